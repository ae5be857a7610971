"""Friction of balls in grooves: the linear theory, full slip, lines of pure rolling, what drives rings."""

import math

import numpy as np
import pytest

from asperity import BallBearing, Friction, material
from asperity.contact import creep
from asperity.contact.friction import cell_places
from asperity.contact.groove_creepage import (
    PURE_ROLLING,
    contact_curvature,
    sliding_speed,
    spin_moment,
)
from asperity.contact.hertz import Hertz
from asperity.errors import InputError
from asperity.reference.materials import Material
from asperity.structures import bearing_friction
from asperity.structures.bearing_creepage import creepage_of
from asperity.structures.bearing_friction import BallOnRaceway, friction_of_balls, rolling_speed, torque_of
from asperity.structures.rolling_bearing import Kinematics

STEEL = material("steel")
B6205 = BallBearing.named("6205")
D, PITCH = B6205.ball_diameter, B6205.pitch_diameter
CURVATURE = contact_curvature(0.5 * D, B6205.inner_conformity * D)
INNER, LOAD = B6205.inner_contact, 60.0
AXES = INNER.semi_axes(INNER.approach(LOAD))
FOUR = 0.5 * math.pi / B6205.balls * np.arange(4)
"""Angles of the cage over the passing of a ball."""


def rolled(contact, friction, spin=0.0, curvature=0.0, bodies=(STEEL, STEEL)):
    return BallOnRaceway(contact, curvature, bodies, Friction(friction), LOAD, spin).at(LOAD)


def in_groove(friction, spin=0.0, curvature=CURVATURE):
    return rolled(INNER, friction, spin, curvature)


def test_a_ball_that_hardly_spins_is_driven_sideways_by_the_linear_theory(monkeypatch):
    """F_y = −G (ab)^(3/2) c23 φ; J. J. Kalker prints c23 = 1.47 for a circle and ν = 1/4."""
    soft = Material("soft", 200e9, 0.25, 7800.0)
    circle = Hertz(0.5 * 200e9 / (1.0 - 0.25**2), 4e-3, 4e-3)
    radius, _ = circle.semi_axes(circle.approach(LOAD))
    spin = 1e-3
    forces = []
    for cells in ((40, 40), (80, 80)):
        monkeypatch.setattr(bearing_friction, "CELLS", cells)
        found = rolled(circle, 1.0, spin, bodies=(soft, soft))
        assert found.slip_area < 0.1 * found.normal.area
        forces.append(found.force[1])
    linear = -200e9 / 2.5 * radius**3 * 1.47 * spin
    assert forces[1] == pytest.approx(linear, rel=0.03)
    assert 2.0 * forces[1] - forces[0] == pytest.approx(linear, rel=0.02)  # of first order in the cells


@pytest.mark.parametrize("axes", ["circle", "ellipse"])
def test_a_ball_that_pivots_has_the_moment_of_full_slip(axes):
    """3π/16 µ Q a of a circle, (3/8) µ Q a E of an ellipse; heat is that moment times the spin."""
    contact = INNER if axes == "ellipse" else Hertz(INNER.modulus, 4e-3, 4e-3)
    of = contact.semi_axes(contact.approach(LOAD))
    expected = 0.05 * spin_moment(LOAD, of)
    if axes == "circle":
        assert expected == pytest.approx(3.0 * math.pi / 16.0 * 0.05 * LOAD * of[0])
    found = rolled(contact, 0.05, 2e3)
    assert -found.moment == pytest.approx(expected, rel=0.01)
    assert found.work == pytest.approx(2e3 * expected, rel=0.01)
    assert found.slip_area > 0.97 * found.normal.area


def test_where_all_slips_a_ball_in_its_groove_rolls_purely_on_the_lines_of_heathcote():
    found = in_groove(0.03)
    xi, eta, _ = found.creepage
    assert eta == 0.0
    lines = math.sqrt(xi / found.creepage_curvature) / AXES[1]
    assert lines == pytest.approx(PURE_ROLLING, rel=0.02)
    assert abs(found.force[0]) < 1e-5 * found.limit
    _, y = cell_places(found.normal.half_space)
    middle = (np.abs(y) < 0.2 * AXES[1]) & (found.normal.pressure > 0.0) & ~found.sticks
    assert np.all(found.traction[0][middle] > 0.0)  # the middle of the ball runs ahead, against the path
    most = 0.03 * sliding_speed(LOAD, AXES, 0.0, CURVATURE, INNER.radius_x)
    assert found.work == pytest.approx(most, rel=0.005)


def test_where_all_slips_heat_is_the_most_there_is_on_both_rings():
    """A search that hardly ends: with so little friction the force changes line by line of cells."""
    of = B6205.with_(inner_conformity=0.515, outer_conformity=0.54)
    loaded = of.loaded(radial=200.0, cage_angles=FOUR)
    found = creepage_of(loaded)
    turning = of.kinematics(25.0, contact_angle=0.0)
    heat = friction_of_balls(loaded, found, turning, Friction(0.001)).heat
    touching = np.isfinite(heat)
    most = 0.001 * rolling_speed(of, turning) * found.sliding
    np.testing.assert_allclose(heat[touching], most[touching], rtol=0.01)


def test_friction_that_falls_at_once_leaves_its_share_where_all_slips(monkeypatch):
    """Heat of full slip is µ ∫ p |s| dA, and at v over a velocity far below all slip that of the least µ."""
    monkeypatch.setattr(creep, "SIZES", np.array([0.8, 1.0]))  # under the largest load alone
    most = 0.5 * 0.006 * sliding_speed(LOAD, AXES, 0.0, CURVATURE, INNER.radius_x)
    for velocity in (None, 1e-5):
        falling = Friction(0.006, 0.5, velocity)
        ball = BallOnRaceway(INNER, CURVATURE, (STEEL, STEEL), falling, LOAD, speed=2.0)
        assert ball.at(LOAD).work == pytest.approx(most, rel=0.01)
        assert ball.power(np.array([LOAD])) == pytest.approx([2.0 * most], rel=0.01)


@pytest.mark.parametrize("spin", [0.0, 30.0])
def test_heat_is_traction_times_slip_and_less_than_if_all_slipped(spin):
    found = in_groove(0.3, spin)
    most = 0.3 * sliding_speed(LOAD, AXES, spin, CURVATURE, INNER.radius_x)
    assert found.work == pytest.approx(found.work_of_slip, rel=0.15)  # of first order in the cells
    assert 0.5 * most < found.work < 0.97 * most
    assert 0.1 < found.stick_area / found.normal.area < 0.9


def test_rings_are_turned_by_what_grooves_dissipate():
    """Moments about the axes of ball and ring, of tractions on the surface that both share; no contact angle.

    The ball turns evenly: F_i = −F_o, and R (F_o − F_i) balances κ (C_i + C_o)/2 with C = ∫ y² τ.
    """
    of = B6205.with_(contact_angle=None, clearance=0.0)
    turning = of.kinematics(25.0, contact_angle=0.0)
    loaded = of.loaded(radial=200.0, cage_angles=FOUR)
    friction = friction_of_balls(loaded, creepage_of(loaded), turning, Friction(0.1))
    ball = 0.5 * D
    driven = 0.0
    for angle in range(len(loaded.azimuth)):
        for k in np.flatnonzero(np.isfinite(friction.heat[0, angle])):
            curved = []
            for ring, load in (("inner", loaded.inner_load), ("outer", loaded.outer_load)):
                balls = BallOnRaceway.of(of, ring, Friction(0.1), load[angle, k])
                moment = balls.at(load[angle, k]).second_moment
                curved.append(0.5 * balls.curvature * moment)
            # along the path of each contact tractions on the ball brake its sides and drive its middle
            along = 0.5 * (curved[0] + curved[1]) / ball
            radii = 0.5 * PITCH - ball, 0.5 * PITCH + ball
            on_inner = radii[0] * along + curved[0]
            on_outer = radii[1] * along - curved[1]
            assert on_inner == pytest.approx(on_outer, rel=1e-6)  # nothing else takes up a torque
            driven += abs(on_inner)
    heat = np.nansum(friction.heat, axis=(0, 2)).mean()
    assert torque_of(heat, turning) == pytest.approx(driven / len(loaded.azimuth), rel=0.01)


def test_a_ring_is_turned_by_the_moments_of_balls_that_spin():
    """M sin α of each ball at any angle; open grooves leave little else."""
    of = B6205.with_(clearance=None, contact_angle=0.4, inner_conformity=0.6, outer_conformity=0.52)
    loaded = of.loaded(axial=300.0)
    found = creepage_of(loaded)
    turning = of.kinematics(25.0, contact_angle=loaded.contact_angle)
    friction = friction_of_balls(loaded, found, turning, Friction(0.05))
    on = int(np.argmax(found.spin[:, 0, 0]))
    moments = friction.spin_moment[on, 0] * np.sin((loaded.inner_angle, loaded.outer_angle)[on][0])
    spun = rolling_speed(of, turning) * friction.spin_moment[on, 0] * found.spin[on, 0]
    assert spun.sum() / (2.0 * math.pi * 25.0) == pytest.approx(moments.sum(), rel=1e-3)
    assert torque_of(friction.heat[:, 0].sum(), turning) > 0.5 * moments.sum()


def test_balls_that_do_not_touch_and_bearings_without_friction_give_no_heat():
    of = B6205.with_(contact_angle=None, clearance=20e-6)
    loaded = of.loaded(radial=100.0)
    found = creepage_of(loaded)
    turning = of.kinematics(25.0)
    none = friction_of_balls(loaded, found, turning, Friction(0.0))
    np.testing.assert_array_equal(np.isnan(none.heat), np.isnan(found.sliding))
    assert np.nanmax(none.heat) == 0.0
    with pytest.raises(InputError, match=r"friction: received -0\.1"):
        friction_of_balls(loaded, found, turning, Friction(-0.1))


def test_a_ball_gyrates_by_the_change_of_its_momentum_as_its_axis_goes_round():
    """dL/dt of a ball that spins about an inclined axis and goes round, over what friction holds at most."""
    of = B6205.with_(clearance=None, contact_angle=0.4)
    loaded = of.loaded(axial=300.0, speed=200.0)
    found = creepage_of(loaded)
    turning = of.kinematics(200.0, contact_angle=loaded.contact_angle)
    inertia = 0.4 * of.ball_mass * (0.5 * D) ** 2
    control = "outer" if found.spin[1, 0, 0] == 0.0 else "inner"
    angles = loaded.inner_angle[0, 0], loaded.outer_angle[0, 0]
    radial, axial = {"inner": (angles[0], -1.0), "outer": (angles[1], 1.0)}[control]
    tilt = np.arctan2(np.sin(radial), np.cos(radial) + axial * D / PITCH)
    spin = 2.0 * np.pi * turning.spin

    def momentum(time):
        at = 2.0 * np.pi * turning.cage * time
        out = np.array([np.cos(at), np.sin(at), 0.0])
        return inertia * spin * (np.sin(tilt) * out + np.cos(tilt) * np.array([0.0, 0.0, 1.0]))

    step = 1e-8
    moment = np.linalg.norm(momentum(step) - momentum(-step)) / (2.0 * step)
    held = 0.1 * (loaded.inner_load[0, 0] + loaded.outer_load[0, 0]) * 0.5 * D
    friction = friction_of_balls(loaded, found, turning, Friction(0.1))
    np.testing.assert_allclose(friction.gyration, moment / held, rtol=1e-5)
    assert np.all(
        friction_of_balls(loaded, found, turning, Friction(0.01)).gyration > 5.0 * friction.gyration
    )


def test_torque_turns_one_ring_against_the_other():
    """2 W between rings that turn 30 times a second against each other, whichever of them turns, and how."""
    for inner, outer in ((30.0, 0.0), (0.0, -30.0), (20.0, -10.0), (40.0, 10.0)):
        turning = Kinematics(9, inner, outer, 12.0, 70.0)
        assert torque_of(np.array(2.0), turning) == pytest.approx(2.0 / (2.0 * math.pi * 30.0))
