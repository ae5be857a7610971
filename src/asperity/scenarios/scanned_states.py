"""States at which a path is scanned: those that the motion visits, each for itself."""

import warnings
from collections.abc import Callable, Sequence
from typing import Protocol, Self, TypeVar

import numpy as np

from asperity.arguments import Array
from asperity.errors import ComputationError, PhysicsWarning
from asperity.kernels.curves import shape_preserving

EXPECTED = (0.75, 1.25)
"""Forces between which a motion is expected to stay, over the static loads, until it is known."""
FEWEST = 3
"""States, at least, through which forces are interpolated: F^(2/3) is nearly straight, and a little bent."""

CURVED = 1e-3
"""Relative error of the forces of samples, rms, up to which a state is left to those beside it."""


def states_apart(approaches: Array, forces: Array) -> list[int]:
    """Which of the states (k,), m, are enough to interpolate the forces (N, k), N, of some samples in all.

    Every other from the highest on, and those between where F^(2/3) is bent: levels of a wheel on a track are
    within 0.04 dB rms of those through all states.
    """
    count = len(approaches)
    kept = np.arange((count - 1) % 2, count, 2)
    if len(kept) < FEWEST:
        return list(range(count))
    between = kept[:-1] + 1
    root = np.cbrt(forces[:, kept]) ** 2
    found = shape_preserving(approaches[kept], root, approaches[between]) ** 1.5
    known = forces[:, between]
    off = np.sqrt(np.mean((found - known) ** 2, axis=0))
    straight = off <= CURVED * known.mean(axis=0)
    return sorted({*range(count)} - {*between[straight].tolist()})


def states_expected(approaches: Array, forces: Array, loads: Array) -> slice:
    """Which of the states (k,), m, a motion under static loads, N, is expected to visit.

    By the mean force (k,), N, of each state.
    """
    least, most = EXPECTED
    low, high = np.interp((least * loads.min(), most * loads.max()), forces, approaches)
    return states_around(approaches, (float(low), float(high)))


def states_around(approaches: Array, visited: tuple[float, float]) -> slice:
    """Which of the states (k,), m, lie around forces between two approaches, m: `FEWEST` or more.

    A slope at the outermost follows from one side: levels are within 0.05 dB of those through all states.
    """
    low, high = np.searchsorted(approaches, visited, side="right")
    last = len(approaches)
    first = min(max(int(low) - 1, 0), last - 1)
    end = max(min(int(high) + 1, last), min(first + FEWEST, last))
    return slice(max(min(first, end - FEWEST), 0), end)


def place_between(value: float, rising: Array, places: Array) -> float:
    """Place at which values (k,), k ≥ 2, that rise with places are one, straight between and beyond them."""
    at = int(np.clip(np.searchsorted(rising, value), 1, len(rising) - 1))
    step = max(float(rising[at] - rising[at - 1]), 1e-3 * float(rising[-1]))
    share = (value - float(rising[at - 1])) / step if step > 0.0 else 1.0
    return float(places[at - 1] + share * (places[at] - places[at - 1]))


class Scanned(Protocol):
    """What a law looks its forces up in, scanned in some states."""

    def wider(self, visited: tuple[float, float] | None) -> Self | None:
        """One that is scanned for a motion between two bounds, too, or in all states; None if this one is."""


OfScan = TypeVar("OfScan", bound=Scanned)
Motion = TypeVar("Motion")


def within_scan(
    roll: Callable[[Sequence[OfScan], float], Motion],
    scanned: Sequence[OfScan],
    visited: Callable[[Motion], Sequence[tuple[float, float]]],
    tried: float = 1.0,
) -> tuple[Motion, Sequence[OfScan]]:
    """Roll over what is scanned; where motion leaves it, scan more and roll anew.

    Where none of the states scanned touches a valley that the record begins over, or motion goes far beyond
    them, rolling fails: it is tried again with all states.

    Parameters
    ----------
    roll : callable
        Rolls over what is scanned, for a share of the way.
    scanned : sequence
        What is looked up in: a path for each contact that has one of its own, or raceways.
    visited : callable
        Least and largest approach, m, or force, N, of a motion on each of them.
    tried : float
        Share of the way after which it is asked first whether motion leaves what was scanned.

    Returns
    -------
    tuple
        The motion, and what it took to be scanned.
    """
    share = tried
    while True:
        failure = None
        with PhysicsWarning.caught() as caught:
            try:
                motion = roll(scanned, share)
                bounds: Sequence[tuple[float, float] | None] = visited(motion)
            except ComputationError as error:
                failure = error
                bounds = [None] * len(scanned)
        wider = [each.wider(between) for each, between in zip(scanned, bounds, strict=True)]
        if not any(wider) and (failure is not None or share == 1.0):
            break
        scanned = [more or each for more, each in zip(wider, scanned, strict=True)]
        share = 1.0
    if failure is not None:
        raise failure
    for each in caught:
        warnings.warn(each.message, stacklevel=2)
    return motion, scanned
