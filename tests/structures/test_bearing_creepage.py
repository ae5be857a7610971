"""How balls slide in their grooves: against rigid kinematics, integrals over a contact, and print."""

import numpy as np
import pytest

from asperity import BallBearing
from asperity.contact.groove_creepage import (
    PURE_ROLLING,
    conformal_creepage,
    contact_curvature,
    sliding_speed,
    spin_moment,
)
from asperity.errors import InputError
from asperity.structures.bearing_creepage import creepage_of, spin_creepage

B6205 = BallBearing.named("6205", contact_angle=np.radians(25.0))
D, PITCH = B6205.ball_diameter, B6205.pitch_diameter
LOAD, AXES = 80.0, (0.1e-3, 0.7e-3)
"""N, and half axes along and across, m."""


def over_contact():
    """Places in a contact (n, n), m, Hertz's pressure there, Pa, and the area of a cell, m²."""
    steps = (np.arange(1001) + 0.5) / 500.5 - 1.0
    x, y = np.meshgrid(AXES[0] * steps, AXES[1] * steps, indexing="ij")
    left = np.maximum(1.0 - (x / AXES[0]) ** 2 - (y / AXES[1]) ** 2, 0.0)
    pressure = 1.5 * LOAD / (np.pi * AXES[0] * AXES[1]) * np.sqrt(left)
    return x, y, pressure, AXES[0] * AXES[1] / 500.5**2


def test_lines_of_pure_rolling_are_where_friction_leaves_no_force():
    """Printed: 0.347 of the half axis (Johnson: 0.35)."""
    _, y, pressure, _ = over_contact()
    assert abs(PURE_ROLLING - 0.3473) < 5e-5
    drive = pressure * np.sign(conformal_creepage(y, AXES[1], 250.0, 3e-3))
    assert abs(drive.sum()) < 2e-3 * pressure.sum()


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_creepage_in_a_groove_is_that_of_rigid_bodies_on_one_surface(sign):
    """Circles of ball and raceway at each place across, of which the ones on the lines of rolling roll."""
    ball, groove, raceway = 0.5 * D, 0.52 * D, 15.5e-3
    curvature = contact_curvature(ball, groove)
    assert curvature == pytest.approx((2.0 * groove + D) / (2.0 * groove * D))  # as Harris prints it
    y = np.linspace(-AXES[1], AXES[1], 9)

    def circles(place):
        rise = 0.5 * curvature * place**2  # towards the middle of the ball
        return ball - rise, raceway + sign * rise

    rolling = PURE_ROLLING * AXES[1]
    of_ball, of_raceway = circles(rolling)
    on_ball, on_raceway = circles(y)
    sliding = on_ball - of_ball / of_raceway * on_raceway  # of a ball that turns by 1 rad/s
    along = 1.0 / (1.0 / ball + sign / raceway)
    found = conformal_creepage(y, AXES[1], curvature, along)
    np.testing.assert_allclose(found, sliding / ball, atol=1e-2 * np.abs(found).max())
    assert found[4] > 0.0 > found[0]  # the middle of the ball runs ahead


@pytest.mark.parametrize("control", ["inner", "outer"])
def test_spin_is_that_of_a_ball_that_rolls_on_both_rings_and_spins_on_one(control):
    """The ball's axis by no slip in both contacts and no spin in one, in vectors; and Harris's ratios."""
    angles = np.radians([27.0, 22.0])
    radius = 0.5 * D
    normals = np.array([[-np.cos(angles[0]), -np.sin(angles[0])], [np.cos(angles[1]), np.sin(angles[1])]])
    of = ["inner", "outer"].index(control)
    rows, right = [], []
    for ring, (n_r, n_z) in enumerate(normals):  # radially, axially; unknown: axis of the ball, both rings
        at = 0.5 * PITCH + radius * n_r
        rings = np.eye(2)[ring]
        rows.append([-radius * n_z, radius * n_r, *(-at * rings)])  # velocity around, ball less ring
        right.append(0.0)
        if ring == of:
            rows.append([n_r, n_z, *(-n_z * rings)])
            right.append(0.0)
    rows.append([0.0, 1.0, 0.0, 0.0])
    right.append(1.0)
    ball_r, ball_z, *rings = np.linalg.solve(rows, right)
    found = spin_creepage(B6205, tuple(angles), control)
    beta = np.arctan2(-ball_r, ball_z)
    share = D / PITCH
    for ring, (n_r, n_z) in enumerate(normals):
        speed = radius * (ball_z * n_r - ball_r * n_z)
        assert abs(found[ring]) == pytest.approx(
            abs((ball_r * n_r + (ball_z - rings[ring]) * n_z) / speed), abs=1e-9 / D
        )
    free = 1 - of
    sign = -1.0 if free else 1.0
    alpha = angles[free]
    ratio = (1.0 - sign * share * np.cos(alpha)) * np.tan(alpha - beta) + sign * share * np.sin(alpha)
    assert found[free] == pytest.approx(
        abs(ratio) * PITCH / D / (0.5 * PITCH - sign * radius * np.cos(alpha))
    )
    assert found[of] == 0.0


def test_moment_and_heat_of_a_contact_are_integrals_over_its_pressure():
    """Of a circle 3π/16 Q a; by the groove alone 0.161 Q a² κ/R_x."""
    x, y, pressure, cell = over_contact()
    assert spin_moment(LOAD, AXES) == pytest.approx(np.sum(pressure * np.hypot(x, y)) * cell, rel=1e-3)
    assert spin_moment(LOAD, (1e-3, 1e-3)) == pytest.approx(3.0 * np.pi / 16.0 * LOAD * 1e-3)
    curvature, along, spin = 250.0, 3e-3, 30.0
    t = PURE_ROLLING
    alone = 1.5 * (2.0 / 15.0 - 2.0 / 3.0 * t**2 + 4.0 / 3.0 * t**3 - 4.0 / 15.0 * t**5)
    of_groove = alone * LOAD * AXES[1] ** 2 * curvature / (2.0 * along)
    assert sliding_speed(LOAD, AXES, 0.0, curvature, along) == pytest.approx(of_groove, rel=2e-3)
    of_spin = spin * spin_moment(LOAD, AXES)
    assert sliding_speed(LOAD, AXES, spin, 0.0, along) == pytest.approx(of_spin, rel=2e-3)
    lengthwise = conformal_creepage(y, AXES[1], curvature, along) - spin * y
    both = np.sum(pressure * np.hypot(lengthwise, spin * x)) * cell
    assert sliding_speed(LOAD, AXES, spin, curvature, along) == pytest.approx(both, rel=2e-3)


def test_a_ball_does_not_spin_where_that_would_take_most_and_slides_in_both_grooves():
    """At rest the inner contact is the more slender; centrifugal force presses the outer one."""
    slow, fast = (creepage_of(B6205.loaded(axial=200.0, speed=speed)) for speed in (0.0, 400.0))
    tight = creepage_of(B6205.with_(inner_conformity=0.54).loaded(axial=200.0))
    angles = [B6205.loaded(axial=200.0).inner_angle[0, 0]] * 2
    alone = np.sin(angles[0]) * sum(
        1.0 / (0.5 * PITCH + sign * 0.5 * D * np.cos(angles[0])) for sign in (1.0, -1.0)
    )
    assert slow.spin[:, 0, 0] == pytest.approx([0.0, alone], rel=1e-3)
    assert fast.spin[1, 0, 0] == 0.0 < fast.spin[0, 0, 0]
    assert tight.spin[1, 0, 0] == 0.0 < tight.spin[0, 0, 0]  # an open groove has the shorter contact
    assert (slow.rim > 0.0).all()
    loose = creepage_of(B6205.with_(contact_angle=None, clearance=20e-6).loaded(radial=100.0))
    assert np.isnan(loose.spin).any()
    assert np.isfinite(loose.spin[:, 0, 0]).all()
    with pytest.raises(InputError, match="control: received 'middle'; allowed: one of inner, outer"):
        spin_creepage(B6205, tuple(angles), "middle")
