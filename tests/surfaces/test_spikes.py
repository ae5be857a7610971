"""Spikes of measured surfaces: found where they are, and nowhere else."""

import numpy as np
import pytest

from asperity import HeightMap, read_surface
from asperity.errors import InputError, MissingPointsWarning
from asperity.surfaces.cleaning import spikes, without_spikes
from asperity.surfaces.synthesis import self_affine

SPACING = 2e-6


def texture(hurst=0.8, seed=1, points=200):
    band = {"longest": 0.2e-3, "shortest": 4 * SPACING}
    return self_affine((points, points), (SPACING, SPACING), rms=0.5e-6, hurst=hurst, seed=seed, **band)


def spiked(heights, share, seed=5):
    """Points drawn at random, raised or lowered by 5 to 20 rms heights."""
    rng = np.random.default_rng(seed)
    at = np.zeros(heights.size, dtype=bool)
    at[rng.choice(heights.size, round(share * heights.size), replace=False)] = True
    size = rng.choice([-1, 1], heights.size) * rng.uniform(5, 20, heights.size) * np.nanstd(heights)
    return heights + np.where(at, size, 0.0).reshape(heights.shape), at.reshape(heights.shape)


@pytest.mark.parametrize("hurst", [0.3, 0.8])
def test_a_gaussian_texture_has_none(hurst):
    assert not spikes(texture(hurst)).any()


def test_those_put_in_are_found_among_missing_points():
    bad, at = spiked(texture().heights, 0.005)
    missing = np.random.default_rng(6).random(bad.shape) < 0.05
    bad[missing] = np.nan
    found = spikes(HeightMap(bad, SPACING))
    assert np.array_equal(found, at & ~missing)


def test_spikes_three_points_wide_are_found_whole():
    heights = np.array(texture().heights)
    heights[50:53, 80:83] += 5e-6
    found = spikes(HeightMap(heights, SPACING))
    assert found[50:53, 80:83].all()
    assert np.count_nonzero(found) == 9


def test_steps_and_slopes_are_none():
    """A step, a plane and a bow are no spikes: the median follows them."""
    x = np.arange(200) * SPACING
    heights = np.array(texture().heights)
    heights[100:] += 20e-6
    heights += 0.05 * x[:, None] + x[None, :] ** 2 / 20e-3
    assert not spikes(HeightMap(heights, SPACING)).any()


def test_rounded_heights_are_none():
    """Heights in steps that most neighbours share: the step, not zero, is what a point may be off."""
    step = 1e-6
    heights = np.round(texture(0.8, seed=2).heights / step) * step
    assert np.median(np.abs(np.diff(heights, axis=0))) == 0.0
    assert not spikes(HeightMap(heights, SPACING)).any()


def test_flat_and_all_but_flat():
    heights = np.zeros((40, 40))
    assert not spikes(HeightMap(heights, SPACING)).any()


def test_scale_and_turning_change_nothing():
    bad, _ = spiked(texture().heights, 0.005)
    found = spikes(HeightMap(bad, SPACING))
    assert np.array_equal(spikes(HeightMap(-1e3 * bad, SPACING)), found)
    assert np.array_equal(spikes(HeightMap(bad.T, SPACING)), found.T)


def test_source_says_how_many():
    heights = np.array(texture().heights)
    heights[20, 30] += 9e-6
    found = without_spikes(HeightMap(heights, SPACING, "plate"))
    assert found.source == "plate; 1 points of spikes removed"
    clean = texture()
    assert without_spikes(clean) is clean


class TestReading:
    @pytest.fixture
    def file(self, tmp_path):
        heights = np.array(texture().heights)
        heights[20, 30] += 9e-6
        heights[60, 70:73] = np.nan
        np.save(tmp_path / "plate.npy", heights * 1e6)
        return tmp_path / "plate.npy"

    def read(self, file, **keys):
        return read_surface(file, height_unit="um", pixel="2 um", **keys)

    def test_spikes_are_taken_away_before_points_are_filled(self, file):
        with pytest.warns(MissingPointsWarning, match=r"4 points .* \(1 of them were spikes\); interpolated"):
            filled = self.read(file, spikes=True, fill=True)
        assert abs(filled.heights[20, 30] - texture().heights[20, 30]) < 0.1e-6
        with pytest.warns(MissingPointsWarning, match="3 points"):
            kept = self.read(file, fill=True)
        assert kept.heights[20, 30] > 7e-6

    def test_lines_have_processing_of_their_own(self, tmp_path):
        np.save(tmp_path / "line.npy", np.array(texture().heights[:, 100]))
        with pytest.raises(InputError, match=r"spikes: received a line, .* allowed: a height map"):
            read_surface(tmp_path / "line.npy", height_unit="m", pixel="2 um", spikes=True)

    def test_flag(self, file):
        with pytest.raises(InputError, match="spikes: received 'yes'; allowed: True or False"):
            self.read(file, spikes="yes")
