"""Wear of raceways by place: closed forms of a contact, and volumes that are those of the work of sliding."""

import numpy as np
import pytest

from asperity import BallBearing, Friction
from asperity.contact.groove_creepage import conformal_creepage, sliding_across, sliding_speed
from asperity.errors import InputError
from asperity.structures.bearing_creepage import creepage_of
from asperity.structures.bearing_friction import friction_of_balls
from asperity.structures.raceway_wear import raceway_wear

B6205 = BallBearing.named("6205")
B7205 = BallBearing.named("6205", contact_angle=np.radians(25.0))
LOAD, AXES, CURVATURE, ALONG = 80.0, (0.1e-3, 0.7e-3), 250.0, 3e-3
"""N, half axes along and across, m, curvature across, 1/m, and relative radius along, m."""
SHARES = np.linspace(-1.0, 1.0, 2001)
COEFFICIENT = 1e-8
SPEED = 30.0
FOUR = 0.5 * np.pi / B6205.balls * np.arange(4)
"""Angles of the cage over the passing of a ball, where friction of each contact is solved."""


def test_a_groove_alone_wears_by_its_creepage_under_half_an_ellipse_of_force():
    """Closed form: the force per width of Hertz's contact is 3Q (1 − t²)/4a."""
    found = sliding_across(LOAD, AXES, 0.0, CURVATURE, ALONG, SHARES)
    creepage = conformal_creepage(AXES[1] * SHARES, AXES[1], CURVATURE, ALONG)
    expected = 0.75 * LOAD * (1.0 - SHARES**2) / AXES[1] * np.abs(creepage)
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12 * expected.max())


def test_spin_alone_wears_the_middle_line_by_the_first_moment_of_its_pressure():
    """Closed form: ∫ p φ |x| dx at y = 0 is Q φ b/πa."""
    spin = 20.0
    found = sliding_across(LOAD, AXES, spin, 0.0, ALONG, [0.0])
    assert found == pytest.approx(LOAD * spin * AXES[0] / (np.pi * AXES[1]), rel=1e-3)


@pytest.mark.parametrize(("spin", "curvature"), [(0.0, CURVATURE), (20.0, 0.0), (-20.0, CURVATURE)])
def test_what_wears_across_a_contact_is_in_all_what_slides_over_it(spin, curvature):
    """The same double integral by chords and by rings of the ellipse."""
    found = sliding_across(LOAD, AXES, spin, curvature, ALONG, SHARES)
    whole = AXES[1] * (SHARES[1] - SHARES[0]) * found.sum()
    assert whole == pytest.approx(sliding_speed(LOAD, AXES, spin, curvature, ALONG), rel=2e-3)


def test_spin_adds_to_what_a_groove_makes_slide_on_one_side():
    """Hertz's pressure times |(ξ − φ y, φ x)| along lines at both sides, summed in small steps."""
    spin = 20.0
    x = AXES[0] * (np.arange(20000) + 0.5 - 10000) / 10000
    for share in (-0.6, 0.6):
        y = AXES[1] * share
        left = np.maximum(1.0 - (x / AXES[0]) ** 2 - share**2, 0.0)
        pressure = 1.5 * LOAD / (np.pi * AXES[0] * AXES[1]) * np.sqrt(left)
        slip = np.hypot(conformal_creepage(y, AXES[1], CURVATURE, ALONG) - spin * y, spin * x)
        expected = (pressure * slip).sum() * (x[1] - x[0])
        found = sliding_across(LOAD, AXES, spin, CURVATURE, ALONG, [share])
        assert found == pytest.approx(expected, rel=1e-4)


def test_balls_wear_a_groove_where_they_touch_it():
    """Along its arc at the groove's radius times the contact angle, of a half axis to either side."""
    loaded = B7205.loaded(0.0, 300.0)
    found = raceway_wear(loaded, B7205.kinematics(SPEED), COEFFICIENT)
    angles = loaded.inner_angle[0, 0], loaded.outer_angle[0, 0]
    assert found.across.mean(axis=1) == pytest.approx(0.52 * B7205.ball_diameter * np.array(angles))
    half = [loaded.semi_axes(ring)[1][0, 0] for ring in ("inner", "outer")]
    assert np.ptp(found.across, axis=1) == pytest.approx(2.0 * np.array(half))


@pytest.mark.parametrize("turning", ["inner", "outer"])
@pytest.mark.parametrize(
    ("bearing", "load"), [(B6205, (300.0, 0.0)), (B7205, (0.0, 300.0)), (B7205, (200.0, 400.0))]
)
def test_the_volume_that_wears_is_that_of_the_work_of_all_contacts(bearing, load, turning):
    """Archard: V H/k is load times sliding, as the heat of all balls over friction is; depths sum to it."""
    bearing = bearing.with_(turning=turning)
    loaded = bearing.loaded(*load, speed=SPEED)
    kinematics = bearing.kinematics(SPEED, contact_angle=loaded.contact_angle)
    found = raceway_wear(loaded, kinematics, COEFFICIENT)
    rolling = np.pi * bearing.ball_diameter * kinematics.spin
    heat = rolling * np.nansum(creepage_of(loaded).sliding, axis=2).mean(axis=1)
    np.testing.assert_allclose(found.volume, COEFFICIENT / bearing.hardness * heat, rtol=1e-12)
    step = found.across[:, 1] - found.across[:, 0]
    np.testing.assert_allclose(
        found.depth.sum(axis=2) * step[:, None], found.area, rtol=0.02, atol=2e-3 * found.area.max()
    )
    turns = ["inner", "outer"].index(turning)
    assert np.ptp(found.area[turns]) == 0.0 == np.ptp(found.depth[turns], axis=0).max()  # it meets all loads


def test_a_ring_that_stands_still_wears_where_it_is_loaded():
    """Below a radial load most, alike on both sides, and nowhere behind; evenly under an axial load."""
    loaded = B6205.loaded(300.0, speed=SPEED)
    outer = raceway_wear(loaded, B6205.kinematics(SPEED), COEFFICIENT)
    assert (np.diff(outer.angle) > 0.0).all()
    assert outer.angle[0] >= 0.0
    assert outer.angle[-1] < 2.0 * np.pi
    deepest = outer.depth[1].max(axis=1)
    assert np.cos(outer.angle[deepest.argmax()]) > 0.999
    behind = np.cos(outer.angle) < 0.0
    assert deepest[behind].max() == 0.0 < deepest[~behind].max()
    mirrored = np.interp(-outer.angle, outer.angle, deepest, period=2.0 * np.pi)
    np.testing.assert_allclose(deepest, mirrored, atol=1e-6 * deepest.max())
    even = raceway_wear(B7205.loaded(0.0, 300.0), B7205.kinematics(SPEED), COEFFICIENT)
    assert np.ptp(even.area[1]) < 1e-6 * even.area[1].max()
    assert even.angle.size == outer.angle.size


def test_wear_grows_with_coefficient_and_speed_and_falls_with_hardness():
    """Archard's law: each to the first power."""
    loaded = B7205.loaded(0.0, 300.0)
    once = raceway_wear(loaded, B7205.kinematics(SPEED), COEFFICIENT).depth
    np.testing.assert_allclose(raceway_wear(loaded, B7205.kinematics(SPEED), 3e-8).depth, 3.0 * once)
    np.testing.assert_allclose(
        raceway_wear(loaded, B7205.kinematics(2.0 * SPEED), COEFFICIENT).depth, 2.0 * once
    )
    soft = B7205.with_(hardness=3.5e9)
    found = raceway_wear(soft.loaded(0.0, 300.0), soft.kinematics(SPEED), COEFFICIENT)
    np.testing.assert_allclose(found.depth, 2.0 * once, rtol=1e-6, atol=1e-9 * once.max())
    with pytest.raises(InputError, match="wear coefficient"):
        raceway_wear(loaded, B7205.kinematics(SPEED), 0.0)


@pytest.mark.parametrize(("bearing", "load"), [(B6205, (300.0, 0.0)), (B7205, (200.0, 400.0))])
def test_what_sticks_does_not_wear(bearing, load):
    """Volume over k/H is the heat over the coefficient of friction; the most there is where all slips."""
    loaded = bearing.loaded(*load, speed=SPEED, cage_angles=FOUR[:2])
    turning = bearing.kinematics(SPEED, contact_angle=loaded.contact_angle)
    most = raceway_wear(loaded, turning, COEFFICIENT)
    found = raceway_wear(loaded, turning, COEFFICIENT, Friction(0.1))
    heat = friction_of_balls(loaded, creepage_of(loaded), turning, Friction(0.1)).heat
    of_rings = np.nansum(heat, axis=2).mean(axis=1)
    np.testing.assert_allclose(found.volume, COEFFICIENT / bearing.hardness * of_rings / 0.1, rtol=1e-9)
    assert np.all(found.volume < 0.99 * most.volume)
    step = found.across[:, 1] - found.across[:, 0]
    sums = found.depth.sum(axis=2) * step[:, None]
    np.testing.assert_allclose(sums, found.area, rtol=0.02, atol=2e-3 * found.area.max())
    slippery = raceway_wear(loaded, turning, COEFFICIENT, Friction(5e-3))
    np.testing.assert_allclose(slippery.volume, most.volume, rtol=0.015)
    # but for a cell at the rim, and, with spin, for lines of pure rolling that no force drives
    np.testing.assert_allclose(slippery.depth, most.depth, atol=0.1 * most.depth.max())


def test_a_groove_wears_least_where_balls_roll_purely_and_stick():
    """The middle of a contact slips, both sides do, and two lines between them stick: without spin alike."""
    loaded = B6205.loaded(300.0, cage_angles=FOUR)
    found = raceway_wear(loaded, B6205.kinematics(SPEED), COEFFICIENT, Friction(0.1))
    deepest = found.depth[1, found.depth[1].max(axis=1).argmax()]
    np.testing.assert_allclose(deepest, deepest[::-1], atol=1e-3 * deepest.max())
    half = loaded.semi_axes("outer")[1].max()
    at = found.across[1] / half
    assert deepest[np.abs(np.abs(at) - 0.4) < 0.1].min() < 0.1 * deepest.max()
    assert deepest[np.abs(at) > 0.6].max() == deepest.max()


def test_what_sticks_all_over_wears_nothing():
    """Friction without end holds all of each contact, however its groove bends."""
    loaded = B6205.loaded(300.0, cage_angles=FOUR)
    found = raceway_wear(loaded, B6205.kinematics(SPEED), COEFFICIENT, Friction(1e6))
    assert not found.depth.any()
    assert not found.volume.any()
