"""Progress on a terminal, and where there is none."""

import io

import pytest

from asperity import progress as module
from asperity.progress import duration, progress_bar


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


def test_without_a_terminal_a_line_tells_the_remaining_time_now_and_then(monkeypatch):
    times = iter([0.0, 5.0, 11.0, 12.0, 22.0])
    monkeypatch.setattr(module.time, "monotonic", lambda: next(times))
    stream = io.StringIO()
    with progress_bar(stream) as progress:
        for done in (0, 25, 50, 60, 100):
            progress(done, 100, "scan")
    assert stream.getvalue() == "scan …\nscan: 50 of 100, about 11 s left\nscan: 100 of 100, about 0 s left\n"


def test_on_a_terminal_there_is_a_bar_for_each_piece_of_work():
    stream = Terminal()
    with progress_bar(stream) as progress:
        progress(1, 4, "scan")
        progress(4, 4, "scan")
        progress(2, 8, "roll")
    assert "scan" in stream.getvalue()
    assert "4/4" in stream.getvalue()
    assert "2/8" in stream.getvalue()


@pytest.mark.parametrize(
    ("seconds", "text"), [(0.0, "0 s"), (59.0, "59 s"), (89.9, "90 s"), (240.0, "4 min"), (9000.0, "2.5 h")]
)
def test_durations(seconds, text):
    assert duration(seconds) == text
