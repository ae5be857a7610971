"""Cells that a sharp edge of a surface crosses: they give way by more than a pressure all over them would.

Beyond a deep edge nothing carries, and towards it the pressure rises as one over the root of the distance.
A cell then sinks by its softness times its pressure more than a cell among others, and by less as what lies
deeper carries, too: to its drop at most, the mean depth below the sound surface, where all of it carries. It
comes there the more sharply the larger a power is, by s = x/(1 + (x/drop)^power)^(1/power) with x what the
sound part alone would sink by.
Where surfaces flow at a hardness, the sound part of the cell does so at a pressure of its own. Until then it
sinks more by F φ(q), φ = 1 − (1 − q⁴)^(2/3), q the pressure over that, and from there on it yields some tens
of times as much as others. What such cells sink grows with their pressure, so that the energy stays convex,
and its least stays the solution.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from asperity.kernels.box import FAR, Box
from asperity.kernels.options import CALLED, INNER, compiled

SHARPEST = 1e-3
"""What is left of 1 − q⁴ where the derivative of φ is largest: at zero it has no bound."""


GIVEN = 6
"""Fields of `SoftCells` that are given for a block, as `contact.edges.Softness` has them: the first ones."""


class SoftCells(NamedTuple):
    """Softness of the cells of a block, and those of a box that have any, one after the other."""

    softness: NDArray  # (rows, ny), m/Pa, zero far from edges; (0, 0) where there is no edge at all
    drop: NDArray  # likewise, the most by which a cell sinks, m; above zero where there is a softness
    power: NDArray  # likewise, with which it comes to that
    flow: NDArray  # likewise, pressure at which its sound part flows, Pa
    flowing: NDArray  # likewise, what it sinks more until all of it does, m
    yielding: NDArray  # likewise, and beyond that, m/Pa
    row: NDArray  # (1,), row of these at which the window begins
    number: NDArray  # (1,), number of cells listed
    cell: NDArray  # their places in the box
    soft: NDArray  # m/Pa
    most: NDArray  # m
    powers: NDArray
    flows: NDArray  # Pa
    more: NDArray  # m
    yields: NDArray  # m/Pa
    sunk: NDArray  # by how much a cell has sunk, m, which is on the residual
    step: NDArray  # and what the last step added, m
    weight: NDArray  # of the cell where steps are preconditioned


def soft_cells(soft: tuple[NDArray, ...] | None, count: int, dtype: DTypeLike) -> SoftCells:
    """Make room for the edges of a block in a window of so many cells."""
    room = 0 if soft is None else count
    none = np.zeros((0, 0))
    softness, drop, power, flow, flowing, yielding = GIVEN * (none,) if soft is None else soft
    row, number = np.zeros((2, 1), dtype=np.int64)
    places: NDArray = np.zeros(room, dtype=np.int64)
    fields: NDArray = np.zeros((9, room), dtype=dtype)
    return SoftCells(softness, drop, power, flow, flowing, yielding, row, number, places, *fields)


@compiled(**INNER)
def by_itself(edges: SoftCells, k: int, pressure: float) -> float:
    """By how much the sound part of a cell at an edge would sink under a pressure, Pa, alone; m."""
    alone = edges.soft[k] * pressure
    if edges.more[k] > 0.0:
        flow = edges.flows[k]
        left = np.cbrt(1.0 - min(pressure / flow, 1.0) ** 4)
        alone += edges.more[k] * (1.0 - left * left) + edges.yields[k] * max(pressure - flow, 0.0)
    return alone


@compiled(**INNER)
def _gives(edges: SoftCells, k: int, pressure: float) -> float:
    """Derivative of `by_itself` by the pressure, m/Pa; where the cell begins to flow it is bounded."""
    if edges.more[k] == 0.0:
        return edges.soft[k]
    ratio = pressure / edges.flows[k]
    if ratio >= 1.0:
        return edges.soft[k] + edges.yields[k]
    rise = 8.0 / 3.0 * ratio**3 / np.cbrt(max(1.0 - ratio**4, SHARPEST))
    return edges.soft[k] + edges.more[k] / edges.flows[k] * rise


@compiled(**INNER)
def sunk_by(edges: SoftCells, k: int, pressure: float) -> float:
    """By how much a cell at an edge sinks under a pressure, Pa; m."""
    if pressure <= 0.0:
        return 0.0
    alone, power = by_itself(edges, k, pressure), edges.powers[k]
    if power == 3.0:  # as most cells have it, in half the time
        deep = alone / edges.most[k]
        return alone / np.cbrt(1.0 + deep * deep * deep)
    return alone * (1.0 + (alone / edges.most[k]) ** power) ** (-1.0 / power)


@compiled(**CALLED)
def find_edges(b: Box, edges: SoftCells, first: int, left: int) -> float:
    """List the cells of a box at edges, with what they have sunk; return the largest softness, m/Pa.

    The box begins at a row and column of the window.
    """
    found, softest = 0, 0.0
    if len(edges.softness):
        for i in range(b.nx):
            row = edges.row[0] + first + i
            for j in range(b.ny):
                soft = edges.softness[row, left + j]
                if soft > 0.0:
                    edges.cell[found] = i * b.pitch + j
                    edges.soft[found], edges.most[found] = soft, edges.drop[row, left + j]
                    edges.powers[found] = edges.power[row, left + j]
                    edges.flows[found] = min(edges.flow[row, left + j], FAR)
                    edges.more[found] = edges.flowing[row, left + j]
                    edges.yields[found] = edges.yielding[row, left + j]
                    edges.sunk[found] = sunk_by(edges, found, b.pressure[i * b.pitch + j])
                    softest = max(softest, soft + edges.yields[found])
                    found += 1
    edges.number[0] = found
    return softest


@compiled(**INNER)
def sink(b: Box, edges: SoftCells) -> None:
    """Add what cells at edges sink under the pressure to a residual that lacks it."""
    for k in range(edges.number[0]):
        q = edges.cell[k]
        edges.sunk[k] = sunk_by(edges, k, b.pressure[q])
        b.residual[q] += edges.sunk[k]


@compiled(**INNER)
def sink_by_step(b: Box, edges: SoftCells) -> None:
    """Add what the whole step lets cells at edges sink to its response."""
    for k in range(edges.number[0]):
        q = edges.cell[k]
        edges.step[k] = sunk_by(edges, k, b.pressure[q] + b.step[q]) - edges.sunk[k]
        b.response[q] += edges.step[k]


@compiled(**INNER)
def sink_by_share(b: Box, edges: SoftCells, share: float) -> None:
    """Correct the residual after a share of a step: what cells sink is no straight line of the pressure."""
    for k in range(edges.number[0]):
        q = edges.cell[k]
        now = sunk_by(edges, k, b.pressure[q])
        b.residual[q] += now - edges.sunk[k] - share * edges.step[k]
        edges.sunk[k] = now


@compiled(**INNER)
def weigh_edges(b: Box, edges: SoftCells, stiffness: float) -> None:
    """Find how much less than others, of a stiffness in Pa/m, cells at edges that give way shall be moved."""
    for k in range(edges.number[0]):
        softer, pressure = edges.soft[k], b.pressure[edges.cell[k]]
        if pressure > 0.0:
            alone = by_itself(edges, k, pressure)
            softer = _gives(edges, k, pressure) * edges.sunk[k] / alone
            softer /= 1.0 + (alone / edges.most[k]) ** edges.powers[k]
        edges.weight[k] = 1.0 / np.sqrt(1.0 + softer * stiffness)


@compiled(**INNER)
def weigh_masked(b: Box, edges: SoftCells) -> None:
    """Weigh what is masked."""
    margin = (len(b.masked) - len(b.residual)) // 2
    for k in range(edges.number[0]):
        b.masked[margin + edges.cell[k]] *= edges.weight[k]


@compiled(**INNER)
def weigh_target(b: Box, edges: SoftCells, target: NDArray) -> tuple[float, float]:
    """Weigh a preconditioned residual likewise; return what previous·target and its sum lose."""
    moved, total = 0.0, 0.0
    for k in range(edges.number[0]):
        q = edges.cell[k]
        lost = target[q] * (1.0 - edges.weight[k])
        target[q] -= lost
        moved += b.previous[q] * lost
        total += lost
    return moved, total
