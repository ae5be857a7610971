"""A Dask scheduler that dies or hangs, or is not there, ends a study in time and in a sentence."""

import json
import os
import re
import signal
import subprocess
import sys
import time

import pytest

pytest.importorskip("distributed", reason='needs pip install "asperity[cluster]"')
posix = pytest.mark.skipif(sys.platform == "win32", reason="processes are stopped by signals")

BALL = 'kind = "ball-on-beam"\nduration = "0.1 s"\nlaws = ["hertz"]\n[surface]\nspectrum = "iso3095"\n'
STUDY = 'case = "ball.toml"\n[sweep]\nseed = [1, 2, 3, 4, 5, 6, 7, 8]\nstart = ["0 m", "0.9 m"]\n'
IMPATIENT = (
    "from asperity.studies import cluster, running\n"
    "cluster.PATIENCE, cluster.SILENCE, running.BEAT = 2.0, 4.0, 1.0\n"
    "from asperity.__main__ import start\n"
    "start()"
)


@pytest.fixture
def served(tmp_path):
    """A scheduler and a worker, each a process."""
    environment = os.environ | {"ASPERITY_CACHE": str(tmp_path / "far"), "ASPERITY_THREADS": "1"}
    file = tmp_path / "scheduler.json"
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "env": environment}
    dask = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--no-dashboard", "--port", "0"]
    scheduler = subprocess.Popen([*dask, "--host", "127.0.0.1", "--scheduler-file", str(file)], **quiet)
    dask = [sys.executable, "-m", "distributed.cli.dask_worker", "--scheduler-file", str(file)]
    worker = subprocess.Popen(
        [*dask, "--nthreads", "1", "--no-nanny", "--no-dashboard", "--death-timeout", "60"], **quiet
    )
    until = time.monotonic() + 60
    while not file.exists() and time.monotonic() < until:
        time.sleep(0.1)
    yield scheduler, file
    for process in (scheduler, worker):
        process.kill()
        process.wait()


def study(folder, address, **more):
    (folder / "ball.toml").write_text(BALL)
    (folder / "study.toml").write_text(STUDY)
    return subprocess.Popen(
        [sys.executable, "-c", IMPATIENT, "study", "study.toml", "--scheduler", address],
        cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        env=os.environ | {"ASPERITY_CACHE": str(folder / "near")}, **more,
    )  # fmt: skip


def address_in(file):
    return json.loads(file.read_text())["address"]


@posix
@pytest.mark.parametrize("end", [signal.SIGKILL, signal.SIGSTOP], ids=["dies", "hangs"])
def test_a_scheduler_that_is_lost_half_way(served, tmp_path, end):
    scheduler, file = served
    with study(tmp_path, address_in(file)) as running:
        until = time.monotonic() + 90
        while not list((tmp_path / "near").glob("*.npz")) and time.monotonic() < until:
            time.sleep(0.05)
        scheduler.send_signal(end)
        try:
            _, told = running.communicate(timeout=60)
        finally:
            running.kill()
    assert running.returncode == 3, told
    assert "the scheduler has not answered for" in told
    ended = int(re.search(r"; (\d+) of 16 members had ended and are kept", told)[1])
    assert 0 < ended == len(list((tmp_path / "near").glob("*.npz")))
    assert "Traceback" not in told
    assert len(told) < 2000
    assert not [path for path in (tmp_path / "runs").rglob("*") if path.is_file()]


@pytest.mark.parametrize(
    "address", ["tcp://127.0.0.1:9", "tcp://127.0.0.1:99999999", "tls://127.0.0.1:9", "x"]
)
def test_an_address_where_nobody_is(tmp_path, address):
    with study(tmp_path, address) as running:
        _, told = running.communicate(timeout=60)
    assert running.returncode == 2
    assert f"scheduler: received '{address}'" in told
    assert "Traceback" not in told
