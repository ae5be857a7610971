"""What a notebook shows of a result: verdict, warnings, numbers and a small figure of the force."""

from __future__ import annotations

import base64
from html import escape

import numpy as np
from xarray import DataTree

from asperity.reporting import data, panels
from asperity.reporting.chart import Area, Axis, Chart, Line, Mark, Panel, envelope
from asperity.schema import provenance
from asperity.schema.rolling import CONTACT_FORCE, CONTACT_LOSS_SHARE, LONGEST_LOSS, TIME
from asperity.schema.spectra import BAND, FORCE_LEVEL

COLUMNS = 350
"""Stretches in which a long force is drawn by its extremes."""


def notebook_view(tree: DataTree, contents: str) -> str:
    """Show a result with verdict and force; what shows its contents is folded below."""
    title, verdict = (escape(str(data.stated(tree, each))) for each in (provenance.TITLE, provenance.VERDICT))
    return "\n".join(
        [
            f"<div><p><strong>{title}.</strong> {verdict}</p>",
            _warnings(tree),
            _picture(tree),
            _numbers(tree),
            f"<details><summary>All data</summary>{contents}</details></div>",
        ]
    )


def _warnings(tree: DataTree) -> str:
    """Every warning on the physics, in a list that opens."""
    told = [
        f"<li>{escape(str(item.get('grade', 'warning')).capitalize() + ': ' + str(item.get('message')))}</li>"
        for item in data.json_list(tree, provenance.WARNINGS)
    ]
    count = f"{len(told)} warning{'s' if len(told) > 1 else ''}"
    return f"<details><summary>{count}</summary><ul>{''.join(told)}</ul></details>" if told else ""


def _numbers(tree: DataTree) -> str:
    """Mean and rms of the force, and its losses, by law."""
    heads = ["law", "mean force", "rms about it", "largest", "time without contact", "longest loss"]
    rows = [f"<tr>{''.join(f'<th>{name}</th>' for name in heads)}</tr>"]
    losses = (
        (CONTACT_LOSS_SHARE, "{:.2%}".format),
        (LONGEST_LOSS, lambda s: data.engineering(s, "s") if s > 0 else "–"),
    )
    for law in data.laws(tree, CONTACT_FORCE):
        force = data.of_law(tree, CONTACT_FORCE, law)
        cells = [law, *(data.engineering(float(f(force)), "N") for f in (np.nanmean, np.nanstd, np.nanmax))]
        for entry, write in losses:
            known = law in data.laws(tree, entry) and not data.law_entry(tree, law).may_pull
            cells.append(write(float(data.of_law(tree, entry, law))) if known else "–")
        rows.append(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in cells)}</tr>")
    return f"<table>{''.join(rows)}</table>"


def _picture(tree: DataTree) -> str:
    from asperity.reporting.paper import draw

    image = base64.b64encode(draw(overview_chart(tree))._repr_png_()).decode()
    main = escape(data.laws(tree, CONTACT_FORCE)[0])
    return f'<img alt="contact force of {main}" width="840" src="data:image/png;base64,{image}">'


def overview_chart(tree: DataTree) -> Chart:
    """Force of the main law in time, and the force levels of all laws."""
    main = data.laws(tree, CONTACT_FORCE)[0]
    time, force = data.values(tree, TIME), data.of_law(tree, CONTACT_FORCE, main)
    (size, unit), (second, symbol) = (
        data.force_unit(float(np.nanmax(np.abs(force)))),
        data.time_unit(float(time[-1] - time[0])),
    )
    starts, low, high = envelope(force / size, COLUMNS)
    colour = data.law_entry(tree, main).colour
    shown: Mark = Line(time / second, force / size, colour=colour, width=1.0)
    if len(starts) < len(force):
        shown = Area(time[starts] / second, low, high, colour=colour, opacity=1.0)
    ends = Axis(f"contact force / {unit}", *panels.main_limits(panels.by_name({main: force / size}), ()))
    history = Panel(Axis(f"time / {symbol}"), ends, (shown,), main, height=3.0)
    if not data.present(tree, FORCE_LEVEL):
        return Chart((history,))
    band = data.values(tree, BAND)
    levels = [
        Line(band, data.of_law(tree, FORCE_LEVEL, law), law, **data.law_style(tree, law, main))
        for law in data.laws(tree, FORCE_LEVEL)
    ]
    axis = panels.levels_axis("force level / dB re 1 N", [line.y for line in levels])
    return Chart((history, Panel(panels.band_axis(band), axis, tuple(levels), height=3.0, beside=True)))
