"""Charts as a page holds them, the script that draws them there, and their numbers where it does not run."""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np

from asperity.reporting.chart import Axis, Chart, Field, Line, Mark, Note, Panel, Rules
from asperity.reporting.data import plain
from asperity.reporting.packed import LONG, Arrays
from asperity.reporting.part import Data
from asperity.reporting.style import envelope
from asperity.reporting.tables import Cell, ReportTable

MOST = 300_000
"""Numbers of the lines of a chart; longer ones are shown by the extremes of stretches of them."""
PIXELS, SHADES = (800, 320), 1022
"""Of a field: along x and along y, and from the lowest number to the highest."""
COLUMNS = 12
"""Of a table of numbers; fields have more."""
COLOURED = ("colour", "fill", "edge")
SCRIPTS = ("numbers", "ticks", "marks", "panel", "cursor", "legend", "figures")


def charts_json(charts: Mapping[str, Chart], colours: Mapping[str, str]) -> str:
    """What the script draws, by the name of its figure, as text that may stand in a script element.

    `colours` are those of the page, in the order of its CSS variables. Drawings are left out.
    """
    arrays, look = Arrays(), list(colours)
    told = {
        name: {
            "panels": [_panel(panel, arrays, look) for panel in _thinned(chart).panels],
            "places": {place: np.asarray(found).tolist() for place, found in chart.places.items()},
        }
        for name, chart in charts.items()
        if not chart.drawing
    }
    found = {"charts": told, "colours": look, "arrays": arrays.told, "data": arrays.packed}
    text = json.dumps(found, ensure_ascii=True, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c")  # so that nothing in it ends the element


def _thinned(chart: Chart) -> Chart:
    """The chart with as many numbers as a page holds, and fields as fine as can be seen."""
    lines = [mark for panel in chart.panels for mark in panel.marks if isinstance(mark, Line)]
    steps = -(-sum(line.y.size for line in lines) // MOST)
    panels = (replace(panel, marks=tuple(_thinner(m, steps) for m in panel.marks)) for panel in chart.panels)
    return replace(chart, panels=tuple(panels))


def _thinner(mark: Mark, steps: int) -> Mark:
    """Every n-th cell of a field; of a long line the extremes of stretches of twice as many `steps`."""
    if isinstance(mark, Field):
        sizes = zip(mark.values.shape, PIXELS, strict=True)
        every = tuple(slice(None, None, -(-size // most)) for size, most in sizes)
        return replace(mark, values=mark.values[every])
    if not isinstance(mark, Line) or steps <= 1 or mark.y.size <= LONG:
        return mark
    stretches = mark.y.size // (2 * steps)
    kept = 2 * steps * stretches
    low, high = envelope(mark.y[:kept], stretches)[1:]
    return replace(mark, x=mark.x[:kept:steps], y=np.stack([low, high], axis=1).ravel())


def _panel(panel: Panel, arrays: Arrays, colours: list[str]) -> dict[str, Any]:
    """A panel in plain words and numbers, without what is the default."""

    def told(owner: Any) -> dict[str, Any]:
        held = {each.name: (getattr(owner, each.name), each.default) for each in fields(owner)}
        return {
            name: plainly(value, name, owner)
            for name, (value, default) in held.items()
            if isinstance(value, np.ndarray) or value != default
        }

    def plainly(value: Any, name: str, owner: Any) -> Any:
        match value:
            case np.ndarray() if isinstance(owner, Field):
                return {"array": arrays.place(value, True, SHADES), "shape": value.shape}
            case np.ndarray():
                return arrays.place(value, linear=not _axis(panel, owner, name).log)
            case tuple():
                return [plainly(each, name, owner) for each in value]
            case str() if name in COLOURED and value in colours:
                return f"--c{colours.index(value)}"
            case float():  # of numpy, too
                return float(value) if np.isfinite(value) else None
        if is_dataclass(value):
            kind = {"kind": type(value).__name__.lower()} if name == "marks" else {}
            return kind | told(value)
        return value

    return told(replace(panel, marks=tuple(m for m in panel.marks if not _nowhere(m))))


def _axis(panel: Panel, mark: Mark, name: str) -> Axis:
    """Axis along which an array of a mark is drawn."""
    along_y = mark.along == "y" if isinstance(mark, Rules) else name in ("y", "low", "high")
    return panel.y if along_y else panel.x


def _nowhere(mark: Mark) -> bool:
    return isinstance(mark, Note) and not np.isfinite([mark.x, mark.y]).all()


@cache
def chart_script() -> str:
    """The script of a page: the library that draws axes, with its licence, and what draws charts with it."""
    package = files("asperity.reporting")
    library = (package / "uplot" / "uPlot.iife.min.js").read_text(encoding="utf-8").partition("\n")[2]
    licence = (package / "uplot" / "LICENSE").read_text(encoding="utf-8")
    own = ((package / "charts" / f"{name}.js").read_text(encoding="utf-8") for name in SCRIPTS)
    return f'/*! uPlot 1.6.32\n{licence}\n*/\n{library}\n(() => {{\n"use strict";\n{"".join(own)}}})();\n'


@cache
def chart_style() -> str:
    """Styles of charts, and those that the library needs."""
    package = files("asperity.reporting")
    library = (package / "uplot" / "uPlot.min.css").read_text(encoding="utf-8")
    return f"{library}\n{(package / 'charts' / 'charts.css').read_text(encoding='utf-8')}"


def script_digest() -> str:
    """Digest of the script, by which a page allows it and nothing else to run."""
    return digest_of(chart_script())


def digest_of(script: str) -> str:
    """SHA-256 of a script, as policies of pages name it."""
    return base64.b64encode(hashlib.sha256(script.encode("utf-8")).digest()).decode("ascii")


def numbers_table(data: Data, most: int = 24) -> ReportTable:
    """Numbers of a figure, at most so many rows of them, for where they are not drawn."""
    columns = data.columns
    rows = max(map(len, columns.values()), default=0)
    shown, named = _spread(rows, most), [list(columns)[n] for n in _spread(len(columns), COLUMNS)]
    cells = [[Cell(_written(columns[name], row), "number") for name in named] for row in shown]
    parts = [
        f"{len(some)} of {count} {what}"
        for some, count, what in ((shown, rows, "rows"), (named, len(columns), "columns"))
        if len(some) < count
    ]
    note = f"{' and '.join(parts)}; the CSV file has all." if parts else ""
    return ReportTable("", "Numbers", named, cells, note)


def _spread(count: int, most: int) -> list[int]:
    """At most so many of `count` places, from the first to the last."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(int)).tolist()


def _written(column: np.ndarray, row: int) -> str:
    return plain(float(column[row]), 4) if row < len(column) and np.isfinite(column[row]) else "–"
