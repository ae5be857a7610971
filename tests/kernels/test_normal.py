"""Normal deviates of random words: those of NumPy's generators, and boxes that cover the bell."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from asperity.kernels import normal
from asperity.surfaces.tiles import deviates, random_of


@pytest.mark.parametrize("count", [*range(1, 12), 2047, 2048, 2049, 200_000])
def test_deviates_are_those_of_numpy_whatever_their_number(count: int) -> None:
    for seed in range(3):
        expected = random_of(seed, 4, -1, 7).standard_normal(2 * count)
        assert_allclose(deviates(seed, (count,), 4, -1, 7).view(np.float64), expected, rtol=1e-12, atol=0.0)


def test_some_of_the_deviates_are_of_the_tail_on_either_side() -> None:
    found = deviates(0, (200_000,)).view(np.float64)
    assert found.min() < -normal.TAIL < normal.TAIL < found.max()


def test_boxes_under_the_bell_have_one_area_and_meet_its_top() -> None:
    width, below, height = normal.boxes()
    right = width * normal.PLACES
    area = right[1:] * -np.diff(height, prepend=1.0)[1:]
    tail = math.sqrt(0.5 * math.pi) * math.erfc(normal.TAIL / math.sqrt(2.0))
    assert_allclose(area, normal.TAIL * height[-1] + tail, rtol=1e-12)
    assert_allclose(below[1:] / normal.PLACES, [0.0, *(right[1:-1] / right[2:])], rtol=1e-12)
    assert_allclose(below[0] / normal.PLACES, normal.TAIL / right[0], rtol=1e-12)
