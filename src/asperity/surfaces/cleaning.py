"""What a measured surface lacks or has too much: points without a height, and spikes."""

from dataclasses import replace
from typing import TypeVar

import numpy as np
import scipy
from numpy.lib.stride_tricks import sliding_window_view

from asperity.arguments import Array, Flags
from asperity.errors import MissingPointsWarning
from asperity.surfaces.even_heights import EvenHeights
from asperity.written_numbers import count_of

S = TypeVar("S", bound=EvenHeights)

FILLED_SHARE_WARNED = 0.05

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
"""Points whose medians are found at a time."""


def fill(surface: S, lines: bool | None = None) -> S:
    """Fill missing points: the harmonic surface through their neighbours, or straight lines in a profile.

    Solves the five-point Laplace equation on the missing points, with no slope at the border: no new peak or
    valley arises. `source` states the share that was filled; more than 5 % are warned of, as filled points
    carry no roughness. `lines` says whether an array holds lines measured side by side; by default its shape
    does, see `HeightMap.holds_lines`. Neighbours need not be in register: such lines are filled along
    themselves, by straight lines, and what is missing at their ends stays missing.
    """
    missing = np.isnan(surface.heights)
    along = int(np.argmax(surface.heights.shape))
    by_lines = surface.heights.ndim == 2 and (surface.holds_lines if lines is None else lines)
    if by_lines:
        begun = np.maximum.accumulate(~missing, axis=along)
        goes_on = np.flip(np.maximum.accumulate(~np.flip(missing, along), axis=along), along)
        missing &= begun & goes_on
    share = float(missing.mean())
    if share == 0.0:
        return surface
    if share > FILLED_SHARE_WARNED:
        MissingPointsWarning.warn(
            f"{share:.1%} of the points were missing and are filled, more than {FILLED_SHARE_WARNED:.0%}: "
            "filled points are smooth and lower Sq and Sdq; measure again or crop"
        )
    heights = np.array(surface.heights)
    if by_lines:
        for line, holes in zip(*(np.moveaxis(each, along, -1) for each in (heights, missing)), strict=True):
            there = np.flatnonzero(np.isfinite(line))
            if holes.any():
                line[holes] = np.interp(np.flatnonzero(holes), there, line[there])
    else:
        from asperity.surfaces.holes import harmonic  # not where none is missing

        spacings = np.atleast_1d(np.asarray(surface.spacing))
        heights[missing] = harmonic(surface.heights, missing, spacings)
    source = f"{surface.source}; {share:.2%} of the points filled".lstrip("; ")
    return replace(surface, heights=heights, source=source)


def nearly_complete(surface: S) -> S | None:
    """Surface with its missing points filled, for what needs all; None where more than 5 % are missing."""
    return fill(surface, lines=False) if surface.missing_share <= FILLED_SHARE_WARNED else None


def spikes(surface: EvenHeights) -> Flags:
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
    distance = np.abs(surface.heights - _local_median(surface.heights))
    return distance > FARTHEST * MAD * _typical(distance)


def without_spikes(surface: S) -> S:
    """Take the spikes of a map away: they become points without a height; `source` says how many."""
    spiky = spikes(surface)
    count = int(np.count_nonzero(spiky))
    if count == 0:
        return surface
    source = f"{surface.source}; {count_of(count, 'point')} of spikes removed".lstrip("; ")
    return replace(surface, heights=np.where(spiky, np.nan, surface.heights), source=source)


def _local_median(heights: Array) -> Array:
    """Median of the neighbours that have a height, the point itself among them; edges are carried on."""
    around = sliding_window_view(
        np.pad(heights, REACH, mode="reflect", reflect_type="odd"), (2 * REACH + 1, 2 * REACH + 1)
    )
    rows = max(1, PIECE // heights.shape[1])
    pieces = (around[first : first + rows] for first in range(0, len(heights), rows))
    return np.concatenate([_median_of_known(piece.reshape(*piece.shape[:2], -1)) for piece in pieces])


def _median_of_known(values: Array) -> Array:
    """Median of those along the last axis that are not missing; NumPy takes six times as long for few."""
    ordered = np.sort(values, axis=-1)  # missing ones come last
    known = np.count_nonzero(np.isfinite(ordered), axis=-1, keepdims=True)
    middle = np.concatenate([(known - 1) // 2, known // 2], axis=-1)
    found: Array = np.take_along_axis(ordered, middle, axis=-1).mean(axis=-1)
    return found


def _typical(distance: Array) -> Array:
    """Median of the distances, of all or of the tiles around, whichever is more."""
    apart = distance[distance > 0.0]
    if not apart.size:
        return distance
    everywhere = max(float(np.nanmedian(distance)), float(np.quantile(apart, STEP_SHARE)))
    nx, ny = (-(-n // TILE) for n in distance.shape)
    padded = np.full((nx * TILE, ny * TILE), np.nan)
    padded[: distance.shape[0], : distance.shape[1]] = distance
    each = padded.reshape(nx, TILE, ny, TILE).swapaxes(1, 2).reshape(nx, ny, -1)
    known = np.isfinite(each).any(axis=-1)
    median = np.full((nx, ny), everywhere)
    median[known] = np.maximum(_median_of_known(each[known]), everywhere)
    largest = scipy.ndimage.maximum_filter(median, 3, mode="nearest")
    spread = np.kron(largest, np.ones((TILE, TILE)))
    return spread[: distance.shape[0], : distance.shape[1]]
