"""Filters that lines run through, against what they were designed for."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.signal import freqz
from threadpoolctl import threadpool_limits

from asperity.reduction import filter
from asperity.reduction.filter import ACCURACY, design_fir

DX, AXES = 1e-5, np.array([1e-4, 1.5e-4])
K = np.geomspace(100.0, 3e4, 100)


def fitted(rows, normalise="tangent"):
    rows = np.clip(np.abs(rows), 1e-3, 1.0)
    zero, every = np.zeros_like(rows), np.ones(len(rows))
    return filter.ContactFilter(
        np.arange(len(rows)) * 1e-6, K, np.ones(K.size, bool), rows, rows, zero, rows, zero,
        every, every, every, normalise,
    )  # fmt: skip


def knee(k):
    """A filter of a fine texture: most of its fall within two octaves, then lobes."""
    q = 2 * np.pi * k * AXES[:, None]
    return 0.6 / np.sqrt(1 + (q / 2.2) ** 4) * (1 + 0.3 * np.cos(2 * q))


def magnitude_at(taps, k):
    return np.array([np.abs(freqz(b, worN=2 * np.pi * k * DX)[1]) for b in taps])


@pytest.mark.parametrize("normalise", ["tangent", "low-wavenumber"])
def test_chosen_order_meets_the_fit_within_0_3_dB_down_to_30_dB(normalise):
    scale = 1.0 if normalise == "tangent" else knee(np.array([1e-3]))
    found = design_fir(fitted(knee(K) / scale, normalise), DX, least=filter.tap_count(DX, AXES.max()))
    between = np.geomspace(100.0, 3e4, 1999)
    wanted = 20 * np.log10(np.abs(knee(between) / scale))
    got = 20 * np.log10(magnitude_at(found.taps, between))
    counted = wanted > -30.0
    assert (~counted).any()
    assert np.abs(got - wanted)[counted].max() < ACCURACY + 0.1  # the fit is known at some wavenumbers only
    assert found.miss <= ACCURACY
    assert_allclose(found.applied, magnitude_at(found.taps, K), rtol=1e-6, atol=1e-9)
    assert normalise == "tangent" or found.taps.sum(axis=1) == pytest.approx(1.0, rel=1e-12)


def test_order_grows_no_further_than_it_must_or_may():
    contact_filter = fitted(knee(K))
    order = design_fir(contact_filter, DX).taps.shape[1] - 1
    shorter = design_fir(contact_filter, DX, most=order // 2)
    assert shorter.taps.shape[1] - 1 == 2 * (order // 4)
    assert shorter.miss > ACCURACY
    assert design_fir(contact_filter, DX, least=2 * order).taps.shape[1] == 2 * order + 1


def test_taps_have_the_same_digits_on_any_number_of_threads():
    taps = []
    for threads in (1, 2):
        with threadpool_limits(limits=threads, user_api="blas"):
            taps.append(design_fir(fitted(knee(K)), DX, least=600, most=600).taps)
    np.testing.assert_array_equal(*taps)


def test_order_as_given_is_a_design_by_window():
    taps = design_fir(fitted(knee(K)), DX, 200).taps
    assert taps.shape == (2, 201)
    assert_allclose(taps, taps[:, ::-1], atol=1e-15)
    assert_allclose(magnitude_at(taps, K), knee(K), atol=0.05)
    assert design_fir(fitted(knee(K)), DX, 20).miss > 3.0
    printed = design_fir(fitted(knee(K) / 0.78, "low-wavenumber"), DX, 60).taps
    assert_allclose(printed.sum(axis=1), 1.0, rtol=1e-12)


@pytest.mark.parametrize("order", [None, 400])
def test_output_has_the_designed_amplitude_and_no_delay(order):
    found = design_fir(fitted(knee(K)), DX, order)
    x, states = np.arange(6000) * DX, found.contact_filter.approaches
    wave = np.cos(2 * np.pi * K[40] * x)
    texture = filter.filtered_texture(wave, DX, found.taps, states)
    inner = slice(found.taps.shape[1], -found.taps.shape[1])
    expected = -knee(K[40:41]) * wave  # h = −z
    assert_allclose(texture.heights[:, inner], expected[:, inner], atol=0.02)


def test_response_is_real_and_signed():
    taps, k = filter.punch_taps(AXES, DX), np.linspace(0.0, 6e3, 200)
    assert_allclose(taps.sum(axis=1), 1.0, rtol=1e-12)
    assert_allclose(filter.response(taps, DX, k), filter.punch_filter(k, AXES[:, None]), atol=0.004)
    assert filter.response(taps, DX, k).min() < -0.2
    assert [filter.tap_count(1e-5, a) for a in (1e-4, 1.01e-4)] == [40, 42]


def test_miss_counts_where_the_fit_is_above_30_dB():
    contact_filter = fitted(10 ** (-np.minimum(K / 1e3, 60.0) / 20) * np.ones((1, K.size)))
    assert filter.LineFilter(contact_filter, np.ones((1, 1)), DX).miss == pytest.approx(30.0, abs=0.5)
