import warnings

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import fft

from asperity.errors import InputError, ShortRecordWarning
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.spectra import (
    LagSums,
    autocorrelation,
    autocorrelation_lengths,
    psd_1d,
    psd_2d,
    psd_radial,
    texture_direction,
)
from asperity.surfaces.statistics import areal_statistics, profile_statistics

UM = 1e-6


def gaussian_correlated(shape, spacing, lengths, rms, seed):
    """Periodic surface with autocorrelation exp(-(x/lx)² - (y/ly)²)."""
    q = [2 * np.pi * fft.fftfreq(n, d) for n, d in zip(shape, spacing, strict=True)]
    exponent = (q[0][:, None] * lengths[0]) ** 2 + (q[1][None, :] * lengths[1]) ** 2
    power = np.exp(-exponent / 4.0)
    noise = np.random.default_rng(seed).standard_normal(shape)
    return HeightMap(fft.ifft2(fft.fft2(noise) * np.sqrt(power / power.mean())).real * rms, spacing)


def wave(amplitude, wavelength, shape=(2000, 50), spacing=(UM, UM)):
    x = np.arange(shape[0]) * spacing[0]
    return HeightMap(
        np.repeat(amplitude * np.sin(2 * np.pi * x / wavelength)[:, None], shape[1], axis=1), spacing
    )


def by_symbol(statistics):
    return {s.symbol: s for s in statistics}


def test_areal_statistics_of_a_sine_wave():
    amplitude, wavelength = 0.4 * UM, 40 * UM
    with pytest.warns(ShortRecordWarning, match="upper bound"):  # a straight lay never decorrelates
        found = by_symbol(areal_statistics(wave(amplitude, wavelength)))
    assert_allclose(found["Sq"].value, amplitude / np.sqrt(2.0), rtol=1e-12)
    assert_allclose(found["Sa"].value, amplitude * 2.0 / np.pi, rtol=3e-3)
    assert_allclose(found["Ssk"].value, 0.0, atol=1e-12)
    assert_allclose(found["Sku"].value, 1.5, rtol=1e-12)
    assert_allclose(found["Sz"].value, 2.0 * amplitude, rtol=1e-12)
    slope = 2.0 * np.pi * amplitude / (wavelength * np.sqrt(2.0))
    assert_allclose(found["Sdq"].value, slope, rtol=5e-3)  # whole waves less three points at the ends
    assert_allclose(found["Sdr"].value, slope**2 / 2.0, rtol=1e-2)
    # parts of a wave at the ends change the mean products by up to wavelength/(2π length)
    assert_allclose(found["Sal"].value, np.arccos(0.2) / (2.0 * np.pi) * wavelength, rtol=3.2e-3)
    assert found["Str"].value < 0.36  # at most this map's half width, 25 µm, shows
    assert found["Sq"].bandwidth == (2 * UM, 2000 * UM)
    assert (found["Sq"].unit, found["Sdq"].unit) == ("m", "1")


def test_slope_of_a_plane_is_exact():
    x, y = np.meshgrid(np.arange(30.0), np.arange(20.0), indexing="ij")
    rough = HeightMap(0.3 * x + 0.4 * y * 2.0, (1.0, 2.0))
    with pytest.warns(ShortRecordWarning):
        found = by_symbol(areal_statistics(rough))
    assert_allclose(found["Sdq"].value, 0.5, rtol=1e-12)
    assert_allclose(found["Sdr"].value, np.sqrt(1.25) - 1.0, rtol=1e-12)


def test_slope_formula_is_of_sixth_order():
    errors = []
    for points in (16, 32):
        x = np.arange(40 * points) / points
        rms = by_symbol(profile_statistics(Profile(np.sin(2 * np.pi * x), 1.0 / points)))["Rdq"].value
        errors.append(abs(rms / (2 * np.pi / np.sqrt(2)) - 1.0))
    x = 2 * np.pi / np.array([16, 32])
    response = (45 * np.sin(x) - 9 * np.sin(2 * x) + np.sin(3 * x)) / (30 * x)
    assert_allclose((1 - response)[0] / (1 - response)[1], 64.0, rtol=0.05)
    assert errors[0] < 5e-3


def test_profile_statistics_of_a_sine_wave_with_own_bandwidth():
    x = np.arange(1000) * UM
    found = by_symbol(
        profile_statistics(Profile(3 * UM * np.sin(2 * np.pi * x / (50 * UM)), UM), (8 * UM, UM))
    )
    assert list(found) == [
        *("Rq", "Ra", "Rsk", "Rku", "Rt", "Rz", "Rp", "Rv", "Rdq"),
        *("Rk", "Rpk", "Rvk", "Rmr1", "Rmr2"),
    ]
    assert_allclose(found["Rq"].value, 3 * UM / np.sqrt(2.0), rtol=1e-12)
    assert_allclose(found["Rdq"].value, 2 * np.pi * 3 / (50 * np.sqrt(2.0)), rtol=3e-3)
    assert found["Rq"].bandwidth == (8 * UM, UM)


def test_skewness_and_kurtosis_of_an_exponential_distribution():
    heights = -np.log((np.arange(200000) + 0.5) / 200000)
    heights = np.random.default_rng(0).permutation(heights).reshape(500, 400)
    found = by_symbol(areal_statistics(HeightMap(heights, (1.0, 1.0))))
    assert_allclose([found["Ssk"].value, found["Sku"].value], [2.0, 9.0], rtol=5e-3)
    assert_allclose([found["Sq"].value, found["Sa"].value], [1.0, 2.0 / np.e], rtol=1e-3)


def test_gaussian_correlation_gives_sal_and_str():
    lengths = (20 * UM, 8 * UM)
    maps = [gaussian_correlated((1024, 1024), (UM, UM), lengths, UM, seed=s) for s in range(5)]
    shortest, longest = np.mean([autocorrelation_lengths(m) for m in maps], axis=0)
    reach = np.sqrt(np.log(5.0))
    assert_allclose([shortest, longest], [lengths[1] * reach, lengths[0] * reach], rtol=0.04)
    slope = np.sqrt(2.0 / lengths[0] ** 2 + 2.0 / lengths[1] ** 2) * UM
    assert_allclose(by_symbol(areal_statistics(maps[0]))["Sdq"].value, slope, rtol=0.01)


def test_missing_points_are_left_out():
    surface = gaussian_correlated((400, 400), (UM, UM), (12 * UM, 12 * UM), UM, seed=1)
    holed = np.array(surface.heights)
    holed[150:170, 60:90] = np.nan
    holed[np.random.default_rng(0).random(holed.shape) < 0.005] = np.nan
    whole, part = (by_symbol(areal_statistics(s)) for s in (surface, HeightMap(holed, surface.spacing)))
    for symbol in ("Sq", "Sa", "Sdq", "Sal"):
        assert_allclose(part[symbol].value, whole[symbol].value, rtol=0.01)
    assert_allclose(part["Str"].value, whole["Str"].value, rtol=0.02)


def test_autocorrelation_against_direct_sums():
    heights = np.random.default_rng(5).standard_normal((12, 9))
    heights[4, 4] = np.nan
    z = heights - np.nanmean(heights)
    lobe = autocorrelation(HeightMap(heights, (1.0, 1.0)))
    assert lobe.shape == (13, 9)
    assert lobe[6, 4] == 1.0
    direct = np.nanmean(z[3:, 2:] * z[:-3, :-2]) / np.nanmean(z**2)
    assert_allclose(lobe[9, 6], direct, rtol=1e-12)
    assert_allclose(lobe[3, 2], direct, rtol=1e-12)


@pytest.mark.parametrize("columns", [1, 8, 9])
def test_products_at_lags_add_up_over_pieces(columns):
    """Against direct sums, at lags that no two pieces share."""
    pieces = [np.random.default_rng(rows).standard_normal((rows, columns)) for rows in (11, 10, 11)]
    lags = LagSums(11, columns, 4)
    for piece in pieces:
        lags.add(piece)
    sums, pairs = lags.sums(), np.outer(*lags.pairs())
    side = columns // 2
    assert sums.shape == pairs.shape == (9, 2 * side + 1)
    for along in range(-4, 5):
        for across in range(-side, side + 1):
            products = []
            for piece in pieces:
                x, y = np.indices(piece.shape)
                inside = (x + along >= 0) & (x + along < len(piece)) & (y + across >= 0)
                inside &= y + across < columns
                products += list(piece[inside] * piece[x[inside] + along, y[inside] + across])
            assert_allclose(sums[4 + along, side + across], np.sum(products), atol=1e-12)
            assert pairs[4 + along, side + across] == len(products)


def test_both_spectra_integrate_to_the_mean_square():
    surface = gaussian_correlated((256, 128), (2 * UM, 3 * UM), (20 * UM, 9 * UM), UM, seed=4)
    mean_square = surface.heights.var()
    qx, qy, areal = psd_2d(surface, window=False)
    assert_allclose(areal.sum() * (qx[1] - qx[0]) * (qy[1] - qy[0]), mean_square, rtol=1e-12)
    weights = np.outer(*(np.sin(np.pi * np.arange(n) / n) ** 2 for n in surface.shape)) ** 2
    z = surface.heights - surface.heights.mean()
    _, _, windowed = psd_2d(surface)
    expected = np.average(z**2, weights=weights)
    assert_allclose(windowed.sum() * (qx[1] - qx[0]) * (qy[1] - qy[0]), expected, rtol=1e-12)
    for axis in (0, 1):
        wavenumber, profile = psd_1d(surface, axis)
        weight = np.sin(np.pi * np.arange(surface.shape[axis]) / surface.shape[axis]) ** 4
        expected = np.average((z**2).mean(axis=1 - axis), weights=weight)
        assert_allclose(profile.sum() * wavenumber[1], expected, rtol=1e-12)


def test_profile_spectrum_is_four_pi_times_the_areal_one_summed_across():
    x, y = np.meshgrid(np.arange(256) / 256, np.arange(128) / 128, indexing="ij")
    surface = HeightMap(3.0 * np.cos(2 * np.pi * 10 * x) * np.cos(2 * np.pi * 5 * y), (0.5, 0.25))
    qx, qy, areal = psd_2d(surface)
    across = 4.0 * np.pi * areal.sum(axis=1) * (qy[1] - qy[0])
    wavenumber, profile = psd_1d(surface)
    assert_allclose(across[np.isclose(qx / (2 * np.pi), wavenumber[10])], profile[10], rtol=1e-12)
    assert_allclose(profile[8:13].sum() * wavenumber[1], 9.0 / 4.0, rtol=1e-12)


def test_profile_spectrum_has_the_closed_form_of_a_gaussian_correlation():
    maps = [gaussian_correlated((256, 256), (UM, UM), (8 * UM, 16 * UM), UM, seed=s) for s in range(8)]
    wavenumber = psd_1d(maps[0])[0]
    profile = np.mean([psd_1d(m)[1] for m in maps], axis=0)
    closed_form = 2 * np.sqrt(np.pi) * 8 * UM * UM**2 * np.exp(-((np.pi * wavenumber * 8 * UM) ** 2))
    assert_allclose(profile[2:20].sum(), closed_form[2:20].sum(), rtol=0.05)


def test_radial_spectrum_has_the_closed_form_of_a_gaussian_correlation():
    length = 10 * UM
    maps = [gaussian_correlated((1024, 1024), (UM, UM), (length, length), UM, seed=s) for s in range(4)]
    q, _ = psd_radial(maps[0])
    mean = np.mean([psd_radial(m)[1] for m in maps], axis=0)
    closed_form = UM**2 * length**2 / (4 * np.pi) * np.exp(-((q * length) ** 2) / 4.0)
    inside = (q > 4e4) & (q < 4e5)
    assert_allclose(np.mean(mean[inside] / closed_form[inside]), 1.0, atol=0.05)


def test_statistics_say_what_is_wrong():
    flat = HeightMap(np.ones((10, 10)), (1.0, 1.0))
    with pytest.raises(InputError, match="equal heights"):
        autocorrelation(flat)
    with pytest.raises(InputError, match="equal heights"):
        profile_statistics(Profile(np.zeros(10), 1.0))
    with pytest.raises(InputError, match="at least 7 points"):
        profile_statistics(Profile([1.0, 2.0, 3.0], 1.0))
    with pytest.raises(InputError, match="no seven valid points"):
        profile_statistics(Profile([1.0, np.nan, 3.0, np.nan] * 5, 1.0))
    with pytest.raises(InputError, match="threshold"):
        autocorrelation_lengths(flat, 1.0)
    holed = np.random.default_rng(0).random((10, 10))
    holed[0, 0] = np.nan
    with pytest.raises(InputError, match=r"1\.00% missing points"):
        psd_2d(HeightMap(holed, (1.0, 1.0)))
    with pytest.raises(InputError, match="axis: received 2"):
        psd_1d(flat, 2)


def turned_texture(degrees, ratio, rng, points=128):
    """Self-affine heights of a Hurst exponent of 0.8, whose ridges lie across a direction."""
    qx, qy = np.fft.fftfreq(points)[:, None], np.fft.fftfreq(points)
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    stretched = np.sqrt((qx * cos + qy * sin) ** 2 / ratio + (qy * cos - qx * sin) ** 2 * ratio)
    power = np.where(np.hypot(qx, qy) < 0.25, np.maximum(stretched, 1 / 32) ** -3.6, 0.0)
    return np.fft.ifft2(np.fft.fft2(rng.normal(size=(points, points))) * np.sqrt(power)).real


def test_the_direction_of_a_rough_texture_is_not_decided_by_its_longest_waves():
    """Ridges of known direction, and two of equal height that cross at 60 degrees: one of both is named."""
    rng = np.random.default_rng(11)
    directions, errors = rng.uniform(0.0, 180.0, 12), []
    for degrees in directions:
        found = np.degrees(texture_direction(HeightMap(turned_texture(degrees, 2.0, rng), (1.0, 1.0))))
        errors.append((found - degrees + 90) % 180 - 90)
    assert np.sqrt(np.mean(np.square(errors))) < 6.0  # 16 by the power of heights
    crossed = turned_texture(20.0, 10.0, rng) + turned_texture(80.0, 10.0, rng)
    found = np.degrees(texture_direction(HeightMap(crossed, (1.0, 1.0))))
    assert min(abs(found - 20.0), abs(found - 80.0)) < 4.0


@pytest.mark.parametrize("degrees", [0, 30, 90, 150])
def test_direction_is_among_the_areal_statistics(degrees):
    """Std: ridges that run across the direction in which the heights vary."""
    angle = np.radians(degrees)
    x, y = np.meshgrid(np.arange(128), np.arange(128), indexing="ij")
    rng = np.random.default_rng(1)
    across = x * np.cos(angle) + y * np.sin(angle)
    heights = sum(np.sin(2 * np.pi * across / w + rng.uniform(0, 6)) for w in (5.0, 7.0, 11.0))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ShortRecordWarning)
        found = by_symbol(areal_statistics(HeightMap(heights, (1.0, 1.0))))
    assert found["Std"].unit == "rad"
    assert abs((np.degrees(found["Std"].value) - degrees + 90) % 180 - 90) <= 2.0
    heights[3:6, 4:40:9] = np.nan  # a few points are filled for it, more than 5 % are not
    few = HeightMap(heights, (1.0, 1.0))
    heights[:8] = np.nan
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ShortRecordWarning)
        assert by_symbol(areal_statistics(few))["Std"].value == pytest.approx(found["Std"].value, abs=0.01)
        assert np.isnan(by_symbol(areal_statistics(HeightMap(heights, (1.0, 1.0))))["Std"].value)
