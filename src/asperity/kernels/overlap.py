"""Boxes around the cells where something happens."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.options import LOOP, REASSOCIATE, compiled

BALL = 4.0 / 3.0 / math.sqrt(math.pi / 2.0)
"""Makes the estimate of the approach exact for a ball: Hertz's force over √A × (mean overlap on A)."""


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


@compiled(**LOOP, nogil=True)
def foundation_approach(
    gap: NDArray[np.float64], load: float, modulus: float, cell_area: float, hardness: float
) -> float:
    """Estimate the approach under a load, BALL E* √A × (mean overlap on A).

    Parameters
    ----------
    gap : ndarray, shape (nx, ny)
        Separation at zero approach, m.
    load : float
        Load, N, less than the hardness over the grid.
    modulus : float
        Contact modulus E*, Pa.
    cell_area : float
        Area of a cell, m².
    hardness : float
        Largest pressure, Pa (may be infinite).

    Returns
    -------
    float
        Approach, m, at which the overlapping cells can carry the load.
    """
    count, added, lowest = _below(gap, np.inf)
    stiffness = BALL * modulus * np.sqrt(cell_area)
    approach = added / count + load / (stiffness * np.sqrt(count))
    for _ in range(30):  # the mean over all cells first, then over fewer and fewer
        count, added, _lowest = _below(gap, approach)
        last, approach = approach, added / count + load / (stiffness * np.sqrt(count))
        if abs(approach - last) <= 1e-3 * (approach - lowest):
            break
    while count * cell_area * hardness <= 1.05 * load and count < gap.size:
        approach += 0.25 * (approach - lowest)
        count, added, _lowest = _below(gap, approach)
    return approach


@compiled(**LOOP, **REASSOCIATE)
def _below(gap: NDArray[np.float64], approach: float) -> tuple[float, float, float]:
    """Number and sum of the gaps below an approach, and the lowest."""
    count, added, lowest = 0.0, 0.0, np.inf
    for i in range(gap.shape[0]):
        for j in range(gap.shape[1]):
            g = gap[i, j]
            count += 1.0 if g < approach else 0.0
            added += g if g < approach else 0.0
            lowest = min(lowest, g)
    return count, added, lowest
