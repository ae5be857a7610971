"""Contact on a given set of cells, which is linear: what a pressure displaces, and what a displacement takes.

Asked for once a contact at most, so nothing here is compiled.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from asperity.arguments import Array
from asperity.kernels.batched_cg import apply_stencil
from asperity.kernels.convolution import convolve_padded, padded_length, padded_spectrum


def displaced(table: Array, pressure: Array) -> Array:
    """Displacement (nx, ny), m, under a pressure, Pa; influence table (≥ nx, ≥ ny), m/Pa."""
    nx, ny = pressure.shape
    spectrum = padded_spectrum(table, nx, ny)
    return np.asarray(convolve_padded(pressure[None], spectrum, padded_length(ny), np)[0])


def unit_indentation(
    table: Array, taps: tuple[float, ...], inside: NDArray[np.bool_], rtol: float, max_iterations: int
) -> tuple[Array, bool]:
    """Find the pressure that displaces a set of cells by one: K p = 1 on the set, p = 0 elsewhere.

    Preconditioned conjugate gradients. Influence table (≥ nx, ≥ ny), m/Pa, taps of `inverse_stencil`, Pa/m,
    and the set (nx, ny). Returns the pressure (nx, ny) in Pa per m of indentation, whose integral is the
    tangent stiffness, and whether the residual, relative to one, fell below `rtol`.
    """
    nx, ny = inside.shape
    spectrum, my = padded_spectrum(table, nx, ny), padded_length(ny)
    pressure, direction, rho = np.zeros((nx, ny)), np.zeros((nx, ny)), 1.0
    residual = -inside.astype(np.float64)
    for _ in range(max_iterations):
        if np.abs(residual).max() <= rtol:  # never of NaN
            return pressure, True
        z = apply_stencil(residual[None], taps, np)[0] * inside
        before, rho = rho, float(np.vdot(residual, z))
        direction = rho / before * direction - z
        response = convolve_padded(direction[None], spectrum, my, np)[0]
        length = rho / float(np.vdot(direction, response))
        pressure += length * direction
        residual += length * response * inside
    return pressure, False
