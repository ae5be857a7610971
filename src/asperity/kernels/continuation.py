"""Pressures to start from, continued from those of the last contacts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.options import LOOP, REASSOCIATE, compiled


@compiled(**LOOP, nogil=True)
def continue_pressure(
    last: NDArray[np.float64],
    before: NDArray[np.float64],
    stride: int,
    share: float,
    cap: float,
    start: NDArray[np.float64],
) -> None:
    """Continue the pressures of two contacts to a third, straight at every point of the surface.

    Parameters
    ----------
    last, before : ndarray, shape (nx, ny)
        Pressures of the last contact and of the one before, Pa.
    stride : int
        Rows that the window moved along the surface from one contact to the next.
    share : float
        How far to go on, in steps from the contact before to the last; at zero, `before` does not matter.
    cap : float
        Largest pressure, Pa.
    start : ndarray, shape (nx, ny)
        Receives the pressure, Pa.
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


@compiled(**LOOP)
def correct_start(
    now: NDArray[np.float64],
    expected: NDArray[np.float64],
    found: NDArray[np.float64],
    cap: float,
    start: NDArray[np.float64],
) -> None:
    """Correct what is expected by how much it was wrong at the approach before.

    Parameters
    ----------
    now, expected : ndarray, shape (nx, ny)
        What is expected, and what was expected at the approach before, Pa.
    found : ndarray, shape (nx, ny)
        What was found there, Pa.
    cap : float
        Largest pressure, Pa.
    start : ndarray, shape (nx, ny)
        Receives the pressure, Pa.
    """
    for i in range(start.shape[0]):
        for j in range(start.shape[1]):
            start[i, j] = min(max(now[i, j] + (found[i, j] - expected[i, j]), 0.0), cap)


@compiled(**LOOP, **REASSOCIATE)
def misfits(
    found: NDArray[np.float64],
    expected: NDArray[np.float64],
    last: NDArray[np.float64],
    before: NDArray[np.float64],
    share: float,
) -> tuple[float, float]:
    """How far what was expected, and a straight line through two other contacts, are from what was found.

    Parameters
    ----------
    found, expected : ndarray, shape (nx, ny)
        Pressures, Pa.
    last, before : ndarray, shape (nx, ny)
        Pressures of the other contacts, Pa.
    share : float
        How far the line goes on, in steps from the contact before to the last.

    Returns
    -------
    by_expectation, by_line : float
        Sums of squares, Pa².
    """
    by_expectation, by_line = 0.0, 0.0
    for i in range(found.shape[0]):
        for j in range(found.shape[1]):
            p = found[i, j]
            by_expectation += (p - expected[i, j]) ** 2
            by_line += (p - max(last[i, j] + share * (last[i, j] - before[i, j]), 0.0)) ** 2
    return by_expectation, by_line
