"""Compute a case into a folder, and never over the run of another case."""

from __future__ import annotations

import json
from pathlib import Path

from asperity.cli.planning import announce_scan
from asperity.config.case import Case
from asperity.errors import InputError
from asperity.files import alone_in, refuse_unwritable, require_space
from asperity.progress import progress_bar
from asperity.terminal import say


def run_into(
    case: Case, directory: Path, *, source: str = "case", report: bool = True, overwrite: bool = False
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

    Raises
    ------
    InputError
        If the case cannot be computed, or its results not go into `directory`.
    """
    refuse_folder(case, directory, overwrite=overwrite)
    with alone_in(directory):
        refuse_folder(case, directory, overwrite=overwrite)  # another run may have ended meanwhile
        _run_alone(case, directory, source, report=report)


def _run_alone(case: Case, directory: Path, source: str, *, report: bool) -> None:
    """Compute a case and write its results, while no other run does into this folder."""
    from asperity.kinds import report as reports
    from asperity.results import save
    from asperity.running import prepare_case, run
    from asperity.store import Store

    prepared = prepare_case(case, source)
    with progress_bar() as progress:
        announce_scan(prepared, progress)
        tree = run(prepared, progress=progress)
    for warning in json.loads(tree.attrs.get("warnings", "[]")):
        times = f" ({warning['count']} times)" if warning["count"] > 1 else ""
        grade = warning.get("grade", "warning").capitalize()
        say(f"{grade}: {warning['message']}{times}", err=True)
    written = save(tree, directory / "run.nc")
    reports.remove_report(directory)
    if verdict := tree.attrs.get("verdict"):
        say(verdict)
    say(f"Results: {written.resolve()}")
    if report:
        page = reports.report(tree, directory)
        say(f"Report:  {page.resolve()}")
    store = Store()
    if size := store.size():
        kept = f"{size / 2**20:.1f} MiB of finished work in {store.root}"
        say(f"Kept:    {kept} (asperity cache --clear deletes it)", err=True)


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
