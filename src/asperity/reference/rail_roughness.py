"""Rail roughness spectra: one-third-octave levels in wavelength, dB re 1 µm."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

ISO_3095_WAVELENGTH_CM = (
    40.0, 31.5, 25.0, 20.0, 16.0, 12.5, 10.0, 8.0, 6.3, 5.0, 4.0,
    3.15, 2.5, 2.0, 1.6, 1.25, 1.0, 0.8, 0.63, 0.5, 0.4, 0.315,
)  # fmt: skip
ISO_3095_LEVEL_DB = (
    17.1, 15.0, 13.0, 11.0, 9.0, 7.0, 4.9, 2.9, 0.9, -1.1, -3.2,
    -5.0, -5.6, -6.2, -6.8, -7.4, -8.0, -8.6, -9.2, -9.8, -10.4, -11.0,
)  # fmt: skip


def iso_3095_limit() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Upper limit of the rail roughness of a reference track: nominal wavelengths (22,), m, and dB re 1 µm.

    ISO 3095:2013; the edition of 2025 has not been compared.
    """
    return np.array(ISO_3095_WAVELENGTH_CM) * 1e-2, np.array(ISO_3095_LEVEL_DB)
