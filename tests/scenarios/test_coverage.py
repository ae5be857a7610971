"""Which bands roughness covers at the speed of a case: told by check and report, doubted, refused."""

import csv
import re
from pathlib import Path

import numpy as np
import pytest

from asperity import BallOnBeam, Profile, WheelOnRail
from asperity.case.tables import read_levels
from asperity.errors import InputError, OutOfRangeWarning, PhysicsWarning
from asperity.reference.cnossos import rail_roughness
from asperity.scenarios.coverage import Coverage, coverages, doubt_levels
from asperity.scenarios.preparing import prepare

LAWS = ["linear-filtered"]


def table(longest, count, level=0.0):
    """Levels in one-third octaves from a wavelength, of which the logarithm is given, down."""
    return np.column_stack([10.0 ** (longest - 0.1 * np.arange(count)), np.full(count, level)])


def case(spectrum, speed=30.0, **wheel):
    kept = {"laws": LAWS, "duration": 0.05, "settling": 0.05, "speed": speed}
    with PhysicsWarning.ignored():
        return WheelOnRail(surface={"spectrum": spectrum}, wheel=wheel, **kept)


@pytest.mark.parametrize(("speed", "longest", "count", "covered"), [
    (30.0, -0.5, 18, 18),  # 100 Hz to 5 kHz by f = v/λ
    (60.0, -0.5, 18, 15),  # an octave higher: the lowest three have none
    (30.0, -0.5, 8, 8),
    (31.0, -1.5, 8, 8),
    (30.0, 0.5, 18, 8),
])  # fmt: skip
def test_bands_are_those_of_the_waves_at_the_speed(speed, longest, count, covered):
    prepared = prepare(case(table(longest, count), speed), "case")
    (found,) = coverages(prepared.case, prepared.textures)
    assert len(found.covered) == covered
    assert len(found.bands) == 18
    expected = speed / table(longest, count)[:, 0]
    np.testing.assert_allclose(found.covered, [f for f in expected if 89.1 < f < 5623], rtol=0.07)
    assert f"at {speed:g} m/s {covered} of 18 one-third octaves from 100 Hz to 5 kHz" in found.at(speed)


@pytest.mark.parametrize(("count", "doubted"), [(4, True), (8, True), (9, False), (18, False)])
def test_fewer_than_half_of_the_bands_are_doubted(count, doubted):
    prepared = prepare(case(table(-0.5, count)), "case")
    told = [str(each.message) for each in prepared.caught if f"{count} of 18" in str(each.message)]
    assert bool(told) is doubted


def test_few_bands_are_doubted_and_none_is_refused():
    prepared = prepare(case(table(-0.5, 2)), "case")
    (doubt,) = [each for each in prepared.caught if "one-third octaves" in str(each.message)]
    assert doubt.category is OutOfRangeWarning
    assert "2 of 18 one-third octaves from 100 Hz to 5 kHz, those from 100 Hz to 125 Hz" in str(doubt.message)
    assert "heard by waves of 5.99 mm to 300 mm. Is the unit of the wavelengths right?" in str(doubt.message)
    with pytest.raises(InputError) as refused:
        prepare(case(table(0.7, 3)), "case")
    assert re.search(r"surface.spectrum: received .* 0 of 18 one-third octaves", str(refused.value))


def test_a_rough_wheel_makes_up_for_a_rail_of_few_bands():
    prepared = prepare(case(table(-0.5, 2), roughness=table(-0.6, 16)), "case")
    assert not [each for each in prepared.caught if "one-third octaves" in str(each.message)]
    assert [each.key for each in coverages(prepared.case, prepared.textures)] == [
        "surface.spectrum", "wheel.roughness",
    ]  # fmt: skip


@pytest.mark.parametrize(("longest", "count"), [(-0.5, 10), (0.3, 35), (0.3, 28)])
@pytest.mark.parametrize(("scale", "unit"), [(100, "cm"), (1000, "mm"), (1e6, "um")])
def test_wavelengths_under_a_wrong_unit(longest, count, scale, unit, tmp_path):
    """Of 0.32 m to 40 mm, and of the limit spectrum, 2 m to 0.8 or 4 mm."""
    rows = "".join(f"{wave * scale:.6g}, {level}\n" for wave, level in table(longest, count))
    (tmp_path / "a.csv").write_text(f"wavelength (m), level (dB)\n{rows}")
    with pytest.raises(
        InputError, match=rf"up to 10 m. Are they in {unit}\? Then write 'wavelength \({unit}\)'"
    ):
        read_levels(tmp_path / "a.csv")
    (tmp_path / "a.csv").write_text(f"wavelength ({unit}), level (dB)\n{rows}")
    np.testing.assert_allclose(read_levels(tmp_path / "a.csv")[0][0], 10.0**longest, rtol=1e-5)


def test_waves_that_are_all_shorter_than_cells_are_told_with_their_unit(tmp_path):
    """Millimetres under µm."""
    rows = "".join(f"{wave * 1e3:.6g}, {level}\n" for wave, level in table(-0.5, 10))
    (tmp_path / "a.csv").write_text(f"wavelength (um), level (dB)\n{rows}")
    told = r"a.csv: received bands of waves of 39.8 µm to 0.316 mm .*; allowed: .*longer than .*Is the unit"
    with pytest.raises(InputError, match=told):
        prepare(case(tmp_path / "a.csv"), "case")


def test_columns_of_a_table_that_count_are_told(tmp_path):
    levels = tmp_path / "a.csv"
    rows = "".join(f"{wave:.6g},{level},17\n" for wave, level in table(-0.5, 18))
    levels.write_text(f"wavelength (m),level (dB),limit (dB)\n{rows}")
    prepared = prepare(case(levels), "case")
    (found,) = coverages(prepared.case, prepared.textures)
    assert "a.csv ('level (dB)', without 'limit (dB)'), waves of" in found.at(30.0)


LIMIT = np.column_stack(rail_roughness("iso3095"))[7:29]
"""Of 400 mm to 3.15 mm."""
DATA = Path(__file__).parents[3] / "shared" / "data" / "niederwangen" / "rail_roughness.csv"


def doubts_of(path, wavelength, level):
    """Whether the levels of a file are doubted, and how."""
    text = "".join(f"{a:.6g}, {b:.2f}\n" for a, b in zip(wavelength, level, strict=True) if np.isfinite(b))
    path.write_text(f"wavelength (m), level (dB re 1 um)\n{text}")
    with PhysicsWarning.caught() as caught:
        doubt_levels(case(path))
    return [str(each.message) for each in caught]


@pytest.mark.parametrize(("times", "added", "told"), [
    (1.0, 0.0, ""),
    (1.0, -14.9, ""),
    (1.0, -15.1, "surface.spectrum: the levels of a.csv are, in the mean from 400 mm to 3.15 mm, 15 dB be"),
    (1.0, 29.9, ""),
    (1.0, 35.0, "35 dB above the limit of EN ISO 3095 for rails; those of rails and wheels are up to 15 dB"),
    (10.0, -8.0, "22 dB below the limit of EN ISO 3095"),
    (0.1, 0.0, ""),
])  # fmt: skip
def test_levels_far_beside_those_of_all_that_rolls_are_doubted(tmp_path, times, added, told):
    """Re 1 nm they are 60 dB higher; of a smooth rail wavelengths in cm that are read as mm or the other way
    round show, of a rough one they are those of another rough one."""
    found = doubts_of(tmp_path / "a.csv", times * LIMIT[:, 0], LIMIT[:, 1] + added)
    assert len(found) == bool(told)
    assert told in "".join(found)


def test_levels_of_a_file_are_doubted_as_a_case_is_prepared(tmp_path):
    """Of a wheel, too; named spectra and numbers from Python, which are lower on purpose, are not."""
    np.savetxt(
        tmp_path / "a.csv", LIMIT - [0.0, 20.0], header="wavelength (m) level (dB re 1 um)", comments=""
    )
    smooth = case(LIMIT - [0.0, 20.0], roughness=tmp_path / "a.csv")
    told = [str(each.message) for each in prepare(smooth, "case").caught]
    (doubt,) = [each for each in told if "the limit of EN ISO 3095" in each]
    assert doubt.startswith("wheel.roughness: the levels of a.csv are, in the mean")


@pytest.mark.skipif(not DATA.exists(), reason="needs the measured data that are kept beside the project")
def test_no_measured_rail_is_doubted_and_most_with_wavelengths_ten_times_as_long(tmp_path):
    with DATA.open(newline="") as file:
        head, *rows = csv.reader(file)
    wavelength = np.array([float(each.split()[0]) for each in head[5:]]) / 100.0
    some = [np.array([float(each or "nan") for each in row[5:]]) for row in rows[::12]]
    assert not any(doubts_of(tmp_path / "a.csv", wavelength, level) for level in some)
    longer = [bool(doubts_of(tmp_path / "a.csv", 10.0 * wavelength, level)) for level in some]
    assert np.mean(longer) > 0.5


@pytest.mark.parametrize(("step", "told"), [(1e-6, "0 of 18"), (0.7, "0 of 18"), (1e-3, "")])
def test_a_measured_line_over_a_track_without_a_wave_that_is_heard_is_doubted_or_refused(step, told):
    """4000 points: 4 mm in all, or 0.7 m apart, at 30 m/s; of a rail no word."""
    line = Profile(1e-3 * step * np.cumsum(np.random.default_rng(4).normal(size=4000)), step)
    keys = {"laws": LAWS, "duration": 0.05, "settling": 0.05, "speed": 30.0}
    try:
        rolled = WheelOnRail(surface={"line": line, "continuation": "repeat"}, **keys)
        said = [str(each.message) for each in prepare(rolled, "case").caught]
    except InputError as refused:
        said = [str(refused)]
    (doubt,) = [each for each in said if "one-third octaves from" in each] or [""]
    assert told in doubt
    assert doubt.startswith("surface.line: ") == bool(told)


def test_a_short_line_on_a_beam_is_not_doubted():
    """Of 8 mm at 20 m/s, waves that are heard from 2.5 kHz on: a rig is looked at where it has waves."""
    line = Profile(1e-8 * np.random.default_rng(4).normal(size=800), 1e-5)
    rig = BallOnBeam(
        laws=["hertz"], duration=0.01, speed=20.0, surface={"line": line, "continuation": "repeat"}
    )
    said = [str(each.message) for each in prepare(rig, "case").caught]
    assert not [each for each in said if "one-third octaves from" in each]


def test_a_single_band_is_told_as_one():
    bands = np.array([100.0, 125.0])
    assert Coverage("a", "b", (1.0, 0.1), bands, bands[:1]).at(10.0).endswith("125 Hz, that of 100 Hz")
