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
from asperity.surfaces.readers.headings import parsed_header, titles_of, units_of_lines, without_invalid
from asperity.surfaces.readers.hints import Hints, advice, spell
from asperity.text_files import decoded, lines_in, number_in, read_text

MISSING = {"", "nan", "bad", "na", "n/a", "null", "none"}  # and any number of asterisks
COMMENT = ("#", "%", "//")
MAX_TEXT_BYTES = 1 << 28
MAX_HEADER = 1 << 20  # characters of headings and comments
PROBE = 1 << 13  # bytes at either end of a file that say whether it is text
PIECE = 1 << 16  # fields of a long line that are split off at a time

_CHECK = "Check the file and its separators."
_NUMERIC = re.compile(r"(?:[\d\s.,;+\-eE*]++|nan|bad|null|none|na|n/a)*+", re.IGNORECASE)


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

    def empty_at_the_end(self, text: str) -> int:
        """How many cells at the end of a line are empty."""
        if self.delimiter is None:
            return 0
        held = text.rstrip(f"{self.delimiter} \t\r\n" if self.delimiter != "\t" else "\t \r\n")
        return text.count(self.delimiter, len(held))


def read(path: Path, hints: Hints) -> list[guards.Surface]:
    """Read heights from text: tab, semicolon, comma or white space between columns, point or comma decimals.

    One column is a line z; two are x, z at uniform x; three are x, y, z on a regular grid; more are a matrix
    of heights whose rows follow one another along x, so the first axis of the map is the line number. Lines
    beside each other may have their position in the first of three columns or more, see `units_of_lines`. A
    map whose heading states its width and height has its columns along x. A column titled "valid" holds 1,
    or 0 where the height is none. Cells that are empty at the end of all lines are left out.
    Missing heights: ``NaN``, ``BAD``, ``NA``, ``***`` or nothing. Lines above the numbers and lines that
    start with ``#``, ``%`` or ``//`` are header, see `parsed_header`; a hint is stronger than it.
    """
    size, allowed = path.stat().st_size, f"at most {amount(MAX_TEXT_BYTES)} of text"
    remedy = "Crop or split the measurement, or save it as .npy, netCDF or X3P."
    require(size <= MAX_TEXT_BYTES, f"size of {path.name}", amount(size), allowed, remedy)
    content = read_text(path, path.name, "heights as text", largest=size, latin=True)
    dialect = _dialect(lines_in(content), hints.decimal, path.name)
    header_lines, table = _table(lines_in(content), dialect, path.name)
    table, titles = without_invalid(table, titles_of(header_lines, dialect.delimiter, table.shape[1]))
    if (units := units_of_lines(titles)) is not None:
        return _lines(table, *units, hints, path.name)
    header = parsed_header(header_lines, titles)
    if not titles and "width" in header and "height" in header:
        return _map_of_a_size(table.T, header, hints, path.name)
    try:
        return _surfaces(table, header, hints, path.name)
    except InputError as error:
        if error.received != positions.UNEVEN or "dx" not in header or "z" not in header:
            raise
    heights = table * hints.heights_in(path.name, header["z"])  # lines without their positions
    return guards.surfaces_of(heights, hints.spacing_in(path.name, (header["dx"], header["dy"])), path.name)


def is_numeric(path: Path) -> bool:
    """Whether a file, whatever its name, is text that ends with lines of numbers."""
    with path.open("rb") as stream:
        head = stream.read(PROBE)
        stream.seek(-min(path.stat().st_size, PROBE), 2)
        tail = stream.read(PROBE)
    try:
        decoded(head[: len(head) // 4 * 4], path.name, "text", latin=True)
        lines = decoded(tail[-(len(tail) // 4 * 4) :], path.name, "text", latin=True).splitlines()
    except (InputError, UnicodeDecodeError):
        return False
    last = [line for line in lines[1:] if line.strip()][-3:]
    return bool(last) and all(_NUMERIC.fullmatch(line) for line in last)


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
    values, columns, characters = array("d"), 0, 0
    empty = guards.MAX_POINTS  # cells at the end of each line
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
        empty = min(empty, dialect.empty_at_the_end(text))
        values.extend(row)
        if len(values) > guards.MAX_POINTS:
            guards.check_claim(source, (len(values) // columns, columns), 1, len(values))
    require(columns, source, "no line of numbers", "heights as text", _CHECK)
    table = np.frombuffer(values).reshape(-1, columns)
    table = table[:, : max(columns - empty, 1)]
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


def _map_of_a_size(
    heights: Array, header: dict[str, float], hints: Hints, source: str
) -> list[guards.Surface]:
    """Map of a width and a height: its columns, x, were those of the numbers."""
    stated = (header["width"] / heights.shape[0], header["height"] / heights.shape[1])
    metres = heights * hints.heights_in(source, header.get("z"))
    return guards.surfaces_of(metres, hints.spacing_in(source, stated), source)


def _lines(table: Array, along: float, unit: float, hints: Hints, source: str) -> list[guards.Surface]:
    """Lines beside each other at the positions of the first column, from units of both, m."""
    heights, step = positions.line(table[:, 0], table[:, 1:], source)
    step *= along
    return guards.surfaces_of(heights * hints.heights_in(source, unit), hints.pixel or (step, step), source)
