"""A bearing that turns: its static solution, tones by the table of waviness, energy, interruption."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from asperity.kernels.pointforce import evaluate_all
from asperity.laws import HertzLaw, Linear
from asperity.reduction.texture import StateTexture
from asperity.rolling import rest
from asperity.rolling.bearing import INSTANTS, BearingRings, roll_bearing
from asperity.speeds import SpeedCourse
from asperity.structures.ball_bearing import BallBearing
from asperity.structures.modal import Modal
from asperity.structures.ring import Ring
from one_contact import Shelf
from refusals import refusals

RUN = {"radial": 100.0, "speed": 30.0, "duration": 0.01, "time_step": 3.2e-6, "settling": 0.01}
B6205 = BallBearing.named("6205")
HOUSING = Ring.rigid(0.3, radial_stiffness=1e8, damping_ratio=0.02)
RINGS = BearingRings(Ring.rigid(0.5), HOUSING)


def hertz(bearing, damping=20.0, textures=(None, None)):
    """Laws of both contacts."""
    both = bearing.inner_contact, bearing.outer_contact
    return [HertzLaw(each.stiffness_constant, h, damping) for each, h in zip(both, textures, strict=True)]


def turned_by(rings=RINGS, laws=None, **keys):
    return roll_bearing(B6205, rings, *(laws or hertz(B6205)), **RUN | keys)


def waves(radius, order, amplitude):
    """Heights of a raceway with so many waves per turn, positive away from contact, beyond both its ends."""
    count = 200 * max(order, 1)
    spacing = 2 * np.pi * radius / count
    along = np.arange(-20, count + 21)
    return StateTexture.unfiltered(
        -amplitude * np.cos(2 * np.pi * order * along / count), spacing, -20 * spacing
    )


def test_it_starts_as_the_static_solution_and_carries_the_load():
    """Independent of it: Newton's method on centres of grooves (`BallBearing.loaded`)."""
    start = {"speed": 0.1, "duration": 2e-5, "time_step": 1e-6, "settling": 0.0, "centrifugal": False}
    begun = turned_by(**start)
    still = B6205.loaded(100.0, cage_angles=begun.cage[:1])
    assert_allclose(begun.inner_force[:, 0], still.inner_load[0], rtol=1e-6, atol=1e-6)
    apart = begun.inner_motion[:, 0] - begun.outer_motion[:, 0]
    assert_allclose(apart, still.displacement[0], rtol=1e-6, atol=1e-12)
    run = turned_by(centrifugal=False)
    still = B6205.loaded(100.0)
    around = run.cage + 2 * np.pi * np.arange(9)[:, None] / 9
    assert (run.inner_force * np.cos(around)).sum(axis=0).mean() == pytest.approx(100.0, rel=1e-3)
    assert abs((run.inner_force * np.sin(around)).sum(axis=0).mean()) < 0.1
    assert run.inner_motion[0].mean() == pytest.approx(still.displacement[:, 0].mean(), rel=0.01)
    assert run.energy.residual < 1e-7
    assert run.unconverged_steps == 0


def test_balls_come_to_rest_in_few_steps(monkeypatch):
    """A step that had to be halved is not tried again at its whole length: laws are asked some 30 times.

    Those of all balls on a ring are asked together.
    """
    asked = []
    monkeypatch.setattr(rest, "evaluate_all", lambda *of: asked.append(of) or evaluate_all(*of))
    turned_by(duration=1e-4, settling=0.0)
    assert 10 < len(asked) / 2 / (INSTANTS + 1) < 40


def test_shapes_that_follow_one_another_are_those_at_every_angle(monkeypatch):
    """Where the cage never slips and the speed is one; else every shape is computed for itself."""
    asked = []
    one_by_one = Modal.shapes_along

    def counted(ring, start, spacing, count):
        asked.append(spacing)
        return one_by_one(ring, start, spacing, count)

    keys = {"rotating": 20.0, "duration": 2e-3, "settling": 1e-3}
    even = turned_by(**keys)
    monkeypatch.setattr(Ring, "shapes_along", counted)
    assert_allclose(even.inner_force, turned_by(**keys).inner_force, rtol=1e-9)
    assert asked
    asked.clear()
    slipping = turned_by(**keys | {"rotating": 0.0}, slip=lambda time: 0.01 * np.cos(1e3 * time))
    assert not asked
    assert np.abs(slipping.inner_force - even.inner_force).max() > 1e-3
    turned_by(**keys | {"speed": SpeedCourse([0.0, 1e-3], [25.0, 30.0])})
    assert not asked


def test_centrifugal_force_presses_the_outer_raceway_alone():
    run = turned_by(speed=150.0)
    loose = run.inner_force.max(axis=1) == 0.0
    assert loose.any()
    mean = run.outer_force[loose].mean()
    assert mean == pytest.approx(B6205.centrifugal_force(150.0), rel=0.02)


COSINE = 5.0 / 6.0
WAVY = BallBearing(5, 8e-3, 8e-3 * COSINE / 0.2, contact_angle=math.acos(COSINE))
"""f_c = 0.4 f_r and f_b = 2 f_r: all tones are multiples of f_r/5."""


def test_at_a_contact_angle_a_part_of_the_centrifugal_force_presses():
    """m (d_m/2) (2π 0.4 f_r)² cos α, along the normal, in which a ball moves; on average over a turn."""
    a, speed = math.acos(COSINE), 100.0
    held = Ring.rigid(0.3, a, radial_stiffness=1e8, axial_stiffness=1e8, damping_ratio=0.05)
    rings = BearingRings(Ring.rigid(0.5, a), held)
    keys = {"axial": 500.0, "speed": speed, "duration": 0.01, "time_step": 2e-6, "settling": 0.01}
    run = roll_bearing(WAVY, rings, *hertz(WAVY), **keys)
    outwards = 0.5 * WAVY.ball_mass * WAVY.pitch_diameter * (2.0 * math.pi * 0.4 * speed) ** 2
    assert (run.outer_force - run.inner_force).mean() == pytest.approx(outwards * COSINE, rel=0.01)
    assert run.inner_force.min() > 0.0
    np.testing.assert_array_equal(run.contact_force, np.vstack([run.inner_force, run.outer_force]))


def test_rings_that_turn_and_bend_have_the_shapes_of_where_balls_are():
    """At one speed shapes follow one another, over a course they are those of each place."""
    lobes = Ring.bending(0.06, 20e-3, 200.0, RINGS.inner.contact_angle, most_lobes=3, damping_ratio=0.05)
    rings = replace(RINGS, inner_bending=lobes, outer_bending=lobes)
    even, course = (
        turned_by(rings, speed=speed, time_step=2e-6)
        for speed in (30.0, SpeedCourse([0.0, 1.0], [30.0, 30.0]))
    )
    largest = np.abs(course.contact_force).max()
    assert np.ptp(course.inner_force, axis=1).max() > 0.01 * largest
    assert_allclose(even.contact_force, course.contact_force, rtol=0.0, atol=1e-8 * largest)


LINES = range(1, 200)


def turned(part, order, outer_bending=None):
    """Amplitudes at multiples of f_r/5 per height: motion of the inner ring (3, f), lobes of the outer."""
    a, height, stiffness = math.acos(COSINE), 1e-7, 1e5
    textures = [
        waves(radius, order, height) if name == part else None
        for name, radius in zip(("inner", "outer"), WAVY.raceway_radii, strict=True)
    ]
    laws = [Linear(10.0, stiffness, texture=each, damping=2.0) for each in textures]
    outer = Ring.rigid(1.0, a, radial_stiffness=9e8, axial_stiffness=9e8, damping_ratio=0.3)
    ball = height * np.cos(order * 2 * np.pi * np.arange(240) / 240)
    run = roll_bearing(
        WAVY, BearingRings(Ring.rigid(0.01, a), outer, outer_bending=outer_bending), *laws,
        axial=5 * 10.0 * math.sin(a), speed=5.0, duration=1.0, settling=0.1, time_step=5e-5,
        ball_heights=[ball, *[0 * ball] * 4] if part == "ball" else (), centrifugal=False,
        sensors=[("outer", 0.0, "radial"), ("outer", math.pi, "radial")],
    )  # fmt: skip
    seen = np.vstack([run.inner_motion, run.acceleration.sum(axis=0)])[:, :-1]
    tones = np.abs(np.fft.rfft(seen)) * 2 / seen.shape[1] / height
    return tones[:3, :200], tones[3, :200]


def tones_of(part, order, lobes):
    """Those of the table, in multiples of f_r/5."""
    return {round(each) for each in WAVY.kinematics(5.0).waviness(part, order, lobes)}


WAVES = [("outer", 5), ("outer", 6), ("outer", 8), ("inner", 10), ("inner", 4), ("inner", 7), ("ball", 2),
         ("ball", 3)]  # fmt: skip


@pytest.mark.parametrize(("part", "order"), WAVES)
def test_waviness_makes_the_tones_of_the_table_alone(part, order):
    """Linear contacts: nothing where the table says so, a/sin α axially where all balls meet one phase."""
    tones, _ = turned(part, order)
    least = 1e-3 if part == "ball" else 1e-5  # inertia of a ball that is pushed by one side and the other
    x, y, z = ({m for m in LINES if row[m] > least} for row in tones)
    assert z == tones_of(part, order, 0)
    assert x == y == tones_of(part, order, 1)
    assert bool(z | x) == ((part, order) not in {("outer", 8), ("inner", 7), ("ball", 3)})
    if (part, order) in {("outer", 5), ("inner", 10)}:
        assert tones[2, z.pop()] == pytest.approx(1 / math.sin(math.acos(COSINE)), rel=0.01)


@pytest.mark.parametrize("order", [7, 6])
def test_a_ring_that_bends_in_two_lobes_answers_to_two_waves_beside_the_balls(order):
    lobes = Ring.bending(0.02, 12e-3, 0.5, math.acos(COSINE), most_lobes=2, damping_ratio=0.3)
    _, bent = turned("outer", order, lobes)
    assert {m for m in LINES if bent[m] > 1e-4 * 10.0} == tones_of("outer", order, 2)
    assert bool(tones_of("outer", order, 2)) == (order == 7)


def test_perfect_surfaces_sound_at_the_passing_of_balls_alone():
    """Varying compliance: multiples of Z f_c, of a bearing whose cage turns 0.4 times as fast."""
    radial = BallBearing(5, 8e-3, 40e-3, clearance=0.0)
    path = {"speed": 50.0, "duration": 0.05, "settling": 0.15, "time_step": 4e-6}
    run = roll_bearing(radial, RINGS, *hertz(radial, 100.0), radial=20.0, **path)
    motion = run.inner_motion[0, : round(0.05 / 4e-6)]
    tones = np.abs(np.fft.rfft(motion - motion.mean()))[:200]  # multiples of f_c
    assert tones[5] > 0.3 * tones.max()
    assert np.delete(tones, np.arange(0, 200, 5)).max() < 1e-3 * tones.max()


def test_springs_of_the_shaft_are_free_of_force_on_average_over_the_places_of_the_cage():
    """At one place alone three balls on three waves would carry 2 % and more beside the load."""
    few = BallBearing(3, 8e-3, 40e-3, clearance=0.0)
    laws = hertz(few, 100.0, (None, waves(few.raceway_radii[1], 3, 5e-7)))
    rings = BearingRings(Ring.rigid(0.5, radial_stiffness=1e6, damping_ratio=0.3), HOUSING)
    passing = 1.0 / (3.0 * few.kinematics(10.0).cage)
    path = {"speed": 10.0, "duration": 2.0 * passing, "settling": 2.0 * passing, "time_step": 3.2e-6}
    run = roll_bearing(few, rings, *laws, radial=20.0, centrifugal=False, **path)
    around = run.cage + 2 * np.pi * np.arange(3)[:, None] / 3
    assert (run.inner_force * np.cos(around)).sum(axis=0).mean() == pytest.approx(20.0, rel=0.01)


def test_a_run_that_is_stopped_goes_on_to_the_same_bits():
    textures = [waves(radius, 31, 1e-7) for radius in B6205.raceway_radii]
    ball = [1e-8 * np.cos(2 * np.pi * (3 + j) * np.arange(60) / 60) for j in range(9)]
    keys = {"ball_heights": ball, "slip": lambda t: 0.01 + 0.01 * np.sin(300 * t), "settling": 0.0}
    keys["laws"] = hertz(B6205, 20.0, textures)
    whole, shelf = turned_by(**keys), Shelf()

    def stop(done, total, message):
        if done:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        turned_by(**keys, progress=stop, checkpoint=shelf)
    assert 0 < shelf.arrays["motion.counts"][0] < len(whole.time)
    again = turned_by(**keys, checkpoint=shelf)
    for name in ("inner_force", "outer_force", "inner_motion", "ball_motion"):
        assert_array_equal(getattr(again, name), getattr(whole, name))
    assert whole.energy.residual < 1e-5


def test_a_sensor_on_a_ring_feels_what_moves_it():
    sensors = [("outer", 0.5, "radial"), ("inner", 0.0, "radial")]
    run = turned_by(sensors=sensors)
    outer = np.array([math.cos(0.5), math.sin(0.5), 0.0]) @ run.outer_motion
    for felt, moved in zip(run.acceleration, (outer, run.inner_motion[0]), strict=True):
        expected = np.gradient(np.gradient(moved, run.time), run.time)[20:-20]
        assert_allclose(felt[20:-20], expected, atol=0.05 * np.abs(expected).max())


test_what_cannot_turn_is_refused = refusals(
    (
        {"rings": BearingRings(Ring.rigid(0.5), Ring.rigid(0.3))},
        "rings.*both free.*Give the shaft or the housing a stiffness",
    ),
    ({"axial": 50.0}, "axial load.*0 on a ring whose contacts carry none"),
    ({"radial": 0.0, "centrifugal": False}, "load"),
    ({"ball_heights": [np.zeros(8)]}, "heights of the balls.*1.*9, one line for each ball"),
    ({"ball_heights": [np.zeros(3)] * 9}, "heights of a ball.*3 numbers.*four or more"),
    ({"slip": lambda t: np.full(t.size, 1.0)}, "slip of the cage.*below 1"),
    ({"sensors": [("cage", 0.0, "radial")]}, 'ring of a sensor.*"inner" or "outer"'),
    ({"sensors": [("outer", 0.0, "sideways")]}, "direction.*radial"),
    ({"duration": 1e-9}, "duration"),
    ({"speed": 0.0}, "speed"),
    of=lambda keys: turned_by(**keys),
)


@pytest.mark.parametrize(("turning", "angle"), [("outer", 0.0), ("inner", 0.3)])
def test_a_load_that_rotates_moves_the_rings_in_circles(turning, angle):
    """Closed form: both rings and, in their own frame, the balls, on linear contacts, at the speed of the
    shaft; it pushes nothing along the axis."""
    of = B6205.with_(balls=4, turning=turning, clearance=None, contact_angle=angle)
    speed, stiffness, damping, force, turn = 500.0, 1e7, 200.0, 20.0, 2e-3
    held = {"radial_stiffness": 5e7, "axial_stiffness": 5e7, "damping_ratio": 0.2}
    rings = BearingRings(*(Ring.rigid(mass, angle, **held) for mass in (0.5, 0.3)))
    preloaded = [Linear(500.0, stiffness, 0.0, damping=damping)] * 2
    found = roll_bearing(
        of, rings, *preloaded, radial=10.0, axial=100.0 * (angle > 0.0), rotating=force, speed=speed,
        duration=turn, time_step=turn / 800, settling=4 * turn, centrifugal=False,
    )  # fmt: skip
    omega = 2 * np.pi * speed
    seen = omega - 2 * np.pi * of.kinematics(speed, contact_angle=angle).cage  # by a ball that goes round
    spring = stiffness + 1j * seen * damping
    between = spring**2 / (2 * spring - of.ball_mass * seen**2)
    pairs = 0.5 * of.balls * np.cos(angle) ** 2 * np.array(
        [[spring - between, -between], [-between, spring - between]]
    )  # fmt: skip
    own = [5e7 - m * omega**2 + 0.4j * omega * np.sqrt(5e7 * m) for m in (0.5, 0.3)]
    orbit = np.linalg.solve(pairs + np.diag(own), force * np.eye(2)[("inner", "outer").index(turning)])
    for ring, expected in zip(("inner_motion", "outer_motion"), orbit, strict=True):
        moved = getattr(found, ring) - getattr(found, ring).mean(axis=1, keepdims=True)
        turned = (moved[0] + 1j * moved[1]) * np.exp(-1j * omega * found.time)
        assert_allclose(turned, expected, atol=2e-3 * abs(expected))
        assert np.abs(moved[2:]).max(initial=0.0) < 1e-6 * abs(expected)
    assert found.energy.residual < 1e-6
    assert found.inner_force.shape == (of.balls, len(found.time))
