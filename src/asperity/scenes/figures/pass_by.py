"""The pass-by: level over time beside the track, and its single numbers."""

from __future__ import annotations

from typing import Any

import numpy as np
from xarray import DataTree

from asperity.reporting.axes import levels_axis, shade
from asperity.reporting.chart import INK, MUTED, Axis, Boxes, Chart, Dashes, Line, Note, Panel, Rules
from asperity.reporting.data import laws, number, stored_variable, values
from asperity.reporting.force_figures import main_last
from asperity.reporting.law_entries import law_style
from asperity.reporting.part import Data, Part, Series, series
from asperity.reporting.tables import Cell, ReportTable, text_cell
from asperity.scenes import schema

LEVEL = schema.PASS_BY_LEVEL
SPAN = 30.0
"""dB below the maximum that are drawn."""
DASHES: dict[str, Dashes] = {
    "rail": (1.5, 1.5),
    "sleepers": (4.0, 1.5),
    "wheel": (6.0, 1.5, 1.5, 1.5),
}
NUMBERS = {
    "L_pAFmax / dB(A)": schema.PASS_BY_MAXIMUM_LEVEL,
    "L_pAeq,Tp / dB(A)": schema.PASS_BY_EQUIVALENT_LEVEL,
    "TEL / dB(A)": schema.TRANSIT_EXPOSURE_LEVEL,
    "SEL / dB(A)": schema.SOUND_EXPOSURE_LEVEL_A,
}


def passing_radiators(tree: DataTree) -> list[str]:
    """What radiates and is known, and all of it together as the last."""
    found = stored_variable(tree, LEVEL)
    if found is None:
        return []
    known = found.notnull().any(["law", "time"]).values
    return [str(name) for name, yes in zip(found["radiator"].values, known, strict=True) if yes]


def pass_by_data(tree: DataTree) -> Data:
    """Level over time, per law and radiator."""
    found = stored_variable(tree, LEVEL)
    assert found is not None
    lines: dict[Any, Series] = {}
    for law in laws(tree, LEVEL):
        for name in passing_radiators(tree):
            level = found.sel(law=law, radiator=name).values
            lines[law, name] = Series(f"{name}, {law}", LEVEL.units, level)
    return Data(series(tree, schema.PASS_BY_TIME, "time"), lines)


def pass_by_chart(tree: DataTree, data: Data) -> Chart:
    """Level over time: the total by each law, the parts of the main law, and when axles pass."""
    names, (*parts, whole) = laws(tree, LEVEL), passing_radiators(tree)
    main = names[0]
    totals = [
        Line(data.at, data.lines[law, whole].values, f"{whole}, {law}", **law_style(tree, law, main))
        for law in main_last(names)
    ]
    of_parts = [
        Line(data.at, data.lines[main, part].values, f"{part}, {main}", MUTED, DASHES[part], 1.2)
        for part in parts
    ]
    label = "sound pressure level, F / dB(A) re 20 µPa"
    axis = levels_axis(label, [line.y for line in totals], span=SPAN, step=5.0)
    time = Axis("time since the first axle was opposite / s", data.at[0], data.at[-1])
    return Chart((Panel(time, axis, (*_train(tree), *totals, *of_parts), height=4.2),))


def _train(tree: DataTree) -> list[Boxes | Note | Rules]:
    """Short rules where axles are opposite, and the pass-by time behind the lines."""
    axles = values(tree, schema.AXLE_TIME, "axle")
    passing = Rules(axles, colour=INK, dashes=(), width=1.4, short=True)
    front, rear = number(tree, schema.FRONT_TIME), number(tree, schema.REAR_TIME)
    if front is None or rear is None:
        return [passing]
    middle = 0.5 * (front + rear)
    named = Note(f"Tp = {rear - front:.2f} s", middle, 0.06, y_share=True, align="center")
    return [shade(np.array([front]), np.array([rear]), opacity=0.6), named, passing]


def pass_by_caption(tree: DataTree) -> str:
    """Say where it is heard, what passes and what is left out."""
    count = len(values(tree, schema.AXLE_TIME, "axle"))
    passing = "One axle passes" if count == 1 else f"{count} axles pass"
    away, above = (number(tree, fact) for fact in (schema.RECEIVER_DISTANCE, schema.RECEIVER_HEIGHT))
    where = ""
    if away is not None and above is not None:
        where = f", {away:g} m from the middle of the track and {above:g} m above the rail head"
    return (
        f"{passing} (ticks), two wheels on each{where}, over reflecting ground. Rail and sleepers radiate "
        "along the track as its vibration decays, a wheel from its axle, evenly in all directions; nothing "
        "screens them."
    )


def pass_by_table(tree: DataTree) -> ReportTable | None:
    """Single numbers of the pass-by, per law, and of each part by the main law."""
    names = laws(tree, LEVEL)
    if not names:
        return None
    *parts, whole = passing_radiators(tree)
    chosen = [(law, whole) for law in names] + [(names[0], part) for part in parts]
    held = {
        head: found for head, entry in NUMBERS.items() if (found := stored_variable(tree, entry)) is not None
    }

    def row(law: str, radiator: str) -> list[Cell]:
        levels = (float(found.sel(law=law, radiator=radiator)) for found in held.values())
        return [text_cell(law), text_cell(radiator), *(Cell(f"{each:.1f}", "number") for each in levels)]

    note = (
        "Re 20 µPa, SEL in 1 s. L_pAFmax: the largest level, time weighting F. SEL: all of the passage. "
        "L_pAeq,Tp: from when the front of the train is opposite to when its rear is; TEL: all between the "
        "points 10 dB down, over the same time (ISO 3095)."
    )
    rows = [row(*each) for each in chosen]
    return ReportTable("pass_by_table", "Single numbers", ["law", "what radiates", *held], rows, note)


PASS_BY_PART = Part(
    "pass_by_level",
    "Level beside the track",
    (LEVEL, schema.PASS_BY_TIME, schema.AXLE_TIME),
    pass_by_data,
    pass_by_chart,
    pass_by_caption,
)
