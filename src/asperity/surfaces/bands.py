"""One-third-octave levels in wavelength, dB re 1 µm: those of surfaces, and surfaces that have given ones."""

import math
from collections.abc import Hashable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import groupby
from typing import NamedTuple

import numpy as np

from asperity.arguments import Array, ArrayLike, Flags, as_row, require
from asperity.spectra import HALF_BAND, band_levels, energy_of, psd, third_octave_numbers
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.strip import places_across
from asperity.surfaces.tiles import Tiling, Waves, closed, deviates, random_of, range_of, start_of

MICROMETRE = 1e-6
"""Reference of roughness levels, m (ISO 3095:2013, EN 15610:2009)."""
LIKELY_WAVELENGTHS = (3.15e-3, 0.4)
"""Wavelengths of the bands of ISO 3095:2013, m."""
SAME_COHERENCE = 1.05
"""Wavenumbers within this ratio share one lateral coherence."""
SAMPLES = 2.06
"""Samples that the shortest wave of a band has at least, where a spacing holds the band."""
TILE = 79.5
"""Length of a tile along in longest waves of its range, which then holds waves 80 to 316 whole."""
WHOLE = 0.99
"""Share of a wave's width in the bands that are given, from which it is in them."""
TILE_ACROSS = 36.0
"""Width of a tile across, in 1/κ: the coherence is below 0.0001 at a third of it."""
BLEND_ACROSS = 1.0 / 3.0
"""Width of the blend of two tiles across, in tiles."""
HIGHEST_ACROSS = 16.0
"""Largest wavenumber across, in κ: the mean square beyond, 0.2 %, goes to the others."""
KEPT_LINES = 200
"""Lines of a strip up to which the waves across it are kept, some 0.1 MB a line."""
MIDDLE = 2**40
"""Number of the random numbers of the middle line, which no block of waves beside it has."""
ALL = 2**20
"""Number of the range of all waves around a circumference."""


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


def likely_band(wavelength: Array) -> Flags:
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
    def draw(self) -> str:
        """What its random numbers belong to."""
        around = "" if self.around is None else f" around {self.around:.6g} m"
        return f"bands{around}, seed {self.seed}"

    @cached_property
    def ranges(self) -> "tuple[RangeOfBands, ...]":
        """Ranges that hold some of its bands, the longest waves first; one around a circumference."""
        centres, low, _, _ = _wavenumber_bands(self.wavelengths, self.levels)
        if self.around is not None:
            return (RangeOfBands(self, ALL, tuple(range(len(centres)))),)
        number = [range_of(each) for each in low.tolist()]
        bands = {n: tuple(i for i, each in enumerate(number) if each == n) for n in sorted(set(number))}
        found = (RangeOfBands(self, *each) for each in bands.items())
        return tuple(each for each in found if each.mean_squares.size)


@dataclass(frozen=True)
class RangeOfBands:
    """Waves of those bands of a surface that lie in one range."""

    surface: BandTexture
    number: int
    bands: tuple[int, ...]

    @property
    def along(self) -> Tiling:
        """Tiles along x."""
        if self.surface.around is not None:
            return Tiling(self.surface.around, 0.0, 0.0)
        return Tiling.from_zero(TILE / start_of(self.number))

    @cached_property
    def mean_squares(self) -> Array:
        """Mean square (k,), m², of each wave, 0, 1, 2, … on the length of a tile.

        Each wave has its share of every band that it lies in, of those too that are left out here: more bands
        change none of the waves.
        """
        length = self.along.length
        surface = self.surface
        _, low, high, levels = (
            each[list(self.bands)] for each in _wavenumber_bands(surface.wavelengths, surface.levels)
        )
        held = high * SAMPLES * surface.finest < 1.0
        if not held.any():
            return np.zeros(0)
        targets = MICROMETRE**2 * energy_of(levels)
        count = math.floor(length * high[held].max() + 0.5) + 1
        return _shared_out(low * length, high * length, targets)[:count]

    def waves(self, tile: int, across: Array) -> Waves:
        """Complex amplitudes (k, ny), m, of a tile at places across (ny,), m."""
        size = np.sqrt(2.0 * self.mean_squares)
        lateral = self.surface.lateral
        first = 1 if self.number == ALL else math.ceil(TILE)
        found = np.zeros((len(size), len(across)), np.complex128)
        turns = random_of(self.surface.seed, MIDDLE + self.number, 0, tile).random(max(len(size) - first, 0))
        found[first:] = np.exp(2j * np.pi * turns)[:, None]
        if np.isfinite(lateral) and across.any():
            scale = 2.0 * np.pi * first / (self.along.length * lateral)
            beside = self._beside(found[first:, :1], tile, (scale * across).tobytes())
            found[first:] = np.where(across == 0.0, found[first:], beside)
        return size[:, None] * found

    def _beside(self, middle: Waves, tile: int, z: bytes) -> Waves:
        """Waves (k, ny), mean square one, at distances z of the first, from where they are `middle`."""
        first = 1 if self.number == ALL else math.ceil(TILE)
        _, weight = _across_waves()
        blocks, lines = _blocks_across(first, len(middle), z)
        found = np.zeros((len(middle), lines), np.complex128)
        for side, of_side in groupby(blocks, lambda each: each.side):
            noise = deviates(self.surface.seed, (len(middle), len(weight)), self.number, side, tile)
            missing = middle - noise @ np.sqrt(0.5 * weight)[:, None] if side == 0 else None
            for block in of_side:
                part = found[block.waves, block.lines]
                part += noise[block.waves] @ block.basis
                if missing is not None:
                    part += block.coherence * missing[block.waves]
        return found


def _shared_out(low: Array, high: Array, targets: Array) -> Array:
    """Mean squares (k,), m², of waves 0, 1, 2, … that give bands theirs, and no more; edges in waves.

    A wave has the width of one. One on the edge of two bands belongs to both, and these are scaled until each
    has its own. One that no band holds beyond an edge is left out, where the band has others.
    """
    covered = np.zeros(math.floor(high.max() + 0.5) + 1)
    bands = []
    for begin, end, target in zip(low, high, targets, strict=True):
        beside = np.arange(max(math.floor(begin + 0.5), 1), math.floor(end + 0.5) + 1)
        width = np.clip(np.minimum(beside + 0.5, end) - np.maximum(beside - 0.5, begin), 0.0, None)
        if target > 0.0 and width.any():
            covered[beside] += width
            bands.append((beside, width, target))
    whole = covered >= WHOLE
    within = [np.where(whole[beside], width, 0.0) for beside, width, _ in bands]
    shares = [each if each.any() else width for each, (_, width, _) in zip(within, bands, strict=True)]
    factors = [target / each.sum() for each, (_, _, target) in zip(shares, bands, strict=True)]
    for _ in range(50):
        found = np.zeros_like(covered)
        for (beside, _, _), each, factor in zip(bands, shares, factors, strict=True):
            found[beside] += factor * each
        ratio = [target / np.sum(found[beside] * width) for beside, width, target in bands]
        factors = [factor * each for factor, each in zip(factors, ratio, strict=True)]
        if np.allclose(ratio, 1.0, rtol=0.0, atol=1e-5):
            break
    return found


def _across_waves() -> tuple[Array, Array]:
    """Wavenumbers u (j,) of waves across a tile, over κ, and their shares of the mean square, D."""
    step = 2.0 * np.pi / TILE_ACROSS
    u = step * np.arange(-round(HIGHEST_ACROSS / step), round(HIGHEST_ACROSS / step) + 1)
    weight = (1.0 + u * u) ** -1.5
    return np.asarray(u), weight / weight.sum()


def _across_basis(z: Array) -> Waves:
    """exp(i u z) (j, ny) of all waves u across a tile: products of few, in two steps."""
    turn = 2.0 * np.pi / TILE_ACROSS
    most = round(HIGHEST_ACROSS * TILE_ACROSS / (2.0 * np.pi))
    step = math.isqrt(2 * most) + 1
    small = np.exp(1j * turn * np.arange(step)[:, None] * z)
    large = np.exp(1j * turn * np.arange(-most, most + 1, step)[:, None] * z)
    return (large[:, None] * small).reshape(-1, len(z))[: 2 * most + 1]


class _Block(NamedTuple):
    """Waves of nearly one wavenumber in a tile across, weighted as the tile is."""

    waves: slice
    side: int  # number of the tile
    lines: slice
    basis: Waves  # exp(i u z) (j, ny), times the size of a part of each wave
    coherence: Array  # with the middle of the tile


def _blocks_across(first: int, count: int, z: bytes) -> tuple[list[_Block], int]:
    """Blocks of so many waves, `first` the number of the first on a tile, z its distances; and lines."""
    make = _made_blocks if len(z) <= KEPT_LINES * np.dtype(np.float64).itemsize else _made_blocks.__wrapped__
    return make(first, count, z)


@lru_cache(maxsize=8)  # those of each range, as tiles of all follow each other along the path
def _made_blocks(first: int, count: int, z: bytes) -> tuple[list[_Block], int]:
    tiling = Tiling.around_zero(TILE_ACROSS, BLEND_ACROSS)
    _, weight = _across_waves()
    number = np.log(np.arange(first, first + count) / first) / math.log(SAME_COHERENCE)
    blocks = list[_Block]()
    number = np.floor(number + 1e-9)
    near = np.frombuffer(z)
    for each in np.unique(number).tolist():
        waves = slice(*np.searchsorted(number, (each, each + 1.0)).tolist())
        distance = SAME_COHERENCE ** (each + 0.5) * near
        for side in tiling.touching(distance[0], distance[-1]):
            lines = tiling.held(side, distance)
            if lines.start == lines.stop:  # lines far apart step over tiles
                continue
            basis = _across_basis(distance[lines])
            share = tiling.weight(side, distance[lines])
            size = np.sqrt(0.5 * weight)[:, None]
            blocks.append(_Block(waves, side, lines, size * basis * share, share * (weight @ basis.real)))
    return sorted(blocks, key=lambda each: each.side), len(near)


def from_bands(n: int, spacing: float, wavelengths: ArrayLike, levels_db: ArrayLike, seed: int) -> Profile:
    """Line with given one-third-octave levels in wavelength, dB re 1 µm rms (ISO 3095:2013, EN 15610:2019).

    Amplitudes are fixed and phases random, so every realisation has the levels asked for. The density is
    constant inside a band; bands that are not given hold nothing. Wavelengths are band centres, m, in any
    order, nominal (0.63 m) or exact (10^(n/10) m). The line closes on itself, as around a wheel; it is no
    shorter than the edge of the longest band. Bands that the spacing does not hold are left out, and a finer
    one adds them to the same line.
    """
    texture = band_texture(wavelengths, levels_db, math.inf, seed, spacing, n * spacing)
    heights = closed(texture, n, np.zeros(1))[:, 0]
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
    heights = closed(texture, nx, places_across(ny, spacing[1]))
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
    given, levels = (as_row(each) for each in (wavelengths, levels_db))
    _wavenumber_bands(given, levels)
    return BandTexture(tuple(given.tolist()), tuple(levels.tolist()), lateral, seed, finest, around)


def range_of_bands(wavelengths: ArrayLike) -> str:
    """Bands in words."""
    return f"one-third octaves {np.max(wavelengths):.4g} to {np.min(wavelengths):.4g} m"


def _wavenumber_bands(wavelengths: ArrayLike, levels_db: ArrayLike) -> tuple[Array, Array, Array, Array]:
    given, levels = (as_row(each) for each in (wavelengths, levels_db))
    centres = 10.0 ** (-third_octave_numbers(given) / 10.0)
    near = np.abs(given * centres - 1.0) < 0.03  # nominal ones lie within 2.4 % of the exact ones
    right = near.all() and np.unique(centres).size == centres.size
    remedy = "Give each band once by its centre, as 0.1, 0.125, 0.16 m."
    require(right, "wavelengths", given, "distinct centres of base-10 one-third octaves", remedy)
    return centres, centres / HALF_BAND, centres * HALF_BAND, levels
