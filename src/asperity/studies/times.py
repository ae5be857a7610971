"""A column of times beside recorded signals: it gives their sampling rate."""

import re
from collections.abc import Sequence

import numpy as np

from asperity.arguments import Array, require
from asperity.case.table_headings import unit_of
from asperity.errors import InputError, OutOfRangeWarning
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
        return named[0], rate_of(values[:, named[0]] * factor(unit, "s"), source)
    if titles or values.shape[1] < 2:
        return None
    rate = rate_of(values[:, 0], source)
    return (0, rate) if rate and BARE_RATES[0] <= rate <= BARE_RATES[1] else None


def rate_of(times: Array, source: str) -> float | None:
    """Samples per second, Hz, at times that rise evenly, as they were printed; None at others."""
    try:
        index, step = places(times, f"times in {source}")
    except InputError:
        return None
    return 1.0 / step if len(times) > 2 and (index == np.arange(len(times))).all() else None


def rate_beside(given: float | None, told: float | None, source: str, teller: str = "its times say") -> float:
    """Sampling rate, Hz, that is given, beside the one that something in the file tells, or this one."""
    remedy = 'Give the sampling rate, as in --rate "12 kHz", if the samples are even all the same.'
    require(given or told, f"times in {source}", "uneven ones", "equal steps", remedy)
    if given and told:
        received, allowed = f"{rounded(given, 6)} Hz", f"{rounded(told, 6)} Hz, as {teller}"
        remedy = "Leave it out, or correct the file: save the signal alone."
        require(abs(given / told - 1.0) <= SAME, f"sampling rate of {source}", received, allowed, remedy)
    return float(told or given or 0.0)


def doubt_rate(given: float, of_column: float, source: str) -> None:
    """Warn of a rate, Hz, that is given beside a column without a title that rises as times of another do."""
    same = any(abs(given / (of_column * unit) - 1.0) <= SAME for unit in (1.0, 1e3, 1e6))  # s, ms, µs
    if not same:
        rises = f"its first column rises as times of {rounded(of_column, 6)} Hz do"
        taken = f"and {rounded(given, 6)} Hz was given and is taken"
        OutOfRangeWarning.warn(f"{source}: {rises}, {taken}. If it holds times, leave the rate out.")
