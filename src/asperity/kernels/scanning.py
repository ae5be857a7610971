"""Contacts of a body moved along a surface, each from those before it: from the gap to the pressure."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.at_load import carry
from asperity.kernels.box import Box, box_room, cut, empty_box, overlap_box, paste
from asperity.kernels.edges import SoftCells, find_edges, soft_cells
from asperity.kernels.influence import UNIT, Influence, convolution, is_prepared, whole_vectors
from asperity.kernels.lanes import VECTOR_BYTES, aligned, lanes, width
from asperity.kernels.options import CALLED, INNER, LOOP, ONCE, REASSOCIATE, compiled
from asperity.kernels.projected_cg import Task, carried_and_lacked, solve, survey, true_residual
from asperity.kernels.rims import (
    Rims,
    lay_bare,
    move_rims,
    rims,
    set_rims,
    take_off,
    without_rims,
)

TRUNCATED = 0.01
"""Share of the force on the window's edge from which a contact counts as cut off."""
MARGIN = 1
"""Cells left around pressure and overlap of what a solution starts from; what sticks out is solved again."""
REACH = 1.3
"""How far beyond the expected approach a solution at a given load may go; more makes the box larger."""
NOTHING = 1e-12
"""Share of the pressure that the overlap lets expect below which a start is taken for zero."""
TRUSTED, TRUSTED_SINGLE = 1e-10, 1e-5
"""Tolerances down to which a residual need not be computed anew, in double and in single precision.

Less is rounding."""
LOOSE = 6.0
"""Residual that is enough where the force has settled, over that which is asked for else.

Errors of forces are then no larger than those of pressures that meet the tolerance."""
PAYS = 1.25
"""Work on a box over that on a smaller one, from which on it pays to cut that out of it."""


Ends = tuple[int, int, int, int]
"""First and end row, first and end column of a box in the window."""


class Room(NamedTuple):
    """Room for a solution, for one thread."""

    lowest: NDArray  # (ny,), for the lowest gap of each column
    outer: NDArray  # for the box of the overlap
    inner: NDArray  # for the box of the contact
    rims: Rims | None  # for cells that are covered in part; None where they are whole
    edges: SoftCells  # for cells at sharp edges


class Block(NamedTuple):
    """Contacts to be solved, and what is known of them."""

    rows: NDArray  # (rows, ny), heights under the block, m
    body: NDArray  # (nx, ny), shape of the smooth body, m
    planes: NDArray  # (positions,), height of the plane from which approaches count, m
    approaches: NDArray  # (k,), increasing, m
    stride: int  # rows between positions
    load: float  # sum of the pressure, Pa, as in `_solve_contact`; negative where approaches are given
    compliance: float  # of bodies that yield to the sum of the pressure, m/Pa; zero at a load
    hardness: float  # Pa
    rtol: float  # largest complementarity residual relative to the largest overlap
    loose: float  # likewise where the force has settled; zero if pressures are asked for, not forces alone
    max_iterations: int  # of a contact
    room: Room  # from `room`
    gap: NDArray  # (nx, ny), room for the gap at a position, m
    start: NDArray  # (nx, ny), room for the pressure that a solution starts from, Pa
    # (2, nx, ny), what the positions before let expect at the last approaches, Pa: even first, odd second
    expected: NDArray
    # (2, k, nx, ny), of the last two positions, Pa: even ones first, odd ones second
    pressures: NDArray
    rise: NDArray  # (nx, ny), room for about what an approach adds to the pressure, Pa/m
    rises: NDArray  # (k, nx, ny), what it was found to add at the last position, Pa/m
    solved: NDArray  # (k,), positions in contact one after the other up to the last
    totals: NDArray  # (k, positions), receives the sum of the pressure over the cells, Pa
    # (k, positions), receives the largest complementarity residual relative to the largest overlap
    residuals: NDArray
    # (k, positions), receives how far the approach is beyond the given one, m: at a load, or if bodies yield
    levels: NDArray
    counts: NDArray  # (4,), solutions, iterations, unconverged and truncated solutions so far


def room(
    known: Influence,
    nx: int,
    ny: int,
    sides: tuple[float, float] | None = None,
    soft: tuple[NDArray, ...] | None = None,
) -> Room:
    """Make room for solutions on a grid of nx × ny cells, with sides over E*, m/Pa, if covered in part.

    What is `soft` at edges is given for all rows of a block, as the first fields of `SoftCells`.
    """
    mx, my = (int(known.lengths[-(-n // UNIT)]) for n in (nx, ny))
    dtype = known.spectra.dtype
    size = box_room(nx, ny, mx, my, width(dtype))
    covered = (
        None if sides is None else rims(*sides, size // 10, dtype)
    )  # a field is less than a tenth of a box
    edges = soft_cells(soft, nx * ny, dtype)
    return Room(np.empty(ny), aligned(size, dtype), aligned(size, dtype), covered, edges)


class Solution(NamedTuple):
    """How a contact was solved."""

    prepared: bool  # whether no convolution was missing, on nx × ny cells
    converged: bool  # whether the tolerance was met
    iterations: int  # of conjugate gradients
    residual: float  # largest complementarity residual relative to the largest overlap
    total: float  # sum of the pressure over the cells, Pa
    level: float  # by how much the approach is beyond the given one, m: at a load, or if bodies yield
    nx: int  # box of the overlap, or the one that is not prepared, cells
    ny: int


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
            found = solve_contact(known, b, b.approaches[i], pressure, b.rises[i])
            if not found.prepared:
                return m, i, found.nx, found.ny
            b.solved[i] += 1
            b.totals[i, m] = found.total
            b.residuals[i, m] = found.residual
            b.levels[i, m] = found.level
            b.counts[0] += 1
            b.counts[1] += found.iterations
            b.counts[2] += not found.converged
            b.counts[3] += _on_edge(pressure) > TRUNCATED * found.total
    return end, 0, 0, 0


@compiled(**INNER)
def _set_gap(b: Block, m: int) -> float:
    """Set the gap at a position; return the approach of first touch."""
    plane = b.planes[m]
    gap = b.gap
    lowest = b.room.lowest
    b.room.edges.row[0] = m * b.stride
    for j in range(len(lowest)):
        lowest[j] = np.inf
    for i in range(gap.shape[0]):
        body = b.body[i]
        row = b.rows[m * b.stride + i]
        target = gap[i]
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
    here = b.pressures[m % 2]
    before = b.pressures[(m + 1) % 2]
    below = 0
    # two approaches make a line, a third tells how far off the line was
    while below < min(i, 3) and b.approaches[i - 1 - below] > touch:
        below += 1
    along = b.solved[i] > 0 and b.stride < b.start.shape[0]
    corrected = along and below > 0 and b.solved[i - 1] > 1
    across = below > 0 and not along
    expected = b.expected[(i + 1) % 2]
    now = b.expected[i % 2]
    if corrected and below == 3:
        by_position, by_approach = misfits(here[i - 1], expected, here[i - 2], here[i - 3], _share(b, i - 1))
        across = by_approach < by_position
    moved = b.stride if along else 0 if across else len(b.start)
    if along and b.solved[i] > 1:
        moved = continue_rolling(before[i], here[i], b.stride, b.stride, b.hardness, now)
    elif along:
        continue_pressure(before[i], here[i], b.stride, 0.0, b.hardness, now)
    if b.loose > 0.0:
        known = b.rises[i - 1 if across else i]
        continue_pressure(known, known, moved, 0.0, np.inf, b.rise)
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
def _on_edge(pressure: NDArray) -> float:
    """Sum of the pressure over the outermost cells."""
    nx, ny = pressure.shape
    total = 0.0
    for j in range(ny):
        total += pressure[0, j] + pressure[nx - 1, j]
    for i in range(1, nx - 1):
        total += pressure[i, 0] + pressure[i, ny - 1]
    return total


@compiled(**ONCE)
def solve_contact(known: Influence, b: Block, approach: float, pressure: NDArray, rise: NDArray) -> Solution:
    """Solve 0 ≤ p ≤ hardness ⟂ K p + gap − approach on a grid; no pressure acts outside of the overlap's box.

    Gap, start and all else are those of a block; approach in m, positive closing. The load is less than the
    hardness over all that overlap; the approach then is REACH times what is expected beyond first touch.
    Bodies that yield have the given approach without their compliance. The start is within the bounds, and
    zero on all of the overlap if nothing is known. `pressure` receives the pressure, unless a convolution is
    missing, and so does `rise` what an approach adds to it, if only the force has to be exact.

    Cells that are covered in part carry beside that box as well, where those at its ends do: one that
    overlaps in part may not in the mean, but alone it carries nothing.
    """
    largest, first, end, left, right = overlap_box(b.gap, approach, b.room.lowest)
    ends = first, end, left, right
    beside = _cells_beside(known, b.room.rims, b.start, ends)
    iterations: int = np.int64(0)  # type: ignore[assignment]  # a literal one would be compiled apart
    while True:
        found = _solve_within(known, b, approach, largest, _widened(ends, beside, b.gap), pressure, rise)
        iterations += found.iterations
        if beside or not found.prepared or not _cells_beside(known, b.room.rims, pressure, ends):
            return Solution(
                found.prepared, found.converged, iterations, found.residual, found.total, found.level,
                found.nx, found.ny,
            )  # fmt: skip
        beside = 1
        for i in range(b.start.shape[0]):
            for j in range(b.start.shape[1]):
                b.start[i, j], b.rise[i, j] = pressure[i, j], rise[i, j]


@compiled(**INNER)
def _cells_beside(known: Influence, rims: Rims | None, pressure: NDArray, ends: Ends) -> int:
    """Cells beside a box to solve on: one where cells at its ends carry, or where a convolution has room."""
    if rims is None:
        return 0
    wide = _widened(ends, 1, pressure)
    first, end, left, right = ends
    if known.lengths[-(-(end - first) // UNIT)] == known.lengths[-(-(wide[1] - wide[0]) // UNIT)]:
        return 1
    total = 0.0
    for j in range(left, right):
        total += pressure[first, j] * (wide[0] < first) + pressure[end - 1, j] * (wide[1] > end)
    for i in range(first, end):
        total += pressure[i, left] * (wide[2] < left) + pressure[i, right - 1] * (wide[3] > right)
    return 1 if total > 0.0 else 0


@compiled(**INNER)
def _widened(ends: Ends, cells: int, gap: NDArray) -> Ends:
    """Widen a box by so many cells on every side, as far as the window goes."""
    first, end, left, right = ends
    nx, ny = gap.shape
    return max(first - cells, 0), min(end + cells, nx), max(left - cells, 0), min(right + cells, ny)


@compiled(**ONCE)
def _solve_within(
    known: Influence, b: Block, approach: float, largest: float, ends: Ends, pressure: NDArray, rise: NDArray
) -> Solution:
    """Solve a contact as `solve_contact` does, on a box whose largest overlap is given, m."""
    hardness = b.hardness
    load = b.load
    first, end, left, right = ends
    nx, ny = end - first, right - left
    if not is_prepared(known, nx, ny):
        return Solution(False, False, 0, 0.0, 0.0, 0.0, nx, ny)
    outer = empty_box(nx, ny, b.room.outer)
    everywhere = convolution(known, nx, ny)
    edges = b.room.edges
    softest = known.softest + b.compliance * nx * ny + find_edges(outer, edges, first, left)
    guessed = not _enter(outer, b.gap, approach, b.start, first, left, NOTHING * known.taps[0] * largest)
    loose = min(b.loose, b.rtol) if guessed else b.loose  # what follows starts from it
    task = Task(hardness, load, b.compliance, largest, b.rtol, loose, softest, b.max_iterations)
    if guessed:
        _guess(outer, largest, largest / REACH if load >= 0.0 else largest, known.taps[0])
    elif b.loose > 0.0:
        _enter_rise(outer, b.rise, first, left, hardness)
    if load >= 0.0:
        carry(outer, hardness, load, known.taps[0])
    true_residual(everywhere, outer, task, edges)
    if guessed and load < 0.0 and (not _scale(outer, hardness) or edges.number[0]):
        true_residual(everywhere, outer, task, edges)
    without_rims(outer, b.room.rims)
    set_rims(outer, b.room.rims, 0.0, known.taps[0], hardness)
    worst, level, top, bottom, near, far = survey(outer, task, b.room.rims)
    iterations: int = np.int64(0)  # type: ignore[assignment]  # a literal one would be compiled apart
    moving = True
    asked = b.rtol
    last = (0, 0, 0, 0)
    while moving and worst > asked * (largest + level) and iterations < b.max_iterations:
        row, rows, column, columns = _part(known, nx, ny, top, bottom, near, far)
        part = rows < nx or columns < ny
        if not is_prepared(known, rows, columns):
            return Solution(False, False, 0, 0.0, 0.0, 0.0, rows, columns)
        before = worst
        again = last == (row, column, rows, columns)
        last = (row, column, rows, columns)
        inner = outer
        if part:
            inner = empty_box(rows, columns, b.room.inner)
            cut(outer, row, column, inner)
            move_rims(inner, b.room.rims, outer.pitch, row, column)
            lay_bare(inner, b.room.rims)
            find_edges(inner, edges, first + row, left + column)
        iterations, moving, settled = solve(
            convolution(known, rows, columns), known.taps, inner, task, iterations, b.room.rims, edges
        )
        asked = loose if settled else b.rtol
        if part:
            paste(inner, outer, row, column)
            move_rims(outer, b.room.rims, inner.pitch, -row, -column)
            find_edges(outer, edges, first, left)
        if part or not _recurs(outer, b.rtol):
            true_residual(everywhere, outer, task, edges)
            take_off(outer, b.room.rims)
        worst, level, top, bottom, near, far = survey(outer, task, b.room.rims)
        moving = moving and not (again and worst > 0.9 * before)  # else rounding hides what is left
    total = _leave(outer, outer.pressure, pressure, first, left)
    if b.loose > 0.0:
        total += carried_and_lacked(outer)[1]
        _leave(outer, outer.unit, rise, first, left)
    converged = worst <= asked * (largest + level)
    return Solution(True, converged, iterations, worst / (largest + level), total, level, nx, ny)


@compiled(**INNER)
def _enter(
    b: Box, gap: NDArray, approach: float, start: NDArray, first: int, left: int, least: float
) -> bool:
    """Set overlap and pressure, if it is not too small to matter; return whether there is any."""
    added = 0.0
    for i in range(b.nx):
        row = slice(i * b.pitch, i * b.pitch + b.ny)
        overlap, pressure = b.overlap[row], b.pressure[row]
        under = gap[first + i, left:]
        known = start[first + i, left:]
        for j in range(len(overlap)):
            overlap[j] = approach - under[j]
            p = known[j] if known[j] > least else 0.0
            pressure[j] = p
            added += p
    return added > 0.0


@compiled(**INNER)
def _enter_rise(b: Box, rise: NDArray, first: int, left: int, hardness: float) -> None:
    """Set what an approach adds to the pressure of the cells between the bounds."""
    for i in range(b.nx):
        row = slice(i * b.pitch, i * b.pitch + b.ny)
        pressure, unit = b.pressure[row], b.unit[row]
        known = rise[first + i, left:]
        for j in range(len(unit)):
            unit[j] = known[j] if 0.0 < pressure[j] < hardness else 0.0


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
    factor = done / stored
    capped = 0
    for q in range(len(b.pressure)):
        p = factor * b.pressure[q]
        capped += p > hardness
        b.pressure[q] = min(p, hardness)
        b.residual[q] = factor * (b.residual[q] + b.overlap[q]) - b.overlap[q]
    return capped == 0


@compiled(**INNER)
def _recurs(b: Box, rtol: float) -> bool:
    """Whether a residual that was carried on from step to step is good enough."""
    return rtol >= (TRUSTED if lanes(b.residual) == VECTOR_BYTES // 8 else TRUSTED_SINGLE)


@compiled(**INNER)
def _work(known: Influence, nx: int, ny: int) -> float:
    """Work of a convolution on a box: the numbers that it transforms along, and those across."""
    mx, my = known.lengths[-(-nx // UNIT)], known.lengths[-(-ny // UNIT)]
    return float(whole_vectors(mx, lanes(known.spectra)) * (ny if my <= known.summed else my))


@compiled(**INNER)
def _leave(b: Box, field: NDArray, target: NDArray, first: int, left: int) -> float:
    """Copy a field of a box to the window, which is zero else; return its sum over the cells."""
    for i in range(target.shape[0]):
        row = target[i]
        for j in range(len(row)):
            row[j] = 0.0
    total = 0.0
    for i in range(b.nx):
        known = field[i * b.pitch : i * b.pitch + b.ny]
        row = target[first + i, left:]
        for j in range(len(known)):
            row[j] = known[j]
            total += known[j]
    return total


@compiled(**INNER)
def _with_margin(first: int, end: int, n: int) -> tuple[int, int]:
    """Begin and length of a side with a margin, within n cells."""
    begin = max(first - MARGIN, 0)
    return begin, min(end + MARGIN, n) - begin


@compiled(**INNER)
def _part(
    known: Influence, nx: int, ny: int, top: int, bottom: int, near: int, far: int
) -> tuple[int, int, int, int]:
    """First row, rows, first column and columns of the part to solve on; all of them if less does not pay."""
    row, rows = _with_margin(top, bottom, nx)
    column, columns = _with_margin(near, far, ny)
    if _work(known, nx, ny) < PAYS * _work(known, rows, columns):
        return 0, nx, 0, ny
    return row, rows, column, columns


# --- pressures to start from, continued from those of the last contacts


@compiled(**CALLED, nogil=True)
def continue_pressure(
    last: NDArray, before: NDArray, stride: int, share: float, cap: float, start: NDArray
) -> None:
    """Continue the pressures of two contacts to a third, straight at every point of the surface.

    Pressures (nx, ny), Pa. The window moves by `stride` rows from one contact to the next; `share` says how
    far to go on, in steps from `before` to `last`: at zero `before` does not matter. No pressure exceeds
    `cap`.
    """
    nx, ny = last.shape
    for i in range(nx - stride):
        known = share if i + 2 * stride < nx else 0.0
        p = last[i + stride]
        q = before[min(i + 2 * stride, nx - 1)]
        for j in range(ny):
            start[i, j] = min(max(p[j] + known * (p[j] - q[j]), 0.0), cap)
    for i in range(nx - stride, nx):
        for j in range(ny):
            start[i, j] = 0.0


@compiled(**CALLED, nogil=True)
def continue_rolling(
    last: NDArray, before: NDArray, stride: int, stride_before: int, cap: float, start: NDArray
) -> int:
    """Continue the pressures of two contacts to a third, with the surface or with the window.

    As in `continue_pressure`; the window moved by `stride_before` rows between the two. Where asperities
    carry, their pressures move with the surface; where the whole patch carries, and more so in long strides,
    it stays in the window. Taken is what would have been nearer from the one before to the last. Returns the
    rows that it moves by.
    """
    nx = len(last)
    with_surface, in_window = 0.0, 0.0
    for i in range(nx):
        in_window += _squares(last[i], before[i], 1.0)
        moved = i + stride_before
        with_surface += _squares(last[i], before[min(moved, nx - 1)], 1.0 if moved < nx else 0.0)
    if with_surface <= in_window:
        share = 1.0 if stride == stride_before else 0.0
        continue_pressure(last, before, stride, share, cap, start)
        return stride
    continue_pressure(last, before, np.int64(0), 0.0, cap, start)
    return 0


@compiled(**INNER, **REASSOCIATE)
def _squares(p: NDArray, q: NDArray, share: float) -> float:
    """Sum of squares of p less a share of q."""
    total = 0.0
    for j in range(len(p)):
        total += (p[j] - share * q[j]) ** 2
    return total


@compiled(**CALLED)
def correct_start(now: NDArray, expected: NDArray, found: NDArray, cap: float, start: NDArray) -> None:
    """Correct the pressure expected now, Pa, by how much was wrong at the approach before."""
    for i in range(start.shape[0]):
        for j in range(start.shape[1]):
            start[i, j] = min(max(now[i, j] + (found[i, j] - expected[i, j]), 0.0), cap)


@compiled(**CALLED, **REASSOCIATE)
def misfits(
    found: NDArray, expected: NDArray, last: NDArray, before: NDArray, share: float
) -> tuple[float, float]:
    """Sums of squares, Pa², between a pressure found and what was expected, and a line through two others.

    The line goes on from `last` by a share of the step from `before` to it.
    """
    by_expectation, by_line = 0.0, 0.0
    for i in range(found.shape[0]):
        for j in range(found.shape[1]):
            p = found[i, j]
            by_expectation += (p - expected[i, j]) ** 2
            by_line += (p - max(last[i, j] + share * (last[i, j] - before[i, j]), 0.0)) ** 2
    return by_expectation, by_line
