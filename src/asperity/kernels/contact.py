"""One contact at a prescribed approach, from the gap to the pressure."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from asperity.kernels.convolution import Convolution, convolve
from asperity.kernels.influence import UNIT, Influence, convolution, is_prepared
from asperity.kernels.overlap import overlap_box
from asperity.kernels.projected_cg import Box, empty_box, solve, survey

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
    cells : int
        Cells under pressure.
    nx, ny : int
        Box of the overlap, or the one that is not prepared.
    """

    status: int
    iterations: int
    residual: float
    total: float
    cells: int
    nx: int
    ny: int


@njit(cache=True, nogil=True)
def solve_contact(
    known: Influence,
    gap: NDArray[np.float64],
    approach: float,
    start: NDArray[np.float64],
    hardness: float,
    rtol: float,
    max_iterations: int,
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
    pressure : ndarray, shape (nx, ny)
        Receives the pressure, Pa, unless a convolution is missing.

    Returns
    -------
    Solution
        How it ended. No pressure acts outside of the box of the overlap, which is all that is solved on.
    """
    largest, first, end, left, right = overlap_box(gap, approach)
    if not largest > 0.0:
        pressure[:] = 0.0
        return Solution(NO_CONTACT, 0, 0.0, 0.0, 0, 0, 0)
    nx, ny = end - first, right - left
    if not is_prepared(known, nx, ny):
        return Solution(UNPREPARED, 0, 0.0, 0.0, 0, nx, ny)
    whole = convolution(known, nx, ny)
    box = empty_box(nx, ny, whole)
    started = False
    for i in range(nx):
        for j in range(ny):
            q = i * box.pitch + j
            box.overlap[q] = approach - gap[first + i, left + j]
            box.pressure[q] = start[first + i, left + j]
            started |= box.pressure[q] > 0.0
    if not started:
        _guess(whole, box, largest, hardness)
    iterations, tolerance = 0, rtol * largest
    while True:
        worst, top, bottom, near, far = survey(whole, box, hardness)
        if worst <= tolerance or iterations >= max_iterations:
            break
        row, rows = _grown(known, top, bottom, nx)
        column, columns = _grown(known, near, far, ny)
        if not is_prepared(known, rows, columns):
            return Solution(UNPREPARED, 0, 0.0, 0.0, 0, rows, columns)
        c = convolution(known, rows, columns)
        done, definite = solve(
            c, known.mirrored, known.taps, box, row, column, empty_box(rows, columns, c), hardness, tolerance,
            max_iterations - iterations,
        )  # fmt: skip
        iterations += done
        if not definite:
            break
    pressure[:] = 0.0
    total, cells = 0.0, 0
    for i in range(nx):
        for j in range(ny):
            p = box.pressure[i * box.pitch + j]
            pressure[first + i, left + j] = p
            total += p
            cells += p > 0.0
    status = CONVERGED
    if not worst <= tolerance:
        status = ITERATION_LIMIT if iterations >= max_iterations else SINGULAR
    return Solution(status, iterations, worst / largest, total, cells, nx, ny)


@njit(cache=True, nogil=True)
def _guess(c: Convolution, b: Box, largest: float, hardness: float) -> None:
    """Pressure of Hertzian form over the deeper half of the overlap, scaled to least energy."""
    for q in range(len(b.pressure)):
        b.pressure[q] = np.sqrt(max(b.overlap[q] - 0.5 * largest, 0.0))
    convolve(c, b.pressure, b.nx, b.ny, b.pitch, b.work, b.response)
    done, stored = 0.0, 0.0
    for q in range(len(b.pressure)):
        done += b.pressure[q] * b.overlap[q]
        stored += b.pressure[q] * b.response[q]
    for q in range(len(b.pressure)):
        b.pressure[q] = min(b.pressure[q] * (done / stored), hardness)


@njit(cache=True, nogil=True)
def _grown(known: Influence, first: int, end: int, n: int) -> tuple[int, int]:
    """Begin and length of a side with a margin, and with what transforms at the same cost, within n cells."""
    needed = end - first + 2 * MARGIN
    if needed >= n:
        return 0, n
    length = min(known.lengths[-(-needed // UNIT)], n)
    return min(max(0, first - (length - (end - first)) // 2), n - length), length
