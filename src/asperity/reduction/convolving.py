"""Convolution of long rows with short weights, by overlapping pieces."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft


def convolved(
    rows: NDArray[np.float64], weights: NDArray[np.float64], piece: int = 2**14
) -> NDArray[np.float64]:
    """Convolve rows (c, n) with weights (s, c, t) and add up the rows: (s, n − t + 1).

    Only where the weights lie on the rows as a whole. Rows are transformed once for all weights, `piece`
    results at a time (overlap-save).
    """
    reach, count = weights.shape[-1] - 1, rows.shape[-1] - weights.shape[-1] + 1
    result = np.empty((len(weights), count))
    piece = min(piece, count)
    period = next_fast_len(piece + reach, real=True)
    transfer = rfft(weights, period)
    for first in range(0, count, piece):
        spectrum = rfft(rows[:, first : first + piece + reach], period)
        found = irfft(np.einsum("cf,scf->sf", spectrum, transfer), period)
        result[:, first : first + piece] = found[:, reach : reach + min(piece, count - first)]
    return result
