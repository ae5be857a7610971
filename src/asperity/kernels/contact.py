"""One contact at a prescribed approach, from the gap to the pressure."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.at_load import carry
from asperity.kernels.box import Box, box_room, cut, empty_box, paste
from asperity.kernels.influence import UNIT, Influence, convolution, is_prepared
from asperity.kernels.lanes import VECTOR_BYTES, lanes, width
from asperity.kernels.options import INNER, ONCE, compiled
from asperity.kernels.overlap import overlap_box
from asperity.kernels.projected_cg import Task, solve, survey, true_residual

MARGIN = 1
"""Cells left around pressure and overlap of what a solution starts from; what sticks out is solved again."""
NO_CONTACT, CONVERGED, ITERATION_LIMIT, STALLED, UNPREPARED = range(5)
"""How a solution can end."""
REACH = 1.3
"""How far beyond the expected approach a solution at a given load may go; more makes the box larger."""
NOTHING = 1e-12
"""Share of the pressure that the overlap lets expect below which a start is taken for zero."""
TRUSTED = 1e-10
"""Tolerance down to which a residual in double precision need not be computed anew: less is rounding."""


class Solution(NamedTuple):
    """How a contact was solved."""

    status: int  # one of the endings above; `UNPREPARED` if the convolution on nx × ny cells is missing
    iterations: int  # of conjugate gradients
    residual: float  # largest complementarity residual relative to the largest overlap
    total: float  # sum of the pressure over the cells, Pa
    level: float  # by how much the approach is beyond the given one, m: at a load, or if bodies yield
    nx: int  # box of the overlap, or the one that is not prepared, cells
    ny: int


class Room(NamedTuple):
    """Room for a solution, for one thread."""

    lowest: NDArray[np.float64]  # (ny,), for the lowest gap of each column
    outer: NDArray[np.float64]  # for the box of the overlap
    inner: NDArray[np.float64]  # for the box of the contact


def room(known: Influence, nx: int, ny: int) -> Room:
    """Make room for solutions on a grid of nx × ny cells."""
    mx, my = (int(known.lengths[-(-n // UNIT)]) for n in (nx, ny))
    dtype = known.spectra.dtype
    size = box_room(nx, ny, mx, my, width(dtype))
    return Room(np.empty(ny), np.empty(size, dtype), np.empty(size, dtype))


@compiled(**ONCE)
def solve_contact(
    known: Influence,
    gap: NDArray[np.float64],
    approach: float,
    load: float,
    compliance: float,
    start: NDArray[np.float64],
    hardness: float,
    rtol: float,
    max_iterations: int,
    room: Room,
    pressure: NDArray[np.float64],
) -> Solution:
    """Solve 0 ≤ p ≤ hardness ⟂ K p + gap − approach on a grid; no pressure acts outside of the overlap's box.

    Gap, m, at zero approach, pressures, Pa, (nx, ny); approach in m, positive closing. `load` is the sum of
    the pressure, Pa, less than the hardness over all that overlap; negative if the approach is given, which
    else is REACH times what is expected beyond first touch. Bodies that yield to the sum of the pressure, by
    a compliance in m/Pa, have the given approach without it; the compliance is zero at a given load. `start`
    is within the bounds, and zero on all of the overlap if nothing is known. `rtol` is the largest
    complementarity residual relative to the largest overlap. `pressure` receives the pressure, unless a
    convolution is missing.
    """
    largest, first, end, left, right = overlap_box(gap, approach, room.lowest)
    nx, ny = end - first, right - left
    if nx > 0 and not is_prepared(known, nx, ny):
        return Solution(UNPREPARED, 0, 0.0, 0.0, 0.0, nx, ny)
    if nx == 0:
        _clear(pressure)
        return Solution(NO_CONTACT, 0, 0.0, 0.0, 0.0, 0, 0)
    softest = known.softest + compliance * nx * ny
    task = Task(hardness, load, compliance, largest, rtol, softest, max_iterations)
    outer, everywhere = empty_box(nx, ny, room.outer), convolution(known, nx, ny)
    guessed = not _enter(outer, gap, approach, start, first, left, NOTHING * known.taps[0] * largest)
    if guessed:
        _guess(outer, largest, largest / REACH if load >= 0.0 else largest, known.taps[0])
    if load >= 0.0:
        carry(outer, hardness, load, known.taps[0])
    true_residual(everywhere, outer, compliance)
    if guessed and load < 0.0 and not _scale(outer, hardness):
        true_residual(everywhere, outer, compliance)
    worst, level, top, bottom, near, far = survey(outer, task)
    iterations: int = np.int64(0)  # type: ignore[assignment]  # a literal one would be compiled apart
    moving, last = True, (0, 0, 0, 0)
    while moving and worst > rtol * (largest + level) and iterations < max_iterations:
        row, rows = _grown(known, top, bottom, nx)
        column, columns = _grown(known, near, far, ny)
        if not is_prepared(known, rows, columns):
            return Solution(UNPREPARED, 0, 0.0, 0.0, 0.0, rows, columns)
        before, again = worst, last == (row, column, rows, columns)
        last = (row, column, rows, columns)
        part, b = rows < nx or columns < ny, outer
        if part:
            b = empty_box(rows, columns, room.inner)
            cut(outer, row, column, b)
        iterations, moving = solve(convolution(known, rows, columns), known.taps, b, task, iterations)
        if part:
            paste(b, outer, row, column)
        if part or not _recurs(outer, rtol):
            true_residual(everywhere, outer, compliance)
        worst, level, top, bottom, near, far = survey(outer, task)
        moving = moving and not (again and worst > 0.9 * before)  # else rounding hides what is left
    total = _leave(outer, pressure, first, left)
    status = CONVERGED
    if not worst <= rtol * (largest + level):
        status = STALLED if not moving else ITERATION_LIMIT
    return Solution(status, iterations, worst / (largest + level), total, level, nx, ny)


@compiled(**INNER)
def _enter(
    b: Box, gap: NDArray, approach: float, start: NDArray, first: int, left: int, least: float
) -> bool:
    """Set overlap and pressure, if it is not too small to matter; return whether there is any."""
    added = 0.0
    for i in range(b.nx):
        here, row, known = i * b.pitch, gap[first + i], start[first + i]
        for j in range(b.ny):
            b.overlap[here + j] = approach - row[left + j]
            p = known[left + j] if known[left + j] > least else 0.0
            b.pressure[here + j] = p
            added += p
    return added > 0.0


@compiled(**INNER)
def _guess(b: Box, largest: float, expected: float, stiffness: float) -> None:
    """Set a pressure of Hertzian form over the deeper half of the overlap that is expected."""
    edge = largest - 0.5 * expected
    for q in range(len(b.pressure)):
        b.pressure[q] = stiffness * np.sqrt(expected * max(b.overlap[q] - edge, 0.0))


@compiled(**INNER)
def _scale(b: Box, hardness: float) -> bool:
    """Scale a pressure and its residual to least energy; return whether the residual is still its own."""
    done, stored = 0.0, 0.0
    for q in range(len(b.pressure)):
        done += b.pressure[q] * b.overlap[q]
        stored += b.pressure[q] * (b.residual[q] + b.overlap[q])
    factor, capped = done / stored, 0
    for q in range(len(b.pressure)):
        p = factor * b.pressure[q]
        capped += p > hardness
        b.pressure[q] = min(p, hardness)
        b.residual[q] = factor * (b.residual[q] + b.overlap[q]) - b.overlap[q]
    return capped == 0


@compiled(**INNER)
def _recurs(b: Box, rtol: float) -> bool:
    """Whether a residual that was carried on from step to step is good enough."""
    return rtol >= TRUSTED and lanes(b.residual) == VECTOR_BYTES // 8


@compiled(**INNER)
def _leave(b: Box, pressure: NDArray[np.float64], first: int, left: int) -> float:
    """Copy the pressure; return its sum over the cells."""
    _clear(pressure)
    total = 0.0
    for i in range(b.nx):
        for j in range(b.ny):
            p = b.pressure[i * b.pitch + j]
            pressure[first + i, left + j] = p
            total += p
    return total


@compiled(**INNER)
def _clear(pressure: NDArray[np.float64]) -> None:
    for i in range(pressure.shape[0]):
        for j in range(pressure.shape[1]):
            pressure[i, j] = 0.0


@compiled(**INNER)
def _grown(known: Influence, first: int, end: int, n: int) -> tuple[int, int]:
    """Begin and length of a side with a margin, and with what transforms at the same cost, within n cells."""
    needed = end - first + 2 * MARGIN
    if needed >= n:
        return 0, n
    length = min(known.lengths[-(-needed // UNIT)], n)
    return min(max(0, first - (length - (end - first)) // 2), n - length), length
