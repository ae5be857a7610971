"""What moves sideways: where wheel and rail touch, how a rail resists there, and when the contact slips."""

from __future__ import annotations

from asperity.case.form import Section
from asperity.parameters import Choice, Number, Quantity, key, keys_of, optional
from asperity.structures.lateral_rail import LateralRail, LateralTrack
from asperity.structures.track import Track

_PADS, _HEADS = "pads lie between", "rail heads lie between"
INCLINATIONS = {"0": 0.0, "1:40": 1.0 / 40.0, "1:20": 1.0 / 20.0}
"""Of a rail towards the middle of the track, from upright: tangents."""


class SidewaysKeys(Section, parameters=keys_of(LateralRail, otherwise="of a UIC 60 rail")):
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
        Choice(tuple(INCLINATIONS), numbers=(0,)),
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
    pad_stiffness: float | None = optional(
        Quantity("N/m", above=0),
        "100 MN/m",
        "lateral stiffness of a rail pad, which loses as vertically",
        "a third of the vertical one",
        f"1 kN/m to 1 TN/m: {_PADS}",
    )
    pad_roll_stiffness: float | None = optional(
        Quantity("N m", above=0),
        "560 kN m",
        "stiffness of a rail pad against roll of the rail, per rad, which loses as vertically",
        "that of an even pad as wide as the rail's foot",
        f"1 N m to 1 GN m: {_PADS}",
    )
    ballast_stiffness: float | None = optional(
        Quantity("N/m", above=0),
        "150 MN/m",
        "lateral stiffness of the ballast under half a sleeper, which loses as vertically",
        "the vertical one",
        "1 kN/m to 1 TN/m: ballast lies between",
    )

    @property
    def rail(self) -> LateralRail:
        """The rail: UIC 60 with what the case says of it."""
        told = {name: getattr(self, name) for name in keys_of(LateralRail, "")}
        return LateralRail(**{name: value for name, value in told.items() if value is not None})

    def model(self, track: Track, foot_width: float) -> LateralTrack:
        """The track sideways, of a rail with a foot of a width, m."""
        own = {
            name: getattr(self, name) for name in ("pad_stiffness", "pad_roll_stiffness", "ballast_stiffness")
        }
        return LateralTrack(track, self.rail, **own, foot_width=foot_width)
