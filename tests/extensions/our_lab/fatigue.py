"""The steady load that tires a contact as much as its force does (ISO 281: by its third power)."""

import numpy as np

from asperity.scenes.observer import Observer
from asperity.schema import Entry

GROUP = "fatigue"
LAW = Entry(GROUP, "law", "1", "contact law")
CONTACT = Entry(GROUP, "contact", "1", "number of the contact, from the foremost")
EQUIVALENT_LOAD = Entry(
    GROUP, "equivalent_load(law, contact)", "N", "steady load of the same fatigue: (mean of F^3)^(1/3)"
)


def observe(computed):
    """The equivalent load of each law and contact."""
    force = computed.stacked("contact_force")
    load = np.cbrt((force**3).mean(axis=-1))
    return {LAW: list(computed.runs), CONTACT: 1 + np.arange(force.shape[1]), EQUIVALENT_LOAD: load}


OBSERVER = Observer(
    GROUP,
    (LAW, CONTACT, EQUIVALENT_LOAD),
    observe,
    needs=["contact_force"],
    sources=["ISO 281:2007 (exponent of ball bearings)."],
)
