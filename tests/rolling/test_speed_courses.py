"""Speeds that change: where they bring what rolls, what it then feels, and constant speeds beside them."""

import copy
import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.signal import fftconvolve

from asperity import Beam, material
from asperity.errors import InputError
from asperity.laws import HertzLaw, Linear
from asperity.reduction.texture import StateTexture
from asperity.rolling.bearing import BearingRings, roll_bearing
from asperity.rolling.roll import roll_bodies
from asperity.speeds import SpeedCourse
from asperity.structures.ball_bearing import BallBearing
from asperity.structures.body import Body
from asperity.structures.rail_poles import rail_at
from asperity.structures.ring import Ring
from asperity.structures.track import Track
from one_contact import first_contact
from refusals import refusals

COURSE = SpeedCourse([0.5, 2.0, 3.0], [1.0, 4.0, 2.0])


def test_positions_are_the_integral_of_the_speed_and_times_their_inverse():
    t = np.linspace(-1.0, 5.0, 6001)
    speeds = np.interp(t, [0.5, 2.0, 3.0], [1.0, 4.0, 2.0])
    far = np.concatenate([[0.0], np.cumsum(0.5 * (speeds[1:] + speeds[:-1]) * np.diff(t))])
    far -= far[1000]
    assert_allclose(COURSE.covered(t), far, atol=1e-12)
    assert_allclose([COURSE.reached(float(each)) for each in far[::100]], t[::100], atol=1e-12)
    assert (float(COURSE), COURSE.slowest, COURSE.end) == (4.0, 1.0, 3.0)
    assert copy.deepcopy(COURSE) == COURSE != SpeedCourse([0.5, 2.0, 3.0], [1.0, 4.0, 1.0])


test_courses_that_stand_or_do_not_go_on_are_refused = refusals(
    ([0.0, 1.0, 1.0], [1.0, 2.0, 3.0], "numbers that do not rise; allowed: rising times, from zero on"),
    ([-1.0, 1.0], [1.0, 2.0], "received -1.0; allowed: rising times, from zero on"),
    ([0.0, 1.0], [1.0, 2.0, 3.0], "speeds of a course: received 3 numbers; allowed: 2"),
    ([0.0], [1.0], "course: received 1 point; allowed: 2 to 600"),
    ([0.0, 1.0], [0.0, 2.0], "0 at 0 s; allowed: speeds above zero all the time. Begin and end it slowly"),
    ([0.0, 1.0], [1.0, -2.0], "-2 at 1 s"),
    of=SpeedCourse,
)

MASS, STIFFNESS, RATIO, LOAD = 0.5, 2e4, 0.05, 5.0
OMEGA = math.sqrt(STIFFNESS / MASS)  # 31.8 Hz
DAMPING = 2.0 * RATIO * MASS * OMEGA


def sine(amplitude, length, end):
    """Waves along the path, downwards; the spline through 200 points a wave is exact to 1e-8."""
    spacing = length / 200
    x = -length + spacing * np.arange(round((end + 2.0 * length) / spacing))
    return StateTexture.unfiltered(amplitude * np.sin(2.0 * np.pi * x / length), spacing, -length)


def test_a_chirp_over_a_resonance_is_the_closed_form_of_one_degree_of_freedom():
    """z = ∫ k/(m ω_d) exp(−ζω τ) sin(ω_d τ) h(x(t−τ)) dτ, x = v t + a t²/2: 10 Hz to 60 Hz in a second."""
    a, wave, first, last = 1e-6, 0.1, 1.0, 6.0
    law = Linear(LOAD, STIFFNESS, texture=sine(a, wave, 3.6), damping=DAMPING)
    path = {"positions": [0.0], "start": 0.0, "duration": 1.0, "time_step": 5e-5}
    course = SpeedCourse([0.0, 1.0], [first, last])
    run = first_contact(roll_bodies(None, [Body.rigid(MASS, LOAD)], [law], speed=course, **path))
    t = run.time
    heights = a * np.sin(2.0 * np.pi * (first * t + 0.5 * (last - first) * t**2) / wave)
    damped = OMEGA * math.sqrt(1.0 - RATIO**2)
    answer = STIFFNESS / MASS / damped * np.exp(-RATIO * OMEGA * t) * np.sin(damped * t)
    closed = 5e-5 * fftconvolve(heights, answer)[: t.size]
    moved = run.rolling_displacement - run.rolling_displacement[0]
    assert np.abs(closed).max() > 3.0 * a  # it rings
    assert_allclose(moved, closed, atol=2e-3 * np.abs(closed).max())


BEAM = Beam.rectangular(1.0, 0.02, 0.01, material("steel"), highest_frequency=1e3)
ACROSS = {"positions": [0.0], "start": 0.1, "time_step": 2e-5, "settling": 0.005, "duration": 0.04}


def across(speed):
    """A body crosses a beam that bends under it."""
    texture = sine(2e-6, 0.05, 1.0)
    law = HertzLaw(5e9, texture, 20.0)
    return first_contact(roll_bodies(BEAM, [Body.rigid(MASS, 50.0)], [law], speed=speed, **ACROSS))


def test_energy_closes_over_a_beam_while_it_is_crossed_ever_faster():
    """The climb on the slope of the beam is at the speed of the moment."""
    run = across(SpeedCourse([0.0, 0.04], [2.0, 30.0]))
    assert run.energy.residual < 1e-5
    assert_allclose(run.position[-1] - run.position[0], 0.04 * 16.0)


def test_a_course_that_hardly_changes_is_the_constant_speed():
    steady = across(4.0)
    hardly = across(SpeedCourse([0.0, 0.04], [4.0, 4.0 * (1.0 + 1e-9)]))
    assert_allclose(hardly.contact_force, steady.contact_force, rtol=1e-6)
    assert hardly.energy.residual == pytest.approx(steady.energy.residual, rel=1e-3, abs=1e-9)


def test_a_rail_of_other_speeds_is_refused():
    track = Track.named("nordborg", rail_loss_factor=0.03)
    rail = rail_at(track, SpeedCourse([0.0, 1.0], [20.0, 21.0]), 1e-4, [0.0], scattered=True)
    told = "received 22 m/s in steps of 0.0001 s; allowed: 20 to 21 m/s and 0.0001 s, for which the rail's"
    body = [Body.rigid(600.0, 6e4)], [Linear(6e4, 1e9)]
    path = {"positions": [0.0], "start": 0.0, "duration": 0.02, "time_step": 1e-4}
    with pytest.raises(InputError, match=told):
        roll_bodies(rail, *body, speed=SpeedCourse([0.0, 0.02], [20.0, 22.0]), **path)


COSINE = 5.0 / 6.0
WAVY = BallBearing(5, 8e-3, 8e-3 * COSINE / 0.2, contact_angle=math.acos(COSINE))
"""f_c = 0.4 f_r."""


def turned(speed, duration, *, order=6, part=1, **keys):
    """Five balls on linear contacts, over so many waves of 0.1 um of the inner (0) or outer (1) raceway."""
    angle = math.acos(COSINE)
    radius = WAVY.raceway_radii[part]
    spacing = 2.0 * np.pi * radius / (200 * order)
    along = np.arange(-20, 200 * order + 21)
    wavy = StateTexture.unfiltered(-1e-7 * np.cos(2.0 * np.pi * along / 200), spacing, -20 * spacing)
    laws = [Linear(10.0, 1e5, texture=each, damping=2.0) for each in (wavy, None)[:: 1 - 2 * part]]
    rings = BearingRings(
        Ring.rigid(0.01, angle),
        Ring.rigid(1.0, angle, radial_stiffness=9e8, axial_stiffness=9e8, damping_ratio=0.3),
    )
    given = {"axial": 50.0 * math.sin(angle), "settling": 0.1, "time_step": 5e-5, "centrifugal": False}
    return roll_bearing(WAVY, rings, *laws, speed=speed, duration=duration, **given | keys)


@pytest.fixture(scope="module")
def run_up():
    return turned(SpeedCourse([0.0, 1.0], [4.0, 6.0]), 1.0)


def test_lines_of_a_run_up_are_those_of_constant_speeds_over_orders(run_up):
    """Six waves move the inner ring as balls pass, 5 f_c, twice a turn; lines of five turns are as narrow."""
    steady = turned(5.0, 1.0)
    turns = 4.0 * run_up.time + run_up.time**2
    lines = []
    for run, turned_by in ((run_up, turns), (steady, 5.0 * steady.time)):
        angle = np.arange(0.0, 5.0, 1.0 / 128.0)
        held = np.interp(angle, turned_by, run.inner_motion[0])
        lines.append(2.0 * np.abs(np.fft.rfft(held)) / held.size / 1e-7)
    orders = np.arange(lines[0].size) / 5.0
    assert orders[lines[0][1:].argmax() + 1] == pytest.approx(2.0)
    assert_allclose(lines[0][8:13], lines[1][8:13], atol=0.02 * lines[1].max())
    assert_allclose(run_up.cage[-1] - run_up.cage[0], 2.0 * np.pi * 0.4 * 5.0, rtol=1e-9)


def test_waves_of_the_ring_that_turns_are_met_at_their_order():
    """Five waves of the inner raceway move it along the axis as they pass the balls, 5 (1 − 0.4) a turn."""
    run = turned(SpeedCourse([0.0, 0.8], [4.0, 6.0]), 0.8, order=5, part=0)
    angle = np.arange(0.0, 4.0, 1.0 / 128.0)
    held = np.interp(angle, 4.0 * run.time + 1.25 * run.time**2, run.inner_motion[2])
    lines = np.abs(np.fft.rfft(held - held.mean()))
    assert lines.argmax() == 12
    assert lines[12] > 10.0 * np.delete(lines, [11, 12, 13]).max()


def test_a_slow_run_up_passes_through_constant_speeds_band_by_band(run_up):
    """Motion across the load while ten balls pass: its mean square."""
    steady = turned(4.5, 0.5).inner_motion
    near = np.abs(4.0 + 2.0 * run_up.time - 4.5) <= 0.5
    assert_allclose(np.std(run_up.inner_motion[:2, near]), np.std(steady[:2]), rtol=0.02)


def test_the_centrifugal_force_of_balls_goes_with_the_square_of_the_speed():
    """Of balls that no load reaches, F = m (d_m/2)(2π f_c)²."""
    of = BallBearing.named("6205")
    laws = [HertzLaw(each.stiffness_constant, None, 20.0) for each in (of.inner_contact, of.outer_contact)]
    rings = BearingRings(Ring.rigid(0.5), Ring.rigid(0.3, radial_stiffness=1e8, damping_ratio=0.02))
    course = SpeedCourse([0.0, 0.006], [75.0, 150.0])
    keys = {"radial": 100.0, "duration": 0.006, "time_step": 3.2e-6, "settling": 0.001}
    run = roll_bearing(of, rings, *laws, speed=course, **keys)
    loose = run.inner_force == 0.0
    speeds = np.broadcast_to(75.0 + 75.0 * run.time / 0.006, loose.shape)
    force = run.outer_force[loose] / [of.centrifugal_force(each) for each in speeds[loose]]
    for slow in (speeds[loose] < 90.0, speeds[loose] > 130.0):
        assert np.mean(force[slow]) == pytest.approx(1.0, rel=0.03)


def test_an_unbalance_goes_with_the_square_of_the_speed():
    """A rotating force moves rings on soft contacts, quasi-statically, as far as it is large."""
    run = turned(SpeedCourse([0.0, 0.5], [2.0, 4.0]), 0.5, order=5, rotating=2.0, settling=0.05)
    radius = np.hypot(*run.inner_motion[:2])
    shares = [radius[abs(2.0 + 4.0 * run.time - speed) < 0.2].mean() for speed in (2.2, 3.8)]
    assert shares[1] / shares[0] == pytest.approx((3.8 / 2.2) ** 2, rel=0.03)
    angle = np.unwrap(np.arctan2(run.inner_motion[1], run.inner_motion[0]))
    assert_allclose(angle - angle[0], 2.0 * np.pi * (2.0 * run.time + 2.0 * run.time**2), atol=0.1)
