"""Free-boundary convolution with an even kernel, by zero-padded real FFTs that skip the zeros.

Compiled code calls `scipy.fft` through rocket-fft, which registers itself with numba when installed.
"""

from __future__ import annotations

import numpy as np
import scipy.fft
from numba import njit
from numpy.typing import NDArray


def padded_length(n: int) -> int:
    """Length at which a circular convolution of two records of `n` cells does not wrap.

    Parameters
    ----------
    n : int
        Number of cells.

    Returns
    -------
    int
        A length ≥ 2n − 1 that transforms fast.
    """
    return int(scipy.fft.next_fast_len(2 * n - 1, real=True))


def even_spectrum(table: NDArray[np.float64], nx: int, ny: int) -> NDArray[np.float64]:
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


@njit(cache=True, nogil=True)
def convolve(field: NDArray[np.float64], spectrum: NDArray[np.float64], my: int) -> NDArray[np.float64]:
    """Convolve a field on a box with an even kernel, with nothing outside the box.

    Parameters
    ----------
    field : ndarray, shape (nx, ny)
        Field on the box.
    spectrum : ndarray, shape (mx, my // 2 + 1)
        From `even_spectrum` for this box.
    my : int
        ``padded_length(ny)``.

    Returns
    -------
    ndarray, shape (nx, ny)
        Convolution on the box.
    """
    nx, ny = field.shape
    mx = spectrum.shape[0]
    # transforming y first and cutting x first leaves the zero rows out of half of the work
    full = scipy.fft.fft(scipy.fft.rfft(field, my, 1), mx, 0)
    full *= spectrum
    rows = scipy.fft.ifft(full, mx, 0)[:nx]
    return scipy.fft.irfft(rows, my, 1)[:, :ny].copy()
