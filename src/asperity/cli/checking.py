"""What a case will compute, said; and said again at once while nothing that it depends on has changed."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from asperity.config.case import Case
from asperity.config.content import content, file_digest
from asperity.store import Store, content_key
from asperity.terminal import say, say_table
from asperity.threads import THREADS, processors

if TYPE_CHECKING:
    from numpy.typing import NDArray


def show_plan(case: Case, source: str, *, converge: bool = False) -> dict[str, Any]:
    """Print the values of a case, and what will be computed from it, with convergence if it is asked for.

    Returns what a program wants to know of it. An `InputError` says that the case cannot be computed.
    """
    planned = _planned(case, source, converge=converge)
    for warning in planned["warnings"]:
        say(f"{warning['grade'].capitalize()}: {warning['message']}", err=True)
    items = case.parameters()
    defaults = ["" if item["is_default"] else item["default"] or "none" for item in items]
    values = [
        (item["key"], item["value"], default, item["note"])
        for item, default in zip(items, defaults, strict=True)
    ]
    changed = {number for number, item in enumerate(items) if not item["is_default"]}
    headings = ("key", "value", "default", "what it is")
    say_table(f"{source}: a valid case", headings, values, width=120, bold=changed)
    rows = [(row["name"], row["value"]) for row in planned["plan"]]
    say_table("What will be computed", (), rows, width=120)
    return {"case": source, "kind": case.kind, "parameters": items, **planned}


def _planned(case: Case, source: str, *, converge: bool) -> dict[str, Any]:
    """Plan of a case, see `asperity.cli.planning.planned`; that of an earlier check if it is the same."""
    import numpy as np

    store, key = Store(), _key(case, converge=converge)
    if (kept := store.get(key)) is not None:
        found: dict[str, Any] = json.loads(kept["plan"].tobytes())
        return found
    from asperity.cli.planning import planned
    from asperity.cli.running import prepared_case

    found = planned(prepared_case(case, source), converge=converge)
    text: NDArray[np.uint8] = np.frombuffer(json.dumps(found).encode(), dtype=np.uint8)
    store.put(key, {"plan": text})
    return found


def _key(case: Case, *, converge: bool) -> str:
    """Name of a plan: the case with all that its files hold, this program, and what it computes on."""
    package = Path(__file__).parents[1]
    program = [[file.name, *os.stat(file)[6:9:2]] for file in sorted(package.rglob("*.py"))]  # size, change
    files = content(case, lambda path: f"{path} {file_digest(path)}")
    machine = [processors(), os.environ.get(THREADS, ""), os.environ.get("ASPERITY_DEVICE", "")]
    return content_key("plan", files, converge, machine, program)
