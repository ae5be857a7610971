"""Progress on a terminal, and where there is none."""

import io
import re
import sys

import pytest

from asperity import progress as module
from asperity.progress import duration, progress_bar, which_of
from asperity.terminal import Manner, speaking


class Terminal(io.StringIO):
    def isatty(self):
        return True


class Clock:
    """A clock that is set by hand."""

    def __init__(self, monkeypatch):
        self.now = 0.0
        monkeypatch.setattr(module.time, "monotonic", lambda: self.now)


@pytest.fixture
def clock(monkeypatch):
    monkeypatch.setattr(module, "COMPILATION", module.Compilation())
    return Clock(monkeypatch)


def shown(clock, *reports, verbose=False):
    """What is written without a terminal of (time, done, total, message)."""
    with speaking(Manner(verbose=verbose)), progress_bar(stream := io.StringIO()) as progress:
        for clock.now, *report in reports:
            progress(*report)
    return stream.getvalue().splitlines()


def test_without_a_terminal_each_piece_of_work_is_one_line_and_the_remaining_time_now_and_then(clock):
    quick = [(0.0, done, 100, message) for message in ("scan", "roll") for done in range(100)]
    assert shown(clock, *quick) == ["scan …", "roll …"]
    slow = [(time, done, 100, "scan") for time, done in ((0, 0), (5, 25), (11, 50), (12, 60), (22, 100))]
    assert shown(clock, *slow) == ["scan …", "scan: 50 of 100, about 11 s left", "scan: 100 of 100"]


def test_a_rate_is_that_of_the_last_half_minute(clock):
    """What was taken as kept went by at once; what is left has to be computed."""
    reports = [(0, 0), (1, 1000), (30, 1010), (60, 1020), (90, 1030)]
    lines = shown(clock, *((time, done, 1059, "scan") for time, done in reports))
    assert lines[-1] == "scan: 1030 of 1059, about 87 s left"


def test_the_time_left_of_a_study_does_not_jump(clock):
    """Twelve members are kept, then two at a time take about two minutes: it jumped from 6 to 38."""
    reports, now = [(0.0, 0), (0.5, 6), (1.0, 12)], 1.0
    for done in range(13, 43, 2):
        now += 120.0 + 10.0 * ((done * 7) % 5 - 2)
        reports += [(now - 15.0, done), (now, done + 1)]
    lines = shown(clock, *((time, done, 42, "study") for time, done in reports))
    promised = {}
    for line in lines:
        if found := re.search(r"study: (\d+) of 42, about (\d+) (s|min) left", line):
            promised[int(found[1])] = float(found[2]) * (60.0 if found[3] == "min" else 1.0)
    real = {done: now - time for time, done in reports}
    assert len(promised) > 20
    for done in (done for done in promised if 16 <= done < 40):
        assert 0.7 < promised[done] / real[done] < 1.4, done


def test_the_next_piece_of_the_same_name_has_a_time_of_its_own(clock):
    """Law after law rolls: after 200 s the second one had "about 39 min left" of a minute."""
    laws = [(0, 1), (100, 50), (200, 100), (201, 1), (231, 51), (261, 99)]
    told = shown(clock, *((time, done, 100, "rolling") for time, done in laws))
    assert told == [
        "rolling …",
        "rolling: 50 of 100, about 2 min left",
        "rolling: 100 of 100",
        "rolling: 51 of 100, about 29 s left",
        "rolling: 99 of 100, about 1 s left",
    ]


def test_before_anything_is_done_no_time_is_promised(clock):
    assert shown(clock, (0.0, 3, 10, "scan"), (50.0, 3, 10, "scan"))[-1] == "scan: 3 of 10"


def test_what_was_compiled_is_told_once_and_what_each_piece_took_where_it_is_wanted(clock):
    with speaking(Manner(verbose=True)), progress_bar(stream := io.StringIO()) as progress:
        progress(0, 40, "scan")
        for clock.now, step, name in (
            (0.0, module.COMPILATION.begin, "outer"),
            (1.0, module.COMPILATION.begin, "inner"),
            (60.0, module.COMPILATION.end, "inner"),
            (80.0, module.COMPILATION.end, "outer"),
            (81.0, module.COMPILATION.end, "loaded, not compiled"),
        ):
            step(name)
        clock.now = 120.0
        progress(40, 40, "scan")
    assert (module.COMPILATION.functions, module.COMPILATION.seconds) == (2, 80.0)
    lines = ["scan …", module.COMPILING, "scan: 40 of 40", "scan: 40 of 40 in 2 min"]
    assert stream.getvalue().splitlines() == lines
    with progress_bar(stream := io.StringIO()):
        module.COMPILATION.begin("another")
    assert stream.getvalue() == ""


def test_whoever_waits_at_a_prompt_or_a_notebook_is_told_once_that_functions_are_compiled(
    clock, monkeypatch, capsys
):
    """The first roll of a notebook has no bar, and takes a minute more than the next."""
    module.COMPILATION.begin("in a program")
    assert capsys.readouterr().err == ""
    monkeypatch.setattr(sys, "ps1", ">>> ", raising=False)
    for name in ("at a prompt", "again"):
        module.COMPILATION.begin(name)
    assert capsys.readouterr().err == f"{module.COMPILING}\n"


def test_a_script_before_a_terminal_says_once_that_functions_are_compiled(clock, monkeypatch):
    """It stood still for half a minute without a word."""
    monkeypatch.setattr(sys, "stderr", Terminal())
    with speaking(Manner(quiet=True)):
        module.COMPILATION.begin("quietly")
    assert sys.stderr.getvalue() == ""
    for name in ("roll", "scan"):
        module.COMPILATION.begin(name)
    assert sys.stderr.getvalue() == f"{module.COMPILING}\n"
    monkeypatch.setattr(module, "COMPILATION", module.Compilation())
    monkeypatch.setattr(sys, "stderr", None)  # closed
    module.COMPILATION.begin("unheard")


def test_nothing_is_shown_where_it_shall_be_quiet():
    for stream in (io.StringIO(), Terminal()):
        with speaking(Manner(quiet=True)), progress_bar(stream) as progress:
            progress(1, 2, "scan")
        assert stream.getvalue() == ""


def test_on_a_terminal_there_is_a_bar_for_each_piece_of_work():
    with progress_bar(stream := Terminal()) as progress:
        progress(1, 4, "scan [b]")
        progress(4, 4, "scan [b]")
        progress(2, 8, "roll")
    for words in ("scan [b]", "4/4", "2/8", "0:00:0"):
        assert words in stream.getvalue()


def test_durations():
    told = {0.0: "0 s", 59.0: "59 s", 89.9: "90 s", 240.0: "4 min", 9000.0: "2.5 h"}
    assert {seconds: duration(seconds) for seconds in told} == told


def test_many_runs_of_a_kind_have_one_bar_that_says_which_it_is():
    with progress_bar(stream := Terminal()) as progress:
        for number in (1, 2):
            for message in ("scan", "roll"):
                progress(number, 4, f"{which_of('run', number, 9)}{message}")
    last = stream.getvalue().split("\x1b[2K")[-1]
    assert re.findall(r"run \d of at most 9: \w+", last) == [
        "run 2 of at most 9: scan",
        "run 2 of at most 9: roll",
    ]
