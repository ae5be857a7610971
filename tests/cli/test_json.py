"""``--json``: one document on standard output, whatever happens, in the form that docs/json.md describes."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from asperity.cli import main
from asperity.cli.program import FORMAT
from asperity.results import read_result
from asperity.terminal import json_ready

DOCUMENT = Path(__file__).parents[2] / "docs" / "json.md"
SMALL = """
kind = "ball-on-beam"
laws = ["hertz", "linear"]
start = "0.45 m"
duration = "20 ms"
settling = "0 s"
[surface]
spectrum = "iso3095"
level = "-20 dB"
"""


@pytest.fixture(autouse=True, scope="module")
def own_folder(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        folder = tmp_path_factory.mktemp("json")
        patch.chdir(folder)
        patch.setenv("ASPERITY_CACHE", str(folder / "cache"))
        Path("small.toml").write_text(SMALL)
        np.save("map.npy", np.random.default_rng(0).normal(size=(48, 40)))
        yield folder


def document(*arguments, code=0):
    """The document that a command prints; nothing else may stand beside it."""
    outcome = CliRunner().invoke(main, [*arguments, "--json"])
    assert outcome.exit_code == code, outcome.output
    assert outcome.stdout.isascii()
    found = json.loads(outcome.stdout, parse_constant=pytest.fail)
    assert (found["format"], found["exit_code"]) == (FORMAT, code)
    return found, outcome.stderr


def chapter(heading):
    """A chapter of docs/json.md."""
    return DOCUMENT.read_text(encoding="utf-8").split(f"\n## {heading}\n")[1].split("\n## ")[0]


def documented(heading):
    """Names that docs/json.md lists in a chapter."""
    return {
        name
        for row in re.findall(r"^\|(.*?)\|", chapter(heading), re.M)
        for name in re.findall(r"`(\w+)`", row)
    }


@pytest.fixture(scope="module")
def ran(own_folder):
    return document("run", "small.toml", "-o", "a")[0]


COMMANDS = {
    "run": ("run", "small.toml", "-o", "a"),
    "check": ("check", "small.toml"),
    "surface": ("surface", "map.npy", "--height-unit", "um", "--pixel", "2 um", "--psd"),
    "study": ("study", "small.toml", "--vary", "seed=1, 2", "-o", "st", "--workers", "1"),
    "compare": ("compare", "a", "a"),
    "report": ("report", "a", "--summary"),
    "figures": ("figures", "a", "scene"),
    "listen": ("listen", "a"),
    "cite": ("cite", "a"),
    "cache": ("cache",),
}


@pytest.mark.parametrize("command", COMMANDS)
def test_every_name_is_documented_and_every_documented_name_is_there(command, ran):
    found, _ = document(*COMMANDS[command])
    common = documented("In every document") - {"message", "kind", "what", "received", "allowed", "remedy"}
    always = common - {"errors", "error"} - (set() if "`files`: " in chapter(command) else {"files"})
    assert set(found) == documented(command) | always
    assert found["command"] == command
    assert all(Path(path).is_file() for path in found.get("files", {}).values())


def test_numbers_of_a_run_are_those_of_its_file(ran):
    tree = read_result("a")
    force = tree["rolling/contact_force"]
    assert [item["law"] for item in ran["laws"]] == ["hertz", "linear"]
    assert ran["laws"][0]["peak_force"] == float(force.sel(law="hertz").max())
    assert ran["laws"][1]["rms_force"] == float(force.sel(law="linear", contact=1).std("time"))
    np.testing.assert_array_equal(ran["force_level"]["linear"], tree["spectra/force_level"].sel(law="linear"))
    assert ran["verdict"] == tree.attrs["verdict"]
    assert [item["message"] for item in ran["warnings"]] == [
        item["message"] for item in json.loads(tree.attrs["warnings"])
    ]


def test_a_check_says_how_long_a_run_takes(ran):
    found, _ = document("check", "small.toml", "-o", "a")
    assert set(found["work"]) == {"seconds", "solutions", "steps", "bytes"}
    assert found["work"]["steps"] > 0
    speed = next(item for item in found["parameters"] if item["key"] == "speed")
    assert (speed["value"], speed["is_default"]) == ("1 m/s", True)


def test_statistics_of_a_surface_are_in_si():
    found, _ = document(*COMMANDS["surface"])
    values = {item["symbol"]: item["value"] for item in found["statistics"]}
    heights = np.load("map.npy") * 1e-6
    assert values["Sq"] == pytest.approx(heights.std(), rel=1e-2)  # levelled
    assert found["shape"] == [48, 40]
    assert found["spacing"] == pytest.approx([2e-6, 2e-6])


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (
            ("run", "absent.toml"),
            {"kind": "InputError", "what": "absent.toml", "received": "no such file"},
        ),
        (("run", "bad.toml"), {"kind": "CaseError"}),
        (("surface", "map.npy"), {"kind": "InputError", "allowed": "a unit of length"}),
        (("compare", "a"), {"kind": "InputError", "what": "runs to compare", "received": "1"}),
        (("run", "small.toml", "--outptu", "x"), {"kind": "UsageError"}),
        (("rn", "small.toml"), {"kind": "UsageError"}),
        (("cite", "absent"), {"kind": "InputError"}),
        (("new", "study"), {"kind": "UsageError"}),  # it has no such form
    ],
)
def test_errors_are_documents_too(arguments, parts, ran):
    Path("bad.toml").write_text(SMALL + 'hurts = 0.7\n[ball]\nradius = "-1 mm"\n')
    found, said = document(*arguments, code=2)
    error = found["error"]
    assert {name: error[name] for name in parts if name != "allowed"} == {
        name: value for name, value in parts.items() if name != "allowed"
    }
    assert found["command"] == arguments[0]
    assert " ".join(error["message"].split()) in " ".join(said.split())
    assert set(error) <= documented("In every document")
    if error["kind"] == "CaseError":
        assert len(error["errors"]) == 2


def test_a_fault_of_the_program_and_an_interruption_are_documents_too(monkeypatch):
    import importlib

    def failing_with(error):
        def run(case, progress=None):
            raise error

        monkeypatch.setattr(importlib.import_module("asperity.running"), "run", run)

    failing_with(RuntimeError("odd"))
    found, _ = document("run", "small.toml", "-o", "b", code=3)
    assert found["error"]["kind"] == "ProgramError"
    assert "RuntimeError: odd" in found["error"]["message"]
    failing_with(KeyboardInterrupt())
    found, said = document("run", "small.toml", "-o", "b", code=130)
    assert found["error"]["message"].startswith("interrupted")
    assert "interrupted" in said


def test_quiet_leaves_warnings_and_documents(ran):
    outcome = CliRunner().invoke(main, ["run", "small.toml", "-o", "a", "--json", "-q"])
    assert json.loads(outcome.stdout)["verdict"] == ran["verdict"]
    lines = outcome.stderr.splitlines()
    assert lines
    assert all(line.startswith(("Warning: ", "Note: ", "Out of range: ")) for line in lines)


def test_verbose_says_what_each_piece_took(ran):
    outcome = CliRunner().invoke(main, ["run", "small.toml", "-o", "a", "-v", "--again"])
    assert re.search(r"^rolling: (\d+) of \1 in \d+ s", outcome.stderr, re.M)
    assert re.search(r"^Time:    \d+ s", outcome.stderr, re.M)


def test_what_is_no_number_is_null():
    told = {"a": np.array([1.0, np.nan]), "b": np.inf, "c": np.float64(2.0), "d": Path("x"), 5: (True, None)}
    assert json_ready(told) == {"a": [1.0, None], "b": None, "c": 2.0, "d": "x", "5": [True, None]}
