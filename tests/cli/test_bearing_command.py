"""``asperity bearing``: what it prints of a bearing and its signal, and refuses; and a bearing that runs."""

import csv
import importlib
import json
import math
import re
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat, wavfile

import asperity
from asperity.case.ball_bearing import BearingUnderLoad
from asperity.case.cases import as_case
from asperity.case.loaded_bearing import read_bearing
from asperity.studies import running
from asperity.wave_files import wave_bytes
from command_line import call, words_of
from faulty_signals import faulty_signal
from memory_of_files import single_digits, times_of_file
from small_cases import BEARING

RATE = 12_000
HERE = ThreadPoolExecutor(1)
TIME = np.arange(2 * RATE) / RATE
OWN = """
balls = 9
ball_diameter = "7.94 mm"
pitch_diameter = "39.04 mm"
clearance = "0 um"
radial = "1 kN"
speed = "3000 1/min"
"""


@pytest.fixture(autouse=True)
def drawn(monkeypatch):
    """Charts and titles of pictures, which are not drawn here."""
    found = []
    for name in ("bearing", "heard"):
        module = importlib.import_module(f"asperity.cli.{name}")
        monkeypatch.setattr(module, "write_chart", lambda chart, title, path: found.append((chart, title)))
    return found


def pulses(tone, seed=0):
    """Blows that ring at 3 kHz, in noise."""
    struck = np.zeros(TIME.size)
    struck[(np.arange(int(2 * tone)) / tone * RATE).astype(int)] = 1.0
    rung = np.convolve(struck, np.exp(-900 * TIME[:150]) * np.sin(2 * np.pi * 3000 * TIME[:150]))
    return rung[: TIME.size] + 0.02 * np.random.default_rng(seed).normal(size=TIME.size)


def shaft(speed):
    """Lines of a shaft that turns."""
    return sum(0.05 * np.sin(2 * np.pi * n * speed * TIME) for n in (1, 2, 3, 4))


def last_line(said):
    """What is said last."""
    return said.strip().splitlines()[-1]


def heard(signal, *words):
    np.save("run.npy", signal)
    given = ("--speed", "1800 1/min", "--signal", "run.npy", "--rate", "12 kHz")
    return call("bearing", "6205", *given, *words).stdout


def test_loads_tones_and_waviness(drawn):
    said = call("bearing", "6205", "--radial", "100 N", "--speed", "1797 1/min", "-o", "a.png").stdout
    for told in (
        r"9 balls of 7.94 mm, pitch diameter 39.04 mm, grooves of 0.52 D \(inner\)",
        r" 0° +inner ring +68.15 +0.0° +0.057 +0.536 +1.06 +0° +outer ring +68.38 .* −40° +inner ring +20.79",
        "no film of lubricant",
        r" 120° +inner ring +– +– +– +– +– ",
        r"2 to 3 of 9 balls touch the inner ring", r"outer ring +107.4 +3.5848 ",
        r"inner ring +162.2 +5.4152 .* ± 29.95 as it turns", r"inner ring +10 +– +192.1 ",
        r"ball +2 +141.2 +129.2, 153.1 "
    ):  # fmt: skip
        assert re.search(told, words_of(said)), told
    ((chart, title),) = drawn
    assert title == "6205, 100 N radial, 0 N axial"
    bars = [mark for mark in chart.panels[0].marks if getattr(mark, "width", 0.0) == 2.2]
    assert len(bars) == 9  # all balls lie on the outer ring as they turn
    assert max(bars, key=lambda bar: np.hypot(np.ptp(bar.x), np.ptp(bar.y))).y.max() < 0.0
    assert "68.4 N" in [
        mark.text.strip() for mark in chart.panels[0].marks if hasattr(mark, "text")
    ]  # its scale
    assert f"Picture: {Path('a.png').resolve()}" in said


@pytest.mark.parametrize("name", ["6205", "NU205"])
def test_tones_ask_for_no_load(name):
    """Z/2 (1 ∓ D/d cos α) of the turning ring, at the free contact angle; pictures are of loads."""
    words = ("bearing", name, "--speed", "1800 1/min")
    found = json.loads(call(*words, "--json").stdout)
    assert found["balls"] is None
    of = read_bearing(name, {}).bearing
    ratio = of.ball_diameter / of.pitch_diameter * math.cos(of.free_angle)
    assert found["tones"]["outer"] == pytest.approx(15.0 * of.balls * (1.0 - ratio))
    assert found["tones"]["inner"] == pytest.approx(15.0 * of.balls * (1.0 + ratio))
    said = " ".join(call(*words).stdout.split())
    assert "A load, as --radial '1 kN', gives loads, pressures and stiffness." in said
    assert ("at the free contact angle" in said) == (of.free_angle > 0.0)
    assert "per turn" in call("bearing", name).stdout
    assert "load: received none" in call(*words, "-o", "zone.svg", code=2).stderr


def test_a_bearing_of_ones_own_and_options_that_are_stronger():
    Path("own.toml").write_text(OWN)
    document = json.loads(call("bearing", "own.toml", "--axial", "200 N", "--json").stdout)
    load, angle, azimuth = (np.array(document["balls"][n]) for n in ("inner_load", "inner_angle", "azimuth"))
    touching = load > 0.0
    along = (load * np.cos(azimuth))[touching] @ np.cos(angle[touching].astype(float))
    assert along == pytest.approx(1000.0)
    assert document["tones"]["outer"] == pytest.approx(180.0, rel=0.01)
    louder = json.loads(call("bearing", "own.toml", "--radial", "2 kN", "--json").stdout)
    assert max(louder["balls"]["inner_load"]) > 1.5 * max(document["balls"]["inner_load"])
    assert ["fills" in each["message"] for each in louder["warnings"]] == [True, True]
    assert "per turn" in call("bearing", "6205", "--axial", "10 N").stdout


FOUR_POINT = """
balls = 12
ball_diameter = "11.112 mm"
pitch_diameter = "46 mm"
arch_angle = "35 deg"
clearance = "40 um"
"""


def test_of_four_point_contact_it_says_what_both_flanks_carry():
    """Of a radial load alike; Σ 2 Q cos α cos ψ = F, and a ball turns by 1/cos α faster."""
    Path("qj.toml").write_text(FOUR_POINT)
    given = "bearing", "qj.toml", "--radial", "2 kN", "--speed", "1800 1/min"
    said = words_of(call(*given).output)
    document = json.loads(call(*given, "--json").stdout)
    loads, angles = (
        np.array(document["balls"][f"inner_{name}"], dtype=float) for name in ("loads", "angles")
    )
    np.testing.assert_allclose(loads[:, 0], loads[:, 1], rtol=1e-6, atol=1e-6)
    inward = (loads * np.cos(np.nan_to_num(angles))).sum(axis=1)
    assert inward @ np.cos(document["balls"]["azimuth"]) == pytest.approx(2000.0, rel=1e-6)
    assert "gothic arches of 35°, clearance 40 µm, free contact angle 39.3°" in said
    load = f"{loads.max():.4g}"
    assert f"Flanks of the ball that carries most: {load} and {load} N on the inner ring, " in said
    spin = "Balls on all four flanks spin by 0.157 and 0.105 rad per mm of way on the inner and outer ring"
    tone = document["tones"]["ball"] / math.cos(math.radians(35.0))
    assert f"{spin}, and turn about the axis of the bearing: their tone is {tone:.4g} Hz, not" in said
    assert "Waviness that is heard" not in said
    call(*given, "--sheet", "qj.html")
    page = " ".join(Path("qj.html").read_text(encoding="utf-8").split())
    assert "flanks of the gothic arches" in page
    assert "The tone of a ball on four flanks is 1.221 times that of one on two" in page


def test_of_a_case_whose_speed_changes_it_says_that_it_takes_the_fastest():
    case = {"kind": "ball-bearing", "speed": "600..1800 1/min in 1 s", "radial": "100 N"}
    Path("run_up.toml").write_text(as_case(case | {"bearing": {"name": "6205"}}).to_toml())
    told = words_of(call("bearing", "run_up.toml").output)
    assert "The speed of run_up.toml changes, 600 to 1800 1/min: what follows is that at the fastest," in told
    assert "Hz at 1800 1/min" in told
    typed = words_of(call("bearing", "run_up.toml", "--speed", "900 1/min").output)
    assert "changes" not in typed
    assert "Hz at 900 1/min" in typed


def test_a_fault_is_heard_and_drawn_with_the_kurtogram_that_its_band_is_from(drawn):
    said = words_of(heard(pulses(108.0) + shaft(29.95), "-o", "b.png"))
    assert said.endswith(" % sure.")
    assert "There are lines of the outer ring at 108.0 Hz, resolved to 0.5 Hz: " in said
    speed = float(re.search(r"([\d.]+) 1/min by lines of the shaft", said)[1])
    assert speed == pytest.approx(1797.0, abs=3.0)
    assert re.search(r"outer ring +107.\d\d .*? 108.\d+ +3.6\d+ +\+0.\d+ % +1 2 3 4 5 ", said)
    ((chart, title),) = drawn
    assert title.startswith("run.npy\nThere are lines of the outer ring")
    assert title.endswith("\u00a0%\u00a0sure.")  # on one line
    envelope, kurtogram = chart.panels
    np.testing.assert_allclose(envelope.marks[-1].x, 108.0 * np.arange(1, 6), atol=1.0)
    field, edges = kurtogram.marks
    low, high = edges.at
    column, _ = np.unravel_index(np.nanargmax(field.values), field.values.shape)
    assert low <= (column + 0.5) / field.values.shape[0] * 6.0 <= high


@pytest.mark.parametrize(("share", "faults"), [(0.05, ["outer"]), (0.6, ["outer", "ball"])])
def test_of_two_faults_a_faint_one_is_left_to_what_modulates_the_clear_one(share, faults):
    both = pulses(108.0) + share * pulses(142.0)
    document = json.loads(heard(both, "--json", "--band", "1 kHz, 5 kHz"))
    assert document["lines"]["ball"]["found"]
    assert document["faults"] == faults


def test_noise_is_no_fault_and_lines_of_the_turns_give_the_speed():
    sound = "No lines of rings or balls stand out: no sign of a fault"
    assert sound in last_line(heard(pulses(1e-9), "--band", "all"))
    said = heard(pulses(1e-9) + shaft(29.8), "--band", "all")
    assert last_line(said).startswith(f"{sound}, ")
    speed = float(re.search(r"([\d.]+) 1/min by lines of the shaft", said)[1])
    assert speed == pytest.approx(60 * 29.8, abs=2.0)


@pytest.mark.parametrize(
    ("told", "begin", "part"),
    [
        ("1800 1/min", "There are lines of the inner ring at 162.", ["inner"]),
        (
            "3600 1/min",
            r"The line of the shaft is not at 60 Hz \(3600 1/min\), as told, but at (29.9|30)",
            [],
        ),
        (
            "1980 1/min",
            r"The line of the shaft is not at 33 Hz \(1980 1/min\), as told, but at (29.9|30)",
            [],
        ),
    ],
)
def test_a_wrong_speed_is_said_first_and_no_fault_is_listed_at_it(told, begin, part):
    signal = faulty_signal("inner", 30.0, RATE, 2.0, noise=0.1)
    np.save("run.npy", signal)
    words = ("bearing", "6205", "--speed", told, "--signal", "run.npy", "--rate", "12 kHz")
    document = json.loads(call(*words, "--json").stdout)
    assert re.match(begin, document["verdict"]), document["verdict"]
    assert document["faults"] == part
    assert document["speed"] == pytest.approx(30.0, rel=0.01)
    assert last_line(call(*words).stdout) == document["verdict"]
    assert f"{100 * document['confidence']:.0f} % sure" in document["verdict"]


def test_a_wrong_rate_is_said_as_a_wrong_speed_is():
    np.save("run.npy", faulty_signal("outer", 30.0, RATE, 2.0, noise=0.1))
    words = ("bearing", "6205", "--speed", "30 Hz", "--signal", "run.npy", "--rate", "48 kHz")
    said = last_line(call(*words).stdout)
    told = re.match(
        r"The line of the shaft is not at 30 Hz \(1800 1/min\), as told, but at ([\d.]+) Hz ", said
    )
    assert "there are lines of the outer ring" in said
    assert float(told[1]) == pytest.approx(120.0, rel=0.005)


def test_of_a_fault_that_is_known_to_be_there_a_record_without_its_sign_says_so():
    signal = shaft(30.0) + 0.5 * np.random.default_rng(1).normal(size=TIME.size)
    said = last_line(heard(signal, "--known", "ball"))
    assert said.endswith("Of the fault of the ball that is known to be there, the record holds no sign.")
    assert "known" not in last_line(heard(signal + 3.0 * pulses(108.0), "--known", "outer"))


def test_a_record_of_a_tenth_of_a_second_says_what_is_too_short_and_judges_the_rings():
    signal = faulty_signal("outer", 30.0, 25_600.0, 0.1, noise=0.1, jitter=0.0)
    np.save("run.npy", signal)
    words = ("bearing", "6205", "--speed", "1800 1/min", "--signal", "run.npy", "--rate", "25.6 kHz")
    assert re.match(
        r"The record of 0.1 s, 3 turns, is too short for the line of the shaft at 30 Hz \(1800 1/min\), "
        r"which takes 0.2 s: the speed is not confirmed. If it is right, there are lines of the outer ring "
        r"at 1\d\d Hz, resolved to 10 Hz, or of another bearing: \d+ % sure.",
        last_line(call(*words).stdout),
    )
    np.save("run.npy", signal[:256])
    said = call(*words, code=2).stderr
    assert (
        "duration of the signal: received 0.01 s; allowed: at least 0.0369 s, to resolve the lines of the "
        "inner ring" in said
    )


SEVERAL = ("bearing", "6205", "--speed", "1800 1/min", "--rate", "12 kHz", "--signal", "a.npy", "b.npy")


def test_several_files_of_one_measurement_are_judged_one_by_one_and_together():
    files = [f"{name}.npy" for name in "abcdefgh"]
    for seed, name in enumerate(files):
        np.save(name, faulty_signal("outer", 30.0, RATE, 0.2, noise=0.5, slip=0.002, seed=seed))
    np.save("i.npy", np.zeros(5))
    said = call(*SEVERAL, *files[2:], "i.npy").stdout
    told = [line for line in said.splitlines() if re.match(r"[a-i].npy", line)]
    assert [line[:5] for line in told] == ["i.npy", *files]
    assert told[0].startswith("i.npy is left out. signal: received 5 samples; allowed: at least 64.")
    silent = sum("no sign of a fault" in line for line in told)
    assert silent >= 6
    assert "All 8 together: 19200 samples, 1.6 s at 12000 Hz, read in 8 pieces of 0.2 s; " in said
    assert f"Of 8 signals, {silent} name no part" in said
    assert "lines of the outer ring at 10" in last_line(said)
    document = json.loads(call(*SEVERAL, *files[2:], "--json").stdout)
    assert (document["faults"], document["turns"]) == (["outer"], pytest.approx(6.0))
    assert [each["signal"] for each in document["signals"]] == files
    assert [each["faults"] for each in document["signals"]].count([]) == silent
    assert last_line(said) == document["verdict"]
    by_option = [word for name in files[1:] for word in ("--signal", name)]
    assert last_line(call(*SEVERAL[:-1], *by_option).stdout) == document["verdict"]


def test_files_of_unlike_speeds_rates_or_none_are_told():
    for name, speed in (("a", 29.4), ("b", 30.5)):
        np.save(f"{name}.npy", faulty_signal("outer", speed, RATE, 2.0, noise=0.1))
    said = words_of(call(*SEVERAL).stdout)
    assert (
        "Of 2 signals, 2 name the outer ring. Their shafts turn at 29.4 to 30.5 Hz: lines of unlike" in said
    )
    wavfile.write("c.wav", 16_000, np.round(30_000 * np.sin(TIME)).astype("<i2"))
    wavfile.write("d.wav", 8_000, np.round(30_000 * np.sin(TIME)).astype("<i2"))
    refused = call(*SEVERAL[:4], "--signal", "c.wav", "d.wav", code=2).stderr
    assert "sampling rates of the signals: received 16000 Hz and 8000 Hz; allowed: one for all" in refused
    assert "--signal: received 1 twice; allowed: each file once" in call(*SEVERAL, "a.npy", code=2).stderr
    refused = call("bearing", "6205", "a.npy", code=2).stderr
    assert "bearing: received 6205 and a.npy; allowed: one. Files of signals follow --signal." in refused
    for name in "ab":
        np.save(f"{name}.npy", np.ones(500))
    assert "the same number throughout" in call(*SEVERAL, code=2).stderr


def test_what_is_wrong_with_a_recording_is_told_last_and_to_programs():
    signal = np.clip(faulty_signal("outer", 30.0, RATE, 2.0, noise=0.1), -0.5, 0.5)
    signal[5_000:5_100] = np.nan
    said = last_line(heard(10.0 + signal))
    assert re.search(
        r"outer ring at 10\d\.\d Hz, resolved to 0\.63 Hz: \d+ % sure\. Samples are missing or left out, "
        r"first at 0\.417 s: read in 2 stretches without a gap \(0\.417, 1\.57 s\)\. The signal is clipped "
        r"at 9\.5 and 10\.5, where [\d.]+ % of its samples lie: blows are higher\. Its mean of 10, ",
        said,
    )
    document = json.loads(heard(10.0 + signal, "--json"))
    assert len(document["doubts"]) == 3
    assert document["doubts"] == document["signals"][0]["doubts"]


def test_progress_is_shown_where_there_is_much_to_do_unless_it_shall_be_quiet(monkeypatch):
    np.save("run.npy", pulses(108.0))
    words = ("bearing", "6205", "--speed", "30 Hz", "--rate", "12 kHz", "--signal", "run.npy")
    assert call(*words).stderr == "reading signals …\n"
    monkeypatch.setattr("asperity.cli.heard.MANY", TIME.size)
    assert "envelope of the whitened signal …" in call(*words).stderr
    assert call(*words, "--quiet").stderr == ""


@pytest.mark.parametrize("kind", ["npz", "txt", "wav"])
def test_signals_come_in_files_of_several_kinds(kind):
    signal, words = pulses(108.0), {"npz": ["--array", "a"], "txt": ["--column", "2"]}.get(kind, [])
    np.savez("run.npz", a=signal, b=np.zeros(4))
    np.savetxt("run.txt", np.stack([TIME, signal], axis=1), header="time acceleration", comments="")
    wavfile.write("run.wav", RATE, (signal / np.abs(signal).max() * 32000).astype("<i2"))
    words += ["--rate", "12 kHz"] if words else []
    told = call("bearing", "6205", "--speed", "1800 1/min", "--signal", f"run.{kind}", *words).stdout
    assert "there are lines of the outer ring at 10" in told
    assert "2 s at 12000 Hz" in told


def test_a_bearing_is_checked_run_reported_drawn_and_heard():
    case = BEARING | {"duration": "50 ms", "fault": BEARING["fault"] | {"on": "inner"}}
    Path("bearing.toml").write_text(as_case(case).to_toml())
    plan = json.loads(call("check", "bearing.toml", "--json").stdout)
    told = {row["name"]: row["value"] for row in plan["plan"]}
    assert told["tones"].startswith("outer raceway 107.5 Hz, inner raceway 162.5 Hz")
    assert plan["work"]["steps"] == pytest.approx(60e-3 * 8 * 51_200, rel=1e-3)
    (law,) = json.loads(call("run", "bearing.toml", "-o", "out", "--json", "--quiet").stdout)["laws"]
    assert (law["law"], len(law["band_velocity"])) == ("hertz", 3)
    page = Path("out/report.html").read_text().replace("\u00a0", " ")
    assert f"Radial velocity by hertz: {1e6 * law['band_velocity'][0]:.3g} µm/s in 50 to 300 Hz" in page
    assert "Diamond: the fault of the inner raceway, where the record begins." in page
    call("report", "out", "--summary")
    call("figures", "out", "--format", "png", "load_zone", "envelope_spectrum")
    call("listen", "out")
    assert [path.name for path in Path("out/sounds").glob("*.wav")] == ["ring_acceleration-hertz-0_rad.wav"]
    tree = asperity.open_result("out")
    tree["bearing"]["band_velocity"] = 2.0 * tree["bearing/band_velocity"]
    tree.attrs["seed"] = 2
    asperity.save(tree, "twice/run.nc")
    call("compare", "out", "twice", "-o", "beside")
    page = Path("beside/comparison.html").read_text().replace("\u00a0", " ")
    told = 1e6 * law["band_velocity"][0]
    assert "twice against out, hertz: radial velocity +6.0 dB in 50 to 300 Hz" in page
    assert f"({told:.3g} to {2.0 * told:.3g} µm/s)" in page
    assert page.index('id="judged_bands"') < page.index('id="force_level"')
    assert "Velocities in the bands of ISO 15242-2" in page
    assert page.count("+6.0") >= 3
    rows = [row for row in Path("beside/comparison.csv").read_text().splitlines() if "band_velocity" in row]
    assert rows[0].startswith("velocity,band_velocity,hertz,50 to 300 Hz,m/s,")
    assert float(rows[0].split(",")[-1]) == pytest.approx(20.0 * np.log10(2.0))


SMALL = {
    "kind": "ball-bearing", "axial": "60 N", "speed": "18000 1/min", "duration": "20 ms", "settling": "5 ms",
    "laws": ["linear"], "centrifugal": False,
    "bearing": {
        "balls": 3, "ball_diameter": "7.94 mm", "pitch_diameter": "39.04 mm", "contact_angle": "20 deg"
    },
    "inner_raceway": {"waves": [4], "amplitudes": ["20 nm"]},
}  # fmt: skip


def test_a_creep_curve_of_a_bearing_is_refused_with_the_kinds_that_have_one():
    Path("bearing.toml").write_text(as_case(SMALL).to_toml())
    told = words_of(call("creep", "bearing.toml", code=2).stderr)
    assert "creep: received a ball-bearing case, for which it is not available; allowed: a kind" in told
    assert "wheel-on-rail" in told


@pytest.mark.usefixtures("members_in_this_process")
def test_a_study_by_command_says_what_helps_a_bearing(monkeypatch):
    """By a linear law twice the waves are 6 dB more, half of them 6 dB less: the quietest stands first."""
    changes = {
        f"{word} as wavy": {"inner_raceway": {"amplitudes": [size]}}
        for word, size in {"twice": "40 nm", "half": "10 nm"}.items()
    }
    monkeypatch.setattr(BearingUnderLoad, "helping_changes", changes)
    monkeypatch.setattr("asperity.studies.effects.SEEDS", 1)
    Path("bearing.toml").write_text(as_case(SMALL).to_toml())
    call("study", "bearing.toml", "--what-helps", "-o", "helps", "--quiet")
    with Path("helps/effects.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["judged"] == "300 to 1800 Hz"]
    assert [row["variant"] for row in rows] == ["half as wavy", "twice as wavy"]
    effect = [float(row["effect [dB]"]) for row in rows]
    assert effect == pytest.approx([-6.02, 6.02], abs=0.01)
    page = Path("helps/study.html").read_text()
    assert "half as wavy" in page
    assert "radial velocity" in page


def test_a_bearing_is_made_finer_and_asked_what_helps_by_command(monkeypatch):
    """By a linear law half the waves are 6 dB less; the members are rolled in this process."""
    half = {"half as wavy": {"inner_raceway": {"amplitudes": ["10 nm"]}}}
    monkeypatch.setattr(BearingUnderLoad, "helping_changes", half)
    monkeypatch.setattr("asperity.studies.effects.SEEDS", 1)
    study = running.study
    monkeypatch.setattr(running, "study", lambda plan, progress=None: study(plan, executor=HERE))
    Path("bearing.toml").write_text(as_case(SMALL).to_toml())
    said = call("run", "bearing.toml", "--what-helps", "--converge", "-o", "out", "--json", "--quiet").stdout
    told = json.loads(said)["what_helps"]
    tree = asperity.open_result("out")
    effect = tree["effects"].to_dataset()["effect"].sel(variant="half as wavy")
    assert float(effect.sel(judged="300 to 1800 Hz")) == pytest.approx(20.0 * np.log10(0.5), abs=0.01)
    (change,) = told["changes"]
    assert change["change"] == "half as wavy"
    assert change["effect"]["300 to 1800 Hz"] == pytest.approx(float(effect.sel(judged="300 to 1800 Hz")))
    assert change["error"]["300 to 1800 Hz"] is None
    assert told["level"].keys() == change["effect"].keys()
    assert {"time step", "run-in"} <= set(tree["convergence"].to_dataset()["setting"].values.tolist())
    page = Path("out/report.html").read_text()
    assert "What helps?" in page
    assert "half as wavy" in page


def waves(file, samples):
    wavfile.write(file, RATE, samples)


def waves_with_a_unit(file, samples):
    file.write_bytes(wave_bytes(samples / 3_276.7, RATE, 10.0, "m/s2"))


@pytest.mark.usefixtures("opened_apart")
@pytest.mark.parametrize(
    ("name", "write", "most"),
    [
        ("digits.txt", single_digits, 1.6),  # the text as bytes and as letters, before there is a number
        ("a.npy", np.save, 0.6),
        ("a.npz", lambda file, samples: np.savez(file, signal=samples), 0.6),
        ("a.mat", lambda file, samples: savemat(file, {"signal": samples}), 0.6),
        ("a.wav", waves, 1.6),  # as shares of full scale
        ("a.wav", waves_with_a_unit, 1.6),  # as numbers of four bytes, in the unit
    ],
)
def test_a_signal_of_few_bytes_a_sample_takes_few_times_its_file(name, write, most, monkeypatch):
    """What the larger of two files takes more than the other."""
    monkeypatch.setattr("asperity.ranks.TOGETHER", 2**12)
    monkeypatch.setattr("asperity.diagnostics.decision.ENOUGH", 3.0)
    for module in ("decision", "recording"):
        monkeypatch.setattr(f"asperity.diagnostics.{module}.MOST_SAMPLES", 2**12)
    rate = () if name.endswith("wav") else ("--rate", "12 kHz")
    asked = ("bearing", "6205", "--speed", "1797 1/min", "--signal", name, *rate)
    assert times_of_file(Path(name), write, lambda: call(*asked)) < most
