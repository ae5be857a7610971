"""Sounds of a run: pitch, scale and length of WAV files, and names that lead nowhere else."""

import csv
import io
import wave

import numpy as np
import pytest
import xarray

import asperity
from asperity.errors import InputError
from asperity.reporting.sound import FADE, PEAK, RATE, Sound, at_rate, wav_bytes

STEP = 1 / 37333.0


def result(laws=("areal", "linear"), tones=(1.0, 0.1), places=(0.2, 0.5), name="acceleration", units="m/s2"):
    """Made-up run: a tone of 1 kHz for each law, twice as strong at the second place, over a mean."""
    time = STEP * np.arange(40_000)
    tone = np.sin(2 * np.pi * 1000.0 * time)
    signal = 5.0 + np.array(tones)[:, None, None] * np.array([1.0, 2.0])[:, None] * tone
    rolling = xarray.Dataset(
        {name: (("law", "sensor", "time"), signal, {"units": units}),
         "contact_force": (("law", "time"), signal[:, 0], {"units": "N"}),
         "relative_displacement": (("law", "time"), signal[:, 0], {"units": "m"})},
        coords={"law": list(laws), "sensor": ("sensor", list(places), {"units": "m"}), "time": time},
    )  # fmt: skip
    return xarray.DataTree.from_dict({"/rolling": rolling})


def read(path):
    with wave.open(str(path)) as sound:
        assert (sound.getnchannels(), sound.getsampwidth(), sound.getframerate()) == (1, 2, RATE)
        return np.frombuffer(sound.readframes(sound.getnframes()), "<i2") / 32767


def test_a_tone_keeps_its_pitch_its_amplitude_and_its_length():
    time = STEP * np.arange(40_000)
    found = at_rate(7.0 + 3.0 * np.sin(2 * np.pi * 1000.0 * time), STEP)
    assert len(found) / RATE == pytest.approx(40_000 * STEP, abs=0.5 / RATE)
    inner = slice(round(2 * FADE * RATE), -round(2 * FADE * RATE))
    expected = 3.0 * np.sin(2 * np.pi * 1000.0 * np.arange(len(found)) * 40_000 * STEP / len(found))
    np.testing.assert_allclose(found[inner], expected[inner], atol=2e-3)
    assert abs(found[0]) < 1e-3
    assert abs(found.mean()) < 1e-3


def test_what_is_too_high_to_be_heard_is_left_out_and_folds_nowhere():
    time = 1e-6 * np.arange(200_000)
    found = at_rate(np.sin(2 * np.pi * 30e3 * time) + np.sin(2 * np.pi * 440.0 * time), 1e-6)
    spectrum = np.abs(np.fft.rfft(found * np.hanning(len(found))))
    assert np.argmax(spectrum) * RATE / len(found) == pytest.approx(440.0, abs=5.0)
    assert spectrum[round(1000 * len(found) / RATE) :].max() < 1e-4 * spectrum.max()


def test_laws_are_on_one_scale_unless_they_are_matched(tmp_path):
    files = asperity.listen(result(), tmp_path / "one")
    names = [f"acceleration-{law}-{place}_m.wav" for law in ("areal", "linear") for place in ("0.2", "0.5")]
    assert [file.name for file in files] == names
    peaks = [np.abs(read(file)).max() for file in files]
    np.testing.assert_allclose(peaks, PEAK * np.array([0.5, 1.0, 0.05, 0.1]), rtol=1e-3)
    with open(tmp_path / "one" / "sounds.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["file"] for row in rows] == names
    for row, each in zip(rows, (1.0, 2.0, 0.1, 0.2), strict=True):
        sample = np.abs(read(tmp_path / "one" / row["file"])).max() * float(row["full sample"])
        assert (sample, row["unit"]) == (pytest.approx(each, rel=2e-3), "m/s2")
        assert float(row["A-weighted rms"]) == pytest.approx(each / np.sqrt(2), rel=0.01)  # 0 dB at 1 kHz
    matched = [read(file) for file in asperity.listen(result(), tmp_path / "two", matched=True)]
    np.testing.assert_allclose([np.abs(each).max() for each in matched], PEAK, rtol=1e-3)


def test_what_is_heard_can_be_chosen(tmp_path):
    (first, _) = asperity.listen(result(), tmp_path, what="contact_force")
    assert first.name == "contact_force-areal.wav"
    with pytest.raises(InputError, match=r"'relative_displacement'; allowed: acceleration, contact_force\."):
        asperity.listen(result(), tmp_path, what="relative_displacement")
    with pytest.raises(InputError, match="nothing, for the run holds no signal"):
        asperity.listen(xarray.DataTree(), tmp_path)
    with pytest.raises(InputError, match=r"what asperity\.run or asperity\.open_result returned"):
        asperity.listen("run.nc", tmp_path)


def test_velocity_is_taken_where_there_is_no_acceleration(tmp_path):
    (first, *_) = asperity.listen(result(name="point_velocity", units="m/s"), tmp_path)
    assert first.name.startswith("point_velocity")


def test_names_of_a_foreign_result_lead_nowhere_else(tmp_path):
    files = asperity.listen(result(laws=("../../up", "a/b c")), tmp_path / "in")
    assert {file.parent for file in files} == {tmp_path / "in"}
    assert Sound("..", "/etc/x", "", "N", np.zeros(2)).file_name == "-_etc_x.wav"


def test_silence_is_written_as_silence(tmp_path):
    (first, *_) = asperity.listen(result(tones=(0.0, 0.0)), tmp_path, matched=True)
    assert not read(first).any()


def test_a_file_never_wraps():
    with wave.open(io.BytesIO(wav_bytes([2.0, -2.0]))) as sound:
        assert np.frombuffer(sound.readframes(2), "<i2").tolist() == [32767, -32767]


@pytest.mark.parametrize("kind", ["ball-on-beam", "wheel-on-rail"])
def test_every_kind_can_be_listened_to(real_runs, kind, tmp_path):
    tree = real_runs[kind]
    files = asperity.listen(tree, tmp_path)
    duration = float(tree["rolling"]["time"][-1])
    assert len(files) >= tree["rolling"].sizes["law"]
    assert all(len(read(file)) / RATE == pytest.approx(duration, rel=0.01) for file in files)
