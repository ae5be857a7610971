"""Where runs begin: what is smooth and even stays as it is set down, all else goes on as its rest does."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from asperity.laws import Areal, HertzLaw, Linear
from asperity.reduction.stiffness import ForceCurve
from asperity.rolling.bearing import BearingRings, roll_bearing
from asperity.rolling.roll import roll_bodies
from asperity.structures.ball_bearing import BallBearing
from asperity.structures.beam import Beam
from asperity.structures.body import Body, carriage, chain
from asperity.structures.ring import Ring
from asperity.structures.roller_bearing import RollerBearing

ANGLE = 0.4
OBLIQUE = BallBearing(3, 8e-3, 40e-3, contact_angle=ANGLE)
HELD = {"radial_stiffness": 1e8, "axial_stiffness": 1e8, "damping_ratio": 0.02}
RIGID = Ring.rigid(0.5, ANGLE), Ring.rigid(0.3, ANGLE, **HELD)
LOBES = Ring.bending(0.06, 26e-3, 150.0, ANGLE, most_lobes=4, damping_ratio=0.02)
PATH = {"duration": 4e-3, "settling": 0.0}
ON_PLANE = {"speed": 1.0, "start": 0.0, "time_step": 1e-6, **PATH}


def hertz(bearing, damping):
    return [
        HertzLaw(each.stiffness_constant, None, damping)
        for each in (bearing.inner_contact, bearing.outer_contact)
    ]


def on_plane(body):
    laws = [HertzLaw(1e10, damping=10.0)] * len(body.places)
    return roll_bodies(None, [body], laws, positions=[0.0], **ON_PLANE)


def pressed_axially(speed=30.0, **bending):
    rings = BearingRings(*RIGID, **bending)
    return roll_bearing(
        OBLIQUE, rings, *hertz(OBLIQUE, 20.0), axial=200.0, speed=speed, time_step=1e-6, **PATH
    )


def rollers_between_tight_rings():
    bearing = RollerBearing.named("NU205", rollers=7, clearance=-5e-6)
    laws = []
    for contact in (bearing.inner_contact, bearing.outer_contact):
        at = contact.approach(500.0) * np.geomspace(1e-2, 1.0, 20)
        found = contact.pressed(at)
        laws.append(
            Areal(ForceCurve.from_samples(at, found.force, 10 / 9, found.stiffness[:, 0, 0]), None, 20.0)
        )
    rings = BearingRings(Ring.rigid(0.5), Ring.rigid(0.3, radial_stiffness=1e8, damping_ratio=0.02))
    return roll_bearing(bearing, rings, *laws, speed=30.0, time_step=2e-6, **PATH)


EVEN = {
    "a ball": lambda: on_plane(Body.rigid(0.5, 30.0)),
    "a carriage on three balls": lambda: on_plane(
        carriage(3.0, 0.1, [0.0, 0.1, 0.2], 0.02, 1e7, 10.0, load=50.0)
    ),
    "balls": pressed_axially,
    "balls in a ring that bends": lambda: pressed_axially(outer_bending=LOBES),
    "balls on a ring that turns and bends": lambda: pressed_axially(inner_bending=LOBES),
    "rollers": rollers_between_tight_rings,
}


@pytest.mark.parametrize("scene", EVEN)
def test_what_is_smooth_and_even_stays_as_it_was_set_down(scene):
    force = EVEN[scene]().contact_force
    assert force.min() > 1.0
    assert np.ptp(force, axis=1).max() < 1e-6 * force.mean()


def missed_orbit(speed):
    """How far a load that rotates moves the inner ring from one circle, relative to it."""
    laws = [Linear(500.0, 1e7, damping=20.0)] * 2
    run = roll_bearing(
        OBLIQUE, BearingRings(*RIGID), *laws, axial=300.0, rotating=20.0, speed=speed, time_step=1e-6,
        centrifugal=False, **PATH
    )  # fmt: skip
    orbit = (run.inner_motion[0] + 1j * run.inner_motion[1]) * np.exp(-2j * np.pi * speed * run.time)
    return np.abs(orbit - orbit[0]).max() / abs(orbit[0])


def test_what_is_left_to_swing_goes_with_the_square_of_the_speed():
    """The static answer and its rate: without the rate it would go with the speed, and be 0.05."""
    slow = missed_orbit(30.0)
    assert slow < 0.01
    assert missed_orbit(60.0) / slow == pytest.approx(4.0, rel=0.05)


def test_a_varying_compliance_is_periodic_from_the_first_passing_of_a_ball_on():
    """To what the entry of one ball leaves of ringing at the next; from rest it takes ten times as much."""
    bearing = BallBearing.named("6205")
    rings = BearingRings(Ring.rigid(0.5), Ring.rigid(0.3, radial_stiffness=1e8, damping_ratio=0.3))
    count = 16000
    passing = 1.0 / (9.0 * bearing.kinematics(10.0, contact_angle=0.0).cage)
    path = {"duration": 4.0 * passing, "time_step": passing / count}
    run = roll_bearing(bearing, rings, *hertz(bearing, 100.0), radial=100.0, speed=10.0, **path)
    first, last = run.inner_motion[:2, :count], run.inner_motion[:2, 3 * count : 4 * count]
    assert_allclose(first, last, rtol=0.0, atol=1e-4 * np.ptp(last))


def test_dampers_press_from_the_start_as_balls_go_into_and_out_of_the_load():
    """They carry 1 % of the load here: the force goes on evenly from the first step."""
    bearing = BallBearing.named("6205")
    rings = BearingRings(Ring.rigid(0.5), Ring.rigid(0.3, radial_stiffness=1e8, damping_ratio=0.3))
    path = {"duration": 2e-5, "time_step": 1e-6}
    force = roll_bearing(
        bearing, rings, *hertz(bearing, 2000.0), radial=100.0, speed=30.0, **path
    ).contact_force
    on_the_way = np.abs(np.diff(force[:, 10:])).max()
    assert on_the_way > 1e-3
    assert_allclose(np.diff(force[:, :3]), np.diff(force[:, 10:13]), rtol=0.0, atol=0.2 * on_the_way)


def test_all_of_a_body_moves_on_with_its_contact():
    """A sprung mass above a wheel, which goes down the static bow of a beam."""
    beam = Beam(
        length=1.0, bending_stiffness=100.0, mass_per_length=1.0, loss_factor=0.01, highest_frequency=500.0
    )
    body = chain([0.2, 1.0], [1e5], [5.0])
    path = {"start": 0.2, "duration": 1e-3, "time_step": 1e-6, "positions": [0.0], "speed": 0.1}
    run = roll_bodies(beam, [body], [HertzLaw(1e10)], **path)
    rates = np.diff(run.degrees_of_freedom[0][:, :2]) / 1e-6
    assert abs(rates[0, 0]) > 1e-5
    assert_allclose(rates[1], rates[0], rtol=1e-3)
