"""Labelled signals of a study of bearings: what was rolled, what is told of it, and that it goes on."""

import csv
import json
import tomllib
from pathlib import Path

import numpy as np
import pytest
import xarray
from executors import Here
from scipy.io import wavfile

import asperity
from asperity.case.cases import as_case, parse_case
from asperity.case.toml import toml_text
from asperity.sensing import through_path
from asperity.studies.axes import AS_IT_IS
from asperity.studies.signals import SignalSet
from command_line import call
from refusals import refusals
from small_cases import BEARING

HEALTHY = {**BEARING, "duration": "50 ms", "seed": 5, "fault": {}}
PIT = {"fault.length": "0.18 mm", "fault.depth": "0.1 mm"}
SWEEP = {
    "variant": {
        "outer pit": PIT | {"fault.on": "outer"},
        "inner spall": PIT | {"fault.on": "inner", "fault.shape": "spall", "fault.angle": "90 deg"},
    }
}


@pytest.fixture(autouse=True)
def kept_members(tmp_path_factory, monkeypatch):
    """Members are rolled once for all tests."""
    monkeypatch.setenv("ASPERITY_CACHE", str(tmp_path_factory.getbasetemp() / "signals"))


def written(case=HEALTHY, sweep=SWEEP, **how):
    """Table of a study, and the labels of its signals with the arrays behind them."""
    table = asperity.study(case, sweep, executor=Here(), signals=SignalSet("set", **{"format": "npy"} | how))
    with open("set/labels.csv", newline="") as file:
        labels = list(csv.DictReader(file))
    return table, labels


def test_signals_are_what_the_main_law_rolls_and_labels_say_of_what():
    table, labels = written()
    assert [row["variant"] for row in labels] == [AS_IT_IS, *SWEEP["variant"]]
    assert [row["fault.on"] for row in labels] == ["none", "outer", "inner"]
    assert [row["fault.shape"] for row in labels] == ["none", "pit", "spall"]
    assert [float(row["fault.width [m]"]) for row in labels] == pytest.approx([0.0, 0.18e-3, 0.18e-3])
    assert labels[0]["fault.angle [rad]"] == ""
    assert float(labels[2]["fault.angle [rad]"]) == pytest.approx(np.pi / 2)
    shaft, ratio = 30.0, 7.94 / 39.04
    for row, name in zip(labels, table["variant"].values, strict=True):
        tones = [float(row[f"{part}_tone [Hz]"]) for part in ("outer", "inner", "ball", "cage")]
        of_shaft = 4.5 * (1 - ratio), 4.5 * (1 + ratio), (1 - ratio**2) / ratio, 0.5 * (1 - ratio)
        assert tones == pytest.approx(shaft * np.array(of_shaft), rel=1e-9)
        assert [row[key] for key in ("seed", "unit", "law")] == ["5", "m/s2", "hertz"]
        told = float(row["speed [Hz]"]), float(row["radial [N]"]), float(row["sampling_rate [Hz]"])
        assert told == pytest.approx((shaft, 100.0, 51_200.0))
        case = as_case(tomllib.loads(Path("set", row["file"]).with_suffix(".toml").read_text()))
        result = asperity.run(case, brief=True)
        np.testing.assert_array_equal(
            np.load(f"set/{row['file']}"), result["rolling/ring_acceleration"].sel(law="hertz")[0]
        )
        found, velocity = table.sel(variant=name), result["bearing/band_velocity"]
        np.testing.assert_array_equal(found["band_velocity"], velocity[:, 0])
        assert found["range"].values.tolist() == velocity["judged_band"].values.tolist()
        np.testing.assert_array_equal(found["line_amplitude"], result["bearing/line_amplitude"][..., 0])
        forces = [result[f"rolling/{ring}_force"].max() for ring in ("inner", "outer")]
        np.testing.assert_array_equal(found["peak_force"][0], forces)
        assert float(found["largest_load"].sel(ring="inner")) == case.contacts[0][1]
    assert "signal" not in table
    assert not {"time", "ring_sensor"} & set(table.dims)
    lengths = table["band_velocity"].sum("range")[:, 0]
    assert lengths[1] > 2.0 * lengths[0]
    assert lengths[2] > 2.0 * lengths[0]


def test_it_goes_on_where_it_was_and_computes_nothing_anew(monkeypatch):
    monkeypatch.setenv("ASPERITY_CACHE", "cache")

    def stops(done, total, message):
        if message.startswith("study") and done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        asperity.study(HEALTHY, SWEEP, executor=Here(), signals=SignalSet("set", "npy"), progress=stops)
    early = {path: path.stat().st_mtime_ns for path in Path("set").glob("*.npy")}
    assert len(early) == 2
    assert not Path("set/labels.csv").exists()
    written()
    assert all(path.stat().st_mtime_ns == early[path] for path in early)
    contents = {path: path.read_bytes() for path in Path("set").glob("*.npy")}
    gone = next(iter(contents))
    gone.unlink()

    def fails(case, **options):
        raise AssertionError("what is finished is not computed anew")

    monkeypatch.setattr("asperity.running.run", fails)
    assert len(written()[1]) == len(contents) == 3
    assert gone.read_bytes() == contents[gone]
    written(format="wav")
    sounds = {path: path.stat().st_mtime_ns for path in Path("set").glob("*.wav")}
    written(format="wav")
    assert all(path.stat().st_mtime_ns == sounds[path] for path in sounds)
    assert [
        row["variant"] for row in written(sweep={"variant": {"outer pit": SWEEP["variant"]["outer pit"]}})[1]
    ] == [AS_IT_IS, "outer pit"]


def test_every_format_holds_the_same_signal():
    _, arrays = written()
    signals = [np.load(f"set/{row['file']}") for row in arrays]
    for row, signal in zip(written(format="wav")[1], signals, strict=True):
        rate, samples = wavfile.read(f"set/{row['file']}")
        scale = float(row["full_scale [m/s2]"])
        assert (rate, samples.dtype, scale) == (51_200, np.int16, abs(signal).max())
        np.testing.assert_allclose(samples / 32_767 * scale, signal, rtol=0.0, atol=0.51 * scale / 32_767)
    for row, signal in zip(written(format="nc")[1], signals, strict=True):
        with xarray.open_dataset(f"set/{row['file']}") as opened:
            np.testing.assert_array_equal(opened["signal"][0], signal)
            assert opened["time"].values[1] == 1 / 51_200
            assert (opened.attrs["fault.on"], opened["signal"].attrs["units"]) == (row["fault.on"], "m/s2")
            assert parse_case(opened.attrs["case"]).fault.on == (
                None if row["fault.on"] == "none" else row["fault.on"]
            )
            assert f"{opened.attrs['fault.length']}" == row["fault.length [m]"]


def test_signals_pass_a_path_and_have_noise_of_their_own():
    response, rate = np.array([0.5, 0.0, -0.2]), 20_000.0
    times = np.arange(3) / rate
    np.savetxt(
        "path.csv", np.column_stack([times, response]), delimiter=",", header="time,response", comments=""
    )
    signals = [np.load(f"set/{row['file']}") for row in written()[1]]
    behind = [np.load(f"set/{row['file']}") for row in written(path="path.csv")[1]]
    for signal, heard in zip(signals, behind, strict=True):
        np.testing.assert_allclose(heard, through_path(signal, 51_200.0, response, rate), rtol=1e-9)
    noisy = [np.load(f"set/{row['file']}") for row in written(path="path.csv", noise="20 dB")[1]]
    noise = [each - quiet for each, quiet in zip(noisy, behind, strict=True)]
    for each, quiet in zip(noise, behind, strict=True):
        assert each.std() == pytest.approx(0.1 * quiet.std(), rel=0.06)
    assert abs(np.corrcoef(noise)[np.triu_indices(3, 1)]).max() < 0.1
    again = [np.load(f"set/{row['file']}") for row in written(path="path.csv", noise="20 dB")[1]]
    np.testing.assert_array_equal(again, noisy)
    absolute = [np.load(f"set/{row['file']}") for row in written(noise="2 m/s^2")[1]]
    assert [np.std(a - b) for a, b in zip(absolute, signals, strict=True)] == pytest.approx(
        [2.0] * 3, rel=0.06
    )


def test_several_sensors_stand_beside_each_other():
    _, (row,) = written({**HEALTHY, "sensors": ["0 deg", "90 deg"]}, {"radial": ["100 N"]}, noise="0 dB")
    found = np.load(f"set/{row['file']}")
    assert found.shape == (2561, 2)
    assert abs(np.corrcoef(found.T)[0, 1]) < 0.9


def test_the_command_line_writes_them():
    written()
    Path("bearing.toml").write_text(as_case(HEALTHY).to_toml())
    Path("study.toml").write_text(toml_text({"case": "bearing.toml", "sweep": SWEEP}))
    words = "study", "study.toml", "--signals", "set", "--format", "wav", "-o", "out"
    said = json.loads(call(*words, "--json", "--quiet").stdout)
    with open(said["files"]["labels"], newline="") as file:
        assert [row["fault.on"] for row in csv.DictReader(file)] == ["none", "outer", "inner"]
    assert {"band_velocity 50 to 300 Hz [m/s]", "line_amplitude outer [m/s2]"} < set(said["columns"])
    assert "rms radial velocity in a band" in Path("out/study.html").read_text().replace("\u00a0", " ")
    refused = call("study", "study.toml", "--noise", "20 dB", code=2).stderr
    assert "--noise: received signals of no study; allowed: it goes with --signals" in refused
    refused = call("study", "ball.toml", "--vary", "seed = 1, 2", "--signals", "set", code=2).stderr
    assert 'signals: received a ball-on-beam case; allowed: a case of kind = "ball-bearing"' in refused


test_what_is_no_set_of_signals_is_refused = refusals(
    ({"format": "mp3"}, "format of the signals"),
    ({"noise": "loud"}, "noise of the signals: received 'loud'; allowed: a level as '20 dB', or an rms"),
    ({"noise": "-1 m/s^2"}, "noise of the signals"),
    ({"noise": "900 dB"}, "within ±200 dB"),
    ({"path_rate": "8 kHz"}, "sampling rate of the path: received a rate without a path"),
    ({"path": "none.npy", "path_rate": "8 kHz"}, "none.npy"),
    ({"path": "uneven.csv"}, "times in uneven.csv: received uneven ones; allowed: equal steps"),
    of=lambda how, uneven: SignalSet("set", **how),
)


@pytest.fixture
def uneven():
    Path("uneven.csv").write_text("0,1\n1,2\n3,4\n")
