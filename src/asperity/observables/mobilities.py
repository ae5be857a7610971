"""Mobility, accelerance and receptance of a rail or of a structure, at one place or from one to another."""

from typing import Any

import numpy as np

from asperity.case.any_case import AnyCase
from asperity.case.in_memory import name_of
from asperity.case.measured import FORMS, in_some_unit, read_mobility
from asperity.case.table_headings import Column
from asperity.case.tables import TableSource, refuse_disorder
from asperity.errors import InputError
from asperity.observables.decay_rates import keys_of_track, supports
from asperity.observables.observable import Measured, Observable, Predictable, Values
from asperity.structures.modal import modal_receptance

MOBILITY = "mobility"
UNITS = "(m/s)/N"
OF_ANYTHING = (1e-15, 1e6)
"""(m/s)/N: of more than rails."""
_FREQUENCY = Column("frequency", "Hz")
_PLACES = (Column("position of the response", "m"), Column("position of the force", "m"))


def no_structure(case: AnyCase) -> str:
    """What a case lacks that has nothing to be struck."""
    if keys_of_track(case) is not None:
        return ""
    over = getattr(case, "rolled_over", None)
    if over is None:
        return f"nothing that is rolled over: it is of kind {case.kind}"
    return "" if over.extent is not None else "a plane that is rigid"


def _predict(trial: Predictable, measured: Measured) -> Values:
    """Mobility between the places, of a rail by default at mid-span, of a structure in its middle."""
    case = trial.case
    frequency = measured.at
    track = keys_of_track(case)
    if track is not None:
        rail = track.model()
        middle = float(rail.mid_spans[0])
        at, driven = measured.places or (middle, middle)
        receptance = rail.receptance(frequency, at, driven)
    else:
        over = case.rolled_over
        first, last = over.extent
        middle = 0.5 * (first + last)
        at, driven = measured.places or (middle, middle)
        highest = max(float(frequency[-1]), case.numerics.highest_frequency)
        receptance = modal_receptance(over.model(highest), frequency, at, driven)
    found = 2j * np.pi * frequency * receptance
    return found if np.iscomplexobj(measured.values) else np.abs(found)


def _free(case: Any) -> tuple[str, ...]:
    if keys_of_track(case) is not None:
        return supports(case)
    over = case.OVER
    names = ("height", "loss_factor", "support_stiffness", "damping_ratio")
    section = getattr(case, over)
    return tuple(f"{over}.{name}" for name in names if name in section.keys and section.is_active(name))


def read_mobilities(table: TableSource) -> list[Measured]:
    """Mobilities in a table: at one place, or with the places of response and force in each line."""
    try:
        frequency, mobility = read_mobility(table, OF_ANYTHING)
    except InputError as error:
        try:
            return _transfer(table)
        except InputError:
            raise error from None
    return [Measured(MOBILITY, frequency, mobility, source=name_of(table))]


def _transfer(table: TableSource) -> list[Measured]:
    """Mobilities between places, one for each pair of them."""
    rows, unit = in_some_unit(table, FORMS, (_FREQUENCY, *_PLACES), ("real part", "imaginary part"))
    found = []
    pairs = np.unique(rows[:, 1:3], axis=0)
    for at, driven in pairs:
        own = rows[(rows[:, 1] == at) & (rows[:, 2] == driven)]
        frequency = own[:, 0]
        values = own[:, 3] + 1j * own[:, 4]
        refuse_disorder(table, frequency)
        mobility = values * (2j * np.pi * frequency) ** FORMS[unit]
        places = (float(at), float(driven))
        found.append(Measured(MOBILITY, frequency, mobility, places=places, source=name_of(table)))
    return found


OBSERVABLES = (
    Observable(MOBILITY, UNITS, "frequency (Hz)", 20.0, 1.0, no_structure, _predict, _free,
               r"mobility|accelerance|inertance|receptance|m/s/N|\(m/s\)/N|m/s\^?2/N|m/s²/N|\bm/N\b",
               read_mobilities, keys=("track.mobility", "measured.mobility")),
)  # fmt: skip
