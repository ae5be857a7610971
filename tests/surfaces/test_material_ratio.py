"""Peaks, core and valleys by the material ratio curve, against closed forms."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ndtri
from scipy.stats import norm

from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.statistics import (
    areal_statistics,
    material_ratio_curve,
    profile_statistics,
    stratified,
)

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
    assert found["k"] == pytest.approx(10 / 7, rel=1e-4)
    assert found["pk"] == pytest.approx(13 / 7, rel=1e-3)
    assert found["vk"] == pytest.approx(26 / 7, rel=1e-3)
    assert found["mr1"] == pytest.approx(13 / 140, abs=1e-4)
    assert found["mr2"] == pytest.approx(0.8 + 1 / 70, abs=1e-4)


def test_the_first_of_the_flattest_secants_counts():
    """A sine is flattest at its crests and, as much, in its valleys: the line lies over the first 40 %."""
    found = stratified(np.sin(2.0 * np.pi * RATIO))
    top, bottom = line_over(lambda m: np.cos(np.pi * m), 0.0, 0.4)
    assert found["k"] == pytest.approx(top - bottom, rel=1e-4)
    assert found["mr1"] == pytest.approx(np.arccos(min(top, 1.0)) / np.pi, abs=1e-4)
    assert found["mr2"] == pytest.approx(np.arccos(bottom) / np.pi, abs=1e-3)
    below = quad(lambda m: bottom - np.cos(np.pi * m), found["mr2"], 1.0)[0]
    assert found["vk"] == pytest.approx(2.0 * below / (1.0 - found["mr2"]), rel=1e-3)


def test_normal_heights_have_a_symmetric_core():
    """The line over the middle 40 % of Φ⁻¹: 2.58 standard deviations high, a tenth of the points above it."""
    found = stratified(ndtri(RATIO))
    top, bottom = line_over(lambda m: norm.isf(m), 0.3, 0.7)
    assert found["k"] == pytest.approx(top - bottom, rel=1e-4)
    assert found["pk"] == pytest.approx(found["vk"], rel=1e-3)
    assert found["mr1"] == pytest.approx(norm.sf(top), abs=1e-4)
    above = norm.pdf(top) - top * norm.sf(top)
    assert found["pk"] == pytest.approx(2.0 * above / norm.sf(top), rel=1e-3)


def test_a_plateau_with_valleys_is_told_from_them():
    """Nine tenths of a plateau of 0.1 µm rms, one of valleys 2 µm deep: as their distribution has it."""
    rng = np.random.default_rng(4)
    valley = rng.random((400, 400)) < 0.1
    heights = 1e-6 * np.where(valley, rng.normal(-2.0, 0.5, valley.shape), rng.normal(0.0, 0.1, valley.shape))
    z = np.linspace(-5.0, 1.0, 60_001)[::-1]
    share = 0.9 * norm.sf(z, 0.0, 0.1) + 0.1 * norm.sf(z, -2.0, 0.5)

    def curve(m):
        return np.interp(m, share, z)

    starts = np.linspace(0.0, 0.6, 601)
    low = starts[np.argmin([curve(m) - curve(m + 0.4) for m in starts])]
    top, bottom = line_over(curve, low, low + 0.4)
    found = {item.symbol: item.value for item in areal_statistics(HeightMap(heights, (1e-6, 1e-6)))}
    begins = np.interp(-bottom, -z, share)
    below = quad(lambda m: bottom - curve(m), begins, 1.0, limit=200)[0]
    assert 1e6 * found["Sk"] == pytest.approx(top - bottom, rel=0.02)
    assert found["Smr2"] == pytest.approx(begins, abs=0.004)
    assert 1e6 * found["Svk"] == pytest.approx(2.0 * below / (1.0 - begins), rel=0.02)


def test_the_curve_falls_from_the_highest_to_the_lowest():
    """Of heights that are spread evenly it is a straight line; missing ones have no part in it."""
    heights = np.append(np.linspace(-1.0, 1.0, 1001), [np.nan] * 10)
    ratio, height = material_ratio_curve(heights, 11)
    assert np.allclose(ratio, np.linspace(0, 1, 11))
    assert np.allclose(height, 1.0 - 2.0 * ratio)


def test_lines_have_parameters_of_their_sections():
    """Sines of five amplitudes in five sections: their heights are averaged, the total height is not."""
    x = np.arange(4000) * 1e-6
    amplitude = np.repeat([1.0, 2.0, 3.0, 4.0, 5.0], 800)
    line = Profile(amplitude * 1e-6 * np.sin(2 * np.pi * x / 80e-6), 1e-6)
    found = {item.symbol: item for item in profile_statistics(line)}
    assert found["Rz"].value == pytest.approx(6e-6, rel=1e-3)
    assert found["Rp"].value == pytest.approx(3e-6, rel=1e-3)
    assert found["Rt"].value == pytest.approx(10e-6, rel=1e-3)
    assert found["Rz"].meaning.endswith("mean of 5 sections of 0.8 mm")
    longer = {item.symbol: item for item in profile_statistics(line, section=1.6e-3)}
    assert longer["Rz"].value == pytest.approx(6e-6, rel=1e-3)  # 2 and 4 µm, of two whole sections
    assert longer["Rq"].value == pytest.approx(1e-6 * np.sqrt(11.0 / 2.0), rel=1e-6)
