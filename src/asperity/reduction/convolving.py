"""Convolution of long rows with short weights, by overlapping pieces."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft

PIECE = 2**14


class LongConvolution:
    """Convolution with weights (s, c, t), which are transformed once for all rows, and these for all weights.

    Results come in pieces of at most so many (overlap-save).
    """

    def __init__(self, weights: NDArray[np.float64], piece: int = PIECE) -> None:
        self.reach, self.piece = weights.shape[-1] - 1, piece
        self.period = next_fast_len(piece + self.reach, real=True)
        self.transfer = rfft(weights, self.period)

    def of(self, rows: NDArray[np.float64]) -> NDArray[np.float64]:
        """Convolve rows (c, n), where weights lie on them as a whole, and add them up: (s, n − t + 1)."""
        count = rows.shape[-1] - self.reach
        result = np.empty((len(self.transfer), count))
        for first in range(0, count, self.piece):
            spectrum = rfft(rows[:, first : first + self.piece + self.reach], self.period)
            found = irfft(np.einsum("cf,scf->sf", spectrum, self.transfer), self.period)
            last = min(first + self.piece, count)
            result[:, first:last] = found[:, self.reach : self.reach + last - first]
        return result
