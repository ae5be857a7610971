"""What a study varies: a key and its values, along an axis of its table."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.case.content import described_value, holds_memory
from asperity.case.describing import CaseKey, value_in_toml
from asperity.reference.materials import Material
from asperity.reporting.data import TYPED_FACTOR, TYPED_UNIT
from asperity.units import factor, unit_in


@dataclass(frozen=True, eq=False)
class SweptAxis:
    """A key and its values."""

    entry: CaseKey  # the key
    written: tuple[Any, ...]  # as they stand in TOML
    values: tuple[Any, ...]  # the same in SI

    @property
    def name(self) -> str:
        """The key with its section, as ``"contact.spacing"``."""
        return self.entry.dotted

    @property
    def meaning(self) -> str:
        """What the key is."""
        return self.entry.key.meaning

    @property
    def told(self) -> Any:
        """The values as they stand in TOML, for tables and programs."""
        return list(self.written)

    @property
    def units(self) -> str:
        """SI unit of the coordinate; ``"1"`` where the values are words."""
        return self.entry.unit or "1"

    @property
    def typed(self) -> dict[str, Any]:
        """Unit in which its first value was written that has one, and what it is in SI; nothing in SI."""
        units = (unit_in(value) for value in self.written if isinstance(value, str))
        unit = next(filter(None, units), self.units)
        if self.units in ("1", "dB") or unit == self.units:
            return {}
        return {TYPED_UNIT: unit, TYPED_FACTOR: factor(unit, self.units)}

    @property
    def coordinate(self) -> NDArray[Any]:
        """Values along the axis: numbers in SI, or words as they were written."""
        if self.entry.unit is not None:
            return np.array(self.values)
        return np.array([written_out(value) for value in self.written])


def written_out(value: object) -> str:
    """Write a value of a key for people: words without quotes, lists with commas."""
    if isinstance(value, str):
        return value
    if isinstance(value, list | tuple):
        return ", ".join(map(written_out, value))
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {written_out(item)}" for name, item in value.items())
    return described_value(value) if holds_memory(value) else json.dumps(value, default=str)


def as_in_toml(value: Any, found: Any, entry: CaseKey) -> Any:
    """A value as it would stand in a file: as it was given, but for numbers in SI."""
    bare = isinstance(value, int | float | np.generic | Material) and not isinstance(value, bool)
    return value_in_toml(found, entry.key) if bare else value
