"""Numbers of a chart as tables, for a page where no script draws it."""

from __future__ import annotations

import numpy as np

from asperity.reporting.chart import Axis, Chart, Line, Panel
from asperity.reporting.data import plain
from asperity.reporting.tables import Cell, ReportTable


def chart_tables(chart: Chart) -> list[ReportTable]:
    """A table for each axis along which lines of a chart have the same places: a row for each place."""
    along: dict[bytes, tuple[Axis, list[tuple[Panel, Line]]]] = {}
    for panel in chart.panels:
        for mark in panel.marks:
            if isinstance(mark, Line) and mark.label:
                along.setdefault(mark.x.tobytes(), (panel.x, []))[1].append((panel, mark))
    return [_table(axis, lines) for axis, lines in along.values()]


def _table(axis: Axis, lines: list[tuple[Panel, Line]]) -> ReportTable:
    names = dict(axis.ticks)
    places = lines[0][1].x.tolist()
    rows = [
        [
            Cell(names.get(place) or plain(place), "number"),
            *(number_cell(line.y[row]) for _, line in lines),
        ]
        for row, place in enumerate(places)
    ]
    titles = (", ".join(filter(None, (panel.title, line.label, panel.y.label))) for panel, line in lines)
    return ReportTable("", "Numbers", [axis.label, *titles], rows)


def number_cell(number: float) -> Cell:
    """A number, or a dash where there is none."""
    return Cell(plain(number, 4) if np.isfinite(number) else "–", "number")
