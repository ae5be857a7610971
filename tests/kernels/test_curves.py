"""Splines along a path and cubic pieces of any shape, against another program's."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline, PchipInterpolator

from asperity.kernels.along import splines_along
from asperity.kernels.piecewise import shape_preserving


@pytest.mark.parametrize("points", [2, 30, 2000])
def test_splines_are_natural_in_blocks_at_places_in_any_order(points):
    random = np.random.default_rng(3)
    values, index = random.normal(size=(3, points)), random.uniform(0.0, points - 1.0, 500)
    index[:2] = 0.0, points - 1.0
    expected = CubicSpline(np.arange(points), values.T, bc_type="natural")
    for places in (index, np.sort(index), np.sort(index)[::-1]):
        np.testing.assert_allclose(splines_along(values, places), expected(places), atol=1e-12)


@pytest.mark.parametrize("count", [3, 4, 10, 60])
def test_pieces_of_any_shape_are_those_of_scipy(count):
    rng = np.random.default_rng(count)
    knots, rows = np.sort(rng.normal(size=count)), rng.normal(size=(6, count))
    rows[0].sort()
    rows[1], rows[2, :], rows[3, 1] = -rows[0], 1.0, rows[3, 0]
    places = np.concatenate([knots, rng.uniform(knots[0], knots[-1], 500)])
    expected = PchipInterpolator(knots, rows, axis=1)(places)
    np.testing.assert_allclose(shape_preserving(knots, rows, places), expected, atol=1e-13)
