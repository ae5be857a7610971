"""A second process that gets ready while a run computes, and then draws and writes its report.

What draws takes as long to import as a short run takes to compute; this way it is never imported here.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, cast

from asperity.interrupts import no_interrupt_for_children
from asperity.streamed import receive_result, send_result
from asperity.threads import THREADS, processors

if TYPE_CHECKING:
    from xarray import DataTree

_START = (
    "import sys, json; sys.path[:] = json.loads(sys.argv[1]); "
    "from asperity.kinds.report_process import draw_on_request; draw_on_request()"
)
_MOST = 4
"""Processes that draw, at most."""


class ReportProcess:
    """A process that writes reports; without one, they are written here."""

    def __init__(self, process: subprocess.Popen[bytes] | None = None) -> None:
        self.process = process

    def write(self, tree: DataTree, page: Path, meanwhile: Callable[[], object]) -> Path:
        """Write the page of a result, and what goes beside it, but not before something else is done.

        That is done here while the other process draws. If that cannot, because of an error or its end, this
        one does, or says why not.
        """
        drawing = self.process is not None and self._tell(lambda to: send_result(tree, to))
        meanwhile()
        if (
            drawing
            and self._tell(lambda to: to.write(json.dumps(str(page)).encode() + b"\n"))
            and self._done()
        ):
            return page
        from asperity.kinds.report import write_page

        return write_page(tree, page)

    def _tell(self, say: Callable[[BinaryIO], object]) -> bool:
        """Tell the other process something; whether that is possible."""
        assert self.process is not None
        assert self.process.stdin is not None
        try:
            say(cast("BinaryIO", self.process.stdin))
            self.process.stdin.flush()
        except OSError:
            return False
        return True

    def _done(self) -> bool:
        """Whether the other process says that it has written all."""
        assert self.process is not None
        assert self.process.stdout is not None
        try:
            return json.loads(self.process.stdout.readline()) is True
        except (OSError, ValueError):
            return False


@contextmanager
def report_process() -> Iterator[ReportProcess]:
    """A process that gets ready to draw while the body of the ``with`` statement runs."""
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
    try:
        yield ReportProcess(process)
    finally:
        _end(process)


def _end(process: subprocess.Popen[bytes]) -> None:
    """End a process with all that it has forked."""
    with suppress(OSError):
        if sys.platform == "win32":
            process.kill()
        else:
            os.killpg(process.pid, signal.SIGKILL)
    with suppress(OSError):
        process.communicate()


def draw_on_request() -> None:
    """Draw results that come by standard input, as the process that `report_process` starts, until it ends.

    After each comes the path where its page is to be written, and the answer that it has been. An error ends
    the process: the other one will meet it, too, and tell.
    """
    import xarray  # noqa: F401  imported while there is time

    from asperity.kinds import KINDS
    from asperity.kinds.report import draw_all, write_page

    for kind in KINDS.values():
        assert kind.chapters  # read while there is time, as well
    asked, processes = sys.stdin.buffer, min(processors(), _MOST)
    while (result := receive_result(asked)) is not None:
        drawn = draw_all(result, processes)
        write_page(result, Path(json.loads(asked.readline())), drawn, processes)
        sys.stdout.write("true\n")
        sys.stdout.flush()
