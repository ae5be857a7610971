"""``asperity bearing --signal --tacho``: records whose speed changes are read over angle; refusals."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

from asperity.cli.heard import _agreement
from asperity.diagnostics import Tacho, diagnose
from asperity.diagnostics.orders import turns_of_pulses
from asperity.structures.ball_bearing import BallBearing
from command_line import call

RATE = 12_000.0
TIME = np.arange(int(3.0 * RATE)) / RATE
SPEEDS = 20.0 + 6.0 * TIME
TURNS = 20.0 * TIME + 3.0 * TIME**2
"""20 to 38 turns per second."""
OUTER = 4.5 * (1.0 - 7.94 / 39.04)
GIVEN = ("bearing", "6205", "--rate", "12 kHz", "--signal", "run.npz")


@pytest.fixture(autouse=True)
def in_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def struck():
    """Blows on the outer ring that ring at 3 kHz, lines of the shaft, and noise."""
    blows = (np.diff(np.floor(OUTER * TURNS), prepend=0.0) > 0.0).astype(float)
    decay = np.exp(-900.0 * TIME[:150]) * np.sin(2.0 * np.pi * 3000.0 * TIME[:150])
    noise = 0.05 * np.random.default_rng(3).normal(size=TIME.size)
    return np.convolve(blows, decay)[: TIME.size] + noise + 0.05 * np.sin(2.0 * np.pi * TURNS)


def pulses(per_turn):
    """Each a tenth of their distance long."""
    return 5.0 * (np.mod(per_turn * TURNS + 0.5, 1.0) < 0.1)


def told(tacho, *words):
    """What is said of the record with a tacho beside it."""
    np.savez("run.npz", acceleration=struck(), tacho=tacho)
    return json.loads(call(*GIVEN, "--array", "acceleration", *words, "--json").stdout)


@pytest.mark.parametrize(("tacho", "reads"), [(60.0 * SPEEDS, "1/min"), (pulses(2), "2 pulses")])
def test_a_fault_in_a_run_up_is_named_over_angle(tacho, reads):
    found = told(tacho, "--tacho", "tacho", "--tacho-reads", reads)
    assert found["faults"] == ["outer"]
    assert found["speed_is"] == "measured"
    assert found["speed"] == pytest.approx(29.0, rel=0.01)
    assert found["lines"]["outer"]["frequency"][0] / found["speed"] == pytest.approx(OUTER, rel=0.003)
    turned = found["tacho"]
    assert (turned["slowest"], turned["fastest"]) == pytest.approx((20.0, 38.0), rel=0.03)


def test_a_verdict_by_a_tacho_doubts_its_pulses_not_the_speed_told():
    np.savez("run.npz", acceleration=struck(), tacho=pulses(2))
    words = (*GIVEN, "--array", "acceleration", "--tacho", "tacho", "--tacho-reads")
    said = " ".join(call(*words, "2 pulses").stdout.split())
    assert "1741 1/min by the tacho: lines of the shaft are not found" in said
    assert "By the tacho the shaft turns at 29.02 Hz (1741 1/min) on average, if it gives 2 pulses in" in said
    assert "If it does, there are lines of the outer ring at 104.0 Hz" in said
    said = " ".join(call(*words, "4 pulses").stdout.split())
    assert "its line is not found there: does the tacho give 4 pulses in a turn, and is it on this" in said


def test_what_gave_the_speed_is_told_in_python():
    tones = BallBearing.named("6205").tones()
    assert diagnose(struck(), RATE, tones, 29.0, tacho=Tacho(2)).tacho == Tacho(2)
    assert diagnose(struck(), RATE, tones, 29.0).tacho is None


@pytest.mark.parametrize(("how", "apart"), [("measured", False), ("contradicted", True)])
def test_signals_whose_lines_say_no_speed_do_not_tell_of_unlike_ones(how, apart):
    by_lines = SimpleNamespace(parts=(), speed=29.0, speed_is="confirmed")
    other = SimpleNamespace(parts=(), speed=31.0, speed_is=how)
    assert ("unlike speeds" in _agreement({"a.wav": by_lines, "b.wav": other})) is apart


def test_a_steady_speed_smears_nothing():
    np.savez("run.npz", acceleration=struck(), tacho=np.full(TIME.size, 29.0))
    words = (*GIVEN, "--array", "acceleration", "--tacho", "tacho", "--tacho-reads", "Hz")
    assert "Frequencies are those at 1740 1/min.\n" in call(*words).stdout


def test_over_time_it_is_not():
    found = told(SPEEDS, "--speed", "29 Hz")
    assert found["faults"] == []
    assert found["speed_is"] == "unconfirmed"
    assert found["tacho"] is None


def test_a_column_of_a_text_says_its_unit_and_gaps_stay():
    signal = struck()
    signal[9_000:9_400] = np.nan
    table = np.column_stack([signal, 60.0 * SPEEDS])[: 2 * int(RATE)]
    np.savetxt("a.csv", table, delimiter=",", header="a (m/s^2),speed (1/min)", comments="", fmt="%.5g")
    words = ("bearing", "6205", "--rate", "12 kHz", "--signal", "a.csv", "--column", "1", "--tacho", "2")
    said = call(*words, "--speed", "26 Hz").stdout
    assert "Read over angle, by the tacho: 120" in said
    assert "smeared by a factor of 1.5" in said
    assert "in 2 stretches without a gap" in said


def test_pulses_tell_the_angle_between_them():
    turns = turns_of_pulses(pulses(1))
    known = np.isfinite(turns)
    assert known.mean() > 0.95
    assert np.ptp((turns - TURNS)[known]) < 1.0 / 300.0  # of a turn: a sample or less


COLUMN = ("--tacho", "tacho", "--tacho-reads")
MISSED = pulses(1) * ~((TURNS > 19.8) & (TURNS < 20.8))
REFUSED = [
    (SPEEDS, ("--tacho", "tacho"), "--tacho-reads: received nothing, and no unit above the column"),
    (SPEEDS, (*COLUMN, "0 pulses"), "--tacho-reads: received '0 pulses'; allowed:"),
    (SPEEDS, (*COLUMN, "furlong"), 'allowed: "1/min", "Hz", or its pulses in a turn, as "1 pulse"'),
    (
        SPEEDS,
        (*COLUMN, "Hz", "--speed", "1200 1/min"),
        "tacho: received 1740 1/min on average, beside a speed of 1200 1/min; allowed: speeds within 10%",
    ),
    (SPEEDS, ("--tacho", "3", "--tacho-reads", "Hz"), "column of the tacho in run.npz: received 3; allowed"),
    (SPEEDS[:-5], (*COLUMN, "Hz"), "received 35995 samples beside a signal of 36000; allowed: one for each"),
    (np.maximum(SPEEDS - 30.0, 0.0), (*COLUMN, "Hz"), "allowed: speeds above zero. Cut off where it stands"),
    (np.full(TIME.size, np.nan), (*COLUMN, "Hz"), "tacho in run.npz: received no number; allowed: speeds"),
    (np.full(TIME.size, 0.5), (*COLUMN, "Hz"), "tacho: received 1.5 turns; allowed: at least 4 turns"),
    (
        pulses(1),
        (*COLUMN, "60 pulses"),
        "allowed: at least 4 turns. Does the tacho give 60 pulses in a turn, and is it on this shaft? "
        "Otherwise record longer.",
    ),
    (
        300.0 * SPEEDS,
        (*COLUMN, "Hz"),
        "Is the speed beside the signal that of this shaft, and are its unit and the rate right? Otherwise "
        "sample faster.",
    ),
    (SPEEDS, ("--tacho-reads", "Hz", "--speed", "29 Hz"), "received 'Hz'; allowed: --tacho COLUMN with it"),
    (MISSED, (*COLUMN, "1 pulse"), "as far apart as the next, near sample"),
    (0.0 * TIME, (*COLUMN, "1 pulse"), "Is it the column of the tacho?"),
    (1.0 * (TIME > 1.0), (*COLUMN, "1 pulse"), "received 1 pulse; allowed: at least 5"),
]


@pytest.mark.parametrize(("tacho", "words", "message"), REFUSED, ids=range(len(REFUSED)))
def test_tachos_that_do_not_fit_are_refused(tacho, words, message):
    np.savez("run.npz", acceleration=TIME, tacho=tacho)
    assert message in call(*GIVEN, "--array", "acceleration", *words, code=2).stderr
