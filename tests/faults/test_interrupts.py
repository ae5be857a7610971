"""Interrupts and kills at any moment: all that is written is whole, and the next run ends as ever."""

import itertools
import os
import random
import signal
import sys
import time

import pytest
from program import CASE, LONG, RUN, ended, goes_on, left, outcome, prepared, program, promised, same

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="processes are ended by signals")

STUDIES = ("study", "study.toml")
STUDY = 'case = "case.toml"\n[sweep]\nseed = [1, 2, 3]\n'
AT_A_WRITE = """
import itertools, os
from asperity import files
replace, numbers = os.replace, itertools.count(1)

def killed(part, path):
    if next(numbers) != {number}:
        return replace(part, path)
    if "{when}" == "after":
        replace(part, path)
    os.kill(os.getpid(), 9)

files.os.replace = killed
from asperity.__main__ import start
start()
"""
AT_A_START = """
import multiprocessing.util as util
import os, signal, threading, time

spawn = util.spawnv_passfds
other = threading.Thread(target=time.sleep, args=(60.0,), daemon=True)
other.start()

def interrupted(path, words, *more):
    number = spawn(path, words, *more)
    if b"spawn_main" in os.fsencode(words[-2]):
        signal.pthread_kill(other.ident, signal.SIGINT)
        time.sleep(0.01)
    return number

util.spawnv_passfds = interrupted
from asperity.__main__ import start
start()
"""
WHEN_IT_LISTENS = """
import asperity.__main__ as program
from contextlib import contextmanager
interruptible = program.interruptible

@contextmanager
def told():
    with interruptible():
        print("listens", flush=True)
        yield

program.interruptible = told
program.start()
"""
"""Says when signals are heard: before, Python itself has no words for an interrupt."""
KILLED = [(n, when) for n in range(1, 26) for when in ("before", "after")]


@pytest.mark.parametrize(("number", "when"), KILLED if LONG else [(1, "after"), (5, "before")])
def test_a_run_killed_at_a_write_goes_on(undisturbed, tmp_path, number, when):
    folder = prepared(tmp_path / "run")
    code, told = ended(program(folder, *RUN, code=AT_A_WRITE.format(number=number, when=when)))
    assert code == -signal.SIGKILL or number > 5, told
    goes_on(folder, undisturbed / "out")


@pytest.mark.parametrize("seed", range(40) if LONG else [pytest.param(0, marks=pytest.mark.long)])
def test_a_run_killed_at_any_moment_goes_on(undisturbed, tmp_path, seed):
    folder = prepared(tmp_path / "run")
    killed = program(folder, *RUN)
    time.sleep(random.Random(seed).uniform(0.2, 4.0))
    killed.kill()
    ended(killed)
    goes_on(folder, undisturbed / "out")


NAMES = ["SIGINT", "SIGTERM", "SIGHUP"]
MOMENTS = [(("new", "study"), 0.0), (("check", "case.toml"), 0.2), (STUDIES, 0.0), (STUDIES, 0.7)]
EACH = list(itertools.product(NAMES, MOMENTS) if LONG else zip([*NAMES, NAMES[0]], MOMENTS, strict=True))


@pytest.mark.parametrize(("name", "moment"), EACH)
def test_every_interrupt_is_told_in_a_word(tmp_path, name, moment):
    folder, (words, delay) = prepared(tmp_path, study=STUDY), moment
    for later in [0.02 * n for n in range(40)] if LONG else [0.0]:
        started = program(folder, *words, code=WHEN_IT_LISTENS, start_new_session=True)
        assert started.stdout.readline() == "listens\n"
        time.sleep(delay + later)
        os.killpg(started.pid, getattr(signal, name))
        code, told = promised(*ended(started))
        assert code in (0, 130)
        assert code == 0 or "interrupted" in told
    assert left(folder) == []


def test_an_interrupt_while_a_process_starts_waits_for_it(tmp_path):
    """It may fall to any thread, whichever signals the one that starts processes lets wait."""
    folder = prepared(tmp_path, study=STUDY)
    code, told = outcome(folder, *STUDIES, code=AT_A_START)
    assert code == 130
    assert "interrupted" in told


@pytest.mark.long
def test_runs_beside_each_other_are_the_same(undisturbed, tmp_path):
    folder = prepared(tmp_path / "beside")
    outs = [f"out{n}" for n in range(8 if LONG else 2)]
    started = [program(folder, "run", "case.toml", "-o", out, "--no-report") for out in outs]
    for out, process in zip(outs, started, strict=True):
        code, told = ended(process)
        assert code == 0, told
        same(undisturbed / "out", folder / out)
    assert left(folder) == []


def test_of_two_runs_in_one_folder_one_is_refused(tmp_path):
    folder = prepared(tmp_path, other=CASE.replace("5 N", "6 N"))
    started = [program(folder, RUN[0], f"{name}.toml", *RUN[2:]) for name in ("case", "other")]
    found = sorted(ended(process) for process in started)
    assert [code for code, _ in found] == [0, 2], found
    refused = found[1][1]
    assert "another run is writing" in refused or "the run of another case" in refused
    assert left(folder) == []
