"""Figures of a comparison of runs: levels and their differences, stiffness, filters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import xarray

from asperity.reporting.axes import EDGE, band_axis, levels_axis, wavenumber_axis
from asperity.reporting.chart import Axis, Boxes, Chart, Dashes, Line, Numbers, Panel, Rules
from asperity.reporting.comparison_table import chance
from asperity.reporting.data import written_units
from asperity.reporting.style import BLUE, GREEN, INK, MUTED, VERMILLION
from asperity.schema import contact

RUN_COLOURS = (INK, VERMILLION, BLUE, GREEN, "#a8458f", "#96700a", "#2a93c4", "#6f7a85")
RUN_DASHES: tuple[Dashes, ...] = ((), (5, 1.5), (2, 1), (6, 1.5, 1, 1.5))
MOST_RUNS = len(RUN_COLOURS)
"""That can be told apart."""


def levels_chart(table: xarray.Dataset, name: str, looks: Mapping[str, Mapping[str, Any]]) -> Chart:
    """A level of all runs by their first law, and the differences to the first run.

    Of two runs the differences of all laws are drawn, in their `looks`; of more runs those of the first law.
    """
    level, difference = table[name].values, table[f"{name}_difference"].values
    runs, laws = ([str(item) for item in table[key].values] for key in ("run", "law"))
    band = table["band"].values
    above = [_of_run(r, run, band, level[r, 0]) for r, run in enumerate(runs)]
    below: list[Boxes | Line | Rules] = [Rules(np.zeros(1), "y", colour=INK, dashes=(), width=0.8)]
    if len(runs) == 2:
        held = [k for k in range(len(laws)) if np.isfinite(difference[1, k]).any()]
        below += _chance(band, chance(table, 1))
        below += [
            Line(band, difference[1, k], laws[k], **looks.get(laws[k], {"colour": MUTED})) for k in held
        ]
    else:
        below += [_of_run(r, run, band, difference[r, 0]) for r, run in enumerate(runs[1:], 1)]
    bands = band_axis(band[np.isfinite(level).any(axis=(0, 1))])
    heights = levels_axis(f"level of {laws[0]} / {written_units(table[name].attrs['units'])}", [level[:, 0]])
    over = Axis(f"over {runs[0]} / dB")
    return Chart(
        (Panel(bands, heights, tuple(above), height=3.2), Panel(bands, over, tuple(below), height=2.8))
    )


def _of_run(number: int, name: str, x: Numbers, y: Numbers, marker: str = "o") -> Line:
    """A line of a run by its number, from 0."""
    dashes = RUN_DASHES[number % len(RUN_DASHES)]
    return Line(x, y, name, RUN_COLOURS[number], dashes, 1.6, marker)


def _chance(band: Numbers, deviation: Numbers) -> list[Boxes]:
    """What two records that know nothing of each other differ by: one standard deviation."""
    known = np.isfinite(deviation)
    if not known.any():
        return []
    band, deviation = band[known], deviation[known]
    edges = band / EDGE, band * EDGE, -deviation, deviation
    return [Boxes(*edges, label="± 1 s by chance", colour=MUTED, opacity=0.18)]


def contact_chart(table: xarray.Dataset) -> Chart:
    """Stiffness of all runs over the approach, and their filters at the working approach."""
    panels = [_stiffness(table)] if "stiffness" in table else []
    panels += [_filters(table)] if "filter" in table else []
    return Chart((*panels[:1], *(replace(panel, beside=True, share=1.15) for panel in panels[1:])))


def _stiffness(table: xarray.Dataset) -> Panel:
    approach, stiffness = table["approach"].values * 1e6, table["stiffness"].values
    unit, symbol = (1e9, "GN/m") if np.nanmax(stiffness) > 2e9 else (1e6, "MN/m")
    working = table[contact.WORKING_APPROACH.name].values * 1e6
    lines = []
    for r, run in enumerate(map(str, table["run"].values)):
        kept = np.isfinite(stiffness[r])
        if kept.any():
            lines.append(_of_run(r, run, approach[kept], stiffness[r, kept] / unit, marker=""))
            at = np.interp(working[r : r + 1], *(lines[-1].x, lines[-1].y))
            lines.append(Line(working[r : r + 1], at, colour=RUN_COLOURS[r], width=0, marker="o"))
    along, up = Axis("approach / µm"), Axis(f"contact stiffness k_c / ({symbol})", low=0.0)
    return Panel(along, up, tuple(lines), height=3.9)


def _filters(table: xarray.Dataset) -> Panel:
    wavenumber, level = table["wavenumber"].values, table["filter"].values
    names = [str(run) for run in table["run"].values]
    lines = [
        _of_run(r, run, wavenumber, level[r], marker="")
        for r, run in enumerate(names)
        if np.isfinite(level[r]).any()
    ]
    kept = wavenumber[np.isfinite(level).any(axis=0)]
    up = Axis("contact filter |H| / dB", max(float(np.nanmin(level)) - 2.0, -40.0), 3.0)
    return Panel(wavenumber_axis(kept[0], kept[-1]), up, tuple(lines), height=3.9)
