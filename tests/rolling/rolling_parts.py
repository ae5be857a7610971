"""What tests of rolling share: rough paths, and differences relative to the largest value."""

import numpy as np
from numpy.testing import assert_allclose

from asperity.reduction.texture import StateTexture


def rough(rms, spacing, start, points=4000, seed=2):
    """A texture of waves longer than thirty points."""
    steps = np.random.default_rng(seed).standard_normal(points)
    heights = np.convolve(steps, np.hanning(30), mode="same")
    return StateTexture.unfiltered(rms * heights / heights.std(), spacing, start)


def same(found, expected, rel=1e-9):
    assert_allclose(found, expected, rtol=0.0, atol=rel * np.abs(expected).max())
