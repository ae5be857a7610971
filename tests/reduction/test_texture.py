"""Textures by state: areal ones against their closed form, lines along a path, convolution by pieces."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from asperity.errors import InputError
from asperity.reduction.texture import LongConvolution, StateTexture, areal_texture, punch_weights
from asperity.surfaces.strip import Fields, Rows
from asperity.surfaces.synthesis import long_strip_from_bands
from refusals import refusals


@pytest.mark.parametrize("axes", [(40e-6, 40e-6), (60e-6, 25e-6), (3e-6, 90e-6), (1e-6, 1e-6)])
def test_weights_sum_to_one_and_are_symmetric(axes):
    w = punch_weights((5e-6, 4e-6), axes)
    assert w.sum() == pytest.approx(1.0, rel=1e-12)
    assert_allclose(w, w[::-1, ::-1], rtol=1e-9, atol=1e-15)
    assert w.min() >= 0.0
    assert w.shape[0] * 5e-6 >= 2 * axes[0]


def test_weight_grows_towards_the_edge_like_a_punch():
    w = punch_weights((1.0, 1.0), (50.0, 50.0))
    along = w[w.shape[0] // 2 :, w.shape[1] // 2][[0, 40]] * 2 * np.pi * 50.0 * 50.0
    assert_allclose(along, [1.0, 1.0 / np.sqrt(1.0 - 0.8**2)], rtol=1e-2)


@pytest.mark.parametrize("direction", [0.0, 0.5, 1.2])
@pytest.mark.parametrize("q", [0.0, 1.0, 2.0, 3.0, 4.0, 5.0])
def test_plane_wave_is_scaled_by_sin_q_over_q(q, direction):
    dx, dy, a, b = 2e-6, 2e-6, 60e-6, 40e-6
    kx, ky = q * np.cos(direction) / a, q * np.sin(direction) / b
    x, y = np.arange(801) * dx, (np.arange(61) - 30) * dy
    wave = np.cos(kx * x[:, None] + ky * y[None, :])
    texture = areal_texture(wave, (dx, dy), [0.0, 1e-6], [(a, b), (0.5 * a, 0.5 * b)])
    inner = slice(100, -100)
    for heights, qs in zip(texture.heights, (q, 0.5 * q), strict=True):
        expected = -np.sinc(qs / np.pi) * np.cos(kx * x)  # heights enter h with a minus
        assert_allclose(heights[inner], expected[inner], atol=4e-3)


@pytest.mark.parametrize(("length", "piece"), [(500, 64), (500, 500), (41, 7), (40, 16384)])
def test_convolution_by_pieces_is_that_of_the_whole(length, piece):
    random = np.random.default_rng(3)
    rows, weights = random.normal(size=(3, length)), random.normal(size=(2, 3, 40))
    expected = [
        sum(np.convolve(row, weight, mode="valid") for row, weight in zip(rows, each, strict=True))
        for each in weights
    ]
    assert_allclose(LongConvolution(weights, piece).of(rows), expected, atol=1e-12)


def test_texture_interpolates_a_sine_to_fourth_order():
    errors = []
    for points in (100, 200):
        x = np.linspace(0.0, 1e-3, points + 1)
        heights = 1e-6 * np.stack([np.sin(2 * np.pi * x / 1e-4), np.cos(2 * np.pi * x / 1e-4)])
        texture = StateTexture(heights, [0.0, 1e-6], 0.0, x[1])
        where = np.linspace(2e-4, 8e-4, 777)
        errors.append(np.abs(texture.at(where)[:, 1] - 1e-6 * np.cos(2 * np.pi * where / 1e-4)).max())
    assert 3.7 < np.log2(errors[0] / errors[1]) < 4.4


def test_unfiltered_texture_has_one_state_and_is_known_on_its_path_alone():
    texture = StateTexture.unfiltered([0.0, 1.0, 2.0, 3.0], spacing=0.5, start=10.0)
    assert_allclose(texture.at([10.0, 10.75, 11.5])[:, 0], [0.0, 1.5, 3.0], atol=1e-12)
    for beyond in (9.9, 11.6):
        with pytest.raises(InputError, match=r"10 to 11.5, where the state texture is known.*longer texture"):
            texture.at([10.0, beyond])


def test_of_what_is_alike_all_across_one_line_is_averaged_and_no_other():
    """As strips are, of which nobody knows whether they are."""
    random = np.random.default_rng(1)
    alike = np.repeat(random.normal(size=(300, 1)), 31, axis=1)
    begins_alike = np.vstack([alike[:1], random.normal(size=(299, 31))])
    given_ = (2e-6, 3e-6), [0.0, 1e-6], [(60e-6, 40e-6), (30e-6, 20e-6)]
    for heights in (alike, begins_alike, np.zeros((300, 31))):
        found, expected = (areal_texture(each, *given_).heights for each in (heights, Rows(heights)))
        assert_allclose(found, expected, atol=1e-13)


def test_any_number_of_threads_averages_a_drawn_strip_to_the_same_digits(monkeypatch):
    monkeypatch.setattr("asperity.reduction.texture.PIECE", 300)
    monkeypatch.setattr("asperity.surfaces.strip.PIECE", 250)
    found = []
    for threads in ("1", "2", "5"):
        monkeypatch.setenv("ASPERITY_THREADS", threads)
        monkeypatch.setattr("asperity.surfaces.strip.pieces", Fields())
        monkeypatch.setattr("asperity.surfaces.strip.tiles", Fields(fewest=24))
        drawn = long_strip_from_bands(
            (3000, 15), (2e-3, 2e-3), [0.1, 0.05, 0.025], [10.0, 5.0, 0.0], seed=2, before=70
        )
        texture = areal_texture(drawn, drawn.spacing, [0.0, 1e-6], [(12e-3, 9e-3), (5e-3, 7e-3)])
        found.append(texture.heights.tobytes())
    assert found[1:] == found[:1] * 2


def strip(rows, columns, *axes):
    areal_texture(np.zeros((rows, columns)), (1.0, 1.0), [0.0], [axes])


test_messages = refusals(
    (strip, (50, 9, 5.0, 5.0), "widest patch, 10 m.*Enlarge contact.window"),
    of=lambda make, arguments: make(*arguments),
)


def test_states_are_left_out_where_straight_lines_between_the_others_miss_nothing():
    """Of h = s² + s between states s the steps allowed are 2 √(2 · miss) wide, of a straight one any."""
    states = np.linspace(0.0, 1.0, 201)
    positions = np.arange(9.0)
    shape = np.cos(positions)
    bowed = StateTexture(np.outer(states**2, shape) + np.outer(states, np.sin(positions)), states, 0.0, 1.0)
    share = 1e-4
    found = bowed.with_fewer_states(share)
    allowed = share * np.abs(bowed.heights).max()
    between = np.array([np.interp(states, found.approaches, each) for each in found.heights.T]).T
    assert np.abs(between - bowed.heights).max() <= allowed
    widest = 2.0 * np.sqrt(allowed)  # a parabola lies d²/4 beside its chord
    assert np.diff(found.approaches)[:-1] == pytest.approx(widest, abs=0.011)
    straight = StateTexture(np.outer(1.0 + states, shape), states, 0.0, 1.0).with_fewer_states(1e-9)
    np.testing.assert_array_equal(straight.approaches, [0.0, 1.0])
    np.testing.assert_array_equal(straight.heights, np.outer([1.0, 2.0], shape))
    assert bowed.with_fewer_states(2.0).heights.shape == (1, 9)
