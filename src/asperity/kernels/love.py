"""Love's influence coefficients: displacement of a half-space under pressure on one rectangular cell."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

AT_ONCE = 2**16
"""Coefficients that are computed in one go: some ten arrays of them take memory."""


def _edge_log(x: NDArray[np.float64], y: NDArray[np.float64], half: float) -> NDArray[np.float64]:
    """ln[(y₊ + √(y₊² + x²)) / (y₋ + √(y₋² + x²))] for y ≥ 0, without cancellation far away."""
    upper, lower = y + half, y - half
    r_upper, r_lower = np.hypot(upper, x), np.hypot(lower, x)
    away = np.where(lower < 0.0, r_lower - lower, 1.0)
    denominator = np.where(lower < 0.0, x * x / away, lower + r_lower)
    step = 2.0 * half * (1.0 + 2.0 * y / (r_upper + r_lower))
    return np.log1p(step / denominator)


def cell_displacement(
    x: NDArray[np.float64], y: NDArray[np.float64], dx: float, dy: float
) -> NDArray[np.float64]:
    """Surface displacement at (x, y), times π E*, under unit pressure on the cell dx × dy at the origin.

    All in m; to be divided by π E*, Pa. A. E. H. Love, Phil. Trans. R. Soc. A 228 (1929) 377; finite
    everywhere.
    """
    x, y = np.abs(x), np.abs(y)
    hx, hy = 0.5 * dx, 0.5 * dy
    return (
        (x + hx) * _edge_log(x + hx, y, hy)
        - (x - hx) * _edge_log(x - hx, y, hy)
        + (y + hy) * _edge_log(y + hy, x, hx)
        - (y - hy) * _edge_log(y - hy, x, hx)
    )


def influence_table(nx: int, ny: int, dx: float, dy: float) -> NDArray[np.float64]:
    """Influence coefficients (nx, ny), m, times π E*: entry (i, j) for the separation (i dx, j dy), m."""
    x, y = dx * np.arange(nx, dtype=np.float64), dy * np.arange(ny, dtype=np.float64)
    table, rows = np.empty((nx, ny)), max(1, AT_ONCE // ny)
    for first in range(0, nx, rows):
        table[first : first + rows] = cell_displacement(x[first : first + rows, None], y, dx, dy)
    return table
