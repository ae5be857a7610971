"""Friction of the balls of a bearing that runs: of each contact at rest, and of all in time."""

import numpy as np

from asperity.arguments import Array
from asperity.contact.hertz import Hertz
from asperity.scenes.computed_bearing import ComputedBearing
from asperity.scenes.observer import Observer
from asperity.schema import Values, bearing
from asperity.speeds import speed_at
from asperity.structures.bearing_creepage import RINGS, creepage_of
from asperity.structures.bearing_friction import (
    BallOnRaceway,
    friction_of_balls,
    rolling_speed,
    torque_of,
)


def friction_group(computed: ComputedBearing) -> Values:
    """Lay out friction of all contacts under the static load, and of the run what turns the rings."""
    case = computed.case
    assert case.friction is not None
    creepage = creepage_of(case.static)
    at_rest = friction_of_balls(case.static, creepage, case.kinematics, case.friction)
    force = computed.stacked("contact_force").reshape(
        len(computed.runs), len(RINGS), -1, len(computed.first.time)
    )
    work = np.zeros((force.shape[0], force.shape[-1]))
    for number, ring in enumerate(RINGS):
        loads = (case.static.inner_load, case.static.outer_load)[number]
        spin = _mean_spin(creepage.spin[number], loads)
        rolled = np.where(force[:, 0] > 0.0, force[:, number], 0.0)  # by the inner ring, too
        work += BallOnRaceway.of(computed.bearing, ring, case.friction).work(rolled, spin).sum(axis=1)
    fastest = rolling_speed(computed.bearing, case.kinematics) * work
    share = speed_at(case.speed, computed.first.time) / float(case.speed)
    return {
        bearing.FRICTION_HEAT: at_rest.heat,
        bearing.SLIPPING_SHARE: at_rest.slip_share,
        bearing.BALL_SPIN_MOMENT: at_rest.spin_moment,
        bearing.GYRATION: at_rest.gyration,
        bearing.FRICTION_TORQUE: torque_of(fastest.mean(axis=1), case.kinematics),
        bearing.ROLLING_HEAT: fastest * share,
    }


def _mean_spin(spin: Array, loads: Array) -> float:
    """Spin creepage of a ring's contacts, weighted with their loads, rad/m."""
    weights = np.where(np.isfinite(spin), loads, 0.0)
    return float((np.nan_to_num(spin) * weights).sum() / max(weights.sum(), 1e-300))


def _rubs(computed: ComputedBearing) -> bool:
    return computed.case.friction is not None and isinstance(computed.case.contacts[0][0], Hertz)


OBSERVER = Observer(
    "bearing_friction",
    (
        bearing.FRICTION_HEAT,
        bearing.SLIPPING_SHARE,
        bearing.BALL_SPIN_MOMENT,
        bearing.GYRATION,
        bearing.FRICTION_TORQUE,
        bearing.ROLLING_HEAT,
    ),
    friction_group,
    needs=("bearing",),
    asked_of=_rubs,
    sources=("J. J. Kalker, Three-Dimensional Elastic Bodies in Rolling Contact (1990) (friction).",),
)
