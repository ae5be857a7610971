"""Textures that are made: continued records, self-affine surfaces, likenesses of maps, homogeneity."""

from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy import fft, integrate, stats

from asperity import HeightMap, spectra
from asperity.spectra import band_product
from asperity.surfaces.bands import band_levels_of
from asperity.surfaces.levelling import level, resample
from asperity.surfaces.likeness import gaussian_correlation, height_table
from asperity.surfaces.spectra import autocorrelation_lengths, psd_1d, psd_2d
from asperity.surfaces.statistics import homogeneity, more_than_chance
from asperity.surfaces.synthesis import (
    SelfAffine,
    close,
    extend,
    from_map,
    line_levels,
    long_self_affine,
    self_affine,
)
from refusals import refusals

UM = 1e-6
RAMP = np.arange(5.0)
AFFINE = {"rms": 0.5 * UM, "hurst": 0.7, "longest": 60 * UM, "shortest": 4 * UM}


@pytest.mark.parametrize(("rows", "how", "start", "expected"), [
    (3, "refuse", 2, [2, 3, 4]),
    (11, "mirror", 0, [0, 1, 2, 3, 4, 3, 2, 1, 0, 1, 2]),
    (5, "mirror", -2, [2, 1, 0, 1, 2]),
    (7, "repeat", 0, [0, 1, 2, 3, 4, 0, 1]),
    (4, "repeat", -2, [3, 4, 0, 1]),
])  # fmt: skip
def test_records_are_cut_mirrored_or_repeated(rows, how, start, expected):
    assert_array_equal(extend(RAMP, rows, how, spacing=1.0, start=start), expected)
    strip = extend(np.outer(RAMP, [1.0, 10.0]), rows, how, spacing=1.0, start=start)
    assert_array_equal(strip, np.outer(expected, [1.0, 10.0]))


def test_closing_spreads_the_step_over_both_sides_of_the_join():
    line = np.linspace(0.0, 1.0, 101)
    closed = close(line, 20)
    assert closed[0] == closed[-1] == 0.5
    assert_array_equal(closed[20:-20], line[20:-20])
    assert np.abs(np.diff(np.concatenate([closed, closed]))).max() < 0.06
    assert_array_equal(close(line, 0), line)
    assert_allclose(extend(line, 101, "repeat", spacing=1.0, crossfade=20), closed)


def test_self_affine_ensemble_has_the_rms_and_the_spectrum_in_closed_form():
    maps = [self_affine((256, 256), (UM, UM), seed=s, **AFFINE).heights for s in range(12)]
    # about 18 independent patches per map: standard error of the mean rms about 1.5 %
    assert_allclose(np.sqrt(np.mean(np.square(maps))), 0.5 * UM, rtol=0.04)
    periodograms = [psd_1d(HeightMap(z, (UM, UM))) for z in maps]
    wavenumber, density = periodograms[0][0], np.mean([p for _, p in periodograms], axis=0)
    scale = (2 * np.pi / AFFINE["longest"]) ** 2

    def areal(q):
        return np.where(q <= 2 * np.pi / AFFINE["shortest"], np.maximum(q * q, scale) ** (-1.0 - 0.7), 0.0)

    total = 2 * np.pi * integrate.quad(lambda q: q * areal(q), 0, 2 * np.pi / 4e-6, limit=500)[0]
    qy = np.linspace(0.0, 2 * np.pi / AFFINE["shortest"], 20001)
    shape = [8 * np.pi * integrate.trapezoid(areal(np.hypot(2 * np.pi * k, qy)), qy) for k in wavenumber]
    inside = (wavenumber > 1e4) & (wavenumber < 2e5)
    ratio = density[inside] / (np.array(shape)[inside] * AFFINE["rms"] ** 2 / total)
    assert_allclose(np.mean(ratio), 1.0, atol=0.04)
    assert abs(np.polyfit(np.log(wavenumber[inside]), np.log(ratio), 1)[0]) < 0.05
    qx, qy, density = psd_2d(HeightMap(maps[1], (UM, UM)))
    beyond = np.hypot(qx[:, None], qy[None, :]) > 1.1 * 2 * np.pi / AFFINE["shortest"]
    assert density[beyond].max() < 1e-6 * density.max()


def test_self_affine_anisotropy_is_the_ratio_of_correlation_lengths():
    options = {**AFFINE, "longest": 30 * UM, "anisotropy": 4.0}
    maps = [self_affine((1024, 256), (UM, UM), seed=s, **options) for s in range(3)]
    shortest, longest = np.mean([autocorrelation_lengths(m) for m in maps], axis=0)
    assert_allclose(longest / shortest, 4.0, rtol=0.15)


@pytest.mark.parametrize("lay", [-25.0, 30.0, 90.0, 160.0])
@pytest.mark.parametrize("strip", [self_affine, long_self_affine])
def test_a_drawn_out_texture_lies_at_any_angle(strip, lay):
    """Ridges lie where the mean square of the slope, a tensor, is least."""
    made = strip(
        (1600, 200), (1e-5, 1e-5), rms=1e-7, hurst=0.8, longest=2e-4, shortest=4e-5, anisotropy=4.0,
        lay=np.deg2rad(lay), seed=3,
    )  # fmt: skip
    heights = made.rows(0, 1600)
    assert np.std(heights) == pytest.approx(1e-7, rel=0.1)
    gx, gy = np.gradient(heights)
    steepest = 0.5 * np.arctan2(2 * np.mean(gx * gy), np.mean(gx**2) - np.mean(gy**2))
    off = (np.rad2deg(steepest) + 90 - lay + 90) % 180 - 90
    assert abs(off) < 3.0


def test_self_affine_does_not_close_on_itself():
    surface = self_affine((64, 64), (UM, UM), seed=3, **AFFINE).heights
    step_inside, step_around = np.std(np.diff(surface, axis=0)), np.std(surface[0] - surface[-1])
    assert step_around > 3 * step_inside


LOGNORMAL = 0.4  # shape parameter: skewness 1.32, kurtosis 6.26
SKEWNESS = (np.exp(LOGNORMAL**2) + 2) * np.sqrt(np.exp(LOGNORMAL**2) - 1)


def parent_spectrum(size=1200, lengths=(10 * UM, 4 * UM)):
    """Spectrum of the normal field: (1 + (qx lx)² + (qy ly)²)^-2, mean one."""
    q = 2 * np.pi * fft.fftfreq(size, UM)
    power = (1 + (q[:, None] * lengths[0]) ** 2 + (q[None, :] * lengths[1]) ** 2) ** -2
    return power / power.mean()


@cache
def parent_correlation():
    """Correlation of the lognormal surface at all lags of the grid."""
    normal = fft.ifft2(parent_spectrum()).real
    return (np.exp(LOGNORMAL**2 * normal) - 1) / (np.exp(LOGNORMAL**2) - 1)


@cache
def parent():
    """Heights of a lognormal surface, m."""
    noise = np.random.default_rng(99).standard_normal((1200, 1200))
    normal = fft.ifft2(fft.fft2(noise) * np.sqrt(parent_spectrum())).real
    return (np.exp(LOGNORMAL * normal) - np.exp(LOGNORMAL**2 / 2)) * UM


def parent_maps(count, size=200):
    """Pieces of it."""
    heights = parent()
    corners = [(size * i, size * j) for i in range(6) for j in range(6)][:count]
    return [HeightMap(heights[i : i + size, j : j + size], (UM, UM), "sheet.x3p") for i, j in corners]


def averaged_bands(lines, segment, low, high):
    frequency, density = spectra.psd(lines, UM, segment=segment)
    return spectra.band_levels(frequency, density.mean(axis=0), UM, low=1 / low, high=1 / high)[1]


@pytest.fixture(scope="module")
def likeness():
    """Levelled maps, and strips like them, 40 lines each."""
    maps = parent_maps(36)
    paths = [from_map(maps, (10000, 200), seed=s).heights for s in range(4)]
    return [level(m).heights for m in maps], np.concatenate([np.split(path, 5, axis=1) for path in paths])


def test_likeness_has_the_height_distribution_of_the_maps(likeness):
    measured, path = np.concatenate([m.ravel() for m in likeness[0]]), likeness[1]
    assert_allclose(path.std(), measured.std(), rtol=0.02)
    assert_allclose(stats.skew(path, axis=None), stats.skew(measured), atol=0.1)
    kurtosis = [stats.kurtosis(z, axis=None, fisher=False) for z in (path, measured)]
    assert_allclose(kurtosis[0], kurtosis[1], rtol=0.05)
    assert_allclose(stats.skew(path, axis=None), SKEWNESS, rtol=0.15)
    assert measured.min() <= path.min() < path.max() <= measured.max()


def test_likeness_has_the_spectrum_of_the_maps_in_both_directions_and_of_their_parent(likeness):
    measured, path = likeness
    lines = np.concatenate(path, axis=1).T
    along = averaged_bands(np.concatenate([m.T for m in measured]), 200, 60 * UM, 3 * UM)
    assert_allclose(averaged_bands(lines, 200, 60 * UM, 3 * UM), along, atol=0.5)
    blocks = np.concatenate([m[:, k : k + 40] for m in measured for k in range(0, 200, 40)])
    across = averaged_bands(blocks, 40, 10 * UM, 3 * UM)
    assert_allclose(averaged_bands(np.concatenate(path), 40, 10 * UM, 3 * UM), across, atol=0.5)
    variance = np.exp(LOGNORMAL**2) * (np.exp(LOGNORMAL**2) - 1) * UM**2
    density = 2 * UM * variance * fft.rfft(parent_correlation()[:, 0]).real
    # levelling and window change what is longer than a quarter of a map, 50 µm
    expected = spectra.band_levels(fft.rfftfreq(1200, UM), density, UM, low=2e4, high=1 / (3 * UM))[1]
    assert_allclose(averaged_bands(lines, 1000, 50 * UM, 3 * UM), expected, atol=0.5)


def steep_parent(exponent, size=2048, flat=16.0):
    """Surface whose areal spectrum falls as q^-exponent from `size/flat` on, and its line spectrum."""
    k = np.hypot(fft.fftfreq(size)[:, None], fft.rfftfreq(size)[None, :]) * size
    power = np.maximum(k, flat) ** -float(exponent)
    power[0, 0] = 0.0
    phase = np.random.default_rng(5).uniform(0.0, 2.0 * np.pi, power.shape)
    heights = fft.irfft2(np.sqrt(power) * np.exp(1j * phase), s=(size, size))
    lines = np.abs(fft.rfft(heights, axis=0)) ** 2 * (2 * UM / size)
    return heights, lines.mean(axis=1)


def bands_over(parent, path, pieces, octaves):
    """Level of synthesised lines over their parent's in octaves from two waves per map on."""
    frequency, density = spectra.psd(path.T, UM)
    edges = 2.0 ** np.arange(1, octaves + 2)

    def levels(wavenumber, density):
        octave = np.digitize(wavenumber * pieces * UM, edges)
        return np.array([10 * np.log10(density[octave == k].mean()) for k in range(1, octaves + 1)])

    whole = np.arange(len(parent)) / (2 * (len(parent) - 1) * UM)
    return levels(frequency, density.mean(axis=0)) - levels(whole, parent)


@pytest.mark.parametrize("exponent", [0.0, 3.6, 5.5])
def test_likeness_has_the_spectrum_of_a_steep_parent(exponent):
    """Maps an eighth of the parent's longest wave: what is longer than they are must not leak into them.

    Between two and sixteen waves per map; a window on the heights lifted two to four by up to 5 dB.
    """
    heights, spectrum = steep_parent(exponent)
    size = 128
    corners = [(i, j) for i in range(0, 2048, 512) for j in range(0, 2048, 512)]
    maps = [HeightMap(heights[i : i + size, j : j + size], (UM, UM)) for i, j in corners]
    path = np.concatenate([from_map(maps, (4096, 128), seed=s).heights for s in range(2)], axis=1)
    off = bands_over(spectrum, path, size, 3)
    assert np.abs(off).max() < 1.3
    assert abs(off.mean()) < 0.8


def test_bow_of_a_sheet_does_not_become_roughness():
    """Sixteen waves of roughness on a bow twenty times as high: the roughness stays what it is."""
    size = 128
    x = np.linspace(-1.0, 1.0, size)
    rough = 0.05 * UM * np.random.default_rng(8).standard_normal((6, size, size))
    maps = [HeightMap(z + 1.0 * UM * x[:, None] ** 2, (UM, UM)) for z in rough]
    path = from_map(maps, (4096, 128), seed=1).heights
    white = np.full(2049, 2 * UM * (0.05 * UM) ** 2)
    off = bands_over(white, path, size, 4)
    assert abs(off[0]) < 3.5  # what is left of the bow; it was 14 dB
    assert np.abs(off[1:]).max() < 0.6
    assert path.std() == pytest.approx(np.std([level(m).heights for m in maps]), rel=0.25)


def test_narrow_strip_is_not_forced_to_close_across():
    strip = from_map(parent_maps(12), (10000, 8), seed=1).heights
    expected = parent_correlation()[0, 7]
    assert 0.2 < expected < 0.5
    assert_allclose(np.corrcoef(strip[:, 0], strip[:, 7])[0, 1], expected, atol=0.08)


def test_likeness_at_another_spacing_is_that_of_the_resampled_maps():
    maps = parent_maps(3)
    path = from_map(maps, (4000, 32), seed=2, spacing=2.5 * UM)
    resampled = [resample(level(m), 2.5 * UM).heights for m in maps]
    assert path.spacing == (2.5 * UM, 2.5 * UM)
    assert_allclose(path.heights.std(), np.std(resampled), rtol=0.03)
    assert path.source == "synthesised from sheet.x3p, seed 2"


def test_correlation_of_a_lognormal_translation_has_its_closed_form():
    probabilities = (np.arange(400000) + 0.5) / 400000
    deviates, heights = height_table(np.exp(LOGNORMAL * stats.norm.ppf(probabilities)))
    normal = np.linspace(-0.9, 1.0, 20)
    translated = (np.exp(LOGNORMAL**2 * normal) - 1) / (np.exp(LOGNORMAL**2) - 1)
    assert_allclose(gaussian_correlation(deviates, heights, translated), normal, atol=2e-4)
    at = np.array([-1.0, 0.0, 2.0])
    assert_allclose(np.interp(at, deviates, heights), np.exp(LOGNORMAL * at), rtol=1e-4)


def texture(seed, points=192, longest=20 * UM):
    band = {"longest": longest, "shortest": 4 * UM}
    return self_affine((points, points), (UM, UM), seed=seed, rms=UM, hurst=0.8, **band)


@pytest.mark.parametrize(
    "make",
    [
        lambda seed: self_affine((32, 32), (UM, UM), seed=seed, **AFFINE).heights,
        lambda seed: from_map(texture(0, 64), (50, 30), seed=seed).heights,
        lambda seed: homogeneity(texture(2, 96, 10 * UM), surrogates=19, seed=seed).expected,
    ],
)
def test_seeds_reproduce_and_differ(make):
    one, same, other = (make(seed) for seed in (1, 1, 2))
    assert_array_equal(one, same)
    assert np.abs(one - other).max() > 0.0


def test_stationary_surfaces_are_rarely_called_inhomogeneous():
    alike = [homogeneity(texture(seed, 96, 10 * UM), surrogates=19, seed=seed) for seed in range(24)]
    p_values = [each.p_value for each in alike]
    # the p-value is uniform under the null hypothesis: mean 0.525, standard error 0.059
    assert abs(np.mean(p_values) - 0.525) < 0.18
    assert sum(p <= 0.05 for p in p_values) <= 5  # more than 5 of 24 has a probability of 0.1 %


@pytest.mark.parametrize(
    ("surface", "factor"),
    [
        (texture(3), np.where(np.arange(192) < 96, 1.0, 1.5)),
        (texture(1, 400, 40 * UM), np.linspace(0.6, 1.4, 400)),  # tested on fewer points
    ],
)
def test_a_rougher_half_or_a_trend_is_found(surface, factor):
    assert homogeneity(surface).homogeneous
    rough = HeightMap(surface.heights * factor, surface.spacing)
    found = homogeneity(rough)
    assert not found.homogeneous
    assert found.p_value == 1 / 40
    assert found.variation > 1.6 * found.expected  # over ten draws of each 1.7 to 2.8 times
    tiles = level(rough).heights.reshape(4, len(factor) // 4, 4, -1)
    assert_allclose(found.tile_rms, np.sqrt(np.mean(tiles**2, axis=(1, 3))), rtol=1e-9)


@pytest.mark.parametrize(
    ("failed", "maps", "more"),
    [(0, 5, False), (1, 1, True), (1, 2, False), (2, 7, True), (1, 5, False), (2, 8, False), (3, 8, True)],
)
def test_more_maps_fail_than_chance_makes_fail(failed, maps, more):
    assert more_than_chance([0.05] * failed + [0.5] * (maps - failed)) == more


HOLED = np.array(texture(0).heights)
HOLED[:2, 0] = np.nan
OTHER = HeightMap(texture(0).heights, (2 * UM, UM))


def affine(shape=(32, 32), spacing=(UM, UM), **changes):
    return self_affine(shape, spacing, seed=1, **(AFFINE | changes))


def continued(rows=3, how="refuse", heights=RAMP, **changes):
    return extend(heights, rows, how, spacing=0.5, what="wheel line", **changes)


test_what_is_wrong_is_said = refusals(
    (lambda: continued(100), "length of the wheel line: received 2.5 m.* 50 m.*'mirror' or 'repeat'"),
    (lambda: continued(4, start=2), r"received 2\.5 m; allowed: .* 2 m, from 1 m on"),
    (lambda: continued(how="repeat", crossfade=3), "0 to 2, half the record"),
    (lambda: affine(rms=-1.0), "rms: received -1.0"),
    (lambda: affine(rms=np.nan), "rms: received nan"),
    (lambda: affine(hurst=1.2), "hurst: received 1.2"),
    (lambda: affine(shortest=1.5 * UM), "at least two samples, 2e-06 m"),
    (lambda: affine(longest=3 * UM), "longer than the shortest"),
    (lambda: affine(anisotropy=0.0), "anisotropy: received 0.0"),
    (lambda: affine(shape=(1, 32)), r"shape: received \(1, 32\)"),
    (lambda: affine(spacing=(UM, -UM)), "spacing"),
    (
        lambda: affine(anisotropy=1e9, lay=0.5),
        r"anisotropy: received 1·10⁹, which takes tiles .*at most 134217728 waves.*nearer to 1",
    ),
    (lambda: from_map(HeightMap(HOLED, UM), (50, 50), seed=1), r"0\.01% missing points in a map"),
    (lambda: from_map([texture(0), OTHER], (50, 50), seed=1), "one spacing for all"),
    (lambda: from_map([], (50, 50), seed=1), "maps: received none"),
    (lambda: from_map(OTHER, (1, 50), seed=1), "shape"),
    (lambda: from_map(texture(0, 5), (50, 50), seed=1), "5 points along a side; allowed: at least 8"),
    (lambda: homogeneity(texture(0, 7)), "2 points or more in each of 4 × 4 tiles"),
)


@pytest.mark.parametrize(
    "keys",
    [
        {"hurst": 0.8, "longest": 0.1, "shortest": 4e-3},
        {"hurst": 0.5, "longest": 0.05, "shortest": 6e-3, "anisotropy": 3.0, "lay": 0.4},
        {"hurst": 0.8, "longest": 0.1, "shortest": 4e-3, "anisotropy": 4.0},
    ],
)
def test_levels_along_a_self_affine_surface_are_those_of_many_of_them(keys):
    """Means over 24 seeds, by their periodograms: they scatter by 4.34/√(24 B L) dB."""
    squares = []
    for seed in range(24):
        drawn = self_affine((3000, 3), (1e-3, 1e-3), rms=5e-6, seed=seed, **keys)
        wavelength, level = band_levels_of(drawn)
        squares.append(10.0 ** (0.1 * level))
    told = line_levels(SelfAffine(5e-6, **keys), wavelength)
    held = (wavelength < 0.3) & (wavelength > 1.2 * keys["shortest"])
    scatter = 4.34 / np.sqrt(24 * band_product(1.0 / wavelength, 3.0))
    apart = 10.0 * np.log10(np.mean(squares, axis=0)) - told
    assert (np.abs(apart[held]) < 4.0 * scatter[held] + 0.1).all()
    assert (told[wavelength < 0.8 * keys["shortest"] / np.sqrt(keys.get("anisotropy", 1.0))] == -np.inf).all()
