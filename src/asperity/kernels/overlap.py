"""Boxes around the cells where something happens."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.options import LOOP, compiled


@compiled(**LOOP)
def overlap_box(
    gap: NDArray[np.float64], approach: float, lowest: NDArray[np.float64]
) -> tuple[float, int, int, int, int]:
    """Find where undeformed bodies overlap.

    Parameters
    ----------
    gap : ndarray, shape (nx, ny)
        Separation at zero approach, m.
    approach : float
        Approach, m.
    lowest : ndarray, shape (ny,)
        Receives the lowest gap of each column, m.

    Returns
    -------
    largest : float
        Largest overlap, m; not positive if there is none.
    first_row, end_row, first_column, end_column : int
        The smallest box that holds all overlapping cells; zeros if there are none.
    """
    nx, ny = gap.shape
    for j in range(ny):
        lowest[j] = np.inf
    smallest, first, end = np.inf, nx, 0
    for i in range(nx):
        row = np.inf
        for j in range(ny):
            g = gap[i, j]
            row = min(row, g)
            lowest[j] = min(lowest[j], g)
        smallest = min(smallest, row)
        if row < approach:
            first, end = min(first, i), i + 1
    if end == 0:
        return approach - smallest, 0, 0, 0, 0
    left, right = 0, ny
    while lowest[left] >= approach:
        left += 1
    while lowest[right - 1] >= approach:
        right -= 1
    return approach - smallest, first, end, left, right


@compiled(**LOOP)
def box_of_positive(field: NDArray[np.float64]) -> tuple[int, int, int, int]:
    """Find the smallest box that holds all positive values of a field.

    Parameters
    ----------
    field : ndarray, shape (nx, ny)
        Field.

    Returns
    -------
    first_row, end_row, first_column, end_column : int
        Zeros if no value is positive.
    """
    nx, ny = field.shape
    first, end, left, right = nx, 0, ny, 0
    for i in range(nx):
        for j in range(ny):
            if field[i, j] > 0.0:
                first, end = min(first, i), i + 1
                left, right = min(left, j), max(right, j + 1)
    return (first, end, left, right) if end else (0, 0, 0, 0)
