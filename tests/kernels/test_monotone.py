"""Cubic pieces that turn only where the data do."""

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from asperity.kernels.piecewise import shape_preserving


@pytest.mark.parametrize("count", [3, 4, 10, 60])
def test_pieces_of_any_shape_are_those_of_scipy(count):
    rng = np.random.default_rng(count)
    knots, rows = np.sort(rng.normal(size=count)), rng.normal(size=(6, count))
    rows[0].sort()
    rows[1], rows[2, :], rows[3, 1] = -rows[0], 1.0, rows[3, 0]
    places = np.concatenate([knots, rng.uniform(knots[0], knots[-1], 500)])
    expected = PchipInterpolator(knots, rows, axis=1)(places)
    np.testing.assert_allclose(shape_preserving(knots, rows, places), expected, atol=1e-13)


def test_pieces_stay_between_their_knots():
    rng = np.random.default_rng(1)
    knots, rows = np.arange(20.0), rng.normal(size=(50, 20))
    places = np.linspace(0.0, 19.0, 1901)
    found, piece = shape_preserving(knots, rows, places), np.minimum(places.astype(int), 18)
    low, high = np.minimum(rows[:, :-1], rows[:, 1:]), np.maximum(rows[:, :-1], rows[:, 1:])
    assert (found >= low[:, piece] - 1e-12).all()
    assert (found <= high[:, piece] + 1e-12).all()
