"""What a result file holds: each variable and attribute once, for who writes it and for who draws it.

One module per group holds what all kinds of case share; what depends on the scene stands in
`asperity.scenes.schema`. ``docs/reference/result_file.md`` lists it all.
"""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from types import ModuleType
from typing import TYPE_CHECKING, Any

from asperity.errors import Grade, InputError, PhysicsWarning

if TYPE_CHECKING:
    import xarray
    from numpy.typing import ArrayLike

VERSION = 4
"""Of the schema, in every result. Raise it where a name, dimension, unit or meaning changes or goes."""
UNKNOWN = "no reason is known"
VIEW_OF = "view_of"
"""Attribute of a variable that stands in memory alone: the variable of the file that it is a part of."""
_PLACE = re.compile(r"\w+(\(\w+(, \w+)*\))?")
_PLACES = 'a name, or a name with its dimensions, as "force" or "force(law, contact, time)"'
_NUMBER = "What has no dimension is an asperity.schema.Attribute."


@dataclass(frozen=True)
class Entry:
    """A variable of a result file."""

    group: str  # where it stands
    # what it is called there, with its dimensions, as ``"filter(approach, wavenumber)"``; a coordinate, as
    # ``"approach"``, has its own name as its dimension
    place: str
    units: str  # in SI; ``"1"`` for a pure number, ``"dB re 1 N"`` for a level
    long_name: str  # what it is
    condition: str = ""  # which results have it, where not all have
    missing: str = ""  # why values may be missing (NaN)
    attributes: tuple[str, ...] = ()  # what else is said of it

    def __post_init__(self) -> None:
        if not _PLACE.fullmatch(self.place) or len(set(self.dims)) < len(self.dims):
            raise InputError(f"entry of the group {self.group}", repr(self.place), _PLACES, _NUMBER)
        if not isinstance(self.units, str) or not isinstance(self.long_name, str):
            received = f"{self.units!r} and {self.long_name!r}"
            allowed = f"its unit and its meaning, as texts; its place is {_PLACES}"
            raise InputError(f"entry {self.place} of the group {self.group}", received, allowed)

    @property
    def name(self) -> str:
        """What it is called in its group."""
        return self.place.partition("(")[0]

    @property
    def dims(self) -> tuple[str, ...]:
        """Names of its dimensions."""
        return tuple((self.place.removesuffix(")").partition("(")[2] or self.place).split(", "))

    @property
    def path(self) -> str:
        """As ``"contact/force"``."""
        return f"{self.group}/{self.name}"

    def variable(self, values: "ArrayLike", **attributes: Any) -> "xarray.Variable":
        """Make the variable; what is not a finite number is missing, and the variable says why."""
        import numpy as np
        import xarray

        numbers = np.asarray(values)
        attrs = {"units": self.units, "long_name": self.long_name} | attributes
        if numbers.dtype.kind == "f" and not (finite := np.isfinite(numbers)).all():
            attrs.setdefault("missing", self.missing or UNKNOWN)
            if attrs["missing"] == UNKNOWN:
                lost = f"{numbers.size - finite.sum()} of {numbers.size} values of {self.name}"
                message = f"{lost} are not finite numbers, and {UNKNOWN}"
                PhysicsWarning.warn(message, Grade.OUT)
            numbers = np.where(finite, numbers, np.nan)
        return xarray.Variable(self.dims, numbers, attrs)


@dataclass(frozen=True)
class Attribute:
    """An attribute of a group of a result file, or of its root."""

    group: str  # where it stands; ``""`` at the root
    name: str  # what it is called there
    units: str  # in SI; ``"text"``, or ``"JSON"`` for what is laid out as that
    meaning: str  # what it is
    condition: str = ""  # which results have it, where not all have


def declared(module: ModuleType) -> tuple[Entry | Attribute, ...]:
    """All entries and attributes that a module declares."""
    return tuple(each for each in vars(module).values() if isinstance(each, Entry | Attribute))


Values = dict[Entry | Attribute, Any]
"""What is laid out: arrays, or variables that are made already, and attributes, each by what it is."""


def group(values: Mapping[Entry | Attribute, Any]) -> "xarray.Dataset":
    """Lay out one group."""
    import xarray

    held = {
        item.name: value if isinstance(value, xarray.Variable) else item.variable(value)
        for item, value in values.items()
        if isinstance(item, Entry)
    }
    told = {
        item.name: json.dumps(value, ensure_ascii=False) if item.units == "JSON" else value
        for item, value in values.items()
        if isinstance(item, Attribute)
    }
    return xarray.Dataset(held, attrs=told)


def tree(values: Mapping[Entry | Attribute, Any]) -> "xarray.DataTree":
    """Lay out all groups, in the order in which they come first."""
    import xarray

    groups: dict[str, Values] = {}
    for item, value in values.items():
        groups.setdefault(f"/{item.group}", {})[item] = value
    return xarray.DataTree.from_dict({name: group(held) for name, held in groups.items()})
