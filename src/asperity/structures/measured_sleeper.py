"""A sleeper by its receptance at the rail seat, as it was measured or computed: modes that meet the table."""

from dataclasses import dataclass, replace

import numpy as np

from asperity.arguments import Array, ArrayLike, Complex, finite_array
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
    fit_error: float = 0.0  # root mean square of the level difference to a table, dB
    fitted: str = ""  # by what, in words

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
    from asperity.structures.modal_fit import check_range

    check_range(frequency, receptance)
    finite_array("size of a receptance (m/N)", np.abs(receptance), above=0.0)
    if wrong := band_of(frequency, receptance.imag > CREATED * np.abs(receptance)):
        received = f"an imaginary part above zero {wrong}, by which the sleeper would make energy"
        allowed = f"zero or less, but for noise of {CREATED:.0%} of the receptance"
        remedy = "With a time factor e^{-iωt} change its sign; divide a mobility by iω first."
        raise InputError("receptance of the sleeper", received, allowed, remedy)


def measured_sleeper(
    frequency: Array, receptance: Complex, mass: float, below: Complex | None = None
) -> MeasuredSleeper:
    """Modes of half a sleeper that meet its receptance at the rail seat, both seats pressed alike.

    Parameters
    ----------
    frequency : ndarray (n,)
        Hz, rising, above zero; ten or more, fine enough for a few in each resonance.
    receptance : ndarray of complex (n,)
        m/N, e^{+iωt}: displacement of a seat per force there, with the same force at the other.
    mass : float
        Of the half, kg.
    below : ndarray of complex (n,), optional
        Dynamic stiffness of what it lay on, N/m; free by default.

    Returns
    -------
    MeasuredSleeper
        With its `fit_error`, of which a `Track` that is built from a case is judged.

    Raises
    ------
    InputError
        If the receptance makes energy, or is out of all range.

    Notes
    -----
    On a bed of the stiffness K that is spread like its mass, mode k answers with 1/(m_k (ω_k² − ω² + K/m)):
    as the free sleeper does at Ω² = ω² − K/m. So modes are those of the free sleeper (vector fitting at iΩ,
    modal masses by least squares without negative values), wherever it was measured; those above the band
    are there by their flexibility.
    """
    from asperity.structures import modal_fit

    check_receptance(frequency, receptance)
    omega, bed = 2.0 * np.pi * frequency, np.zeros(len(frequency), complex) if below is None else below
    answering = -1j * np.sqrt(bed / mass - omega**2) / (2.0 * np.pi)
    rigid = np.asarray(1.0 / (bed - mass * omega**2))
    own, ratios, masses = modal_fit.fit_modes(frequency, receptance, rigid, answering)
    rigidly = ((0.0, own), (0.0, ratios), (mass, masses))
    natural, damping, modal = (tuple(np.append(*each).tolist()) for each in rigidly)
    found = MeasuredSleeper(mass, natural, damping, modal)
    fitted = found._modes(omega, bed).sum(axis=-1)
    off = 20.0 * np.log10(np.abs(fitted / receptance))
    worst = int(np.argmax(np.abs(off)))
    words = f"{len(own)} modes on {mass:.4g} kg"
    if bed.any():
        here, there = bed[0], 1.0 / receptance[0] + mass * omega[0] ** 2
        of_each = (f"{k.real:.3g} N/m with loss factor {k.imag / k.real:.2g}" for k in (here, there))
        words += " and {} at {:.3g} Hz, where the table has {}".format(next(of_each), frequency[0], *of_each)
    words += f" ({abs(off[worst]):.2g} dB off at most, at {frequency[worst]:.4g} Hz)"
    return replace(found, fit_error=modal_fit.level_error(fitted, receptance), fitted=words)
