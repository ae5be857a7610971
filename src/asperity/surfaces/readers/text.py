"""Text and CSV: lines, point lists and matrices of heights, and what their headings state."""

from __future__ import annotations

import math
import re
from array import array
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from asperity.arguments import Array, require
from asperity.errors import InputError
from asperity.files import amount
from asperity.surfaces.heightmap import Profile
from asperity.surfaces.readers import guards, positions
from asperity.surfaces.readers.hints import Hints, advice, spell
from asperity.text_files import lines_in, number_in, read_text
from asperity.units import factor, quantity

MISSING = {"", "nan", "bad", "na", "n/a", "null", "none"}  # and any number of asterisks
COMMENT = ("#", "%", "//")
MAX_TEXT_BYTES = 1 << 28
MAX_HEADER = 1 << 20  # characters of headings and comments
PIECE = 1 << 16  # fields of a long line that are split off at a time

_CHECK = "Check the file and its separators."
_NUMERIC = re.compile(r"(?:[\d\s.,;+\-eE*]++|nan|bad|null|none|na|n/a)*+", re.IGNORECASE)
_NUMBER = r"[-+]?\d++(?:[.,]\d*+)?(?:[eE][-+]?\d++)?"
# For lines in which one blank stands for all white space: whatever the line, they need time like its length.
_BRACKET = re.compile(r"[\[(] ?([^\s\[\]()\d]{1,20}) ?[\])]")
_UNIT_LINE = re.compile(r"(.*?)\bunits?\b ?[:=]? ?[\[(]?([^\s\[\]();,]{1,20})", re.IGNORECASE)
_PIXEL_LINE = re.compile(
    r"(pixel(?:[ _]size)?|spacing|sampl(?:e|ing)[ _](?:spacing|interval|distance)|dx|dy)"
    rf" ?[:=;]? ?({_NUMBER}) ?([^\s\d;,]{{1,20}})[;,]*",
    re.IGNORECASE,
)
_LATERAL_WORDS = {"x", "y", "xy", "lateral", "length", "distance", "position", "pixel"}


@dataclass(frozen=True)
class Dialect:
    """How numbers are written."""

    delimiter: str | None  # of the columns; None for white space
    decimal_comma: bool  # whether the comma is the decimal mark

    def numbers(self, text: str) -> array[float] | None:
        """Return the numbers of one line, NaN for missing ones; None if it holds anything else."""
        row = array("d")
        rest: str | None = text.rstrip("\r\n")
        while rest is not None:
            words = rest.split(self.delimiter, PIECE)
            rest = words.pop() if len(words) > PIECE else None
            for word in words:
                word = word.strip()
                try:
                    row.append(number_in(word.replace(",", ".") if self.decimal_comma else word))
                except ValueError:
                    if word.lower() not in MISSING and word.strip("*"):
                        return None
                    row.append(math.nan)
        return row

    def is_blank(self, text: str, *, above: bool) -> bool:
        """Whether a line is empty; above the numbers, delimiters alone are as good as nothing."""
        if self.delimiter and above:
            text = text.replace(self.delimiter, "")
        return not text.strip() and (self.delimiter is None or self.delimiter not in text)

    def is_closed(self, text: str) -> bool:
        """Whether a delimiter follows the last number of a line."""
        return self.delimiter is not None and not text.rpartition(self.delimiter)[2].strip()


def read(path: Path, hints: Hints) -> list[guards.Surface]:
    """Read heights from text: tab, semicolon, comma or white space between columns, point or comma decimals.

    One column is a line z; two are x, z at uniform x; three are x, y, z on a regular grid; more are a matrix
    of heights whose rows follow one another along x, so the first axis of the map is the line number. Lines
    beside each other may have their position in the first of three columns or more, see `units_of_lines`.
    Missing heights: ``NaN``, ``BAD``, ``NA``, ``***`` or nothing. Lines above the numbers and lines that
    start with ``#``, ``%`` or ``//`` are header, see `parsed_header`; a hint is stronger than it.
    """
    size, allowed = path.stat().st_size, f"at most {amount(MAX_TEXT_BYTES)} of text"
    remedy = "Crop or split the measurement, or save it as .npy, netCDF or X3P."
    require(size <= MAX_TEXT_BYTES, f"size of {path.name}", amount(size), allowed, remedy)
    content = read_text(path, path.name, "heights as text", largest=size, latin=True)
    dialect = _dialect(lines_in(content), hints.decimal, path.name)
    header_lines, table = _table(lines_in(content), dialect, path.name)
    if (units := units_of_lines(header_lines, table.shape[1])) is not None:
        return _lines(table, *units, hints, path.name)
    header = parsed_header(header_lines, dialect.delimiter, table.shape[1])
    try:
        return _surfaces(table, header, hints, path.name)
    except InputError as error:
        if error.received != positions.UNEVEN or "dx" not in header or "z" not in header:
            raise
    heights = table * hints.heights_in(path.name, header["z"])  # lines without their positions
    return guards.surfaces_of(heights, hints.spacing_in(path.name, (header["dx"], header["dy"])), path.name)


def _dialect(lines: Iterable[str], decimal: str | None, source: str) -> Dialect:
    """Judge by the last lines that hold nothing but numbers and missing markers."""
    numeric = (text.strip(" \r\n") for text in lines if _NUMERIC.fullmatch(text) and text.strip())
    sample = deque(numeric, maxlen=50)
    joined = "\n".join(sample)
    for delimiter in "\t;":
        if delimiter in joined:
            comma = decimal == "," or (decimal is None and "," in joined and "." not in joined)
            return Dialect(delimiter, comma)
    if "," not in joined:
        return Dialect(None, False)
    if decimal is not None:
        return Dialect(None, True) if decimal == "," else Dialect(",", False)
    words = [word for text in sample for word in text.split()]
    if "." in joined or any(w.count(",") > 1 or w.startswith(",") or w.endswith(",") for w in words):
        return Dialect(",", False)
    if len(words) > len(sample) or not all("," in word for word in words):
        return Dialect(None, True)
    received, allowed = f"numbers such as {words[-1][:40]!r}", "an unambiguous decimal mark"
    lead = f"Give {spell('decimal', ',')} if the comma is the decimal mark; if it separates columns, give"
    remedy = advice("decimal", ".", lead, "Write decimal points, or semicolons between columns.")
    raise InputError(source, received, allowed, remedy)


def _table(lines: Iterable[str], dialect: Dialect, source: str) -> tuple[list[str], Array]:
    """Read lines above and among the numbers, and the numbers (rows, columns)."""
    header: list[str] = []
    values, columns, closed, characters = array("d"), 0, True, 0
    blanks = array("q")  # how many rows stand above each empty line
    for number, text in enumerate(lines, 1):
        comment = text.lstrip().startswith(COMMENT)
        if not comment and dialect.is_blank(text, above=not columns):
            blanks.append(len(values) // columns if columns else 0)
            continue
        row = None if comment else dialect.numbers(text)
        if row is None:
            if columns and not comment:
                received, allowed = (
                    f"{text.strip()[:60]!r} in line {number}",
                    "numbers or marks of missing ones",
                )
                raise InputError(source, received, allowed, "Correct or remove the line.")
            header.append(text)
            characters += len(text)
            received = f"more than {amount(MAX_HEADER)} of text that is no number"
            require(characters <= MAX_HEADER, source, received, "heights as text", _CHECK)
            continue
        if not columns:
            columns = len(row)
        if len(row) != columns:
            received = f"{len(row)} values in row {len(values) // columns + 1}"
            allowed = f"{columns}, as in the first row"
            raise InputError(source, received, allowed, "Mark missing heights with NaN.")
        closed = closed and dialect.is_closed(text)
        values.extend(row)
        if len(values) > guards.MAX_POINTS:
            guards.check_claim(source, (len(values) // columns, columns), 1, len(values))
    require(columns, source, "no line of numbers", "heights as text", _CHECK)
    table = np.frombuffer(values).reshape(-1, columns)
    if closed and columns > 1:  # every line ends with a delimiter
        table = table[:, :-1]
    return header, table if table.shape[1] > 1 else _with_gaps(table, blanks)


def _with_gaps(table: Array, blanks: array[int]) -> Array:
    """Single heights (rows, 1), with a missing one for each empty line between them."""
    gaps = np.bincount(np.array(blanks, dtype=np.int64), minlength=len(table))[: len(table)]
    gaps[0] = 0
    spread = np.full((len(table) + int(gaps.sum()), 1), np.nan)
    spread[np.arange(len(table)) + np.cumsum(gaps)] = table
    return spread


def _surfaces(table: Array, header: dict[str, float], hints: Hints, source: str) -> list[guards.Surface]:
    columns, heading = table.shape[1], 'Write it into the heading, as "x (mm)"'
    heights = (table[:, -1] if columns in (2, 3) else table) * hints.heights_in(source, header.get("z"))
    spacing = hints.pixel or ((header["dx"], header["dy"]) if "dx" in header else None)

    def lateral(axis: str) -> float:
        return hints.lateral_in(source, header.get(axis), "mm", f"{heading}, or give", f"{heading}.")

    if columns == 2:
        line, step = positions.line(table[:, 0], heights, source)
        if spacing:
            return [Profile(line, spacing[0], source)]
        unit = lateral("x")
        return [Profile(line, step * unit, source, float(table[:, 0].min()) * unit)]
    if columns == 3:
        heights, steps = positions.rasterised(table[:, 0], table[:, 1], heights, source)
        spacing = spacing or (steps[0] * lateral("x"), steps[1] * lateral("y"))
    return guards.surfaces_of(heights, hints.spacing_in(source, spacing), source)


def _lines(table: Array, along: float, unit: float, hints: Hints, source: str) -> list[guards.Surface]:
    """Lines beside each other at the positions of the first column, from units of both, m."""
    heights, step = positions.line(table[:, 0], table[:, 1:], source)
    step *= along
    return guards.surfaces_of(heights * hints.heights_in(source, unit), hints.pixel or (step, step), source)


FINER = 100.0
"""Least ratio of the unit of positions to that of heights at which several columns are lines: mm to µm."""


def units_of_lines(lines: list[str], columns: int) -> tuple[float, float] | None:
    """Units of positions and of heights, m, of three columns or more whose titles are those of lines.

    Each title has a unit: the first a much larger one, all others the same. None for any other heading.
    """
    titles = next((found for text in reversed(lines) if len(found := _brackets(text)) == columns > 2), [])
    try:
        along, *heights = map(_length, titles)
    except (InputError, ValueError):
        return None
    return (along, heights[0]) if len(set(heights)) == 1 and along >= FINER * heights[0] else None


def parsed_header(lines: list[str], delimiter: str | None, columns: int) -> dict[str, float]:
    """Find units and pixel sizes in the lines above the numbers.

    Understood are column titles with units (``x [mm]; z (µm)``, ``Height (nm)``), lines such as ``# unit:
    um``, ``height unit = nm``, ``lateral unit: mm`` (a bare ``unit`` is that of the heights), and ``# pixel:
    1.5 um``, ``dx = 1 mm``. The delimiter of the columns is None for white space.

    Returns lengths in m, where the lines do not leave them out: of one unit of ``x``, ``y`` and ``z``, and
    the distances ``dx`` and ``dy`` of neighbouring points, which are the same where only one is given.
    """
    cleaned = [each.strip().lstrip("#%/!").strip() for each in lines]
    stated: dict[str, float] = {}
    pixels: dict[str, float] = {}
    for text in (" ".join(each.split()) for each in cleaned):
        if match := _UNIT_LINE.match(text):
            stated |= dict.fromkeys("xy" if _is_lateral(match[1]) else "z", _length(match[2]))
        if match := _PIXEL_LINE.fullmatch(text):
            pixels[match[1].lower()] = quantity(f"{match[2].replace(',', '.')} {match[3]}", "m")
    titles = _column_units(cleaned, delimiter, columns)
    stated |= ({"y": titles["x"]} if "x" in titles else {}) | titles
    if pixels:
        dx = pixels.get("dx", next(iter(pixels.values())))
        stated |= {"dx": dx, "dy": pixels.get("dy", dx)}
    return stated


def _column_units(lines: list[str], delimiter: str | None, columns: int) -> dict[str, float]:
    """Units of the column titles: of x, y, z for two or three columns, else of the heights alone."""
    axes = {2: "xz", 3: "xyz"}.get(columns)
    for text in reversed(lines):
        units = _brackets(text)
        if axes is None:
            if len(units) == 1 and not _is_lateral(text):
                return {"z": _length(units[0])}
            continue
        titles = text.split(delimiter) if delimiter else []
        if len(titles) != columns and len(units) == columns:
            return {axis: _length(unit) for axis, unit in zip(axes, units, strict=True)}
        if units and len(titles) == columns:
            each = [_brackets(title) for title in titles]
            return {axis: _length(unit[-1]) for axis, unit in zip(axes, each, strict=True) if unit}
    return {}


def _brackets(text: str) -> list[str]:
    return _BRACKET.findall(" ".join(text.split()))


def _is_lateral(words: str) -> bool:
    return not _LATERAL_WORDS.isdisjoint(re.findall(r"[a-z]+", words.lower()))


def _length(unit: str) -> float:
    try:
        return factor(unit, "m")
    except InputError as error:
        correct = "Correct the header"
        remedy = advice("height_unit", "um", f"{correct}, or leave the bracket out and give", f"{correct}.")
        raise InputError("unit in the header", repr(unit), "a unit of length", remedy) from error
