"""Spikes of a measured map: points that stand out of their neighbours as no roughness does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from asperity.arguments import Array
from asperity.surfaces.heightmap import HeightMap

__all__ = ["FARTHEST", "spikes", "without_spikes"]

REACH = 2
"""Points to either side whose median a point is held against: spikes up to three points wide stand out."""
FARTHEST = 8.0
"""Distance from that median, in standard deviations, beyond which a point is a spike."""
TILE = 16
"""Points along the sides of the tiles on which the standard deviation is estimated."""
MAD = 1.4826
"""Standard deviation of a normal distribution over its median absolute deviation."""
STEP_SHARE = 0.05
"""Share of the distances above zero below which there is nothing but the step of rounded heights."""
PIECE = 2**18
"""Points whose neighbours are sorted at a time."""


def spikes(surface: HeightMap) -> NDArray[np.bool_]:
    """Find the spikes of a map: Hampel's identifier on the distance from the local median.

    A point is a spike if it is farther from the median of its 5 × 5 neighbours than `FARTHEST`
    standard deviations. These are estimated, so that spikes do not count, as 1.4826 times the
    median absolute distance: of the whole surface, or of the tiles around where that is more, as on steep
    places; no less than the step of heights that are rounded. Missing points have no part in it. Gaussian
    textures whose waves are four points long and longer have none.

    Parameters
    ----------
    surface : HeightMap
        Heights, as they were measured: neither form nor tilt matters.

    Returns
    -------
    ndarray of bool, shape (nx, ny)
        True at the spikes.

    Notes
    -----
    F. R. Hampel, J. Am. Stat. Assoc. 69 (1974) 383; L. Davies and U. Gather, J. Am. Stat. Assoc. 88 (1993)
    782. The local median is what ISO 16610-49 and -71 build robust filters on.
    """
    heights = surface.heights
    distance = np.abs(heights - _local_median(heights))
    return np.asarray(distance > FARTHEST * MAD * _typical(distance))


def without_spikes(surface: HeightMap) -> HeightMap:
    """Take the spikes of a map away: they become points without a height; `source` says how many."""
    found = spikes(surface)
    count = int(np.count_nonzero(found))
    if count == 0:
        return surface
    source = f"{surface.source}; {count} points of spikes removed".lstrip("; ")
    return replace(surface, heights=np.where(found, np.nan, surface.heights), source=source)


def _local_median(heights: Array) -> Array:
    """Median of the neighbours that have a height, the point itself among them; edges are carried on."""
    padded = np.pad(heights, REACH, mode="reflect", reflect_type="odd")
    side = 2 * REACH + 1
    around = np.lib.stride_tricks.sliding_window_view(padded, (side,) * heights.ndim)
    rows = max(1, PIECE // max(heights[0].size, 1))
    found = np.empty(heights.shape)
    for first in range(0, len(heights), rows):
        piece = around[first : first + rows]
        ordered = np.sort(piece.reshape(*piece.shape[: heights.ndim], -1), axis=-1)  # missing ones last
        count = np.count_nonzero(np.isfinite(ordered), axis=-1)[..., None]
        low, high = (
            np.take_along_axis(ordered, at, -1) for at in (np.maximum(count - 1, 0) // 2, count // 2)
        )
        found[first : first + rows] = 0.5 * (low + high)[..., 0]
    return found


def _typical(distance: Array) -> Array:
    """Median of the distances, of all or of the tiles around, whichever is more."""
    apart = distance[distance > 0.0]
    if not apart.size:
        return distance
    everywhere = max(float(np.nanmedian(distance)), float(np.quantile(apart, STEP_SHARE)))
    tiles = tuple(-(-n // TILE) for n in distance.shape)
    padded = np.full([n * TILE for n in tiles], np.nan)
    padded[tuple(slice(n) for n in distance.shape)] = distance
    split = padded.reshape([size for n in tiles for size in (n, TILE)])
    order = [*range(0, split.ndim, 2), *range(1, split.ndim, 2)]
    each = split.transpose(order).reshape(*tiles, -1)
    known = np.isfinite(each).any(axis=-1)
    median = np.full(tiles, everywhere)
    median[known] = np.nanmedian(each[known], axis=-1)
    median = np.maximum(median, everywhere)
    grown = np.pad(median, 1, mode="edge")
    around = np.lib.stride_tricks.sliding_window_view(grown, (3,) * median.ndim)
    largest = around.reshape(*tiles, -1).max(axis=-1)
    for axis in range(distance.ndim):
        largest = np.repeat(largest, TILE, axis=axis)
    return largest[tuple(slice(n) for n in distance.shape)]
