"""How much more cells give way that a sharp edge crosses, from where it lies in them.

Beyond the edge of a deep pit nothing carries, and towards it the pressure of an elastic contact rises as
one over the root of the distance. Spread over all of a cell that the edge crosses, the force that its sound
part carries would be too large for what that sinks by, or be none: where the cell counts or not, a pit
grows by whole cells. The sound surface goes on in it here, and it sinks by x = p γ/E* more, and by less as
the rest of the cell carries, too: in all by x/(1 + (x/h)^n)^(1/n), up to the mean depth h of the cell. So
the force changes evenly as an edge moves, a slope is less of an edge the gentler it is, and in the limit of
a shallow step the heights are means over the cells.

γ makes the mean pressures at a straight edge, which are known in closed form, those that cells find, and
along the grid the force of a whole punch: ``benchmarks/cell_edges.py`` derives it. Over the width w of the
cell along the normal of the edge, it depends on the place of the cell's middle over w and, less so, on the
slant of the edge on the grid. Curves hold 1/(1 + γ/w): it falls to zero with the part of the cell that is
sound.
"""

from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from asperity.arguments import Array
from asperity.kernels.batched import compliance, sunk
from asperity.surfaces.edges import FAR, FIRST, Edges

KNOTS, SLANTS, PER_UNIT = 49, 7, 40
"""Values of a curve, from the place `FIRST` to that of a cell that is all before the edge, curves, and knots
to the width of a cell.

Curves are even in the root of the slant: the smaller over the larger of what the sides of the cell are along
the normal, 0 for an edge along the grid.
"""
LEAST = 1e-3
"""What is kept at least: softer cells carry nothing that counts."""
KEPT = np.loadtxt(Path(__file__).with_name("cell_edges.txt"), encoding="utf-8")
"""1/(1 + γ/w): slant after slant."""
POWERS = (FIRST, -0.35), (0.6, 3.0)
"""Places, and powers with which cells come to their drop: linear between.

A contact that goes on beyond an edge reaches at first only what is shallow of a cell there. From pits and
spalls of gentle slopes (``benchmarks/cell_edges.py --faults``).
"""
YIELDING = 30.0
"""Sides of a cell over E* by which it sinks with the pressure beyond that at which its sound part flows."""
CARRYING = 0.5
"""Share of what is kept that flows no sooner: cells just beyond an edge carry in the place of others."""


class Softness(NamedTuple):
    """How cells at edges give way, as `kernels.edges` takes it; arrays of cells, zero far from edges."""

    softness: Array  # m/Pa: under a low pressure they sink by that times the pressure
    drop: Array  # to at most so much, m
    power: Array  # with which they come to that
    flow: Array  # pressure at which their sound part flows, Pa; infinite without hardness
    yielding: float  # what they sink more beyond that, m/Pa

    def sunk(self, pressure: Array) -> Array:
        """By how much cells sink more than others under a pressure, Pa; m."""
        return sunk(*self, pressure, np)

    def compliance(self, pressure: Array) -> Array:
        """Derivative of what cells sink by the pressure, m/Pa."""
        return compliance(*self, pressure, np)

    def covered_cells(self, pressure: Array, shares: Array) -> float:
        """Number of cells in contact, by their sound shares and, as far as it carries, the rest of them."""
        lower = self.sunk(pressure) / self.drop
        return float(np.sum((shares + (1.0 - shares) * lower)[pressure > 0.0]))


@lru_cache(maxsize=1)  # a contact is solved with it, and looked at afterwards
def softness_at(edges: Edges, modulus: float, hardness: float | None) -> Softness:
    """Find how cells at edges give way on a half-space of a contact modulus E* and a hardness, Pa."""
    softness = np.zeros(edges.distance.shape)
    at = edges.crossed & (edges.drop > 0.0)
    along, across = edges.sides(at)
    width = along + across
    kept = _kept(edges.places[at], np.minimum(along, across) / np.maximum(along, across))
    softness[at] = width / modulus * (1.0 / kept - 1.0)
    gives_way = softness > 0.0
    drop = np.where(gives_way, edges.drop, FAR)
    power = np.interp(edges.places, *POWERS)
    flow = np.full(drop.shape, np.inf)
    if hardness is None:
        return Softness(softness, drop, power, flow, 0.0)
    flow[at] = hardness * np.maximum(edges.shares[at], CARRYING * kept)
    flow[~gives_way] = np.inf
    return Softness(softness, drop, power, flow, YIELDING * min(edges.spacing) / modulus)


def _kept(place: Array, slant: Array) -> Array:
    """Values between those of the curves."""
    x = (place - FIRST) * PER_UNIT
    y = np.sqrt(slant) * (SLANTS - 1)
    i, j = (np.minimum(each.astype(int), most) for each, most in ((x, KNOTS - 2), (y, SLANTS - 2)))
    x = x - i
    y = y - j
    one, other = ((1.0 - x) * KEPT[j + k, i] + x * KEPT[j + k, i + 1] for k in (0, 1))
    return np.maximum((1.0 - y) * one + y * other, LEAST)
