"""Creep of balls in a run: in time and at rest, the most loaded contacts, friction that falls, refusals."""

from types import SimpleNamespace

import numpy as np
import pytest

from asperity.case.cases import as_case
from asperity.errors import CaseError, Grade, percent
from asperity.scenes import schema
from asperity.scenes.creep import OF_BALLS, ball_group
from asperity.schema import bearing
from asperity.speeds import SpeedCourse
from asperity.structures.bearing_creepage import creepage_of
from asperity.structures.bearing_friction import friction_of_balls, rolling_speed
from small_cases import BEARING

EVEN = {"radial": "0 N", "axial": "200 N", "friction": 0.1}
"""Evenly loaded balls, which spin."""


def run_of(of, force, speed=None):
    """A run of a case under forces (contacts, steps), N."""
    case = SimpleNamespace(
        static=of.static, kinematics=of.kinematics, friction_law=of.friction_law, speed=speed or of.speed
    )
    first = SimpleNamespace(time=1e-3 * np.arange(force.shape[-1]))
    return SimpleNamespace(
        case=case,
        bearing=of.bearing.bearing,
        runs={"hertz": first},
        first=first,
        stacked={"contact_force": force[None]}.get,
    )


def at_rest(of, steps=3):
    """Static forces of all contacts in time."""
    loads = np.concatenate([of.static.inner_load[0], of.static.outer_load[0]])
    return np.tile(loads[:, None], (1, steps))


def test_heat_follows_forces_and_speed_of_balls_that_both_rings_roll():
    """Evenly loaded balls that spin, at half of the speed and more, and where the inner ring lets go."""
    of = as_case(BEARING | EVEN)
    force = at_rest(of)
    force[: len(force) // 2, 2] = 0.0
    run = run_of(of, force, SpeedCourse([0.0, 2e-3], [0.5 * of.speed, of.speed]))
    found = ball_group(run)
    creepage = creepage_of(of.static)
    assert creepage.spin[:, 0, 0].max() > 10.0
    heat = friction_of_balls(of.static, creepage, of.kinematics, of.friction_law).heat[:, 0].ravel()
    expected = np.stack([0.5 * heat, 0.75 * heat, 0.0 * heat], axis=-1)
    np.testing.assert_allclose(found[schema.FRICTION_POWER], expected[None], rtol=1e-3)
    np.testing.assert_allclose(found[schema.MEAN_FRICTION_POWER], [expected.mean()], rtol=1e-3)
    torque = heat.sum() / (2.0 * np.pi * of.kinematics.inner)
    assert found[bearing.FRICTION_TORQUE] == pytest.approx([2.0 / 3.0 * torque], rel=1e-3)


def test_the_most_loaded_contacts_are_laid_out_as_those_of_other_scenes_are(monkeypatch):
    """Heat, slip and moment as of all balls at rest; the map is of the contact that makes most heat."""
    monkeypatch.setattr("asperity.structures.bearing_statics.STEPS", 4)  # angles of the cage
    of = as_case(BEARING | {"radial": "200 N", "axial": "200 N", "friction": 0.1})
    found = ball_group(run_of(of, at_rest(of)))
    loads = np.stack([of.static.inner_load, of.static.outer_load]).reshape(2, -1)
    places = [0, 1], loads.argmax(axis=1)
    heat, slips, moment = (
        found[each].reshape(2, -1)[places]
        for each in (bearing.FRICTION_HEAT, bearing.SLIPPING_SHARE, bearing.BALL_SPIN_MOMENT)
    )
    np.testing.assert_allclose(found[schema.SAMPLE_HEAT], heat, rtol=1e-4)
    np.testing.assert_allclose(np.abs(found[schema.SPIN_MOMENT]), moment, rtol=1e-4, atol=1e-12)
    area = found[schema.STICK_AREA] + found[schema.SLIP_AREA]
    np.testing.assert_allclose(found[schema.SLIP_AREA] / area, slips, rtol=1e-4)
    for ring, at, seen in zip(("inner", "outer"), places[1], area, strict=True):
        along, across = (each.flat[at] for each in of.static.semi_axes(ring))
        assert seen == pytest.approx(np.pi * along * across, rel=1.0 / 24.0)  # by half a cell around it
    along, across = found[schema.SAMPLE_FRICTION].T
    assert not along.any()  # nothing drives a ball along its path
    assert np.abs(across).max() < 0.1 * loads.max()
    # heat is traction times slip velocity, of first order in the cells
    cell = np.diff(found[schema.CREEP_X])[0] * np.diff(found[schema.CREEP_Y])[0]
    seen = (found[schema.TRACTION] * found[schema.SLIP_VELOCITY]).sum() * cell
    assert seen == pytest.approx(heat.max(), rel=0.15)
    speed = rolling_speed(of.bearing.bearing, of.kinematics)
    assert 0.0 < found[schema.SLIP_VELOCITY].max() < 0.05 * speed


def test_friction_of_the_case_falls_in_time_and_at_rest(monkeypatch):
    """By hardly anything over 100 m/s; and at once to what half of the coefficient gives where most slips."""
    monkeypatch.setattr("asperity.structures.bearing_friction.CELLS", (12, 24))
    of = as_case(BEARING | EVEN | {"friction": 0.01})
    cases = {
        "stays": of,
        "slowly": of.with_(creep={"kinetic": 0.5, "falling_velocity": "100 m/s"}),
        "at once": of.with_(creep={"kinetic": 0.5}),
    }
    heat = {
        name: [found[bearing.FRICTION_HEAT][:, 0].sum(), found[schema.FRICTION_POWER][0, :, 0].sum()]
        for name, each in cases.items()
        for found in [ball_group(run_of(each, at_rest(each)))]
    }
    assert heat["slowly"] == pytest.approx(heat["stays"], rel=1e-3)
    assert heat["at once"] == pytest.approx(0.5 * np.array(heat["stays"]), rel=0.02)


@pytest.mark.parametrize(
    ("speed", "friction", "grade"),
    [("1800 1/min", 0.05, None), ("30000 1/min", 0.05, Grade.WARNING), ("40000 1/min", 0.02, Grade.OUT)],
)
def test_balls_that_gyrate_beyond_what_is_computed_are_told(speed, friction, grade):
    """The moment goes with the square of the speed; friction holds what it does."""
    of = as_case(BEARING | EVEN | {"speed": speed, "axial": "400 N", "friction": friction})
    found = list(OF_BALLS.findings(run_of(of, at_rest(of))))
    assert [each.grade for each in found] == [grade] * (grade is not None)
    gyration = ball_group(run_of(of, at_rest(of)))[bearing.GYRATION]
    for each in found:
        assert each.value == percent(float(gyration.max()))
        assert "from 100 % on balls pivot sideways" in each.message


RUN_UP = [["0 s", "900 1/min"], ["60 ms", "1800 1/min"]]
REFUSED = (
    ({"creep": {"kinetic": 0.5}}, r"creep\.kinetic: received 0\.5; allowed: only together with friction"),
    (
        {"friction": 0.1, "creep": {"falling_velocity": "0.1 m/s"}},
        r"creep\.falling_velocity: received friction that stays; allowed: kinetic below 1",
    ),
    (
        {
            "friction": 0.1,
            "creep": {"kinetic": 0.5},
            "speed": [["0 s", "900 1/min"], ["60 ms", "1800 1/min"]],
        },
        r"creep\.kinetic: received 0\.5; allowed: friction that stays where the speed changes",
    ),
)


@pytest.mark.parametrize(("keys", "message"), REFUSED)
def test_friction_that_falls_is_there_and_falls_at_one_speed(keys, message):
    with pytest.raises(CaseError, match=message):
        as_case(BEARING | keys)
