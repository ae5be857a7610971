"""What is made of finished runs: reports, figures, comparisons, sounds; and what is kept between runs."""

import re
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from asperity.cli.commands import require_writable
from asperity.files import amount, discard, left_overs, together
from asperity.reporting import data, signal_files, sound
from asperity.reporting.comparison_page import summary
from asperity.reporting.figure import chosen_figures, write_figures
from asperity.results import read_result
from asperity.scenes.report import comparison_of, figures_of, write_comparison, write_page, write_summary
from asperity.store import Store, is_private, kernel_folders
from asperity.terminal import say, say_files, say_table
from asperity.written_numbers import count_of

ONE_OF = {
    "results": "result",
    "compiled functions": "compiled function",
    "files left by interrupted runs": "file left by interrupted runs",
}
"""Of what is kept between runs."""
_KERNEL = re.compile(r"asperity[\w.<>]+-[0-9a-f]{24}")
"""Name of a compiled function that is kept."""


def _folder_beside(run: Path, chosen: Path | None, name: str = "") -> Path:
    """A folder of one's choice, or by default one of this name in that of a run."""
    return chosen or (run if run.is_dir() else run.parent) / name


def report_again(run: Path, directory: Path | None, *, summary: bool) -> None:
    """Write the page of a run, or its summary alone; by default beside it."""
    target = _folder_beside(run, directory)
    require_writable(target, "report")
    tree = read_result(run)
    what, write = ("summary", write_summary) if summary else ("report", write_page)
    with together(target, last=(name := f"{what}.html")) as new:
        write(tree, new / name)
    say_files({what: target / name})


def draw_figures(run: Path, directory: Path | None, format: str, names: Sequence[str]) -> None:
    """Draw figures of a run, by default into ``figures`` beside it, all or none."""
    target = _folder_beside(run, directory, "figures")
    require_writable(target, "figures")
    tree = read_result(run)
    drawn = chosen_figures(figures_of(tree), names)
    with together(target, last="") as new:
        files = write_figures(drawn, new, format)
    say(f"Figures: {target.absolute()}, {', '.join(path.name for path in files) or 'none'}")


def write_sounds(run: Path, directory: Path | None, what: str | None, *, matched: bool) -> dict[str, Any]:
    """Write the sounds of a run, by default into ``sounds`` beside it."""
    target = _folder_beside(run, directory, "sounds")
    files = sound.listen(read_result(run), target, what=what, matched=matched)
    scale = "all as loud as each other" if matched else "all on one scale"
    say(
        f"Sounds: {target.absolute()}, {count_of(len(files), 'file')}, {scale}; "
        f"{sound.TABLE} says which is which"
    )
    return {"run": run.resolve(), "matched": matched, "files": {path.name: path for path in files}}


def write_measured(run: Path, directory: Path | None, what: str | None, format: str) -> dict[str, Any]:
    """Write signals of a run, by default into ``signals`` beside it."""
    target = _folder_beside(run, directory, "signals")
    files = signal_files.write_signals(read_result(run), target, format=format, what=what)
    count = count_of(len(files), "file")
    table = signal_files.TABLE
    say(f"Signals: {target.absolute()}, {count}; {table} says what they are")
    return {"run": run.resolve(), "files": {path.name: path for path in files}}


def compare_runs(runs: Sequence[Path], directory: Path) -> None:
    """Compare runs into a page and a table, and say in short what differs."""
    folder = directory.parent if directory.suffix.lower() == ".html" else directory
    require_writable(folder, "comparison")
    found = comparison_of(runs)
    table = found.table
    names = found.names
    keys = [[i["key"], *("–" if v is None else str(v) for v in i["values"])] for i in found.keys]
    if keys:
        say_table("Keys that differ", ["key", *names], keys, width=120)
    changes = np.stack([table[f"{name}_a_difference"].values for name in found.levels], axis=-1)
    rows = [
        [names[r], str(law), *map(data.signed, changes[r, k])]
        for r in range(1, len(names))
        for k, law in enumerate(table["law"].values)
        if np.isfinite(changes[r, k]).any()
    ]
    say_table(f"A-weighted, less {names[0]}, in dB", ["run", "law", *found.levels.values()], rows, width=120)
    say(summary(found))
    page, numbers = write_comparison(found, directory)
    say_files({"page": page, "table": numbers})


def show_cache(*, clear: bool = False) -> dict[str, Any]:
    """Print what is kept, how much it is and where; delete it if asked, but for what another run writes."""
    store = Store()
    kept = [("results", store.root, store.files())]
    left = {store.root: store.left_overs()}
    for folder in kernel_folders():
        versions: list[Path] = []
        with suppress(OSError):  # a name that is too long
            found = folder.glob("[0-9a-f]" * 16)
            versions = [place for place in found if is_private(place) and not place.is_symlink()]
        kernels = [file for place in versions for file in place.iterdir() if _KERNEL.fullmatch(file.name)]
        left[folder] = [part for place in versions for part in left_overs(place)]
        kept += [("compiled functions", folder, sorted(kernels))] if kernels else []
    kept += [
        ("files left by interrupted runs", folder, sorted(parts)) for folder, parts in left.items() if parts
    ]
    told = []
    for what, folder, files in kept:
        size = 0
        for file in files:
            with suppress(OSError):
                size += file.stat().st_size
            if clear:
                discard(file)
        things = ONE_OF.get(what, what) if len(files) == 1 else what
        say(f"{folder}: {len(files)} {things}{' deleted' if clear else ''}, {amount(size)}")
        told.append({"what": what, "folder": folder, "count": len(files), "bytes": size})
    return {"kept": told, "deleted": clear}
