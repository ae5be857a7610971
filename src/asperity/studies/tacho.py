"""Recorded signals with a tacho, or a speed beside them: resampled over angle before they are read."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from asperity.arguments import Array, require
from asperity.case.table_headings import unit_of
from asperity.diagnostics import orders
from asperity.diagnostics.tacho import Tacho
from asperity.errors import InputError
from asperity.speeds import FEWEST_TURNS
from asperity.studies.recorded import Recorded, read_beside
from asperity.units import factor
from asperity.written_numbers import capital, count_of, rounded

READS = '"1/min", "Hz", or its pulses in a turn, as "1 pulse" or "60 pulses"'
_PULSES = re.compile(r"\s*([1-9][0-9]{0,5})\s*pulses?\s*")
DIFFERS = 0.1
"""Share by which the mean speed of a tacho may lie beside the speed that is given."""


@dataclass(frozen=True)
class Turned:
    """How something turned while a signal was recorded.

    Attributes
    ----------
    turns : ndarray (n,)
        At its samples; NaN before the first pulse of a tacho and after the last.
    rate : float
        Samples per second, Hz.
    tacho : Tacho
        What told it.
    """

    turns: Array
    rate: float
    tacho: Tacho

    @property
    def speeds(self) -> tuple[float, float, float]:
        """Slowest, mean and fastest over a turn, 1/s."""
        known = np.flatnonzero(np.isfinite(self.turns))
        turns = self.turns[known]
        whole = float(turns[-1] - turns[0])
        received = f"{rounded(whole)} turns"
        least = FEWEST_TURNS
        remedy = f"{capital(self.tacho.question)} Otherwise record longer."
        require(whole >= least, "tacho", received, f"at least {least:g} turns", remedy)
        times = np.interp(np.arange(turns[0], turns[-1]), turns, known / self.rate)
        each = 1.0 / np.diff(times)
        mean = whole * self.rate / float(known[-1] - known[0])
        return float(each.min()), mean, float(each.max())


def read_turned(
    path: Path, signal: Recorded, which: str, reads: str | None, array: str | None = None
) -> Turned:
    """Read how something turned, from a column of the file of a signal by number, or an array by name.

    `reads` says what stands there; by default the unit in its heading.
    """
    values, title = read_beside(path, which, array)
    received = f"{count_of(values.size, 'sample')} beside a signal of {signal.values.size}"
    require(values.size == signal.values.size, f"tacho in {path.name}", received, "one for each sample")
    unit = unit_of(title, "Hz") if reads is None else reads
    require(unit, "--tacho-reads", "nothing, and no unit above the column", READS)
    try:
        if pulses := _PULSES.fullmatch(unit):
            turns = orders.turns_of_pulses(values, float(pulses[1]))
            return Turned(turns, signal.rate, Tacho(int(pulses[1])))
        scale = factor(unit, "Hz")
    except InputError as error:
        if error.what == "unit":
            raise InputError("--tacho-reads", f"'{unit}'", READS) from None
        raise error.about(f"{error.what} in {path.name}") from None
    known = np.isfinite(values)
    require(known.any(), f"tacho in {path.name}", "no number", "speeds")
    speeds = scale * np.interp(np.arange(values.size), np.flatnonzero(known), values[known])
    try:
        return Turned(orders.turns_of(np.abs(speeds), signal.rate), signal.rate, Tacho())
    except InputError as error:
        remedy = "Cut off where it stands."
        raise InputError(f"tacho in {path.name}", error.received, "speeds above zero", remedy) from None


def fitting_speed(turned: Sequence[Turned], told: float | None) -> float:
    """Speed of which frequencies are told, 1/s: the mean of all; one that is given differs little from it."""
    mean = float(np.mean([each.speeds[1] for each in turned]))
    if told and abs(told / mean - 1.0) > DIFFERS:
        received = (
            f"{rounded(60.0 * mean, 5)} 1/min on average, beside a speed of {rounded(60.0 * told, 5)} 1/min"
        )
        remedy = "Is its unit, or the number of its pulses in a turn, right?"
        raise InputError("tacho", received, f"speeds within {DIFFERS:.0%} of one another", remedy)
    return mean


def at_constant_speed(
    signals: Mapping[str, Recorded], turned: Sequence[Turned], speed: float
) -> dict[str, Recorded]:
    """Signals at equal steps of angle, as if all had turned at one speed, 1/s, at one sampling rate.

    What is missing stays missing. Resonances are smeared by as much as the speed changes, lines no more.
    """
    per_turn = max(orders.finest(each.turns[np.isfinite(each.turns)]) for each in turned)
    found = {}
    for (name, signal), course in zip(signals.items(), turned, strict=True):
        inside = np.isfinite(course.turns)
        turns = course.turns[inside]
        values = signal.values[inside]
        gone = ~np.isfinite(values)
        places = np.arange(values.size)
        whole = np.interp(places, places[~gone], values[~gone]) if gone.any() else values
        resampled, _ = orders.over_angle(whole, turns, per_turn=per_turn)
        if gone.any():
            at = turns[0] + np.arange(resampled.size) / per_turn
            resampled[np.interp(at, turns, gone.astype(float)) > 0.0] = np.nan
        found[name] = replace(signal, values=resampled, rate=per_turn * speed, rate_by="")
    return found
