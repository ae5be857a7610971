"""Free-boundary convolution of whole batches with an even kernel, by zero-padded real transforms.

Written on an array module `xp` (numpy or CuPy), for batches on a device.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.fourier import smooth_length

Array = Any
"""An array of the module `xp`."""


def padded_length(n: int) -> int:
    """Length ≥ 2n − 1 that transforms fast: a circular convolution of n cells does not wrap."""
    return smooth_length(2 * n - 1)


def padded_spectrum(table: NDArray[np.float64], nx: int, ny: int) -> NDArray[np.float64]:
    """Real spectrum (mx, my // 2 + 1) of an even kernel on the padded grid of an (nx, ny) box.

    The kernel (≥ nx, ≥ ny) is given at non-negative separations; mx and my are from `padded_length`.
    """
    mx, my = padded_length(nx), padded_length(ny)
    circulant = np.zeros((mx, my))
    circulant[:nx, :ny] = table[:nx, :ny]
    circulant[mx - nx + 1 :, :ny] = table[nx - 1 : 0 : -1, :ny]
    circulant[:, my - ny + 1 :] = circulant[:, ny - 1 : 0 : -1]
    return np.ascontiguousarray(np.fft.rfft2(circulant).real)


def convolve_padded(field: Array, spectrum: Array, my: int, xp: Any) -> Array:
    """Convolve fields (b, nx, ny) on a box with an even kernel, with nothing outside the box.

    The spectrum is from `padded_spectrum` for this box, `my` is ``padded_length(ny)``.
    """
    nx, ny = field.shape[1:]
    padded = (spectrum.shape[0], my)
    full = xp.fft.rfft2(field, s=padded)
    full *= spectrum
    return xp.ascontiguousarray(xp.fft.irfft2(full, s=padded)[:, :nx, :ny])
