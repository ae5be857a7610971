"""What a synthesised surface shares with measured maps: the distribution of heights and their correlation."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import cast

import numpy as np
from scipy import fft
from scipy.special import j0, ndtr

from asperity.arguments import Array, require
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.levelling import level, resample

DEVIATE = 6.0
"""Largest standard normal deviate in the tables: one point in 10^9 lies beyond."""
ORDERS = 24
"""Terms of Mehler's expansion."""
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


def height_table(heights: Array, points: int = 2401) -> tuple[Array, Array]:
    """Standard normal deviates, rising, and the heights, m, that have the same place in a distribution.

    Of measured heights the quantiles are used as they are, so nothing higher or lower than measured can
    arise. Interpolated, this gives a normal variable their distribution; beyond the table the end values
    hold.
    """
    rising = np.sort(heights, axis=None)
    deviates = np.linspace(-DEVIATE, DEVIATE, points)
    probabilities = (np.arange(rising.size) + 0.5) / rising.size
    return deviates, np.interp(ndtr(deviates), probabilities, rising)


def gaussian_correlation(deviates: Array, heights: Array, correlation: Array) -> Array:
    """Correlation coefficient that a Gaussian field needs for its heights to have a given one, at most 1.

    Deviates and heights are those of `height_table`. Mehler's expansion: with g = Σ c_k He_k/√k!, the
    correlation of g is Σ c_k² ρ^k/Σ c_k². The relation is monotone because the table is. M. Grigoriu, Applied
    Non-Gaussian Processes (1995).
    """
    weight = np.exp(-deviates * deviates / 2.0)
    weight /= weight.sum()
    previous = np.zeros_like(deviates)
    current = np.ones_like(deviates)
    coefficients = []
    for k in range(ORDERS):  # normalised Hermite polynomials
        previous, current = current, (deviates * current - np.sqrt(k) * previous) / np.sqrt(k + 1.0)
        coefficients.append(np.sum(weight * heights * current))
    energies = np.square(coefficients)
    table = -np.cos(np.linspace(0.0, np.pi, 4001))
    mapped = np.polynomial.polynomial.polyval(table, np.concatenate([[0.0], energies / energies.sum()]))
    return np.interp(correlation, np.maximum.accumulate(mapped), table)


@dataclass(frozen=True, eq=False)
class Likeness:
    """What a synthesised surface shares with measured maps."""

    transform: Callable[[Array], Array]  # from a normal variable of unit variance to heights, m
    # (odd, odd), of the normal field at all lags up to `LAGS` maps, zero lag first (wrapped)
    correlation: Array
    spacing: tuple[float, float]  # (dx, dy), m
    source: str  # where the maps came from

    @property
    def size(self) -> tuple[int, int]:
        """Size of the maps along and across, points."""
        along, across = ((n + 1) // (2 * LAGS) for n in self.correlation.shape)
        return along, across


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
    heights = [one.heights for one in levelled]
    steps = levelled[0].spacing
    table = height_table(np.concatenate([each.ravel() for each in heights]))
    correlation = gaussian_correlation(*table, _correlation(heights, steps))
    sources = ", ".join(dict.fromkeys(one.source for one in levelled if one.source))
    transform = cast(Callable[[Array], Array], partial(np.interp, xp=table[0], fp=table[1]))
    return Likeness(transform, correlation, steps, sources or "maps")


def _prepared(maps: tuple[HeightMap, ...], spacing: float | tuple[float, float] | None) -> list[HeightMap]:
    require(maps, "maps", "none", "one or more height maps")
    for one in maps:
        received = f"{one.missing_share:.2%} missing points in {one.source or 'a map'}"
        require(not np.isnan(one.heights).any(), "maps", received, "complete maps", "Use fill first.")
        same = np.allclose(one.spacing, maps[0].spacing, rtol=1e-6, atol=0.0)
        received = f"spacings {maps[0].spacing} and {one.spacing} m"
        require(same, "maps", received, "one spacing for all", "Use resample first.")
    levelled = [level(one) for one in maps]
    rough = any(
        np.ptp(flat.heights) > max(ROUNDING * np.abs(one.heights).max(), FLAT)
        for flat, one in zip(levelled, maps, strict=True)
    )
    received = f"a plane without roughness, {maps[0].source or 'a map'}"
    remedy = "Check the measurement, and which array is read."
    require(rough, "maps", received, "maps with roughness", remedy)
    levelled = levelled if spacing is None else [resample(one, spacing) for one in levelled]
    fewest = min(min(one.shape) for one in levelled)
    require(fewest >= LEAST_POINTS, "maps", f"{fewest} points along a side", f"at least {LEAST_POINTS}")
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
    return np.delete(np.delete(whole, grid[0] // 2, 0), grid[1] // 2, 1) / whole[0, 0]


def _spectrum(
    maps: list[Array], size: list[int], grid: list[int], spacing: tuple[float, float], variance: float
) -> Array:
    """Half spectrum of the heights, m²; its mean over the grid is what it explains of their variance."""
    shares = [(min(spacing) / step) ** 2 for step in spacing]
    power = np.zeros((grid[0], grid[1] // 2 + 1))
    weight = 0.0
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
    lobe = fft.irfft(np.abs(fft.rfft(_hann(points), grid)) ** 2, grid)
    return lobe / lobe[0]


def _hann(points: int) -> Array:
    return np.sin(np.pi * (np.arange(points) + 0.5) / points) ** 2
