"""Is the texture the same everywhere, and does it have a direction?"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import bdtrc

from asperity.arguments import Array, require
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.levelling import level, resample
from asperity.surfaces.synthesis import from_map

SIGNIFICANCE = 0.05
TILES = (4, 4)
"""Tiles that a map is cut into where nothing else is said."""
MOST_POINTS = 192
"""Points along a side on which the test is made: short waves add little to the mean square of a tile."""
FEWEST_POINTS = 8
"""Points along a tile's side that are left."""


@dataclass(frozen=True, eq=False)
class Homogeneity:
    """Outcome of the homogeneity test."""

    # (kx, ky), root mean square height of each tile about the map's mean plane, m
    tile_rms: Array
    variation: float  # coefficient of variation of the tiles' mean squares
    expected: float  # median of the same over stationary surrogates
    p_value: float  # share of surrogates, this map included, that vary at least as much

    @property
    def homogeneous(self) -> bool:
        """Whether the tiles differ no more than chance makes them, at 5 % significance."""
        return self.p_value > SIGNIFICANCE


def homogeneity(
    surface: HeightMap, tiles: tuple[int, int] = TILES, *, surrogates: int = 39, seed: int = 0
) -> Homogeneity:
    """Test whether the mean square of tiles varies more than on a stationary surface.

    The surrogates are pieces of a stationary surface with the spectrum and the height distribution of the map
    (see `asperity.surfaces.synthesis.from_map`), levelled and tiled as the map is; there are at least 19, and
    the smallest p-value is 1/(surrogates + 1). Rows and columns left over by the tiles are not used.

    One-sided rank test (Monte Carlo test), on at most 192 points along a side (J. Theiler et al., Physica D
    58 (1992) 77: surrogate data). Finds patches and trends of roughness larger than a tile; a change of the
    spectrum at equal mean square goes unseen.
    """
    several = len(tiles) == 2 and min(tiles) >= 1 and max(tiles) > 1
    fit = several and all(n >= 2 * count for n, count in zip(surface.shape, tiles, strict=True))
    require(fit, "tiles", tiles, f"two or more tiles of 2 points or more in {surface.shape}")
    require(surrogates >= 19, "surrogates", surrogates, "at least 19, for 5 % significance")
    coarse = _coarse(level(surface), tiles)
    measured, (nx, ny) = _tile_mean_squares(level(coarse), tiles), coarse.shape
    variation = float(measured.std() / measured.mean())
    long = from_map(coarse, (nx * surrogates, ny), seed).heights
    pieces = (HeightMap(long[k * nx : (k + 1) * nx], coarse.spacing) for k in range(surrogates))
    squares = [_tile_mean_squares(level(piece), tiles) for piece in pieces]
    chance = np.array([s.std() / s.mean() for s in squares])
    p_value = (1.0 + float(np.sum(chance >= variation))) / (surrogates + 1.0)
    tile_rms = np.sqrt(_tile_mean_squares(level(surface), tiles))
    return Homogeneity(tile_rms, variation, float(np.median(chance)), p_value)


def _coarse(surface: HeightMap, tiles: tuple[int, int]) -> HeightMap:
    """The surface on fewer points where it has more than the test needs."""
    room = min(n / (FEWEST_POINTS * count) for n, count in zip(surface.shape, tiles, strict=True))
    step = max(1.0, min(max(surface.shape) / MOST_POINTS, room))
    return resample(surface, (step * surface.spacing[0], step * surface.spacing[1]))


def _tile_mean_squares(surface: HeightMap, tiles: tuple[int, int]) -> Array:
    px, py = (n // k for n, k in zip(surface.shape, tiles, strict=True))
    kept = surface.heights[: px * tiles[0], : py * tiles[1]]
    return np.mean(kept.reshape(tiles[0], px, tiles[1], py) ** 2, axis=(1, 3))


def more_than_chance(p_values: Sequence[float]) -> bool:
    """Whether more maps fail the test than chance makes fail, at 5 % significance.

    One of one, two of two to seven, three of eight or more, and so on: the binomial tail.
    """
    count = sum(p <= SIGNIFICANCE for p in p_values)
    return bool(bdtrc(count - 1, len(p_values), SIGNIFICANCE) <= SIGNIFICANCE * (1 + 1e-9))
