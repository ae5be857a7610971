"""Kernels are compiled before the work, the contact by a second process."""

import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

from asperity.case.cases import as_case
from asperity.contact import pressed_once
from asperity.kernels import scanning
from asperity.scenarios import compiling
from small_cases import COARSE


@pytest.fixture
def started(monkeypatch):
    """Second processes, which do nothing until they are killed; none is needed for what is on disk."""
    found, popen = [], subprocess.Popen

    def idle(command, **options):
        found.append(popen([command[0], "-c", "input()"], **options))
        found[-1].told = command[-1]
        return found[-1]

    monkeypatch.setattr(compiling.subprocess, "Popen", idle)
    monkeypatch.setattr(compiling, "processors", lambda: 2)
    monkeypatch.setattr(compiling, "is_kept", lambda function: False)
    return found


def test_a_second_process_runs_while_it_is_needed_and_is_waited_for(started, monkeypatch):
    with compiling._contact_compiled_beside(("whole",)) as process:
        assert started == [process]
        assert process.poll() is None
    assert process.poll() is not None
    monkeypatch.setattr(compiling, "PATIENCE", 0.01)
    told, pressed, half_space = [], [], pressed_once.HalfSpace
    look = lambda *given, cells: pressed.append(cells) or half_space(*given, cells=cells)  # noqa: E731
    monkeypatch.setattr(pressed_once, "HalfSpace", look)
    pressed_once.press_once.cache_clear()
    compiling.compile_kernels(lambda *report: told.append(report), "whole", "covered")  # not for ever
    assert pressed == ["whole", "covered"]
    assert "press_once(*('whole', 'covered'))" in started[1].told
    assert started[1].poll() is not None
    assert [told[0], told[-1]] == [(done, 2, "compiled functions") for done in (0, 2)]
    with pytest.raises(KeyboardInterrupt), compiling._contact_compiled_beside(("whole",)):
        raise KeyboardInterrupt
    assert started[2].poll() is not None


def test_the_second_process_starts_before_a_case_is_laid_out_where_its_cells_are_known(started, monkeypatch):
    monkeypatch.setattr(compiling, "PATIENCE", 0.01)
    covered = {"contact": COARSE["contact"] | {"rim_cells": "covered"}, "laws": ["table"]}
    for keys in (covered, {"laws": ["hertz"]}):
        case = as_case(COARSE | keys)
        with compiling.compiled_ahead(case):
            (ahead,) = started
            assert f"press_once(*{case.cells_at_rims!r})" in ahead.told
            compiling.compile_kernels(lambda *_: None, *case.cells_at_rims)
            assert started == [ahead]
            assert ahead.poll() is None  # until the case was run
        assert ahead.poll() is not None
        started.clear()
    for case in (
        COARSE | {"laws": ["table"]},
        {"kind": "ball-bearing", "bearing": {"name": "6205"}, "radial": 100.0},
    ):
        with compiling.compiled_ahead(as_case(case)):
            assert not started


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("processors", lambda: 1),
        ("is_kept", lambda function: function == compiling.CONTACT),
        ("sys.executable", ""),
    ],
)
def test_there_is_none_where_it_is_of_no_use_or_cannot_be_started(started, monkeypatch, name, value):
    monkeypatch.setattr(f"asperity.scenarios.compiling.{name}", value)
    with compiling._contact_compiled_beside(("whole",)) as other:
        assert other is None


def test_the_second_process_is_told_what_exists():
    """Its errors are seen by nobody."""
    command = [sys.executable, "-c", compiling.BESIDE.format(("whole",))]
    with subprocess.Popen(command, stdin=subprocess.PIPE) as other:
        assert other.wait() == 0
    assert f"{scanning.__name__}.{scanning.solve_positions.__name__}" == compiling.CONTACT


STARTED = """
import time
from asperity.scenarios import compiling
compiling.BESIDE = compiling.BESIDE.partition("from asperity.contact")[0] + "import time; time.sleep(600)"
compiling.processors, compiling.is_kept = lambda: 2, lambda function: False
with compiling._contact_compiled_beside(("whole",)) as other:
    print(other.pid, flush=True)
    time.sleep(600)
"""


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="there is nowhere to look")
def test_no_process_compiles_on_after_the_first_was_killed():
    with subprocess.Popen([sys.executable, "-c", STARTED], stdout=subprocess.PIPE, text=True) as first:
        other = Path("/proc", first.stdout.readline().strip(), "stat")
        assert other.exists()
        first.kill()
    begun = time.monotonic()
    with suppress(OSError):  # it is gone
        while " Z " not in other.read_text():  # nor that, where nobody waits for it
            assert time.monotonic() < begun + 60.0
            time.sleep(0.01)


def test_time_is_told_once_of_what_both_kinds_of_cells_share(monkeypatch):
    told = compiling.time_to_compile
    monkeypatch.setattr(compiling, "is_kept", lambda kernel: False)
    shared = told("whole") + told("covered") - told("whole", "covered")
    assert shared == compiling.ROLLING_TIME + compiling.CONTACT_TIME < told("whole") < told("covered")
    monkeypatch.setattr(compiling, "is_kept", lambda kernel: kernel == compiling.CONTACT)
    assert told("whole", "covered") == compiling.ROLLING_TIME
