"""What a notebook shows of a result: verdict, warnings, numbers and a small figure of the force."""

from __future__ import annotations

import base64
import io
from html import escape

import numpy as np
from matplotlib.figure import Figure
from xarray import DataTree

from asperity.reporting.data import engineering, force_unit, json_list, laws, of_law, present, stated, values
from asperity.reporting.law_entries import law_entry, law_style
from asperity.reporting.style import ShownFigure, band_axis, envelope, styled
from asperity.reporting.time_figures import main_limits, time_unit
from asperity.schema import provenance
from asperity.schema.rolling import CONTACT_FORCE, CONTACT_LOSS_SHARE, LONGEST_LOSS, TIME
from asperity.schema.spectra import BAND, FORCE_LEVEL

COLUMNS = 350
"""Stretches in which a long force is drawn by its extremes."""
SIZE = (8.4, 2.5)  # inch


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
    image = io.BytesIO()
    overview_figure(tree).savefig(image, format="png", dpi=110)
    data = base64.b64encode(image.getvalue()).decode()
    main = escape(laws(tree, CONTACT_FORCE)[0])
    return f'<img alt="contact force of {main}" src="data:image/png;base64,{data}">'


@styled()
def overview_figure(tree: DataTree) -> Figure:
    """Force of the main law in time, and the force levels of all laws."""
    figure = ShownFigure(figsize=SIZE, layout="constrained")
    history, *levels = figure.subplots(1, 2 if present(tree, FORCE_LEVEL) else 1, squeeze=False)[0]
    names = laws(tree, CONTACT_FORCE)
    main, time = names[0], values(tree, TIME, "time")
    size, unit = force_unit(float(np.nanmax(np.abs(of_law(tree, CONTACT_FORCE, main, "time")))))
    force = of_law(tree, CONTACT_FORCE, main, "time") / size
    second, symbol = time_unit(float(time[-1] - time[0]))
    starts, low, high = envelope(force, COLUMNS)
    colour = law_entry(tree, main).colour
    if len(starts) < len(force):
        history.fill_between(time[starts] / second, low, high, color=colour, linewidth=0.4)
    else:
        history.plot(time / second, force, color=colour, linewidth=1.0)
    history.set(xlabel=f"time / {symbol}", ylabel=f"contact force / {unit}", title=main)
    history.set_ylim(*main_limits({main: force}, ()))
    for axes in levels:
        band = values(tree, BAND, "band")
        for law in laws(tree, FORCE_LEVEL):
            level = of_law(tree, FORCE_LEVEL, law, "band")
            axes.plot(band, level, label=law, **law_style(tree, law, main))
        band_axis(axes, band)
        axes.set(ylabel="force level / dB re 1 N")
        axes.legend(fontsize=7, ncols=2 if len(names) > 4 else 1)
    return figure
