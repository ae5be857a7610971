"""Measured roughness lines: EN 15610:2009, third octaves, and lines side by side as a strip.

Later editions of the standard have not been compared.
"""

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain, pairwise

import numpy as np
import scipy
from scipy import fft

from asperity.arguments import Array, Flags, Indices, require
from asperity.errors import CoarseSamplingWarning
from asperity.reference.cnossos import rail_roughness
from asperity.spectra import band_levels, in_bands, psd
from asperity.surfaces.bands import LIKELY_WAVELENGTHS, MICROMETRE, likely_band
from asperity.surfaces.cleaning import nearly_complete
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.levelling import own, without_polynomial
from asperity.written_numbers import count_of, rounded

ROLLED_RADIUS = 0.375
"""Radius of the circle that is rolled over a line, m."""
SPIKE_CURVATURE = -10.0
"""Second derivative below which a point may be a spike, 1/m (-10^7 µm/m²)."""
SPIKE_SCALE = 3.0
"""A spike is higher than its width squared over this, m; 8 · 0.375 m: the circle does not fit it."""
TOGETHER = 2**17
"""Points that a circle is rolled over at a time, at least, and feet between which spikes are sought."""
COARSEST_SPACING = 1e-3
"""m."""
FEWEST_BANDS = 6
"""Of the limit, that a line resolves: others are no rail's or wheel's."""
FULL_LINE = 0.95
"""Share of the longest line from which a line counts as a full turn."""
NEAR = 0.01
"""Share of a turn by which the starts of neighbouring lines differ, unless others fit `CLEARLY` better."""
CLEARLY = 0.2
"""Gain in correlation that speaks for a start farther away."""


def process(
    lines: Sequence[Profile], steps: Collection[str] = ("spikes", "curvature")
) -> tuple[list[Profile], str]:
    """Process measured lines, m: trim, fill, remove spikes, roll a circle over them; and tell what was done.

    Missing points at the ends are cut off, those inside filled by straight lines, where "fill" is among the
    steps, or refused. Warned of are a spacing beyond 1 mm and more than 5 % filled points. Pits narrower than
    the patch that the circle bridges are no longer in the line: a contact filter or a contact geometry
    applied after it counts that effect twice in part. Leave "curvature" out for laws that solve the contact
    on the heights themselves.
    """
    done = []
    lifted = []
    highest = []
    trimmed = 0
    filled = 0
    removed = 0
    changed = 0
    for profile in lines:
        if profile.spacing > COARSEST_SPACING * (1.0 + 1e-6):
            coarse = f"spacing {rounded(profile.spacing * 1e3)} mm, more than the 1 mm of EN 15610"
            remedy = (
                "spikes and short waves are not resolved; measure more finely or leave the processing out"
            )
            CoarseSamplingWarning.warn(f"{coarse}: {remedy}")
        line = trim(profile)
        missing = int(np.isnan(line.heights).sum())
        received = f"{missing} missing points inside {line.source or 'the line'}"
        remedy = "Fill them, or cut a piece without."
        require("fill" in steps or not missing, "measured line", received, "a line without gaps", remedy)
        trimmed = trimmed + len(profile.heights) - len(line.heights)
        filled = filled + missing
        line = line.filled()
        if "spikes" in steps:
            line, spikes, points = remove_spikes(line)
            removed = removed + spikes
            changed = changed + points
        done.append(roll_over(line) if "curvature" in steps else line)
        share, most = _lift(done[-1].heights, line.heights)
        lifted.append(share)
        highest.append(most)
    rolled = f"rolled over with a circle of {ROLLED_RADIUS:g} m: {np.mean(lifted):.1%} of the points lifted"
    words = (
        f"{trimmed} missing points trimmed at the ends",
        f"{count_of(filled, 'point')} filled" if "fill" in steps else "gaps not filled",
        f"{count_of(removed, 'spike')} ({count_of(changed, 'point')}) removed"
        if "spikes" in steps
        else "spikes kept",
        f"{rolled}, by up to {rounded(max(highest) * 1e6)} µm" if "curvature" in steps else "not rolled over",
    )
    return done, "EN 15610:2009: " + "; ".join(words)


def _lift(rolled: Array, heights: Array) -> tuple[float, float]:
    """Share of the points that a circle lifted, and by how much at most, m."""
    pieces = [slice(first, first + TOGETHER) for first in range(0, len(heights), TOGETHER)]
    lifts = (rolled[piece] - heights[piece] for piece in pieces)
    lifted, most = zip(*((np.count_nonzero(lift > 1e-12), lift.max()) for lift in lifts), strict=True)
    return sum(lifted) / len(heights), float(max(most))


def trim(profile: Profile) -> Profile:
    """Cut missing points off both ends."""
    known = np.isfinite(profile.heights)
    first = int(np.argmax(known))
    stop = len(known) - int(np.argmax(known[::-1]))
    return replace(profile, heights=profile.heights[first:stop], start=None)


def remove_spikes(profile: Profile) -> tuple[Profile, int, int]:
    """Remove narrow upward spikes, as dust and grains leave them; and tell how many, and of how many points.

    A spike holds a point with a second derivative below -10⁷ µm/m², ends at the nearest feet on either side
    (where a positive second derivative is largest) and is higher above the straight line between its feet
    than w²/3 m, w their distance. It is replaced by that line. One pass; the ends of the record count as
    feet. EN 15610:2009 (spike removal): curvature and height are the standard's; the feet are our reading of
    where a spike ends.
    """
    cut = profile.heights.copy()
    removed, changed = _cut_spikes(cut, profile.spacing)
    cut.flags.writeable = False  # it need not be copied
    return replace(profile, heights=cut), removed, changed


def _sharp_and_feet(heights: Array, spacing: float) -> tuple[Flags, Flags]:
    """Where a line (n,) bends as sharply as a spike, and where spikes may end, but for its own ends."""
    sharp, foot = np.zeros((2, len(heights)), dtype=bool)
    bend = np.diff(heights, 2)
    sharp[1:-1] = bend < SPIKE_CURVATURE * spacing**2
    highest = bend > 0.0
    highest[1:] &= bend[1:] >= bend[:-1]
    highest[:-1] &= bend[:-1] >= bend[1:]
    foot[1:-1] = highest
    return sharp, foot


def _cut_spikes(heights: Array, spacing: float) -> tuple[int, int]:
    """Cut the spikes off a line (n,), m, in place; return how many, and of how many points.

    Piece by piece, each from a foot to the last one in it; the ends of the line are feet.
    """
    count = len(heights)
    removed = 0
    changed = 0
    first = 0
    size = TOGETHER
    before = heights[:0]
    while first < count - 1:
        stop = min(first + size, count)
        seen = np.append(before, heights[first : stop + 2])
        sharp, foot = (each[len(before) :][: stop - first] for each in _sharp_and_feet(seen, spacing))
        foot[0] = True
        foot[-1] |= stop == count
        feet = np.flatnonzero(foot)
        last = int(feet[-1])
        size = TOGETHER if last else 2 * size
        if not last:
            continue
        before = heights[first + last - 1 : first + last].copy()  # as it was, for the next piece
        spikes, points = _cut_between(heights[first : first + last + 1], sharp, feet, spacing)
        removed += spikes
        changed += points
        first += last
    return removed, changed


def _cut_between(heights: Array, sharp: Flags, feet: Indices, spacing: float) -> tuple[int, int]:
    """Cut the spikes off a piece of a line between its feet, in place; return how many, and of how many
    points."""
    points = np.diff(feet)
    begins = feet[:-1]
    spikes = np.logical_or.reduceat(sharp[: feet[-1]], begins)
    if not spikes.any():
        return 0, 0
    chord = np.interp(np.arange(feet[-1]), feet, heights[feet])
    rise = np.maximum.reduceat(heights[:-1] - chord, begins)
    spikes &= rise > (points * spacing) ** 2 / SPIKE_SCALE
    within = np.repeat(spikes, points)
    heights[:-1][within] = chord[within]
    return int(spikes.sum()), int((points[spikes] - 1).sum())


def roll_over(profile: Profile, radius: float = ROLLED_RADIUS) -> Profile:
    """Path of a circle's lowest point as it rolls over a complete line, m, nowhere below it.

    max over s of z(s) - R + √(R² - (s - x)²) at the points s of the line; at the ends only the line itself
    carries. EN 15610:2009 (curvature processing). Contact is found at points of the line: the height between
    them is off by at most spacing²/8R, 0.3 µm at 1 mm.
    """
    rolled = profile.heights.copy()
    _lift_to_circle(rolled, profile.spacing, radius)
    rolled.flags.writeable = False  # it need not be copied
    return replace(profile, heights=rolled)


def _lift_to_circle(heights: Array, spacing: float, radius: float) -> None:
    """Roll a circle over a line (n,), m, in place."""
    count = len(heights)
    depth = min(float(np.ptp(heights)), radius)
    touched = math.ceil(math.sqrt(depth * (2.0 * radius - depth)) / spacing)
    reach = min(touched, math.floor(radius / spacing), count - 1)
    across = np.arange(reach + 1) * spacing
    circle = np.sqrt(np.maximum(radius**2 - across**2, 0.0)) - radius
    step = max(TOGETHER, 2 * reach)
    before = heights[:0]
    for first in range(0, count, step):
        envelope = _upper_envelope(np.append(before, heights[first : first + step + reach]), circle)
        skipped = len(before)
        before = heights[first + step - reach : first + step].copy()  # as they were, for the next piece
        heights[first : first + step] = envelope[skipped:][:step]


def _upper_envelope(heights: Array, arc: Array) -> Array:
    """Highest of arcs of one shape that lie on heights (n,), each (k,) from its top on to either side.

    Two of them cross once at most, the left one being above on the left: the point whose arc is the highest
    moves on with the place. Places are halved between those that are known, and of each no points count but
    those between the points of its neighbours.
    """
    count = len(heights)
    reach = len(arc) - 1
    envelope = np.empty(count)
    highest = np.zeros(count, dtype=np.int64)
    distances = (1 << n for n in reversed(range((count - 1).bit_length())))
    halved = ((distance, np.arange(distance, count, 2 * distance)) for distance in distances)
    for distance, places in chain([(count, np.zeros(1, dtype=np.int64))], halved):
        low = np.where(places < distance, 0, highest[places - distance])
        behind = np.minimum(places + distance, count - 1)
        high = np.where(places + distance < count, highest[behind], count - 1)
        low = np.maximum(low, places - reach)
        high = np.minimum(high, places + reach)
        sizes = np.maximum(high - low, 0) + 1
        starts = np.cumsum(sizes) - sizes
        points = np.arange(sizes.sum()) + np.repeat(low - starts, sizes)
        values = heights[points] + arc[np.abs(points - np.repeat(places, sizes))]
        envelope[places] = np.maximum.reduceat(values, starts)
        tops = np.flatnonzero(values == np.repeat(envelope[places], sizes))
        highest[places] = points[tops[np.searchsorted(tops, starts)]]
    return envelope


@dataclass(frozen=True, eq=False)
class ThirdOctaves:
    """One-third-octave levels of lines, mean power of all, dB re 1 µm, at wavelengths (b,), m, that fall."""

    wavelength: Array
    measured: Array  # levelled, gaps filled
    processed: Array  # after EN 15610: without spikes, rolled over with a circle
    limit: Array  # EN ISO 3095:2013; NaN where it gives none

    @property
    def limited(self) -> Flags:
        """Bands for which there is a limit."""
        return np.isfinite(self.limit)


def full_lines(lines: Sequence[Profile]) -> list[Profile]:
    """Lines that a spectrum can be taken of, cut to one length: those of a full length, nearly complete."""
    cut = [trim(line) for line in lines]
    longest = max(len(line.heights) for line in cut)
    whole = [nearly_complete(line) for line in cut if len(line.heights) >= FULL_LINE * longest]
    complete = [line for line in whole if line is not None]
    shortest = min((len(line.heights) for line in complete), default=0)
    return [Profile(line.heights[:shortest], complete[0].spacing) for line in complete]


def third_octaves(lines: Sequence[Profile], *, overwrite: bool = False) -> ThirdOctaves | None:
    """Levels of lines measured side by side, or of one, m, and the limit of EN ISO 3095:2013.

    A Hann window lies over each whole line, so that its ends count less. None of lines that resolve fewer
    than six bands of the limit, 400 mm to 3.15 mm. Whether lines have been processed after EN 15610 already
    their file does not say: of those the levels as measured count. Heights of levelled lines that nobody
    needs any more may be overwritten.
    """
    full = full_lines(lines)
    if not full or 4.0 * full[0].spacing > LIKELY_WAVELENGTHS[1] or full[0].size < LIKELY_WAVELENGTHS[0]:
        return None
    whole = overwrite and all(each.shape == full[0].shape and not each.missing_share for each in lines)
    sums: list[Array | float] = [0.0, 0.0]
    for line in full:
        heights = own(line.heights) if overwrite else line.heights.copy()
        for step, processed in enumerate(_before_and_after(heights, line.spacing, levelled=whole)):
            wavenumber = density = np.zeros(0)  # not held beside the next ones, as below
            wavenumber, density = psd(processed, line.spacing)
            sums[step] = sums[step] + density
        del heights, processed
    centres, before = band_levels(wavenumber, sums[0] / len(full), MICROMETRE)
    _, after = band_levels(wavenumber, sums[1] / len(full), MICROMETRE)
    wavelength = 1.0 / centres
    nominal, limits = rail_roughness("iso3095")
    nominal, limits = nominal[likely_band(nominal)], limits[likely_band(nominal)]
    limit = in_bands(wavelength, nominal, limits)
    few = np.isfinite(limit).sum() < FEWEST_BANDS
    return None if few else ThirdOctaves(wavelength, before, after, limit)


def _before_and_after(heights: Array, spacing: float, *, levelled: bool) -> Iterator[Array]:
    """Heights of a complete line, levelled; then, as they were, without spikes, rolled over and levelled.

    Held once, however long.
    """
    if levelled:
        yield heights
    else:
        ends = [0, len(heights) - 1]
        tilt = heights[ends]
        yield without_polynomial(heights, 1, into=heights)
        tilt = tilt - heights[ends]
        heights = own(heights)
        for first in range(0, len(heights), TOGETHER):
            piece = heights[first : first + TOGETHER]
            piece += np.interp(np.arange(first, first + len(piece)), ends, tilt)
    _cut_spikes(heights, spacing)
    _lift_to_circle(heights, spacing, ROLLED_RADIUS)
    yield without_polynomial(heights, 1, into=heights)


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


def bring_into_register(profiles: Sequence[Profile]) -> Register:
    """Turn and shift the complete, parallel lines of a wheel so that neighbours agree.

    Lines are often measured to and fro, each starting anew. Every line but the first is tried in both
    directions, and at all shifts around the wheel, against the line before it; the highest correlation wins.
    Starts within 1 % of a turn are preferred, since long waves also agree elsewhere: one farther away must
    raise the correlation by 0.2.
    """
    lines = common_length(profiles)
    aligned = [lines[0]]
    turned = [False]
    shifts = [0]
    for line in lines[1:]:
        backwards, shift = _best_match(aligned[-1], line)
        aligned.append(np.roll(line[::-1] if backwards else line, shift))
        turned.append(backwards)
        shifts.append(shift)
    correlations = (1.0, *(_correlation(one, other) for one, other in pairwise(aligned)))
    return Register(np.array(aligned), tuple(turned), tuple(shifts), correlations)


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
    n = min(len(p.heights) for p in profiles)
    return np.array([p.heights[:n] for p in profiles])


def strip_from_lines(lines: Array, distance_across: float, shape_y: int, spacing_y: float) -> Array:
    """Strip (n, shape_y) through complete parallel lines (k, n), heights and distances in m.

    The points across are centred on the lines. Across, one line is constant, two and three are joined by
    straight lines, four and more by a cubic spline; beyond the outer lines their heights hold. Between lines
    that have little in common the interpolated texture is smoother than a measured one: its mean square falls
    to about half, midway between uncorrelated lines.
    """
    count = len(lines)
    if count == 1:
        return np.repeat(lines.T, shape_y, axis=1)
    at = (np.arange(count) - 0.5 * (count - 1)) * distance_across
    wanted = np.clip((np.arange(shape_y) - 0.5 * (shape_y - 1)) * spacing_y, at[0], at[-1])
    spline = scipy.interpolate.make_interp_spline(at, lines, k=1 if count < 4 else 3)
    return np.ascontiguousarray(spline(wanted).T)
