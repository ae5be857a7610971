"""Progress on a terminal, and where there is none."""

import io

import pytest

from asperity import progress as module
from asperity.progress import duration, progress_bar
from asperity.terminal import Manner, speaking


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_without_a_terminal_each_piece_of_work_is_one_line():
    stream = io.StringIO()
    with progress_bar(stream) as progress:
        for message in ("scan", "roll"):
            for done in range(100):
                progress(done, 100, message)
    assert stream.getvalue() == "scan …\nroll …\n"


class Clock:
    """A clock that is set by hand."""

    def __init__(self, monkeypatch):
        self.now = 0.0
        monkeypatch.setattr(module.time, "monotonic", lambda: self.now)


@pytest.fixture
def clock(monkeypatch):
    monkeypatch.setattr(module, "COMPILATION", module.Compilation())
    return Clock(monkeypatch)


def test_without_a_terminal_a_line_tells_rate_and_remaining_time_now_and_then(clock):
    stream = io.StringIO()
    with progress_bar(stream) as progress:
        for clock.now, done in ((0.0, 0), (5.0, 25), (11.0, 50), (12.0, 60), (22.0, 100)):
            progress(done, 100, "scan")
    assert stream.getvalue() == (
        "scan …\nscan: 50 of 100, 4.55/s, about 11 s left\nscan: 100 of 100, 4.55/s, about 0 s left\n"
    )


def test_time_of_the_compiler_counts_for_no_rate(clock):
    """Ten steps of one second each: the 80 s in which something was compiled are none of theirs."""
    stream = io.StringIO()
    with speaking(Manner(verbose=True)), progress_bar(stream) as progress:
        progress(0, 40, "scan")
        module.COMPILATION.begin("kernel")
        clock.now = 1.0
        module.COMPILATION.begin("kernel inside it")
        clock.now = 60.0
        module.COMPILATION.end("kernel inside it")
        clock.now = 80.0
        module.COMPILATION.end("kernel")
        clock.now = 90.0
        progress(10, 40, "scan")
        clock.now = 120.0
        progress(40, 40, "scan")
    assert module.COMPILATION.functions == 2
    assert module.COMPILATION.seconds == 80.0
    assert stream.getvalue().splitlines() == [
        "scan …",
        "compiling functions, once: later runs load them …",
        "scan: 10 of 40, 1/s, about 30 s left",
        "scan: 40 of 40, 1/s, about 0 s left",
        "scan: 40 of 40 in 40 s, and 80 s to compile",
    ]


def test_a_rate_is_that_of_the_last_half_minute(clock):
    """What was taken as kept went by at once; what is left has to be computed."""
    pace = module.Pace("scan", 0)
    for clock.now, done in ((1.0, 1000), (30.0, 1010), (60.0, 1020), (90.0, 1030)):
        pace.report(done)
    assert pace.rate == pytest.approx(1 / 3)
    assert pace.told(1059) == "20/min, about 87 s left"


def test_before_anything_is_done_no_time_is_promised(clock):
    pace = module.Pace("scan", 3)
    clock.now = 50.0
    pace.report(3)
    assert pace.told(10) == ""


@pytest.mark.parametrize(
    ("rate", "text"),
    [(0.05, "3/min"), (0.5, "0.5/s"), (12.34, "12.3/s"), (31e3, "31 k/s"), (2.5e6, "2.5 M/s")],
)
def test_rates(rate, text):
    assert module.per_second(rate) == text


def test_nothing_is_shown_where_it_shall_be_quiet():
    for stream in (io.StringIO(), Terminal()):
        with speaking(Manner(quiet=True)), progress_bar(stream) as progress:
            progress(1, 2, "scan")
        assert stream.getvalue() == ""


def test_on_a_terminal_there_is_a_bar_for_each_piece_of_work():
    stream = Terminal()
    with progress_bar(stream) as progress:
        progress(1, 4, "scan")
        progress(4, 4, "scan")
        progress(2, 8, "roll")
    assert "scan" in stream.getvalue()
    assert "4/4" in stream.getvalue()
    assert "2/8" in stream.getvalue()


def test_a_bar_tells_rate_and_remaining_time(clock):
    stream = Terminal()
    with progress_bar(stream) as progress:
        progress(0, 100, "scan")
        clock.now = 10.0
        progress(20, 100, "scan")
    assert "2/s, about 40 s left" in stream.getvalue()


@pytest.mark.parametrize(
    ("seconds", "text"), [(0.0, "0 s"), (59.0, "59 s"), (89.9, "90 s"), (240.0, "4 min"), (9000.0, "2.5 h")]
)
def test_durations(seconds, text):
    assert duration(seconds) == text
