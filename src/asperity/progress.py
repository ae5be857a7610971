"""Progress of long work on standard error: what is done, how far it is and how long it will take."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol, TextIO

from asperity.printable import printable
from asperity.terminal import write

QUIET_INTERVAL = 10.0  # s between lines where standard error is not a terminal


class Progress(Protocol):
    """What long work calls: ``progress(done, total, message)``."""

    def __call__(self, done: int, total: int, message: str) -> None:
        """Report that `done` of `total` steps of the work called `message` are finished."""


@contextmanager
def progress_bar(stream: TextIO | None = None) -> Iterator[Progress]:
    """Show progress while the body of the ``with`` statement runs.

    It gives a callable ``progress(done, total, message)``, where a new `message` starts a new piece of work.
    On a terminal every piece has a bar with its share and the remaining time; elsewhere a plain line is
    written when it starts and every 10 s. By default on standard error.
    """
    stream = sys.stderr if stream is None else stream
    if stream is None or not stream.isatty():  # None: standard error is closed
        yield _PlainProgress(stream)
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn, TimeRemainingColumn

    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(elapsed_when_finished=True),
    )
    tasks: dict[str, TaskID] = {}
    with Progress(*columns, console=Console(file=stream)) as bars:

        def update(done: int, total: int, message: str) -> None:
            if message not in tasks:
                tasks[message] = bars.add_task(printable(message), total=total)
            bars.update(tasks[message], completed=done, total=total)

        yield update


class _PlainProgress:
    """A line at the start of a piece of work, and one every few seconds."""

    def __init__(self, stream: TextIO | None) -> None:
        self.stream = stream
        self.message = ""
        self.first_done = 0
        self.started = self.written = 0.0

    def __call__(self, done: int, total: int, message: str) -> None:
        now = time.monotonic()
        if message != self.message:
            self.message, self.first_done = message, done
            self.started = self.written = now
            write(self.stream, f"{message} …")
        elif now - self.written >= QUIET_INTERVAL:
            self.written = now
            remaining = (now - self.started) * (total - done) / max(done - self.first_done, 1)
            write(self.stream, f"{message}: {done} of {total}, about {duration(remaining)} left")


def duration(seconds: float) -> str:
    """Write a time span, s, for people, in the unit that suits it: ``"8 s"``, ``"4 min"``, ``"2.5 h"``."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    if seconds < 5400:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"
