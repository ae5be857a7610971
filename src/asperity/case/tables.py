"""Tables that a case names, as text with columns: what they hold, read in SI and checked."""

import math
import re
from array import array
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice, pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from asperity.arguments import Array, NDArray, shown
from asperity.case.form import name_of
from asperity.errors import InputError
from asperity.parameters import FROM_PYTHON, File, Origin, Problems
from asperity.spectra import energy_sum
from asperity.structures import support, track_parameters
from asperity.structures.outline import checked_outline
from asperity.text_files import lines_in, lines_of_cells, number_in, read_text
from asperity.units import factor, unit_in_brackets

LARGEST_TABLE = 32 * 2**20  # bytes
LARGEST_LEVEL = 60.0  # dB re 1 um, either side: 1 nm to 1 mm in one band
FEWEST_LINES = 10  # of a receptance
MOST_HEADING = 50
"""Lines of a file among which its heading is sought."""
_BAND = 0.1  # of a decade

TableSource = Path | Array
"""A file, or from Python the array that it would hold."""


class Column(NamedTuple):
    """A column of a table."""

    name: str
    dimension: str  # SI unit; "" for a pure number


_FREQUENCY = Column("frequency", "Hz")
LEVELS = (Column("wavelength", "m"), Column("level", "dB"))
MODES = (_FREQUENCY, Column("damping ratio", ""), Column("modal mass", "kg"))
RADIATION = (
    Column("nodal diameters", ""),
    Column("axial velocity over the disc", ""),
    Column("radial velocity of the tread", ""),
)
"""Further columns of modes: how they move the whole wheel, rms per radial velocity at the contact."""
OUTLINE = (Column("radius", "m"), Column("axial place", "m"))
BAYS = (Column("spacing", "m"), Column("pad stiffness", "N/m"), Column("ballast stiffness", "N/m"))
RATIOS = (_FREQUENCY, Column("radiation ratio", ""))
STIFFNESS = (_FREQUENCY, Column("real part", "N/m"), Column("imaginary part", "N/m"))
STIFFNESS_AND_LOSS = (_FREQUENCY, Column("magnitude", "N/m"), Column("loss factor", ""))
PRELOAD = (Column("preload", "N"),)
"""A further column of both."""
RECEPTANCE = (_FREQUENCY, Column("real part", "m/N"), Column("imaginary part", "m/N"))
MAGNITUDE_AND_PHASE = (_FREQUENCY, Column("magnitude", "m/N"), Column("phase", "rad"))
RECEPTANCES = (
    _FREQUENCY,
    Column("position of the response", "m"),
    Column("position of the force", "m"),
    *RECEPTANCE[1:],
)


@dataclass(frozen=True)
class TableFile(File):
    """A file that holds a table, or an array in its place, which is read to see that it is right."""

    read: Callable[[TableSource], object] = name_of

    def __call__(self, value: Any, origin: Origin = FROM_PYTHON) -> Any:
        """Return the path, absolute, or the array."""
        table = super().__call__(value, origin)
        try:
            self.read(table)
        except InputError as error:
            raise Problems([error.about("", f"{error.received} in {name_of(table)}")]) from None
        return table


def read_levels(table: TableSource) -> tuple[Array, Array]:
    """Read one-third-octave band levels of a texture over wavelength, from a table of two columns or more.

    Wavelengths (n,), m, falling, and levels (n,), dB re 1 µm; no band may be missing. Of several columns of
    levels, lines beside each other, that is their energy mean.
    """
    rows = read_table(table, LEVELS, repeated=True)
    wavelength, levels = rows[:, 0], rows[:, 1:]
    level = levels[:, 0] if levels.shape[1] == 1 else energy_sum(levels) - 10.0 * np.log10(levels.shape[1])
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
    if abs(level.max()) > LARGEST_LEVEL:
        received = f"levels up to {level.max():.3g} dB re 1 um"
        allowed = f"a highest level between -{LARGEST_LEVEL:g} and {LARGEST_LEVEL:g} dB re 1 um"
        raise InputError(name_of(table), received, allowed, "Is the unit right?")
    return wavelength, level


@contextmanager
def fitted_to(table: TableSource) -> Iterator[None]:
    """Name the table whose receptance cannot be, or cannot be met by modes."""
    try:
        yield
    except InputError as error:
        raise error.about(f"{error.what} in {name_of(table)}") from None


def read_mode_table(table: TableSource) -> Array:
    """Read the modes of a wheel (n, 3), `MODES`, or with how they move disc and tread (n, 6), `RADIATION`."""
    rows = read_table(table, MODES, RADIATION)
    frequency, ratio, mass, diameters, *velocities = np.pad(rows, ((0, 0), (0, 6 - rows.shape[1]))).T
    whole, allowed = "a whole number, zero or more", "zero or more, per radial velocity at the contact"
    for what, values, wrong, right in (
        ("a number of nodal diameters", diameters, (diameters < 0) | (diameters % 1 != 0), whole),
        *(("an rms velocity", each, each < 0, allowed) for each in velocities),
        ("a frequency", frequency, frequency <= 0, "greater than 0 Hz"),
        ("a damping ratio", ratio, (ratio <= 0) | (ratio >= 1), "greater than 0 and less than 1"),
        ("a modal mass", mass, mass <= 0, "greater than 0 kg"),
    ):
        refuse_where(table, values, wrong, what, right)
    return rows


def refuse_where(
    table: TableSource, values: Array, wrong: NDArray[np.bool_], what: str, allowed: str
) -> None:
    """Refuse the first of the values of a table that are wrong, if there is one."""
    if wrong.any():
        raise InputError(name_of(table), f"{what} of {values[wrong][0]:g}", allowed)


def read_outline(table: TableSource) -> Array:
    """Read the outline of a wheel's section (n, 2), radius and axial place, m, and check it."""
    outline = read_table(table, OUTLINE)
    checked_outline(outline, f"outline in {name_of(table)}")
    return outline


def read_ratios(table: TableSource) -> tuple[Array, Array]:
    """Read radiation ratios (n,) over rising frequencies (n,), Hz, all above zero."""
    frequency, ratio = read_table(table, RATIOS).T
    refuse_disorder(table, frequency)
    refuse_where(table, ratio, ratio <= 0, "a radiation ratio", "greater than 0")
    return frequency, ratio


def read_receptance(table: TableSource) -> tuple[Array, NDArray[np.complex128]]:
    """Read a receptance at its own place, (n,), m/N, e^{+iωt}, with its rising frequencies, Hz.

    A table of three columns: frequency, real and imaginary part; or, as the heading of a file says, magnitude
    and phase.
    """
    by_phase = isinstance(table, Path) and _tells(table, "phase")
    frequency, first, second = read_table(table, MAGNITUDE_AND_PHASE if by_phase else RECEPTANCE).T
    if frequency.size < FEWEST_LINES:
        raise InputError(name_of(table), f"{frequency.size} frequencies", f"at least {FEWEST_LINES}")
    refuse_disorder(table, frequency)
    return frequency, first * np.exp(1j * second) if by_phase else first + 1j * second


def read_seat_receptance(table: TableSource) -> tuple[Array, NDArray[np.complex128]]:
    """Read the receptance of a sleeper at its rail seat, as `read_receptance`, that makes no energy."""
    frequency, receptance = read_receptance(table)
    with fitted_to(table):
        support.check_receptance(frequency, receptance)
    return frequency, receptance


def read_dynamic_stiffness(table: TableSource) -> Array:
    """Read a dynamic stiffness over frequency, and preload if the table tells it, (n, 3) or (n, 4).

    Frequency, Hz, real and imaginary part, N/m, e^{+iωt}, and preload, N. Files may have magnitude and loss
    factor, the imaginary over the real part, instead, which their heading says; arrays hold the parts.
    """
    by_loss = isinstance(table, Path) and _tells(table, "loss")
    rows = read_table(table, STIFFNESS_AND_LOSS if by_loss else STIFFNESS, PRELOAD)
    if by_loss:
        real = rows[:, 1] / np.hypot(1.0, rows[:, 2])
        rows = np.column_stack([rows[:, 0], real, real * rows[:, 2], rows[:, 3:]])
    try:
        support.check_stiffness_tables(rows)
    except InputError as error:
        raise error.about(name_of(table), f"{error.received} ({error.what})") from None
    return rows


def read_bays(table: TableSource) -> Array:
    """Read the bays of a track one by one (n, 3): distance to the next sleeper, m, pad and ballast, N/m."""
    rows = read_table(table, BAYS)
    if len(rows) > track_parameters.MOST_BAYS:
        raise InputError(
            name_of(table),
            f"{len(rows)} bays",
            f"at most {track_parameters.MOST_BAYS}",
            "They repeat by themselves.",
        )
    for column, values in zip(BAYS, rows.T, strict=True):
        if (wrong := values <= 0.0).any():
            received = (
                f"a {column.name} of {values[wrong][0]:g} {column.dimension} in bay {wrong.argmax() + 1}"
            )
            remedy = "Give a sleeper that hangs very soft ballast, as 1 kN/m." if column is BAYS[2] else ""
            raise InputError(name_of(table), received, "greater than 0", remedy)
    return rows


def _tells(path: Path, word: str) -> bool:
    """Whether the heading of a text file has a word, in small letters."""
    content = read_text(path, path.name, "a table over frequency", largest=LARGEST_TABLE, latin=True)
    lines = (line.lower() for line in islice(lines_in(content), MOST_HEADING))
    return any(word in line and unit_in_brackets(line) for line in lines)


def refuse_disorder(table: TableSource, frequency: Array) -> None:
    """Refuse frequencies, Hz, that do not rise, or are not above zero."""
    if frequency[0] <= 0 or (np.diff(frequency) <= 0).any():
        raise InputError(name_of(table), "frequencies that do not rise", "rising frequencies, all above 0 Hz")


def read_table(
    table: TableSource,
    columns: tuple[Column, ...],
    further: tuple[Column, ...] = (),
    *,
    repeated: bool = False,
) -> Array:
    """Read a table of numbers (lines, columns), in SI; all of its lines may have all `further` columns.

    An array is taken as it is, in SI. In a file, columns are apart by semicolon or tab (with decimal commas),
    comma or white space; text from '#' on is left out. A heading, or a comment right above the numbers, names
    the unit of each column that has one, as ``wavelength (cm)``; a table that does not is refused. So is a
    line that does not hold one finite number for each column. Other lines of words may stand above the
    heading. With `repeated` the last column may come several times.
    """
    allowed = f"a table with the columns {_named(columns)}"
    if further:
        allowed += f", or with these and {_named(further)}"
    if isinstance(table, np.ndarray):
        if not len(table) or not np.isfinite(table).all():
            raise InputError(name_of(table), "no rows, or numbers that are not finite", allowed)
        return table
    content = read_text(table, table.name, allowed, largest=LARGEST_TABLE, latin=True)
    words: deque[list[str]] = deque(maxlen=2)
    heading: list[str] = []
    found = array("d")
    for number, cells in lines_of_cells(content):
        if not found and are_words(cells):
            words.append(cells)
            continue
        if not found:
            if len(cells) == len(columns) + len(further):
                columns += further
            elif repeated and len(cells) > len(columns):
                columns += columns[-1:] * (len(cells) - len(columns))
            dimensions = [column.dimension for column in columns]
            heading = heading_of(words, dimensions) or _comment_above(content, number)
        values = [_number(cell) for cell in cells]
        short = not heading and words and len(cells) < len(words[-1])  # than what may be its heading
        if short or len(cells) != len(columns) or not all(map(math.isfinite, values)):
            raise InputError(name_of(table), f"'{', '.join(cells)[:40]}' in line {number}", allowed)
        found.extend(values)
    if not found:
        raise InputError(name_of(table), "no line of numbers", allowed)
    return np.array(found).reshape(-1, len(columns)) * _scales(heading, columns, table)


def _named(columns: tuple[Column, ...]) -> str:
    return ", ".join(f"{column.name} ({column.dimension or '1'})" for column in columns)


def _number(cell: str) -> float:
    try:
        return number_in(cell)
    except ValueError:
        return math.nan


def _comment_above(content: str, number: int) -> list[str]:
    """Cells of the comment in the line before a line, as programs write a heading; none without one."""
    above = "".join(islice(lines_in(content), max(number - 2, 0), number - 1)).strip()
    text = above.lstrip("#") if above.startswith("#") else ""
    return next((cells for _, cells in lines_of_cells(text)), [])


def _scales(heading: list[str], columns: tuple[Column, ...], path: Path) -> list[float]:
    """SI values of the units that a heading names in brackets, for each column."""
    units = map(unit_of, heading, (column.dimension for column in columns))
    fit = len(heading) == len(columns)
    if not fit or any(not unit and column.dimension for unit, column in zip(units, columns, strict=True)):
        received = f"the heading {shown(', '.join(heading))}" if fit else "no heading"
        example = f"'{', '.join(c.name + f' ({c.dimension})' * bool(c.dimension) for c in columns)}'"
        remedy = f"Add the line {example} above the numbers, with the units that they are in."
        raise InputError(path.name, received, "a heading with the units in brackets", remedy)
    for cell, column in zip(heading, columns, strict=True):
        for other in columns:
            if _words(cell) & (_words(other.name) - _words(column.name)) and not (
                _words(cell) & (_words(column.name) - _words(other.name))
            ):
                received = f"the heading {shown(cell)} for the {column.name}"
                allowed = f"columns in the order {_named(columns)}"
                raise InputError(path.name, received, allowed, "Exchange the columns.")
    return [_scale(cell, column, path) for cell, column in zip(heading, columns, strict=True)]


def _words(text: str) -> set[str]:
    return set(re.findall(r"[a-z]+", text.lower()))


def _scale(heading: str, column: Column, path: Path) -> float:
    """SI value of the unit that a heading names in brackets; 1 for a pure number."""
    unit = unit_of(heading, column.dimension)
    if not column.dimension and unit in ("", "-", "1"):
        return 1.0
    try:
        return factor(unit, column.dimension)
    except InputError as error:
        allowed = f"{column.name} in {column.dimension or 'no unit'}"
        raise InputError(path.name, f"the heading {shown(heading)}", allowed, error.remedy) from None


# --- headings


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
        if bare and above:
            return [f"{title} {unit}" for title, unit in zip(above[-1], last, strict=True)]
        return last
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
