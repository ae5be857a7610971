"""The stiffness of a rough contact over its load."""

import numpy as np
from xarray import DataTree

from asperity.case.any_case import AnyCase
from asperity.case.scene import Case
from asperity.case.table_headings import Column
from asperity.observables.observable import Collected, Measured, Observable, Predictable, Values, reader
from asperity.schema import contact

STIFFNESS = "contact stiffness"


def _no_contact(case: AnyCase) -> str:
    return "" if isinstance(case, Case) else f"no single contact: it is of kind {case.kind}"


def _collect(tree: DataTree) -> Collected:
    """Force and tangent stiffness over the approach, mean of the samples."""
    return {
        "contact_load": np.asarray(tree[contact.FORCE.path].values),
        "contact_stiffness": np.asarray(tree[contact.TANGENT_STIFFNESS.path].values),
    }


def _predict(trial: Predictable, measured: Measured) -> Values:
    """Tangent stiffness dF/dr at each load; NaN beyond the loads that were computed."""
    load = trial.collected["contact_load"]
    stiffness = trial.collected["contact_stiffness"]
    known = (load > 0.0) & (stiffness > 0.0)
    place = np.log(load[known])
    over = np.log(stiffness[known])
    return np.exp(np.interp(np.log(measured.at), place, over, left=np.nan, right=np.nan))


def _free(case: Case) -> tuple[str, ...]:
    return ("surface.rms",) if case.surface.rms is not None else ("surface.level",)


OBSERVABLES = (
    Observable(STIFFNESS, "N/m", "load (N)", 20.0, 0.5, _no_contact, _predict, _free,
               r"load.*stiffness|stiffness.*load",
               reader(STIFFNESS, Column("load", "N"), Column("stiffness", "N/m")), _collect,
               ("measured.contact_stiffness",)),
)  # fmt: skip
