"""A ball bearing of four-point contact: against one of one arc, closed forms, and forces on exact circles."""

import math

import numpy as np
import pytest
from scipy.optimize import least_squares

from asperity import BallBearing
from asperity.structures.bearing_creepage import creepage_of, flank_spin
from asperity.structures.bearing_statics import _Balls
from asperity.structures.waviness_tolerance import wave_tolerances
from refusals import refusals

FLANKS = math.radians(35.0)
QJ = BallBearing(12, 11.112e-3, 46e-3, 0.515, 0.53, arch_angle=FLANKS, clearance=40e-6)
ONE_ARC = QJ.with_(arch_angle=None, clearance=None, contact_angle=QJ.free_angle)
TIGHT = QJ.with_(clearance=-4e-6)
TURNED = QJ.with_(turning="outer")


@pytest.mark.parametrize("speed", [0.0, 60.0])
def test_under_an_axial_load_balls_are_between_two_flanks_as_in_grooves_of_one_arc(speed):
    """Whose centres are nearer along the axis by both offsets; its free angle is cos α_g − P_d/2A."""
    assert math.cos(QJ.free_angle) == pytest.approx(math.cos(FLANKS) - 20e-6 / QJ.groove_distance)
    found, expected = (each.loaded(axial=3000.0, speed=speed) for each in (QJ, ONE_ARC))
    np.testing.assert_allclose(found.inner_loads[..., 0], expected.inner_load, rtol=1e-9)
    np.testing.assert_allclose(found.outer_loads[..., 0], expected.outer_load, rtol=1e-9)
    np.testing.assert_allclose(found.outer_angle, expected.outer_angle, rtol=1e-9)
    np.testing.assert_array_equal(found.inner_loads[..., 1], 0.0)
    np.testing.assert_array_equal(found.outer_loads[..., 1], 0.0)
    offsets = sum(each.offset for each in QJ.arches)
    apart = expected.displacement[:, 2] - found.displacement[:, 2]
    np.testing.assert_allclose(apart, offsets, rtol=1e-9)
    np.testing.assert_allclose(found.stiffness[:, 2, 2], expected.stiffness[:, 2, 2], rtol=1e-8)
    np.testing.assert_allclose(found.damping(20.0)[:, 2, 2], expected.damping(20.0)[:, 2, 2], rtol=1e-8)
    assert found.contact_angle == pytest.approx(expected.contact_angle)
    np.testing.assert_allclose(found.inner_pressure, expected.inner_pressure, rtol=1e-9)


def test_the_force_of_both_flanks_is_the_slope_of_their_energy():
    balls = _Balls(TIGHT, 0.0)
    place = np.array([TIGHT.groove_distance, 2e-6])
    step = 1e-9
    for ring in ("inner", "outer"):
        assert (balls.contacts(place, ring)[0] > 0.0).all()
        energies = [balls.held(place + way, ring)[0] for way in (*step * np.eye(2), *-step * np.eye(2))]
        slope = (np.array(energies[:2]) - energies[2:]) / (2.0 * step)
        np.testing.assert_allclose(balls.held(place, ring)[1], slope, rtol=1e-6)


def test_under_a_radial_load_both_flanks_carry_alike():
    """Σ 2 Q cos α cos ψ = F, and nothing pushes along the axis."""
    found = QJ.loaded(radial=2000.0)
    for loads, angles in ((found.inner_loads, found.inner_angles), (found.outer_loads, found.outer_angles)):
        np.testing.assert_allclose(loads[..., 0], loads[..., 1], rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(angles[..., 0], -angles[..., 1], rtol=1e-9)
    inward = (found.inner_loads * np.cos(np.nan_to_num(found.inner_angles))).sum(axis=-1)
    assert (inward * np.cos(found.azimuth)).sum(axis=1) == pytest.approx(2000.0, rel=1e-10)
    assert (inward * np.sin(found.azimuth)).sum(axis=1) == pytest.approx(0.0, abs=1e-7)
    assert found.contact_angle == pytest.approx(FLANKS, abs=0.02)
    assert found.displacement[:, 2] == pytest.approx(0.0, abs=1e-12)


def test_dampers_of_both_flanks_take_what_the_ball_leaves_them():
    """Radially Σ 2 c cos² ψ (cos² α_i (1 − s)² + cos² α_o s²); a ball follows by s = k_i/(k_i + k_o)."""
    found = QJ.loaded(radial=2000.0, cage_angles=[0.0])
    carries = found.inner_load[0] > 0.0
    stiff, seen = [], []
    for contact, conformity, loads, angles in (
        (QJ.inner_contact, QJ.inner_conformity, found.inner_loads, found.inner_angles),
        (QJ.outer_contact, QJ.outer_conformity, found.outer_loads, found.outer_angles),
    ):
        load, angle = loads[0, carries, 0], angles[0, carries, 0]
        approach = contact.approach(1.0) * load ** (2.0 / 3.0)
        across = load / ((conformity - 0.5) * QJ.ball_diameter + approach)
        stiff.append(1.5 * load / approach * np.cos(angle) ** 2 + across * np.sin(angle) ** 2)
        seen.append(np.cos(angle) ** 2)
    follows = stiff[0] / (stiff[0] + stiff[1])
    of_ball = seen[0] * (1.0 - follows) ** 2 + seen[1] * follows**2
    expected = 2.0 * 20.0 * (of_ball * np.cos(found.azimuth[0, carries]) ** 2).sum()
    assert found.damping(20.0)[0, 0, 0] == pytest.approx(expected, rel=1e-6)


def test_interference_presses_four_contacts_of_each_ball():
    """Each line by K (u cos α)^1.5 where the radius grows by u = −P_d/2."""
    found = TIGHT.loaded(radial=1e-3)
    expected = TIGHT.series_stiffness * (2e-6 * math.cos(FLANKS)) ** 1.5
    for loads in (found.inner_loads, found.outer_loads):
        np.testing.assert_allclose(loads, expected, rtol=5e-3)


def test_a_ball_that_is_thrown_outwards_lies_on_both_flanks():
    """2 Q cos α = m (d_m/2) ω²."""
    found = QJ.loaded(radial=500.0, speed=100.0)
    free = found.inner_load == 0.0
    assert free.any()
    shared = 2.0 * found.outer_loads[free] * np.cos(found.outer_angles[free])
    np.testing.assert_allclose(shared, QJ.centrifugal_force(100.0), rtol=1e-6)


def forces_on_circles(bearing, lift, radial, axial):
    """Loads of all contacts (Z, 2), inner and outer, by forces on ring and balls over circles."""
    D, Z = bearing.ball_diameter, bearing.balls
    sides = (
        (bearing.inner_conformity, bearing.inner_contact),
        (bearing.outer_conformity, bearing.outer_contact),
    )
    (r_i, K_i), (r_o, K_o) = [((f - 0.5) * D * 1e6, c.stiffness_constant * 1e-9) for f, c in sides]
    psi = 2.0 * np.pi * np.arange(Z) / Z
    out = np.array([np.cos(psi), np.sin(psi)]).T

    def pulled(ball, centre, length, constant):
        way = centre - ball
        distance = np.linalg.norm(way, axis=-1)
        load = constant * np.maximum(distance - length, 0.0) ** 1.5
        return load[..., None] * way / distance[..., None], load

    def missed(x, told=False):
        ring, balls = x[:3], x[3:].reshape(Z, 1, 2)
        sign = np.array([1.0, -1.0])
        inner = np.zeros((Z, 2, 2))
        radius = (r_i + r_o) * math.cos(FLANKS) - 0.5e6 * bearing.clearance
        inner[..., 0] = (radius + out @ ring[:2])[:, None]
        inner[..., 1] = ring[2] + sign * r_i * math.sin(FLANKS)
        outer = np.zeros((Z, 2, 2))
        outer[..., 1] = -sign * r_o * math.sin(FLANKS)
        above, Q_i = pulled(balls, inner, r_i, K_i)
        below, Q_o = pulled(balls, outer, r_o, K_o)
        if told:
            return Q_i, Q_o
        on_ball = np.add((above + below).sum(axis=1), [lift, 0.0])
        on_ring = above.sum(axis=1)
        balance = [*(on_ring[:, 0] @ out - [radial, 0.0]), on_ring[:, 1].sum() - axial]
        return np.concatenate([balance, on_ball.ravel()])

    start = np.zeros(3 + 2 * Z)
    start[:3] = [40.0, 0.0, 3.0]
    start[3::2] = r_o * math.cos(FLANKS) + np.maximum(0.5 * (out[:, 0] * 40.0 - 20.0), 0.5)
    found = least_squares(missed, start, xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=4000)
    assert np.abs(found.fun).max() < 1e-6 * radial
    return missed(found.x, told=True)


def test_three_and_four_contacts_are_those_of_forces_on_exact_circles():
    """Under both loads, at a speed: some balls touch on four points, some on two, some only outwards."""
    speed = 50.0
    found = QJ.loaded(radial=2000.0, axial=500.0, speed=speed, cage_angles=[0.0])
    inner, outer = forces_on_circles(QJ, QJ.centrifugal_force(speed), 2000.0, 500.0)
    np.testing.assert_allclose(found.inner_loads[0], inner, rtol=1e-5, atol=1e-3)
    np.testing.assert_allclose(found.outer_loads[0], outer, rtol=1e-5, atol=1e-3)
    carrying = np.count_nonzero(found.inner_loads[0], axis=-1) + np.count_nonzero(
        found.outer_loads[0], axis=-1
    )
    assert {2, 4} <= {*carrying.tolist()}
    assert found.inner_load[0] == pytest.approx(found.inner_loads[0].max(axis=-1))


def test_its_stiffness_is_what_the_load_changes_by():
    found, more = (QJ.loaded(radial=2000.0, axial=each, cage_angles=[0.1]) for each in (500.0, 500.05))
    change = found.stiffness[0] @ (more.displacement[0] - found.displacement[0])
    np.testing.assert_allclose(change, [0.0, 0.0, 0.05], atol=2e-5)


def test_a_ball_on_four_flanks_spins_by_what_it_and_the_rings_turn_about_their_normals():
    """(ω_b ± ω_ring) sin α over the speed of rolling, all seen from the cage, where nothing slides."""
    for of in (QJ, TURNED):
        turning = of.kinematics(30.0, contact_angle=FLANKS)
        ball = turning.spin / math.cos(FLANKS)  # about the axis of the bearing
        rings = turning.inner - turning.cage, turning.cage - turning.outer
        rates = 2.0 * math.pi * (ball + np.array([1.0, -1.0]) * np.abs(rings))
        rolling = math.pi * ball * of.ball_diameter * math.cos(FLANKS)
        np.testing.assert_allclose(flank_spin(of), rates * math.sin(FLANKS) / rolling, rtol=1e-9)


def test_tones_of_a_radial_load_are_those_of_rolling_on_its_flanks():
    tones = QJ.tones()
    assert tones["outer"].order == pytest.approx(6.0 * (1.0 - 11.112 / 46.0 * math.cos(FLANKS)))
    along = QJ.tones(axial=True)["outer"].order
    assert along == pytest.approx(6.0 * (1.0 - 11.112 / 46.0 * math.cos(QJ.free_angle)))


test_arches_that_cannot_be = refusals(
    (
        {"contact_angle": 0.3, "clearance": None},
        "received both arch_angle and contact_angle; allowed: one of",
    ),
    ({"arch_angle": 1.5}, r"arch_angle \(rad\): received 1.5; allowed: an angle above 0, up to 1.4 rad"),
    ({"arch_angle": -0.1}, "arch_angle"),
    of=lambda changes: QJ.with_(**changes),
)
test_what_arches_have_not = refusals(
    (lambda: creepage_of(QJ.loaded(radial=100.0)), "grooves: received of two arcs; .* spins on both rings"),
    (
        lambda: list(wave_tolerances(QJ, QJ.loaded(axial=3000.0), 30.0, [1.0], [(50.0, 300.0)])),
        "grooves: received of two arcs; allowed: of one arc: waves of two flanks are not in it",
    ),
    (
        lambda: QJ.with_(arch_angle=0.2, clearance=0.0).loaded(radial=4000.0),
        "contact: received half an axis of .* mm across .* allowed: .* the arcs .* a wider arch_angle",
    ),
    of=lambda call: call(),
)
