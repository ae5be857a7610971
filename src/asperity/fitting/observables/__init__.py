"""Quantities that cases are fitted to: one file each, and its name here."""

from asperity.arguments import one_of
from asperity.fitting.observable import Observable
from asperity.fitting.observables import bearings, decay_rates, levels, mobilities, stiffness

_MODULES = (decay_rates, mobilities, stiffness, bearings, levels)
BUILT_IN: dict[str, Observable] = {each.name: each for module in _MODULES for each in module.OBSERVABLES}
"""By name; the first whose words are in a heading is what the table holds."""


def quantities() -> tuple[str, ...]:
    """Names of all quantities that a case can be fitted to."""
    return tuple(BUILT_IN)


def observable(name: str) -> Observable:
    """The quantity of a name; an `InputError` lists those that there are."""
    return BUILT_IN[one_of("measured quantity", name, BUILT_IN)]
