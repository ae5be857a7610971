"""The wheel: a mass under a constant load, rigid or with resonances."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.errors import InputError, UnconvergedWarning
from asperity.structures.body import Body
from asperity.structures.modal_fit import fit_modes, warn_of_wide_lines

DOUBTFUL_FIT = 1.0  # dB, from here on a fit is warned of
REFUSED_FIT = 6.0  # dB, beyond it mass or unit cannot be right
ROUNDING = 1e-9  # share of a residue that may be real


def _no_modes() -> NDArray[np.complex128]:
    return np.zeros(0, dtype=complex)


@dataclass(frozen=True, eq=False)
class Wheel:
    """Wheel at its contact point, in the vertical direction: a free mass and flexible modes.

    The displacement that follows a unit impulse is t/M + 2 Re Σ r e^{st}.

    Parameters
    ----------
    mass : float
        M, unsprung mass per wheel, kg. Its suspension is soft: the wheel counts as free.
    load : float
        Static contact force, weight included, N.
    poles : ndarray (p,) of complex, optional
        s of the flexible modes, 1/s, with Im s > 0 and Re s < 0; their conjugates are implied.
    residues : ndarray (p,) of complex, optional
        r of the receptance at each pole, m/(N s).
    fit_error : float
        Of a fitted wheel: root mean square of the level difference to the given receptance, dB.

    Raises
    ------
    InputError
        If mass or load is not positive, or poles and residues are not pairs of a stable wheel.

    Notes
    -----
    The modes stand still in the contact: that a rotating wheel splits each of them in two, one revolution
    frequency times the number of nodal diameters up and down, is left out.

    Examples
    --------
    >>> import numpy as np
    >>> from asperity import Wheel
    >>> wheel = Wheel.rigid(mass=600.0, load=65e3)
    >>> omega = 2 * np.pi * 100.0
    >>> bool(np.isclose(abs(wheel.receptance(np.array([100.0])))[0], 1 / (600.0 * omega**2)))
    True
    """

    mass: float
    load: float
    poles: NDArray[np.complex128] = field(default_factory=_no_modes)
    residues: NDArray[np.complex128] = field(default_factory=_no_modes)
    fit_error: float = 0.0

    def __post_init__(self) -> None:
        for what, value in (("wheel mass (kg)", self.mass), ("wheel load (N)", self.load)):
            if not (np.isfinite(value) and value > 0.0):
                raise InputError(what, value, "a finite positive number")
        if np.ndim(self.poles) != 1 or np.shape(self.poles) != np.shape(self.residues):
            received = f"shapes {np.shape(self.poles)} and {np.shape(self.residues)}"
            raise InputError("poles and residues of the wheel", received, "two lists of the same length")
        if not (np.isfinite(self.poles).all() and np.isfinite(self.residues).all()):
            raise InputError("poles and residues of the wheel", "values that are not finite", "finite values")
        if not ((np.imag(self.poles) > 0.0) & (np.real(self.poles) < 0.0)).all():
            raise InputError(
                "poles of the wheel",
                "a pole outside the upper left quarter of the plane",
                "Im s > 0 and Re s < 0",
                "Give one pole of each conjugate pair, of damped modes only.",
            )

    @classmethod
    def rigid(cls, mass: float, load: float) -> Wheel:
        """Wheel without resonances.

        Parameters
        ----------
        mass : float
            kg.
        load : float
            N.

        Returns
        -------
        Wheel
            With no poles.

        Raises
        ------
        InputError
            As `Wheel`.
        """
        return cls(mass, load)

    @classmethod
    def from_modes(
        cls,
        mass: float,
        load: float,
        frequencies: ArrayLike,
        damping_ratios: ArrayLike,
        modal_masses: ArrayLike,
    ) -> Wheel:
        """Wheel given by its modes.

        Parameters
        ----------
        mass : float
            Mass of the whole wheel, kg: that of its rigid motion.
        load : float
            N.
        frequencies : array_like (p,)
            Undamped natural frequencies, Hz.
        damping_ratios : array_like (p,)
            Share of critical damping, above 0 and below 1.
        modal_masses : array_like (p,)
            Modal masses with the vertical mode shape at the contact point scaled to one, kg.

        Returns
        -------
        Wheel
            With a pole −ζω₀ + iω_d and a residue 1/(2i m ω_d) per mode, ω_d = ω₀√(1 − ζ²).

        Raises
        ------
        InputError
            If the lists differ in length or hold values out of range; or as `Wheel`.
        """
        natural, ratio, modal_mass = (
            np.atleast_1d(np.asarray(a, dtype=float)) for a in (frequencies, damping_ratios, modal_masses)
        )
        if natural.ndim != 1 or not natural.shape == ratio.shape == modal_mass.shape:
            received = f"{natural.size} frequencies, {ratio.size} damping ratios, {modal_mass.size} masses"
            raise InputError("modes of the wheel", received, "one of each per mode")
        for what, values, upper, allowed in (
            ("natural frequencies of the wheel (Hz)", natural, np.inf, "finite positive numbers"),
            ("damping ratios of the wheel", ratio, 1.0, "above 0 and below 1"),
            ("modal masses of the wheel (kg)", modal_mass, np.inf, "finite positive numbers"),
        ):
            wrong = ~((values > 0.0) & (values < upper))
            if wrong.any():
                raise InputError(what, float(values[wrong][0]), allowed)
        omega = 2.0 * np.pi * natural
        damped = omega * np.sqrt(1.0 - ratio**2)
        return cls(mass, load, -ratio * omega + 1j * damped, 1.0 / (2j * modal_mass * damped))

    @classmethod
    def from_receptance(
        cls,
        mass: float,
        load: float,
        frequency: ArrayLike,
        receptance: ArrayLike,
        *,
        highest_frequency: float | None = None,
    ) -> Wheel:
        """Wheel given by its measured or computed receptance.

        The mass is taken off; what is left is fitted by modes with positive modal masses, so the
        wheel cannot create energy. Modes above the band are represented by their stiffness.

        Parameters
        ----------
        mass : float
            Mass of the whole wheel, kg: that of its rigid motion.
        load : float
            N.
        frequency : array_like (n,)
            Hz, above zero and rising; fine enough for a few points in each resonance.
        receptance : array_like (n,) of complex
            Vertical displacement per vertical force at the contact point, m/N, e^{+iωt}.
        highest_frequency : float, optional
            The fit goes up to here, Hz; the whole record by default. Take twice what matters: with 2 % of
            noise, a mode just above the end takes decibels from the band at it.

        Returns
        -------
        Wheel
            With its `fit_error`.

        Raises
        ------
        InputError
            If the record is short, disordered or not finite, if it creates energy (the other time
            factor), or if it is no receptance in m/N of a wheel of this mass: a fit error above 6 dB.

        Warns
        -----
        UnconvergedWarning
            If the fit error is above 1 dB.
        CoarseSamplingWarning
            If frequencies are too far apart for a mode.
        """
        f, given = np.asarray(frequency, dtype=float), np.asarray(receptance, dtype=complex)
        _check_receptance(f, given)
        band = f <= (np.inf if highest_frequency is None else highest_frequency)
        if np.count_nonzero(band) < 10:
            received = f"{np.count_nonzero(band)} points up to {highest_frequency} Hz"
            raise InputError("receptance of the wheel", received, "ten points or more")
        f, given = f[band], given[band]
        modes = fit_modes(f, given, cls.rigid(mass, load).receptance(f))
        warn_of_wide_lines(f, *modes[:2])
        wheel = cls.from_modes(mass, load, *modes)
        error = float(np.sqrt(np.mean((20.0 * np.log10(np.abs(wheel.receptance(f) / given))) ** 2)))
        _judge_fit(error, mass)
        return cls(mass, load, wheel.poles, wheel.residues, error)

    @property
    def natural_frequencies(self) -> NDArray[np.float64]:
        """Undamped natural frequencies of the flexible modes, Hz, shape (p,)."""
        return np.abs(self.poles) / (2.0 * np.pi)

    @property
    def damping_ratios(self) -> NDArray[np.float64]:
        """Damping ratios of the flexible modes, shape (p,)."""
        return -self.poles.real / np.abs(self.poles)

    @property
    def body(self) -> Body:
        """The same as a body on one contact.

        Raises
        ------
        InputError
            If a residue is not that of a real mode shape, −i/(2 m ω_d).
        """
        damped = self.poles.imag
        if (np.abs(self.residues.real) > ROUNDING * np.abs(self.residues)).any() or (
            self.residues.imag > 0.0
        ).any():
            allowed = "residues of real mode shapes, with no real part and a negative imaginary one"
            raise InputError("residues of the wheel", "others", allowed, "Use Wheel.from_modes.")
        masses = 0.5 / (np.abs(self.residues) * damped)
        return Body.from_modes(self.mass, self.load, self.natural_frequencies, self.damping_ratios, masses)

    def receptance(self, frequency: ArrayLike) -> NDArray[np.complex128]:
        """Displacement per harmonic force at the contact point.

        Parameters
        ----------
        frequency : array_like
            Hz, above zero.

        Returns
        -------
        ndarray of complex
            −1/(Mω²) + Σ r/(iω − s) + r*/(iω − s*), m/N, of the shape of `frequency`; e^{+iωt}.

        Raises
        ------
        InputError
            If a frequency is not above zero.
        """
        f = np.asarray(frequency, dtype=float)
        if not (f > 0.0).all():
            raise InputError(
                "frequency (Hz)", float(np.min(f)), "above 0: a free wheel has no static receptance"
            )
        omega = 2.0 * np.pi * f
        rigid = -1.0 / (self.mass * omega**2)
        point = 1j * omega[..., None]
        pairs = self.residues / (point - self.poles) + self.residues.conj() / (point - self.poles.conj())
        return np.asarray(rigid + pairs.sum(axis=-1))


def _check_receptance(frequency: NDArray[np.float64], receptance: NDArray[np.complex128]) -> None:
    what = "receptance of the wheel"
    if frequency.ndim != 1 or frequency.shape != receptance.shape:
        received = f"shapes {frequency.shape} and {receptance.shape}"
        raise InputError(what, received, "one value per frequency")
    if not (np.isfinite(frequency).all() and np.isfinite(receptance).all()):
        raise InputError(what, "values that are not finite", "finite values")
    if frequency.size and not (frequency[0] > 0.0 and (np.diff(frequency) > 0.0).all()):
        raise InputError(what, "frequencies in disorder", "frequencies above 0 Hz and rising")
    if not np.abs(receptance).all():
        raise InputError(what, "a value of zero", "values other than zero", "Leave such points out.")
    sine = receptance.imag / np.abs(receptance)
    if np.sum(sine) > 3.0 * np.linalg.norm(sine):  # more than noise of random sign
        raise InputError(
            what,
            "an imaginary part that is mostly positive",
            "the time factor e^{+iωt}, whose imaginary part is negative in a damped wheel",
            "Conjugate the values; divide a mobility by iω first.",
        )


def _judge_fit(error: float, mass: float) -> None:
    if error > REFUSED_FIT:
        raise InputError(
            "receptance of the wheel",
            f"values that modes on a mass of {mass:.4g} kg meet to {error:.1f} dB only",
            f"a receptance that they meet within {REFUSED_FIT:.0f} dB",
            "Check the mass, the unit m/N, and that it is displacement, not velocity or acceleration.",
        )
    if error > DOUBTFUL_FIT:
        warnings.warn(
            f"The wheel's modes meet its given receptance to {error:.1f} dB only, more than "
            f"{DOUBTFUL_FIT:.0f} dB: its resonances are uncertain by as much. Give a finer or smoother "
            "receptance, or its modes.",
            UnconvergedWarning,
            stacklevel=3,
        )
