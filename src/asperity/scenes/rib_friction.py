"""How the ends of tapered rollers rub on the rib: heat under the static load, and torque in time."""

import math

from asperity.scenes.along_rollers import has_rollers
from asperity.scenes.computed_bearing import ComputedBearing
from asperity.scenes.observer import Observer
from asperity.schema import Values, bearing
from asperity.structures.roller_statics import LoadedRollers


def rib_group(computed: ComputedBearing) -> Values:
    """Lay out heat of all rollers under the static load, and what torque they ask of the rings in time."""
    case = computed.case
    found: LoadedRollers = case.static  # type: ignore[assignment]
    assert case.friction is not None
    pushed = computed.stacked("rib_force").sum(axis=1).mean(axis=-1)
    return {
        bearing.RIB_HEAT: 2.0 * math.pi * float(case.speed) * found.rib_torque(case.friction),
        bearing.RIB_TORQUE: case.friction * found.bearing.rib_lever * pushed,
    }


def _rubs(computed: ComputedBearing) -> bool:
    return computed.case.friction is not None and has_rollers(computed)


OBSERVER = Observer(
    "rib_friction", (bearing.RIB_HEAT, bearing.RIB_TORQUE), rib_group, needs=("bearing",), asked_of=_rubs
)
