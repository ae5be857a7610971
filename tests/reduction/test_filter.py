"""The contact filter against sin q/q, and the FIR filters against what they were designed for."""

import numpy as np
import pytest
from scipy.signal import freqz

from asperity.contact import Hertz
from asperity.errors import InputError
from asperity.reduction.filter import (
    FLOOR,
    ContactFilter,
    design_fir,
    estimate_filter,
    filtered_texture,
    mean_filter,
    punch_filter,
    tap_count,
)
from asperity.reduction.scan import scan_forces

MODULUS, RADIUS = 115e9, 25e-3


@pytest.mark.parametrize(("q", "tolerance"), [(1.0, 0.01), (2.0, 0.01), (3.0, 0.02), (4.0, 0.02)])
def test_ball_on_a_sinusoid(q, tolerance):
    """The whole chain: 3-D scan, spectra, tangent stiffness; sign included."""
    delta = 0.35e-6
    hertz = Hertz(MODULUS, RADIUS, RADIUS)
    a = hertz.semi_axes(delta)[0]
    cells, periods = 25, 6
    positions_per_period = round(2 * np.pi / q * cells)
    dx = 2 * np.pi * a / q / positions_per_period
    nx = 2 * int(1.3 * a / dx) + 1
    x = (np.arange(nx) - nx // 2) * dx
    body = (x[:, None] ** 2 + x[None, :] ** 2) / (2 * RADIUS)
    n = periods * positions_per_period
    stride = max(1, positions_per_period // 16)
    path = np.arange(n + nx) * dx
    heights = 0.02 * delta * np.cos(2 * np.pi * path / (positions_per_period * dx))
    surface = np.repeat(heights[:, None], nx, axis=1)
    forces = scan_forces(surface, (dx, dx), body, MODULUS, [delta], stride=stride).forces
    line = heights[nx // 2 :: stride][: forces.shape[1]]
    estimate = estimate_filter(
        forces, line[None], stride * dx, tangent_stiffness=hertz.tangent_stiffness(delta)
    )
    i = int(np.argmin(np.abs(estimate.wavenumber - q / (2 * np.pi * a))))
    assert estimate.signed[0, i] == pytest.approx(np.sin(q) / q, abs=tolerance)
    assert estimate.magnitude[0, i] == pytest.approx(abs(np.sin(q) / q), abs=tolerance)
    assert punch_filter(q / (2 * np.pi * a), a) == pytest.approx(np.sin(q) / q, rel=1e-12)


def synthetic(order=0.0, m=4096, dx=1e-5, seed=0, k0=5e6):
    """Forces of a known filter exp(−(k λ0)²) applied to a random line."""
    rng = np.random.default_rng(seed)
    z = rng.standard_normal(m) * 1e-7
    k = np.fft.rfftfreq(m, dx)
    h = np.exp(-((k * 8e-5) ** 2))
    forces = k0 * np.fft.irfft(np.fft.rfft(z) * h, m) + 30.0
    return forces[None], z[None], dx, lambda k: np.exp(-((k * 8e-5) ** 2))


def test_known_filter_is_found_under_both_normalisations():
    forces, lines, dx, h = synthetic()
    tangent = estimate_filter(forces, lines, dx, tangent_stiffness=5e6)
    printed = estimate_filter(forces, lines, dx, asymptote=1e3)
    band = (tangent.wavenumber > 1e3) & (tangent.wavenumber < 1.5e4)
    expected = h(tangent.wavenumber)
    np.testing.assert_allclose(tangent.magnitude[0, band], expected[band], rtol=0.05)
    np.testing.assert_allclose(tangent.signed[0, band], expected[band], rtol=0.05)
    assert printed.stiffness[0] == pytest.approx(5e6, rel=0.02)


def test_half_the_force_halves_only_the_tangent_normalisation():
    forces, lines, dx, h = synthetic()
    tangent = estimate_filter(0.5 * forces, lines, dx, tangent_stiffness=5e6)
    printed = estimate_filter(0.5 * forces, lines, dx, asymptote=1e3)
    i = 30
    assert tangent.magnitude[0, i] == pytest.approx(0.5 * h(tangent.wavenumber[i]), rel=0.05)
    assert printed.magnitude[0, i] == pytest.approx(h(printed.wavenumber[i]), rel=0.05)


def test_mean_filter_fits_and_averages():
    estimates = [estimate_filter(*synthetic(seed=s)[:3], asymptote=1e3) for s in range(4)]
    h = synthetic()[3]
    result = mean_filter(estimates, [1e-6])
    k = result.wavenumber
    band = k < 2e4
    np.testing.assert_allclose(result.magnitude[0, band], h(k[band]), atol=0.03)
    assert result.magnitude.max() <= 1.0
    assert result.magnitude.min() >= FLOOR
    assert result.spread[0, band].max() < 0.05


def flat_then_falling(normalise="low-wavenumber"):
    k = np.linspace(100.0, 5e4, 500)
    magnitude = np.stack([1 / (1 + (k / 5e3) ** 2), 0.7 / (1 + (k / 4e3) ** 2)])
    zero = np.zeros_like(magnitude)
    return ContactFilter(np.array([1e-6, 2e-6]), k, magnitude, zero, magnitude, np.ones(2), normalise)


def test_fir_reproduces_the_designed_magnitude():
    contact_filter, dx = flat_then_falling("tangent"), 1e-5
    taps = design_fir(contact_filter, dx, 200)
    assert taps.shape == (2, 201)
    np.testing.assert_allclose(taps, taps[:, ::-1], atol=1e-15)
    for b, magnitude in zip(taps, contact_filter.magnitude, strict=True):
        _, response = freqz(b, worN=2 * np.pi * contact_filter.wavenumber * dx)
        np.testing.assert_allclose(np.abs(response), magnitude, atol=0.01)


def test_fir_output_has_the_designed_amplitude_and_no_delay():
    contact_filter, dx = flat_then_falling("tangent"), 1e-5
    taps = design_fir(contact_filter, dx, 200)
    k = contact_filter.wavenumber[60]
    x = np.arange(4000) * dx
    texture = filtered_texture(np.cos(2 * np.pi * k * x), dx, taps, contact_filter.approaches)
    inner = slice(200, -200)
    for h, magnitude in zip(texture.heights, contact_filter.magnitude, strict=True):
        expected = -magnitude[60] * np.cos(2 * np.pi * k * x)  # h = −z
        np.testing.assert_allclose(h[inner], expected[inner], atol=0.01)


def test_printed_taps_sum_to_one():
    taps = design_fir(flat_then_falling(), 1e-5, 60)
    np.testing.assert_allclose(taps.sum(axis=1), 1.0, rtol=1e-12)


def test_tap_count_covers_four_semi_axes_and_is_even():
    assert tap_count(1e-5, 1e-4) == 40
    assert tap_count(1e-5, 1.01e-4) == 42


def test_bad_input():
    with pytest.raises(InputError, match="equally many, at least 16"):
        estimate_filter(np.ones((1, 20)), np.ones((1, 21)), 1.0)
    with pytest.raises(InputError, match="a flat surface"):
        estimate_filter(np.ones((1, 20)), np.ones((1, 20)), 1.0)
    with pytest.raises(InputError, match="an even number"):
        design_fir(flat_then_falling(), 1e-5, 41)
