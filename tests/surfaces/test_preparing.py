"""Form, band, grid and direction of measured surfaces; missing points are filled, and spikes found."""

import tracemalloc

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.sparse import linalg

from asperity import BallOnBeam, HeightMap, Profile, read_surface
from asperity.errors import CaseError, MissingPointsWarning, ShortRecordWarning
from asperity.surfaces.cleaning import _local_median, fill, spikes, without_spikes
from asperity.surfaces.levelling import band_limit, level, resample
from asperity.surfaces.rotation import inscribed, rotated
from asperity.surfaces.spectra import texture_direction
from asperity.surfaces.synthesis import self_affine
from refusals import refusals

UM = 1e-6


def make_map(function, shape=(60, 40), spacing=(2 * UM, 3 * UM)):
    x, y = (np.arange(n) * s for n, s in zip(shape, spacing, strict=True))
    return HeightMap(function(x[:, None], y[None, :]) + np.zeros(shape), spacing)


def with_holes(surface, share=0.1):
    heights = np.array(surface.heights)
    heights[np.random.default_rng(0).random(heights.shape) < share] = np.nan
    return type(surface)(heights, surface.spacing)


ROUGH = HeightMap(np.random.default_rng(2).standard_normal((64, 48)) * UM, (UM, UM))
FLAT = HeightMap(np.zeros((20, 20)), (UM, UM))


@pytest.mark.parametrize(("word", "degree"), [("plane", 1), ("quadratic", 2), ("quartic", 4)])
def test_a_form_has_one_word_in_cases_and_in_python_where_its_degree_is_understood(word, degree):
    assert np.array_equal(ROUGH.levelled(word).heights, ROUGH.levelled(degree).heights)
    assert BallOnBeam(surface={"file": ROUGH, "form": word}).surface.form == word
    for form in (True, degree, 0, "sphere", 2.0, None):
        with pytest.raises(CaseError, match=r'surface\.form: .*allowed: "plane", "quadratic", "quartic"'):
            BallOnBeam(surface={"file": ROUGH, "form": form})


@pytest.mark.parametrize("degree", [0, 1, 2, 4])
def test_level_removes_its_polynomial_exactly_with_points_missing(degree):
    slope = (degree > 0) * np.array([0.01, -0.02])
    bow = (degree > 1) * np.array([30.0, -50.0, 20.0])
    steep = (degree > 2) * 3e8
    surface = make_map(
        lambda x, y: (
            5 * UM
            + slope[0] * x
            + slope[1] * y
            + bow[0] * x * x
            + bow[1] * x * y
            + bow[2] * y * y
            + steep * x * x * y * (x - y)
        )
    )
    left = level(with_holes(surface), degree).heights
    assert 0.05 < np.isnan(left).mean() < 0.15
    assert_allclose(left[np.isfinite(left)], 0.0, atol=1e-19)
    line = level(surface.line(), degree).heights
    assert_allclose(line, 0.0, atol=1e-19)


@pytest.mark.parametrize("ratio", [0.5, 1.0, 2.0])
def test_gaussian_transmission_with_zero_phase(ratio):
    """exp(−ln 2 (λc/λ)²) of ISO 16610-21 for lines, and for maps in any direction."""
    expected, wave = np.exp(-np.log(2.0) / ratio**2), 40 * UM
    wavy = [Profile(np.sin(2 * np.pi * np.arange(1000) * UM / wave), UM)]
    for cos, sin in ((1.0, 0.0), (0.8, 0.6)):
        made = make_map(lambda x, y, c=cos, s=sin: np.sin(2 * np.pi * (x * c + y * s) / wave), (256, 200))
        wavy.append(made)
    for surface in wavy:
        inner = (slice(100, -100), slice(60, -60))[: surface.heights.ndim]
        low, high = (
            band_limit(surface, **{limit: wave / ratio}).heights[inner] for limit in ("shortest", "longest")
        )
        assert_allclose(low, expected * surface.heights[inner], atol=2e-5)
        assert_allclose(high, (1 - expected) * surface.heights[inner], atol=2e-5)


def test_band_limit_keeps_a_constant_and_missing_points():
    surface = with_holes(make_map(lambda x, y: 4 * UM + 0.0 * x * y))
    low = band_limit(surface, shortest=20 * UM).heights
    assert_allclose(low[np.isfinite(low)], 4 * UM, rtol=1e-12)
    assert (np.isnan(low) == np.isnan(surface.heights)).all()


@pytest.mark.parametrize("new", [8.0, 4.0, 1.0])
def test_resample_keeps_waves_that_fit(new):
    points, step = 512, 1.5625 * UM
    length = points * step
    x = (np.arange(points) + 0.5) * step
    wave = np.cos(2 * np.pi * 20.5 * x / length)  # even at both edges, 39 µm long
    resampled = resample(Profile(wave, step), new * UM)
    centres = (np.arange(resampled.shape[0]) + 0.5) * new * UM
    assert resampled.shape[0] == int(length / (new * UM))
    assert_allclose(resampled.heights, np.cos(2 * np.pi * 20.5 * centres / length), atol=2e-3)


def test_resample_removes_what_would_alias_and_keeps_the_mean():
    x = (np.arange(512) + 0.5) / 512
    short = HeightMap(3.0 + np.cos(np.pi * 114 * x)[:, None] * np.ones(64), (UM, UM))  # 8.98 µm
    left = resample(short, (8 * UM, UM)).heights
    assert left.shape == (64, 64)
    assert_allclose(left, 3.0, atol=1e-12)


def wave(angle, wavelength=12 * UM, shape=(160, 120)):
    """Crests at right angles to a direction, degrees from x towards y."""
    cos, sin = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    return make_map(lambda x, y: np.sin(2 * np.pi * (x * cos + y * sin) / wavelength), shape, (UM, UM))


def test_quarter_turns_move_points_and_change_none():
    """Rolling along +y: the first axis runs along y, and what lay at small x lies at large y'."""
    heights = np.random.default_rng(0).normal(size=(5, 3))
    heights[1, 2] = np.nan
    surface = HeightMap(heights, (UM, 2 * UM))
    along_y = rotated(surface, np.pi / 2)
    assert along_y.spacing == (2 * UM, UM)
    assert_array_equal(along_y.heights, heights[::-1].T)
    assert_array_equal(rotated(surface, np.pi).heights, heights[::-1, ::-1])
    assert_array_equal(rotated(surface, -np.pi / 2).heights, heights[:, ::-1].T)
    assert_array_equal(rotated(surface, 0.0).heights, heights)


@pytest.mark.parametrize("direction", [30.0, -50.0, 120.0])
def test_a_wave_along_the_direction_becomes_a_wave_along_x(direction):
    """Of known phase, the same at all places across; and Std turns against the direction."""
    turned = rotated(wave(direction), np.radians(direction))
    middle = np.array([159, 119]) * UM / 2 @ [np.cos(np.radians(direction)), np.sin(np.radians(direction))]
    n = turned.shape[0]
    place = middle + UM * (np.arange(n) - 0.5 * (n - 1))
    expected = np.sin(2 * np.pi * place / (12 * UM))[:, None]
    assert_allclose(turned.heights, np.broadcast_to(expected, turned.shape), atol=4e-3)
    after = np.degrees(texture_direction(rotated(wave(40.0), np.radians(direction))))
    assert (after - (40.0 - direction) + 90) % 180 - 90 == pytest.approx(0.0, abs=2.5)


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


def test_planes_turn_exactly_and_nothing_lies_beyond_the_points():
    surface = make_map(lambda x, y: 3 * x - y + 7 * UM, (40, 30), (UM, 2 * UM))
    turned = rotated(surface, np.radians(20.0))
    assert turned.spacing == (UM, UM)
    gradient = [np.diff(turned.heights, axis=axis) / UM for axis in (0, 1)]
    cos, sin = np.cos(np.radians(20)), np.sin(np.radians(20))
    assert_allclose(gradient[0], 3 * cos - sin, rtol=1e-9)
    assert_allclose(gradient[1], -3 * sin - cos, rtol=1e-9)
    assert rotated(wave(10.0, shape=(101, 101)), np.pi / 4).shape == (71, 71)  # sides of 100/√2 steps


LINE = Profile(np.zeros(100), UM)


test_what_is_wrong_is_said = refusals(
    (lambda: level(LINE, 3), "degree: received 3"),
    (lambda: level(Profile([1.0, 2.0, np.nan], 1.0), 2), "2 valid points"),
    (lambda: band_limit(LINE, shortest=UM), "shortest wavelength: received 1e-06; allowed: at least two"),
    (lambda: band_limit(LINE, longest=10 * UM, shortest=20 * UM), "shortest < longest"),
    (lambda: resample(ROUGH, 60 * UM), "spacing"),
    (lambda: resample(with_holes(ROUGH), 4 * UM), "Use fill first"),
    (lambda: rotated(HeightMap(np.eye(90, 2), UM), np.pi / 4), "received 45 degrees on a map of 90 x 2"),
    (lambda: rotated(FLAT, np.inf), "a finite angle"),
    (lambda: rotated(with_holes(ROUGH), 0.1), "complete heights, or quarter turns"),
)


def test_a_filter_longer_than_the_surface_is_doubted():
    with pytest.warns(ShortRecordWarning, match="exceeds the surface") as caught:
        band_limit(LINE, longest=200 * UM)
    assert caught[0].filename == __file__  # who asked, not where it was found


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


@pytest.mark.filterwarnings("ignore::asperity.errors.MissingPointsWarning")
@pytest.mark.parametrize(("shape", "across"), [("square", 1.0), ("ring", 0.1), ("scattered", 2.5)])
def test_large_holes_of_any_shape_take_the_memory_of_a_few_maps(shape, across, monkeypatch):
    """Factors of a direct solution fill in with size, where Python does not count: none is of many points."""
    x, y = np.arange(200)[:, None] * SPACING, np.arange(200) * across * SPACING
    exact = x * x - y * y + 3.0 * x * y + 1e-3 * x + 2e-3
    missing = np.zeros(exact.shape, dtype=bool)
    missing[20:190, 10:190] = True
    if shape == "ring":
        missing[100:160, 100:160] = False
    elif shape == "scattered":
        missing &= np.random.default_rng(0).random(exact.shape) < 0.6
    factored = []
    for name in ("splu", "spsolve"):
        direct = getattr(linalg, name)
        monkeypatch.setattr(
            linalg, name, lambda a, *b, direct=direct: factored.append(a.shape[0]) or direct(a, *b)
        )
    holed = HeightMap(np.where(missing, np.nan, exact), (SPACING, across * SPACING))
    tracemalloc.start()
    try:
        filled = fill(holed)
        assert tracemalloc.get_traced_memory()[1] < 60 * holed.heights.nbytes
    finally:
        tracemalloc.stop()
    assert max(factored) < 0.75 * missing.sum()
    assert_allclose(filled.heights, exact, rtol=0.0, atol=1e-10 * np.ptp(exact))


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
    step = 20e-6 * (np.arange(200) >= 100)[:, None]  # beside it 7 of 30 draws have a spike, without it none
    return texture(seed=2) + step + 0.05 * x[:, None] + x[None, :] ** 2 / 20e-3


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


def test_points_are_held_against_the_median_of_what_is_known_around_them():
    """As NumPy has it, of odd and of even numbers; where nothing is known there is none."""
    surface = make_map(lambda x, y: np.sin(9e4 * x) * np.cos(7e4 * y + x / UM))
    heights = np.array(with_holes(surface, 0.45).heights)
    heights[20:27, 10:17] = np.nan
    found = _local_median(heights)
    for i, j in np.ndindex(found[2:-2, 2:-2].shape):
        around = heights[i : i + 5, j : j + 5]
        known = around[np.isfinite(around)]
        assert_allclose(found[i + 2, j + 2], np.median(known) if known.size else np.nan, rtol=1e-12)


def test_spikes_are_taken_away_before_points_are_filled(tmp_path):
    heights = texture()
    heights[20, 30] += 9e-6
    heights[60, 70:73] = np.nan
    np.save(tmp_path / "plate.npy", heights * 1e6)
    hints = {"height_unit": "um", "pixel": "2 um", "fill": True}
    with pytest.warns(MissingPointsWarning, match=r"4 points .* \(1 of them was a spike\); interpolated"):
        filled = read_surface(tmp_path / "plate.npy", spikes=True, **hints)
    assert abs(filled.heights[20, 30] - texture()[20, 30]) < 0.1e-6
    assert filled.source.startswith("plate.npy; 1 point of spikes removed; ")
    with pytest.warns(MissingPointsWarning, match="3 points"):
        kept = read_surface(tmp_path / "plate.npy", **hints)
    assert kept.heights[20, 30] > 7e-6
