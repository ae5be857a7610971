"""What running-in did to the surface: a figure of its heights, and tables of its passes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.chart import BLUE, MUTED, Axis, Chart, Line, Panel
from asperity.reporting.data import engineering, number, present, stored_variable, values
from asperity.reporting.part import Data, Part, present_series, series
from asperity.reporting.tables import Cell, ReportTable, in_percent, text_cell
from asperity.reporting.texture_figures import SECOND_DASHES, length_unit
from asperity.schema import contact, surface

STRETCH = 10.0
"""Length of the line that is drawn, in widths of the nominal patch."""
_CONDITIONS = (contact.TRACK_RMS, contact.TRACK_SLOPE, contact.TRACK_AREA_RATIO, contact.TRACK_STIFFNESS)


def heights_data(tree: DataTree) -> Data:
    """Heights along the middle of the path, before and after running-in."""
    named = {surface.LINE_UNTOUCHED: "before running-in", surface.LINE: "after running-in"}
    return Data(series(tree, surface.DISTANCE), present_series(tree, named))


def heights_chart(tree: DataTree, data: Data) -> Chart:
    """The line before and after, where it was lowered most."""
    before, after = (data.lines[entry].values for entry in (surface.LINE_UNTOUCHED, surface.LINE))
    drawn = _most_lowered(tree, data.at, before - after)
    x, before, after = data.at[drawn], before[drawn], after[drawn]
    (along, unit), (height, symbol) = length_unit(float(np.ptp(x))), length_unit(float(np.ptp(before)))
    lines = (
        Line(x / along, before / height, "before running-in", MUTED, SECOND_DASHES, 0.9),
        Line(x / along, after / height, "after", BLUE),
    )
    distance = Axis(f"distance along the path / {unit}", x[0] / along, x[-1] / along)
    return Chart((Panel(distance, Axis(f"height / {symbol} (out of the material ↑)"), lines, height=2.9),))


def _most_lowered(tree: DataTree, x: NDArray[np.float64], lowering: NDArray[np.float64]) -> slice:
    """Points of the stretch around the deepest mark."""
    radius = number(tree, contact.HERTZ_RADIUS)
    count = len(x) if not radius else round(2 * STRETCH * radius / (x[1] - x[0]))
    first = int(np.clip(np.argmax(lowering) - count // 2, 0, max(len(x) - count, 0)))
    return slice(first, first + max(count, 2))


def _caption(tree: DataTree) -> str:
    lowering = values(tree, surface.LINE_UNTOUCHED) - values(tree, surface.LINE)
    deepest, mean = (engineering(float(found), "m") for found in (lowering.max(), lowering.mean()))
    return (
        "Heights along the middle of the path, around the place that was lowered most, before and after "
        f"running-in under the working load. Lowered by {deepest} at most, by {mean} in the mean."
    )


def _has_marks(tree: DataTree) -> bool:
    return bool((values(tree, surface.LINE_UNTOUCHED) > values(tree, surface.LINE)).any())


HEIGHTS = Part(
    "running_in",
    "Surface before and after running-in",
    (surface.LINE_UNTOUCHED, surface.LINE, surface.DISTANCE),
    heights_data,
    heights_chart,
    _caption,
    worth=_has_marks,
)


def condition_table(tree: DataTree) -> ReportTable | None:
    """The track before and after running-in."""
    if not present(tree, *_CONDITIONS):
        return None
    rows = []
    for entry in _CONDITIONS:
        found = stored_variable(tree, entry)
        assert found is not None
        pair = [float(found.sel(condition=name)) for name in ("before", "after")]
        change = pair[1] / pair[0] - 1 if pair[0] else float("nan")
        cells = [Cell(engineering(value, entry.units), "number") for value in pair]
        signed = f"{100 * change:+.1f} %".replace("-", "−") if np.isfinite(change) else "–"
        rows.append([text_cell(entry.long_name), *cells, Cell(signed, "number")])
    share = number(tree, contact.YIELDED_SHARE) or 0.0
    note = (
        f"{in_percent(share)} of the area that carried pressure has yielded. Before: the first contact, with "
        "the pressure capped at the hardness. All else in this report is of the surface after running-in."
    )
    return ReportTable(
        "running_in_statistics", "Running-in", ["quantity", "before", "after", "change"], rows, note
    )


def passes_table(tree: DataTree) -> ReportTable | None:
    """What each pass lowered."""
    if not present(tree, contact.RUNNING_IN_PASS, contact.RUNNING_IN_LOWERING):
        return None
    columns = [
        values(tree, entry)
        for entry in (contact.RUNNING_IN_PASS, contact.RUNNING_IN_LOWERING, contact.RUNNING_IN_YIELDING)
    ]
    rows = [
        [
            Cell(f"{number:.0f}", "number"),
            Cell(engineering(lowered, "m"), "number"),
            Cell(in_percent(share), "number"),
        ]
        for number, lowered, share in zip(*columns, strict=True)
    ]
    done = "The last pass changed nothing beyond 1/1000 of the smooth bodies' approach: the next is elastic."
    more = "The last pass still lowered places by more than 1/1000 of the smooth bodies' approach."
    note = done if number(tree, contact.SHAKEN_DOWN) else more
    head = ["pass", "largest lowering", "share of the touched area that yields"]
    return ReportTable("running_in_passes", "Passes of running-in", head, rows, note)
