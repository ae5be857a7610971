"""Lines and strips with given one-third-octave levels, and the levels of surfaces."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy import fft, stats
from scipy.special import k1

from asperity import HeightMap, spectra
from asperity.reference import cnossos
from asperity.surfaces.bands import band_levels_of, from_bands, strip_from_bands
from refusals import refusals

MM, UM = 1e-3, 1e-6


def rail(first, stop, name="iso3095"):
    return tuple(v[first:stop] for v in cnossos.rail_roughness(name))


def periodogram_levels(heights, wavelengths):
    """Levels of what closes on itself, 1 mm apart, mean power of its lines."""
    points = len(heights)
    density = 2 * np.abs(fft.rfft(heights.reshape(points, -1), axis=0)) ** 2 * MM / points
    low, high = 1 / np.max(wavelengths), 1 / np.min(wavelengths)
    return spectra.band_levels(fft.rfftfreq(points, MM), density.mean(axis=1), UM, low=low, high=high)[1]


@pytest.mark.parametrize(
    ("points", "lateral", "bands"),
    [
        (20000, 1.0, rail(0, 30)),
        (16001, 0.3, rail(0, 30, "cnossos-average")),
        (16000, np.inf, rail(0, 30)),
        (6000, 1.0, rail(7, 30)),  # 3 lines in the band of 0.4 m
        (20000, None, rail(13, 24)),
        (20001, None, rail(13, 24)),
    ],
)
def test_the_levels_are_those_asked_for(points, lateral, bands):
    """Exactly, of the periodogram of a line, and of the middle line of a strip; in the mean of all lines.

    Their sum is the variance of a line, but for waves on the edges of the first and the last band.
    """
    if lateral is None:
        heights = from_bands(points, MM, *bands, seed=4).heights
        assert_allclose(10 * np.log10(heights.var() / UM**2), spectra.energy_sum(bands[1]), atol=0.01)
    else:
        strip = strip_from_bands((points, 17), (MM, MM), *bands, lateral=lateral, seed=5).heights
        heights = strip[:, 8]
        assert_allclose(heights, from_bands(points, MM, *bands, seed=5).heights, rtol=0, atol=1e-12 * UM)
        assert abs(np.mean(periodogram_levels(strip, bands[0]) - bands[1])) < 0.1
    assert_allclose(periodogram_levels(heights, bands[0]), bands[1], atol=0.05)
    if lateral == np.inf:
        assert_array_equal(strip, np.broadcast_to(heights[:, None], strip.shape))


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


def test_lines_that_step_over_tiles_have_nothing_in_common():
    """Between lines 500 wavelengths of the spectrum across apart lie tiles without a line."""
    strip = strip_from_bands((4000, 5), (MM, 0.25), [0.005], [0.0], lateral=0.1, seed=8).heights
    assert_allclose(np.sqrt(np.mean(strip**2)), UM, rtol=0.05)
    assert_allclose(np.corrcoef(strip.T), np.eye(5), atol=0.12)


def test_strip_is_isotropic_where_the_line_density_falls_with_the_square():
    wavelengths = 10.0 ** (-np.arange(5, 24) / 10)  # 0.32 m to 5 mm
    levels = -np.arange(wavelengths.size) * 1.0  # density ∝ ν^-2

    def strip(seed, lateral=1.0):
        return strip_from_bands((800, 100), (MM, MM), wavelengths, levels, lateral=lateral, seed=seed).heights

    def level(heights):
        wavelength, levels = band_levels_of(HeightMap(heights, MM))
        return levels[(wavelength > 0.009) & (wavelength < 0.022)]

    maps = [strip(seed) for seed in range(4)]
    along, across = (np.mean([level(z) for z in views], 0) for views in (maps, [z.T for z in maps]))
    assert_allclose(across, along, atol=1.0)
    assert (level(strip(1, lateral=4.0).T) < along - 5.0).all()


def test_a_strip_closes_along_but_not_across_and_is_normal():
    rough = strip_from_bands((4000, 100), (MM, MM), [0.1], [10.0], seed=1).heights
    assert np.abs(rough[0] - rough[-1]).max() < 5 * np.abs(np.diff(rough, axis=0)).max()
    assert np.std(rough[:, 0] - rough[:, -1]) > 5 * np.std(rough[:, 0] - rough[:, 1])
    strip = strip_from_bands((50000, 40), (MM, 10 * MM), [0.04, 0.02, 0.01], [0.0, 0.0, 0.0], seed=4).heights
    assert_allclose([stats.skew(strip, axis=None), stats.kurtosis(strip, axis=None)], 0.0, atol=0.05)
    assert_allclose(strip.std(), np.sqrt(3) * UM, rtol=1e-3)


def test_band_without_energy():
    strip = strip_from_bands((2000, 5), (MM, MM), [0.1, 0.02], [0.0, -np.inf], seed=1)
    found = periodogram_levels(strip.heights[:, 2], [0.1, 0.02])
    assert_allclose(found[0], 0.0, atol=0.05)
    assert found[-1] < -200.0
    assert not strip_from_bands((2000, 5), (MM, MM), [0.1], [-np.inf], seed=1).heights.any()


test_what_is_wrong_is_said = refusals(
    *(
        (lambda wavelengths=wavelengths: from_bands(1000, MM, wavelengths, [0.0], seed=1), "distinct centres")
        for wavelengths in ([0.1, 0.1], [0.09])
    )
)


def test_levels_of_a_line_and_of_a_strip():
    wavelengths, levels = rail(13, 29)
    line = from_bands(400000, MM, wavelengths, levels, seed=1)
    found_at, found = band_levels_of(line)
    held = (found_at > 3 * MM) & (found_at < 0.11)
    assert_allclose(found_at[held], wavelengths, rtol=0.025)
    assert_allclose(found[held], levels, atol=0.6)
    strip = HeightMap(np.stack([line.heights, 2 * line.heights], axis=1), (MM, MM))
    _, both = band_levels_of(strip)
    assert_allclose((both - found)[held], 10 * np.log10(2.5))
