"""Exact modal stepping, against closed forms."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from asperity.kernels.stepping import refine
from asperity.rolling.steps import modal_coefficients

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
