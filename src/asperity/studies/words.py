"""The table of a study in words: names for people, one unit for each column, numbers as people write them."""

import re
from collections.abc import Sequence

import numpy as np

from asperity.reporting import data

Row = Sequence[object]
MISSING = "–"
"""Stands where there is no number."""


def table_in_words(
    heading: Sequence[str], rows: Sequence[Row], axes: int, spread: Sequence[Row] = ()
) -> tuple[list[str], list[list[str]]]:
    """Headings and cells of a table for people: names with their units, levels with one decimal.

    Parameters
    ----------
    heading, rows
        From `asperity.studies.table.columns_of`.
    axes : int
        Number of columns that hold swept keys and the law, which stay as they were typed.
    spread : sequence of rows, optional
        Standard deviations over the seeds, laid out like the rows: they stand behind ±.
    """
    heads = list(heading)
    columns = []
    for n, title in enumerate(heading):
        column = [row[n] for row in rows]
        if n < axes:
            columns.append([_as_typed(value) for value in column])
            continue
        numbers = np.array(column, dtype=float)
        name, _, units = title.removesuffix("]").partition(" [")
        size, symbol = data.unit_of_quantity(name.partition(" ")[0], units, numbers)
        heads[n] = _called(name) + (f" [{symbol}]" if symbol else "")
        places = 1 if units.startswith("dB") else None
        cells = [_written(value, places) for value in numbers / size]
        for row, by in enumerate(_written(each[n] / size, places, 2) for each in spread):  # type: ignore[operator]
            cells[row] += f" ± {by}" if by != MISSING else ""
        columns.append(cells)
    return heads, [list(row) for row in zip(*columns, strict=True)]


def _called(name: str) -> str:
    """Name of a quantity for people: ``"force level, A-weighted, over linear"``."""
    name, to, law = name.partition("_difference_to_")
    name = re.sub(r"_a(?=_by_chance|$| )", ", A-weighted", name).replace("_", " ")
    return f"{name}, over {law.replace('_', '-')}" if to else name


def _as_typed(value: object) -> str:
    return value if isinstance(value, str) else _written(float(value), None)  # type: ignore[arg-type]


def _written(value: float, places: int | None, digits: int = 4) -> str:
    """A number with so many decimals, or with so many digits; a dash where there is none."""
    if not np.isfinite(value):
        return MISSING
    if places is None:
        return data.plain(value, digits)
    return f"{round(value, places) + 0.0:.{places}f}".replace("-", "−")
