"""Pressures to start from, continued from those of the last contacts."""

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.options import CALLED, INNER, LOOP, REASSOCIATE, compiled


@compiled(**CALLED, nogil=True)
def continue_pressure(
    last: NDArray, before: NDArray, stride: int, share: float, cap: float, start: NDArray
) -> None:
    """Continue the pressures of two contacts to a third, straight at every point of the surface.

    Pressures (nx, ny), Pa. The window moves by `stride` rows from one contact to the next; `share` says how
    far to go on, in steps from `before` to `last`: at zero `before` does not matter. No pressure exceeds
    `cap`.
    """
    nx, ny = last.shape
    for i in range(nx - stride):
        known = share if i + 2 * stride < nx else 0.0
        p, q = last[i + stride], before[min(i + 2 * stride, nx - 1)]
        for j in range(ny):
            start[i, j] = min(max(p[j] + known * (p[j] - q[j]), 0.0), cap)
    for i in range(nx - stride, nx):
        for j in range(ny):
            start[i, j] = 0.0


@compiled(**LOOP, nogil=True)
def continue_rolling(
    last: NDArray, before: NDArray, stride: int, stride_before: int, cap: float, start: NDArray
) -> None:
    """Continue the pressures of two contacts to a third, with the surface or with the window.

    As in `continue_pressure`; the window moved by `stride_before` rows between the two. Where asperities
    carry, their pressures move with the surface; where the whole patch carries, and more so in long strides,
    it stays in the window. Taken is what would have been nearer from the one before to the last.
    """
    nx = len(last)
    with_surface, in_window = 0.0, 0.0
    for i in range(nx):
        in_window += _squares(last[i], before[i], 1.0)
        moved = i + stride_before
        with_surface += _squares(last[i], before[min(moved, nx - 1)], 1.0 if moved < nx else 0.0)
    if with_surface <= in_window:
        share = 1.0 if stride == stride_before else 0.0
        continue_pressure(last, before, stride, share, cap, start)
    else:
        continue_pressure(last, before, np.int64(0), 0.0, cap, start)


@compiled(**INNER, **REASSOCIATE)
def _squares(p: NDArray, q: NDArray, share: float) -> float:
    """Sum of squares of p less a share of q."""
    total = 0.0
    for j in range(len(p)):
        total += (p[j] - share * q[j]) ** 2
    return total


@compiled(**CALLED)
def correct_start(now: NDArray, expected: NDArray, found: NDArray, cap: float, start: NDArray) -> None:
    """Correct the pressure expected now, Pa, by how much was wrong at the approach before."""
    for i in range(start.shape[0]):
        for j in range(start.shape[1]):
            start[i, j] = min(max(now[i, j] + (found[i, j] - expected[i, j]), 0.0), cap)


@compiled(**CALLED, **REASSOCIATE)
def misfits(
    found: NDArray, expected: NDArray, last: NDArray, before: NDArray, share: float
) -> tuple[float, float]:
    """Sums of squares, Pa², between a pressure found and what was expected, and a line through two others.

    The line goes on from `last` by a share of the step from `before` to it.
    """
    by_expectation, by_line = 0.0, 0.0
    for i in range(found.shape[0]):
        for j in range(found.shape[1]):
            p = found[i, j]
            by_expectation += (p - expected[i, j]) ** 2
            by_line += (p - max(last[i, j] + share * (last[i, j] - before[i, j]), 0.0)) ** 2
    return by_expectation, by_line
