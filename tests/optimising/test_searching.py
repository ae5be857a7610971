"""The search, on responses that are known in closed form."""

import numpy as np
import pytest

from asperity.optimising.allocation import Limits, energy_of, rms_of
from asperity.optimising.searching import Trial, search

BANDS = 8
WEIGHT = 10.0 ** np.linspace(-2.0, 2.0, BANDS)


def limits(**more):
    start = np.zeros(BANDS)
    return Limits(start, start - 30.0, start + 30.0, np.ones(BANDS), **more)


def rolled(floor=0.0, coupling=0.0, power=1.0, best_lay=1.0):
    """A response that is a sum over bands; that leaks into the next, saturates, and depends on the lay."""
    leak = np.eye(BANDS) + coupling * (np.eye(BANDS, k=1) + np.eye(BANDS, k=-1))

    def roll(levels, lateral):
        energies = (leak @ (WEIGHT * energy_of(levels))) ** power
        energies = energies * (1.0 + np.log(lateral / best_lay) ** 2)
        return Trial(levels, lateral, energies + floor, 0.2)

    return roll


def found(roll, bounds, limit=None, lay=None):
    told = []
    trials, settled = search(roll, roll(np.zeros(BANDS), 1.0), bounds, limit, lay, told.append)
    return trials, settled, told


def test_a_sum_over_bands_takes_two_rounds():
    trials, settled, told = found(rolled(), limits(budget=40.0))
    assert settled
    assert len(told) <= 2
    heard = trials[-1].energies
    np.testing.assert_allclose(heard, heard.mean(), rtol=0.01)


def test_a_floor_under_each_band_is_told_apart_from_its_roughness():
    """Where lowering a band changes nothing any more, its price is better spent elsewhere."""
    trials, settled, _ = found(rolled(floor=3.0), limits(budget=40.0))
    assert settled
    alike = 10.0 ** (np.mean(np.log10(WEIGHT)) - 0.5)
    least = 10.0 * np.log10(0.2 + BANDS * (3.0 + alike))
    assert trials[-1].level == pytest.approx(least, abs=0.1)


@pytest.mark.parametrize("limit", [5.0, 18.0])
@pytest.mark.parametrize("coupling", [0.0, 0.1])
def test_a_limit_is_met(limit, coupling):
    trials, settled, _ = found(rolled(coupling=coupling, power=0.9), limits(), limit)
    assert settled
    assert trials[-1].level == pytest.approx(limit, abs=0.06)


def test_the_least_rms_is_kept_while_the_level_falls():
    roll = rolled(coupling=0.3)
    start = roll(np.zeros(BANDS), 1.0)
    trials, settled, _ = found(roll, limits(rms_at_least=rms_of(start.levels)))
    assert settled
    assert trials[-1].level < start.level - 3.0
    assert rms_of(trials[-1].levels) >= rms_of(start.levels) * (1 - 1e-6)


def test_the_lay_is_found_between_its_bounds():
    trials, _, told = found(rolled(best_lay=1.6), limits(budget=40.0), lay=(0.5, 3.0))
    assert trials[-1].lateral == pytest.approx(1.6, rel=0.06)
    assert any("lay" in word for word in told)
    trials, _, _ = found(rolled(best_lay=9.0), limits(budget=40.0), lay=(0.5, 3.0))
    assert trials[-1].lateral == pytest.approx(3.0)


def test_a_search_that_does_not_settle_says_so():
    random = np.random.default_rng(1)

    def erratic(levels, lateral):
        return Trial(levels, lateral, WEIGHT * energy_of(levels) * 10.0 ** random.uniform(-0.5, 0.5), 0.0)

    trials, settled, _ = found(erratic, limits(), limit=5.0)
    assert not settled
    missed = [abs(trial.level - 5.0) for trial in trials[1:]]
    assert missed[-1] == min(missed)  # and the best that was met is the last
