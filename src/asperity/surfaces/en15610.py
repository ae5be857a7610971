"""Processing of measured roughness lines after EN 15610:2009: spikes and curvature.

Later editions of the standard have not been compared.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy.typing import NDArray

from asperity.arguments import Array
from asperity.errors import CoarseSamplingWarning, InputError, PhysicsWarning
from asperity.reference.cnossos import rail_roughness
from asperity.spectra import HALF_BAND
from asperity.surfaces.bands import LIKELY_WAVELENGTHS, band_levels_of
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.levelling import fill, nearly_complete
from asperity.surfaces.parallel_lines import FULL_LINE, common_length

ROLLED_RADIUS = 0.375
"""Radius of the circle that is rolled over a line, m."""

SPIKE_CURVATURE = -10.0
"""Second derivative below which a point may be a spike, 1/m (-10^7 µm/m²)."""

SPIKE_SCALE = 3.0
"""A spike is higher than its width squared over this, m; 8 · 0.375 m: the circle does not fit it."""

COARSEST_SPACING = 1e-3
"""m."""


@dataclass(frozen=True)
class Processing:
    """Every switch of `process`, and what it did."""

    trimmed: tuple[int, int] = (0, 0)  # missing points cut off at the start and at the end
    fill: bool = False  # whether gaps were to be filled
    filled: int = 0  # points that were
    spikes: bool = False  # whether spikes were to be removed
    spikes_removed: int = 0
    spike_points: int = 0  # points changed by it
    curvature: bool = False  # whether a circle was rolled over the line
    radius: float = ROLLED_RADIUS  # of that circle, m
    lifted: float = 0.0  # share of the points that the circle did not touch, 0 to 1
    largest_lift: float = 0.0  # largest height of the circle above a point, m

    def __str__(self) -> str:
        """Return what was done, in one sentence."""
        parts = [f"{sum(self.trimmed)} missing points trimmed at the ends"]
        parts.append(f"{self.filled} points filled" if self.fill else "gaps not filled")
        removed = f"{self.spikes_removed} spikes ({self.spike_points} points) removed"
        parts.append(removed if self.spikes else "spikes kept")
        rolled = f"rolled over with a circle of {self.radius:g} m: {self.lifted:.1%} of the points lifted"
        rolled += f", by up to {self.largest_lift * 1e6:.3g} µm"
        parts.append(rolled if self.curvature else "not rolled over")
        return "EN 15610:2009: " + "; ".join(parts)


def process(
    profile: Profile,
    *,
    fill_gaps: bool = False,
    spikes: bool = True,
    curvature: bool = True,
    radius: float = ROLLED_RADIUS,
) -> tuple[Profile, Processing]:
    """Process a measured line, m: trim, fill, remove spikes, roll a circle over it; and tell what each did.

    Missing points at the ends are cut off, those inside filled by straight lines or refused. Warned of are a
    spacing beyond 1 mm and more than 5 % filled points. Pits narrower than the patch that the circle bridges
    are no longer in the line: a contact filter or a contact geometry applied after it counts that effect
    twice in part. Leave `curvature` out for laws that solve the contact on the heights themselves.
    """
    if profile.spacing > COARSEST_SPACING * (1.0 + 1e-6):
        message = (
            f"spacing {profile.spacing * 1e3:.3g} mm, more than the 1 mm of EN 15610: spikes and short waves "
            "are not resolved; measure more finely or leave the processing out"
        )
        warnings.warn(message, CoarseSamplingWarning, stacklevel=2)
    line, trimmed = trim(profile)
    missing = int(np.isnan(line.heights).sum())
    if missing and not fill_gaps:
        received = f"{missing} missing points inside {line.source or 'the line'}"
        raise InputError(
            "measured line", received, "a line without gaps", "Fill them, or cut a piece without."
        )
    if missing:
        line = fill(line)
    removed = changed = 0
    if spikes:
        line, removed, changed = remove_spikes(line)
    lift = np.zeros(1)
    if curvature:
        rolled = roll_over(line, radius)
        lift, line = rolled.heights - line.heights, rolled
    lifted = float(np.mean(lift > 1e-12))
    return line, Processing(
        trimmed, fill_gaps, missing, spikes, removed, changed, curvature, radius, lifted, float(lift.max())
    )


def trim(profile: Profile) -> tuple[Profile, tuple[int, int]]:
    """Cut missing points off both ends; and tell how many there."""
    valid = np.flatnonzero(np.isfinite(profile.heights))
    first, last = int(valid[0]), int(valid[-1]) + 1
    cut = (first, len(profile.heights) - last)
    return (profile if cut == (0, 0) else replace(profile, heights=profile.heights[first:last])), cut


def remove_spikes(profile: Profile) -> tuple[Profile, int, int]:
    """Remove narrow upward spikes, as dust and grains leave them; and tell how many, and of how many points.

    A spike holds a point with a second derivative below -10⁷ µm/m², ends at the nearest feet on either side
    (where a positive second derivative is largest) and is higher above the straight line between its feet
    than w²/3 m, w their distance. It is replaced by that line. One pass; the ends of the record count as
    feet. EN 15610:2009 (spike removal): curvature and height are the standard's; the feet are our reading of
    where a spike ends.
    """
    heights = np.array(_complete(profile))
    bend = np.diff(heights, 2)
    foot = (bend > 0.0) & (bend >= np.append(0.0, bend[:-1])) & (bend >= np.append(bend[1:], 0.0))
    feet = np.concatenate([[0], np.flatnonzero(foot) + 1, [len(heights) - 1]])
    sharp = np.flatnonzero(bend < SPIKE_CURVATURE * profile.spacing**2) + 1
    spikes = points = 0
    for k in np.unique(np.searchsorted(feet, sharp)):
        first, last = int(feet[k - 1]), int(feet[k])
        width = (last - first) * profile.spacing
        chord = np.linspace(heights[first], heights[last], last - first + 1)
        if np.max(heights[first : last + 1] - chord) > width**2 / SPIKE_SCALE:
            heights[first : last + 1] = chord
            spikes, points = spikes + 1, points + last - first - 1
    return replace(profile, heights=heights), spikes, points


def roll_over(profile: Profile, radius: float = ROLLED_RADIUS) -> Profile:
    """Path of a circle's lowest point as it rolls over a complete line, m, nowhere below it.

    max over s of z(s) - R + √(R² - (s - x)²) at the points s of the line; at the ends only the line itself
    carries. EN 15610:2009 (curvature processing). Contact is found at points of the line: the height between
    them is off by at most spacing²/8R, 0.3 µm at 1 mm.
    """
    heights = _complete(profile)
    if not 0.0 < radius < math.inf:
        raise InputError("radius of the circle", radius, "a finite positive length, m")
    depth = min(float(np.ptp(heights)), radius)
    reach = min(math.ceil(math.sqrt(depth * (2.0 * radius - depth)) / profile.spacing), len(heights) - 1)
    across = np.minimum(np.arange(-reach, reach + 1) * profile.spacing, radius)
    circle = np.sqrt(np.maximum(radius**2 - across**2, 0.0)) - radius
    rolled = scipy.ndimage.grey_dilation(heights, structure=circle, mode="constant", cval=-np.inf)
    return replace(profile, heights=rolled)


def _complete(profile: Profile) -> Array:
    if profile.missing_share > 0.0:
        received = f"{profile.missing_share:.2%} missing points"
        raise InputError("measured line", received, "complete heights", "Trim and fill it first.")
    return profile.heights


FEWEST_BANDS = 6
"""Of the limit, that a line resolves: others are no rail's or wheel's."""


@dataclass(frozen=True, eq=False)
class ThirdOctaves:
    """One-third-octave levels of lines, mean power of all, dB re 1 µm, at wavelengths (b,), m, that fall."""

    wavelength: Array
    measured: Array  # levelled, gaps filled
    processed: Array  # after EN 15610: without spikes, rolled over with a circle
    limit: Array  # EN ISO 3095:2013; NaN where it gives none

    @property
    def limited(self) -> NDArray[np.bool_]:
        """Bands for which there is a limit."""
        return np.isfinite(self.limit)


def full_lines(lines: Sequence[Profile]) -> list[Profile]:
    """Lines that a spectrum can be taken of, cut to one length: those of a full length, nearly complete."""
    cut = [trim(line)[0] for line in lines]
    longest = max(len(line.heights) for line in cut)
    whole = [nearly_complete(line) for line in cut if len(line.heights) >= FULL_LINE * longest]
    kept = [line for line in whole if line is not None]
    return [Profile(each, kept[0].spacing) for each in common_length(kept)] if kept else []


def third_octaves(lines: Sequence[Profile]) -> ThirdOctaves | None:
    """Levels of lines measured side by side, or of one, m, and the limit of EN ISO 3095:2013.

    A Hann window lies over each whole line, so that its ends count less. None of lines that resolve fewer
    than six bands of the limit, 400 mm to 3.15 mm. Whether lines have been processed after EN 15610 already
    their file does not say: of those the levels as measured count.
    """
    full = full_lines(lines)
    if not full or 4.0 * full[0].spacing > LIKELY_WAVELENGTHS[1] or full[0].size < LIKELY_WAVELENGTHS[0]:
        return None
    spacing = full[0].spacing
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PhysicsWarning)  # of a spacing beyond 1 mm
        done = [process(line)[0] for line in full]
    found = []
    for each in (full, done):
        together = np.array([line.levelled().heights for line in each]).T
        surface = (
            HeightMap(together, (spacing, spacing)) if len(each) > 1 else Profile(together[:, 0], spacing)
        )
        found.append(band_levels_of(surface))
    wavelength = found[0][0]
    nominal, limits = rail_roughness("iso3095")
    inside = (nominal > LIKELY_WAVELENGTHS[0] / HALF_BAND) & (nominal < LIKELY_WAVELENGTHS[1] * HALF_BAND)
    limit = np.full(wavelength.shape, np.nan)
    for at, level in zip(nominal[inside], limits[inside], strict=True):
        limit[np.abs(np.log10(wavelength / at)) < 0.03] = level
    if np.isfinite(limit).sum() < FEWEST_BANDS:
        return None
    return ThirdOctaves(wavelength, found[0][1], found[1][1], limit)
