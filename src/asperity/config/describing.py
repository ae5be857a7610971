"""Keys and values of a case as TOML text."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from asperity.config.content import content, described_value, holds_memory
from asperity.config.form import Section, extra_of, is_active
from asperity.config.values import GIVEN, Quantity, allowed_in, name_of_numbers, value_kind
from asperity.errors import InputError
from asperity.reference.materials import MATERIALS, Material
from asperity.units import written


def toml_text(data: Mapping[str, Any]) -> str:
    """Write keys and values as TOML that reads as the same; those at the top come before the sections."""
    sections = {name: value for name, value in data.items() if isinstance(value, Mapping)}
    lines = _lines({name: value for name, value in data.items() if name not in sections})
    for name, section in sections.items():
        lines += ["", f"[{_text(name)}]", *_lines(section)]
    return "\n".join(lines).lstrip() + "\n"


def _lines(data: Mapping[str, Any]) -> list[str]:
    return [f"{_text(name)} = {toml_value(value)}" for name, value in data.items()]


def _text(name: str) -> str:
    bare = name.isascii() and name.replace("-", "_").isidentifier()
    return name if bare else toml_value(name)


def toml_value(value: object) -> str:
    """Write one value as it stands behind the = of a key."""
    if isinstance(value, Mapping):
        inside = ", ".join(f"{_text(name)} = {toml_value(item)}" for name, item in value.items())
        return f"{{ {inside} }}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(toml_value, value))}]"
    if isinstance(value, float):
        return repr(value)  # inf and nan, too, are spelled as in Python
    return json.dumps(value, ensure_ascii=False, default=described_value).replace("\x7f", "\\u007f")


_UNIT = re.compile(r"\d\.? ([^\"',\]]+)")  # in an example, as "25 mm" or ["0.2 m", "0.4 m"]


class CaseKey(NamedTuple):
    """One key of a case."""

    dotted: str  # name with its section, as "contact.spacing"
    name: str
    field: FieldInfo
    section: type[BaseModel]

    @property
    def default(self) -> Any:
        """The default as written in TOML; None if there is no fixed one."""
        return extra_of(self.field)["default"]

    @property
    def otherwise(self) -> str:
        """What happens without the key, where there is no fixed default."""
        return str(extra_of(self.field)["otherwise"])


def parameters(case: Section) -> list[dict[str, Any]]:
    """List the keys that matter in a case.

    Returns
    -------
    list of dict
        For each key: ``key`` (dotted), ``value`` and ``default`` (text with units), ``is_default`` and
        ``note`` (what the key is).
    """
    listed = []
    for entry in entries(type(case)):
        title, _, _ = entry.dotted.rpartition(".")
        section: Section = getattr(case, title) if title else case
        if not is_active(section, entry.name):
            continue
        value, usual = getattr(section, entry.name), section.default_of(entry.name)
        default = entry.otherwise if usual is None else in_words(usual, entry.field)
        text = default if value is None else in_words(value, entry.field)
        if text:
            item = {"key": entry.dotted, "value": text, "default": default}
            same = content(value) == content(usual)
            listed.append({**item, "is_default": same, "note": entry.field.description})
    return listed


def in_words(value: object, field: FieldInfo) -> str:
    """Write a value of a key for people, in the unit of its default or its example: ``"300 MN/m"``."""
    if holds_memory(value):
        return described_value(value)
    if isinstance(value, tuple):
        return ", ".join(in_words(item, field) for item in value)
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, Path):
        return value.name
    if isinstance(value, Material):
        return words_of_material(_material(value, exactly=False))
    return _quantity(value, field, exactly=False) if isinstance(value, float) else str(value)


def words_of_material(value: str | dict[str, Any]) -> str:
    """Write a material for people: its name, or its numbers."""
    numbers = {} if isinstance(value, str) else {k: v for k, v in value.items() if k != "citation"}
    return ", ".join(f"{name} {item}" for name, item in numbers.items()) or str(value)


def in_toml(section: Section, in_memory: Callable[[str, Any], Any]) -> dict[str, Any]:
    """Keys that are not at their defaults as they would stand in a case file, to the last bit.

    `in_memory` says what stands for the surface or table that a dotted key has instead of a file.
    """
    return _in_toml(section, section.given(), "", in_memory)


def _in_toml(
    section: Section, given: Mapping[str, Any], title: str, in_memory: Callable[[str, Any], Any]
) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in given.items():
        inner = getattr(section, name)
        if isinstance(inner, Section):
            found[name] = _in_toml(inner, value, f"{name}.", in_memory)
        elif holds_memory(value):
            found[name] = in_memory(f"{title}{name}", value)
        else:
            found[name] = value_in_toml(value, type(section).model_fields[name])
    return found


def value_in_toml(value: Any, field: FieldInfo) -> Any:
    """Write a value of a key as it would stand in a case file."""
    if isinstance(value, tuple):
        return [value_in_toml(item, field) for item in value]
    if isinstance(value, Material):
        return _material(value, exactly=True)
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, float) and isinstance(value_kind(field.annotation, field.metadata), Quantity):
        return _quantity(value, field, exactly=True)
    return value


def refused(dotted: str, value: object) -> NoReturn:
    """Refuse to write a case of something that stands in memory."""
    remedy = 'Save it first, as np.save("map.npy", heights), and name the file in the case.'
    raise InputError(dotted, described_value(value), "a file, where a case shall be written", remedy)


def _quantity(value: float, field: FieldInfo, *, exactly: bool) -> str:
    """Write a number with its unit, if it has one."""
    kind = value_kind(field.annotation, field.metadata)
    if not isinstance(kind, Quantity):
        return str(value)
    example = extra_of(field)["example"] if extra_of(field)["default"] is None else extra_of(field)["default"]
    unit = _UNIT.search(str(example))
    return written(value, kind.dimension, unit[1] if unit else kind.dimension, exactly=exactly)


def _material(value: Material, *, exactly: bool) -> str | dict[str, Any]:
    """Write a material: the name of a known one, or its numbers."""
    if MATERIALS.get(value.name) == value:
        return value.name
    named = {} if value.name == name_of_numbers(value.youngs_modulus) else {"name": value.name}
    told = {} if value.citation == GIVEN else {"citation": value.citation}
    return {
        **named,
        "youngs_modulus": written(value.youngs_modulus, "Pa", "GPa", exactly=exactly),
        "poisson_ratio": value.poisson_ratio,
        "density": written(value.density, "kg/m^3", "kg/m^3", exactly=exactly),
        **told,
    }


def commented(model: type[BaseModel], written_out: Mapping[str, str]) -> str:
    """Write a case in TOML: one line for each key with its value, meaning, what is allowed and default.

    Keys without a fixed default are commented out, but for those that are `written_out`.
    """
    lines: list[str] = []
    title = ""
    for entry in entries(model):
        home, _, _ = entry.dotted.rpartition(".")
        if home != title:
            title = home
            lines += [
                "",
                f"[{title}]{'':{_COLUMN - len(title) - 2}}# {model.model_fields[title].description}",
            ]
        lines.append(_line(entry, written_out))
    return "\n".join(lines) + "\n"


_COLUMN = 32  # where comments start, if the value leaves room


def _line(entry: CaseKey, written_out: Mapping[str, str]) -> str:
    value = written_out.get(entry.dotted)
    default = f"default: {entry.otherwise}" if entry.otherwise else "no default"
    if entry.default is not None:
        usual = _toml(entry.default)
        default = "default" if value in (None, usual) else f"default: {usual}"
        value = usual if value is None else value
    companion = extra_of(entry.field)["goes_with"]
    home = entry.dotted.rpartition(".")[0]
    lonely = companion and f"{home}.{companion}" not in written_out
    if companion:
        default += f"; goes with {companion}"
    code = f"{entry.name} = {_toml(extra_of(entry.field)['example']) if value is None else value}"
    if value is None or lonely:
        code = f"# {code}"
    allowed = allowed_in(entry.field).split(", with its unit")[0]
    return f"{code:{_COLUMN - 2}}  # {entry.field.description} ({allowed}; {default})"


def entries(model: type[BaseModel], title: str = "") -> Iterator[CaseKey]:
    """List all keys of a kind of case, those of its sections after those at the top."""
    sections = []
    for name, field in model.model_fields.items():
        if isinstance(field.annotation, type) and issubclass(field.annotation, BaseModel):
            sections.append((name, field.annotation))
        else:
            yield CaseKey(f"{title}.{name}".lstrip("."), name, field, model)
    for name, section in sections:
        yield from entries(section, name)


def _toml(value: object) -> str:
    return json.dumps(value, ensure_ascii=False)
