"""Progress of long work on standard error: what is done, how far it is and how long it will take."""

import re
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing, contextmanager
from html import escape
from importlib import import_module
from typing import TextIO, TypeVar

from asperity.errors import printable
from asperity.terminal import manner, write

NOTEBOOK_INTERVAL = 0.2  # s between drawings of a bar
QUIET_INTERVAL = 10.0  # s between lines where standard error is not a terminal
WINDOW = 30.0  # s over which a rate is taken: what was kept went by at once, the rest has to be computed
FEWEST = 8
"""Steps that a rate is taken from, at least: members of a study take minutes, and come in bursts."""
KEPT = 0.1
"""Share of the time of a step from which on it was computed, not kept."""
COMPILED = "compiled functions"
"""The piece of work that is compiling."""
COMPILING = "compiling functions, once: later runs load them …"

Progress = Callable[[int, int, str], object]
"""What long work calls, as ``progress(done, total, message)``: so many steps of the work are finished."""
R = TypeVar("R")


_NUMBERED = re.compile(r"^\w+ \d+ of at most \d+: ")


def which_of(what: str, number: int, most: int) -> str:
    """Begin what one of several pieces of work of a kind says: ``"run 7 of at most 60: "``."""
    return f"{what} {number} of at most {most}: "


def counted(
    results: Iterable[R],
    total: int,
    message: str,
    progress: Progress | None,
    steps: Callable[[R], int] = lambda _: 1,
) -> Iterator[R]:
    """Hand results on as they come, and tell with each how many steps of the work are done."""
    tell = progress or (lambda *_: None)
    done = 0
    tell(done, total, message)
    for result in results:
        done += steps(result)
        tell(done, total, message)
        yield result


class Compilation:
    """What was compiled in this process, its first use of kernels, and how long that took, s."""

    def __init__(self) -> None:
        self.functions = 0
        self.seconds = 0.0
        self._said = False
        self._announce: Callable[[str], object] | None = None
        self._begun: dict[str, float] = {}  # functions that are being compiled, one inside the other
        self._lock = threading.Lock()

    @contextmanager
    def announced(self, announce: Callable[[str], object]) -> Iterator[None]:
        """Have the first compilation of this process announced while the ``with`` statement runs."""
        self._announce = announce if not self.functions else None
        try:
            yield
        finally:
            self._announce = None

    def begin(self, name: str) -> None:
        """Say that a function is being compiled."""
        with self._lock:
            self._begun[name] = time.monotonic()
            announce = self._announce
            self._announce = None
            if announce is None and not self._said and _somebody_waits():
                announce = _say_aloud
            self._said = self._said or announce is not None
        if announce is not None:
            announce(COMPILING)

    def end(self, name: str) -> None:
        """Say that it is done."""
        with self._lock:
            if (begun := self._begun.pop(name, None)) is not None:
                self.functions += 1
                self.seconds += 0.0 if self._begun else time.monotonic() - begun


def _somebody_waits() -> bool:
    """Whether a person sits before a prompt, a notebook or a terminal, and wonders what takes so long."""
    before_terminal = sys.stderr is not None and sys.stderr.isatty()
    return not manner().quiet and (hasattr(sys, "ps1") or before_terminal or _in_notebook())


def _say_aloud(text: str) -> None:
    """Say on standard error what is waited for."""
    write(sys.stderr, text)


COMPILATION = Compilation()


class _Piece:
    """A piece of work: what is done of it, and how long the rest will take."""

    def __init__(self, message: str, done: int, total: int) -> None:
        self.message = message
        self.done = done
        self.total = total
        self.begun = self._shown = time.monotonic()
        self._seen = deque([(self.begun, done)])

    def report(self, done: int, total: int, interval: float) -> bool:
        """Take down that so many steps are done now; return whether that is to be shown.

        Fewer than before are those of another piece of the same kind, as of the next law that rolls.
        """
        now = time.monotonic()
        if done < self.done:
            self._seen.clear()
        self.done = done
        self.total = total
        self._seen.append((now, done))
        while len(self._seen) > 2 and self._seen[1][0] < now - WINDOW and self._is_told_by_others():
            self._seen.popleft()
        due = now - self._shown >= interval
        self._shown = now if due else self._shown
        return due

    def _is_told_by_others(self) -> bool:
        """Whether the rate is known without the first time: from enough steps, or as these were kept."""
        first, before = self._seen[0]
        second, between = self._seen[1]
        last, done = self._seen[-1]
        quick = (second - first) * (done - between) < KEPT * (last - second) * (between - before)
        return done - between >= FEWEST or (done > between > before and quick)

    @property
    def left(self) -> float:
        """Time that the rest will take, s; zero before anything is done."""
        first, before = self._seen[0]
        last, done = self._seen[-1]
        return (self.total - done) * (last - first) / (done - before) if done > before else 0.0

    @property
    def words(self) -> str:
        """How far it is, as ``"scan: 5 of 9, about 4 s left"``; no time before anything is done."""
        told = f", about {duration(self.left)} left" * (self.left > 0.0)
        return f"{self.message}: {self._seen[-1][1]} of {self.total}{told}"


@contextmanager
def progress_bar(stream: TextIO | None = None) -> Iterator[Progress]:
    """Show progress while the body of the ``with`` statement runs, by default on standard error.

    It gives a callable ``progress(done, total, message)``, where a new `message` starts a new piece of work.
    On a terminal every piece has a bar with its counts and the remaining time; elsewhere a plain line is
    written when it starts and every 10 s. Where it shall be quiet nothing is shown; where more is wanted,
    what each piece took.
    """
    stream = sys.stderr if stream is None else stream
    if manner().quiet:
        yield lambda done, total, message: None
    elif stream is None or not stream.isatty():  # None: standard error is closed
        announced = COMPILATION.announced(lambda text: write(stream, text))
        with announced, closing(_PlainProgress(stream)) as plain:
            yield plain
    else:
        with _bars(stream) as update:
            yield update


@contextmanager
def _bars(stream: TextIO) -> Iterator[Progress]:
    """A bar for each piece of work, drawn by rich."""
    from rich import progress
    from rich.console import Console

    tasks: dict[str, progress.TaskID] = {}
    pieces: dict[str, _Piece] = {}
    columns = (
        progress.TextColumn("{task.description}", markup=False),
        progress.BarColumn(),
        progress.MofNCompleteColumn(),
        progress.TextColumn("{task.fields[left]}", markup=False),
        progress.TimeElapsedColumn(),
    )
    with progress.Progress(*columns, console=Console(file=stream)) as bars:

        def update(done: int, total: int, message: str) -> None:
            name = _NUMBERED.sub("", message)  # of many runs alike one bar
            if name not in tasks:
                tasks[name] = bars.add_task("", left="")
                pieces[name] = _Piece(name, done, total)
            piece = pieces[name]
            piece.report(done, total, 0.0)
            left = f"about {duration(piece.left)} left" if piece.left > 0.0 else ""
            said = printable(message)
            bars.update(tasks[name], description=said, completed=done, total=total, left=left)

        with COMPILATION.announced(lambda text: bars.console.print(text, markup=False, highlight=False)):
            yield update


@contextmanager
def shown_progress(progress: Progress | None) -> Iterator[Progress]:
    """Take the progress that a caller wants; without any, a bar in a notebook, and none elsewhere."""
    if progress is not None:
        yield progress
    elif _in_notebook():
        with closing(_NotebookProgress()) as shown:
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
        self.piece: _Piece | None = None
        self.handle = import_module("IPython.display").display(self, display_id=True)

    def __call__(self, done: int, total: int, message: str) -> None:
        if self.piece is None or message != self.piece.message:
            self.piece = _Piece(message, done, total)
        elif not self.piece.report(done, total, NOTEBOOK_INTERVAL) and done < total:
            return
        self.handle.update(self)

    def close(self) -> None:
        """Take the bar away."""
        self.piece = None
        self.handle.update(self)

    def __repr__(self) -> str:
        return self.piece.words if self.piece else ""

    def _repr_html_(self) -> str:
        if not self.piece:
            return ""
        bar = f'<progress value="{self.piece.done}" max="{max(self.piece.total, 1)}"></progress>'
        return f"{bar} {escape(printable(self.piece.words))}"


class _PlainProgress:
    """A line at the start of a piece of work, and one every few seconds."""

    def __init__(self, stream: TextIO | None) -> None:
        self.stream = stream
        self.piece = _Piece("", 0, 0)

    def __call__(self, done: int, total: int, message: str) -> None:
        if message != self.piece.message:
            self.close()
            self.piece = _Piece(message, done, total)
            write(self.stream, f"{message} …")
        elif self.piece.report(done, total, QUIET_INTERVAL):
            write(self.stream, self.piece.words)

    def close(self) -> None:
        """Say what the piece took that ends here, where that is wanted."""
        piece = self.piece
        if piece.message and manner().verbose:
            took = duration(time.monotonic() - piece.begun)
            write(self.stream, f"{piece.message}: {piece.done} of {piece.total} in {took}")


def duration(seconds: float) -> str:
    """Write a time span, s, for people, in the unit that suits it: ``"8 s"``, ``"4 min"``, ``"2.5 h"``."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    if seconds < 5400:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"
