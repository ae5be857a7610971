"""How much the grid of a contact matters: the stiffness of whole cells, which jumps as cells enter."""

import numpy as np

from asperity.scenarios.geometry import Geometry
from asperity.scenarios.reducing import PressedSamples

SMOOTH = 0.1
"""Rms height within the patch, in approaches, below which few cells enter as the force varies."""
AT_SIX, ORDER, SLENDER = 0.042, 1.4, 0.82
"""Share by which six whole cells in the half-width of a contact miss the stiffness of a ball at most; powers
with which that falls with their number, and with the slenderness of an ellipse.

From ``benchmarks/cell_rims.py --check``.
"""


def stiffness_missed(shape: Geometry) -> float:
    """Share by which the stiffness of a smooth contact of whole cells is off at most, under the load."""
    small, large = sorted(shape.semi_axes)
    cells = small / max(shape.spacing)
    return float(AT_SIX * (6.0 / cells) ** ORDER * (small / large) ** SLENDER)


def roughness_within(pressed: PressedSamples, shape: Geometry) -> float:
    """Rms height of samples about a plane within the nominal patch, in approaches of the smooth bodies."""
    nx, ny = shape.body.shape
    a, b = (axis / step for axis, step in zip(shape.semi_axes, shape.spacing, strict=True))
    x, y = np.mgrid[-(nx // 2) : nx // 2 + 1, -(ny // 2) : ny // 2 + 1]
    inside = (x / a) ** 2 + (y / b) ** 2 < 1.0
    plane = np.stack([np.ones(inside.sum()), x[inside], y[inside]], axis=1)
    heights = np.stack([(shape.body - each.undeformed_gap)[inside] for each in pressed.contacts], axis=1)
    left = heights - plane @ np.linalg.lstsq(plane, heights, rcond=None)[0]
    return float(np.sqrt(np.mean(left**2))) / shape.hertz.approach(shape.load)
