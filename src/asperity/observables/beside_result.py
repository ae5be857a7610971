"""What a case names as measured, beside the result of its run: how far it is off, and how sure that is."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from operator import attrgetter
from typing import Any

import numpy as np
from xarray import DataTree

from asperity.arguments import Array
from asperity.case.any_case import AnyCase
from asperity.case.form import content
from asperity.observables import collected_of, observable, reading
from asperity.observables.observable import Collected, Measured
from asperity.schema import Values, group
from asperity.schema import measured as schema


@dataclass(frozen=True, eq=False)
class RunCase:
    """A case that was run, of which something is predicted.

    Parameters
    ----------
    case : AnyCase
        The case.
    tree : DataTree
        Its result.
    """

    case: AnyCase
    tree: DataTree
    fine: bool = True

    @property
    def whole(self) -> AnyCase:
        """The case as it was run."""
        return self.case

    @cached_property
    def collected(self) -> Collected:
        """What its result holds of all that is measured."""
        return collected_of(self.tree)


def with_tables_beside(case: AnyCase, tree: DataTree) -> DataTree:
    """The result of a case with a group that compares it with the tables that [measured] names, if it does.

    Measurements under other conditions than those of the case are left out: a fit takes them.
    """
    measured = [
        each for each in reading.combined(reading.tables_beside(case)) if _as_in(case, each.conditions)
    ]
    if measured:
        tree["measured"] = DataTree(dataset=group(laid_beside(RunCase(case, tree), measured)))
    return tree


def _as_in(case: AnyCase, conditions: Mapping[str, Any]) -> bool:
    """Whether a case has keys, by their dotted names, as they were in a measurement."""
    return all(content(attrgetter(dotted)(case)) == content(value) for dotted, value in conditions.items())


def laid_beside(run: RunCase, measured: Sequence[Measured]) -> Values:
    """Lay out all measured values beside those of a run, one list over all quantities."""
    found: dict[Any, list[Any]] = {each: [] for each in _LISTED}
    for each in measured:
        of = observable(each.what)
        predicted = of.predict(run, each)
        deviation = of.differs(each.values, predicted)[: len(each.at)]
        usual = of.uncertainty if each.uncertainty is None else each.uncertainty
        chance = np.zeros(len(each.at)) if of.chance is None else of.chance(run.collected, each)
        uncertainty = np.where(np.isfinite(deviation), np.hypot(usual, np.nan_to_num(chance)), np.nan)
        words = {
            schema.QUANTITY: of.name,
            schema.SOURCE: each.source,
            schema.AXIS: of.axis,
            schema.UNITS: of.units,
        }
        numbers: dict[Any, Array] = {
            schema.AT: each.at,
            schema.VALUE: magnitudes(each.values),
            schema.COMPUTED: magnitudes(predicted),
            schema.DEVIATION: deviation,
            schema.UNCERTAINTY: uncertainty,
        }
        for entry, word in words.items():
            found[entry] += [word] * len(each.at)
        for entry, values in numbers.items():
            found[entry] += values.tolist()
    count = len(found[schema.AT])
    return {
        schema.VALUE_NUMBER: 1 + np.arange(count),
        **{entry: np.array(each) for entry, each in found.items()},
    }


_LISTED = (
    *(schema.QUANTITY, schema.SOURCE, schema.AXIS, schema.AT, schema.UNITS),
    *(schema.VALUE, schema.COMPUTED, schema.DEVIATION, schema.UNCERTAINTY),
)


def magnitudes(values: Any) -> Array:
    """Values, of complex ones their magnitudes."""
    return np.asarray(np.abs(values) if np.iscomplexobj(values) else values, dtype=float)
