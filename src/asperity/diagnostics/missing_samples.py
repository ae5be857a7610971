"""Samples that are missing where none is marked: held, or filled in by straight lines and cubics."""

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.arguments import Array, floats

Mask = NDArray[np.bool_]
Runs = NDArray[np.intp]
Samples = NDArray[Any]
"""Of a record (n,), in whatever type they were kept: what is computed of some takes them as floats."""

BLOCK = 2**16
"""Samples that are looked at together: a record is not held beside itself."""
ORDERS = (1, 2, 4)
"""Of differences that are nothing where samples are held, on a straight line, on a cubic."""
IN_A_ROW = 8
"""Such differences from which on no chance and no rounding makes them, where …"""
ABRUPT = 16.0
"""… those on either side, so many of them, are this many times as large as rounding makes them."""
DIGITS = 1e-7
"""Of the largest value: what floats of four bytes, and seven printed digits, leave out."""
AT_THE_END = 1e-3
"""Share of the height of a signal within which what is constant is clipped."""


def runs(held: Mask) -> Runs:
    """First place of each run of a condition (n,), and the one behind its last, (runs, 2)."""
    edges = np.flatnonzero(held[1:] != held[:-1]) + 1
    first = [0] if held[0] else []
    last = [held.size] if held[-1] else []
    return np.concatenate([first, edges, last]).astype(np.intp).reshape(-1, 2)


def runs_of(pieces: Iterable[Mask], least: int = 1) -> Runs:
    """Those runs of a condition that are held by so many in a row, of pieces of it one after the other.

    Most records have none, and millions of short runs.
    """
    found = [joined([])]
    begun = None
    first = 0
    for held in pieces:
        here = runs(held) + first
        if begun is not None and held[0]:
            here[0, 0] = begun
        elif begun is not None:
            here = np.insert(here, 0, (begun, first), axis=0)
        first += held.size
        begun = int(here[-1, 0]) if held[-1] else None
        ended = here[: len(here) - held[-1]]
        found.append(ended[ended[:, 1] - ended[:, 0] >= least])
    if begun is not None and first - begun >= least:
        found.append(np.array([[begun, first]]))
    return np.concatenate(found)


def blocks(values: NDArray[Any], size: int = BLOCK) -> Iterator[NDArray[Any]]:
    """Values (n,), so many at a time."""
    return (values[first : first + size] for first in range(0, values.size, size))


def least_step(values: Samples) -> float:
    """Step of values (n,), in their unit: what those that differ do so by at least."""
    known = floats(values[:BLOCK])
    known = known[np.isfinite(known)]
    return float(np.diff(np.unique(known)).min(initial=np.ptp(known) if known.size else 0.0))


def filled_in(values: Samples, most: float = np.inf) -> Runs:
    """First place of each stretch of a signal (n,) in which nothing was measured, and that behind its last.

    There the signal is constant, or on a straight line or a cubic, to within rounding, while on either side
    of it it is not: coarse steps, a slow tone and blows that die out have no such edges. What is constant at
    an end of the signal is clipped, and at more than so many places it is the silence between blows.
    """
    low = float(np.nanmin(values))
    high = float(np.nanmax(values))
    rounding = max(least_step(values), DIGITS * max(abs(low), abs(high)))
    margin = AT_THE_END * (high - low)
    found = []
    for order in ORDERS:
        noise = rounding * 2.0 ** (order - 1)
        small = _small(values, order, 0.0 if order == 1 else noise)
        for first, last in runs_of(small, IN_A_ROW):
            behind = last + order
            beside = (
                floats(values[max(first - IN_A_ROW - order, 0) : first]),
                floats(values[behind : behind + IN_A_ROW + order]),
            )
            clipped = not low + margin < float(np.median(values[first:behind])) < high - margin
            if not clipped and _begins_and_ends(beside, order, ABRUPT * noise):
                found.append((first, behind))
    stretches = joined(found)
    middles = floats(values[stretches.mean(axis=1).astype(int)])
    alike = [np.count_nonzero(np.abs(middles - each) <= rounding) for each in middles]
    return stretches[np.array(alike, dtype=float) <= most]


def _small(values: Samples, order: int, most: float) -> Iterator[Mask]:
    """Where differences of an order are no larger than so much, piece by piece, (n - order,) in all."""
    parts = (floats(values[first : first + BLOCK + order]) for first in range(0, values.size - order, BLOCK))
    return (np.abs(np.diff(part, order)) <= most for part in parts)


def _begins_and_ends(beside: Iterable[Array], order: int, least: float) -> bool:
    """Whether differences on either side of a stretch are large, by the median of what is known."""
    steps = [np.abs(np.diff(each, order)) for each in beside]
    known = [each[np.isfinite(each)] for each in steps]
    return all(each.size and float(np.median(each)) >= least for each in known)


def joined(found: list[tuple[int, int]]) -> Runs:
    """Stretches that overlap, as one, in their order."""
    joined = list[list[int]]()
    for first, last in sorted(found):
        if joined and first <= joined[-1][1]:
            joined[-1][1] = max(joined[-1][1], last)
        else:
            joined.append([first, last])
    return np.array(joined, dtype=np.intp).reshape(-1, 2)
