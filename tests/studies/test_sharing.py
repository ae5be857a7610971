"""Members of a study share what they have in common, and have the digits that they have alone."""

import json
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from executors import ROUGH, Here
from scipy.ndimage import gaussian_filter

import asperity
from asperity import HalfSpace
from asperity.case.cases import as_case
from asperity.contact.scan import ScanJob, scan_forces
from asperity.running import prepare_case, run
from asperity.store import Store
from asperity.studies.definition import study_of
from asperity.studies.member import kept, packed
from asperity.surfaces.strip import Fields, Rows
from small_cases import changed

WHEEL = changed(
    "wheel-on-rail",
    laws=["areal", "linear-filtered"],
    contact={"window": "20 mm"},
    numerics={"highest_frequency": "2 kHz", "poles": 40},
)


@pytest.fixture(autouse=True)
def cases(own_folder):
    Path("wheel.toml").write_text(WHEEL.to_toml())
    Path("rough.toml").write_text(ROUGH.to_toml())


def stored(name):
    return {path.name for path in Store().files() if path.name.startswith(name)}


@pytest.mark.parametrize(
    ("case", "sweep", "kernels", "more"),
    [
        ("wheel.toml", {"speed": ["21 m/s", "33 m/s"], "wheel.load": ["45 kN", "65 kN"]}, 2, 0),
        ("rough.toml", {"ball.load": ["40 N", "30 N"]}, 0, 6),
        ("rough.toml", {"speed": ["0.6 m/s", "1.3 m/s"]}, 0, 6),
    ],
    ids=["speeds and loads of a wheel", "loads over a path", "speeds over a path"],
)
def test_members_share_scans_and_have_the_digits_that_they_have_alone(
    case, sweep, kernels, more, monkeypatch
):
    """`kernels` of the track are one for each speed.

    A shorter path has `more` blocks, at its two ends, for each pair of states; another load has those of two
    pairs.
    """
    *_, last = study_of(case, sweep).members()
    monkeypatch.setenv("ASPERITY_CACHE", "alone")
    alone, of_one = packed(kept(run(last.case, brief=True))), stored("scan-")
    assert of_one
    monkeypatch.setenv("ASPERITY_CACHE", "together")
    monkeypatch.setattr("asperity.surfaces.strip.pieces", Fields())
    assert asperity.study(case, sweep, executor=Here())["completed"].all()
    assert len(of_one - stored("scan-")) == 0
    assert len(stored("scan-") - of_one) <= more < len(of_one)
    assert len(stored("moving-kernel-")) == kernels
    found = Store().get(last.key)
    assert found.keys() == alone.keys()
    for name in found.keys() - {"__description__"}:
        np.testing.assert_array_equal(found[name], alone[name], err_msg=name)
    described = [json.loads(str(each["__description__"])) for each in (found, alone)]
    assert described[0]["variables"] == described[1]["variables"]
    assert described[0]["attrs"]["warnings"] == described[1]["attrs"]["warnings"]


@pytest.mark.parametrize("texture", ["of a spectrum", "synthesised", "like a map"])
def test_a_path_is_the_same_at_every_speed(texture):
    """The run-in too, as far as both have one."""
    case, scale = as_case("rough.toml"), 1.0
    if texture == "of a spectrum":
        case, scale = as_case("wheel.toml"), 30.0
    if texture == "like a map":
        heights = 0.05e-6 * np.random.default_rng(1).standard_normal((100, 100))
        measured = gaussian_filter(heights, 4.0, mode="wrap")
        case = type(case)(**case.given() | {"surface": {"file": measured, "pixel": 20e-6}})
    speeds = [case.with_(speed=v * scale, settling=0.1) for v in (0.6, 1.3)]
    slow, fast = (prepare_case(each).textures for each in speeds)
    after, lead = slow.path.shape[0] - slow.before, fast.before - slow.before
    assert lead > 1000
    for one, other in zip(slow.maps, fast.maps, strict=True):
        assert np.array_equal(one.heights, other.heights)
    assert np.array_equal(slow.line, fast.line[lead : fast.before + after])
    assert np.array_equal(slow.path.rows(40, 2000), fast.path.rows(lead + 40, lead + 2000))


def test_processes_share_the_work_of_a_scan(tmp_path, monkeypatch):
    """As two threads with a store each, which know of each other by the folder alone."""
    monkeypatch.setattr("asperity.contact.scan.BLOCK", 8)
    dx, n = 5e-6, 15
    x = (np.arange(n) - n // 2) * dx
    body = (x[:, None] ** 2 + x[None, :] ** 2) / 6e-3
    heights = 0.02e-6 * np.random.default_rng(1).standard_normal((300, n))
    job = ScanJob(HalfSpace((n, n), dx, 115e9), Rows(heights), body, np.array([0.0, 0.05e-6]), device=None)
    solved, solve, together = [], ScanJob.solve, threading.Barrier(2, timeout=30)

    def counted(self, rows, *more):
        solved.append(threading.get_ident())
        if len(solved) <= 2:  # both are at work
            together.wait()
        return solve(self, rows, *more)

    monkeypatch.setattr(ScanJob, "solve", counted)
    with ThreadPoolExecutor(2) as pool:
        stores = [Store(tmp_path / "both"), Store(tmp_path / "both")]
        found = list(pool.map(lambda store: scan_forces(job, cache=store, workers=1), stores))
    assert len(solved) == len(job.starts)
    assert len(set(solved)) == 2
    assert np.array_equal(found[0].forces, found[1].forces)
    monkeypatch.setattr(ScanJob, "solve", solve)
    assert np.array_equal(found[0].forces, scan_forces(job, workers=1).forces)


def test_brief_results_lack_what_a_report_shows_and_nothing_else():
    whole, brief = run("wheel.toml"), run("wheel.toml", brief=True)
    names = [{f"{n.path}/{v}" for n in tree.subtree for v in n.data_vars} for tree in (whole, brief)]
    missing = names[0] - names[1]
    assert "/surface/psd_path" in missing
    assert all(name.startswith("/surface/") for name in missing)
    for group in ("rolling", "spectra", "contact", "pass_by", "track"):
        assert brief[group].to_dataset().equals(whole[group].to_dataset())
