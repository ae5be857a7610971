"""Natural splines along a path against another program's and against their own conditions."""

import numpy as np
from scipy.interpolate import CubicSpline

from asperity.kernels.along import splines_along


def test_it_is_the_natural_spline():
    values = np.random.default_rng(2).normal(size=(30, 5))
    index = np.concatenate([np.linspace(0.0, 29.0, 200), np.arange(30.0)])
    found = splines_along(np.ascontiguousarray(values.T), index)
    expected = CubicSpline(np.arange(30.0), values, bc_type="natural")(index)
    np.testing.assert_allclose(found, expected, atol=1e-13)


def test_straight_lines_are_kept_to_the_ends_and_two_points_are_enough():
    values = np.array([[1.0, 3.0]])
    found = splines_along(values, np.array([0.0, 0.25, 1.0]))
    np.testing.assert_allclose(found[:, 0], [1.0, 1.5, 3.0], rtol=1e-15)


def test_blocks_leave_no_trace_and_places_may_come_in_any_order():
    random = np.random.default_rng(3)
    values, index = random.normal(size=(3, 2000)), random.uniform(0.0, 1999.0, 500)
    expected = CubicSpline(np.arange(2000.0), values.T, bc_type="natural")
    np.testing.assert_allclose(splines_along(values, index), expected(index), atol=1e-12)
    rising = np.sort(index)
    np.testing.assert_allclose(splines_along(values, rising), expected(rising), atol=1e-12)
