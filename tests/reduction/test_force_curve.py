"""The force curve and the force table."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from asperity.reduction.stiffness import ForceCurve, ForceTable
from refusals import refusals

K = 3.2e10


def rising(draw_steps):
    """Samples of a curve that rises by given steps of approach (um) and force (N)."""
    steps = np.array(draw_steps)
    return -2e-6 + 1e-6 * np.cumsum(steps[:, 0]), np.cumsum(steps[:, 1]) - steps[0, 1]


curves = st.lists(st.tuples(st.floats(0.05, 3.0), st.floats(1e-3, 20.0)), min_size=4, max_size=15).map(
    lambda steps: ForceCurve.from_samples(*rising(steps))
)


def test_hertz_is_exact_and_unbounded():
    curve = ForceCurve.hertz(K)
    s = np.array([1e-9, 1e-6, 1e-4, 2.0])
    assert_allclose(curve.force(s), K * s**1.5, rtol=1e-15)
    assert_allclose(curve.stiffness(s), 1.5 * K * np.sqrt(s), rtol=1e-15)
    assert_allclose(curve.inverse(K * s**1.5), s, rtol=1e-15)
    assert curve.upper == np.inf
    assert_allclose(curve.force([-1e-6, 0.0]), 0.0, atol=0.0)


@given(st.floats(0.0, 0.999), st.integers(0, 4))
@settings(max_examples=40)
def test_samples_of_hertz_give_hertz_between_and_beyond(offset, zeros):
    """With first touch at a sample or between two, and with none before it."""
    s = 1e-6 * (np.arange(8) - zeros + offset + 1e-3)
    curve = ForceCurve.from_samples(s, K * np.maximum(s, 0.0) ** 1.5)
    assert_allclose(curve.first_touch, 0.0, atol=1e-20)
    fine = np.linspace(-3e-6, 12e-6, 151)
    assert_allclose(curve.force(fine), K * np.maximum(fine, 0.0) ** 1.5, rtol=1e-9, atol=1e-9)
    assert curve.upper == s[-1]


def test_linear_acts_in_tension():
    curve = ForceCurve.linear(force=5.0, stiffness=2e7, approach=1e-6)
    s = np.array([-3e-6, 1e-6, 2e-6])
    assert_allclose(curve.force(s), 5.0 + 2e7 * (s - 1e-6), rtol=1e-12)
    assert_allclose(curve.stiffness(s), 2e7)
    assert_allclose(curve.inverse([-5.0, 0.0, 25.0]), [0.5e-6, 0.75e-6, 2e-6], rtol=1e-12)
    assert curve.first_touch == -np.inf


def test_secant_of_a_quadratic_force_is_the_printed_stiffness():
    s = np.linspace(-3e-6, 5e-6, 9)
    curve = ForceCurve.from_samples(s, 1e12 * (s + 3e-6) ** 2)
    assert_allclose(curve.secant(s[1:], 3e-6), 1e12 * (s[1:] + 3e-6), rtol=1e-12)
    assert curve.secant(-4e-6, 3e-6) == 0.0


@given(curves)
@settings(max_examples=40)
def test_curve_is_monotone_smooth_and_inverted_and_stiffness_its_derivative(curve):
    low, high = curve.knots[0], curve.knots[-1]
    s = np.sort(np.concatenate([np.linspace(low - 1e-7, high + 1e-6, 301), curve.knots]))
    force = curve.force(s)
    assert np.all(np.diff(force) >= 0.0)
    assert np.all(curve.stiffness(s) >= 0.0)
    inside = force > 0.0
    again = curve.force(curve.inverse(force[inside].reshape(1, -1)))[0]
    assert_allclose(again, force[inside], rtol=1e-9, atol=1e-12 * force.max())
    step = 1e-13 * (high - low)
    jump = curve.stiffness(curve.knots + step) - curve.stiffness(curve.knots - step)
    assert_allclose(jump, 0.0, atol=1e-3 * curve.stiffness(s).max())
    width = np.diff(curve.knots)
    s, step = (curve.knots[:-1] + np.outer([0.3, 0.6], width)).ravel(), 1e-5 * np.tile(width, 2)
    difference = (curve.force(s + step) - curve.force(s - step)) / (2.0 * step)
    assert_allclose(curve.stiffness(s), difference, rtol=1e-5, atol=1e-6 * difference.max())


def test_curve_starts_no_lower_than_the_last_sample_without_contact():
    # g = 1, 1.1, 3: its continuation would reach below the sample at -1 um
    curve = ForceCurve.from_samples([-2e-6, -1e-6, 0.0, 1e-6, 2e-6], [0.0, 0.0, 1.0, 1.1**1.5, 3**1.5])
    assert_allclose(curve.first_touch, -1e-6)
    assert_allclose(curve.force([-1.5e-6, 0.0, 1e-6]), [0.0, 1.0, 1.1**1.5], rtol=1e-12)


def test_table_never_pulls_and_never_falls():
    rng = np.random.default_rng(5)
    forces = np.maximum(0.0, np.cumsum(rng.uniform(0.0, 1.0, (6, 200)), axis=0) - 1.0)
    table = ForceTable(forces, np.arange(6) * 1e-6, 0.0, 1e-5, np.zeros(200))
    fine = table.at(np.linspace(0.0, 199e-5, 3001))
    assert fine.min() >= 0.0
    assert np.diff(fine, axis=1).min() >= 0.0
    assert_allclose(table.at(np.arange(200) * 1e-5), forces.T, rtol=1e-9, atol=1e-9)


def samples(approach, force):
    ForceCurve.from_samples(approach, force)


test_messages = refusals(
    (samples, ([0.0, 1e-6], [0.0, 1.0]), "at least two positive"),
    (samples, ([0.0, 1e-6, 2e-6], [0.0, 2.0, 1.0]), "strictly increasing forces"),
    (samples, ([0.0, 1e-6, 2e-6], [-1.0, 1.0, 2.0]), "none negative"),
    (ForceCurve.hertz, (0.0,), "Hertz constant"),
    (ForceCurve.linear, (1.0, np.nan), "contact stiffness"),
    (ForceCurve.hertz(K).inverse, (-1.0,), "only pushes"),
    of=lambda make, arguments: make(*arguments),
)
