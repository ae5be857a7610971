"""A second process that gets ready while a run computes, and then draws and writes its report.

What draws takes as long to import as a short run takes to compute; this way it is never imported here.
"""

from __future__ import annotations

import gc
import json
import os
import select
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, BinaryIO, cast

from asperity.interrupts import no_interrupt_for_children
from asperity.threads import THREADS, processors

if TYPE_CHECKING:
    from xarray import DataTree

_START = (
    "import sys, json; sys.path[:] = json.loads(sys.argv[1]); "
    "from asperity.kinds.report_process import draw_on_request; draw_on_request()"
)
_MOST = 4
"""Processes that draw, at most."""
_COLLECT_AFTER = 100_000
"""New objects until unused ones are sought: a figure makes many."""


class ReportProcess:
    """A process that writes reports; without one, they are written here."""

    def __init__(self, process: subprocess.Popen[bytes] | None = None) -> None:
        self.process = process
        self._telling: Thread | None = None

    @property
    def ahead(self) -> Callable[[DataTree], None] | None:
        """Takes a part of the result, for figures to be drawn from it while the rest is computed."""
        return None if self.process is None else self._draw_ahead

    def _draw_ahead(self, known: DataTree) -> None:
        from asperity.streamed import send_result

        def tell() -> None:
            if self._told(lambda to: to.write(b"null\n")) and self._told(lambda to: send_result(known, to)):
                self._answered()

        self._tell_next(tell)

    def _tell_next(self, tell: Callable[[], None]) -> None:
        """Tell the other process something on a thread, after all else: it may not listen yet."""
        before = self._telling

        def tell_after() -> None:
            if before is not None:
                before.join()
            tell()

        self._telling = Thread(target=tell_after, daemon=True)
        self._telling.start()

    def write(self, tree: DataTree, page: Path, save: Callable[[Callable[[], object]], object]) -> Path:
        """Write the page of a result, and what goes beside it, but not before the result is saved.

        `save` saves it, and calls what it is given before it writes anything: then an earlier report is
        removed. The other process draws meanwhile. If it cannot, because of an error or its end, this one
        does what is left, or says why not.
        """
        from asperity.streamed import send_result

        removed = drawing = False

        def tell() -> None:
            nonlocal removed, drawing
            removed = self._did(page.parent)
            drawing = self._told(lambda to: send_result(tree, to))

        def remove_earlier() -> None:
            self.told()
            if not removed and page.exists():
                from asperity.kinds.report import remove_report

                remove_report(page.parent)

        self._tell_next(tell)
        save(remove_earlier)
        if drawing and self._did(page):
            return page
        from asperity.kinds.report import write_page

        return write_page(tree, page)

    def told(self) -> None:
        """Wait until all has been told, or cannot be."""
        if self._telling is not None:
            self._telling.join()

    def _did(self, path: Path) -> bool:
        """Tell the other process a path, and hear whether it did what was to be done with it."""
        return self._told(lambda to: to.write(json.dumps(str(path)).encode() + b"\n")) and self._answered()

    def _answered(self) -> bool:
        """Hear whether the other process did what it was told."""
        assert self.process is not None
        assert self.process.stdout is not None
        try:
            return json.loads(self.process.stdout.readline()) is True
        except (OSError, ValueError):
            return False

    def _told(self, say: Callable[[BinaryIO], object]) -> bool:
        """Tell the other process something; whether that is possible."""
        if self.process is None:
            return False
        assert self.process.stdin is not None
        try:
            say(cast("BinaryIO", self.process.stdin))
            self.process.stdin.flush()
        except OSError:
            return False
        return True


@contextmanager
def report_process(wanted: bool = True) -> Iterator[ReportProcess | None]:
    """A process that gets ready to draw while the ``with`` statement runs; None if none is wanted."""
    if not wanted:
        yield None
        return
    if "1" in (os.environ.get(THREADS), str(processors())):
        yield ReportProcess()
        return
    command = [sys.executable, "-c", _START, json.dumps(sys.path)]
    try:
        with no_interrupt_for_children():
            process = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env=os.environ | {THREADS: "1"},
                start_new_session=True,  # it ends with the processes that it forks
            )
    except OSError:  # no process to be had
        yield ReportProcess()
        return
    reporter = ReportProcess(process)
    try:
        yield reporter
    finally:
        _end(reporter)


def _end(reporter: ReportProcess) -> None:
    """End the other process with all that it has forked."""
    process = reporter.process
    assert process is not None
    with suppress(OSError):
        if sys.platform == "win32":
            process.kill()
        else:
            os.killpg(process.pid, signal.SIGKILL)
    reporter.told()
    with suppress(OSError):
        process.communicate()


def draw_on_request() -> None:
    """Draw results that come by standard input, as the process that `report_process` starts, until it ends.

    Before each comes a folder, from which an earlier report is removed, after it the path where its page is
    to be written; the answer to both is that it was done. Before that may come a part of the result: it is
    answered when it was read, and drawn from until something else comes. An error ends the process: the other
    one will meet it, too, and tell.
    """
    from asperity.kinds import KINDS
    from asperity.kinds.report import draw_all, parts_of, remove_report, write_page
    from asperity.reporting.ahead import DrawnAhead, drawn_ahead, warm_up
    from asperity.streamed import receive_result
    from asperity.unneeded import spare_pint

    spare_pint()
    for kind in KINDS.values():
        assert kind.chapters  # read while there is time, as well
    if not _asked_again():
        warm_up()
    gc.freeze()  # what was imported is used to the end
    gc.set_threshold(_COLLECT_AFTER)
    asked, processes = sys.stdin.buffer, min(processors(), _MOST)
    ahead: dict[str, DrawnAhead] = {}
    while line := asked.readline():
        folder = json.loads(line)
        if folder is not None:
            remove_report(folder)
            _answer()
        result = receive_result(asked)
        if result is None:
            return
        if folder is None:
            _answer()
            parts = [part for part in parts_of(result) if part.name not in ahead]
            ahead |= drawn_ahead(result, parts, _asked_again)
            continue
        drawn = draw_all(result, processes, ahead)
        write_page(result, Path(json.loads(asked.readline())), drawn, processes)
        _answer()


def _asked_again() -> bool:
    """Whether something waits to be read, after all that came before was read."""
    return sys.platform == "win32" or bool(select.select([sys.stdin], [], [], 0)[0])


def _answer() -> None:
    sys.stdout.write("true\n")
    sys.stdout.flush()
