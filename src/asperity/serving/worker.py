"""What is done for the page in processes of their own: questions answered, one at a time, and runs rolled.

Uploaded files are opened and typed values read here, apart from the server: a file that hangs or ends this
process ends nothing else. Questions, answers and progress are a line of JSON each. A process ends with the
server.
"""

import base64
import json
import os
import sys
import time
import warnings
from collections import OrderedDict
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from queue import SimpleQueue
from threading import Thread
from typing import TYPE_CHECKING, Any, TextIO

import numpy as np

from asperity import errors
from asperity.case import cases, toml
from asperity.case.any_case import AnyCase
from asperity.case.surface import MAP_KEYS
from asperity.files import alone_in
from asperity.parameters import Origin
from asperity.progress import Progress
from asperity.sandbox import MEMORY, end_with_parent, limit_process
from asperity.serving import case_form, stored_runs
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.readers import hints, read_surface
from asperity.units import written

if TYPE_CHECKING:
    from asperity.serving.contact_preview import PressedSample

Told = dict[str, Any]
LAID_READY = 4
"""Contacts that stay laid ready: as many tabs may be open."""
LEAVING = 1.0
"""Time that an answer has to be finished when the server has ended, s."""
NICENESS = 5
"""How far a run stands back for the slider."""
INTERVAL = 0.1
"""Time between two reports of progress, s."""
MOST_CHANGED = 4  # keys that the list of runs names
_pressed: "OrderedDict[str, PressedSample]" = OrderedDict()


# --- questions about cases and files


def _case(kind: str, values: dict[str, object], surfaces: str) -> AnyCase:
    root = Path(surfaces)
    data = case_form.case_data(kind, values, lambda identifier: stored_runs.surface_named(root, identifier))
    return cases.case_of(data, Origin("the case", root, units=True))


def read_form(kind: str, values: dict[str, object], surfaces: str) -> Told:
    """Read a case from its form: its text, and what of it is changed."""
    case = _case(kind, values, surfaces)
    changed = [f"{each['key']} {each['value']}" for each in case.parameters() if not each["is_default"]]
    more = f" and {len(changed) - MOST_CHANGED} more" if len(changed) > MOST_CHANGED else ""
    return {"toml": case.to_toml(), "changed": ", ".join(changed[:MOST_CHANGED]) + more}


def read_case_file(text: str, surfaces: str) -> Told:
    """Read a case file into the form."""
    root = Path(surfaces)
    data = toml.read_toml(text, "case", "the case")
    values = case_form.form_values(data, lambda path: stored_runs.identifier_of(root, path))
    cases.case_of(data, Origin("the case", root, units=True))  # once it names nothing but what was uploaded
    return {"kind": data["kind"], "values": values}


def press_form(kind: str, values: dict[str, object], surfaces: str, share: float | None, whole: bool) -> Told:
    """Press the first sample of a case; `whole` asks for what does not change with the approach as well."""
    from asperity.serving.contact_preview import PressedSample

    key = json.dumps([kind, values], sort_keys=True)
    if key not in _pressed:
        _pressed[key] = PressedSample(_case(kind, values, surfaces))
        whole = True
        if len(_pressed) > LAID_READY:
            _pressed.popitem(last=False)
    _pressed.move_to_end(key)
    sample = _pressed[key]
    return {"contact": sample.at(share)} | ({"sample": sample.described()} if whole else {})


def prepare_to_press() -> Told:
    """Press a sample once, so that the first one finds everything imported and compiled."""
    from asperity.serving.contact_preview import PressedSample

    PressedSample(cases.demo_case()).at(None)
    return {}


def examined(path: str) -> Told:
    """Say what is in an uploaded file, or what a case has to say of it; an `InputError` if none reads it."""
    try:
        # said below
        with hints.spelled(hints.in_case("surface", MAP_KEYS)), errors.MissingPointsWarning.ignored():
            first = read_surface(path, index=0)
    except errors.InputError as error:
        if "in [surface]" not in error.remedy:
            raise
        return {"words": "", "needs": str(error).replace(path, Path(path).name)}
    kind = "map" if isinstance(first, HeightMap) else "line"
    points = " × ".join(map(str, first.shape))
    apart = " × ".join(dict.fromkeys(written(float(d), "m", "um") for d in np.atleast_1d(first.spacing)))
    share = first.missing_share
    lost = f", {errors.percent(share)} without a height: set fill" if share else ""
    return {"words": f"{kind} of {points} points, {apart} apart{lost}", "needs": ""}


_QUESTIONS = {
    "check": "worker.read_form",
    "fill": "worker.read_case_file",
    "press": "worker.press_form",
    "prepare to press": "worker.prepare_to_press",
    "examine": "worker.examined",
    "view": "run_view.viewed_run",
    "compare": "run_view.compared_runs",
    "report": "run_view.write_report",
}
"""Module and function that answer each: what shows runs is imported by who is asked for it."""


def answer_all() -> None:
    """Answer what comes on standard input until it ends, in the process of a `Questions`."""
    answers = _own_output()
    questions = SimpleQueue[str | None]()
    with suppress(OSError, ValueError):
        limit_process(MEMORY)
    warnings.simplefilter("ignore")  # runs tell theirs; here nobody reads them

    def read() -> None:
        for line in sys.stdin:
            questions.put(line)
        questions.put(None)
        time.sleep(LEAVING)
        os._exit(1)

    Thread(target=read, daemon=True).start()
    while (line := questions.get()) is not None:
        _tell(answers, answered(line))


def answered(line: str) -> Told:
    """The answer to one question, or why there is none."""
    question: Told = json.loads(line)
    module, _, function = _QUESTIONS[question.pop("question")].partition(".")
    try:
        found: Told = getattr(import_module(f"asperity.serving.{module}"), function)(**question)
    except errors.CaseError as error:
        return {"refused": error.errors}
    except Exception as error:
        memory = "This needs more memory than the page takes. Run the case with 'asperity run'."
        return {"refused": [_why(error, memory)]}
    return found


def _why(error: Exception, memory: str) -> str:
    """What went wrong: the input, too little memory, or the program, which must not end the page."""
    if isinstance(error, errors.AsperityError):
        return str(error)
    return memory if isinstance(error, MemoryError) else f"The program failed with {errors.reason(error)}."


# --- runs


def roll_run() -> None:
    """Roll the case in the folder that is the last argument, in a process of `Jobs`."""
    told = _own_output()
    message = ""
    last = 0.0
    end_with_parent()
    if hasattr(os, "nice"):
        os.nice(NICENESS)

    def progress(done: int, total: int, what: str) -> None:
        """Tell it, at most once in a tenth of a second for the same piece of work."""
        nonlocal message, last
        now = time.monotonic()
        if what != message or now - last >= INTERVAL or done >= total:
            message = what
            last = now
            _tell(told, {"done": done, "total": total, "message": what})

    try:
        _roll(Path(sys.argv[-1]), progress)
        _tell(told, {"state": "done"})
    except Exception as error:
        _tell(told, {"state": "failed", "message": _why(error, errors.TOO_MUCH_MEMORY)})


def _roll(folder: Path, progress: Progress) -> None:
    """Compute the case, and write all that the page shows of it; the result, which says so, comes last."""
    progress(0, 1, "importing")
    from asperity.reporting.sound import listen
    from asperity.results import save
    from asperity.running import prepare_case, run

    # those on the physics stand in the result
    with alone_in(folder), warnings.catch_warnings(action="ignore"):
        progress(0, 1, "preparing")
        tree = run(prepare_case(cases.read_case(folder / stored_runs.CASE), "the case"), progress=progress)
        progress(0, 1, "writing")
        with suppress(errors.InputError):  # nothing to listen to
            listen(tree, stored_runs.own_folder(folder / stored_runs.SOUNDS))
        save(tree, folder / stored_runs.RESULT)


# --- lines of JSON


def _own_output() -> TextIO:
    """Standard output for what is told alone: what libraries print goes to standard error."""
    own = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    return own


def _tell(told: TextIO, line: Told) -> None:
    with suppress(OSError):  # nobody listens any more
        told.write(json.dumps(line, default=_plain) + "\n")
        told.flush()


def _plain(value: object) -> object:
    """Arrays as single precision in base 64, for the browser's typed arrays."""
    if isinstance(value, np.ndarray):
        return base64.b64encode(np.ascontiguousarray(value, dtype="<f4").tobytes()).decode()
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(type(value).__name__)
