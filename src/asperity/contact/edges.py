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
import scipy

from asperity.arguments import Array
from asperity.kernels.batched import compliance, sunk
from asperity.surfaces.edges import FAR, FIRST, Edges

KNOTS, SLANTS, PER_UNIT = 49, 7, 40
"""Values of a curve, from the place `FIRST` to that of a cell that is all before the edge, curves, and knots
to the width of a cell.

Curves are even in the root of the slant: the smaller over the larger of what the sides of the cell are along
the normal, 0 for an edge along the grid.
"""
WHOLE = 0.4
"""Place from which on cells are next to whole: the drop of those beside tells how deep it is there."""
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
SOFTER = 4.0 / np.pi - 1.0
"""By how much of its softness a cell sinks more until its sound part flows."""
FLOWING = (0.5, 0.65, 2.0, 2.5), (0.48, 0.2, 0.2, 0.0)
"""Places, and widths over E* by which cells sink more under the hardness, until they flow: linear between.

Of those that an edge crosses, in plane strain (``benchmarks/cell_edges.py --flow``); beyond, of whole cells
that the border of the flow crosses, by trial. Less if the step is not deep beside a width times H/E*.
"""
CARRIED = 0.3
"""Share of what would be carried by a slope that begins at the edge, by trial: others are steps."""


class Softness(NamedTuple):
    """How cells at edges give way, as `kernels.edges` takes it; arrays of cells, zero far from edges."""

    softness: Array  # m/Pa: under a low pressure they sink by that times the pressure
    drop: Array  # to at most so much, m
    power: Array  # with which they come to that
    flow: Array  # pressure at which their sound part flows, Pa; infinite without hardness
    flowing: Array  # what they sink more until all of it does, m
    yielding: Array  # and beyond that, m/Pa

    def sunk(self, pressure: Array) -> Array:
        """By how much cells sink more than others under a pressure, Pa; m."""
        return sunk(self, pressure, np)

    def compliance(self, pressure: Array) -> Array:
        """Derivative of what cells sink by the pressure, m/Pa."""
        return compliance(self, pressure, np)

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
    kept = _kept(edges.places[at], np.minimum(along, across) / np.maximum(along, across))
    softness[at] = (along + across) / modulus * (1.0 / kept - 1.0)
    power = np.interp(edges.places, *POWERS)
    if hardness is None:
        none = np.zeros_like(softness)
        drop = np.where(softness > 0.0, edges.drop, FAR)
        return Softness(softness, drop, power, none + np.inf, none, none)
    flow = np.full(softness.shape, hardness)
    flow[at] *= np.maximum(edges.shares[at], CARRYING * kept)
    return _with_flow(edges, modulus, hardness, softness, power, flow)


def _with_flow(
    edges: Edges, modulus: float, hardness: float, softness: Array, power: Array, flow: Array
) -> Softness:
    """Let cells of a softness flow from a pressure on, Pa, and whole ones beside the edge as well.

    A slope that begins at the edge carries the part (1 - s) x/d of the rest of a cell, where s is its sound
    share, x what it sinks, and d its depth where that ends: 2 drop/(1 - s). So it flows later the more it
    has sunk, and sinks with the pressure beyond.
    """
    deepest = scipy.ndimage.maximum_filter(edges.drop, 5)
    near = edges.sound & (edges.places < FLOWING[0][-1]) & (deepest > 0.0)
    places, drop, deepest = edges.places[near], edges.drop[near], deepest[near]
    drop = np.where((places < WHOLE) & (drop > 0.0), drop, deepest)
    width = edges.sides(near).sum(axis=0) / modulus
    soft = np.maximum(softness[near], LEAST * width)
    carried = hardness * (1.0 - edges.shares[near]) ** 2 / (2.0 * drop)
    flows = np.minimum(hardness, flow[near] / np.maximum(1.0 - CARRIED * carried * soft, LEAST))
    singular = deepest / (deepest + hardness * width)
    flowing = (SOFTER * soft + np.interp(places, *FLOWING) * singular * width) * flows
    least = modulus / (YIELDING * min(edges.spacing))
    yielding = 1.0 / np.maximum(carried, least)

    def everywhere(values: Array, elsewhere: float) -> Array:
        field = np.full(softness.shape, elsewhere)
        field[near] = values
        return field

    return Softness(
        everywhere(soft, 0.0),
        everywhere(drop, FAR),
        power,
        everywhere(flows, np.inf),
        everywhere(flowing, 0.0),
        everywhere(yielding, 0.0),
    )


def _kept(place: Array, slant: Array) -> Array:
    """Values between those of the curves."""
    x = (place - FIRST) * PER_UNIT
    y = np.sqrt(slant) * (SLANTS - 1)
    i, j = (np.minimum(each.astype(int), most) for each, most in ((x, KNOTS - 2), (y, SLANTS - 2)))
    x = x - i
    y = y - j
    one, other = ((1.0 - x) * KEPT[j + k, i] + x * KEPT[j + k, i + 1] for k in (0, 1))
    return np.maximum((1.0 - y) * one + y * other, LEAST)
