"""Compare runs into a folder: a page and a table, and what they say in short."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray

from asperity.files import refuse_unwritable
from asperity.kinds.comparing import compared_levels, named_runs, shown_levels, write_comparison
from asperity.reporting.comparison import compared
from asperity.reporting.comparison_page import listed_keys, summary
from asperity.reporting.data import signed
from asperity.terminal import say, say_table


def compare_into(paths: Sequence[Path], target: Path, laws: Sequence[str]) -> dict[str, Any]:
    """Compare runs, write page and table, and return what a program wants to know."""
    folder = target.parent if target.suffix.lower() == ".html" else target
    refuse_unwritable(folder, "folder of the comparison", "Choose another folder with -o.")
    runs = named_runs(paths)
    entries = compared_levels(runs)
    table = compared(runs, entries, laws)
    levels = shown_levels(table, entries)
    cases = json.loads(table.attrs["cases"])
    names = [run.name for run in runs]
    _show_cases(names, listed_keys(table))
    _show_changes(names, table, levels)
    say(words := summary(runs, table, levels))
    page, rows = write_comparison(runs, table, levels, target)
    say(f"Page:    {page.resolve()}")
    say(f"Table:   {rows.resolve()}")
    return {
        "runs": [
            {"name": run.name, "path": str(path.resolve())} for run, path in zip(runs, paths, strict=True)
        ],
        "summary": words,
        "cases": cases,
        "laws": table["law"].values,
        "bands": table["band"].values if "band" in table else [],
        "levels": {
            name: {
                "meaning": title,
                "units": table[name].attrs["units"],
                "level": table[name].values,
                "difference": table[f"{name}_difference"].values,
                "a_weighted": table[f"{name}_a"].values,
                "a_weighted_difference": table[f"{name}_a_difference"].values,
            }
            for name, title in levels.items()
        },
        "warnings": [],
        "files": {"page": str(page.resolve()), "table": str(rows.resolve())},
    }


def _show_cases(names: Sequence[str], cases: Sequence[dict[str, Any]]) -> None:
    rows = [
        [item["key"], *("–" if value is None else str(value) for value in item["values"])] for item in cases
    ]
    if rows:
        say_table("Keys that differ", ["key", *names], rows, width=120)


def _show_changes(names: Sequence[str], table: xarray.Dataset, levels: dict[str, str]) -> None:
    """Print A-weighted differences to the first run, by law and run."""
    rows = []
    for r in range(1, len(names)):
        for k, law in enumerate(map(str, table["law"].values)):
            changes = [float(table[f"{name}_a_difference"].values[r, k]) for name in levels]
            if np.isfinite(changes).any():
                rows.append([names[r], law, *map(signed, changes)])
    say_table(f"A-weighted, less {names[0]}, in dB", ["run", "law", *levels.values()], rows, width=120)
