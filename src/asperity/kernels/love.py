"""Love's influence coefficients: displacement of a half-space under pressure on one rectangular cell."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.options import compiled


@compiled(cache=True)
def _edge_log(x: float, y: float, half: float) -> float:
    """ln[(y₊ + √(y₊² + x²)) / (y₋ + √(y₋² + x²))] for y ≥ 0, without cancellation far away."""
    upper, lower = y + half, y - half
    r_upper, r_lower = math.hypot(upper, x), math.hypot(lower, x)
    if lower >= 0.0:
        denominator = lower + r_lower
    else:
        denominator = x * x / (r_lower - lower)
    step = 2.0 * half * (1.0 + 2.0 * y / (r_upper + r_lower))
    return math.log1p(step / denominator)


@compiled(cache=True)
def cell_displacement(x: float, y: float, dx: float, dy: float) -> float:
    """Surface displacement at (x, y), times π E*, under unit pressure on the cell dx × dy at the origin.

    All in m; to be divided by π E*, Pa. A. E. H. Love, Phil. Trans. R. Soc. A 228 (1929) 377; finite
    everywhere.
    """
    x, y = abs(x), abs(y)
    hx, hy = 0.5 * dx, 0.5 * dy
    return (
        (x + hx) * _edge_log(x + hx, y, hy)
        - (x - hx) * _edge_log(x - hx, y, hy)
        + (y + hy) * _edge_log(y + hy, x, hx)
        - (y - hy) * _edge_log(y - hy, x, hx)
    )


@compiled(cache=True)
def influence_table(nx: int, ny: int, dx: float, dy: float) -> NDArray[np.float64]:
    """Influence coefficients (nx, ny), m, times π E*: entry (i, j) for the separation (i dx, j dy), m."""
    table = np.empty((nx, ny))
    for i in range(nx):
        for j in range(ny):
            table[i, j] = cell_displacement(i * dx, j * dy, dx, dy)
    return table
