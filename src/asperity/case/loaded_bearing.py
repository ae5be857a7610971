"""A bearing and what it carries, of balls or of rollers, as ``asperity bearing`` reads it."""

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from asperity.arguments import given_options
from asperity.case import toml
from asperity.case.ball_bearing import BearingUnderLoad
from asperity.case.bearing_sections import DAMPED, LOAD, LOADS, BearingGeometry
from asperity.case.form import Section, section
from asperity.case.lubricant import LubricantKeys, RollerLubricantKeys
from asperity.case.roller_bearing import (
    FRICTION,
    TILT,
    TILT_STIFFNESS,
    RollerBearingUnderLoad,
    RollerGeometry,
    held_at,
    rubbing_nowhere,
)
from asperity.case.speed import span_of
from asperity.errors import InputError, OutOfRangeWarning
from asperity.parameters import DAMPING, Origin, Quantity, key, optional
from asperity.reference.bearings import LISTED, named_bearings
from asperity.speeds import SpeedCourse, at_fastest
from asperity.structures.roller_bearing import ROLLER_BEARINGS

SPEEDS = "0 Hz to 10 kHz: bearings turn slower"
CARRIED = {"radial": "N", "axial": "N", "speed": "Hz", "contact_damping": "N s/m"}
"""Keys of loads that a case has, too, in SI."""


class LoadKeys(Section):
    """What a bearing carries."""

    radial: float = key(LOAD, "0 N", "radial load on the inner ring", LOADS)
    axial: float = key(LOAD, "0 N", "axial load on the inner ring", LOADS)
    speed: float | None = optional(
        Quantity("Hz", "1/min", at_least=0),
        "1800 1/min",
        "speed of the ring that turns",
        "it stands still",
        SPEEDS,
    )
    contact_damping: float = key(DAMPING, "0 N s/m", "damping of each contact, for --table", DAMPED)
    lubricant: LubricantKeys = section(LubricantKeys, "the oil: how thick its films are")

    if TYPE_CHECKING:
        name: str | None

        @property
        def bearing(self) -> Any:
            """The bearing."""

    @property
    def is_loaded(self) -> bool:
        """Whether a load, a preload or an interference presses what rolls."""
        carried = self.radial + self.axial + self.bearing.preload
        return carried > 0.0 or self.bearing.radial_clearance < 0.0

    def loaded(self, share: float = 1.0) -> Any:
        """The bearing under a share of its load, the preload in it."""
        preload = self.bearing.preload
        axial = self.axial if share == 1.0 else max(share * (self.axial + preload) - preload, 0.0)
        return self.bearing.loaded(share * self.radial, axial, speed=self.speed or 0.0, **self.held)

    @property
    def held(self) -> dict[str, Any]:
        """How the inner ring is held beside its load."""
        return {}


class BearingKeys(LoadKeys, BearingGeometry):
    """A ball bearing and what it carries."""


class RollerBearingKeys(LoadKeys, RollerGeometry):
    """A roller bearing and what it carries."""

    tilt: float = TILT
    tilt_stiffness: float | None = TILT_STIFFNESS
    friction: float | None = FRICTION
    lubricant: RollerLubricantKeys = section(RollerLubricantKeys, "the oil: how thick its films are")

    @property
    def held(self) -> dict[str, Any]:
        """How the inner ring is held beside its load."""
        return held_at(self.tilt, self.tilt_stiffness)

    def problems(self) -> Iterator[InputError]:
        """What a bearing lacks, or friction of one in which nothing slides."""
        yield from list(super().problems()) or rubbing_nowhere(self.friction, self.bearing)


def _read(keys: Mapping[str, Any], source: str) -> LoadKeys:
    """Keys of a bearing on balls, or on rollers where any of them are those of rollers."""
    others = RollerGeometry.DIMENSIONS.keys() - BearingGeometry.DIMENSIONS.keys()
    of_rollers = not others.isdisjoint(keys) or keys.get("name") in ROLLER_BEARINGS
    return (RollerBearingKeys if of_rollers else BearingKeys).read(keys, Origin.file(source))


def _of_case(keys: dict[str, Any], source: str, options: Mapping[str, Any]) -> dict[str, Any]:
    """Bearing and load of a file; of a case that is read as one what concerns them.

    A speed that changes stands there at its fastest, which is told unless options have another.
    """
    toml.refuse_vast(keys, source)
    if "kind" not in keys:
        return keys
    on_rollers = keys["kind"] == "roller-bearing"
    case = (RollerBearingUnderLoad if on_rollers else BearingUnderLoad).read(keys, Origin.file(source))
    if isinstance(case.speed, SpeedCourse) and options.get("speed") is None:
        span = span_of(case.speed, "Hz", "1/min")
        OutOfRangeWarning.warn(
            f"The speed of {source} changes, {span}: what follows is that"
            f"{at_fastest(case.speed, '1/min', 60.0)[1:]}. Take --speed for another."
        )
    carried: dict[str, Any] = {
        name: f"{float(getattr(case, name))!r} {unit}" for name, unit in CARRIED.items()
    }
    carried["contact_damping"] = f"{0.5 * sum(case.dampings)!r} N s/m"
    units = {"tilt": "rad", "tilt_stiffness": "N m"}
    carried |= {name: f"{value!r} {units[name]}" for name, value in case.held.items()}
    if on_rollers and case.friction is not None:
        carried["friction"] = case.friction
    return dict(keys.get("bearing", {})) | carried | {"lubricant": keys.get("lubricant", {})}


def bearing_of_run(text: str, source: str) -> LoadKeys:
    """Bearing, load and speed of a run by the text of its case, whose files need no longer be there."""
    keys = toml.read_toml(text, "case", source)
    names = "kind", "bearing", "lubricant", "tilt", "tilt_stiffness", "rotating_tilt", "friction", *CARRIED
    own = {name: keys[name] for name in names if name in keys}
    return _read(_of_case(own, source, {}), source)


def read_bearing(source: str, options: Mapping[str, Any]) -> LoadKeys:
    """Read a bearing by its name, or from a TOML file or case; options, as they are typed, are stronger."""
    keys: dict[str, Any] = {"name": source}
    if source not in LISTED and source not in ROLLER_BEARINGS:
        remedy = f"{named_bearings(source)} {RollerGeometry.names_in_words()}"
        definition = toml.read_definition(source, "bearing", remedy)
        keys = _of_case(toml.read_toml(definition, "bearing", source), source, options)
    typed = given_options(options)
    if "lubricant" in typed and isinstance(known := keys.get("lubricant"), dict):
        typed["lubricant"] = known | typed["lubricant"]
    return _read(keys | typed, source)
