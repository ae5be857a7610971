"""What lies along the roller of a bearing that carries most: load and pressure of its slices at rest."""

import numpy as np

from asperity.arguments import Array
from asperity.scenes.computed_bearing import ComputedBearing
from asperity.scenes.observer import DECLARED, Observer
from asperity.schema import Values, bearing
from asperity.structures.roller_statics import LoadedRollers


def along_group(computed: ComputedBearing) -> Values:
    """Lay out what the slices of that roller do, on both rings."""
    found: LoadedRollers = computed.case.static  # type: ignore[assignment]
    of = found.bearing
    loads = list[Array]()
    pressures = list[Array]()
    for contact, slices in ((of.inner_contact, found.inner_slices), (of.outer_contact, found.outer_slices)):
        heaviest = slices[np.unravel_index(int(slices.sum(axis=-1).argmax()), slices.shape[:2])]
        loads.append(heaviest * of.slices / of.roller_length)
        pressures.append(contact.pressures(heaviest))
    return {
        bearing.ALONG_ROLLER: of.inner_contact.places,
        bearing.LINE_LOAD: loads,
        bearing.LINE_PRESSURE: pressures,
        bearing.RING_TILT: found.tilt,
        bearing.TILT_MOMENT: float(found.moment[:, 0].mean()),
    }


def has_rollers(computed: ComputedBearing) -> bool:
    """Whether rollers roll in it, not balls."""
    return isinstance(computed.case.static, LoadedRollers)


OBSERVER = Observer(
    "along_rollers",
    DECLARED,
    along_group,
    needs=("bearing",),
    asked_of=has_rollers,
    sources=("G. Lundberg, Forsch. Ing.-Wes. 10 (1939) 201 (profiles of rollers).",),
)
