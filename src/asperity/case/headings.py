"""Headings of tables, as people, instruments and spreadsheets write them: in which unit each column is."""

import re
from collections.abc import Sequence

from asperity.errors import InputError
from asperity.units import factor, unit_in_brackets

_REFERENCE = re.compile(r" ?re[fl]?\.? ?(1 ?([uµμ]m|micron)|1e-6 ?m|20 ?[uµμ]Pa)$")
_AFTER = re.compile(r"(?:.* in |[^/]*/)\s*(\S.*)")
"""``level in dB``, ``wavelength / cm``."""
_WITH_UNIT = re.compile(r"[^()\[\]]+[(\[][^()\[\]]*[)\]]")
_NUMBER = re.compile(r"[-+.]?\d|nan|[-+]?inf", re.IGNORECASE)


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
        return (
            [f"{title} {unit}" for title, unit in zip(above[-1], last, strict=True)]
            if bare and above
            else last
        )
    if above and all(map(_is_unit, last, dimensions)):
        return [f"{title} ({unit})" for title, unit in zip(above[-1], last, strict=True)]
    return last


def unit_of(title: str, dimension: str) -> str:
    """Unit that a title names, in brackets, or of a dimension also behind "in" or a stroke; empty without."""
    found = unit_in_brackets(title)
    if not found and dimension and (behind := _AFTER.fullmatch(title)):
        found = " ".join(behind[1].split())
    if dimension.startswith("dB"):
        found = re.sub(r"^dB ?A$", "dB(A)", _REFERENCE.sub("", found))
    return found


def _titles(cells: list[str], count: int) -> list[str]:
    """Cells, or titles that each end with a bracket, where blanks stand between them."""
    if len(cells) != count:
        found = [each.strip() for each in _WITH_UNIT.findall(" ".join(cells))]
        return found if len(found) == count else cells
    return cells


def _is_unit(text: str, dimension: str) -> bool:
    try:
        return not dimension or factor(unit_of(f"({text})", dimension), dimension) > 0.0
    except InputError:
        return False
