"""A rail without supports."""

from dataclasses import dataclass

import numpy as np

from asperity.arguments import Complex
from asperity.structures.support import Losses


@dataclass(frozen=True)
class Rail:
    """A rail without supports: Euler-Bernoulli, or with shear stiffness and rotary inertia Timoshenko."""

    bending_stiffness: float  # E I, N m²
    mass_per_length: float  # m', kg/m
    losses: Losses  # of both stiffnesses
    shear_stiffness: float | None = None  # S = G A κ, N
    rotary_inertia: float | None = None  # ρ I, kg m

    def waves(self, omega: Complex, foundation: Complex | None = None) -> tuple[Complex, Complex]:
        """Receptance of an infinite rail as a sum of two waves, G_0(x) = sum_i A_i exp(-i k_i |x|).

        Wavenumbers k_i, rad/m, Im k_i <= 0, and amplitudes A_i, m/N, both (2, f), at angular frequencies
        (f,), rad/s, with positive real part or in the lower half-plane.

        Residues of the wavenumber spectrum (1 + (EI k^2 - rho I omega^2)/S)/(EI (k^2 - k_1^2)(k^2 - k_2^2))
        at the roots of EI k^4 - omega^2 (rho I + m' EI/S) k^2 - m' omega^2 (1 - rho I omega^2/S) = 0. The
        rail is free, or lies on a foundation s (f,), N/m^2, whose dynamic stiffness takes from its inertia:
        m' omega^2 - s stands for m' omega^2, as in EI k^4 + s - m' omega^2 = 0 of Euler-Bernoulli.
        """
        if foundation is not None:
            return self._bedded(omega, foundation)
        relative, mass = self.losses.at(omega), self.mass_per_length
        bending = self.bending_stiffness * relative
        if self.shear_stiffness is None or self.rotary_inertia is None:
            k = np.sqrt(omega) * (mass / bending) ** 0.25
            scale = 1.0 / (4.0 * bending * k**3)
            return np.stack([k, -1j * k]), np.stack([-1j * scale, -scale])
        shear, inertia = self.shear_stiffness * relative, self.rotary_inertia
        difference = inertia - mass * bending / shear
        root = omega * np.sqrt(omega**2 * difference**2 + 4.0 * bending * mass)
        first = omega**2 * (inertia + mass * bending / shear) + root
        product = -mass * omega**2 * (1.0 - inertia * omega**2 / shear)  # of the roots, times EI
        squares = np.stack([first / (2.0 * bending), 2.0 * product / first])
        k = np.sqrt(squares)
        k = np.where(k.imag > 0.0, -k, k)
        rotation = (bending * squares + shear - inertia * omega**2) / shear
        return k, -1j * rotation / (2.0 * k * bending * (squares - squares[::-1]))

    def _bedded(self, omega: Complex, foundation: Complex) -> tuple[Complex, Complex]:
        relative = self.losses.at(omega)
        bending, held = self.bending_stiffness * relative, foundation - self.mass_per_length * omega**2
        if self.shear_stiffness is None or self.rotary_inertia is None:
            k = np.exp(-0.25j * np.pi) * (held / bending) ** 0.25
            scale = 1.0 / (4.0 * bending * k**3)
            return np.stack([k, -1j * k]), np.stack([-1j * scale, -scale])
        shear, inertia = self.shear_stiffness * relative, self.rotary_inertia * omega**2
        middle = inertia - held * bending / shear
        root = np.sqrt((inertia + held * bending / shear) ** 2 - 4.0 * bending * held)
        first = middle + np.where(np.real(root * np.conj(middle)) < 0.0, -root, root)
        squares = np.stack([first / (2.0 * bending), 2.0 * held * (1.0 - inertia / shear) / first])
        k = np.sqrt(squares)
        k = np.where(k.imag > 0.0, -k, k)
        rotation = (bending * squares + shear - inertia) / shear
        return k, -1j * rotation / (2.0 * k * bending * (squares - squares[::-1]))

    def deflection_on(self, foundation: float) -> float:
        """Deflection at rest under a unit force, m/N, on a foundation, N/m^2: Winkler's, with shear.

        (1/sqrt(q) + EI/S)/(2 EI sqrt(p + 2 sqrt(q))), q = s/EI, p = s/S, the integral of the wavenumber
        spectrum at zero frequency.
        """
        bending, shear = self.static
        root = float(np.sqrt(foundation / bending))
        return (1.0 / root + bending * shear) / (
            2.0 * bending * float(np.sqrt(foundation * shear + 2.0 * root))
        )

    def pinned_frequency(self, length: float) -> float:
        """Lowest natural frequency, Hz, if it is simply supported at equal distances, m, without losses.

        The frequency at which k = pi/length solves the dispersion relation.
        """
        k, bending, mass = np.pi / length, self.bending_stiffness, self.mass_per_length
        if self.shear_stiffness is None or self.rotary_inertia is None:
            return float(k**2 * np.sqrt(bending / mass) / (2.0 * np.pi))
        shear, inertia = self.shear_stiffness, self.rotary_inertia
        middle = mass + (inertia + mass * bending / shear) * k**2
        root = np.sqrt(middle**2 - 4.0 * mass * inertia / shear * bending * k**4)
        return float(np.sqrt(2.0 * bending * k**4 / (middle + root)) / (2.0 * np.pi))

    @property
    def static(self) -> tuple[float, float]:
        """Bending stiffness at rest, N m², and shear compliance, 1/N."""
        rest, shear = self.losses.static, self.shear_stiffness
        return self.bending_stiffness * rest, 1.0 / (shear * rest) if shear else 0.0
