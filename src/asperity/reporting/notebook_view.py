"""What a notebook shows of a result: verdict, warnings, numbers and a small figure of the force."""

from __future__ import annotations

import base64
from html import escape

import numpy as np
from xarray import DataTree

from asperity.reporting.axes import band_axis, levels_axis
from asperity.reporting.chart import Area, Axis, Chart, Line, Mark, Panel, envelope
from asperity.reporting.data import engineering, force_unit, json_list, laws, of_law, present, stated, values
from asperity.reporting.force_figures import main_limits, time_unit
from asperity.reporting.law_entries import law_entry, law_style
from asperity.schema import provenance
from asperity.schema.rolling import CONTACT_FORCE, CONTACT_LOSS_SHARE, LONGEST_LOSS, TIME
from asperity.schema.spectra import BAND, FORCE_LEVEL

COLUMNS = 350
"""Stretches in which a long force is drawn by its extremes."""


def notebook_view(tree: DataTree, data: str) -> str:
    """Show a result with verdict and force; what shows its data is folded below."""
    title = escape(str(stated(tree, provenance.TITLE)))
    return "\n".join(
        [
            f"<div><p><strong>{title}.</strong> {escape(str(stated(tree, provenance.VERDICT)))}</p>",
            _warnings(tree),
            _picture(tree),
            _numbers(tree),
            f"<details><summary>All data</summary>{data}</details></div>",
        ]
    )


def _warnings(tree: DataTree) -> str:
    """Every warning on the physics, in a list that opens."""
    told = [
        f"<li>{escape(str(item.get('grade', 'warning')).capitalize() + ': ' + str(item.get('message')))}</li>"
        for item in json_list(tree, provenance.WARNINGS)
    ]
    if not told:
        return ""
    count = f"{len(told)} warning{'s' if len(told) > 1 else ''}"
    return f"<details><summary>{count}</summary><ul>{''.join(told)}</ul></details>"


def _numbers(tree: DataTree) -> str:
    """Mean and rms of the force, and its losses, by law."""
    heads = ["law", "mean force", "rms about it", "largest", "time without contact", "longest loss"]
    rows = []
    for law in laws(tree, CONTACT_FORCE):
        force = of_law(tree, CONTACT_FORCE, law, "time")
        cells = [engineering(float(f(force)), "N") for f in (np.nanmean, np.nanstd, np.nanmax)]
        for entry, write in ((CONTACT_LOSS_SHARE, lambda x: f"{x:.2%}"), (LONGEST_LOSS, _time)):
            known = law in laws(tree, entry) and not law_entry(tree, law).may_pull
            cells.append(write(float(of_law(tree, entry, law))) if known else "–")
        rows.append("".join(f"<td>{escape(cell)}</td>" for cell in (law, *cells)))
    head = "".join(f"<th>{name}</th>" for name in heads)
    return f"<table><tr>{head}</tr>{''.join(f'<tr>{row}</tr>' for row in rows)}</table>"


def _time(seconds: float) -> str:
    return engineering(seconds, "s") if seconds > 0 else "–"


def _picture(tree: DataTree) -> str:
    from asperity.reporting.paper import draw

    data = base64.b64encode(draw(overview_chart(tree))._repr_png_()).decode()
    main = escape(laws(tree, CONTACT_FORCE)[0])
    return f'<img alt="contact force of {main}" width="840" src="data:image/png;base64,{data}">'


def overview_chart(tree: DataTree) -> Chart:
    """Force of the main law in time, and the force levels of all laws."""
    main = laws(tree, CONTACT_FORCE)[0]
    time, force = values(tree, TIME, "time"), of_law(tree, CONTACT_FORCE, main, "time")
    size, unit = force_unit(float(np.nanmax(np.abs(force))))
    second, symbol = time_unit(float(time[-1] - time[0]))
    starts, low, high = envelope(force / size, COLUMNS)
    colour = law_entry(tree, main).colour
    shown: Mark = Line(time / second, force / size, colour=colour, width=1.0)
    if len(starts) < len(force):
        shown = Area(time[starts] / second, low, high, colour=colour, opacity=1.0)
    ends = main_limits({main: force / size}, ())
    history = Panel(
        Axis(f"time / {symbol}"), Axis(f"contact force / {unit}", *ends), (shown,), main, height=3.0
    )
    return Chart((history, *([_levels_panel(tree, main)] if present(tree, FORCE_LEVEL) else [])))


def _levels_panel(tree: DataTree, main: str) -> Panel:
    band = values(tree, BAND, "band")
    levels = {law: of_law(tree, FORCE_LEVEL, law, "band") for law in laws(tree, FORCE_LEVEL)}
    lines = [Line(band, level, law, **law_style(tree, law, main)) for law, level in levels.items()]
    axis = levels_axis("force level / dB re 1 N", list(levels.values()))
    return Panel(band_axis(band), axis, tuple(lines), height=3.0, beside=True)
