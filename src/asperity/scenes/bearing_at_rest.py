"""How a bearing carries its load at rest, and what turns how fast."""

import numpy as np

from asperity.arguments import Array
from asperity.scenarios.prepared_bearing import RINGS, omitted_from
from asperity.scenes.computed_bearing import ComputedBearing
from asperity.scenes.observer import DECLARED, Observer
from asperity.schema import Values, bearing
from asperity.structures.bearing_statics import LoadedBearing
from asperity.structures.rolling_bearing import PARTS, Kinematics

DIRECTIONS = ("along", "across", "axial")


def static_group(found: LoadedBearing, turning: Kinematics, omitted: str = "") -> Values:
    """Lay out how a bearing carries its load, and what turns how fast."""
    of = found.bearing
    along, across = np.transpose([found.semi_axes(ring) for ring in RINGS], (1, 0, 2, 3))

    def both(what: str) -> list[Array]:
        return [getattr(found, f"{ring}_{what}") for ring in RINGS]

    return {
        bearing.BALL: 1 + np.arange(of.balls),
        bearing.RING: list(RINGS),
        bearing.DIRECTION: list(DIRECTIONS),
        bearing.CAGE_ANGLE: found.azimuth[:, 0],
        bearing.AZIMUTH: found.azimuth,
        bearing.BALL_LOAD: both("load"),
        bearing.BALL_ANGLE: both("angle"),
        bearing.PEAK_PRESSURE: both("pressure"),
        bearing.SEMI_AXIS_ALONG: along,
        bearing.SEMI_AXIS_ACROSS: across,
        bearing.RING_DISPLACEMENT: found.displacement.T[: len(DIRECTIONS)],
        bearing.RING_STIFFNESS: np.diagonal(found.stiffness, axis1=1, axis2=2).T[: len(DIRECTIONS)],
        bearing.BALL_DIAMETER: of.ball_diameter,
        bearing.PITCH_DIAMETER: of.pitch_diameter,
        bearing.CONTACT_ANGLE: found.contact_angle,
        bearing.ELEMENT: of.ELEMENT,
        bearing.LEFT_OUT: omitted or of.LEFT_OUT,
        **tones_group(turning),
    }


def tones_group(turning: Kinematics) -> Values:
    """Lay out what turns how fast."""
    return {
        bearing.PART: list(PARTS),
        bearing.TONE: [turning.tone(part) for part in PARTS],
        bearing.MODULATION: [turning.modulation(part) for part in PARTS],
        bearing.TURNING: turning.turning,
        bearing.CAGE: turning.cage,
    }


def rest_group(computed: ComputedBearing) -> Values:
    """Lay out the same of a run."""
    case = computed.case
    return static_group(case.static, case.kinematics, omitted_from(case))


OBSERVER = Observer(
    "bearing_at_rest",
    DECLARED,
    rest_group,
    needs=("bearing",),
)
