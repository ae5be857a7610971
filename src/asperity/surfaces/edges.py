"""Sharp edges of a surface on a grid: how far cells are from them, and which they cross."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from asperity.arguments import Array, Flags, finite_array, require, two_lengths

REACH = 1.5
"""Distance from an edge, over the sides of a cell together, up to which it has to be known."""
FIRST = -0.7
"""Place, in widths of a cell, of the first beyond an edge that takes a part of what those before it carry."""
FAR = 1.0
"""Distance, m, where there is no edge."""


@dataclass(frozen=True, eq=False)
class Edges:
    """Sharp edges on a grid of heights, as the outline of a pit has.

    In a cell that an edge crosses only the part before the edge carries, so that where the edge lies within
    the cell matters. The heights there are those of the sound surface, as in cells just beyond it.

    Parameters
    ----------
    distance : (rows, lines) array
        Of the middles of cells from the next edge, m: positive where the surface is sound. What is farther
        than `REACH` sides of a cell may as well be `FAR`.
    normal : (rows, lines) array
        Part along the rows of a unit vector across that edge, from 0 to 1.
    drop : (rows, lines) array
        Mean depth of the cells that are crossed below the sound surface, m.
    spacing : (float, float)
        Distances (dx, dy), m, of rows and lines.

    Raises
    ------
    InputError
        If shapes do not fit or values are not finite.
    """

    distance: Array
    normal: Array
    drop: Array
    spacing: tuple[float, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "spacing", two_lengths("spacing of edges", self.spacing))
        distance = finite_array("distance from edges", self.distance, "finite lengths, m", shape=(None, None))
        object.__setattr__(self, "distance", distance)
        for name, allowed, most in (("normal", "numbers from 0 to 1", 1.0), ("drop", "depths, m", np.inf)):
            what = f"{name} of edges"
            values = finite_array(what, getattr(self, name), allowed, shape=distance.shape)
            least = float(values.min(initial=0.0))
            largest = float(values.max(initial=0.0))
            require(least >= 0.0 and largest <= most, what, f"{least:.4g} to {largest:.4g}", allowed)
            object.__setattr__(self, name, values)

    def sides(self, cells: Flags) -> Array:
        """What the two sides of some cells are along the normal (2, ...), m: their width, added up."""
        along, across = self.spacing
        normal = self.normal[cells]
        return np.stack([normal * along, np.sqrt(np.maximum(1.0 - normal**2, 0.0)) * across])

    @cached_property
    def places(self) -> Array:
        """Distances of the middles of cells from the edge over their width along its normal (rows, lines)."""
        found = self.distance / self.spacing[1]  # that of an edge along the rows, and where there is none
        tilted = self.normal > 0.0
        found[tilted] = self.distance[tilted] / self.sides(tilted).sum(axis=0)
        return found

    @cached_property
    def sound(self) -> Flags:
        """Cells with the heights of the sound surface, though they may lie beyond the edge in part."""
        return self.places > FIRST

    @cached_property
    def crossed(self) -> Flags:
        """Those of them that give way more than others, because an edge crosses them or is close."""
        return self.sound & (self.places < 0.5)

    @cached_property
    def shares(self) -> Array:
        """Shares of cells (rows, lines) that lie before the edge, as if that were straight."""
        found = np.asarray(self.distance > 0.0, dtype=float)
        at = np.abs(self.places) < 0.5
        near, far = 0.5 * np.sort(self.sides(at), axis=0)
        near = np.maximum(near, 1e-6 * far)
        share = np.zeros(far.shape)
        for sign, end in ((1, far + near), (-1, far - near), (-1, near - far), (1, -far - near)):
            share += sign * np.maximum(self.distance[at] + end, 0.0) ** 2
        found[at] = share / (8.0 * near * far)
        return found

    def rearranged(self, rearrange: Callable[[Array], Array]) -> "Edges":
        """Edges with all fields rearranged alike, as some rows of them are."""
        distance, normal, drop = (rearrange(each) for each in (self.distance, self.normal, self.drop))
        return Edges(distance, normal, drop, self.spacing)

    def with_others(self, others: "Edges") -> "Edges":
        """Edges of two surfaces that meet: in each cell the next one; what is lost adds up."""
        own = self.distance < others.distance
        distance, normal = (
            np.where(own, *each) for each in ((self.distance, others.distance), (self.normal, others.normal))
        )
        return Edges(distance, normal, self.drop + others.drop, self.spacing)
