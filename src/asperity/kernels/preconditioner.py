"""Approximate inverse of the influence of pressure, as a short stencil on a set of cells."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.box import Box
from asperity.kernels.convolution import quarter_spectrum
from asperity.kernels.options import INNER, REASSOCIATE, compiled


def inverse_stencil(table: NDArray[np.float64]) -> NDArray[np.float64]:
    """Fit a 13-point stencil whose symbol approximates the inverse of that of a kernel (≥ 32, ≥ 32).

    The kernel is given at non-negative separations. Returns the taps at (0,0), (±1,0), (0,±1), (±1,±1),
    (±2,0), (0,±2), in units of the inverse kernel. The symbol is positive, so the stencil restricted to any
    set of cells is positive definite.
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
    # the fit may fall below zero, where steps would climb: it keeps a tenth of the least it stands for
    floor = 0.1 / float(symbol.max())
    coefficients[0] += max(0.0, floor - lowest)
    return np.asarray(coefficients)


@compiled(**INNER, **REASSOCIATE)
def precondition(
    b: Box, taps: NDArray[np.float64], target: NDArray[np.float64]
) -> tuple[float, float, float]:
    """Apply the stencil (Pa/m) to what is masked, m, where that is not zero, into `target`.

    Returns m·target, (m − previous)·target and the sum of the target.
    """
    row = b.pitch
    above, m, below = b.masked[row - 1 :], b.masked[2 * row - 2 :], b.masked[3 * row - 1 :]
    top, bottom = b.masked, b.masked[4 * row :]
    c0, c1, c2, c3, c4, c5 = taps[0], taps[1], taps[2], taps[3], taps[4], taps[5]
    zero = b.z.dtype.type(0.0)
    rho, change, total = zero, zero, zero
    for q in range(len(target)):
        g = m[q + 2]
        s = c0 * g + c1 * (above[q + 1] + below[q + 1]) + c2 * (m[q + 1] + m[q + 3])
        s += c3 * (above[q] + above[q + 2] + below[q] + below[q + 2])
        s += c4 * (top[q] + bottom[q]) + c5 * (m[q] + m[q + 4])
        s = s if g != zero else zero
        target[q] = s
        rho += g * s
        change += (g - b.previous[q]) * s
        total += s
    return rho, change, total
