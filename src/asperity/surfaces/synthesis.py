"""Textures that are made: records continued, self-affine surfaces, likenesses of maps, and long strips."""

import math
from collections.abc import Hashable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

import numpy as np
from scipy import fft

from asperity.arguments import Array, ArrayLike, require, two_lengths
from asperity.surfaces.bands import band_texture, range_of_bands
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.likeness import Likeness, likeness
from asperity.surfaces.strip import LongStrip, places_across
from asperity.surfaces.tiles import GROUP, Tiling, Waves, deviates, fine, heights_at
from asperity.written_numbers import rounded

Continuation = Literal["refuse", "mirror", "repeat"]

TILE_REACHES = 16.0, 6.0
"""Size of a tile along and across in reaches of the longest waves."""
MAP_LENGTHS = 10.0, 4.0
"""Size of a tile along and across in lengths of a measured map."""
BLEND_REACHES = 2.0
"""Length of the blend of two tiles in reaches."""
LARGEST_TILE = 2**27
"""Points of a tile: as many numbers are drawn for it, and a few seconds go by."""
FEWEST = 2**6
"""Points that each side of a tile counts for at least: those of a few waves cost as much."""


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
    n, index = len(values), np.arange(start, start + rows)
    if how == "repeat":
        return close(values, crossfade)[np.mod(index, n)]
    if how == "mirror":
        folded = np.mod(index, 2 * (n - 1))
        return np.asarray(values[np.where(folded < n, folded, 2 * (n - 1) - folded)])
    allowed = f"at least the run with its margins, {rows * spacing:.4g} m"
    allowed += f", from {start * spacing:.4g} m on" if start else ""
    remedy = "Set surface.continuation to 'mirror' or 'repeat', or shorten the run."
    inside = start >= 0 and start + rows <= n
    require(inside, f"length of the {what}", f"{n * spacing:.4g} m", allowed, remedy)
    return np.asarray(values[start : start + rows])


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
        return f"self-affine in {self.along}, across in {self.across}, seed {self.seed}"

    @property
    def drawn_out(self) -> Array:
        """Matrix that draws a circle out and turns it by the lay."""
        stretch, cosine, sine = np.sqrt(self.anisotropy), np.cos(self.lay), np.sin(self.lay)
        return np.array([[stretch * cosine, -sine / stretch], [stretch * sine, cosine / stretch]])

    @property
    def reach(self) -> Array:
        """How far the longest waves reach along x and y, m; not less than the shortest do."""
        return np.maximum(self.longest * np.hypot(*self.drawn_out.T), self.shortest)

    @property
    def along(self) -> Tiling:
        """Tiles along x."""
        if self.around is not None:
            return Tiling(self.around, 0.0, 0.0)
        return Tiling.from_zero(TILE_REACHES[0] * self.reach[0], BLEND_REACHES * self.reach[0])

    @property
    def across(self) -> Tiling:
        """Tiles along y."""
        return Tiling.around_zero(TILE_REACHES[1] * self.reach[1], BLEND_REACHES * self.reach[1])

    def check(self, spacing: tuple[float, float]) -> None:
        """Refuse a spacing, m, too coarse for the shortest waves, and longest ones out of all proportion."""
        coarsest = 2.0 * max(spacing)
        fine = self.shortest >= coarsest * (1 - 1e-9)
        require(fine, "shortest", self.shortest, f"at least two samples, {coarsest:.4g} m")
        sizes = [max(2.0 * each.length / self.shortest, FEWEST) for each in (self.along, self.across)]
        received = f"{self.longest:.4g} m with waves down to {self.shortest:.4g} m"
        received += f", which take tiles of {rounded(sizes[0])} x {rounded(sizes[1])} points"
        remedy = "Shorten it, lengthen the shortest, or bring the anisotropy nearer to 1."
        allowed = f"at most {LARGEST_TILE} points"
        require(sizes[0] * sizes[1] <= LARGEST_TILE, "longest", received, allowed, remedy)

    def waves(self, tile: int, across: Array) -> Waves:
        """Complex amplitudes (k, ny), m, of a tile at places across (ny,), m."""
        scale = self.rms / np.sqrt(self._mean_square)
        return _waves(self.seed, tile, across, self.across, (scale * each for each in self._amplitudes()))

    def _amplitudes(self) -> Iterator[Array]:
        """Roots of the spectrum (GROUP, 2j + 1) of groups of waves along; across 0, 1, −1, 2, −2, …"""
        turn, most = 2.0 * np.pi, (1.0 + 1e-9) / self.shortest
        count, beside = (math.floor(most * tiling.length) for tiling in (self.along, self.across))
        qy = turn / self.across.length * to_and_fro(beside)
        for first in range(0, count + 1, GROUP):
            wave = np.arange(first, first + GROUP)[:, None]
            qx = turn / self.along.length * wave
            square = sum((qx * along + qy * across) ** 2 for along, across in self.drawn_out.T)
            power = np.maximum(square, (turn / self.longest) ** 2) ** (-1.0 - self.hurst)
            power[qx**2 + qy**2 > (turn * most) ** 2] = 0.0
            power *= np.where(wave > 0, 2.0, 1.0)  # of wave 0 across, the opposite ones are there
            power[(wave == 0) & (qy == 0.0)] = 0.0
            yield np.sqrt(power)

    @cached_property
    def _mean_square(self) -> float:
        return float(sum(np.sum(each**2) for each in self._amplitudes())) or 1.0


def to_and_fro(count: int) -> Array:
    """Numbers 0, 1, −1, 2, −2, … to a number and its opposite: a larger one adds to these."""
    index = np.arange(2 * count + 1)
    return np.where(index % 2 == 1, (index + 1) // 2, -(index // 2)).astype(np.float64)


def _waves(seed: int, tile: int, across: Array, tiling: Tiling, amplitudes: Iterable[Array]) -> Waves:
    """Waves along (k, ny), m, of a tile, from the amplitudes of groups of them, rms; see `SelfAffine`."""
    found, sides = [], tiling.touching(across.min(), across.max())
    basis = dict[int, Waves]()
    for group, each in enumerate(amplitudes):
        part = np.zeros((len(each), len(across)), np.complex128)
        for side in sides:
            if side not in basis:
                turns = 2.0 * np.pi / tiling.length * to_and_fro(each.shape[1] // 2)
                waves = np.exp(1j * turns[:, None] * tiling.within(side, across))
                basis[side] = waves * tiling.weight(side, across)
            noise = deviates(seed, (each.shape[1], GROUP), group, side, tile).T[: len(each)]
            part += (noise * each) @ basis[side]
        found.append(part)
    return np.concatenate(found)


def _heights(strip: LongStrip) -> Array:
    """Heights of all of a strip that is no longer than a map, m, of which nothing is kept."""
    shape, (dx, dy), drawn = strip.shape, strip.spacing, strip.drawn
    require(len(shape) == 2 and min(shape) >= 2, "shape", shape, "(nx, ny), at least 2 points each")
    across = places_across(shape[1], dy)
    along = np.asarray(dx * np.arange(shape[0]))
    heights = heights_at(drawn.along, along, shape[1], lambda tile: fine(drawn.waves(tile, across)))
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
    def along(self) -> Tiling:
        """Tiles along x."""
        length = self.points[0] * self.like.spacing[0]
        if self.around is not None:
            return Tiling(length, 0.0, 0.0)
        return Tiling.from_zero(length, BLEND_REACHES * self.like.size[0] * self.like.spacing[0])

    @property
    def across(self) -> Tiling:
        """Tiles along y; a map is as wide as half of what is alone in one."""
        dy = self.like.spacing[1]
        return Tiling.around_zero(self.points[1] * dy, self.like.size[1] * dy)

    def waves(self, tile: int, across: Array) -> Waves:
        """Complex amplitudes (k, ny) of a tile at places across (ny,), m."""
        groups = (self._amplitudes[i : i + GROUP] for i in range(0, len(self._amplitudes), GROUP))
        return _waves(self.seed, tile, across, self.across, groups)

    @cached_property
    def _amplitudes(self) -> Array:
        """Rms of the waves (k, 2j + 1) that close on a tile, across as in `to_and_fro`."""
        correlation, (rows, lines) = self.like.correlation, self.points
        # lags that wrap onto each other add up: the same spectrum at fewer wavenumbers, never below zero
        places = [np.fft.fftfreq(n, 1.0 / n).astype(np.intp) for n in correlation.shape]
        embedded = np.zeros((rows, lines))
        np.add.at(embedded, np.ix_(places[0] % rows, places[1] % lines), correlation)
        power = fft.rfft2(embedded, axes=(1, 0), overwrite_x=True).real[: (rows + 1) // 2]
        power = np.maximum(power[:, to_and_fro((lines - 1) // 2).astype(np.intp)], 0.0)
        power[1:] *= 2.0
        return np.sqrt(power / power.sum())
