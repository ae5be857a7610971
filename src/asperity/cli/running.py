"""Compute a case into a folder, and never over the run of another case."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

from asperity.cli.planning import announce_scan
from asperity.config.case import Case
from asperity.errors import InputError
from asperity.files import alone_in, refuse_unwritable, require_space
from asperity.progress import progress_bar
from asperity.terminal import say

if TYPE_CHECKING:
    from xarray import DataTree


def run_into(
    case: Case,
    directory: Path,
    *,
    source: str = "case",
    report: bool = True,
    overwrite: bool = False,
    converge: bool = False,
) -> None:
    """Compute a case and write its results.

    Parameters
    ----------
    case : Case
        The case.
    directory : Path
        Where ``run.nc``, ``report.html`` and the CSVs go.
    source : str
        Name of the case, for messages.
    report : bool
        Whether to write the page and the CSVs.
    overwrite : bool
        Whether the run of another case in `directory` may be replaced.
    converge : bool
        Whether it is computed again with each of its settings made finer, once its own results are written.

    Raises
    ------
    InputError
        If the case cannot be computed, or its results not go into `directory`.
    """
    refuse_folder(case, directory, overwrite=overwrite)
    with alone_in(directory):
        refuse_folder(case, directory, overwrite=overwrite)  # another run may have ended meanwhile
        _run_alone(case, directory, source, report=report, converge=converge)


def _run_alone(case: Case, directory: Path, source: str, *, report: bool, converge: bool) -> None:
    """Compute a case and write its results, while no other run does into this folder."""
    from asperity.convergence.running import with_convergence
    from asperity.kinds import report as reports
    from asperity.running import prepare_case, run
    from asperity.store import Store

    prepared = prepare_case(case, source)
    with progress_bar() as progress:
        announce_scan(prepared, progress)
        tree: DataTree = run(prepared, progress=progress)
    for warning in json.loads(tree.attrs.get("warnings", "[]")):
        times = f" ({warning['count']} times)" if warning["count"] > 1 else ""
        grade = warning.get("grade", "warning").capitalize()
        say(f"{grade}: {warning['message']}{times}", err=True)
    reports.remove_report(directory)
    written = _written(tree, directory, report=report)
    if converge:
        with progress_bar() as progress:
            tree = with_convergence(prepared, tree, progress)
        written = _written(tree, directory, report=report)
    if verdict := tree.attrs.get("verdict"):
        say(verdict)
    for name, path in written.items():
        say(f"{name}:{'':{8 - len(name)}}{path.resolve()}")
    store = Store()
    if size := store.size():
        kept = f"{size / 2**20:.1f} MiB of finished work in {store.root}"
        say(f"Kept:    {kept} (asperity cache --clear deletes it)", err=True)


def _written(tree: DataTree, directory: Path, *, report: bool) -> dict[str, Path]:
    """Write a result, and its report if it is wanted; the paths, each with what it is."""
    from asperity.kinds import report as reports
    from asperity.results import save

    written = {"Results": save(tree, directory / "run.nc")}
    if report:
        written["Report"] = reports.report(tree, directory)
    return written


def _expected_size(case: Case) -> float:
    """Bytes of results, about: a dozen numbers per law and time step, in run.nc and again as text."""
    return 400.0 * len(case.laws) * case.rolled_time / case.time_step


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
    refuse_unwritable(directory, "folder of the results", "Choose another folder with -o.")
    require_space(directory, _expected_size(case))
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
    elif (directory / "report.html").exists():
        raise InputError(str(directory), "a report.html without its run.nc", allowed, remedy)
