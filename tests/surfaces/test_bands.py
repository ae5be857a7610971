import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy import fft, stats
from scipy.special import k1

from asperity import spectra
from asperity.errors import InputError
from asperity.reference import cnossos
from asperity.surfaces.bands import band_levels_of, check_levels, strip_from_bands
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.synthesis import from_bands

MM, UM = 1e-3, 1e-6


def periodogram_levels(heights, spacing, wavelengths):
    """Levels of a strip that closes on itself, mean power of its lines."""
    points = heights.shape[0]
    density = 2 * np.mean(np.abs(fft.rfft(heights, axis=0)) ** 2, axis=1) * spacing / points
    low, high = 1 / np.max(wavelengths), 1 / np.min(wavelengths)
    return spectra.band_levels(fft.rfftfreq(points, spacing), density, UM, low=low, high=high)[1]


@pytest.mark.parametrize("name", ["iso3095", "cnossos-average"])
@pytest.mark.parametrize(("points", "lateral"), [(20000, 1.0), (16001, 0.3), (16000, np.inf)])
def test_strip_has_the_levels_of_its_bands(name, points, lateral):
    wavelengths, levels = (v[:30] for v in cnossos.rail_roughness(name))  # down to 2.5 mm
    strip = strip_from_bands((points, 17), (MM, MM), wavelengths, levels, lateral=lateral, seed=5)
    found = periodogram_levels(strip.heights, MM, wavelengths)
    assert_allclose(found, levels, atol=0.05)


def test_levels_hold_where_a_band_has_few_lines():
    wavelengths, levels = (v[7:30] for v in cnossos.rail_roughness("iso3095"))
    for seed in range(5):
        strip = strip_from_bands((6000, 9), (MM, MM), wavelengths, levels, seed=seed)  # 3 lines at 0.4 m
        assert_allclose(periodogram_levels(strip.heights, MM, wavelengths), levels, atol=0.05)


def test_single_lines_scatter_about_the_levels():
    wavelengths, levels = (v[13:29] for v in cnossos.rail_roughness("iso3095"))
    strip = strip_from_bands((40000, 33), (MM, 2 * MM), wavelengths, levels, seed=2)
    each = np.array([periodogram_levels(strip.heights[:, [k]], MM, wavelengths) for k in range(33)])
    assert_allclose(each, np.broadcast_to(levels, each.shape), atol=1.5)
    assert each[:, -1].std() > 0.01


@pytest.mark.parametrize("lateral", [1.0, 4.0])
def test_lines_share_what_the_spectrum_across_says(lateral):
    """Coherence of lines a distance y apart: ∫ D cos(ky y) dky = z K1(z), z = kx y / lateral."""
    wavelengths, levels = [0.05, 0.02, 0.008], [0.0, 0.0, 0.0]
    strip = strip_from_bands((100000, 12), (MM, MM), wavelengths, levels, lateral=lateral, seed=8)
    lines = fft.rfft(strip.heights, axis=0)
    wavenumber = fft.rfftfreq(100000, MM)
    for centre in wavelengths:
        band = np.abs(wavenumber * centre - 1) < 0.1
        cross = np.conj(lines[band, 0, None]) * lines[band]
        power = np.mean(np.abs(lines[band]) ** 2)
        z = 2 * np.pi / centre * np.arange(1, 12) * MM / lateral
        assert_allclose(np.mean(cross.real, axis=0)[1:] / power, z * k1(z), atol=0.12)


def test_strip_is_isotropic_where_the_line_density_falls_with_the_square():
    wavelengths = 10.0 ** (-np.arange(5, 24) / 10)  # 0.32 m to 5 mm
    levels = -np.arange(wavelengths.size) * 1.0  # density ∝ ν^-2
    maps = [strip_from_bands((1200, 100), (MM, MM), wavelengths, levels, seed=s).heights for s in range(4)]
    along, across = (
        np.mean([band_levels_of(HeightMap(z, (MM, MM)), shortest=0.01, longest=0.02)[1] for z in views], 0)
        for views in (maps, [z.T for z in maps])
    )
    assert_allclose(across, along, atol=1.0)
    flat = strip_from_bands((1200, 100), (MM, MM), wavelengths, levels, lateral=4.0, seed=1).heights
    _, across = band_levels_of(HeightMap(flat.T, (MM, MM)), shortest=0.01, longest=0.02)
    assert (across < along - 5.0).all()


def test_equal_lines_and_closing_along_but_not_across():
    strip = strip_from_bands((4000, 8), (MM, MM), [0.1], [10.0], lateral=np.inf, seed=1).heights
    assert_array_equal(strip, np.broadcast_to(strip[:, :1], strip.shape))
    rough = strip_from_bands((4000, 200), (MM, MM), [0.1], [10.0], seed=1).heights
    assert np.abs(rough[0] - rough[-1]).max() < 5 * np.abs(np.diff(rough, axis=0)).max()
    assert np.std(rough[:, 0] - rough[:, -1]) > 5 * np.std(rough[:, 0] - rough[:, 1])


def test_heights_of_a_strip_are_normal():
    strip = strip_from_bands((50000, 40), (MM, 10 * MM), [0.04, 0.02, 0.01], [0.0, 0.0, 0.0], seed=4).heights
    assert abs(stats.skew(strip, axis=None)) < 0.05
    assert abs(stats.kurtosis(strip, axis=None)) < 0.05
    assert_allclose(strip.std(), np.sqrt(3) * UM, rtol=1e-3)


def test_strips_follow_their_seed():
    one, same, other = (
        strip_from_bands((500, 5), (MM, MM), [0.05], [0.0], seed=s).heights for s in (1, 1, 2)
    )
    assert_array_equal(one, same)
    assert np.abs(one - other).max() > 0.1 * UM


def test_band_without_energy():
    strip = strip_from_bands((2000, 5), (MM, MM), [0.1, 0.02], [0.0, -np.inf], seed=1)
    found = periodogram_levels(strip.heights, MM, [0.1, 0.02])
    assert_allclose(found[0], 0.0, atol=0.05)
    assert found[-1] < -200.0
    flat = strip_from_bands((2000, 5), (MM, MM), [0.1], [-np.inf], seed=1)
    assert_array_equal(flat.heights, 0.0)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"shape": (1, 9)}, r"shape: received \(1, 9\)"),
        ({"spacing": (MM, -MM)}, "spacing: received"),
        ({"lateral": 0.0}, "lateral: received 0.0"),
        ({"lateral": np.nan}, "lateral: received nan"),
        ({"shape": (100, 9)}, "length of the line: received 0.1 m"),
        ({"wavelengths": [0.001]}, "spacing: received 0.001 m"),
    ],
)
def test_strip_says_what_is_wrong(change, text):
    arguments = {"shape": (1000, 9), "spacing": (MM, MM), "wavelengths": [0.1], "levels_db": [0.0], "seed": 1}
    with pytest.raises(InputError, match=text):
        strip_from_bands(**{**arguments, **change})


def test_levels_of_a_line_and_of_a_strip():
    wavelengths, levels = (v[13:29] for v in cnossos.rail_roughness("iso3095"))
    line = from_bands(40000, MM, wavelengths, levels, seed=1)
    found_at, found = band_levels_of(line, segment=4.0, longest=0.1, shortest=3.15 * MM)
    assert_allclose(found_at, wavelengths, rtol=0.025)
    assert_allclose(found, levels, atol=0.6)
    strip = HeightMap(np.stack([line.heights, 2 * line.heights], axis=1), (MM, MM))
    _, both = band_levels_of(strip, segment=4.0, longest=0.1, shortest=3.15 * MM)
    assert_allclose(both - found, 10 * np.log10(2.5))


@pytest.mark.parametrize(("factor", "extreme"), [(1e6, "125 dB"), (1e3, "65 dB"), (1e-3, "-")])
def test_levels_ask_for_the_unit(factor, extreme):
    wavelengths, levels = (v[13:29] for v in cnossos.rail_roughness("iso3095"))
    line = from_bands(40000, MM, wavelengths, levels, seed=1)
    check_levels([line])
    with pytest.raises(
        InputError, match=rf"levels of the wheel: received {extreme}.*Is the unit right"
    ) as caught:
        check_levels([line, Profile(factor * line.heights, MM)], "wheel")
    assert "between -60 and +60 dB" in str(caught.value)


def test_smooth_lines_and_short_waves_that_a_record_cannot_hold_are_not_asked_about():
    check_levels([Profile(np.zeros(2000), MM)])
    x = np.arange(4000) * 10 * MM
    check_levels([Profile(UM * np.sin(2 * np.pi * x / 0.2), 10 * MM)])
