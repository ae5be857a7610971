"""A bearing and what it carries at rest, as it is read by its name, from a file, or of a case."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from asperity.case import toml
from asperity.case.bearing_sections import BearingGeometry
from asperity.case.body import DAMPING
from asperity.case.form import section
from asperity.case.lubricant import LubricantKeys
from asperity.parameters import (
    Origin,
    Quantity,
    key,
    optional,
)
from asperity.reference.bearings import LISTED, named_bearings

if TYPE_CHECKING:
    pass

LOAD = Quantity("N", at_least=0)
LOADS = "0 N to 100 MN: bearings carry less"
DAMPED = "1e-9 N s/m to 1e9 N s/m: less damps nothing, more is rigid"
_SPEEDS = "0 Hz to 10 kHz: bearings turn slower"


class BearingKeys(BearingGeometry):
    """A ball bearing and what it carries."""

    radial: float = key(LOAD, "0 N", "radial load on the inner ring", LOADS)
    axial: float = key(LOAD, "0 N", "axial load on the inner ring", LOADS)
    speed: float | None = optional(
        Quantity("Hz", "1/min", at_least=0),
        "1800 1/min",
        "speed of the ring that turns",
        "it stands still",
        _SPEEDS,
    )
    contact_damping: float = key(DAMPING, "0 N s/m", "damping of each contact, for --table", DAMPED)
    lubricant: LubricantKeys = section(LubricantKeys, "the oil: how thick its films are")


CARRIED = {"radial": "N", "axial": "N", "speed": "Hz", "contact_damping": "N s/m"}
"""Keys of `BearingKeys` that a case has, too, in SI."""


def _of_case(keys: dict[str, Any], source: str) -> dict[str, Any]:
    """Bearing and load of a file; of a case that is read as one what concerns them."""
    toml.refuse_vast(keys, source)
    if "kind" not in keys:
        return keys
    from asperity.case.ball_bearing import BearingUnderLoad

    case = BearingUnderLoad.read(keys, Origin.file(source))
    carried = {name: f"{float(getattr(case, name))!r} {unit}" for name, unit in CARRIED.items()}
    carried["contact_damping"] = f"{0.5 * sum(case.dampings)!r} N s/m"
    return dict(keys.get("bearing", {})) | carried | {"lubricant": keys.get("lubricant", {})}


def bearing_of_run(text: str, source: str) -> BearingKeys:
    """Bearing, load and speed of a run by the text of its case, whose files need no longer be there."""
    keys = toml.read_toml(text, "case", source)
    own = {name: keys[name] for name in ("kind", "bearing", "lubricant", *CARRIED) if name in keys}
    return BearingKeys.read(_of_case(own, source), Origin.file(source))


def read_bearing(source: str, options: Mapping[str, Any]) -> BearingKeys:
    """Read a bearing by its name, or from a TOML file or case; options, as they are typed, are stronger."""
    keys: dict[str, Any] = {"name": source}
    if source not in LISTED:
        definition = toml.read_definition(source, "bearing", named_bearings(source))
        keys = _of_case(toml.read_toml(definition, "bearing", source), source)
    typed: dict[str, Any] = {name: value for name, value in options.items() if value is not None}
    if "lubricant" in typed and isinstance(known := keys.get("lubricant"), dict):
        typed["lubricant"] = known | typed["lubricant"]
    return BearingKeys.read(keys | typed, Origin.file(source))
