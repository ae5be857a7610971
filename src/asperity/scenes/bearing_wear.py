"""Wear of the raceways of a ball bearing over the angle around them, by Archard's law."""

from asperity.scenes.computed_bearing import ComputedBearing
from asperity.scenes.observer import DECLARED, Observer
from asperity.schema import Values, bearing
from asperity.structures.raceway_wear import raceway_wear


def wear_group(computed: ComputedBearing) -> Values:
    """Lay out how fast both raceways wear under the static load, at places around them."""
    case = computed.case
    assert case.wear_coefficient is not None
    found = raceway_wear(case.static, case.kinematics, case.wear_coefficient, case.friction_law)
    return {
        bearing.RACEWAY_ANGLE: found.angle,
        bearing.WEAR_RATE: found.depth.max(axis=2),
        bearing.WORN_AREA_RATE: found.area,
        bearing.WORN_VOLUME_RATE: found.volume,
    }


def _wears(computed: ComputedBearing) -> bool:
    return computed.case.wear_coefficient is not None


OBSERVER = Observer(
    "bearing_wear",
    DECLARED,
    wear_group,
    needs=("bearing",),
    asked_of=_wears,
    sources=("J. F. Archard, J. Appl. Phys. 24 (1953) 981 (wear by sliding under a load).",),
)
