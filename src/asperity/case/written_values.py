"""Values of keys as they would stand in a case file, and as people read them."""

import re
from pathlib import Path
from typing import Any

from asperity.case.in_memory import described_value, holds_memory
from asperity.case.speed import written_course
from asperity.parameters import GIVEN, Key, Quantity, name_of_numbers
from asperity.reference.materials import MATERIALS, Material
from asperity.speeds import SpeedCourse
from asperity.units import written

_UNIT = re.compile(r"\d\.? ([^\"',\]]+)")  # in an example, as "25 mm" or ["0.2 m", "0.4 m"]


def in_words(value: object, key: Key) -> str:
    """Write a value of a key for people, in the unit of its default or its example: ``"300 MN/m"``."""
    if holds_memory(value):
        return described_value(value)
    if isinstance(value, Path):
        return value.name
    return _spoken(value_in_toml(value, key, exactly=False))


def _spoken(value: object) -> str:
    """A value of a case file as people read it."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, dict):
        return ", ".join(f"{name} {each}" for name, each in value.items() if name != "citation")
    return ", ".join(map(_spoken, value)) if isinstance(value, list) else str(value)


def value_in_toml(value: Any, key: Key, *, exactly: bool = True) -> Any:
    """Write a value of a key as it would stand in a case file, to the last bit or shorter."""
    if isinstance(value, tuple):
        return [value_in_toml(item, key, exactly=exactly) for item in value]
    if isinstance(value, Material):
        return _material(value, exactly=exactly)
    if isinstance(value, Path):
        return str(value)
    if not isinstance(value, float) or not isinstance(key.one, Quantity):
        return value
    unit = _UNIT.search(str(key.written_example))
    how = key.one.dimension, unit[1] if unit else key.one.dimension
    if isinstance(value, SpeedCourse):
        return written_course(value, *how, exactly=exactly)
    return written(value, *how, exactly=exactly)


def _material(value: Material, *, exactly: bool) -> str | dict[str, Any]:
    """Write a material: the name of a known one, or its numbers."""
    if MATERIALS.get(value.name) == value:
        return value.name
    named = {} if value.name == name_of_numbers(value.youngs_modulus) else {"name": value.name}
    return {
        **named,
        "youngs_modulus": written(value.youngs_modulus, "Pa", "GPa", exactly=exactly),
        "poisson_ratio": value.poisson_ratio,
        "density": written(value.density, "kg/m^3", "kg/m^3", exactly=exactly),
        **({} if value.citation == GIVEN else {"citation": value.citation}),
    }
