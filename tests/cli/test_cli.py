"""The command line: what it prints, what it writes, and its exit codes."""

import csv
import html
import importlib
import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import asperity
from asperity.case.cases import load_case, parse_case
from asperity.cli import main
from asperity.cli.running import earlier_result, name_of_run
from asperity.results import read_result
from asperity.store import Store
from asperity.studies.definition import load_study

CASE = 'kind = "ball-on-beam"\nduration = "0.01 s"\n[surface]\nrms = "0.5 um"\n'
SMALL = """
kind = "ball-on-beam"
laws = ["hertz", "linear"]
start = "0.45 m"
duration = "20 ms"
settling = "0 s"
[surface]
spectrum = "iso3095"
"""
"""A case of a second: smooth bodies follow a line."""


@pytest.fixture(autouse=True)
def own_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("ASPERITY_CACHE", str(tmp_path / "cache"))
    Path("case.toml").write_text(CASE)
    return tmp_path


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """Folder of a small run with its report, and what was said."""
    folder = tmp_path_factory.mktemp("ran")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setenv("ASPERITY_CACHE", str(folder / "cache"))
        Path("small.toml").write_text(SMALL)
        return folder / "out", call("run", "small.toml", "-o", "out")


@pytest.fixture
def out(ran, own_folder):
    """The case ``small.toml``, and its run in the folder ``out``."""
    Path("small.toml").write_text(SMALL)
    shutil.copytree(ran[0], "out")
    return Path("out")


def nothing_was_computed():
    """Whether no run is there but those that were copied, and nothing was kept."""
    return not list(Path().glob("runs/*/run.nc")) and not list(Path().glob("cache/*"))


def failing_with(monkeypatch, error):
    """Put a fault into the computation that no input makes."""

    def run(case, progress=None):
        raise error

    monkeypatch.setattr(importlib.import_module("asperity.running"), "run", run)


def call(*arguments, code=0):
    outcome = CliRunner().invoke(main, list(arguments))
    assert outcome.exit_code == code, outcome.output
    return outcome


# --- run and demo


def test_what_to_cite_for_a_run_is_said(ran):
    folder, _ = ran
    told = call("cite", str(folder)).stdout.splitlines()
    assert told[0].startswith(f"asperity {asperity.__version__}: ")
    assert told[1:] == json.loads(read_result(folder).attrs["citations"])
    assert any("Lundberg" in line for line in told)


def test_a_run_is_written_as_sounds(ran):
    folder, _ = ran
    told = call("listen", str(folder / "run.nc"), "-o", "heard").stdout
    files = list(Path("heard").glob("*.wav"))
    assert f"{len(files)} files, all on one scale" in " ".join(told.split())
    refused = call("listen", str(folder), "--what", "drums", code=2).stderr
    assert "received 'drums'; allowed: acceleration" in refused


def test_figures_of_a_run_are_drawn_when_asked(ran):
    folder, _ = ran
    told = call("figures", str(folder / "run.nc"), "scene", "contact force levels", "--format", "pdf").stdout
    files = [folder / "figures" / f"{name}.pdf" for name in ("scene", "force_bands")]
    assert [file.read_bytes()[:4] for file in files] == [b"%PDF"] * 2
    assert "scene.pdf, force_bands.pdf" in " ".join(told.split())
    call("figures", str(folder), "-o", "all")
    numbers = {path.stem for path in folder.glob("*.csv")}
    assert {path.name for path in Path("all").iterdir()} == {f"{name}.svg" for name in numbers}


def test_a_report_is_written_again_from_its_run_and_as_a_summary(ran):
    folder, _ = ran
    again = call("report", str(folder / "run.nc"), "-o", "page").stdout
    assert str(Path("page/report.html").absolute()) in again
    assert Path("page/report.html").read_bytes() == (folder / "report.html").read_bytes()
    assert {path.name for path in Path("page").glob("*.csv")} == {path.name for path in folder.glob("*.csv")}
    call("report", str(folder), "--summary", "-o", "sheet")
    assert [path.name for path in Path("sheet").iterdir()] == ["summary.html"]
    assert "no such file" in call("report", "nothing", code=2).stderr
    Path("taken").write_text("a file")
    assert "folder of the report: received taken" in call("report", str(folder), "-o", "taken", code=2).stderr


def test_wrong_figures_and_folders_are_told_and_leave_nothing(ran):
    folder, _ = ran
    refused = call("figures", str(folder), "scene", "force_band", "-o", "new", code=2).stderr
    assert 'Nearest: "force_bands" (Contact force levels in one-third octaves)' in " ".join(refused.split())
    assert not Path("new").exists()
    Path("taken").write_text("a file")
    refused = call("figures", str(folder), "-o", "taken", code=2).stderr
    assert "folder of the figures: received taken" in refused
    assert "Choose another folder with -o." in refused


def test_a_run_and_its_report_need_no_matplotlib(own_folder):
    Path("small.toml").write_text(SMALL)
    script = (
        "import sys\nfrom asperity.cli import main\n"
        "try: main(['run', 'small.toml', '-o', 'out'])\nexcept SystemExit as end: assert not end.code\n"
        "print('matplotlib' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert Path("out/report.html").exists()
    assert done.stdout.splitlines()[-1] == "False"


def test_runs_are_compared(ran):
    """A page and a table, and what they say in short; with itself a run has no differences."""
    folder, _ = ran
    told = call("compare", str(folder), str(folder / "run.nc"), "-o", "both").stdout
    assert "The cases are the same. " in told
    assert "0.0 dB(A)" in told
    assert Path("both/comparison.html").stat().st_size > 50_000
    assert str(Path("both/comparison.csv").resolve()) in told
    call("compare", str(folder), str(folder), "--law", "linear", "-o", "page.html")
    assert Path("page.html").exists()
    assert Path("page.csv").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["{run}"],
            "runs to compare: received 1; allowed: two to 8 runs. Give a run.nc or its folder for",
        ),
        (["{run}", "absent"], "absent: received no such file; allowed: a result file that a run has written"),
        (
            ["{run}", "{run}", "--law", "areal"],
            "law: received 'areal'; allowed: a law of the runs: hertz, linear",
        ),
        (["{run}", "{run}", "-o", "case.toml"], "folder of the comparison: received case.toml"),
        ([], "Missing argument 'RUNS...'"),
    ],
)
def test_what_cannot_be_compared_is_explained(ran, arguments, message):
    words = [word.replace("{run}", str(ran[0])) for word in arguments]
    assert message in call("compare", *words, code=2).stderr


def test_run_writes_results_and_report(ran):
    folder, outcome = ran
    tree = read_result(folder)
    assert parse_case(tree.attrs["case"]) == parse_case(SMALL)
    np.testing.assert_allclose(tree["rolling/contact_force"].mean("time"), 5.04, rtol=0.3)
    page = html.unescape((folder / "report.html").read_text(encoding="utf-8"))
    assert " ".join(tree.attrs["verdict"].split()) in " ".join(
        page.split()
    )  # units keep to their numbers there
    assert tree.attrs["verdict"] in outcome.stdout
    assert str((folder / "report.html").resolve()) in outcome.stdout
    assert "rolling …" in outcome.stderr.splitlines()
    (warning,) = [w for w in json.loads(tree.attrs["warnings"]) if "after rest" in w["message"]]
    assert f"{warning['grade'].capitalize()}: {warning['message']}" in outcome.stderr.splitlines()


def test_run_says_what_is_kept_and_how_to_clear_it(ran, out):
    assert "Kept" not in ran[1].stderr
    Store().put("scan-1", {"block": np.zeros(100_000)})
    kept = call("run", "small.toml", "--no-report").stderr
    assert f"MiB of finished work in {Store().root}" in kept
    assert "asperity cache --clear" in kept


def test_a_run_without_report_has_a_folder_of_its_own():
    Path("small.toml").write_text(SMALL)
    call("run", "small.toml", "--no-report")
    assert [path.name for path in Path("runs/small").iterdir()] == ["run.nc"]


def test_the_same_case_replaces_its_own_run(out):
    before = (out / "run.nc").stat().st_mtime_ns
    call("run", "small.toml", "-o", "out", "--no-report", "--again")
    assert (out / "run.nc").stat().st_mtime_ns > before


def test_a_finished_run_says_so_and_computes_nothing(ran, out, monkeypatch):
    """It says where all lies, and the same to a program; the file of the case may have been moved."""
    failing_with(monkeypatch, ZeroDivisionError("computed"))
    Path("small.toml").rename("moved.toml")
    before = (out / "run.nc").stat().st_mtime_ns
    told = call("run", "moved.toml", "-o", "out")
    assert "Nothing to do: this case has been run, with the same files and program" in told.stderr
    assert read_result("out").attrs["verdict"] in told.stdout
    assert str((out / "report.html").resolve()) in told.stdout
    document = json.loads(call("run", "moved.toml", "-o", "out", "--json").stdout)
    assert document["computed"] is False
    assert document["laws"][0]["peak_force"] == read_result("out")["rolling/contact_force"][0].max()
    assert (out / "run.nc").stat().st_mtime_ns == before
    call("run", "moved.toml", "-o", "out", "--again", code=3)


INCOMPLETE = {
    "a table is gone": lambda out: next(out.glob("*.csv")).unlink(),
    "no page": lambda out: (out / "report.html").unlink(),
    "the page of a run before": lambda out: os.utime(out / "report.html", ns=(0, 0)),
    "damaged": lambda out: (out / "run.nc").write_bytes((out / "run.nc").read_bytes()[:-1]),
}


@pytest.mark.parametrize("what", INCOMPLETE)
def test_a_run_that_is_not_whole_is_none(out, what):
    case = load_case("small.toml")
    assert earlier_result(case, out, report=True, converge=False) is not None
    INCOMPLETE[what](out)
    assert earlier_result(case, out, report=True, converge=False) is None


def test_a_run_of_another_program_or_without_convergence_is_computed(out, monkeypatch):
    case = load_case("small.toml")
    assert earlier_result(case, out, report=False, converge=True) is None
    monkeypatch.setattr("asperity.__version__", "9")
    assert earlier_result(case, out, report=False, converge=False) is None


def test_a_run_is_another_where_a_file_that_it_names_holds_something_else():
    """However its name and its time stay the same; a file that is gone gives the run no name."""
    np.save("line.npy", np.arange(4000.0))
    keys = 'line = "line.npy"\nline_unit = "nm"\nline_spacing = "8 um"'
    Path("case.toml").write_text('laws = ["hertz"]\n' + CASE.replace('rms = "0.5 um"', keys))
    case, status = load_case("case.toml"), Path("line.npy").stat()
    name = name_of_run(case)
    assert name == name_of_run(load_case("case.toml"))
    np.save("line.npy", np.arange(4000.0) + np.eye(1, 4000, 77)[0])
    os.utime("line.npy", ns=(status.st_atime_ns, status.st_mtime_ns))
    assert name_of_run(case) != name
    np.save("line.npy", np.arange(4000.0))
    assert name_of_run(case) == name
    Path("line.npy").unlink()
    assert name_of_run(case) == ""


def test_another_case_is_never_overwritten(out):
    Path("other.toml").write_text(SMALL + 'level = "+3 dB"\n')
    outcome = call("run", "other.toml", "-o", "out", code=2)
    assert "out: received the run of another case" in outcome.stderr
    assert "--overwrite" in outcome.stderr
    assert parse_case(read_result("out").attrs["case"]) == parse_case(SMALL)
    call("run", "other.toml", "-o", "out", "--overwrite", "--no-report")
    assert "+3 dB" in read_result("out").attrs["case"]


@pytest.mark.parametrize(
    ("name", "message"),
    [("run.nc", "a run.nc that cannot be read"), ("report.html", "a report.html without its run.nc")],
)
def test_files_of_others_are_never_overwritten(name, message):
    Path("out").mkdir()
    Path("out", name).write_text("precious")
    assert message in call("run", "case.toml", "-o", "out", code=2).stderr
    assert Path("out", name).read_text() == "precious"
    assert [path.name for path in Path("out").iterdir()] == [name]
    assert nothing_was_computed()


def test_a_file_is_no_folder_for_results():
    for command in ("run", "check"):
        message = call(command, "case.toml", "-o", "case.toml", code=2).stderr
        assert "folder of the results: received case.toml" in message
        assert "case.toml is a file); allowed: a folder that can be written to." in message
    assert Path("case.toml").read_text() == CASE


def test_the_demonstration_says_where_its_report_lies():
    outcome = call("demo")
    assert "warning" not in outcome.stderr.lower()
    assert "out of range" not in outcome.output.lower()
    page = Path("asperity-demo/report.html").resolve()
    assert str(page) in outcome.stdout
    assert page.stat().st_size > 100_000
    assert "areal" in read_result("asperity-demo")["rolling/law"]


# --- exit codes and messages


def test_wrong_input_is_2_with_one_message_per_error():
    Path("bad.toml").write_text(CASE + 'hurts = 0.7\n[ball]\nradius = "-1 mm"\n')
    outcome = call("run", "bad.toml", "-o", "out", code=2)
    assert "bad.toml: 2 errors" in outcome.stderr
    assert 'Did you mean "hurst"?' in outcome.stderr
    assert "Traceback" not in outcome.output
    assert not Path("out").exists()


def test_a_missing_case_is_2():
    assert "absent.toml: received no such file" in call("run", "absent.toml", code=2).stderr
    assert "absent.toml: received no such file" in call("check", "absent.toml", code=2).stderr


def test_wrong_use_is_2():
    assert "No such command 'rn'" in call("rn", code=2).stderr
    assert "No such option" in call("run", "case.toml", "--outptu", "x", code=2).stderr
    assert "Missing argument" in call("run", code=2).stderr


def test_input_that_proves_wrong_while_computing_is_2():
    np.save("line.npy", np.random.default_rng(0).normal(size=900))
    line = 'line = "line.npy"\nline_unit = "nm"\nline_spacing = "8 um"'
    Path("case.toml").write_text(SMALL.replace('spectrum = "iso3095"', line))
    assert (
        "Error: surface.line: received 0.0072 m; allowed: at least" in call("run", "case.toml", code=2).stderr
    )


def test_a_failed_computation_is_3():
    Path("study.toml").write_text('case = "case.toml"\n[sweep]\n"beam.height" = ["1 um", "2 um"]\n')
    outcome = call("study", "study.toml", "--workers", "1", code=3)
    assert outcome.stderr.splitlines()[-1].startswith("Error: all 2 members failed, the first one so: ")
    assert outcome.stderr.strip().endswith("Try: one of them with 'asperity run'.")
    assert "Traceback" not in outcome.output


def test_a_fault_of_the_program_is_3_and_says_how_to_see_more(monkeypatch):
    failing_with(monkeypatch, ZeroDivisionError("division by zero"))
    outcome = call("run", "case.toml", code=3)
    assert "ZeroDivisionError: division by zero. Try: asperity --debug" in outcome.stderr
    assert "Traceback" not in outcome.output
    assert "Traceback" in call("--debug", "run", "case.toml", code=3).stderr


def test_too_little_memory_is_3(monkeypatch):
    failing_with(monkeypatch, MemoryError())
    assert "are meant in? If so, try a smaller contact.window" in call("run", "case.toml", code=3).stderr


@pytest.mark.parametrize("command", ["run", "check", "study"])
def test_a_folder_that_cannot_be_written_is_2_before_anything_is_computed(command):
    Path("file").write_text("in the way")
    Path("study.toml").write_text('case = "case.toml"\n[sweep]\nseed = [1, 2]\n')
    file = "study.toml" if command == "study" else "case.toml"
    message = call(command, file, "-o", "file/out", code=2).stderr
    assert "folder of the results: received file/out" in message
    assert "file is a file)" in message
    assert nothing_was_computed()
    if Path("/proc/self").exists():  # where nobody makes files, the superuser neither
        assert "folder of the results" in call(command, file, "-o", "/proc/out", code=2).stderr


def test_several_errors_of_files_and_surroundings_come_at_once(monkeypatch):
    monkeypatch.setenv("ASPERITY_THREADS", "many")
    np.save("map.npy", np.random.default_rng(0).normal(size=(64, 64)))
    keys = 'file = "map.npy"\nheight_unit = "um"'
    ball = '[ball]\nload = "20 kN"\n[contact]\nspacing = "8 um"\nwindow = "0.5 mm"\n'
    Path("case.toml").write_text(CASE.replace('rms = "0.5 um"', keys) + ball)
    for command in ("run", "check"):
        message = call(command, "case.toml", code=2).stderr
        assert "case.toml: 3 errors" in message
        assert "  - contact.window: received 504 um; allowed: at least" in message
        assert 'Give it, as in pixel = "1.5 um" in [surface].' in message
        assert "  - $ASPERITY_THREADS: received 'many'" in message


BEFORE_COMPUTING = {
    "window": ('[contact]\nwindow = "0.2 mm"\n', "contact.window: received 2"),
    "strips": (
        '[contact]\nwindow = "0.5 mm"\nspacing = "60 um"\nsample_length = "1 mm"\n[surface]',
        "contact.sample_length: received strips of",
    ),
    "hardness": ('[contact]\nhardness = "1 MPa"\n', "contact.hardness: received 0.001 GPa"),
    "step": ('[numerics]\ntime_step = "30 us"\n', "duration: received 0.02 ms; allowed: at least one"),
}


@pytest.mark.parametrize("what", BEFORE_COMPUTING)
def test_check_finds_what_run_refuses(what):
    keys, expected = BEFORE_COMPUTING[what]
    case = CASE + '[ball]\nload = "60 N"\n' + keys.removesuffix("[surface]")
    if what == "step":
        case = case.replace('"0.01 s"', '"20 us"')
    if what == "strips":
        case = 'speed = "5 m/s"\n' + case.replace('"0.5 um"', '"0.5 um"\nshortest = "0.2 mm"')
    Path("case.toml").write_text(case)
    found = call("check", "case.toml", code=2).stderr
    assert expected in found
    assert call("run", "case.toml", code=2).stderr == found
    assert nothing_was_computed()


def test_check_finds_approaches_that_do_not_carry_the_load():
    approaches = 'approaches = ["-1 um", "-0.9 um"]\nsamples = 2\n'
    Path("case.toml").write_text(CASE.replace("0.5 um", "0.1 um") + f"[contact]\n{approaches}")
    for command in ("run", "check"):
        message = call(command, "case.toml", code=2).stderr
        assert "contact.approaches: received up to -0.9 um, where the samples carry 0 N" in message


def test_check_finds_approaches_of_which_one_alone_is_in_contact():
    approaches = 'approaches = ["-9 um", "3 um"]\nsamples = 2\n'
    Path("case.toml").write_text(CASE.replace("0.5 um", "0.1 um") + f"[contact]\n{approaches}")
    message = call("check", "case.toml", code=2).stderr
    assert "contact.approaches: received up to 3 um, where the samples carry" in message
    assert "and none at -9 um; allowed: at least two approaches in contact. Add some around" in message


def test_check_says_what_is_doubtful_before_anything_is_computed():
    Path("case.toml").write_text('start = "0 m"\nsettling = "0 s"\n' + CASE)
    assert "Warning: the record starts 0 ms after rest" in call("check", "case.toml").stderr


def test_warnings_are_printed_once_on_one_line(monkeypatch):
    Path("file").write_text("where the cache should be")
    monkeypatch.setenv("ASPERITY_CACHE", "file")
    surface = (
        'rms = "0.1 um"\nlongest = "0.2 mm"\nshortest = "40 um"\n[contact]\nsamples = 1\nspacing = "20 um"'
    )
    case = SMALL.replace('spectrum = "iso3095"', surface).replace("hertz", "table").replace("20 ms", "2 ms")
    Path("case.toml").write_text(case)
    lines = call("run", "case.toml", "--no-report").stderr.splitlines()
    assert len([line for line in lines if "finished work is not kept" in line]) == 1
    assert all(line.startswith("Warning: ") for line in lines if "not kept" in line)


def test_exit_codes_of_the_program_itself():
    program = [sys.executable, "-c", "from asperity.cli import main; main(prog_name='asperity')"]
    done = subprocess.run([*program, "new", "ball-on-beam"], capture_output=True, text=True, check=False)
    assert done.returncode == 0
    assert done.stdout.startswith("# A ball rolls over a rough beam")
    wrong = subprocess.run([*program, "new", "wheel-on-beam"], capture_output=True, text=True, check=False)
    assert wrong.returncode == 2
    assert wrong.stderr.startswith("Error: kind: received 'wheel-on-beam'; allowed: \"ball-on-beam\", ")
    assert len(wrong.stderr.splitlines()) == 1


ENDING = """
import atexit, sys, threading
class Told:
    def __init__(self, name): self.name = name
    def __del__(self): print(self.name)
late = Told("taken apart")
from asperity.__main__ import start
def work():
    threading.main_thread().join()  # however long that takes: the program has nothing left to do
    atexit.register(print, "put away")
    print("awaited")
threading.Thread(target=work).start()
sys.stdout = open(sys.stdout.fileno(), "w", buffering=65536)
start()
"""


@pytest.mark.parametrize(("words", "code"), [(["--version"], 0), (["check", "nothing.toml"], 2)])
def test_the_program_puts_away_what_it_holds_and_ends_without_taking_python_apart(words, code):
    done = subprocess.run([sys.executable, "-c", ENDING, *words], capture_output=True, text=True)
    assert done.returncode == code
    told = done.stdout.splitlines()
    assert told[-2:] == ["awaited", "put away"]
    assert "taken apart" not in told


def test_a_terminal_without_greek_letters_is_enough():
    program = [
        sys.executable,
        "-c",
        "from asperity.cli import main; main(prog_name='asperity')",
        "check",
        "case.toml",
    ]
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    done = subprocess.run(program, capture_output=True, text=True, env=environment, check=True)
    assert "6001 points 10 um apart" in done.stdout


PROGRAM = [sys.executable, "-c", "from asperity.cli import main; main(prog_name='asperity')"]


@pytest.mark.parametrize(
    ("encoding", "shown"),
    [("cp1252", "-22.7 dB, 10-6 µm, delta = d0"), ("cp866", "-22.7 dB, 10-6 um, delta = d0")],
)
def test_a_pipe_without_a_minus_sign_gets_a_hyphen(encoding, shown):
    script = (
        "import sys, click\nfrom asperity.cli import main\n"
        "@main.command()\ndef say(): click.echo('−22.7 dB, 10⁻⁶ µm, δ = d₀')\n"
        "main(['say'])"
    )
    environment = {**os.environ, "PYTHONIOENCODING": encoding}
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, env=environment, check=True)
    assert done.stdout.decode(encoding).strip() == shown


def test_the_module_is_the_program():
    module = [sys.executable, "-m", "asperity"]
    done = subprocess.run([*module, "new", "study"], capture_output=True, text=True, check=True)
    assert done.stdout == call("new", "study").stdout
    wrong = subprocess.run([*module, "nwe"], capture_output=True, text=True, check=False)
    assert wrong.returncode == 2
    assert "Usage: python -m asperity" in wrong.stderr


@pytest.mark.parametrize(
    ("words", "completions"),
    [
        ("asperity new ", {"ball-on-beam", "wheel-on-rail", "bodies", "study", "optimisation"}),
        ("asperity new w", {"wheel-on-rail"}),
        ("asperity new --law sh", {"shifted", "shifted-unfiltered"}),
        ("asperity compare --law dir", {"direct"}),
        ("asperity study absent.toml --vary track.n", {"track.name="}),
        ("asperity study case.toml --vary beam.support=free,cl", {"beam.support=free,clamped"}),
        ("asperity run --device ", {"cpu", "gpu"}),
        ("asperity com", {"compare", "completion"}),
    ],
)
def test_a_shell_completes(words, completions):
    asked = {
        "_ASPERITY_COMPLETE": "bash_complete",
        "COMP_WORDS": words,
        "COMP_CWORD": str(len(words.split(" ")) - 1),
    }
    done = subprocess.run(PROGRAM, capture_output=True, text=True, env=os.environ | asked, check=True)
    assert {line.partition(",")[2] for line in done.stdout.split()} == completions


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_a_shell_is_told_how_to_complete(shell):
    assert "_ASPERITY_COMPLETE" in call("completion", shell).stdout


def test_help_imports_nothing_heavy():
    script = (
        "import sys\nfrom asperity.cli import main\n"
        "try: main(['--help'])\nexcept SystemExit: pass\n"
        "heavy = {'numpy', 'scipy', 'numba', 'xarray', 'pydantic', 'pint', 'matplotlib', 'rich'}\n"
        "print(sorted(heavy & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert "Roll a body" in done.stdout
    assert done.stdout.splitlines()[-1] == "[]"


COMMANDS = sorted(main.commands)


@pytest.mark.parametrize("command", COMMANDS)
def test_help_teaches_with_examples_that_the_command_takes(command):
    """Each example is a line that the program can read: its command and its options are there."""
    told = call(command, "--help").stdout
    examples = told.split("Examples:\n")[1].splitlines()
    assert [line[:4] == "  # " for line in examples] == [True, False] * (len(examples) // 2)
    for line in examples[1::2]:
        words = shlex.split(re.split(r" [|>]+ |\)\"", line.partition("asperity ")[2])[0])
        assert words[0] == command
        known = {name for option in main.commands[command].params for name in option.opts}
        assert {word for word in words if word.startswith("-")} <= known


def test_help_lists_every_command_with_a_whole_sentence():
    told = call("--help").stdout
    for name, command in main.commands.items():
        assert re.search(rf"^  {name} +{re.escape(command.short_help)}$", told, re.M)
    assert "..." not in told.split("Begin:")[1]


def test_laws_of_a_new_case_can_be_chosen():
    Path("chosen.toml").write_text(call("new", "ball-on-beam", "--law", "table", "--law", "hertz").stdout)
    assert load_case("chosen.toml").laws == ("table", "hertz")
    refused = call("new", "ball-on-beam", "--law", "aerial", code=2).stderr
    assert "law: received 'aerial'; allowed:" in refused
    assert 'Did you mean "areal"?' in refused


# --- new and check


@pytest.mark.parametrize("name", ["ball-on-beam", "wheel-on-rail", "study"])
def test_what_is_new_survives_any_encoding_of_a_redirection(name):
    """PowerShell 5 writes UTF-16, cmd its code page."""
    text = call("new", name).stdout
    assert text.isascii()
    Path("case.toml").write_text(call("new", "ball-on-beam").stdout)
    Path("new.toml").write_bytes(text.encode("utf-16"))
    if name == "study":
        assert load_study("new.toml").shape == (2, 3)
    else:
        assert load_case("new.toml").kind == name


def test_no_such_template():
    message = call("new", "ball-on-bam", code=2).stderr
    assert message.startswith(
        'Error: kind: received \'ball-on-bam\'; allowed: "ball-on-beam", "wheel-on-rail", "bodies", '
        '"study", "optimisation". Did you mean "ball-on-beam"?'
    )


@pytest.mark.parametrize(
    ("content", "received"),
    [
        (CASE.encode("utf-16-le"), "text in UTF-16 without a byte-order mark"),
        (CASE.encode("utf-16-be"), "text in UTF-16 without a byte-order mark"),
        (CASE.encode("utf-16")[:-1], "a byte that is no UTF-16"),
        ("# caf\u00e9\n".encode("cp1252"), "a byte that is no UTF-8 in line 1"),
        (bytes(range(256)), "bytes that are no text"),
    ],
)
def test_other_encodings_are_named(content, received):
    Path("case.toml").write_bytes(content)
    message = call("check", "case.toml", code=2).stderr
    assert f"case.toml: received {received}" in message
    assert "Save the file as UTF-8." in message


@pytest.mark.parametrize("folder", ["data", "Users", "temp"])
def test_backslashes_of_windows_get_the_advice_of_single_quotes(folder):
    """TOML refuses \\d and \\U, and takes \\t for a tab."""
    Path("case.toml").write_text(CASE.replace('rms = "0.5 um"', rf'file = "C:\{folder}\beam.x3p"'))
    message = call("check", "case.toml", code=2).stderr
    assert r"write Windows paths in single quotes, as in file = 'C:\data\beam.x3p', or with /" in message
    Path("case.toml").write_text(CASE.replace('rms = "0.5 um"', rf"file = 'C:\{folder}\beam.x3p'"))
    message = call("check", "case.toml", code=2).stderr
    assert rf"surface.file: received 'C:\{folder}\beam.x3p'; allowed: the path of an existing file" in message
    Path("case.toml").write_text(CASE.replace('"0.01 s"', "0.01 s"))
    assert "double quotes" in call("check", "case.toml", code=2).stderr


def test_a_new_case_is_valid(own_folder):
    Path("new.toml").write_text(call("new", "ball-on-beam").stdout)
    assert load_case("new.toml").speed == 1.0


def test_check_shows_values_and_work():
    outcome = call("check", "case.toml")
    for text in (
        "a valid case",
        "ball.radius",
        "25 mm",
        "6001 points 10 µm apart",
        "0.01 s, and 0.05 s before it, 6000 steps of 10 µs",
        "less what the cache holds",
    ):
        assert text in outcome.stdout


def test_check_reads_the_measured_map():
    np.save("map[dim] :x:.npy", np.random.default_rng(0).normal(size=(64, 64)))  # names are no markup
    keys = 'file = "map[dim] :x:.npy"\nheight_unit = "um"\npixel = "8 um"\n'
    case = CASE.replace('rms = "0.5 um"\n', keys)
    Path("measured.toml").write_text(case)
    shown = call("check", "measured.toml").stdout
    assert "64 × 64 points, 0.512 × 0.512 mm" in shown
    assert "map[dim] :x:.npy" in shown
    Path("measured.toml").write_text(case + '[contact]\nwindow = "0.6 mm"\n')
    assert (
        "contact.window: received 600 um; allowed: at most the measured map, 510 um"
        in call("check", "measured.toml", code=2).stderr
    )
    Path("measured.toml").write_text(case.replace('pixel = "8 um"\n', ""))
    assert "pixel" in call("check", "measured.toml", code=2).stderr


def test_a_second_check_says_the_same_and_computes_nothing_until_a_file_changes(monkeypatch):
    heights = np.random.default_rng(0).normal(size=(64, 64))
    np.save("map.npy", heights)
    keys = 'file = "map.npy"\nheight_unit = "um"\npixel = "8 um"\n'
    Path("measured.toml").write_text(CASE.replace('rms = "0.5 um"\n', keys))
    first = call("check", "measured.toml")
    monkeypatch.setattr("asperity.running.prepare_case", None)
    assert call("check", "measured.toml").stdout == first.stdout
    np.save("map.npy", 2.0 * heights)
    assert "NoneType" in call("check", "measured.toml", code=3).stderr


def test_the_plan_counts_contact_solutions():
    from dataclasses import replace

    from asperity.cli.planning import plan
    from asperity.running import prepare_case
    from asperity.scenarios.expecting import expect

    laws = 'laws = ["table", "direct"]\n'
    contact = '[contact]\nspacing = "8 um"\nwindow = "0.5 mm"\n'
    contact += 'approaches = ["0 um", "1 um"]\nsamples = 2\nsample_length = "1.5 mm"\n'

    def rows_of(text):
        prepared = prepare_case(parse_case(text))
        return dict(plan(prepared, replace(expect(prepared, lambda *_: None), seconds=44.0)))

    rows = rows_of(laws + CASE + contact)
    window, strip = 63, 188  # rows of 8 µm
    path = 7501 + 2 * window
    assert rows["contact solutions, scan for the filters"] == f"at most {2 * 2 * (strip - window + 1)}"
    assert rows["contact solutions, scan for the path"] == f"at most {2 * (path - window + 1)}"
    assert rows["contact solutions, direct"] == f"at most {7500}"
    assert rows["work"] == "about 40 s, less what the cache holds"
    smooth = CASE.replace('rms = "0.5 um"', 'spectrum = "iso3095"')
    assert not any(name.startswith("contact solutions") for name in rows_of(smooth))


LONG = """
kind = "ball-on-beam"
laws = ["table"]
speed = "1 m/s"
[surface]
rms = "0.05 um"
longest = "0.4 mm"
shortest = "40 um"
[ball]
radius = "25 mm"
[beam]
length = "10 m"
[contact]
spacing = "10 um"
window = "0.5 mm"
approaches = [
    "-0.2 um", "-0.1 um", "0 um", "0.1 um", "0.2 um", "0.3 um", "0.4 um", "0.6 um", "0.8 um", "1 um",
]
"""


def test_a_path_of_ten_metres_is_planned_and_announced(monkeypatch):
    """10^6 positions × 10 approaches of 8 bytes are 76 MiB."""
    Path("long.toml").write_text(LONG)
    monkeypatch.setenv("COLUMNS", "400")
    shown = " ".join(call("check", "long.toml").stdout.replace("│", " ").split())
    planned = re.search(
        r"scan of the path (\d+) positions 10 µm apart × 10 approaches, solved in single precision, "
        r"at most (\d+) solutions",
        shown,
    )
    assert planned
    assert 1_000_000 <= int(planned[1]) <= 1_000_100
    assert int(planned[2]) == 10 * int(planned[1])
    size = float(re.search(r"([\d.]+) MiB in", shown)[1])
    assert 76 < size < 90

    started = subprocess.Popen(
        [*PROGRAM, "--debug", "run", "long.toml", "-o", "out"], stderr=subprocess.PIPE, text=True
    )
    said = [started.stderr.readline()]
    while "goes on after its last finished block" not in said[-1]:
        assert started.poll() is None, said
        said.append(started.stderr.readline())
    assert f"Scan of the path: {planned[1]} positions" in "".join(said)
    started.send_signal(signal.SIGINT)
    rest = started.communicate(timeout=60)[1]
    assert started.returncode == 130
    assert rest.splitlines()[-1] == "interrupted; run the same command again to continue"
    assert "Traceback" not in rest


def test_a_scan_that_the_disk_cannot_hold_is_refused(monkeypatch):
    Path("long.toml").write_text(LONG)
    monkeypatch.setattr("asperity.scenarios.expecting.free_space", lambda path: 2**20)
    message = call("run", "long.toml", "-o", "out", code=2).stderr
    assert "disk of the cache: received 1 MiB free" in message
    assert "ASPERITY_CACHE" in message


def test_a_run_leaves_no_report_of_another(out):
    """Neither its page nor the CSVs of another kind of case; files of other names stay."""
    (out / "measured.csv").write_text("x")
    (out / "receptance.csv").write_text("x")
    call("run", "small.toml", "-o", "out", "--no-report", "--again")
    assert sorted(path.name for path in out.iterdir() if path.is_file()) == ["measured.csv", "run.nc"]


@pytest.mark.parametrize("command", ["run", "check"])
def test_results_that_the_disk_cannot_hold_are_refused_before_work(monkeypatch, command):
    monkeypatch.setattr("asperity.files.free_space", lambda path: 2**10)
    message = call(command, "case.toml", "-o", "out", code=3).stderr
    assert "the disk is full (" in message
    assert "are needed, 1 KiB are free)" in message
    assert nothing_was_computed()
    assert not Path("out").exists()


# --- surface and cache


@pytest.fixture
def ensemble():
    rng = np.random.default_rng(0)
    np.savez("maps.npz", polished=rng.normal(size=(3, 40, 32)), line=rng.normal(size=200))
    return ["surface", "maps.npz", "--height-unit", "um", "--pixel", "2 um"]


def test_surface_says_what_is_in_a_file(ensemble):
    outcome = call(*ensemble, "--array", "polished")
    assert (
        "3 maps, each 40 × 32 points, 0.08 × 0.064 mm, 2 × 2 µm apart, 0.00% without a height"
        in outcome.stdout
    )
    assert "Sq" in outcome.stdout
    assert "wavelengths 4 µm to 0.08 mm" in outcome.stdout
    assert Path("maps-polished-surface.png").read_bytes().startswith(b"\x89PNG")


def test_surface_takes_one_of_an_ensemble(ensemble):
    outcome = call(*ensemble, "--array", "polished", "--index", "2", "-o", "picture.svg")
    assert "a map of 40 × 32 points" in outcome.stdout
    assert "<svg" in Path("picture.svg").read_text()
    assert "3" in call(*ensemble, "--array", "polished", "--index", "3", code=2).stderr


def test_surface_reads_lines_and_missing_points():
    heights = np.random.default_rng(0).normal(size=300)
    heights[5] = np.nan
    np.save("line.npy", heights)
    outcome = call("surface", "line.npy", "--height-unit", "um", "--pixel", "2 um")
    assert "a line of 300 points, 0.6 mm, 2 µm apart, 0.33% without a height" in outcome.stdout
    assert "Rq" in outcome.stdout
    outcome = call("surface", "line.npy", "--height-unit", "um", "--pixel", "2 um", "--fill")
    assert "0.00% without a height" in outcome.stdout


def test_surface_asks_for_what_the_file_does_not_say(ensemble):
    assert "polished" in call(*ensemble, code=2).stderr
    assert "unit" in call("surface", "maps.npz", "--array", "line", "--pixel", "1 um", code=2).stderr
    assert "absent.x3p" in call("surface", "absent.x3p", code=2).stderr


def test_hints_are_asked_for_as_options(ensemble):
    def advised(*arguments):
        return call("surface", *arguments, code=2).stderr

    bare = ["maps.npz", "--array", "line"]
    assert "Choose one, as in --array polished." in advised("maps.npz")
    assert "Give it, as in --height-unit um." in advised(*bare)
    assert 'Give it, as in --pixel "1.5 um".' in advised(*bare, "--height-unit", "um")
    Path("comma.txt").write_text("0,5\n1,5\n2,75\n")
    message = advised("comma.txt", "--height-unit", "um", "--pixel", "1 um")
    assert 'Give --decimal "," if the comma is the decimal mark; if it separates columns, give' in message
    call("surface", "comma.txt", "--height-unit", "um", "--pixel", "1 um", "--decimal", ",", code=2)
    Path("plain.txt").write_text("".join(f"{x} {x % 3}\n" for x in range(20)))
    assert "or give --pixel-unit mm." in advised("plain.txt", "--height-unit", "um")
    read = call("surface", "plain.txt", "--height-unit", "um", "--pixel-unit", "mm")
    assert "a line of 20 points, 20 mm" in read.stdout
    Path("odd.txt").write_text("# unit: kg\n1\n2\n")
    assert "leave the bracket out and give --height-unit um." in advised("odd.txt", "--pixel", "1 um")


def test_missing_points_are_filled_by_an_option():
    heights = np.random.default_rng(0).normal(size=300)
    heights[5] = np.nan
    np.save("line.npy", heights)
    warning = call("surface", "line.npy", "--height-unit", "um", "--pixel", "2 um").stderr
    assert "--fill interpolates them" in warning
    assert "fill=True" not in warning


def test_a_map_is_rolled_along_its_other_direction(ensemble):
    outcome = call(*ensemble, "--array", "polished", "--transpose")
    assert "3 maps, each 32 × 40 points" in outcome.stdout


def test_each_array_and_map_has_a_picture_of_its_own(ensemble):
    np.savez("maps.npz", a=np.random.default_rng(0).normal(size=(2, 40, 32)), b=np.ones((30, 30)).cumsum(0))
    for choice in (["--array", "a"], ["--array", "a", "--index", "0"], ["--array", "b"]):
        said = call(*ensemble, *choice).stdout
        assert said.startswith(", ".join(["maps.npz", choice[1]]))
    assert "a plane has no texture to be tested" in said
    assert sorted(path.name for path in Path().glob("*.png")) == [
        "maps-a-0-surface.png",
        "maps-a-surface.png",
        "maps-b-surface.png",
    ]


def test_titles_of_pictures_name_array_and_map(ensemble, monkeypatch):
    titles = []
    monkeypatch.setattr(
        "asperity.cli.surface.write_chart", lambda chart, title, to: titles.append(title) or to
    )
    call(*ensemble, "--array", "polished")
    call(*ensemble, "--array", "polished", "--index", "2")
    assert titles == ["maps.npz, polished, the first of 3 maps", "maps.npz, polished, map 2"]


@pytest.mark.parametrize(
    ("keys", "advice"),
    [
        ('file = "maps.npz"', 'Choose one, as in array = "polished" in [surface].'),
        ('file = "maps.npz"\narray = "polished"', 'Give it, as in height_unit = "um" in [surface].'),
        ('line = "maps.npz"', 'Choose one, as in line_array = "polished" in [surface].'),
        ('line = "maps.npz"\nline_array = "line"', 'Give it, as in line_unit = "um" in [surface].'),
        (
            'line = "maps.npz"\nline_array = "line"\nline_unit = "um"',
            'Give it, as in line_spacing = "1.5 um" in [surface].',
        ),
        ('line = "comma.txt"\nline_unit = "um"', "Write decimal points, or semicolons between columns."),
        ('line = "pairs.txt"\nline_unit = "um"', 'Write it into the heading, as "x (mm)".'),
        ('file = "holes.npy"\nheight_unit = "um"\npixel = "8 um"', "Set fill = true in [surface]."),
    ],
)
def test_hints_are_asked_for_as_keys_of_a_case(ensemble, keys, advice):
    Path("comma.txt").write_text("0,5\n1,5\n2,75\n")
    Path("pairs.txt").write_text("".join(f"{x} {x % 3}\n" for x in range(20)))
    np.save("holes.npy", np.where(np.eye(80) > 0, np.nan, np.arange(80) * 1e-9))
    Path("case.toml").write_text(CASE.replace('rms = "0.5 um"', keys))
    assert advice in call("run", "case.toml", code=2).stderr


def test_a_line_of_a_ball_case_is_read_with_its_hints():
    np.savez("lines.npz", a=np.zeros(9), b=np.random.default_rng(0).normal(size=4000))
    keys = 'line = "lines.npz"\nline_array = "b"\nline_unit = "nm"\nline_spacing = "8 um"'
    grid = '[contact]\nspacing = "8 um"\n'
    Path("case.toml").write_text('laws = ["hertz"]\n' + CASE.replace('rms = "0.5 um"', keys) + grid)
    call("run", "case.toml", "-o", "out", "--no-report")
    line = read_result("out")["surface/line"]
    assert float(line.std()) == pytest.approx(1e-9, rel=0.1)


def test_a_file_that_is_missing_is_named_once(ensemble):
    for arguments in (["surface", "absent.x3p"], ["run", "absent.toml"], ["study", "absent.toml"]):
        message = call(*arguments, code=2).stderr
        assert message.startswith(f"Error: {arguments[1]}: received no such file; allowed: ")
        assert message.count("absent") == 1
    Path("case.toml").write_text(CASE.replace('rms = "0.5 um"', 'file = "absent.x3p"'))
    assert call("run", "case.toml", code=2).stderr.count("absent.x3p") == 1
    assert "received a folder" in call("run", ".", code=2).stderr


def test_lines_measured_side_by_side_are_no_map():
    lines = np.random.default_rng(0).normal(0.0, [[2.0], [4.0], [6.0]], (3, 900))
    lines[1, 850:] = np.nan
    np.save("lines.npy", lines)
    hints = ["surface", "lines.npy", "--height-unit", "um", "--pixel", "1 mm"]
    shown = call(*hints).stdout
    assert "lines.npy: 3 parallel lines, each of 900 points, 900 mm, 1 mm apart, 1.85% without" in shown
    assert "--map takes it for a map" in shown
    assert "wavelengths 2 mm to 900 mm" in shown
    measured = re.search(r"Rq +([\d.]+) µm  rms height \(([\d.]+) µm to ([\d.]+) µm\)", shown)
    assert [float(number) for number in measured.groups()] == pytest.approx([4.0, 2.0, 6.0], rel=0.05)
    assert "Sal" not in shown
    assert Path("lines-surface.png").read_bytes().startswith(b"\x89PNG")
    assert "--map" not in call(*hints, "--lines").stdout
    refused = call(*hints, "--map", code=2).stderr  # a map of three rows has no slopes
    assert "3 points along axis 0" in refused


def test_a_map_may_be_taken_for_lines(ensemble):
    shown = call(*ensemble, "--array", "polished", "--index", "0", "--lines").stdout
    assert "32 parallel lines, each of 40 points, 80 µm" in shown.replace("0.08 mm", "80 µm")


def ridges(*arguments):
    """What the command says of a wave along x, 2 µm in amplitude and 50 µm long."""
    x = 2.0 * np.arange(200)
    np.save("ridges.npy", np.tile(2.0 * np.sin(2 * np.pi * x / 50.0)[:, None], (1, 120)))
    hints = ["--height-unit", "um", "--pixel", "2 um", "--map"]
    return call("surface", "ridges.npy", *hints, *arguments).stdout


def column(path, title):
    with open(path, encoding="utf-8", newline="") as file:
        found = [row[title] for row in csv.DictReader(file)]
    return np.array([float(value) for value in found if value])


def test_spectra_of_a_surface_are_written():
    """The PSD of a wave of amplitude A has its peak at 1/λ and the integral A²/2."""
    said = ridges("--psd")
    assert str(Path("ridges-psd.csv").resolve()) in said
    wavenumber = column("ridges-psd.csv", "wavenumber along x [1/m]")
    density = column("ridges-psd.csv", "PSD along x [m³]")
    assert wavenumber[density.argmax()] == pytest.approx(1 / 50e-6)
    assert density.sum() * wavenumber[0] == pytest.approx(0.5 * (2e-6) ** 2, rel=1e-3)
    across = column("ridges-psd.csv", "PSD along y [m³]")
    assert across[2:].max() < 1e-12 * density.max()  # each line across is level, at a height of its own


@pytest.mark.parametrize(("angle", "std"), [("90", 90), ("30 deg", 150), ("0.5235987756 rad", 150)])
def test_a_map_is_turned(angle, std):
    """What varies along x varies at 180° less the angle of the direction in which it is rolled over."""
    np.save("ridges.npy", np.tile(np.repeat(np.random.default_rng(1).normal(size=100), 3)[:, None], (1, 240)))
    hints = ["--height-unit", "um", "--pixel", "2 um", "--map"]
    said = call("surface", "ridges.npy", *hints, "--direction", angle).stdout
    assert abs(int(re.search(r"Std +(\d+)°", said)[1]) - std) <= 2
    if angle == "90":
        assert "a map of 240 × 300 points" in said


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["map.npy", "--rotate", "30 m"], "--direction: received '30 m'; allowed: an angle, as 30 (degrees)"),
        (["map.npy", "--direction", "left"], "--direction: received 'left'; allowed: an angle"),
        (["map.npy", "--direction", "nan"], "--direction: received 'nan'; allowed: an angle"),
        (
            ["line.npy", "--direction", "30"],
            "--direction: received a line; allowed: a height map. Leave it out.",
        ),
        (
            ["hole.npy", "--psd"],
            "--psd: received more than 5 % of points without a height; allowed: nearly complete heights",
        ),
    ],
)
def test_what_a_surface_cannot_do_is_explained(arguments, message):
    heights = np.random.default_rng(0).normal(size=(40, 40))
    np.save("map.npy", heights)
    np.save("line.npy", heights.ravel())
    heights[3:8, 3:30] = np.nan
    np.save("hole.npy", heights)
    hints = ["--height-unit", "um", "--pixel", "2 um"]
    assert message in call("surface", *arguments, *hints, code=2).stderr


def test_surface_writes_pictures_only(ensemble):
    message = "allowed: a name that ends in .png, .pdf, .svg"
    assert message in call(*ensemble, "--array", "polished", "-o", "picture.doc", code=2).stderr
    Path("map.png").write_bytes(b"heights in a picture")
    assert "another name" in call("surface", "map.png", "-o", "map.png", code=2).stderr
    assert Path("map.png").read_bytes() == b"heights in a picture"


def test_cache_is_shown_and_cleared(own_folder, monkeypatch):
    monkeypatch.setenv("ASPERITY_KERNELS", str(own_folder / "kernels"))
    monkeypatch.setattr("tempfile.tempdir", str(own_folder))
    cache, version = own_folder / "cache", own_folder / "kernels" / "0123456789abcdef"
    Store().put("scan-1", {"force": np.zeros(2**17)})
    (cache / ".scan-2.npz.01234567.part").write_bytes(bytes(2**10))
    (cache / "notes.txt").write_text("of the user")
    version.mkdir(parents=True, mode=0o700)
    (version / "kernel-0").write_bytes(bytes(2**20))
    (version / ".kernel-1.01234567.part").write_bytes(bytes(2**10))
    told = [
        f"{cache}: 1 results, 1 MiB",
        f"{own_folder / 'kernels'}: 1 compiled functions, 1 MiB",
        f"{cache}: 1 files left by interrupted runs, 1 KiB",
        f"{own_folder / 'kernels'}: 1 files left by interrupted runs, 1 KiB",
    ]
    assert call("cache").stdout.splitlines() == told
    assert call("cache", "--clear").stdout.splitlines() == [
        f"{cache}: 1 results deleted, 1 MiB",
        f"{own_folder / 'kernels'}: 1 compiled functions deleted, 1 MiB",
        f"{cache}: 1 files left by interrupted runs deleted, 1 KiB",
        f"{own_folder / 'kernels'}: 1 files left by interrupted runs deleted, 1 KiB",
    ]
    assert [path.name for path in cache.iterdir()] == ["notes.txt"]
    assert list(version.iterdir()) == []


def test_surface_says_whether_a_map_is_the_same_everywhere_and_which_way_it_runs():
    rng = np.random.default_rng(3)
    ridges = np.repeat(rng.normal(size=64), 2)[:, None] + 0.5 * rng.normal(size=(128, 128))
    np.save("even.npy", ridges)
    np.save("trend.npy", ridges * np.linspace(0.3, 2.0, 128))
    even, trend = (
        call("surface", name, "--height-unit", "um", "--pixel", "2 um").stdout
        for name in ("even.npy", "trend.npy")
    )
    direction = int(re.search(r"Std +(\d+)°  direction from x", even)[1])
    assert min(direction, 180 - direction) <= 2
    assert "the same everywhere, as far as chance tells" in even
    assert "(p = 0.025): not the same everywhere" in trend
    ridges[3:20, 4:90] = np.nan
    np.save("hole.npy", ridges)
    hole = call("surface", "hole.npy", "--height-unit", "um", "--pixel", "2 um").stdout
    assert re.search(r"Std +–", hole)
    assert "Homogeneity, Std and spectra are those of a map with at least 95% of its points: --fill" in hole


def test_a_few_spikes_take_no_spectrum_away():
    """Three spikes of 16,384 points: direction, homogeneity and spectra are those of what lies between."""
    rng = np.random.default_rng(3)
    wave = np.sin(2 * np.pi * np.arange(128) / 16.0)[:, None] + 0.5 * rng.normal(size=(128, 128))
    wave[[30, 60, 90], [70, 20, 110]] = 300.0
    np.save("map.npy", wave)
    said = call("surface", "map.npy", "--height-unit", "nm", "--pixel", "2 um", "--spikes", "--psd").stdout
    assert re.search(r"Std +(0|1|179|180)°", said)
    assert "are those of the map with its missing points, 0.00018 of all, interpolated" in said
    wavenumber, density = (column("map-psd.csv", f"{name} along x [{unit}]") for name, unit in
                           (("wavenumber", "1/m"), ("PSD", "m³")))  # fmt: skip
    assert wavenumber[density.argmax()] == pytest.approx(1 / 32e-6)
    assert density.sum() * wavenumber[0] == pytest.approx(0.5e-18 + 0.25e-18, rel=0.05)


def test_lines_of_a_rail_are_held_against_the_limit_of_its_roughness():
    """A corrugation of 10 µm has 10 lg 50 = 17.0 dB in its band, where the limit is −5.6."""
    x = np.arange(4000) * 1e-3
    lines = np.array([10.0 * np.sin(2 * np.pi * x / 25e-3 + phase) for phase in (0.0, 1.0, 2.0)])
    lines += 0.02 * np.random.default_rng(0).normal(size=lines.shape)
    lines[1, 3000:] = np.nan  # a short line stays out of it
    np.save("rail.npy", lines)
    hints = ["surface", "rail.npy", "--height-unit", "um", "--pixel", "1 mm"]
    said = call(*hints).stdout
    measured = dict(re.findall(r"^ +([\d.]+) mm +-?[\d.]+ +(-?[\d.]+ +\w+)", said, re.MULTILINE))
    assert len(measured) == 22
    assert measured["25"].split() == ["17.0", "FAIL"]
    assert [band for band, each in measured.items() if each.endswith("FAIL")] == ["31.5", "25", "20"][1:2]
    document = json.loads(call(*hints, "--json").stdout)["third_octaves"]
    assert document["limit"][0] == 17.1
    assert document["wavelength"][0] == pytest.approx(0.4, rel=0.01)
    np.save("fine.npy", lines[0])
    fine = call("surface", "fine.npy", "--height-unit", "um", "--pixel", "2 um").stdout
    assert "ISO 3095" not in fine
