"""Roughness shared out over wavelengths, and the search for it: closed forms and linear programming."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from asperity.optimising import allocation

BANDS = 8
WEIGHT = 10.0 ** np.linspace(-2.0, 2.0, BANDS)


def limits(n=BANDS, reach=30.0, price=1.0, **more):
    start = np.zeros(n)
    return allocation.Limits(
        start, start - reach, start + reach, np.broadcast_to(price, n).astype(float), **more
    )


weights = st.lists(st.floats(-4.0, 4.0), min_size=3, max_size=12).map(lambda x: 10.0 ** np.array(x))


@pytest.mark.parametrize("share", [0.0, 1.0])
@pytest.mark.parametrize("seed", range(20))
def test_rms_heights_at_the_ends_of_what_bands_may_have_are_met(seed, share):
    """All bands then lie on their bounds, whatever prices and weights are."""
    random = np.random.default_rng(seed)
    start = random.normal(0.0, 10.0, 6)
    lowest = start - random.uniform(0.0, 15.0, 6)
    highest = start + random.uniform(0.0, 15.0, 6)
    wanted = highest if share else lowest
    name = "rms_at_least" if share else "rms_at_most"
    more = {name: allocation.rms_of(wanted)}
    price = random.uniform(0.0, 2.0, 6) * (random.random(6) > 0.3)
    bounds = allocation.Limits(start, lowest, highest, price, **more)
    response = allocation.Response(random.uniform(0.0, 1.0, 6), 0.0)
    np.testing.assert_allclose(allocation.quietest(response, bounds), wanted, atol=1e-3)


@given(weights, st.integers(0, 2**32 - 1))
@settings(max_examples=30)
def test_a_limit_gives_each_band_its_share_by_price(weight, seed):
    """Closed form of the inverse: weight 10^(L/10) = price (E − floor)/Σ price."""
    price = np.random.default_rng(seed).uniform(0.2, 5.0, len(weight))
    response = allocation.Response(weight, floor=0.3)
    level = 10.0 * np.log10(0.3 + 7.0)
    found = allocation.roughest(response, limits(len(weight), 100.0, price), level)
    np.testing.assert_allclose(response.energies(found), price / price.sum() * 7.0, rtol=2e-3)
    assert response.level(found) == pytest.approx(level, abs=1e-6)


@given(weights)
@settings(max_examples=30)
def test_a_budget_buys_silence_where_all_bands_are_heard_alike(weight):
    """Closed form: the geometric mean of all energies is fixed, the sum least where they are equal."""
    n = len(weight)
    response = allocation.Response(weight, floor=0.0)
    found = allocation.quietest(response, limits(n, 100.0, budget=6.0 * n))
    alike = np.exp(np.mean(np.log(weight))) * 10.0**-0.6
    np.testing.assert_allclose(response.energies(found), alike, rtol=2e-3)


@given(weights, st.floats(0.2, 0.9))
@settings(max_examples=30)
def test_a_least_rms_is_borne_where_it_is_heard_least(weight, share):
    """A linear programme in the energies: the solver of another library has the same level."""
    n = len(weight)
    bounds = limits(n, 10.0, rms_at_least=1e-6 * np.sqrt(share * n * 10.0))
    response = allocation.Response(weight, floor=0.0)
    found = allocation.quietest(response, bounds)
    box = list(zip(allocation.energy_of(bounds.lowest), allocation.energy_of(bounds.highest), strict=True))
    exact = linprog(weight, A_ub=[-np.ones(n)], b_ub=[-share * n * 10.0], bounds=box)
    assert exact.success
    assert response.level(found) == pytest.approx(10.0 * np.log10(exact.fun), abs=0.01)
    assert allocation.rms_of(found) >= bounds.rms_at_least * (1 - 1e-6)


def test_a_band_at_its_bound_leaves_the_rest_to_the_others():
    bounds = limits(3, 100.0, rms_at_most=2e-6)
    bounds = allocation.Limits(bounds.start, bounds.lowest, np.array([-10.0, 100.0, 100.0]), bounds.price)
    response = allocation.Response(np.ones(3), floor=0.0)
    found = allocation.roughest(response, bounds, 0.0)
    np.testing.assert_allclose(response.energies(found), [0.1, 0.45, 0.45], rtol=1e-3)


def test_the_largest_rms_is_kept():
    response = allocation.Response(np.array([1.0, 1e-3, 1e-6]), floor=0.0)
    found = allocation.roughest(response, limits(3, 30.0, rms_at_most=3e-6), 0.0)
    assert allocation.rms_of(found) == pytest.approx(3e-6, rel=1e-6)


# --- the search, on responses that are known in closed form


def rolled(floor=0.0, coupling=0.0, power=1.0, best_lay=1.0):
    """A response that is a sum over bands; that leaks into the next, saturates, and depends on the lay."""
    leak = np.eye(BANDS) + coupling * (np.eye(BANDS, k=1) + np.eye(BANDS, k=-1))

    def roll(levels, lateral):
        energies = (leak @ (WEIGHT * allocation.energy_of(levels))) ** power
        energies = energies * (1.0 + np.log(lateral / best_lay) ** 2)
        return allocation.Trial(levels, lateral, energies + floor, 0.2)

    return roll


def found(roll, bounds, limit=None, lay=None):
    told = []
    trials, settled = allocation.search(roll, roll(np.zeros(BANDS), 1.0), bounds, limit, lay, told.append)
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
    trials, settled, _ = found(roll, limits(rms_at_least=allocation.rms_of(start.levels)))
    assert settled
    assert trials[-1].level < start.level - 3.0
    assert allocation.rms_of(trials[-1].levels) >= allocation.rms_of(start.levels) * (1 - 1e-6)


def test_the_lay_is_found_between_its_bounds():
    trials, _, told = found(rolled(best_lay=1.6), limits(budget=40.0), lay=(0.5, 3.0))
    assert trials[-1].lateral == pytest.approx(1.6, rel=0.06)
    assert any("lay" in word for word in told)
    trials, _, _ = found(rolled(best_lay=9.0), limits(budget=40.0), lay=(0.5, 3.0))
    assert trials[-1].lateral == pytest.approx(3.0)


def test_a_search_that_does_not_settle_says_so():
    random = np.random.default_rng(1)

    def erratic(levels, lateral):
        return allocation.Trial(
            levels, lateral, WEIGHT * allocation.energy_of(levels) * 10.0 ** random.uniform(-0.5, 0.5), 0.0
        )

    trials, settled, _ = found(erratic, limits(), limit=5.0)
    assert not settled
    missed = [abs(trial.level - 5.0) for trial in trials[1:]]
    assert missed[-1] == min(missed)  # and the best that was met is the last


@pytest.mark.parametrize(("lay", "best"), [((2.0, 8.0), 2.0), ((0.5, 8.0), 1.0)])
def test_a_lay_that_may_not_be_is_not_taken_however_quiet(lay, best):
    """A response that rises with the lay from that of the case on, 1, which the bounds hold or do not."""

    def roll(levels, lateral):
        return allocation.Trial(levels, lateral, np.array([max(lateral, 1.0 / lateral)]), 0.0)

    best_of = allocation._best_lay(roll, roll(np.zeros(1), 1.0), lay, lambda words: None)
    assert best_of.lateral == pytest.approx(best)
