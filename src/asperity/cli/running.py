"""Whether a case has been run already: by the same program, from files that hold the same."""

from __future__ import annotations

import hashlib
import json
import os
import re
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import asperity
from asperity.arguments import no_file
from asperity.config.case import Case
from asperity.config.content import content, file_digest
from asperity.errors import InputError
from asperity.files import (
    alone_in,
    discard,
    refuse_unwritable,
    remove_left_overs,
    require_space,
    together,
)
from asperity.progress import COMPILATION, duration, progress_bar
from asperity.schema import provenance, rolling, spectra
from asperity.store import content_key
from asperity.terminal import detail, remark, say

if TYPE_CHECKING:
    from xarray import DataTree

    from asperity.scenarios.preparing import PreparedCase

_LINKED = re.compile(r'href="([\w.-]+\.(?:csv|svg))"')
"""Files that a page offers beside it."""


def name_of_run(case: Case) -> str:
    """Name a run by all it depends on: case, contents of its files, program; empty where that is unknown."""
    try:
        told = json.dumps(content(case, _digest), sort_keys=True)
        return content_key("run", case.text, told, _program(), os.environ.get("ASPERITY_DEVICE", ""))
    except (InputError, OSError):  # the run will say what is wrong
        return ""


def earlier_run(name: str, directory: Path, page: Path | None, *, converge: bool) -> DataTree | None:
    """The result that a folder holds of the run of this name, with all that is asked for; else None.

    `page` is that of its report, None where none is wanted.
    """
    file = directory / "run.nc"
    if not name or no_file(file) or (page is not None and not _is_whole(page, file)):
        return None
    from asperity.results import read_result

    try:
        tree = read_result(file)
    except InputError:
        return None
    same = tree.attrs.get(provenance.RUN.name) == name
    return tree if same and (not converge or "convergence" in tree.children) else None


def _is_whole(page: Path, result: Path) -> bool:
    """Whether a page is that of the result beside it, written before it, and all that it offers is there."""
    if no_file(page) or page.stat().st_mtime_ns < result.stat().st_mtime_ns:
        return False
    linked = set(_LINKED.findall(page.read_text(encoding="utf-8", errors="replace")))
    return not any(no_file(page.parent / name) for name in linked)


def _digest(path: Path) -> str:
    if received := no_file(path):
        raise InputError(str(path), received, "a file")
    return file_digest(path)


def _program() -> str:
    """SHA-256 over the sources of the program: its version alone says nothing while it is worked on."""
    found = hashlib.sha256(asperity.__version__.encode())
    for name, text in _sources(Path(asperity.__file__).parent):
        found.update(name.encode() + b"\0" + text)
    return found.hexdigest()


def _sources(folder: Path) -> Iterator[tuple[str, bytes]]:
    for path in sorted(folder.rglob("*")):
        if path.is_file() and "__pycache__" not in path.parts and path.suffix not in (".pyc", ".part"):
            yield str(path.relative_to(folder)), path.read_bytes()


PAGE = "report.html"
READING = "reading and laying out the case"


def run_into(
    case: Case,
    directory: Path,
    *,
    report: bool = True,
    source: str = "case",
    overwrite: bool = False,
    converge: bool = False,
) -> dict[str, Any]:
    """Compute a case and write its results; return what a program wants to know of them.

    Parameters
    ----------
    case : Case
        The case.
    directory : Path
        Where ``run.nc``, ``report.html`` and the CSVs go.
    report : bool
        Whether the page and the CSVs are written.
    source : str
        Name of the case, for messages.
    overwrite : bool
        Whether the run of another case in `directory` may be replaced.
    converge : bool
        Whether it is computed again with each of its settings made finer, once its own results are written.

    Raises
    ------
    InputError
        If the case cannot be computed, or its results not go into `directory`.
    """
    _refuse_full(case, directory)
    with alone_in(directory):
        refuse_folder(case, directory, overwrite=overwrite)
        tree = _run_alone(case, directory, source, report=report, converge=converge)
    return _told(tree, source, _files(directory, report=report), computed=True)


def told_of_earlier(
    case: Case, directory: Path, *, report: bool, source: str = "case", converge: bool = False
) -> dict[str, Any] | None:
    """Say that a folder holds the run of a case already, if it does; return what a program wants to know."""
    written = _files(directory, report=report)
    tree = earlier_run(name_of_run(case), directory, written.get("Report"), converge=converge)
    if tree is None:
        return None
    _warn(tree)
    remark("Nothing to do: this case has been run, with the same files and program (--again runs it).")
    return _told(tree, source, written, computed=False)


def prepared_case(case: Case, source: str) -> PreparedCase:
    """Read and lay out all that a case needs, and say so if that takes long."""
    from asperity.running import prepare_case

    with progress_bar() as progress:
        progress(0, 1, READING)
        prepared = prepare_case(case, source)
        progress(1, 1, READING)
    return prepared


def _run_alone(case: Case, directory: Path, source: str, *, report: bool, converge: bool) -> DataTree:
    """Compute a case and write its results, while no other run does into this folder."""
    from asperity.cli.planning import announce_scan
    from asperity.running import run
    from asperity.store import Store

    before, name = (time.monotonic(), COMPILATION.seconds), name_of_run(case)
    prepared = prepared_case(case, source)
    with progress_bar() as progress:
        announce_scan(prepared)
        tree: DataTree = run(prepared, progress=progress)
    if name and name == name_of_run(case):  # no file was changed meanwhile
        tree.attrs[provenance.RUN.name] = name
    _warn(tree)
    if not converge:
        del prepared  # what it holds is not needed beside what is written
    _write(tree, directory, report=report)
    if converge:
        from asperity.convergence.running import with_convergence

        with progress_bar() as progress:
            tree = with_convergence(prepared, tree, progress)
        _write(tree, directory, report=report)
    _say_time(before)
    store = Store()
    remove_left_overs(store.root)
    if size := store.size():
        kept = f"{size / 2**20:.1f} MiB of finished work in {store.root}"
        remark(f"Kept:    {kept} (asperity cache --clear deletes it)")
    return tree


def _warnings(tree: DataTree) -> list[dict[str, Any]]:
    return [{"grade": "warning", **warning} for warning in json.loads(tree.attrs.get("warnings", "[]"))]


def _warn(tree: DataTree) -> None:
    for warning in _warnings(tree):
        times = f" ({warning['count']} times)" if warning["count"] > 1 else ""
        say(f"{warning['grade'].capitalize()}: {warning['message']}{times}", err=True)


def _told(tree: DataTree, source: str, written: Mapping[str, Path], *, computed: bool) -> dict[str, Any]:
    """Say what a run found and where it lies; return what a program wants to know of it."""
    if verdict := tree.attrs.get("verdict"):
        say(verdict)
    for name, path in written.items():
        say(f"{name}:{'':{8 - len(name)}}{path.resolve()}")
    return {
        "case": source,
        "kind": tree[provenance.KIND.group].attrs[provenance.KIND.name],
        "computed": computed,
        "verdict": tree.attrs.get("verdict", ""),
        "laws": law_summaries(tree),
        **band_summaries(tree),
        "warnings": _warnings(tree),
        "files": {name.lower(): str(path.resolve()) for name, path in written.items()},
    }


def _say_time(before: tuple[float, float]) -> None:
    """Say what all took, and how much of it was compiling, which later runs need not do."""
    whole, compiling = time.monotonic() - before[0], COMPILATION.seconds - before[1]
    told = f", of which {duration(compiling)} compiled {COMPILATION.functions} functions" if compiling else ""
    detail(f"Time:    {duration(whole)}{told}")


def law_summaries(tree: DataTree) -> list[dict[str, Any]]:
    """Numbers of each law's force, in SI: mean, rms about it, largest, and losses of contact."""
    found = []
    group = tree["rolling"].to_dataset()
    for law in group["law"].values.tolist():
        here = group.sel(law=law).isel({rolling.CONTACT.name: 0}, missing_dims="ignore")
        force = here[rolling.CONTACT_FORCE.name]
        numbers = {"mean_force": force.mean(), "rms_force": force.std(), "peak_force": force.max()}
        lost = (rolling.CONTACT_LOSS_SHARE, rolling.CONTACT_LOSS_EVENTS, rolling.LONGEST_LOSS)
        numbers |= {entry.name: here[entry.name] for entry in lost if entry.name in here}
        found.append({"law": law} | {name: float(value) for name, value in numbers.items()})
    return found


def band_summaries(tree: DataTree) -> dict[str, Any]:
    """Centres of the one-third octaves, Hz, and the force level of each law in them, dB re 1 N."""
    group = tree["spectra"].to_dataset()
    if spectra.FORCE_LEVEL.name not in group:
        return {"bands": [], "force_level": {}}
    level = group[spectra.FORCE_LEVEL.name]
    bands = group[spectra.BAND.name].values
    return {
        "bands": bands,
        "force_level": {str(law): level.sel(law=law).values for law in level["law"].values},
    }


def _files(directory: Path, *, report: bool) -> dict[str, Path]:
    """What is written, and where: results, and the report if it is wanted."""
    return {"Results": directory / "run.nc"} | ({"Report": directory / PAGE} if report else {})


def _write(tree: DataTree, directory: Path, *, report: bool) -> None:
    """Write a result, and its report if it is wanted, in place of earlier ones.

    What an earlier report has beyond this one goes: it would not belong to the run beside it.
    """
    from asperity.results import save

    with together(directory, last=PAGE) as new:
        save(tree, new / "run.nc")
        if report:
            from asperity.kinds.report import write_page

            write_page(tree, new / PAGE)
        if (directory / PAGE).exists():
            from asperity.kinds.report import names_of_reports

            for name in names_of_reports():
                if not (new / name).exists():
                    discard(directory / name)


def _expected_size(case: Case) -> float:
    """Bytes of results, about: a dozen numbers per law and time step, in run.nc and again as text."""
    return 400.0 * len(case.laws) * case.rolled_time / case.time_step


def _refuse_full(case: Case, directory: Path) -> None:
    """Refuse a folder that cannot be written to, or whose disk is too full."""
    refuse_unwritable(directory, "folder of the results", "Choose another folder with -o.")
    require_space(directory, _expected_size(case))


def refuse_folder(case: Case, directory: Path, *, overwrite: bool = False) -> None:
    """Refuse a folder that cannot be written to, or that holds what is not this case's own run.

    Parameters
    ----------
    case : Case
        The case.
    directory : Path
        Where its results shall go.
    overwrite : bool
        Whether the run of another case may be replaced.

    Raises
    ------
    InputError
        If results cannot go there.
    ComputationError
        If the disk is too full for them.
    """
    _refuse_full(case, directory)
    if overwrite:
        return
    allowed = "a new folder, or the folder of an earlier run of the same case"
    remedy = "Choose another folder with -o, or replace it with --overwrite."
    if (directory / "run.nc").exists():
        from asperity.results import case_text

        try:
            earlier = case_text(directory / "run.nc")
        except InputError:
            raise InputError(str(directory), "a run.nc that cannot be read", allowed, remedy) from None
        if earlier != case.text:
            raise InputError(str(directory), "the run of another case", allowed, remedy)
    elif (directory / PAGE).exists():
        raise InputError(str(directory), "a report.html without its run.nc", allowed, remedy)
