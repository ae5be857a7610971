"""Friction of a bearing in time: under forces and speeds that are given, against that at rest."""

from types import SimpleNamespace

import numpy as np
import pytest

from asperity.case.cases import as_case
from asperity.scenes.bearing_friction import friction_group
from asperity.schema import bearing as schema
from asperity.speeds import SpeedCourse
from asperity.structures.bearing_creepage import creepage_of
from asperity.structures.bearing_friction import friction_of_balls
from small_cases import BEARING


def test_heat_follows_forces_and_speed_of_balls_that_both_rings_roll():
    """Evenly loaded balls that spin, at half of the speed and more, and where the inner ring lets go."""
    of = as_case(BEARING | {"radial": "0 N", "axial": "200 N", "friction": 0.1})
    speed = SpeedCourse([0.0, 2e-3], [0.5 * of.speed, of.speed])
    case = SimpleNamespace(static=of.static, kinematics=of.kinematics, friction=of.friction, speed=speed)
    inner, outer = (
        np.tile(each[0][:, None], (1, 3)) for each in (of.static.inner_load, of.static.outer_load)
    )
    inner[:, 2] = 0.0
    first = SimpleNamespace(time=1e-3 * np.arange(3))
    run = SimpleNamespace(
        case=case,
        bearing=of.bearing.bearing,
        runs={"hertz": first},
        first=first,
        stacked={"contact_force": np.concatenate([inner, outer])[None]}.get,
    )
    found = friction_group(run)
    creepage = creepage_of(of.static)
    assert creepage.spin[:, 0, 0].max() > 10.0
    whole = friction_of_balls(of.static, creepage, of.kinematics, 0.1).heat[:, 0].sum()
    np.testing.assert_allclose(found[schema.ROLLING_HEAT], [[0.5 * whole, 0.75 * whole, 0.0]], rtol=1e-3)
    torque = whole / (2.0 * np.pi * of.kinematics.inner)
    assert found[schema.FRICTION_TORQUE] == pytest.approx([2.0 / 3.0 * torque], rel=1e-3)
