"""Measured lines: processed after EN 15610, brought into register, laid out as a strip."""

import tracemalloc

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from asperity.errors import CoarseSamplingWarning, MissingPointsWarning
from asperity.reference import cnossos
from asperity.spectra import band_levels, energy_sum, psd
from asperity.surfaces import measured_lines
from asperity.surfaces.bands import band_levels_of, from_bands, strip_from_bands
from asperity.surfaces.heightmap import Profile
from asperity.surfaces.measured_lines import bring_into_register, process, remove_spikes, roll_over, trim
from asperity.surfaces.statistics import profile_statistics
from like_measured import either, wheel_lines
from refusals import refusals

MM, UM = 1e-3, 1e-6
WAVE = 5 * UM * np.sin(2 * np.pi * np.arange(2000) / 250)
ROUGH = 5 * UM * np.random.default_rng(2).standard_normal(2000)


def spike(height, width, points=401):
    """Triangle on a flat line."""
    x = (np.arange(points) - points // 2) * MM
    return Profile(height * np.clip(1 - np.abs(x) / (width / 2), 0, None), MM)


def test_missing_ends_are_trimmed():
    line = trim(Profile([np.nan, np.nan, 1.0, np.nan, 2.0, np.nan], MM))
    assert_array_equal(line.heights, [1.0, np.nan, 2.0])
    assert_array_equal(trim(line).heights, line.heights)


@pytest.mark.parametrize(("height", "width", "gone"), [
    (10 * UM, 6 * MM, False),  # lower than w²/3 m = 12 µm
    (13 * UM, 6 * MM, False),  # r'' = -8.7e6 µm/m²
    (20 * UM, 6 * MM, True),  # r'' = -13e6 µm/m²
    (20 * UM, 10 * MM, False),  # w²/3 m = 33 µm
    (-100 * UM, 4 * MM, False),  # a pit
])  # fmt: skip
def test_spikes_go_by_curvature_and_width(height, width, gone):
    line = spike(height, width)
    cleaned, spikes, points = remove_spikes(line)
    assert (spikes, points) == (int(gone), width / MM - 1 if gone else 0)
    assert_allclose(cleaned.heights, 0.0 if gone else line.heights, atol=1e-15)


def test_two_spikes_on_a_wave_are_counted_and_cut_to_the_wave():
    rough = WAVE.copy()
    rough[[500, 1200]] += 60 * UM
    cleaned, spikes, points = remove_spikes(Profile(rough, MM))
    assert (spikes, points >= 2) == (2, True)
    assert_allclose(cleaned.heights, WAVE, atol=2 * UM)
    assert remove_spikes(Profile(10 * WAVE, MM))[1] == 0


def test_gentle_waves_pass_the_circle_and_larger_ones_rise_higher():
    gentle = Profile(4 * WAVE, MM)  # curvature 0.013/m
    assert_allclose(roll_over(gentle).heights, gentle.heights, atol=1e-12)
    small, large = (roll_over(Profile(ROUGH, MM), radius).heights for radius in (0.1, 0.375))
    assert (small >= ROUGH).all()
    assert (large >= small).all()
    assert_allclose(large.max(), ROUGH.max())


def test_every_switch_is_recorded_with_what_it_did():
    heights = 0.4 * ROUGH[:1000]
    heights[300] += 80 * UM
    heights[:4], heights[600:603] = np.nan, np.nan
    lines, done = process([Profile(heights, MM), Profile(heights[:500], MM)], ("fill", "spikes", "curvature"))
    assert [len(line.heights) for line in lines] == [996, 496]
    cut = [remove_spikes(trim(Profile(heights[:n], MM)).filled()) for n in (1000, 500)]
    lift = [line.heights - each[0].heights for line, each in zip(lines, cut, strict=True)]
    share = np.mean([np.mean(each > 1e-12) for each in lift])
    expected = (
        "8 missing points trimmed at the ends; 3 points filled",
        f"{sum(each[1] for each in cut)} spikes ({sum(each[2] for each in cut)} points) removed",
        f"circle of 0.375 m: {share:.1%} of the points lifted, by up to {1e6 * max(map(max, lift)):.3g} µm",
    )
    assert min(each[1] for each in cut) >= 1
    assert 0.0 < share < 1.0
    for part in expected:
        assert part in done
    line = spike(80 * UM, 4 * MM)
    (same,), done = process([line], ())
    assert_array_equal(same.heights, line.heights)
    assert done.endswith(
        "0 missing points trimmed at the ends; gaps not filled; spikes kept; not rolled over"
    )


def test_coarse_lines_and_long_gaps_are_doubted():
    with pytest.warns(CoarseSamplingWarning, match="spacing 2 mm, more than the 1 mm"):
        process([Profile(np.zeros(100), 2 * MM)])
    with pytest.warns(MissingPointsWarning):
        process([HOLED], ["fill"])


def wheel_strip(lines):
    wavelengths, levels = (v[3:20] for v in cnossos.wheel_roughness("cast-iron"))
    return strip_from_bands((2880, lines), (MM, 5 * MM), wavelengths, levels, lateral=50.0, seed=7).heights.T


def test_lines_measured_to_and_fro_come_into_register():
    lines, shifts = wheel_strip(6), [0, 12, -7, 100, 3, 55]
    fro = [z[::-1] if k % 2 else z for k, z in enumerate(lines)]
    measured = [Profile(np.roll(z, shift), MM) for z, shift in zip(fro, shifts, strict=True)]
    found = bring_into_register(measured)
    assert_allclose(found.lines, lines, atol=1e-15)
    assert found.reversed == (False, True) * 3
    expected = np.diag(np.corrcoef(lines), 1)
    assert_allclose(found.correlations, [1.0, *expected])
    assert min(expected) > 0.5


def strip_from(lines, distance_across=4 * MM, shape_y=41, spacing_y=MM):
    return measured_lines.strip_from_lines(lines, distance_across, shape_y, spacing_y)


def test_strip_passes_through_its_lines_and_holds_beyond():
    lines = np.random.default_rng(1).standard_normal((5, 50))
    strip = strip_from(lines)  # 20 mm to either side, lines to 8 mm
    assert strip.shape == (50, 41)
    assert_allclose(strip[:, 12:29:4], lines.T, atol=1e-12)
    assert_allclose(strip[:, :12], np.repeat(lines[:1].T, 12, axis=1), atol=1e-12)
    assert_allclose(strip[:, 29:], np.repeat(lines[-1:].T, 12, axis=1), atol=1e-12)
    assert_array_equal(strip_from(lines[:1]), np.repeat(lines[:1].T, 41, axis=1))


def test_interpolation_across_is_exact_for_its_polynomials():
    y = (np.arange(6) - 2.5) * 4 * MM
    cubic = strip_from(np.repeat((y**3)[:, None], 3, axis=1), shape_y=21)
    assert_allclose(cubic[0], ((np.arange(21) - 10) * MM) ** 3, atol=1e-12)
    linear = strip_from(np.array([[0.0, 0.0], [1.0, 2.0]]), shape_y=5)
    assert_allclose(linear, np.linspace(0, 1, 5) * np.array([[1.0], [2.0]]))


def wheel(depth, measured):
    return [trim(Profile(z * UM, MM)) for z in wheel_lines(depth, measured=measured)]


@either
@pytest.mark.parametrize("depth", [0.2, 0.6])
def test_measured_wheel_lines_keep_their_flat_and_plausible_levels(measured, depth):
    lines, _ = process(wheel(depth, measured))
    deepest = -min(line.heights.min() for line in lines)
    assert 0.4 * depth * MM < deepest < 2.5 * depth * MM
    found = [band_levels_of(Profile(line, MM)) for line in measured_lines.common_length(lines)]
    wavelength, level = found[0][0], energy_sum([one for _, one in found], axis=0) - 10 * np.log10(len(found))
    smooth = cnossos.wheel_roughness("disc")[1][-10]  # -10 dB at 6.3 mm
    short = level[(wavelength < 12 * MM) & (wavelength > 3 * MM)]
    assert_allclose(short, smooth, atol=25.0)


@either
def test_flats_of_measured_wheels_come_to_lie_beside_each_other(measured):
    """The flat covers seven of the ten lines; rolled over, they lack the waves that tell to from fro."""
    lines = wheel(0.2, measured)
    for some, beside in ((lines, 7), (process(lines)[0], 5)):
        found = bring_into_register(some)
        assert found.reversed[:beside] == (5 * (False, True))[:beside]
        assert np.ptp(np.argmin(found.lines[:beside], axis=1)) <= 5


def test_third_octaves_stand_beside_the_limit():
    wavelengths, limit = (v[7:29] for v in cnossos.rail_roughness("iso3095"))
    line = from_bands(20000, 0.5 * MM, wavelengths, limit, seed=1)
    found = measured_lines.third_octaves([line])
    assert_allclose(found.wavelength[found.limited], wavelengths, rtol=0.025)
    assert_array_equal(found.limit[found.limited], limit)
    assert_allclose(found.measured[found.limited][9:], limit[9:], atol=1.0)  # of bands below 50 mm
    bridged = found.processed > found.measured + 0.5
    assert not bridged[found.limited].any()  # of smooth lines nothing is
    assert measured_lines.third_octaves([Profile(np.zeros(100), 0.2)]) is None


@pytest.mark.parametrize("overwrite", [False, True])
def test_a_line_is_processed_as_it_lies_and_levelled_afterwards(overwrite):
    """A circle on a slope touches elsewhere than on the level."""
    missing = 10 * [np.nan]  # what is cut off is not levelled with the rest
    bent = 1e-3 * np.arange(3000) * 0.5 * MM + 5 * UM * np.random.default_rng(1).normal(size=3000)
    line = Profile([*missing, *bent], 0.5 * MM)
    expected = process([Profile(bent, 0.5 * MM)])[0][0].levelled()
    found = measured_lines.third_octaves([line], overwrite=overwrite)
    _, density = psd(expected.heights, 0.5 * MM)
    wavenumber = np.fft.rfftfreq(3000, 0.5 * MM)
    _, levels = band_levels(wavenumber, density, UM)
    assert_allclose(found.processed, levels, atol=1e-6)


HOLED = Profile([*np.zeros(40), *20 * [np.nan], *np.zeros(40)], MM)


test_what_is_wrong_is_said = refusals(
    (lambda: process([HOLED]), "20 missing points inside"),
)


def dilated(line, radius=0.375):
    """Each point by what a circle around every other one says: the definition, by brute force."""
    number = np.arange(len(line.heights))
    away = np.abs(number[:, None] - number) * line.spacing
    circle = np.where(away <= radius, np.sqrt(np.maximum(radius**2 - away**2, 0.0)) - radius, -np.inf)
    return (line.heights + circle).max(axis=1)


@pytest.mark.parametrize("spacing", [1e-6, 1e-4, MM, 0.1])
@pytest.mark.parametrize("height", [UM, MM, 1.0])
def test_a_circle_rolls_as_by_its_definition_over_any_heights(spacing, height, monkeypatch):
    monkeypatch.setattr(measured_lines, "TOGETHER", 100)
    rng = np.random.default_rng(5)
    walk = np.cumsum(rng.standard_normal(701))
    bumps = np.where(rng.random(702) > 0.99, 5.0, 0.1 * rng.standard_normal(702))
    for heights in (walk / np.ptp(walk), rng.standard_normal(703), bumps, np.ones(5), np.arange(2.0)):
        line = Profile(height * heights, spacing)
        np.testing.assert_allclose(roll_over(line).heights, dilated(line), rtol=0, atol=2e-16)


class Looked:
    """An arc that counts how often it is looked at."""

    def __init__(self, arc):
        self.arc, self.count = arc, 0

    def __len__(self):
        return len(self.arc)

    def __getitem__(self, at):
        self.count += at.size
        return self.arc[at]


@pytest.mark.parametrize("size", [2_000, 32_000])
def test_rolling_takes_time_like_the_length_of_a_line(size):
    """However far the circle reaches: each point is looked at twice for each halving of their distances."""
    arc = Looked(-(np.linspace(0.0, 0.3, size) ** 2))
    heights = np.cumsum(np.random.default_rng(1).standard_normal(size))
    envelope = measured_lines._upper_envelope(heights, arc)
    assert arc.count < 2 * size * np.log2(size)
    assert (envelope >= heights).all()


def test_spikes_side_by_side_share_a_foot_and_go_as_one_by_one(monkeypatch):
    """Each from foot to foot by its own straight line, whatever is looked at in one go."""
    rng = np.random.default_rng(8)
    heights = WAVE + 0.3 * UM * rng.standard_normal(2000)
    at = [300, 302, 304, 1000, 1003, 1998]
    heights[at] += 60 * UM
    whole = remove_spikes(Profile(heights, MM))
    monkeypatch.setattr(measured_lines, "TOGETHER", 1)
    single = remove_spikes(Profile(heights, MM))
    assert_array_equal(whole[0].heights, single[0].heights)
    assert whole[1:] == single[1:]
    assert whole[1] == len(at)
    assert (whole[0].heights[at] < heights[at] - 50 * UM).all()


@pytest.mark.parametrize("together", [3, 8, 50])
def test_spikes_of_pieces_of_any_length_are_those_of_the_whole_line(together, monkeypatch):
    """Pieces end at feet, whose bends need a point on either side as it was."""
    draw = np.random.default_rng(together)
    for _ in range(20):
        heights = 2 * UM * draw.normal(size=300) * (draw.random(300) < 0.5)
        heights[draw.integers(0, 300, 12)] += 60 * UM
        whole = remove_spikes(Profile(heights, MM))
        monkeypatch.setattr(measured_lines, "TOGETHER", together)
        pieces = remove_spikes(Profile(heights, MM))
        monkeypatch.undo()
        assert_array_equal(pieces[0].heights, whole[0].heights)
        assert pieces[1:] == whole[1:]


@pytest.mark.parametrize(("evaluated", "most"), [
    (lambda line: measured_lines.third_octaves([line, line]), 2.0),
    (profile_statistics, 1.3),
])  # fmt: skip
def test_a_long_line_is_held_once_beside_itself(evaluated, most, monkeypatch):
    """Levelled, processed or sorted, in place; all else is pieces of it, and masks of a byte a point."""
    for name in ("levelling.PIECE", "statistics.PIECE", "measured_lines.TOGETHER"):
        monkeypatch.setattr(f"asperity.surfaces.{name}", 2**11)
    monkeypatch.setattr("asperity.ranks.TOGETHER", 2**11)
    monkeypatch.setattr("asperity.spectra.LONGEST_SEGMENT", 2**11)
    monkeypatch.setattr("asperity.spectra.ROUND", 2**7)
    heights = 1e-6 * np.random.default_rng(0).normal(size=2**17)
    heights[::5000] += 1e-3  # spikes
    line = Profile(heights, 1e-3)
    evaluated(Profile(heights[: 2**14], 1e-3))  # imports
    tracemalloc.start()
    try:
        evaluated(line)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < most * heights.nbytes


def test_a_line_in_pieces_is_the_line_as_a_whole(monkeypatch):
    """Spikes, whose feet lie in the piece beside, the circle, which reaches over it, and what is sorted."""
    random = np.random.default_rng(5)
    heights = 20 * UM * random.standard_normal(3_000)
    heights[random.integers(0, 3_000, 60)] += 300 * UM
    line = Profile(heights, MM)
    whole = remove_spikes(line), roll_over(line), profile_statistics(line)
    monkeypatch.setattr(measured_lines, "TOGETHER", 7)
    monkeypatch.setattr("asperity.surfaces.statistics.PIECE", 7)
    pieces = remove_spikes(line), roll_over(line), profile_statistics(line)
    assert pieces[0][1:] == whole[0][1:]
    assert pieces[0][1] > 50
    assert_array_equal(pieces[0][0].heights, whole[0][0].heights)
    assert_array_equal(pieces[1].heights, whole[1].heights)
    assert_allclose([each.value for each in pieces[2]], [each.value for each in whole[2]], rtol=1e-9)
