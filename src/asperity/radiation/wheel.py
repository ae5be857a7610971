"""How fast each mode of a wheel moves in a run, from the spectra of its contact force and of its motion."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import beta, gamma

from asperity.arguments import Array, ArrayLike, Integers
from asperity.radiation.track import IMPEDANCE, SPEED_OF_SOUND, above_zero
from asperity.structures.body import Wheel
from asperity.structures.modal import modal_answers

POINTS = 41
"""Places at which a resonance is looked at, where lines are too far apart for it."""


def modal_velocity_psd(
    wheel: Wheel, frequency: Array, force: Array, displacement: Array, compliance: Array
) -> Array:
    """PSDs of the radial velocity at the contact of the wheel's rigid motion and of each of its modes.

    Parameters
    ----------
    wheel : Wheel
        With p modes.
    frequency : ndarray (f,)
        Lines, Hz, above zero, uniform and rising.
    force, displacement : ndarray (l, f)
        One-sided PSDs of the contact force, N²/Hz, and of the wheel's displacement at the contact, m²/Hz.
    compliance : ndarray (f,)
        |α₀| about that of contact and rail, m/N.

    Returns
    -------
    ndarray (p + 1, l, f)
        (m/s)²/Hz; the rigid motion first.

    Notes
    -----
    S_i = ω²|α_i|²/(|α₀|² + |α_W|²) · (|α₀|² S_F + S_x). For S_x = |α_W|² S_F this is ω²|α_i|² S_F whatever
    α₀ is. The force falls where the wheel resonates, and its motion where the resonances cancel, both within
    less than a line; their sum does neither, so that what multiplies it may be averaged over each line.
    """
    weight = _line_means(wheel, frequency, compliance)
    return weight[:, None] * (compliance**2 * force + displacement)


def _line_means(wheel: Wheel, frequency: Array, compliance: Array) -> Array:
    """Mean of ω²|α_i|²/(|α₀|² + |α_W|²) over each line (p + 1, f), with every resonance resolved."""
    fine, edges = fine_lines(frequency, wheel.natural_frequencies, wheel.damping_ratios)
    omega = 2.0 * np.pi * fine
    flexible = modal_answers(fine, wheel.natural_frequencies, wheel.damping_ratios) / wheel.modal_masses
    each = np.column_stack([-1.0 / (wheel.mass * omega**2), flexible]).T
    other = np.interp(fine, frequency, compliance) ** 2
    value = omega**2 * np.abs(each) ** 2 / (other + np.abs(each.sum(axis=0)) ** 2)
    return line_means(value, fine, edges)


def fine_lines(frequency: Array, natural: Array, damping: Array) -> tuple[Array, Array]:
    """Frequencies that resolve every resonance, and the edges of lines (f + 1,) among them, Hz.

    Lines (f,), Hz, above zero, uniform and rising; natural frequencies, Hz, and damping ratios (p,).
    """
    step = frequency[1] - frequency[0]
    edges = np.concatenate([frequency - 0.5 * step, frequency[-1:] + 0.5 * step])
    edges[0] = max(edges[0], 1e-3 * step)
    at = [edges, frequency]
    for own, ratio in zip(natural, damping, strict=True):
        reach = np.arcsinh(2.0 * step / (ratio * own))
        at.append(own * (1.0 + ratio * np.sinh(np.linspace(-reach, reach, POINTS))))
    return np.unique(np.clip(np.concatenate(at), edges[0], edges[-1])), edges


def line_means(value: Array, fine: Array, edges: Array) -> Array:
    """Mean over each line (n, f) of values (n, k) at the frequencies of `fine_lines`."""
    area = 0.5 * (value[:, 1:] + value[:, :-1]) * np.diff(fine)
    summed = np.concatenate([np.zeros((len(value), 1)), np.cumsum(area, axis=1)], axis=1)
    return np.diff(summed[:, np.searchsorted(fine, edges)], axis=1) / np.diff(edges)


def axial_transition(nodal_diameters: int) -> float:
    """Wavenumber times radius, ka, at which axial motion starts to radiate fully.

    A thin disc of radius a in free air, whose axial velocity goes as r^n cos(nθ): the flow around it at low
    frequency, φ = Γ(n+1)/(√π Γ(n+3/2)) v (r/a)^n √(a² − r²) cos(nθ), radiates as a layer of dipoles. The
    ratio that follows, per 2πa² ⟨v²⟩, is C (ka)^(2n+4), here set equal to one. For n = 0 C = 8/(27π²), that
    of a rigid disc (Rayleigh).
    """
    n = nodal_diameters
    flow = gamma(n + 1.0) / (math.sqrt(math.pi) * gamma(n + 1.5))
    layer = gamma(1.5) / (2.0 ** (n + 1) * gamma(n + 2.5))
    limit = (n + 1.0) * (flow * layer) ** 2 * beta(1.5, n + 1.0)
    return float(limit ** (-1.0 / (2 * n + 4)))


def radial_transition(nodal_diameters: int, width_ratio: float) -> float:
    """Wavenumber times radius, ka, at which radial motion starts to radiate fully.

    A ring of radius a and width b, here given as b/a, whose outer face alone moves air, with cos(nθ): as
    monopoles its ratio per 2πab ⟨v²⟩ is k²ab/4 ∫J_n²(ka sinϑ) sinϑ dϑ, which at low frequency is (b/a)
    (ka)^(2n+2) B(1/2, n+1)/(4^(n+1) n!²), here set equal to one.
    """
    n = nodal_diameters
    limit = width_ratio * beta(0.5, n + 1.0) / (4.0 ** (n + 1) * gamma(n + 1.0) ** 2)
    return float(limit ** (-1.0 / (2 * n + 2)))


@dataclass(frozen=True, eq=False)
class RadiatingWheel:
    """A wheel as a radiator of its modes.

    Parameters
    ----------
    radius, width : float
        Of the tread, m.
    nodal_diameters : ndarray (p,) of int
        n of each mode.
    axial, radial : ndarray (p,)
        Root mean square, over the disc, of the axial velocity, and over the tread, of the radial velocity,
        both per radial velocity at the contact.

    Notes
    -----
    W = ρ c Σ [2πa² σ_a(n) ⟨v_a²⟩ + 2πab σ_r(n) ⟨v_r²⟩], each mode by itself: two modes of the same n that
    move together in a band would radiate more or less than their sum.
    """

    radius: float
    width: float
    nodal_diameters: Integers
    axial: Array
    radial: Array

    def axial_ratio(self, frequency: ArrayLike) -> Array:
        """σ_a (p, f) at positive frequencies (f,), Hz: 1/(1 + (f_ca/f)^(2n+4))."""
        transition = np.array([axial_transition(n) for n in self.nodal_diameters])
        return self._ratio(frequency, transition, 2 * self.nodal_diameters + 4)

    def radial_ratio(self, frequency: ArrayLike) -> Array:
        """σ_r (p, f) at positive frequencies (f,), Hz: 1/(1 + (f_cr/f)^(2n+2))."""
        slender = self.width / self.radius
        transition = np.array([radial_transition(n, slender) for n in self.nodal_diameters])
        return self._ratio(frequency, transition, 2 * self.nodal_diameters + 2)

    def power(self, frequency: ArrayLike, square: Array) -> Array:
        """Sound power of each mode (p, f), W, from its mean square radial velocity at the contact, m²/s².

        Per Hz where this is a density. Frequencies (f,), Hz.
        """
        disc = 2.0 * np.pi * self.radius**2 * self.axial[:, None] ** 2 * self.axial_ratio(frequency)
        around = 2.0 * np.pi * self.radius * self.width
        tread = around * self.radial[:, None] ** 2 * self.radial_ratio(frequency)
        return IMPEDANCE * (disc + tread) * square

    def _ratio(self, frequency: ArrayLike, transition: Array, exponent: Integers) -> Array:
        over = 2.0 * np.pi * above_zero(frequency) * self.radius / SPEED_OF_SOUND / transition[:, None]
        return 1.0 / (1.0 + over ** -exponent[:, None].astype(float))
