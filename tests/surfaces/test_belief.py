"""Sizes beyond belief are refused with the likely cause, unusual ones doubted, in every reader."""

import re
from dataclasses import replace

import numpy as np
import pytest

from asperity import HeightMap, Profile, read_surface
from asperity.case.surface import Surface
from asperity.cli.surface import scale_in_words
from asperity.errors import InputError, OutOfRangeWarning
from asperity.reference.cnossos import rail_roughness
from asperity.scenarios.records import measured_maps
from asperity.surfaces.bands import from_bands
from asperity.surfaces.readers import belief, read_across
from asperity.surfaces.readers.belief import ROUGHEST, SLOPES, USUAL_SLOPES, judge_sizes, typical_slope
from asperity.surfaces.readers.hints import Hints

ROUGH = np.random.default_rng(3).normal(size=(40, 30))
ROUGH /= ROUGH.std()


@pytest.fixture
def read(tmp_path):
    def read(height_unit, pixel, kind="npy"):
        file = tmp_path / f"a.{kind}"
        np.save(file, ROUGH) if kind == "npy" else np.savetxt(file, ROUGH)
        return read_surface(file, height_unit=height_unit, pixel=pixel)

    return read


@pytest.mark.parametrize("kind", ["npy", "txt"])
@pytest.mark.parametrize(("height_unit", "pixel", "message"), [
    ("m", "20 um", r'heights of 1 m over a field of 0.8 mm × 0.6 mm: .* in µm, 1 µm\? Give height_unit="um"'),
    ("m", "20 mm", r'Were they in mm, 1 mm\? Give height_unit="mm"'),
    ("mm", "20 um", r'Were they in µm, 1 µm\? Give height_unit="um"'),
    ("um", "1 nm", r'Were they in nm, 1 nm\? Give height_unit="nm"'),
    ("um", "20 m", r'points 20 m apart; allowed: .* to 1 m. Are points 20 µm apart\? Give pixel="20 um"'),
    ("um", "0.4 m", r"a map whose lesser side is 12 m; allowed: .* at most 10 m. Are points 0.4 mm apart"),
    ("pm", "1 mm", r"slopes of 1.\d·10⁻⁹; allowed: slopes of 1·10⁻⁸ to 10 .*Are points 1 nm apart"),
])  # fmt: skip
def test_units_that_are_wrong_by_thousands(read, kind, height_unit, pixel, message):
    with pytest.raises(InputError, match=message):
        read(height_unit, pixel, kind)


@pytest.mark.filterwarnings("error::asperity.errors.OutOfRangeWarning")
@pytest.mark.parametrize(("x_unit", "z_unit", "message"), [
    ("um", "mm", r"Were heights 1.84 µm\? Then their unit is a thousandth of the one .*give height_unit"),
    ("um", "m", r"Were heights 1.84 µm\? Then their unit is a millionth of the one that is taken"),
    ("mm", "nm", r'Are points 2 µm apart\? Give pixel="2 um", .* heights 1.84 µm\? .* a thousand times the'),
])  # fmt: skip
def test_a_unit_that_a_file_states_is_not_advised_again(tmp_path, x_unit, z_unit, message):
    """Heights of 1.84 at places 2 apart, each in its unit; rails have slopes of 1e-4, and are no mirrors."""
    heights = 0.2 * np.cumsum(ROUGH.ravel() - ROUGH.mean())
    rows = "".join(f"{2 * n};{z:.6f}\n" for n, z in enumerate(heights))
    (tmp_path / "a.csv").write_text(f"x [{x_unit}];z [{z_unit}]\n{rows}")
    with pytest.raises((InputError, OutOfRangeWarning), match=message):
        read_surface(tmp_path / "a.csv")


@pytest.mark.parametrize(("height_unit", "pixel", "message"), [
    ("um", "0.3 um", r"slopes of 4\.\d, usual are up to 2"),
    ("nm", "10 mm", "slopes of 1.4·10⁻⁷, usual are from 1·10⁻⁶ on"),
    ("mm", "50 mm", "a map of 1.5 m and more"),
])  # fmt: skip
def test_what_is_unusual_is_doubted_and_read(read, height_unit, pixel, message):
    with pytest.warns(OutOfRangeWarning, match=message):
        assert read(height_unit, pixel).shape == (40, 30)


def test_what_is_measured_is_believed():
    """From atomic steps to a rail: no word of any of them."""
    wavelength, level = (each[rail_roughness("iso3095")[0] > 3e-3] for each in rail_roughness("iso3095"))
    rail = from_bands(20_000, 1e-3, wavelength, level, seed=1)
    step = 2.0 * np.sin(np.pi * 1e-3 / wavelength) / 1e-3  # of neighbours, by a wave
    slope = np.sqrt(np.sum(step**2 * 10.0 ** (level / 10.0) * 1e-12))
    measured = [
        (rail, slope),
        (HeightMap(3e-10 * np.round(ROUGH), (1e-9, 1e-9)), None),  # atoms
        (HeightMap(2e-10 * ROUGH, (1e-6, 1e-6)), None),  # a mirror
        (HeightMap(0.7e-6 * ROUGH, (1.6e-6, 1.6e-6)), None),  # sheet
        (Profile(30e-9 * ROUGH.ravel(), 1e-4), None),  # a raceway
        (HeightMap(np.zeros((40, 30)), (1e-3, 1e-3)), None),
    ]
    for surface, slope in measured:
        judge_sizes(surface, Hints())
        assert slope is None or typical_slope(surface) == pytest.approx(slope, rel=0.1)


def test_a_slope_is_typical_whatever_spikes_gaps_and_steps_there_are():
    """Of normal heights without correlation, rms steps are √2 of their rms."""
    heights = np.random.default_rng(1).normal(size=(300, 200))
    assert typical_slope(HeightMap(heights, (2.0, 2.0))) == pytest.approx(np.sqrt(2) / 2, rel=0.02)
    spiky = np.where(np.random.default_rng(2).random(heights.shape) < 0.02, 1e6, heights)
    spiky[:40] = np.nan
    assert typical_slope(HeightMap(spiky, (2.0, 2.0))) == pytest.approx(np.sqrt(2) / 2, rel=0.1)
    line = np.arange(1000.0) // 5  # four of five neighbours are alike
    assert typical_slope(Profile(line, 1.0)) == pytest.approx(1.4826)
    assert typical_slope(HeightMap(np.ones((40, 30)), (1.0, 1.0))) is None
    assert SLOPES[0] < USUAL_SLOPES[0] < USUAL_SLOPES[1] < SLOPES[1]


def test_a_map_whose_lengths_are_all_a_thousand_times_too_large_is_told_both_readings(read):
    """Slopes are the same in µm and in mm, where no surface that rolls is as rough."""
    assert read("um", "2 um").size == pytest.approx((80e-6, 60e-6))
    now, less = (rf"[\d.]+ {unit} about a smooth form over 80 {unit} × 60 {unit}" for unit in ("mm", "µm"))
    message = f"heights of {now}, rougher .* it is {less}, points 2 µm apart: then correct both units"
    with pytest.warns(OutOfRangeWarning, match=message):
        read("mm", "2 mm")


@pytest.mark.parametrize(("unit", "told"), [("mm", "thousand"), ("m", "million")])
def test_a_line_whose_lengths_are_all_too_large_is_told_both_readings(tmp_path, unit, told):
    """Micrometres under another unit: their slopes are right, and tell nothing."""
    heights = np.convolve(np.random.default_rng(4).normal(size=300), np.ones(4) / 2.0, "same")
    rows = "\n".join(f"{n};{z:.4f}" for n, z in enumerate(heights))
    file = tmp_path / "a.csv"
    file.write_text(f"x ({unit});z ({unit})\n{rows}\n")
    message = rf"heights of [\d.]+ {unit} about .*, rougher than .* a {told} times too large, it is [\d.]+ µm"
    with pytest.warns(OutOfRangeWarning, match=message + " about .* over 0.3 mm, points 1 µm apart"):
        read_surface(file)


def test_sections_of_bodies_and_long_waves_of_a_rail_are_no_rough_lines():
    y = np.linspace(-60e-3, 60e-3, 481)
    flange = 28e-3 * np.sin(np.clip((-38e-3 - y) / 14e-3, 0.0, 1.0) * np.pi / 2)
    noise = 5e-6 * np.random.default_rng(0).normal(size=481)
    waves = 5e-3 * np.sin(2 * np.pi * np.arange(3000) / 300.0)
    for line in (Profile(flange - y / 20 + noise, 0.25e-3), Profile(waves, 0.1)):
        judge_sizes(line, Hints())


def test_form_is_no_roughness():
    """A cap of a ball of 5 mm, and a plate that is tilted by a degree."""
    x, y = np.meshgrid(*(4e-6 * np.arange(n) for n in (400, 300)), indexing="ij")
    for form in (x * np.tan(np.radians(1.0)), -((x - 8e-4) ** 2 + (y - 6e-4) ** 2) / 1e-2):
        judge_sizes(
            HeightMap(form + 1e-7 * np.random.default_rng(1).normal(size=x.shape), (4e-6, 4e-6)), Hints()
        )


@pytest.mark.parametrize("surface", [
    HeightMap(4e-10 * ROUGH, (1e-9, 1e-9)), Profile(4e-10 * ROUGH.ravel(), 1e-9),
])  # fmt: skip
def test_lengths_that_are_all_a_thousand_too_small_are_told_with_the_larger_reading(surface):
    """Slopes stay as they are, and waves go up to what nobody hears."""
    judge_sizes(surface, Hints())  # without a word: microscopes of atomic force measure so
    larger = r"thousand times too small, it has heights of 0\.4 µm over .* correct both units"
    assert re.search(larger, scale_in_words(surface))
    assert "thousand" not in scale_in_words(replace(surface, spacing=np.multiply(200, surface.spacing)))
    if isinstance(surface, HeightMap):
        with pytest.raises(InputError, match=rf"a map of 40 nm × 30 nm; .* 20 um along each side.*{larger}"):
            measured_maps(Surface(file=surface), 20e-6)


def test_a_line_that_bends_is_smooth_where_it_rises_by_more():
    """Waves of 0.1 m, 11 mm high, bend by 0.1 mm between points 2 mm apart; noise as high is doubted."""
    waves = Profile(5.6e-3 * np.sin(2.0 * np.pi * np.arange(400) * 2e-3 / 0.1), 2e-3)
    bends = np.abs(np.diff(waves.heights, 2))
    assert np.median(bends) > ROUGHEST
    judge_sizes(waves, Hints())
    rough = Profile(np.random.default_rng(4).normal(0.0, np.std(bends), 400), 2e-3)
    with pytest.warns(OutOfRangeWarning, match="a thousand times too large"):
        judge_sizes(rough, Hints())


@pytest.mark.parametrize("unit", [1e-9, 1e-6, 1e-3])
def test_numbers_that_files_are_filled_with_are_known_in_any_unit(unit):
    bits = (-32768.0, 32767.0, 65535.0, 2.0**31, 2.0**32 - 1.0)
    assert all(belief._is_mark(unit * mark) for mark in (0.0, -999.0, -9999.0, 9999.0, -99999.0, *bits))
    assert not any(belief._is_mark(unit * height) for height in (-998.0, 1000.0, 327.0, 65530.0))


@pytest.mark.parametrize(("mark", "told"), [(0, "0 m"), (65535, "65.5 µm")])
def test_points_without_a_height_in_unsigned_numbers_are_doubted(tmp_path, mark, told):
    """3 µm in nm, which spread by 0.25 µm: zero is 12 of that away, the largest number of 16 bits 250."""
    heights = np.random.default_rng(3).normal(3000.0, 250.0, (40, 50)).clip(2000.0, 4000.0).astype(np.uint16)
    heights[4, 7:9] = mark
    np.save(tmp_path / "a.npy", heights)
    with pytest.warns(OutOfRangeWarning, match=f"2 points have the height {told}, .* write NaN there"):
        read_surface(tmp_path / "a.npy", height_unit="nm", pixel="20 um")


@pytest.mark.filterwarnings("error::asperity.errors.OutOfRangeWarning")
@pytest.mark.parametrize("steepest", [1.0, 3.0, 20.0])
def test_a_cylindrical_tread_with_a_steep_flange_is_believed(tmp_path, steepest):
    """Most of its points are level, and neighbours that are not are those of the flange alone."""
    y = np.arange(-60.0, 60.0, 0.25)
    z = np.clip(steepest * (-40.0 - y), 0.0, 28.0)
    rows = "".join(f"{a:.2f};{b:.4f}\n" for a, b in zip(y, z, strict=True))
    (tmp_path / "a.csv").write_text(f"y (mm);z (mm)\n{rows}")
    assert read_across(tmp_path / "a.csv").heights.max() == pytest.approx(1e-3 * min(28.0, 20.0 * steepest))
    (tmp_path / "a.csv").write_text(f"y (um);z (m)\n{rows}")
    with pytest.raises(InputError, match="slopes of"):
        read_across(tmp_path / "a.csv")
