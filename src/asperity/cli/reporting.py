"""Write the report of a run again, or a summary of it, and say where it is."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from asperity.files import refuse_unwritable, together
from asperity.kinds.report import PAGE, SUMMARY, write_page, write_summary
from asperity.results import read_result
from asperity.terminal import say


def report_into(run: Path, folder: Path | None, *, summary: bool) -> dict[str, Any]:
    """Write the page of the run in a file or folder, by default beside it, or its summary alone."""
    target = folder or (run if run.is_dir() else run.parent)
    refuse_unwritable(target, "folder of the report", "Choose another folder with -o.")
    tree = read_result(run)
    name, write = (SUMMARY, write_summary) if summary else (PAGE, write_page)
    with together(target, last=name) as new:
        write(tree, new / name)
    what = "summary" if summary else "report"
    say(f"{what.capitalize()}: {(target / name).absolute()}")
    return {"run": str(run.resolve()), "warnings": [], "files": {what: str((target / name).resolve())}}
