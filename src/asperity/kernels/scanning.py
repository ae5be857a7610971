"""Contacts of a body moved along a surface, each started from those before it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.contact import CONVERGED, UNPREPARED, Room, solve_contact
from asperity.kernels.continuation import continue_pressure, correct_start, misfits
from asperity.kernels.influence import Influence
from asperity.kernels.options import CALLED, INNER, LOOP, compiled

TRUNCATED = 0.01
"""Share of the force on the window's edge from which a contact counts as cut off."""


class Block(NamedTuple):
    """Contacts to be solved, and what is known of them."""

    rows: NDArray[np.float64]  # (rows, ny), heights under the block, m
    body: NDArray[np.float64]  # (nx, ny), shape of the smooth body, m
    planes: NDArray[np.float64]  # (positions,), height of the plane from which approaches count, m
    approaches: NDArray[np.float64]  # (k,), increasing, m
    stride: int  # rows between positions
    load: float  # as in `contact.solve_contact`; if given, there is one approach, an upper estimate
    compliance: float  # of the bodies, as in `contact.solve_contact`
    hardness: float  # Pa
    rtol: float  # as in `contact.solve_contact`
    max_iterations: int  # of a contact
    room: Room  # from `contact.room`
    gap: NDArray[np.float64]  # (nx, ny), room for the gap at a position, m
    start: NDArray[np.float64]  # (nx, ny), room for the pressure that a solution starts from, Pa
    # (2, nx, ny), what the positions before let expect at the last approaches, Pa: even first, odd second
    expected: NDArray[np.float64]
    # (2, k, nx, ny), of the last two positions, Pa: even ones first, odd ones second
    pressures: NDArray[np.float64]
    solved: NDArray[np.int64]  # (k,), positions in contact one after the other up to the last
    totals: NDArray[np.float64]  # (k, positions), receives the sum of the pressure over the cells, Pa
    # (k, positions), receives the largest complementarity residual relative to the largest overlap
    residuals: NDArray[np.float64]
    # (k, positions), receives how far the approach is beyond the given one, m: at a load, or if bodies yield
    levels: NDArray[np.float64]
    counts: NDArray[np.int64]  # (4,), solutions, iterations, unconverged and truncated solutions so far


@compiled(**LOOP, nogil=True)
def solve_positions(
    known: Influence, b: Block, position: int, level: int, end: int
) -> tuple[int, int, int, int]:
    """Solve the contacts of a block from a position and approach, by number, to the position `end`.

    All contacts before are solved. Returns the contact at which it stopped, and the box nx × ny on which a
    convolution has to be prepared to go on; zeros at the end.
    """
    for m in range(position, end):
        touch = _set_gap(b, m)
        for i in range(level if m == position else 0, len(b.approaches)):
            if not b.approaches[i] > touch:
                b.solved[i] = 0
                continue
            _set_start(b, m, i, touch)
            pressure = b.pressures[m % 2, i]
            found = solve_contact(
                known, b.gap, b.approaches[i], b.load, b.compliance, b.start, b.hardness, b.rtol,
                b.max_iterations, b.room, pressure,
            )  # fmt: skip
            if found.status == UNPREPARED:
                return m, i, found.nx, found.ny
            b.solved[i] += 1
            b.totals[i, m], b.residuals[i, m], b.levels[i, m] = found.total, found.residual, found.level
            b.counts[0] += 1
            b.counts[1] += found.iterations
            b.counts[2] += found.status != CONVERGED
            b.counts[3] += _on_edge(pressure) > TRUNCATED * found.total
    return end, 0, 0, 0


@compiled(**INNER)
def _set_gap(b: Block, m: int) -> float:
    """Set the gap at a position; return the approach of first touch."""
    plane, gap, lowest = b.planes[m], b.gap, b.room.lowest
    for j in range(len(lowest)):
        lowest[j] = np.inf
    for i in range(gap.shape[0]):
        body, row, target = b.body[i], b.rows[m * b.stride + i], gap[i]
        for j in range(len(target)):
            target[j] = body[j] + plane - row[j]
            lowest[j] = min(lowest[j], target[j])
    touch = np.inf
    for j in range(len(lowest)):
        touch = min(touch, lowest[j])
    return touch


@compiled(**CALLED)
def _set_start(b: Block, m: int, i: int, touch: float) -> None:
    """Continue the pressure of the last positions or approaches, whichever was nearer one approach before.

    The approach before also tells by how much the positions alone mislead.
    """
    here, before, below = b.pressures[m % 2], b.pressures[(m + 1) % 2], 0
    # two approaches make a line, a third tells how far off the line was
    while below < min(i, 3) and b.approaches[i - 1 - below] > touch:
        below += 1
    along = b.solved[i] > 0 and b.stride < b.start.shape[0]  # pressures move with the asperities
    corrected = along and below > 0 and b.solved[i - 1] > 1
    across = below > 0 and not along
    expected, now = b.expected[(i + 1) % 2], b.expected[i % 2]
    if corrected and below == 3:
        by_position, by_approach = misfits(here[i - 1], expected, here[i - 2], here[i - 3], _share(b, i - 1))
        across = by_approach < by_position
    if along:
        share = 1.0 if b.solved[i] > 1 else 0.0
        continue_pressure(before[i], here[i], b.stride, share, b.hardness, now)
    if across:
        share = _share(b, i) if below > 1 else 0.0
        other = here[i - 2] if below > 1 else here[i - 1]
        continue_pressure(here[i - 1], other, np.int64(0), share, b.hardness, b.start)
    elif along:
        correct_start(now, expected, here[i - 1] if corrected else expected, b.hardness, b.start)
    else:  # nothing is known
        continue_pressure(here[i], here[i], np.int64(len(b.start)), 0.0, b.hardness, b.start)


@compiled(**INNER)
def _share(b: Block, i: int) -> float:
    """How far an approach is from the one before, in steps between that and the one before it."""
    return (b.approaches[i] - b.approaches[i - 1]) / (b.approaches[i - 1] - b.approaches[i - 2])


@compiled(**INNER)
def _on_edge(pressure: NDArray[np.float64]) -> float:
    """Sum of the pressure over the outermost cells."""
    nx, ny = pressure.shape
    total = 0.0
    for j in range(ny):
        total += pressure[0, j] + pressure[nx - 1, j]
    for i in range(1, nx - 1):
        total += pressure[i, 0] + pressure[i, ny - 1]
    return total
