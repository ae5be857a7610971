"""Waves of a rail without supports, Euler-Bernoulli or Timoshenko."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def free_rail_waves(
    omega: NDArray,
    bending_stiffness: complex | NDArray,
    mass_per_length: float,
    shear_stiffness: complex | NDArray | None = None,
    rotary_inertia: float | None = None,
) -> tuple[NDArray, NDArray]:
    """Receptance of a free infinite rail as a sum of two waves.

    Parameters
    ----------
    omega : ndarray (f,) of complex
        Angular frequency, rad/s, with positive real part or in the lower half-plane.
    bending_stiffness : complex or ndarray (f,)
        E I with its losses, N m^2.
    mass_per_length : float
        m', kg/m.
    shear_stiffness : complex or ndarray (f,), optional
        S = G A kappa with its losses, N; with `rotary_inertia` a Timoshenko rail.
    rotary_inertia : float, optional
        rho I, kg m.

    Returns
    -------
    wavenumbers, amplitudes : ndarray (2, f) of complex
        k_i, rad/m, Im k_i <= 0, and A_i, m/N, of G_0(x) = sum_i A_i exp(-i k_i |x|).

    Notes
    -----
    Residues of the wavenumber spectrum (1 + (EI k^2 - rho I omega^2)/S)/(EI (k^2 - k_1^2)(k^2 - k_2^2))
    at the roots of EI k^4 - omega^2 (rho I + m' EI/S) k^2 - m' omega^2 (1 - rho I omega^2/S) = 0.
    """
    bending, mass = bending_stiffness, mass_per_length
    if shear_stiffness is None or rotary_inertia is None:
        k = np.sqrt(omega) * (mass / bending) ** 0.25
        scale = 1.0 / (4.0 * bending * k**3)
        return np.stack([k, -1j * k]), np.stack([-1j * scale, -scale])
    shear, inertia = shear_stiffness, rotary_inertia
    difference = inertia - mass * bending / shear
    root = omega * np.sqrt(omega**2 * difference**2 + 4.0 * bending * mass)
    first = omega**2 * (inertia + mass * bending / shear) + root
    product = -mass * omega**2 * (1.0 - inertia * omega**2 / shear)  # of the roots, times EI
    squares = np.stack([first / (2.0 * bending), 2.0 * product / first])
    k = np.sqrt(squares)
    k = np.where(k.imag > 0.0, -k, k)
    rotation = (bending * squares + shear - inertia * omega**2) / shear
    return k, -1j * rotation / (2.0 * k * bending * (squares - squares[::-1]))


def pinned_frequency(
    length: float,
    bending_stiffness: float,
    mass_per_length: float,
    shear_stiffness: float | None = None,
    rotary_inertia: float | None = None,
) -> float:
    """Lowest natural frequency of a rail that is simply supported at equal distances.

    Parameters
    ----------
    length : float
        Distance of the supports, m.
    bending_stiffness, mass_per_length, shear_stiffness, rotary_inertia : float
        As in `free_rail_waves`, without loss factor.

    Returns
    -------
    float
        Hz: the frequency at which k = pi/length solves the dispersion relation.
    """
    k, bending, mass = np.pi / length, bending_stiffness, mass_per_length
    if shear_stiffness is None or rotary_inertia is None:
        return float(k**2 * np.sqrt(bending / mass) / (2.0 * np.pi))
    middle = mass + (rotary_inertia + mass * bending / shear_stiffness) * k**2
    root = np.sqrt(middle**2 - 4.0 * mass * rotary_inertia / shear_stiffness * bending * k**4)
    return float(np.sqrt(2.0 * bending * k**4 / (middle + root)) / (2.0 * np.pi))
