"""Checks a case; runs it into a folder, unless that holds the run already: of the same program and files."""

from __future__ import annotations

import hashlib
import json
import os
import time
from collections.abc import Iterable, Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import asperity
from asperity import files
from asperity.arguments import no_file
from asperity.case.any_case import AnyCase, ReadyCase, function_named
from asperity.case.form import case_key, file_digest
from asperity.cli.commands import require_writable, taken_folder
from asperity.errors import Grade, InputError, PhysicsWarning
from asperity.progress import COMPILATION, duration, progress_bar
from asperity.schema import bearing, provenance, rolling
from asperity.store import Store, content_key
from asperity.terminal import detail, remark, say, say_files, say_table
from asperity.threads import THREADS, processors
from asperity.written_numbers import rounded

if TYPE_CHECKING:
    from xarray import DataArray, DataTree

    from asperity.scenarios.preparing import Plan

RESULT, PAGE = "run.nc", "report.html"
CONVERGENCE, EFFECTS = "convergence", "effects"
"""Groups of a result that are computed if they are asked for."""
READING = "reading and laying out the case"
ANNOUNCED = 1_000_000  # contact solutions of a scan that is announced before it starts
LONG_RECORD = 30.0  # s of processor time, at least, of a case that is announced before it is laid out


def run_case(
    case: AnyCase,
    directory: Path,
    *,
    source: str = "case",
    report: bool = True,
    converge: bool = False,
    what_helps: bool = False,
    again: bool = False,
    overwrite: bool = False,
) -> dict[str, Any]:
    """Compute a case, if its folder does not hold its run already; return what a program wants to know.

    Parameters
    ----------
    case : Case
        The case.
    directory : Path
        Where ``run.nc``, ``report.html`` and the CSVs go.
    source : str
        Name of the case, for messages.
    report : bool
        Whether the page and the CSVs are written.
    converge : bool
        Whether it is computed again with each of its settings made finer, once its own results are written.
    what_helps : bool
        Whether variants of it are computed then, too, that say what makes it quieter.
    again : bool
        Whether it is computed even if the folder holds its run.
    overwrite : bool
        Whether the run of another case in `directory` may be replaced.

    Raises
    ------
    InputError
        If the case cannot be computed, or its results not go into `directory`.
    """
    tree = None
    more = [name for name, asked in ((CONVERGENCE, converge), (EFFECTS, what_helps)) if asked]
    if what_helps:
        from asperity.studies.effects import what_helps as plan

        plan(case)  # refuses a case over no track
    if not again and os.path.lexists(directory / RESULT):
        tree = earlier_result(case, directory, report=report, more=more)
    computed = tree is None
    if tree is None:
        refuse_full(case, directory)
        with files.alone_in(directory):
            if not overwrite:
                refuse_other(case, directory)
            tree = _run_alone(case, directory, source, report=report, more=more)
    else:
        warn(warnings_of(tree))
        remark("Nothing to do: this case has been run, with the same files and program (--again runs it).")
    if verdict := tree.attrs.get("verdict", ""):
        say(verdict)
    effects = None
    if what_helps:
        from asperity.cli.studying import print_effects
        from asperity.scenes.figures.effects import effects_of_run, effects_table

        if (effects := effects_of_run(tree)) is not None:
            print_effects(effects_table(effects))
    written = {"results": directory / RESULT} | ({"report": directory / PAGE} if report else {})
    say_files(written)
    return {
        "case": source,
        "kind": tree[provenance.KIND.group].attrs[provenance.KIND.name],
        "computed": computed,
        "verdict": verdict,
        "laws": law_summaries(tree),
        "what_helps": effects and effects.document,
        "warnings": warnings_of(tree),
        "files": written,
    }


def prepared_case(case: AnyCase, source: str) -> ReadyCase:
    """Read and lay out all that a case needs, and say so if that takes long."""
    from asperity.running import prepare_case

    announce_size(case)
    with progress_bar() as progress:
        progress(0, 1, READING)
        prepared = prepare_case(case, source)
        progress(1, 1, READING)
    return prepared


def _run_alone(case: AnyCase, directory: Path, source: str, *, report: bool, more: Sequence[str]) -> DataTree:
    """Compute a case, and more groups, and write its results, while no other run does into this folder."""
    from asperity.running import run
    from asperity.scenarios.compiling import compiled_ahead

    began = time.monotonic()
    compiled = COMPILATION.seconds
    name = name_of_run(case)
    with compiled_ahead(case):
        prepared = prepared_case(case, source)
        with progress_bar() as progress:
            announce_scan(prepared)
            tree: DataTree = run(prepared, progress=progress)
    if name and name == name_of_run(case):  # no file was changed meanwhile
        tree.attrs[provenance.RUN.name] = name
    warn(warnings_of(tree))
    if CONVERGENCE not in more:
        del prepared  # what it holds is not needed beside what is written
    _write(tree, directory, report=report)
    if more:
        from asperity.convergence import with_convergence
        from asperity.studies.effects import with_effects

        with progress_bar() as progress:
            if CONVERGENCE in more:
                tree = with_convergence(prepared, tree, progress)
            if EFFECTS in more:
                tree = with_effects(case, tree, progress)
        _write(tree, directory, report=report)
    spent = time.monotonic() - began
    compiling = COMPILATION.seconds - compiled
    told = f", of which {duration(compiling)} compiled {COMPILATION.functions} functions" if compiling else ""
    detail(f"Time:    {duration(spent)}{told}")
    store = Store()
    files.remove_left_overs(store.root)
    if size := store.size():
        kept = f"{size / 2**20:.1f} MiB of finished work in {store.root}"
        remark(f"Kept:    {kept} (asperity cache --clear deletes it)")
    return tree


def _write(tree: DataTree, directory: Path, *, report: bool) -> None:
    """Write a result, and its report if it is wanted, in place of earlier ones.

    What an earlier report has beyond this one goes: it would not belong to the run beside it.
    """
    from asperity.results import save

    with files.together(directory, last=PAGE) as new:
        save(tree, new / RESULT)
        if report:
            from asperity.scenes.report import write_page

            write_page(tree, new / PAGE)
        if (directory / PAGE).exists():
            from asperity.scenes.report import names_of_reports

            for name in names_of_reports():
                if not (new / name).exists():
                    files.discard(directory / name)


# --- what is said of a run


def announce_size(case: AnyCase) -> None:
    """Before a case is laid out that takes long, say what it takes at least."""
    from asperity.scenarios import run_time

    seconds = run_time.STEP * case.forces_evaluated + run_time.CELL * case.points_laid
    if seconds > LONG_RECORD:
        steps, points = (f"{rounded(count / 1e6)} million" for count in (case.steps_taken, case.points_laid))
        path = f" over {points} points of a path" * bool(case.points_laid)
        say(
            f"A long case: {steps} time steps{path}. It takes {duration(seconds)} of processor "
            f"time or more, and its results up to {files.amount(8.0 * case.numbers_written)} of memory.",
            err=True,
        )


def announce_scan(prepared: ReadyCase) -> None:
    """Before a long scan of a path starts, say how long it is."""
    from asperity.scenes.planning import described_scan

    scans_of = prepared.case.SCANNED_BY
    scan = function_named(scans_of)(prepared).get("path") if scans_of else None
    if scan is not None and scan.solutions >= ANNOUNCED:
        say(f"Scan of the path: {described_scan(scan)}.", err=True)


def warnings_of(tree: DataTree) -> list[dict[str, Any]]:
    """What a run met, each with its grade."""
    return [{"grade": "warning", **warning} for warning in json.loads(tree.attrs.get("warnings", "[]"))]


def warn(warnings: Iterable[dict[str, Any]]) -> None:
    """Say what was met, each with its grade."""
    for warning in warnings:
        times = f" ({warning['count']} times)" if warning.get("count", 1) > 1 else ""
        say(f"{warning['grade'].capitalize()}: {warning['message']}{times}", err=True)


def law_summaries(tree: DataTree) -> list[dict[str, Any]]:
    """Numbers of each law's force, in SI: mean, rms about it, largest, and losses of contact.

    Over a track the totals of its sound, dB(A), and the parts of its sound power. Of a bearing the rms
    velocities, m/s and in anderons, in the bands in which it is judged, at the first accelerometer.
    """
    from asperity.scenes import schema
    from asperity.studies.member import kept

    found = kept(tree)
    names = [*rolling.FORCES, *(entry.name for entry in (*rolling.LOSSES, *schema.TOTALS))]
    of_bearings = [
        entry.name for entry in (bearing.BAND_VELOCITY, bearing.BAND_ANDERONS) if entry.name in found
    ]
    told = of_bearings or [name for name in names if name in found]
    parts = schema.RADIATOR.name

    def numbers(of: DataArray) -> Any:
        values = of.values.tolist()
        return dict(zip(of[parts].values.tolist(), values, strict=True)) if parts in of.dims else values

    return [
        {"law": law} | {name: numbers(found[name].sel(law=law)) for name in told}
        for law in found["law"].values.tolist()
    ]


# --- the run of an earlier time


def earlier_result(case: AnyCase, directory: Path, *, report: bool, more: Sequence[str]) -> DataTree | None:
    """The result of this case that a folder holds, with all that is asked for, more groups too; else None."""
    from asperity.results import read_result

    file = directory / RESULT
    page = directory / PAGE
    name = name_of_run(case)
    if not name or no_file(file):
        return None
    if report and (no_file(page) or page.stat().st_mtime_ns < file.stat().st_mtime_ns):
        return None
    try:
        tree = read_result(file)
    except InputError:
        return None
    same = tree.attrs.get(provenance.RUN.name) == name
    return tree if same and set(more) <= set(tree.children) else None


def name_of_run(case: AnyCase) -> str:
    """Name a run by all it depends on: case, contents of its files, program; empty where that is unknown."""

    def digest(path: Path) -> str:
        if received := no_file(path):  # a pipe may never end
            raise InputError(str(path), received, "a file")
        return file_digest(path)

    try:
        device = os.environ.get("ASPERITY_DEVICE", "")
        return case_key("run", 1, case, asperity.__version__, program(), device, of_file=digest)
    except (InputError, OSError):  # the run will say what is wrong
        return ""


@cache
def program() -> str:
    """SHA-256 over the sources of the program: its version alone says nothing while it is worked on."""
    digest = hashlib.sha256()
    folder = Path(asperity.__file__).parent
    for path in sorted(folder.rglob("*")):
        if path.is_file() and "__pycache__" not in path.parts and path.suffix not in (".pyc", ".part"):
            digest.update(str(path.relative_to(folder)).encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


# --- folders


def refuse_full(case: AnyCase, directory: Path) -> None:
    """Refuse a folder that cannot be written to, or whose disk is too full for the results of a case."""
    require_writable(directory)
    files.require_space(directory, 8.0 * case.numbers_written)  # as netCDF, and again as text


def refuse_other(case: AnyCase, directory: Path) -> None:
    """Refuse a folder that holds what is not this case's own run."""
    from asperity.results import case_text

    received = ""
    if (directory / RESULT).exists():
        try:
            received = "" if case_text(directory / RESULT) == case.text else "the run of another case"
        except InputError:
            received = "a run.nc that cannot be read"
    elif (directory / PAGE).exists():
        received = "a report.html without its run.nc"
    if received:
        raise taken_folder(directory, received, "case")


# --- what will be computed


DECIDED = ("laws", "law to take", "expected errors, dB", "runs", "work")
"""Rows of a plan that are told first: what is decided in the case, and the time that it takes."""


def show_plan(case: AnyCase, source: str, *, every_key: bool) -> dict[str, Any]:
    """Print what is doubtful of a case, what will be computed, and the keys that it sets, or `every_key`.

    Returns what a program wants to know of it. An `InputError` says that the case cannot be computed.
    """
    store = Store()
    name = name_of_run(case)
    key = content_key("plan", name, processors(), os.environ.get(THREADS, ""))
    kept = store.get(key) if name else None  # of an earlier check, if all that it depends on is the same
    found = planned(prepared_case(case, source)) if kept is None else json.loads(kept["plan"].tobytes())
    if kept is None and not found["work"]["compiling_seconds"]:  # true of the first time only
        store.put(key, {"plan": np.frombuffer(json.dumps(found).encode(), dtype=np.uint8)})
    doubts = len(found["warnings"])
    told = f"{doubts} {'doubts' if doubts > 1 else 'doubt'}:" if doubts else "nothing in it is doubtful."
    say(f"{source}: a valid case, {told}")
    warn(found["warnings"])
    rows = [(row["name"], row["value"]) for row in found["plan"]]
    rows.sort(key=lambda row: DECIDED.index(row[0]) if row[0] in DECIDED else len(DECIDED))
    say_table("What will be computed", (), rows, width=120)
    _show_keys(case, every_key=every_key)
    return {"case": source, "kind": case.kind, "parameters": case.parameters(), **found}


def _show_keys(case: AnyCase, *, every_key: bool) -> None:
    """Print the keys that a case sets, or every one, those in bold."""
    items = case.parameters()
    changed = {number for number, item in enumerate(items) if not item["is_default"]}
    values = [
        (item["key"], item["value"], item["default"] or "none" if n in changed else "", item["note"])
        for n, item in enumerate(items)
        if every_key or n in changed
    ]
    headings = ("key", "value", "default", "what it is")
    if every_key:
        say_table("Every key", headings, values, width=120, bold=changed)
    elif values:
        say_table("Keys that are not at their defaults", headings, values, width=120)
    if not every_key:
        remark(f"{len(items) - len(changed)} keys are at their defaults (--keys shows them).")


def doubted(case: AnyCase, source: str) -> list[dict[str, Any]]:
    """Say what is doubtful of a case from which other work starts; of one that no run takes nothing is."""
    try:
        prepared = prepared_case(case, source)
    except InputError:
        return []
    found = [_told(each.message) for each in prepared.caught]
    warn(found)
    return found


def _told(message: Warning | str) -> dict[str, Any]:
    return {"grade": getattr(message, "grade", Grade.WARNING).value, "message": str(message)}


def planned(prepared: ReadyCase) -> dict[str, Any]:
    """What will be computed from a case: rows, seconds and warnings."""
    with progress_bar() as progress, PhysicsWarning.caught() as planning:
        found: Plan = function_named(prepared.case.PLANNED_BY)(prepared, progress)
    met = [*prepared.caught, *planning]
    work = found.work
    doubts = [_told(each.message) for each in met]
    doubts += [{"grade": each.grade.value, "message": each.message} for each in found.findings if each.grade]
    return {
        "plan": [{"name": name, "value": value} for name, value in found.rows],
        "work": {
            "seconds": work.seconds,
            "processor_seconds": work.time.processor,
            "compiling_seconds": work.compiling,
            "solutions": work.solutions,
            "steps": work.steps,
            "bytes": sum(scan.bytes for scan in work.scans.values()),
        },
        "warnings": doubts,
    }
