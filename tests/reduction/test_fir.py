"""Filters that lines run through, against what they were designed for."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.signal import freqz
from threadpoolctl import threadpool_limits

from asperity.errors import InputError
from asperity.reduction.filter import (
    ACCURACY,
    ContactFilter,
    LineFilter,
    design_fir,
    filtered_texture,
    punch_filter,
    punch_taps,
    response,
    tap_count,
)

DX, AXES = 1e-5, np.array([1e-4, 1.5e-4])


def fitted(magnitude, normalise="tangent", k=None):
    k = np.geomspace(100.0, 3e4, 100) if k is None else k
    rows = np.clip(np.abs(magnitude(k)), 1e-3, 1.0)
    zero, every = np.zeros_like(rows), np.ones(len(rows))
    return ContactFilter(
        np.arange(len(rows)) * 1e-6, k, np.ones(k.size, bool), rows, rows, zero, rows, zero,
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
    contact_filter = fitted(lambda k: knee(k) / scale, normalise)
    found = design_fir(contact_filter, DX, least=tap_count(DX, AXES.max()))
    between = np.geomspace(100.0, 3e4, 1999)
    wanted = 20 * np.log10(np.abs(knee(between) / scale))
    got = 20 * np.log10(magnitude_at(found.taps, between))
    counted = wanted > -30.0
    assert (~counted).any()
    assert np.abs(got - wanted)[counted].max() < ACCURACY + 0.1  # the fit is known at some wavenumbers only
    assert found.miss <= ACCURACY
    assert_allclose(found.applied, magnitude_at(found.taps, contact_filter.wavenumber), rtol=1e-6, atol=1e-9)


def test_order_grows_no_further_than_it_must_or_may():
    contact_filter = fitted(knee)
    found = design_fir(contact_filter, DX)
    order = found.taps.shape[1] - 1
    shorter = design_fir(contact_filter, DX, most=order // 2)
    assert shorter.taps.shape[1] - 1 == 2 * (order // 4)
    assert shorter.miss > ACCURACY
    assert design_fir(contact_filter, DX, least=2 * order).taps.shape[1] == 2 * order + 1


def test_taps_have_the_same_digits_on_any_number_of_threads():
    contact_filter = fitted(knee)
    taps = []
    for threads in (1, 2):
        with threadpool_limits(limits=threads, user_api="blas"):
            taps.append(design_fir(contact_filter, DX, least=600, most=600).taps)
    np.testing.assert_array_equal(*taps)


def test_lobes_of_a_uniform_texture_are_applied():
    found = design_fir(fitted(lambda k: punch_filter(k[None], AXES[:, None])), DX)
    q = 2 * np.pi * found.contact_filter.wavenumber * AXES[:, None]
    clear = (np.abs(np.sin(q) / q) > 0.05) & (np.abs(np.sin(q)) > 0.3)
    assert_allclose(found.applied[clear], np.abs(np.sin(q) / q)[clear], rtol=0.05)


def test_order_as_given_is_a_design_by_window():
    contact_filter = fitted(knee)
    taps = design_fir(contact_filter, DX, 200).taps
    assert taps.shape == (2, 201)
    assert_allclose(taps, taps[:, ::-1], atol=1e-15)
    k = contact_filter.wavenumber
    assert_allclose(magnitude_at(taps, k), knee(k), atol=0.05)
    too_short = design_fir(contact_filter, DX, 20)
    assert too_short.miss > 3.0


@pytest.mark.parametrize("order", [None, 60])
def test_printed_taps_sum_to_one(order):
    contact_filter = fitted(lambda k: knee(k) / 0.78, "low-wavenumber")
    taps = design_fir(contact_filter, DX, order).taps
    assert_allclose(taps.sum(axis=1), 1.0, rtol=1e-12)


@pytest.mark.parametrize("order", [None, 400])
def test_output_has_the_designed_amplitude_and_no_delay(order):
    found = design_fir(fitted(knee), DX, order)
    k = found.contact_filter.wavenumber[40]
    x = np.arange(6000) * DX
    texture = filtered_texture(np.cos(2 * np.pi * k * x), DX, found.taps, found.contact_filter.approaches)
    inner = slice(found.taps.shape[1], -found.taps.shape[1])
    for h, magnitude in zip(texture.heights, knee(np.array([k]))[:, 0], strict=True):
        expected = -magnitude * np.cos(2 * np.pi * k * x)  # h = −z
        assert_allclose(h[inner], expected[inner], atol=0.02)


def test_response_is_real_and_signed():
    taps = punch_taps(AXES, DX)
    assert_allclose(taps.sum(axis=1), 1.0, rtol=1e-12)
    k = np.linspace(0.0, 6e3, 200)
    assert_allclose(response(taps, DX, k), punch_filter(k, AXES[:, None]), atol=0.004)
    assert response(taps, DX, k).min() < -0.2


def test_miss_counts_where_the_fit_is_above_30_dB():
    contact_filter = fitted(lambda k: 10 ** (-np.minimum(k / 1e3, 60.0) / 20) * np.ones((1, k.size)))
    flat = LineFilter(contact_filter, np.ones((1, 1)), DX)
    assert flat.miss == pytest.approx(30.0, abs=0.5)


def test_tap_count_covers_four_semi_axes_and_is_even():
    assert tap_count(1e-5, 1e-4) == 40
    assert tap_count(1e-5, 1.01e-4) == 42


@pytest.mark.parametrize("order", [41, 0])
def test_odd_orders_are_refused(order):
    with pytest.raises(InputError, match="an even number"):
        design_fir(fitted(knee), DX, order)
