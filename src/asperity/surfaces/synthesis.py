"""Textures that are made: records continued, self-affine surfaces, likenesses of maps, and long strips."""

import math
from collections.abc import Hashable, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Literal, NamedTuple

import numpy as np
from scipy import fft

from asperity.arguments import Array, ArrayLike, Indices, require, two_lengths
from asperity.spectra import HALF_BAND, level_of
from asperity.surfaces.bands import MICROMETRE, band_texture, range_of_bands
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.likeness import Likeness, likeness
from asperity.surfaces.strip import LongStrip, places_across
from asperity.surfaces.tiles import RANGE, Tiling, Waves, deviates, fine, heights_at, range_of, start_of
from asperity.written_numbers import rounded

__all__ = ["close", "extend", "from_map", "self_affine"]

Continuation = Literal["refuse", "mirror", "repeat"]

TILE = np.array([40.0, 24.0])
"""Size of a tile along and across in reaches of the longest waves of its range."""
FLAT = 16.0
"""Waves that are drawn, in longest waves: the spectrum is flat there, and longer ones hold 0.2 % at most."""
MAP_LENGTHS = 10.0, 4.0
"""Size of a tile along and across in lengths of a measured map."""
MOST_WAVES = 2**27
"""Waves of a tile: as many are looked at, and a few seconds go by."""
TOGETHER = 2**21
"""Waves of a tile that are summed at a time."""
GROUP = 16
"""Waves along that share a stream of random numbers, in the likeness of maps."""


def extend(
    heights: ArrayLike,
    rows: int,
    how: Continuation = "refuse",
    *,
    spacing: float,
    start: int = 0,
    crossfade: int = 0,
    what: str = "record",
) -> Array:
    """Heights (rows,) or (rows, k), m, along a path of any length from a record (n,) or (n, k).

    The record is complete. One that is too short is refused, mirrored, that is run through to and fro (no
    step, a kink where it turns), or repeated with period n, as the circumference of a wheel; then it is
    closed over the points `crossfade`, see `close`. `start` is the point that comes first, negative only if
    it is mirrored or repeated. `what` names the record in messages.
    """
    values = np.asarray(heights, dtype=np.float64)
    n = len(values)
    index = np.arange(start, start + rows)
    if how == "repeat":
        return close(values, crossfade)[np.mod(index, n)]
    if how == "mirror":
        folded = np.mod(index, 2 * (n - 1))
        return values[np.where(folded < n, folded, 2 * (n - 1) - folded)]
    allowed = f"at least the run with its margins, {rows * spacing:.4g} m"
    allowed += f", from {start * spacing:.4g} m on" if start else ""
    remedy = "Set surface.continuation to 'mirror' or 'repeat', or shorten the run."
    inside = start >= 0 and start + rows <= n
    require(inside, f"length of the {what}", f"{n * spacing:.4g} m", allowed, remedy)
    return values[start : start + rows]


def close(heights: ArrayLike, points: int) -> Array:
    """Close a periodic record: spread the step between its end and its start over both sides of the join.

    Heights (n,) or (n, k), m; half the step is taken from that many points on either side, fading with a
    raised cosine.
    """
    values = np.array(heights, dtype=np.float64)
    allowed = f"0 to {len(values) // 2}, half the record"
    require(0 <= 2 * points <= len(values), "crossfade", f"{points} points", allowed)
    if points == 0:
        return values
    fade = 0.5 + 0.5 * np.cos(np.pi * np.arange(points) / points)
    share = np.multiply.outer(fade, 0.5 * (values[0] - values[-1]))
    values[:points] -= share
    values[-points:] += share[::-1]
    return values


def self_affine(
    shape: tuple[int, int],
    spacing: tuple[float, float],
    *,
    rms: float,
    hurst: float,
    longest: float,
    shortest: float,
    anisotropy: float = 1.0,
    lay: float = 0.0,
    seed: int,
) -> HeightMap:
    """Gaussian self-affine surface with a roll-off and a cut-off (spectrum of B. N. J. Persson et al., 2005).

    The power spectral density is C(q') = constant below 2π/longest and falls as q'^(-2-2·hurst) up to the
    cut-off at 2π/shortest, and is zero beyond; q'² = (qx √anisotropy)² + (qy/√anisotropy)²: the anisotropy is
    the correlation length in x over that in y. With a `lay`, rad, all of this is turned from x towards y:
    ridges that are drawn out along x then lie in that direction. J. Phys.: Condens. Matter 17 (2005) R1.
    Lengths are in m; 0 < hurst <= 1, and the shortest wave has at least two samples.

    The rms is that of the *ensemble* about zero, m. One realisation scatters about it, the more the fewer
    longest wavelengths fit in; it is not rescaled, since that would make short pieces rougher than the long
    surface they stand for. The surface is drawn as `asperity.surfaces.tiles` says: a larger map, or one with
    another spacing, is the same surface where the smaller one is, with x = 0 in its first row and y = 0 in
    its column ny // 2. A shorter shortest wave adds waves to it; all of them then are scaled alike to the
    same rms. The surface is proportional to the rms, and not periodic.
    """
    strip = long_self_affine(
        shape, spacing, seed=seed, rms=rms, hurst=hurst, longest=longest, shortest=shortest,
        anisotropy=anisotropy, lay=lay,
    )  # fmt: skip
    return HeightMap(_heights(strip), strip.spacing, strip.source)


def long_self_affine(
    shape: tuple[int, int], spacing: tuple[float, float], *, seed: int, before: int = 0, **parameters: float
) -> LongStrip:
    """Self-affine strip of any length, generated where it is read: the surface of `self_affine`.

    With rows `before`, as `LongStrip` has them.
    """
    steps = two_lengths("spacing", spacing)
    texture = SelfAffine(**parameters, seed=seed)
    texture.check(steps)
    return LongStrip(shape, steps, texture, None, f"{texture}, seed {seed}", before)


@dataclass(frozen=True)
class SelfAffine:
    """A surface that is drawn with the spectrum of `self_affine`, whose parameters it has."""

    rms: float
    hurst: float
    longest: float
    shortest: float
    anisotropy: float = 1.0
    lay: float = 0.0
    seed: int = 0
    around: float | None = None  # length on which the surface closes along x, m; tiles without it

    def __post_init__(self) -> None:
        for name, right, allowed in (
            ("rms", 0.0 <= self.rms < np.inf, "zero or more, m"),
            ("hurst", 0.0 < self.hurst <= 1.0, "above 0, up to 1"),
            ("shortest", 0.0 < self.shortest < np.inf, "above zero, m"),
            ("longest", self.shortest < self.longest < np.inf, "longer than the shortest"),
            ("anisotropy", 0.0 < self.anisotropy < np.inf, "above zero"),
        ):
            require(right, name, getattr(self, name), allowed)

    def __str__(self) -> str:
        waves = f"{self.shortest:.4g} to {self.longest:.4g} m"
        return f"self-affine: rms {self.rms:.4g} m, Hurst {self.hurst:g}, {waves}"

    @property
    def name(self) -> Hashable:
        """What names it."""
        return self

    @property
    def draw(self) -> str:
        """What its random numbers belong to."""
        around = "" if self.around is None else f" around {self.around:.6g} m"
        stretch = f"drawn out {self.anisotropy:.6g} times at {math.degrees(self.lay):.6g} deg"
        return f"self-affine{around}, {stretch}, seed {self.seed}"

    @cached_property
    def ranges(self) -> "tuple[AffineRange, ...]":
        """Ranges of q' that hold its waves, the longest first."""
        most = math.sqrt(max(self.anisotropy, 1.0 / self.anisotropy)) / self.shortest
        numbers = range(range_of(1.0 / (FLAT * self.longest)), range_of(most) + 1)
        return tuple(AffineRange(self, number) for number in numbers)

    def check(self, spacing: tuple[float, float]) -> None:
        """Refuse a spacing, m, too coarse for the shortest waves, and an anisotropy out of all proportion."""
        coarsest = 2.0 * max(spacing)
        fine = self.shortest >= coarsest * (1 - 1e-9)
        require(fine, "shortest", self.shortest, f"at least two samples, {coarsest:.4g} m")
        along, across = max((each.tile.most for each in self.ranges), key=math.prod)
        waves = f"{rounded(along)} x {rounded(2.0 * across)} waves"
        received = f"{rounded(self.anisotropy)}, which takes tiles of {waves}"
        remedy = "Bring it nearer to 1, or lengthen the shortest wave."
        allowed = f"at most {MOST_WAVES} waves"
        require(2.0 * along * across <= MOST_WAVES, "anisotropy", received, allowed, remedy)

    @cached_property
    def mean_square(self) -> float:
        """Sum of the spectrum over all waves, where it is one on the longest."""
        return sum(float(each.power.sum()) for each in self.ranges) or 1.0


def line_levels(surface: SelfAffine, wavelength: Array) -> Array:
    """One-third-octave levels (b,) of lines along x, dB re 1 µm, at wavelengths, m: of the ensemble.

    A wave has the width of its tile's step of wavenumber; minus infinity where there is none.
    """
    found = np.zeros(len(wavelength))
    for each in surface.ranges:
        step = start_of(each.number) / each.tile.size[0]
        power = np.bincount(waves_of(each.tile).along, each.power)  # of all waves across
        here = step * np.arange(len(power))
        for band, length in enumerate(wavelength):
            low = 1.0 / (length * HALF_BAND)
            high = HALF_BAND / length
            width = np.minimum(here + 0.5 * step, high) - np.maximum(here - 0.5 * step, low)
            found[band] += float(np.sum(power * np.clip(width, 0.0, None))) / step
    return level_of(found * (surface.rms / MICROMETRE) ** 2 / surface.mean_square)


def drawn_out(anisotropy: float, lay: float) -> Array:
    """Matrix that draws a circle out and turns it by a lay, rad."""
    stretch = np.sqrt(anisotropy)
    cosine = np.cos(lay)
    sine = np.sin(lay)
    return np.array([[stretch * cosine, -sine / stretch], [stretch * sine, cosine / stretch]])


@dataclass(frozen=True)
class AffineRange:
    """Waves of a self-affine surface whose q' lies in one range."""

    surface: SelfAffine
    number: int

    @cached_property
    def tile(self) -> "AffineTile":
        """Tile of the range; no smaller than the correlation of waves that are cut off at the shortest."""
        surface = self.surface
        least = start_of(self.number)
        shortest = start_of(range_of(1.0 / surface.shortest) + 1)
        reach = np.maximum(np.hypot(*drawn_out(surface.anisotropy, surface.lay).T), least / shortest)
        along, across = (TILE * reach).tolist()
        if surface.around is not None:
            along = surface.around * least
        highest = (1.0 + 1e-9) / (surface.shortest * least)
        return AffineTile((along, across), surface.anisotropy, surface.lay, highest)

    @property
    def along(self) -> Tiling:
        """Tiles along x."""
        length = self.tile.size[0] / start_of(self.number)
        return Tiling.from_zero(length) if self.surface.around is None else Tiling(length, 0.0, 0.0)

    @property
    def across(self) -> Tiling:
        """Tiles along y."""
        return Tiling.around_zero(self.tile.size[1] / start_of(self.number))

    @cached_property
    def power(self) -> Array:
        """Mean squares of its waves, where the spectrum is one on the longest of the surface."""
        return power_of(self.tile, self.surface.longest * start_of(self.number), self.surface.hurst)

    def waves(self, tile: int, across: Array) -> Waves:
        """Complex amplitudes (k, ny), m, of a tile at places across (ny,), m."""
        members = waves_of(self.tile)
        tiling = self.across
        count, beside = self.tile.most
        size = self.surface.rms * np.sqrt(self.power / self.surface.mean_square)
        turns = 2.0 * np.pi / tiling.length * np.arange(beside + 1)
        found = np.zeros((count + 1, len(across)), np.complex128)
        for side in tiling.touching(across.min(), across.max()):
            lines = tiling.held(side, across)
            noise = deviates(self.surface.seed, (len(size),), self.number, side, tile)[members.rank] * size
            forth = np.exp(1j * turns[:, None] * tiling.within(side, across[lines]))
            forth *= tiling.weight(side, across[lines])
            basis = np.concatenate([forth[:0:-1].conj(), forth])
            step = max(1, TOGETHER // len(basis))
            for first in range(0, count + 1, step):
                rows = found[first : first + step]
                there = slice(*np.searchsorted(members.along, (first, first + step)).tolist())
                columns = members.across[there] + beside
                low = columns.min(initial=len(basis))
                high = columns.max(initial=0) + 1
                box = np.zeros((len(rows), max(high - low, 0)), np.complex128)
                box[members.along[there] - first, columns - low] = noise[there]
                rows[:, lines] += box @ basis[low:high]
        return found


class AffineTile(NamedTuple):
    """What tells which waves a range has on a tile, in its longest waves and least wavenumbers."""

    size: tuple[float, float]  # along and across
    anisotropy: float
    lay: float  # rad
    highest: float  # wavenumber of the shortest waves that are drawn

    @property
    def most(self) -> tuple[int, int]:
        """Largest numbers of waves along and across."""
        return most_of(self)


@lru_cache(maxsize=32)
def most_of(tile: AffineTile) -> tuple[int, int]:
    """Largest numbers of waves of a tile."""
    ellipse = RANGE * np.hypot(*np.linalg.inv(drawn_out(tile.anisotropy, tile.lay)))
    along, across = np.floor(tile.size * np.minimum(ellipse, tile.highest)).astype(int).tolist()
    return along, across


class MembersOfRange(NamedTuple):
    """Waves of a range on a tile, by their number along."""

    along: Indices
    across: Indices
    stretched: Array  # q'², in the least one of the range
    rank: Indices  # from the least wavenumber on: those of a shorter shortest wave come after these


@lru_cache(maxsize=32)
def waves_of(tile: AffineTile) -> MembersOfRange:
    """Waves of a range on a tile."""
    count, beside = tile.most
    y = np.arange(-beside, beside + 1)
    step = max(1, TOGETHER // len(y))
    parts = []
    for first in range(0, count + 1, step):
        x = np.arange(first, min(first + step, count + 1))[:, None]
        qx = x / tile.size[0]
        qy = y / tile.size[1]
        stretched = sum((qx * a + qy * b) ** 2 for a, b in drawn_out(tile.anisotropy, tile.lay).T)
        square = qx**2 + qy**2
        inside = (stretched >= 1.0) & (stretched < RANGE**2) & (square <= tile.highest**2)
        along, across = np.nonzero(inside)
        parts.append((along + first, across - beside, stretched[inside], square[inside]))
    along, across, stretched, square = (np.concatenate(each) for each in zip(*parts, strict=True))
    rank = np.empty(len(along), np.intp)
    rank[np.argsort(square, kind="stable")] = np.arange(len(along))
    return MembersOfRange(along, across, stretched, rank)


@lru_cache(maxsize=32)
def power_of(tile: AffineTile, longest: float, hurst: float) -> Array:
    """Mean squares of the waves of a tile, where the spectrum is one on the longest of the surface."""
    waves = waves_of(tile)
    along, across = tile.size
    power = np.maximum(waves.stretched * longest**2, 1.0) ** (-1.0 - hurst)
    # of wave 0 along, the opposite ones across are there
    return np.asarray(power * np.where(waves.along > 0, 2.0, 1.0) * (longest**2 / (along * across)))


def to_and_fro(count: int) -> Array:
    """Numbers 0, 1, −1, 2, −2, … to a number and its opposite: a larger one adds to these."""
    index = np.arange(2 * count + 1)
    return np.where(index % 2 == 1, (index + 1) // 2, -(index // 2)).astype(np.float64)


def _heights(strip: LongStrip) -> Array:
    """Heights of all of a strip that is no longer than a map, m, of which nothing is kept."""
    shape = strip.shape
    dx, dy = strip.spacing
    ranges = strip.drawn.ranges
    require(len(shape) == 2 and min(shape) >= 2, "shape", shape, "(nx, ny), at least 2 points each")
    across = places_across(shape[1], dy)
    along = np.asarray(dx * np.arange(shape[0]))
    heights = heights_at(ranges, along, shape[1], lambda i, tile: fine(ranges[i].waves(tile, across)))
    return heights if strip.transform is None else strip.transform(heights)


def long_strip_from_bands(
    shape: tuple[int, int],
    spacing: tuple[float, float],
    wavelengths: ArrayLike,
    levels_db: ArrayLike,
    *,
    lateral: float = 1.0,
    seed: int,
    before: int = 0,
) -> LongStrip:
    """Strip of any length with given one-third-octave levels, generated where it is read.

    The surface has the spectrum of `strip_from_bands`, whose parameters it has; its middle line has the
    levels asked for in each tile, which is as long as twenty of the longest waves. Bands that the spacing
    does not hold are left out. With rows `before`, as `LongStrip` has them.
    """
    steps = two_lengths("spacing", spacing)
    texture = band_texture(wavelengths, levels_db, lateral, seed, steps[0])
    source = f"{range_of_bands(wavelengths)}, lateral {lateral:g}, seed {seed}"
    return LongStrip(shape, steps, texture, None, source, before)


def from_map(
    maps: HeightMap | Sequence[HeightMap],
    shape: tuple[int, int],
    seed: int,
    spacing: float | tuple[float, float] | None = None,
) -> HeightMap:
    """Surface of any size with the spectrum and the height distribution of measured maps.

    The maps are of one texture, with one spacing, and complete. The two-sided angular spectrum, with its
    anisotropy, is that of the surface that the levelled maps were cut from, as
    `likeness` estimates it; its variance is that of the pooled heights. A Gaussian
    field with a pre-distorted correlation is translated to their distribution: no height exceeds the measured
    extremes. Another spacing, m, leaves wavelengths below two new samples out. No realisation is rescaled, so
    Sq scatters as in pieces of one long surface.

    Wavelengths longer than the map are not known. The spectrum is held below one wave per map, and what lacks
    of the variance, as the bow of a sheet, gets waves twice as long as the map. A bow that all maps have
    becomes waves of random phase: pieces as long as the maps are flatter than these. The field is drawn in
    tiles of ten by four maps, see `asperity.surfaces.tiles`: it is not periodic, a narrow strip holds waves
    much longer than its width, and a larger surface is the same one where the smaller one is, as in
    `self_affine`. At another spacing the maps are resampled, and another surface is drawn. Where the
    distribution and the spectrum contradict each other (a distribution that is not smooth needs short waves
    that a steep spectrum does not have), the distribution wins.

    C. R. Dietrich and G. N. Newsam, SIAM J. Sci. Comput. 18 (1997) 1088 (circulant embedding). M. Grigoriu,
    Applied Non-Gaussian Processes (1995) (translation).
    """
    strip = long_strip_like(maps, shape, seed, spacing)
    return HeightMap(_heights(strip), strip.spacing, strip.source)


def long_strip_like(
    maps: HeightMap | Sequence[HeightMap],
    shape: tuple[int, int],
    seed: int,
    spacing: float | tuple[float, float] | None = None,
    before: int = 0,
) -> LongStrip:
    """Strip of any length in the likeness of measured maps, generated where it is read.

    The surface of `from_map`: a Gaussian one, blended from tile to tile over the length of two maps, then
    translated to the height distribution, which is exact in the blends too. With rows `before`, as
    `LongStrip` has them.
    """
    like = likeness(maps, spacing)
    source = f"synthesised from {like.source}, seed {seed}"
    return LongStrip(shape, like.spacing, LikeMaps(like, seed), like.transform, source, before)


@dataclass(frozen=True, eq=False)
class LikeMaps:
    """A Gaussian surface of unit variance that is drawn with the correlation of measured maps."""

    like: Likeness
    seed: int
    around: int | None = None  # points on which it closes along x; tiles without it
    name: Hashable = field(default_factory=object, repr=False)

    @property
    def draw(self) -> str:
        """What its random numbers belong to."""
        return f"like {self.like.source}, in {self.along}, across in {self.across}, seed {self.seed}"

    @property
    def points(self) -> tuple[int, int]:
        """Points of a tile along and across."""
        along, across = (
            fft.next_fast_len(math.ceil(times * size), real=True)
            for times, size in zip(MAP_LENGTHS, self.like.size, strict=True)
        )
        return (along if self.around is None else self.around), across

    @property
    def ranges(self) -> "tuple[LikeMaps]":
        """All of its waves are one."""
        return (self,)

    @property
    def along(self) -> Tiling:
        """Tiles along x."""
        length = self.points[0] * self.like.spacing[0]
        if self.around is not None:
            return Tiling(length, 0.0, 0.0)
        return Tiling.from_zero(length)

    @property
    def across(self) -> Tiling:
        """Tiles along y; a map is narrower than half of what is alone in one."""
        return Tiling.around_zero(self.points[1] * self.like.spacing[1])

    def waves(self, tile: int, across: Array) -> Waves:
        """Complex amplitudes (k, ny) of a tile at places across (ny,), m."""
        found = []
        tiling = self.across
        basis = dict[int, Waves]()
        turns = 2.0 * np.pi / tiling.length * to_and_fro(self._amplitudes.shape[1] // 2)[:, None]
        for side in tiling.touching(across.min(), across.max()):
            waves = np.exp(1j * turns * tiling.within(side, across))
            basis[side] = waves * tiling.weight(side, across)
        for group in range(-(-len(self._amplitudes) // GROUP)):
            size = self._amplitudes[GROUP * group : GROUP * (group + 1)]
            part = np.zeros((len(size), len(across)), np.complex128)
            for side, waves in basis.items():
                noise = deviates(self.seed, (size.shape[1], GROUP), group, side, tile).T[: len(size)]
                part += (noise * size) @ waves
            found.append(part)
        return np.concatenate(found)

    @cached_property
    def _amplitudes(self) -> Array:
        """Rms of the waves (k, 2j + 1) that close on a tile, across as in `to_and_fro`."""
        correlation = self.like.correlation
        rows, lines = self.points
        # lags that wrap onto each other add up: the same spectrum at fewer wavenumbers, never below zero
        places = [np.fft.fftfreq(n, 1.0 / n).astype(np.intp) for n in correlation.shape]
        embedded = np.zeros((rows, lines))
        np.add.at(embedded, np.ix_(places[0] % rows, places[1] % lines), correlation)
        power = fft.rfft2(embedded, axes=(1, 0), overwrite_x=True).real[: (rows + 1) // 2]
        power = np.maximum(power[:, to_and_fro((lines - 1) // 2).astype(np.intp)], 0.0)
        power[1:] *= 2.0
        return np.sqrt(power / power.sum())
