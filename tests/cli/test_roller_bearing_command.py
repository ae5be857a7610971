"""``asperity bearing`` of a roller bearing: what it prints, writes and refuses, in words of rollers."""

import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest
from scipy.io import wavfile

from asperity import RollerBearing
from asperity.case.cases import as_case
from asperity.written_numbers import rounded
from command_line import call
from faulty_signals import faulty_signal

LOADED = ("bearing", "NU205", "--radial", "2 kN", "--speed", "1800 1/min")
TAPERED = """
rollers = 15
roller_diameter = "7 mm"
roller_length = "10 mm"
pitch_diameter = "45 mm"
contact_angle = "14 deg"
axial = "2 kN"
speed = "1800 1/min"
"""


@pytest.fixture
def tapered(tmp_path):
    (path := tmp_path / "own.toml").write_text(TAPERED)
    return str(path)


def test_geometry_load_stiffness_and_tones_are_said_of_rollers():
    said = call(*LOADED).stdout
    assert said.startswith(
        "NU205: 13 rollers of 7.5 × 7.8 mm, logarithmic profile of 2.62 µm, pitch diameter"
    )
    assert "is chosen so that ISO 76 makes this rating of them" in said
    assert re.search(r"BPFO: rollers pass a spot of it", said)
    assert re.search(r"roller +│ 150.2 +│ 5.0077 │ 2 BSF", said)
    assert "4 to 5 of 13 rollers touch the inner ring" in said
    assert "7.04 of 7.8 mm touch the inner ring; rings are held against tilt" in said
    assert "ball" not in said
    assert "Waviness" not in said  # under an axial load, which nothing carries


def test_numbers_for_programs_are_those_of_the_bearing():
    told = json.loads(call(*LOADED, "--json").stdout)
    found = RollerBearing.named("NU205").loaded(2000.0, speed=30.0)
    assert told["balls"]["inner_load"] == pytest.approx(found.inner_load[0].tolist())
    assert told["tones"]["outer"] == pytest.approx(157.5)


def test_of_a_file_and_of_a_case_the_bearing_is_on_rollers(tapered, tmp_path):
    said = call("bearing", tapered).stdout
    assert ": 15 rollers of 7 × 10 mm" in said
    assert "contact angle 14°" in said
    assert re.search(r"roller +│ 2 +│", said)  # waviness
    case = as_case({"kind": "roller-bearing", "radial": "1 kN", "bearing": {"name": "NU205", "rollers": 11}})
    (path := tmp_path / "case.toml").write_text(case.to_toml())
    said = call("bearing", str(path)).stdout
    assert "11 rollers" in said
    assert "under 1000 N radial" in said


def test_a_tilted_ring_is_that_of_the_static_solution(tmp_path):
    """Its loads and the moment that holds it; there is none on balls, nor in a table."""
    said = " ".join(call(*LOADED, "--tilt", "1.5 mrad").output.split())
    found = RollerBearing.named("NU205").loaded(2000.0, tilt=1.5e-3, speed=30.0)
    moment = f"{found.moment[:, 0].mean():.4g}"
    assert f"the inner ring is held at a tilt of 1.5 mrad by a moment of {moment} N m." in said
    told = json.loads(call(*LOADED, "--tilt", "1.5 mrad", "--json").stdout)
    assert told["balls"]["inner_load"] == pytest.approx(found.inner_load[0].tolist())
    assert told["balls"]["inner_pressure"] == pytest.approx(found.inner_pressure[0].tolist())
    sheet = tmp_path / "tilted.html"
    call(*LOADED, "--tilt", "3 mrad", "--sheet", str(sheet))
    found = RollerBearing.named("NU205").loaded(2000.0, tilt=3e-3, speed=30.0)
    page = " ".join(sheet.read_text(encoding="utf-8").split())
    assert f"{rounded(found.inner_pressure.max() / 1e9)} GPa, contact angle" in page
    assert "0 N axially, tilted by 3 mrad, at 1800 1/min: heaviest roller" in page
    refused = call(*LOADED, "--tilt", "1 mrad", "--table", "k.csv", code=2).stderr
    assert "--table: received a tilt with it; allowed: a ring that is held without tilt" in refused
    assert "tilt" in call("bearing", "6205", "--radial", "1 kN", "--tilt", "1 mrad", code=2).stderr
    refused = call("bearing", "NU205", "--tilt", "2 mrad", code=2).stderr
    assert "tilt: received a tilt without a load; allowed: a load beside it, as --radial '1 kN'" in refused


def test_a_shaft_that_gives_way_is_told_of_a_file(tmp_path):
    """By the tilt and the moment at rest, in words, on the sheet; a table has none."""
    keys = 'name = "NU205"\nradial = "2 kN"\ntilt = "1 mrad"\ntilt_stiffness = "500 N m"\n'
    (path := tmp_path / "own.toml").write_text(keys)
    found = RollerBearing.named("NU205").loaded(2000.0, tilt=1e-3, tilt_stiffness=500.0)
    told = f"{1e3 * found.tilt:.4g} mrad by a moment of {found.moment[:, 0].mean():.4g} N m."
    assert f"held at a tilt of {told}" in " ".join(call("bearing", str(path)).stdout.split())
    call("bearing", str(path), "--sheet", str(sheet := tmp_path / "sheet.html"))
    assert f"tilted by {1e3 * found.tilt:.4g} mrad," in " ".join(sheet.read_text(encoding="utf-8").split())
    path.write_text(keys.replace('tilt = "1 mrad"\n', ""))
    assert "--table: received a tilt" in call("bearing", str(path), "--table", "k.csv", code=2).stderr


def test_films_are_those_of_lines():
    assert "Films of oil" in call(*LOADED, "--oil", "ISO VG 68").stdout


def test_the_list_names_roller_bearings():
    assert "Roller bearings: NU205." in call("bearing", "--list").stdout


def test_a_data_sheet_is_of_rollers(tmp_path):
    call(*LOADED, "--sheet", str(path := tmp_path / "sheet.html"))
    page = path.read_text()
    for words in (
        "Roller bearing NU205", "13 of 7.5 × 7.8 mm, steel", "logarithmic, 2.62 µm", "mass of a roller",
        "roller, on both rings (2 BSF)", "heaviest roller 8", "is chosen so that ISO 76",
    ):  # fmt: skip
        assert words in page
    assert "groove" not in page
    assert "means while a roller passes" in page
    assert ">taper<" not in page


@pytest.mark.parametrize(
    ("stiffness", "told"),
    [
        ("", "rigid"),
        (
            'rib_stiffness = "300 MN/m"\nrib_height = "1 mm"',
            "a spring of 300 MN/m, 1 mm above the inner raceway",
        ),
    ],
)
def test_a_taper_and_its_rib_are_told(tapered, tmp_path, stiffness, told):
    (path := Path(tapered)).write_text(f'{TAPERED}taper = "4.2 deg"\n{stiffness}\n')
    said = call("bearing", tapered, "--sheet", str(sheet := tmp_path / "sheet.html")).stdout
    page = re.sub(r"<[^>]*>|\s+", " ", sheet.read_text(encoding="utf-8"))
    assert re.search(rf"taper +4.2° +rib +{told}", page)
    said = call("bearing", str(path)).stdout
    assert f"contact angle 14°, taper 4.2°, its rib {told}" in " ".join(said.split())


def test_friction_on_a_rib_is_said_of_a_file_and_of_a_case(tmp_path):
    """Torque by the closed form of the static solution; heat at a speed."""
    text = TAPERED.replace('speed = "1800 1/min"', 'radial = "800 N"') + 'taper = "4.2 deg"\nfriction = 0.1\n'
    (path := tmp_path / "own.toml").write_text(text + 'rib_height = "1 mm"\n')
    angles = {"contact_angle": np.radians(14.0), "taper": np.radians(4.2), "rib_height": 1e-3}
    of = RollerBearing(15, 7e-3, 10e-3, 45e-3, **angles)
    found = of.loaded(800.0, 2000.0).rib_torque(0.1)
    said = " ".join(call("bearing", str(path)).stdout.split())
    assert (
        f"Friction of rollers on the rib asks the rings for {1e3 * found.sum(axis=1).mean():.4g} N mm."
        in said
    )
    told = json.loads(call("bearing", str(path), "--json").stdout)
    assert told["balls"]["rib_torque"] == pytest.approx(found[0].tolist())
    path.write_text(text)
    refused = call("bearing", str(path), code=2).stderr
    assert (
        "friction: received 0.1; allowed: none without taper and rib_height: rollers slide on a rib"
        in refused
    )
    bearing = {"contact_angle": "14 deg", "taper": "4.2 deg", "rib_height": "1 mm", "name": "NU205"}
    case = {
        "kind": "roller-bearing",
        "radial": "800 N",
        "axial": "600 N",
        "friction": 0.1,
        "bearing": bearing,
    }
    (path := tmp_path / "case.toml").write_text(as_case(case).to_toml())
    of = RollerBearing.named("NU205", **angles)
    torque = of.loaded(800.0, 600.0, speed=30.0).rib_torque(0.1).sum(axis=1).mean()
    said = " ".join(call("bearing", str(path)).stdout.split())
    assert f"{1e3 * torque:.4g} N mm, {60.0 * np.pi * torque:.4g} W of heat." in said
    said = call(*LOADED).stdout
    assert "Friction" not in said


def test_a_table_has_stiffness_and_damping_of_a_ring_held_against_tilt(tmp_path):
    path = tmp_path / "k.csv"
    options = ("--radial", "1 kN, 2 kN", "--damping", "20 N s/m", "--cage-angle", "0 deg")
    assert (
        "The inner ring is held against tilt."
        in call("bearing", "NU205", *options, "--table", str(path)).stdout
    )
    rows = list(csv.DictReader(path.read_text().splitlines()))
    found = RollerBearing.named("NU205").loaded(2000.0, cage_angles=[0.0])
    assert float(rows[1]["kxx (N/m)"]) == pytest.approx(found.stiffness[0, 0, 0], rel=1e-9)
    assert float(rows[1]["cxx (N s/m)"]) == pytest.approx(found.damping(20.0)[0, 0, 0], rel=1e-9)


def test_waves_have_limits_where_all_rollers_touch():
    limits = ("--limits", "50 um/s, 30 um/s, none", "--outer-mass", "60 g")
    pressed = ("--clearance", "-4 um", "--radial", "10 N", "--speed", "1800 1/min")
    said = call("bearing", "NU205", *pressed, *limits).stdout
    velocity = 2.0 * np.pi * 157.5 / np.sqrt(2.0)  # of the ring on a circle of 1 m
    assert re.search(
        rf"outer ring │ 12 +│ 157.5 +│ 50 to 300 +│ {velocity:.0f} +│ {5e4 / velocity:.1f}", said
    )
    assert "follows its rollers up to" in said
    assert re.search(r"│ roller +│ 2 +│ 138.1, 162.3", said)
    said = call(*LOADED, *limits, code=2).stderr
    assert (
        "load: received 4 of 13 rollers that touch; allowed: a load under which all touch, an axial one"
        in said
    )


def test_a_signal_is_read_by_tones_of_rollers(tmp_path):
    rate = 12_000
    signal = faulty_signal("outer", 30.0, rate, 5.0, bearing=(13, 7.5 / 39.0), angle=0.0)
    wavfile.write(path := tmp_path / "run.wav", rate, signal.astype(np.float32))
    said = call(
        "bearing", "NU205", "--speed", "1800 1/min", "--signal", str(path), "--known", "roller"
    ).stdout
    assert re.search(r"lines of the outer ring at 15[67]\.", said)
    assert "Of the fault of the roller that is known to be there" in said
    assert said.strip().endswith("How sure rests on records of ball bearings.")
    of_balls = ("bearing", "6205", "--speed", "1800 1/min", "--signal", str(path), "--known", "roller")
    assert (
        "--known: received roller; allowed: outer, inner or ball of a ball" in call(*of_balls, code=2).stderr
    )


@pytest.mark.parametrize(("words", "message"), [
    (("NU206",), "Did you mean .* Named roller bearings: NU205."),
    (("NU205", "--axial", "100 N"), "axial load: received 100 N; allowed: 0 N where contact_angle is 0"),
    (("NU205", "--oil", "ISO VG 68", "--speed", "30 Hz"), "load: received none; allowed: a radial or axial"),
])  # fmt: skip
def test_what_no_roller_bearing_carries_is_refused(words, message):
    assert re.search(message, call("bearing", *words, code=2).stderr)
