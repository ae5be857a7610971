"""Positions of the scan of a raceway, as far apart as patch and waves let them be, and forces between."""

import numpy as np

from asperity.arguments import Array
from asperity.kernels.curves import OVERLAP, splines_along
from asperity.scenarios.rim_cells import SMOOTH
from asperity.scenarios.scanned_positions import OF_TEXTURE, OF_WAVE

OF_ROUGH = OF_TEXTURE, OF_WAVE
"""Positions in a half axis, at least, and in the shortest wave that is looked at."""
OF_SMOOTH, OF_SMOOTHEST = (2.5, 3.0), (1.5, 1.8)
"""Likewise where forces follow the average under the patch between positions.

These are for what is of second order alone, which grows with the square of the roughness.
"""
SMOOTHEST = 0.02
"""Rms height in approaches up to which so few do."""
ALIKE = 0.5
"""Least static load of a ball over the largest one from which so few do: patches of others are shorter.

Under a radial load a bearing was 0.4 dB rms off where splines ran through the forces themselves.
"""


def follows_average(roughness: float, least_share: float) -> bool:
    """Whether forces follow the average under the patch between positions: where it is smooth within that.

    The roughness is in approaches; the least static load of a ball is a share of the largest one.
    """
    return roughness <= SMOOTH and least_share >= ALIKE


def positions_apart(half_axis: float, shortest: float, roughness: float, *, follows: bool) -> float:
    """How far apart positions may be on a sound raceway, m, by half axis and shortest wave, m.

    The roughness is in approaches. Where forces follow the average under the patch between positions, levels
    are those of a position in every row within 0.1 dB, on waves from 1.6 half axes on.
    """
    even = OF_SMOOTHEST if roughness <= SMOOTHEST else OF_SMOOTH
    in_axis, in_wave = even if follows else OF_ROUGH
    return min(half_axis / in_axis, shortest / in_wave)


def forces_between(scanned: Array, followed: Array) -> Array:
    """Forces (states, positions), N, once around, of those scanned at the first of every few positions.

    They are those that are about `followed` at all positions, N, with splines through what these miss.
    """
    step = followed.shape[1] // scanned.shape[1]
    missed = np.pad(scanned - followed[:, ::step], ((0, 0), (OVERLAP, OVERLAP)), "wrap")
    places = OVERLAP + np.arange(followed.shape[1]) / step
    return np.maximum(followed + splines_along(missed, places).T, 0.0)
