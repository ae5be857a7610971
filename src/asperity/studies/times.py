"""A column of times beside recorded signals: it gives their sampling rate."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity.arguments import Array, NDArray, floats, require
from asperity.case.table_headings import unit_of
from asperity.errors import InputError, OutOfRangeWarning
from asperity.surfaces.readers.positions import LARGEST, places
from asperity.units import factor
from asperity.written_numbers import rounded

_TITLE = re.compile(r"\W*(time|zeit|temps|tiempo|tempo|t)(?![a-z])", re.IGNORECASE)
BARE_RATES = (100.0, 1e7)
"""Hz, at which a first column without a title that rises evenly holds times, s."""
MOST_GAPS = 100
"""Places at which samples may be missing from times that are even."""
MOST_MISSING = 10_000
"""Samples that stand for a gap: how long it was in truth changes nothing beyond."""
SAME = 0.01
"""Share by which a rate that is given may differ from that of the times."""


@dataclass(frozen=True)
class Clock:
    """Times beside a signal.

    Attributes
    ----------
    column : int
        That holds them.
    rate : float or None
        Samples per second, Hz; None of times that are not even.
    gaps : tuple of (int, int)
        Places before which samples are missing, and how many at least.
    """

    column: int
    rate: float | None
    gaps: tuple[tuple[int, int], ...] = ()

    def filled(self, values: NDArray[Any]) -> NDArray[Any]:
        """Values (n,) with NaN where samples are missing."""
        before = [place for place, count in self.gaps for _ in range(count)]
        return np.insert(floats(values), before, np.nan) if before else values


def clock_of(values: NDArray[Any], titles: Sequence[str], source: str) -> Clock | None:
    """Column of times, s, of a table (n, k), with the sampling rate and gaps, if they are even; None without
    one.

    Titles name it, with its unit, else seconds. Without titles it is the first of several columns, if it
    rises evenly.
    """
    named = [number for number, title in enumerate(titles) if _TITLE.match(title)]
    if named:
        unit = unit_of(titles[named[0]], "s") or "s"
        return Clock(named[0], *_rate_and_gaps(floats(values[:, named[0]]) * factor(unit, "s"), source))
    if titles or values.shape[1] < 2:
        return None
    rate, gaps = _rate_and_gaps(floats(values[:, 0]), source)
    return Clock(0, rate, gaps) if rate and BARE_RATES[0] <= rate <= BARE_RATES[1] else None


def rate_of(times: Array, source: str) -> float | None:
    """Samples per second, Hz, at times that rise evenly, as they were printed; None at others."""
    rate, gaps = _rate_and_gaps(times, source)
    return None if gaps else rate


def _rate_and_gaps(times: Array, source: str) -> tuple[float | None, tuple[tuple[int, int], ...]]:
    """Samples per second, Hz, at times that rise evenly, as they were printed, but for few gaps; None at
    others."""
    if len(times) > 2 and (step := _even_spacing(times, source)):
        return 1.0 / step, ()
    if not (np.abs(times) < LARGEST).all():
        return None, ()
    steps = np.diff(times)
    typical = float(np.median(steps)) if steps.size else 0.0
    after = 1 + np.flatnonzero(np.abs(steps - typical) > 0.5 * np.abs(typical))
    if not typical > 0.0 or after.size > MOST_GAPS:
        return None, ()
    parts = [each for each in np.split(times, after) if each.size > 2]
    spacings = [_even_spacing(each, source) for each in parts]
    if not parts or not all(spacings):
        return None, ()
    step = spacings[int(np.argmax([each.size for each in parts]))]
    lost = np.rint(steps[after - 1] / step) - 1.0
    missing = np.clip(lost, 1, MOST_MISSING).astype(int)  # fewer where a clock begins anew
    return 1.0 / step, tuple(zip(after.tolist(), missing.tolist(), strict=True))


def _even_spacing(times: Array, source: str) -> float:
    """Distance, s, of times that rise evenly, as they were printed; 0 of others."""
    try:
        index, step = places(times, f"times in {source}")
    except InputError:
        return 0.0
    return step if (index == np.arange(len(times))).all() else 0.0


def rate_beside(given: float | None, told: float | None, source: str, teller: str = "its times say") -> float:
    """Sampling rate, Hz, that is given, beside the one that something in the file tells, or this one."""
    remedy = 'Give the sampling rate, as in --rate "12 kHz", if the samples are even all the same.'
    require(given or told, f"times in {source}", "uneven ones", "equal steps", remedy)
    if given and told:
        received = f"{rounded(given, 6)} Hz"
        allowed = f"{rounded(told, 6)} Hz, as {teller}"
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
