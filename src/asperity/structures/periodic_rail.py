"""The exact receptance of a rail on periodic supports."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity.arguments import Array, Complex, NDArray
from asperity.errors import InputError
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
        mass = self.mass_per_length
        relative = self.losses.at(omega)
        bending = self.bending_stiffness * relative
        free = foundation is None
        held = -mass * omega**2 if foundation is None else foundation - mass * omega**2
        if self.shear_stiffness is None or self.rotary_inertia is None:
            if free:
                k = np.sqrt(omega) * (mass / bending) ** 0.25
            else:
                k = np.exp(-0.25j * np.pi) * (held / bending) ** 0.25
            scale = 1.0 / (4.0 * bending * k**3)
            return np.stack([k, -1j * k]), np.stack([-1j * scale, -scale])
        shear = self.shear_stiffness * relative
        inertia = self.rotary_inertia * omega**2
        if free:
            difference = self.rotary_inertia - mass * bending / shear
            root = omega * np.sqrt(omega**2 * difference**2 + 4.0 * bending * mass)
            first = omega**2 * (self.rotary_inertia + mass * bending / shear) + root
        else:
            middle = inertia - held * bending / shear
            root = np.sqrt((inertia + held * bending / shear) ** 2 - 4.0 * bending * held)
            first = middle + np.where(np.real(root * np.conj(middle)) < 0.0, -root, root)
        product = held * (1.0 - inertia / shear)  # of the roots, times EI
        squares = np.stack([first / (2.0 * bending), 2.0 * product / first])
        k = decaying(squares)
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
        k = np.pi / length
        bending = self.bending_stiffness
        mass = self.mass_per_length
        if self.shear_stiffness is None or self.rotary_inertia is None:
            return float(k**2 * np.sqrt(bending / mass) / (2.0 * np.pi))
        shear = self.shear_stiffness
        inertia = self.rotary_inertia
        middle = mass + (inertia + mass * bending / shear) * k**2
        root = np.sqrt(middle**2 - 4.0 * mass * inertia / shear * bending * k**4)
        return float(np.sqrt(2.0 * bending * k**4 / (middle + root)) / (2.0 * np.pi))

    @property
    def static(self) -> tuple[float, float]:
        """Bending stiffness at rest, N m², and shear compliance, 1/N."""
        rest = self.losses.static
        shear = self.shear_stiffness
        return self.bending_stiffness * rest, 1.0 / (shear * rest) if shear else 0.0


_LARGEST_EXPONENT = 200.0  # products of three exponentials stay inside the range of doubles


@dataclass(frozen=True, eq=False)
class PeriodicWaves:
    """The two Floquet waves of a periodically supported rail at each frequency.

    With 0 <= x0 <= L and x = p L + xi >= x0, the displacement at x per force at x0 is G(x|x0) = sum_j
    coefficients_j multipliers_j**p outgoing(xi)_j incoming(x0)_j.

    The shapes are those of the Floquet sum phi_lambda(x) = sum_n lambda^n G_0(x - n L), multiplied by (cos
    k_1 L - c)(cos k_2 L - c), c = (lambda + 1/lambda)/2, and the coefficients divided by its square. So
    written, nothing becomes infinite where the supports exert no force.
    """

    multipliers: Complex  # (2, f), lambda_j, the change of wave j over one bay, |lambda_j| < 1
    coefficients: Complex  # (2, f), C_j, N/m times the square of the scale that the shapes carry
    wavenumbers: Complex  # (2, f), k_i of the free rail, rad/m, Im k_i <= 0
    weights: Complex  # (2, 2, f), share of the free wave i in wave j, axes (i, j, f)
    spacing: float  # distance of the supports L, m
    bays = 1  # after which the track repeats

    def bay(self, number: int) -> "PeriodicWaves":
        """Itself, as every bay: `asperity.structures.cell_waves.CellWaves` has others."""
        return self

    def at_first(self, count: int) -> "PeriodicWaves":
        """The same waves at so many of its frequencies, the first."""
        own = (self.multipliers, self.coefficients, self.wavenumbers, self.weights)
        multipliers, coefficients, wavenumbers, weights = (each[..., :count] for each in own)
        return PeriodicWaves(multipliers, coefficients, wavenumbers, weights, self.spacing)

    @property
    def spans(self) -> "list[PeriodicWaves]":
        """Stretches from each support to the next, as of `CellWaves`."""
        return [self]

    @property
    def steps(self) -> Complex:
        """Change of each wave from a span to the next (1, 2, f)."""
        return self.multipliers[None]

    @property
    def edges(self) -> Array:
        """Places of the support, zero, and of the end of the bay, m."""
        return np.array([0.0, self.spacing])

    def carried(self, first: int, last: int, zone: slice = slice(None)) -> Complex:
        """Change of each wave (2, f) from one bay to another one, in either direction, in a zone of f."""
        return whole_power(self.multipliers[:, zone], abs(last - first))

    def outgoing(self, x: float) -> Complex:
        """Shapes (2, f) of the waves that decay towards growing x, 0 <= x <= L, m: phi_lambda(x), scaled."""
        near, far = self._from_both_ends(x)
        return far + self.multipliers * near

    def incoming(self, x: float) -> Complex:
        """Shapes (2, f) of the waves that grow towards growing x, 0 <= x <= L: phi_{1/lambda}(x), scaled."""
        near, far = self._from_both_ends(x)
        return far + near / self.multipliers

    def symmetric_shapes(self, places: Array) -> tuple[Complex, Complex]:
        """Shapes at places (p,), m, that lie symmetrically about the middle of the bay: two of (p, 2, f).

        The first decay towards growing x, the second grow: `outgoing` and `incoming` for less work.
        """
        return self._of_sines(np.sin(self.wavenumbers * places[:, None, None]))

    def shapes_at_nodes(self, count: int) -> tuple[Complex, Complex]:
        """As `symmetric_shapes`, at the ends of so many equal parts of the bay; sines follow one another."""
        step = self.wavenumbers * (self.spacing / count)
        sines = np.zeros((count + 1, *step.shape), complex)
        sines[1] = np.sin(step)
        twice = 2.0 * np.cos(step)
        for node in range(2, count + 1):
            np.multiply(twice, sines[node - 1], out=sines[node])
            sines[node] -= sines[node - 2]
        return self._of_sines(sines)

    def _of_sines(self, sines: Complex) -> tuple[Complex, Complex]:
        near = np.einsum("ijf,pif->pjf", self.weights, sines)
        return near[::-1] + self.multipliers * near, near[::-1] + near / self.multipliers

    def _from_both_ends(self, x: float) -> tuple[Complex, Complex]:
        """What shapes consist of: sines from the support before a place and from the next, each (2, f)."""
        near, far = (
            np.einsum("ijf,if->jf", self.weights, np.sin(self.wavenumbers * at))
            for at in (x, self.spacing - x)
        )
        return near, far

    def receptance(self, x: float, x0: float) -> Complex:
        """Displacement at `x` per force at `x0`, (f,), m/N; positions from any support, m."""
        (found,) = self.receptances([max(x, x0)], min(x, x0))
        return found

    def receptances(self, places: Sequence[float], x0: float) -> list[Complex]:
        """Displacements (f,), m/N, at places, none before `x0`, per force there; from any support, m."""
        first_bay = math.floor(x0 / self.spacing)
        start = x0 - first_bay * self.spacing
        near, far = self._from_both_ends(start)
        incoming = far + near / self.multipliers
        found = []
        for last in places:
            bays = math.floor(last / self.spacing)
            along = last - bays * self.spacing
            outgoing = far + self.multipliers * near if along == start else self.outgoing(along)
            waves = self.coefficients * outgoing * incoming
            found.append(np.sum(waves * whole_power(self.multipliers, bays - first_bay), axis=0))
        return found


def whole_power(base: Complex, exponent: int) -> Complex:
    """A power of whole exponent, zero or more, by squares: beyond 100 NumPy's takes fifty times as long."""
    found = np.ones_like(base)
    while exponent:
        if exponent % 2:
            found = found * base
        exponent //= 2
        if exponent:
            base = base * base
    return found


def periodic_waves(
    wavenumbers: Complex, amplitudes: Complex, support: Complex, spacing: float
) -> PeriodicWaves:
    """Floquet waves from the receptance of the free rail, G_0(x) = sum_i A_i exp(-i k_i |x|).

    Wavenumbers k_i, rad/m, and amplitudes A_i, m/N, are (2, f), the dynamic stiffness K of a support, N/m,
    (f,); the supports are L apart, m. An `InputError` says if a free wave decays by more than exp(-200) in
    one bay.

    1 + K phi_lambda(0) = 0 is the quadratic c^2 - B c + D = 0 with a_i = i K A_i sin k_i L, C_i = cos k_i L,
    B = C_1 + C_2 + a_1 + a_2, D = C_1 C_2 + a_1 C_2 + a_2 C_1; the superposition of the supports is the sum
    of the residues at its roots.
    """
    phase = wavenumbers * spacing
    refuse_decay(phase.imag)
    sine = np.sin(phase)
    cosine = np.cos(phase)
    unit = 1j * amplitudes * sine  # a_i per support stiffness
    c_1, c_2 = cosine
    u_1, u_2 = unit
    total = c_1 + c_2 + support * (u_1 + u_2)
    product = c_1 * c_2 + support * (u_1 * c_2 + u_2 * c_1)
    root = np.sqrt(total**2 - 4.0 * product)
    sign = np.where(np.real(root * np.conj(total)) < 0.0, -1.0, 1.0)
    larger = 0.5 * (total + sign * root)
    c = np.stack([larger, product / larger])
    multipliers = multipliers_of(c)
    slope = u_1 * (c - c_2) + u_2 * (c - c_1)  # (C_1 - c)(C_2 - c) / K on the roots
    coefficients = -2.0 / (slope * (c - c[::-1]) * (multipliers - 1.0 / multipliers))
    weights = 1j * amplitudes[:, None] * (cosine[::-1, None] - c)
    return PeriodicWaves(multipliers, coefficients, wavenumbers, weights, spacing)


def multipliers_of(c: NDArray[Any]) -> Complex:
    """Multipliers λ from bay to bay of waves that grow no more, by c = (λ + 1/λ)/2."""
    root = np.sqrt(c - 1.0) * np.sqrt(c + 1.0)
    return 1.0 / np.where(np.real(root * np.conj(c)) < 0.0, c - root, c + root)


def decaying(square: Complex) -> Complex:
    """Wavenumbers by their squares, of waves that decay away from where they start."""
    k = np.sqrt(square)
    return np.where(k.imag > 0.0, -k, k)


def refuse_decay(exponent: Array) -> None:
    """Refuse waves of a rail that decay by more than exp(-200) over a bay, of which exponents are given."""
    if (largest := np.abs(exponent).max(initial=0.0)) > _LARGEST_EXPONENT:
        raise InputError(
            "decay of a rail wave over one bay (neper)",
            f"{largest:.4g}",
            f"at most {_LARGEST_EXPONENT:g}",
            "Lower the highest frequency, in a case numerics.highest_frequency.",
        )


def static_receptance(stiffness: float, shear: float, support: float, spacing: float, x: float) -> float:
    """Static deflection per unit force, m/N, the limit of the Floquet sum at zero frequency.

    E I, N m^2; 1/S = 1/G A kappa, 1/N; K of one support, N/m; position x of the force in the bay, 0 <= x <=
    L, m. With y = 1 - c, G_0 = |x|^3/12EI - |x|/2S gives phi(0) = L^3/(4EI y^2) + b/y, b = L/(2S) -
    L^3/(12EI), and the multipliers from y^2 + K b y + K L^3/(4EI) = 0.
    """
    bending = 1.0 / stiffness
    cubic = 0.25 * bending * spacing**3
    linear = 0.5 * shear * spacing - bending * spacing**3 / 12.0
    y = np.roots(np.array([1.0, support * linear, support * cubic], dtype=complex))
    multipliers = multipliers_of(1.0 - y)

    def shape(multiplier: Complex) -> Complex:
        ramp = (spacing - x) + multiplier * x
        cube = (spacing - x) ** 3 + multiplier * x**3
        slope = bending * spacing**2 / (4.0 * y**2) + 0.5 * shear / y
        return slope * ramp - bending * cube / (12.0 * y)

    change = 2.0 * cubic / y**3 + linear / y**2  # d phi(0)/d c
    coefficients = -2.0 / (change * (multipliers - 1.0 / multipliers))
    return float(np.sum(coefficients * shape(multipliers) * shape(1.0 / multipliers)).real)
