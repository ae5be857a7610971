"""What is kept between runs, and where."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

from asperity.files import amount, discard, left_overs
from asperity.store import Store, is_private, kernel_folders
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
    left = {store.root: left_overs(store.root)}
    for folder in kernel_folders():
        kernels, left[folder] = _kernels(folder)
        if kernels:
            yield "compiled functions", folder, kernels
    for folder, parts in left.items():
        if parts:
            yield "files left by interrupted runs", folder, parts


def _kernels(folder: Path) -> tuple[list[Path], list[Path]]:
    """Compiled kernels of all versions in a folder, and parts that interrupted writes left."""
    places: list[Path] = []
    with suppress(OSError):  # a name that is too long
        places = [place for place in folder.glob("[0-9a-f]" * 16) if is_private(place)]
    kernels = [file for place in places for file in place.iterdir() if not file.name.startswith(".")]
    return sorted(kernels), sorted(part for place in places for part in left_overs(place))


def _size(files: list[Path]) -> int:
    size = 0
    for file in files:
        with suppress(OSError):
            size += file.stat().st_size
    return size
