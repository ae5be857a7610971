"""What the page shows of several runs beside each other: `asperity.compare`, as tables of text."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray

from asperity.kinds.comparing import compare, compared_levels, named_runs, shown_levels
from asperity.reporting.comparison import compared
from asperity.reporting.comparison_table import summary, sure
from asperity.reporting.data import engineering, nominal_band
from asperity.reporting.tables import in_percent, signed
from asperity.schema import contact, rolling
from asperity.schema.spectra import FORCE_LEVEL

_LEVEL = FORCE_LEVEL.name
_NUMBERS = {
    "mean_force": ("mean force", "N"),
    "rms_force": ("rms about it", "N"),
    "peak_force": ("largest force", "N"),
}


def numbered_names(names: Sequence[str]) -> list[str]:
    """Names of runs, each once: those that stand there already are numbered."""
    found: list[str] = []
    for name in names:
        number, own = 1, name
        while own in found:
            number += 1
            own = f"{name} ({number})"
        found.append(own)
    return found


def compared_runs(paths: list[str], names: list[str]) -> dict[str, Any]:
    """A sentence, and tables: what differs in the cases, force and levels by the main law."""
    runs = named_runs(paths, numbered_names(names))
    entries = compared_levels(runs)
    table = compared(runs, entries)
    shown = [run.name for run in runs]
    items = json.loads(table.attrs["cases"])
    cases = [
        [item["key"], *("–" if value is None else str(value) for value in item["values"])] for item in items
    ]
    return {
        "summary": summary(runs, table, shown_levels(table, entries)),
        "cases": {"head": ["key", *shown], "rows": cases},
        "numbers": {"head": ["", *shown], "rows": _numbers(table)},
        "levels": {
            "head": ["Hz", *shown, *(f"{name} − {shown[0]}" for name in shown[1:])],
            "rows": _levels(table) if _LEVEL in table else [],
        },
        "law": str(table["law"].values[0]) if table.sizes["law"] else "",
    }


def _numbers(table: xarray.Dataset) -> list[list[str]]:
    """Force and its loss by the main law, and the stiffness at the load; a dash where there is none."""
    if not table.sizes["law"]:
        return []
    rows = [[title, *_written(table[name][:, 0], unit)] for name, (title, unit) in _NUMBERS.items()]
    lost = table[rolling.CONTACT_LOSS_SHARE.name].values[:, 0]
    rows.append(
        ["time without contact", *(in_percent(float(each)) if np.isfinite(each) else "–" for each in lost)]
    )
    stiffness = table[contact.WORKING_STIFFNESS.name]
    return [*rows, ["stiffness dF/dr at the load", *_written(stiffness, "N/m")]]


def _written(values: xarray.DataArray, unit: str) -> list[str]:
    return [engineering(float(value), unit) for value in values.values]


def _levels(table: xarray.Dataset) -> list[list[str]]:
    """Levels of the main law by band, differences to the first run, and A-weighted totals.

    In brackets where two records of this length differ as much by chance.
    """
    level, change = table[_LEVEL].values[:, 0], table[f"{_LEVEL}_difference"].values[1:, 0]
    trusted = [sure(table, run) for run in range(1, len(level))]
    rows = []
    for b, band in enumerate(table["band"].values):
        if np.isfinite(level[:, b]).any():
            differences = (
                _change(float(each[b]), bool(held[b])) for each, held in zip(change, trusted, strict=True)
            )
            rows.append([nominal_band(float(band)), *(_decibels(each[b]) for each in level), *differences])
    total, weighted = table[f"{_LEVEL}_a"].values[:, 0], table[f"{_LEVEL}_a_difference"].values[1:, 0]
    return [*rows, ["dB(A)", *map(_decibels, total), *(_change(float(each), True) for each in weighted)]]


def _decibels(level: float) -> str:
    return f"{level:.1f}".replace("-", "−") if np.isfinite(level) else "–"


def _change(value: float, trusted: bool) -> str:
    if not np.isfinite(value):
        return "–"
    return signed(value) if trusted else f"({signed(value)})"


def write_beside(paths: list[str], names: list[str], folder: str) -> dict[str, Any]:
    """Write the page of a comparison, with its table, into a folder."""
    compare(*paths, names=numbered_names(names), path=folder)
    return {}
