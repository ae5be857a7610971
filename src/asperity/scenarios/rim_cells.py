"""How cells at the rim of a contact count, and how much that matters: whole ones let the stiffness jump."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from asperity.arguments import Array
from asperity.contact.batched import find_device
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.reducing import samples_of
from asperity.scenarios.scene import PreparedCase
from asperity.spectra import root_mean_square
from asperity.written_numbers import rounded

SMOOTH = 0.1
"""Rms height within the patch, in approaches, up to which covered cells are chosen.

Few cells enter there as the force varies, and with nine in the half-width force and stiffness are nearer to
those of finer grids than on whole cells, however short waves are: ``benchmarks/cell_rims.py --choice``.
"""
AT_SIX, ORDER, SLENDER = 0.042, 1.4, 0.82
"""Share by which six whole cells in the half-width of a contact miss the stiffness of a ball at most; powers
with which that falls with their number, and with the slenderness of an ellipse.

From ``benchmarks/cell_rims.py --check``.
"""


def with_rims(prepared: PreparedCase) -> PreparedCase:
    """The case with gaps of cells, not of points, where those at rims count as far as they are covered.

    Where that is left to the case it is so for laws that see heights, alone: they follow the stiffness of
    single contacts, and a law has the same digits whichever others are run beside it.
    """
    case = prepared.case
    if case.contact.rim_cells == "covered":
        cells = prepared.shape.over_cells(), prepared.textures.over_cells()
        return replace(prepared, shape=cells[0], textures=cells[1])
    if len(case.cells_at_rims) == 1:
        return prepared
    if find_device() is not None:
        return replace(prepared, cells_of_heights="whole", rims="the device gpu has no others")
    shape = prepared.shape
    within = roughness_within(samples_of(case, shape, prepared.textures.maps, shape.class_axes), shape)
    texture = f"the texture has {rounded(within, 2)} approaches rms within the contact"
    if within > SMOOTH:
        return replace(prepared, cells_of_heights="whole", rims=f"{texture}, more than {SMOOTH}")
    why = f"{texture}, up to {SMOOTH}"
    return replace(prepared, cells_of_heights="covered", rims=why, roughness=within)


def stiffness_missed(shape: Geometry) -> float:
    """Share by which the stiffness of a smooth contact of whole cells is off at most, under the load."""
    small, large = sorted(shape.semi_axes)
    cells = small / max(shape.spacing)
    return float(AT_SIX * (6.0 / cells) ** ORDER * (small / large) ** SLENDER)


def roughness_within(samples: Sequence[Array], shape: Geometry) -> float:
    """Rms height of samples (nx, ny), m, about a plane within the nominal patch, in smooth approaches."""
    nx, ny = shape.body.shape
    a, b = (axis / step for axis, step in zip(shape.semi_axes, shape.spacing, strict=True))
    x, y = np.mgrid[-(nx // 2) : nx // 2 + 1, -(ny // 2) : ny // 2 + 1]
    inside = (x / a) ** 2 + (y / b) ** 2 < 1.0
    plane = np.stack([np.ones(inside.sum()), x[inside], y[inside]], axis=1)
    heights = np.stack([sample[inside] for sample in samples], axis=1)
    left = heights - plane @ np.linalg.lstsq(plane, heights, rcond=None)[0]
    return root_mean_square(left) / shape.hertz.approach(shape.load)
