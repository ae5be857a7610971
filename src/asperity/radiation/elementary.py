"""Radiation ratios of bodies whose sound field is known in closed form.

The ratio σ is that of the sound power to ρ c S ⟨v²⟩, where ⟨v²⟩ is the mean square of the normal velocity
over the radiating surface S (of two-dimensional bodies per length). The arguments ka hold the wavenumber
k = ω/c, rad/m, and a radius a, m.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import h2vp, j1

from asperity.errors import InputError

_SMALL = 1e-2  # from here down a piston follows its series


def cylinder(ka: ArrayLike, order: int = 1) -> NDArray[np.float64]:
    """Radiation ratio of a cylinder of infinite length whose surface moves as cos(nθ).

    Parameters
    ----------
    ka : array_like
        Positive.
    order : int
        n: 0 breathes (line monopole), 1 oscillates as a rigid body (line dipole).

    Returns
    -------
    ndarray
        2/(π ka |H_n'(ka)|²), of the shape of `ka`.

    Raises
    ------
    InputError
        If ka is not positive, or the order negative.

    Notes
    -----
    Outside, p = A H_n(kr) cos(nθ) with Hankel's function of the second kind; −∂p/∂r = iωρ v cos(nθ) on the
    surface gives |A| = ρ c v/|H_n'(ka)|. Far away |H_n|² = 2/(πkr); the power that passes is divided by that
    of a plane wave of the same mean square velocity. Of an oscillating rigid cylinder ⟨v_n²⟩ is half
    of its ⟨v²⟩. Limits: (π/2)(ka)³ for n = 1 and (π/2) ka for n = 0 at low ka, 1 at high ka.
    """
    ka = _positive(ka)
    if order < 0:
        raise InputError("order of the motion around a cylinder", order, "zero or more")
    return np.asarray(2.0 / (np.pi * ka * np.abs(h2vp(order, ka)) ** 2))


def baffled_piston(ka: ArrayLike) -> NDArray[np.float64]:
    """Radiation ratio of a rigid circular piston in an infinite plane, at positive ka.

    1 − J₁(2ka)/ka (Rayleigh 1896): (ka)²/2 at low ka, 1 at high ka. An `InputError` says if ka is not
    positive.
    """
    ka = _positive(ka)
    series = 0.5 * ka**2 * (1.0 - ka**2 / 6.0)
    return np.where(ka < _SMALL, series, 1.0 - j1(2.0 * ka) / ka)


def _positive(ka: ArrayLike) -> NDArray[np.float64]:
    values = np.asarray(ka, dtype=float)
    if not ((values > 0.0) & (values < np.inf)).all():
        raise InputError("wavenumber times radius", float(np.min(values)), "finite positive numbers")
    return values
