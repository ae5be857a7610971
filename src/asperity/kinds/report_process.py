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
from typing import TYPE_CHECKING, Any, BinaryIO, cast

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
            if self._told(lambda to: to.write(b"false\n")) and self._told(lambda to: send_result(known, to)):
                self._answer()

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

    def write(self, tree: DataTree, page: Path, save: Callable[[], object]) -> list[str]:
        """Write the page of a result, and what goes beside it, once `save` has saved the result.

        The other process draws meanwhile. If it cannot, because of an error or its end, this one does what is
        left, or says why not. Names of all files that a report may have are returned.
        """
        from asperity.streamed import send_result

        drawing = False

        def tell() -> None:
            nonlocal drawing
            drawing = self._told(lambda to: to.write(b"true\n")) and self._told(
                lambda to: send_result(tree, to)
            )

        self._tell_next(tell)
        save()
        self.told()
        if drawing and self._told(lambda to: to.write(json.dumps(str(page)).encode() + b"\n")):
            names = self._answer()
            if isinstance(names, list):
                return names
        from asperity.kinds.report import names_of_reports, write_page

        write_page(tree, page)
        return names_of_reports()

    def told(self) -> None:
        """Wait until all has been told, or cannot be."""
        if self._telling is not None:
            self._telling.join()

    def _answer(self) -> Any:
        """What the other process says when it has done what it was told; None if it has not."""
        assert self.process is not None
        assert self.process.stdout is not None
        try:
            return json.loads(self.process.stdout.readline())
        except (OSError, ValueError):
            return None

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

    Before each comes whether it is whole. After one that is comes the path where its page is to be written;
    the answer are names of all files that a report may have. A part of a result is answered when it was read,
    and drawn from until something else comes. An error ends the process: the other one will meet it, too, and
    tell.
    """
    from asperity.kinds import KINDS
    from asperity.kinds.report import draw_all, names_of_reports, parts_of, write_page
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
        whole = json.loads(line)
        result = receive_result(asked)
        if result is None:
            return
        if not whole:
            _answer([])
            parts = [part for part in parts_of(result) if part.name not in ahead]
            ahead |= drawn_ahead(result, parts, _asked_again)
            continue
        drawn = draw_all(result, processes, ahead)
        write_page(result, Path(json.loads(asked.readline())), drawn, processes)
        _answer(names_of_reports())


def _asked_again() -> bool:
    """Whether something waits to be read, after all that came before was read."""
    return sys.platform == "win32" or bool(select.select([sys.stdin], [], [], 0)[0])


def _answer(words: list[str]) -> None:
    sys.stdout.write(json.dumps(words) + "\n")
    sys.stdout.flush()
