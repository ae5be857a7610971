"""From the text of a case to its object, or to all that is wrong with it."""

from __future__ import annotations

import os
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from pydantic import ValidationError

from asperity import text_files
from asperity.config.form import Section
from asperity.config.messages import case_error
from asperity.config.values import BACKSLASH
from asperity.errors import InputError

C = TypeVar("C", bound=Section)
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


@dataclass(frozen=True)
class Origin:
    """Where keys and values come from.

    Attributes
    ----------
    source : str
        Its name, for messages.
    folder : Path
        Where relative paths start.
    units : bool
        Whether quantities must carry their units, as in a file; from Python they may be numbers in SI.
    """

    source: str = "case"
    folder: Path = Path()
    units: bool = False

    @classmethod
    def file(cls, path: str | os.PathLike[str]) -> Origin:
        """Origin of what stands in a file."""
        return cls(str(path), Path(path).parent, units=True)


FROM_PYTHON = Origin()


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
    return text_files.read_text(Path(path), str(path), allowed, largest=LARGEST_CASE, remedy=remedy)


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


def validated(model: type[C], data: dict[str, Any], origin: Origin) -> C:
    """Make a case of a known kind, or another form, from its keys and values, sections as dicts; in SI.

    Raises
    ------
    CaseError
        With all errors at once, if the keys are wrong.
    """
    try:
        return model.model_validate(data, context={"folder": origin.folder, "units": origin.units})
    except ValidationError as error:
        raise case_error(error, model, origin.source) from None


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
