"""Where the sections of what rolls and of what is rolled over touch, across the path."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy

from asperity.arguments import Array, ArrayLike, Flags, require
from asperity.case.sideways import INCLINATIONS
from asperity.errors import InputError, PhysicsWarning
from asperity.structures.outline import HIGHEST_FLANGE
from asperity.surfaces.heightmap import Profile
from asperity.surfaces.levelling import level
from asperity.surfaces.readers import hints, read_across
from asperity.surfaces.readers.belief import told_length
from asperity.written_numbers import count_of, rounded

if TYPE_CHECKING:
    from asperity.case.rolling_case import RollingCase
    from asperity.contact.hertz import Hertz

REACH = 0.1
"""Farthest place of a section that is not measured, but a circle, m."""
SHARE = 0.9
"""And farthest over its radius."""
FEWEST = 4
"""Points of a section."""
POINTS = 2001
"""Of a circle, and of the gap, among which the lowest is looked for."""
WIDEST, NARROWEST = 1.0, 2e-3
"""Widths of sections, m: wheels and rails are 60 to 150 mm wide, and their contact some 10 mm."""
OF_TRAINS = ("wheel.profile", "track.rail_profile")
"""Keys of sections that are those of wheels and rails."""
FLANGE = 10e-3
"""Least height over the rest of a tread that is a flange's, m: they are 25 mm high, chamfers 5 mm."""
FLANGE_PLACES = (-90e-3, -30e-3)
"""Where the top of a flange lies from the running circle, m: its back is 70 mm off, its top some 55 mm."""
RISING = 0.01
"""Slope to the field side from which on a tread without a flange is doubted: treads fall, by 1:40 say."""
FIELD_SIDE = (30e-3, 50e-3)
"""Places on the field side of a tread, m: beyond its curved part, short of its chamfer."""
STEEP = (0.11, 0.3)
"""Slopes there that may be those of diameters: treads fall by 1:40 to 1:15, worn ones by little more."""
FALLEN = 5e-3
"""Depth below its top at which the middle of a rail's head is sought, m."""
OFF = 10e-3
"""How far that middle may lie from where places begin, m."""
WIDEST_HEAD = 80e-3
"""Widest head of a rail, m: they are 56 to 76 mm wide."""
TREAD = 25e-3
"""Half the width of a tread about its running circle, m, which no flange reaches."""
HOLLOW = 2e-3
"""By how much more a rail lies above its middle than below it, m, where it is upside down."""
COMPARED = 200
"""Points of a section whose slopes are compared pair by pair."""
PRINTED = (1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5, 5e-6, 2e-6, 1e-6)
"""Steps of heights, m, that tables are printed in."""
UNCERTAIN = 0.5
"""Share of the radius of a contact from which on it is told that printed heights leave it uncertain."""
SETTLED = 10
"""Times that the parabola of a gap is fitted to the width of the contact that follows."""


def read_section(measured: Path | Profile, key: str) -> Profile:
    """Read a measured section of a body across the path.

    Parameters
    ----------
    measured : Path or Profile
        Its file, or itself.
    key : str
        The key that names it, for messages.

    Returns
    -------
    Profile
        Heights, complete.

    Raises
    ------
    InputError
        If the file does not hold one complete line.
    """
    with hints.spelled(hints.in_case(key.partition(".")[0], {})):
        section = read_across(measured) if isinstance(measured, Path) else measured
    if not isinstance(section, Profile):
        raise InputError(key, "a map of heights", "one line across the path")
    count = len(section.heights)
    require(count >= FEWEST, key, count_of(count, "point"), f"at least {FEWEST}", "Measure more of them.")
    _refuse_beyond_belief(section, key)
    return complete(section, key)


def _refuse_beyond_belief(section: Profile, key: str) -> None:
    """Refuse a section wider than any, or one of wheel or rail that is narrower than their contact."""
    least = NARROWEST if key in OF_TRAINS else 0.0
    wide = f"{rounded(section.size)} m" if section.size > WIDEST else told_length(section.size)
    received = f"a section {wide} wide"
    allowed = f"sections up to {WIDEST:g} m wide, of wheel and rail from {told_length(NARROWEST)} on"
    remedy = "Are its places in mm? Write that into the heading, as 'y (mm); z (mm)'."
    require(least <= section.size <= WIDEST, key, received, allowed, remedy)


def complete(line: Profile, key: str) -> Profile:
    """The line that a key names, refused where a point has no height."""
    remedy = "Interpolate them in the file."
    require(line.missing_share == 0.0, key, "points without a height", "a complete line", remedy)
    return line


# --- which way up, and which way round


def _away_from_rest(y: Array, z: Array) -> Array:
    """Heights (n,), m, from the line that half of a section may leave (repeated medians, Siegel 1982)."""
    some = np.unique(np.linspace(0, len(y) - 1, min(len(y), COMPARED)).astype(int))
    others = ~np.eye(len(some), dtype=bool)
    across, up = (np.subtract.outer(each[some], each[some])[others] for each in (y, z))
    slope = float(np.median(np.median((up / across).reshape(len(some), -1), axis=1)))
    return z - slope * y - np.median(z[some] - slope * y[some])


def flange_of(y: Array, z: Array) -> tuple[int, int]:
    """Which way a flange stands out of a section, 1 or -1, and on which side, -1, 1, or 0 on both; else 0, 0.

    By places (n,) and heights (n,), m. Bodies that fall on both sides have none.
    """
    away = _away_from_rest(y, z)
    farthest = int(np.argmax(np.abs(away)))
    if abs(away[farthest]) < FLANGE:
        return 0, 0
    way = 1 if away[farthest] > 0.0 else -1
    side = 1 if y[farthest] > 0.5 * (y[0] + y[-1]) else -1
    other = side * (y - 0.5 * (y[0] + y[-1])) < 0.0
    alike = float((way * away[other]).max()) > 0.5 * abs(away[farthest])
    if alike:
        return (1, 0) if way > 0 else (0, 0)
    return way, side


def _is_head_down(y: Array, z: Array) -> bool:
    """Whether a rail's section lies above its middle, or above that of what was measured, not below."""
    away = _away_from_rest(y, z)
    middle = 0.0 if y[0] < 0.0 < y[-1] else 0.5 * (y[0] + y[-1])
    at_middle = float(np.interp(middle, y, away))
    return bool((away.max() - at_middle) - (at_middle - away.min()) > HOLLOW)


def _refuse_strange_flange(key: str, section: Profile, y: Array, side: int) -> None:
    """Refuse a tread whose flange is on the field side, too high, or away from where flanges are."""
    z = section.heights
    top = float(y[np.argmax(z)])
    height = float(_away_from_rest(y, z).max())
    if section.start is not None and y[0] < 0.0 < y[-1]:
        height = float(z.max() - np.interp(0.0, y, z))
    received = f"a flange at {rounded(1e3 * top)} mm, on the field side"
    allowed = "places positive to the field side: a flange is on the side of negative ones"
    remedy = "Change the sign of its places, and of those of the rail if both count the same way."
    require(side <= 0, key, received, allowed, remedy)
    received = f"a flange {rounded(1e3 * height)} mm high"
    most = rounded(1e3 * HIGHEST_FLANGE)
    remedy = "Are its heights diameters? Halve them. Else check their unit."
    require(height <= HIGHEST_FLANGE, key, received, f"flanges of up to {most} mm", remedy)
    low, high = FLANGE_PLACES
    received = f"the top of a flange at {rounded(1e3 * top)} mm"
    allowed = f"{rounded(1e3 * low)} to {rounded(1e3 * high)} mm, as places count from the running circle"
    remedy = "Do they count from the back of the flange? Subtract 70 mm from them."
    require(section.start is None or low <= top <= high, key, received, allowed, remedy)


def _slope(y: Array, z: Array, here: Flags) -> float:
    """Slope of a section at some of its points (n,), m; 0 where it has fewer than two."""
    return float(np.polynomial.polynomial.polyfit(y[here], z[here], 1)[1]) if here.sum() > 1 else 0.0


def _doubts_of_tread(key: str, y: Array, z: Array) -> Iterator[str]:
    """Say where a tread without a flange falls to the wrong side, or too steeply, by its points (n,), m."""
    slope = _slope(y, z, np.abs(y) <= TREAD)
    outside = _slope(y, z, (y >= FIELD_SIDE[0]) & (y <= FIELD_SIDE[1]))
    if STEEP[0] < -outside < STEEP[1]:
        yield (
            f"{key}: the field side of the tread falls by 1:{rounded(-1.0 / outside, 2)}, where treads fall "
            "by 1:40 to 1:15. Are its heights diameters? Halve them."
        )
    if slope > RISING:
        yield (
            f"{key}: the tread rises to the field side by 1:{rounded(1.0 / slope, 2)}, where treads fall. Is "
            "it upside down, or are its places mirrored?"
        )


def _doubts_of_head(key: str, y: Array, z: Array) -> Iterator[str]:
    """Say where a rail's head that falls to both sides has not its middle where its places begin."""
    top = int(np.argmax(z))
    low = float(z.max()) - FALLEN
    left = np.flatnonzero(z[:top] < low)
    right = np.flatnonzero(z[top:] < low)
    if left.size and right.size:
        middle = 0.5 * float(y[left[-1]] + y[top + right[0]])
        if abs(middle) > OFF:
            yield (
                f"{key}: the middle of the head lies at {rounded(1e3 * middle)} mm of its places, which "
                "count from it. Do they count from an edge? Subtract as much from them."
            )


def _doubts_of_head_for_tread(key: str, y: Array, z: Array) -> Iterator[str]:
    """Say where the section of a wheel has the shape of a rail's head, either way up, by points (n,), m."""
    wide = float(y[-1] - y[0])
    left, right = z[[0, -1]] - np.interp(0.5 * (y[0] + y[-1]), y, z)
    if wide <= WIDEST_HEAD and left * right > 0.0 and (both := min(abs(left), abs(right))) > FALLEN:
        yield (
            f"{key}: its ends are {rounded(1e3 * both)} mm off its middle, both on one side of it, in a "
            f"section {rounded(1e3 * wide)} mm wide, as heads of rails are. Is it the section of the rail?"
        )


def _doubts_of_tread_for_head(key: str, y: Array, z: Array) -> Iterator[str]:
    """Say where the section of a rail has the shape of a tread with its flange, by its points (n,), m."""
    away = np.abs(_away_from_rest(y, z))
    level_width = float((away < FLANGE).mean() * (y[-1] - y[0]))
    if level_width > WIDEST_HEAD and flange_of(y, z)[1]:
        yield (
            f"{key}: {rounded(1e3 * level_width)} mm are level beside a step of "
            f"{rounded(1e3 * away.max())} mm, as a tread beside its flange; heads of rails are up to 76 mm "
            "wide. Is it the section of the wheel?"
        )


# --- the contact


@dataclass(frozen=True, eq=False)
class Lying:
    """The section of a body as it lies."""

    # spline: places across (n,), m, towards the field side from the middle of the rail head -> depth below
    # that middle, m, and place on the section itself, m
    section: Any
    turned: bool = False  # whether its heights came into the material
    flanged: bool = False  # whether it is a tread with its flange
    measured: bool = True  # or a circle
    doubts: tuple[str, ...] = ()  # what is hardly meant, in sentences
    is_the_other: bool = False  # whether it has the shape of what it touches
    step: float = 0.0  # of its heights as printed, m; 0 where they are not
    spacing: float = 0.0  # of its points, m; 0 of a circle


@dataclass(frozen=True, eq=False)
class Meeting:
    """Where a tread touches a rail head across the path, both as they lie."""

    tread: Lying
    head: Lying
    at: float  # place of the contact, m
    inside: float = 0.0  # how far that is from the edges of what is known of both, m

    @property
    def places(self) -> tuple[float, float]:
        """On tread and rail head, m from their middle, positive towards the field side."""
        on_tread, on_head = (float(each.section(self.at)[1]) for each in (self.tread, self.head))
        return on_tread, on_head

    @property
    def doubts(self) -> tuple[str, ...]:
        """What is hardly meant of both, in sentences."""
        return self.tread.doubts + self.head.doubts

    def uncertain(self, half: float) -> float:
        """By how much the depth of the gap across a contact of a half width, m, is off at most, m, by printed
        heights.

        Two standard deviations of a parabola through n points, five or more, whose errors, of the variance
        q²/12 of a step q, know nothing of one another: that of its depth is q²/12 · 45/(4 n). Those of a
        smooth section partly do, and cancel: it is off by a fourth of that to all of it.
        """
        variance = sum(each.step**2 * each.spacing / (2.0 * half) for each in (self.tread, self.head))
        return 2.0 * math.sqrt(45.0 / 48.0 * variance)

    def doubt_of_printed(self, radius: float, half: float, keys: str) -> str:
        """Say where printed heights leave the radius of the gap across a contact, m, of a half width, m,
        uncertain; else nothing."""
        depth = 0.5 * half**2 / radius
        share = self.uncertain(half) / depth
        if share < UNCERTAIN:
            return ""
        off = f"by up to {rounded(100.0 * share, 2)} %" if share < 1.0 else "altogether"
        printed = told_length(max(self.tread.step, self.head.step))
        return (
            f"{keys}: positions printed to {printed} leave the radius of the contact across the path, "
            f"{rounded(1e3 * radius)} mm, uncertain {off}: the gap is {rounded(1e6 * depth, 2)} µm deep "
            "where they touch. Take tables with more digits."
        )

    def gap(self, across: Array) -> Array:
        """Gap (n,), m, at places across (n,), m from the contact."""
        gaps = self._gap(self.at + np.append(across, 0.0))
        return gaps[:-1] - gaps[-1]

    def _gap(self, y: ArrayLike) -> Array:
        return self.tread.section(y)[..., 0] + self.head.section(y)[..., 0]

    def osculating(self, hertz: Hertz, load: float) -> Hertz | None:
        """Contact of the parabola through the gap over its own width, under a load, N; None where it is none.

        `hertz` has the radius along the path.
        """
        if not self.inside > 0.0:
            return None
        half = min(hertz.semi_axes_under(load)[1], self.inside)
        for _ in range(SETTLED):
            y = half * np.linspace(-1.0, 1.0, 201)
            curvature = float(np.polynomial.polynomial.polyfit(y, self.gap(y), 2)[2])
            if not curvature > 0.0:
                return None
            hertz = replace(hertz, radius_y=0.5 / curvature)
            half = min(hertz.semi_axes_under(load)[1], self.inside)
        return hertz

    @classmethod
    def of(cls, tread: Lying, head: Lying, keys: str, clear: float) -> Meeting:
        """Find the lowest gap, at least `clear` m inside of what is known; messages tell of `keys`."""
        ends = [each.section.t[[0, -1]] for each in (tread, head)]
        low = max(each[0] for each in ends)
        high = min(each[1] for each in ends)
        places = np.linspace(low, max(low, high), POINTS)
        anywhere = cls(tread, head, 0.0)
        n = int(np.argmin(anywhere._gap(places)))
        around = places[max(n - 1, 0)], places[min(n + 1, POINTS - 1)]
        found = scipy.optimize.minimize_scalar(
            lambda at: float(anywhere._gap(at)), bounds=around, method="bounded", options={"xatol": 1e-9}
        ).x
        inside = max(min(found - low, high - found), 0.0)
        received = f"sections that meet {1e3 * inside:.1f} mm from an edge of what is known of them"
        allowed = f"a contact at least {rounded(1e3 * clear)} mm inside, half of contact.window"
        remedy = (
            "Do both hold radii, no diameters? Then measure more of them, shift them less, or shrink "
            "contact.window."
        )
        if tread.flanged and not head.measured:
            remedy = (
                "A head that is a circle meets the flange: give the rail's section, or cut the flange off."
            )
        remedy = next(iter(anywhere.doubts), remedy)
        require(inside >= clear, keys, received, allowed, remedy)
        return cls(tread, head, float(found), float(inside))


def printed_step(heights: Array) -> float:
    """Step of heights (n,), m, that all are multiples of, as tables print them; 0 where there is none.

    A plane and a cone may be so by their shape.
    """
    for step in PRINTED:
        whole = np.rint(heights / step)
        if (np.abs(heights / step - whole) <= 1e-6 * np.maximum(np.abs(whole), 1.0)).all():
            return step if np.ptp(np.diff(whole)) else 0.0
    return 0.0


def _circle(radius: float) -> tuple[Array, Array]:
    """Section of a circle, m: places and heights from its highest point."""
    y: Any = min(REACH, SHARE * radius) * np.linspace(-1.0, 1.0, POINTS)
    return y, -(y**2) / (radius + np.sqrt(radius**2 - y**2))


def _places_of(section: Profile) -> Array:
    """Places (n,), m, across: as the file has them, else from the middle."""
    count = len(section.heights)
    first = -0.5 * (count - 1) * section.spacing if section.start is None else section.start
    return first + section.spacing * np.arange(count, dtype=np.float64)


def _levelled(section: Profile, y: Array, flanged: bool) -> tuple[Array, Array]:
    """Places from the middle and heights of a levelled section, (n,) each, m.

    Of a tread with a flange the tread is levelled about the running circle, where the file counts from it,
    else about the middle of what is no flange; of anything else all, about the middle of what was measured.
    """
    z = section.heights
    if not flanged:
        return _places_of(replace(section, start=None)), np.asarray(level(section).heights)
    if section.start is None:
        rest = y[np.abs(_away_from_rest(y, z)) < FLANGE]
        y = y - 0.5 * (rest[0] + rest[-1])
    tread: Flags = np.abs(y) <= TREAD
    if tread.sum() > 1:
        offset, slope = np.polynomial.polynomial.polyfit(y[tread], z[tread], 1)
        z = z - (offset + slope * y)
    return y, z


def _lying(
    measured: Path | Profile | None, radius: float, key: str, angle: float | None, shift: float, *, head: bool
) -> Lying:
    """Section of a body, measured or a circle, turned about its middle and shifted, see `Lying`.

    Turned by an angle, rad, that lifts the field side of a rail; shifted towards that side, m. Without an
    angle it is levelled, and its middle is that of what was measured. The heights of tables that have one z
    for wheel and rail come into the material of one of them: they are turned where its shape shows that, the
    flange of a tread or the corners of a head.
    """
    turned = False
    step = 0.0
    spacing = 0.0
    way = 0
    doubts = list[str]()
    others = list[str]()
    if measured is None:
        y, z = _circle(radius)
    else:
        with PhysicsWarning.caught() as caught:  # it is read as often as it is looked at, and told once
            section = read_section(measured, key)
        doubts += [str(each.message) for each in caught]
        step = printed_step(section.heights)
        spacing = section.spacing
        y = _places_of(section)
        way, side = (0, 0) if head else flange_of(y, section.heights)
        turned = _is_head_down(y, section.heights) if head else way < 0
        section = replace(section, heights=-section.heights) if turned else section
        if key in OF_TRAINS:
            doubts_of_shape = _doubts_of_tread_for_head if head else _doubts_of_head_for_tread
            others = list(doubts_of_shape(key, y, section.heights))
            doubts += others
        if side:
            _refuse_strange_flange(key, section, y, side)
        if key in OF_TRAINS and not way and angle is not None and section.start is not None:
            doubts_of = _doubts_of_head if head else _doubts_of_tread
            doubts += doubts_of(key, y, section.heights)
        y, z = (y, section.heights) if angle is not None else _levelled(section, y, way != 0)
        z = z - np.interp(0.0, y, z)
    angle = angle or 0.0
    across = y * math.cos(angle) - z * math.sin(angle) + shift
    depth = -(y * math.sin(angle) + z * math.cos(angle))
    allowed = f"heights over places that rise, turned by {rounded(1e3 * angle)} mrad, too"
    remedy = next(iter(doubts), "Leave flanks out that are as steep, and check the units.")
    require((np.diff(across) > 0.0).all(), key, "a section that overhangs", allowed, remedy)
    spline = scipy.interpolate.make_interp_spline(across, np.column_stack([depth, y]), k=3)
    known = measured is not None
    return Lying(spline, turned, way != 0, known, tuple(doubts), bool(others), step, spacing)


def meeting_of(case: RollingCase, clear: float | None = None) -> Meeting:
    """Lay the sections of what rolls, and of what is rolled over, together: levelled, or as they lie.

    As they lie, where the inclination of a rail towards the middle of the track is given. They meet at least
    `clear` m, by default half of the window, inside of what is known of them.
    """
    body = case.rolling
    over = case.rolled_over
    tread, head = section_keys(case)
    inclination = None
    shift = 0.0
    if "sideways" in case.inner and case.sideways.rail_inclination is not None:
        inclination = math.atan(INCLINATIONS[case.sideways.rail_inclination])
        shift = case.sideways.wheel_shift
    level_or_upright = None if inclination is None else 0.0
    upper = _lying(body.profile, body.across, tread, level_or_upright, shift, head=False)
    lower = _lying(over.profile, over.radius_across, head, inclination, 0.0, head=True)
    received = "sections exchanged: the wheel's has the shape of a rail's head, the rail's that of a tread"
    allowed = f"the wheel's under {tread}, the rail's under {head}"
    exchanged = upper.is_the_other and lower.is_the_other
    require(not exchanged, f"{tread} and {head}", received, allowed, "Exchange the two files.")
    clear = 0.5 * case.contact.window if clear is None else clear
    return Meeting.of(upper, lower, f"{tread} and {head}", clear)


def section_keys(case: RollingCase) -> tuple[str, str]:
    """Keys of the sections of what rolls and of what is rolled over, across the path."""
    return f"{case.ROLLING}.profile", f"{case.over_name}.rail_profile"


def turned_sections(case: RollingCase, met: Meeting) -> list[str]:
    """Say which sections were turned, in a sentence each."""
    lowest = ("its flange was the lowest", "its corners were the highest")
    told = zip(section_keys(case), (met.tread, met.head), lowest, strict=True)
    return [
        f"{key}: turned upside down, as {why}: heights are positive out of the material, and tables with one "
        "z for wheel and rail have them into one of both."
        for key, each, why in told
        if each.turned
    ]
