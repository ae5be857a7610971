"""Heights of cells, where they are known at points of a grid: means over cells, and what textures press."""

import numpy as np

from asperity.arguments import Array
from asperity.surfaces.strip import Strip

PRESSED = 0.75
"""Share of the way from the middle of a cell to its mean at which a texture is pressed.

Cells are pressed evenly and give way on average. On means the force of a rough contact is too small, as the
gap that is left at the rims of small asperities is not that at the rim of a ball; on heights in the middle it
is too large. With nine cells in the half-width neither is left: ``benchmarks/cell_rims.py --choice``.
"""


def cell_means(heights: Array) -> Array:
    """Means of heights over the cells around the points where they are known, to the fourth order.

    By second differences: of a wave of n cells along an axis 1 - (1 - cos(2 pi/n))/12 is left, of four cells
    0.917 where the mean over a cell leaves 0.900. Beyond its ends a surface goes on as an odd one would.

    Parameters
    ----------
    heights : ndarray, shape (nx, ny)
        Heights, m.

    Returns
    -------
    ndarray, shape (nx, ny)
        Means, m.
    """
    return _towards_means(heights, 1.0)


def pressed_heights(texture: Array) -> Array:
    """Heights (nx, ny), m, that a texture known at points (nx, ny), m, has for covered cells: near means."""
    return _towards_means(texture, PRESSED)


def _towards_means(heights: Array, share: float) -> Array:
    z = np.pad(heights, 1, mode="reflect", reflect_type="odd")
    beside = z[2:, 1:-1] + z[:-2, 1:-1] + z[1:-1, 2:] + z[1:-1, :-2]
    return heights + share * (beside - 4.0 * heights) / 24.0


class PressedStrip:
    """A strip of texture as covered cells press it."""

    def __init__(self, strip: Strip) -> None:
        self.strip = strip
        self.shape = strip.shape
        self.spacing = strip.spacing

    def rows(self, first: int, stop: int) -> Array:
        """Heights of the cells of the rows first … stop − 1, m."""
        begin = max(first - 1, 0)
        known = pressed_heights(self.strip.rows(begin, min(stop + 1, self.shape[0])))
        return known[first - begin : stop - begin]
