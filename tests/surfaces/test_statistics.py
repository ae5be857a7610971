"""Roughness parameters, spectra and correlation of maps, lines and strips, against closed forms."""

import tracemalloc

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import fft
from scipy.integrate import quad

from asperity.errors import ShortRecordWarning
from asperity.ranks import Ranked
from asperity.reporting.texture_figures import surface_chart
from asperity.surfaces import spectra
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.statistics import (
    areal_statistics,
    homogeneity,
    material_ratio_curve,
    profile_statistics,
    rms_slope,
    stratified,
)
from refusals import refusals

UM = 1e-6


def gaussian_correlated(shape, spacing, lengths, seed):
    """Periodic surface of 1 µm rms with autocorrelation exp(-(x/lx)² - (y/ly)²)."""
    q = [2 * np.pi * fft.fftfreq(n, d) for n, d in zip(shape, spacing, strict=True)]
    exponent = (q[0][:, None] * lengths[0]) ** 2 + (q[1][None, :] * lengths[1]) ** 2
    power = np.exp(-exponent / 4.0)
    noise = np.random.default_rng(seed).standard_normal(shape)
    return HeightMap(fft.ifft2(fft.fft2(noise) * np.sqrt(power / power.mean())).real * UM, spacing)


def values(statistics):
    return {item.symbol: item.value for item in statistics}


def waves(amplitude, wavelength, shape=(2000, 50)):
    x = np.arange(shape[0]) * UM
    return HeightMap(amplitude * np.sin(2 * np.pi * x / wavelength)[:, None] * np.ones(shape[1]), (UM, UM))


def test_areal_statistics_of_a_sine_wave():
    amplitude, wavelength = 0.4 * UM, 40 * UM
    with pytest.warns(ShortRecordWarning, match="upper bound"):  # a straight lay never decorrelates
        named = areal_statistics(waves(amplitude, wavelength))
    found = values(named)
    slope = 2.0 * np.pi * amplitude / (wavelength * np.sqrt(2.0))
    for symbol, expected, off in (
        ("Sq", amplitude / np.sqrt(2.0), 1e-12),
        ("Sa", amplitude * 2.0 / np.pi, 3e-3),
        ("Sku", 1.5, 1e-12),
        ("Sz", 2.0 * amplitude, 1e-12),
        ("Sdq", slope, 5e-3),  # whole waves less three points at the ends
        ("Sdr", slope**2 / 2.0, 1e-2),
        # parts of a wave at the ends change the mean products by up to wavelength/(2π length)
        ("Sal", np.arccos(0.2) / (2.0 * np.pi) * wavelength, 3.2e-3),
    ):
        assert found[symbol] == pytest.approx(expected, rel=off), symbol
    assert_allclose(found["Ssk"], 0.0, atol=1e-12)
    assert found["Str"] < 0.36  # at most this map's half width, 25 µm, shows
    assert named[0].bandwidth == (2 * UM, 2000 * UM)
    assert {item.symbol: item.unit for item in named}["Std"] == "rad"


def test_slope_of_a_plane_is_exact():
    x, y = np.meshgrid(np.arange(30.0), np.arange(20.0), indexing="ij")
    with pytest.warns(ShortRecordWarning):
        found = values(areal_statistics(HeightMap(0.3 * x + 0.4 * y * 2.0, (1.0, 2.0))))
    assert_allclose([found["Sdq"], found["Sdr"]], [0.5, np.sqrt(1.25) - 1.0], rtol=1e-12)


@pytest.mark.parametrize("points", [8, 16])
def test_slope_formula_has_its_response(points):
    """Seven points: (45 sin x − 9 sin 2x + sin 3x)/30x of a wave of x a sample, of sixth order."""
    x = 2 * np.pi / points
    line = Profile(np.sin(x * np.arange(300 * points + 6)), 1.0)
    response = (45 * np.sin(x) - 9 * np.sin(2 * x) + np.sin(3 * x)) / (30 * x)
    assert_allclose(values(profile_statistics(line))["Rdq"], response * x / np.sqrt(2), rtol=1e-9)


def test_lines_have_parameters_of_their_sections():
    """Sines of five amplitudes in five sections: their heights are averaged, the total height is not."""
    x = np.arange(4000) * UM
    line = Profile(np.repeat([1.0, 2.0, 3.0, 4.0, 5.0], 800) * UM * np.sin(2 * np.pi * x / 80e-6), UM)
    named, own = profile_statistics(line), profile_statistics(line, (8 * UM, UM), section=1.6e-3)
    found, longer = values(named), values(own)
    assert " ".join(found) == "Rq Ra Rsk Rku Rt Rz Rp Rv Rdq Rk Rpk Rvk Rmr1 Rmr2"
    assert (named[0].bandwidth, own[0].bandwidth) == ((2 * UM, 4000 * UM), (8 * UM, UM))
    assert_allclose([found["Rz"], found["Rp"], found["Rt"]], [6 * UM, 3 * UM, 10 * UM], rtol=1e-3)
    assert named[5].meaning.endswith("mean of 5 sections of 0.8 mm")
    along_a_track = profile_statistics(Profile(line.heights, 1e-3 * 2.5))
    assert along_a_track[5].meaning.endswith("mean of 5 sections of 2 m")
    assert longer["Rz"] == pytest.approx(6e-6, rel=1e-3)  # 2 and 4 µm, of two whole sections
    assert longer["Rq"] == pytest.approx(1e-6 * np.sqrt(11.0 / 2.0), rel=1e-6)


def test_skewness_and_kurtosis_of_an_exponential_distribution():
    heights = -np.log((np.arange(200000) + 0.5) / 200000)
    heights = np.random.default_rng(0).permutation(heights).reshape(500, 400)
    found = values(areal_statistics(HeightMap(heights, (1.0, 1.0))))
    assert_allclose([found["Ssk"], found["Sku"]], [2.0, 9.0], rtol=5e-3)
    assert_allclose([found["Sq"], found["Sa"]], [1.0, 2.0 / np.e], rtol=1e-3)


def test_a_gaussian_correlation_has_its_lengths_slope_and_spectra_in_closed_form():
    lengths = (20 * UM, 8 * UM)
    maps = [gaussian_correlated((1000, 500), (UM, UM), lengths, seed) for seed in range(6)]
    found = [values(areal_statistics(m)) for m in maps]
    shortest, longest = np.mean([(each["Sal"], each["Sal"] / each["Str"]) for each in found], axis=0)
    assert_allclose([shortest, longest], np.sqrt(np.log(5.0)) * np.array(lengths)[::-1], rtol=0.04)
    slope = np.sqrt(2.0 / lengths[0] ** 2 + 2.0 / lengths[1] ** 2) * UM
    assert_allclose(np.mean([each["Sdq"] for each in found]), slope, rtol=0.01)
    for axis, length in enumerate(lengths):
        wavenumber, _ = spectra.psd_1d(maps[0], axis)
        profile = np.mean([spectra.psd_1d(m, axis)[1] for m in maps], axis=0)
        expected = 2 * np.sqrt(np.pi) * length * UM**2 * np.exp(-((np.pi * wavenumber * length) ** 2))
        assert_allclose(profile[2:40].sum(), expected[2:40].sum(), rtol=0.05)
    round_ = [gaussian_correlated((512, 512), (UM, UM), (10 * UM, 10 * UM), seed) for seed in range(5)]
    q, _ = spectra.psd_radial(round_[0])
    mean = np.mean([spectra.psd_radial(m)[1] for m in round_], axis=0)
    expected = UM**2 * (10 * UM) ** 2 / (4 * np.pi) * np.exp(-((q * 10 * UM) ** 2) / 4.0)
    inside = (q > 4e4) & (q < 4e5)
    assert_allclose(np.mean(mean[inside] / expected[inside]), 1.0, atol=0.05)


def test_missing_points_are_left_out():
    surface = gaussian_correlated((400, 400), (UM, UM), (12 * UM, 12 * UM), seed=1)
    holed = np.array(surface.heights)
    holed[150:170, 60:90] = np.nan
    holed[np.random.default_rng(0).random(holed.shape) < 0.005] = np.nan
    whole, part = (values(areal_statistics(s)) for s in (surface, HeightMap(holed, surface.spacing)))
    for symbol, off in (("Sq", 0.01), ("Sa", 0.01), ("Sdq", 0.01), ("Sal", 0.01), ("Str", 0.02)):
        assert_allclose(part[symbol], whole[symbol], rtol=off)


@pytest.mark.parametrize("columns", [1, 8, 9])
def test_products_at_lags_are_those_of_direct_sums(columns):
    z, side = np.random.default_rng(5).standard_normal((11, columns)), columns // 2
    sums, pairs = spectra.lag_products(z, 4), spectra.lag_pairs(*z.shape, 4)
    assert sums.shape == pairs.shape == (9, 2 * side + 1)
    for along in range(5):
        for across in range(-side, side + 1):
            here = z[: 11 - along, max(-across, 0) : columns - max(across, 0)]
            there = z[along:, max(across, 0) : columns + min(across, 0)]
            for at in ((4 + along, side + across), (4 - along, side - across)):
                assert_allclose(sums[at], np.sum(here * there), atol=1e-12)
                assert pairs[at] == here.size


def test_spectra_integrate_to_the_mean_square_under_their_windows():
    surface = gaussian_correlated((256, 128), (2 * UM, 3 * UM), (20 * UM, 9 * UM), seed=4)
    z = surface.heights - surface.heights.mean()
    along, across = (np.sin(np.pi * np.arange(n) / n) ** 4 for n in surface.shape)
    qx, qy, areal = spectra.psd_2d(surface)
    expected = np.average(z**2, weights=np.outer(along, across))
    assert_allclose(areal.sum() * (qx[1] - qx[0]) * (qy[1] - qy[0]), expected, rtol=1e-12)
    for axis, weight in enumerate((along, across)):
        wavenumber, profile = spectra.psd_1d(surface, axis)
        of_lines = z - z.mean(axis=axis, keepdims=True)
        expected = np.average((of_lines**2).mean(axis=1 - axis), weights=weight)
        assert_allclose(profile.sum() * wavenumber[1], expected, rtol=1e-12)


FLAT, GAP = HeightMap(np.ones((10, 10)), (1.0, 1.0)), np.random.default_rng(0).random((10, 10))
GAP[0, 0] = np.nan


test_what_is_wrong_is_said = refusals(
    (lambda: spectra.autocorrelation(FLAT), "equal heights"),
    (lambda: profile_statistics(Profile(np.zeros(10), 1.0)), "equal heights"),
    (lambda: rms_slope(HeightMap(np.eye(6), (1.0, 1.0))), "no seven valid points in a row along both axes"),
    (lambda: spectra.psd_2d(HeightMap(GAP, (1.0, 1.0))), r"1\.00% missing points"),
)


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

    def found(heights):
        return np.degrees(spectra.texture_direction(HeightMap(heights, (1.0, 1.0))))

    directions = rng.uniform(0.0, 180.0, 12)
    errors = [(found(turned_texture(d, 2.0, rng)) - d + 90) % 180 - 90 for d in directions]
    assert np.sqrt(np.mean(np.square(errors))) < 6.0  # 16 by the power of heights
    x, y = np.indices((128, 128))
    waves = sum(
        size * np.sin(2 * np.pi * (x * np.cos(np.radians(d)) + y * np.sin(np.radians(d))) / 7.0)
        for d, size in ((30.0, 1.0), (52.0, np.sqrt(0.3)))
    )
    mean = 30.0 + 0.5 * np.degrees(np.angle(1.0 + 0.3 * np.exp(2j * np.radians(22.0))))
    assert found(waves) == pytest.approx(mean, abs=1.5)  # of all that lies within 30 degrees
    crossed = found(turned_texture(20.0, 10.0, rng) + turned_texture(80.0, 10.0, rng))
    assert min(abs(crossed - 20.0), abs(crossed - 80.0)) < 4.0


@pytest.mark.parametrize("degrees", [0, 30, 90, 150])
@pytest.mark.filterwarnings("ignore::asperity.errors.ShortRecordWarning")
def test_direction_is_among_the_areal_statistics(degrees):
    """Std: ridges, under noise, that run across the direction in which the heights vary."""
    angle, rng = np.radians(degrees), np.random.default_rng(1)
    x, y = np.meshgrid(np.arange(128), np.arange(128), indexing="ij")
    across = x * np.cos(angle) + y * np.sin(angle)
    heights = sum(np.sin(2 * np.pi * across / w + rng.uniform(0, 6)) for w in np.linspace(4, 12, 20))
    heights += 3 * rng.standard_normal(x.shape)

    def std():
        return values(areal_statistics(HeightMap(heights, (1.0, 1.0))))["Std"]

    found = std()
    assert abs((np.degrees(found) - degrees + 90) % 180 - 90) <= 2.0
    heights[3:6, 4:40:9] = np.nan  # a few points are filled for it, more than 5 % are not
    assert std() == pytest.approx(found, abs=0.01)
    heights[:8] = np.nan
    assert np.isnan(std())


RATIO = (np.arange(200_000) + 0.5) / 200_000


def line_over(curve, low, high):
    """Line of least squares through a curve over an interval: its heights at 0 and at 1."""
    middle, width = 0.5 * (low + high), high - low
    mean = quad(curve, low, high)[0] / width
    slope = quad(lambda m: (m - middle) * curve(m), low, high)[0] * 12.0 / width**3
    return mean - slope * middle, mean + slope * (1.0 - middle)


def test_three_straight_pieces_have_the_core_of_the_middle_one():
    """From 3 to 1 over 10 %, to 0 over 70 %, to −4 over 20 %: the core is the middle line, drawn out."""
    heights = np.interp(RATIO, [0.0, 0.1, 0.8, 1.0], [3.0, 1.0, 0.0, -4.0])
    found = stratified(np.random.default_rng(0).permutation(heights).reshape(400, 500))
    expected = {"k": 10 / 7, "pk": 13 / 7, "vk": 26 / 7, "mr1": 13 / 140, "mr2": 0.8 + 1 / 70}
    assert found == pytest.approx(expected, rel=1e-3)


def test_the_first_of_the_flattest_secants_counts():
    """A sine is flattest at its crests and, as much, in its valleys: the line lies over the first 40 %."""
    found = stratified(np.sin(2.0 * np.pi * RATIO))
    top, bottom = line_over(lambda m: np.cos(np.pi * m), 0.0, 0.4)
    assert found["k"] == pytest.approx(top - bottom, rel=1e-4)
    assert found["mr1"] == pytest.approx(np.arccos(min(top, 1.0)) / np.pi, abs=1e-4)
    assert found["mr2"] == pytest.approx(np.arccos(bottom) / np.pi, abs=1e-3)
    below = quad(lambda m: bottom - np.cos(np.pi * m), found["mr2"], 1.0)[0]
    assert found["vk"] == pytest.approx(2.0 * below / (1.0 - found["mr2"]), rel=1e-3)


def test_layers_are_those_of_heights_about_their_mean():
    heights = np.random.default_rng(2).normal(size=5000) ** 3
    found = stratified(heights + 40.0, 40.0)
    assert found == pytest.approx(stratified(heights), rel=1e-9)


def test_the_curve_falls_from_the_highest_to_the_lowest():
    """Of heights that are spread evenly it is a straight line; missing ones have no part in it."""
    heights = np.append(np.linspace(-1.0, 1.0, 1001), [np.nan] * 10)
    ratio, height = material_ratio_curve(Ranked([heights[:300], heights[300:]]), 11)
    assert_allclose(ratio, np.linspace(0, 1, 11))
    assert_allclose(height, 1.0 - 2.0 * ratio, atol=1e-12)


@pytest.mark.parametrize("heights", [[1.0, 2.0, 4.0], [1.0, np.nan, 3.0, np.nan] * 5])
def test_without_seven_points_in_a_row_there_is_no_slope_but_all_else(heights):
    found = {item.symbol: item.value for item in profile_statistics(Profile(heights, 1.0))}
    assert [symbol for symbol, value in found.items() if np.isnan(value)] == ["Rdq"]
    assert found["Rq"] == pytest.approx(np.nanstd(heights))


@pytest.mark.parametrize(("slope", "kept"), [(0.1, 129), (0.0252, 193), (0.005, 401)])
def test_of_a_correlation_the_lobe_is_kept_with_points_beside_it(slope, kept):
    """A cone that is below a tenth within 32 points, within 64, or nowhere."""
    x, y = np.meshgrid(np.arange(-200, 201), np.arange(-200, 201), indexing="ij")
    cone = np.maximum(1.0 - slope * np.hypot(x, y), 0.0)
    assert spectra._around_lobe(cone).shape == (kept, kept)
    shortest, longest = spectra.lengths_of(cone, (1.0, 1.0)) if slope > 0.01 else (0.8 / slope,) * 2
    assert [shortest, longest] == pytest.approx([0.8 / slope] * 2, rel=5e-3)


@pytest.mark.parametrize("shape", [(12, 10), (11, 10), (12, 9), (11, 9)])
def test_an_areal_spectrum_is_that_of_a_whole_transform_and_rings_are_means_of_it(shape):
    """Half of the plane is transformed: what stands at q stands at −q, but in columns that are both."""
    surface = HeightMap(np.random.default_rng(5).normal(size=shape), (1.0, 1.5))
    window = np.outer(*(0.5 - 0.5 * np.cos(2 * np.pi * np.arange(n) / n) for n in shape))
    whole = np.abs(fft.fft2((surface.heights - surface.heights.mean()) * window)) ** 2
    whole *= 1.5 / (4 * np.pi**2 * (window**2).sum())
    qx, qy, density = spectra.psd_2d(surface)
    assert_allclose(density, fft.fftshift(whole))
    q = np.hypot(qx[:, None], qy)
    ring = np.rint(q / max(qx[1] - qx[0], qy[1] - qy[0]))
    radius, mean = spectra.psd_radial(surface)
    assert_allclose(mean, [density[ring == n].mean() for n in range(1, len(mean) + 1)])
    assert_allclose(radius, [q[ring == n].mean() for n in range(1, len(mean) + 1)])


@pytest.mark.parametrize(("evaluated", "most"), [
    (lambda surface: spectra.psd_2d(surface)[2], 2.6),
    (spectra.texture_direction, 1.6),
    (spectra.autocorrelation, 2.4),
    (lambda surface: [item.value for item in areal_statistics(surface)], 2.4),
    (lambda surface: homogeneity(surface, surrogates=19).tile_rms, 2.3),
    (lambda surface: spectra.psd_radial(surface)[1], 2.2),
    (lambda surface: surface_chart(surface.heights, surface.spacing, {}).panels[2].marks[0].y, 2.3),
])  # fmt: skip
def test_a_large_map_is_not_held_many_times_in_what_is_evaluated(evaluated, most, monkeypatch):
    """Beside its heights: half of its complex spectrum takes as much, products at lags half more, and ..."""
    for module in ("surfaces.spectra", "surfaces.statistics", "surfaces.levelling"):
        monkeypatch.setattr(f"asperity.{module}.PIECE", 2**12)
    monkeypatch.setattr("asperity.ranks.TOGETHER", 2**12)
    monkeypatch.setattr("asperity.surfaces.statistics.MOST_POINTS", 16)
    monkeypatch.setattr("asperity.reporting.chart.SEEN", 64)
    surface = HeightMap(1e-6 * np.random.default_rng(4).normal(size=(512, 512)), (1e-6, 1e-6))
    evaluated(HeightMap(surface.heights[:64, :64], surface.spacing))  # imports
    tracemalloc.start()
    try:
        in_pieces = evaluated(surface)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < most * surface.heights.nbytes, peak / surface.heights.nbytes
    monkeypatch.undo()
    monkeypatch.setattr("asperity.surfaces.statistics.MOST_POINTS", 16)
    assert_allclose(np.asarray(in_pieces), np.asarray(evaluated(surface)), rtol=1e-9)
