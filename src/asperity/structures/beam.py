"""Beams in bending by their modes: of one span, and on any supports."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import Any, Self

import numpy as np
import scipy

from asperity.arguments import Array, ArrayLike, as_row, one_of, positive, real, require
from asperity.errors import InputError
from asperity.kernels.curves import STRIDE, add_near_fields
from asperity.quadrature import gauss
from asperity.reference.materials import Material
from asperity.structures.modal import Modal, Pieces, modal_receptance, pieces_of, shapes_at, turned_on
from asperity.written_numbers import rounded

SUPPORTS = ("simply-supported", "free", "clamped")


@dataclass(frozen=True, eq=False)
class _Uniform(Modal):
    """What beams of one section have in common."""

    length: float
    bending_stiffness: float
    mass_per_length: float

    receptance = modal_receptance

    @classmethod
    def rectangular(
        cls, length: float, width: float, height: float, material: Material, *more: Any, **options: Any
    ) -> Self:
        """Beam of rectangular section.

        Parameters
        ----------
        length, width, height : float
            m; the height is the dimension in the direction of bending.
        material : Material
            Gives E and the density.
        *more, **options
            Further parameters of the beam.

        Returns
        -------
        Beam or SupportedBeam
            With B = E b h^3/12 and m' = rho b h.

        Raises
        ------
        InputError
            As the beam itself.
        """
        stiffness = material.youngs_modulus * positive("beam width (m)", width) * height**3 / 12.0
        mass = material.density * width * positive("beam height (m)", height)
        return cls(length, stiffness, mass, *more, **options)

    def _check(self, loss_factor: float, highest_frequency: float) -> None:
        positive("beam length (m)", self.length)
        positive("bending stiffness of the beam (N m^2)", self.bending_stiffness)
        positive("mass per length of the beam (kg/m)", self.mass_per_length)
        positive("highest frequency of the beam (Hz)", highest_frequency)
        _check_loss("loss factor of the beam", loss_factor)

    def _needs_a_mode(self, count: int, highest_frequency: float) -> None:
        allowed = "above the first natural frequency of bending"
        remedy = "Raise it, in a case numerics.highest_frequency, or take a longer or softer beam."
        require(count, "highest frequency of the beam (Hz)", highest_frequency, allowed, remedy)

    @property
    def extent(self) -> tuple[float, float]:
        """Where it begins and ends, m."""
        return 0.0, self.length

    @property
    def mass(self) -> float:
        """Mass, kg."""
        return self.mass_per_length * self.length


def _check_loss(what: str, value: float) -> None:
    real(what, value, "zero or more, below 2", at_least=0.0, below=2.0)


@dataclass(frozen=True)
class Beam(_Uniform):
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

    support: str = "simply-supported"
    loss_factor: float = 0.005
    highest_frequency: float = 10e3
    suspension_frequency: float = 5.0

    def __post_init__(self) -> None:
        self._check(self.loss_factor, self.highest_frequency)
        positive("suspension frequency of the beam (Hz)", self.suspension_frequency)
        one_of("beam support", self.support, SUPPORTS)
        self._needs_a_mode(len(self._bending_roots), self.highest_frequency)

    @property
    def _unit(self) -> float:
        """Angular frequency of a mode whose root is one, rad/s."""
        return float(np.sqrt(self.bending_stiffness / self.mass_per_length) / self.length**2)

    @cached_property
    def _bending_roots(self) -> Array:
        """Wavenumber times length of the bending modes up to the highest frequency."""
        largest = np.sqrt(2.0 * np.pi * self.highest_frequency / self._unit)
        n = np.arange(1, int(largest / np.pi) + 2)
        if self.support == "simply-supported":
            roots = n * np.pi
        else:
            # cos x cosh x = 1 split into even modes, tan(x/2) = -tanh(x/2), and odd ones
            turns = np.pi * ((n + 1) // 2)
            sign = np.where(n % 2 == 1, -1.0, 1.0)
            roots = (n + 0.5) * np.pi
            for _ in range(20):  # contracts by a factor 30 or more
                roots = 2.0 * (turns + sign * np.arctan(np.tanh(0.5 * roots)))
        return roots[roots <= largest]

    @property
    def _rigid_modes(self) -> int:
        return 2 if self.support == "free" else 0

    @cached_property
    def natural_frequencies(self) -> Array:
        """Undamped natural frequencies of all modes, Hz; rigid modes of a free beam first."""
        rigid = np.full(self._rigid_modes, self.suspension_frequency)
        return np.concatenate([rigid, self._bending_roots**2 * self._unit / (2.0 * np.pi)])

    @property
    def damping_ratios(self) -> Array:
        """Of all modes alike: half the loss factor."""
        return np.full(self.natural_frequencies.shape, 0.5 * self.loss_factor)

    def shapes(self, x: ArrayLike) -> tuple[Array, Array]:
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

    def shapes_along(self, start: float, spacing: float, count: int) -> tuple[Array, Array]:
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
        shapes, slopes = turned_on(wave, slope, k, spacing, count)
        if self.support != "simply-supported":
            near = np.array([rising, falling])
            angle = k * spacing
            add_near_fields(near, np.array([np.exp(angle), np.exp(-angle), k]), shapes, slopes)
        return shapes, slopes

    @cached_property
    def _wavenumbers(self) -> Array:
        """Of all modes, 1/m; zero for the rigid ones."""
        return np.concatenate([np.zeros(self._rigid_modes), self._bending_roots / self.length])

    def _parts(self, x: ArrayLike) -> tuple[tuple[Array, Array | float, Array | float], Array]:
        """Mode shapes (n, modes) in three parts, and the slope of the first.

        A sinusoid, or the straight line of a rigid mode, and the exponentials that rise and fall with x.
        """
        at = as_row(x)
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
            turn = np.sqrt(12.0) / self.length
            rigid = np.stack([np.ones_like(at), turn * (at - 0.5 * self.length)], axis=1)
            wave = np.hstack([rigid, wave])
            slope = np.hstack([np.full(rigid.shape, [0.0, turn]), slope])
            rising, falling = (np.pad(each, ((0, 0), (2, 0))) for each in (rising, falling))
        return (scale * wave, scale * rising, scale * falling), scale * slope

    def _centred_parts(self, at: Array) -> tuple[Array, Array, Array, Array]:
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
        cosine = np.cos(phase)
        sine = np.sin(phase)
        wave = np.where(even, cosine / np.cos(half), sine / np.sin(half))
        slope = k * np.where(even, -sine / np.cos(half), cosine / np.sin(half))
        return wave, slope, rising, falling


DEGREE = 7
"""Of the splines in which modes are looked for."""
PHASE = 0.8
"""Wavenumber of the highest mode times the distance of knots, at most: frequencies are exact to 1e-10."""
MOST_KNOTS = 1500
"""Knots of a beam: some 60 spans of one wavelength of the highest mode."""
SAME_PLACE = 1e-9
"""Share of the length within which a support is at an end."""


@dataclass(frozen=True)
class Support:
    """What holds a beam at one place.

    Parameters
    ----------
    position : float
        From the left end, m.
    stiffness : float
        Against deflection, N/m; infinite for a rigid support.
    rotational_stiffness : float
        Against rotation, N m/rad; infinite where the beam is clamped.
    loss_factor : float
        Of both springs.

    Raises
    ------
    InputError
        If a number is negative, or nothing is held.

    Examples
    --------
    >>> from asperity import Support
    >>> clamp, pad = Support(0.0, rotational_stiffness=float("inf")), Support(1.5, 30e6, loss_factor=0.2)
    >>> clamp.stiffness, pad.stiffness  # N/m
    (inf, 30000000.0)
    """

    position: float
    stiffness: float = math.inf
    rotational_stiffness: float = 0.0
    loss_factor: float = 0.0

    def __post_init__(self) -> None:
        real("position of a support (m)", self.position, "0 and more", at_least=0.0)
        for what, value in (
            ("stiffness of a support (N/m)", self.stiffness),
            ("rotational stiffness of a support (N m/rad)", self.rotational_stiffness),
        ):
            if not value >= 0.0:
                raise InputError(what, value, "0 and more, or infinite")
        holds = self.stiffness or self.rotational_stiffness
        require(holds, "stiffness of a support (N/m)", 0.0, "a support that holds something")
        _check_loss("loss factor of a support", self.loss_factor)


@dataclass(frozen=True, eq=False)
class SupportedBeam(_Uniform):
    """Uniform Euler–Bernoulli beam on supports, with modal damping.

    Parameters
    ----------
    length : float
        m.
    bending_stiffness : float
        B = E I, N m².
    mass_per_length : float
        kg/m.
    supports : sequence of Support
        In any order; where there is none the beam is free, also at its ends.
    loss_factor : float
        Of the beam itself.
    highest_frequency : float
        All modes up to here are kept, Hz.

    Raises
    ------
    InputError
        If a value is out of range, two supports share a place or one is off the beam, or no mode lies below
        the highest frequency.

    Notes
    -----
    Modes are those of least energy (Ritz) among splines of degree 7, which bend as supports let them: forces
    of supports are jumps of the shear force. They converge from above, and are exact to about 1e-10 with the
    knots taken. The damping ratio of a mode is half the mean of the loss factors of beam and springs, by the
    share of the strain energy that each has in the undamped mode: an approximation for small and similar
    losses. A beam that its supports do not hold has modes of frequency 0.

    Examples
    --------
    >>> from asperity import Support, SupportedBeam
    >>> two_spans = SupportedBeam(2.0, 4375.0, 3.925, [Support(0.0), Support(1.0), Support(2.0)])
    >>> two_spans.natural_frequencies[:3].round(1).tolist()  # Hz, antisymmetric and symmetric in turn
    [52.4, 81.9, 209.8]
    """

    supports: Sequence[Support] = field(default_factory=tuple)
    loss_factor: float = 0.005
    highest_frequency: float = 10e3

    def __post_init__(self) -> None:
        self._check(self.loss_factor, self.highest_frequency)
        ordered = tuple(sorted(self.supports, key=lambda support: support.position))
        places = [support.position for support in ordered]
        if places and places[-1] > self.length * (1.0 + SAME_PLACE):
            raise InputError("position of a support (m)", places[-1], f"0 to {self.length:.6g}, on the beam")
        if places and np.diff(places).min(initial=self.length) <= SAME_PLACE * self.length:
            raise InputError("positions of the supports (m)", "one place twice", "different places")
        object.__setattr__(self, "supports", ordered)
        if len(self._knots) > MOST_KNOTS:
            received = f"{rounded(self.highest_frequency, 4)} Hz, {len(self._knots)} knots of splines"
            remedy = "Lower it, or take fewer supports."
            raise InputError("highest frequency of the beam (Hz)", received, f"{MOST_KNOTS} knots", remedy)
        self._needs_a_mode(self.natural_frequencies.size, self.highest_frequency)

    @property
    def natural_frequencies(self) -> Array:
        """Undamped, of all modes, Hz."""
        return self._modes[0]

    @property
    def damping_ratios(self) -> Array:
        """Of all modes, by their strain energy."""
        return self._modes[1]

    def shapes(self, x: ArrayLike) -> tuple[Array, Array]:
        """Mass-normalised mode shapes, kg^(−1/2), and slopes (n, modes) at positions (n,), m."""
        return shapes_at(self._modes[2], x)

    @cached_property
    def _knots(self) -> Array:
        """Of the splines, m: at supports as many in one place as let the shear force, or the moment, jump."""
        wave = (self.mass_per_length / self.bending_stiffness) ** 0.25 * math.sqrt(
            2.0 * math.pi * self.highest_frequency
        )
        slack = SAME_PLACE * self.length
        inner = [s for s in self.supports if slack < s.position < self.length - slack]
        ends = [0.0, *(s.position for s in inner), self.length]
        knots = [np.zeros(DEGREE + 1)]
        for i, (left, right) in enumerate(pairwise(ends)):
            count = math.ceil(wave * (right - left) / PHASE) + 2
            knots.append(np.linspace(left, right, min(count, MOST_KNOTS) + 1)[1:-1])
            if i < len(inner):
                smooth = 2 if inner[i].rotational_stiffness == 0.0 else 1
                knots.append(np.full(DEGREE - smooth, right))
        return np.concatenate([*knots, np.full(DEGREE + 1, self.length)])

    @property
    def _rigid_modes(self) -> int:
        """Number of motions of a rigid body, translation and rotation, that no support holds."""
        held = [(1.0, s.position / self.length) for s in self.supports if s.stiffness > 0.0]
        held += [(0.0, 1.0) for s in self.supports if s.rotational_stiffness > 0.0]
        return 2 - (int(np.linalg.matrix_rank(np.array(held))) if held else 0)

    @cached_property
    def _modes(self) -> tuple[Array, Array, Pieces]:
        """Natural frequencies, Hz, damping ratios and mode shapes."""
        basis = scipy.interpolate.BSpline(self._knots, np.eye(len(self._knots) - DEGREE - 1), DEGREE)
        mass, bending = self._energies(basis)
        stiffness = bending.copy()
        lossy = self.loss_factor * bending
        fixed = []
        for support in self.supports:
            at = min(support.position, self.length)
            for order, spring in enumerate((support.stiffness, support.rotational_stiffness)):
                row = basis(at, nu=order)
                if math.isinf(spring):
                    fixed.append(row)
                elif spring > 0.0:
                    stiffness += spring * np.outer(row, row)
                    lossy += support.loss_factor * spring * np.outer(row, row)
        free: Array = np.eye(len(mass))
        if fixed:
            free = np.asarray(scipy.linalg.qr(np.array(fixed).T)[0][:, len(fixed) :], dtype=np.float64)
        mass, stiffness, lossy = (free.T @ part @ free for part in (mass, stiffness, lossy))
        # inverted, the lowest modes have the largest values, and the fewest digits are lost in them
        shift = self.bending_stiffness / self.mass_per_length / self.length**4
        inverse, vectors = scipy.linalg.eigh(mass, stiffness + shift * mass)
        squares = 1.0 / inverse[::-1] - shift
        squares[: self._rigid_modes] = 0.0
        kept = squares <= (2.0 * np.pi * self.highest_frequency) ** 2
        vectors = vectors[:, ::-1][:, kept]
        squares = squares[kept]
        vectors = vectors / np.sqrt(np.einsum("ir,ij,jr->r", vectors, mass, vectors, optimize=True))
        lost = np.einsum("ir,ij,jr->r", vectors, lossy, vectors, optimize=True)
        with np.errstate(divide="ignore", invalid="ignore"):
            ratios = np.where(squares > 0.0, 0.5 * lost / squares, 0.0)
        shapes = pieces_of(scipy.interpolate.BSpline(self._knots, free @ vectors, DEGREE))
        return np.sqrt(squares) / (2.0 * np.pi), ratios, shapes

    def _energies(self, basis: "scipy.interpolate.BSpline") -> tuple[Array, Array]:
        """Matrices of mass and of bending stiffness, by Gauss's rule, which is exact for splines."""
        breaks = np.unique(self._knots)
        nodes, weights = gauss(DEGREE + 1)
        length = np.diff(breaks)[:, None]
        at = (breaks[:-1, None] + length * nodes).ravel()
        weight = (length * weights).ravel()[:, None]
        value = basis(at)
        bend = basis(at, nu=2)
        mass = self.mass_per_length * value.T @ (weight * value)
        return mass, self.bending_stiffness * bend.T @ (weight * bend)
