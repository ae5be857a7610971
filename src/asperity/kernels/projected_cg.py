"""Projected conjugate gradients for 0 ≤ p ⟂ (K p − overlap) ≥ 0, with a stencil preconditioner.

Conjugate gradients with bound projection after I. A. Polonsky and L. M. Keer, Wear 231 (1999) 206; the
preconditioner applies an approximate inverse of K as a short stencil on the free set, so that an iteration
needs one convolution, and a second one only when a bound was hit.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from asperity.kernels.convolution import convolve, even_spectrum

REACH = 2
"""How many cells the preconditioning stencil reaches from its centre."""


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
    symbol = even_spectrum(table, n, n)
    qx = 2.0 * np.pi * np.fft.fftfreq(symbol.shape[0])[:, None]
    qy = np.pi * np.linspace(0.0, 1.0, symbol.shape[1])[None, :]
    cx, cy = np.cos(qx), np.cos(qy)
    one = np.ones_like(symbol)
    taps = [one, 2 * cx * one, 2 * cy * one, 4 * cx * cy, 2 * np.cos(2 * qx) * one, 2 * np.cos(2 * qy) * one]
    basis = np.stack([tap * symbol for tap in taps], axis=-1).reshape(-1, len(taps))
    coefficients = np.linalg.lstsq(basis, np.ones(symbol.size), rcond=None)[0]
    lowest = float(np.min(np.stack(taps, axis=-1) @ coefficients))
    floor = 0.1 / float(symbol.max())
    coefficients[0] += max(0.0, floor - lowest)
    return np.asarray(coefficients)


@njit(cache=True, nogil=True)
def _precondition(
    pressure: NDArray[np.float64],
    residual: NDArray[np.float64],
    hardness: float,
    taps: NDArray[np.float64],
    masked: NDArray[np.float64],
    z: NDArray[np.float64],
) -> int:
    """Apply the stencil to the residual on the free set; return the size of that set.

    `masked` has a border of REACH zeros and receives the residual on the free set; `z` is zero elsewhere.
    """
    nx, ny = pressure.shape
    count = 0
    for i in range(nx):
        for j in range(ny):
            p, g = pressure[i, j], residual[i, j]
            free = (p > 0.0 or g < 0.0) and (p < hardness or g > 0.0)
            masked[i + 2, j + 2] = g if free else 0.0
            z[i, j] = 1.0 if free else 0.0
            count += free
    c0, c1, c2, c3, c4, c5 = taps
    for i in range(nx):
        a, b, m, d, e = masked[i], masked[i + 1], masked[i + 2], masked[i + 3], masked[i + 4]
        for j in range(ny):
            k = j + 2
            z[i, j] *= (
                c0 * m[k]
                + c1 * (b[k] + d[k])
                + c2 * (m[k - 1] + m[k + 1])
                + c3 * (b[k - 1] + b[k + 1] + d[k - 1] + d[k + 1])
                + c4 * (a[k] + e[k])
                + c5 * (m[k - 2] + m[k + 2])
            )
    return count


@njit(cache=True, nogil=True)
def _direction(
    residual: NDArray[np.float64],
    previous: NDArray[np.float64],
    z: NDArray[np.float64],
    direction: NDArray[np.float64],
    rho_previous: float,
) -> tuple[float, float]:
    """Update the search direction in place (Polak–Ribière); return residual·z and residual·direction."""
    nx, ny = residual.shape
    rho, change = 0.0, 0.0
    for i in range(nx):
        for j in range(ny):
            rho += residual[i, j] * z[i, j]
            change += (residual[i, j] - previous[i, j]) * z[i, j]
    beta = max(0.0, change / rho_previous) if rho_previous > 0.0 else 0.0
    slope = 0.0
    for i in range(nx):
        for j in range(ny):
            t = beta * direction[i, j] - z[i, j] if z[i, j] != 0.0 else 0.0
            direction[i, j] = t
            slope += residual[i, j] * t
    return rho, slope


@njit(cache=True, nogil=True)
def _dot(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    total = 0.0
    for i in range(a.shape[0]):
        for j in range(a.shape[1]):
            total += a[i, j] * b[i, j]
    return total


@njit(cache=True, nogil=True)
def _advance(
    pressure: NDArray[np.float64],
    direction: NDArray[np.float64],
    step: float,
    hardness: float,
) -> int:
    """Step along the direction and project on the bounds; return how many cells were clipped."""
    clipped = 0
    for i in range(pressure.shape[0]):
        for j in range(pressure.shape[1]):
            p = pressure[i, j] + step * direction[i, j]
            if p < 0.0:
                clipped += 1
                p = 0.0
            elif p > hardness:
                clipped += 1
                p = hardness
            pressure[i, j] = p
    return clipped


@njit(cache=True, nogil=True)
def _complementarity(pressure: NDArray[np.float64], residual: NDArray[np.float64], hardness: float) -> float:
    """Largest violation of the complementarity conditions, in the unit of the residual."""
    worst = 0.0
    for i in range(pressure.shape[0]):
        for j in range(pressure.shape[1]):
            p, g = pressure[i, j], residual[i, j]
            if p <= 0.0:
                g = -g
            elif p < hardness:
                g = abs(g)
            if g > worst:
                worst = g
    return worst


@njit(cache=True, nogil=True)
def _add_scaled(a: NDArray[np.float64], factor: float, b: NDArray[np.float64]) -> None:
    for i in range(a.shape[0]):
        for j in range(a.shape[1]):
            a[i, j] += factor * b[i, j]


@njit(cache=True, nogil=True)
def solve(
    overlap: NDArray[np.float64],
    spectrum: NDArray[np.float64],
    my: int,
    taps: NDArray[np.float64],
    pressure: NDArray[np.float64],
    hardness: float,
    tolerance: float,
    max_iterations: int,
) -> tuple[int, float]:
    """Solve 0 ≤ p ≤ hardness ⟂ K p − overlap on a box, starting from `pressure`, which is overwritten.

    Parameters
    ----------
    overlap : ndarray, shape (nx, ny)
        Overlap of the undeformed bodies, m.
    spectrum : ndarray
        Kernel on the box, from `even_spectrum`, m/Pa.
    my : int
        ``padded_length(ny)``.
    taps : ndarray, shape (6,)
        From `inverse_stencil`, Pa/m.
    pressure : ndarray, shape (nx, ny)
        Start within the bounds; on return the solution, Pa.
    hardness : float
        Upper bound of the pressure, Pa (may be infinite).
    tolerance : float
        Largest complementarity residual, m.
    max_iterations : int
        Iterations allowed.

    Returns
    -------
    iterations : int
        Iterations done.
    residual : float
        Largest complementarity residual reached, m; above `tolerance` the solution did not converge.
    """
    nx, ny = overlap.shape
    masked = np.zeros((nx + 2 * REACH, ny + 2 * REACH))
    z, direction, previous = np.empty((nx, ny)), np.zeros((nx, ny)), np.zeros((nx, ny))
    residual = convolve(pressure, spectrum, my) - overlap
    worst, rho, drifted = _complementarity(pressure, residual, hardness), 0.0, False
    iteration = 0
    while iteration < max_iterations:
        if worst <= tolerance:
            if not drifted:
                break
            # the recurrence says converged: let the true residual confirm it
            residual = convolve(pressure, spectrum, my) - overlap
            worst, drifted = _complementarity(pressure, residual, hardness), False
            continue
        iteration += 1
        _precondition(pressure, residual, hardness, taps, masked, z)
        rho, slope = _direction(residual, previous, z, direction, rho)
        if slope >= 0.0:  # not a descent direction any more: restart from the preconditioned gradient
            direction[:] = -z
            slope = -rho
        response = convolve(direction, spectrum, my)
        curvature = _dot(direction, response)
        if not curvature > 0.0:
            break
        step = -slope / curvature
        previous[:] = residual
        if _advance(pressure, direction, step, hardness):
            residual = convolve(pressure, spectrum, my) - overlap
            drifted = False
        else:
            _add_scaled(residual, step, response)
            drifted = True
        worst = _complementarity(pressure, residual, hardness)
    return iteration, worst


@njit(cache=True, nogil=True)
def unit_indentation(
    free: NDArray[np.bool_],
    spectrum: NDArray[np.float64],
    my: int,
    taps: NDArray[np.float64],
    rtol: float,
    max_iterations: int,
) -> tuple[NDArray[np.float64], bool]:
    """Pressure that displaces a fixed set of cells by one: K p = 1 on the set, p = 0 elsewhere.

    Parameters
    ----------
    free : ndarray of bool, shape (nx, ny)
        The set.
    spectrum, my, taps
        As in `solve`.
    rtol : float
        Largest residual, relative to one.
    max_iterations : int
        Iterations allowed.

    Returns
    -------
    pressure : ndarray, shape (nx, ny)
        Pa per m of indentation; its integral is the tangent stiffness.
    converged : bool
        Whether the residual fell below `rtol`.
    """
    box = free.astype(np.float64)
    masked = np.zeros((free.shape[0] + 2 * REACH, free.shape[1] + 2 * REACH))
    pressure, z, direction = np.zeros_like(box), np.empty_like(box), np.zeros_like(box)
    previous, residual, rho = np.zeros_like(box), -box, 0.0
    for _ in range(max_iterations):
        if np.max(np.abs(residual)) <= rtol:
            return pressure, True
        # a positive "pressure" on the set marks it as free for the preconditioner
        _precondition(box, residual, np.inf, taps, masked, z)
        rho, slope = _direction(residual, previous, z, direction, rho)
        response = convolve(direction, spectrum, my) * box
        step = -slope / _dot(direction, response)
        previous[:] = residual
        _add_scaled(pressure, step, direction)
        _add_scaled(residual, step, response)
    return pressure, False
