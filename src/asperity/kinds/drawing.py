"""Figures of a report, drawn by two processes: this one, and one that gets ready while a run computes."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Thread
from typing import IO, TYPE_CHECKING

from asperity.interrupts import no_interrupt_for_children
from asperity.threads import THREADS, processors

if TYPE_CHECKING:
    from xarray import DataTree

    from asperity.reporting.page import Picture
    from asperity.reporting.part import Part

_START = (
    "import sys, json; sys.path[:] = json.loads(sys.argv[1]); "
    "from asperity.kinds.drawing import draw_on_request; draw_on_request()"
)


class DrawingProcess:
    """A process that draws figures of a result; without one, all are drawn here."""

    def __init__(self, process: subprocess.Popen[str] | None = None) -> None:
        self.process = process

    def pictures(self, tree: DataTree, path: Path, parts: Sequence[Part]) -> dict[str, Picture]:
        """Draw figures of a result that is kept in a file, by name: this process from the first on.

        The other draws from the last on. What it does not draw, because it ended, is drawn here.
        """
        from asperity.reporting.page import picture

        waiting, drawn = deque(parts), dict[str, "Picture"]()
        beside = Thread(target=self._draw, args=(path, waiting, drawn), daemon=True)
        beside.start()
        while waiting or beside.is_alive():
            try:
                part = waiting.popleft()
            except IndexError:
                beside.join(0.05)
                continue
            drawn[part.name] = picture(tree, part)
        return drawn

    def _draw(self, path: Path, waiting: deque[Part], drawn: dict[str, Picture]) -> None:
        """Let the other process draw from the end of the queue."""
        if self.process is None:
            return
        asked, answers = self.process.stdin, self.process.stdout
        assert asked is not None
        assert answers is not None
        while waiting:
            try:
                part = waiting.pop()
            except IndexError:
                return
            try:
                _say(asked, [str(path), part.name])
                drawn[part.name] = _read(answers.readline())
            except (OSError, ValueError):
                waiting.append(part)
                return


@contextmanager
def drawing_process() -> Iterator[DrawingProcess]:
    """A process that gets ready to draw while the body of the ``with`` statement runs."""
    if "1" in (os.environ.get(THREADS), str(processors())):
        yield DrawingProcess()
        return
    command = [sys.executable, "-c", _START, json.dumps(sys.path)]
    try:
        with no_interrupt_for_children():
            process = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                encoding="utf-8",
                env=os.environ | {"ASPERITY_THREADS": "1"},
            )
    except OSError:  # no process to be had: all is drawn here
        yield DrawingProcess()
        return
    try:
        yield DrawingProcess(process)
    finally:
        process.kill()
        with suppress(OSError):
            process.communicate()


def draw_on_request() -> None:
    """Draw what standard input asks for, as the process that `drawing_process` starts, until it ends."""
    from asperity.kinds.report import parts_of
    from asperity.reporting.page import picture
    from asperity.results import read_result

    trees: dict[str, DataTree] = {}
    for request in sys.stdin:
        path, name = json.loads(request)
        if path not in trees:
            trees = {path: read_result(Path(path))}
        part = next(part for part in parts_of(trees[path]) if part.name == name)
        _say(sys.stdout, vars(picture(trees[path], part)))


def _say(to: IO[str], what: object) -> None:
    to.write(json.dumps(what) + "\n")
    to.flush()


def _read(answer: str) -> Picture:
    from markupsafe import Markup

    from asperity.reporting.page import Picture

    found = json.loads(answer)
    return Picture(**found | {name: Markup(found[name]) for name in ("svg", "narrow", "live")})
