"""Boxes around the cells where something happens."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.options import CALLED, LOOP, REASSOCIATE, compiled

BALL = 4.0 / 3.0 / math.sqrt(math.pi / 2.0)
"""Makes the estimate of the approach exact for a ball: Hertz's force over √A × (mean overlap on A)."""


@compiled(**CALLED)
def overlap_box(
    gap: NDArray[np.float64], approach: float, lowest: NDArray[np.float64]
) -> tuple[float, int, int, int, int]:
    """Find where bodies with a gap (nx, ny), m, at zero approach overlap at an approach, m.

    Returns the largest overlap, m, not positive if there is none, and the first and end row and column of the
    smallest box that holds all overlapping cells, else zeros. `lowest` (ny,) receives the lowest gap of each
    column, m.
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


@compiled(**LOOP, nogil=True)
def foundation_approach(
    gap: NDArray[np.float64], load: float, modulus: float, cell_area: float, hardness: float
) -> float:
    """Estimate the approach, m, under a load, N: BALL E* √A × (mean overlap on A).

    The overlapping cells can carry the load there. Gap (nx, ny), m, at zero approach; modulus and hardness,
    Pa; cell area, m². The load is less than the hardness over the grid.
    """
    count, added, lowest = _below(gap, np.inf)
    stiffness = BALL * modulus * np.sqrt(cell_area)
    approach = added / count + load / (stiffness * np.sqrt(count))
    for _ in range(30):  # the mean over all cells first, then over fewer and fewer
        count, added, _lowest = _below(gap, approach)
        last, approach = approach, added / count + load / (stiffness * np.sqrt(count))
        if abs(approach - last) <= 1e-3 * (approach - lowest):  # an estimate is enough
            break
    # where all cells are near the hardness, so many must overlap that they carry a little more than the load
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
