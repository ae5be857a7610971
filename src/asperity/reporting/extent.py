"""Where things stand in a chart: its panels in rows, and how far the axes of a panel reach."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from asperity.reporting.chart import Area, Boxes, Chart, Field, Line, Mark, Numbers, Panel, Shape

MARGIN = 0.04
"""Share of the height of a panel that is left free above and below its marks."""


def rows_of(chart: Chart) -> list[list[Panel]]:
    """Panels of a chart that stand in one row."""
    rows: list[list[Panel]] = []
    for panel in chart.panels:
        if panel.beside and rows:
            rows[-1].append(panel)
        else:
            rows.append([panel])
    return rows


def limits(panel: Panel, way: str) -> tuple[float, float]:
    """Ends of an axis of a panel, ``"x"`` or ``"y"``; as far as its marks reach where it does not say so."""
    axis = panel.x if way == "x" else panel.y
    if axis.low is not None and axis.high is not None:
        return axis.low, axis.high
    found = np.concatenate([np.zeros(0), *(np.ravel(n) for mark in panel.marks for n in _reached(mark, way))])
    found = found[np.isfinite(found) & (found > 0 if axis.log else True)]
    low, high = (float(found.min()), float(found.max())) if found.size else (1.0, 10.0)
    if axis.log:
        room = (high / low) ** MARGIN if high > low else 1.2
        wider = low / room, high * room
    else:
        room = MARGIN * (high - low) or 0.5 * abs(high) or 1.0
        wider = low - room, high + room
    low, high = wider if way == "y" or low == high else (low, high)
    return low if axis.low is None else axis.low, high if axis.high is None else axis.high


def _reached(mark: Mark, way: str) -> Iterator[Numbers | tuple[float, float]]:
    """Numbers of a mark along an axis; rules and notes stand where there is room."""
    match mark:
        case Line() | Shape():
            yield mark.x if way == "x" else mark.y
        case Area():
            yield from (mark.x,) if way == "x" else (mark.low, mark.high)
        case Boxes():
            yield from (mark.left, mark.right) if way == "x" else (mark.low, mark.high)
        case Field():
            yield mark.x if way == "x" else mark.y
