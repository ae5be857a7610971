"""Compilation ahead of the work: what is left of it is told, and a second process takes its share."""

import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

from asperity import progress as telling
from asperity.kernels import kept, scanning
from asperity.kernels.census import Census, instructions
from asperity.scenarios import compiling, second_process

KERNELS = "asperity.kernels"


@pytest.fixture
def contact():
    return Census((scanning.solve_positions,))


def test_the_census_follows_the_calls(contact):
    assert f"{KERNELS}.scanning.solve_positions" in contact.sizes
    assert f"{KERNELS}.fourier.transform" in contact.sizes  # through three others
    assert f"{KERNELS}.contact.solve_contact" not in contact.sizes  # a part of the first
    assert f"{KERNELS}.modal.roll_beam" not in contact.sizes
    assert instructions(scanning.solve_positions) == max(contact.sizes.values())


def test_what_is_done_is_what_lies_in_the_folders(contact, tmp_path, monkeypatch):
    monkeypatch.setattr(kept, "_COMPILED", set())
    monkeypatch.setattr(kept, "folders", lambda: iter([tmp_path]))
    assert contact.done() == 0.0
    (tmp_path / kept.SOURCES).mkdir()
    for name in contact.sizes:
        (tmp_path / kept.SOURCES / f"{name}-0123456789ab").touch()
    assert contact.done() == pytest.approx(1.0)


class Machine:
    """A clock, and a compiler that gets ready, then works kernels off, so many times slower than another."""

    def __init__(self, monkeypatch, slowness, kernels):
        self.now, self.slowness, self.sizes = 100.0, slowness, kernels
        self.there = set()
        monkeypatch.setattr(telling.time, "monotonic", lambda: self.now)
        monkeypatch.setattr(kept, "_COMPILED", self.there)
        monkeypatch.setattr(kept, "folders", lambda: iter([]))

    def compile_all(self, hear):
        """Compile in the order of the calls; each takes what goes with its instructions, give or take."""
        hear()
        self.now += 0.07 * self.slowness
        for number, (name, size) in enumerate(reversed(self.sizes.items())):
            self.now += 0.93 * self.slowness * (0.7, 1.3)[number % 2] * size / sum(self.sizes.values())
            self.there.add(name)
            hear()


@pytest.mark.parametrize("slowness", [5.0, 20.0, 80.0])
def test_the_time_left_is_right_within_a_third_on_a_slow_machine_too(contact, slowness, monkeypatch):
    machine = Machine(monkeypatch, slowness, contact.sizes)
    monkeypatch.setattr(telling, "COMPILATION", telling.Compilation())
    told, pace = [], None

    def progress(done, total, message):
        nonlocal pace
        pace = pace or telling.Pace(message, done)
        pace.report(done)
        if pace.told(total):
            told.append((machine.now, machine.now + pace.left(total)))

    tell = compiling.Telling(progress, ())
    tell.census = contact
    telling.COMPILATION.begin("all of them")
    begun = machine.now
    machine.compile_all(tell)
    taken = machine.now - begun
    assert told[0][0] < begun + 0.5 * taken  # early enough to be of use
    for _, expected in told:
        assert expected - begun == pytest.approx(taken, rel=1 / 3)


def test_what_was_there_before_counts_for_no_rate(contact, monkeypatch):
    told = []
    tell = compiling.Telling(lambda *done: told.append(done), ())
    tell.census, tell.before = contact, 0.5
    monkeypatch.setattr(compiling, "INTERVAL", 0.0)
    for share in (0.5, 0.75, 1.0):
        monkeypatch.setattr(contact, "done", lambda share=share: share)
        tell()
    assert [done for done, _, _ in told] == [0, 53, 100]


@pytest.fixture
def started(monkeypatch):
    """Second processes, which do nothing until they are killed; none is needed for what is on disk."""
    found = []

    def popen(command, **options):
        found.append(subprocess_popen([command[0], "-c", "input()"], **options))
        return found[-1]

    subprocess_popen = subprocess.Popen
    monkeypatch.setattr(second_process.subprocess, "Popen", popen)
    monkeypatch.setattr(second_process, "processors", lambda: 2)
    monkeypatch.setattr(second_process, "is_kept", lambda function: False)
    return found


def test_one_second_process_runs_while_it_is_needed(started):
    with second_process.contact_compiled_beside(), second_process.contact_compiled_beside():
        (process,) = started
        assert process.poll() is None
    assert process.poll() is not None
    with second_process.contact_compiled_beside():
        assert len(started) == 2


def test_it_ends_with_the_work_that_is_stopped(started):
    with pytest.raises(KeyboardInterrupt), second_process.contact_compiled_beside():
        raise KeyboardInterrupt
    assert started[0].poll() is not None


def test_on_one_processor_and_with_kernels_on_disk_there_is_none(started, monkeypatch):
    monkeypatch.setattr(second_process, "processors", lambda: 1)
    with second_process.contact_compiled_beside():
        assert not started
    monkeypatch.setattr(second_process, "processors", lambda: 2)
    monkeypatch.setattr(second_process, "is_kept", lambda function: function == second_process.LAST)
    with second_process.contact_compiled_beside():
        assert not started


def test_without_an_interpreter_to_start_the_work_goes_on(monkeypatch):
    monkeypatch.setattr(second_process, "is_kept", lambda function: False)
    monkeypatch.setattr(second_process, "processors", lambda: 2)
    monkeypatch.setattr(second_process.sys, "executable", "")
    with second_process.contact_compiled_beside():
        pass


def test_the_second_process_is_told_what_exists():
    """Its errors are seen by nobody."""
    command = [sys.executable, "-c", second_process.CODE.partition(";")[0]]
    assert subprocess.run(command, check=False).returncode == 0
    module, _, name = second_process.LAST.rpartition(".")
    assert hasattr(sys.modules[module], name)


def test_what_python_never_calls_is_compiled_as_the_contact_calls_it():
    code = (
        "from asperity.kernels import kept; from asperity.scenarios import compiling as c; "
        "solve = lambda: {name for name in kept._CALLED if '.projected_cg.solve-' in name}; "
        "c.press_once(); called = solve(); c.iterate_never(); assert len(solve() | called) == 1, solve()"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


STARTED = """
import time
from asperity.scenarios import second_process
second_process.CODE = second_process.CODE.partition("from asperity.scen")[0] + "import time; time.sleep(600)"
print(second_process._started().pid, flush=True)
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
