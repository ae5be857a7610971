"""What moves sideways: how sections of wheel and rail lie on each other, and how a rail resists."""

from asperity.arguments import given_options
from asperity.case.form import Section
from asperity.parameters import Choice, Quantity, key, keys_of, optional
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

    def model(self, track: Track, foot_width: float) -> LateralTrack:
        """The track sideways, of a rail with a foot of a width, m: UIC 60 with what the case says of it."""
        told = {name: getattr(self, name) for name in keys_of(LateralTrack, "")}
        return LateralTrack(track, **given_options(told), foot_width=foot_width)
