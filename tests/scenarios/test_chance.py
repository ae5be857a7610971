"""How sure the levels of one record are: what chance and the start from rest leave, against closed forms."""

import numpy as np
import pytest
from scipy.stats import gamma

from asperity.spectra import band_product, chance_and_start, level_deviation, values_seen

CENTRE = 100.0
SETTLED, RECORD = 0.2, 0.8


def resonance(frequency, damping):
    """One oscillator under a force, mass one; two places where it is the same."""
    own = 2.0 * np.pi * CENTRE
    omega = 2.0 * np.pi * frequency
    return np.tile(1.0 / (own**2 - omega**2 + 2j * damping * own * omega), (2, 1))


@pytest.mark.parametrize("damping", [0.0005, 0.0025, 0.01])
def test_a_resonance_forgets_its_start_as_slowly_as_it_rings(damping):
    """Its mean square grows as 1 − exp(−λt), λ = 2ζω; white noise in the band would be there at once."""
    rate = 2.0 * damping * 2.0 * np.pi * CENTRE
    _, (share,) = chance_and_start(lambda f: resonance(f, damping), np.array([CENTRE]), SETTLED, RECORD)
    expected = np.exp(-rate * SETTLED) * (1.0 - np.exp(-rate * RECORD)) / (rate * RECORD)
    assert share == pytest.approx(expected, rel=0.02, abs=0.01)


@pytest.mark.parametrize("damping", [0.0005, 0.001, 0.0025])
def test_a_band_holds_as_many_values_as_its_resonance_forgets(damping):
    """Of the correlation exp(−λ|τ|) of its square; the band itself would hold 18."""
    along = 2.0 * damping * 2.0 * np.pi * CENTRE * RECORD
    (values,), _ = chance_and_start(lambda f: resonance(f, damping), np.array([CENTRE]), SETTLED, RECORD)
    expected = 0.5 * along / (1.0 - (1.0 - np.exp(-along)) / along)
    assert values == pytest.approx(max(expected, 1.0), rel=0.03)


def test_white_noise_holds_bandwidth_times_time():
    centres = 10.0 ** np.arange(2.0, 3.6, 0.1)
    values, share = chance_and_start(lambda f: np.ones((3, f.size)), centres, SETTLED, RECORD)
    np.testing.assert_allclose(values, band_product(centres, RECORD), rtol=0.1)
    assert share.max() < 0.02


def test_places_that_ring_louder_count_more():
    """Half of a record that is silent leaves half of the values."""
    (silent,), (even,) = (
        chance_and_start(lambda f, p=p: np.outer(p, np.ones(f.size)), np.array([1e3]), SETTLED, RECORD)[0]
        for p in ([1.0, 0.0], [1.0, 1.0])
    )
    assert silent == pytest.approx(0.5 * even, rel=1e-9)


@pytest.mark.parametrize("values", [1.0, 3.0, 50.0])
def test_a_level_deviates_as_that_of_a_gamma_distribution(values):
    draws = 10.0 * np.log10(gamma(values).rvs(200_000, random_state=1))
    assert level_deviation(values) == pytest.approx(draws.std(), rel=0.01)


def test_a_texture_that_comes_again_holds_the_values_of_one_turn():
    """Ten turns of the same noise scatter as one; noise that does not come again as all ten."""
    rng, turn, turns = np.random.default_rng(5), 400, 10
    centres, step = np.array([100.0, 200.0]), 1e-3
    seen = [values_seen(np.tile(rng.standard_normal(turn), turns), step, centres) for _ in range(40)]
    np.testing.assert_allclose(np.mean(seen, axis=0), 1.0 / turns, rtol=0.35)
    new = [values_seen(rng.standard_normal(turn * turns), step, centres) for _ in range(40)]
    assert (np.mean(new, axis=0) > 0.85).all()
