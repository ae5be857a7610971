import warnings

import numpy as np
import pytest
from numpy.testing import assert_allclose

from asperity import BallOnBeam
from asperity.errors import CaseError, InputError, MissingPointsWarning, ShortRecordWarning
from asperity.surfaces.cleaning import fill
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.levelling import band_limit, fit_form, level, remove_form, resample

UM = 1e-6


def make_map(function, shape=(60, 40), spacing=(2 * UM, 3 * UM)):
    x, y = (np.arange(n) * s for n, s in zip(shape, spacing, strict=True))
    return HeightMap(function(x[:, None], y[None, :]) + np.zeros(shape), spacing)


def with_holes(surface, seed=0, share=0.1):
    heights = np.array(surface.heights)
    heights[np.random.default_rng(seed).random(heights.shape) < share] = np.nan
    return type(surface)(heights, surface.spacing)


@pytest.mark.parametrize(("word", "degree"), [("plane", 1), ("quadratic", 2)])
def test_a_form_has_one_word_in_cases_and_in_python_and_its_degree_is_understood(word, degree):
    """A case writes the word, whichever it was given."""
    rough = HeightMap(np.random.default_rng(2).standard_normal((30, 20)) * UM, (UM, UM))
    assert np.array_equal(rough.levelled(word).heights, rough.levelled(degree).heights)
    cases = [BallOnBeam(surface={"file": rough, "form": form}) for form in (word, degree)]
    assert [case.surface.form for case in cases] == [word, word]
    for form in (True, 0, 3, "sphere", 2.0, None):
        with pytest.raises(CaseError, match=r'surface\.form: .*allowed: "plane", "quadratic"'):
            BallOnBeam(surface={"file": rough, "form": form})


@pytest.mark.parametrize("degree", [0, 1, 2])
def test_level_removes_its_polynomial_exactly_with_points_missing(degree):
    slope = (degree > 0) * np.array([0.01, -0.02])
    bow = (degree > 1) * np.array([30.0, -50.0, 20.0])
    surface = make_map(
        lambda x, y: 5 * UM + slope[0] * x + slope[1] * y + bow[0] * x * x + bow[1] * x * y + bow[2] * y * y
    )
    left = level(with_holes(surface), degree).heights
    assert 0.05 < np.isnan(left).mean() < 0.15
    assert_allclose(left[np.isfinite(left)], 0.0, atol=1e-19)


def test_level_is_a_projection_and_leaves_zero_mean():
    rough = HeightMap(np.random.default_rng(2).standard_normal((30, 20)) * UM, (UM, UM))
    once = level(rough, 2)
    assert_allclose(once.heights.mean(), 0.0, atol=1e-20)
    assert_allclose(level(once, 2).heights, once.heights, atol=1e-19)


def test_level_a_profile():
    line = Profile(3.0 + 0.2 * np.arange(50.0), 1.0)
    assert_allclose(level(line).heights, 0.0, atol=1e-13)


def test_level_says_which_degrees_there_are():
    with pytest.raises(InputError, match="degree: received 3"):
        level(Profile([1.0, 2.0, 3.0, 4.0, 5.0], 1.0), 3)
    with pytest.raises(InputError, match="2 valid points"):
        level(Profile([1.0, 2.0, np.nan], 1.0), 2)


@pytest.mark.parametrize("radius", [25e-3, -2e-3])
def test_sphere_is_found_and_removed(radius):
    centre, top = np.array([40e-6, 90e-6]), 7 * UM

    def cap(x, y):
        square = (x - centre[0]) ** 2 + (y - centre[1]) ** 2
        return top + np.sign(radius) * (np.sqrt(radius**2 - square) - abs(radius))

    ball = with_holes(make_map(cap))
    assert_allclose(fit_form(ball, "sphere").radius, radius, rtol=1e-6)
    left = remove_form(ball, "sphere").heights
    assert np.nanmax(np.abs(left)) < 1e-14


def test_steep_sphere_is_no_paraboloid():
    ball = make_map(lambda x, y: np.sqrt((0.2e-3) ** 2 - (x - 60 * UM) ** 2 - (y - 50 * UM) ** 2))
    assert_allclose(fit_form(ball, "sphere").radius, 0.2e-3, rtol=1e-6)
    assert np.abs(remove_form(ball, "polynomial", degree=2).heights).max() > 1e-7


def test_cylinder_in_any_direction_of_the_plane():
    def roller(x, y):
        across = x * np.cos(0.4) + y * np.sin(0.4) - 70 * UM
        return np.sqrt(1e-3**2 - across**2)

    surface = make_map(roller)
    assert_allclose(fit_form(surface, "cylinder").radius, 1e-3, rtol=1e-6)
    assert np.abs(remove_form(surface, "cylinder").heights).max() < 1e-13


def test_circle_of_a_profile():
    x = np.linspace(-1e-4, 1e-4, 81)
    line = Profile(np.sqrt(4e-3**2 - (x - 2e-5) ** 2), x[1] - x[0])
    assert_allclose(fit_form(line).radius, 4e-3, rtol=1e-6)
    assert np.abs(remove_form(line).heights).max() < 1e-14


def test_roughness_survives_form_removal():
    ripple = make_map(lambda x, y: 0.1 * UM * np.sin(2 * np.pi * x / (12 * UM)) + 0.0 * y)
    ball = make_map(lambda x, y: -((x - 60 * UM) ** 2 + (y - 60 * UM) ** 2) / (2 * 25e-3))
    left = remove_form(HeightMap(ripple.heights + ball.heights, ball.spacing)).heights
    assert_allclose(left, ripple.heights, atol=0.01 * UM)


def test_form_says_what_is_wrong():
    flat = make_map(lambda x, y: 0.0 * x * y)
    with pytest.raises(InputError, match="no curvature"):
        remove_form(flat, "sphere")
    with pytest.raises(InputError, match="form: received 'cone'"):
        remove_form(flat, "cone")
    with pytest.raises(InputError, match="degree: received 13"):
        remove_form(flat, "polynomial", degree=13)


def inner_amplitude(line, wavelength):
    x = line.x
    inner = slice(line.shape[0] // 4, -line.shape[0] // 4)
    basis = np.stack([np.sin(2 * np.pi * x / wavelength), np.cos(2 * np.pi * x / wavelength)], axis=1)
    return np.linalg.lstsq(basis[inner], line.heights[inner], rcond=None)[0]


@pytest.mark.parametrize("ratio", [0.5, 1.0, 2.0])
def test_gaussian_transmission_with_zero_phase(ratio):
    cut_off, wavelength = 80 * UM, 80 * UM * ratio
    x = np.arange(4000) * UM
    line = Profile(np.sin(2 * np.pi * x / wavelength), UM)
    expected = np.exp(-np.log(2.0) / ratio**2)  # ISO 16610-21
    assert_allclose(inner_amplitude(band_limit(line, shortest=cut_off), wavelength), [expected, 0], atol=1e-5)
    assert_allclose(
        inner_amplitude(band_limit(line, longest=cut_off), wavelength), [1 - expected, 0], atol=1e-5
    )


def test_areal_gaussian_halves_a_wave_at_the_cut_off_in_any_direction():
    size, step, wave = 256, UM, 20 * UM
    x, y = np.meshgrid(np.arange(size) * step, np.arange(size) * step, indexing="ij")
    for angle in (0.0, 0.7):
        wavy = np.sin(2 * np.pi * (x * np.cos(angle) + y * np.sin(angle)) / wave)
        left = band_limit(HeightMap(wavy, (step, step)), shortest=wave).heights
        inner = (slice(64, 192),) * 2
        assert_allclose(left[inner], 0.5 * wavy[inner], atol=2e-5)


def test_band_limit_keeps_a_constant_and_missing_points():
    surface = with_holes(make_map(lambda x, y: 4 * UM + 0.0 * x * y))
    low = band_limit(surface, shortest=20 * UM).heights
    assert_allclose(low[np.isfinite(low)], 4 * UM, rtol=1e-12)
    assert (np.isnan(low) == np.isnan(surface.heights)).all()


def test_band_limit_says_what_is_wrong():
    line = Profile(np.zeros(100), UM)
    with pytest.raises(
        InputError, match="shortest wavelength: received 1e-06; allowed: at least two samples, 2e-06 m"
    ):
        band_limit(line, shortest=UM)
    with pytest.raises(InputError, match="shortest < longest"):
        band_limit(line, longest=10 * UM, shortest=20 * UM)
    with pytest.warns(ShortRecordWarning, match="exceeds the surface"):
        band_limit(line, longest=200 * UM)


def test_fill_restores_a_harmonic_surface():
    surface = make_map(lambda x, y: (x * x - y * y) / 1.0 + 0.3 * x * y)
    holed = np.array(surface.heights)
    holed[20:28, 10:16] = np.nan
    holed[3, 3] = np.nan
    filled = fill(HeightMap(holed, surface.spacing, "patch"))
    assert_allclose(filled.heights, surface.heights, atol=1e-20)
    assert filled.source == "patch; 2.04% of the points filled"


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


def test_fill_leaves_a_complete_surface_alone():
    surface = make_map(lambda x, y: x + y)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert fill(surface) is surface


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


def test_resample_removes_what_would_alias():
    x = (np.arange(512) + 0.5) / 512
    short = HeightMap(np.cos(np.pi * 114 * x)[:, None] * np.ones(64), (UM, UM))  # 8.98 µm
    left = resample(short, (8 * UM, UM)).heights
    assert left.shape == (64, 64)
    assert_allclose(left, 0.0, atol=1e-12)


def test_resample_keeps_the_mean_and_says_what_is_wrong():
    rough = HeightMap(np.random.default_rng(0).standard_normal((128, 96)), (UM, UM))
    assert_allclose(resample(rough, 4 * UM).heights.mean(), rough.heights.mean(), atol=1e-3)
    with pytest.raises(InputError, match="spacing"):
        resample(rough, 60 * UM)
    with pytest.raises(InputError, match="Use fill first"):
        resample(with_holes(rough), 4 * UM)
