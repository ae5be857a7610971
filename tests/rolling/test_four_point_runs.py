"""A ball bearing of four-point contact that runs: its statics, limits, energy, and as a case."""

import json
import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import least_squares, root

import asperity
from asperity import BallBearing
from asperity.case.cases import as_case
from asperity.errors import CaseError
from asperity.laws import HertzLaw
from asperity.rolling.bearing import BearingRings, roll_bearing
from asperity.scenes.bearing_validity import out_of_place
from asperity.scenes.figures.bearing import bands_table
from asperity.speeds import SpeedCourse
from asperity.structures.ring import Ring
from refusals import refusals

FLANKS = math.radians(35.0)
QJ = BallBearing(12, 11.112e-3, 46e-3, 0.515, 0.53, arch_angle=FLANKS, clearance=4e-6)
STILL = {"speed": 1e-3, "duration": 2e-6, "time_step": 1e-6, "settling": 0.0, "centrifugal": False}


def rolled(bearing, radial, axial, *, angle=None, damping=0.0, stiffer=1.0, **times):
    angle = bearing.loaded(radial, axial).contact_angle if angle is None else angle
    held = {"radial_stiffness": 1e8, "axial_stiffness": 1e8, "damping_ratio": 0.3}
    rings = BearingRings(Ring.rigid(0.5, angle), Ring.rigid(0.3, angle, **held))
    contacts = bearing.inner_contact, bearing.outer_contact
    laws = [HertzLaw(stiffer * each.stiffness_constant, None, damping) for each in contacts]
    return roll_bearing(bearing, rings, *laws, radial=radial, axial=axial, **STILL | times)


def apart(run):
    """Displacement of the inner ring from the outer one at the start, m."""
    return run.inner_motion[:, 0] - run.outer_motion[:, 0]


def on_fixed_normals(bearing, angle, radial, axial):
    """Ring and loads (Z, 2) of inner flanks, by forces on ring and balls on lines that keep their angle."""
    psi = 2.0 * np.pi * np.arange(bearing.balls) / bearing.balls
    sides = np.array([1.0, -1.0])
    normals = np.array([np.full(2, math.cos(angle)), sides * math.sin(angle)])  # (2, flanks)
    A, flanks = bearing.groove_distance, bearing.arch_angle
    gap = A * (1.0 - math.cos(angle - flanks)) + 0.5 * bearing.clearance * math.cos(angle)

    def loads(x):
        ring, balls = x[:3] * 1e-6, x[3:].reshape(-1, 2) * 1e-6
        place = np.column_stack([np.cos(psi) * ring[0] + np.sin(psi) * ring[1], np.full(psi.size, ring[2])])
        inner = np.maximum((place - balls) @ normals - gap, 0.0) ** 1.5
        outer = np.maximum(balls @ normals, 0.0) ** 1.5
        return (
            bearing.inner_contact.stiffness_constant * inner,
            bearing.outer_contact.stiffness_constant * outer,
        )

    def missed(x):
        inner, outer = loads(x)
        on_ring = inner @ normals.T
        pulled = [
            (on_ring[:, 0] * np.cos(psi)).sum() - radial,
            (on_ring[:, 0] * np.sin(psi)).sum(),
            on_ring[:, 1].sum() - axial,
        ]
        return np.concatenate([pulled, ((outer - inner) @ normals.T).ravel()])

    start = apart(rolled(bearing, radial, axial)) * 1.02e6
    first = np.column_stack([np.cos(psi) * start[0], np.full(psi.size, start[2])]) * 0.5
    closest = {"xtol": 1e-15, "ftol": 1e-15, "gtol": 1e-15}
    found = least_squares(missed, np.concatenate([start, first.ravel()]), **closest)
    assert np.abs(missed(found.x)).max() < 1e-9 * (radial + axial)
    return found.x[:3] * 1e-6, loads(found.x)[0]


@pytest.mark.parametrize(("radial", "axial"), [(100.0, 50.0), (2000.0, 700.0)])
def test_it_starts_as_forces_on_ring_and_balls_are_in_balance(radial, axial):
    tight = QJ.with_(clearance=-6e-6)
    run = rolled(tight, radial, axial)
    ring, loads = on_fixed_normals(tight, tight.loaded(radial, axial).contact_angle, radial, axial)
    Z = tight.balls
    assert np.abs(run.flank_force[:Z, 0] - loads[:, 1]).max() < 1e-9 * loads.max()
    assert np.abs(run.inner_force[:, 0] - loads.sum(axis=1)).max() < 1e-9 * loads.max()
    assert np.abs(apart(run) - ring).max() < 1e-9 * np.abs(ring).max()


def test_under_an_axial_load_it_starts_as_the_static_solution_on_circles():
    """All balls at one angle, which is that of the run: `BallBearing.loaded` to its digits."""
    for bearing, load in ((QJ, 100.0), (QJ.with_(clearance=40e-6), 3000.0)):
        run, still = rolled(bearing, 0.0, load), bearing.loaded(axial=load, cage_angles=[0.0])
        np.testing.assert_allclose(run.inner_force[:, 0], still.inner_loads[0, :, 0], rtol=1e-9)
        assert np.abs(run.flank_force[:, 0]).max() < 1e-9 * load
        assert apart(run)[2] == pytest.approx(still.displacement[0, 2], rel=1e-9)


def on_circles(of, axial, lift):
    """Loads of the outer and of the inner flanks (2, 2), by forces on ball and ring where angles follow."""
    normals = np.array([[math.cos(FLANKS), math.sin(FLANKS)], [math.cos(FLANKS), -math.sin(FLANKS)]])
    grooves = (of.outer_conformity, of.outer_contact, 1.0), (of.inner_conformity, of.inner_contact, -1.0)

    def pressed(x):
        ball, ring = x[:2] * 1e-6, np.array([-0.5 * of.clearance, 1e-6 * x[2]])
        for conformity, contact, sign in grooves:
            length = (conformity - 0.5) * of.ball_diameter
            reach = ball - ring * (sign < 0.0) + sign * length * normals  # from centres of the arcs
            far = np.linalg.norm(reach, axis=1, keepdims=True)
            load = contact.stiffness_constant * np.maximum(far - length, 0.0) ** 1.5
            yield load[:, 0], load * reach / far

    def missed(x):
        (_, on_outer), (_, on_inner) = pressed(x)
        held = [lift, 0.0] - on_outer.sum(axis=0) - on_inner.sum(axis=0)
        return [*held, on_inner[:, 1].sum() + axial / of.balls]

    found = root(missed, [1.0, 5.0, 10.0], tol=1e-14)
    assert np.abs(found.fun).max() < 1e-9 * axial
    return np.array([load for load, _ in pressed(found.x)])


def test_fast_balls_press_flanks_at_angles_that_part_and_in_a_run_do_not():
    """On lines that keep their angle F_c/(2 cos α) is added to each outer flank; on circles half of it."""
    still, lift = QJ.loaded(axial=400.0, speed=100.0, cage_angles=[0.0]), QJ.centrifugal_force(100.0)
    outer, inner = on_circles(QJ, 400.0, lift)
    np.testing.assert_allclose(still.outer_loads[0, 0], outer, rtol=1e-6)
    np.testing.assert_allclose(still.inner_loads[0, 0], inner, rtol=1e-6)
    run = rolled(QJ, 0.0, 400.0, speed=100.0, centrifugal=True)
    light = float(run.flank_force[QJ.balls, 0])
    angle = QJ.loaded(axial=400.0).contact_angle
    thrown = QJ.centrifugal_force(100.0) / (2.0 * math.cos(angle))
    assert light == pytest.approx(thrown, rel=0.02)
    heavy = float(run.outer_force[0, 0]) - light
    assert heavy == pytest.approx(400.0 / (12 * math.sin(angle)) + thrown, rel=0.02)
    assert [round(each, 1) for each in (light, outer[1])] == [5.1, 2.6]  # as the page has them
    assert heavy / outer[0] == pytest.approx(1.02, abs=0.005)


def test_under_a_radial_load_it_is_near_the_static_solution_whose_angles_follow():
    run, still = rolled(QJ, 100.0, 0.0), QJ.loaded(100.0, cage_angles=[0.0])
    loads = still.inner_loads[0]
    np.testing.assert_allclose(run.inner_force[:, 0], loads.sum(axis=1), atol=2e-3 * loads.max())
    np.testing.assert_allclose(run.flank_force[:12, 0], 0.5 * run.inner_force[:, 0], rtol=1e-9, atol=1e-7)
    assert apart(run) == pytest.approx(still.displacement[0], rel=1e-3, abs=1e-12)


def test_arches_of_a_small_angle_are_one_arc_of_two_contacts():
    flat, one = (QJ.with_(arch_angle=each) for each in (1e-6, None))
    run = rolled(flat, 500.0, 0.0, angle=1e-6)
    expected = rolled(one, 500.0, 0.0, angle=0.0, stiffer=2.0)
    np.testing.assert_allclose(run.inner_force, expected.inner_force, rtol=1e-5, atol=1e-6)
    assert apart(run)[0] == pytest.approx(apart(expected)[0], rel=1e-6)


TURNING = {"speed": 50.0, "duration": 0.02, "settling": 0.01, "time_step": 2e-6, "damping": 60.0}


@pytest.mark.parametrize("axial", [0.0, 300.0])
def test_it_turns_and_its_energy_is_balanced(axial):
    run = rolled(QJ, 1000.0, axial, **TURNING, centrifugal=True)
    assert run.energy.residual < 1e-6
    assert run.unconverged_steps == 0
    assert run.reached.shape == (2, 2)
    assert run.softening.shape == (2, 12)
    assert run.flank_force.shape == run.contact_force.shape
    angle = QJ.loaded(1000.0, axial).contact_angle
    along = math.sin(angle) * (run.inner_force - 2.0 * run.flank_force[:12]).sum(axis=0)
    assert along.mean() == pytest.approx(axial, abs=2.0)
    if not axial:  # nothing tells one flank from the other
        assert np.abs(run.inner_motion[2]).max() < 1e-12
        np.testing.assert_allclose(run.flank_force, 0.5 * run.contact_force, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("course", [False, True])
def test_a_ball_that_is_thrown_outwards_lies_on_both_flanks(course):
    """2 Q cos α = m (d_m/2) ω², at a speed that is even and at the first of one that changes."""
    speed = SpeedCourse([0.0, 1.0], [100.0, 300.0]) if course else 100.0
    wide = QJ.with_(clearance=40e-6)
    run = rolled(wide, 500.0, 0.0, damping=60.0, **STILL | {"speed": speed, "centrifugal": True})
    free = np.abs(run.inner_force[:, 0]) < 1e-6
    assert free.any()
    angle = wide.loaded(500.0).contact_angle
    cage = wide.kinematics(100.0, contact_angle=angle).cage
    thrown = 0.5 * wide.ball_mass * wide.pitch_diameter * (2.0 * math.pi * cage) ** 2
    np.testing.assert_allclose(run.outer_force[free, 0] * math.cos(angle), thrown, rtol=1e-4)


# --- as a case

KEYS = {"balls": 8, "ball_diameter": "11.112 mm", "pitch_diameter": "46 mm", "arch_angle": "35 deg"}
CASE = {
    "kind": "ball-bearing",
    "speed": "6000 1/min",
    "radial": "500 N",
    "axial": "300 N",
    "laws": ["areal", "hertz"],
    "duration": "30 ms",
    "settling": "5 ms",
    "bearing": KEYS | {"clearance": "4 um"},
    "outer_raceway": {"waviness": "0.1 um"},
}


def test_a_case_of_it_runs_and_writes_what_each_flank_carries():
    found = asperity.run(as_case(CASE), brief=True)
    flank, force = (found[f"rolling/{name}"] for name in ("flank_force", "contact_force"))
    assert flank.dims == ("law", "contact", "time")
    assert flank.shape == force.shape
    inner = (force - 2.0 * flank).values[0, :8].sum(axis=0).mean()
    angle = found["bearing"].attrs["contact_angle"]
    assert math.sin(angle) * inner == pytest.approx(300.0, rel=0.02)
    checks = json.loads(found["contact"].attrs["validity"])
    assert not [each for each in checks if each["grade"] == "out of range"]
    anderons, velocities = (found[f"bearing/band_{name}"].values[0, 0] for name in ("anderons", "velocity"))
    one = 25.4e-9 * 200.0 * np.pi * np.sqrt(np.log2([6.0, 6.0, 10.0 / 1.8]))
    np.testing.assert_allclose(anderons, velocities / one, rtol=1e-12)
    assert {"50 to 300 Hz, µm/s", "50 to 300 Hz, anderon"} <= set(bands_table(found).head)


def test_forces_of_both_flanks_carry_an_axial_load_with_their_difference():
    """Three parts in all, of which one is on the other flank: the axial load is one part."""
    case = as_case(CASE | {"radial": "0 N"})
    part = np.full((8, 5), 300.0 / (8.0 * math.sin(case.static.contact_angle)))
    still = np.zeros((3, 5))
    forces = {"inner_force": 3.0 * part, "flank_force": np.concatenate([part, part])}
    run = SimpleNamespace(cage=np.zeros(5), inner_motion=still, outer_motion=still, **forces)
    assert not list(out_of_place(case, "hertz", run))


test_what_arches_have_not_is_refused = refusals(
    ({"friction": 0.1}, "friction: received 0.1; allowed: none of gothic arches: on two flanks a ball spins"),
    ({"wear_coefficient": 1e-8}, "wear_coefficient: received 1e-08; allowed: none of gothic arches"),
    of=lambda changes: as_case(CASE | changes),
    error=CaseError,
)
