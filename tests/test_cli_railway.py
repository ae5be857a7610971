"""The command line for a wheel on a rail: new, check and sweep."""

import csv
import sys
import types
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

from asperity.cli import main
from asperity.config import load_case

BALL = 'kind = "ball-on-beam"\n[surface]\nrms = "0.5 um"\n'
RAIL = 'kind = "wheel-on-rail"\nduration = "0.2 s"\nsettling = "0.1 s"\n[surface]\nspectrum = "iso3095"\n'


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


def test_a_new_case_is_valid():
    Path("new.toml").write_text(call("new", "wheel-on-rail").stdout)
    assert load_case("new.toml").wheel.load == 65e3


def test_check_shows_the_track_and_the_run_in():
    shown = call("check", "rail.toml").stdout
    for text in (
        "wheel.load",
        "16.8 m from -5.6 m",
        "0.2 s, and 0.1 s before it",
        "pinned–pinned 1420 Hz, sleeper passing 93.33 Hz, critical speed 441.1 m/s",
        "5.4 m, 5.7 m",
    ):
        assert text in shown


def test_check_reads_the_measured_lines():
    np.save("wheel.npy", np.zeros((2890, 10)))
    keys = '[wheel]\nline = "wheel.npy"\nline_unit = "um"\n'
    Path("measured.toml").write_text(f"{RAIL}{keys}line_spacing = '1 mm'\nline_distance = '5 mm'\n")
    assert "a map of 2890 × 10 points, 2890 × 10 mm" in call("check", "measured.toml").stdout
    Path("measured.toml").write_text(RAIL + keys)
    assert "pixel" in call("check", "measured.toml", code=2).stderr


@pytest.fixture
def swept(monkeypatch):
    """Replace the sweep; returns the speeds and loads that were asked for."""
    asked = []

    def sweep(case, speeds, loads, progress=None):
        asked.append((case.text, list(speeds), list(loads)))
        units = {"law": "1", "speed": "m/s", "load": "N", "band": "Hz"}
        coordinates = {"law": ["areal", "linear"], "speed": speeds, "load": loads, "band": [500.0, 1000.0]}
        axes = {
            name: (name, values, {"units": units[name], "long_name": name})
            for name, values in coordinates.items()
        }
        shape = (2, len(speeds), len(loads))
        share = (("law", "speed", "load"), np.arange(np.prod(shape)).reshape(shape) / 10)
        level = (("law", "speed", "load", "band"), np.full((*shape, 2), 30.5))
        return xr.Dataset(
            {
                "contact_loss_share": (*share, {"units": "1", "long_name": "time out of contact"}),
                "force_level": (*level, {"units": "dB re 1 N", "long_name": "force level"}),
                "deflection": (("load",), [1e-3] * len(loads), {"units": "m", "long_name": "deflection"}),
            },
            axes,
        )

    module = types.ModuleType("asperity.scenarios.sweep")
    module.sweep = sweep
    monkeypatch.setitem(sys.modules, "asperity.scenarios.sweep", module)
    return asked


def test_a_sweep_is_tabulated_and_written(swept):
    outcome = call("sweep", "rail.toml", "--speed", "20 m/s, 200 km/h", "--load", "50 kN,65 kN", "-o", "out")
    assert swept == [(RAIL, [20.0, pytest.approx(200 / 3.6)], [50e3, 65e3])]
    assert "contact_loss_share [1]" in outcome.stdout
    assert "force_level" not in outcome.stdout
    assert str(Path("out/sweep.nc").resolve()) in outcome.stdout
    with xr.open_dataset("out/sweep.nc", engine="h5netcdf") as found:
        assert found.sizes == {"law": 2, "speed": 2, "load": 2, "band": 2}
    with open("out/sweep.csv", newline="") as file:
        heading, *rows = csv.reader(file)
    assert heading == [
        *("law", "speed [m/s]", "load [N]", "contact_loss_share [1]"),
        *("force_level 500 Hz [dB re 1 N]", "force_level 1000 Hz [dB re 1 N]", "deflection [m]"),
    ]
    assert len(rows) == 8
    assert rows[1] == ["areal", "20.0", "65000.0", "0.1", "30.5", "30.5", "0.001"]


def test_a_sweep_takes_what_is_not_given_from_the_case(swept):
    call("sweep", "rail.toml", "--load", "50 kN")
    assert swept == [(RAIL, [56.0], [50e3])]
    assert Path("runs/rail/sweep.csv").exists()


def test_a_sweep_is_never_overwritten_unasked(swept):
    call("sweep", "rail.toml", "-o", "out")
    assert "out: received a sweep.nc" in call("sweep", "rail.toml", "-o", "out", code=2).stderr
    call("sweep", "rail.toml", "-o", "out", "--overwrite")
    assert len(swept) == 2


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["ball.toml"], "kind: received 'ball-on-beam'; allowed: \"wheel-on-rail\""),
        (["rail.toml", "--speed", "20"], "--speed: received '20'; allowed: a number and a unit"),
        (["rail.toml", "--speed", "20 kg"], "--speed: received 'kg'"),
        (["rail.toml", "--speed", "20 m/s,"], "--speed: received ''"),
        (["rail.toml", "--speed", "-1 m/s"], "--speed: received '-1 m/s'; allowed: finite values greater"),
        (["rail.toml", "--load", "inf"], "--load: received 'inf'; allowed: finite values greater than 0"),
        (["rail.toml", "--load", "5 kN,5000 N"], "--load: received '5000 N' more than once"),
    ],
)
def test_a_sweep_refuses_wrong_values(swept, arguments, message):
    assert message in call("sweep", *arguments, code=2).stderr
    assert swept == []
