"""One-third-octave levels in wavelength, dB re 1 µm: those of surfaces, and surfaces that have given ones."""

import math
from collections.abc import Hashable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from asperity.arguments import Array, ArrayLike, NDArray, require
from asperity.spectra import HALF_BAND, band_energies, band_levels, psd
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.strip import places_across
from asperity.surfaces.tiles import Tiling, Waves, closed, deviates, random_of

MICROMETRE = 1e-6
"""Reference of roughness levels, m (ISO 3095:2013, EN 15610:2009)."""
LIKELY_WAVELENGTHS = (3.15e-3, 0.4)
"""Wavelengths of the bands of ISO 3095:2013, m."""
SAME_COHERENCE = 1.05
"""Wavenumbers within this ratio share one lateral coherence."""
SAMPLES = 2.06
"""Samples that the shortest wave of a band has at least, where a spacing holds the band."""
BAND_LENGTHS = 20.0
"""Length of a tile along in longest wavelengths: each band has waves enough."""
BLEND_LENGTHS = 2.0
"""Length of the blend of two tiles along in longest wavelengths."""
FEW = 500
"""Waves up to which those on the edges of bands matter."""
TILE_ACROSS = 36.0
"""Width of a tile across, in 1/κ: the coherence is below 0.0001 at a third of it."""
BLEND_ACROSS = 12.0
"""Width of the blend of two tiles across, in 1/κ."""
HIGHEST_ACROSS = 16.0
"""Largest wavenumber across, in κ: the mean square beyond, 0.2 %, goes to the others."""
MIDDLE = 2**40
"""Number of the random numbers of the middle line, which no block of waves beside it has."""


def band_levels_of(surface: Profile | HeightMap) -> tuple[Array, Array]:
    """One-third-octave levels, dB re 1 µm, with their wavelengths, m; of a map the mean power along x.

    Complete heights, m, under a Hann window; the mean of each line is removed. The bands are those that the
    length resolves and the spacing holds. The exact band centres fall; an empty band has a level of minus
    infinity.
    """
    wavenumber, density = psd(surface.heights.T, float(np.atleast_1d(surface.spacing)[0]))
    if density.ndim == 2:
        density = density.mean(axis=0)
    centres, levels = band_levels(wavenumber, density, MICROMETRE)
    return 1.0 / centres, levels


def likely_band(wavelength: Array) -> NDArray[np.bool_]:
    """Which bands of a wavelength, m, lie between those of 3.15 mm and 0.4 m."""
    shortest, longest = LIKELY_WAVELENGTHS
    return (wavelength > shortest / HALF_BAND) & (wavelength < longest * HALF_BAND)


@dataclass(frozen=True)
class BandTexture:
    """A surface that is drawn of one-third-octave levels, as waves along x that lines beside share in part.

    Each wave has a fixed amplitude and a random phase on the middle line, which thus has exactly the levels
    asked for. Beside it, it changes with the distance as a Gaussian process of the coherence z K₁(z), given
    what it is in the middle: Σ √w_j ξ_j exp(i u_j z), z = κy, with weights w of D at steps of u. It is made
    of tiles across, whose width grows with the wavelength.
    """

    wavelengths: tuple[float, ...]  # centres of bands, m
    levels: tuple[float, ...]  # dB re 1 µm
    lateral: float
    seed: int
    finest: float  # distance of the points along, m: bands that it does not hold are left out
    around: float | None = None  # length on which the surface closes along x, m; tiles without it

    @property
    def name(self) -> Hashable:
        """What names it."""
        return self

    @property
    def along(self) -> Tiling:
        """Tiles along x."""
        if self.around is not None:
            return Tiling(self.around, 0.0, 0.0)
        longest = max(self.wavelengths)
        return Tiling.from_zero(BAND_LENGTHS * longest, BLEND_LENGTHS * longest)

    @property
    def draw(self) -> str:
        """What its random numbers belong to."""
        return f"bands in {self.along}, seed {self.seed}"

    @cached_property
    def mean_squares(self) -> Array:
        """Mean square (k,), m², of each wave, 0, 1, 2, … on the length of a tile.

        Each wave has its share of every band that it lies in, of those too that are left out here: more bands
        change none of the waves.
        """
        length = self.along.length
        _, low, high, levels = _wavenumber_bands(self.wavelengths, self.levels)
        held = high * SAMPLES * self.finest < 1.0
        count = math.ceil(length * high[held].max() + 0.5) if held.any() else 1
        targets = MICROMETRE**2 * 10.0 ** (levels / 10.0)
        return _shared_out(low * length, high * length, targets, max(count, FEW))[:count]

    def waves(self, tile: int, across: Array) -> Waves:
        """Complex amplitudes (k, ny), m, of a tile at places across (ny,), m."""
        size = np.sqrt(2.0 * self.mean_squares)
        turns = random_of(self.seed, MIDDLE, 0, tile).random(len(size))
        middle = np.exp(2j * np.pi * turns)[:, None]
        if not np.isfinite(self.lateral) or not across.any():
            return np.asarray(size[:, None] * np.broadcast_to(middle, (len(size), len(across))))
        found = np.empty((len(size), len(across)), np.complex128)
        for number, block in _blocks(len(size), self.along.length):
            scale = 2.0 * np.pi * SAME_COHERENCE ** (number + 0.5) / self.lateral
            found[block] = self._beside(middle[block], (number, tile), scale * across)
        found[0] = 0.0
        return size[:, None] * found

    def _beside(self, middle: Waves, place: tuple[int, int], z: Array) -> Waves:
        """Waves of one coherence (k, ny), mean square one, at distances z from where they are `middle`."""
        number, tile = place
        tiling = Tiling.around_zero(TILE_ACROSS, BLEND_ACROSS)
        u, weight = _across_waves()
        found = np.zeros((len(middle), len(z)), np.complex128)
        for side in tiling.touching(z.min(), z.max()):
            shape = (len(middle), len(u))
            noise = deviates(self.seed, shape, number, side, tile) * np.sqrt(0.5 * weight)
            process = noise @ np.exp(1j * u[:, None] * z)
            if side == 0:
                coherence = weight @ np.cos(u[:, None] * z)
                process += coherence * (middle - noise.sum(axis=1, keepdims=True))
            found += tiling.weight(side, z) * process
        return found


def _shared_out(low: Array, high: Array, targets: Array, count: int) -> Array:
    """Mean squares (count,), m², of waves 0, 1, 2, … that give bands theirs; edges in waves.

    A wave has the width of one; what lies on an edge belongs to two bands, which matters where waves are few.
    There the bands are scaled until each has its own.
    """
    index = np.arange(count)
    shares = []
    for begin, end, target in zip(low, high, targets, strict=True):
        there = slice(max(math.floor(begin), 1), math.ceil(end) + 1)
        beside = np.arange(there.start, there.stop)
        overlap = np.clip(np.minimum(beside + 0.5, end) - np.maximum(beside - 0.5, begin), 0.0, None)
        part = (
            (target * overlap / overlap.sum())[: max(count - there.start, 0)]
            if overlap.any()
            else overlap[:0]
        )
        shares.append((slice(there.start, there.start + len(part)), part))
    factors, few = np.ones(len(targets)), (high < FEW) & (targets > 0.0)
    for _ in range(50):
        found = np.zeros(count)
        for (there, part), factor in zip(shares, factors, strict=True):
            found[there] += factor * part
        ratio = targets[few] / band_energies(index[:FEW], found[:FEW], low[few], high[few])
        factors[few] *= ratio
        if np.allclose(ratio, 1.0, rtol=0.0, atol=1e-5):
            break
    return found


def _across_waves() -> tuple[Array, Array]:
    """Wavenumbers u (j,) of waves across a tile, over κ, and their shares of the mean square, D."""
    step = 2.0 * np.pi / TILE_ACROSS
    u = step * np.arange(-round(HIGHEST_ACROSS / step), round(HIGHEST_ACROSS / step) + 1)
    weight = np.asarray((1.0 + u * u) ** -1.5)
    return np.asarray(u), weight / weight.sum()


def _blocks(count: int, length: float) -> Iterator[tuple[int, slice]]:
    """Runs of waves whose wavenumbers are nearly the same, with the number of each, on whatever length."""
    if count < 2:
        return
    number = np.floor(np.log(np.arange(1, count) / length) / math.log(SAME_COHERENCE) + 1e-9).astype(int)
    starts = 1 + np.flatnonzero(np.diff(number, prepend=number[0] - 1))
    for first, stop in pairwise([*starts.tolist(), count]):
        yield int(number[first - 1]), slice(first, stop)


def from_bands(n: int, spacing: float, wavelengths: ArrayLike, levels_db: ArrayLike, seed: int) -> Profile:
    """Line with given one-third-octave levels in wavelength, dB re 1 µm rms (ISO 3095:2013, EN 15610:2019).

    Amplitudes are fixed and phases random, so every realisation has the levels asked for. The density is
    constant inside a band; bands that are not given hold nothing. Wavelengths are band centres, m, in any
    order, nominal (0.63 m) or exact (10^(n/10) m). The line closes on itself, as around a wheel; it is no
    shorter than the edge of the longest band. Bands that the spacing does not hold are left out, and a finer
    one adds them to the same line.
    """
    texture = band_texture(wavelengths, levels_db, math.inf, seed, spacing, n * spacing)
    heights = closed(texture.waves(0, np.zeros(1)), n)[:, 0]
    return Profile(heights, spacing, f"{range_of_bands(wavelengths)}, seed {seed}")


def strip_from_bands(
    shape: tuple[int, int],
    spacing: tuple[float, float],
    wavelengths: ArrayLike,
    levels_db: ArrayLike,
    *,
    lateral: float = 1.0,
    seed: int,
    around: float | None = None,
) -> HeightMap:
    """Strip whose lines along x have given one-third-octave levels in wavelength, dB re 1 µm rms.

    The spectrum is S(kx, ky) = S1(kx) D(ky | kx): S1 is constant inside a band, as in `from_bands`, and

        D(ky | kx) = (1 + (ky/κ)²)^(-3/2) / 2κ,   κ = |kx| / lateral,   ∫ D dky = 1,

    so the share of the waves of wavenumber kx that lines a distance y apart have in common (their coherence)
    is κy K₁(κy), K₁ the modified Bessel function: 0.5 at κy = 1.26, that is at a fifth of a wavelength for
    lateral = 1, the correlation length across over that along; ``inf`` makes all lines equal.

    The strip closes on itself along x and does not across. Its middle line, ny // 2, is that of `from_bands`:
    it has the levels asked for, as `asperity.spectra.band_levels` finds them from the periodogram of the
    whole length; lines beside it scatter about them. A wider strip, or a finer spacing, holds the same waves.
    It closes on the length `around`, m, if one is given, which the rows share out.

    An isotropic areal spectrum C ∝ q^(-p) has D = (1 + (ky/kx)²)^(-p/2) times a constant and a line density
    S1 ∝ kx^(1-p). With lateral = 1 the strip is thus exactly isotropic where the line density falls as ν^(-2)
    (1 dB from band to shorter band) and nearly so beside it: the limit of ISO 3095:2013 falls as ν^(-3) above
    100 mm and as ν^(-1.6) below 30 mm.
    """
    nx, ny = shape
    texture = band_texture(wavelengths, levels_db, lateral, seed, spacing[0], around or nx * spacing[0])
    heights = closed(texture.waves(0, places_across(ny, spacing[1])), nx)
    return HeightMap(heights, spacing, f"{range_of_bands(wavelengths)}, lateral {lateral:g}, seed {seed}")


def band_texture(
    wavelengths: ArrayLike,
    levels_db: ArrayLike,
    lateral: float,
    seed: int,
    finest: float,
    around: float | None = None,
) -> BandTexture:
    """Surface of one-third-octave levels, drawn; see `strip_from_bands`, and `BandTexture` for the rest."""
    given, levels = (np.atleast_1d(np.asarray(each, dtype=np.float64)) for each in (wavelengths, levels_db))
    _wavenumber_bands(given, levels)
    return BandTexture(tuple(given.tolist()), tuple(levels.tolist()), lateral, seed, finest, around)


def range_of_bands(wavelengths: ArrayLike) -> str:
    """Bands in words."""
    return f"one-third octaves {np.max(wavelengths):.4g} to {np.min(wavelengths):.4g} m"


def _wavenumber_bands(wavelengths: ArrayLike, levels_db: ArrayLike) -> tuple[Array, Array, Array, Array]:
    given, levels = (np.atleast_1d(np.asarray(each, dtype=np.float64)) for each in (wavelengths, levels_db))
    centres = 10.0 ** (np.rint(-10.0 * np.log10(given)) / 10.0)
    near = np.abs(given * centres - 1.0) < 0.03  # nominal ones lie within 2.4 % of the exact ones
    right = near.all() and np.unique(centres).size == centres.size
    remedy = "Give each band once by its centre, as 0.1, 0.125, 0.16 m."
    require(right, "wavelengths", given, "distinct centres of base-10 one-third octaves", remedy)
    return centres, centres / HALF_BAND, centres * HALF_BAND, levels
