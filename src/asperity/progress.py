"""Progress of long work on standard error: what is done, how far it is and how long it will take."""

from __future__ import annotations

import math
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from html import escape
from importlib import import_module
from typing import Protocol, TextIO

from asperity.printable import printable
from asperity.terminal import manner, write

NOTEBOOK_INTERVAL = 0.2  # s between drawings of a bar
QUIET_INTERVAL = 10.0  # s between lines where standard error is not a terminal
COMPILING_INTERVAL = 3.0  # s, likewise while functions are compiled: nobody expects that
WINDOW = 30.0  # s over which a rate is taken


class Progress(Protocol):
    """What long work calls: ``progress(done, total, message)``."""

    def __call__(self, done: int, total: int, message: str) -> None:
        """Report that `done` of `total` steps of the work called `message` are finished."""


class Compilation:
    """Time that the compiler took in this process: its first use of a kernel, never that of the work."""

    def __init__(self) -> None:
        self.functions = 0  # that were compiled
        self._told: Callable[[], None] | None = None
        self._said = False
        self._spent, self._begun = 0.0, 0.0  # s
        self._open: set[str] = set()
        self._lock = threading.Lock()

    @property
    def seconds(self) -> float:
        """Time until now, s."""
        with self._lock:
            return self._spent + (time.monotonic() - self._begun if self._open else 0.0)

    def begin(self, name: str) -> None:
        """Say that a function is being compiled; others may be inside it."""
        with self._lock:
            told = None if self._open else self._told
            if not self._open:
                self._begun = time.monotonic()
            self._open.add(name)
        if told is not None:
            told()

    @contextmanager
    def told_to(self, tell: Callable[[str], None]) -> Iterator[None]:
        """Have it said, once in a process, that something is compiled while the ``with`` statement runs."""
        before, self._told = self._told, None if self._said else lambda: self._tell_once(tell)
        try:
            yield
        finally:
            self._told = before

    def _tell_once(self, tell: Callable[[str], None]) -> None:
        self._told, self._said = None, True
        tell(COMPILING)

    def end(self, name: str) -> None:
        """Say that it is done."""
        with self._lock:
            if name in self._open:
                self._open.discard(name)
                self.functions += 1
                if not self._open:
                    self._spent += time.monotonic() - self._begun


COMPILING = "compiling functions, once: later runs load them …"
COMPILATION = Compilation()
"""Of this process."""
COMPILED = "compiled functions"
"""The piece of work that is compiling: its time counts."""
ENOUGH = 0.2
"""Share of it from which on the time left is told: kernels differ."""


class Pace:
    """How fast a piece of work goes: steps done over the time it took without the compiler's, lately."""

    def __init__(self, message: str, done: int) -> None:
        self.message = message
        self.begun, self._compiled = time.monotonic(), COMPILATION.seconds
        self._seen = deque([(0.0, done)])

    def report(self, done: int) -> None:
        """Take down that so many steps are done now."""
        now = self.worked
        self._seen.append((now, done))
        while len(self._seen) > 2 and self._seen[1][0] < now - WINDOW:
            self._seen.popleft()

    @property
    def compiling(self) -> float:
        """Time in which something was compiled meanwhile, s; none of it where this is the work."""
        return 0.0 if self.message == COMPILED else COMPILATION.seconds - self._compiled

    @property
    def worked(self) -> float:
        """Time since the beginning, without the compiler's, s."""
        return max(time.monotonic() - self.begun - self.compiling, 0.0)

    @property
    def rate(self) -> float:
        """Steps per second over the last `WINDOW`; NaN before any is done."""
        (first, before), (last, done) = self._seen[0], self._seen[-1]
        return (done - before) / (last - first) if done > before and last > first else math.nan

    def left(self, total: int) -> float:
        """Time, s, that the rest will take at this rate; NaN before any is done."""
        return (total - self._seen[-1][1]) / self.rate

    def told(self, total: int) -> str:
        """Rate and time left in words, as ``"5.2/s, about 9 s left"``; nothing before any is done."""
        if self.message == COMPILED and self._seen[-1][1] < ENOUGH * total:
            return ""
        rate, left = self.rate, self.left(total)
        return f"{per_second(rate)}, about {duration(left)} left" if math.isfinite(left) else ""


def per_second(rate: float) -> str:
    """Write a rate for people: ``"5.2/s"``, ``"31 k/s"``, ``"4/min"``."""
    if rate < 0.5:
        return f"{60 * rate:.2g}/min"
    for size, prefix in ((1e6, " M"), (1e3, " k")):
        if rate >= size:
            return f"{rate / size:.3g}{prefix}/s"
    return f"{rate:.3g}/s"


@contextmanager
def progress_bar(stream: TextIO | None = None) -> Iterator[Progress]:
    """Show progress while the body of the ``with`` statement runs.

    It gives a callable ``progress(done, total, message)``, where a new `message` starts a new piece of work.
    On a terminal every piece has a bar with its share, its rate and the remaining time; elsewhere a plain
    line is written when it starts and every 10 s. By default on standard error. Time of the compiler counts
    for no rate. Where it shall be quiet nothing is shown; where more is wanted, what each piece took.
    """
    stream = sys.stderr if stream is None else stream
    if manner().quiet:
        yield lambda done, total, message: None
    elif stream is None or not stream.isatty():  # None: standard error is closed
        plain = _PlainProgress(stream)
        try:
            with COMPILATION.told_to(lambda text: write(stream, text)):
                yield plain
        finally:
            plain.finish()
    else:
        with _bars(stream) as update:
            yield update


@contextmanager
def _bars(stream: TextIO) -> Iterator[Progress]:
    """A bar for each piece of work, drawn by rich."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn

    words, pace = (
        TextColumn("{task.description}", markup=False),
        TextColumn("{task.fields[told]}", markup=False),
    )
    tasks: dict[str, TaskID] = {}
    paces: dict[str, Pace] = {}
    with Progress(words, BarColumn(), MofNCompleteColumn(), pace, console=Console(file=stream)) as bars:

        def update(done: int, total: int, message: str) -> None:
            if message not in tasks:
                tasks[message] = bars.add_task(printable(message), total=total, told="")
                paces[message] = Pace(message, done)
            here = paces[message]
            here.report(done)
            told = _took(here) if done >= total else here.told(total)
            bars.update(tasks[message], completed=done, total=total, told=told)

        with COMPILATION.told_to(lambda text: bars.console.print(text, markup=False, highlight=False)):
            yield update


def _took(pace: Pace) -> str:
    """Time that a piece has taken, and how much of it the compiler took."""
    compiling = f", and {duration(pace.compiling)} to compile" if pace.compiling >= 1.0 else ""
    return f"{duration(pace.worked)}{compiling}"


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
        self.line = "", 0, 1, ""  # message, done, total, rate and time left
        self.pace = Pace("", 0)
        self.drawn = time.monotonic()
        self.handle = import_module("IPython.display").display(self, display_id=True)

    def __enter__(self) -> _NotebookProgress:
        return self

    def __exit__(self, *caught: object) -> None:
        self.line = "", 0, 1, ""
        self.handle.update(self)

    def __call__(self, done: int, total: int, message: str) -> None:
        now = time.monotonic()
        if message != self.pace.message:
            self.pace = Pace(message, done)
        else:
            self.pace.report(done)
            if now - self.drawn < NOTEBOOK_INTERVAL and done < total:
                return
        self.line, self.drawn = (message, done, total, self.pace.told(total)), now
        self.handle.update(self)

    def __repr__(self) -> str:
        message, done, total, _ = self.line
        return f"{message}: {done} of {total}" if message else ""

    def _repr_html_(self) -> str:
        message, done, total, told = self.line
        if not message:
            return ""
        bar = f'<progress value="{done}" max="{max(total, 1)}"></progress>'
        rest = f", {told}" if told and 0 < done < total else ""
        return f"{bar} {escape(printable(message))}: {done} of {total}{rest}"


class _PlainProgress:
    """A line at the start of a piece of work, and one every few seconds."""

    def __init__(self, stream: TextIO | None) -> None:
        self.stream = stream
        self.pace: Pace | None = None
        self.done, self.total = 0, 0
        self.written = 0.0

    def __call__(self, done: int, total: int, message: str) -> None:
        now = time.monotonic()
        if self.pace is None or message != self.pace.message:
            self.finish()
            self.pace, self.written = Pace(message, done), now
            write(self.stream, f"{message} …")
        else:
            self.pace.report(done)
            if now - self.written >= (COMPILING_INTERVAL if message == COMPILED else QUIET_INTERVAL):
                self.written = now
                told = self.pace.told(total)
                write(self.stream, f"{message}: {done} of {total}" + f", {told}" * bool(told))
        self.done, self.total = done, total

    def finish(self) -> None:
        """Say what the piece took that ends here, where that is wanted."""
        if self.pace is not None and manner().verbose:
            write(self.stream, f"{self.pace.message}: {self.done} of {self.total} in {_took(self.pace)}")
        self.pace = None


def duration(seconds: float) -> str:
    """Write a time span, s, for people, in the unit that suits it: ``"8 s"``, ``"4 min"``, ``"2.5 h"``."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    if seconds < 5400:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"
