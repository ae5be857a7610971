"""Text and CSV: lines, point lists and matrices of heights, and what their headings state."""

from __future__ import annotations

import math
import re
from array import array
from collections import deque
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from asperity.arguments import Array, listed, require
from asperity.errors import InputError
from asperity.files import amount
from asperity.growing_numbers import GrowingNumbers
from asperity.surfaces.heightmap import Profile
from asperity.surfaces.readers import guards, positions
from asperity.surfaces.readers.belief import doubt_depth
from asperity.surfaces.readers.headings import (
    Title,
    columns_of_heights,
    depth_named,
    length_named,
    parsed_header,
    titles_of,
    units_of_lines,
    without_invalid,
)
from asperity.surfaces.readers.hints import Hints, advice, spell
from asperity.text_files import (
    blocks_of_lines,
    decoded,
    even_rows,
    in_thousands,
    lines_in,
    number_in,
    number_or_nan,
    read_text,
    refuse_decimal_commas,
)
from asperity.written_numbers import count_of

MISSING = {"", "nan", "bad", "na", "n/a", "#n/a", "n.a.", "#nv", "null", "none", "void", "lost", "missing",
           "invalid", "no data", "nodata", "nan(ind)", "-nan(ind)", "1.#qnan", "-1.#ind"}  # fmt: skip
"""Words for a missing height, beside any number of asterisks, and of dashes in a line with numbers."""
COMMENT = ("#", "%", "//")
COLUMNS = ", columns "
"""What stands in the source of heights before the columns that they were taken from."""
MAX_TEXT_BYTES = 1 << 28
MAX_HEADER = 1 << 20  # characters of headings and comments
PROBE = 1 << 13  # bytes at either end of a file that say whether it is text
END = 1 << 14  # characters at the end of a text, in which ...
SAMPLE = 50  # ... so many lines of numbers tell how they are written
PIECE = 1 << 16  # fields of a long line that are split off at a time

_CHECK = "Check the file and its separators."
_NUMERIC = re.compile(r"(?:[\d\s.,;+\-eEdD*'’]++|nan|bad|null|none|na|n/a)*+", re.IGNORECASE)
_SURE_COMMA = re.compile(r"[-+]?\d+,0\d|-0,")
"""A decimal comma: nobody writes whole numbers as 05 or -0."""
_QUOTED_COMMA = re.compile(r'"[-+]?\d*,\d[^"\n]*"')
"""A number in quotes with a decimal comma."""


@dataclass(frozen=True)
class Dialect:
    """How numbers are written."""

    delimiter: str | None  # of the columns; None for white space
    decimal_comma: bool  # whether the comma is the decimal mark

    def numbers(self, text: str) -> array[float] | None:
        """Return the numbers of one line, NaN for missing ones; None if it holds anything else."""
        row = array("d")
        underlined = "-" in text  # as titles are, by dashes alone
        rest: str | None = text.rstrip("\r\n")
        while rest is not None:
            words = rest.split(self.delimiter, PIECE)
            rest = words.pop() if len(words) > PIECE else None
            for word in words:
                word = word.strip()
                try:
                    row.append(number_in(word.replace(",", ".") if self.decimal_comma else word))
                except ValueError:
                    dashes = not word.strip("-")
                    if not dashes and word.lower() not in MISSING and word.strip("*"):
                        return None
                    row.append(math.nan)
                    underlined = underlined and dashes
                else:
                    underlined = False
        return None if underlined else row

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
    size = path.stat().st_size
    allowed = f"at most {amount(MAX_TEXT_BYTES)} of text"
    remedy = "Crop or split the measurement, or save it as .npy, netCDF or X3P."
    require(size <= MAX_TEXT_BYTES, f"size of {path.name}", amount(size), allowed, remedy)
    content = _unquoted(read_text(path, path.name, "heights as text", largest=size, latin=True))
    sample = _last_numbers(content)
    dialect = _dialect(sample, hints.decimal, path.name)
    rows = _table(content, dialect, path.name)
    del content  # before the numbers take their whole room
    header_lines = rows.header
    table = guards.without_marks(rows.finished())
    all_titles = titles_of(header_lines, dialect.delimiter, table.shape[1])
    table, titles = columns_of_heights(table, all_titles)
    source = path.name + _columns_told(all_titles, titles)
    table, titles = without_invalid(table, titles)
    if name := depth_named(header_lines, titles, dialect.delimiter, table.shape[1]):
        doubt_depth(path.name, name)
    if (units := units_of_lines(titles)) is not None:
        return _lines(table, *units, hints, source)
    header = parsed_header(header_lines, titles)
    if not titles and "width" in header and "height" in header:
        return _map_of_a_size(table.T, header, hints, source)
    if table.shape[1] > 3 and (found := _with_positions(table, titles, header, hints, source)):
        return found
    try:
        return _surfaces(table, header, hints, source)
    except InputError as error:
        # two columns with commas between them, or one number of thousands with a decimal comma
        if table.shape[1] == 2 and dialect.delimiter == ",":
            _refuse_thousands("\n".join(sample), None, path.name)
        if error.received != positions.UNEVEN or "dx" not in header or "z" not in header:
            raise
    heights = table * hints.heights_in(source, header["z"])  # lines without their positions
    return guards.surfaces_of(heights, hints.spacing_in(source, (header["dx"], header["dy"])), source)


def _columns_told(titles: list[Title], kept: list[Title]) -> str:
    """Say which columns are taken where others with a title are left out; nothing else."""
    left = [f"'{title.name}'" for title in titles if title.name and title not in kept]
    taken = [f"'{title.name}'" for title in kept]
    return f"{COLUMNS}{listed(taken)}, without {listed(left)}" if left else ""


def _unquoted(content: str) -> str:
    """Text without quotes around its cells, with semicolons between them where they have decimal commas."""
    if '"' not in content:
        return content
    if _QUOTED_COMMA.search(content):
        content = re.sub(r'" *, *"', ";", content)
    return content.replace('"', "")


def holds_text(path: Path) -> bool:
    """Whether a file begins as text does, in an encoding that is read."""
    with path.open("rb") as stream:
        head = stream.read(PROBE)
    try:
        decoded(head[: len(head) // 4 * 4], path.name, "text", latin=True)
    except (InputError, UnicodeDecodeError):
        return False
    return True


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


def _last_numbers(content: str) -> list[str]:
    """The last lines that hold nothing but numbers and missing markers."""
    for text in (content[-END:], content):
        numeric = (
            line.strip(" \r\n") for line in lines_in(text) if _NUMERIC.fullmatch(line) and line.strip()
        )
        sample = deque(numeric, maxlen=SAMPLE + 1)  # one more, as the first may be the end of a line
        if len(sample) > SAMPLE:
            break
    return list(sample)[-SAMPLE:]


def _dialect(sample: list[str], decimal: str | None, source: str) -> Dialect:
    """Judge by lines of numbers."""
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
        refuse_decimal_commas(joined, source)
        return Dialect(",", False)
    if len(words) > len(sample) or not all("," in word for word in words):
        return Dialect(None, True)
    if any(_SURE_COMMA.match(word) for word in words):
        return Dialect(None, True)
    received = f"numbers such as {words[-1][:40]!r}"
    allowed = "an unambiguous decimal mark"
    lead = f"Give {spell('decimal', ',')} if the comma is the decimal mark; if it separates columns, give"
    remedy = advice("decimal", ".", lead, "Write decimal points, or semicolons between columns.")
    raise InputError(source, received, allowed, remedy)


def _refuse_thousands(text: str, delimiter: str | None, source: str) -> None:
    """Refuse a line with numbers that have marks between thousands: which comma is which is not guessed."""
    if word := in_thousands(text.split(delimiter)):
        received = f"numbers such as {word.strip()[:40]!r}, with marks between thousands"
        allowed = "numbers with a decimal mark alone"
        raise InputError(source, received, allowed, "Export them without marks between thousands.")


def _table(content: str, dialect: Dialect, source: str) -> _Table:
    """Read the numbers, and lines above and among them."""
    table = _Table(dialect, source)
    number = 0
    decimal = "," if dialect.decimal_comma else "."
    for lines in blocks_of_lines(content):
        even = even_rows(lines, dialect.delimiter, decimal)
        if even is not None and even.shape[1] == (table.columns or even.shape[1]):
            table.take(even)
        else:
            for place, text in enumerate(lines, number + 1):
                table.take_line(place, text)
        number += len(lines)
    return table


@dataclass
class _Table:
    """Rows of numbers, and lines above and among them, as they are read."""

    dialect: Dialect
    source: str
    header: list[str] = field(default_factory=list)
    characters: int = 0  # of the header
    values: GrowingNumbers = field(default_factory=GrowingNumbers)
    columns: int = 0
    empty: int = guards.MAX_POINTS  # cells at the end of each line
    blanks: array[int] = field(default_factory=lambda: array("q"))  # rows above each empty line

    def take(self, rows: Array) -> None:
        """Take rows of numbers alone."""
        self.columns = rows.shape[1]
        self.empty = 0
        self.values.extend(rows)
        self._check_count()

    def take_line(self, number: int, text: str) -> None:
        """Take a line of any kind."""
        columns = self.columns
        comment = text.lstrip().startswith(COMMENT)
        if not comment and self.dialect.is_blank(text, above=not columns):
            self.blanks.append(self.rows)
            return
        row = None if comment else self.dialect.numbers(text)
        if row is None:
            if not comment:
                _refuse_thousands(text, self.dialect.delimiter, self.source)
            if columns and not comment:
                received = f"{text.strip()[:60]!r} in line {number}"
                allowed = "numbers or marks of missing ones"
                raise InputError(self.source, received, allowed, "Correct or remove the line.")
            self.header.append(text)
            self.characters += len(text)
            received = f"more than {amount(MAX_HEADER)} of text that is no number"
            require(self.characters <= MAX_HEADER, self.source, received, "heights as text", _CHECK)
            return
        self.columns = columns = columns or len(row)
        if len(row) != columns:
            received = f"{count_of(len(row), 'value')} in row {self.rows + 1}"
            allowed = f"{columns}, as in the first row"
            raise InputError(self.source, received, allowed, "Mark missing heights with NaN.")
        self.empty = min(self.empty, self.dialect.empty_at_the_end(text))
        self.values.extend(row)
        self._check_count()

    @property
    def rows(self) -> int:
        """How many there are."""
        return len(self.values) // self.columns if self.columns else 0

    def _check_count(self) -> None:
        if len(self.values) > guards.MAX_POINTS:
            guards.check_claim(self.source, (self.rows, self.columns), 1, len(self.values))

    def finished(self) -> Array:
        """The numbers (rows, columns), which are here no more."""
        require(self.columns, self.source, "no line of numbers", "heights as text", _CHECK)
        table = self.values.poured().reshape(-1, self.columns)
        table = table[:, : max(self.columns - self.empty, 1)]
        return _with_gaps(table, self.blanks) if table.shape[1] == 1 and self.blanks else table


def _with_gaps(table: Array, blanks: array[int]) -> Array:
    """Single heights (rows, 1), with a missing one for each empty line between them."""
    gaps = np.bincount(np.array(blanks, dtype=np.int64), minlength=len(table))[: len(table)]
    gaps[0] = 0
    spread = np.full((len(table) + int(gaps.sum()), 1), np.nan)
    spread[np.arange(len(table)) + np.cumsum(gaps)] = table
    return spread


def _surfaces(table: Array, header: dict[str, float], hints: Hints, source: str) -> list[guards.Surface]:
    columns = table.shape[1]
    heading = 'Write it into the heading, as "x (mm)"'
    heights = table[:, -1].copy() if columns in (2, 3) else table
    heights *= hints.heights_in(source, header.get("z"))
    spacing = hints.pixel or ((header["dx"], header["dy"]) if "dx" in header else None)

    def lateral(axis: str) -> float:
        return hints.lateral_in(source, header.get(axis), "mm", f"{heading}, or give", f"{heading}.")

    if columns == 3 and len(table) > 1 and not hints.pixel:  # a section of a map
        for place, axis in enumerate("xy"):
            if np.ptp(table[:, 1 - place]) == 0.0:
                line, step = positions.line(table[:, place], heights, source)
                unit = lateral(axis)
                return [Profile(line, step * unit, source, float(table[:, place].min()) * unit)]
    if columns == 2:
        put = positions.made_even if hints.section else positions.line
        line, step = put(table[:, 0], heights, source)
        if spacing:
            return [Profile(line, spacing[0], source)]
        unit = lateral("x")
        return [Profile(line, step * unit, source, float(table[:, 0].min()) * unit)]
    if columns == 3:
        heights, steps = positions.rasterised(table[:, 0], table[:, 1], heights, source)
        spacing = spacing or (steps[0] * lateral("x"), steps[1] * lateral("y"))
    return guards.surfaces_of(heights, hints.spacing_in(source, spacing), source)


def _with_positions(
    table: Array, titles: list[Title], header: dict[str, float], hints: Hints, source: str
) -> list[guards.Surface]:
    """Heights whose first column holds even positions, and perhaps the first row others; none without."""
    across = np.array([number_or_nan(title.name) for title in titles[1:]]) if titles else table[0, 1:]
    framed = positions.are_even(across) and (bool(titles) or not table[0, 0] > 0.0)
    inner = table[1:] if framed and not titles else table
    if not positions.are_even(inner[:, 0]) or all(map(positions.are_even, inner[:, 1:].T)):
        return []
    stated = header.get("x") or (length_named(titles[0].unit) if titles and titles[0].unit else None)
    heights = inner[:, 1:] * hints.heights_in(source, header.get("z"))
    if hints.pixel:
        return guards.surfaces_of(heights, hints.pixel, source)
    heading = "Write it into the heading, as # lateral unit: mm"
    unit = hints.lateral_in(source, stated, "mm", f"{heading}, or give", f"{heading}.")
    heights, step = positions.line(inner[:, 0], heights, source)
    other = step
    if framed:
        turned, other = positions.line(across, heights.T, source)
        heights = turned.T
    return guards.surfaces_of(heights, (step * unit, other * unit), source)


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
