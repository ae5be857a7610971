"""How the balls of a bearing slide on its raceways: spin, creepage by the grooves, and the heat at most."""

import numpy as np

from asperity.contact.hertz import Hertz
from asperity.scenes.computed_bearing import ComputedBearing
from asperity.scenes.observer import DECLARED, Observer
from asperity.schema import Values, bearing
from asperity.structures.bearing_creepage import creepage_of


def creepage_group(computed: ComputedBearing) -> Values:
    """Lay out creepages of all contacts under the static load, at each angle of the cage."""
    case = computed.case
    found = creepage_of(case.static)
    rolling = np.pi * computed.bearing.ball_diameter * case.kinematics.spin  # m/s, on both raceways
    return {
        bearing.SPIN_CREEPAGE: found.spin,
        bearing.RIM_CREEPAGE: found.rim,
        bearing.SLIDING_HEAT: rolling * found.sliding,
    }


def _has_grooves(computed: ComputedBearing) -> bool:
    """Whether its contacts are curved across the path, one with each ring: not of rollers, nor of arches."""
    return isinstance(computed.case.contacts[0][0], Hertz) and not computed.bearing.arches


OBSERVER = Observer(
    "bearing_creepage",
    DECLARED,
    creepage_group,
    needs=("bearing",),
    asked_of=_has_grooves,
    sources=(
        "H. L. Heathcote, Proc. Inst. Automobile Eng. 15 (1921) 569 (sliding of a ball in its groove).",
        "A. B. Jones, J. Basic Eng. 81 (1959) 1 (which raceway controls the spin of a ball).",
    ),
)
