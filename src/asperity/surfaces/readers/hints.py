"""What a user may say about a file of heights, and how that is written where the user stands."""

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import asdict, dataclass, field, replace
from typing import Literal

import numpy as np

from asperity.arguments import real, require, shown
from asperity.units import factor, quantity

Value = str | int | bool | None
Length = str | float


@dataclass(frozen=True)
class Spelling:
    """How a hint of `read_surface` is written: as an argument in Python, an option, or a key of a case."""

    style: Literal["argument", "option", "key"] = "argument"
    section: str = ""  # of the case
    keys: Mapping[str, str] = field(default_factory=dict)  # that it has, by the hints that they are

    def write(self, name: str, value: Value) -> str | None:
        """Write a hint with a value, or its name alone; None where there is no way to say it."""
        if self.style == "option":
            option = f"--{name.replace('_', '-')}"
            if value is None or value is True:
                return option
            return f'{option} "{value}"' if set(str(value)) & set(" ,;") else f"{option} {value}"
        key = self.keys.get(name) if self.style == "key" else name
        if key is None or value is None:
            return key
        if self.style == "key":
            return f"{key} = {json.dumps(value, ensure_ascii=False)} in [{self.section}]"
        return f"{key}={json.dumps(value, ensure_ascii=False) if isinstance(value, str) else value}"


in_python = Spelling()
"""As ``height_unit="um"``."""
on_command_line = Spelling("option")
"""As ``--height-unit um``."""
SPELLING: ContextVar[Spelling] = ContextVar("spelling", default=in_python)
"""The one in use."""


def in_case(section: str, keys: Mapping[str, str]) -> Spelling:
    """Write a hint as a key of a case: ``height_unit = "um" in [surface]``.

    `keys` are those that the section has, by the hints that they are; others cannot be said there.
    """
    return Spelling("key", section, dict(keys))


@contextmanager
def spelled(spelling: Spelling) -> Iterator[None]:
    """Write hints in another way while the body of the ``with`` statement reads files."""
    token = SPELLING.set(spelling)
    try:
        yield
    finally:
        SPELLING.reset(token)


def advice(name: str, value: Value, lead: str, otherwise: str) -> str:
    """Advise to give a hint with a value, or an example of one, as it is written where the user stands.

    `lead` comes before it; `otherwise` is the sentence for a place where the hint cannot be given.
    """
    written = SPELLING.get().write(name, value)
    return otherwise if written is None else f"{lead} {written}."


def spell(name: str, value: Value = None) -> str:
    """Write a hint with a value as it is written where the user stands; its bare name if it has no place."""
    return SPELLING.get().write(name, value) or name


_HEADING = 'Save it as text with a heading, as "{}".'


@dataclass(frozen=True)
class Hints:
    """Checked hints in SI; None where nothing was said."""

    array: str | None = None  # name of the array, variable or channel to read
    height_unit: float | None = None  # length in m of one unit of the heights
    pixel: tuple[float, float] | None = None  # (dx, dy), m
    pixel_unit: float | None = None  # length in m of one unit of the coordinates
    decimal: str | None = None  # mark of a text file
    section: bool = False  # whether it is that of a body, whose places may be uneven

    def heights_in(self, source: str, stated: float | None = None) -> float:
        """Return the factor of the heights: the hint, else what the file states, else an `InputError`."""
        remedy = advice("height_unit", "um", "Give it, as in", _HEADING.format("z (um)"))
        chosen = self.height_unit or stated or 0.0
        require(chosen, source, "heights without a unit", "a unit of the heights", remedy)
        return chosen

    def spacing_in(self, source: str, stated: tuple[float, float] | None = None) -> tuple[float, float]:
        """Return the spacing: the hint, else what the file states, else an `InputError`."""
        remedy = advice("pixel", "1.5 um", "Give it, as in", _HEADING.format("# pixel: 1.5 um"))
        chosen = self.pixel or stated
        allowed = "the distance of neighbouring points"
        require(chosen, source, "heights without a pixel size", allowed, remedy)
        return chosen or (0.0, 0.0)

    def lateral_in(self, source: str, stated: float | None, example: str, lead: str, otherwise: str) -> float:
        """Return the factor of coordinates as `heights_in` does; the rest is as of `advice`."""
        chosen = self.pixel_unit or stated or 0.0
        remedy = advice("pixel_unit", example, lead, otherwise)
        require(chosen, source, "coordinates without a unit", "a unit of the coordinates", remedy)
        return chosen

    def refuse(self, source: str, kind: str) -> None:
        """Raise an `InputError` if anything was said about a format that states everything itself."""
        given = asdict(replace(self, section=False)).items()
        said = [spell(name) for name, value in given if value not in (None, False)]
        allowed = f"no hints, because {kind} files state their lengths and have one array"
        require(not said, f"hints for {source}", ", ".join(said), allowed, "Leave them out.")


def checked_hints(
    array: str | None = None,
    height_unit: Length | None = None,
    pixel: Length | Sequence[Length] | None = None,
    pixel_unit: Length | None = None,
    decimal: str | None = None,
) -> Hints:
    """Convert hints as a user writes them, see `read_surface`, to SI.

    A unit may be given as its length in m; a bare pixel size is in `pixel_unit`, else in m.
    """
    require(decimal in (None, ".", ","), "decimal", shown(decimal), '"." or ","', "Give one of these.")
    named = array is None or isinstance(array, str)
    require(named, "array", shown(array), "the name of an array", "Write it in quotes.")
    lateral = _unit("pixel_unit", pixel_unit)
    spacing = None if pixel is None else _pair(pixel, lateral or 1.0)
    return Hints(array, _unit("height_unit", height_unit), spacing, lateral, decimal)


def _unit(name: str, unit: Length | None) -> float | None:
    if unit is None:
        return None
    return _positive(name, factor(unit, "m") if isinstance(unit, str) else unit)


def _pair(pixel: Length | Sequence[Length], unit: float) -> tuple[float, float]:
    sizes = list(pixel) if isinstance(pixel, list | tuple | np.ndarray) and np.ndim(pixel) == 1 else [pixel]
    allowed = "one length, or two (dx, dy)"
    require(len(sizes) in (1, 2), "pixel", shown(pixel), allowed, 'Write it as "1.5 um".')
    metres = [quantity(s, "m") if isinstance(s, str) else _positive("pixel", s) * unit for s in sizes]
    return _positive("pixel", metres[0]), _positive("pixel", metres[-1])


def _positive(name: str, value: object) -> float:
    remedy = "Check the number and its unit."
    return real(name, value, "a finite length above zero", above=0.0, remedy=remedy)
