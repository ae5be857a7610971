import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from asperity.errors import CoarseSamplingWarning, InputError, MissingPointsWarning
from asperity.reference import cnossos
from asperity.spectra import energy_sum
from asperity.surfaces.bands import band_levels_of, check_levels
from asperity.surfaces.heightmap import Profile
from asperity.surfaces.measured_lines import process, remove_spikes, roll_over, trim
from like_measured import either, wheel_lines

MM, UM = 1e-3, 1e-6


def spike(height, width, points=401, spacing=MM):
    """Triangle on a flat line."""
    x = (np.arange(points) - points // 2) * spacing
    return Profile(height * np.clip(1 - np.abs(x) / (width / 2), 0, None), spacing)


def test_missing_ends_are_trimmed():
    line, cut = trim(Profile([np.nan, np.nan, 1.0, np.nan, 2.0, np.nan], MM))
    assert cut == (2, 1)
    assert_array_equal(line.heights, [1.0, np.nan, 2.0])
    whole = Profile([1.0, 2.0], MM)
    assert trim(whole) == (whole, (0, 0))


@pytest.mark.parametrize(
    ("height", "width", "gone"),
    [
        (40 * UM, 6 * MM, True),  # w²/3 m = 12 µm
        (10 * UM, 6 * MM, False),  # lower than that
        (13 * UM, 6 * MM, False),  # r'' = -8.7e6 µm/m²
        (20 * UM, 6 * MM, True),  # r'' = -13e6 µm/m²
        (20 * UM, 10 * MM, False),  # w²/3 m = 33 µm
    ],
)
def test_spikes_go_by_curvature_and_width(height, width, gone):
    line = spike(height, width)
    cleaned, spikes, points = remove_spikes(line)
    assert spikes == int(gone)
    assert_allclose(cleaned.heights.max(), 0.0 if gone else height, atol=1e-15)
    assert points == (width / MM - 1 if gone else 0)


def test_pits_and_smooth_waves_are_no_spikes():
    pit = Profile(-spike(100 * UM, 4 * MM).heights, MM)
    assert remove_spikes(pit)[1] == 0
    wave = Profile(50 * UM * np.sin(2 * np.pi * np.arange(2000) / 100), MM)
    cleaned, spikes, _ = remove_spikes(wave)
    assert spikes == 0
    assert_array_equal(cleaned.heights, wave.heights)


def test_two_spikes_on_a_wave_are_counted_and_cut_to_the_wave():
    wave = 5 * UM * np.sin(2 * np.pi * np.arange(2000) / 250)
    rough = wave.copy()
    rough[[500, 1200]] += 60 * UM
    cleaned, spikes, points = remove_spikes(Profile(rough, MM))
    assert (spikes, points >= 2) == (2, True)
    assert_allclose(cleaned.heights, wave, atol=2 * UM)


def test_circle_rests_on_a_point_with_its_own_arc():
    heights = np.zeros(401)
    heights[200] = 30 * UM
    rolled = roll_over(Profile(heights, MM), 0.375)
    x = (np.arange(401) - 200) * MM
    arc = 30 * UM + np.sqrt(np.maximum(0.375**2 - x**2, 0)) - 0.375
    assert_allclose(rolled.heights, np.maximum(arc, 0.0), atol=1e-15)


def test_circle_bridges_a_narrow_slot_by_its_sagitta_only():
    heights = np.zeros(401)
    heights[190:211] = -1.0 * MM  # edges at 189 and 211: 22 mm wide
    rolled = roll_over(Profile(heights, MM), 0.375).heights
    assert_allclose(rolled.min(), np.sqrt(0.375**2 - 0.011**2) - 0.375)


def test_gentle_waves_pass_the_circle_and_rolling_twice_adds_nothing_below_a_line():
    wave = Profile(20 * UM * np.sin(2 * np.pi * np.arange(3000) / 300), MM)  # curvature 0.009/m
    assert_allclose(roll_over(wave).heights, wave.heights, atol=1e-12)
    rough = Profile(np.random.default_rng(2).standard_normal(2000) * 5 * UM, MM)
    rolled = roll_over(rough)
    assert (rolled.heights >= rough.heights).all()
    assert_allclose(rolled.heights.max(), rough.heights.max())


def test_larger_circles_rise_higher():
    rough = Profile(np.random.default_rng(2).standard_normal(2000) * 5 * UM, MM)
    small, large = (roll_over(rough, r).heights for r in (0.1, 0.375))
    assert (large >= small).all()


def test_every_switch_is_recorded_with_what_it_did():
    heights = 2 * UM * np.random.default_rng(5).standard_normal(1000)
    heights[300] += 80 * UM
    heights[:4], heights[600:603] = np.nan, np.nan
    line, done = process(Profile(heights, MM), fill_gaps=True)
    assert (done.trimmed, done.fill, done.filled) == ((4, 0), True, 3)
    assert (done.spikes, done.curvature, done.radius) == (True, True, 0.375)
    assert done.spikes_removed >= 1
    assert done.spike_points >= 1
    assert 0.0 < done.lifted < 1.0
    assert done.largest_lift > 0.0
    assert len(line.heights) == 996
    text = str(done)
    for part in ("4 missing points", "3 points filled", "spikes (", "circle of 0.375 m", "lifted"):
        assert part in text


def test_switches_left_off_leave_the_line_alone():
    line = spike(80 * UM, 4 * MM)
    same, done = process(line, spikes=False, curvature=False)
    assert_array_equal(same.heights, line.heights)
    assert (done.spikes_removed, done.spike_points, done.lifted, done.largest_lift) == (0, 0, 0.0, 0.0)
    for part in ("gaps not filled", "spikes kept", "not rolled over"):
        assert part in str(done)
    assert process(line, curvature=False)[1].spikes_removed == 1


def test_gaps_inside_are_refused_unless_filled():
    heights = np.zeros(100)
    heights[40:60] = np.nan
    with pytest.raises(InputError, match="20 missing points inside"):
        process(Profile(heights, MM))
    with pytest.warns(MissingPointsWarning):
        process(Profile(heights, MM), fill_gaps=True)


def test_coarse_spacing_is_doubted():
    with pytest.warns(CoarseSamplingWarning, match="spacing 2 mm, more than the 1 mm"):
        process(Profile(np.zeros(100), 2 * MM))


@pytest.mark.parametrize("function", [remove_spikes, roll_over])
def test_missing_points_are_refused(function):
    heights = np.zeros(2000)
    heights[5] = np.nan
    with pytest.raises(InputError, match="missing points"):
        function(Profile(heights, MM))


def test_radius_of_the_circle_is_checked():
    with pytest.raises(InputError, match="radius of the circle: received 0"):
        roll_over(Profile(np.zeros(10), MM), 0.0)


@either
@pytest.mark.parametrize("depth", [0.2, 0.4, 0.6])
def test_measured_wheel_lines_keep_their_flat_and_plausible_levels(measured, depth):
    raw = wheel_lines(depth, measured=measured) * UM
    lines, records = zip(*(process(Profile(z, MM)) for z in raw), strict=True)
    assert all(
        r.trimmed[0] == 0 and sum(r.trimmed) + line.shape[0] == raw.shape[1]
        for r, line in zip(records, lines, strict=True)
    )
    deepest = -min(line.heights.min() for line in lines)
    assert 0.4 * depth * MM < deepest < 2.5 * depth * MM
    check_levels(lines, "wheel")
    found = [band_levels_of(line, segment=1.0) for line in lines]
    wavelength, level = found[0][0], energy_sum([one for _, one in found], axis=0) - 10 * np.log10(len(found))
    smooth = cnossos.wheel_roughness("disc")[1][-10]  # -10 dB at 6.3 mm
    short = level[(wavelength < 12 * MM) & (wavelength > 3 * MM)]
    assert ((short > smooth - 25) & (short < smooth + 25)).all()
    with pytest.raises(InputError, match="levels of the wheel"):
        check_levels([Profile(z.heights / UM, MM) for z in lines], "wheel")
