"""One contact at a prescribed approach, from the gap to the pressure."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.convolution import convolve
from asperity.kernels.influence import UNIT, Influence, convolution, is_prepared
from asperity.kernels.lanes import width
from asperity.kernels.options import INNER, LOOP, ONCE, compiled
from asperity.kernels.overlap import overlap_box
from asperity.kernels.projected_cg import Box, box_room, empty_box, solve, survey, unit_indentation

MARGIN = 3
"""Cells left around pressure and overlap of what a solution starts from."""
NO_CONTACT, CONVERGED, ITERATION_LIMIT, SINGULAR, UNPREPARED = range(5)
"""How a solution can end."""


class Solution(NamedTuple):
    """How a contact was solved.

    Attributes
    ----------
    status : int
        One of the endings above; `UNPREPARED` if the convolution on `nx` × `ny` cells is missing.
    iterations : int
        Conjugate-gradient iterations.
    residual : float
        Largest complementarity residual relative to the largest overlap.
    total : float
        Sum of the pressure over the cells, Pa.
    nx, ny : int
        Box of the overlap, or the one that is not prepared.
    """

    status: int
    iterations: int
    residual: float
    total: float
    nx: int
    ny: int


class Room(NamedTuple):
    """Room for a solution, for one thread.

    Attributes
    ----------
    lowest : ndarray, shape (ny,)
        For the lowest gap of each column.
    outer, inner : ndarray
        For the boxes of overlap and contact.
    """

    lowest: NDArray[np.float64]
    outer: NDArray[np.float64]
    inner: NDArray[np.float64]


def room(known: Influence, nx: int, ny: int) -> Room:
    """Make room for solutions on a grid.

    Parameters
    ----------
    known : Influence
        The influence.
    nx, ny : int
        Cells of the grid.

    Returns
    -------
    Room
        Of any value.
    """
    mx, my = (int(known.lengths[-(-n // UNIT)]) for n in (nx, ny))
    dtype = known.spectra.dtype
    size = box_room(nx, ny, mx, my, width(dtype))
    return Room(np.empty(ny), np.empty(size, dtype), np.empty(size, dtype))


@compiled(**ONCE)
def solve_contact(
    known: Influence,
    gap: NDArray[np.float64],
    approach: float,
    start: NDArray[np.float64],
    hardness: float,
    rtol: float,
    max_iterations: int,
    room: Room,
    pressure: NDArray[np.float64],
) -> Solution:
    """Solve 0 ≤ p ≤ hardness ⟂ K p + gap − approach on a grid.

    Parameters
    ----------
    known : Influence
        K, with the convolutions prepared so far.
    gap : ndarray, shape (nx, ny)
        Separation of the undeformed bodies at zero approach, m.
    approach : float
        Approach, m, positive closing.
    start : ndarray, shape (nx, ny)
        Pressure to start from, Pa, within the bounds; zero on all of the overlap if nothing is known.
    hardness : float
        Upper bound of the pressure, Pa (may be infinite).
    rtol : float
        Largest complementarity residual relative to the largest overlap.
    max_iterations : int
        Iterations allowed.
    room : Room
        For this grid.
    pressure : ndarray, shape (nx, ny)
        Receives the pressure, Pa, unless a convolution is missing.

    Returns
    -------
    Solution
        How it ended. No pressure acts outside of the box of the overlap, which is all that is solved on.
    """
    largest, first, end, left, right = overlap_box(gap, approach, room.lowest)
    nx, ny = end - first, right - left
    if nx > 0 and not is_prepared(known, nx, ny):
        return Solution(UNPREPARED, 0, 0.0, 0.0, nx, ny)
    if nx == 0:
        _clear(pressure)
        return Solution(NO_CONTACT, 0, 0.0, 0.0, 0, 0)
    outer, everywhere = empty_box(nx, ny, room.outer), convolution(known, nx, ny)
    guessed = not _enter(outer, gap, approach, start, first, left)
    if guessed:
        _guess(outer, largest, known.taps[0])
    iterations, tolerance, definite = 0, rtol * largest, True
    while True:
        worst, top, bottom, near, far = survey(everywhere, outer, hardness)
        if guessed:
            _scale(outer, hardness)
            guessed = False
            continue
        if worst <= tolerance or iterations >= max_iterations or not definite:
            break
        row, rows = _grown(known, top, bottom, nx)
        column, columns = _grown(known, near, far, ny)
        if not is_prepared(known, rows, columns):
            return Solution(UNPREPARED, 0, 0.0, 0.0, rows, columns)
        done, definite = solve(
            convolution(known, rows, columns), known.mirrored, known.taps, outer, row, column,
            empty_box(rows, columns, room.inner), hardness, tolerance, max_iterations - iterations,
        )  # fmt: skip
        iterations += done
    total = _leave(outer, pressure, first, left)
    status = CONVERGED
    if not worst <= tolerance:
        status = ITERATION_LIMIT if iterations >= max_iterations else SINGULAR
    return Solution(status, iterations, worst / largest, total, nx, ny)


@compiled(**LOOP, nogil=True)
def displace(known: Influence, pressure: NDArray[np.float64], room: Room, out: NDArray[np.float64]) -> None:
    """Displacement under a pressure, K p.

    Parameters
    ----------
    known : Influence
        K, with the convolution on the box prepared.
    pressure : ndarray, shape (nx, ny)
        Pressure on a box, Pa.
    room : Room
        For this box.
    out : ndarray, shape (nx, ny)
        Receives the displacement, m.
    """
    nx, ny = pressure.shape
    b = empty_box(nx, ny, room.outer)
    for i in range(nx):
        for j in range(ny):
            b.pressure[i * b.pitch + j] = pressure[i, j]
    convolve(convolution(known, nx, ny), b.pressure, nx, ny, b.pitch, b.work, b.response)
    for i in range(nx):
        for j in range(ny):
            out[i, j] = b.response[i * b.pitch + j]


@compiled(**LOOP, nogil=True)
def indent(
    known: Influence, inside: NDArray[np.bool_], rtol: float, max_iterations: int, room: Room
) -> tuple[float, bool]:
    """Displace a fixed set of cells by one, as in `projected_cg.unit_indentation`.

    Parameters
    ----------
    known : Influence
        K, with the convolution on the box prepared.
    inside : ndarray of bool, shape (nx, ny)
        The set on a box.
    rtol : float
        Largest residual, relative to one.
    max_iterations : int
        Iterations allowed.
    room : Room
        For this box.

    Returns
    -------
    total : float
        Sum of the pressure over the cells, Pa/m.
    converged : bool
        Whether the residual fell below `rtol`.
    """
    nx, ny = inside.shape
    b = empty_box(nx, ny, room.inner)
    converged = unit_indentation(convolution(known, nx, ny), known.taps, b, inside, rtol, max_iterations)
    total = 0.0
    for q in range(len(b.pressure)):
        total += b.pressure[q]
    return total, converged


@compiled(**INNER)
def _enter(b: Box, gap: NDArray, approach: float, start: NDArray, first: int, left: int) -> bool:
    """Set overlap and pressure; return whether there is any pressure."""
    started = False
    for i in range(b.nx):
        for j in range(b.ny):
            q = i * b.pitch + j
            b.overlap[q] = approach - gap[first + i, left + j]
            b.pressure[q] = start[first + i, left + j]
            started |= b.pressure[q] > 0.0
    return started


@compiled(**INNER)
def _guess(b: Box, largest: float, stiffness: float) -> None:
    """Set a pressure of Hertzian form over the deeper half of the overlap, of about the right size."""
    for q in range(len(b.pressure)):
        b.pressure[q] = stiffness * np.sqrt(largest * max(b.overlap[q] - 0.5 * largest, 0.0))


@compiled(**INNER)
def _scale(b: Box, hardness: float) -> None:
    """Scale a pressure whose residual is known to least energy."""
    done, stored = 0.0, 0.0
    for q in range(len(b.pressure)):
        done += b.pressure[q] * b.overlap[q]
        stored += b.pressure[q] * (b.residual[q] + b.overlap[q])
    for q in range(len(b.pressure)):
        b.pressure[q] = min(b.pressure[q] * (done / stored), hardness)


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
