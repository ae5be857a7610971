"""What once failed, replayed by the program: each ends in time, with its exit code and one message."""

import json
import os
import re
import signal
import subprocess
import sys
from threading import Timer

import numpy as np
import pytest
from corpus import ABSURD, CIRCLES, CORPUS
from program import LONG, ended, left, program, promised

import asperity
from asperity.errors import InputError
from asperity.files import atomic_write
from asperity.interrupts import interruptible
from asperity.sandbox import sandboxed

SECONDS = 30
"""Of processor time that no failure takes."""
FORKS = f"""
import json, os, signal, sys
import asperity.cli, asperity.case.cases, asperity.studies.definition, asperity.surfaces.readers
from asperity.__main__ import start
for line in sys.stdin:
    folder, words = json.loads(line)
    child = os.fork()
    if child == 0:
        os.chdir(folder)
        told = os.open("told", os.O_CREAT | os.O_WRONLY)
        os.dup2(told, 1), os.dup2(told, 2)
        signal.setitimer(signal.ITIMER_PROF, {SECONDS})
        signal.alarm(10 * {SECONDS})
        sys.argv[1:] = words
        code = 1
        try:
            start()
        except SystemExit as end:
            code = end.code or 0
        finally:
            os._exit(code)
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)
"""
"""Starts the program as often as it is told to, by forks: it imports its modules once."""


@pytest.fixture(scope="module")
def forks(tmp_path_factory):
    cache = str(tmp_path_factory.mktemp("cache"))
    with subprocess.Popen(
        [sys.executable, "-c", FORKS], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        env=os.environ | {"ASPERITY_CACHE": cache},
    ) as server:  # fmt: skip
        yield server
        server.stdin.close()


@pytest.fixture
def replay(tmp_path, request):
    """Let the program run in a folder with these files; returns its exit code and all it said."""

    def replay(words, files):
        for file, contents in files.items():
            (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / file).write_bytes(contents if isinstance(contents, bytes) else contents.encode())
        if LONG or not hasattr(os, "fork"):
            return ended(program(tmp_path, *words), timeout=10 * SECONDS)
        server = request.getfixturevalue("forks")
        server.stdin.write(json.dumps([str(tmp_path), words]) + "\n")
        server.stdin.flush()
        return int(server.stdout.readline()), (tmp_path / "told").read_text()

    return replay


@pytest.mark.parametrize("name", CORPUS)
def test_what_once_failed(name, tmp_path, replay):
    words, code, says, files = CORPUS[name]
    found, told = replay(words, files)
    promised(found, told)
    assert found == code
    assert re.search(says, told), told
    assert len(told) < (2000 if code else 20_000)
    assert "\x1b" not in told
    assert left(tmp_path) == []


@pytest.fixture
def circles(tmp_path, monkeypatch):
    """A file in which HDF5 turns in circles, with a seal that fits; opened as the program does."""
    monkeypatch.setattr("asperity.results.sandboxed", sandboxed)
    return atomic_write(tmp_path / "run.nc", lambda file: file.write(CIRCLES), sealed=True)


@pytest.mark.parametrize("read", [asperity.open_result, asperity.read_surface])
def test_a_library_that_turns_in_circles(circles, monkeypatch, read):
    """The process ends by itself, or beside other work by the patience of this one: both say the same."""
    monkeypatch.setattr("asperity.sandbox.SECONDS", 0.9)
    with pytest.raises(InputError, match=r"a file that takes more than 1 s to open"):
        read(circles)


@pytest.mark.skipif(sys.platform == "win32", reason="there are no such signals")
def test_a_right_seal_around_a_hostile_file_leaves_the_program_free_to_end(circles):
    with interruptible():
        Timer(1.0, os.kill, (os.getpid(), signal.SIGTERM)).start()
        with pytest.raises(KeyboardInterrupt):
            asperity.open_result(circles)


@pytest.mark.parametrize("name", ABSURD)
def test_absurd_bodies_press_no_more_than_their_load(name, tmp_path, replay):
    text, load, largest, files = ABSURD[name]
    found, told = replay(("run", "case.toml", "-o", "out", "--no-report"), files | {"case.toml": text})
    promised(found, told)
    assert found == 0, told
    force = asperity.open_result(tmp_path / "out")["rolling/contact_force"].values
    assert np.isfinite(force).all()
    assert force.max() < largest * load
    assert force.mean() == pytest.approx(load, rel=0.02)
