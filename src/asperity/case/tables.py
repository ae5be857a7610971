"""Tables that a case names, as text with columns: what they hold, read in SI and checked."""

import math
from array import array
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice, pairwise
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from asperity.arguments import Array, Complex, Flags, listed
from asperity.case.in_memory import name_of
from asperity.case.table_headings import (
    MOST_HEADING,
    Column,
    are_words,
    converted,
    heading_of,
    is_wide,
    named,
    refuse_statistics,
    refuse_wide,
    without_limits,
)
from asperity.errors import InputError
from asperity.parameters import (
    FORCE,
    FROM_PYTHON,
    File,
    Key,
    Origin,
    Problems,
    keys_of,
    optional,
    outside,
)
from asperity.spectra import energy_mean
from asperity.structures import support, track_parameters
from asperity.structures.outline import checked_outline
from asperity.text_files import lines_in, lines_of_cells, number_or_nan, read_text, refuse_decimal_commas
from asperity.units import unit_in_brackets
from asperity.written_numbers import count_of, rounded

LARGEST_TABLE = 32 * 2**20  # bytes
LARGEST_LEVEL = 60.0  # dB re 1 um, either side: 1 nm to 1 mm in one band
LONGEST_WAVE, MEASURED_WAVE = 10.0, 1.0
"""m: roughness is measured up to 1 m, long corrugation up to 3 m; what is longer is track geometry."""
_SMALLER = {"cm": 1e-2, "mm": 1e-3, "um": 1e-6, "nm": 1e-9}
FEWEST_LINES = 10  # of a receptance
_BAND = 0.1  # of a decade
DECIMALS = 14
"""Of an outline, m."""

TableSource = Path | Array
"""A file, or from Python the array that it would hold."""


_FREQUENCY = Column("frequency", "Hz")
LEVELS = (Column("wavelength", "m"), Column("level", "dB", "1 um"))
MODES = (_FREQUENCY, Column("damping ratio", ""), Column("modal mass", "kg"))
RADIATION = (
    Column("nodal diameters", ""),
    Column("axial velocity over the disc", ""),
    Column("radial velocity of the tread", ""),
)
"""Further columns of modes: how they move the whole wheel, rms per radial velocity at the contact."""
OUTLINE = (Column("radius", "m"), Column("axial place", "m"))
BAYS = (Column("spacing", "m"), Column("pad stiffness", "N/m"), Column("ballast stiffness", "N/m"))
_TRACK = keys_of(track_parameters.TrackParameters, "")
_OF_BAYS = ("sleeper_spacing", "pad_stiffness", "ballast_stiffness")
"""Keys whose plausible limits are those of the same columns."""
PRELOAD_KEY = optional(
    FORCE,
    "30 kN",
    "preload of the pads at which such a table is taken",
    "what a support carries of the wheel's static load",
    "1 N to 10 MN: rails press on pads with as much",
    goes_with="pad_table",
)
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
    wavelength = rows[:, 0]
    levels = rows[:, 1:]
    level = levels[:, 0] if levels.shape[1] == 1 else energy_mean(levels)
    order = np.argsort(-wavelength)
    wavelength = wavelength[order]
    level = level[order]
    if wavelength[-1] <= 0:
        raise InputError(
            name_of(table), f"a wavelength of {wavelength[-1]:g} m", "wavelengths greater than 0"
        )
    if wavelength[0] > LONGEST_WAVE:
        from asperity.surfaces.bands import likely_band  # which loads transforms

        received = f"wavelengths of {wavelength[-1]:.4g} m to {wavelength[0]:.4g} m"
        unit = max(_SMALLER, key=lambda unit: int(likely_band(wavelength * _SMALLER[unit]).sum()))
        remedy = f"Are they in {unit}? Then write 'wavelength ({unit})' above them."
        raise InputError(name_of(table), received, f"waves of roughness, up to {LONGEST_WAVE:g} m", remedy)
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
        received = f"levels up to {rounded(level.max())} dB re 1 um"
        allowed = f"a highest level between -{LARGEST_LEVEL:g} and {LARGEST_LEVEL:g} dB re 1 um"
        raise InputError(name_of(table), received, allowed, "Is the unit right?")
    return wavelength, level


def columns_of_levels(table: TableSource) -> str:
    """Say which columns of a file with levels count, and which are left out; nothing where there are two."""
    if not isinstance(table, Path):
        return ""
    content = read_text(table, table.name, "a table of levels", largest=LARGEST_TABLE, latin=True)
    words: deque[list[str]] = deque(maxlen=2)
    for number, cells in lines_of_cells(content):
        if are_words(cells):
            words.append(cells)
            continue
        if len(cells) <= len(LEVELS):
            return ""
        above = [*words, _comment_above(content, number)]
        kept = without_limits(above, len(cells), len(LEVELS))
        titles = heading_of(above, ["m", *["dB"] * (len(cells) - 1)])
        named_so = [f"'{title}'" for title in titles]
        counted = [each for place, each in enumerate(named_so) if place in kept[1:]]
        others = [each for place, each in enumerate(named_so) if place not in kept]
        mean = "the energy mean of " * (len(counted) > 1)
        return f"{mean}{listed(counted)}" + f", without {listed(others)}" * bool(others)
    return ""


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
    whole = "a whole number, zero or more"
    allowed = "zero or more, per radial velocity at the contact"
    for what, values, wrong, right in (
        ("a number of nodal diameters", diameters, (diameters < 0) | (diameters % 1 != 0), whole),
        *(("an rms velocity", each, each < 0, allowed) for each in velocities),
        ("a frequency", frequency, frequency <= 0, "greater than 0 Hz"),
        ("a damping ratio", ratio, (ratio <= 0) | (ratio >= 1), "greater than 0 and less than 1"),
        ("a modal mass", mass, mass <= 0, "greater than 0 kg"),
    ):
        refuse_where(table, values, wrong, what, right)
    return rows


def refuse_where(table: TableSource, values: Array, wrong: Flags, what: str, allowed: str) -> None:
    """Refuse the first of the values of a table that are wrong, if there is one."""
    if wrong.any():
        raise InputError(name_of(table), f"{what} of {values[wrong][0]:g}", allowed)


def read_outline(table: TableSource) -> Array:
    """Read the outline of a wheel's section (n, 2), radius and axial place, m, and check it."""
    outline = np.round(read_table(table, OUTLINE), DECIMALS)  # in whatever unit, the same numbers
    checked_outline(outline, f"outline in {name_of(table)}")
    return outline


def _refuse_implausible(table: TableSource, what: str, values: Array, key: Key) -> None:
    """Refuse numbers of a table where the same number as a key of a case is refused."""
    for value in (values.min(), values.max()):
        for error in outside(what, float(value), key.kind, key.within):
            received = f"a {what} of {error.received}"
            raise InputError(name_of(table), received, error.allowed, f"{error.remedy} Is the unit right?")


def read_ratios(table: TableSource) -> tuple[Array, Array]:
    """Read radiation ratios (n,) over rising frequencies (n,), Hz, all above zero."""
    frequency, ratio = read_table(table, RATIOS).T
    refuse_disorder(table, frequency)
    refuse_where(table, ratio, ratio <= 0, "a radiation ratio", "greater than 0")
    return frequency, ratio


def read_receptance(table: TableSource) -> tuple[Array, Complex]:
    """Read a receptance at its own place, (n,), m/N, e^{+iωt}, with its rising frequencies, Hz.

    A table of three columns: frequency, real and imaginary part; or, as the heading of a file says, magnitude
    and phase.
    """
    by_phase = isinstance(table, Path) and tells(table, "phase")
    frequency, first, second = read_table(table, MAGNITUDE_AND_PHASE if by_phase else RECEPTANCE).T
    if frequency.size < FEWEST_LINES:
        raise InputError(name_of(table), count_of(frequency.size, "frequency"), f"at least {FEWEST_LINES}")
    refuse_disorder(table, frequency)
    return frequency, first * np.exp(1j * second) if by_phase else first + 1j * second


def read_seat_receptance(table: TableSource) -> tuple[Array, Complex]:
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
    by_loss = isinstance(table, Path) and tells(table, "loss")
    rows = read_table(table, STIFFNESS_AND_LOSS if by_loss else STIFFNESS, PRELOAD)
    if by_loss:
        real = rows[:, 1] / np.hypot(1.0, rows[:, 2])
        rows = np.column_stack([rows[:, 0], real, real * rows[:, 2], rows[:, 3:]])
    _refuse_implausible(table, "stiffness", np.hypot(rows[:, 1], rows[:, 2]), _TRACK["pad_stiffness"])
    if rows.shape[1] > 3:
        _refuse_implausible(table, "preload", rows[:, 3], PRELOAD_KEY)
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
            count_of(len(rows), "bay"),
            f"at most {track_parameters.MOST_BAYS}",
            "They repeat by themselves.",
        )
    for column, name, values in zip(BAYS, _OF_BAYS, rows.T, strict=True):
        if (wrong := values <= 0.0).any():
            received = (
                f"a {column.name} of {values[wrong][0]:g} {column.dimension} in bay {wrong.argmax() + 1}"
            )
            remedy = "Give a sleeper that hangs very soft ballast, as 1 kN/m." if column is BAYS[2] else ""
            raise InputError(name_of(table), received, "greater than 0", remedy)
        _refuse_implausible(table, column.name, values, _TRACK[name])
    return rows


def tells(path: Path, word: str) -> bool:
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
    allowed = f"a table with the columns {named(columns)}"
    if further:
        allowed += f", or with these and {named(further)}"
    if isinstance(table, np.ndarray):
        if not len(table) or not np.isfinite(table).all():
            raise InputError(name_of(table), "no rows, or numbers that are not finite", allowed)
        return table
    content = read_text(table, table.name, allowed, largest=LARGEST_TABLE, latin=True)
    refuse_decimal_commas(content, table.name)
    words: deque[list[str]] = deque(maxlen=2)
    heading: list[str] = []
    kept: list[int] = []
    found = array("d")
    for number, cells in lines_of_cells(content):
        if not found and are_words(cells):
            words.append(cells)
            continue
        if not found:
            above = _comment_above(content, number)
            kept = without_limits([*words, above], len(cells), len(columns))
            count = len(kept)
            if count == len(columns) + len(further):
                columns += further
            elif repeated and count > len(columns):
                columns += columns[-1:] * (count - len(columns))
            titles = [_of(row, kept, len(cells)) for row in words]
            heading = heading_of(titles, [each.dimension for each in columns]) or _of(above, kept, len(cells))
            if not heading and words and 1 < len(words[-1]) < len(cells):
                received = f"{count_of(len(cells), 'number')} in line {number} below {len(words[-1])} titles"
                remedy = "Do commas stand in numbers and between them? Export decimal points, or semicolons."
                raise InputError(name_of(table), received, allowed, remedy)
            short = not heading and words and len(cells) < len(words[-1])  # than what may be its heading
            if short or count != len(columns) or any(is_wide(row, columns[0]) for row in words):
                _refuse_line(table, content, cells, number, columns, allowed)
            if repeated:
                refuse_statistics(heading, table.name)
            width = len(cells)
        values = [number_or_nan(cell) for cell in _of(cells, kept, width)]
        if len(cells) != width or not all(map(math.isfinite, values)):
            _refuse_line(table, content, cells, number, columns, allowed)
        found.extend(values)
    if not found:
        refuse_wide(content, columns, table.name)
        raise InputError(name_of(table), "no line of numbers", allowed)
    return converted(np.array(found).reshape(-1, len(columns)), heading, columns, table.name)


def _of(cells: list[str], kept: list[int], count: int) -> list[str]:
    """Cells of the columns that are kept, of a line that has as many as all columns."""
    return [cells[each] for each in kept] if len(cells) == count else cells


def _refuse_line(
    table: Path, content: str, cells: list[str], number: int, columns: Sequence[Column], allowed: str
) -> NoReturn:
    """Refuse a line that does not fit, or the table whose lines do not because it lies on its side."""
    refuse_wide(content, columns, table.name)
    raise InputError(name_of(table), f"'{', '.join(cells)[:40]}' in line {number}", allowed)


def _comment_above(content: str, number: int) -> list[str]:
    """Cells of the comment in the line before a line, as programs write a heading; none without one."""
    above = "".join(islice(lines_in(content), max(number - 2, 0), number - 1)).strip()
    text = above.lstrip("#") if above.startswith("#") else ""
    return next((cells for _, cells in lines_of_cells(text)), [])
