"""A sleeper by its receptance at the rail seat, as it was measured or computed: modes that meet the table."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from asperity.arguments import Array, Complex
from asperity.errors import InputError
from asperity.structures.stiffness_table import band_of
from asperity.structures.support import Element

CREATED = 0.05
"""Share of a receptance that its imaginary part may be above zero, by noise."""


@dataclass(frozen=True)
class MeasuredSleeper(Element):
    """Half a sleeper by its modes at the rail seat while it is free, both seats pressed alike.

    Its rigid motion is the first mode, of no frequency. What lies below counts as spread like its mass, with
    the share m_k/m in mode k: exact for an even sleeper on even ballast. It is causal and passive.
    """

    mass: float  # m, of the half, kg
    natural_frequencies: tuple[float, ...]  # Hz
    damping_ratios: tuple[float, ...]
    modal_masses: tuple[float, ...]  # m_k, of the half, kg, where the seat is displaced by one
    # of its level against a table: root mean square and largest, dB, and the frequency of that, Hz
    fit_errors: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def on(self, omega: ArrayLike, below: Complex | None) -> Complex | None:
        """Inverse of the sum of its modes."""
        return None if below is None else 1.0 / self._modes(omega, below).sum(axis=-1)

    def spread(self, omega: ArrayLike, below: Complex | None) -> Array | float:
        """Mean over its mass, in which its modes are orthogonal: Σ m_k |q_k|²/(m |Σ q_k|²)."""
        if below is None:
            return 1.0
        modes = self._modes(omega, below)
        squares = np.abs(modes) ** 2 @ np.array(self.modal_masses) / self.mass
        return np.asarray(squares / np.abs(modes.sum(axis=-1)) ** 2)

    def lost(self, omega: ArrayLike, below: Complex | None) -> Array:
        """Imaginary stiffness, N/m, by which it dissipates itself, per square of how it moves by `spread`."""
        if below is None:
            return np.zeros(np.shape(omega))
        squares, masses = np.abs(self._modes(omega, below)) ** 2, np.array(self.modal_masses)
        damping = 4.0 * np.pi * np.array(self.damping_ratios) * self.natural_frequencies * masses
        return np.asarray(self.mass * np.real(omega) * (squares @ damping) / (squares @ masses))

    def resting(self, below: float | None) -> float | None:
        """Inverse of the deflection of the seat under a force that stays."""
        if below is None:
            return None
        return float(1.0 / self._modes(0.0, np.asarray(complex(below))).sum().real)

    def _modes(self, omega: ArrayLike, below: Complex) -> Complex:
        """Displacement of the seat in each mode per force (..., k), m/N."""
        at = np.asarray(omega, dtype=complex)[..., None]
        own, held = 2.0 * np.pi * np.array(self.natural_frequencies), below[..., None] / self.mass
        stiffness = own**2 + held - at**2 + 2j * np.array(self.damping_ratios) * own * at
        return np.asarray(1.0 / (np.array(self.modal_masses) * stiffness))


def check_receptance(frequency: Array, receptance: Complex) -> None:
    """Refuse a receptance (n,) at its own place, m/N, that makes energy, and say in which band, Hz."""
    if wrong := band_of(frequency, receptance.imag > CREATED * np.abs(receptance)):
        received = f"an imaginary part above zero {wrong}, by which the sleeper would make energy"
        allowed = f"zero or less, but for noise of {CREATED:.0%} of the receptance"
        remedy = "With a time factor e^{-iωt} change its sign; divide a mobility by iω first."
        raise InputError("receptance of the sleeper", received, allowed, remedy)


def measured_sleeper(frequency: Array, receptance: Complex, mass: float, below: Complex) -> MeasuredSleeper:
    """Modes of half a sleeper that meet its receptance at the rail seat, both seats pressed alike.

    Parameters
    ----------
    frequency : ndarray (n,)
        Hz, rising, above zero; ten or more, fine enough for a few in each resonance.
    receptance : ndarray of complex (n,)
        m/N, e^{+iωt}: displacement of a seat per force there, with the same force at the other.
    mass : float
        Of the half, kg.
    below : ndarray of complex (n,)
        Dynamic stiffness of what it lay on, N/m; zero of a free one.

    Returns
    -------
    MeasuredSleeper
        With its `fit_errors`.

    Raises
    ------
    InputError
        If the receptance makes energy, or modes on this mass and bed meet it to 6 dB only.

    Warns
    -----
    UnconvergedWarning
        If they meet it to more than 1 dB.

    Notes
    -----
    On a bed of the stiffness K that is spread like its mass, mode k answers with 1/(m_k (ω_k² − ω² + K/m)):
    as the free sleeper does at Ω² = ω² − K/m. So modes are those of the free sleeper (vector fitting at iΩ,
    modal masses by least squares without negative values), wherever it was measured; those above the band
    are there by their flexibility.
    """
    from asperity.structures import modal_fit

    check_receptance(frequency, receptance)
    omega = 2.0 * np.pi * frequency
    answering = -1j * np.sqrt(below / mass - omega**2) / (2.0 * np.pi)
    rigid = np.asarray(1.0 / (below - mass * omega**2))
    own, ratios, masses = modal_fit.fit_modes(frequency, receptance, rigid, answering)
    found = MeasuredSleeper(
        mass, *((first, *each.tolist()) for first, each in ((0.0, own), (0.0, ratios), (mass, masses)))
    )
    fitted = found._modes(omega, below).sum(axis=-1)
    error, off = (
        modal_fit.level_error(fitted, receptance),
        np.abs(20.0 * np.log10(np.abs(fitted / receptance))),
    )
    modes = f"{len(own)} modes on a mass of {mass:.4g} kg"
    if below.any():
        here, there = below[0], 1.0 / receptance[0] + mass * omega[0] ** 2
        modes += (
            f" and a bed of {here.real:.3g} N/m with the loss factor {here.imag / here.real:.2g} at "
            f"{frequency[0]:.3g} Hz, where the table has {there.real:.3g} N/m and {there.imag / there.real:.2g},"
        )
    modal_fit.judge_fit("receptance of the sleeper", error, modes)
    worst = int(np.argmax(off))
    return replace(found, fit_errors=(error, float(off[worst]), float(frequency[worst])))
