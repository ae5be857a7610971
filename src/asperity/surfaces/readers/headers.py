"""Units and pixel sizes in the header lines of a text file."""

from __future__ import annotations

import re
from dataclasses import dataclass

from asperity.errors import InputError
from asperity.surfaces.readers.spelling import advice
from asperity.units import factor, quantity

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
