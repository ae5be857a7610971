"""The process that does for the page what takes files, numbers and time: it answers one question at a time.

Uploaded files are opened and typed values read here, apart from the server: a file that hangs or ends this
process ends nothing else. Question and answer are a line of JSON each.
"""

from __future__ import annotations

import base64
import json
import os
import sys
import threading
import time
import warnings
from collections import OrderedDict
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any, TextIO

import numpy as np

from asperity.case.cases import case_of, demo_case
from asperity.case.scene import Case
from asperity.case.toml import read_toml
from asperity.errors import AsperityError, CaseError, reason
from asperity.parameters import Origin
from asperity.sandbox import MEMORY, limit_process
from asperity.serving.case_form import case_data, form_values
from asperity.serving.uploads import examined, identifier_of, surface_named

if TYPE_CHECKING:
    from asperity.serving.contact_preview import PressedSample

KEPT = 4
"""Contacts that stay laid ready: as many tabs may be open."""
LEAVING = 1.0
"""Time that an answer has to be finished when the server has ended, s."""
MOST_CHANGED = 4  # keys that the list of runs names
_pressed: OrderedDict[str, PressedSample] = OrderedDict()


def _case(kind: str, values: dict[str, object], surfaces: str) -> Case:
    root = Path(surfaces)
    data = case_data(kind, values, lambda identifier: surface_named(root, identifier))
    return case_of(data, Origin("the case", root, units=True))


def prepare_to_press() -> dict[str, Any]:
    """Press a sample once, so that the first one finds everything imported and compiled."""
    from asperity.serving.contact_preview import PressedSample

    PressedSample(demo_case()).at(None)
    return {}


def prepare_to_show() -> dict[str, Any]:
    """Import what shows runs."""
    import asperity.serving.run_view  # noqa: F401

    return {}


def read_form(kind: str, values: dict[str, object], surfaces: str) -> dict[str, Any]:
    """Read a case from its form: its text, and what of it is changed."""
    case = _case(kind, values, surfaces)
    changed = [f"{each['key']} {each['value']}" for each in case.parameters() if not each["is_default"]]
    more = f" and {len(changed) - MOST_CHANGED} more" if len(changed) > MOST_CHANGED else ""
    return {"toml": case.to_toml(), "changed": ", ".join(changed[:MOST_CHANGED]) + more}


def press_form(
    kind: str, values: dict[str, object], surfaces: str, share: float | None, whole: bool
) -> dict[str, Any]:
    """Press the first sample of a case; `whole` asks for what does not change with the approach as well."""
    from asperity.serving.contact_preview import PressedSample

    key = json.dumps([kind, values], sort_keys=True)
    if key not in _pressed:
        _pressed[key] = PressedSample(_case(kind, values, surfaces))
        whole = True
        if len(_pressed) > KEPT:
            _pressed.popitem(last=False)
    _pressed.move_to_end(key)
    sample = _pressed[key]
    told = {"contact": sample.at(share)}
    return told | {"sample": sample.described()} if whole else told


def read_case_file(text: str, surfaces: str) -> dict[str, Any]:
    """Read a case file into the form."""
    root = Path(surfaces)
    data = read_toml(text, "case", "the case")
    case_of(data, Origin("the case", root, units=True))
    return {"kind": data["kind"], "values": form_values(data, lambda path: identifier_of(root, path))}


def show_run(path: str) -> dict[str, Any]:
    """Show a run by the path of its result."""
    from asperity.serving.run_view import viewed_run

    return viewed_run(path)


def show_beside(paths: list[str], names: list[str]) -> dict[str, Any]:
    """Show runs beside each other."""
    from asperity.serving.comparison_view import compared_runs

    return compared_runs(paths, names)


def write_comparison_page(paths: list[str], names: list[str], folder: str) -> dict[str, Any]:
    """Write the page of a comparison into a folder."""
    from asperity.serving.comparison_view import write_beside

    return write_beside(paths, names, folder)


def write_report(path: str) -> dict[str, Any]:
    """Write the report of a run, with the numbers of its figures, beside its result."""
    from asperity.results import read_result
    from asperity.scenes.report import report

    report(read_result(path), Path(path).parent)
    return {}


QUESTIONS: dict[str, Callable[..., dict[str, Any]]] = {
    "prepare to press": prepare_to_press,
    "prepare to show": prepare_to_show,
    "check": read_form,
    "press": press_form,
    "fill": read_case_file,
    "examine": examined,
    "view": show_run,
    "compare": show_beside,
    "report": write_report,
    "comparison": write_comparison_page,
}


def answer_all() -> None:
    """Answer what comes on standard input until it ends, as the process that `desk.Desk` starts."""
    answers = _own_output()
    with suppress(OSError, ValueError):
        limit_process(MEMORY)
    warnings.simplefilter("ignore")  # runs tell theirs; here nobody reads them
    for line in _questions():
        answers.write(json.dumps(_answered(line), default=_plain) + "\n")
        answers.flush()


def _questions() -> Iterator[str]:
    """Lines of standard input; where it ends while one is being answered, nobody waits for that any more."""
    waiting: SimpleQueue[str | None] = SimpleQueue()

    def read() -> None:
        for line in sys.stdin:
            waiting.put(line)
        waiting.put(None)
        time.sleep(LEAVING)
        os._exit(1)

    threading.Thread(target=read, daemon=True).start()
    while (line := waiting.get()) is not None:
        yield line


def _answered(line: str) -> dict[str, Any]:
    """The answer to one question, or why there is none."""
    question: dict[str, Any] = json.loads(line)
    name = question.pop("question")
    try:
        return QUESTIONS[name](**question)
    except CaseError as error:
        return {"refused": error.errors}
    except AsperityError as error:
        return {"refused": [str(error)]}
    except MemoryError:
        return {"refused": ["This needs more memory than the page takes. Run the case with 'asperity run'."]}
    except Exception as error:  # a fault of the program, which must not end the page
        return {"refused": [f"The program failed with {reason(error)}."]}


def _plain(value: object) -> object:
    """Arrays as single precision in base 64, for the browser's typed arrays."""
    if isinstance(value, np.ndarray):
        return base64.b64encode(np.ascontiguousarray(value, dtype="<f4").tobytes()).decode()
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(type(value).__name__)


def _own_output() -> TextIO:
    """Standard output for answers alone: what libraries print goes to standard error."""
    own = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    return own
