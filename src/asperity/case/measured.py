"""Tables of what was measured on a track: read in SI, and refused where they cannot be right."""

import numpy as np
from numpy.typing import NDArray

from asperity.arguments import Array
from asperity.case.content import name_of
from asperity.case.tables import Column, TableSource, read_table, refuse_disorder
from asperity.errors import InputError

FEWEST = 3
"""Rows of a table over frequency."""
BAND_SHIFT = 0.06
"""By how much, in bands, a nominal centre may be off the exact one: 1.6 is by 0.041."""
DECAY_RATES = (0.01, 200.0)
"""dB/m: half a kilometre of rail moves as one, or less than one of a length shorter than its section."""
MOBILITIES = (1e-9, 0.1)
"""(m/s)/N: rails lie between 1e-7 and 1e-3."""

MOST_GAINS = 0.1
"""Share of the lines at which noise may turn the power round that a hammer gives to a rail."""

_FREQUENCY = Column("frequency", "Hz")
_VERTICAL, _LATERAL = Column("vertical decay rate", "dB/m"), Column("lateral decay rate", "dB/m")
MOBILITY = "m/s/N"
FORMS = {MOBILITY: 0, "m/s^2/N": -1, "m/N": 1}
"""Units of mobility, accelerance and receptance; the power of iω that makes a mobility of each."""


def band_numbers(table: TableSource, frequency: Array) -> Array:
    """Numbers n of one-third octaves 10^(n/10) Hz, by nominal or exact centres, Hz; rising, each once."""
    refuse_disorder(table, frequency)
    places = 10.0 * np.log10(frequency)
    numbers = np.rint(places)
    allowed = "centres of one-third octaves that rise, each once, as 100, 125, 160"
    if (off := np.abs(places - numbers) > BAND_SHIFT).any():
        received = f"a frequency of {frequency[off][0]:g} Hz"
        raise InputError(name_of(table), received, allowed, "Sum narrow bands to one-third octaves first.")
    if (again := np.diff(numbers) == 0).any():
        raise InputError(name_of(table), f"twice the band of {frequency[1:][again][0]:g} Hz", allowed)
    return numbers


def read_decay_rates(table: TableSource) -> tuple[Array, Array, Array | None]:
    """Read decay rates (n,), dB/m, vertical and, if the table has them, lateral, in one-third octaves.

    A table of two or three columns, as EN 15461 reports them, which may lack bands. First come the exact
    centres (n,), Hz.
    """
    rows = read_table(table, (_FREQUENCY, _VERTICAL), (_LATERAL,))
    _refuse_few(table, rows)
    numbers, (least, most) = band_numbers(table, rows[:, 0]), DECAY_RATES
    rates = rows[:, 1:]
    if (wrong := (rates < least) | (rates > most)).any():
        received = f"a decay rate of {rates[wrong][0]:g} dB/m"
        remedy = "Is the unit right, dB per metre?" if rates[wrong][0] > 0 else "A rail loses vibration."
        raise InputError(name_of(table), received, f"{least:g} to {most:g} dB/m", remedy)
    return 10.0 ** (0.1 * numbers), rates[:, 0], rates[:, 1] if rates.shape[1] > 1 else None


def read_mobility(table: TableSource) -> tuple[Array, NDArray[np.inexact]]:
    """Read a point mobility (n,), (m/s)/N, over rising frequencies (n,), Hz: complex, or its magnitude.

    A table of frequency and magnitude, or real and imaginary part, e^{+iωt}; the unit in a file says whether
    it holds mobility, accelerance or receptance.
    """
    rows, power = _of_some_form(table)
    _refuse_few(table, rows)
    frequency = rows[:, 0]
    refuse_disorder(table, frequency)
    found = rows[:, 1] if rows.shape[1] == 2 else rows[:, 1] + 1j * rows[:, 2]
    rate = 2.0 * np.pi * frequency if rows.shape[1] == 2 else 2j * np.pi * frequency
    mobility = found * rate**power
    least, most = MOBILITIES
    size = mobility if rows.shape[1] == 2 else np.abs(mobility)
    if (wrong := ~((size > least) & (size < most))).any():
        received = f"a mobility of {size[wrong][0]:.3g} (m/s)/N"
        raise InputError(name_of(table), received, f"{least:g} to {most:g} (m/s)/N", "Is the unit right?")
    gains = mobility.real < 0.0
    if np.mean(gains) > MOST_GAINS:
        received = f"a rail that gives power to the hammer at {frequency[gains][0]:g} Hz and elsewhere"
        allowed = "a point mobility, whose real part is positive"
        remedy = "Are unit (mobility, accelerance or receptance) and sign of the phase, e^{+iωt}, right?"
        raise InputError(name_of(table), received, allowed, remedy)
    return frequency, mobility


def _of_some_form(table: TableSource) -> tuple[Array, int]:
    """Rows of a table, and the power of iω by which its numbers become mobilities."""
    errors = []
    for unit, power in FORMS.items():
        columns = Column("magnitude or real part", unit), Column("imaginary part", unit)
        try:
            return read_table(table, (_FREQUENCY, columns[0]), columns[1:]), power
        except InputError as error:
            errors.append(error)
    told = errors[0]
    allowed = told.allowed.replace(MOBILITY, " or ".join(FORMS))
    raise InputError(told.what, told.received, allowed, told.remedy)


def _refuse_few(table: TableSource, rows: Array) -> None:
    if len(rows) < FEWEST:
        raise InputError(name_of(table), f"{len(rows)} frequencies", f"at least {FEWEST}")
