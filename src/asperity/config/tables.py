"""Tables that a case names, as text with columns; among them band levels of a texture."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.arguments import shown
from asperity.config.content import name_of
from asperity.config.form import Section
from asperity.decoding import lines_of_cells, number_in, read_text
from asperity.errors import InputError
from asperity.units import factor, unit_in_brackets

LARGEST_TABLE = 10 * 2**20  # bytes
LARGEST_LEVEL = 60.0  # dB re 1 um, either side: 1 nm to 1 mm in one band

TABLE_OF_LEVELS = "a table of wavelengths and levels"

_BAND = 0.1  # of a decade


TableSource = Path | NDArray[np.float64]
"""A file, or from Python the array that it would hold."""


class Column(NamedTuple):
    """A column of a table."""

    name: str
    dimension: str  # SI unit; "" for a pure number


LEVELS = (Column("wavelength", "m"), Column("level", "dB"))


def read_levels(table: TableSource) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Read one-third-octave band levels of a texture over wavelength, from a table of two columns.

    Wavelengths (n,), m, unless the heading names another unit, falling, and levels (n,), dB re 1 µm; no band
    may be missing.
    """
    wavelength, level = read_table(table, LEVELS).T
    order = np.argsort(-wavelength)
    wavelength, level = wavelength[order], level[order]
    if wavelength[-1] <= 0:
        raise InputError(
            name_of(table), f"a wavelength of {wavelength[-1]:g} m", "wavelengths greater than 0"
        )
    for longer, shorter in pairwise(wavelength):
        step = math.log10(longer / shorter)
        if abs(step - _BAND) > _BAND / 5:
            kind = "a gap in the bands" if step > _BAND else "bands closer than one-third octaves"
            received = f"{kind} between {longer * 1e3:.4g} mm and {shorter * 1e3:.4g} mm"
            remedy = "Complete the table; nothing is filled in silently."
            raise InputError(
                name_of(table), received, "every one-third octave of wavelength, each once", remedy
            )
    return wavelength, level


def problems_of_table(
    section: Section, name: str, read: Callable[[TableSource], object]
) -> Iterator[InputError]:
    """Say what is wrong with the table that a key names."""
    table = getattr(section, name)
    if isinstance(table, Path | np.ndarray):
        try:
            read(table)
        except InputError as error:
            received = f"{error.received} in {name_of(table)}"
            yield InputError(name, received, error.allowed, error.remedy)


def check_band_levels(levels: NDArray[np.float64], name: str) -> None:
    """Ask for the unit where levels, dB re 1 µm, are those of no wheel or rail: beyond 60 dB."""
    worst = levels[np.argmax(np.abs(levels))]
    if abs(worst) > LARGEST_LEVEL:
        received = f"a level of {worst:.3g} dB re 1 um"
        allowed = f"-{LARGEST_LEVEL:g} to {LARGEST_LEVEL:g} dB re 1 um"
        remedy = "Is the unit right? If these levels are meant, set surface.accept_levels = true."
        raise InputError(name, received, allowed, remedy)


def read_table(
    table: TableSource, columns: tuple[Column, ...], further: tuple[Column, ...] = ()
) -> NDArray[np.float64]:
    """Read a table of numbers (lines, columns), in SI; all of its lines may have all `further` columns.

    An array is taken as it is. In a file, columns are apart by comma, semicolon (with decimal commas) or
    white space; text from '#' on is left out. A heading may name units in brackets, as ``wavelength (cm)``;
    without one, they are SI. A line that does not hold one finite number for each column is refused.
    """
    allowed = f"a table with the columns {_named(columns)}"
    if further:
        allowed += f", or with these and {_named(further)}"
    if isinstance(table, np.ndarray):
        if not len(table) or not np.isfinite(table).all():
            raise InputError(name_of(table), "no rows, or numbers that are not finite", allowed)
        return table
    lines = list(lines_of_cells(read_text(table, table.name, allowed, largest=LARGEST_TABLE)))
    if lines and len(lines[0][1]) == len(columns) + len(further):
        columns += further
    scale, rows = [1.0] * len(columns), []
    for number, cells in lines:
        values = [_number(cell) for cell in cells]
        if len(cells) == len(columns) and all(map(math.isfinite, values)):
            rows.append(values)
        elif len(cells) == len(columns) and not rows and all(map(math.isnan, values)):
            scale = [_scale(cell, column, table) for cell, column in zip(cells, columns, strict=True)]
        else:
            raise InputError(name_of(table), f"'{', '.join(cells)[:40]}' in line {number}", allowed)
    if not rows:
        raise InputError(name_of(table), "no line of numbers", allowed)
    return np.array(rows) * scale


def _named(columns: tuple[Column, ...]) -> str:
    return ", ".join(f"{column.name} ({column.dimension or '1'})" for column in columns)


def _number(cell: str) -> float:
    try:
        return number_in(cell)
    except ValueError:
        return math.nan


def _scale(heading: str, column: Column, path: Path) -> float:
    """SI value of the unit that a heading names in brackets; 1 without one."""
    unit = unit_in_brackets(heading)
    if column.dimension == "dB":
        unit = re.sub(r" ?re ?1 ?[uµμ]m$", "", unit)
    if unit in ("", "-", "1"):
        return 1.0
    try:
        return factor(unit, column.dimension)
    except InputError as error:
        allowed = f"{column.name} in {column.dimension or 'no unit'}"
        raise InputError(path.name, f"the heading {shown(heading)}", allowed, error.remedy) from None
