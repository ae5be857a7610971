"""Text and CSV: lines, point lists and matrices of heights."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from asperity.decoding import number_in
from asperity.errors import InputError
from asperity.surfaces.heightmap import Profile
from asperity.surfaces.readers.grid import line, rasterised
from asperity.surfaces.readers.guards import check_claim, hostile
from asperity.surfaces.readers.headers import Header, parsed_header
from asperity.surfaces.readers.hints import Hints, Surface, surfaces_of
from asperity.surfaces.readers.spelling import advice, spell

MISSING = {"", "nan", "bad", "na", "n/a", "null", "none"}  # and any number of asterisks
COMMENT = ("#", "%", "//")

_NUMERIC = re.compile(r"(?:[\d\s.,;+\-eE*]|nan|bad|null|none|na|n/a)*", re.IGNORECASE)


@dataclass(frozen=True)
class Dialect:
    """How numbers are written."""

    delimiter: str | None  # of the columns; None for white space
    decimal_comma: bool  # whether the comma is the decimal mark

    def fields(self, text: str) -> list[str]:
        """Return the stripped fields of one line."""
        words = text.rstrip("\r\n").split(self.delimiter)
        words = [word.strip() for word in words]
        return [word.replace(",", ".") for word in words] if self.decimal_comma else words


def read(path: Path, hints: Hints) -> list[Surface]:
    """Read heights from text: tab, semicolon, comma or white space between columns, point or comma decimals.

    One column is a line z; two are x, z at uniform x; three are x, y, z on a regular grid; more are a matrix
    of heights whose rows follow one another along x, so the first axis of the map is the line number. Missing
    heights: ``NaN``, ``BAD``, ``NA``, ``***`` or nothing. Lines above the numbers and lines that start with
    ``#``, ``%`` or ``//`` are header, see `asperity.surfaces.readers.headers`; a hint is stronger than it.
    """
    with hostile(path.name, "text"):
        lines = _decoded(path.read_bytes(), path.name).splitlines()
        dialect = _dialect(lines, hints.decimal, path.name)
        header_lines, table = _table(lines, dialect, path.name)
        header = parsed_header(header_lines, dialect.delimiter, table.shape[1])
        return _surfaces(table, header, hints, path.name)


def _decoded(data: bytes, source: str) -> str:
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return data.decode("utf-16")
    if b"\x00" in data:
        raise InputError(source, "binary data", "text", "Rename the file to the extension of its format.")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def _dialect(lines: list[str], decimal: str | None, source: str) -> Dialect:
    """Judge by the last lines that hold nothing but numbers and missing markers."""
    sample = [text.strip(" ") for text in lines if _NUMERIC.fullmatch(text) and text.strip()][-50:]
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


def _table(lines: list[str], dialect: Dialect, source: str) -> tuple[list[str], NDArray[np.float64]]:
    header: list[str] = []
    rows: list[list[float]] = []
    marked: list[tuple[int, int]] = []  # line and fields of headings that are numbers but for marks in them
    blanks: list[int] = []  # how many rows stand above each empty line
    closed = 0  # rows whose last field is not empty
    for i, text in enumerate(lines, 1):
        if text.lstrip().startswith(COMMENT):
            header.append(text)
            continue
        words = dialect.fields(text)
        row = _numbers(words)
        if not any(words) and (len(words) < 2 or not rows):
            blanks.append(len(rows))
        elif row is not None:
            rows.append(row)
            closed += bool(words[-1])
        elif not rows:
            header.append(text)
            if any(map(str.isdigit, text)) and _numbers([word.replace("_", "") for word in words]):
                marked.append((i, len(words)))
        else:
            raise _no_numbers(lines, i, source)
    for i, fields in marked:
        if rows and fields == len(rows[0]):
            raise _no_numbers(lines, i, source)
    if rows and not closed and len(rows[0]) > 1:  # every line ends with a delimiter
        rows = [row[:-1] for row in rows]
    return header, _rectangular(rows, blanks, source)


def _no_numbers(lines: list[str], number: int, source: str) -> InputError:
    received = f"{lines[number - 1].strip()[:60]!r} in line {number}"
    return InputError(
        source, received, "numbers, NaN, BAD, NA, *** or nothing", "Correct or remove the line."
    )


def _numbers(words: list[str]) -> list[float] | None:
    row = []
    for word in words:
        if word.lower() in MISSING or not word.strip("*"):
            row.append(np.nan)
            continue
        try:
            row.append(number_in(word))
        except ValueError:
            return None
    return row


def _rectangular(rows: list[list[float]], blanks: list[int], source: str) -> NDArray[np.float64]:
    if not rows:
        raise InputError(
            source, "no line of numbers", "heights as text", "Check the file and its separators."
        )
    columns = len(rows[0])
    for i, row in enumerate(rows):
        if len(row) != columns:
            received, allowed = f"{len(row)} values in row {i + 1}", f"{columns}, as in the first row"
            raise InputError(source, received, allowed, "Mark missing heights with NaN.")
    check_claim(source, (len(rows), columns), 1, len(rows) * columns)
    if columns == 1:  # an empty line between single heights is a missing height
        gaps = Counter(blank for blank in blanks if blank)
        rows = [each for i, row in enumerate(rows) for each in (*[[np.nan]] * gaps[i], row)]
    return np.array(rows)


def _surfaces(table: NDArray[np.float64], header: Header, hints: Hints, source: str) -> list[Surface]:
    unit = hints.heights_in(source, header.height_unit)
    stated = hints.spacing or header.spacing
    columns = table.shape[1]
    if columns == 2:
        heights, step = line(table[:, 0], table[:, 1], source)
        dx = stated[0] if stated else step * _lateral(header.x_unit, hints, source)
        return [Profile(heights * unit, dx, source)]
    if columns == 3:
        heights, steps = rasterised(table[:, 0], table[:, 1], table[:, 2], source)
        if stated is None:
            x, y = _lateral(header.x_unit, hints, source), _lateral(header.y_unit, hints, source)
            stated = steps[0] * x, steps[1] * y
        return surfaces_of(heights * unit, stated, source)
    return surfaces_of(table * unit, hints.spacing_in(source, stated), source)


def _lateral(stated: float | None, hints: Hints, source: str) -> float:
    unit = hints.lateral_factor or stated
    if unit is None:
        allowed = "a unit of the coordinates"
        heading = 'Write it into the heading, as "x (mm)"'
        remedy = advice("pixel_unit", "mm", f"{heading}, or give", f"{heading}.")
        raise InputError(source, "coordinates without a unit", allowed, remedy)
    return unit
