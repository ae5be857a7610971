"""The numbers behind every figure, one CSV file each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from asperity.comma_separated import csv_text
from asperity.files import write_bytes
from asperity.reporting.part import Columns

ROWS = 4096
"""Rows that are written at a time: as text they take many times as much memory."""


def columns_text(columns: Columns) -> str:
    """Comma-separated text: a header ``quantity [unit]``, then one row per value, exact to the last bit.

    A missing number (NaN) is an empty field.
    """
    table = [np.asarray(column, dtype=float) for column in columns.values()]
    return csv_text(list(columns), []) + "".join(_pieces(table))


def _pieces(table: Sequence[NDArray[np.float64]]) -> Iterator[str]:
    """Rows of columns (n,), all of one length, some at a time."""
    for start in range(0, max(map(len, table)), ROWS):
        numbers = (column[start : start + ROWS].tolist() for column in table)
        written = (["" if number != number else repr(number) for number in column] for column in numbers)
        yield "".join(f"{','.join(row)}\n" for row in zip(*written, strict=True))


def write_columns(columns: Columns, path: Path) -> Path:
    """Write `columns` to the file at `path`, completely or not at all."""
    return write_bytes(path, columns_text(columns).encode("utf-8"))
