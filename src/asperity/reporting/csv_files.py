"""The numbers behind every figure, one CSV file each."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from asperity.comma_separated import csv_text
from asperity.files import write_bytes
from asperity.reporting.part import Columns


def columns_text(columns: Columns) -> str:
    """Comma-separated text: a header ``quantity [unit]``, then one row per value, exact to the last bit.

    A missing number (NaN) is an empty field.
    """
    numbers = (np.asarray(column, dtype=float).tolist() for column in columns.values())
    written = (["" if number != number else repr(number) for number in column] for column in numbers)
    rows = map(",".join, zip(*written, strict=True))
    return csv_text(list(columns), []) + "".join(f"{row}\n" for row in rows)


def write_columns(columns: Columns, path: Path) -> Path:
    """Write `columns` to the file at `path`, completely or not at all."""
    return write_bytes(path, columns_text(columns).encode("utf-8"))
