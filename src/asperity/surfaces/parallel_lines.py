"""Parallel measured lines: brought into register, and laid out as a strip."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy
from numpy.typing import ArrayLike
from scipy import fft

from asperity.arguments import Array
from asperity.errors import InputError, ShortRecordWarning
from asperity.surfaces.heightmap import HeightMap, Profile

FULL_LINE = 0.95
"""Share of the longest line from which a line counts as a full turn."""
NEAR = 0.01
"""Share of a turn by which the starts of neighbouring lines differ, unless others fit `CLEARLY` better."""
CLEARLY = 0.2
"""Gain in correlation that speaks for a start farther away."""


MOST_LINES = 32
"""Lines side by side, at most, that a bare array is taken for without being told."""
SLENDER = 20.0
"""Times longer than wide, in points, that such an array is at least."""


def are_lines(surface: HeightMap) -> bool:
    """Judge by its shape whether an array holds lines measured side by side rather than a map.

    At most 32 lines, each with at least 20 times as many points; such a file knows no distance across of
    lines.
    """
    few, many = sorted(surface.shape)
    return few <= MOST_LINES and many >= SLENDER * few


def lines_of(surface: HeightMap) -> tuple[Profile, ...]:
    """Take an array as lines side by side, which lie along its longer side."""
    along = int(np.argmax(surface.shape))
    heights = surface.heights if along == 1 else surface.heights.T
    return tuple(
        Profile(line, surface.spacing[along], f"{surface.source}, line {i}".lstrip(", "))
        for i, line in enumerate(heights, 1)
    )


@dataclass(frozen=True, eq=False)
class Register:
    """Parallel lines in register, and what brought them there."""

    lines: Array  # (k, n), heights, m, cut to the shortest full line
    reversed: tuple[bool, ...]  # whether each line was turned round
    shifts: tuple[int, ...]  # points by which each line was moved on, around its length
    correlations: tuple[float, ...]  # coefficient of each line with the one before it; 1 for the first
    # lines too short for a full turn, replaced by their neighbours, linearly in between
    replaced: tuple[int, ...]


def bring_into_register(profiles: Sequence[Profile]) -> Register:
    """Turn and shift the complete, parallel lines of a wheel so that neighbours agree.

    Lines are often measured to and fro, each starting anew. Every line but the first is tried in both
    directions, and at all shifts around the wheel, against the line before it; the highest correlation wins.
    Starts within 1 % of a turn are preferred, since long waves also agree elsewhere: one farther away must
    raise the correlation by 0.2. A line shorter than 95 % of the longest is warned of.
    """
    longest = max((len(p.heights) for p in profiles), default=0)
    full = [k for k, p in enumerate(profiles) if len(p.heights) >= FULL_LINE * longest]
    lines = common_length([profiles[k] for k in full])
    turned, shifts = [False] * len(profiles), [0] * len(profiles)
    done = [lines[0]]
    for k, line in zip(full[1:], lines[1:], strict=True):
        turned[k], shifts[k] = _best_match(done[-1], line)
        done.append(np.roll(line[::-1] if turned[k] else line, shifts[k]))
    replaced = tuple(k for k in range(len(profiles)) if k not in full)
    if replaced:
        message = (
            f"{len(replaced)} of {len(profiles)} parallel lines are shorter than {FULL_LINE:.0%} of the "
            f"longest, {longest} points: their neighbours replace them; measure again or leave them out"
        )
        warnings.warn(message, ShortRecordWarning, stacklevel=2)
    everywhere = np.clip(np.arange(len(profiles)), full[0], full[-1])
    between = scipy.interpolate.make_interp_spline(full, np.array(done), k=1) if len(done) > 1 else None
    result = np.repeat(done, len(profiles), axis=0) if between is None else between(everywhere)
    pairs = (_correlation(one, other) for one, other in pairwise(result))
    return Register(result, tuple(turned), tuple(shifts), (1.0, *pairs), replaced)


def _best_match(reference: Array, line: Array) -> tuple[bool, int]:
    """Whether to turn a periodic line round, and how far to move it on, to follow a reference."""
    n = len(line)
    wanted = fft.rfft(reference - reference.mean())
    distance = np.minimum(np.arange(n), n - np.arange(n))
    scale = n * float(reference.std() * line.std())
    handicap = np.where(distance <= NEAR * n, 0.0, CLEARLY * scale)
    matches = []
    for backwards in (False, True):
        tried = line[::-1] if backwards else line
        agreement = fft.irfft(wanted * np.conj(fft.rfft(tried - tried.mean())), n) - handicap
        shift = int(np.argmax(agreement))
        matches.append((float(agreement[shift]), backwards, shift))
    return max(matches)[1:]


def _correlation(one: Array, other: Array) -> float:
    scale = float(one.std() * other.std())
    return float(np.mean((one - one.mean()) * (other - other.mean()))) / scale if scale else 0.0


def common_length(profiles: Sequence[Profile]) -> Array:
    """Complete parallel lines with one spacing, cut to the length of the shortest: heights (k, n), m."""
    if not profiles:
        raise InputError("parallel lines", "none", "one or more lines")
    for profile in profiles:
        if profile.missing_share > 0.0:
            received = f"{profile.missing_share:.2%} missing points in {profile.source or 'a line'}"
            raise InputError("parallel lines", received, "complete lines", "Trim and fill them first.")
        if not np.isclose(profile.spacing, profiles[0].spacing, rtol=1e-6, atol=0.0):
            received = f"spacings {profiles[0].spacing} and {profile.spacing} m"
            raise InputError("parallel lines", received, "one spacing for all", "Use resample first.")
    n = min(len(p.heights) for p in profiles)
    return np.array([p.heights[:n] for p in profiles])


def strip_from_lines(
    lines: ArrayLike, spacing: float, distance_across: float, shape_y: int, spacing_y: float
) -> Array:
    """Strip (n, shape_y) through complete parallel lines (k, n), heights and distances in m.

    The points across are centred on the lines. Across, one line is constant, two and three are joined by
    straight lines, four and more by a cubic spline; beyond the outer lines their heights hold. Between lines
    that have little in common the interpolated texture is smoother than a measured one: its mean square falls
    to about half, midway between uncorrelated lines.
    """
    heights = np.asarray(lines, dtype=np.float64)
    if heights.ndim != 2 or heights.size == 0 or not np.isfinite(heights).all():
        raise InputError("parallel lines", f"shape {heights.shape}", "complete heights (k, n)")
    if not min(spacing, distance_across, spacing_y) > 0.0 or shape_y < 1:
        received = f"{spacing}, {distance_across}, {spacing_y} m and {shape_y} points"
        raise InputError("spacings of the lines", received, "positive lengths and one point or more")
    count = len(heights)
    at = (np.arange(count) - 0.5 * (count - 1)) * distance_across
    wanted = np.clip((np.arange(shape_y) - 0.5 * (shape_y - 1)) * spacing_y, at[0], at[-1])
    if count == 1:
        return np.repeat(heights.T, shape_y, axis=1)
    degree = 1 if count < 4 else 3
    return np.ascontiguousarray(scipy.interpolate.make_interp_spline(at, heights, k=degree)(wanted).T)
