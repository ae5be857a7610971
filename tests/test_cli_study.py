"""The command line of studies: study and sweep."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

from asperity.cli import main
from asperity.studies.definition import load_study

BALL = 'kind = "ball-on-beam"\n[surface]\nrms = "0.5 um"\n'
RAIL = 'kind = "wheel-on-rail"\n[surface]\nspectrum = "iso3095"\n'
STUDY = 'case = "rail.toml"\n[sweep]\nspeed = ["20 m/s", "200 km/h"]\n"track.name" = ["x2000"]\n'
FAILURE = {"error": "ComputationError", "message": "it failed.", "members": [f"seed = {n}" for n in range(8)]}


@pytest.fixture(autouse=True)
def own_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("ASPERITY_CACHE", str(tmp_path / "cache"))
    Path("ball.toml").write_text(BALL)
    Path("rail.toml").write_text(RAIL)


def call(*arguments, code=0):
    outcome = CliRunner().invoke(main, list(arguments))
    assert outcome.exit_code == code, outcome.output
    return outcome


@pytest.fixture
def computed(monkeypatch):
    """Replace the computation; returns the sweeps and the workers that were asked for."""
    asked = []

    def study(definition, *, executor, workers, progress):
        asked.append((definition.sweep, workers))
        swept = [axis.name for axis in definition.axes]
        axes = {
            axis.name: (axis.name, axis.coordinate, {"units": axis.units, "long_name": axis.name})
            for axis in definition.axes
        }
        axes["law"] = ("law", ["areal", "linear"], {"units": "1", "long_name": "law"})
        axes["band"] = ("band", [500.0, 1000.0], {"units": "Hz", "long_name": "band"})
        shape = (*definition.shape, 2)
        share = np.arange(np.prod(shape), dtype=float).reshape(shape) / 10
        share.flat[-1] = np.nan
        warning = {"category": "Coarse", "message": "spacing is coarse", "members": 3}
        attrs = {"case": definition.text, "sweep": json.dumps(definition.sweep)}
        attrs |= {"warnings": json.dumps([warning]), "failures": json.dumps([FAILURE])}
        variables = {
            "completed": (swept, np.ones(definition.shape, np.int8), "1"),
            "contact_loss_share": ([*swept, "law"], share, "1"),
            "force_level": ([*swept, "law", "band"], np.full((*shape, 2), 30.5), "dB re 1 N"),
            "table": ([*swept, "band", "other"], np.zeros((*definition.shape, 2, 3)), "m"),
        }
        found = {n: (d, v, {"units": u, "long_name": n}) for n, (d, v, u) in variables.items()}
        return xr.Dataset(found, axes, attrs)

    monkeypatch.setattr("asperity.studies.running.study", study)
    return asked


def test_a_study_is_tabulated_and_written(computed):
    Path("study.toml").write_text(STUDY)
    outcome = call("study", "study.toml", "-o", "out", "--workers", "2")
    assert computed == [({"speed": ["20 m/s", "200 km/h"], "track.name": ["x2000"]}, 2)]
    assert "Study of 2 speed × 1 track.name" in outcome.stderr
    for text in ("speed [m/s]", "contact_loss_share [1]", "x2000", "–"):
        assert text in outcome.stdout
    assert "force_level" not in outcome.stdout
    assert str(Path("out/study.nc").resolve()) in outcome.stdout
    with xr.open_dataset("out/study.nc", engine="h5netcdf") as found:
        assert found["contact_loss_share"].dims == ("speed", "track.name", "law")
    with open("out/study.csv", newline="") as file:
        heading, *rows = csv.reader(file)
    assert heading == [
        *("speed [m/s]", "track.name", "law", "completed [1]", "contact_loss_share [1]"),
        *("force_level 500 Hz [dB re 1 N]", "force_level 1000 Hz [dB re 1 N]"),
    ]
    assert len(rows) == 4
    assert rows[1] == ["20.0", "x2000", "linear", "1", "0.1", "30.5", "30.5"]


def test_names_in_a_table_are_no_formulas_and_no_markup(computed):
    for name in ("=cmd|x.npy", "[red]a [um].npy"):
        Path(name).write_bytes(b"1")
    Path("study.toml").write_text(
        '[case]\nkind = "ball-on-beam"\n[case.surface]\nheight_unit = "um"\n'
        '[sweep]\n"surface.file" = ["=cmd|x.npy", "[red]a [um].npy"]\n'
    )
    outcome = call("study", "study.toml", "-o", "out")
    assert "[red]a [um].npy" in outcome.stdout
    with open("out/study.csv", newline="") as file:
        _, *rows = csv.reader(file)
    assert [row[0] for row in rows[::2]] == ["'=cmd|x.npy", "[red]a [um].npy"]
    assert rows[0][2] == "1"  # numbers stay as they are


def test_what_members_met_is_said_once(computed):
    said = call("sweep", "rail.toml", "--speed", "20 m/s").stderr
    assert "Warning (3 of 1 members): spacing is coarse" in said
    assert "Failed (8 of 1 members): it failed." in said
    assert "  - seed = 5\n  - and 2 more\n" in said


def test_a_long_table_is_printed_in_part(computed):
    speeds = ", ".join(f"{n} m/s" for n in range(1, 41))
    assert "… and 20 more rows, in study.csv" in call("sweep", "rail.toml", "--speed", speeds).stdout


def test_speeds_and_loads_need_no_file(computed):
    call("sweep", "rail.toml", "--speed", "20 m/s, 200 km/h", "--load", "50 kN,65 kN")
    call("sweep", "ball.toml", "--load", "5 N")
    assert [sweep for sweep, _ in computed] == [
        {"speed": ["20 m/s", "200 km/h"], "wheel.load": ["50 kN", "65 kN"]},
        {"ball.load": ["5 N"]},
    ]
    assert Path("runs/rail/study.csv").exists()


def test_another_study_is_never_overwritten_unasked(computed):
    call("sweep", "rail.toml", "--speed", "20 m/s", "-o", "out")
    call("sweep", "rail.toml", "--speed", "20 m/s", "-o", "out")
    other = ["sweep", "rail.toml", "--speed", "30 m/s", "-o", "out"]
    assert "out: received the study.nc of another study" in call(*other, code=2).stderr
    Path("out/study.nc").write_text("precious")
    assert "out: received the study.nc of another study" in call(*other, code=2).stderr
    call(*other, "--overwrite")
    assert len(computed) == 3
    assert "rail.toml is a file)" in call(*other[:-1], "rail.toml", code=2).stderr


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["sweep", "rail.toml"], "sweep: received nothing; allowed: --speed, --load or both"),
        (["sweep", "rail.toml", "--speed", "20"], "sweep.speed[1]: received '20'; allowed: a speed"),
        (["sweep", "rail.toml", "--speed", "20 m/s,"], "sweep.speed[2]: received ''"),
        (["sweep", "rail.toml", "--speed", "-1 m/s"], "sweep.speed[1]: received '-1 m/s'"),
        (["sweep", "rail.toml", "--load", "inf"], "sweep.wheel.load[1]: received 'inf'"),
        (
            ["sweep", "rail.toml", "--load", "5 kN,5000 N"],
            "wheel.load: received '5000 N' more than once",
        ),
        (["study", "absent.toml"], "absent.toml: received no such file; allowed: the path of a study file"),
        (["study", "rail.toml"], "case: received nothing"),
        (
            ["sweep", "rail.toml", "--load", "5 kN", "--workers", "2", "--scheduler", "x"],
            "--workers: received",
        ),
    ],
)
def test_wrong_input_is_explained(computed, arguments, message):
    assert message in call(*arguments, code=2).stderr
    assert computed == []


def test_a_new_study_is_valid():
    Path("study.toml").write_text(call("new", "study").stdout)
    Path("case.toml").write_text(RAIL)
    assert load_study("study.toml").shape == (2, 3)
