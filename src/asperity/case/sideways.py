"""What moves sideways: how sections lie on each other, how a rail resists; how wheels creep and slip."""

from __future__ import annotations

import math
from collections.abc import Iterator

from asperity.case.form import Section
from asperity.errors import InputError
from asperity.parameters import Choice, Number, Quantity, key, keys_of, optional
from asperity.structures.lateral_rail import LateralTrack
from asperity.structures.track import Track

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
_CREEPAGE = Number(at_least=-0.1, at_most=0.1)
_NONE = "none"


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
