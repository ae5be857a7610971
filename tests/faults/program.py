"""The program as a user starts it, in a folder of its own."""

import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pytest
import xarray
from click.testing import CliRunner

from asperity.cli import main
from asperity.results import read_result

LONG = os.environ.get("ASPERITY_FAULTS") == "long"
"""Whether to take the time that a thorough search needs: ``ASPERITY_FAULTS=long pytest tests/faults``."""
START = "from asperity.__main__ import start; start()"
RUN = ("run", "case.toml", "-o", "out", "--no-report")
CASE = """
kind = "ball-on-beam"
duration = "10 ms"
settling = "5 ms"
laws = ["hertz", "table"]
[surface]
rms = "0.1 um"
longest = "0.2 mm"
shortest = "40 um"
[contact]
samples = 1
sample_length = "2 mm"
spacing = "20 um"
[ball]
load = "5 N"
[numerics]
highest_frequency = "2 kHz"
"""
"""A case of a second, with kept blocks."""


def program(folder, *words, code=START, env=(), **more):
    """Start the program; its cache lies beside its results."""
    environment = os.environ | {"ASPERITY_CACHE": str(folder / "cache")} | dict(env)
    environment.pop("COVERAGE_PROCESS_CONFIG", None)  # what measures it breaks by signals and full disks
    return subprocess.Popen(
        [sys.executable, "-X", "faulthandler", "-c", code, *words],
        cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment, **more,
    )  # fmt: skip


def ended(process, timeout=300):
    """Wait for it; return its exit code and all it said."""
    out, err = process.communicate(timeout=timeout)
    return process.returncode, out + err


def promised(code, told):
    """Whatever happens, the program ends with one of its exit codes and without a traceback."""
    assert code in (0, 2, 3, 130), told
    assert "Traceback" not in told, told
    assert "the program failed" not in told, told
    assert code not in (2, 3) or "Error: " in told
    return code, told


def outcome(folder, *words, **more):
    """Let the program run to its end, as it promises; return its exit code and all it said."""
    return promised(*ended(program(folder, *words, **more)))


def prepared(folder, **files):
    """Make the folder and write a case into it, and what else is given, by name without ``.toml``."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in ({"case": CASE} | files).items():
        (folder / f"{name}.toml").write_text(text)
    return folder


def left(folder):
    """What no finished write leaves in a folder and below."""
    return [path for path in Path(folder).rglob(".*") if path.is_file() or path.suffix == ".part"]


def same(first, second):
    """Whether two runs are the same to the last bit."""
    one, other = read_result(first), read_result(second)
    xarray.testing.assert_equal(one, other)
    for name in ("case", "verdict", "warnings"):
        assert one.attrs[name] == other.attrs[name]


def here(folder, *words, env=()):
    """The same in this process, a second sooner; its cache lies beside its results."""
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for name, value in {"ASPERITY_CACHE": str(folder / "cache"), **dict(env)}.items():
            patch.setenv(name, value)
        done = CliRunner().invoke(main, words)
    assert isinstance(done.exception, SystemExit | None), done.exception
    return promised(done.exit_code, done.output)


def finished(folder):
    """Let the command run to its end in this process."""
    code, told = here(folder, *RUN)
    assert code == 0, told


def goes_on(folder, whole):
    """The same command again ends as a run does that nothing disturbs, and leaves nothing behind."""
    finished(folder)
    same(whole, folder / "out")
    assert left(folder) == []


@contextmanager
def in_time(seconds):
    """Fail where work hangs."""

    def late(number, frame):
        raise TimeoutError(f"more than {seconds} s")

    if not hasattr(signal, "setitimer"):
        yield
        return
    before = signal.signal(signal.SIGALRM, late)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def until(there, seconds=90):
    """Wait for something to be there."""
    last = time.monotonic() + seconds
    while not there():
        assert time.monotonic() < last, "it never came"
        time.sleep(0.05)
