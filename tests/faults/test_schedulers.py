"""A Dask scheduler that dies or hangs, or is not there, ends a study in time and in a sentence."""

import json
import os
import re
import signal
import subprocess
import sys

import pytest
from program import ended, prepared, program, promised, until

from asperity.errors import InputError
from asperity.studies import cluster

pytest.importorskip("distributed", reason='needs pip install "asperity[cluster]"')
posix = pytest.mark.skipif(sys.platform == "win32", reason="processes are stopped by signals")

BALL = 'kind = "ball-on-beam"\nduration = "0.1 s"\nlaws = ["hertz"]\n[surface]\nspectrum = "iso3095"\n'
STUDY = 'case = "case.toml"\n[sweep]\nseed = [1, 2, 3, 4, 5, 6, 7, 8]\nstart = ["0 m", "0.9 m"]\n'
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
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "env": environment}
    file, dask = tmp_path / "scheduler.json", f"{sys.executable} -m distributed.cli.dask_"
    own = "scheduler --port 0 --host 127.0.0.1", "worker --nthreads 1 --no-nanny --death-timeout 60"
    where = ["--no-dashboard", "--scheduler-file", str(file)]
    started = [subprocess.Popen([*f"{dask}{words}".split(), *where], **quiet) for words in own]
    until(file.exists)
    yield started[0], json.loads(file.read_text())["address"]
    for process in started:
        process.kill()
        process.wait()


def study(folder, address):
    folder = prepared(folder, case=BALL, study=STUDY)
    return program(folder, "study", "study.toml", "--scheduler", address, code=IMPATIENT)


@pytest.mark.long
@posix
@pytest.mark.parametrize("end", [signal.SIGKILL, signal.SIGSTOP], ids=["dies", "hangs"])
def test_a_scheduler_that_is_lost_half_way(served, tmp_path, end):
    scheduler, address = served
    with study(tmp_path, address) as running:
        until(lambda: list((tmp_path / "cache").glob("*.npz")))
        scheduler.send_signal(end)
        code, told = promised(*ended(running, timeout=60))
    assert code == 3, told
    assert "the scheduler has not answered for" in told
    count = int(re.search(r"; (\d+) of 16 members had ended and are kept", told)[1])
    assert 0 < count == len(list((tmp_path / "cache").glob("*.npz")))
    assert len(told) < 2000
    assert not [path for path in (tmp_path / "runs").rglob("*") if path.is_file()]


@pytest.mark.parametrize(
    "address", ["tcp://127.0.0.1:9", "tcp://127.0.0.1:99999999", "tls://127.0.0.1:9", "nowhere at all"]
)
def test_an_address_where_nobody_is(monkeypatch, address):
    monkeypatch.setattr(cluster, "PATIENCE", 0.2)
    with pytest.raises(InputError, match=rf"^scheduler: received '{address}' .*'dask scheduler'"):
        cluster.cluster(address).__enter__()
