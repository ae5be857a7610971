"""Whether a case has been run already: by the same program, from files that hold the same."""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import asperity
from asperity.arguments import no_file
from asperity.config.case import Case
from asperity.config.content import content, file_digest
from asperity.errors import InputError
from asperity.schema import provenance
from asperity.store import content_key

if TYPE_CHECKING:
    from xarray import DataTree

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
