"""Figures of a comparison of runs: levels and their differences, stiffness, filters."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from asperity.reporting.comparison_table import chance
from asperity.reporting.style import (
    BLUE,
    GREEN,
    INK,
    MUTED,
    VERMILLION,
    Dashes,
    band_axis,
    is_narrow,
    legend_above,
    level_limits,
    new_figure,
    side_by_side,
    styled,
    wavenumber_axis,
)
from asperity.schema import contact

RUN_COLOURS = (INK, VERMILLION, BLUE, GREEN, "#a8458f", "#96700a", "#2a93c4", "#6f7a85")
RUN_DASHES: tuple[Dashes, ...] = ("-", (0, (5, 1.5)), (0, (2, 1)), (0, (6, 1.5, 1, 1.5)))
MOST_RUNS = len(RUN_COLOURS)
"""That can be told apart."""


def run_style(number: int) -> dict[str, Any]:
    """Line properties of a run by its number, from 0."""
    return {"color": RUN_COLOURS[number], "linestyle": RUN_DASHES[number % len(RUN_DASHES)], "linewidth": 1.6}


@styled()
def levels_figure(table: xarray.Dataset, name: str, looks: Mapping[str, Mapping[str, Any]]) -> Figure:
    """Draw a level of all runs by their first law, and the differences to the first run.

    Of two runs the differences of all laws are drawn, in their `looks`; of more runs those of the first law.
    """
    level, difference = table[name], table[f"{name}_difference"]
    names, band = [str(run) for run in table["run"].values], table["band"].values
    kept = np.isfinite(level.values).any(axis=(0, 1))
    figure = new_figure(6.0 if not is_narrow() else 5.6)
    upper, lower = figure.subplots(2, 1, height_ratios=[1.15, 1])
    for r, run in enumerate(names):
        upper.plot(band, level.values[r, 0], label=run, marker="o", markersize=3, **run_style(r))
    level_limits(upper, [level.values[:, 0]])
    law = str(table["law"].values[0])
    upper.set_ylabel(f"level of {law} / {level.attrs['units']}")
    legend_above(upper)
    if len(names) == 2:
        _shade_chance(lower, band, chance(table, 1))
        for k, each in enumerate(map(str, table["law"].values)):
            if np.isfinite(difference.values[1, k]).any():
                lower.plot(band, difference.values[1, k], label=each, **looks.get(each, {"color": MUTED}))
    else:
        for r, run in enumerate(names[1:], 1):
            lower.plot(band, difference.values[r, 0], label=run, marker="o", markersize=3, **run_style(r))
    lower.axhline(0.0, color=INK, linewidth=0.8)
    lower.set_ylabel(f"over {names[0]} / dB")
    legend_above(lower)
    for axes in (upper, lower):
        band_axis(axes, band[kept], label="one-third octave band / Hz" if axes is lower else "")
    return figure


def _shade_chance(axes: Axes, band: NDArray[np.float64], deviation: NDArray[np.float64]) -> None:
    """Shade what two records that know nothing of each other differ by: one standard deviation."""
    known = np.isfinite(deviation)
    if not known.any():
        return
    axes.fill_between(
        band[known], -deviation[known], deviation[known], color=MUTED, alpha=0.18, linewidth=0, step="mid",
        label="± 1 s by chance",
    )  # fmt: skip


@styled()
def contact_figure(table: xarray.Dataset) -> Figure:
    """Draw the stiffness of all runs over the approach, and their filters at the working approach."""
    figure, panels = side_by_side(3.9, (1, 1.15))
    if "stiffness" in table:
        _draw_stiffness(panels[0], table)
    else:
        panels[0].set_axis_off()
    if "filter" in table:
        _draw_filters(panels[1], table)
    else:
        panels[1].set_axis_off()
    return figure


def _draw_stiffness(axes: Axes, table: xarray.Dataset) -> None:
    approach, stiffness = table["approach"].values * 1e6, table["stiffness"].values
    unit, symbol = (1e9, "GN/m") if np.nanmax(stiffness) > 2e9 else (1e6, "MN/m")
    working = table[contact.WORKING_APPROACH.name].values * 1e6
    for r, run in enumerate(map(str, table["run"].values)):
        kept = np.isfinite(stiffness[r])
        if not kept.any():
            continue
        axes.plot(approach[kept], stiffness[r, kept] / unit, label=run, **run_style(r))
        at = np.interp(working[r], approach[kept], stiffness[r, kept] / unit)
        axes.plot(working[r], at, marker="o", markersize=6, color=RUN_COLOURS[r], markerfacecolor="none")
    axes.set_xlabel("approach / µm")
    axes.set_ylabel(f"contact stiffness k_c / ({symbol})")
    axes.set_ylim(bottom=0.0)
    legend_above(axes, 2)


def _draw_filters(axes: Axes, table: xarray.Dataset) -> None:
    wavenumber, level = table["wavenumber"].values, table["filter"].values
    for r, run in enumerate(map(str, table["run"].values)):
        if np.isfinite(level[r]).any():
            axes.plot(wavenumber, level[r], label=run, **run_style(r))
    kept = np.isfinite(level).any(axis=0)
    axes.set_ylim(max(np.nanmin(level) - 2.0, -40.0), 3.0)
    wavenumber_axis(axes, wavenumber[kept][0], wavenumber[kept][-1])
    axes.set_ylabel("contact filter |H| / dB")
