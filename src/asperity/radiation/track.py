"""Sound power of rail and sleepers from vibration along the track."""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.special import h2vp, j1

from asperity.arguments import Array, ArrayLike, Complex, finite_array, positive
from asperity.quadrature import gauss
from asperity.structures.lateral_rail import LateralTrack
from asperity.structures.mobility import FEWEST_NODES, ForceOverBay, Mobility
from asperity.structures.track import Track

SPEED_OF_SOUND = 343.2
"""m/s; ISO 9613-1:1993, reference for 20 °C."""

IMPEDANCE = 413.0
"""Density times speed of sound, Pa s/m."""


def wavenumber(frequency: Array) -> Array:
    """k = ω/c of sound, rad/m, at frequencies, Hz."""
    return 2.0 * np.pi * frequency / SPEED_OF_SOUND


def cylinder(ka: ArrayLike) -> Array:
    """Radiation ratio of a cylinder of infinite length that oscillates as a rigid body (line dipole).

    Parameters
    ----------
    ka : array_like
        Positive.

    Returns
    -------
    ndarray
        2/(π ka |H_1'(ka)|²), of the shape of `ka`.

    Notes
    -----
    Outside, p = A H_1(kr) cos θ with Hankel's function of the second kind; −∂p/∂r = iωρ v cos θ on the
    surface gives |A| = ρ c v/|H_1'(ka)|. Far away |H_1|² = 2/(πkr); the power that passes is divided by that
    of a plane wave of the same mean square velocity. Of an oscillating rigid cylinder ⟨v_n²⟩ is half
    of its ⟨v²⟩. Limits: (π/2)(ka)³ at low ka, 1 at high ka.
    """
    ka = np.asarray(ka, dtype=float)
    return 2.0 / (np.pi * ka * np.abs(h2vp(1, ka)) ** 2)


def baffled_piston(ka: ArrayLike) -> Array:
    """Radiation ratio of a rigid circular piston in an infinite plane, at positive ka.

    1 − J₁(2ka)/ka (Rayleigh 1896): (ka)²/2 at low ka, 1 at high ka.
    """
    ka = np.asarray(ka, dtype=float)
    return 1.0 - j1(2.0 * ka) / ka


def squared_mobility(track: Track, frequency: ArrayLike, force: ForceOverBay | None = None) -> Array:
    """Integral along the rail of the squared mobility, mean over the places of the force in a bay.

    Parameters
    ----------
    track : Track
        With its damping as it is: constant loss factors, or relaxations.
    frequency : array_like (f,)
        Hz, positive.
    force : callable, optional
        How the mean square of the force is spread over a bay, the same on both sides of its middle; evenly
        by default. A wheel presses less where the rail gives way, most of all at mid-span near the
        pinned-pinned frequency.

    Returns
    -------
    ndarray (f,)
        Mean over x₀ of ∫|Y(x|x₀)|² dx over the whole rail, m (m/s)²/N². Times the mean square force it is
        ∫⟨v²⟩dx, on both sides of the force.

    Raises
    ------
    InputError
        If a frequency is not positive, or so high that a wave is lost within a bay.

    Notes
    -----
    Both waves and their products: u_j is wave j in the bay after that of the force, and Σ_p Σ_ij u_i u_j*
    (λ_i λ_j*)^p = Σ_ij u_i u_j*/(1 − λ_i λ_j*) over all bays. Within a bay by Gauss's rule, in that of the
    force from the force on, on both of its sides; of bays that differ the mean is over all of their cell.
    """
    return _mobility(track, frequency).rail(force)


def squared_sleeper_mobility(track: Track, frequency: ArrayLike, force: ForceOverBay | None = None) -> Array:
    """Sum over all half sleepers of the squared mobility, mean over the places of the force in a bay.

    Velocity of the sleeper per force on the rail, squared, (f,), (m/s)²/N², at positive frequencies (f,), Hz.
    A sleeper on its ballast moves by K_p/(K_p + K_b − m_s ω²) of the rail above it; of one that bends, it is
    the mean over its length. The rest as in `squared_mobility`.
    """
    if track.continuous:
        moved = track.support.sleeper_square(2.0 * np.pi * above_zero(frequency))
        return moved * squared_mobility(track, frequency, force) / track.sleeper_spacing
    return _mobility(track, frequency).sleepers(track, force)


def squared_point_mobility(track: Track, frequency: ArrayLike, force: ForceOverBay | None = None) -> Array:
    """Squared mobility of the rail at the force, mean over a bay, (f,), (m/s)²/N²; as `squared_mobility`."""
    return _mobility(track, frequency).point(force)


def _mobility(track: Track, frequency: ArrayLike) -> Mobility:
    omega = 2.0 * np.pi * above_zero(frequency)
    return Mobility(track.waves(omega), omega)


def above_zero(frequency: ArrayLike) -> Array:
    """Frequencies (f,), Hz, or an `InputError` where one is not positive."""
    return np.atleast_1d(finite_array("frequency (Hz)", frequency, "finite positive numbers", above=0.0))


def dipole_ratio(frequency: Array, dipole_area: float, width: float) -> Array:
    """Radiation ratio of a rigid section that oscillates (f,): that of a cylinder with the same two limits.

    At low frequency the line dipole of an area, m², which the section and the air that goes with it displace;
    at high frequency plane faces of a width, m, together, from which the ratio counts.
    """
    radius = (dipole_area**2 / (4.0 * np.pi * width)) ** (1.0 / 3.0)
    return cylinder(wavenumber(frequency) * radius)


STEEL_DENSITY = 7850.0
"""kg/m³; with the mass per length of a rail, the area of its section."""


@dataclass(frozen=True, eq=False)
class RailSection:
    """Section of a rail as a radiator of its vertical motion.

    Parameters
    ----------
    foot_width, head_width : float
        b_f and b_h, m.
    area : float
        S of the section, m².
    table : tuple of ndarray, optional
        Frequencies (n,), Hz, rising, and radiation ratios (n,) that replace the model: interpolated in their
        logarithms, and beyond the table as at its ends.

    Raises
    ------
    InputError
        If a dimension is not positive.

    Notes
    -----
    The power per length is ρ c · 2 b_f · σ · ⟨v²⟩: the ratio counts from the two faces of the foot. At low
    frequency the section is a line dipole, W' = ρ c ⟨v²⟩ k³ D²/8, of the area D = S + (π/4)(b_f² + b_h²) that
    it displaces and of the air that goes with it, for foot and head that of a flat strip each. At high
    frequency the faces of the foot radiate like plane ones; the head lies in front of one of them and adds
    nothing. In between the ratio is that of the oscillating cylinder with the same two limits, whose radius
    is (D²/(8 π b_f))^(1/3).

    Against a boundary element solution of the section 60E1 in free air (docs/railway/noise.md): −0.7 to
    +1.4 dB in the one-third octaves up to 1.6 kHz, −3.8 dB at 2 kHz, where the space between head and foot
    resonates, −2.4 to +0.2 dB above. In two dimensions: the waves in the rail are longer than those in the
    air, and reach farther than those are long. Without the ground under the rail.
    """

    foot_width: float
    head_width: float
    area: float
    table: tuple[Array, Array] | None = None

    def __post_init__(self) -> None:
        for what in ("foot_width", "head_width", "area"):
            positive(f"{what} of the rail's section", getattr(self, what))

    @property
    def radiating_width(self) -> float:
        """Both faces of the foot, m."""
        return 2.0 * self.foot_width

    @property
    def dipole_area(self) -> float:
        """Area D of the section and of the air that goes with it, m²."""
        return self.area + 0.25 * np.pi * (self.foot_width**2 + self.head_width**2)

    def radiation_ratio(self, frequency: ArrayLike) -> Array:
        """Ratio σ (f,) at positive frequencies (f,), Hz."""
        f = above_zero(frequency)
        if self.table is not None:
            at, ratio = self.table
            return np.exp(np.interp(np.log(f), np.log(at), np.log(ratio)))
        return dipole_ratio(f, self.dipole_area, self.radiating_width)

    def power_per_force(self, track: Track, frequency: ArrayLike, force: ForceOverBay | None = None) -> Array:
        """Sound power of the whole rail per mean square force on it, (f,), W/N², at frequencies (f,), Hz.

        `force` is how that is spread over a bay, as in `squared_mobility`.
        """
        ratio = self.radiation_ratio(frequency)
        return IMPEDANCE * self.radiating_width * ratio * squared_mobility(track, frequency, force)


@dataclass(frozen=True)
class SleeperTop:
    """Top of half a sleeper, whose other faces lie in ballast: a piston in a plane.

    Parameters
    ----------
    length : float
        Of the whole sleeper, m: half of it moves with each rail.
    width : float
        Of its top along the track, m.

    Notes
    -----
    A rigid circular piston of the same area in an infinite rigid plane; a strip of 1.3 m by 0.25 m radiates
    1 to 2 dB less from 160 to 400 Hz. Each half sleeper radiates by itself: where the sound is longer than
    some sleeper distances, below about 300 Hz, neighbours that move together radiate more than the sum.
    Bending of the sleepers and absorption by the ballast are left out.
    """

    length: float
    width: float

    @property
    def area(self) -> float:
        """Of half a sleeper, m²."""
        return 0.5 * self.length * self.width

    @property
    def radius(self) -> float:
        """Radius of the circle of the same area, m."""
        return math.sqrt(self.area / math.pi)

    def radiation_ratio(self, frequency: ArrayLike) -> Array:
        """Ratio σ (f,) at positive frequencies (f,), Hz: of the power to ρ c S ⟨v²⟩."""
        return baffled_piston(wavenumber(above_zero(frequency)) * self.radius)

    def power_per_force(self, track: Track, frequency: ArrayLike, force: ForceOverBay | None = None) -> Array:
        """Sound power of all half sleepers per mean square force on the rail, (f,), W/N²; frequencies, Hz.

        `force` is how that is spread over a bay, as in `asperity.radiation.track.squared_mobility`.
        """
        ratio = self.radiation_ratio(frequency)
        return IMPEDANCE * self.area * ratio * squared_sleeper_mobility(track, frequency, force)


BOX = 1.19
"""Area of the air that goes with a square section, over the square of its height (of a flat strip π/4)."""


@dataclass(frozen=True)
class SideOfRail:
    """Section of a rail as a radiator of its lateral motion.

    Parameters
    ----------
    height, foot_width, head_width : float
        H, b_f and b_h, m.

    Notes
    -----
    The power per length is ρ c · 2H · σ · ⟨v²⟩, ⟨v²⟩ the mean over the height. The air between head and foot
    moves with the web: at low frequency the section is the line dipole of a box, of the area D = H (b_f +
    b_h)/2 + 1.19 H²; at high frequency its two sides radiate like plane ones. In between as
    `asperity.radiation.track.RailSection`. Against boundary elements of the section 60E1 in free air:
    +0.8 to −1 dB up to 315 Hz, −2 to −3.4 dB from 400 to 800 Hz, where the space between head and foot
    resonates, −1.5 to +2 dB above. Roll counts as much as motion of the whole, though it is a poorer
    radiator.
    """

    height: float
    foot_width: float
    head_width: float

    def radiation_ratio(self, frequency: ArrayLike) -> Array:
        """Ratio σ (f,) at positive frequencies (f,), Hz."""
        outline = 0.5 * self.height * (self.foot_width + self.head_width)
        return dipole_ratio(above_zero(frequency), outline + BOX * self.height**2, 2.0 * self.height)

    def power(self, frequency: ArrayLike, square: Array) -> Array:
        """Sound power (..., f), W, of a mean square velocity that is integrated along the rail (..., f)."""
        return IMPEDANCE * 2.0 * self.height * self.radiation_ratio(frequency) * square


def squared_lateral_mobility(
    track: LateralTrack, frequency: ArrayLike, places: Array, place: float
) -> Complex:
    """Integrals along the rail of how two forces at a contact move it sideways, (n, 2, 2, f), m (m/s)²/N².

    Parameters
    ----------
    track : LateralTrack
    frequency : array_like (f,)
        Hz, positive.
    places : ndarray (n,)
        Of the contact in the bay, 0 to L, m, rising, that lie symmetrically about its middle.
    place : float
        Of the contact across the head, m from its middle, positive towards the field side.

    Returns
    -------
    ndarray (n, 2, 2, f) of complex
        Hermitian M, by which forces (F, T), downwards and sideways, make ∫⟨v²⟩ dx = (F, T)* M (F, T), mean
        over the height of the rail; right of each place twice, so that the mean over all places holds both
        sides.
    """
    omega = 2.0 * np.pi * above_zero(frequency)
    waves = track.waves(omega)
    spacing = track.track.sleeper_spacing
    edges = np.concatenate([[0.0], places, [spacing]])
    count = FEWEST_NODES + int(np.ceil(np.abs(waves.wavenumbers).max() * np.diff(edges).max()))
    node, weight = gauss(count)

    def between(begin: float, end: float) -> Complex:
        """Integral of the products of motions by waves i and j over a piece of the bay, (f, i, j)."""
        moved = waves.outgoing_at(begin + (end - begin) * node)
        shares = (end - begin) * weight
        weighted = np.einsum("x,ab,fxbj->fxaj", shares, track.mean_squares, moved, optimize=True)
        first, second = (each.reshape(len(omega), -1, each.shape[-1]) for each in (moved, weighted))
        return first.conj().swapaxes(1, 2) @ second

    pieces = np.stack([between(*each) for each in pairwise(edges.tolist())])
    ahead = np.cumsum(pieces[::-1], axis=0)[::-1]  # from each edge on
    product = waves.multipliers.T.conj()[:, :, None] * waves.multipliers.T[:, None]
    behind = ahead[0] * product / (1.0 - product)
    forces = track.contact_shapes(place)
    found = []
    for x0, rest in zip(places, ahead[1:], strict=True):
        sent = (waves.coefficients * np.einsum("aj...,na->nj...", waves.incoming(x0), forces)).T  # (f, j, n)
        found.append(sent.conj().swapaxes(1, 2) @ (rest + behind) @ sent)
    return 2.0 * omega**2 * np.moveaxis(np.stack(found), 1, -1)
