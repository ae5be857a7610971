"""``--json``: one document, whatever happens, in the form that docs/reference/json.md describes."""

import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from asperity.cli.commands import FORMAT
from asperity.results import read_result
from asperity.terminal import json_ready
from command_line import SMALL, call, working_in

pytestmark = pytest.mark.usefixtures("members_in_this_process")
DOCUMENT = Path(__file__).parents[2] / "docs" / "reference" / "json.md"


@pytest.fixture(autouse=True, scope="module")
def own_folder(tmp_path_factory, ran):
    """One for all, with a run."""
    with working_in(tmp_path_factory.mktemp("json")) as folder:
        Path("small.toml").write_text(SMALL)
        np.save("map.npy", np.random.default_rng(0).normal(size=(48, 40)))
        shutil.copytree(ran.folder, "a")
        Path("track.toml").write_text('kind = "wheel-on-rail"\nsurface.smooth = true\n')
        Path("hammer.csv").write_text("frequency (Hz), mobility (m/s/N)\n200, 4e-6\n400, 5e-6\n800, 6e-6\n")
        yield folder


def document(*arguments, code=0):
    """The document that a command prints; nothing else may stand beside it."""
    outcome = call(*arguments, "--json", code=code)
    assert outcome.stdout.isascii()
    found = json.loads(outcome.stdout, parse_constant=pytest.fail)
    assert (found["format"], found["exit_code"]) == (FORMAT, code)
    return found, outcome.stderr


def chapter(heading):
    """A chapter of docs/reference/json.md."""
    return DOCUMENT.read_text(encoding="utf-8").split(f"\n## {heading}\n")[1].split("\n## ")[0]


def documented(heading):
    """Names that docs/reference/json.md lists in a chapter."""
    rows = re.findall(r"^\|(.*?)\|", chapter(heading), re.M)
    return {name for row in rows for name in re.findall(r"`(\w+)`", row)}


SURFACE = ("surface", "map.npy", "--height-unit", "um", "--pixel", "2 um", "--psd")
COMMANDS = {
    "run": ("run", "small.toml", "-o", "a"),
    "check": ("check", "small.toml"),
    "surface": SURFACE,
    "bearing": ("bearing", "6205", "--radial", "100 N", "-o", "load.png"),
    "study": ("study", "small.toml", "--vary", "seed=1, 2", "-o", "st", "--workers", "1"),
    "fit": ("fit", "track.toml", "--to", "hammer.csv", "--free", "track.pad_stiffness", "--starts", "1"),
    "listen": ("listen", "a"),
    "signals": ("signals", "a"),
    "cite": ("cite", "a"),
    "cache": ("cache",),
}


@pytest.mark.parametrize("command", COMMANDS)
def test_every_name_is_documented_and_every_documented_name_is_there(command):
    found, _ = document(*COMMANDS[command])
    common = documented("In every document") - {"message", "kind", "error"}
    always = common - (set() if "`files`: " in chapter(command) else {"files"})
    assert set(found) == documented(command) | always
    assert found["command"] == command
    assert all(Path(path).is_file() for path in found.get("files", {}).values())


def test_numbers_of_a_run_are_those_of_its_file():
    told, tree = document(*COMMANDS["run"])[0], read_result("a")
    force = tree["rolling/contact_force"]
    assert [item["law"] for item in told["laws"]] == ["hertz", "linear"]
    assert told["laws"][0]["peak_force"] == float(force.sel(law="hertz").max())
    assert told["laws"][1]["rms_force"] == float(force.sel(law="linear", contact=1).std("time"))
    assert told["laws"][0]["mean_force"] == float(force.sel(law="hertz", contact=1).mean("time"))
    assert told["verdict"] == tree.attrs["verdict"]
    assert [item["message"] for item in told["warnings"]] == [
        item["message"] for item in json.loads(tree.attrs["warnings"])
    ]


def test_a_check_says_how_long_a_run_takes():
    found, _ = document("check", "small.toml", "-o", "a")
    times = {"seconds", "processor_seconds", "compiling_seconds"}
    assert set(found["work"]) == times | {"solutions", "steps", "bytes"}
    assert found["work"]["steps"] > 0
    speed = next(item for item in found["parameters"] if item["key"] == "speed")
    assert (speed["value"], speed["is_default"]) == ("1 m/s", True)


def test_statistics_of_a_surface_are_in_si():
    found, _ = document(*SURFACE)
    values = {item["symbol"]: item["value"] for item in found["statistics"]}
    heights = np.load("map.npy") * 1e-6
    assert values["Sq"] == pytest.approx(heights.std(), rel=1e-2)  # levelled
    assert found["shape"] == [48, 40]
    assert found["spacing"] == pytest.approx([2e-6, 2e-6])


def test_parts_of_errors_are_documented():
    found, _ = document("new", "study", code=2)  # it has no such form
    assert found["error"]["kind"] == "UsageError"
    assert set(found["error"]) <= documented("In every document")


def test_quiet_leaves_warnings_and_documents():
    outcome = call(*COMMANDS["run"], "--json", "-q")
    assert json.loads(outcome.stdout)["computed"] is False
    lines = outcome.stderr.splitlines()
    assert lines
    assert all(line.startswith(("Warning: ", "Note: ", "Out of range: ")) for line in lines)


def test_what_is_no_number_is_null():
    told = {"a": np.array([1.0, np.nan]), "b": np.inf, "c": np.float64(2.0), "d": Path("x"), 5: (True, None)}
    assert json_ready(told) == {"a": [1.0, None], "b": None, "c": 2.0, "d": "x", "5": [True, None]}
