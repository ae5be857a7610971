"""Quantities that are measured and that a case predicts: one file each, and its name here."""

from contextlib import suppress

from xarray import DataTree

from asperity.arguments import one_of
from asperity.observables import bearings, decay_rates, levels, mobilities, stiffness
from asperity.observables.observable import Collected, Observable

_MODULES = (decay_rates, mobilities, stiffness, bearings, levels)
BUILT_IN: dict[str, Observable] = {each.name: each for module in _MODULES for each in module.OBSERVABLES}
"""By name; the first whose words are in a heading is what the table holds."""


def quantities() -> tuple[str, ...]:
    """Names of all quantities that a case can be fitted to."""
    return tuple(BUILT_IN)


def observable(name: str) -> Observable:
    """The quantity of a name; an `InputError` lists those that there are."""
    return BUILT_IN[one_of("measured quantity", name, BUILT_IN)]


def collected_of(tree: DataTree) -> Collected:
    """What a result holds of all that is measured."""
    found = Collected()
    for each in BUILT_IN.values():
        with suppress(KeyError):  # of another kind of case
            found |= each.collect(tree) if each.collect is not None else {}
    return found
