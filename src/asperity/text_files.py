"""Text files: what people have written is read, in UTF-8 or as PowerShell writes it; tables are written."""

import codecs
import csv
import io
import math
import re
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain
from pathlib import Path

from asperity.arguments import Array, no_file
from asperity.errors import InputError, printable
from asperity.files import amount, write_bytes

_MARKS = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
_NO_TEXT = {
    b"PK\x03\x04": "a zip archive, as workbooks of Excel are",
    b"\xd0\xcf\x11\xe0": "a document of Office, as old workbooks of Excel are",
    b"%PDF": "a PDF",
    b"\x1f\x8b": "a compressed file, gzip",
    b"BZh": "a compressed file, bzip2",
    b"\xfd7zXZ\0": "a compressed file, xz",
    b"7z\xbc\xaf": "a compressed file, 7z",
    b"\x89PNG": "a picture, PNG",
    b"\xff\xd8\xff": "a picture, JPEG",
}
"""What people take for tables, by its first bytes."""
_FORMULA = ("=", "+", "-", "@")
"""First characters of what spreadsheets take for a formula, and would compute or even run."""


BACKSLASH = (
    "In double quotes a backslash changes the letter after it: write Windows paths in single quotes, as in "
    r"file = 'C:\data\beam.x3p', or with / instead."
)
"""What to do about a path whose letters a TOML file has changed."""
LATIN_SHARE = 0.5
"""Least share of Latin characters in UTF-16 that bears no mark."""
_FIRST_BLOCK, _BLOCK = 1 << 10, 1 << 16
"""Characters of a text that are taken at a time, at first and then."""
_PLAIN = re.compile(r"[\d.,;+\-eE \t\n]*+", re.ASCII)
"""Numbers and what stands between them."""
_EMPTY_LINE = re.compile(r"(?:\A|\n)[,; \t]*(?:\n|[,; \t]\Z)")
_FORTRAN = re.compile(r"(?<=[\d.])[dD](?=[-+]?\d+\s*\Z)")
"""The letter before an exponent in double precision."""
_THOUSANDS = re.compile(
    r"[-+]?\d{1,3}(?:(?:\.\d{3})+,\d+|(?:,\d{3})+\.\d+|(?:['’]\d{3})+(?:[.,]\d+)?"
    r"|(?:[ \u00a0\u202f\u2009]\d{3})+[.,]\d+)"
)
_DECIMALS = re.compile(r"\d\.\d")
_LAST = 1 << 14
"""Characters at the end of a text by which it is told which commas separate columns."""
_DECIMAL_COMMA = re.compile(r"(?:^|,) *[-+]?0\d|-0,")
"""What nobody writes as whole numbers between commas: 05, or -0."""
_APART = re.compile(r",\s")
"""A comma that is no decimal mark."""


def read_text(
    path: Path,
    source: str,
    allowed: str,
    *,
    largest: int,
    remedy: str = "",
    latin: bool = False,
) -> str:
    """Read a text file that a person has written, without a mark of its encoding.

    Of at most `largest` bytes. `source` is its name and `allowed` what may stand there, for messages;
    `remedy` is what to do if there is no such file. What is no UTF-8 is read as Latin-1 if `latin`, as
    instruments write it.
    """
    if received := no_file(path):
        raise InputError(source, received, allowed, remedy)
    try:
        with open(path, "rb") as file:
            content = file.read(min(largest, path.stat().st_size) + 1)  # room for no more is made
    except OSError as error:
        raise InputError(source, f"a file that cannot be read ({error.strerror})", allowed) from None
    if len(content) > largest:
        allowed = f"{allowed} of at most {amount(largest)}"
        raise InputError(source, f"more than {amount(largest)}", allowed)
    return decoded(content, source, allowed, latin=latin)


def refuse_no_table(content: bytes, source: str, allowed: str) -> None:
    """Refuse what begins as files do that people take for tables, and says what it is."""
    for begins, received in _NO_TEXT.items():
        if content.startswith(begins):
            remedy = "Unpack it." if "compressed" in received else "Export it as text, as CSV."
            raise InputError(source, received, allowed, remedy)


def decoded(content: bytes, source: str, allowed: str, *, latin: bool) -> str:
    """Decode the content of a text file, UTF-8 or UTF-16, without the mark.

    Of another encoding an `InputError` says which it probably is; `source` and `allowed` are for that
    message.
    """
    remedy = "Save the file as UTF-8."
    refuse_no_table(content, source, allowed)
    try:
        if content.startswith(_MARKS):
            return content.decode("utf-16")
        if b"\0" in content:
            if order := _order_of_utf16(content):
                return content.decode(f"utf-16-{order}")
            raise InputError(source, "bytes that are no text, or not in UTF-8", allowed, remedy)
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        if latin and not content.startswith(_MARKS):
            return content.decode("latin-1")
        line = content[: error.start].count(b"\n") + 1
        encoding = error.encoding[:6].upper()  # whatever the order of bytes
        received = f"a byte that is no {encoding} in line {line}"
        raise InputError(source, received, allowed, remedy) from None


def _order_of_utf16(content: bytes) -> str:
    """Order of bytes of UTF-16 that bears no mark, ``"le"`` or ``"be"``; empty for anything else.

    Latin letters and digits have their zeros at every second byte, and nowhere else.
    """
    first = content[::2].count(0)
    second = content[1::2].count(0)
    if len(content) % 2 or min(first, second) or max(first, second) < LATIN_SHARE * len(content) / 2:
        return ""
    return "le" if second else "be"


def lines_in(content: str) -> Iterator[str]:
    """Lines of a text, one at a time: a list of them takes many times the memory of short lines."""
    return chain.from_iterable(blocks_of_lines(content))


def blocks_of_lines(content: str) -> Iterator[list[str]]:
    """Lines of a text, in lists of some ten kilobytes, the first of one, at ends of lines of any system.

    The first may hold a heading, for which all lines beside it are read one by one.
    """
    start = 0
    while start < len(content):
        after = start + (_BLOCK if start else _FIRST_BLOCK)
        ends = (content.find(mark, after) + 1 for mark in "\n\r")
        end = next((end for end in ends if end), len(content))
        yield list(io.StringIO(content[start:end], newline=None))
        start = end


def even_rows(lines: list[str], delimiter: str | None, decimal: str = ".") -> "Array | None":
    """Numbers (rows, columns) of lines that hold nothing else, equally many in each, all at once.

    None where there is anything else: a word, a missing number, an empty line. As `number_in` reads them one
    by one, at a small part of the time. The delimiter is None for white space.
    """
    import numpy as np

    text = "".join(lines)
    if (
        not _PLAIN.fullmatch(text)
        or _EMPTY_LINE.search(text)
        or (delimiter != "," != decimal and "," in text)
    ):
        return None
    if decimal == ",":
        lines = text.replace(",", ".").splitlines()
    try:
        return np.loadtxt(lines, delimiter=delimiter, comments=None, ndmin=2)
    except ValueError:
        return None


def lines_of_cells(content: str, first: int = 1) -> Iterator[tuple[int, list[str]]]:
    """Cells of each line of a table that holds any, with its number, from that of the first on.

    They are apart as `separator_in` says. Text from '#' on is left out, and so are separators at the end, as
    spreadsheets write them.
    """
    for number, line in enumerate(lines_in(content), start=first):
        text = line.partition("#")[0].strip().rstrip(";, \t")
        separator = separator_in(text)
        if separator in (";", "\t"):
            text = text.replace(",", ".")
        if text:
            cells = [cell.strip().strip('"') for cell in text.split(separator)]
            yield number, [cell for cell in cells if cell] if separator == "\t" else cells


def separator_in(text: str) -> str | None:
    """Semicolon or tab, both with decimal commas, comma, or None for white space, between cells of a line."""
    if ";" in text:
        return ";"
    if "\t" in text and not _APART.search(text):
        return "\t"
    return "," if "," in text else None


def number_in(text: str | bytes) -> float:
    """Number that a text holds, as people and instruments write it: ``"1.5e-3"``, ``"inf"`` or ``"nan"``.

    With or without white space around; exponents of ten may be those of Fortran, ``"1.5D-03"``. ``"1_0"``,
    which is ten to Python, is a `ValueError` as any other text.
    """
    if (b"_" if isinstance(text, bytes) else "_") in text:  # type: ignore[operator]
        raise ValueError(f"no number: {text!r}")
    try:
        return float(text)
    except ValueError:
        words = text.decode("latin-1") if isinstance(text, bytes) else text
        return float(_FORTRAN.sub("e", words))


def number_or_nan(text: str) -> float:
    """The number that a text holds; NaN of any other text."""
    try:
        return number_in(text)
    except ValueError:
        return math.nan


def in_thousands(words: Iterable[str]) -> str:
    """The first of some words that is a number with marks between thousands; empty without one.

    As ``"1.234,5"``, ``"1,234.5"`` or ``"1'234"``: what is one of them and what is two is not guessed.
    """
    return next((word for word in words if _THOUSANDS.fullmatch(word.strip())), "")


def refuse_decimal_commas(content: str, source: str) -> None:
    """Refuse numbers with commas that have commas between them, too: which is which is not guessed."""
    lines = [line for line in content[-_LAST:].splitlines() if _PLAIN.fullmatch(line)]
    if any(map(_DECIMALS.search, lines)):
        return
    for line in lines:
        words = line.split()
        between = ";" not in line and "\t" not in line
        between &= any(word.count(",") > 1 or "," in (word[0], word[-1]) for word in words)
        if between and _DECIMAL_COMMA.search(line):
            received = f"lines such as {line.strip()[:40]!r}, with commas in numbers and between them"
            remedy = "Export decimal points, or semicolons between columns."
            raise InputError(source, received, "commas of one kind", remedy)


def csv_text(heading: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Write out a table of numbers and words under titles of its columns.

    A missing number (NaN) is an empty field; a word that a spreadsheet would take for a formula begins with
    an apostrophe.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(map(_field, heading))
    writer.writerows(map(_field, row) for row in rows)
    return text.getvalue()


def write_csv(path: Path, heading: Sequence[str], rows: Iterable[Sequence[object]]) -> Path:
    """Write a table to a file, completely or not at all, as `csv_text` writes it out."""
    return write_bytes(path, csv_text(heading, rows).encode("utf-8"))


def _field(value: object) -> object:
    if isinstance(value, str):
        shown = printable(value)  # no tab or line end is left, either
        return f"'{shown}" if shown.startswith(_FORMULA) else shown
    return "" if isinstance(value, float) and math.isnan(value) else value
