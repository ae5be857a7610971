"""Tables of what was measured on a track and beside it: read in SI, refused where they cannot be right."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from asperity.arguments import Array, NDArray
from asperity.case.in_memory import name_of
from asperity.case.table_headings import Column
from asperity.case.tables import TableSource, read_table, refuse_disorder, tells
from asperity.errors import InputError
from asperity.spectra import a_weighting, third_octave_numbers
from asperity.written_numbers import count_of, rounded

FEWEST = 3
"""Rows of a table over frequency."""
BAND_SHIFT = 0.06
"""By how much, in bands, a nominal centre may be off the exact one: 1.6 is by 0.041."""
DECAY_RATES = (0.01, 200.0)
"""dB/m: half a kilometre of rail moves as one, or less than one of a length shorter than its section."""
RAILS = ("left", "right"), ("links", "rechts"), ("gauche", "droite")
"""Words by which headings tell the rails apart."""
MOBILITIES = (1e-9, 0.1)
"""(m/s)/N: rails lie between 1e-7 and 1e-3."""

MOST_GAINS = 0.1
"""Share of the lines at which noise may turn the power round that a hammer gives to a rail."""

SOUND = ("dB", "dB(A)")
PRESSURE = "20 uPa"
"""Reference of levels of sound."""
SOUND_LEVELS = (-20.0, 180.0)
"""dB re 20 µPa."""

_FREQUENCY = Column("frequency", "Hz")
_VERTICAL, _LATERAL = Column("vertical decay rate", "dB/m"), Column("lateral decay rate", "dB/m")
_PHASE = Column("phase", "rad")
FORMS = {"m/s/N": 0, "m/s^2/N": -1, "m/N": 1}
"""Units of mobility, accelerance and receptance; the power of iω that makes a mobility of each."""


def band_numbers(table: TableSource, frequency: Array) -> Array:
    """Numbers n of one-third octaves 10^(n/10) Hz, by nominal or exact centres, Hz; rising, each once."""
    refuse_disorder(table, frequency)
    places = 10.0 * np.log10(frequency)
    numbers = third_octave_numbers(frequency)
    allowed = "centres of one-third octaves that rise, each once, as 100, 125, 160"
    if (off := np.abs(places - numbers) > BAND_SHIFT).any():
        received = f"a frequency of {frequency[off][0]:g} Hz"
        raise InputError(name_of(table), received, allowed, "Sum narrow bands to one-third octaves first.")
    if (again := np.diff(numbers) == 0).any():
        raise InputError(name_of(table), f"twice the band of {frequency[1:][again][0]:g} Hz", allowed)
    return numbers


def read_decay_rates(table: TableSource) -> tuple[Array, Array, Array | None]:
    """Read decay rates (n,), dB/m, vertical and, if the table has them, lateral, in one-third octaves.

    A table of two or three columns, as EN 15461 reports them, which may lack bands; or of both rails, two
    vertical ones and, if it has them, two lateral ones. Of these 1/Δ is the mean of both, as the sound of two
    rails is. First come the exact centres (n,), Hz.
    """
    centres, rates = read_rails(table)
    of_both = 1.0 / np.mean(1.0 / rates, axis=2)
    return centres, of_both[:, 0], of_both[:, 1] if of_both.shape[1] > 1 else None


def read_rails(table: TableSource) -> tuple[Array, Array]:
    """Exact centres (n,), Hz, and the rates of such a table by direction and rail (n, directions, rails)."""
    rows, rails = _of_rails(table)
    rates = rows[:, 1:]
    _refuse_beyond(table, rates, DECAY_RATES, "a decay rate", "dB/m")
    numbers = band_numbers(table, rows[:, 0])
    return 10.0 ** (0.1 * numbers), rates.reshape(len(rates), -1, rails)


def _of_rails(table: TableSource) -> tuple[Array, int]:
    """Rows of a table of decay rates, and of how many rails it holds them, one after the other."""
    both = _FREQUENCY, _VERTICAL, _VERTICAL
    try:
        rows = read_table(table, both[:2], (_LATERAL,))
    except InputError as error:
        try:
            rows = read_table(table, both, (_LATERAL, _LATERAL))
        except InputError:
            raise error from None
        if rows.shape[1] == len(both) and isinstance(table, Path) and tells(table, "lateral"):
            raise
        return rows, 2
    two = rows.shape[1] == len(both) and isinstance(table, Path) and _names_rails(table)
    return rows, 2 if two or rows.shape[1] == len(both) + 2 else 1


def _names_rails(table: Path) -> bool:
    """Whether the columns of a table are those of two rails in one direction: none of them is lateral."""
    return not tells(table, "lateral") and any(all(tells(table, each) for each in pair) for pair in RAILS)


def read_mobility(
    table: TableSource, within: tuple[float, float] = MOBILITIES
) -> tuple[Array, NDArray[np.inexact]]:
    """Read a point mobility (n,), (m/s)/N, over rising frequencies (n,), Hz: complex, or its magnitude.

    A table of frequency and magnitude, magnitude and phase, or real and imaginary part, e^{+iωt}; the unit in
    a file says whether it holds mobility, accelerance or receptance.
    """
    turned = isinstance(table, Path) and tells(table, "phase")
    if turned:
        rows, unit = in_some_unit(table, FORMS, (_FREQUENCY,), ("magnitude",), behind=(_PHASE,))
    else:
        rows, unit = in_some_unit(
            table, FORMS, (_FREQUENCY,), ("magnitude or real part",), ("imaginary part",)
        )
    frequency = rows[:, 0]
    refuse_disorder(table, frequency)
    whole = rows.shape[1] == 3  # with its phase
    response = rows[:, 1] * np.exp(1j * rows[:, 2]) if turned else rows[:, 1] + 1j * rows[:, -1]
    found, turn = (response, 1j) if whole else (rows[:, 1], 1.0)
    mobility = found * (turn * 2.0 * np.pi * frequency) ** FORMS[unit]
    size = np.asarray(np.abs(mobility) if whole else mobility.real)
    _refuse_beyond(table, size, within, "a mobility", "(m/s)/N")
    gains = mobility.real < 0.0
    if np.mean(gains) > MOST_GAINS:
        received = f"a rail that gives power to the hammer at {frequency[gains][0]:g} Hz and elsewhere"
        allowed = "a point mobility, whose real part is positive"
        remedy = "Are unit (mobility, accelerance or receptance) and sign of the phase, e^{+iωt}, right?"
        raise InputError(name_of(table), received, allowed, remedy)
    return frequency, mobility


def read_band_levels(table: TableSource) -> tuple[Array, Array]:
    """Read sound pressure levels (n,), dB, in one-third octaves by their exact centres (n,), Hz.

    Without weighting; a file says by the unit dB(A) that its levels are A-weighted.
    """
    rows, unit = in_some_unit(table, SOUND, (_FREQUENCY,), ("level",))
    _refuse_beyond(table, level := rows[:, 1], SOUND_LEVELS, "a level", "dB re 20 uPa")
    centres = 10.0 ** (0.1 * band_numbers(table, rows[:, 0]))
    return centres, level - (a_weighting(centres) if unit == SOUND[1] else 0.0)


def _refuse_beyond(
    table: TableSource, values: Array, within: tuple[float, float], what: str, unit: str
) -> None:
    """Refuse values at few frequencies, and those beyond what is plausible: ask for their unit."""
    if len(values) < FEWEST:
        raise InputError(name_of(table), count_of(len(values), "frequency"), f"at least {FEWEST}")
    if (wrong := (values < within[0]) | (values > within[1])).any():
        received = f"{what} of {rounded(values[wrong][0])} {unit}"
        allowed = "{:g} to {:g} ".format(*within) + unit
        raise InputError(name_of(table), received, allowed, "Is the unit right?")


def in_some_unit(
    table: TableSource,
    units: Iterable[str],
    columns: tuple[Column, ...],
    names: tuple[str, ...],
    further: tuple[str, ...] = (),
    behind: tuple[Column, ...] = (),
) -> tuple[Array, str]:
    """Rows of a table, and the first of some units in which those of its columns are that have names here.

    They stand behind its other columns, and before those `behind`; all lines may have `further` ones.
    """
    errors = []
    tried = list(units)
    for unit in tried:
        reference = PRESSURE if unit in SOUND else ""
        own, more = (tuple(Column(name, unit, reference) for name in each) for each in (names, further))
        try:
            return read_table(table, columns + own + behind, more), unit
        except InputError as error:
            errors.append(error)
    told, *_ = errors
    allowed = told.allowed.replace(tried[0], " or ".join(tried))
    in_levels = isinstance(table, Path) and tells(table, "db") and not set(tried) & set(SOUND)
    as_value = "Write each level L as a value: its reference times 10^(L/20)."
    remedy = as_value if in_levels else told.remedy
    raise InputError(told.what, told.received, allowed, remedy)
