"""Labelled signals of a study of bearings: what was rolled, what is told of it; behind a path, in noise."""

import csv
import json
import struct
import tomllib
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray
from executors import Here
from scipy.io import savemat, wavfile

import asperity
from asperity.case.cases import as_case, parse_case
from asperity.case.toml import toml_text
from asperity.errors import InputError
from asperity.reporting.study_figures import key_figure
from asperity.studies.axes import AS_IT_IS
from asperity.studies.recorded import read_record, read_signal
from asperity.studies.sensor_path import through_path, with_noise
from asperity.studies.signals import SignalSet
from asperity.universal_files import Channel, universal_text
from command_line import call
from refusals import refusals
from small_cases import BEARING

HEALTHY = {**BEARING, "duration": "50 ms", "seed": 5, "fault": {}}
SPALL = {"fault.on": "inner", "fault.shape": "spall", "fault.angle": "90 deg"}
SIZE = {"fault.length": "0.18 mm", "fault.depth": "0.1 mm"}
OUTER = {"outer pit": SIZE | {"fault.on": "outer"}}
SWEEP = {"variant": OUTER | {"inner spall": SIZE | SPALL}}


@pytest.fixture(autouse=True)
def kept_members(tmp_path_factory, monkeypatch):
    """Members are rolled once for all tests."""
    monkeypatch.setenv("ASPERITY_CACHE", str(tmp_path_factory.getbasetemp() / "signals"))


def written(case=HEALTHY, sweep=SWEEP, progress=None, **how):
    """Table of a study, and labels of its signals."""
    signals = SignalSet("set", **{"format": "npy"} | how)
    table = asperity.study(case, sweep, executor=Here(), signals=signals, progress=progress)
    with open("set/labels.csv", newline="") as file:
        return table, list(csv.DictReader(file))


def heard(**how):
    """The signals themselves."""
    return np.stack([np.load(f"set/{row['file']}") for row in written(**how)[1]])


def test_signals_are_what_the_main_law_rolls_and_labels_say_of_what():
    table, labels = written()
    assert [row["variant"] for row in labels] == [AS_IT_IS, *SWEEP["variant"]]
    keys = "fault.on", "fault.shape", "fault.width [m]", "fault.angle [rad]"
    assert [labels[0][key] for key in keys] == ["none", "none", "0.0", ""]
    row, ratio = labels[2], 7.94 / 39.04
    assert [row[key] for key in keys[:2]] == ["inner", "spall"]
    assert [float(row[key]) for key in keys[2:]] == pytest.approx([0.18e-3, np.pi / 2])
    tones = [float(row[f"{part}_tone [Hz]"]) for part in ("outer", "inner", "ball", "cage")]
    of_shaft = 4.5 * (1 - ratio), 4.5 * (1 + ratio), (1 - ratio**2) / ratio, 0.5 * (1 - ratio)
    assert tones == pytest.approx(30.0 * np.array(of_shaft), rel=1e-9)
    assert [row[key] for key in ("seed", "unit", "law")] == ["5", "m/s2", "hertz"]
    told = [float(row[key]) for key in ("speed [Hz]", "radial [N]", "sampling_rate [Hz]")]
    assert told == pytest.approx([30.0, 100.0, 51_200.0])
    case = as_case(tomllib.loads(Path("set", row["file"]).with_suffix(".toml").read_text()))
    result, found = asperity.run(case, brief=True), table.sel(variant="inner spall")
    signal = result["rolling/ring_acceleration"].sel(law="hertz")[0]
    np.testing.assert_array_equal(np.load(f"set/{row['file']}"), signal)
    np.testing.assert_array_equal(found["band_velocity"], result["bearing/band_velocity"][:, 0])
    np.testing.assert_array_equal(found["line_amplitude"], result["bearing/line_amplitude"][..., 0])
    forces = [result[f"rolling/{ring}_force"].max() for ring in ("inner", "outer")]
    np.testing.assert_array_equal(found["peak_force"][0], forces)
    assert found["largest_load"].values.tolist() == [load for _, load in case.contacts]
    assert not {"signal", "time", "ring_sensor"} & set(table.variables)


def test_it_goes_on_where_it_was_and_computes_nothing_anew(monkeypatch):
    def stops(done, total, message):
        if message.startswith("study") and done == 2:
            raise KeyboardInterrupt

    with monkeypatch.context() as apart:
        apart.setenv("ASPERITY_CACHE", "cache")
        with pytest.raises(KeyboardInterrupt):
            written(sweep={"variant": OUTER}, progress=stops)
    early = {path: path.stat().st_mtime_ns for path in Path("set").glob("*.npy")}
    assert (len(early), Path("set/labels.csv").exists()) == (2, False)
    written()
    contents = {path: path.read_bytes() for path in Path("set").glob("*.npy")}
    gone = next(path for path in contents if path not in early)
    gone.unlink()
    monkeypatch.setattr("asperity.running.run", None)  # nothing is computed any more
    assert len(written()[1]) == len(contents) == 3
    assert gone.read_bytes() == contents[gone]
    written(format="wav")
    early |= {path: path.stat().st_mtime_ns for path in Path("set").glob("*.wav")}
    written(format="wav")
    assert all(path.stat().st_mtime_ns == early[path] for path in early)
    assert len(written(sweep={"variant": OUTER})[1]) == 2


def test_every_format_holds_the_same_signal():
    signals = heard()
    for row, signal in zip(written(format="wav")[1], signals, strict=True):
        rate, samples = wavfile.read(f"set/{row['file']}")
        scale = float(row["full_scale [m/s2]"])
        assert (rate, samples.dtype, scale) == (51_200, np.int16, abs(signal).max())
        np.testing.assert_allclose(samples / 32_767 * scale, signal, rtol=0.0, atol=0.51 * scale / 32_767)
    for row, signal in zip(written(format="nc")[1], signals, strict=True):
        with xarray.open_dataset(f"set/{row['file']}") as opened:
            np.testing.assert_array_equal(opened["signal"][0], signal)
            assert opened["time"].values[1] == 1 / 51_200
            assert (opened["tacho_speed"].values == 30.0).all()
            case = parse_case(opened.attrs["case"])
            assert (case.fault.on or "none") == opened.attrs["fault.on"] == row["fault.on"]
            assert f"{opened.attrs['fault.length']}" == row["fault.length [m]"]


def test_signals_pass_a_path_and_have_noise_of_their_own():
    response, rate = np.array([0.5, 0.0, -0.2]), 20_000.0
    np.savetxt("path.csv", np.column_stack([np.arange(3) / rate, response]), delimiter=",")
    signals, behind = heard(), heard(path="path.csv")
    expected = [through_path(signal, 51_200.0, response, rate) for signal in signals]
    np.testing.assert_allclose(behind, expected, rtol=1e-9)
    noisy = heard(path="path.csv", noise="20 dB")
    np.testing.assert_allclose((noisy - behind).std(axis=1), 0.1 * behind.std(axis=1), rtol=0.06)
    assert abs(np.corrcoef(noisy - behind)[np.triu_indices(3, 1)]).max() < 0.1
    for file in Path("set").glob("*.npy"):
        file.unlink()
    np.testing.assert_array_equal(heard(path="path.csv", noise="20 dB"), noisy)
    np.testing.assert_allclose((heard(noise="2 m/s^2") - signals).std(axis=1), 2.0, rtol=0.06)
    (both,) = heard(case=HEALTHY | {"sensors": ["0 deg", "90 deg"]}, sweep={"seed": [5]}, noise="2 m/s^2")
    assert both.shape == (2561, 2)
    assert abs(np.corrcoef(both.T)[0, 1]) < 0.2


def test_the_command_line_writes_them():
    written()
    Path("bearing.toml").write_text(as_case(HEALTHY).to_toml())
    Path("study.toml").write_text(toml_text({"case": "bearing.toml", "sweep": SWEEP}))
    words = "study", "study.toml", "--signals", "set", "--format", "wav", "-o", "out"
    said = json.loads(call(*words, "--json", "--quiet").stdout)
    assert len(Path(said["files"]["labels"]).read_text().splitlines()) == 4
    assert {"band_velocity 50 to 300 Hz [m/s]", "line_amplitude outer [m/s2]"} < set(said["columns"])
    assert "rms radial velocity in a band" in Path("out/study.html").read_text().replace("\u00a0", " ")


def test_labels_tell_every_fault_and_none_where_there_is_none():
    second = {"on": "ball", "ball": 7, "length": 2.0**-12, "depth": "9 um"}
    second = {f"fault[2].{name}": value for name, value in second.items()}
    _, (_, one, two) = written(sweep={"variant": OUTER | {"two": OUTER["outer pit"] | second}})
    names = ["on", "ball", "length [m]", "angle [rad]"]
    assert [two[f"fault[2].{name}"] for name in names] == ["ball", "7", "0.000244140625", "0.0"]
    assert [one[f"fault[2].{name}"] for name in names] == ["none", "0", "0.0", ""]


def test_a_figure_of_several_keys_says_which_part_it_shows_the_largest():
    table = written()[0].expand_dims(speed=[25.0, 30.0]).assign_attrs(sweep='{"speed": 0, "variant": 0}')
    table["speed"].attrs |= {"units": "Hz", "long_name": "speed"}
    panel, *_ = key_figure(table, None, "variant", {}, ["line_amplitude"])
    largest = table["line_amplitude"].max(["speed", "variant", "law"]).idxmax("part")
    assert panel.title.endswith(f", {largest.item()}")
    shown = table["line_amplitude"].sel(part=largest, speed=30.0, law="hertz")
    np.testing.assert_allclose(panel.marks[1].y, shown)


test_what_is_no_set_of_signals_is_refused = refusals(
    ({"format": "mp3"}, "format of the signals"),
    ({"noise": "loud"}, "noise of the signals: received 'loud'; allowed: a level as '20 dB', or an rms"),
    ({"noise": "900 dB"}, "within ±200 dB"),
    ({"path_rate": "8 kHz"}, "sampling rate of the path: received a rate without a path"),
    ({"path": "none.npy", "path_rate": "8 kHz"}, "none.npy"),
    ({"path": "uneven.csv"}, "times in uneven.csv: received uneven ones; allowed: equal steps"),
    ({}, 'signals: received a ball-on-beam case; allowed: a case of kind = "ball-bearing"'),
    of=lambda how: refused(**how),
)


def refused(**how):
    Path("uneven.csv").write_text("0,1\n1,2\n3,4\n")
    asperity.study("ball.toml", {"seed": [1, 2]}, executor=Here(), signals=SignalSet("set", **how))


# --- behind a path, and in noise: closed forms


RATE = 51_200.0
TIME = np.arange(10_240) / RATE
WEIGHTS = np.exp(-np.arange(40) / 7.0) * np.cos(0.9 * np.arange(40))


def sine(frequency):
    """It comes and goes softly: edges hold every frequency."""
    return np.sin(np.pi * TIME / TIME[-1]) ** 2 * np.sin(2 * np.pi * frequency * TIME)


def test_a_path_of_the_same_rate_is_a_filter_and_one_alone_leaves_the_signal():
    signal = np.random.default_rng(3).normal(size=TIME.size)
    np.testing.assert_allclose(through_path(signal, RATE, [1.0], RATE), signal, rtol=0.0, atol=1e-13)
    filtered = np.convolve(signal, WEIGHTS)[: signal.size]
    np.testing.assert_allclose(through_path(signal, RATE, WEIGHTS, RATE), filtered, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize(("rate", "frequency"), [(12e3, 500.0), (12e3, 5e3), (44_100.0, 5e3), (96e3, 500.0)])
def test_a_sine_leaves_a_path_of_any_rate_with_its_transfer_function(rate, frequency):
    found = through_path(sine(frequency), RATE, WEIGHTS, rate)
    middle = slice(4000, 6240)
    transfer = abs(np.exp(-2j * np.pi * frequency / rate * np.arange(WEIGHTS.size)) @ WEIGHTS)
    assert found[middle].std() == pytest.approx(transfer * sine(frequency)[middle].std(), rel=2e-3)


def test_nothing_passes_above_what_the_path_knows_and_all_below():
    found = through_path(sine(1000.0) + sine(8000.0), RATE, [1.0], 12_000.0)
    np.testing.assert_allclose(found, sine(1000.0), rtol=0.0, atol=1e-5)


def test_what_leaves_the_record_at_its_end_does_not_come_back_at_its_beginning():
    burst = np.exp(-(((TIME - 0.19) / 2e-3) ** 2))
    late = np.r_[np.zeros(500), 1.0]  # 42 ms
    assert abs(through_path(burst, RATE, late, 12_000.0)).max() < 1e-6
    shifted = through_path(burst[::-1], RATE, late, 12_000.0)
    assert TIME[shifted.argmax()] == pytest.approx(TIME[-1] - 0.19 + 500 / 12_000, abs=1 / RATE)


def test_noise_has_its_level_is_white_and_differs_by_seed():
    signal = 3.0 + np.sin(2 * np.pi * 700.0 * TIME)
    for given, rms in (({"below": 20.0}, 0.1 * np.sqrt(0.5)), ({"rms": 0.3}, 0.3)):
        noise = [with_noise(signal, seed, **given) - signal for seed in (1, 2, 1)]
        for each in noise:
            assert each.std() == pytest.approx(rms, rel=4.0 / np.sqrt(2 * TIME.size))
            assert abs(each[1:] @ each[:-1]) < 4.0 * rms**2 * np.sqrt(TIME.size)
        np.testing.assert_array_equal(noise[0], noise[2])
        assert abs(noise[0] @ noise[1]) < 4.0 * rms**2 * np.sqrt(TIME.size)


def path(response=(1.0,), rate=RATE, signal=TIME):
    return lambda: through_path(signal, RATE, response, rate)


test_wrong_paths_and_levels = refusals(
    (path([]), "impulse response: received 0 s; allowed: above 0, and at most 0.2 s"),
    (path(np.ones(9), 40.0), "impulse response: received 0.225 s"),
    (path(rate=1.0), "received 51200 and 1 Hz; allowed: up to 10000 times apart"),
    (path(rate=0.0), r"sampling rate of the path \(Hz\): received 0.0"),
    (path([1.0, np.nan]), "impulse response: received nan"),
    (lambda: with_noise(TIME, 1, below=1.0, rms=1.0), "noise: received both or none"),
    (lambda: with_noise(TIME, 1), "allowed: one of below and rms"),
)


SAMPLES = np.arange(-300, 300, dtype="<i2")


def wav(samples=SAMPLES, form=1, *, channels=1, rate=12_000, align=2, bits=16, **fields):
    """A WAV file of 12 kHz, whose head may tell other sizes of RIFF and data, and another form than PCM."""
    sizes = {"riff": 36 + samples.nbytes, "data": samples.nbytes} | fields
    kind = struct.pack("<HHIIHH", form, channels, rate, 24_000, align, bits)
    chunks = b"fmt " + struct.pack("<I", 16) + kind + b"data" + struct.pack("<I", sizes["data"])
    return b"RIFF" + struct.pack("<I", sizes["riff"]) + b"WAVE" + chunks + samples.tobytes()


def recorded(name, contents, tmp_path):
    file = tmp_path / name
    if isinstance(contents, bytes):
        file.write_bytes(contents)
    else:
        np.save(file, contents)
    return read_signal(file, 12e3)[0]


def test_a_wav_file_is_read_in_shares_of_full_scale(tmp_path):
    np.testing.assert_array_equal(recorded("a.wav", wav(), tmp_path), SAMPLES / 2**15)


def test_a_wav_file_with_the_highest_byte_first(tmp_path):
    head = b"WAVEfmt " + struct.pack(">IHHIIHH", 16, 1, 1, 12_000, 24_000, 2, 16)
    content = head + b"data" + struct.pack(">I", SAMPLES.nbytes) + SAMPLES.astype(">i2").tobytes()
    file = b"RIFX" + struct.pack(">I", len(content)) + content
    np.testing.assert_array_equal(recorded("a.wav", file, tmp_path), SAMPLES / 2**15)
    with pytest.raises(InputError, match="1 channel of 0 bits, 2 bytes a sample, 12000 samples per second"):
        recorded("a.wav", file.replace(b"\0\x10data", b"\0\0data"), tmp_path)


@pytest.mark.parametrize("name", ["a.mat", "a", "a.dat"])
@pytest.mark.parametrize("shape", [(-1, 1), (1, -1)])
def test_a_record_of_matlab_is_read_whatever_it_is_called(tmp_path, name, shape):
    """As it is handed round: a column beside the turns per minute; sizes of one are no signals."""
    stored = {"X097_DE_time": TIME.reshape(shape), "X097RPM": 1797.0}
    savemat(tmp_path / name, stored, appendmat=False)
    values, rate = read_signal(tmp_path / name, 12e3)
    np.testing.assert_array_equal(values, TIME)
    assert rate == 12e3


@pytest.mark.parametrize("encoding", ["utf-8", "latin-1", "utf-16"])
def test_a_column_with_decimal_commas_below_a_title_in_any_encoding(encoding, tmp_path):
    values = np.round(np.sin(0.1 * np.arange(200)), 4)
    text = "Beschleunigung in m/s²\n" + "\n".join(f"{value:.4f}".replace(".", ",") for value in values)
    np.testing.assert_array_equal(recorded("a.txt", text.encode(encoding), tmp_path), values)
    pairs = "\n".join(f"{number},{number * 3}" for number in range(9))  # whole numbers beside each other
    with pytest.raises(InputError, match="2 columns"):
        recorded("b.txt", pairs.encode(), tmp_path)


def test_the_content_of_a_record_decides_not_its_name(tmp_path):
    np.testing.assert_array_equal(recorded("a.txt", wav(), tmp_path), SAMPLES / 2**15)
    np.save(tmp_path / "a.npy", TIME)
    (tmp_path / "a.npy").rename(tmp_path / "a.bin")
    np.testing.assert_array_equal(read_signal(tmp_path / "a.bin", 12e3)[0], TIME)


OF_NINE = universal_text([Channel("a", np.sin(np.arange(9.0)), 1e-4, "m/s2")]).encode()

test_signals_that_are_none = refusals(
    (
        "a.bin",
        b"\x00\x00\x01\x02\xff" * 40,
        "bytes that are no text, and no signal; allowed: .npz, .npy, .wav, .mat, .parquet, .uff or",
    ),
    ("a.wav", wav(data=2**32 - 1, riff=2**32 - 1), "4294967295 bytes of samples, by its head, in 1200"),
    (
        "a.wav",
        wav(form=2),
        r"a kind of WAV that is not read \(.*ADPCM\); allowed: whole numbers .* PCM of 16 bits",
    ),
    ("a.wav", wav(form=3), r"a kind of WAV that is not read \(.*16-bit floating-point data\)"),
    ("a.npy", np.float64(3.0), "a single number; allowed: a signal"),
    (
        "a.wav",
        wav(bits=0),
        "received 1 channel of 0 bits, 2 bytes a sample, 12000 samples per second, by its head; allowed: "
        "none of them 0, and bytes for all bits. Its head is damaged",
    ),
    ("a.wav", wav(rate=0), "received 1 channel of 16 bits, 2 bytes a sample, 0 samples per second"),
    ("a.wav", wav(channels=0), "received 0 channels of 16 bits, 2 bytes a sample"),
    ("a.wav", wav(channels=2), "received 2 channels of 16 bits, 2 bytes a sample"),
    ("a.wav", wav(bits=17), "received 1 channel of 17 bits, 2 bytes a sample"),
    ("a.wav", wav()[:36], "a WAV file without its piece 'data'; allowed: one that tells its kind .*damaged"),
    ("a.wav", wav().replace(b"fmt ", b"fmT "), "a WAV file without its piece 'fmt '; allowed"),
    ("a.wav", wav()[:12], "a WAV file without its piece 'fmt ' and 'data'; allowed"),
    ("a.wav", wav()[:-7], r"1200 bytes of samples, by its head, in 1193; .*truncated"),
    (
        "a.npy",
        1e308 * np.sin(np.arange(9.0)),
        r"values of up to 9.89·10³⁰⁷; allowed: 1·10⁻⁶⁰ to 1·10⁶⁰ at most",
    ),
    ("a.txt", "\n".join(f"{(-1) ** n}e308 {n}" for n in range(9)).encode(), "2 columns"),  # and no word more
    ("a.npy", 1e-300 * np.sin(np.arange(9.0)), "values of up to 9.89·10⁻³⁰¹"),
    (
        "a.uff",
        b"    -1\n    15\n         1         1         1        11  0.0E+00  0.0E+00  0.0E+00\n    -1\n",
        "received datasets 15, 0 of them time responses; allowed: a time response in a dataset 58",
    ),
    *(
        (
            "a.uff",
            OF_NINE.replace(b"         9         1", b"%10d         1" % told),
            f"{told} samples, by its head",
        )
        for told in (8, 10, 999999999)
    ),
    of=recorded,
)


def test_a_signal_has_one_row_under_the_name_of_a_variant_where_the_case_as_it_is_is_the_same():
    _, labels = written(sweep={"radial": ["50 N", "100 N"], "variant": {"heavy": {"radial": "100 N"}}})
    told = [(row["variant"], float(row["radial [N]"])) for row in labels]
    assert told == [(AS_IT_IS, 50.0), ("heavy", 100.0)]
    assert len({row["file"] for row in labels}) == 2


BESIDE = {
    "fs": 12e3, "Fs": np.array([[12_000]]), "sample_rate": np.array([12_000.0]), "sr": 12_000, "fs_kHz": 12.0,
    "SamplingFrequency": 12e3, "rate": 12e3, "dt": 1 / 12e3, "dt_ms": 1 / 12,
    "t": np.arange(TIME.size) / 12e3, "time": np.arange(TIME.size)[:, None] / 12e3,
}  # fmt: skip


@pytest.mark.parametrize("kind", ["npz", "mat", "struct", "hdf5"])
@pytest.mark.parametrize("name", BESIDE)
def test_what_stands_beside_a_signal_gives_its_sampling_rate(tmp_path, kind, name):
    """A number or times, by the names that people give them; a shaft's rate, and another speed, are none."""
    file, held = (
        tmp_path / "run.mat",
        {"gs": TIME[:, None], "load": 270.0, "frequency": 25.0, name: BESIDE[name]},
    )
    if kind == "npz":
        file = tmp_path / "run.mat.npz"
        np.savez(file, **held | {"gs": TIME})
    elif kind == "hdf5":
        with h5py.File(file, "w") as opened:
            for each, value in held.items():
                opened["/bearing/" + each] = np.atleast_2d(value).T
    else:
        savemat(file, {"bearing": held} if kind == "struct" else held)
    array = {"npz": "gs", "mat": "gs"}.get(kind, "bearing.gs")
    found = read_record(file, array=array)
    np.testing.assert_array_equal(found.values, TIME)
    assert found.rate == pytest.approx(12e3, rel=1e-6)
    assert name in found.rate_by
    assert read_signal(file, 12_050.0, array=array)[1] == pytest.approx(12e3)
    with pytest.raises(InputError, match=f"received 48000 Hz; allowed: 12000 Hz, as '.*{name}' says"):
        read_signal(file, 48e3, array=array)


def test_what_is_no_sampling_rate_is_none_and_two_that_differ_are_refused(tmp_path):
    file = tmp_path / "run.npz"
    np.savez(file, gs=TIME, rate=25.0, fs=-1.0, dt=0.0, t=np.zeros(TIME.size), sr=np.nan, speed=1797.0)
    with pytest.raises(InputError, match="sampling rate: received nothing"):
        read_signal(file, array="gs")
    np.savez(file, gs=TIME, fs=12e3, dt=1 / 48e3)
    with pytest.raises(InputError, match=r"sampling rates in run.npz: received fs 12000 Hz, dt 48000 Hz"):
        read_signal(file, 12e3, array="gs")


def test_the_head_of_a_wav_file_is_not_overruled_in_silence(tmp_path):
    (tmp_path / "a.wav").write_bytes(wav())
    with pytest.raises(InputError, match=r"received 48000 Hz; allowed: .* as its head says"):
        read_signal(tmp_path / "a.wav", 48e3)
