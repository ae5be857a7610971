"""Every second row of heights, for cells that are two rows long: without the waves that these cannot hold."""

import numpy as np

from asperity.arguments import Array
from asperity.surfaces.strip import Strip

BESIDE = np.array([150.0, -25.0, 3.0]) / 512.0
"""Share of the first, third and fifth row on either side; a half is a row's own."""
REACH = 5
"""Rows on either side that a row is made of."""


def every_second(heights: Array, first: int, count: int) -> Array:
    """Heights (count, ny), m, of every second row of heights (rows, ny), m, from a row on.

    Half of each is its own, half what its neighbours on either side say of it by polynomials of the fifth
    degree: of a wave of n rows 0.992 is left with n = 10, a half with 4, and 0.008 with 2.5, which every
    second row would show as one of ten. Rows at either end that are needed: `REACH`.
    """
    stop = first + 2 * count - 1
    rows = 0.5 * heights[first:stop:2]
    for place, share in enumerate(BESIDE):
        beside = 2 * place + 1
        rows += share * heights[first - beside : stop - beside : 2]
        rows += share * heights[first + beside : stop + beside : 2]
    return rows


class SecondRows:
    """A strip with every second row of another one, from one of its first two on."""

    def __init__(self, strip: Strip, first: int) -> None:
        self.strip = strip
        self.first = first
        rows, lines = strip.shape
        self.shape = (rows - first + 1) // 2, lines
        self.spacing = 2.0 * strip.spacing[0], strip.spacing[1]

    def rows(self, first: int, stop: int) -> Array:
        """Heights of the rows first … stop − 1, m; beyond its ends the other one goes on as an odd one."""
        begin = self.first + 2 * first - REACH
        end = self.first + 2 * stop - 1 + REACH
        held = max(begin, 0), min(end, self.strip.shape[0])
        known = self.strip.rows(*held)
        beyond = [(held[0] - begin, end - held[1]), (0, 0)]
        closed = np.pad(known, beyond, mode="reflect", reflect_type="odd")
        return every_second(closed, REACH, stop - first)
