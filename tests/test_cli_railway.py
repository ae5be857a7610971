"""The command line for a wheel on a rail: new and check."""

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from asperity.cli import main
from asperity.config import load_case

RAIL = 'kind = "wheel-on-rail"\nduration = "0.2 s"\nsettling = "0.1 s"\n[surface]\nspectrum = "iso3095"\n'


@pytest.fixture(autouse=True)
def own_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("ASPERITY_CACHE", str(tmp_path / "cache"))
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
