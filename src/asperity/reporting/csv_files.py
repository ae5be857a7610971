"""The numbers behind every figure, one CSV file each."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from asperity import comma_separated
from asperity.reporting.part import Columns


def csv_text(columns: Columns) -> str:
    """Comma-separated text: a header ``quantity [unit]``, then one row per value, exact to the last bit.

    A missing number (NaN) is an empty field.
    """
    return comma_separated.csv_text(list(columns), _rows(columns))


def _rows(columns: Columns) -> list[tuple[float, ...]]:
    return list(zip(*(np.asarray(values, dtype=float).tolist() for values in columns.values()), strict=True))


def write_csv(columns: Columns, path: Path) -> Path:
    """Write `columns` to the file at `path`, completely or not at all."""
    return comma_separated.write_csv(path, list(columns), _rows(columns))
