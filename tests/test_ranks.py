"""Values in rising order, part by part, as all of them are when they are sorted at once."""

import tracemalloc

import numpy as np
import pytest

from asperity.ranks import Ranked

DRAW = np.random.default_rng(3)
VALUES = {
    "normal": DRAW.normal(size=5000),
    "digits": DRAW.integers(0, 10, 5000).astype(float),
    "one value, and a few": np.where(DRAW.random(5000) < 0.002, DRAW.normal(size=5000), 2.0),
    "over many decades": 10.0 ** DRAW.uniform(-300.0, 300.0, 5000),
    "one value": np.full(5000, -3.0),
    "nearly one value": 1.0 + 1e-15 * DRAW.integers(0, 20, 5000),
    "a map with holes": np.where(DRAW.random((50, 100)) < 0.1, np.nan, DRAW.normal(size=(50, 100))).T,
}


@pytest.mark.parametrize("name", VALUES)
@pytest.mark.parametrize("together", [40, 300, 10_000])
def test_ranks_are_those_of_all_values_in_order(name, together, monkeypatch):
    monkeypatch.setattr("asperity.ranks.TOGETHER", together)
    values = VALUES[name]
    known = np.sort(values[np.isfinite(values)])
    ranked = Ranked([values[:20], values[20:]])
    assert (ranked.count, ranked.lowest, ranked.highest) == (known.size, known[0], known[-1])
    for first, last in ((0, known.size), (0, 1), (known.size - 1, known.size), (700, 900), (4000, 4001)):
        np.testing.assert_array_equal(ranked.between(first, last), known[first:last])
    shares = np.array([0.0, 0.001, 0.25, 0.5, 0.7777, 1.0])
    np.testing.assert_allclose(ranked.quantiles(shares), np.quantile(known, shares), rtol=1e-14)


@pytest.mark.parametrize("name", ["normal", "digits", "one value, and a few", "nearly one value"])
def test_what_is_ranked_is_not_held_beside_itself(name, monkeypatch):
    monkeypatch.setattr("asperity.ranks.TOGETHER", 2**10)
    values = np.tile(VALUES[name], 40)
    tracemalloc.start()
    try:
        ranked = Ranked([values])
        for rank in range(0, values.size, 2**14):
            ranked.between(rank, min(rank + 2**10, values.size))
        assert tracemalloc.get_traced_memory()[1] < 0.1 * values.nbytes
    finally:
        tracemalloc.stop()
