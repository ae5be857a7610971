"""The areal texture against its closed-form transform."""

import numpy as np
import pytest

from asperity.errors import InputError
from asperity.reduction.texture import areal_texture, punch_weights


@pytest.mark.parametrize("axes", [(40e-6, 40e-6), (60e-6, 25e-6), (3e-6, 90e-6), (1e-6, 1e-6)])
def test_weights_sum_to_one_and_are_symmetric(axes):
    w = punch_weights((5e-6, 4e-6), axes)
    assert w.sum() == pytest.approx(1.0, rel=1e-12)
    np.testing.assert_allclose(w, w[::-1, ::-1], rtol=1e-9, atol=1e-15)
    assert w.min() >= 0.0
    assert w.shape[0] * 5e-6 >= 2 * axes[0]


def test_weight_grows_towards_the_edge_like_a_punch():
    w = punch_weights((1.0, 1.0), (50.0, 50.0))
    middle = 1 / (2 * np.pi * 50.0 * 50.0)
    assert w[w.shape[0] // 2, w.shape[1] // 2] == pytest.approx(middle, rel=1e-3)
    off = w[w.shape[0] // 2 + 40, w.shape[1] // 2]
    assert off == pytest.approx(middle / np.sqrt(1 - 0.8**2), rel=1e-2)


@pytest.mark.parametrize("direction", [0.0, 0.5, 1.2])
@pytest.mark.parametrize("q", [1.0, 2.0, 3.0, 4.0, 5.0])
def test_plane_wave_is_scaled_by_sin_q_over_q(q, direction):
    dx, dy, a, b = 2e-6, 2e-6, 60e-6, 40e-6
    kx, ky = q * np.cos(direction) / a, q * np.sin(direction) / b
    x, y = np.arange(801) * dx, (np.arange(61) - 30) * dy
    wave = np.cos(kx * x[:, None] + ky * y[None, :])
    texture = areal_texture(wave, (dx, dy), [0.0], [(a, b)])
    inner = slice(100, -100)
    expected = -np.sin(q) / q * np.cos(kx * x)  # heights enter h with a minus
    np.testing.assert_allclose(texture.heights[0][inner], expected[inner], atol=4e-3)


def test_uniform_offset_is_kept_with_the_sign_away_from_contact():
    texture = areal_texture(np.full((200, 41), 3e-6), (5e-6, 5e-6), [0.0, 1e-6], [(30e-6,) * 2, (50e-6,) * 2])
    np.testing.assert_allclose(texture.heights[:, 60:-60], -3e-6, rtol=1e-9)


def test_bad_strips():
    with pytest.raises(InputError, match="an odd number"):
        areal_texture(np.zeros((50, 40)), (1.0, 1.0), [0.0], [(5.0, 5.0)])
    with pytest.raises(InputError, match="widest patch"):
        areal_texture(np.zeros((50, 9)), (1.0, 1.0), [0.0], [(5.0, 5.0)])
