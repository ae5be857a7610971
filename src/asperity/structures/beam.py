"""Finite Euler-Bernoulli beam in its modes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.errors import InputError
from asperity.kernels.waves import STRIDE, add_near_fields, turn_on
from asperity.reference.materials import Material
from asperity.structures.modal import modal_receptance

SUPPORTS = ("simply-supported", "free", "clamped")


@dataclass(frozen=True)
class Beam:
    """Uniform Euler-Bernoulli beam with modal damping.

    All modes have the damping ratio ``loss_factor / 2``, which dissipates at resonance what a
    hysteretic loss factor does. Free ends carry the two rigid modes on a soft suspension.

    Parameters
    ----------
    length : float
        m.
    bending_stiffness : float
        B = E I, N m^2.
    mass_per_length : float
        kg/m.
    support : {"simply-supported", "free", "clamped"}
        Condition of both ends.
    loss_factor : float
        Twice the modal damping ratio.
    highest_frequency : float
        All modes with natural frequencies up to here are kept, Hz; at least one.
    suspension_frequency : float
        Natural frequency of the rigid translation and rotation of a free beam, Hz.

    Raises
    ------
    InputError
        If a value is not positive, the support unknown, or no mode lies below the highest frequency.

    Notes
    -----
    Shear and rotary inertia are left out: valid while the bending wavelength is longer than about
    ten heights.

    Examples
    --------
    >>> from asperity import Beam, material
    >>> beam = Beam.rectangular(1.0, 50e-3, 10e-3, material("steel"))
    >>> beam.natural_frequencies[:3].round(1).tolist()  # Hz, in the ratios 1 : 4 : 9
    [23.5, 93.8, 211.1]
    """

    length: float
    bending_stiffness: float
    mass_per_length: float
    support: str = "simply-supported"
    loss_factor: float = 0.005
    highest_frequency: float = 10e3
    suspension_frequency: float = 5.0

    def __post_init__(self) -> None:
        for what, value in (
            ("beam length (m)", self.length),
            ("bending stiffness of the beam (N m^2)", self.bending_stiffness),
            ("mass per length of the beam (kg/m)", self.mass_per_length),
            ("highest frequency of the beam (Hz)", self.highest_frequency),
            ("suspension frequency of the beam (Hz)", self.suspension_frequency),
        ):
            if not (np.isfinite(value) and value > 0.0):
                raise InputError(what, value, "a finite positive number")
        if not 0.0 <= self.loss_factor < 2.0:
            raise InputError("loss factor of the beam", self.loss_factor, "zero or more, below 2")
        if self.support not in SUPPORTS:
            raise InputError("beam support", repr(self.support), "one of " + ", ".join(SUPPORTS))
        if len(self._bending_roots) == 0:
            raise InputError(
                "highest frequency of the beam (Hz)",
                self.highest_frequency,
                "above the first natural frequency of bending",
                "Raise it, in a case numerics.highest_frequency, or take a longer or softer beam.",
            )

    @classmethod
    def rectangular(
        cls, length: float, width: float, height: float, material: Material, **options: Any
    ) -> Beam:
        """Beam of rectangular section.

        Parameters
        ----------
        length, width, height : float
            m; the height is the dimension in the direction of bending.
        material : Material
            Gives E and the density.
        **options
            Further parameters of `Beam`.

        Returns
        -------
        Beam
            With B = E b h^3/12 and m' = rho b h.

        Raises
        ------
        InputError
            As `Beam`.
        """
        for what, value in (("beam width (m)", width), ("beam height (m)", height)):
            if not (np.isfinite(value) and value > 0.0):
                raise InputError(what, value, "a finite positive number")
        stiffness = material.youngs_modulus * width * height**3 / 12.0
        return cls(length, stiffness, material.density * width * height, **options)

    @cached_property
    def _bending_roots(self) -> NDArray[np.float64]:
        """Wavenumber times length of the bending modes up to the highest frequency."""
        unit = np.sqrt(self.bending_stiffness / self.mass_per_length) / self.length**2  # omega of root 1
        largest = np.sqrt(2.0 * np.pi * self.highest_frequency / unit)
        n = np.arange(1, int(largest / np.pi) + 2)
        if self.support == "simply-supported":
            roots = n * np.pi
        else:
            # cos x cosh x = 1 split into even modes, tan(x/2) = -tanh(x/2), and odd ones
            turns, sign = np.pi * ((n + 1) // 2), np.where(n % 2 == 1, -1.0, 1.0)
            roots = (n + 0.5) * np.pi
            for _ in range(20):  # contracts by a factor 30 or more
                roots = 2.0 * (turns + sign * np.arctan(np.tanh(0.5 * roots)))
        return roots[roots <= largest]

    @property
    def _rigid_modes(self) -> int:
        return 2 if self.support == "free" else 0

    @cached_property
    def natural_frequencies(self) -> NDArray[np.float64]:
        """Undamped natural frequencies of all modes, Hz; rigid modes of a free beam first."""
        unit = np.sqrt(self.bending_stiffness / self.mass_per_length) / self.length**2
        rigid = np.full(self._rigid_modes, self.suspension_frequency)
        return np.concatenate([rigid, self._bending_roots**2 * unit / (2.0 * np.pi)])

    @property
    def damping_ratio(self) -> float:
        """Damping ratio of every mode: half the loss factor."""
        return 0.5 * self.loss_factor

    @property
    def damping_ratios(self) -> NDArray[np.float64]:
        """The same for each mode."""
        return np.full(self.natural_frequencies.shape, self.damping_ratio)

    @property
    def extent(self) -> tuple[float, float]:
        """Where it begins and ends, m."""
        return 0.0, self.length

    @property
    def mass(self) -> float:
        """Mass, kg."""
        return self.mass_per_length * self.length

    def shapes(self, x: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Mass-normalised mode shapes and their slopes.

        Parameters
        ----------
        x : array_like (n,)
            Positions from the left end, m.

        Returns
        -------
        shapes, slopes : ndarray (n, modes)
            kg^-1/2, and kg^-1/2 per metre.

        Raises
        ------
        InputError
            If a position is off the beam.
        """
        (wave, rising, falling), slopes = self._parts(x)
        return wave + rising + falling, slopes + self._wavenumbers * (rising - falling)

    def shapes_along(
        self, start: float, spacing: float, count: int
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Mode shapes and slopes at equally spaced positions, as under a contact that rolls.

        Parameters
        ----------
        start : float
            First position from the left end, m.
        spacing : float
            Distance of the positions, m.
        count : int
            Number of positions.

        Returns
        -------
        shapes, slopes : ndarray (count, modes)
            As `shapes` to rounding, many times faster: sines and cosines follow by angle addition and
            exponentials by products from exact values at every 128th position.

        Raises
        ------
        InputError
            If a position is off the beam.
        """
        k = self._wavenumbers
        (wave, rising, falling), slope = self._parts(start + spacing * np.arange(0, count, STRIDE))
        shapes, slopes = np.empty((2, count, len(k)))
        angle = k * spacing
        sine_over_k = spacing * np.sinc(angle / np.pi)  # the limit of k = 0 moves rigid modes
        turn = np.array([2.0 * np.sin(0.5 * angle) ** 2, sine_over_k, k * np.sin(angle)])
        turn_on(wave, slope, turn, shapes, slopes)
        if self.support != "simply-supported":
            near = np.array([rising, falling])
            add_near_fields(near, np.array([np.exp(angle), np.exp(-angle), k]), shapes, slopes)
        return shapes, slopes

    @cached_property
    def _wavenumbers(self) -> NDArray[np.float64]:
        """Of all modes, 1/m; zero for the rigid ones."""
        return np.concatenate([np.zeros(self._rigid_modes), self._bending_roots / self.length])

    def _parts(
        self, x: ArrayLike
    ) -> tuple[
        tuple[NDArray[np.float64], NDArray[np.float64] | float, NDArray[np.float64] | float],
        NDArray[np.float64],
    ]:
        """Mode shapes (n, modes) in three parts, and the slope of the first.

        A sinusoid, or the straight line of a rigid mode, and the exponentials that rise and fall with x.
        """
        at = np.atleast_1d(np.asarray(x, dtype=float))
        if at.min() < -1e-9 * self.length or at.max() > self.length * (1.0 + 1e-9):
            received = f"{at.min():.6g} to {at.max():.6g}"
            raise InputError("positions on the beam (m)", received, f"0 to {self.length:.6g}")
        scale = 1.0 / np.sqrt(self.mass)
        if self.support == "simply-supported":
            k = self._bending_roots / self.length
            scale *= np.sqrt(2.0)
            phase = np.outer(at, k)
            return (scale * np.sin(phase), 0.0, 0.0), scale * k * np.cos(phase)
        wave, slope, rising, falling = self._centred_parts(at)
        if self.support == "free":
            rotation = np.sqrt(12.0) / self.length
            rigid = np.stack([np.ones_like(at), rotation * (at - 0.5 * self.length)], axis=1)
            rigid_slopes = np.stack([np.zeros_like(at), np.full_like(at, rotation)], axis=1)
            none = np.zeros_like(rigid)
            wave, slope = np.hstack([rigid, wave]), np.hstack([rigid_slopes, slope])
            rising, falling = np.hstack([none, rising]), np.hstack([none, falling])
        return (scale * wave, scale * rising, scale * falling), scale * slope

    def _centred_parts(
        self, at: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Bending modes of free and clamped beams, even or odd about the middle.

        cos(kx)/cos(kL/2) -+ cosh(kx)/cosh(kL/2) and the same with sines, written with decaying exponentials
        only; the mean square over the length is one. Sinusoid, its slope, and the exponentials that rise and
        fall with x.
        """
        k = self._bending_roots / self.length
        even = np.arange(len(k)) % 2 == 0
        phase = np.outer(at - 0.5 * self.length, k)
        half = 0.5 * self._bending_roots
        parity = np.where(even, 1.0, -1.0)
        end = (1.0 + parity * np.exp(-2.0 * half)) * (1.0 if self.support == "free" else -1.0)
        rising = np.exp(-np.outer(self.length - at, k)) / end
        falling = parity * np.exp(-np.outer(at, k)) / end
        cosine, sine = np.cos(phase), np.sin(phase)
        wave = np.where(even, cosine / np.cos(half), sine / np.sin(half))
        slope = k * np.where(even, -sine / np.cos(half), cosine / np.sin(half))
        return wave, slope, rising, falling

    def receptance(self, frequency: ArrayLike, x: float, x0: float) -> NDArray[np.complex128]:
        """Displacement at `x` per harmonic force at `x0`, by modal superposition.

        Parameters
        ----------
        frequency : array_like
            Hz; zero gives the static compliance. Time factor exp(+i omega t).
        x, x0 : float
            Positions of the response and of the force, m.

        Returns
        -------
        ndarray of complex
            m/N, of the shape of `frequency`.

        Raises
        ------
        InputError
            If a position is off the beam.
        """
        return modal_receptance(self, frequency, x, x0)
