"""How a hint is written where the user stands: as an argument in Python, an option, or a key of a case."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any

from asperity.errors import InputError
from asperity.units import factor, quantity

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


_NUMBER = r"[-+]?\d++(?:[.,]\d*+)?(?:[eE][-+]?\d++)?"
# For lines in which one blank stands for all white space: whatever the line, they need time like its length.
_BRACKET = re.compile(r"[\[(] ?([^\s\[\]()\d]{1,20}) ?[\])]")
_UNIT_LINE = re.compile(r"(.*?)\bunits?\b ?[:=]? ?[\[(]?([^\s\[\]();,]{1,20})", re.IGNORECASE)
_PIXEL_LINE = re.compile(
    rf"(pixel(?:[ _]size)?|spacing|sample spacing|dx|dy) ?[:=]? ?({_NUMBER}) ?([^\s\d;,]{{1,20}})",
    re.IGNORECASE,
)
_LATERAL_WORDS = {"x", "y", "xy", "lateral", "length", "distance", "position", "pixel"}


@dataclass(frozen=True)
class Header:
    """What the header lines of a text file state, in m; None where they are silent."""

    height_unit: float | None = None  # length in m of one unit of the column
    x_unit: float | None = None  # likewise
    y_unit: float | None = None  # likewise
    spacing: tuple[float, float] | None = None  # (dx, dy), m


def parsed_header(lines: list[str], delimiter: str | None, columns: int) -> Header:
    """Find units and pixel sizes in the lines above the numbers.

    Understood are column titles with units (``x [mm]; z (µm)``, ``Height (nm)``), lines such as ``# unit:
    um``, ``height unit = nm``, ``lateral unit: mm`` (a bare ``unit`` is that of the heights), and ``# pixel:
    1.5 um``, ``dx = 1 mm``. The delimiter of the columns is None for white space.
    """
    cleaned = [line.strip().lstrip("#%/!").strip() for line in lines]
    single = [" ".join(line.split()) for line in cleaned]
    titles = _column_units(cleaned, delimiter, columns)
    lateral, height = _unit_lines(single)
    return Header(
        height_unit=titles.get("z", height),
        x_unit=titles.get("x", lateral),
        y_unit=titles.get("y", titles.get("x", lateral)),
        spacing=_pixel_lines(single),
    )


def _column_units(lines: list[str], delimiter: str | None, columns: int) -> dict[str, float]:
    """Units of the column titles: of x, y, z for two or three columns, else of the heights alone."""
    axes = {2: "xz", 3: "xyz"}.get(columns)
    for line in reversed(lines):
        found = _brackets(line)
        if axes is None:
            if len(found) == 1 and not _is_lateral(line):
                return {"z": _length(found[0])}
            continue
        titles = line.split(delimiter) if delimiter else []
        if len(titles) != columns and len(found) == columns:
            return {axis: _length(unit) for axis, unit in zip(axes, found, strict=True)}
        if found and len(titles) == columns:
            units = [_brackets(title) for title in titles]
            return {axis: _length(unit[-1]) for axis, unit in zip(axes, units, strict=True) if unit}
    return {}


def _brackets(text: str) -> list[str]:
    return _BRACKET.findall(" ".join(text.split()))


def _unit_lines(lines: list[str]) -> tuple[float | None, float | None]:
    lateral = height = None
    for line in lines:
        match = _UNIT_LINE.match(line)
        if match and _is_lateral(match[1]):
            lateral = _length(match[2])
        elif match:
            height = _length(match[2])
    return lateral, height


def _pixel_lines(lines: list[str]) -> tuple[float, float] | None:
    found = {}
    for line in lines:
        match = _PIXEL_LINE.fullmatch(line)
        if match:
            found[match[1].lower()] = quantity(f"{match[2].replace(',', '.')} {match[3]}", "m")
    both = [found[name] for name in found if name not in ("dx", "dy")]
    dx = found.get("dx", both[0] if both else found.get("dy"))
    return None if dx is None else (dx, found.get("dy", dx))


def _is_lateral(words: str) -> bool:
    return not _LATERAL_WORDS.isdisjoint(re.findall(r"[a-z]+", words.lower()))


def _length(unit: str) -> float:
    try:
        return factor(unit, "m")
    except InputError as error:
        correct = "Correct the header"
        remedy = advice("height_unit", "um", f"{correct}, or leave the bracket out and give", f"{correct}.")
        raise InputError("unit in the header", repr(unit), "a unit of length", remedy) from error
