"""Runs of the page on disk: a folder each, named at random, in which it can be seen what became of it."""

from __future__ import annotations

import hashlib
import json
import re
import secrets
import shutil
from collections.abc import Iterator
from contextlib import suppress
from datetime import datetime
from pathlib import Path
from typing import Any

from asperity.case.toml import LARGEST_CASE
from asperity.errors import InputError
from asperity.files import discard, write_bytes
from asperity.printable import printable
from asperity.text_files import read_text

CASE, RESULT, REPORT, SOUNDS = "case.toml", "run.nc", "report.html", "sounds"
COMPARISON = "comparison.html"
_FACTS, _OUTCOME = "run.json", "outcome.json"
_IDENTIFIER = re.compile(r"[0-9a-f]{16}")
LONGEST_NAME = 80


def new_identifier() -> str:
    """Make a name that nobody can guess."""
    return secrets.token_hex(8)


def identifier_of_runs(identifiers: list[str]) -> str:
    """Name of what is kept of several runs in this order."""
    return hashlib.sha256(",".join(identifiers).encode()).hexdigest()[:16]


def folder_of(root: Path, identifier: str) -> Path | None:
    """Folder of what is kept under an identifier; None if there is none, or it is none."""
    if not _IDENTIFIER.fullmatch(identifier):
        return None
    folder = root / identifier
    return folder if folder.is_dir() and not folder.is_symlink() else None


def kept_in(root: Path) -> Iterator[Path]:
    """Folders that are kept there, the latest first."""
    if not root.is_dir():
        return
    found = [
        (folder.stat().st_mtime_ns, folder)
        for each in root.iterdir()
        if (folder := folder_of(root, each.name))
    ]
    yield from (folder for _, folder in sorted(found, reverse=True))


def keep_run(root: Path, case: str, *, kind: str, name: str, changed: str) -> str:
    """Make the folder of a new run with its case in TOML, and what a list of runs says of it."""
    identifier = new_identifier()
    facts = {
        "kind": kind,
        "name": shortened_name(name) or datetime.now().strftime("%d %b, %H:%M:%S"),
        "changed": changed,
        "created": datetime.now().astimezone().isoformat(timespec="milliseconds"),
    }
    write_bytes(root / identifier / _FACTS, json.dumps(facts, ensure_ascii=False).encode())
    write_bytes(root / identifier / CASE, case.encode())
    return identifier


def shortened_name(text: str) -> str:
    """Make a name that can be shown of what was typed."""
    return printable(" ".join(text.split()))[:LONGEST_NAME]


def told_of(folder: Path) -> dict[str, Any]:
    """What a run is, and what became of it: done, failed, cancelled, or interrupted where nobody knows."""
    facts, outcome = _read(folder / _FACTS), _read(folder / _OUTCOME)
    if (folder / RESULT).is_file():
        outcome = {"state": "done"}
    told = {
        "kind": "",
        "name": folder.name,
        "changed": "",
        "created": "",
        "state": "interrupted",
        "message": "",
    }
    return told | facts | outcome | {"id": folder.name}


def _read(file: Path) -> dict[str, str]:
    """Words that were kept by their names; none of a file that is missing or damaged."""
    try:
        found = json.loads(read_text(file, file.name, "JSON", largest=LARGEST_CASE))
    except (InputError, ValueError, RecursionError):
        return {}
    words = found.items() if isinstance(found, dict) else ()
    return {name: printable(word, lines=True) for name, word in words if isinstance(word, str)}


def case_of_run(folder: Path) -> str:
    """Text of the case of a run; an `InputError` if it is missing or damaged."""
    return read_text(folder / CASE, f"the case of {folder.name}", "a case", largest=LARGEST_CASE)


def write_outcome(folder: Path, state: str, message: str = "") -> None:
    """Write what became of a run that is not done, and why."""
    text = json.dumps({"state": state, "message": message}, ensure_ascii=False)
    write_bytes(folder / _OUTCOME, text.encode())


def forget_outcome(folder: Path) -> None:
    """Take back what became of a run, before it goes on."""
    discard(folder / _OUTCOME)


def remove_kept(folder: Path) -> None:
    """Delete a run, or a surface, with all its files."""
    shutil.rmtree(folder, ignore_errors=True)


def remove_unnamed(root: Path, runs: Path) -> None:
    """Delete what no case of a run names."""
    named = ""
    for folder in kept_in(runs):
        with suppress(InputError):
            named += case_of_run(folder)
    for folder in kept_in(root):
        if folder.name not in named:
            remove_kept(folder)


def keep_latest(root: Path, most: int) -> None:
    """Delete all but the latest."""
    for folder in list(kept_in(root))[most:]:
        remove_kept(folder)


def file_of_run(folder: Path, name: str) -> Path | None:
    """A file of a run that may be looked at: of its folder or its sounds, and nothing else."""
    if not re.fullmatch(r"(sounds/)?[\w.+-]+\.(nc|toml|html|csv|wav|svg|png)", name) or ".." in name:
        return None
    file = folder / name
    return file if file.is_file() and not file.is_symlink() else None
