"""What moves sideways: where wheel and rail touch, how a rail resists; how wheels creep and slip."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy

from asperity.arguments import Array, ArrayLike, require
from asperity.case.form import Section
from asperity.errors import InputError
from asperity.parameters import Choice, Number, Quantity, key, keys_of, optional
from asperity.structures.lateral_rail import LateralTrack
from asperity.structures.track import Track
from asperity.surfaces.heightmap import Profile
from asperity.surfaces.levelling import level
from asperity.surfaces.readers import hints, read_surface

if TYPE_CHECKING:
    from asperity.case.scene import Case


_HEADS = "rail heads lie between"
INCLINATIONS = {"0": 0.0, "1:40": 1.0 / 40.0, "1:20": 1.0 / 20.0}
"""Of a rail towards the middle of the track, from upright: tangents."""


class SidewaysKeys(Section, parameters=keys_of(LateralTrack, otherwise="of a UIC 60 rail")):
    """Motion sideways, which follows from the vertical force, by frequency."""

    contact_place: float | None = optional(
        Quantity("m"),
        "10 mm",
        "place of the contact across tread and rail head, from their middle, positive to the field side; "
        "off it wheel and rail move sideways, as on a bent web",
        "where their sections touch, by rail_inclination; else the middle",
        f"-50 mm to 50 mm: {_HEADS}",
    )
    rail_inclination: str | None = optional(
        Choice(tuple(INCLINATIONS)),
        "1:40",
        "inclination of the rail towards the middle of the track, by which the sections of wheel and rail "
        "lie on each other, positive to the field side from running circle and middle of the head, as their "
        "files say",
        "measured sections are levelled, and their contact is in the middle",
    )
    wheel_shift: float = key(
        Quantity("m"),
        "0 mm",
        "how far the running circle is to the field side of the middle of the head",
        f"-50 mm to 50 mm: {_HEADS}",
        goes_with="rail_inclination",
    )
    friction: float = key(
        Number(above=0, at_most=1), 0.3, "coefficient of friction, up to which the contact sticks"
    )

    def model(self, track: Track, foot_width: float) -> LateralTrack:
        """The track sideways, of a rail with a foot of a width, m: UIC 60 with what the case says of it."""
        told = {name: getattr(self, name) for name in keys_of(LateralTrack, "")}
        known = {name: value for name, value in told.items() if value is not None}
        return LateralTrack(track, **known, foot_width=foot_width)


_ANY = "angle_of_attack or longitudinal or lateral or spin"
_CREEPAGE, _NONE = Number(at_least=-0.1, at_most=0.1), "none"


class CreepKeys(Section):
    """Creepages of the wheel over the rail; the contact sticks up to sideways.friction."""

    angle_of_attack: float | None = optional(
        Quantity("rad"),
        "8 mrad",
        "angle from the rail to where the wheel heads, to the field side; minus its tangent adds to lateral",
        _NONE,
        "-100 mrad to 100 mrad: creepages are small",
    )
    longitudinal: float | None = optional(
        _CREEPAGE, 0.001, "velocity over the rail over that of rolling, along; positive: it brakes", _NONE
    )
    lateral: float | None = optional(
        _CREEPAGE, -0.002, "the same to the field side, beside that of an angle of attack", _NONE
    )
    spin: float | None = optional(
        Quantity("rad/m"),
        "0.1 rad/m",
        "turning of the wheel about the normal, from along to the field side, per length rolled",
        _NONE,
        "-10 rad/m to 10 rad/m: wheels do not pivot",
    )
    kinetic: float = key(
        Number(at_least=0, at_most=1), 1.0, "share of sideways.friction that is left in slip", goes_with=_ANY
    )
    falling_velocity: float | None = optional(
        Quantity("m/s", above=0),
        "0.5 m/s",
        "slip velocity over which friction falls to that share, by exp(-v/falling_velocity)",
        "it falls at once",
        "1 mm/s to 100 m/s: nothing else is known",
        goes_with=_ANY,
    )

    @property
    def creepage(self) -> tuple[float, float, float]:
        """Of the wheel along, to the field side, and spin, rad/m; all zero where the case gives none."""
        across = (self.lateral or 0.0) - math.tan(self.angle_of_attack or 0.0)
        return self.longitudinal or 0.0, across, self.spin or 0.0

    def problems(self) -> Iterator[InputError]:
        """Friction that falls over a velocity falls."""
        if self.falling_velocity is not None and self.kinetic == 1.0:
            yield InputError(
                "falling_velocity", "friction that stays", "kinetic below 1", "As kinetic = 0.5."
            )


# --- where the sections of wheel and rail touch

REACH = 0.1
"""Farthest place of a section that is not measured, but a circle, m."""
SHARE = 0.9
"""And farthest over its radius."""
FEWEST = 4
"""Points of a section."""
POINTS = 2001
"""Of a circle, and of the gap, among which the lowest is looked for."""


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
        section = read_surface(measured) if isinstance(measured, Path) else measured
    if not isinstance(section, Profile):
        raise InputError(key, "a map of heights", "one line across the path")
    count = len(section.heights)
    require(count >= FEWEST, key, f"{count} points", f"at least {FEWEST}", "Measure more of them.")
    return complete(section, key)


def complete(line: Profile, key: str) -> Profile:
    """The line that a key names, refused where a point has no height."""
    remedy = "Interpolate them in the file."
    require(line.missing_share == 0.0, key, "points without a height", "a complete line", remedy)
    return line


@dataclass(frozen=True, eq=False)
class Meeting:
    """Where a tread touches a rail head across the path, both as they lie."""

    # splines: places across (n,), m, towards the field side from the middle of the rail head -> depth below
    # that middle, m, and place on the section itself, m
    tread: Any
    head: Any
    at: float  # place of the contact, m

    @property
    def places(self) -> tuple[float, float]:
        """On tread and rail head, m from their middle, positive towards the field side."""
        on_tread, on_head = (float(each(self.at)[1]) for each in (self.tread, self.head))
        return on_tread, on_head

    def gap(self, across: Array) -> Array:
        """Gap (n,), m, at places across (n,), m from the contact."""
        gaps = self._gap(self.at + np.append(across, 0.0))
        return gaps[:-1] - gaps[-1]

    def _gap(self, y: ArrayLike) -> Array:
        return np.asarray(self.tread(y)[..., 0] + self.head(y)[..., 0])

    @classmethod
    def of(cls, tread: Any, head: Any, keys: str, clear: float) -> Meeting:
        """Find the lowest gap, at least `clear` m inside of what is known; messages tell of `keys`."""
        low, high = max(tread.t[0], head.t[0]), min(tread.t[-1], head.t[-1])
        places, anywhere = np.linspace(low, max(low, high), POINTS), cls(tread, head, 0.0)
        n = int(np.argmin(anywhere._gap(places)))
        around = places[max(n - 1, 0)], places[min(n + 1, POINTS - 1)]
        found = scipy.optimize.minimize_scalar(
            lambda at: float(anywhere._gap(at)), bounds=around, method="bounded", options={"xatol": 1e-9}
        ).x
        inside = max(min(found - low, high - found), 0.0)
        received = f"sections that meet {1e3 * inside:.1f} mm from an edge of what is known of them"
        allowed = f"a contact at least {1e3 * clear:.3g} mm inside, half of contact.window"
        remedy = "Measure more of them, shift them less, or shrink contact.window."
        require(inside >= clear, keys, received, allowed, remedy)
        return cls(tread, head, float(found))


def _lying(
    measured: Path | Profile | None, radius: float, key: str, angle: float | None, shift: float
) -> Any:
    """Section of a body, measured or a circle, turned about its middle and shifted, see `Meeting`.

    Turned by an angle, rad, that lifts the field side of a rail; shifted towards that side, m. Without an
    angle it is levelled, and its middle is that of what was measured.
    """
    if measured is None:
        y: Any = min(REACH, SHARE * radius) * np.linspace(-1.0, 1.0, POINTS)
        z: Any = -(y**2) / (radius + np.sqrt(radius**2 - y**2))
    else:
        section = read_section(measured, key)
        if angle is None:
            section = replace(level(section), start=None)
        z, count = section.heights, len(section.heights)
        first = -0.5 * (count - 1) * section.spacing if section.start is None else section.start
        y = first + section.spacing * np.arange(count)
        z = z - np.interp(0.0, y, z)
    angle = angle or 0.0
    across = y * math.cos(angle) - z * math.sin(angle) + shift
    depth = -(y * math.sin(angle) + z * math.cos(angle))
    allowed = f"heights over places that rise, turned by {1e3 * angle:.3g} mrad, too"
    remedy = "Leave flanks out that are as steep, and check the units."
    require((np.diff(across) > 0.0).all(), key, "a section that overhangs", allowed, remedy)
    return scipy.interpolate.make_interp_spline(across, np.column_stack([depth, y]), k=3)


def meeting_of(case: Case) -> Meeting:
    """Lay the sections of what rolls, and of what is rolled over, together: levelled, or as they lie.

    As they lie, where the inclination of a rail towards the middle of the track is given.
    """
    body, over, (tread, head) = case.rolling, case.rolled_over, section_keys(case)
    inclination, shift = None, 0.0
    if "sideways" in case.inner and case.sideways.rail_inclination is not None:
        inclination = math.atan(INCLINATIONS[case.sideways.rail_inclination])
        shift = case.sideways.wheel_shift
    upper = _lying(body.profile, body.across, tread, None if inclination is None else 0.0, shift)
    lower = _lying(over.profile, over.radius_across, head, inclination, 0.0)
    return Meeting.of(upper, lower, f"{tread} and {head}", 0.5 * case.contact.window)


def section_keys(case: Case) -> tuple[str, str]:
    """Keys of the sections of what rolls and of what is rolled over, across the path."""
    return f"{case.ROLLING}.profile", f"{case.over_name}.rail_profile"
