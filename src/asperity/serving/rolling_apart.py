"""The process that rolls one run of the page, tells its progress, and ends with the server."""

from __future__ import annotations

import json
import os
import sys
import time
import warnings
from contextlib import suppress
from pathlib import Path
from typing import TextIO

from asperity.errors import TOO_MUCH_MEMORY, AsperityError, reason
from asperity.sandbox import end_with_parent

NICENESS = 5
"""How far it stands back for the slider."""
INTERVAL = 0.1
"""Time between two reports of progress, s."""


def roll_run() -> None:
    """Roll the case in the folder that is the last argument, as the process that `jobs.Jobs` starts."""
    folder, told = Path(sys.argv[-1]), os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # what libraries print is no report
    end_with_parent()
    if hasattr(os, "nice"):
        os.nice(NICENESS)
    try:
        _roll(folder, _Reports(told))
        _tell(told, {"state": "done"})
    except AsperityError as error:
        _tell(told, {"state": "failed", "message": str(error)})
    except MemoryError:
        _tell(told, {"state": "failed", "message": TOO_MUCH_MEMORY})
    except Exception as error:  # a fault of the program, which the page shows
        _tell(told, {"state": "failed", "message": f"The program failed with {reason(error)}."})


def _roll(folder: Path, progress: _Reports) -> None:
    """Compute the case, and write all that the page shows of it; the result, which says so, comes last."""
    progress(0, 1, "importing")
    from asperity.case.cases import load_case
    from asperity.errors import InputError
    from asperity.files import alone_in
    from asperity.reporting.sound import listen
    from asperity.results import save
    from asperity.running import prepare_case, run
    from asperity.serving.kept_runs import CASE, RESULT, SOUNDS

    with alone_in(folder), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # those on the physics stand in the result
        progress(0, 1, "preparing")
        tree = run(prepare_case(load_case(folder / CASE), "the case"), progress=progress)
        progress(0, 1, "writing")
        with suppress(InputError):  # nothing to listen to
            listen(tree, folder / SOUNDS)
        save(tree, folder / RESULT)


class _Reports:
    """Progress as lines of JSON, at most one in a tenth of a second for the same piece of work."""

    def __init__(self, told: TextIO) -> None:
        self.told, self.message, self.last = told, "", 0.0

    def __call__(self, done: int, total: int, message: str) -> None:
        now = time.monotonic()
        if message == self.message and now - self.last < INTERVAL and done < total:
            return
        self.message, self.last = message, now
        _tell(self.told, {"done": done, "total": total, "message": message})


def _tell(told: TextIO, report: dict[str, object]) -> None:
    with suppress(OSError):  # nobody listens any more
        told.write(json.dumps(report) + "\n")
        told.flush()
