"""What a case will compute, said; and said again at once while nothing that it depends on has changed."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any

import numpy as np

from asperity.case.any_case import AnyCase, ReadyCase
from asperity.cli.running import described_scan, name_of_run, prepared_case
from asperity.errors import Grade
from asperity.progress import duration, progress_bar
from asperity.store import Store, content_key
from asperity.terminal import say, say_table
from asperity.threads import THREADS, processors

if TYPE_CHECKING:
    from asperity.scenarios.law_choice import LawChoice
    from asperity.scenarios.preparing import PreparedCase, Work

Rows = list[tuple[str, str]]
"""Names, and values with their units."""


def show_plan(case: AnyCase, source: str) -> dict[str, Any]:
    """Print the values of a case, and what will be computed from it.

    Returns what a program wants to know of it. An `InputError` says that the case cannot be computed.
    """
    found = _kept_plan(case, source)
    for warning in found["warnings"]:
        say(f"{warning['grade'].capitalize()}: {warning['message']}", err=True)
    items = case.parameters()
    changed = {number for number, item in enumerate(items) if not item["is_default"]}
    values = [
        (item["key"], item["value"], item["default"] or "none" if n in changed else "", item["note"])
        for n, item in enumerate(items)
    ]
    headings = ("key", "value", "default", "what it is")
    say_table(f"{source}: a valid case", headings, values, width=120, bold=changed)
    rows = [(row["name"], row["value"]) for row in found["plan"]]
    say_table("What will be computed", (), rows, width=120)
    return {"case": source, "kind": case.kind, "parameters": items, **found}


def _kept_plan(case: AnyCase, source: str) -> dict[str, Any]:
    """The plan of an earlier check, if case, files, program and processors are the same; else a new one."""
    store, name = Store(), name_of_run(case)
    key = content_key("plan", name, processors(), os.environ.get(THREADS, ""))
    if name and (kept := store.get(key)) is not None:
        found: dict[str, Any] = json.loads(kept["plan"].tobytes())
        return found
    found = planned(prepared_case(case, source))
    store.put(key, {"plan": np.frombuffer(json.dumps(found).encode(), dtype=np.uint8)})
    return found


def planned(prepared: ReadyCase) -> dict[str, Any]:
    """What will be computed from a case: rows, seconds and warnings."""
    from asperity.scenarios.law_choice import law_choice
    from asperity.scenarios.preparing import PreparedCase, expect
    from asperity.scenes.validity import foreseen

    caught = [(getattr(each.message, "grade", Grade.WARNING), str(each.message)) for each in prepared.caught]
    if isinstance(prepared, PreparedCase):
        with progress_bar() as progress:
            work = expect(prepared, progress)
            case = prepared.case, prepared.shape, prepared.textures
            choice = law_choice(*case, prepared.scene)
            rows = plan(prepared, work, choice)
            faults = [] if work.tried is None else foreseen(*case, work.tried, choice)
        caught += [(each.grade, each.message) for each in faults if each.grade]
    else:
        from asperity.scenarios.bearing import PreparedBearing, expected

        assert isinstance(prepared, PreparedBearing)
        rows, work = expected(prepared)
        rows.append(_work(work))
    return {
        "plan": [{"name": name, "value": value} for name, value in rows],
        "work": {
            "seconds": work.seconds,
            "solutions": work.solutions,
            "steps": work.steps,
            "bytes": sum(scan.bytes for scan in work.scans.values()),
        },
        "warnings": [{"grade": grade.value, "message": message} for grade, message in caught],
    }


def plan(prepared: PreparedCase, work: Work, choice: LawChoice | None = None) -> Rows:
    """List what will be computed and how much work it is, from `asperity.scenarios.preparing.expect`."""
    from asperity.scenarios.reducing import STATES
    from asperity.scenes.track import planned_track

    case, (nx, ny) = prepared.case, prepared.shape.body.shape
    contact, settling = case.contact, case.settled_time
    states = STATES if contact.approaches is None else len(contact.approaches)
    first, last = case.rolled_range
    points = round((last - first) / contact.spacing) + 1
    offsets = prepared.scene.offsets
    places = f"{min(offsets):g} to {max(offsets):g} m ahead of the position"
    run_in = f", and {settling:g} s before it" if settling else ""
    rows = [
        ("textures", prepared.textures.origin),
        ("path", f"{last - first:g} m from {first:g} m, {points} points {contact.spacing * 1e6:g} µm apart"),
        ("time", f"{case.rolled_time:g} s{run_in}, {work.steps} steps of {case.time_step * 1e6:.4g} µs"),
        *([("contacts", f"{len(offsets)}, {places}")] if len(offsets) > 1 else []),
        *planned_track(prepared),
        ("laws", ", ".join(case.laws)),
        ("contact", f"{nx} × {ny} cells, {contact.samples} samples, {states} approaches"),
    ]
    if work.tried is not None:  # a sample
        share = f"about {100 * work.tried.pressed.area_ratio:.0f} % of the area of smooth bodies"
        rows.append(("real contact", share))
    rows += choice.rows() if choice is not None else []
    rows += [(f"contact solutions, {name}", f"at most {count}") for name, count in work.solutions.items()]
    if scan := work.scans.get("path"):
        rows.append(("scan of the path", described_scan(scan)))
    return [*rows, _work(work)]


def _work(work: Work) -> tuple[str, str]:
    return "work", f"about {duration(float(f'{work.seconds:.1g}'))}, less what the cache holds"
