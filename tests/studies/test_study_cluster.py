"""Studies on a real Dask cluster of two worker processes, one of which is killed half-way."""

import json
import os
import signal
import sys
from pathlib import Path

import pytest
import xarray
from executors import ROUGH, Here

import asperity
from asperity.errors import InputError
from asperity.studies.cluster import cluster
from command_line import call


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory):
    """Address of the scheduler of two workers, each a process with one thread and a store of their own."""
    distributed = pytest.importorskip("distributed", reason='needs pip install "asperity[cluster]"')
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ASPERITY_CACHE", str(tmp_path_factory.mktemp("workers")))
        with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as workers:
            yield workers.scheduler_address


def workers_of(scheduler):
    from distributed import Client

    with Client(scheduler) as client:
        return set(client.run(os.getpid).values())


@pytest.mark.long
def test_a_study_survives_a_killed_worker(scheduler, monkeypatch):
    """Members share the scan of the path, whichever worker solves a block, and have the digits of here."""
    Path("rough.toml").write_text(ROUGH.with_(duration="8 ms").to_toml())
    sweep = {"ball.load": "20..40 N, 6 steps"}
    (first, _), calls = sorted(workers_of(scheduler)), []

    def kill_half_way(done, total, message):
        calls.append(done)
        if done == 2:
            os.kill(first, signal.SIGKILL)

    with cluster(scheduler) as executor:
        there = asperity.study("rough.toml", sweep, executor=executor, progress=kill_half_way)
        assert first not in workers_of(scheduler)
    assert calls == list(range(7))
    assert there["completed"].all()
    monkeypatch.setenv("ASPERITY_CACHE", "local")
    xarray.testing.assert_identical(there, asperity.study("rough.toml", sweep, executor=Here()))


@pytest.mark.long
def test_the_command_line_computes_on_a_cluster(scheduler):
    Path("study.toml").write_text('case = "ball.toml"\n[sweep]\nseed = [1, 2]\nstart = ["0 m", "0.99 m"]\n')
    said = call("study", "study.toml", "-o", "out", "--scheduler", scheduler).stderr
    assert "Failed (2 of 4 members): duration: received 0.02 s, which ends at 1.01 m" in said
    with xarray.open_dataset("out/study.nc", engine="h5netcdf") as table:
        assert table["completed"].values.tolist() == [[1, 0], [1, 0]]
        assert len(json.loads(table.attrs["failures"])) == 1


def test_a_cluster_needs_its_package(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError, match=r'pip install "asperity\[cluster\]"'):
        cluster("tcp://127.0.0.1:1").__enter__()
