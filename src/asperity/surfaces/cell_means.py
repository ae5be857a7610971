"""Heights of cells, where they are known at points of a grid: means over cells, and what textures press."""

import numpy as np

from asperity.arguments import Array
from asperity.surfaces.strip import PIECE, Fields, Strip, joined_pieces

SHORTEST = 8.0
"""Second differences of the shortest wave that a grid holds, over its heights: the fields of a chessboard."""


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
    return heights + _bend(heights) / 24.0


def pressed_heights(texture: Array) -> Array:
    """Heights (nx, ny), m, that a texture known at points (nx, ny), m, has for covered cells.

    Means over cells of waves that are long against them, heights in their middles of the shortest wave that
    the grid holds, and between by the second differences. Where bodies touch all over, means are pressed.
    Where they touch on spots of a cell or two, nothing beside a spot tells that it ends there, so that it
    counts as whole: by its mean it touches too late, by its height in the middle too early
    (``benchmarks/cell_rims.py --choice``).
    """
    bend = _bend(texture)
    return texture + (bend + _bend(bend) / SHORTEST) / 24.0


def _bend(heights: Array) -> Array:
    """Second differences along and across, added up; none across a border."""
    bend = np.zeros_like(heights)
    bend[1:-1] = np.diff(heights, 2, axis=0)
    bend[:, 1:-1] += np.diff(heights, 2, axis=1)
    return bend


class PressedStrip:
    """A strip of texture as covered cells press it, in pieces that are kept: states are scanned in turn."""

    def __init__(self, strip: Strip) -> None:
        self.strip = strip
        self.shape = strip.shape
        self.spacing = strip.spacing
        self._kept = Fields()

    def rows(self, first: int, stop: int) -> Array:
        """Heights of the cells of the rows first … stop − 1, m."""
        return joined_pieces((first, stop), self.shape[1], self._piece, self._pressed)

    def _piece(self, row: int) -> tuple[int, int]:
        begin = row // PIECE * PIECE
        return begin, min(begin + PIECE, self.shape[0])

    def _pressed(self, first: int, stop: int) -> Array:
        def make() -> Array:
            begin = max(first - 2, 0)
            known = pressed_heights(self.strip.rows(begin, min(stop + 2, self.shape[0])))
            return known[first - begin : stop - begin]

        return self._kept.rows(first, make)
