"""``asperity creep``: a curve of a case in words, as CSV, and drawn."""

from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from asperity.reporting.chart import Line
from command_line import call

BALL = 'kind = "ball-on-beam"\n[surface]\n{}\n[ball]\nload = "20 N"\n[beam]\nloss_factor = 0.01\n'


@pytest.fixture(autouse=True)
def coarse():
    rough = BALL.format('rms = "60 nm"\nlongest = "60 um"\nshortest = "32 um"')
    window = '[contact]\nspacing = "12 um"\nwindow = "0.5 mm"\nsamples = 2\n'
    Path("case.toml").write_text(rough + window)


def test_a_rough_case_is_told_written_and_drawn(monkeypatch):
    drawn, creep = [], import_module("asperity.cli.creep")  # of this name the command line has a command
    write = creep.write_chart
    monkeypatch.setattr(creep, "write_chart", lambda chart, *to: (drawn.append(chart), write(chart, *to)))
    asked = ("creep", "case.toml", "--direction", "lateral", "--points", "3", "--friction", "0.2")
    told = call(*asked, "-o", "creep.svg", "--table", "creep.csv").stdout
    assert "samples)" in told
    assert "friction 0.2, lateral" in told
    names, *rows = Path("creep.csv").read_text().splitlines()
    assert names == "creepage across,smooth,rough,its scatter,linear theory,FASTSIM,share that slips"
    found = np.array([row.split(",") for row in rows], dtype=float)
    assert found[:, 1] == pytest.approx(found[:, 5], abs=0.08)
    assert found[-1, 1:3] == pytest.approx(1.0, abs=0.03)
    assert found[:, 2] != pytest.approx(found[:, 1], abs=1e-6)
    lines = [mark for mark in drawn[0].panels[0].marks if isinstance(mark, Line)]
    assert len(lines) == 4
    assert all((line.x[0], line.y[0]) == (0.0, 0.0) for line in lines)  # what does not creep has no force
    assert Path("creep.svg").read_text(encoding="utf-8").lstrip().startswith("<?xml")


def test_states_of_a_rough_case_are_told_written_and_drawn():
    asked = ("creep", "case.toml", "--states", "--points", "2")
    told = call(*asked, "-o", "states.svg", "--table", "states.csv").stdout
    assert "under the same load, 2 samples" in told
    table = np.genfromtxt("states.csv", delimiter=",", names=True)
    assert table.dtype.names[:4] == ("approach_m", "load_N", "rough_real_area_m2", "smooth_real_area_m2")
    stiffness, normal = table["rough_stiffness_across_Nm"], table["rough_normal_stiffness_Nm"]
    assert stiffness == pytest.approx(1.4 / 1.7 * normal, rel=0.01)
    light, heavy = table["ratio_of_longitudinal_creep_1"]
    assert light < heavy == pytest.approx(1.0, abs=0.03)
    assert Path("states.svg").stat().st_size > 1000
