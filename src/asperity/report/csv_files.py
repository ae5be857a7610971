"""The numbers behind every figure, one CSV file each."""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path

import numpy as np

from asperity.files import write_bytes
from asperity.report.part import Columns


def csv_text(columns: Columns) -> str:
    """Comma-separated text: a header ``quantity [unit]``, then one row per value, exact to the last bit.

    Parameters
    ----------
    columns : dict of str to (n,) array
        The columns, in SI units. A missing number (NaN) is an empty field.

    Returns
    -------
    str
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    shown = [_fields(np.asarray(values, dtype=float)) for values in columns.values()]
    writer.writerows(zip(*shown, strict=True))
    return text.getvalue()


def _fields(values: np.ndarray) -> list[float | str]:
    return ["" if math.isnan(value) else value for value in values.tolist()]


def write_csv(columns: Columns, path: Path) -> Path:
    """Write `columns` to the file at `path`, completely or not at all."""

    return write_bytes(path, csv_text(columns).encode("utf-8"))
