"""Defects of wheel and rail as lines, heights positive out of the body: corrugation, flat, dipped joint."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from asperity.arguments import Array, ArrayLike, require
from asperity.surfaces.heightmap import Profile
from asperity.surfaces.tiles import Tiling, Waves, fine, heights_at, random_of

FlatShape = Literal["fresh", "worn"]

TABLE_POINTS = 1001
"""Points over half a worn flat at which its envelope is found."""
WAVES_OF_BAND = 10.0
"""Waves in a tile of a band of corrugation, and their wavelengths in it, at least."""


def corrugation(
    n: int,
    spacing: float,
    *,
    wavelength: float,
    amplitude: float,
    bandwidth: float | None = None,
    seed: int = 0,
    before: int = 0,
) -> Profile:
    """Corrugation of a rail, heights about zero, m: a sine, or a band of waves about one wavelength, m.

    The amplitude, m, is half the height between peak and trough of a sine, √2 of the rms of a band. That has
    a width in octaves, constant density and random phases, drawn as `asperity.surfaces.tiles` says: a longer
    line, or one of another spacing, is the same corrugation, and each tile has the exact rms. The rms of a
    line of length L scatters about it by 1/(2 √(B L)) at most, as that of any noise of a bandwidth B in 1/m:
    it is left as it was drawn, since one record of a rail has more of its corrugation than the next. A sine
    starts at zero rising; both count from the point `before`. No standard gives a spectrum of corrugation; an
    amplitude of 25 µm at the wavelength v/f_pp of the pinned-pinned frequency is used in the literature.
    """
    size = amplitude / math.sqrt(2.0)
    half = 2.0 ** (0.0 if bandwidth is None else bandwidth / 2.0)
    received = f"{wavelength / half:.4g} m as the shortest wavelength"
    allowed = f"at least two samples, {2.0 * spacing:.4g} m"
    require(2.0 * spacing <= wavelength / half < math.inf, "corrugation", received, allowed)
    x = np.asarray((np.arange(n) - before) * spacing)
    if bandwidth is None:
        heights = math.sqrt(2.0) * size * np.sin(2.0 * np.pi * x / wavelength)
        return Profile(heights, spacing, f"corrugation of {wavelength:.4g} m")
    band = _BandOfWaves(wavelength, half, size, seed)
    heights = heights_at((band,), x, 1, lambda _, tile: fine(band.waves(tile, np.zeros(1))))[:, 0]
    return Profile(heights, spacing, f"corrugation of {wavelength:.4g} m, {bandwidth:g} octaves, seed {seed}")


@dataclass(frozen=True)
class _BandOfWaves:
    """Waves of one amplitude in a band about a wavelength, m, drawn the same all across."""

    wavelength: float
    half: float  # ratio of the band's edges to its centre
    rms: float  # m
    seed: int

    @property
    def along(self) -> Tiling:
        """Tiles that hold some waves of the band."""
        width = (self.half - 1.0 / self.half) / self.wavelength
        length = max(WAVES_OF_BAND / width, WAVES_OF_BAND * self.wavelength)
        return Tiling.from_zero(length)

    def waves(self, tile: int, across: Array) -> Waves:
        """Complex amplitudes (k, ny), m, of a tile."""
        middle = self.along.length / self.wavelength
        inside = np.arange(math.ceil(middle / self.half), math.floor(middle * self.half) + 1)
        found = np.zeros(inside[-1] + 1, np.complex128)
        turns = random_of(self.seed, tile).random(len(inside))
        found[inside] = self.rms * math.sqrt(2.0 / len(inside)) * np.exp(2j * np.pi * turns)
        return np.repeat(found[:, None], len(across), axis=1)


def flat_length(depth: float, radius: float) -> float:
    """Chord l = √(8 R d) of a fresh wheel flat, m, for depths d up to a twentieth of the radius R, m."""
    allowed = f"above zero, up to {radius / 20.0:.4g} m (R/20)"
    require(0.0 < depth <= radius / 20.0, "depth of the wheel flat", f"{depth} m", allowed)
    return math.sqrt(8.0 * radius * depth)


def flat_geometry(
    x: ArrayLike, depth: float, radius: float, shape: FlatShape = "fresh", length: float | None = None
) -> Array:
    """Height of a flatted wheel against the round one, zero or negative, m, along its circumference, m.

    `x` counts from the middle of the flat. Fresh: a chord, -(d - x²/2R) for |x| <= l/2. Worn: rounded, -d/2
    (1 + cos 2πx/l), its length l, m, at least that of the chord √(8 R d), which all others have. S. G. Newton
    and R. A. Clark, J. Mech. Eng. Sci. 21 (1979) 287 (not seen; chord and rounded flat).
    """
    length = _length(depth, radius, shape, length)
    at = np.asarray(x, dtype=np.float64)
    if shape == "fresh":
        height = -(depth - at**2 / (2.0 * radius))
    else:
        height = -0.5 * depth * (1.0 + np.cos(2.0 * np.pi * at / length))
    return np.where(np.abs(at) <= length / 2.0, height, 0.0)


def _length(depth: float, radius: float, shape: str, length: float | None) -> float:
    chord = flat_length(depth, radius)
    if length is not None:
        long_enough = shape == "worn" and chord * (1.0 - 1e-9) <= length < math.inf
        allowed = f"that of a worn flat, at least its chord of {chord:.4g} m; none of a fresh one"
        require(long_enough, "length of the wheel flat", f"{length} m", allowed)
    return chord if length is None else length


def flat_trajectory(
    x: ArrayLike, depth: float, radius: float, shape: FlatShape = "fresh", length: float | None = None
) -> Array:
    """Height of the centre of a rigid flatted wheel that rolls on a rigid flat rail, zero or negative, m.

    `x` is the centre's position, m, from where the middle of the flat is below it; the rest as in
    `flat_geometry`. Over a fresh flat the wheel turns about the ends of the chord in turn: -(l/2 - |x|)²/2R,
    with a kink of slope ±l/2R at the middle. For a worn flat z(s) the envelope max over s of z(s) - (s -
    x)²/2R is tabulated. T. X. Wu and D. J. Thompson, ISVR Technical Memorandum 859 (2001) (wheel flats).
    """
    length = _length(depth, radius, shape, length)
    distance = np.abs(np.asarray(x, dtype=np.float64))
    if shape == "fresh":
        return np.where(distance <= length / 2.0, -((length / 2.0 - distance) ** 2) / (2.0 * radius), 0.0)
    touching = np.linspace(-length / 2.0, length / 2.0, 2 * TABLE_POINTS - 1)
    height = flat_geometry(touching, depth, radius, shape, length)
    at = touching[TABLE_POINTS - 1 :]
    envelope = np.max(height - (touching - at[:, None]) ** 2 / (2.0 * radius), axis=1)
    return np.interp(distance, at, envelope, right=0.0)


def dipped_joint(x: ArrayLike, depth: float, length: float) -> Array:
    """Height of a rail with a dipped joint, m: two parabolas that meet in a kink.

    -depth (1 - 2|x|/length)² for |x| <= length/2, else zero, x from the joint; all in m. The rail turns by 8
    depth/length at the joint and joins the straight rail without a kink. T. X. Wu and D. J. Thompson, J.
    Sound Vib. 267 (2003) 485-496 (rail joints with quadratic dips).
    """
    allowed = f"above zero, up to {length / 20.0:.4g} m (a twentieth of its length)"
    require(0.0 < depth <= length / 20.0, "depth of the dipped joint", f"{depth} m", allowed)
    remaining = np.clip(1.0 - 2.0 * np.abs(np.asarray(x, dtype=np.float64)) / length, 0.0, None)
    return -depth * remaining**2
