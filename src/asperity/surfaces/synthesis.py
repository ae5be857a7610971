"""Continuation of a record that is shorter than the run: refused, mirrored or repeated."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from scipy import fft
from scipy.special import j0

from asperity.arguments import Array, one_of
from asperity.errors import InputError
from asperity.surfaces.bands import from_bands, strip_from_bands
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.levelling import level, resample
from asperity.surfaces.rotation import gaussian_correlation, height_transform
from asperity.surfaces.strip import LongStrip

Continuation = Literal["refuse", "mirror", "repeat"]

CHOICES = ("refuse", "mirror", "repeat")


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
    one_of(f"continuation of the {what}", how, CHOICES)
    if not np.isfinite(values).all():
        raise InputError(what, "missing points", "complete heights", "Fill or trim it first.")
    index = np.arange(start, start + rows)
    if how == "repeat":
        return close(values, crossfade)[np.mod(index, n)]
    if how == "mirror":
        folded = np.mod(index, 2 * (n - 1))
        return np.asarray(values[np.where(folded < n, folded, 2 * (n - 1) - folded)])
    if start < 0 or start + rows > n:
        received = f"{n * spacing:.4g} m"
        allowed = f"at least the run with its margins, {rows * spacing:.4g} m"
        if start:
            allowed += f", from {start * spacing:.4g} m on"
        remedy = "Set surface.continuation to 'mirror' or 'repeat', or shorten the run."
        raise InputError(f"length of the {what}", received, allowed, remedy)
    return np.asarray(values[start : start + rows])


def close(heights: ArrayLike, points: int) -> Array:
    """Close a periodic record: spread the step between its end and its start over both sides of the join.

    Heights (n,) or (n, k), m; half the step is taken from that many points on either side, fading with a
    raised cosine.
    """
    values = np.array(heights, dtype=np.float64)
    if not 0 <= 2 * points <= len(values):
        raise InputError("crossfade", f"{points} points", f"0 to {len(values) // 2}, half the record")
    if points == 0:
        return values
    fade = 0.5 + 0.5 * np.cos(np.pi * np.arange(points) / points)
    share = np.multiply.outer(fade, 0.5 * (values[0] - values[-1]))
    values[:points] -= share
    values[-points:] += share[::-1]
    return values


LEAST_POINTS = 8
"""Along each side of a map that has a spectrum."""
LAGS = 2
"""Lengths of the map beyond which the correlation is taken as zero."""
ROUNDING = 1e-12
"""Heights, relative to the largest before levelling, that are nothing but rounding."""
FLAT = 1e-15
"""Heights within which a map that was levelled before is a plane, m: less than any atom."""
LONGEST = 2.0
"""Wavelength, in lengths of the map, that heights are given which the spectrum does not explain."""


@dataclass(frozen=True, eq=False)
class Likeness:
    """What a synthesised surface shares with measured maps."""

    # from a normal variable of unit variance to heights, m
    transform: Callable[[Array], Array]
    # (odd, odd), of the normal field at all lags up to `LAGS` maps, zero lag first (wrapped)
    correlation: Array
    spacing: tuple[float, float]  # (dx, dy), m
    source: str  # where the maps came from

    @property
    def reach(self) -> int:
        """Length of the maps, points."""
        return (self.correlation.shape[0] + 1) // (2 * LAGS)


def likeness(
    maps: HeightMap | Sequence[HeightMap], spacing: float | tuple[float, float] | None = None
) -> Likeness:
    """Estimate the height distribution and the correlation of the surface that maps were cut from.

    The maps are of one texture, with one spacing, and complete, with at least eight points along a side; each
    is levelled by its mean plane. Another spacing, m, may be wanted.

    A window mixes each wavenumber with its neighbours, one step of the map away. In a spectrum that falls by
    10 dB a step, as that of long waves or of a bow, the neighbours win. So the window is put on the
    *curvature* of the maps, whose spectrum is nearly even and which knows no plane and no bow, and the
    spectrum is divided by what that has done, from one wave per map on. For longer waves that level is held,
    as far as the variance of the heights goes; what lacks is form, and gets waves twice as long as the map.
    """
    return _likeness((maps,) if isinstance(maps, HeightMap) else tuple(maps), spacing)


@lru_cache(maxsize=2)  # heights are read-only, and a path and its strips are made from the same maps
def _likeness(maps: tuple[HeightMap, ...], spacing: float | tuple[float, float] | None) -> Likeness:
    levelled = _prepared(maps, spacing)
    transform = height_transform(np.concatenate([m.heights.ravel() for m in levelled]))
    needed = gaussian_correlation(transform, _correlation([m.heights for m in levelled], levelled[0].spacing))
    sources = ", ".join(dict.fromkeys(m.source for m in levelled if m.source))
    return Likeness(transform, needed, levelled[0].spacing, sources or "maps")


def _prepared(maps: tuple[HeightMap, ...], spacing: float | tuple[float, float] | None) -> list[HeightMap]:
    if not maps:
        raise InputError("maps", "none", "one or more height maps")
    for one in maps:
        if np.isnan(one.heights).any():
            received = f"{one.missing_share:.2%} missing points in {one.source or 'a map'}"
            raise InputError("maps", received, "complete maps", "Use fill first.")
        if not np.allclose(one.spacing, maps[0].spacing, rtol=1e-6, atol=0.0):
            received = f"spacings {maps[0].spacing} and {one.spacing} m"
            raise InputError("maps", received, "one spacing for all", "Use resample first.")
    levelled = [level(one) for one in maps]
    if all(
        np.ptp(flat.heights) <= max(ROUNDING * np.abs(one.heights).max(), FLAT)
        for flat, one in zip(levelled, maps, strict=True)
    ):
        received = f"a plane without roughness, {maps[0].source or 'a map'}"
        raise InputError(
            "maps", received, "maps with roughness", "Check the measurement, and which array is read."
        )
    levelled = levelled if spacing is None else [resample(one, spacing) for one in levelled]
    smallest = min(min(one.shape) for one in levelled)
    if smallest < LEAST_POINTS:
        raise InputError("maps", f"{smallest} points along a side", f"at least {LEAST_POINTS}")
    return levelled


def _correlation(maps: list[Array], spacing: tuple[float, float]) -> Array:
    """Correlation coefficients at all lags up to twice the map, odd size, zero lag first (wrapped)."""
    size = [max(m.shape[axis] for m in maps) for axis in (0, 1)]
    grid = [2 * LAGS * n for n in size]
    variance = float(np.mean(np.concatenate([m.ravel() for m in maps]) ** 2))
    covariance = fft.irfft2(_spectrum(maps, size, grid, spacing, variance), s=grid)
    lags = [np.minimum(np.arange(g), g - np.arange(g)) / n for g, n in zip(grid, size, strict=True)]
    fades = [np.cos(0.5 * np.pi * np.clip((lag - 1.0) / (LAGS - 1.0), 0.0, 1.0)) ** 2 for lag in lags]
    resolved = covariance * np.outer(*fades) / variance
    longer = np.outer(*(_faded(LAGS * n, g) for n, g in zip(size, grid, strict=True)))
    longer *= j0(2.0 * np.pi / LONGEST * np.hypot(lags[0][:, None], lags[1][None, :]))
    whole = resolved + max(0.0, 1.0 - resolved[0, 0]) * longer
    # the lag of half the grid is zero, and its own opposite
    return np.asarray(np.delete(np.delete(whole, grid[0] // 2, 0), grid[1] // 2, 1) / whole[0, 0])


def _spectrum(
    maps: list[Array], size: list[int], grid: list[int], spacing: tuple[float, float], variance: float
) -> Array:
    """Half spectrum of the heights, m²; its mean over the grid is what it explains of their variance."""
    shares = [(min(spacing) / step) ** 2 for step in spacing]
    power, weight = np.zeros((grid[0], grid[1] // 2 + 1)), 0.0
    for heights in maps:
        inner = heights[1:-1, 1:-1]
        along = heights[2:, 1:-1] + heights[:-2, 1:-1] - 2.0 * inner
        across = heights[1:-1, 2:] + heights[1:-1, :-2] - 2.0 * inner
        curvature = shares[0] * along + shares[1] * across
        window = np.outer(*(_hann(n) for n in curvature.shape))
        curvature -= np.sum(window * curvature) / np.sum(window)
        power += np.abs(fft.rfft2(window * curvature, s=grid)) ** 2
        weight += float(np.sum(window**2))
    per_map = (fft.fftfreq(grid[0]) * size[0], fft.rfftfreq(grid[1]) * size[1])
    turns = [4.0 * np.sin(np.pi * k / n) ** 2 for k, n in zip(per_map, size, strict=True)]
    response = shares[0] * turns[0][:, None] + shares[1] * turns[1][None, :]
    waves = np.hypot(per_map[0][:, None], per_map[1][None, :])
    longer = waves < 1.0
    density = np.where(longer, 0.0, power / weight / np.where(longer, np.inf, response) ** 2)
    # held below one wave per map, as far as the heights have variance for it
    unexplained = max(0.0, variance - float(fft.irfft2(density, s=grid)[0, 0]))
    held = density[(waves >= 1.0) & (waves < 1.5)].mean()
    share = float(fft.irfft2(longer.astype(np.float64), s=grid)[0, 0])
    density[longer] = min(held, unexplained / share)
    return density


def _faded(points: int, grid: int) -> Array:
    """Correlation that fades out at `points`, with a spectrum nowhere negative: that of a Hann window."""
    found = fft.irfft(np.abs(fft.rfft(_hann(points), grid)) ** 2, grid)
    return np.asarray(found / found[0])


def _hann(points: int) -> Array:
    return np.sin(np.pi * (np.arange(points) + 0.5) / points) ** 2


__all__ = [
    "from_bands",
    "from_map",
    "long_self_affine",
    "long_strip_from_bands",
    "long_strip_like",
    "self_affine",
    "strip_from_bands",
]

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
    steps = (float(spacing[0]), float(spacing[1]))
    _check_shape(shape)
    _check_self_affine(steps, rms, hurst, longest, shortest, anisotropy)
    stretch, (cosine, sine) = np.sqrt(anisotropy), (np.cos(lay), np.sin(lay))
    reach = _reach(longest, anisotropy, lay)
    grid = [
        fft.next_fast_len(int(np.ceil(max(n + r / d, 2.0 * r / d))), real=True)
        for n, r, d in zip(shape, reach, steps, strict=True)
    ]
    if grid[0] * grid[1] > max(LARGEST_MAP, 4 * shape[0] * shape[1]):
        received = f"{longest:.4g} m at {steps[0]:.4g} m, which take a map of {grid[0]} x {grid[1]} points"
        remedy = "Shorten it, coarsen the spacing, or bring the anisotropy nearer to 1."
        raise InputError("longest", received, f"at most {LARGEST_MAP} points", remedy)
    qx = 2.0 * np.pi * fft.fftfreq(grid[0], steps[0])[:, None]
    qy = 2.0 * np.pi * fft.rfftfreq(grid[1], steps[1])[None, :]
    along, across = qx * cosine + qy * sine, qy * cosine - qx * sine
    scaled = np.maximum((along * stretch) ** 2 + (across / stretch) ** 2, (2.0 * np.pi / longest) ** 2)
    power = scaled ** (-1.0 - hurst)
    power[qx**2 + qy**2 > (2.0 * np.pi / shortest) ** 2 * (1.0 + 1e-12)] = 0.0
    power[0, 0] = 0.0
    field = _gaussian_field(power, grid, rms, seed)
    source = f"self-affine: rms {rms:.4g} m, Hurst {hurst:g}, {shortest:.4g} to {longest:.4g} m, seed {seed}"
    return HeightMap(field[: shape[0], : shape[1]], steps, source)


def _reach(longest: float, anisotropy: float, lay: float) -> tuple[float, float]:
    """How far the longest waves reach along x and y, m: a drawn-out circle, turned by the lay, rad."""
    stretch, (cosine, sine) = np.sqrt(anisotropy), (np.cos(lay), np.sin(lay))
    along = float(np.hypot(stretch * cosine, sine / stretch))
    return longest * along, longest * float(np.hypot(stretch * sine, cosine / stretch))


def _check_shape(shape: tuple[int, int]) -> None:
    if len(shape) != 2 or min(shape) < 2:
        raise InputError("shape", shape, "(nx, ny), at least 2 points each")


def _check_self_affine(
    steps: tuple[float, float], rms: float, hurst: float, longest: float, shortest: float, anisotropy: float
) -> None:
    coarsest = 2.0 * max(steps)
    checks = [
        ("spacing", steps, min(steps) > 0.0, "above zero"),
        ("rms", rms, 0.0 <= rms < np.inf, "zero or more, m"),
        ("hurst", hurst, 0.0 < hurst <= 1.0, "above 0, up to 1"),
        ("shortest", shortest, shortest >= coarsest * (1 - 1e-9), f"at least two samples, {coarsest:.4g} m"),
        ("longest", longest, shortest < longest < np.inf, "longer than the shortest"),
        ("anisotropy", anisotropy, 0.0 < anisotropy < np.inf, "above zero"),
    ]
    for what, received, right, allowed in checks:
        if not right:
            raise InputError(what, received, allowed)


def _gaussian_field(power: Array, grid: Sequence[int], rms: float, seed: int) -> Array:
    """Periodic Gaussian field with this half spectrum, scaled to an expected mean square of rms²."""
    doubled = power.sum() + power[:, 1 : (grid[1] + 1) // 2].sum()  # the half that rfft2 leaves out
    noise = np.random.default_rng(seed).standard_normal((grid[0], grid[1]))
    spectrum = fft.rfft2(noise, overwrite_x=True)
    del noise
    spectrum *= np.sqrt(power * (rms**2 * grid[0] * grid[1] / doubled))
    return np.asarray(fft.irfft2(spectrum, s=tuple(grid), overwrite_x=True))


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
    _check_shape(shape)
    like = likeness(maps, spacing)
    heights = like.transform(_gaussian_like(like, shape, seed))
    return HeightMap(heights, like.spacing, f"synthesised from {like.source}, seed {seed}")


def long_self_affine(
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
    before: int = 0,
) -> LongStrip:
    """Self-affine strip of any length, generated where it is read.

    Pieces of `self_affine` surfaces, whose parameters it has, blended over two roll-off wavelengths. With
    rows `before`, as `LongStrip` has them.
    """
    steps = (float(spacing[0]), float(spacing[1]))
    _check_shape(shape)
    _check_self_affine(steps, rms, hurst, longest, shortest, anisotropy)

    def piece(rows: int, piece_seed: int) -> Array:
        return self_affine(
            (rows, shape[1]), steps, rms=rms, hurst=hurst, longest=longest, shortest=shortest,
            anisotropy=anisotropy, lay=lay, seed=piece_seed,
        ).heights  # fmt: skip

    reach = int(np.ceil(_reach(longest, anisotropy, lay)[0] / steps[0]))
    source = f"self-affine: rms {rms:.4g} m, Hurst {hurst:g}, {shortest:.4g} to {longest:.4g} m, seed {seed}"
    name = "self-affine", steps, rms, hurst, longest, shortest, anisotropy, lay
    stride, blend = _pieces(shape[1], reach)
    return LongStrip(shape, steps, piece, seed, stride, blend, source=source, before=before, name=name)


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
    steps, reach = (float(spacing[0]), float(spacing[1])), int(np.ceil(given.max() / spacing[0]))
    stride = max(BAND_REACHES * reach, int(np.ceil(LEAST_PIECE / steps[0])))

    def piece(rows: int, piece_seed: int) -> Array:
        grid = fft.next_fast_len(rows, real=True)
        return strip_from_bands(
            (grid, shape[1]), steps, given, levels, lateral=lateral, seed=piece_seed
        ).heights[:rows]

    source = f"one-third octaves {given.max():.4g} to {given.min():.4g} m, lateral {lateral:g}, seed {seed}"
    name = "bands", steps, given.tobytes(), levels.tobytes(), lateral
    blend = BLEND_REACHES * reach
    return LongStrip(shape, steps, piece, seed, stride, blend, source=source, before=before, name=name)


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
    _check_shape(shape)
    like = likeness(maps, spacing)

    def piece(rows: int, piece_seed: int) -> Array:
        return _gaussian_like(like, (rows, shape[1]), piece_seed)

    source = f"synthesised from {like.source}, seed {seed}"
    stride, blend = _pieces(shape[1], like.reach)
    return LongStrip(shape, like.spacing, piece, seed, stride, blend, like.transform, source, before)


def _pieces(columns: int, reach: int) -> tuple[int, int]:
    """Rows from piece to piece of a long strip, and rows of a blend; a correlation length is `reach` rows."""
    return max(PIECE_POINTS // columns, PIECE_REACHES * reach), max(1, BLEND_REACHES * reach)


def _gaussian_like(like: Likeness, shape: tuple[int, int], seed: int) -> Array:
    """Gaussian field of unit variance with the correlation of measured maps, not periodic."""
    lags = [(n + 1) // 2 for n in like.correlation.shape]
    grid = [fft.next_fast_len(n + k, real=True) for n, k in zip(shape, lags, strict=True)]
    power = fft.rfft2(_embedded(like.correlation, grid), overwrite_x=True).real
    np.maximum(power, 0.0, out=power)
    return _gaussian_field(power, grid, 1.0, seed)[: shape[0], : shape[1]]


def _embedded(correlation: Array, grid: Sequence[int]) -> Array:
    """Correlation at the lags of a periodic grid; lags that wrap onto each other add up.

    Adding samples the same spectrum more coarsely, so it stays non-negative.
    """
    embedded = np.zeros((grid[0], grid[1]))
    nx, ny = ((n + 1) // 2 for n in correlation.shape)
    for row, row_out in ((slice(0, nx), slice(0, nx)), (slice(nx, None), slice(grid[0] - nx + 1, None))):
        embedded[row_out, :ny] += correlation[row, :ny]
        embedded[row_out, grid[1] - ny + 1 :] += correlation[row, ny:]
    return embedded
