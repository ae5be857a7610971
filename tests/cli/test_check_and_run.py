"""Checking and running a case: what is said, what is written, and when nothing has to be computed."""

import html
import importlib
import json
import os
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from asperity.case.cases import parse_case, read_case
from asperity.cli.running import earlier_result, name_of_run
from asperity.results import read_result
from asperity.running import prepare_case
from asperity.scenarios.preparing import expect
from asperity.scenarios.run_time import RunTime
from asperity.scenes.planning import plan
from asperity.store import Store
from command_line import CASE, RAIL, SMALL, call, words_of

MAP = CASE.replace('rms = "0.5 um"', 'file = "map.npy"\nheight_unit = "um"\npixel = "8 um"')
LINE = CASE.replace('rms = "0.5 um"', 'line = "line.npz"\nline_array = "b"\nline_unit = "nm"')
LINE = f'laws = ["hertz"]\n{LINE}line_spacing = "8 um"\n[contact]\nspacing = "8 um"\n'


# --- run


def test_a_run_writes_results_and_report(ran):
    tree = read_result(ran.folder)
    assert parse_case(tree.attrs["case"]) == parse_case(SMALL)
    np.testing.assert_allclose(tree["rolling/contact_force"].mean("time"), 5.04, rtol=0.3)
    page = html.unescape((ran.folder / "report.html").read_text(encoding="utf-8"))
    assert words_of(tree.attrs["verdict"]) in words_of(page)  # units keep to their numbers there
    assert tree.attrs["verdict"] in ran.stdout
    assert f"Report:  {(ran.folder / 'report.html').resolve()}" in ran.stdout
    assert "rolling …" in ran.stderr
    (warning,) = [w for w in json.loads(tree.attrs["warnings"]) if "after rest" in w["message"]]
    assert f"{warning['grade'].capitalize()}: {warning['message']}" in ran.stderr
    assert not any(line.startswith("Kept") for line in ran.stderr)


def test_a_run_again_replaces_its_own_and_leaves_no_report_of_another(out):
    """Neither its page nor the CSVs of another kind of case; files of other names stay. More is told."""
    Store().put("scan-1", {"block": np.zeros(100_000)})
    (out / "measured.csv").write_text("x")
    (out / "receptance.csv").write_text("x")
    before = (out / "run.nc").stat().st_mtime_ns
    said = call("run", "small.toml", "-o", "out", "--no-report", "--again", "-v").stderr
    assert (out / "run.nc").stat().st_mtime_ns > before
    assert sorted(path.name for path in out.iterdir() if path.is_file()) == ["measured.csv", "run.nc"]
    assert re.search(r"^rolling: (\d+) of \1 in \d+ s", said, re.M)
    assert re.search(r"^Time:    \d+ s", said, re.M)
    kept = rf"Kept:    [\d.]+ MiB of finished work in {Store().root} \(asperity cache --clear deletes it\)"
    assert re.search(kept, said)


def test_a_finished_run_says_so_and_computes_nothing(out, monkeypatch):
    """It says where all lies, and the same to a program; the file of the case may have been moved."""
    monkeypatch.setattr(importlib.import_module("asperity.running"), "run", None)
    Path("small.toml").rename("moved.toml")
    told = call("run", "moved.toml", "-o", "out")
    assert "Nothing to do: this case has been run, with the same files and program" in told.stderr
    assert read_result("out").attrs["verdict"] in told.stdout
    assert str((out / "report.html").resolve()) in told.stdout
    assert json.loads(call("run", "moved.toml", "-o", "out", "--json").stdout)["computed"] is False
    call("run", "moved.toml", "-o", "out", "--again", code=3)


INCOMPLETE = {
    "no page": lambda out: (out / "report.html").unlink(),
    "the page of a run before": lambda out: os.utime(out / "report.html", ns=(0, 0)),
    "damaged": lambda out: (out / "run.nc").write_bytes((out / "run.nc").read_bytes()[:-1]),
}


@pytest.mark.parametrize("what", INCOMPLETE)
def test_a_run_that_is_not_whole_is_none(out, what):
    case = read_case("small.toml")
    assert earlier_result(case, out, report=True, more=()) is not None
    INCOMPLETE[what](out)
    assert earlier_result(case, out, report=True, more=()) is None


def test_a_run_of_another_program_or_without_convergence_is_computed(out, monkeypatch):
    case = read_case("small.toml")
    assert earlier_result(case, out, report=False, more=["convergence"]) is None
    others = ("asperity.__version__", "9"), ("asperity.cli.running.program", lambda: "other sources")
    for name, value in others:
        with monkeypatch.context() as patch:
            patch.setattr(name, value)
            assert earlier_result(case, out, report=False, more=()) is None
    monkeypatch.setenv("ASPERITY_DEVICE", "gpu")
    assert earlier_result(case, out, report=False, more=()) is None


def test_a_run_is_another_where_a_file_that_it_names_holds_something_else():
    """However its name and its time stay the same; a file that is gone gives the run no name."""
    heights = np.arange(4000.0)
    np.savez("line.npz", b=heights)
    Path("case.toml").write_text(LINE)
    case, status = read_case("case.toml"), Path("line.npz").stat()
    name = name_of_run(case)
    np.savez("line.npz", b=heights + np.eye(1, 4000, 77)[0])
    os.utime("line.npz", ns=(status.st_atime_ns, status.st_mtime_ns))
    assert name_of_run(case) != name
    np.savez("line.npz", b=heights)
    assert name_of_run(read_case("case.toml")) == name
    Path("line.npz").unlink()
    assert name_of_run(case) == ""


def test_another_case_is_never_overwritten_unasked(out):
    Path("other.toml").write_text(SMALL + 'level = "+3 dB"\n')
    refused = call("run", "other.toml", "-o", "out", code=2).stderr
    assert "out: received the run of another case" in refused
    assert "--overwrite" in refused
    assert parse_case(read_result("out").attrs["case"]) == parse_case(SMALL)
    call("run", "other.toml", "-o", "out", "--overwrite", "--no-report")
    assert "+3 dB" in read_result("out").attrs["case"]


def test_a_line_is_read_with_its_hints_into_a_folder_of_its_own():
    np.savez("line.npz", a=np.zeros(9), b=np.random.default_rng(0).normal(size=4000))
    Path("line.toml").write_text(LINE)
    call("run", "line.toml", "--no-report")
    assert [path.name for path in Path("runs/line").iterdir()] == ["run.nc"]
    assert float(read_result("runs/line")["surface/line"].std()) == pytest.approx(1e-9, rel=0.1)


def test_the_demonstration_says_where_its_report_lies():
    said = call("demo")
    assert "warning" not in said.stderr.lower()
    assert "out of range" not in said.output.lower()
    assert "not built up" not in said.stdout
    page = Path("asperity-demo/report.html").resolve()
    assert str(page) in said.stdout
    assert page.stat().st_size > 100_000
    assert "areal" in read_result("asperity-demo")["rolling/law"]


# --- check


def test_a_check_shows_values_and_work():
    shown = words_of(call("check", "case.toml", "--keys").stdout)
    for text in (
        "case.toml: a valid case, 2 doubts:",
        "ball.radius 25 mm",
        "6001 points 10 µm apart",
        "0.01 s, and 0.05 s before it, 6000 steps of 10 µs",
        "less what the cache holds",
    ):
        assert text in shown


def test_a_check_begins_with_what_is_doubted_and_decided_and_ends_with_the_keys_that_are_set():
    said = call("check", "case.toml")
    shown = words_of(said.stdout)
    order = ["case.toml: a valid case", "laws", "work", "textures", "Keys that are not at their defaults"]
    assert [shown.index(words) for words in order] == sorted(shown.index(words) for words in order)
    assert "ball.radius" not in shown
    assert re.search(r"\d+ keys are at their defaults \(--keys shows them\)", said.stderr)
    assert "surface.rms" in shown.partition("Keys that are not at their defaults")[2]


def test_a_check_shows_the_track_the_run_in_and_what_loss_factors_do_to_the_force():
    Path("rail.toml").write_text(RAIL)
    shown = words_of(call("check", "rail.toml", "--keys").stdout)
    for text in (
        "wheel.load",
        "16.8 m from -5.6 m",
        "0.2 s, and 0.1 s before it",
        "pinned–pinned 1420 Hz, sleeper passing 93.33 Hz, critical speed 441.1 m/s",
        "5.4 m, 5.7 m",
        "error of the contact force, dB: ",
    ):
        assert text in shown
    lossy = f'{RAIL}[track]\nname = "nordborg-loss-factor"\nballast_loss_factor = 2.0\n'
    Path("lossy.toml").write_text(lossy)
    outcome = call("check", "lossy.toml")
    for text in ("40 Hz +0.4", "630 Hz −1.0", "else below 0.05"):
        assert text in words_of(outcome.stdout)
    assert "lossy.toml: a valid case, 2 doubts:" in words_of(outcome.stdout)
    assert "Nothing that answers after a force only has one loss factor at all" in outcome.stderr
    Path("viscous.toml").write_text(f'{RAIL}[track]\nname = "nordborg"\nrail_loss_factor = 0.0\n')
    assert "loss factors" not in call("check", "viscous.toml").stdout


def test_a_second_check_says_the_same_and_computes_nothing_until_a_file_changes(monkeypatch):
    heights = np.random.default_rng(0).normal(size=(64, 64))
    np.save("map.npy", heights)
    Path("measured.toml").write_text(MAP)
    first = call("check", "measured.toml")
    monkeypatch.setattr("asperity.running.prepare_case", None)
    assert call("check", "measured.toml").stdout == first.stdout
    np.save("map.npy", 2.0 * heights)
    assert "NoneType" in call("check", "measured.toml", code=3).stderr


@pytest.mark.parametrize("poles", ["", "poles = 1000\n"])
def test_fewer_poles_are_taken_where_the_track_remembers_few_steps(poles):
    """A tenth of 0.12 s in steps of 1/(8 f_max)."""
    Path("coarse.toml").write_text(f'{RAIL}[numerics]\nhighest_frequency = "300 Hz"\n{poles}')
    call("check", "coarse.toml")


def test_the_plan_counts_contact_solutions():
    contact = '[contact]\nspacing = "8 um"\nwindow = "0.5 mm"\n'
    contact += 'approaches = ["0 um", "1 um"]\nsamples = 2\nsample_length = "1.5 mm"\n'

    def rows_of(text):
        prepared = prepare_case(parse_case(text))
        taken = RunTime({"all": 44.4})
        return dict(plan(prepared, replace(expect(prepared, lambda *_: None), time=taken, compiling=0.0)))

    rows = rows_of('laws = ["table", "direct"]\n' + CASE + contact)
    window, strip = 63, 188  # rows of 8 µm
    path = 7501 + 2 * window
    every_other = range(window % 2, path - window + 1, 2)  # counted from where the record starts
    # no law filters a line: of two states the higher one has a filter, to be shown
    assert rows["contact solutions, scan for the filters"] == f"at most {2 * (strip - window + 1)}"
    assert rows["contact solutions, scan for the path"] == f"at most {2 * len(every_other)}"
    assert rows["contact solutions, direct"] == f"at most {7500}"
    assert rows["work"] == "about 44 s of processor time, less what the cache holds; most of it all"
    smooth = CASE.replace('rms = "0.5 um"', 'spectrum = "iso3095"')
    assert not any(name.startswith("contact solutions") for name in rows_of(smooth))


# --- long paths and full disks

LONG = """
kind = "ball-on-beam"
laws = ["table"]
surface = { rms = "0.05 um", longest = "0.2 mm", shortest = "0.1 mm" }
beam.length = "4 m"
[contact]
spacing = "10 um"
window = "0.5 mm"
approaches = ["-0.1 um", "0 um", "0.1 um", "0.2 um", "0.3 um", "0.4 um", "0.6 um", "0.8 um", "1 um"]
"""


def test_a_long_path_is_planned_announced_and_refused_where_no_disk_holds_it(monkeypatch):
    """200 000 positions × 9 approaches of 8 bytes are 13.7 MiB, beside what each block of a state holds."""
    Path("long.toml").write_text(LONG)
    shown = words_of(call("check", "long.toml").stdout)
    planned = re.search(r"scan of the path (\d+) positions × 9 approaches, about (\d+) solutions", shown)
    assert planned
    assert 200_000 <= int(planned[1]) <= 200_100
    assert int(planned[2]) == 9 * int(planned[1])
    assert 13.7 < float(re.search(r"([\d.]+) MiB in", shown)[1]) < 22
    monkeypatch.setattr(importlib.import_module("asperity.running"), "run", None)
    said = call("run", "long.toml", "-o", "out", code=3).stderr
    assert f"Scan of the path: {planned[1]} positions" in said
    assert "if interrupted or killed, it goes on after its last finished block" in said
    monkeypatch.setattr("asperity.scenarios.preparing.free_space", lambda path: 2**20)
    monkeypatch.setattr("asperity.scenarios.preparing.MOST_HELD", 2**23)  # it is not held in memory
    message = call("run", "long.toml", "-o", "out", code=2).stderr
    assert "disk of the cache: received 1 MiB free" in message
    assert "ASPERITY_CACHE" in message


@pytest.mark.parametrize("command", ["run", "check"])
def test_results_that_the_disk_cannot_hold_are_refused_before_work(monkeypatch, command):
    monkeypatch.setattr("asperity.files.free_space", lambda path: 2**10)
    message = call(command, "case.toml", "-o", "out", code=3).stderr
    assert "the disk is full (" in message
    assert "are needed, 1 KiB are free)" in message
    assert not Path("out").exists()


LONG_RECORDS = {
    "wheel": (
        "kind = 'wheel-on-rail'\nspeed = '50 m/s'\nduration = '400 s'\nlaws = ['linear']\n"
        "[surface]\nspectrum = 'iso3095'\n[contact]\nspacing = '1 mm'\nwindow = '21 mm'\n"
        "[numerics]\ntime_step = '20 us'",
        "20 million time steps over 420 million points of a path. It takes 3 min of processor time or more, "
        "and its results up to 7.45 GiB of memory.",
    ),
    "bearing": (
        "kind = 'ball-bearing'\nspeed = '1800 1/min'\nradial = '100 N'\nlaws = ['hertz']\n"
        "duration = '20 s'\nsettling = '0.1 s'\nsampling_rate = '50 kHz'\ntime_step = '2 us'\n"
        "[bearing]\nname = '6205'",
        "10.1 million time steps. It takes 3 min of processor time or more, and its results up to 420 MiB",
    ),
}
"""20 015 000 steps, 20 015 m, 21 points across, 50 numbers a step; 20.1 s of 2 µs, 9 balls, 55 a sample."""


@pytest.mark.parametrize("name", LONG_RECORDS)
def test_what_a_long_record_takes_is_told_before_it_is_laid_out(name, monkeypatch):
    text, told = LONG_RECORDS[name]
    Path("long.toml").write_text(text)
    monkeypatch.setattr("asperity.files.free_space", lambda path: 2**40)
    monkeypatch.setattr("asperity.running.prepare_case", None)
    for command in ("check", "run"):
        assert f"A long case: {told}" in words_of(call(command, "long.toml", "-o", "out", code=3).stderr)
