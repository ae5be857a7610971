"""Write the sounds of a run, and say where they are."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from asperity.reporting.sound import TABLE, listen
from asperity.results import read_result
from asperity.terminal import say


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
