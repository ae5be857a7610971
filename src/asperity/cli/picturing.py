"""Draw the figures of a run to files, and say where they are."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from asperity.files import refuse_unwritable, together
from asperity.kinds.report import parts_of
from asperity.reporting.part import chosen_parts, write_figures
from asperity.results import read_result
from asperity.terminal import say


def figures_into(run: Path, folder: Path | None, format: str, names: Sequence[str]) -> dict[str, Any]:
    """Draw figures of the run in a file or folder, by default into ``figures`` beside it, all or none."""
    target = folder or (run if run.is_dir() else run.parent) / "figures"
    refuse_unwritable(target, "folder of the figures", "Choose another folder with -o.")
    tree = read_result(run)
    parts = chosen_parts(parts_of(tree), names)
    with together(target, last="") as new:
        files = [target / path.name for path in write_figures(tree, parts, new, format)]
    say(f"Figures: {target.absolute()}, {', '.join(path.name for path in files) or 'none'}")
    return {
        "run": str(run.resolve()),
        "file_format": format,
        "titles": {part.name: part.title for part in parts},
        "warnings": [],
        "files": {part.name: str(path.resolve()) for part, path in zip(parts, files, strict=True)},
    }
