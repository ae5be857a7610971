"""How much more cells give way that a sharp edge crosses, from where it lies in them.

Beyond the edge of a deep pit nothing carries, and towards it the pressure of an elastic contact rises as
one over the root of the distance. Spread over all of a cell that the edge crosses, the force that its sound
part carries would be too large for what that sinks by, or be none: where the cell counts or not, a pit
grows by whole cells. The sound surface goes on in it here, and it sinks by p γ/E* more, at most to where
the rest of the cell carries, too: by the mean depth of the cell. So the force changes evenly as an edge
moves, and in the limit of a shallow step the heights are means over the cells.

γ makes the mean pressures at a straight edge, which are known in closed form, those that cells find, and
along the grid the force of a whole punch: ``benchmarks/cell_edges.py`` derives it. Over the width w of the
cell along the normal of the edge, it depends on the place of the cell's middle over w and, less so, on the
slant of the edge on the grid. Curves hold 1/(1 + γ/w): it falls to zero with the part of the cell that is
sound.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from asperity.arguments import Array, require
from asperity.kernels.batched import sunk
from asperity.surfaces.edges import FIRST, Edges
from asperity.written_numbers import rounded

if TYPE_CHECKING:
    from asperity.contact.halfspace import HalfSpace

KNOTS, SLANTS, PER_UNIT = 49, 7, 40
"""Values of a curve, from the place `FIRST` to that of a cell that is all before the edge, curves, and knots
to the width of a cell.

Curves are even in the root of the slant: the smaller over the larger of what the sides of the cell are along
the normal, 0 for an edge along the grid.
"""
LEAST = 1e-3
"""What is kept at least: softer cells carry nothing that counts."""
KEPT = np.array([
 [0.0000, 0.0000, 0.0142, 0.0293, 0.0446, 0.0603, 0.0764, 0.0928, 0.1096, 0.1267, 0.1443, 0.1622,
  0.1806, 0.1994, 0.2187, 0.2384, 0.2586, 0.2793, 0.3006, 0.3224, 0.3447, 0.3677, 0.3912, 0.4154,
  0.4403, 0.4658, 0.4921, 0.5191, 0.5469, 0.5755, 0.6050, 0.6354, 0.6667, 0.6989, 0.7322, 0.7666,
  0.8021, 0.8388, 0.8767, 0.9159, 0.9565, 0.9985, 1.0000, 1.0000, 1.0000, 1.0000, 1.0000, 1.0000,
  1.0000],
 [0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0663, 0.1301, 0.1718,
  0.2069, 0.2378, 0.2669, 0.2937, 0.3201, 0.3450, 0.3697, 0.3939, 0.4171, 0.4417, 0.4634, 0.4844,
  0.5055, 0.5271, 0.5491, 0.5717, 0.5950, 0.6192, 0.6443, 0.6705, 0.6980, 0.7268, 0.7570, 0.7862,
  0.8097, 0.8403, 0.8650, 0.8964, 0.9232, 0.9549, 0.9841, 1.0000, 1.0000, 1.0000, 1.0000, 1.0000,
  1.0000],
 [0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0201, 0.0573, 0.1054,
  0.1623, 0.2075, 0.2440, 0.2770, 0.3080, 0.3373, 0.3654, 0.3926, 0.4194, 0.4453, 0.4713, 0.4972,
  0.5228, 0.5482, 0.5735, 0.5988, 0.6242, 0.6497, 0.6756, 0.7018, 0.7285, 0.7558, 0.7837, 0.8120,
  0.8396, 0.8675, 0.8958, 0.9240, 0.9529, 0.9797, 1.0000, 1.0000, 1.0000, 1.0000, 1.0000, 1.0000,
  0.9783],
 [0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0117, 0.0334, 0.0618,
  0.0958, 0.1344, 0.1770, 0.2232, 0.2726, 0.3142, 0.3501, 0.3835, 0.4152, 0.4459, 0.4759, 0.5057,
  0.5354, 0.5648, 0.5940, 0.6231, 0.6518, 0.6804, 0.7086, 0.7366, 0.7644, 0.7918, 0.8189, 0.8456,
  0.8721, 0.8983, 0.9241, 0.9498, 0.9751, 0.9912, 0.9996, 1.0000, 1.0000, 0.9951, 0.9846, 0.9694,
  0.9492],
 [0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0090, 0.0257, 0.0477,
  0.0741, 0.1044, 0.1380, 0.1747, 0.2141, 0.2560, 0.3000, 0.3459, 0.3934, 0.4381, 0.4765, 0.5125,
  0.5474, 0.5811, 0.6138, 0.6456, 0.6766, 0.7069, 0.7366, 0.7658, 0.7945, 0.8229, 0.8510, 0.8791,
  0.9058, 0.9254, 0.9408, 0.9530, 0.9624, 0.9693, 0.9738, 0.9758, 0.9755, 0.9726, 0.9670, 0.9584,
  0.9467],
 [0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0080, 0.0229, 0.0426,
  0.0663, 0.0935, 0.1240, 0.1573, 0.1932, 0.2315, 0.2717, 0.3137, 0.3572, 0.4020, 0.4479, 0.4932,
  0.5375, 0.5804, 0.6219, 0.6615, 0.6993, 0.7348, 0.7679, 0.7983, 0.8259, 0.8504, 0.8716, 0.8897,
  0.9056, 0.9198, 0.9323, 0.9434, 0.9526, 0.9601, 0.9653, 0.9684, 0.9694, 0.9683, 0.9650, 0.9591,
  0.9505],
 [0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0078, 0.0223, 0.0415,
  0.0646, 0.0911, 0.1206, 0.1529, 0.1877, 0.2247, 0.2636, 0.3044, 0.3468, 0.3905, 0.4353, 0.4807,
  0.5259, 0.5705, 0.6142, 0.6564, 0.6968, 0.7348, 0.7701, 0.8022, 0.8306, 0.8550, 0.8748, 0.8904,
  0.9043, 0.9165, 0.9273, 0.9367, 0.9447, 0.9514, 0.9567, 0.9606, 0.9631, 0.9641, 0.9635, 0.9610,
  0.9566],
])  # fmt: skip
"""1/(1 + γ/w): slant after slant."""


YIELDING = 30.0
"""Sides of a cell over E* by which it sinks with the pressure beyond that at which its sound part flows."""
CARRYING = 0.5
"""Share of what is kept that flows no sooner: cells just beyond an edge carry in the place of others."""


class Softness(NamedTuple):
    """How cells at edges give way, as `kernels.edges` takes it; arrays of cells, zero far from edges."""

    softness: Array  # m/Pa: what they sink is that times the pressure
    drop: Array  # at most so much, m
    flow: Array  # pressure at which their sound part flows, Pa; infinite without hardness
    yielding: float  # what they sink more beyond that, m/Pa

    def sunk(self, pressure: Array) -> Array:
        """By how much cells sink more than others under a pressure, Pa; m."""
        return sunk(self.softness, self.drop, self.flow, self.yielding, pressure, np)

    def compliance(self, pressure: Array) -> Array:
        """Derivative of what cells sink by the pressure, m/Pa."""
        giving = self.softness + self.yielding * (pressure > self.flow)
        return np.where(self.sunk(pressure) < self.drop, giving, 0.0)

    def covered_cells(self, pressure: Array, shares: Array) -> float:
        """Number of cells in contact, by their sound shares but where all of the cell carries."""
        all_of_it = self.compliance(pressure) == 0.0
        return float(np.sum(np.where(all_of_it, 1.0, shares)[pressure > 0.0]))


def check_edges(edges: Edges, half_space: "HalfSpace", shape: tuple[int, int]) -> None:
    """Refuse edges that are on other cells than a surface of so many rows and lines, or on unfit ones."""
    what, remedy = "edges of a contact", "Lay them on the cells of the contact."
    own = edges.distance.shape
    given = half_space.spacing
    require(own == shape, what, f"shape {own}", f"shape {shape}", remedy)
    received, allowed = (
        f"cells of {rounded(1e6 * x, 6)} × {rounded(1e6 * y, 6)} µm" for x, y in (edges.spacing, given)
    )
    require(np.allclose(edges.spacing, given, rtol=1e-9, atol=0.0), what, received, allowed, remedy)
    remedy = "How much cells at edges give way is known for whole cells and a free boundary."
    fit = (("cells", half_space.cells, "whole"), ("boundary", half_space.boundary, "free"))
    for name, value, wanted in fit:
        require(value == wanted, f"{name} of a contact with edges", repr(value), repr(wanted), remedy)


def softness_at(edges: Edges, modulus: float, hardness: float | None) -> Softness:
    """Find how cells at edges give way on a half-space of a contact modulus E* and a hardness, Pa."""
    softness, flow = np.zeros((2, *edges.distance.shape))
    at = edges.crossed
    along, across = edges.sides(at)
    width = along + across
    kept = _kept(edges.places[at], np.minimum(along, across) / np.maximum(along, across))
    softness[at] = width / modulus * (1.0 / kept - 1.0)
    drop = np.where(softness > 0.0, edges.drop, 0.0)  # other cells do not sink
    if hardness is None:
        return Softness(softness, drop, np.full(flow.shape, np.inf), 0.0)
    flow[at] = hardness * np.maximum(edges.shares[at], CARRYING * kept)
    return Softness(softness, drop, flow, YIELDING * min(edges.spacing) / modulus)


def _kept(place: Array, slant: Array) -> Array:
    """Values between those of the curves."""
    x, y = (place - FIRST) * PER_UNIT, np.sqrt(slant) * (SLANTS - 1)
    i, j = (np.minimum(each.astype(int), most) for each, most in ((x, KNOTS - 2), (y, SLANTS - 2)))
    x, y = x - i, y - j
    one, other = ((1.0 - x) * KEPT[j + k, i] + x * KEPT[j + k, i + 1] for k in (0, 1))
    return np.maximum((1.0 - y) * one + y * other, LEAST)
