"""What tests of rolling share: rough paths, and differences relative to the largest value."""

import numpy as np
from numpy.testing import assert_allclose

from asperity.reduction.texture import StateTexture
from asperity.structures.body import Body


def rough(rms, spacing, start, points=4000, seed=2):
    """A texture of waves longer than thirty points."""
    steps = np.random.default_rng(seed).standard_normal(points)
    heights = np.convolve(steps, np.hanning(30), mode="same")
    return StateTexture.unfiltered(rms * heights / heights.std(), spacing, start)


def same(found, expected, rel=1e-9):
    assert_allclose(found, expected, rtol=0.0, atol=rel * np.abs(expected).max())


def rigid_bar(mass, inertia, places, load):
    """A rigid body that heaves and pitches about the middle of its contacts, and presses with a load."""
    places, none = np.asarray(places, dtype=float), np.zeros((2, 2))
    lever = np.stack([np.ones_like(places), places - places.mean()], axis=1)
    return Body(np.diag([mass, inertia]), none, none, lever, np.array([load, 0.0]), places)
