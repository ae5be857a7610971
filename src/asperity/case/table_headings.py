"""Headings of tables: titles of their columns, units and references, and columns that hold something else."""

import math
import re
from collections.abc import Iterable, Sequence
from itertools import islice, pairwise
from typing import NamedTuple

from asperity.arguments import Array, shown
from asperity.errors import InputError
from asperity.text_files import lines_of_cells
from asperity.units import factor, quantity, unit_in_brackets

_AFTER = re.compile(r"(?:.* in |[^/]*/)\s*(\S.*)")
"""``level in dB``, ``wavelength / cm``."""
_WITH_UNIT = re.compile(r"[^()\[\]]+[(\[][^()\[\]]*[)\]]")
_NUMBER = re.compile(r"[-+.]?\d|nan|[-+]?inf", re.IGNORECASE)
_LEVEL = re.compile(r"(dB)(?: ?\(?(A)\)?)?(?:[ ,(]* ?re(?:[fl]\.?|\.)?(?: to)?:? ?(.+?)\)?)?")
"""``dB``, ``dB(A)``, ``dB re 1 µm``: what is weighted, and the reference."""
_PER_LENGTH = re.compile(r"dB ?/ ?(\S+)")
_LIMIT = re.compile(
    r"\b(?:limits?|grenz\w*|limites?|límites?|permitted|allowed|required|requirement|target|soll\w*)\b"
    r"|\bISO[ -]?3095\b|\bTSI\b|\bEN[ -]?13979\b|\breference (?:curve|spectrum|values?)|\breferenz\w*"
    r"|\b(?:diff(?:erences?|erenz)?|exceed\w*|exceedances?|margins?|überschreit\w*|abweichung\w*|écarts?)\b",
    re.IGNORECASE,
)
_STATISTIC = re.compile(
    r"\b(?:means?|averages?|avg|mittel\w*|moyenne|median|max\w*|min\w*|std|sd|st\w* ?dev\w*|deviation"
    r"|uncertainty|spread|sigma|σ|total|sum|gesamt\w*|summe|variance|quantiles?|percentiles?|perzentil\w*|[LP]_?(?:50|90|95|99))\b",
    re.IGNORECASE,
)
_WAVENUMBER = re.compile(r"wave ?numbers?|wellenzahl|\b1/[a-zµμ]?m\b|m\^?-1\b", re.IGNORECASE)
RECIPROCAL = "Write wavelengths: one over wavenumbers in cycles, 2π over those in radians."
_QUANTITY = re.compile(r"[\d.,]{1,12} ?[a-zA-Zµμ]{1,3}")
_PLACE = re.compile(r"\d+(?:[.,]\d+)?")
BAND_STEP = 1.15, 1.4
"""Ratio of the centres of neighbouring one-third octaves, rounded: 1.26."""
WIDE = 3
"""Cells of one line that are positions, from which on a table may lie on its side."""
MOST_LABELS = 8
"""Cells that name its measurements."""
MOST_HEADING = 50
"""Lines of a file among which its heading is sought."""


class Column(NamedTuple):
    """A column of a table."""

    name: str
    dimension: str  # SI unit; "" for a pure number
    reference: str = ""  # of a level


def named(columns: Iterable[Column]) -> str:
    """Columns in words, with their units."""
    return ", ".join(f"{column.name} ({column.dimension or '1'})" for column in columns)


def are_words(cells: Sequence[str]) -> bool:
    """Whether cells begin a line of words: neither with a number nor with what stands for one."""
    return not _NUMBER.match(cells[0])


def heading_of(lines: Sequence[list[str]], dimensions: Sequence[str]) -> list[str]:
    """Title of each column, with its unit, from the lines of words above a table; none without such a line.

    The last with a title for each column of a dimension, in SI. Units in a line of their own are those of the
    titles above them.
    """
    fitting = [_titles(cells, len(dimensions)) for cells in lines]
    fitting = [cells for cells in fitting if len(cells) == len(dimensions)]
    if not fitting:
        return []
    *above, last = fitting
    if any(unit_of(*each) for each in zip(last, dimensions, strict=True)):
        bare = all(cell[:1] in "([" for cell in last)
        if bare and above:
            return [f"{title} {unit}" for title, unit in zip(above[-1], last, strict=True)]
        return last
    if above and all(map(_is_unit, last, dimensions)):
        return [f"{title} ({unit})" for title, unit in zip(above[-1], last, strict=True)]
    return last


def _titles(cells: list[str], count: int) -> list[str]:
    """Cells, or titles that each end with a bracket, where blanks stand between them."""
    if len(cells) != count:
        found = [each.strip() for each in _WITH_UNIT.findall(" ".join(cells))]
        return found if len(found) == count else cells
    return cells


def _is_unit(text: str, dimension: str) -> bool:
    try:
        return not dimension or in_si(unit_of(f"({text})", dimension), dimension) > 0.0
    except InputError:
        return False


def unit_of(title: str, dimension: str) -> str:
    """Unit that a title names, in brackets, or of a dimension also behind "in" or a stroke; empty without.

    Of a level it is that without its reference.
    """
    found = _as_written(title, dimension)
    level = _LEVEL.fullmatch(found) if dimension in ("dB", "dB(A)") else None
    return f"dB({level[2]})" if level and level[2] else "dB" if level else found


def _as_written(title: str, dimension: str) -> str:
    found = unit_in_brackets(title)
    if not found and dimension and (behind := _AFTER.fullmatch(title)):
        found = " ".join(behind[1].split())
    return found


def in_si(unit: str, dimension: str) -> float:
    """SI value of a unit as `factor`, or of a rate of decay per any length."""
    per = _PER_LENGTH.fullmatch(unit) if dimension == "dB/m" else None
    return 1.0 / factor(per[1], "m") if per else factor(unit, dimension)


def converted(rows: Array, heading: list[str], columns: Sequence[Column], source: str) -> Array:
    """Rows of a table in SI, by the units and references that the titles of a heading name."""
    units = map(unit_of, heading, (column.dimension for column in columns))
    fit = len(heading) == len(columns)
    if not fit or any(not unit and column.dimension for unit, column in zip(units, columns, strict=True)):
        received = f"the heading {shown(', '.join(heading))}" if fit else "no heading"
        remedy = f"Add the line {_example(columns)} above the numbers, with the units that they are in."
        raise InputError(source, received, "a heading with the units in brackets", remedy)
    _refuse_exchanged(heading, columns, source)
    scales = [_scale(title, column, source) for title, column in zip(heading, columns, strict=True)]
    offsets = [_offset(title, column, source) for title, column in zip(heading, columns, strict=True)]
    return rows * scales + offsets if any(offsets) else rows * scales


def _example(columns: Sequence[Column]) -> str:
    return f"'{', '.join(c.name + f' ({c.dimension})' * bool(c.dimension) for c in columns)}'"


def _refuse_exchanged(heading: list[str], columns: Sequence[Column], source: str) -> None:
    """Refuse titles whose words are those of another column."""
    for cell, column in zip(heading, columns, strict=True):
        for other in columns:
            if _words(cell) & (_words(other.name) - _words(column.name)) and not (
                _words(cell) & (_words(column.name) - _words(other.name))
            ):
                received = f"the heading {shown(cell)} for the {column.name}"
                allowed = f"columns in the order {named(columns)}"
                raise InputError(source, received, allowed, "Exchange the columns.")


def _words(text: str) -> set[str]:
    return set(re.findall(r"[a-z]+", text.lower()))


def _scale(title: str, column: Column, source: str) -> float:
    """SI value of the unit that a title names; 1 for a pure number."""
    unit = unit_of(title, column.dimension)
    if not column.dimension and unit in ("", "-", "1"):
        return 1.0
    try:
        return in_si(unit, column.dimension)
    except InputError as error:
        allowed = f"{column.name} in {column.dimension or 'no unit'}"
        remedy = RECIPROCAL if column.name == "wavelength" and _WAVENUMBER.search(title) else error.remedy
        raise InputError(source, f"the heading {shown(title)}", allowed, remedy) from None


def _offset(title: str, column: Column, source: str) -> float:
    """Level, dB, of the reference that a title names, re that of a column; 0 where it names none."""
    level = _LEVEL.fullmatch(_as_written(title, column.dimension)) if column.reference else None
    if level is None or not level[3]:
        return 0.0
    number, unit = column.reference.split()
    stated = level[3] if _NUMBER.match(level[3]) else f"1 {level[3]}"
    dimension = unit[1:] or unit
    try:
        ratio = quantity(stated, dimension) / quantity(column.reference, dimension)
    except InputError:
        ratio = math.nan
    if not 0.0 < ratio < math.inf:
        allowed = f"a {column.name} in dB re {number} {unit}, or re another number of {dimension}"
        remedy = "Levels of another quantity cannot be converted."
        raise InputError(source, f"the heading {shown(title)}", allowed, remedy)
    return round(20.0 * math.log10(ratio), 9)


# --- columns that hold something else, and tables that lie on their side


def without_limits(lines: Sequence[list[str]], count: int, least: int) -> list[int]:
    """Numbers of the columns of a table of so many that hold no limit, by the lines of words above it.

    All of them, if fewer would be left than the least that it needs.
    """
    titles = [cells for cells in lines if len(cells) == count]
    kept = [n for n in range(count) if not any(_LIMIT.search(cells[n]) for cells in titles)]
    return kept if len(kept) >= least and kept[:1] == [0] else list(range(count))


def refuse_statistics(heading: list[str], source: str) -> None:
    """Refuse a mean or an extreme among levels of lines, which would count as one of them."""
    found = [title for title in heading[1:] if _STATISTIC.search(title)]
    if found and len(heading) > 2:
        received = f"the heading {shown(found[0])} beside other columns of levels"
        allowed = "levels of lines beside each other, or one column alone"
        raise InputError(source, received, allowed, "Leave the others out, or this one.")


def is_wide(cells: Sequence[str], first: Column) -> bool:
    """Whether a line has many positions of a first column beside each other, as ``31.5 cm, 25 cm``.

    Or bands behind a word, as ``wavelength (cm), 31.5, 25``: no names of lines, which count on.
    """
    held = _positions(cells, first)
    if len(held) > WIDE and len(held) >= len(cells) - MOST_LABELS:
        return True
    values = [float(found[0].replace(",", ".")) for cell in cells[1:] if (found := _PLACE.match(cell))]
    steps = [max(a, b) / min(a, b) for a, b in pairwise(values) if min(a, b) > 0.0]
    in_bands = len(steps) == len(cells) - 2 and all(BAND_STEP[0] < step < BAND_STEP[1] for step in steps)
    return _is_labelled(cells) and in_bands


def _is_labelled(cells: Sequence[str]) -> bool:
    """Whether a line has numbers behind a word."""
    return len(cells) > WIDE and are_words(cells) and all(_NUMBER.match(cell) for cell in cells[1:])


def _positions(cells: Sequence[str], first: Column) -> list[str]:
    return [cell for cell in cells if first.dimension and _QUANTITY.fullmatch(cell) and _fits(cell, first)]


def refuse_wide(content: str, columns: Sequence[Column], source: str) -> None:
    """Refuse a table that lies on its side, one measurement in a row, and say how to turn it."""
    columns = list(dict.fromkeys(columns))  # of several alike, one
    first = columns[0]
    for line, cells in islice(lines_of_cells(content), MOST_HEADING):
        if not _is_labelled(cells) and not is_wide(cells, first):
            continue
        held = _positions(cells, first) or cells[1:]
        unit = unit_of(cells[0], first.dimension) or held[0].lstrip("0123456789., ") or first.dimension
        plural = {"frequency": "frequencies"}.get(first.name, f"{first.name}s")
        received = f"{len(held)} {plural} beside each other in line {line}, one measurement in a row"
        allowed = f"one line for each {first.name}, with the columns {named(columns)}"
        row = ", ".join([held[0].removesuffix(unit).rstrip(), *["…"] * (len(columns) - 1)])
        turned = _example([first._replace(dimension=unit), *columns[1:]])
        remedy = f"Turn the table: write the line {turned} and lines below it as '{row}'."
        raise InputError(source, received, allowed, remedy)


def _fits(cell: str, column: Column) -> bool:
    try:
        return quantity(cell.replace(",", "."), column.dimension) > 0.0
    except InputError:
        return False
