"""A roller bearing that runs under a load: what of it is other than of a ball bearing."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar

from asperity.case.any_case import LAW
from asperity.case.ball_bearing import BearingUnderLoad
from asperity.case.bearing_sections import AroundKeys, RollerFaultKeys
from asperity.case.form import section
from asperity.case.lubricant import RollerLubricantKeys
from asperity.case.named_bearing import NamedBearing
from asperity.case.ready_lists import IN_ROLLER_BEARINGS, NamedChanges, listed_changes
from asperity.errors import InputError
from asperity.laws import LawSpec, Need, spec_of
from asperity.parameters import ANGLE, DURATION, Choice, Flag, ListOf, Quantity, key, keys_of, optional
from asperity.rolling.resolution import steps_per_resonance
from asperity.structures.roller_bearing import ROLLER_BEARINGS, RollerBearing
from asperity.structures.rollers_on_raceways import STEEPEST_TILT
from asperity.written_numbers import rounded

if TYPE_CHECKING:
    from asperity.contact.slices import SlicedContact
    from asperity.structures.roller_statics import LoadedRollers

TILT = key(
    ANGLE,
    "0 mrad",
    "tilt of the inner ring in the plane of the radial load",
    "-0.1 rad to 0.1 rad: shafts tilt less",
)
TILT_STIFFNESS = optional(
    Quantity("N m", above=0),
    "2 kN m",
    "stiffness by which the shaft holds the inner ring at tilt, against the moment of the rollers",
    "it stays at tilt",
    "10 N m to 1 GN m: softer holds nothing, stiffer gives way by nothing",
)
FRICTION: Any = replace(
    BearingUnderLoad.keys["friction"],
    meaning="coefficient of friction of tapered rollers on the rib, which bearing.rib_height goes with",
)
DIMENSIONS = keys_of(RollerBearing, otherwise="that of the named bearing")
BY_SLICES = "areal"
"""The law of rollers: its force is that of all slices, on heights averaged under them."""


def _follows_averages(law: LawSpec) -> bool:
    """Whether a law is a force curve on averaged heights: a roller has no scan, and no ellipse."""
    return Need.AREAL in law.needs and not law.sees_heights


OF_CROWNING = {
    "drop of the crowning": "crowning_drop",
    "straight middle of the crowning": "crowning_straight",
}
"""Keys of what a crowning may be refused for."""


def held_at(tilt: float, stiffness: float | None) -> dict[str, Any]:
    """How the inner ring is held, as `RollerBearing.loaded` takes it, where a shaft does so."""
    return {"tilt": tilt} if stiffness is None else {"tilt": tilt, "tilt_stiffness": stiffness}


def rubbing_nowhere(friction: float | None, of: RollerBearing, within: str = "") -> Iterator[InputError]:
    """Friction of a bearing whose rollers touch no rib, keys of which stand within a section."""
    if friction is not None and of.rib_height is None:
        allowed = f"none without {within}taper and {within}rib_height: rollers slide on a rib alone"
        yield InputError("friction", f"{friction:g}", allowed, "Give them, or leave it out.")


class RollerGeometry(NamedBearing, parameters=DIMENSIONS):
    """A roller bearing, named or by its dimensions."""

    MODEL = RollerBearing
    DIMENSIONS = DIMENSIONS
    NEEDED = ("rollers", "roller_diameter", "roller_length", "pitch_diameter")

    name: str | None = optional(
        Choice(tuple(ROLLER_BEARINGS)), "NU205", "named bearing", "the dimensions are given"
    )

    if TYPE_CHECKING:

        @property
        def bearing(self) -> RollerBearing:
            """The bearing."""

    @classmethod
    def names_in_words(cls) -> str:
        """The names that there are."""
        return f"Named roller bearings: {', '.join(ROLLER_BEARINGS)}."

    def problems(self) -> Iterator[InputError]:
        """What a bearing lacks, or why it cannot be, by the key of its crowning."""
        for error in super().problems():
            yield error.about(OF_CROWNING.get(error.what, error.what))


class RollerBearingUnderLoad(BearingUnderLoad):
    """A roller bearing runs under a constant load.

    Numbers are in SI, or text with its unit. ``asperity new roller-bearing`` writes these keys as a case.

    Examples
    --------
    >>> from asperity import RollerBearingUnderLoad
    >>> case = RollerBearingUnderLoad(speed="1800 1/min", radial=2000, bearing={"name": "NU205"})
    >>> f"{case.kinematics.ball_pass_outer:.1f} Hz"
    '157.5 Hz'
    """

    TITLE = "A roller bearing runs under a load."
    NEEDED = "a bearing and its load"
    OPTIMISED_BY = ""
    RENAMED: ClassVar = {"balls": "rollers"}
    WRITTEN_OUT: ClassVar = {
        "bearing.name": '"NU205"', "radial": '"2 kN"', "inner_raceway.waviness": '"0.2 um"',
        "outer_raceway.waviness": '"0.2 um"',
    }  # fmt: skip

    kind: str = key(Choice(("roller-bearing",)), "roller-bearing", "what rolls")
    tilt: float = TILT
    tilt_stiffness: float | None = TILT_STIFFNESS
    rotating_tilt: float = replace(
        TILT, meaning="tilt that turns with the ring that turns, as of a bent shaft"
    )
    laws: tuple[str, ...] = key(
        ListOf(LAW, least=1, once=True),
        [BY_SLICES],
        "laws of the contact force: areal alone of those built in, by the slices of ISO/TS 16281",
    )
    time_step: float | None = optional(
        DURATION,
        "2 us",
        "time step",
        "a tenth of a roller's period, or of that of the highest frequency; a fifth of a roller's far beyond "
        "that; a quarter of that of a ring's highest mode",
        "1 ns to 1 ms: bearings ring between",
    )
    centrifugal: bool = key(Flag(), True, "whether rollers press the outer ring as they go round")
    friction: float | None = FRICTION
    bearing: RollerGeometry = section(  # type: ignore[assignment]
        RollerGeometry, "the bearing: named, or by its dimensions"
    )
    lubricant: RollerLubricantKeys = section(
        RollerLubricantKeys, "the oil: a film in each contact, dry without it"
    )
    rollers: AroundKeys = section(AroundKeys, "what is on each roller all around")
    fault: RollerFaultKeys = section(
        RollerFaultKeys, "a fault of a raceway or of a roller; of several each below [[fault]]", repeated=True
    )

    if TYPE_CHECKING:

        @property
        def static(self) -> LoadedRollers:  # type: ignore[override]
            """The bearing under its load while it turns."""

        @property
        def contacts(self) -> tuple[tuple[SlicedContact, float], tuple[SlicedContact, float]]:  # type: ignore[override]
            """Smooth contacts of a roller with the inner and the outer ring, and their largest loads, N."""

    @property
    def tilts(self) -> dict[str, float]:
        """Tilts of the inner ring, rad, by the names of their keys, where there are any."""
        standing = self.tilt
        if self.tilt_stiffness is not None:  # as far as the shaft gives way at rest, mean over the cage
            standing = self.static.tilt
        found = {"tilt": standing, "rotating_tilt": self.rotating_tilt}
        return found if any(found.values()) else {}

    @property
    def held(self) -> dict[str, Any]:
        """How far the inner ring is tilted at most: where one that turns adds to one that stands."""
        tilt = math.copysign(abs(self.tilt) + abs(self.rotating_tilt), self.tilt)
        return held_at(tilt, self.tilt_stiffness)

    def resolving(self, resonance: float) -> float:
        """Time steps in a second, 1/s, that a resonance of contacts, Hz, takes: fewer beyond the record."""
        return steps_per_resonance(resonance, self.highest_frequency) * resonance

    @property
    def helping_changes(self) -> NamedChanges:
        """Changes that may make it quieter: clearance, crowning, waves of each part, speed, …."""
        return listed_changes(IN_ROLLER_BEARINGS)

    def problems(self) -> Iterator[InputError]:
        """Laws that rollers have; and what holds of any bearing."""
        others = [law for law in self.laws if not _follows_averages(spec_of(law))]
        if others:
            remedy = "Its force on rollers is that of slices; the others are made for the ellipse of a ball."
            yield InputError("laws", ", ".join(others), f'"{BY_SLICES}"', remedy)
            return
        if sliding := next(self._problems_of_sliding(), None):
            yield sliding
            return
        if self.axial > 0.0 and self.bearing.bearing.contact_angle == 0.0:
            remedy = "Rollers slide along such raceways, and ribs are not in it. Give a contact_angle."
            allowed = "0 N where bearing.contact_angle is 0"
            yield InputError("axial", f"{rounded(self.axial, 4)} N", allowed, remedy)
            return
        if self.tilt_stiffness is not None and self.rotating_tilt:
            remedy = "It is held against what stands; leave one of them out."
            yield InputError("tilt_stiffness", "one beside rotating_tilt", "a tilt that stands alone", remedy)
            return
        if abs(self.held["tilt"]) >= STEEPEST_TILT:
            key = "tilt" if abs(self.tilt) >= abs(self.rotating_tilt) else "rotating_tilt"
            allowed = f"below {STEEPEST_TILT:g} rad, tilt and rotating_tilt together"
            yield InputError(key, f"{rounded(self.held['tilt'], 4)} rad", allowed, "Is the unit right?")
            return
        yield from super().problems()

    def _problems_of_sliding(self) -> Iterator[InputError]:
        """Friction of what slides: the ends of tapered rollers on a rib, as high as it is told."""
        sliding = {"wear_coefficient": self.wear_coefficient}
        sliding |= {f"creep.{name}": each for name, each in self.creep.given().items()}
        for name, given in sliding.items():
            if given is not None:
                allowed = "none: rollers slide nowhere but on a rib, with a friction that stays"
                yield InputError(name, f"{given:g}", allowed, 'Leave it out; kind = "ball-bearing" has it.')
        yield from rubbing_nowhere(self.friction, self.bearing.bearing, "bearing.")
