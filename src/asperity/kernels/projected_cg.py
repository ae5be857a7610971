"""Projected conjugate gradients for 0 ≤ p ⟂ (K p − overlap) ≥ 0, with a stencil preconditioner.

Conjugate gradients with bound projection after I. A. Polonsky and L. M. Keer, Wear 231 (1999) 206; the
preconditioner applies an approximate inverse of K as a short stencil on the free set, so that an iteration
needs one convolution. What cells that hit a bound did not take of a step is convolved cell by cell where they
are few.

Fields lie flat, row after row, with some idle columns behind each row: nothing overlaps there, so that no
pressure acts, and loops need not know where a row ends.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.convolution import Convolution, convolve, quarter_spectrum, whole, workspace
from asperity.kernels.lanes import lanes, load, store
from asperity.kernels.options import INNER, LOOP, ONCE, REASSOCIATE, compiled

REACH = 2
"""How many cells the preconditioning stencil reaches from its centre."""
FEW = 20
"""Clipped cells up to which it is faster to convolve them one by one."""
FAR = 1e30
"""Separation in the idle columns, m."""


class Box(NamedTuple):
    """Fields of a solution on a box, each of nx rows of `pitch` cells.

    Attributes
    ----------
    nx, ny, pitch : int
        Rows, columns, and columns with the idle ones.
    overlap : ndarray
        Overlap of the undeformed bodies, m.
    pressure : ndarray
        Pressure, Pa.
    residual, previous : ndarray
        K p − overlap, m, now and one iteration ago.
    direction, response : ndarray
        Search direction, Pa, and what it displaces, m.
    z : ndarray
        Preconditioned residual, Pa.
    masked : ndarray
        Residual on the free set, between REACH rows of zeros.
    clipped : ndarray, shape (2 FEW,)
        Rows and columns of clipped cells.
    work : ndarray
        Room for convolutions.
    """

    nx: int
    ny: int
    pitch: int
    overlap: NDArray[np.float64]
    pressure: NDArray[np.float64]
    residual: NDArray[np.float64]
    previous: NDArray[np.float64]
    direction: NDArray[np.float64]
    response: NDArray[np.float64]
    z: NDArray[np.float64]
    masked: NDArray[np.float64]
    clipped: NDArray[np.float64]
    work: NDArray[np.float64]


@compiled(**INNER)
def _extent(nx: int, ny: int, lanes: int) -> tuple[int, int]:
    """Pitch of a box, and length of its fields: whole runs of four vectors."""
    pitch = max(whole(ny, lanes), ny + REACH)
    return pitch, whole(nx * pitch, 4 * lanes)


@compiled(**LOOP)
def box_room(nx: int, ny: int, mx: int, my: int, lanes: int) -> int:
    """Room that a box needs.

    Parameters
    ----------
    nx, ny : int
        Cells.
    mx, my : int
        Cells that are convolved.
    lanes : int
        Numbers in a vector.

    Returns
    -------
    int
        Numbers.
    """
    pitch, size = _extent(nx, ny, lanes)
    return 8 * size + 2 * REACH * pitch + 2 * FEW + workspace(mx, my, lanes)


@compiled(**LOOP)
def empty_box(nx: int, ny: int, room: NDArray[np.float64]) -> Box:
    """Make a box on which nothing overlaps.

    Parameters
    ----------
    nx, ny : int
        Cells.
    room : ndarray
        As many numbers as `box_room` says, of any value, or more: the fields will lie here.

    Returns
    -------
    Box
        With pressure zero.
    """
    pitch, size = _extent(nx, ny, lanes(room))
    masked, end = 7 * size, 8 * size + 2 * REACH * pitch
    for q in range(end):
        room[q] = 0.0
    box = Box(
        nx, ny, pitch, room[:size], room[size : 2 * size], room[2 * size : 3 * size],
        room[3 * size : 4 * size], room[4 * size : 5 * size], room[5 * size : 6 * size],
        room[6 * size : masked], room[masked:end], room[end : end + 2 * FEW], room[end + 2 * FEW :],
    )  # fmt: skip
    for q in range(size):
        box.overlap[q], box.residual[q] = -FAR, FAR
    return box


def inverse_stencil(table: NDArray[np.float64]) -> NDArray[np.float64]:
    """Fit a 13-point stencil whose symbol approximates the inverse of the kernel's.

    Parameters
    ----------
    table : ndarray, shape (≥ 32, ≥ 32)
        Kernel at non-negative separations.

    Returns
    -------
    ndarray, shape (6,)
        Taps at (0,0), (±1,0), (0,±1), (±1,±1), (±2,0), (0,±2), in units of the inverse kernel. The symbol
        is positive, so the stencil restricted to any set of cells is positive definite.
    """
    n = 32
    symbol = quarter_spectrum(quarter_spectrum(table[:n, :n], 1), 0)
    q = 2.0 * np.pi * (np.arange(n) + 0.25) / n
    qx, qy = q[:, None], q[None, :]
    cx, cy = np.cos(qx), np.cos(qy)
    one = np.ones_like(symbol)
    taps = [one, 2 * cx * one, 2 * cy * one, 4 * cx * cy, 2 * np.cos(2 * qx) * one, 2 * np.cos(2 * qy) * one]
    basis = np.stack([tap * symbol for tap in taps], axis=-1).reshape(-1, len(taps))
    coefficients = np.linalg.lstsq(basis, np.ones(symbol.size), rcond=None)[0]
    lowest = float(np.min(np.stack(taps, axis=-1) @ coefficients))
    floor = 0.1 / float(symbol.max())
    coefficients[0] += max(0.0, floor - lowest)
    return np.asarray(coefficients)


@compiled(**INNER, **REASSOCIATE)
def _free(pressure: NDArray[np.float64], b: Box, hardness: float, tolerance: float) -> float:
    """Mask the residual with the free set; return how many cells violate complementarity."""
    real = b.z.dtype.type  # numbers of another precision would be computed with in double
    zero, one, target = real(0.0), real(1.0), b.masked[REACH * b.pitch :]
    hardness, tolerance, violated = real(hardness), real(tolerance), zero
    for q in range(len(pressure)):
        p, r = pressure[q], b.residual[q]
        masked = r if p > zero else min(r, zero)
        masked = masked if p < hardness else max(masked, zero)
        target[q] = masked
        violated += zero if abs(masked) <= tolerance else one
    return violated


@compiled(**INNER, **REASSOCIATE)
def _precondition(b: Box, taps: NDArray[np.float64]) -> tuple[float, float]:
    """Apply the stencil to the residual on the free set; return residual·z and (residual − previous)·z."""
    row = b.pitch
    above, m, below = b.masked[row - 1 :], b.masked[2 * row - 2 :], b.masked[3 * row - 1 :]
    top, bottom = b.masked, b.masked[4 * row :]
    c0, c1, c2, c3, c4, c5 = taps[0], taps[1], taps[2], taps[3], taps[4], taps[5]
    zero = b.z.dtype.type(0.0)
    rho, change = zero, zero
    for q in range(len(b.z)):
        g = m[q + 2]
        s = c0 * g + c1 * (above[q + 1] + below[q + 1]) + c2 * (m[q + 1] + m[q + 3])
        s += c3 * (above[q] + above[q + 2] + below[q] + below[q + 2])
        s += c4 * (top[q] + bottom[q]) + c5 * (m[q] + m[q + 4])
        s = s if g != zero else zero
        b.z[q] = s
        rho += g * s
        change += (g - b.previous[q]) * s
    return rho, change


@compiled(**INNER, **REASSOCIATE)
def _turn(b: Box, beta: float) -> float:
    """Set the search direction from z and the one before; return residual·direction."""
    zero, factor = b.z.dtype.type(0.0), b.z.dtype.type(beta)
    slope = zero
    for q in range(len(b.z)):
        t = factor * b.direction[q] - b.z[q] if b.z[q] != zero else zero
        b.direction[q] = t
        slope += b.residual[q] * t
    return slope


@compiled(**INNER, **REASSOCIATE)
def _dot(left: NDArray[np.float64], right: NDArray[np.float64]) -> float:
    total = left.dtype.type(0.0)
    for q in range(len(left)):
        total += left[q] * right[q]
    return total


@compiled(**INNER)
def _advance(b: Box, step: float, hardness: float) -> int:
    """Step along the direction and project on the bounds; return how many cells were clipped.

    The residual becomes the previous one, `z` what the bounds took off the step.
    """
    real = b.z.dtype.type
    zero, factor, cap, clipped = real(0.0), real(step), real(hardness), 0
    for q in range(len(b.z)):
        wanted = b.pressure[q] + factor * b.direction[q]
        kept = min(max(wanted, zero), cap)
        clipped += kept != wanted
        b.z[q] = kept - wanted
        b.pressure[q] = kept
        b.previous[q] = b.residual[q]
        b.residual[q] += factor * b.response[q]
    return clipped


@compiled(**INNER)
def _correct(b: Box, mirrored: NDArray[np.float64], count: int) -> None:
    """Add to the residual what the clipped cells in `z` displace, one by one."""
    found, q = 0, 0
    while found < count:
        if b.z[q] != 0.0:
            b.clipped[2 * found], b.clipped[2 * found + 1] = q // b.pitch, q % b.pitch
            found += 1
        q += 1
    width = mirrored.shape[1]
    middle = width // 2
    for i in range(b.nx):
        for j in range(0, b.ny, lanes(mirrored)):
            total = load(b.residual, i * b.pitch + j)
            for n in range(count):
                row, column = int(b.clipped[2 * n]), int(b.clipped[2 * n + 1])
                influence = load(mirrored, abs(i - row) * width + middle - column + j)
                total = total + b.z[row * b.pitch + column] * influence
            store(b.residual, i * b.pitch + j, total)


@compiled(**ONCE)
def _true_residual(c: Convolution, b: Box) -> None:
    convolve(c, b.pressure, b.nx, b.ny, b.pitch, b.work, b.response)
    for q in range(len(b.residual)):
        b.residual[q] = b.response[q] - b.overlap[q]


@compiled(**ONCE)
def survey(c: Convolution, b: Box, hardness: float) -> tuple[float, int, int, int, int]:
    """Compute the residual of a pressure and where there is something left to solve.

    Parameters
    ----------
    c : Convolution
        With the kernel, m/Pa, for this box.
    b : Box
        Holds overlap and pressure, receives the residual.
    hardness : float
        Upper bound of the pressure, Pa.

    Returns
    -------
    worst : float
        Largest complementarity residual, m.
    first_row, end_row, first_column, end_column : int
        The smallest box that holds all cells under pressure or in overlap; zeros if there are none.
    """
    _true_residual(c, b)
    first, end, left, right = b.nx, 0, b.ny, 0
    worst = 0.0
    for i in range(b.nx):
        for j in range(b.ny):
            p, r = b.pressure[i * b.pitch + j], b.residual[i * b.pitch + j]
            if p > 0.0 or r < 0.0:
                worst = max(worst, abs(r) if p < hardness else r)
                first, end = min(first, i), i + 1
                left, right = min(left, j), max(right, j + 1)
    return (worst, first, end, left, right) if end else (worst, 0, 0, 0, 0)


@compiled(**INNER)
def _copy(outer: Box, source: NDArray[np.float64], row: int, column: int, b: Box, target: NDArray) -> None:
    for i in range(b.nx):
        for j in range(b.ny):
            target[i * b.pitch + j] = source[(row + i) * outer.pitch + column + j]


@compiled(**ONCE)
def solve(
    c: Convolution,
    mirrored: NDArray[np.float64],
    taps: NDArray[np.float64],
    outer: Box,
    row: int,
    column: int,
    b: Box,
    hardness: float,
    tolerance: float,
    max_iterations: int,
) -> tuple[int, bool]:
    """Solve 0 ≤ p ≤ hardness ⟂ K p − overlap on a box within another one that was surveyed.

    Parameters
    ----------
    c : Convolution
        With the kernel, m/Pa, for the inner box.
    mirrored : ndarray, shape (≥ nx, ≥ 2 whole(ny) − 1)
        The kernel at separations i ≥ 0 and, with zero in the middle column, j of both signs, m/Pa.
    taps : ndarray, shape (6,)
        From `inverse_stencil`, Pa/m.
    outer : Box
        Holds overlap, residual and a start within the bounds that is zero outside of the inner box; receives
        the pressure.
    row, column : int
        Where the inner box begins.
    b : Box
        The inner box, empty.
    hardness : float
        Upper bound of the pressure, Pa (may be infinite).
    tolerance : float
        Largest complementarity residual, m, as far as the recurrence knows it: survey the result.
    max_iterations : int
        Iterations allowed.

    Returns
    -------
    iterations : int
        Iterations done.
    definite : bool
        Whether the kernel is: otherwise there is no going on.
    """
    _copy(outer, outer.overlap, row, column, b, b.overlap)
    _copy(outer, outer.pressure, row, column, b, b.pressure)
    _copy(outer, outer.residual, row, column, b, b.residual)
    rho, iteration, definite = 0.0, 0, True
    while iteration < max_iterations and _free(b.pressure, b, hardness, tolerance):
        iteration += 1
        before = rho
        rho, change = _precondition(b, taps)
        slope = _turn(b, max(0.0, change / before) if before > 0.0 else 0.0)
        if slope >= 0.0:  # not a descent direction any more: restart from the preconditioned gradient
            slope = _turn(b, 0.0)
        convolve(c, b.direction, b.nx, b.ny, b.pitch, b.work, b.response)
        curvature = _dot(b.direction, b.response)
        definite = curvature > 0.0
        if not definite:
            break
        clipped = _advance(b, -slope / curvature, hardness)
        if clipped > FEW:
            _true_residual(c, b)
        elif clipped:
            _correct(b, mirrored, clipped)
    for i in range(b.nx):
        for j in range(b.ny):
            outer.pressure[(row + i) * outer.pitch + column + j] = b.pressure[i * b.pitch + j]
    return iteration, definite


@compiled(**ONCE)
def unit_indentation(
    c: Convolution,
    taps: NDArray[np.float64],
    b: Box,
    inside: NDArray[np.bool_],
    rtol: float,
    max_iterations: int,
) -> bool:
    """Find the pressure that displaces a fixed set of cells by one: K p = 1 on the set, p = 0 elsewhere.

    Parameters
    ----------
    c, taps
        As in `solve`.
    b : Box
        Empty. On return `pressure` is Pa per m of indentation; its integral is the tangent stiffness.
    inside : ndarray of bool, shape (nx, ny)
        The set.
    rtol : float
        Largest residual, relative to one.
    max_iterations : int
        Iterations allowed.

    Returns
    -------
    bool
        Whether the residual fell below `rtol`.
    """
    rho = 0.0
    for q in range(len(b.overlap)):
        b.overlap[q] = 0.0
    for i in range(b.nx):
        for j in range(b.ny):
            b.overlap[i * b.pitch + j] = 1.0 if inside[i, j] else 0.0
    for q in range(len(b.overlap)):
        b.residual[q] = -b.overlap[q]
    for _ in range(max_iterations):
        # a positive "pressure" on the set marks it as free
        if not _free(b.overlap, b, np.inf, rtol):
            return True
        before = rho
        rho, change = _precondition(b, taps)
        slope = _turn(b, max(0.0, change / before) if before > 0.0 else 0.0)
        convolve(c, b.direction, b.nx, b.ny, b.pitch, b.work, b.response)
        step = -slope / _dot(b.direction, b.response)
        for q in range(len(b.overlap)):
            b.previous[q] = b.residual[q]
            b.pressure[q] += step * b.direction[q]
            b.residual[q] += step * b.response[q] * b.overlap[q]
    return False
