"""Positions at which a path is rolled over or scanned: as far apart as patch and waves let them be."""

import math

from asperity.scenarios.geometry import Geometry
from asperity.scenarios.scene import PreparedCase
from asperity.speeds import slowest
from asperity.structures.track import Track

OF_EDGES = 8
"""Positions in a half axis of the patch where edges come and go under it: of defects, of what is run in."""
OF_TEXTURE = 4
"""Positions in a half axis of the patch, at most, where there is texture alone."""
OF_SMOOTH = 2.5
"""Likewise where that is smooth within the contact.

Planes hold what is of first order at every row: positions are for the second order alone.
"""
OF_WAVE = 5
"""Positions in the shortest wave that is looked at, where the patch does not ask for fewer."""


def edge_stride(shape: Geometry) -> int:
    """Rows of the contact grid between positions that miss no edge: an eighth of the patch."""
    return _rows(shape, shape.class_axes[0] / OF_EDGES)


def table_stride(prepared: PreparedCase) -> int:
    """Rows of the contact grid between the positions of a table.

    The first order of a force at given approach is the texture averaged under the patch, and the plane that
    approaches count from has that at every row. What is left for the table has hardly any waves that are
    short against the patch: with half axis a, those of length λ fall as sin q/q, q = 2πa/λ. Positions s apart
    take the wavenumber 2π/s − k for k: with a quarter of the patch q is 8π less that of k there, of which a
    thirtieth is left, and with five positions in the shortest wave that is looked at four times as large as
    that of any such wave; by as many positions cubic splines are 0.04 dB low. Fewer do where the texture is
    smooth, on a track, which damps what forces are off by: a beam rings with it. Levels in one-third octaves
    are within 0.1 dB rms of those with a position in every row, of balls and wheels on textures from nearly
    smooth ones to those that the load just holds down.
    """
    shape = prepared.shape
    closest = edge_stride(prepared.shape)
    if prepared.textures.defects is not None:
        return closest
    smooth = math.isfinite(prepared.roughness) and isinstance(prepared.scene.over, Track)
    in_patch = OF_SMOOTH if smooth else OF_TEXTURE
    wave = slowest(prepared.case.speed) / prepared.case.numerics.highest_frequency
    return max(closest, _rows(shape, min(shape.class_axes[0] / in_patch, wave / OF_WAVE)))


def _rows(shape: Geometry, length: float) -> int:
    return max(1, math.floor(length / shape.spacing[0] * (1.0 + 1e-9)))
