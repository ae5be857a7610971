"""Headings of heights as text: titles of columns, units, and sizes that lines above the numbers state."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from asperity.arguments import Array, require
from asperity.errors import InputError
from asperity.surfaces.readers.hints import advice
from asperity.units import factor, quantity

_NUMBER = r"[-+]?\d++(?:[.,]\d*+)?(?:[eE][-+]?\d++)?"
# For lines in which one blank stands for all white space: whatever the line, they need time like its length.
_BRACKET = re.compile(r"[\[(] ?([^\s\[\]()\d]{1,20}) ?[\])]")
_UNIT_LINE = re.compile(r"(.*?)\bunits?\b ?[:=]? ?[\[(]?([^\s\[\]();,]{1,20})", re.IGNORECASE)
_PIXEL_LINE = re.compile(
    r"(pixel(?:[ _]size)?|spacing|sampl(?:e|ing)[ _](?:spacing|interval|distance)|dx|dy)"
    rf" ?[:=;]? ?({_NUMBER}) ?([^\s\d;,]{{1,20}})[;,]*",
    re.IGNORECASE,
)
_VALUE_LINE = re.compile(rf"([^:=;\d]{{1,40}}?) ?[:=;] ?(?:({_NUMBER}) ?)?([^\s\d;,:=]{{1,20}})[;,]*")
"""``Width: 12.0 µm``, or of ``Value units: m`` the unit alone."""
_WIDTH = {
    "width",
    "breite",
    "largeur",
    "larghezza",
    "ancho",
    "anchura",
    "largura",
    "šířka",
    "szerokość",
    "ширина",
}
_HEIGHT = {"height", "höhe", "hauteur", "altezza", "alto", "altura", "výška", "wysokość", "высота"}
_LATERAL_WORDS = {"x", "y", "xy", "lateral", "length", "distance", "position", "pixel"}
_BEHIND_IN = re.compile(r"(?:.*\bin |[^/]*/) ?(\S+)", re.IGNORECASE)
_LENGTH = re.compile(
    r"[npuµμmc]?m|å|angstr[oö]ms?|microns?|mils?|inch(?:es)?|(?:nano|pico|mi[ck]ro|milli|centi)?m[eè]t(?:er|re)s?",
    re.IGNORECASE,
)
_TRUTH = re.compile(r"[\[(]? ?(?:1 ?/ ?0|0 ?/ ?1|bool(?:ean)?|true/false) ?[\])]?", re.IGNORECASE)
_VALID = re.compile(r"\W*(?:is[ _])?(valid|validity|validité|gültig|gueltig|valide)\b", re.IGNORECASE)
_INVALID = re.compile(r"\W*(?:is[ _])?(invalid|ungültig|ungueltig|missing|bad|masked)\b", re.IGNORECASE)
MOST_TITLE = 200
"""Characters of a title."""
MOST_WORDS = 4
"""Words of a title whose last is its unit."""


@dataclass(frozen=True)
class Title:
    """Title of a column."""

    name: str
    unit: str  # as it is written; empty without one


def titles_of(lines: Sequence[str], delimiter: str | None, columns: int) -> list[Title]:
    """Titles of several columns, of which at least one names a unit, from the lines above them; else none.

    Units stand in brackets, behind "in" or a stroke, as the last word of a title (``Lateral um``), or in a
    line of their own below the titles. The last line of titles counts, whose empty cells at the end are left
    out. The delimiter of the columns is None for white space.
    """
    if columns < 2:
        return []
    rows = [_cells(text, delimiter, columns) for text in lines if len(text) <= MOST_TITLE * columns]
    for number in range(len(rows) - 1, -1, -1):
        cells = rows[number]
        if len(cells) != columns:
            continue
        if units := _units_alone(cells):
            above = (row for row in reversed(rows[:number]) if len(row) == columns)
            names = next(above, [""] * columns)
            return [Title(name, unit) for name, unit in zip(names, units, strict=True)]
        titles = [Title(cell, _unit_of(cell)) for cell in cells]
        if any(title.unit for title in titles):
            return titles
    return []


def _cells(text: str, delimiter: str | None, columns: int) -> list[str]:
    """Cells of a line, as many as there are columns if they can be told apart."""
    plain = uncommented(text)
    ways = [plain.split(delimiter)] if delimiter else [re.split(r"\t|\s{2,}", plain), plain.split()]
    for cells in ways:
        found = [" ".join(cell.strip().strip('"').split()) for cell in cells]
        while found and not found[-1]:
            found.pop()
        if len(found) == columns:
            return found
    line = " ".join(plain.split())
    ends = [match.end() for match in _BRACKET.finditer(line)]
    if len(ends) != columns:
        return []
    return [line[start:end].strip(" ,;") for start, end in zip([0, *ends[:-1]], ends, strict=True)]


def uncommented(text: str) -> str:
    """Line without the mark of a comment before it."""
    return text.strip().lstrip("#%/!").strip()


def _units_alone(cells: list[str]) -> list[str]:
    """Units of a line that holds nothing else; none of another line."""
    bare = [cell.strip("[]() ") for cell in cells]
    known = [bool(_LENGTH.fullmatch(unit) or _TRUTH.fullmatch(unit) or unit in ("", "-")) for unit in bare]
    return bare if all(known) and any(_LENGTH.fullmatch(unit) for unit in bare) else []


def _unit_of(title: str) -> str:
    """Unit that a title names; empty without one."""
    if brackets := _BRACKET.findall(title):
        return str(brackets[-1])
    if any(mark.isdigit() for mark in title):
        return ""
    *before, last = title.split() or [""]
    behind = _BEHIND_IN.fullmatch(title)
    for word in (behind[1] if behind else "", last if before else ""):
        if _LENGTH.fullmatch(word):
            return word
    return ""


def without_invalid(table: Array, titles: list[Title]) -> tuple[Array, list[Title]]:
    """Heights without those that a column of ones and zeros calls invalid, and without that column."""
    for number, title in enumerate(titles):
        named = _VALID.match(title.name) or _INVALID.match(title.name)
        flags = table[:, number]
        if not named or not np.isin(flags, (0.0, 1.0)).all():
            continue
        valid = flags == (0.0 if _INVALID.match(title.name) else 1.0)
        rest = np.delete(table, number, axis=1)
        rest[~valid, -1] = np.nan
        return rest, [*titles[:number], *titles[number + 1 :]]
    return table, titles


FINER = 100.0
"""Least ratio of the unit of positions to that of heights at which several columns are lines: mm to µm."""


def units_of_lines(titles: list[Title]) -> tuple[float, float] | None:
    """Units of positions and of heights, m, of three columns or more whose titles are those of lines.

    Each title has a unit: the first a much larger one, all others the same. None for any other heading.
    """
    if len(titles) < 3:
        return None
    try:
        along, *heights = (_length(title.unit) for title in titles)
    except (InputError, ValueError):
        return None
    return (along, heights[0]) if len(set(heights)) == 1 and along >= FINER * heights[0] else None


def parsed_header(lines: Sequence[str], titles: list[Title]) -> dict[str, float]:
    """Find units and sizes in the lines above the numbers.

    Understood are column titles with units (``x [mm]; z (µm)``, ``Height (nm)``), lines such as ``# unit:
    um``, ``height unit = nm``, ``lateral unit: mm`` (a bare ``unit`` is that of the heights), ``# pixel:
    1.5 um``, ``dx = 1 mm``, and ``Width: 12 µm`` with ``Height: 5 µm`` of a map, as Gwyddion writes them.

    Returns lengths in m, where the lines do not leave them out: of one unit of ``x``, ``y`` and ``z``, the
    distances ``dx`` and ``dy`` of neighbouring points, which are the same where only one is given, and
    ``width`` and ``height`` of a map whose rows of numbers lie along its width.
    """
    cleaned = [" ".join(uncommented(each).split()) for each in lines]
    stated: dict[str, float] = {}
    pixels: dict[str, float] = {}
    for text in cleaned:
        if match := _UNIT_LINE.match(text):
            stated |= dict.fromkeys("xy" if _is_lateral(match[1]) else "z", _length(match[2]))
        if match := _PIXEL_LINE.fullmatch(text):
            pixels[match[1].lower()] = _quantity(match[2], match[3])
    stated |= _extent(lines, cleaned)
    units = _column_units(titles) or _unit_of_one(cleaned, titles)
    stated |= ({"y": units["x"]} if "x" in units else {}) | units
    if pixels:
        dx = pixels.get("dx", next(iter(pixels.values())))
        stated |= {"dx": dx, "dy": pixels.get("dy", dx)}
    return stated


def _column_units(titles: list[Title]) -> dict[str, float]:
    """Units of the titles of two columns x, z or of three, x, y, z."""
    axes = {2: "xz", 3: "xyz"}.get(len(titles), "")
    return {axis: _length(title.unit) for axis, title in zip(axes, titles, strict=False) if title.unit}


def _unit_of_one(lines: list[str], titles: list[Title]) -> dict[str, float]:
    """Unit of heights that one title names, of a single column or of all of a matrix."""
    for text in reversed([] if titles else lines):
        units = _BRACKET.findall(text)
        if len(units) == 1 and not _is_lateral(text):
            return {"z": _length(units[0])}
        few = len(text) <= MOST_TITLE and len(text.split()) <= MOST_WORDS
        if few and not units and not _is_lateral(text) and (unit := _unit_of(text)):
            return {"z": _length(unit)}
    return {}


def _extent(lines: Sequence[str], cleaned: list[str]) -> dict[str, float]:
    """Width and height of a map, and the unit of its heights, by their names or as Gwyddion orders them."""
    values = [_VALUE_LINE.fullmatch(text) for text in cleaned]
    found: dict[str, float] = {}
    for value in values:
        for name, words in (("width", _WIDTH), ("height", _HEIGHT)):
            if value and value[2] and value[1].lower() in words:
                found[name] = _quantity(value[2], value[3])
    if len(found) == 2:
        return found
    comments = [number for number, text in enumerate(lines) if text.lstrip().startswith("#")]
    if comments != [0, 1, 2, 3] or len(lines) != 4:  # channel, width, height, unit; in any language
        return {}
    _, width, height, unit = values
    lengths = [each for each in (width, height) if each and each[2] and _LENGTH.fullmatch(each[3])]
    if len(lengths) < 2 or not unit or unit[2] or not _LENGTH.fullmatch(unit[3]):
        return {}
    sizes = [_quantity(each[2], each[3]) for each in lengths]
    return {"width": sizes[0], "height": sizes[1], "z": _length(unit[3])}


def _is_lateral(words: str) -> bool:
    return not _LATERAL_WORDS.isdisjoint(re.findall(r"[a-z]+", words.lower()))


def _quantity(number: str, unit: str) -> float:
    value = quantity(f"{number.replace(',', '.')} {unit}", "m")
    require(
        value > 0.0, "length in the header", f"{number} {unit}", "a length above zero", "Correct the header."
    )
    return value


def _length(unit: str) -> float:
    try:
        spelt = unit.lower().replace("mikro", "micro").replace("è", "e").replace("ö", "o")
        return factor(unit if len(unit) <= 3 else spelt, "m")
    except InputError as error:
        correct = "Correct the header"
        remedy = advice("height_unit", "um", f"{correct}, or leave the bracket out and give", f"{correct}.")
        raise InputError("unit in the header", repr(unit), "a unit of length", remedy) from error
