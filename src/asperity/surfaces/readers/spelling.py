"""How a hint is written where the user stands: as an argument in Python, an option, or a key of a case."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any

Value = str | int | bool | None
Spelling = Callable[[str, Value], str | None]
"""Writes a hint of `read_surface` with a value, or its name alone; None where there is no way to say it."""


def in_python(name: str, value: Value) -> str:
    """Write a hint as an argument: ``height_unit="um"``."""
    if value is None:
        return name
    return f"{name}={json.dumps(value, ensure_ascii=False) if isinstance(value, str) else value}"


def on_command_line(name: str, value: Value) -> str:
    """Write a hint as an option: ``--height-unit um``."""
    option = f"--{name.replace('_', '-')}"
    if value is None or value is True:
        return option
    word = str(value)
    return f'{option} "{word}"' if set(word) & set(" ,;") else f"{option} {word}"


def in_case(section: str, keys: Mapping[str, str]) -> Spelling:
    """Write a hint as a key of a case: ``height_unit = "um" in [surface]``.

    `keys` are those that the section has, by the hints that they are; others cannot be said there.
    """

    return InCase(section, dict(keys))


@dataclass(frozen=True)
class InCase:
    """Writes hints as `in_case` says."""

    section: str
    keys: Mapping[str, str]

    def __call__(self, name: str, value: Value) -> str | None:
        """Write a hint."""
        if name not in self.keys or value is None:
            return self.keys.get(name)
        return f"{self.keys[name]} = {json.dumps(value, ensure_ascii=False)} in [{self.section}]"


_spelling: ContextVar[Spelling] = ContextVar("spelling", default=in_python)


@contextmanager
def spelled(spelling: Spelling) -> Iterator[None]:
    """Write hints in another way while the body of the ``with`` statement reads files.

    That way is `in_python`, `on_command_line` or what `in_case` makes.
    """
    token = _spelling.set(spelling)
    try:
        yield
    finally:
        _spelling.reset(token)


def current() -> list[Any]:
    """Describe the spelling in use, as `spelling_of` takes it: what JSON can hold."""
    spelling = _spelling.get()
    if isinstance(spelling, InCase):
        return [spelling.section, dict(spelling.keys)]
    return [spelling.__name__]


def spelling_of(description: list[Any]) -> Spelling:
    """Make the spelling that `current` describes."""
    if len(description) > 1:
        return InCase(*description)
    return {"in_python": in_python, "on_command_line": on_command_line}[description[0]]


def advice(name: str, value: Value, lead: str, otherwise: str) -> str:
    """Advise to give a hint with a value, or an example of one, as it is written where the user stands.

    `lead` comes before it; `otherwise` is the sentence for a place where the hint cannot be given.
    """
    written = _spelling.get()(name, value)
    return otherwise if written is None else f"{lead} {written}."


def spell(name: str, value: Value = None) -> str:
    """Write a hint with a value as it is written where the user stands; its bare name if it has no place."""
    return _spelling.get()(name, value) or name
