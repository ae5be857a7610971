"""Text and CSV: lines, point lists and matrices of heights."""

from __future__ import annotations

import codecs
import math
import re
from array import array
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from asperity.arguments import Array
from asperity.errors import InputError
from asperity.files import amount
from asperity.surfaces.heightmap import Profile
from asperity.surfaces.readers.arrays import line, rasterised
from asperity.surfaces.readers.guards import MAX_POINTS, Hints, Surface, check_claim, hostile, surfaces_of
from asperity.surfaces.readers.headers import Header, advice, parsed_header, spell
from asperity.text_files import number_in

MISSING = {"", "nan", "bad", "na", "n/a", "null", "none"}  # and any number of asterisks
COMMENT = ("#", "%", "//")

_CHECK = "Check the file and its separators."
_NUMERIC = re.compile(r"(?:[\d\s.,;+\-eE*]++|nan|bad|null|none|na|n/a)*+", re.IGNORECASE)


MAX_TEXT_BYTES = 1 << 30
MAX_HEADER = 1 << 20  # characters of headings and comments
PIECE = 1 << 16  # fields of a long line that are split off at a time; bytes that are looked at


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


def read(path: Path, hints: Hints) -> list[Surface]:
    """Read heights from text: tab, semicolon, comma or white space between columns, point or comma decimals.

    One column is a line z; two are x, z at uniform x; three are x, y, z on a regular grid; more are a matrix
    of heights whose rows follow one another along x, so the first axis of the map is the line number. Missing
    heights: ``NaN``, ``BAD``, ``NA``, ``***`` or nothing. Lines above the numbers and lines that start with
    ``#``, ``%`` or ``//`` are header, see `asperity.surfaces.readers.headers`; a hint is stronger than it.
    The file is read line by line, so that memory is a few times what its numbers take.
    """
    size = path.stat().st_size
    if size > MAX_TEXT_BYTES:
        allowed = f"at most {amount(MAX_TEXT_BYTES)} of text"
        remedy = "Crop or split the measurement, or save it as .npy, netCDF or X3P."
        raise InputError(f"size of {path.name}", amount(size), allowed, remedy)
    with hostile(path.name, "text"):
        encoding = _encoding(path)
        with path.open(encoding=encoding) as lines:
            dialect = _dialect(lines, hints.decimal, path.name)
        with path.open(encoding=encoding) as lines:
            header_lines, table = _table(lines, dialect, path.name)
        header = parsed_header(header_lines, dialect.delimiter, table.shape[1])
        return _surfaces(table, header, hints, path.name)


def _encoding(path: Path) -> str:
    """Marked UTF-16, UTF-8, or Latin-1 for what is neither."""
    decoder = codecs.getincrementaldecoder("utf-8-sig")()
    found = "utf-8-sig"
    with path.open("rb") as file:
        if file.read(2) in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE):
            return "utf-16"
        file.seek(0)
        while chunk := file.read(PIECE):
            if b"\x00" in chunk:
                remedy = "Rename the file to the extension of its format."
                raise InputError(path.name, "binary data", "text", remedy)
            try:
                decoder.decode(chunk)
            except UnicodeDecodeError:
                decoder.reset()
                found = "latin-1"
        try:
            decoder.decode(b"", final=True)
        except UnicodeDecodeError:
            found = "latin-1"
    return found


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
    marked: list[tuple[int, str, int]] = []  # headings that are numbers but for marks in them, and fields
    found, columns, closed, said = array("d"), 0, True, 0
    blanks = array("q")  # how many rows stand above each empty line
    for number, text in enumerate(lines, 1):
        comment = text.lstrip().startswith(COMMENT)
        if not comment and dialect.is_blank(text, above=not columns):
            blanks.append(len(found) // columns if columns else 0)
            continue
        row = None if comment else dialect.numbers(text)
        if row is None:
            if columns and not comment:
                raise _no_numbers(text, number, source)
            header.append(text)
            unmarked = dialect.numbers(text.replace("_", "")) if any(map(str.isdigit, text)) else None
            if unmarked and not comment:
                marked.append((number, text, len(unmarked)))
            said += len(text)
            if said > MAX_HEADER:
                received = f"more than {amount(MAX_HEADER)} of text that is no number"
                raise InputError(source, received, "heights as text", _CHECK)
            continue
        if not columns:
            columns = len(row)
            for line_number, heading, fields in marked:
                if fields == columns:
                    raise _no_numbers(heading, line_number, source)
        if len(row) != columns:
            received = f"{len(row)} values in row {len(found) // columns + 1}"
            allowed = f"{columns}, as in the first row"
            raise InputError(source, received, allowed, "Mark missing heights with NaN.")
        closed = closed and dialect.is_closed(text)
        found.extend(row)
        if len(found) > MAX_POINTS:
            check_claim(source, (len(found) // columns, columns), 1, len(found))
    if not columns:
        raise InputError(source, "no line of numbers", "heights as text", _CHECK)
    table = np.frombuffer(found).reshape(-1, columns)
    if closed and columns > 1:  # every line ends with a delimiter
        table = table[:, :-1]
    if table.shape[1] == 1:  # an empty line between single heights is a missing height
        gaps = np.bincount(np.array(blanks, dtype=np.int64), minlength=len(table))[: len(table)]
        gaps[0] = 0
        spread = np.full((len(table) + int(gaps.sum()), 1), np.nan)
        spread[np.arange(len(table)) + np.cumsum(gaps)] = table
        table = spread
    return header, table


def _no_numbers(text: str, number: int, source: str) -> InputError:
    received = f"{text.strip()[:60]!r} in line {number}"
    return InputError(
        source, received, "numbers, NaN, BAD, NA, *** or nothing", "Correct or remove the line."
    )


def _surfaces(table: Array, header: Header, hints: Hints, source: str) -> list[Surface]:
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
    table *= unit
    return surfaces_of(table, hints.spacing_in(source, stated), source)


def _lateral(stated: float | None, hints: Hints, source: str) -> float:
    unit = hints.lateral_factor or stated
    if unit is None:
        allowed = "a unit of the coordinates"
        heading = 'Write it into the heading, as "x (mm)"'
        remedy = advice("pixel_unit", "mm", f"{heading}, or give", f"{heading}.")
        raise InputError(source, "coordinates without a unit", allowed, remedy)
    return unit
