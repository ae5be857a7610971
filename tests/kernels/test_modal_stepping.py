"""Exact modal stepping, against closed forms, and the flight of the ball."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from asperity.kernels.modal import (
    BeamMotion,
    BeamRecord,
    System,
    modal_coefficients,
    refine,
    roll_beam,
)
from asperity.laws import HertzLaw

H = 2e-3


def one_step(omega, zeta, q, v, p0, p1, h=H):
    a = modal_coefficients(np.array([omega]), np.array([zeta]), h).reshape(2, 4)
    return a @ np.array([q, v, p0, p1])


def by_integration(omega, zeta, q, v, p0, p1, h=H):
    def right(t, y):
        return [y[1], p0 + (p1 - p0) * t / h - 2 * zeta * omega * y[1] - omega**2 * y[0]]

    return solve_ivp(right, (0.0, h), [q, v], method="DOP853", rtol=1e-12, atol=1e-16).y[:, -1]


@pytest.mark.parametrize("zeta", [0.0, 0.0025, 0.3, 1.0, 1.7])
@pytest.mark.parametrize("omega", [1e-3, 30.0, 700.0, 5000.0])
def test_step_is_exact_for_every_kind_of_mode(omega, zeta):
    stepped = one_step(omega, zeta, 1e-3, 0.4, 2.0, -3.0)
    assert_allclose(stepped, by_integration(omega, zeta, 1e-3, 0.4, 2.0, -3.0), rtol=1e-9, atol=1e-14)


def test_free_mode_moves_as_a_mass():
    q, v = one_step(0.0, 0.0, 1.0, 0.5, 2.0, 5.0)
    assert_allclose(v, 0.5 + H * (2.0 + 5.0) / 2, rtol=1e-14)
    assert_allclose(q, 1.0 + H * 0.5 + H**2 * (2.0 / 3 + 5.0 / 6), rtol=1e-14)


@pytest.mark.parametrize("phase", [1e-9, 1e-4, 0.3, 3.0, 40.0, 400.0])
def test_undamped_step_is_the_rotation(phase):
    omega = phase / H
    a = modal_coefficients(np.array([omega]), np.array([0.0]), H).reshape(2, 4)
    rotation = [[np.cos(phase), np.sin(phase) / omega], [-omega * np.sin(phase), np.cos(phase)]]
    scale = np.array([[1.0, 1.0 / omega], [omega, 1.0]])
    assert_allclose(a[:, :2] / scale, np.array(rotation) / scale, atol=1e-12)


def test_step_under_a_ramp_from_rest():
    # q = (t - sin(omega t)/omega)/omega^2 per unit slope of the force
    omega, slope = 900.0, 3.0
    q, v = one_step(omega, 0.0, 0.0, 0.0, 0.0, slope * H)
    assert_allclose(q, slope * (H - np.sin(omega * H) / omega) / omega**2, rtol=1e-12)
    assert_allclose(v, slope * (1 - np.cos(omega * H)) / omega**2, rtol=1e-12)


def test_small_phase_keeps_its_digits():
    # series in omega h: the leading terms are those of a free mass
    a = modal_coefficients(np.array([1e-5 / H]), np.array([0.0]), H).reshape(2, 4)
    assert_allclose(a[0, 2:], [H**2 / 3, H**2 / 6], rtol=1e-9)
    assert_allclose(a[1, 2:], [H / 2, H / 2], rtol=1e-9)


def flight_system(modes=3, h=1e-4):
    omega = 2 * np.pi * np.array([20.0, 90.0, 300.0])[:modes]
    zeta = np.full(modes, 0.01)
    system = System(
        modal_coefficients(omega, zeta, h),
        omega**2,
        2 * zeta * omega,
        np.ones((2, modes)),
        0.5,
        4.9,
        h,
        1.0,
        0.0,
    )
    return system, omega, zeta


def motion_at(modes, ball, velocity, q):
    return BeamMotion(
        np.array(q, dtype=float),
        np.zeros(modes),
        np.zeros(modes),
        np.array([ball, velocity]),
        np.zeros(2),
        np.full(2, ball - sum(q)),
        np.zeros(5),
        np.zeros(5),
        np.zeros(3, dtype=np.int64),
    )


def records(n):
    return BeamRecord(np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n), np.zeros((2, n)))


def test_flight_is_a_parabola_and_the_beam_rings_freely():
    system, omega, zeta = flight_system()
    n = 500
    motion, record = motion_at(3, -1.0, 0.3, [1e-3, -5e-4, 2e-4]), records(n + 1)
    shapes = np.ones((n + 1, 3))
    law = HertzLaw(1e10).prepare(np.zeros(n + 1))
    assert roll_beam(system, motion, record, law, shapes, np.zeros_like(shapes), 0, n, np.inf)
    t = system.time_step * np.arange(1, n + 1)
    assert_allclose(record.force, 0.0, atol=0.0)
    assert_allclose(record.ball[1:], -1.0 + 0.3 * t + 0.5 * (4.9 / 0.5) * t**2, rtol=1e-12)
    damped = omega * np.sqrt(1 - zeta**2)
    ringing = np.exp(-zeta * omega * t[:, None]) * (
        np.cos(damped * t[:, None]) + zeta * omega / damped * np.sin(damped * t[:, None])
    )
    assert_allclose(record.beam[1:], ringing @ [1e-3, -5e-4, 2e-4], atol=1e-15)


def test_ball_bounces_elastically():
    """A ball dropped on a rigid base returns to its height, the closer the smaller the step."""
    heights = []
    for h in (2e-5, 1e-5):
        system, _, _ = flight_system(h=h)
        n = int(0.0652 / h)
        motion, record = motion_at(3, -1e-3, 0.0, np.zeros(3)), records(n + 1)
        nodes = np.zeros((n + 1, 3))  # over a node of all modes the beam does not give
        assert roll_beam(
            system, motion, record, HertzLaw(1e9).prepare(np.zeros(n + 1)), nodes, nodes, 0, n, np.inf
        )
        landed = int(np.argmax(record.force > 0))
        heights.append(record.ball[landed:].min())
        assert motion.counts[1] == 0
    assert_allclose(heights[1], -1e-3, rtol=1e-3)
    assert abs(heights[1] + 1e-3) < 0.5 * abs(heights[0] + 1e-3)


def test_refine_brackets_and_bisects_a_kinked_function():
    low, high, x = -np.inf, np.inf, 5.0
    for iteration in range(80):
        residual = x - 1.0 + (10.0 if x > 2.0 else 0.0)  # jumps across zero nowhere, root at one
        low, high, x = refine(low, high, x, residual, 1.0, iteration)
    assert_allclose(x, 1.0, rtol=1e-14)
    low, high, x = -np.inf, np.inf, 5.0
    for iteration in range(120):
        residual = x - 3.0 + (10.0 if x > 2.0 else 0.0)  # jumps across zero at two
        low, high, x = refine(low, high, x, residual, 1.0, iteration)
    assert_allclose([low, high], 2.0, rtol=1e-12)


def test_force_that_is_not_finite_stops_the_run():
    system, _, _ = flight_system()
    motion, record = motion_at(3, np.nan, 0.0, np.zeros(3)), records(11)
    shapes = np.ones((11, 3))
    assert not roll_beam(
        system, motion, record, HertzLaw(1e9).prepare(np.zeros(11)), shapes, shapes, 0, 10, 1e9
    )


@pytest.mark.parametrize("phase", [0.01, 1.0, 20.0])
def test_the_exact_step_is_the_matrix_exponential(phase):
    # another program's exponential of the oscillator extended by a force linear over the step
    step, ratio, omega = 1e-4, 0.3, phase / 1e-4
    generator = np.zeros((4, 4))
    generator[0, 1] = generator[1, 2] = generator[2, 3] = 1.0
    generator[1, :2] = -(phase**2), -2.0 * ratio * phase
    expected = expm(generator)
    found = modal_coefficients(np.array([omega]), np.array([ratio]), step).reshape(2, 4)
    assert found[0, 0] == pytest.approx(expected[0, 0], rel=1e-11)
    assert found[1, 1] == pytest.approx(expected[1, 1], rel=1e-11)
    assert found[0, 3] == pytest.approx(expected[0, 3] * step**2, rel=1e-11)
    assert found[0, 2] == pytest.approx((expected[0, 2] - expected[0, 3]) * step**2, rel=1e-11)
