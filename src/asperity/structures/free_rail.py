"""Waves of a rail without supports, Euler-Bernoulli or Timoshenko."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def free_rail_waves(
    omega: NDArray[np.float64],
    bending_stiffness: complex | NDArray[np.complex128],
    mass_per_length: float,
    shear_stiffness: complex | NDArray[np.complex128] | None = None,
    rotary_inertia: float | None = None,
) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Receptance of a free infinite rail as a sum of two waves, G_0(x) = sum_i A_i exp(-i k_i |x|).

    Wavenumbers k_i, rad/m, Im k_i <= 0, and amplitudes A_i, m/N, both (2, f), at angular frequencies (f,),
    rad/s, with positive real part or in the lower half-plane. Bending stiffness E I, N m^2, and shear
    stiffness S = G A kappa, N, with their losses; mass m', kg/m; rotary inertia rho I, kg m. The latter with
    the shear stiffness makes it a Timoshenko rail.

    Residues of the wavenumber spectrum (1 + (EI k^2 - rho I omega^2)/S)/(EI (k^2 - k_1^2)(k^2 - k_2^2)) at
    the roots of EI k^4 - omega^2 (rho I + m' EI/S) k^2 - m' omega^2 (1 - rho I omega^2/S) = 0.
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
    """Lowest natural frequency, Hz, of a rail that is simply supported at equal distances, m.

    The frequency at which k = pi/length solves the dispersion relation; the rail as in `free_rail_waves`,
    without loss factor.
    """
    k, bending, mass = np.pi / length, bending_stiffness, mass_per_length
    if shear_stiffness is None or rotary_inertia is None:
        return float(k**2 * np.sqrt(bending / mass) / (2.0 * np.pi))
    middle = mass + (rotary_inertia + mass * bending / shear_stiffness) * k**2
    root = np.sqrt(middle**2 - 4.0 * mass * rotary_inertia / shear_stiffness * bending * k**4)
    return float(np.sqrt(2.0 * bending * k**4 / (middle + root)) / (2.0 * np.pi))
