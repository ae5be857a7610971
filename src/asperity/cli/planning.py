"""What a case will compute, said; and said again at once while nothing that it depends on has changed."""

from __future__ import annotations

import json
import os
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

from asperity.config.case import Case
from asperity.config.content import content, file_digest
from asperity.config.sections import MeasuredLine
from asperity.errors import Grade, PhysicsWarning
from asperity.progress import duration, progress_bar
from asperity.store import Store, content_key
from asperity.terminal import say, say_table
from asperity.threads import THREADS, processors

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from asperity.scenarios.expecting import ScanSize, Work
    from asperity.scenarios.law_choice import LawChoice
    from asperity.scenarios.preparing import PreparedCase


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


ANNOUNCED = 1_000_000  # contact solutions of a scan that is announced before it starts


def planned(prepared: PreparedCase, *, converge: bool = False) -> dict[str, Any]:
    """What will be computed from a case, with convergence if it is asked for: rows, seconds and warnings."""
    from asperity.scenarios.expecting import expect
    from asperity.scenes.validity import foreseen

    with progress_bar() as progress:
        expected = expect(prepared, progress)
        rows = plan(prepared, expected)
        tried = expected.tried
        given = prepared.case, prepared.shape, prepared.textures
        faults = [] if tried is None else foreseen(*given, tried, _law_choice(prepared))
        more = [("convergence", _described_convergence(prepared, expected))] if converge else []
    return {
        "plan": [{"name": name, "value": value} for name, value in [*rows, *more]],
        "work": {
            "seconds": expected.seconds,
            "solutions": expected.solutions,
            "steps": expected.steps,
            "bytes": sum(scan.bytes for scan in expected.scans.values()),
        },
        "warnings": [
            {"grade": getattr(each.message, "grade", Grade.WARNING).value, "message": str(each.message)}
            for each in prepared.caught
        ]
        + [{"grade": each.grade.value, "message": each.message} for each in faults if each.grade],
    }


def plan(prepared: PreparedCase, expected: Work) -> list[tuple[str, str]]:
    """List what will be computed and how much work it is.

    Parameters
    ----------
    prepared : PreparedCase
        The case.
    expected : Work
        From `asperity.scenarios.expecting.expect`.

    Returns
    -------
    list of (str, str)
        Name and value, with units.
    """
    from asperity.scenarios.reducing import STATES

    choice = _law_choice(prepared)
    case, (nx, ny) = prepared.case, prepared.shape.body.shape
    contact, settling = case.contact, case.settled_time
    states = STATES if contact.approaches is None else len(contact.approaches)
    first, last = case.rolled_range
    points = round((last - first) / contact.spacing) + 1
    run_in = f", and {settling:g} s before it" if settling else ""
    scanned = expected.scans.get("path")
    return [
        *_measured(case),
        ("textures", prepared.textures.origin),
        ("path", f"{last - first:g} m from {first:g} m, {points} points {contact.spacing * 1e6:g} µm apart"),
        ("time", f"{case.rolled_time:g} s{run_in}, {expected.steps} steps of {case.time_step * 1e6:.4g} µs"),
        *prepared.kind.plan("rows")(prepared),
        ("laws", ", ".join(case.laws)),
        ("contact", f"{nx} × {ny} cells, {contact.samples} samples, {states} approaches"),
        *_running_in(prepared),
        *_real_contact(expected),
        *(choice.rows() if choice is not None else ()),
        *((f"contact solutions, {name}", f"at most {count}") for name, count in expected.solutions.items()),
        *([("scan of the path", described_scan(scanned))] if scanned else []),
        ("work", f"{about(expected.seconds)}, less what the cache holds"),
    ]


def _law_choice(prepared: PreparedCase) -> LawChoice | None:
    """Which law to take, and how far the laws are expected from `direct`."""
    from asperity.scenarios.law_choice import law_choice

    return law_choice(prepared.case, prepared.shape, prepared.textures, prepared.bodies)


def _running_in(prepared: PreparedCase) -> list[tuple[str, str]]:
    """How often the body rolls before the record, so that asperities yield."""
    from asperity.scenarios.running_in import running_in_passes, running_in_positions

    passes, hardness = prepared.case.contact.running_in, prepared.case.contact.hardness
    if passes is None or hardness is None:
        return []
    count = running_in_passes(prepared.case)
    often = f"to shakedown, about {count}" if isinstance(passes, str) else f"{count}"
    often += " pass" if count == 1 else " passes"
    positions = running_in_positions(prepared.shape, prepared.textures)
    words = f"{often} over {positions} positions"
    text = f"{words} under {prepared.shape.load:.3g} N at {hardness / 1e9:.3g} GPa"
    return [("running in", f"{text}; if interrupted, it goes on after its last pass")]


def _real_contact(expected: Work) -> list[tuple[str, str]]:
    """Real contact of the sample that was tried."""
    if expected.tried is None:
        return []
    return [
        (
            "real contact",
            f"about {100 * expected.tried.pressed.area_ratio:.0f} % of the area of smooth bodies",
        )
    ]


def about(seconds: float) -> str:
    """Write a coarse time, s, for people, to one digit or two: ``"about 20 s"``."""
    return f"about {duration(float(f'{seconds:.1g}'))}"


def _described_convergence(prepared: PreparedCase, work: Work) -> str:
    """Which settings will be made finer, in one run more each, and which cannot be."""
    import numpy as np

    from asperity.convergence.running import unchangeable

    states = np.zeros(0) if work.tried is None else work.tried.approaches
    found = unchangeable(prepared, states)
    finer = [name for name, reason in found.items() if not reason]
    text = f"{len(finer)} runs more, each about as long or a few times that: {', '.join(finer)}"
    unchanged = [f"{name} ({reason})" for name, reason in found.items() if reason]
    return f"{text}; not changed: {', '.join(unchanged)}" if unchanged else text


def described_scan(scan: ScanSize) -> str:
    """Describe the scan of a path in a sentence: its size, disk use, and what an interruption costs."""
    root, size = Store().root, f"{scan.bytes / 2**20:.1f} MiB"
    return (
        f"{scan.positions} positions {scan.step * 1e6:.4g} µm apart × {scan.states} approaches, "
        f"solved in {'single' if scan.single else 'double'} precision, "
        f"at most {scan.solutions} solutions, {size} in {root}; "
        "if interrupted or killed, it goes on after its last finished block"
    )


def announce_scan(prepared: PreparedCase) -> None:
    """Before a long scan of a path starts, say how long it is."""
    from asperity.scenarios.expecting import scan_sizes

    scan = scan_sizes(prepared.case, prepared.shape, prepared.textures).get("path")
    if scan is not None and scan.solutions >= ANNOUNCED:
        say(f"Scan of the path: {described_scan(scan)}.", err=True)


def _measured(case: Case) -> list[tuple[str, str]]:
    """Say what is in the measured files."""
    from asperity.cli.inspecting import described, described_lines
    from asperity.scenarios.records import read_lines, read_maps
    from asperity.surfaces.heightmap import HeightMap
    from asperity.surfaces.measured_lines import lines_of

    found = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PhysicsWarning)  # said before
        if case.surface.file is not None:
            found.append(("measured map", described(list(read_maps(case.surface)))))
        for name in type(case).model_fields:
            section = getattr(case, name)
            if isinstance(section, MeasuredLine) and section.line is not None:
                lines = read_lines(section, name)
                words = described([lines])
                if isinstance(lines, HeightMap):
                    words = described_lines(lines_of(lines))
                found.append((f"measured line of [{name}]", words))
    return found
