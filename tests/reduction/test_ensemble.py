"""k_c(r) from samples on one common datum."""

import numpy as np
import pytest

from asperity.contact import HalfSpace, Hertz
from asperity.contact.scan import first_touch
from asperity.errors import InputError
from asperity.reduction.stiffness import StiffnessEnsemble, patches, stiffness_ensemble, weighted_mean
from asperity.reduction.texture import punch_weights

DX, MODULUS, RADIUS, N = 5e-6, 115e9, 10e-3, 51
APPROACHES = np.linspace(-0.2e-6, 0.4e-6, 7)


def body():
    x = (np.arange(N) - N // 2) * DX
    return (x[:, None] ** 2 + x[None, :] ** 2) / (2 * RADIUS)


def loaded(samples):
    datum = -min(first_touch(s, body()).min() for s in samples)
    return stiffness_ensemble(samples, HalfSpace((N, N), DX, MODULUS), body(), APPROACHES, max(datum, 0.0))


def test_smooth_samples_give_hertz():
    ensemble = loaded([np.zeros((N, N))] * 2)
    hertz = Hertz(MODULUS, RADIUS, RADIUS)
    expected = [hertz.force(d) for d in APPROACHES]
    np.testing.assert_allclose(ensemble.mean_force, expected, rtol=5e-3, atol=1e-9)
    assert ensemble.force_spread.max() == 0.0


def test_rough_stiffness_is_below_hertz_deep_in_and_starts_before_it():
    rng = np.random.default_rng(0)
    samples = [0.1e-6 * rng.standard_normal((N, N)) for _ in range(4)]
    ensemble = loaded(samples)
    hertz = Hertz(MODULUS, RADIUS, RADIUS)
    assert ensemble.datum > 0.0
    assert np.all(ensemble.forces[:, APPROACHES + ensemble.datum <= 0.0] == 0.0)
    assert ensemble.mean_force[2] > hertz.force(APPROACHES[2])  # mean planes just meeting
    deep = -1
    state = ensemble.states[deep]
    assert ensemble.curve.secant(APPROACHES[deep], ensemble.datum) < hertz.force(state) / state
    assert ensemble.curve.force(APPROACHES[deep]) == pytest.approx(ensemble.mean_force[deep], rel=1e-12)


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
        curve = stiffness_ensemble(samples, half_space, body(), states, 0.0).curve
        assert curve.stiffness(light) == pytest.approx(exact, rel=0.01)


def test_patches_have_their_patch_mean_removed_and_cover_the_maps():
    x = np.arange(120.0)
    maps = [np.add.outer(x, 0.1 * x) + 7.0, np.add.outer(x, 0.1 * x)]
    weights = punch_weights((1.0, 1.0), (10.0, 10.0))
    cut = patches(maps, (N, N), 5, weights)
    assert len(cut) == 5
    for sample in cut:
        assert sample.shape == (N, N)
        assert weighted_mean(sample, weights) == pytest.approx(0.0, abs=1e-9)
    assert len(patches(maps, (N, N), 1, weights)) == 2  # at least one from each map


def test_small_map_is_refused():
    with pytest.raises(InputError, match="window of the contact: received 51 × 51 cells"):
        patches([np.zeros((60, 50))], (N, N), 1, punch_weights((1.0, 1.0), (5.0, 5.0)))


def test_the_spread_of_forces_is_that_of_a_sample_of_them():
    """Of forces 1, 2 and 6 N: mean 3 N, squares 4 + 1 + 9 over N − 1."""
    forces = np.array([[1.0, 10.0], [2.0, 10.0], [6.0, 10.0]])
    ensemble = StiffnessEnsemble(np.array([0.0, 1e-6]), forces, np.ones((3, 2)), 0.0, 2)
    np.testing.assert_allclose(ensemble.force_spread, [np.sqrt(7.0), 0.0], atol=1e-15)
