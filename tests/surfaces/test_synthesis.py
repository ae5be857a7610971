from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy import fft, integrate, stats

from asperity import spectra
from asperity.errors import InputError
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.levelling import level, resample
from asperity.surfaces.likeness import gaussian_correlation, height_table
from asperity.surfaces.readers import read_surfaces
from asperity.surfaces.spectra import autocorrelation_lengths, psd_1d, psd_2d
from asperity.surfaces.synthesis import from_bands, from_map, long_self_affine, self_affine

UM = 1e-6
SHEET = Path(__file__).parents[3] / "shared" / "data" / "aa5754_um.npz"
AFFINE = {"rms": 0.5 * UM, "hurst": 0.7, "longest": 60 * UM, "shortest": 4 * UM}


def test_self_affine_ensemble_has_the_rms_and_the_slope_of_its_spectrum():
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


def test_self_affine_has_nothing_beyond_the_cut_off():
    qx, qy, density = psd_2d(self_affine((256, 256), (UM, UM), seed=1, **AFFINE))
    q = np.hypot(qx[:, None], qy[None, :])
    assert density[q > 1.1 * 2 * np.pi / AFFINE["shortest"]].max() < 1e-6 * density.max()


def test_self_affine_anisotropy_is_the_ratio_of_correlation_lengths():
    options = {**AFFINE, "longest": 30 * UM, "anisotropy": 4.0}
    maps = [self_affine((1024, 256), (UM, UM), seed=s, **options) for s in range(3)]
    shortest, longest = np.mean([autocorrelation_lengths(m) for m in maps], axis=0)
    assert_allclose(longest / shortest, 4.0, rtol=0.15)


def test_self_affine_takes_no_map_beyond_all_measure():
    with pytest.raises(InputError, match=r"longest: received 10 m at 8e-06 m, which take a map of 2500000 x"):
        self_affine((600, 63), (8e-6, 8e-6), rms=UM, hurst=0.8, longest=10.0, shortest=16 * UM, seed=1)
    with pytest.raises(InputError, match=r"allowed: at most 134217728 points.*nearer to 1"):
        self_affine((64, 64), (UM, UM), seed=1, **(AFFINE | {"anisotropy": 1e9}))


def test_self_affine_does_not_close_on_itself():
    surface = self_affine((64, 64), (UM, UM), seed=3, **AFFINE).heights
    step_inside, step_around = np.std(np.diff(surface, axis=0)), np.std(surface[0] - surface[-1])
    assert step_around > 3 * step_inside


def test_seeds_reproduce_and_differ():
    one, same, other = (self_affine((32, 32), (UM, UM), seed=s, **AFFINE).heights for s in (1, 1, 2))
    assert_array_equal(one, same)
    assert np.abs(one - other).max() > 0.1 * UM


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"rms": -1.0}, "rms: received -1.0"),
        ({"rms": np.nan}, "rms: received nan"),
        ({"hurst": 1.2}, "hurst: received 1.2"),
        ({"shortest": 1.5 * UM}, "at least two samples, 2e-06 m"),
        ({"longest": 3 * UM}, "longer than the shortest"),
        ({"anisotropy": 0.0}, "anisotropy: received 0.0"),
    ],
)
def test_self_affine_says_what_is_wrong(change, text):
    with pytest.raises(InputError, match=text):
        self_affine((32, 32), (UM, UM), seed=1, **{**AFFINE, **change})


def test_self_affine_needs_a_shape_and_a_spacing():
    with pytest.raises(InputError, match=r"shape: received \(1, 32\)"):
        self_affine((1, 32), (UM, UM), seed=1, **AFFINE)
    with pytest.raises(InputError, match="spacing"):
        self_affine((32, 32), (UM, -UM), seed=1, **AFFINE)


WAVELENGTHS = [0.1, 0.08, 0.063, 0.05, 0.04, 0.0315, 0.025, 0.02, 0.016, 0.0125, 0.01]
LEVELS = np.linspace(6.0, -9.0, len(WAVELENGTHS))


@pytest.mark.parametrize("points", [20000, 20001])
def test_line_from_bands_has_their_levels(points):
    line = from_bands(points, 1e-3, WAVELENGTHS, LEVELS, seed=4)
    frequency, density = spectra.psd(line.heights, 1e-3, segment=4000)
    centres, levels = spectra.band_levels(frequency, density, UM, low=1 / 0.1, high=1 / 0.01)
    assert_allclose(1 / centres, WAVELENGTHS, rtol=0.025)
    assert_allclose(levels, LEVELS, atol=0.6)
    assert_allclose(10 * np.log10(line.heights.var() / UM**2), spectra.energy_sum(LEVELS), atol=1e-9)


def test_periodogram_of_a_line_from_bands_is_exact():
    line = from_bands(20000, 1e-3, WAVELENGTHS, LEVELS, seed=1)
    density = 2 * np.abs(fft.rfft(line.heights)) ** 2 * 1e-3 / 20000
    _, levels = spectra.band_levels(fft.rfftfreq(20000, 1e-3), density, UM, low=1 / 0.1, high=1 / 0.01)
    assert_allclose(levels, LEVELS, atol=0.05)  # lines on the edges belong to two bands


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ((100, 1e-3, [0.1], [0.0]), "length of the line: received 0.1 m"),
        ((1000, 1e-2, [0.02], [0.0]), "spacing: received 0.01 m"),
        ((1000, 1e-3, [0.1, 0.1], [0.0, 0.0]), "distinct centres"),
        ((1000, 1e-3, [0.09], [0.0]), "distinct centres"),
        ((1000, 1e-3, [0.1, 0.08], [0.0]), "equal length"),
        ((1000, 1e-3, [0.1], [np.nan]), "equal length"),
        ((1000, 1e-3, [-0.1], [0.0]), "positive and finite"),
        ((1, 1e-3, [0.1], [0.0]), "2 points or more"),
    ],
)
def test_from_bands_says_what_is_wrong(arguments, text):
    with pytest.raises(InputError, match=text):
        from_bands(*arguments, seed=1)


LOGNORMAL = 0.4  # shape parameter: skewness 1.32, kurtosis 6.26
SKEWNESS = (np.exp(LOGNORMAL**2) + 2) * np.sqrt(np.exp(LOGNORMAL**2) - 1)


def parent_spectrum(size=1200, lengths=(10 * UM, 4 * UM)):
    """Spectrum of the normal field: (1 + (qx lx)² + (qy ly)²)^-2, mean one."""
    q = 2 * np.pi * fft.fftfreq(size, UM)
    power = (1 + (q[:, None] * lengths[0]) ** 2 + (q[None, :] * lengths[1]) ** 2) ** -2
    return power / power.mean()


def parent_correlation():
    """Correlation of the lognormal surface at all lags of the grid."""
    normal = fft.ifft2(parent_spectrum()).real
    return (np.exp(LOGNORMAL**2 * normal) - 1) / (np.exp(LOGNORMAL**2) - 1)


def parent_maps(count, size=200):
    """Pieces of one lognormal surface."""
    noise = np.random.default_rng(99).standard_normal((1200, 1200))
    normal = fft.ifft2(fft.fft2(noise) * np.sqrt(parent_spectrum())).real
    heights = (np.exp(LOGNORMAL * normal) - np.exp(LOGNORMAL**2 / 2)) * UM
    corners = [(size * i, size * j) for i in range(6) for j in range(6)][:count]
    return [HeightMap(heights[i : i + size, j : j + size], (UM, UM)) for i, j in corners]


def averaged_bands(lines, segment, low, high):
    frequency, density = spectra.psd(lines, UM, segment=segment)
    return spectra.band_levels(frequency, density.mean(axis=0), UM, low=1 / low, high=1 / high)[1]


@pytest.fixture(scope="module")
def likeness():
    maps = parent_maps(36)
    return [level(m).heights for m in maps], np.stack(
        [from_map(maps, (20000, 40), seed=s).heights for s in range(10)]
    )


def test_likeness_has_the_height_distribution_of_the_maps(likeness):
    measured, path = np.concatenate([m.ravel() for m in likeness[0]]), likeness[1]
    assert path.shape == (10, 20000, 40)
    assert_allclose(path.std(), measured.std(), rtol=0.02)
    assert_allclose(stats.skew(path, axis=None), stats.skew(measured), atol=0.1)
    kurtosis = [stats.kurtosis(z, axis=None, fisher=False) for z in (path, measured)]
    assert_allclose(kurtosis[0], kurtosis[1], rtol=0.05)
    assert_allclose(stats.skew(path, axis=None), SKEWNESS, rtol=0.15)
    assert measured.min() <= path.min() < path.max() <= measured.max()


def test_likeness_has_the_spectrum_of_the_maps_in_both_directions(likeness):
    measured, path = likeness
    along = averaged_bands(np.concatenate([m.T for m in measured]), 200, 60 * UM, 3 * UM)
    assert_allclose(averaged_bands(np.concatenate(path, axis=1).T, 200, 60 * UM, 3 * UM), along, atol=0.5)
    blocks = np.concatenate([m[:, k : k + 40] for m in measured for k in range(0, 200, 40)])
    across = averaged_bands(blocks, 40, 10 * UM, 3 * UM)
    assert_allclose(averaged_bands(np.concatenate(path), 40, 10 * UM, 3 * UM), across, atol=0.5)


def test_likeness_has_the_spectrum_of_its_parent(likeness):
    variance = np.exp(LOGNORMAL**2) * (np.exp(LOGNORMAL**2) - 1) * UM**2
    density = 2 * UM * variance * fft.rfft(parent_correlation()[:, 0]).real
    wavenumber = fft.rfftfreq(1200, UM)
    # levelling and window change what is longer than a quarter of a map, 50 µm
    expected = spectra.band_levels(wavenumber, density, UM, low=1 / (50 * UM), high=1 / (3 * UM))[1]
    assert_allclose(
        averaged_bands(np.concatenate(likeness[1], axis=1).T, 1000, 50 * UM, 3 * UM), expected, atol=0.5
    )


def steep_parent(exponent, size=2048, flat=16.0):
    """Surface whose areal spectrum falls as q^-exponent from `size/flat` on, and its line spectrum."""
    k = np.hypot(fft.fftfreq(size)[:, None], fft.rfftfreq(size)[None, :]) * size
    power = np.maximum(k, flat) ** -float(exponent)
    power[0, 0] = 0.0
    phase = np.random.default_rng(5).uniform(0.0, 2.0 * np.pi, power.shape)
    heights = fft.irfft2(np.sqrt(power) * np.exp(1j * phase), s=(size, size))
    lines = np.abs(fft.rfft(heights, axis=0)) ** 2 * (2 * UM / size)
    return heights, lines.mean(axis=1)


def bands_over(parent, path, pieces, low, high):
    """Level of synthesised lines over their parent's in octaves, from `low` to `high` waves per map."""
    size, length = 2 * (len(parent) - 1), path.shape[0]
    window = np.hanning(length + 1)[:-1]
    density = np.abs(fft.rfft((path - path.mean()) * window[:, None], axis=0)) ** 2
    density = density.mean(axis=1) * (2 * UM / np.sum(window**2))
    found = []
    for edge in 2.0 ** np.arange(np.log2(low), np.log2(high)):
        levels = []
        for spectrum, points in ((density, length), (parent, size)):
            waves = np.arange(len(spectrum)) * pieces / points
            levels.append(10 * np.log10(spectrum[(waves >= edge) & (waves < 2 * edge)].mean()))
        found.append(levels[0] - levels[1])
    return np.array(found)


@pytest.mark.parametrize("exponent", [0.0, 2.0, 3.6, 4.4, 5.5])
def test_likeness_has_the_spectrum_of_a_steep_parent(exponent):
    """Maps an eighth of the parent's longest wave: what is longer than they are must not leak into them.

    Between two and sixteen waves per map; a window on the heights lifted two to four by up to 5 dB.
    """
    heights, spectrum = steep_parent(exponent)
    size = 128
    corners = [(i, j) for i in range(0, 2048, 512) for j in range(0, 2048, 512)]
    maps = [HeightMap(heights[i : i + size, j : j + size], (UM, UM)) for i, j in corners]
    path = np.concatenate([from_map(maps, (4096, 128), seed=s).heights for s in range(2)], axis=1)
    off = bands_over(spectrum, path, size, 2, 16)
    assert np.abs(off).max() < 1.3
    assert abs(off.mean()) < 0.8


def test_bow_of_a_sheet_does_not_become_roughness():
    """Sixteen waves of roughness on a bow twenty times as high: the roughness stays what it is."""
    rng = np.random.default_rng(8)
    size = 128
    x = np.linspace(-1.0, 1.0, size)
    rough = 0.05 * UM * rng.standard_normal((6, size, size))
    maps = [HeightMap(z + 1.0 * UM * x[:, None] ** 2, (UM, UM)) for z in rough]
    path = from_map(maps, (4096, 128), seed=1).heights
    white = np.full(2049, 2 * UM * (0.05 * UM) ** 2)
    off = bands_over(white, path, size, 2, 32)
    assert abs(off[0]) < 3.5  # what is left of the bow; it was 14 dB
    assert np.abs(off[1:]).max() < 0.6
    assert path.std() == pytest.approx(np.std([level(m).heights for m in maps]), rel=0.25)


@pytest.mark.skipif(not SHEET.is_file(), reason="no measured sheet in shared/data")
@pytest.mark.parametrize("name", ["polished", "bb20"])
def test_likeness_of_a_measured_sheet_keeps_its_spectrum(name):
    """Wave by wave from half the map, 0.4 mm, to 0.1 mm, where it was up to 5.7 dB too high."""
    maps = read_surfaces(SHEET, array=name, height_unit="um", pixel=1.5625 * UM)
    maps = [level(resample(level(m), 8 * UM)) for m in maps]
    measured = np.mean([psd_1d(m)[1] for m in maps], axis=0)
    path = from_map(maps, (20000, 51), seed=1).heights
    _, density = spectra.psd(np.ascontiguousarray(path.T), 8 * UM, segment=maps[0].shape[0])
    off = 10 * np.log10(density.mean(axis=0)[2:9] / measured[2:9])
    assert np.abs(off).max() < 1.5
    assert abs(off.mean()) < 0.7


def test_maps_of_a_few_points_have_no_spectrum():
    with pytest.raises(InputError, match="maps: received 5 points along a side; allowed: at least 8"):
        from_map(HeightMap(np.random.default_rng(0).standard_normal((5, 40)), (UM, UM)), (50, 50), seed=1)


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


def test_likeness_of_one_map_is_reproducible_and_says_where_it_comes_from():
    one = HeightMap(parent_maps(1)[0].heights, (UM, UM), "sheet.x3p")
    first, again, other = (from_map(one, (50, 30), seed=s) for s in (3, 3, 4))
    assert_array_equal(first.heights, again.heights)
    assert np.abs(first.heights - other.heights).max() > 0.1 * UM
    assert first.source == "synthesised from sheet.x3p, seed 3"


def test_from_map_says_what_is_wrong():
    surface = parent_maps(1)[0]
    holed = np.array(surface.heights)
    holed[:2, 0] = np.nan
    with pytest.raises(InputError, match=r"0\.01% missing points in a map"):
        from_map(HeightMap(holed, surface.spacing), (50, 50), seed=1)
    with pytest.raises(InputError, match="one spacing for all"):
        from_map([surface, HeightMap(surface.heights, (2 * UM, UM))], (50, 50), seed=1)
    with pytest.raises(InputError, match="maps: received none"):
        from_map([], (50, 50), seed=1)
    with pytest.raises(InputError, match="shape"):
        from_map(surface, (1, 50), seed=1)


def test_correlation_of_a_lognormal_translation_has_its_closed_form():
    probabilities = (np.arange(400000) + 0.5) / 400000
    deviates, heights = height_table(np.exp(LOGNORMAL * stats.norm.ppf(probabilities)))
    normal = np.linspace(-0.9, 1.0, 20)
    translated = (np.exp(LOGNORMAL**2 * normal) - 1) / (np.exp(LOGNORMAL**2) - 1)
    assert_allclose(gaussian_correlation(deviates, heights, translated), normal, atol=2e-4)
    assert_allclose(
        np.interp([-1.0, 0.0, 2.0], deviates, heights), np.exp(LOGNORMAL * np.array([-1, 0, 2])), rtol=1e-4
    )


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
