"""Progress of long work on standard error: what is done, how far it is and how long it will take."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from html import escape
from typing import Protocol, TextIO

from asperity.printable import printable
from asperity.terminal import write

NOTEBOOK_INTERVAL = 0.2  # s between drawings of a bar
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


@contextmanager
def shown_progress(progress: Progress | None) -> Iterator[Progress]:
    """Take the progress that a caller wants; without any, a bar in a notebook, and none elsewhere."""
    if progress is not None:
        yield progress
    elif _in_notebook():
        with _NotebookProgress() as shown:
            yield shown
    else:
        yield lambda done, total, message: None


def _in_notebook() -> bool:
    """Whether a notebook shows what is displayed; IPython is asked only where it runs already."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return shell is not None and shell.has_trait("kernel")


class _NotebookProgress:
    """A bar beneath the cell that is run, which goes when the work ends."""

    def __init__(self) -> None:
        from IPython.display import display

        self.line = "", 0, 1, 0.0  # message, done, total and seconds left
        self.started = self.drawn = time.monotonic()
        self.first_done = 0
        self.handle = display(self, display_id=True)

    def __enter__(self) -> _NotebookProgress:
        return self

    def __exit__(self, *caught: object) -> None:
        self.line = "", 0, 1, 0.0
        self.handle.update(self)

    def __call__(self, done: int, total: int, message: str) -> None:
        now = time.monotonic()
        begun = message != self.line[0]
        if begun:
            self.first_done, self.started = done, now
        elif now - self.drawn < NOTEBOOK_INTERVAL and done < total:
            return
        left = (now - self.started) * (total - done) / max(done - self.first_done, 1)
        self.line, self.drawn = (message, done, total, left), now
        self.handle.update(self)

    def __repr__(self) -> str:
        message, done, total, _ = self.line
        return f"{message}: {done} of {total}" if message else ""

    def _repr_html_(self) -> str:
        message, done, total, left = self.line
        if not message:
            return ""
        bar = f'<progress value="{done}" max="{max(total, 1)}"></progress>'
        rest = f", about {duration(left)} left" if 0 < done < total else ""
        return f"{bar} {escape(printable(message))}: {done} of {total}{rest}"


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
