"""Members of a study share what they have in common, and have the digits that they have alone."""

import json
import threading
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

import asperity
from asperity.case.cases import as_case
from asperity.contact import HalfSpace
from asperity.contact.scan import ScanJob, scan_forces
from asperity.running import prepare_case, run
from asperity.store import Store
from asperity.studies.definition import study_of
from asperity.studies.member import kept, packed
from asperity.surfaces.strip import Fields, LongStrip

WHEEL = """
kind = "wheel-on-rail"
laws = ["areal", "linear-filtered"]
duration = "60 ms"
settling = "20 ms"
[surface]
spectrum = "iso3095"
[wheel]
roughness = "disc"
[contact]
spacing = "1 mm"
window = "20 mm"
samples = 2
sample_length = "60 mm"
[numerics]
highest_frequency = "2 kHz"
poles = 40
"""
BALL = """
kind = "ball-on-beam"
laws = ["table", "areal", "linear-filtered"]
start = "0.5 m"
duration = "20 ms"
[surface]
rms = "0.05 um"
longest = "0.4 mm"
shortest = "60 um"
[contact]
spacing = "20 um"
window = "0.66 mm"
samples = 2
sample_length = "1.4 mm"
[numerics]
highest_frequency = "2 kHz"
"""
SPEEDS = ["21 m/s", "33 m/s"]
LOADS = ["45 kN", "65 kN", "90 kN"]


class Here(Executor):
    """Computes at once, in this process."""

    def submit(self, task, /, *arguments, **keywords):
        future = Future()
        future.set_result(task(*arguments, **keywords))
        return future


@pytest.fixture(autouse=True)
def own_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("ASPERITY_CACHE", str(tmp_path / "cache"))
    Path("wheel.toml").write_text(WHEEL)
    Path("ball.toml").write_text(BALL)


def toml(keys):
    return "".join(f"{key} = {json.dumps(value)}\n" for key, value in keys.items())


def scans():
    return {path.name for path in Store().files() if path.name.startswith("scan-")}


def test_all_speeds_and_loads_share_the_scans_of_one_run():
    asperity.run(as_case("wheel.toml").with_(speed=33.0, **{"wheel.load": 65e3}))
    of_one = scans()
    assert of_one
    sweep = {"speed": SPEEDS, "wheel.load": LOADS}
    table = asperity.study("wheel.toml", sweep, executor=Here())
    assert int(table["completed"].sum()) == 6
    assert scans() == of_one
    kernels = [path for path in Store().files() if path.name.startswith("moving-kernel-")]
    assert len(kernels) == len(SPEEDS)  # the response of the track under a moving contact


def test_loads_share_the_scan_of_a_path():
    asperity.run(as_case("ball.toml").with_(**{"ball.load": 30.0}))
    of_one = scans()
    asperity.study("ball.toml", {"ball.load": ["30 N", "25 N", "40 N"]}, executor=Here())
    assert scans() == of_one


def test_speeds_share_the_scan_of_a_path_but_for_its_ends():
    asperity.run(as_case("ball.toml").with_(speed=1.3))
    of_fastest = scans()
    asperity.study("ball.toml", {"speed": ["0.6 m/s", "0.9 m/s"]}, executor=Here())
    assert len(of_fastest) > 10
    assert len(scans() - of_fastest) <= 2 * 2  # first and last block of a shorter path


@pytest.mark.parametrize(
    ("case", "sweep"),
    [
        ("wheel.toml", {"speed": SPEEDS, "wheel.load": LOADS[:2]}),
        ("ball.toml", {"ball.load": ["30 N", "40 N"]}),
        ("ball.toml", {"speed": ["0.9 m/s", "1.3 m/s", "0.6 m/s"]}),
    ],
)
def test_a_member_has_the_digits_that_it_has_alone(case, sweep, tmp_path, monkeypatch):
    members = study_of(case, sweep).members()
    asperity.study(case, sweep, executor=Here())
    in_study = [Store().get(member.key) for member in members]
    monkeypatch.setenv("ASPERITY_CACHE", str(tmp_path / "another"))
    monkeypatch.setattr("asperity.surfaces.strip.fields", Fields())
    alone = packed(kept(run(members[-1].case)))
    found = in_study[-1]
    assert found.keys() == alone.keys()
    for name in found.keys() - {"__description__"}:
        assert np.array_equal(found[name], alone[name], equal_nan=found[name].dtype.kind == "f"), name
    described = [json.loads(str(each["__description__"])) for each in (found, alone)]
    assert described[0]["variables"] == described[1]["variables"]
    assert described[0]["attrs"]["warnings"] == described[1]["attrs"]["warnings"]


def test_a_track_is_the_same_at_every_speed():
    slow, fast = (prepare_case(as_case("wheel.toml").with_(speed=v)).textures for v in (21.0, 40.0))
    shared = slow.path.shape[0] - slow.before
    assert fast.before > slow.before
    for one, other in zip(slow.maps, fast.maps, strict=True):
        assert np.array_equal(one.heights, other.heights)
    assert np.array_equal(
        slow.path.rows(slow.before, slow.before + shared), fast.path.rows(fast.before, fast.before + shared)
    )
    assert np.array_equal(  # the run-in too, as far as both have one
        slow.line[: slow.before], fast.line[fast.before - slow.before : fast.before]
    )


@pytest.mark.parametrize("likeness", [False, True])
def test_the_path_of_a_ball_is_the_same_at_every_speed(likeness):
    case = as_case("ball.toml")
    if likeness:
        heights = 0.05e-6 * np.random.default_rng(1).standard_normal((100, 100))
        np.savez("map.npz", heights=gaussian_filter(heights, 4.0, mode="wrap"))
        measured = {"file": "map.npz", "height_unit": "m", "pixel": "20 um"}
        Path("measured.toml").write_text(
            BALL.replace(BALL[BALL.index("rms") : BALL.index("[contact]")], toml(measured))
        )
        case = as_case("measured.toml")
    slow, fast = (prepare_case(case.with_(speed=v)).textures for v in (0.6, 1.3))
    assert isinstance(slow.path, LongStrip)
    after, lead = slow.path.shape[0] - slow.before, fast.before - slow.before
    assert lead > 1000
    assert np.array_equal(slow.line, fast.line[lead : fast.before + after])
    assert np.array_equal(slow.path.rows(40, 2000), fast.path.rows(lead + 40, lead + 2000))


def test_processes_share_the_work_of_a_scan(tmp_path, monkeypatch):
    """As two threads with a store each, which know of each other by the folder alone."""
    monkeypatch.setattr("asperity.contact.scan.BLOCK", 8)
    dx, n = 5e-6, 15
    x = (np.arange(n) - n // 2) * dx
    body = (x[:, None] ** 2 + x[None, :] ** 2) / 6e-3
    heights = 0.02e-6 * np.random.default_rng(1).standard_normal((300, n))
    from asperity.surfaces.strip import Rows

    job = ScanJob(HalfSpace((n, n), dx, 115e9), Rows(heights), body, np.array([0.0, 0.05e-6]), device=None)
    solved, solve, together = [], ScanJob.solve, threading.Barrier(2, timeout=30)

    def counted(self, rows, planes):
        solved.append(threading.get_ident())
        if len(solved) <= 2:  # both are at work
            together.wait()
        return solve(self, rows, planes)

    monkeypatch.setattr(ScanJob, "solve", counted)
    with ThreadPoolExecutor(2) as pool:
        found = list(
            pool.map(lambda _: scan_forces(job, cache=Store(tmp_path / "both"), workers=1), range(2))
        )
    assert len(solved) == len(job.starts)
    assert len(set(solved)) == 2
    assert np.array_equal(found[0].forces, found[1].forces)
    monkeypatch.setattr(ScanJob, "solve", solve)
    assert np.array_equal(found[0].forces, scan_forces(job, workers=1).forces)


def test_brief_results_lack_what_a_report_shows_and_nothing_else():
    case = as_case("wheel.toml").with_(speed=33.0)
    whole, brief = run(case), run(case, brief=True)
    missing = {f"{n.path}/{v}" for n in whole.subtree for v in n.data_vars} - {
        f"{n.path}/{v}" for n in brief.subtree for v in n.data_vars
    }
    assert "/surface/psd_path" in missing
    assert all(name.startswith("/surface/") for name in missing)
    for group in ("rolling", "spectra", "contact", "pass_by", "track"):
        assert brief[group].to_dataset().equals(whole[group].to_dataset())
