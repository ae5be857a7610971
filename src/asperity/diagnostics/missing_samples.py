"""Samples that are missing where none is marked: held, or filled in by straight lines and cubics."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from asperity.arguments import Array

Mask = NDArray[np.bool_]
Runs = NDArray[np.intp]

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


def begins_run(held: Mask, length: int) -> Mask:
    """Where a condition (n,) is held by so many in a row: most records have none, and millions of short
    runs."""
    done = 1
    while done < length and held.any():
        by = min(done, length - done)
        held = held[: held.size - by] & held[by:]
        done += by
    return held if done >= length else np.zeros(1, dtype=bool)


def least_step(values: Array) -> float:
    """Step of values (n,), in their unit: what those that differ do so by at least."""
    known = values[:BLOCK]
    known = known[np.isfinite(known)]
    return float(np.diff(np.unique(known)).min(initial=np.ptp(known) if known.size else 0.0))


def filled_in(values: Array, most: float = np.inf) -> Runs:
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
        for first, last in _long(_small(values, order, 0.0 if order == 1 else noise)):
            behind = last + order
            beside = (
                values[max(first - IN_A_ROW - order, 0) : first],
                values[behind : behind + IN_A_ROW + order],
            )
            clipped = not low + margin < float(np.median(values[first:behind])) < high - margin
            if not clipped and _begins_and_ends(beside, order, ABRUPT * noise):
                found.append((first, behind))
    stretches = joined(found)
    middles = values[stretches.mean(axis=1).astype(int)]
    alike = [np.count_nonzero(np.abs(middles - each) <= rounding) for each in middles]
    return stretches[np.array(alike, dtype=float) <= most]


def _small(values: Array, order: int, most: float) -> Mask:
    """Where differences of an order are no larger than so much, (n - order,)."""
    held = np.zeros(max(values.size - order, 1), dtype=bool)
    for first in range(0, values.size - order, BLOCK):
        part = values[first : first + BLOCK + order]
        held[first : first + part.size - order] = np.abs(np.diff(part, order)) <= most
    return held


def _long(small: Mask) -> Runs:
    """Runs of a condition that are longer than chance makes them."""
    found = runs(begins_run(small, IN_A_ROW))
    found[:, 1] += IN_A_ROW - 1
    return found


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
