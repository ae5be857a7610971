"""What is kept between runs, and where."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

from asperity.files import amount, discard
from asperity.kernels.folders import folders, kept_files
from asperity.store import Store
from asperity.terminal import say


def show_kept(*, clear: bool = False) -> dict[str, Any]:
    """Print what is kept, how much it is and where; delete it if asked, but for what another run writes."""
    told = []
    for what, where, files in _kept():
        size = _size(files)
        if clear:
            for file in files:
                discard(file)
        say(f"{where}: {len(files)} {what}{' deleted' if clear else ''}, {amount(size)}")
        told.append({"what": what, "folder": str(where), "count": len(files), "bytes": size})
    return {"kept": told, "deleted": clear, "warnings": []}


def _kept() -> Iterator[tuple[str, Path, list[Path]]]:
    """What is kept, where, and its files; results are named even where there are none."""
    store = Store()
    yield "results", store.root, store.files()
    left = {store.root: store.left_overs()}
    for folder in folders():
        kernels, left[folder] = kept_files(folder)
        if kernels:
            yield "compiled functions", folder, kernels
    for folder, parts in left.items():
        if parts:
            yield "files left by interrupted runs", folder, parts


def _size(files: list[Path]) -> int:
    size = 0
    for file in files:
        with suppress(OSError):
            size += file.stat().st_size
    return size
