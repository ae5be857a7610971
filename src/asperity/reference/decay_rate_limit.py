"""Least vertical decay rate of a track for tests of vehicles, in one-third octaves."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from asperity.arguments import Array

_HALF_BAND = 10.0**0.05
_FROM_BAND_DB_PER_M = ((250.0, 2.0), (400.0, 6.0), (800.0, 2.19), (1000.0, 0.8))
_LAST_BAND = 5000.0


def iso_3095_decay_rate(frequency: ArrayLike) -> Array:
    """Lower limit of the vertical decay rate of a reference track, dB/m, at frequencies (f,), Hz.

    That of the one-third octave which holds the frequency; NaN below 250 Hz and above 5 kHz. ISO 3095:2013;
    the edition of 2025 has not been compared.
    """
    at = np.asarray(frequency, dtype=np.float64)
    limit = np.full(at.shape, np.nan)
    for first, value in _FROM_BAND_DB_PER_M:
        limit[at >= first / _HALF_BAND] = value
    limit[at > _LAST_BAND * _HALF_BAND] = np.nan
    return limit
