"""HeightMap and Profile: what they accept, refuse and give back."""

import base64
import dataclasses

import numpy as np
import pytest

from asperity.surfaces.heightmap import HeightMap, Profile
from refusals import refusals

HEIGHTS = np.arange(12.0).reshape(3, 4)
MAP = HeightMap(HEIGHTS, (1e-6, 2e-6), "made")
LINE = Profile([0.0, 1.0, np.nan, 3.0], 1e-3, "wheel")


@pytest.mark.parametrize("view", [lambda array: array, lambda array: array[:]])
def test_heights_are_a_read_only_copy(view):
    original = HEIGHTS.copy()
    given = view(original)
    given.flags.writeable = given is original
    surface = HeightMap(given, (1.0, 1.0))
    original[0, 0] = 99.0
    assert surface.heights[0, 0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        surface.heights[0, 0] = 1.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        surface.spacing = (1.0, 1.0)


def test_integers_become_floats_and_masked_points_missing():
    masked = np.ma.masked_equal(np.arange(4).reshape(2, 2), 3)
    surface = HeightMap(masked, 1.0)
    assert surface.heights.dtype == np.float64
    np.testing.assert_array_equal(surface.heights, [[0, 1], [2, np.nan]])
    assert surface.missing_share == 0.25
    assert surface.spacing == (1.0, 1.0)


def test_a_map_has_coordinates_lines_and_pieces():
    assert MAP.shape == (3, 4)
    assert MAP.size == pytest.approx((3e-6, 8e-6))
    np.testing.assert_allclose(MAP.x, [0, 1e-6, 2e-6])
    np.testing.assert_allclose(MAP.y, [0, 2e-6, 4e-6, 6e-6])
    np.testing.assert_array_equal(MAP.line().heights, HEIGHTS[:, 2])
    np.testing.assert_array_equal(MAP.line(0).heights, HEIGHTS[:, 0])
    assert (MAP.line().spacing, MAP.line().source) == (1e-6, "made")
    np.testing.assert_array_equal(MAP.crop((1e-6, 2e-6), (2e-6, 6e-6)).heights, HEIGHTS[1:3, 1:4])
    np.testing.assert_array_equal(MAP.transposed().heights, HEIGHTS.T)
    assert MAP.transposed().spacing == (2e-6, 1e-6)


def test_a_line_has_coordinates_and_pieces():
    assert LINE.shape == (4,)
    assert LINE.size == pytest.approx(4e-3)
    np.testing.assert_allclose(LINE.x, [0, 1e-3, 2e-3, 3e-3])
    np.testing.assert_array_equal(LINE.crop(1e-3, 3e-3).heights, [1.0, np.nan, 3.0])


SQUARE = np.zeros((2, 2))


test_what_is_wrong_is_said = refusals(
    (lambda: HeightMap(np.zeros(3), 1.0), r"shape \(3,\)"),
    (lambda: HeightMap(np.zeros((1, 3)), 1.0), r"shape \(1, 3\)"),
    (lambda: HeightMap([[1.0, 2.0], [3.0]], 1.0), "rows of unequal length"),
    (lambda: HeightMap(SQUARE, (1.0, 0.0)), "spacing of the height map"),
    (lambda: HeightMap(SQUARE, None), "spacing of the height map"),
    (lambda: MAP.crop((2e-6, 0), (2e-6, 4e-6)), "piece of the map along x"),
    (lambda: MAP.crop((-1e-6, 0), (2e-6, 4e-6)), "piece of the map along x"),
    (lambda: MAP.crop((0, 0), (2e-6, 2e-6)), "piece of the map along y"),
    (lambda: MAP.crop((np.nan, 0), (2e-6, 4e-6)), "piece of the map along x"),
    (lambda: MAP.line(-1), r"index of a line of the map: received -1; allowed: 0 to 3"),
    (lambda: MAP.line(4), r"index of a line of the map: received 4; allowed: 0 to 3"),
    (lambda: LINE.crop(2e-3, 3e-3), "piece of the line"),
    (lambda: Profile([0.0, 1.0], -1.0), "spacing of the profile"),
    (lambda: Profile(SQUARE, 1.0, "wheel"), r"heights of wheel: received an array of shape \(2, 2\)"),
)


@pytest.mark.parametrize("shape", [(40, 30), (700, 20), (500,)])
def test_surfaces_show_themselves_in_a_notebook(shape):
    heights = 1e-6 * np.random.default_rng(0).normal(size=shape)
    heights.flat[3] = np.nan
    made = HeightMap(heights, (2e-6, 3e-6), "<b>\x1b") if len(shape) == 2 else Profile(heights, 1e-3, "<b>")
    shown = made._repr_html_()
    what = "Height map" if len(shape) == 2 else "Profile"
    assert f"<strong>{what}.</strong> {' × '.join(map(str, shape))} points, " in shown
    assert "&lt;b&gt;" in shown
    assert "\x1b" not in shown
    assert f"rms height {1e6 * np.nanstd(heights):.4g} µm" in shown
    assert f"{100 / heights.size:.2g} % without a height" in shown
    assert base64.b64decode(shown.partition("base64,")[2].partition('"')[0]).startswith(b"\x89PNG")
