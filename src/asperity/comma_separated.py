"""The one place that writes comma-separated text: numbers to the last bit, words that no program runs."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Sequence
from pathlib import Path

from asperity.files import write_bytes
from asperity.printable import printable

_FORMULA = ("=", "+", "-", "@")
"""First characters of what spreadsheets take for a formula, and would compute or even run."""


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
