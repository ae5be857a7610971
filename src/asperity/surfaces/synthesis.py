"""Textures that are made: records continued, self-affine surfaces, likenesses of maps, and long strips."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy import fft

from asperity.arguments import Array, ArrayLike, require, two_lengths
from asperity.surfaces.bands import strip_from_bands
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.likeness import Likeness, likeness
from asperity.surfaces.strip import LongStrip

Continuation = Literal["refuse", "mirror", "repeat"]

PIECE_POINTS = 2**18
"""Points of a piece of a long strip, at least: 2 MiB."""
PIECE_REACHES = 16
"""Length of a piece of a long strip in correlation lengths, at least."""
BAND_REACHES = 8
"""Length of a piece of a long strip from band levels in longest wavelengths: each band has lines enough."""
LEAST_PIECE = 5.0
"""Length of a piece of a long strip from band levels, at least, m."""
BLEND_REACHES = 2
"""Length of the blend of two pieces in correlation lengths."""
LARGEST_MAP = 2**27
"""Points of a map that is made for its longest wavelength: 1 GiB, and three times that while it is made."""


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


def closed_around(heights: Array, rows: int) -> Array:
    """Close a random strip (n, ny) over `rows` rows: those beyond give way to the first ones.

    They are weighted by cos θ and sin θ as in `LongStrip`, so that mean square and lateral correlation stay.
    """
    beyond = len(heights) - rows
    angle = 0.5 * np.pi * ((np.arange(beyond) + 0.5) / max(beyond, 1))[:, None]
    closed = heights[:rows].copy()
    closed[:beyond] = np.sin(angle) * closed[:beyond] + np.cos(angle) * heights[rows:]
    return closed


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

    The rms is that of the *ensemble* about zero, m, exact on this grid. One realisation scatters about it,
    the more the fewer longest wavelengths fit in; it is not rescaled, since that would make short pieces
    rougher than the long surface they stand for. It is cut from a surface that is at least one roll-off
    wavelength larger, so not periodic.
    """
    texture = _SelfAffine(two_lengths("spacing", spacing), rms, hurst, longest, shortest, anisotropy, lay)
    return HeightMap(texture.heights(shape, seed), texture.steps, f"{texture}, seed {seed}")


def long_self_affine(
    shape: tuple[int, int], spacing: tuple[float, float], *, seed: int, before: int = 0, **parameters: float
) -> LongStrip:
    """Self-affine strip of any length, generated where it is read.

    Pieces of `self_affine` surfaces, whose parameters it has, blended over two roll-off wavelengths. With
    rows `before`, as `LongStrip` has them.
    """
    texture = _SelfAffine(two_lengths("spacing", spacing), **parameters)

    def piece(rows: int, piece_seed: int) -> Array:
        return texture.heights((rows, shape[1]), piece_seed)

    stride, blend = _pieces(shape[1], int(np.ceil(texture.reach[0] / texture.steps[0])))
    source = f"{texture}, seed {seed}"
    return LongStrip(shape, texture.steps, piece, seed, stride, blend, None, source, before, texture)


@dataclass(frozen=True)
class _SelfAffine:
    """Parameters of `self_affine` surfaces on a grid of a spacing (dx, dy), m."""

    steps: tuple[float, float]
    rms: float
    hurst: float
    longest: float
    shortest: float
    anisotropy: float = 1.0
    lay: float = 0.0

    def __post_init__(self) -> None:
        coarsest = 2.0 * max(self.steps)
        fine = self.shortest >= coarsest * (1 - 1e-9)
        for name, right, allowed in (
            ("rms", 0.0 <= self.rms < np.inf, "zero or more, m"),
            ("hurst", 0.0 < self.hurst <= 1.0, "above 0, up to 1"),
            ("shortest", fine, f"at least two samples, {coarsest:.4g} m"),
            ("longest", self.shortest < self.longest < np.inf, "longer than the shortest"),
            ("anisotropy", 0.0 < self.anisotropy < np.inf, "above zero"),
        ):
            require(right, name, getattr(self, name), allowed)

    def __str__(self) -> str:
        waves = f"{self.shortest:.4g} to {self.longest:.4g} m"
        return f"self-affine: rms {self.rms:.4g} m, Hurst {self.hurst:g}, {waves}"

    @property
    def drawn(self) -> Array:
        """Matrix that draws a circle out and turns it by the lay."""
        stretch, cosine, sine = np.sqrt(self.anisotropy), np.cos(self.lay), np.sin(self.lay)
        return np.array([[stretch * cosine, -sine / stretch], [stretch * sine, cosine / stretch]])

    @property
    def reach(self) -> Array:
        """How far the longest waves reach along x and y, m."""
        return self.longest * np.hypot(*self.drawn.T)

    def heights(self, shape: tuple[int, int], seed: int) -> Array:
        """One realisation (nx, ny), m, cut from a periodic one."""
        require(len(shape) == 2 and min(shape) >= 2, "shape", shape, "(nx, ny), at least 2 points each")
        grid = [
            fft.next_fast_len(int(np.ceil(max(n + r / d, 2.0 * r / d))), real=True)
            for n, r, d in zip(shape, self.reach, self.steps, strict=True)
        ]
        received = (
            f"{self.longest:.4g} m at {self.steps[0]:.4g} m, which take a map of {grid[0]} x {grid[1]} points"
        )
        remedy = "Shorten it, coarsen the spacing, or bring the anisotropy nearer to 1."
        small = grid[0] * grid[1] <= max(LARGEST_MAP, 4 * shape[0] * shape[1])
        require(small, "longest", received, f"at most {LARGEST_MAP} points", remedy)
        qx = 2.0 * np.pi * fft.fftfreq(grid[0], self.steps[0])[:, None]
        qy = 2.0 * np.pi * fft.rfftfreq(grid[1], self.steps[1])[None, :]
        square = sum((qx * along + qy * across) ** 2 for along, across in self.drawn.T)
        power = np.maximum(square, (2.0 * np.pi / self.longest) ** 2) ** (-1.0 - self.hurst)
        power[qx**2 + qy**2 > (2.0 * np.pi / self.shortest) ** 2 * (1.0 + 1e-12)] = 0.0
        power[0, 0] = 0.0
        return _gaussian_field(power, grid, self.rms, seed)[: shape[0], : shape[1]]


def _gaussian_field(power: Array, grid: Sequence[int], rms: float, seed: int) -> Array:
    """Periodic Gaussian field with this half spectrum, scaled to an expected mean square of rms²."""
    doubled = power.sum() + power[:, 1 : (grid[1] + 1) // 2].sum()  # the half that rfft2 leaves out
    noise = np.random.default_rng(seed).standard_normal((grid[0], grid[1]))
    spectrum = fft.rfft2(noise, overwrite_x=True)
    del noise
    spectrum *= np.sqrt(power * (rms**2 * grid[0] * grid[1] / doubled))
    return np.asarray(fft.irfft2(spectrum, s=tuple(grid), overwrite_x=True))


def _pieces(columns: int, reach: int) -> tuple[int, int]:
    """Rows from piece to piece of a long strip, and rows of a blend; a correlation length is `reach` rows."""
    return max(PIECE_POINTS // columns, PIECE_REACHES * reach), max(1, BLEND_REACHES * reach)


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

    Pieces of `strip_from_bands`, whose parameters it has, each with the levels asked for, blended over two of
    the longest wavelengths. With rows `before`, as `LongStrip` has them.
    """
    given, levels = np.array(wavelengths, dtype=float), np.array(levels_db, dtype=float)
    steps = two_lengths("spacing", spacing)
    reach = int(np.ceil(given.max() / steps[0]))
    stride = max(BAND_REACHES * reach, int(np.ceil(LEAST_PIECE / steps[0])))

    def piece(rows: int, piece_seed: int) -> Array:
        grid = fft.next_fast_len(rows, real=True), shape[1]
        return strip_from_bands(grid, steps, given, levels, lateral=lateral, seed=piece_seed).heights[:rows]

    source = f"one-third octaves {given.max():.4g} to {given.min():.4g} m, lateral {lateral:g}, seed {seed}"
    name = "bands", steps, given.tobytes(), levels.tobytes(), lateral
    return LongStrip(shape, steps, piece, seed, stride, BLEND_REACHES * reach, None, source, before, name)


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
    becomes waves of random phase: pieces as long as the maps are flatter than these. The field is made on a
    grid longer and wider than asked for by two maps, then cut: it is not periodic, and a narrow strip holds
    waves much longer than its width. Where the distribution and the spectrum contradict each other (a
    distribution that is not smooth needs short waves that a steep spectrum does not have), the distribution
    wins.

    C. R. Dietrich and G. N. Newsam, SIAM J. Sci. Comput. 18 (1997) 1088 (circulant embedding). M. Grigoriu,
    Applied Non-Gaussian Processes (1995) (translation).
    """
    like = likeness(maps, spacing)
    heights = like.transform(_gaussian_like(like, shape, seed))
    return HeightMap(heights, like.spacing, f"synthesised from {like.source}, seed {seed}")


def long_strip_like(
    maps: HeightMap | Sequence[HeightMap],
    shape: tuple[int, int],
    seed: int,
    spacing: float | tuple[float, float] | None = None,
    before: int = 0,
) -> LongStrip:
    """Strip of any length in the likeness of measured maps, generated where it is read.

    Gaussian pieces of the kind that `from_map` makes, blended over two lengths of the maps, then translated
    to the height distribution, which is exact in the blends too. With rows `before`, as `LongStrip` has them.
    """
    like = likeness(maps, spacing)

    def piece(rows: int, piece_seed: int) -> Array:
        return _gaussian_like(like, (rows, shape[1]), piece_seed)

    source = f"synthesised from {like.source}, seed {seed}"
    stride, blend = _pieces(shape[1], like.reach)
    return LongStrip(shape, like.spacing, piece, seed, stride, blend, like.transform, source, before)


def _gaussian_like(like: Likeness, shape: tuple[int, int], seed: int) -> Array:
    """Gaussian field of unit variance with the correlation of measured maps, not periodic."""
    lags = [(n + 1) // 2 for n in like.correlation.shape]
    grid = [fft.next_fast_len(n + k, real=True) for n, k in zip(shape, lags, strict=True)]
    # lags that wrap onto each other add up: this samples the same spectrum more coarsely, never below zero
    embedded, (nx, ny) = np.zeros((grid[0], grid[1])), lags
    for row, row_out in ((slice(0, nx), slice(0, nx)), (slice(nx, None), slice(grid[0] - nx + 1, None))):
        embedded[row_out, :ny] += like.correlation[row, :ny]
        embedded[row_out, grid[1] - ny + 1 :] += like.correlation[row, ny:]
    power = fft.rfft2(embedded, overwrite_x=True).real
    np.maximum(power, 0.0, out=power)
    return _gaussian_field(power, grid, 1.0, seed)[: shape[0], : shape[1]]
