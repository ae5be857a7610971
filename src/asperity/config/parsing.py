"""From the text of a case to its object, or to all that is wrong with it."""

from __future__ import annotations

import os
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from pydantic import BaseModel, ValidationError

from asperity import decoding
from asperity.arguments import nearest, shown
from asperity.config.case import Case
from asperity.config.keys import BACKSLASH, Problems, allowed_in
from asperity.errors import CaseError, InputError

C = TypeVar("C", bound=Case)
LARGEST_CASE = 2**20  # bytes
MOST_PARTS = 20
"""Parts of a dotted key; those of a case have three. The time to read a key grows with the square of them."""
MOST_VALUES = 2000
"""Keys and values of lists in a case: some twenty times what the longest ones have."""
DEEPEST = 10  # sections and lists inside one another; those of a case are three deep

# Where a run of parts starts, parts and dots are taken whole, so that the search needs time like the text.
_MANY_PARTS = re.compile(
    r"""(?<![\w-])(?:(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+){%d}""" % MOST_PARTS  # noqa: UP031
)


def plain_data(value: Any, depth: int = 0) -> Any:
    """Keys and values as TOML would give them: numbers of Python, lists, and paths as text."""
    if depth > DEEPEST:
        raise _too_deep("case")
    if isinstance(value, Mapping):
        return {str(name): plain_data(item, depth + 1) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain_data(item, depth + 1) for item in value]
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    return value.item() if isinstance(value, np.generic) else value


def read_definition(path: str | os.PathLike[str], what: str, remedy: str) -> str:
    """Read the text of a case or a study that a person has written.

    `what` it holds, and the remedy if it is missing, are for messages.
    """
    allowed = f"the path of a {what} file (TOML)"
    return decoding.read_text(Path(path), str(path), allowed, largest=LARGEST_CASE, remedy=remedy)


def read_toml(text: str, what: str, source: str | os.PathLike[str]) -> dict[str, Any]:
    """Read TOML; what the text is, and where it comes from, are for messages."""
    allowed = f"a {what} in TOML"
    text = text.replace("\r\n", "\n")
    if _MANY_PARTS.search(text):
        raise InputError(str(source), f"a key of more than {MOST_PARTS} parts", allowed)
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # TOML errors, and numbers too long to read
        remedy = 'Strings and quantities stand in double quotes: speed = "1 m/s".'
        place = re.search(r"\(at line (\d+), column \d+\)$", str(error))
        if place and "\\" in text.split("\n")[int(place[1]) - 1]:
            remedy = BACKSLASH
        raise InputError(str(source), f"no TOML ({error})", allowed, remedy) from None


def validated(model: type[C], data: dict[str, Any], text: str, source: str | os.PathLike[str]) -> C:
    """Make a case of a known kind from its keys and values.

    Parameters
    ----------
    model : class of cases
        Its kind.
    data : dict
        Keys and values as TOML gives them, sections as dicts.
    text : str
        The TOML text they come from.
    source : str or path
        Where that comes from, for messages; relative paths start at its folder.

    Returns
    -------
    Case
        The case, in SI.

    Raises
    ------
    CaseError
        With all errors at once, if the keys are wrong.
    """
    try:
        case = model.model_validate(data, context={"folder": Path(source).parent})
    except ValidationError as error:
        raise CaseError(str(source), _messages(error, model)) from None
    case._text, case._given, case._source = text, data, str(source)
    return case


def refuse_vast(data: Mapping[str, Any], source: str) -> None:
    """Refuse what would take long to check and fill screens with errors."""
    level: list[Any] = [data]  # one depth after the other: nothing here may recurse
    count = 0
    for _ in range(DEEPEST):
        inner = [item for each in level for item in (each.values() if isinstance(each, Mapping) else each)]
        count += len(inner)
        if count > MOST_VALUES:
            allowed = f"a case with at most {MOST_VALUES}"
            remedy = "Keep heights in a file of their own."
            raise InputError(source, f"{count} keys and values", allowed, remedy)
        level = [item for item in inner if isinstance(item, Mapping | list | tuple)]
    if level:
        raise _too_deep(source)


def _too_deep(source: str) -> InputError:
    received = f"sections or lists more than {DEEPEST} deep inside one another"
    return InputError(source, received, "keys, sections, and lists of values")


def _messages(error: ValidationError, model: type[BaseModel]) -> list[str]:
    messages: list[str] = []
    for item in error.errors(include_url=False):
        name = _dotted(item["loc"])
        cause = item.get("ctx", {}).get("error")
        if isinstance(cause, Problems):
            messages += [_message(".".join(filter(None, (name, each.what))), each) for each in cause.errors]
        elif isinstance(cause, InputError):
            messages.append(_message(name, cause))
        elif item["type"] == "extra_forbidden":
            messages.append(_unknown(item["loc"], model))
        else:
            received = "nothing" if item["type"] == "missing" else shown(item["input"])
            messages.append(str(InputError(name, received, _allowed(item["loc"], model))))
    return messages


def _message(name: str, error: InputError) -> str:
    return str(InputError(name or "the case", error.received, error.allowed, error.remedy))


def _dotted(location: tuple[int | str, ...]) -> str:
    text = ""
    for part in location:
        text += f"[{part + 1}]" if isinstance(part, int) else f".{part}"
    return text.lstrip(".")


def _sections(model: type[BaseModel]) -> dict[str, type[BaseModel]]:
    found: dict[str, type[BaseModel]] = {}
    for name, field in model.model_fields.items():
        if isinstance(field.annotation, type) and issubclass(field.annotation, BaseModel):
            found[name] = field.annotation
    return found


def _unknown(location: tuple[int | str, ...], model: type[BaseModel]) -> str:
    """Message about an unknown key: the nearest one here, or the section in which it would be known."""
    *path, name = map(str, location)
    sections = _sections(model)
    here: type[BaseModel] = sections[path[0]] if path else model
    place = f"keys of [{path[0]}]" if path else "keys at the top of a case"
    remedy = nearest(name, list(here.model_fields))
    homes = [f"[{title}]" for title, section in sections.items() if name in section.model_fields]
    if path and name in model.model_fields:
        homes.insert(0, "the top of the case, above the first section")
    if homes:
        remedy = f"Move it to {homes[0]}."
    return str(
        InputError(_dotted(location), "an unknown key", f"{place}: {', '.join(here.model_fields)}", remedy)
    )


def _allowed(location: tuple[int | str, ...], model: type[BaseModel]) -> str:
    here, names = model, [part for part in location if isinstance(part, str)]
    sections = _sections(model)
    if names[0] in sections:
        if len(names) == 1:
            return f"a section [{names[0]}]"
        here = sections[names.pop(0)]
    return allowed_in(here.model_fields[names[0]])
