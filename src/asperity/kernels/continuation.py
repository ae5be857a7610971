"""Pressures to start from, continued from those of the last contacts."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from asperity.kernels.options import LOOP


@njit(**LOOP, nogil=True)
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
