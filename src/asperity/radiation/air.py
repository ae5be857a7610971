"""Air at 20 °C and 101.325 kPa."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

SPEED_OF_SOUND = 343.2
"""m/s; ISO 9613-1:1993, reference for 20 °C."""

IMPEDANCE = 413.0
"""Density times speed of sound, Pa s/m."""


def wavenumber(frequency: NDArray[np.float64]) -> NDArray[np.float64]:
    """k = ω/c of sound, rad/m, at frequencies, Hz."""
    return 2.0 * np.pi * frequency / SPEED_OF_SOUND
