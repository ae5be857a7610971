"""Presets run as they are written, and another scene, with a structure, takes one file and one line."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import asperity
from asperity.case import PRESETS
from asperity.case.cases import case_class, parse_case, template
from asperity.cli import main
from small_cases import CASES


@pytest.mark.usefixtures("cache_of_module")  # the ball's scans are those of the bodies
@pytest.mark.parametrize(
    "kind", [pytest.param(kind, marks=[pytest.mark.long] * (kind != "wheel-on-rail")) for kind in CASES]
)
def test_what_new_prints_runs_with_all_checks_in_range(kind):
    tree = asperity.run(parse_case(template(kind)))
    assert [w for w in json.loads(tree.attrs["warnings"]) if w["grade"] != "note"] == []
    checks = json.loads(tree["contact"].attrs["validity"])
    assert len(checks) > 5
    assert {check["grade"] for check in checks} <= {"", "note"}
    assert "never loses contact" in tree.attrs["verdict"]


NAME = "roller-on-foundation"
FILE = Path(__file__).with_name("roller_on_foundation.py")
CASE = f"""
kind = "{NAME}"
duration = "20 ms"
settling = "5 ms"
surface = {{rms = "0.05 um", longest = "0.2 mm", shortest = "50 um"}}
roller.load = "30 N"
contact = {{spacing = "20 um", window = "1 mm", samples = 2, sample_length = "4 mm"}}
numerics.highest_frequency = "2 kHz"
"""


@pytest.fixture
def kind(tmp_path, monkeypatch):
    """The file in a folder of its own, and one line."""
    (tmp_path / "own").mkdir()
    shutil.copy(FILE, tmp_path / "own" / "rollers.py")
    monkeypatch.syspath_prepend(str(tmp_path / "own"))
    monkeypatch.setitem(PRESETS, NAME, "rollers.RollerOnFoundation")


@pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")
def test_a_kind_in_one_file_is_written_checked_run_and_reported(kind, tmp_path, monkeypatch):
    def command(*arguments):
        done = CliRunner().invoke(main, arguments, standalone_mode=False)
        assert (done.exit_code, done.exception) == (0, None), done.output
        return done.output

    monkeypatch.chdir(tmp_path)
    assert f'kind = "{NAME}"' in command("new", NAME)
    Path("case.toml").write_text(CASE)
    plan = command("check", "case.toml")
    assert "roller.load" in plan
    assert "foundation.stiffness" in plan
    command("run", "case.toml", "-o", "out")
    result = asperity.open_result("out/run.nc")
    assert (result["scenario"].attrs["kind"], asperity.RollerOnFoundation) == (NAME, case_class(NAME))
    assert result.attrs["title"] == "A body over a foundation"
    assert "roller" in result.attrs["verdict"]
    rolling = result["rolling"].to_dataset()
    assert list(rolling["law"].values) == ["areal", "hertz", "linear"]
    force, sunk = (rolling[name].sel(contact=1) for name in ("contact_force", "over_displacement"))
    np.testing.assert_allclose(sunk, force / 5e6, rtol=1e-12)
    assert float(abs(force.mean("time") / 30.0 - 1.0).max()) < 0.02
    # Hertz follows every wave of the line, the areal texture is smoothed by the contact
    rms = force.std("time")
    assert float(rms.sel(law="hertz")) > 1.5 * float(rms.sel(law="areal")) > 0.0
    page = Path("out/report.html").read_text(encoding="utf-8")
    assert all(f">{heading}</h2>" in page for heading in ("Texture", "Contact", "Contact force"))
    assert {"force_psd.csv", "force_bands.csv"} <= {path.name for path in Path("out").iterdir()}
