"""Sounds of a run: pitch, scale and length of WAV files, and names that lead nowhere else."""

import csv
import io
import wave

import numpy as np
import pytest
import xarray
from scipy.fft import rfft, rfftfreq

import asperity
from asperity.reporting.sound import FADE, PEAK, RATE, Sound, at_rate, pass_by_pressure, radiated
from asperity.wave_files import wave_bytes
from refusals import refusals

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
    (first, *_) = asperity.listen(result(name="point_velocity", units="m/s"), tmp_path)
    assert first.name.startswith("point_velocity")  # where there is no acceleration


test_what_cannot_be_heard_is_told = refusals(
    (result(), "relative_displacement", "'relative_displacement'; allowed: acceleration, contact_force."),
    (result(), "pass_by_pressure", "received 'pass_by_pressure'"),
    (xarray.DataTree(), None, "nothing, for the run holds no signal"),
    ("run.nc", None, r"what asperity\.run or asperity\.open_result returned"),
    of=lambda tree, what, tmp_path: asperity.listen(tree, tmp_path, what=what),
)


def test_names_of_a_foreign_result_lead_nowhere_else_and_silence_is_silence(tmp_path):
    tree = result(laws=("../../up", "a/b c"), tones=(0.0, 0.0))
    files = asperity.listen(tree, tmp_path / "in", matched=True)
    assert {file.parent for file in files} == {tmp_path / "in"}
    assert not read(files[0]).any()
    assert Sound("..", "/etc/x", "", "N", np.zeros(2)).file_name == "-_etc_x.wav"


def test_a_file_never_wraps():
    with wave.open(io.BytesIO(wave_bytes([2.0, -2.0], RATE, 1.0, "N"))) as sound:
        assert np.frombuffer(sound.readframes(2), "<i2").tolist() == [32767, -32767]


@pytest.mark.parametrize("what", [None, "pass_by_pressure"])
def test_a_real_run_can_be_listened_to(real_runs, what, tmp_path):
    tree = real_runs["wheel-on-rail"]
    files = asperity.listen(tree, tmp_path, what=what)
    duration = float(tree["rolling"]["time"][-1])
    assert len(files) >= tree["rolling"].sizes["law"]
    assert all(len(read(file)) / RATE == pytest.approx(duration, rel=0.01) for file in files)


def passing(speed, level=100.0):
    """Made-up run of a wheel: a tone, whose sound power is known in the band."""
    time = STEP * np.arange(40_000)
    force = 65e3 + 300.0 * np.sin(2.0 * np.pi * 1000.0 * time)[None]
    power = np.full((1, 3, 2), np.nan)
    power[0, :2] = [[level - 10.0 * np.log10(2.0), -300.0]] * 2  # two sources, one that does not radiate
    rolling = xarray.Dataset(
        {"contact_force": (("law", "time"), force, {"units": "N"})},
        {"law": ["areal"], "time": time},
        {"speed": speed},
    )
    spectra = xarray.Dataset(
        {"sound_power_level": (("law", "source", "noise_band"), power)},
        {"law": ["areal"], "noise_band": [1000.0, 2000.0]},
    )
    return xarray.DataTree.from_dict({"/rolling": rolling, "/spectra": spectra})


def test_pressure_beside_the_track_is_that_of_a_source_above_ground():
    """At rest 7.5 m away: L_p = L_W − 10 lg(2π d²/1 m²) + 10 lg(413 · 1e-12/4e-10)."""
    found = pass_by_pressure(passing(speed=0.0))
    level = 20.0 * np.log10(found.values.std() / 2e-5)
    assert level == pytest.approx(100.0 - 10.0 * np.log10(2.0 * np.pi * 7.5**2) + 0.14, abs=0.02)


def with_spectra(tree, change):
    """The same run with other sound powers."""
    spectra = change(tree["spectra"].to_dataset().copy(deep=True))
    return xarray.DataTree.from_dict({"/rolling": tree["rolling"].to_dataset(), "/spectra": spectra})


def loudness(tree):
    return 20.0 * np.log10(pass_by_pressure(tree).values.std())


def test_the_total_is_not_heard_twice_and_vibration_comes_before_transfers():
    """The total stands among the sources, and is their sum; of the second source nothing is known."""

    def with_total(spectra):
        spectra["sound_power_level"][0, 2, 0] = 100.0
        return spectra.assign_coords(source=["track", "wheel", "total"])

    def with_vibration(spectra):
        power = [[[80.0, np.nan], [np.nan, np.nan], [80.0, np.nan]]]
        coordinates = {"radiator": ["rail", "wheel", "total"], "band": [1000.0, 2000.0]}
        variables = {"radiated_power_level": (("law", "radiator", "band"), power)}
        return spectra.assign(variables).assign_coords(coordinates)

    tree = passing(speed=0.0)
    assert loudness(with_spectra(tree, with_total)) == pytest.approx(loudness(tree), abs=1e-6)
    assert loudness(with_spectra(tree, with_vibration)) == pytest.approx(loudness(tree) - 20.0, abs=0.02)


def test_it_is_loudest_in_the_middle_and_falls_with_the_distance():
    """At 50 m/s the source is 26.8 m along when the record ends: 20 lg(27.8/7.5) = 11.4 dB."""
    pressure = pass_by_pressure(passing(speed=50.0)).values[0]
    n = len(pressure)
    loud = [np.std(part) for part in (pressure[n // 2 - 400 : n // 2 + 400], pressure[:800], pressure[-800:])]
    assert 20.0 * np.log10(loud[0] / loud[1]) == pytest.approx(11.3, abs=0.2)
    assert loud[1] == pytest.approx(loud[2], rel=0.02)


def test_each_band_has_its_sound_power_and_nothing_lies_beside():
    force = np.random.default_rng(3).normal(size=40_000)
    centre, level = np.array([100.0, 1000.0]) * 10.0 ** np.array([0.0, 0.1]), np.array([90.0, -np.inf])
    source = radiated(force, STEP, centre, level)
    power = 2.0 * np.abs(rfft(source)) ** 2 / len(source) ** 2
    lines = rfftfreq(len(source), STEP)
    inside = (lines > 100.0 / 10**0.05) & (lines < 100.0 * 10**0.05)
    assert 10.0 * np.log10(power[inside].sum() / 1e-12) == pytest.approx(90.0, abs=0.3)
    assert power[~inside].sum() < 1e-20
