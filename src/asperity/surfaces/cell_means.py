"""Heights as means over the cells of a grid, where they are known at its points."""

import numpy as np

from asperity.arguments import Array
from asperity.surfaces.strip import Strip


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
    z = np.pad(heights, 1, mode="reflect", reflect_type="odd")
    beside = z[2:, 1:-1] + z[:-2, 1:-1] + z[1:-1, 2:] + z[1:-1, :-2]
    return heights + (beside - 4.0 * heights) / 24.0


class MeansOverCells:
    """A strip as means over its cells."""

    def __init__(self, strip: Strip) -> None:
        self.strip = strip
        self.shape = strip.shape
        self.spacing = strip.spacing

    def rows(self, first: int, stop: int) -> Array:
        """Means over the cells of the rows first … stop − 1, m."""
        begin = max(first - 1, 0)
        known = cell_means(self.strip.rows(begin, min(stop + 1, self.shape[0])))
        return known[first - begin : stop - begin]
