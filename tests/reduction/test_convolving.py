"""Convolution by pieces against scipy's."""

import numpy as np
import pytest
from scipy import signal

from asperity.reduction.texture import LongConvolution


@pytest.mark.parametrize(("length", "piece"), [(500, 64), (500, 500), (41, 7), (40, 16384)])
def test_pieces_are_those_of_the_whole(length, piece):
    random = np.random.default_rng(3)
    rows, weights = random.normal(size=(3, length)), random.normal(size=(2, 3, 40))
    expected = [
        sum(np.convolve(row, weight, mode="valid") for row, weight in zip(rows, each, strict=True))
        for each in weights
    ]
    np.testing.assert_allclose(LongConvolution(weights, piece).of(rows), expected, atol=1e-12)


def test_long_rows_agree_with_scipy():
    random = np.random.default_rng(4)
    row, weight = random.normal(size=50_000), random.normal(size=81)
    expected = signal.oaconvolve(row, weight, mode="valid")
    np.testing.assert_allclose(LongConvolution(weight[None, None]).of(row[None])[0], expected, atol=1e-11)
