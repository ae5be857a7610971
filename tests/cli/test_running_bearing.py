"""A ball bearing by the command line: checked, run, reported, drawn, heard; what is not there is said."""

import json
from pathlib import Path

import pytest

from asperity.case.cases import as_case
from command_line import call
from small_cases import BEARING


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
    refused = call("compare", "out", "out/run.nc", code=2).stderr
    assert "runs to compare: received runs of bearings; allowed: runs of bodies that roll" in refused
    refused = call("run", "bearing.toml", "-o", "new", "--converge", code=2).stderr
    assert "convergence: received a ball-bearing case" in refused
