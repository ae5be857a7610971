"""Sizes beyond belief: a unit that is wrong by thousands shows in the slopes and in the size of a field."""

import math

import numpy as np

from asperity.arguments import Array
from asperity.errors import InputError, OutOfRangeWarning
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.levelling import level
from asperity.surfaces.readers.hints import Hints, advice, spell
from asperity.written_numbers import rounded

SLOPES, USUAL_SLOPES = (1e-8, 10.0), (1e-6, 2.0)
"""Typical slopes from point to point: refused beyond the first, doubted beyond the second.

Machined and rolled surfaces have rms slopes of 0.01 to 0.5, polished ones from 1e-3 on, and the limit
spectrum of ISO 3095 has 1e-3. A slope of 2 is 63 degrees, more than most optical instruments follow; one of
10 is 84 degrees. An optical flat of a twentieth of a wavelength over 100 mm has some 3e-7; 1e-8 are 10 nm
over a metre, as the best straightedges have.
"""
MOST_TOLD = 1e99
"""Height, m, or slope as which any larger one is told."""
FIELDS, USUAL_FIELDS = 10.0, 1.0
"""Lesser side of a map, m: fields of microscopes are below 10 mm, stitched ones below some 0.3 m."""
SPACINGS = (1e-11, 1.0)
"""Distance of points, m: atoms are 1e-10 m apart, and roughness is shorter than a metre."""
USUAL = 0.03
"""Slope in the middle of usual ones, to which the units that were exchanged by thousands would come."""
ROUGHEST = 50e-6
"""Rms height of a map about a smooth form, m, beyond which nothing rolls: machined and worn surfaces have up
to some 10 µm, castings 50 µm. Slopes tell no unit that is wrong for heights and places alike; this does."""
JAGGED = 0.3
"""Least typical bend from point to point, over the typical step, of a line that is rough: sections of bodies
and long waves bend by less."""
FIRST_POINTS = 2**14
"""Points of a line by which that is told."""
SMALLEST = 5e-6
"""Longest side of a map or line, m, below which microscopes of atomic force measure; nothing rolls. Slopes
tell no unit that is wrong for heights and places alike; this does."""
SIDE = 200
"""Points along either side of a map whose rms height is taken."""
MOST_POINTS = 2**20
"""Points of which slopes are taken."""
APART = 300.0
"""Least distance of a height from all others, in their spread, that marks a missing point, or is wrong."""
APART_OF_MARKS = 10.0
"""The same where its digits are those of a mark."""
MARKS = {"0.00000", "9.99000", "9.99900", "9.99990", "9.99999", "3.27680", "3.27670", "6.55350", "6.55040",
         "2.14748", "4.29497"}  # fmt: skip
"""Digits of 0, -999, 9999 and of the ends of 16 and 32 bits, which files of heights are filled with."""
FEWEST_POINTS = 30
"""Points whose slopes prove nothing."""
_NORMAL = 1.4826
"""Standard deviation over the median size of normally distributed numbers."""
_UNITS = {1.0: "m", 1e-3: "mm", 1e-6: "um", 1e-9: "nm"}
_TIMES = {1e-9: "billion times", 1e-6: "million times", 1e-3: "thousand times",
          1e3: "thousandth of", 1e6: "millionth of", 1e9: "billionth of"}  # fmt: skip
"""What is said of a unit that is so many times smaller than another."""
LEAST_LIKELY = 1e-4
"""Slope from which on units that were exchanged are likely: that of smooth rails."""


def typical_slope(surface: HeightMap | Profile) -> float | None:
    """Slope from point to point as most points have it; None of a plane.

    Of a map it is that in the direction where it is less. The median of the sizes tells it, of those that are
    not zero: spikes do not count, nor do heights that are rounded.
    """
    along = [
        _slope_along(surface.heights, surface.spacing if isinstance(surface, Profile) else surface.spacing[0])
    ]
    if isinstance(surface, HeightMap):
        along.append(_slope_along(surface.heights.T, surface.spacing[1]))
    found = [slope for slope in along if slope]
    return min(found) if found else None


def _slope_along(heights: Array, spacing: float) -> float:
    """Typical slope along the first axis; zero where all neighbours are alike, or none has a height."""
    columns = heights.reshape(len(heights), -1)
    columns = columns[:, :: max(1, math.ceil(columns.size / MOST_POINTS))]
    with np.errstate(over="ignore"):
        steps = np.abs(np.diff(columns[: 2 * MOST_POINTS], axis=0))
    steps = steps[steps > 0.0]
    return min(_NORMAL * float(np.median(steps)) / spacing, MOST_TOLD) if steps.size else 0.0


def _over_its_width(section: HeightMap | Profile) -> float | None:
    """Height of a section of a body over its width: a cylinder is level, and the flange beside it steep."""
    sample = _sample(section.heights)
    return float(np.ptp(sample)) / float(np.max(section.size)) or None if sample.size else None


def judge_sizes(surface: HeightMap | Profile, hints: Hints) -> None:
    """Refuse a surface whose sizes are beyond belief, with the likely cause, and warn of unusual ones."""
    what = surface.source or "surface"
    spacing = float(np.max(surface.spacing))
    if surface.heights.size >= FEWEST_POINTS and (told := _far_from_others(surface.heights)):
        OutOfRangeWarning.warn(f"{what}: {told}")
    slope = None
    if surface.heights.size >= FEWEST_POINTS:
        slope = _over_its_width(surface) if hints.section else typical_slope(surface)
    places = _of_places(spacing, _thousands(slope or 0.0))
    if not SPACINGS[0] <= float(np.min(surface.spacing)) <= spacing <= SPACINGS[1]:
        allowed = f"distances of {SPACINGS[0] * 1e9:g} nm to {SPACINGS[1]:g} m"
        raise InputError(what, f"points {told_length(spacing)} apart", allowed, places)
    field = float(np.min(surface.size)) if isinstance(surface, HeightMap) else 0.0
    if field > FIELDS:
        received = f"a map whose lesser side is {told_length(field)}"
        raise InputError(what, received, f"maps of at most {FIELDS:g} m", places)
    if field > USUAL_FIELDS:
        OutOfRangeWarning.warn(f"{what}: a map of {told_length(field)} and more. {places}")
    if slope is None:
        return
    found = f"heights of {told_length(_rms(surface))} over {_extent(surface)}: slopes of {rounded(slope, 2)}"
    steep = slope > USUAL_SLOPES[1]
    factor = _thousands(slope)
    heights = _of_heights(surface, factor if steep else 1.0 / factor, hints)
    remedy = heights if steep else f"{places} {heights}"
    if not SLOPES[0] <= slope <= SLOPES[1]:
        allowed = f"slopes of {rounded(SLOPES[0])} to {rounded(SLOPES[1])} from point to point"
        raise InputError(what, found, allowed, remedy)
    if not USUAL_SLOPES[0] <= slope <= USUAL_SLOPES[1]:
        usual = f"up to {rounded(USUAL_SLOPES[1])}" if steep else f"from {rounded(USUAL_SLOPES[0])} on"
        OutOfRangeWarning.warn(f"{what}: {found}, usual are {usual}. {remedy}")
    elif isinstance(surface, Profile):
        _doubt_line(surface, what)
    elif 0.0 < field <= USUAL_FIELDS and not surface.holds_lines:
        _doubt_roughness(surface, what)


def doubt_depth(source: str, name: str) -> None:
    """Warn of heights that bear the name of depths, whose sign may be the other."""
    OutOfRangeWarning.warn(
        f"{source}: {name[:60]!r} is taken for heights, positive out of the material. If it counts into the "
        "material, change its sign in the file."
    )


def _doubt_roughness(surface: HeightMap, what: str) -> None:
    """Warn of a map that is rougher than what rolls, with what it is in units of a thousandth."""
    rough = _about_form(surface)
    if rough > ROUGHEST:
        OutOfRangeWarning.warn(f"{what}: {_two_readings(surface, rough)}")


def _doubt_line(line: Profile, what: str) -> None:
    """Warn of a line that is jagged, and rougher than what rolls; sections and long waves are smooth."""
    steps = np.diff(line.heights[:FIRST_POINTS])
    step, bend = (_typical(each[np.isfinite(each)]) for each in (steps, np.diff(steps)))
    if bend > max(ROUGHEST, JAGGED * step):
        some = line.heights[:: max(1, math.ceil(line.heights.size / FIRST_POINTS))]
        beside = HeightMap(np.stack([some, some], axis=1), (line.spacing, line.spacing))
        OutOfRangeWarning.warn(f"{what}: {_two_readings(line, _about_form(beside))}")


def _typical(differences: Array) -> float:
    """Typical size of differences: the rms of normal ones; 0 of none."""
    return _NORMAL * float(np.median(np.abs(differences))) if differences.size else 0.0


def _about_form(surface: HeightMap) -> float:
    """Typical height, m, of points of a map about the paraboloid of least squares: the rms of normal ones.

    Pits do not count, whatever their depth, where they take less than half of it.
    """
    strides = [math.ceil(n / SIDE) for n in surface.shape]
    some = surface.heights[:: strides[0], :: strides[1]]
    if np.isfinite(some).sum() < FEWEST_POINTS or min(some.shape) < 2:
        return 0.0
    about = level(HeightMap(some, surface.spacing), "quadratic").heights
    return _NORMAL * float(np.nanmedian(np.abs(about - np.nanmedian(about))))


def larger_reading(surface: HeightMap | Profile) -> str:
    """Say what a tiny map or line is in units a thousand times larger; empty for those of usual sizes."""
    if float(np.max(surface.size)) >= SMALLEST:
        return ""
    rms = told_length(1e3 * _rms(surface))
    sides = 1e3 * np.atleast_1d(surface.size)
    return (
        f"If all of its lengths are a thousand times too small, it has heights of {rms} over "
        f"{' × '.join(map(told_length, sides))}: then correct both units, {spell('height_unit')} and "
        f"{spell('pixel')}."
    )


def _two_readings(surface: HeightMap | Profile, rough: float) -> str:
    """Say what a surface is in the units that it is taken in, and in others a thousandth or less of them."""
    times, smaller = ("thousand", 1e-3) if rough <= ROUGHEST * 1e3 else ("million", 1e-6)
    sides = np.atleast_1d(surface.size)
    now, less = (
        f"{told_length(unit * rough)} about a smooth form over "
        f"{' × '.join(told_length(unit * side) for side in sides)}"
        for unit in (1.0, smaller)
    )
    pixel = told_length(smaller * float(np.min(surface.spacing)))
    given = f"{spell('height_unit')} and {spell('pixel')}"
    return (
        f"heights of {now}, rougher than what rolls (castings have {told_length(ROUGHEST)}). If all of "
        f"its lengths are a {times} times too large, it is {less}, points {pixel} apart: then correct both "
        f"units, {given}."
    )


def _sample(heights: Array) -> Array:
    """Heights of `MOST_POINTS` points, evenly spread over all, that have one."""
    flat = heights.reshape(-1)
    sample = flat[:: max(1, math.ceil(flat.size / MOST_POINTS))]
    return sample[np.isfinite(sample)]


def _rms(surface: HeightMap | Profile) -> float:
    sample = _sample(surface.heights)
    with np.errstate(over="ignore"):
        return min(float(sample.std()), MOST_TOLD) if sample.size else 0.0


def _far_from_others(heights: Array) -> str:
    """Say which single height, of one point or many, is far from all others; empty without one."""
    flat = heights.reshape(-1)
    sample = _sample(heights)
    middle = float(np.median(sample)) if sample.size else 0.0
    spread = _NORMAL * float(np.median(np.abs(sample - middle))) if sample.size else 0.0
    for end in (float(np.fmin.reduce(flat)), float(np.fmax.reduce(flat))) if spread else ():
        if abs(end - middle) <= (APART_OF_MARKS if _is_mark(end) else APART) * spread:
            continue
        half = 0.5 * (end + middle)
        far = flat[flat > half if end > middle else flat < half]
        if (far == end).all():
            points = "a point has" if far.size == 1 else f"{far.size} points have"
            received = f"{points} the height {told_length(end)}, where others spread by {told_length(spread)}"
            return f"{received}. If it marks what is missing, write NaN there."
    return ""


def _is_mark(height: float) -> bool:
    """Whether a height, m, is by its digits one that files are filled with, in any unit by tens."""
    return f"{abs(height):.5e}".partition("e")[0] in MARKS


def _thousands(slope: float) -> float:
    """Ratio of units, 1e3, 1e6 or 1e9, by which a slope comes to usual ones: near `USUAL` from above."""
    if not slope:
        return 1e6
    steps = (
        round(math.log10(slope / USUAL) / 3.0) if slope > USUAL else math.log10(LEAST_LIKELY / slope) / 3.0
    )
    return float(1e3 ** int(np.clip(math.ceil(steps), 1, 3)))


def _of_heights(surface: HeightMap | Profile, factor: float, hints: Hints) -> str:
    """Ask whether heights were smaller by a factor; of a unit that a file states its name is not known."""
    given = hints.height_unit
    while given and factor > 1e3 and given / factor < 0.9 * min(_UNITS):
        factor /= 1e3
    usual = told_length(_rms(surface) / factor)
    unit = _UNITS.get(float(f"{given / factor:.3g}")) if given else None
    if unit is None:
        return (
            f"Were heights {usual}? Then their unit is a {_TIMES[factor]} the one that is taken: correct it "
            f"in the file, or give {spell('height_unit')}."
        )
    lead = f"Were they in {unit.replace('u', 'µ')}, {usual}? Give"
    return advice("height_unit", unit, lead, f"Were they {usual}? Correct their unit.")


def _of_places(spacing: float, factor: float) -> str:
    usual = told_length(spacing / factor)
    given = spell("pixel", told_length(spacing / factor, 6).replace("µ", "u"))
    return f"Are points {usual} apart? Give {given}, or correct the unit of places."


def told_length(metres: float, digits: int = 3) -> str:
    """Length with some digits in the unit that suits it: ``"0.25 µm"``."""
    unit, name = next((each for each in _NAMED if abs(metres) >= 0.1 * each[0]), _NAMED[-1 if metres else 1])
    return f"{metres / unit:.{digits}g} {name}"


_NAMED = ((1e3, "km"), (1.0, "m"), (1e-3, "mm"), (1e-6, "µm"), (1e-9, "nm"), (1e-12, "pm"))


def _extent(surface: HeightMap | Profile) -> str:
    if isinstance(surface, Profile):
        return f"a line of {told_length(surface.size)}"
    return f"a field of {' × '.join(told_length(side) for side in surface.size)}"
