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
    values = (np.asarray(column, dtype=float).tolist() for column in columns.values())
    return csv_text(list(columns), zip(*values, strict=True))


def write_columns(columns: Columns, path: Path) -> Path:
    """Write `columns` to the file at `path`, completely or not at all."""
    return write_bytes(path, columns_text(columns).encode("utf-8"))
