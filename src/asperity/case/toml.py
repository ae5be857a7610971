"""TOML as text: what a person wrote is read, and what a case says is written."""

import json
import os
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from asperity import text_files
from asperity.arguments import FilePath
from asperity.case.in_memory import described_value
from asperity.errors import InputError
from asperity.written_numbers import with_article

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


def read_definition(path: FilePath, what: str, remedy: str) -> str:
    """Read the text of a case or a study that a person has written.

    `what` it holds, and the remedy if it is missing, are for messages.
    """
    allowed = f"the path of {with_article(what)} file (TOML)"
    return text_files.read_text(Path(path), str(path), allowed, largest=LARGEST_CASE, remedy=remedy)


def read_toml(text: str, what: str, source: FilePath) -> dict[str, Any]:
    """Read TOML; what the text is, and where it comes from, are for messages."""
    allowed = f"{with_article(what)} in TOML"
    text = text.replace("\r\n", "\n")
    if _MANY_PARTS.search(text):
        raise InputError(str(source), f"a key of more than {MOST_PARTS} parts", allowed)
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # TOML errors, and numbers too long to read
        remedy = 'Strings and quantities stand in double quotes: speed = "1 m/s".'
        place = re.search(r"\(at line (\d+), column \d+\)$", str(error))
        if place and "\\" in text.split("\n")[int(place[1]) - 1]:
            remedy = text_files.BACKSLASH
        raise InputError(str(source), f"no TOML ({error})", allowed, remedy) from None


def refuse_vast(data: Mapping[str, Any], source: str) -> None:
    """Refuse what would take long to check and fill screens with errors."""
    level: list[Any] = [dict(data)]  # one depth after the other: nothing here may recurse
    count = 0
    for _ in range(DEEPEST):
        inner = [item for each in level for item in (each.values() if isinstance(each, dict) else each)]
        count += len(inner)
        if count > MOST_VALUES:
            allowed = f"a case with at most {MOST_VALUES}"
            remedy = "Keep heights in a file of their own."
            raise InputError(source, f"{count} keys and values", allowed, remedy)
        level = [item for item in inner if isinstance(item, dict | list | tuple)]
        if not level:
            return
    raise _too_deep(source)


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


def _too_deep(source: str) -> InputError:
    received = f"sections or lists more than {DEEPEST} deep inside one another"
    return InputError(source, received, "keys, sections, and lists of values")


def toml_text(data: Mapping[str, Any]) -> str:
    """Write keys and values as TOML that reads as the same; those at the top come before the sections."""
    sections = {name: value for name, value in data.items() if isinstance(value, Mapping)}
    lines = _lines({name: value for name, value in data.items() if name not in sections})
    repeated = {name.partition("[")[0] for name in sections if name.endswith("]")}
    for name, section in sections.items():
        plain = name.partition("[")[0]
        lines += ["", f"[[{plain}]]" if plain in repeated else f"[{_name(name)}]", *_lines(section)]
    return "\n".join(lines).lstrip() + "\n"


def _lines(data: Mapping[str, Any]) -> list[str]:
    return [f"{_name(name)} = {toml_value(value)}" for name, value in data.items()]


def _name(name: str) -> str:
    bare = name.isascii() and name.replace("-", "_").isidentifier()
    return name if bare else toml_value(name)


def toml_value(value: object) -> str:
    """Write one value as it stands behind the = of a key."""
    if isinstance(value, Mapping):
        inside = ", ".join(f"{_name(name)} = {toml_value(item)}" for name, item in value.items())
        return f"{{ {inside} }}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(toml_value, value))}]"
    if isinstance(value, float):
        return repr(value)  # inf and nan, too, are spelled as in Python
    return json.dumps(value, ensure_ascii=False, default=described_value).replace("\x7f", "\\u007f")
