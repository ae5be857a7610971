"""Projected conjugate gradients for 0 ≤ p ⟂ (K p − overlap) ≥ 0, with a stencil preconditioner.

Conjugate gradients with bound projection after I. A. Polonsky and L. M. Keer, Wear 231 (1999) 206; the
preconditioner applies an approximate inverse of K as a short stencil on the free set, so that an iteration
needs one convolution. What cells that hit a bound did not take of a step is convolved cell by cell where they
are few.

Fields lie on a box of `ny` columns in arrays whose rows are filled up to whole vectors.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from asperity.kernels.convolution import Convolution, convolve, pitch, quarter_spectrum, workspace
from asperity.kernels.options import LOOP, REASSOCIATE

REACH = 2
"""How many cells the preconditioning stencil reaches from its centre."""
FEW = 24
"""Clipped cells up to which it is faster to convolve them one by one."""


class Box(NamedTuple):
    """Fields of a solution on a box, shape (nx, pitch).

    Attributes
    ----------
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
    masked : ndarray, shape (nx + 2 REACH, pitch + 2 REACH)
        Residual on the free set, within a border of zeros.
    work : ndarray
        Room for convolutions.
    """

    overlap: NDArray[np.float64]
    pressure: NDArray[np.float64]
    residual: NDArray[np.float64]
    previous: NDArray[np.float64]
    direction: NDArray[np.float64]
    response: NDArray[np.float64]
    z: NDArray[np.float64]
    masked: NDArray[np.float64]
    work: NDArray[np.float64]


@njit(cache=True, nogil=True)
def empty_box(nx: int, ny: int, c: Convolution) -> Box:
    """Make the fields of a box.

    Parameters
    ----------
    nx, ny : int
        Cells.
    c : Convolution
        That the solution will use.

    Returns
    -------
    Box
        Zeros.
    """
    row = pitch(ny)
    f, masked = np.zeros((7, nx, row)), np.zeros((nx + 2 * REACH, row + 2 * REACH))
    return Box(f[0], f[1], f[2], f[3], f[4], f[5], f[6], masked, workspace(c))


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


@njit(**LOOP)
def _free(pressure: NDArray[np.float64], b: Box, ny: int, hardness: float, tolerance: float) -> int:
    """Mask the residual with the free set; return how many cells violate complementarity."""
    violated = 0
    for i in range(pressure.shape[0]):
        p, g, m = pressure[i], b.residual[i], b.masked[i + REACH]
        for j in range(ny):
            r = g[j]
            masked = r if ((p[j] > 0.0) | (r < 0.0)) & ((p[j] < hardness) | (r > 0.0)) else 0.0
            m[j + REACH] = masked
            violated += not abs(masked) <= tolerance
    return violated


@njit(**LOOP, **REASSOCIATE)
def _precondition(b: Box, ny: int, taps: NDArray[np.float64]) -> tuple[float, float]:
    """Apply the stencil to the residual on the free set; return residual·z and (residual − previous)·z."""
    nx = b.z.shape[0]
    c0, c1, c2, c3, c4, c5 = taps[0], taps[1], taps[2], taps[3], taps[4], taps[5]
    rho, change = 0.0, 0.0
    for i in range(nx):
        k, l, m, n, o = b.masked[i], b.masked[i + 1], b.masked[i + 2], b.masked[i + 3], b.masked[i + 4]
        old, z = b.previous[i], b.z[i]
        for j in range(ny):
            g = m[j + 2]
            s = c0 * g + c1 * (l[j + 2] + n[j + 2]) + c2 * (m[j + 1] + m[j + 3])
            s += c3 * (l[j + 1] + l[j + 3] + n[j + 1] + n[j + 3])
            s += c4 * (k[j + 2] + o[j + 2]) + c5 * (m[j] + m[j + 4])
            s = s if g != 0.0 else 0.0
            z[j] = s
            rho += g * s
            change += (g - old[j]) * s
    return rho, change


@njit(**LOOP, **REASSOCIATE)
def _turn(b: Box, ny: int, beta: float) -> float:
    """Set the search direction from z and the one before; return residual·direction."""
    slope = 0.0
    for i in range(b.z.shape[0]):
        z, d, g = b.z[i], b.direction[i], b.residual[i]
        for j in range(ny):
            t = beta * d[j] - z[j] if z[j] != 0.0 else 0.0
            d[j] = t
            slope += g[j] * t
    return slope


@njit(**LOOP, **REASSOCIATE)
def _dot(left: NDArray[np.float64], right: NDArray[np.float64], ny: int) -> float:
    total = 0.0
    for i in range(left.shape[0]):
        x, y = left[i], right[i]
        for j in range(ny):
            total += x[j] * y[j]
    return total


@njit(**LOOP)
def _advance(b: Box, ny: int, step: float, hardness: float) -> int:
    """Step along the direction and project on the bounds; return how many cells were clipped.

    The residual becomes the previous one, `z` what the bounds took off the step.
    """
    clipped = 0
    for i in range(b.pressure.shape[0]):
        p, d, z = b.pressure[i], b.direction[i], b.z[i]
        g, old, u = b.residual[i], b.previous[i], b.response[i]
        for j in range(ny):
            wanted = p[j] + step * d[j]
            kept = min(max(wanted, 0.0), hardness)
            clipped += kept != wanted
            z[j] = kept - wanted
            p[j] = kept
        for j in range(ny):
            old[j] = g[j]
            g[j] += step * u[j]
    return clipped


@njit(**LOOP)
def _correct(b: Box, ny: int, mirrored: NDArray[np.float64]) -> None:
    """Add to the residual what the cells in `z` displace, one by one."""
    nx, middle = b.z.shape[0], mirrored.shape[1] // 2
    for k in range(nx):
        for l in range(ny):
            amount = b.z[k, l]
            if amount != 0.0:
                for i in range(nx):
                    g, influence = b.residual[i], mirrored[abs(i - k), middle - l :]
                    for j in range(ny):
                        g[j] += amount * influence[j]


@njit(**LOOP)
def _true_residual(c: Convolution, b: Box, ny: int) -> None:
    convolve(c, b.pressure, ny, b.work, b.residual)
    for i in range(b.residual.shape[0]):
        for j in range(ny):
            b.residual[i, j] -= b.overlap[i, j]


@njit(**LOOP, nogil=True)
def survey(c: Convolution, b: Box, ny: int, hardness: float) -> tuple[float, int, int, int, int]:
    """Compute the residual of a pressure and where there is something left to solve.

    Parameters
    ----------
    c : Convolution
        With the kernel, m/Pa, for this box.
    b : Box
        Holds overlap and pressure, receives the residual.
    ny : int
        Columns of the box.
    hardness : float
        Upper bound of the pressure, Pa.

    Returns
    -------
    worst : float
        Largest complementarity residual, m.
    first_row, end_row, first_column, end_column : int
        The smallest box that holds all cells under pressure or in overlap; zeros if there are none.
    """
    _true_residual(c, b, ny)
    first, end, left, right = b.pressure.shape[0], 0, ny, 0
    worst = 0.0
    for i in range(b.pressure.shape[0]):
        for j in range(ny):
            p, r = b.pressure[i, j], b.residual[i, j]
            if p > 0.0 or r < 0.0:
                worst = max(worst, abs(r) if p < hardness else r)
                first, end = min(first, i), i + 1
                left, right = min(left, j), max(right, j + 1)
    return (worst, first, end, left, right) if end else (worst, 0, 0, 0, 0)


@njit(**LOOP)
def _copy(outer: NDArray[np.float64], row: int, column: int, inner: NDArray[np.float64], ny: int) -> None:
    for i in range(inner.shape[0]):
        for j in range(ny):
            inner[i, j] = outer[row + i, column + j]


@njit(**LOOP, nogil=True)
def solve(
    c: Convolution,
    mirrored: NDArray[np.float64],
    taps: NDArray[np.float64],
    outer: Box,
    row: int,
    column: int,
    b: Box,
    ny: int,
    hardness: float,
    tolerance: float,
    max_iterations: int,
) -> tuple[int, bool]:
    """Solve 0 ≤ p ≤ hardness ⟂ K p − overlap on a box within another one that was surveyed.

    Parameters
    ----------
    c : Convolution
        With the kernel, m/Pa, for the inner box.
    mirrored : ndarray, shape (≥ nx, ≥ 2 ny − 1)
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
    ny : int
        Columns of the inner box.
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
    _copy(outer.overlap, row, column, b.overlap, ny)
    _copy(outer.pressure, row, column, b.pressure, ny)
    _copy(outer.residual, row, column, b.residual, ny)
    rho, iteration, definite = 0.0, 0, True
    while iteration < max_iterations and _free(b.pressure, b, ny, hardness, tolerance):
        iteration += 1
        before = rho
        rho, change = _precondition(b, ny, taps)
        slope = _turn(b, ny, max(0.0, change / before) if before > 0.0 else 0.0)
        if slope >= 0.0:  # not a descent direction any more: restart from the preconditioned gradient
            slope = _turn(b, ny, 0.0)
        convolve(c, b.direction, ny, b.work, b.response)
        curvature = _dot(b.direction, b.response, ny)
        definite = curvature > 0.0
        if not definite:
            break
        clipped = _advance(b, ny, -slope / curvature, hardness)
        if clipped > FEW:
            _true_residual(c, b, ny)
        elif clipped:
            _correct(b, ny, mirrored)
    for i in range(b.pressure.shape[0]):
        for j in range(ny):
            outer.pressure[row + i, column + j] = b.pressure[i, j]
    return iteration, definite


@njit(**LOOP, nogil=True)
def unit_indentation(
    c: Convolution, taps: NDArray[np.float64], b: Box, ny: int, rtol: float, max_iterations: int
) -> bool:
    """Find the pressure that displaces a fixed set of cells by one: K p = 1 on the set, p = 0 elsewhere.

    Parameters
    ----------
    c, taps, ny
        As in `solve`.
    b : Box
        `overlap` is one on the set and zero elsewhere, `pressure` zero. On return `pressure` is Pa per m of
        indentation; its integral is the tangent stiffness.
    rtol : float
        Largest residual, relative to one.
    max_iterations : int
        Iterations allowed.

    Returns
    -------
    bool
        Whether the residual fell below `rtol`.
    """
    nx, rho = b.overlap.shape[0], 0.0
    for i in range(nx):
        for j in range(ny):
            b.residual[i, j] = -b.overlap[i, j]
    for _ in range(max_iterations):
        # a positive "pressure" on the set marks it as free
        if not _free(b.overlap, b, ny, np.inf, rtol):
            return True
        before = rho
        rho, change = _precondition(b, ny, taps)
        slope = _turn(b, ny, max(0.0, change / before) if before > 0.0 else 0.0)
        convolve(c, b.direction, ny, b.work, b.response)
        step = -slope / _dot(b.direction, b.response, ny)
        for i in range(nx):
            for j in range(ny):
                b.previous[i, j] = b.residual[i, j]
                b.pressure[i, j] += step * b.direction[i, j]
                b.residual[i, j] += step * b.response[i, j] * b.overlap[i, j]
    return False
