"""A column of times beside recorded signals: it gives their sampling rate."""

import re
from collections.abc import Sequence

import numpy as np

from asperity.arguments import Array, require
from asperity.case.table_headings import unit_of
from asperity.errors import InputError
from asperity.surfaces.readers.positions import places
from asperity.units import factor
from asperity.written_numbers import rounded

_TITLE = re.compile(r"\W*(time|zeit|temps|tiempo|tempo|t)(?![a-z])", re.IGNORECASE)
BARE_RATES = (100.0, 1e7)
"""Hz, at which a first column without a title that rises evenly holds times, s."""
SAME = 0.01
"""Share by which a rate that is given may differ from that of the times."""


def clock_of(values: Array, titles: Sequence[str], source: str) -> tuple[int, float | None] | None:
    """Column of times, s, of a table (n, k), and the sampling rate, Hz, if they are even; None without one.

    Titles name it, with its unit, else seconds. Without titles it is the first of several columns, if it
    rises evenly.
    """
    named = [number for number, title in enumerate(titles) if _TITLE.match(title)]
    if named:
        unit = unit_of(titles[named[0]], "s") or "s"
        return named[0], _rate(values[:, named[0]] * factor(unit, "s"), source)
    if titles or values.shape[1] < 2:
        return None
    rate = _rate(values[:, 0], source)
    return (0, rate) if rate and BARE_RATES[0] <= rate <= BARE_RATES[1] else None


def _rate(times: Array, source: str) -> float | None:
    """Samples per second, Hz, at times that rise evenly, as they were printed; None at others."""
    try:
        index, step = places(times, f"times in {source}")
    except InputError:
        return None
    return 1.0 / step if len(times) > 2 and (index == np.arange(len(times))).all() else None


def rate_beside(given: float | None, of_times: float | None, source: str) -> float:
    """Sampling rate, Hz, that is given beside a column of times, or that of these."""
    remedy = 'Give the sampling rate, as in --rate "12 kHz", if the samples are even all the same.'
    require(given or of_times, f"times in {source}", "uneven ones", "equal steps", remedy)
    if given and of_times:
        received, allowed = f"{given:g} Hz", f"{rounded(of_times, 6)} Hz, as its times say"
        same = abs(given / of_times - 1.0) <= SAME
        require(same, f"sampling rate of {source}", received, allowed, "Leave it out, or correct the times.")
    return float(of_times or given or 0.0)
