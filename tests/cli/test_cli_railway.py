"""The command line for a wheel on a rail: new and check."""

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from asperity.case.cases import load_case
from asperity.cli import main

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


def test_check_says_what_loss_factors_do_to_the_force():
    assert "error of the contact force, dB: " in call("check", "rail.toml").stdout
    Path("lossy.toml").write_text(
        f'{RAIL}[track]\nname = "nordborg-loss-factor"\nballast_loss_factor = 2.0\n'
    )
    outcome = call("check", "lossy.toml")
    told = " ".join(line.split("│")[2].strip() for line in outcome.stdout.splitlines() if line[0] == "│")
    assert "40 Hz +0.4" in told
    assert "630 Hz −1.0" in told
    assert "else below 0.05" in told
    assert "rail 0.99, pads 1.10, ballast 0.40; the load at mid-span rests" in told
    assert "mm down, nominally 0.343 mm" in told
    assert "nothing that answers after a force only has the loss factor 2 of the ballast" in outcome.stderr
    Path("viscous.toml").write_text(f'{RAIL}[track]\nname = "nordborg"\nrail_loss_factor = 0.0\n')
    assert "loss factors" not in call("check", "viscous.toml").stdout


def test_check_reads_the_measured_lines():
    np.save("wheel.npy", np.zeros((2890, 10)))
    keys = '[wheel]\nline = "wheel.npy"\nline_unit = "um"\n'
    Path("measured.toml").write_text(f"{RAIL}{keys}line_spacing = '1 mm'\nline_distance = '5 mm'\n")
    shown = " ".join(call("check", "measured.toml").stdout.replace("│", " ").split())
    assert "measured line of [wheel] 10 parallel lines, each of 2890 points, 2.89 m, 1 mm apart" in shown
    Path("measured.toml").write_text(RAIL + keys)
    message = call("check", "measured.toml", code=2).stderr
    assert 'Give it, as in line_spacing = "1.5 um" in [wheel].' in message


def test_check_finds_lines_without_their_distance():
    np.save("wheel.npy", np.zeros((2890, 10)))
    keys = '[wheel]\nline = "wheel.npy"\nline_unit = "um"\nline_spacing = "1 mm"\n'
    Path("measured.toml").write_text(RAIL + keys)
    for command in ("check", "run"):
        message = call(command, "measured.toml", code=2).stderr
        assert "wheel.line_distance: received no distance for 10 lines" in message


@pytest.mark.parametrize("highest", ["300 Hz", "1 kHz"])
def test_fewer_poles_are_taken_where_the_track_remembers_few_steps(highest):
    """A tenth of 0.12 s in steps of 1/(8 f_max)."""
    coarse = f'[numerics]\nhighest_frequency = "{highest}"\n'
    Path("coarse.toml").write_text(RAIL + coarse)
    call("check", "coarse.toml")
    Path("coarse.toml").write_text(RAIL + coarse + "poles = 1000\n")
    call("check", "coarse.toml")


def test_check_finds_a_track_without_damping():
    undamped = 'name = "uic60"\nrail_loss_factor = 0.0\npad_loss_factor = 0.0\nballast_loss_factor = 0.0\n'
    Path("undamped.toml").write_text(f"{RAIL}[track]\n{undamped}")
    assert "track: received no damping at all" in call("check", "undamped.toml", code=2).stderr
