"""HeightMap and Profile: what they accept, refuse and give back."""

import base64
import dataclasses

import numpy as np
import pytest

from asperity.errors import InputError
from asperity.surfaces.heightmap import HeightMap, Profile

HEIGHTS = np.arange(12.0).reshape(3, 4)


@pytest.fixture
def surface():
    return HeightMap(HEIGHTS, (1e-6, 2e-6), "made")


def test_heights_are_a_read_only_copy():
    original = HEIGHTS.copy()
    surface = HeightMap(original, (1.0, 1.0))
    original[0, 0] = 99.0
    assert surface.heights[0, 0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        surface.heights[0, 0] = 1.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        surface.spacing = (1.0, 1.0)


def test_a_read_only_view_of_a_writeable_array_is_copied():
    original = HEIGHTS.copy()
    view = original[:]
    view.flags.writeable = False
    surface = HeightMap(view, (1.0, 1.0))
    original[0, 0] = 99.0
    assert surface.heights[0, 0] == 0.0


def test_integers_become_floats_and_masked_points_missing():
    masked = np.ma.masked_equal(np.arange(4).reshape(2, 2), 3)
    surface = HeightMap(masked, 1.0)
    assert surface.heights.dtype == np.float64
    np.testing.assert_array_equal(surface.heights, [[0, 1], [2, np.nan]])
    assert surface.missing_share == 0.25
    assert surface.spacing == (1.0, 1.0)


def test_coordinates_and_size(surface):
    assert surface.shape == (3, 4)
    assert surface.size == pytest.approx((3e-6, 8e-6))
    np.testing.assert_allclose(surface.x, [0, 1e-6, 2e-6])
    np.testing.assert_allclose(surface.y, [0, 2e-6, 4e-6, 6e-6])


def test_line_runs_along_x(surface):
    np.testing.assert_array_equal(surface.line().heights, HEIGHTS[:, 2])
    np.testing.assert_array_equal(surface.line(0).heights, HEIGHTS[:, 0])
    assert surface.line().spacing == 1e-6
    assert surface.line().source == "made"


@pytest.mark.parametrize("index", [-1, 4])
def test_no_such_line(surface, index):
    with pytest.raises(InputError, match=r"index of a line of the map: received .*allowed: 0 to 3"):
        surface.line(index)


def test_crop_and_transpose(surface):
    piece = surface.crop((1e-6, 2e-6), (2e-6, 6e-6))
    np.testing.assert_array_equal(piece.heights, HEIGHTS[1:3, 1:4])
    turned = surface.transposed()
    np.testing.assert_array_equal(turned.heights, HEIGHTS.T)
    assert turned.spacing == (2e-6, 1e-6)


@pytest.mark.parametrize(
    ("start", "size"),
    [
        ((2e-6, 0), (2e-6, 4e-6)),
        ((-1e-6, 0), (2e-6, 4e-6)),
        ((0, 0), (1e-6, 4e-6)),
        ((np.nan, 0), (2e-6, 4e-6)),
    ],
)
def test_crop_outside_the_map(surface, start, size):
    with pytest.raises(InputError, match="piece of the map along x"):
        surface.crop(start, size)


@pytest.mark.parametrize(
    ("heights", "message"),
    [
        (np.zeros(3), r"shape \(3,\)"),
        (np.zeros((1, 3)), r"shape \(1, 3\)"),
        (np.zeros((2, 2), dtype=complex), "complex128"),
        (np.array([["a", "b"], ["c", "d"]]), "<U1"),
        ([[1.0, 2.0], [3.0]], "unequal length"),
        ([[1.0, np.inf], [0.0, 0.0]], "infinite"),
        (np.full((2, 2), np.nan), "every point is missing"),
    ],
)
def test_bad_heights(heights, message):
    with pytest.raises(InputError, match=message):
        HeightMap(heights, (1.0, 1.0))


@pytest.mark.parametrize("spacing", [0.0, -1.0, np.nan, np.inf, "a", None, (1.0, 0.0), (1.0, 1.0, 1.0)])
def test_bad_spacing(spacing):
    with pytest.raises(InputError, match="spacing of the height map"):
        HeightMap(np.zeros((2, 2)), spacing)


def test_profile():
    profile = Profile([0.0, 1.0, np.nan, 3.0], 1e-3, "wheel")
    assert profile.shape == (4,)
    assert profile.size == pytest.approx(4e-3)
    assert profile.missing_share == 0.25
    np.testing.assert_allclose(profile.x, [0, 1e-3, 2e-3, 3e-3])
    np.testing.assert_array_equal(profile.crop(1e-3, 3e-3).heights, [1.0, np.nan, 3.0])
    with pytest.raises(InputError, match="piece of the line"):
        profile.crop(2e-3, 3e-3)
    with pytest.raises(InputError, match="spacing of the profile"):
        Profile([0.0, 1.0], -1.0)
    with pytest.raises(InputError, match=r"heights of wheel: received an array of shape \(2, 2\)"):
        Profile(np.zeros((2, 2)), 1.0, "wheel")


def test_operations_delegate_to_levelling():
    x, y = np.meshgrid(np.arange(8.0), np.arange(6.0), indexing="ij")
    plane = HeightMap(3 * x - 2 * y + 1, (1.0, 1.0))
    assert abs(plane.levelled().heights).max() < 1e-12
    holed = plane.heights.copy()
    holed[3, 3] = np.nan
    assert HeightMap(holed, (1.0, 1.0)).filled().missing_share == 0
    assert plane.band_limited(shortest=3.0).shape == plane.shape
    slope = Profile(2 * np.arange(50.0), 1.0)
    assert abs(slope.levelled().heights).max() < 1e-12
    holed = slope.heights.copy()
    holed[20] = np.nan
    assert Profile(holed, 1.0).filled().heights[20] == pytest.approx(40.0)
    assert slope.band_limited(shortest=3.0).shape == slope.shape


@pytest.mark.parametrize("shape", [(40, 30), (2000, 20), (500,)])
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
    assert f"{1 / heights.size:.2%} without a height" in shown
    assert base64.b64decode(shown.partition("base64,")[2].partition('"')[0]).startswith(b"\x89PNG")
