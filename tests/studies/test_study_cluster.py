"""Studies on a real Dask cluster of two worker processes, one of which is killed half-way."""

import json
import os
import signal
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
import xarray
from click.testing import CliRunner

import asperity
from asperity.cli import main
from asperity.errors import InputError
from asperity.studies.cluster import cluster

BALL = """
kind = "ball-on-beam"
duration = "0.1 s"
laws = ["hertz", "linear"]
[surface]
spectrum = "iso3095"
"""
SWEEP = {"ball.load": ["5 N", "6 N"], "seed": list(range(1, 8))}


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory):
    """Address of the scheduler of two workers, each a process with one thread and a store of their own."""
    distributed = pytest.importorskip("distributed", reason='needs pip install "asperity[cluster]"')
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ASPERITY_CACHE", str(tmp_path_factory.mktemp("workers")))
        with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as workers:
            yield workers.scheduler_address


@pytest.fixture(autouse=True)
def own_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("ASPERITY_CACHE", str(tmp_path / "cache"))
    Path("ball.toml").write_text(BALL)


def test_a_study_survives_a_killed_worker(scheduler, monkeypatch):
    from distributed import Client

    with Client(scheduler) as client:
        workers = sorted(client.run(os.getpid).values())
    assert len(set(workers)) == 2
    calls, killed = [], []

    def kill_half_way(done, total, message):
        calls.append(done)
        if done >= total // 3 and not killed:
            os.kill(workers[0], signal.SIGKILL)
            killed.append(done)

    with cluster(scheduler) as executor:
        table = asperity.study("ball.toml", SWEEP, executor=executor, progress=kill_half_way)
        assert workers[0] not in client_processes(scheduler)
    assert killed
    assert killed[0] < 14
    assert calls == list(range(15))
    assert table["completed"].all()
    monkeypatch.setenv("ASPERITY_CACHE", "local")
    with ThreadPoolExecutor(1) as here:
        xarray.testing.assert_identical(table, asperity.study("ball.toml", SWEEP, executor=here))


def client_processes(scheduler):
    from distributed import Client

    with Client(scheduler) as client:
        return set(client.run(os.getpid).values())


def test_the_command_line_computes_on_a_cluster(scheduler):
    Path("study.toml").write_text('case = "ball.toml"\n[sweep]\nseed = [1, 2]\nstart = ["0 m", "0.95 m"]\n')
    arguments = ["study", "study.toml", "-o", "out", "--scheduler", scheduler]
    outcome = CliRunner().invoke(main, arguments)
    assert outcome.exit_code == 0, outcome.output
    assert "Failed (2 of 4 members): duration: received 0.1 s, which ends at 1.05 m" in outcome.stderr
    with xarray.open_dataset("out/study.nc", engine="h5netcdf") as table:
        assert table["completed"].values.tolist() == [[1, 0], [1, 0]]
        assert len(json.loads(table.attrs["failures"])) == 1


def test_a_scheduler_that_does_not_answer(monkeypatch):
    pytest.importorskip("distributed", reason='needs pip install "asperity[cluster]"')
    monkeypatch.setattr("asperity.studies.cluster.PATIENCE", 1.0)
    with pytest.raises(InputError, match=r"scheduler: received 'tcp://127.0.0.1:1' .*dask scheduler"):
        cluster("tcp://127.0.0.1:1").__enter__()
    with pytest.raises(InputError, match="scheduler: received 'nowhere at all'"):
        cluster("nowhere at all").__enter__()


def test_a_cluster_needs_its_package(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError, match=r'pip install "asperity\[cluster\]"'):
        cluster("tcp://127.0.0.1:1").__enter__()


def test_members_on_a_cluster_have_the_digits_of_this_process(scheduler, monkeypatch):
    """They share the scan of the path, whichever worker solves a block of it."""
    table = BALL.replace('["hertz", "linear"]', '["table", "linear"]').replace('"0.1 s"', '"20 ms"')
    table = table.replace('spectrum = "iso3095"', 'rms = "0.05 um"\nlongest = "0.4 mm"\nshortest = "60 um"')
    table += '[contact]\nspacing = "20 um"\nwindow = "0.66 mm"\nsamples = 2\nsample_length = "1.4 mm"\n'
    Path("rough.toml").write_text(f'start = "0.5 m"\n{table}[ball]\nload = "30 N"\n')
    sweep = {"ball.load": ["25 N", "30 N", "40 N"]}
    with cluster(scheduler) as executor:
        there = asperity.study("rough.toml", sweep, executor=executor)
    with ThreadPoolExecutor(1) as executor:
        monkeypatch.setenv("ASPERITY_CACHE", str(Path("another").absolute()))
        here = asperity.study("rough.toml", sweep, executor=executor)
    assert int(here["completed"].sum()) == 3
    assert there.equals(here)
