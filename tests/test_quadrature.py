"""Gauss's rule against integrals in closed form."""

import numpy as np
import pytest

from asperity.quadrature import gauss


@pytest.mark.parametrize(("begin", "end"), [(0.0, 1.0), (-2.0, 0.5), (3.0, 7.0)])
def test_polynomials_up_to_twice_the_places_less_one_are_exact(begin, end):
    places, weights = gauss(4, begin, end)
    assert begin < places.min() < places.max() < end
    for power in range(8):
        whole = (end ** (power + 1) - begin ** (power + 1)) / (power + 1)
        assert np.sum(weights * places**power) == pytest.approx(whole, rel=1e-12)
    beyond = (end**9 - begin**9) / 9.0
    assert abs(np.sum(weights * places**8) - beyond) > 1e-6 * abs(beyond)
