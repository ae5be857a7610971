"""A case in words: a commented template, and the list of parameters that a report shows."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from asperity.config.keys import Quantity, allowed_in, extra_of, is_active, value_kind
from asperity.units import factor


class Entry(NamedTuple):
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


def parameters(case: BaseModel, given: Mapping[str, Any]) -> list[dict[str, Any]]:
    """List the keys that matter in a case.

    Parameters
    ----------
    case : pydantic model
        The case.
    given : mapping
        The keys that its file holds, as TOML gives them.

    Returns
    -------
    list of dict
        For each key: ``key`` (dotted), ``value`` and ``default`` (text with units), ``is_default`` and
        ``note`` (what the key is).
    """
    listed = []
    for entry in entries(type(case)):
        title, _, _ = entry.dotted.rpartition(".")
        section = getattr(case, title) if title else case
        written = given.get(title, {}) if title else given
        if not is_active(section, entry.name):
            continue
        default = entry.otherwise if entry.default is None else _human(entry.default)
        value, same = default, True
        if entry.name in written:
            value, same = _human(written[entry.name]), _is_default(entry, getattr(section, entry.name))
        if value:
            item = {"key": entry.dotted, "value": value, "default": default, "is_default": same}
            listed.append({**item, "note": entry.field.description})
    return listed


def with_unit(value: float, field: FieldInfo) -> str:
    """Write a value in the unit that the example of its key has.

    Parameters
    ----------
    value : float
        In SI.
    field : pydantic field
        The key.

    Returns
    -------
    str
        As ``"300 MN/m"``, or the number alone where the key has no unit.
    """
    kind = value_kind(field.annotation, field.metadata)
    example = str(extra_of(field)["example"]).strip('"')
    if not isinstance(kind, Quantity):
        return f"{value:.6g}"
    unit = example.split(" ", 1)[1]
    return f"{value / factor(unit, kind.dimension):.6g} {unit}"


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


def _line(entry: Entry, written_out: Mapping[str, str]) -> str:
    value = written_out.get(entry.dotted)
    default = f"default: {entry.otherwise}" if entry.otherwise else "no default"
    if entry.default is not None:
        default = "default"
        value = _toml(entry.default) if value is None else value
    companion = extra_of(entry.field)["goes_with"]
    home = entry.dotted.rpartition(".")[0]
    lonely = companion and f"{home}.{companion}" not in written_out
    if companion:
        default += f"; goes with {companion}"
    code = f"{entry.name} = {value if value is not None else extra_of(entry.field)['example']}"
    if value is None or lonely:
        code = f"# {code}"
    allowed = allowed_in(entry.field).split(", with its unit")[0]
    return f"{code:{_COLUMN - 2}}  # {entry.field.description} ({allowed}; {default})"


def entries(model: type[BaseModel], title: str = "") -> Iterator[Entry]:
    """List all keys of a kind of case, those of its sections after those at the top."""
    sections = []
    for name, field in model.model_fields.items():
        if isinstance(field.annotation, type) and issubclass(field.annotation, BaseModel):
            sections.append((name, field.annotation))
        else:
            yield Entry(f"{title}.{name}".lstrip("."), name, field, model)
    for name, section in sections:
        yield from entries(section, name)


def _is_default(entry: Entry, value: object) -> bool:
    kind = value_kind(entry.field.annotation, entry.field.metadata)
    if entry.default is None or kind is None:
        return False
    if isinstance(entry.default, tuple):
        return value == tuple(kind(item) for item in entry.default)  # type: ignore[call-arg]
    return bool(value == kind(entry.default))  # type: ignore[call-arg]


def _toml(value: object) -> str:
    return json.dumps(value, ensure_ascii=False)


def _human(value: object) -> str:
    if isinstance(value, list | tuple):
        return ", ".join(map(_human, value))
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {_human(item)}" for name, item in value.items())
    if isinstance(value, bool):
        return "yes" if value else "no"
    return str(value)
