"""What is made of a finished run: its page, figures as files, sounds."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from asperity.files import refuse_unwritable, together
from asperity.kinds.report import PAGE, SUMMARY, figures_of, write_page, write_summary
from asperity.reporting.figure import chosen_figures, write_figures
from asperity.reporting.sound import TABLE, listen
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


def figures_into(run: Path, folder: Path | None, format: str, names: Sequence[str]) -> dict[str, Any]:
    """Draw figures of the run in a file or folder, by default into ``figures`` beside it, all or none."""
    target = folder or (run if run.is_dir() else run.parent) / "figures"
    refuse_unwritable(target, "folder of the figures", "Choose another folder with -o.")
    tree = read_result(run)
    figures = chosen_figures(figures_of(tree), names)
    with together(target, last="") as new:
        files = [target / path.name for path in write_figures(tree, figures, new, format)]
    say(f"Figures: {target.absolute()}, {', '.join(path.name for path in files) or 'none'}")
    return {
        "run": str(run.resolve()),
        "file_format": format,
        "titles": {figure.name: figure.title for figure in figures},
        "warnings": [],
        "files": {figure.name: str(path.resolve()) for figure, path in zip(figures, files, strict=True)},
    }


def listen_into(run: Path, folder: Path | None, what: str | None, *, matched: bool) -> dict[str, Any]:
    """Write the sounds of the run in a file or folder, by default into ``sounds`` beside it."""
    tree = read_result(run)
    target = folder or (run if run.is_dir() else run.parent) / "sounds"
    files = listen(tree, target, what=what, matched=matched)
    scale = "all as loud as each other" if matched else "all on one scale"
    say(f"Sounds: {target.absolute()}, {len(files)} files, {scale}; {TABLE} says which is which")
    return {
        "run": str(run.resolve()),
        "matched": matched,
        "warnings": [],
        "files": {path.name: str(path.resolve()) for path in files},
    }
