"""Maps laid out along another direction: exact quarter turns, known signs, nothing made up."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from asperity.errors import InputError
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.spectra import texture_direction
from asperity.surfaces.steps import inscribed, rotated

UM = 1e-6


def wave(angle, wavelength=12 * UM, shape=(160, 120), spacing=(UM, UM)):
    """Crests at right angles to a direction, degrees from x towards y."""
    x, y = (np.arange(n) * d for n, d in zip(shape, spacing, strict=True))
    across = x[:, None] * np.cos(np.radians(angle)) + y * np.sin(np.radians(angle))
    return HeightMap(np.sin(2 * np.pi * across / wavelength), spacing)


def test_quarter_turns_move_points_and_change_none():
    """Rolling along +y: the first axis runs along y, and what lay at small x lies at large y'."""
    heights = np.random.default_rng(0).normal(size=(5, 3))
    heights[1, 2] = np.nan
    surface = HeightMap(heights, (UM, 2 * UM))
    along_y = rotated(surface, np.pi / 2)
    assert along_y.spacing == (2 * UM, UM)
    for i in range(3):
        for j in range(5):
            assert_array_equal(along_y.heights[i, j], heights[4 - j, i])
    assert_array_equal(rotated(surface, np.pi).heights, heights[::-1, ::-1])
    assert_array_equal(rotated(surface, -np.pi / 2).heights, rotated(surface, 1.5 * np.pi).heights)
    assert_array_equal(rotated(rotated(surface, np.pi / 2), -np.pi / 2).heights, heights)
    assert_array_equal(rotated(surface, 0.0).heights, heights)


@pytest.mark.parametrize("direction", [30.0, -50.0, 120.0])
def test_a_wave_along_the_direction_becomes_a_wave_along_x(direction):
    """Crests at right angles to the direction: all heights of a row are then the same, and of known phase."""
    turned = rotated(wave(direction), np.radians(direction))
    assert_allclose(np.ptp(turned.heights, axis=1), 0.0, atol=5e-3)
    middle = np.array([159, 119]) * UM / 2 @ [np.cos(np.radians(direction)), np.sin(np.radians(direction))]
    n = turned.shape[0]
    place = middle + UM * (np.arange(n) - 0.5 * (n - 1))
    assert_allclose(turned.heights[:, 5], np.sin(2 * np.pi * place / (12 * UM)), atol=3e-3)


@pytest.mark.parametrize("direction", [25.0, 70.0])
def test_std_turns_against_the_direction(direction):
    before = np.degrees(texture_direction(wave(40.0)))
    after = np.degrees(texture_direction(rotated(wave(40.0), np.radians(direction))))
    assert (after - (before - direction) + 90) % 180 - 90 == pytest.approx(0.0, abs=2.5)


@pytest.mark.parametrize("degrees", [1.0, 20.0, 45.0, 66.0, 89.0, 110.0, 200.0, 333.0])
@pytest.mark.parametrize("sides", [(3.0, 2.0), (2.0, 3.0), (10.0, 1.0), (1.0, 1.0)])
def test_the_rectangle_lies_inside_and_none_larger_does(sides, degrees):
    """Against a search over all rectangles about the middle."""
    cos, sin = abs(np.cos(np.radians(degrees))), abs(np.sin(np.radians(degrees)))
    a, b = inscribed(*sides, np.radians(degrees))
    assert a * cos + b * sin <= sides[0] * (1 + 1e-9)
    assert a * sin + b * cos <= sides[1] * (1 + 1e-9)
    tried = np.linspace(1e-6, min(sides[0] / cos, sides[1] / sin), 4001)
    fitting = np.minimum((sides[0] - tried * cos) / sin, (sides[1] - tried * sin) / cos)
    assert a * b == pytest.approx((tried * fitting).max(), rel=1e-3)


def test_a_square_turned_by_an_eighth_keeps_half_its_area():
    turned = rotated(wave(10.0, shape=(101, 101)), np.pi / 4)
    assert turned.shape == (71, 71)  # sides of 100/√2 steps


def test_planes_turn_exactly_and_nothing_lies_beyond_the_points():
    x, y = np.arange(40) * UM, np.arange(30) * 2 * UM
    turned = rotated(HeightMap(3 * x[:, None] - y + 7 * UM, (UM, 2 * UM)), np.radians(20.0))
    assert turned.spacing == (UM, UM)
    gradient = [np.diff(turned.heights, axis=axis) / UM for axis in (0, 1)]
    cos, sin = np.cos(np.radians(20)), np.sin(np.radians(20))
    assert_allclose(gradient[0], 3 * cos - sin, rtol=1e-9)
    assert_allclose(gradient[1], -3 * sin - cos, rtol=1e-9)


def test_points_beside_a_missing_one_are_missing_and_no_others():
    surface = wave(0.0)
    heights = np.array(surface.heights)
    heights[80, 60] = np.nan
    turned = rotated(HeightMap(heights, surface.spacing), np.radians(30))
    whole = rotated(surface, np.radians(30))
    gone = np.isnan(turned.heights)
    assert 1 <= gone.sum() <= 5  # four cells of the map hold less than five points of its own spacing
    assert_allclose(turned.heights[~gone], whole.heights[~gone], atol=0.05)


def test_a_direction_that_leaves_nothing_is_refused():
    with pytest.raises(InputError, match="direction: received 45 degrees on a map of 90 x 2"):
        rotated(HeightMap(np.eye(90, 2), (UM, UM)), np.pi / 4)
    with pytest.raises(InputError, match="a finite angle"):
        rotated(HeightMap(np.eye(9, 9), (UM, UM)), np.inf)
