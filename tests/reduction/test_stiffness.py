"""k_c(r) from samples on one datum, the real contact of rough bodies, the force curve and the force table."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.special import erf

from asperity import HalfSpace, Hertz
from asperity.contact.scan import FORCE_ACCURACY, ScanJob, first_touch, rtol_for, scan_forces
from asperity.errors import InputError
from asperity.reduction import stiffness
from asperity.reduction.stiffness import ForceCurve, ForceTable
from asperity.reduction.texture import punch_weights
from asperity.surfaces.statistics import rms_slope
from asperity.surfaces.strip import Rows
from asperity.surfaces.synthesis import self_affine
from refusals import refusals

DX, MODULUS, RADIUS, N = 5e-6, 115e9, 10e-3, 51
HERTZ, APPROACHES = Hertz(MODULUS, RADIUS, RADIUS), np.linspace(-0.2e-6, 0.4e-6, 7)


def body(cells=N, spacing=DX, radius=RADIUS):
    x = (np.arange(cells) - cells // 2) * spacing
    return (x[:, None] ** 2 + x[None, :] ** 2) / (2 * radius)


def loaded(samples, workers=None):
    datum = -min(first_touch(s, body()).min() for s in samples)
    space = HalfSpace((N, N), DX, MODULUS)
    return stiffness.stiffness_ensemble(samples, space, body(), APPROACHES, max(datum, 0.0), workers=workers)


def test_smooth_samples_give_hertz():
    ensemble = loaded([np.zeros((N, N))] * 2)
    expected = [HERTZ.force(d) for d in APPROACHES]
    np.testing.assert_allclose(ensemble.mean_force, expected, rtol=5e-3, atol=1e-9)
    assert ensemble.force_spread.max() == 0.0


def test_rough_stiffness_is_below_hertz_deep_in_and_starts_before_it():
    rng = np.random.default_rng(0)
    samples = [0.1e-6 * rng.standard_normal((N, N)) for _ in range(4)]
    ensemble, alone = (loaded(samples, workers) for workers in (3, 1))
    assert np.array_equal(ensemble.forces, alone.forces)
    assert ensemble.datum > 0.0
    assert np.all(ensemble.forces[:, APPROACHES + ensemble.datum <= 0.0] == 0.0)
    assert ensemble.mean_force[2] > HERTZ.force(APPROACHES[2])  # mean planes just meeting
    state, deep = ensemble.states[-1], APPROACHES[-1]
    assert ensemble.curve.secant(deep, ensemble.datum) < HERTZ.force(state) / state
    assert ensemble.curve.force(deep) == pytest.approx(ensemble.mean_force[-1], rel=1e-12)
    # of N samples
    np.testing.assert_allclose(ensemble.force_spread, ensemble.forces.std(axis=0) * np.sqrt(4 / 3))


def test_stiffness_of_a_light_state_does_not_depend_on_the_grid_of_states():
    """Central differences of the force of the same samples, with 3, 7 and 17 states from there on."""
    waves = 0.1e-6 * np.sin(2 * np.pi * np.arange(N) / 9.0)
    samples = [np.add.outer(np.roll(waves, i), waves) for i in range(3)]
    half_space, light, step = HalfSpace((N, N), DX, MODULUS), -0.1e-6, 1e-10
    by_step = [
        np.mean([half_space.solve(body() - s, approach=light + d, rtol=1e-9).force for s in samples])
        for d in (-step, step)
    ]
    exact = (by_step[1] - by_step[0]) / (2 * step)
    for count in (3, 7, 17):
        states = np.linspace(light, 0.4e-6, count)
        curve = stiffness.stiffness_ensemble(samples, half_space, body(), states, 0.0).curve
        assert curve.stiffness(light) == pytest.approx(exact, rel=0.01)


def test_patches_have_their_patch_mean_removed_and_cover_the_maps():
    x, weights = np.arange(120.0), punch_weights((1.0, 1.0), (10.0, 10.0))
    maps = [np.add.outer(x, 0.1 * x) + 7.0, np.add.outer(x, 0.1 * x)]
    for asked, expected in ((5, 5), (1, 2)):  # at least one from each map
        cut = stiffness.patches(maps, (N, N), asked, weights)
        assert [sample.shape for sample in cut] == [(N, N)] * expected
        assert [stiffness.weighted_mean(s, weights) for s in cut] == pytest.approx([0.0] * expected, abs=1e-9)
    with pytest.raises(InputError, match="window of the contact: received 51 × 51 cells"):
        stiffness.patches([np.zeros((60, 50))], (N, N), 1, weights)


@pytest.mark.parametrize("accuracy", [1e-2, FORCE_ACCURACY])
@pytest.mark.parametrize(("rms", "hardness"), [(0.0, None), (0.1, None), (1.5, None), (0.5, 2e9)])
def test_forces_are_as_accurate_as_asked_for(accuracy, rms, hardness):
    """Against a residual ten thousand times smaller, to thrice the working approach; rms in approaches."""
    approach = HERTZ.approach(10.0)
    a = HERTZ.semi_axes(approach)[0]
    dx = 2 * a / (0.35 * N)
    waves = {"hurst": 0.8, "longest": 1.4 * a, "shortest": 2 * dx}
    heights = self_affine((N + 11, N), (dx, dx), rms=rms * approach, **waves, seed=1).heights
    half_space, approaches = HalfSpace((N, N), dx, MODULUS, hardness), np.array([-rms, 0.1, 0.3, 1.0, 3.0])
    found, tight = (
        scan_forces(ScanJob(half_space, Rows(heights), body(N, dx), approach * approaches, rtol=rtol)).forces
        for rtol in (rtol_for(accuracy), 1e-4 * rtol_for(accuracy))
    )
    touching = tight > 0.0
    assert touching[-1].all()
    assert np.all(found[~touching] == 0.0)
    assert np.abs(found[touching] / tight[touching] - 1.0).max() <= accuracy


def test_cells_that_touch_alone():
    pressure = np.zeros((6, 6))
    assert stiffness.isolated_share(pressure) == 0.0
    pressure[0, 0] = pressure[3, 3] = pressure[3, 4] = 1.0
    pressure[5, 0] = 2.0
    assert stiffness.isolated_share(pressure) == pytest.approx(3 / 5)
    pressure[4, 1] = 5.0  # neighbours across a corner do not count
    assert stiffness.isolated_share(pressure) == pytest.approx(8 / 10)
    assert stiffness.isolated_share(np.ones((4, 4))) == 0.0


@pytest.mark.parametrize("hurst", [0.5, 0.9])
@pytest.mark.parametrize("steepness", [0.4, 1.0, 4.0])
def test_the_real_contact_area_is_that_of_persson(hurst, steepness):
    """Contacts of a ball; steepness is E* Sdq over Hertz's peak pressure.

    Persson's share of contact under a pressure p, erf(√π κ p/(2 E* Sdq)), averaged over Hertz's pressure:
    B. N. J. Persson, J. Chem. Phys. 115 (2001) 3840; κ = 2.0: S. Hyun et al., Phys. Rev. E 70 (2004)
    026117 (not seen).
    """
    radius, load, spacing, cells = 25e-3, 30.0, 8e-6, 65
    hertz = Hertz(MODULUS, radius, radius)
    peak = hertz.peak_pressure(hertz.approach(load))
    waves = {"longest": 0.2e-3, "shortest": 32e-6, "seed": 3}
    texture = self_affine((4 * cells, cells), (spacing, spacing), rms=1e-7, hurst=hurst, **waves)
    slope = steepness * peak / MODULUS
    pieces = np.split(texture.heights * slope / rms_slope(texture), 4)
    half_space, ball = HalfSpace((cells, cells), spacing, MODULUS), body(cells, spacing, radius)
    smooth = half_space.solve(ball, load=load).area
    rough = [half_space.solve(ball - (piece - piece.mean()), load=load).area for piece in pieces]
    pressure = peak * np.sqrt(1 - (np.arange(1000) + 0.5) / 1000)  # at places of equal areas
    share = erf(0.5 * np.sqrt(np.pi) * 2.0 * pressure / (MODULUS * slope)).mean()
    assert np.mean(rough) / smooth == pytest.approx(share, abs=0.05)


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
    assert_allclose(curve.inverse(K * s**1.5), s, rtol=4e-15)  # a power of a power
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


def test_a_piece_that_is_a_square_is_inverted():
    curve = ForceCurve(np.array([0.0, 1.0]), np.array([[0.0, 1.0, 1.0, 0.0]]), 1.0)
    assert_allclose(curve.inverse([0.0, 0.75, 2.0, 5.0]), [0.0, 0.5, 1.0, 2.0], atol=1e-15)


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
