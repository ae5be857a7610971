"""Missing points are filled from their neighbours; spikes are found where they are, and nowhere else."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from asperity import HeightMap, Profile, read_surface
from asperity.errors import MissingPointsWarning
from asperity.surfaces.cleaning import fill, spikes, without_spikes
from asperity.surfaces.synthesis import self_affine

SPACING = 2e-6


def test_fill_restores_a_harmonic_surface():
    x, y = 2e-6 * np.arange(60)[:, None], 3e-6 * np.arange(40)
    harmonic = x * x - y * y + 0.3 * x * y
    holed = np.array(harmonic)
    holed[20:28, 10:16] = np.nan
    holed[3, 3] = np.nan
    filled = fill(HeightMap(holed, (2e-6, 3e-6), "patch"))
    assert_allclose(filled.heights, harmonic, atol=1e-20)
    assert filled.source == "patch; 2.04% of the points filled"
    assert fill(filled) is filled


def test_fill_a_profile_with_straight_lines_and_level_ends():
    with pytest.warns(MissingPointsWarning, match=r"50.0% of the points"):
        filled = fill(Profile([np.nan, 1.0, np.nan, np.nan, 4.0, 5.0, 6.0, np.nan], 1.0))
    assert_allclose(filled.heights, [1.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 6.0])


@pytest.mark.filterwarnings("ignore::asperity.errors.MissingPointsWarning")
def test_lines_side_by_side_are_filled_along_themselves_or_not_at_all():
    """Three lines out of register, each with a flat of its own: none gets that of a neighbour."""
    lines = np.zeros((3, 120))
    lines[0, 20:30], lines[1, 100:110], lines[2, 20:30] = -1.0, -1.0, -1.0
    lines[:] += 0.01 * np.arange(120)
    holed = lines.copy()
    holed[1, 15:35] = np.nan  # beside the flats of both neighbours
    holed[1, 60:] = np.nan  # a short line: its own flat was not reached
    for surface in (HeightMap(holed, (5e-3, 1e-3)), HeightMap(holed.T, (1e-3, 5e-3))):
        filled = surface.filled()
        heights = filled.heights if surface.shape[0] == 3 else filled.heights.T
        assert_allclose(heights[1, :60], 0.01 * np.arange(60), atol=1e-12)
        assert np.isnan(heights[1, 60:]).all()
        assert filled.source == "5.56% of the points filled"
    taken_for_a_map = HeightMap(holed, (5e-3, 1e-3)).filled(lines=False)
    assert taken_for_a_map.heights[1, 25] < -0.4  # a second flat


def texture(hurst=0.8, seed=1):
    band = {"longest": 0.2e-3, "shortest": 4 * SPACING}
    made = self_affine((200, 200), (SPACING, SPACING), rms=0.5e-6, hurst=hurst, seed=seed, **band)
    return np.array(made.heights)


def stepped_and_bowed():
    x = np.arange(200) * SPACING
    return texture() + 20e-6 * (np.arange(200) >= 100)[:, None] + 0.05 * x[:, None] + x[None, :] ** 2 / 20e-3


@pytest.mark.parametrize(
    "heights",
    [
        texture(0.3),
        texture(0.8),
        stepped_and_bowed(),  # the median follows them
        np.round(texture(seed=2) / 1e-6) * 1e-6,  # the step that most neighbours share, not zero, counts
        np.zeros((40, 40)),
    ],
)
def test_where_there_are_no_spikes_none_are_found(heights):
    surface = HeightMap(heights, SPACING)
    assert without_spikes(surface) is surface


def test_spikes_are_found_among_missing_points_at_any_scale_and_turn():
    """Points drawn at random, raised or lowered by 5 to 20 rms heights, and a place three points wide."""
    rng, bad = np.random.default_rng(5), texture()
    at = np.zeros(bad.size, dtype=bool)
    at[rng.choice(bad.size, 200, replace=False)] = True
    size = rng.choice([-1, 1], bad.size) * rng.uniform(5, 20, bad.size) * bad.std()
    bad, at = bad + np.where(at, size, 0.0).reshape(bad.shape), at.reshape(bad.shape)
    missing = rng.random(bad.shape) < 0.05
    bad[missing] = np.nan
    for scale in (1.0, -1e3):
        for turned, expected in ((bad, at & ~missing), (bad.T, (at & ~missing).T)):
            assert np.array_equal(spikes(HeightMap(scale * turned, SPACING)), expected)
    wide = texture()
    wide[50:53, 80:83] += 5e-6
    found = np.argwhere(spikes(HeightMap(wide, SPACING))).tolist()
    assert found == [[i, j] for i in (50, 51, 52) for j in (80, 81, 82)]


def test_spikes_are_taken_away_before_points_are_filled(tmp_path):
    heights = texture()
    heights[20, 30] += 9e-6
    heights[60, 70:73] = np.nan
    np.save(tmp_path / "plate.npy", heights * 1e6)
    hints = {"height_unit": "um", "pixel": "2 um", "fill": True}
    with pytest.warns(MissingPointsWarning, match=r"4 points .* \(1 of them were spikes\); interpolated"):
        filled = read_surface(tmp_path / "plate.npy", spikes=True, **hints)
    assert abs(filled.heights[20, 30] - texture()[20, 30]) < 0.1e-6
    assert filled.source.startswith("plate.npy; 1 points of spikes removed; ")
    with pytest.warns(MissingPointsWarning, match="3 points"):
        kept = read_surface(tmp_path / "plate.npy", **hints)
    assert kept.heights[20, 30] > 7e-6
