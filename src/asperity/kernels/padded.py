"""Free-boundary convolution of whole batches with an even kernel, by zero-padded real transforms.

Written on an array module `xp` (numpy or CuPy), for batches on a device.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.fft
from numpy.typing import NDArray

Array = Any
"""An array of the module `xp`."""


def padded_length(n: int) -> int:
    """Length at which a circular convolution of two records of `n` cells does not wrap.

    Parameters
    ----------
    n : int
        Number of cells.

    Returns
    -------
    int
        A length ≥ 2n − 1 without prime factors above 5.
    """
    return int(scipy.fft.next_fast_len(2 * n - 1, real=True))


def padded_spectrum(table: NDArray[np.float64], nx: int, ny: int) -> NDArray[np.float64]:
    """Spectrum of an even kernel on the padded grid of an (nx, ny) box; it is real.

    Parameters
    ----------
    table : ndarray, shape (≥ nx, ≥ ny)
        Kernel at non-negative separations.
    nx, ny : int
        Box size, cells.

    Returns
    -------
    ndarray, shape (mx, my // 2 + 1)
        Real spectrum, mx and my from `padded_length`.
    """
    mx, my = padded_length(nx), padded_length(ny)
    circulant = np.zeros((mx, my))
    circulant[:nx, :ny] = table[:nx, :ny]
    circulant[mx - nx + 1 :, :ny] = table[nx - 1 : 0 : -1, :ny]
    circulant[:, my - ny + 1 :] = circulant[:, ny - 1 : 0 : -1]
    return np.ascontiguousarray(scipy.fft.rfft2(circulant).real)


def convolve(field: Array, spectrum: Array, my: int, xp: Any) -> Array:
    """Convolve fields on a box with an even kernel, with nothing outside the box.

    Parameters
    ----------
    field : array, shape (b, nx, ny)
        Fields on the box.
    spectrum : array, shape (mx, my // 2 + 1)
        From `padded_spectrum` for this box.
    my : int
        ``padded_length(ny)``.
    xp : module
        numpy or CuPy.

    Returns
    -------
    array, shape (b, nx, ny)
        Convolutions on the box.
    """
    nx, ny = field.shape[1:]
    padded = (spectrum.shape[0], my)
    full = xp.fft.rfft2(field, s=padded)
    full *= spectrum
    return xp.ascontiguousarray(xp.fft.irfft2(full, s=padded)[:, :nx, :ny])
