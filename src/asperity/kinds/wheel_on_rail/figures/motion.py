"""Figures of motion: wheel and rail at the contact, and the rail at the points that the wheel passes."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray
from xarray import DataTree

from asperity.kinds.wheel_on_rail import schema
from asperity.kinds.wheel_on_rail.figures.force import around_peak
from asperity.kinds.wheel_on_rail.figures.marks import draw_marks, draw_sleepers, natural_frequencies
from asperity.reporting.data import laws, number, of_law, present, stored_variable, values
from asperity.reporting.law_entries import baselines_among, law_style, pulling
from asperity.reporting.part import Data, Part, Series, by_law, series
from asperity.reporting.spectrum_figures import (
    DRAWN,
    frequency_range,
    narrow_level,
    shade_bands,
    shaded_words,
)
from asperity.reporting.style import (
    INK,
    frequency_axis,
    legend_above,
    level_limits,
    new_figure,
    styled,
)
from asperity.reporting.time_figures import beyond_limits, main_limits, time_unit
from asperity.schema import Entry
from asperity.schema.rolling import CONTACT_FORCE, POSITION, RELATIVE_DISPLACEMENT, SPEED, TIME
from asperity.schema.spectra import FREQUENCY

MOTIONS = {
    schema.RAIL_DISPLACEMENT: ("rail", 1e-3, "mm"),
    schema.WHEEL_DISPLACEMENT: ("wheel", 1e-3, "mm"),
    RELATIVE_DISPLACEMENT: ("approach", 1e-6, "µm"),
}
"""What moves at the contact, and the unit it is drawn in."""
PIECE = 0.1  # s around the largest force
VELOCITY, VELOCITY_PSD = schema.POINT_VELOCITY, schema.POINT_VELOCITY_PSD
POINTS = 3
"""Passed points that are drawn, at most; the CSV files hold all."""
AROUND_PASSING = 0.15
"""Longest time before and after a passing that is drawn, s."""


def _piece(tree: DataTree) -> slice:
    if present(tree, CONTACT_FORCE):
        return around_peak(tree, PIECE)
    return slice(0, None)


def displacement_data(tree: DataTree) -> Data:
    """Displacements of each law over a piece of the run, every time step."""
    part = _piece(tree)
    named: dict[Any, Series] = {}
    if present(tree, POSITION):
        named[POSITION] = series(tree, POSITION, "position on the rail")
    for entry, (name, _, _) in MOTIONS.items():
        named |= {(entry, law): line for law, line in by_law(tree, entry, f"{name}, {{}}").items()}
    lines = {key: replace(line, values=line.values[part]) for key, line in named.items()}
    return Data(Series("time", TIME.units, values(tree, TIME)[part]), lines)


def _motions(data: Data) -> dict[Entry, dict[str, NDArray[np.float64]]]:
    """Motions that a result holds, by law."""
    return {entry: motions for entry in MOTIONS if (motions := data.of(entry))}


@styled()
def displacement_figure(tree: DataTree, data: Data) -> Figure:
    """Displacement of rail and wheel at the contact and their approach, all laws, over a piece of the run."""
    found, time = _motions(data), data.at
    figure = new_figure(0.6 + 1.55 * len(found))
    panels = figure.subplots(len(found), 1, sharex=True, squeeze=False)[:, 0]
    unit, symbol = time_unit(time[-1])
    for axes, (entry, motions) in zip(panels, found.items(), strict=True):
        name, size, length = MOTIONS[entry]
        for law, motion in motions.items():
            axes.plot(time / unit, motion / size, label=law, **law_style(tree, law, next(iter(motions))))
        low, high = main_limits(motions, pulling(tree))
        axes.set_ylim(high / size, low / size)  # downwards
        axes.set_ylabel(f"{name} / {length}")
        draw_sleepers(axes, tree, time[0], time[-1], unit)
    panels[0].set_xlim(time[0] / unit, time[-1] / unit)
    panels[-1].set_xlabel(f"time / {symbol}")
    legend_above(panels[0])
    return figure


def _displaced_beyond(tree: DataTree) -> str:
    """Say which laws leave the axes."""
    words = ""
    for entry, motions in _motions(displacement_data(tree)).items():
        outside = beyond_limits(motions, main_limits(motions, pulling(tree)), "m")
        words += outside.replace("The axis suits", f"{MOTIONS[entry][0].capitalize()}: the axis suits")
    return words


def _displacement_caption(tree: DataTree) -> str:
    sleepers = " Ticks: the wheel passes a sleeper." if number(tree, schema.SLEEPER_SPACING) else ""
    return (
        "Motion at the contact around the largest force, positive downwards and drawn downwards; from the "
        "unloaded track, so that the static deflection is in. The approach of wheel and rail is positive "
        f"closing.{sleepers}{_displaced_beyond(tree)}"
    )


def point_labels(tree: DataTree) -> list[str]:
    """Positions of the passed points, with their place in the bay where it has a name."""
    bay = number(tree, schema.SLEEPER_SPACING)
    found = []
    for point in values(tree, schema.ROLLING_POINT).tolist():
        place = (point / bay) % 1 if bay else np.nan
        name = ", over a sleeper" if min(place, 1 - place) < 0.02 else ""
        name = ", mid-span" if abs(place - 0.5) < 0.02 else name
        found.append(f"x = {point:.4g} m{name}")
    return found


def _name(axes: Axes, label: str) -> None:
    """Write the name of a panel into its upper right corner."""
    axes.annotate(
        label, (0.99, 0.96), xycoords="axes fraction", va="top", ha="right", fontsize=9, fontweight="bold"
    )


def _points(tree: DataTree, entry: Entry) -> list[int]:
    found = stored_variable(tree, entry)
    assert found is not None
    others = [dim for dim in found.dims if dim != "point"]
    return [int(index) for index in np.flatnonzero(found.notnull().any(others).values)]


def _around_passing(tree: DataTree, point: int) -> tuple[slice, float | None]:
    """Time steps around the wheel's passing of a point, and the time of it if the positions are known."""
    time, speed = values(tree, TIME), number(tree, SPEED)
    if not speed or not present(tree, POSITION):
        return slice(0, None), None
    passing = time[0] + (values(tree, schema.ROLLING_POINT)[point] - values(tree, POSITION)[0]) / speed
    low, high = np.searchsorted(time, [passing - AROUND_PASSING, passing + AROUND_PASSING])
    return (slice(int(low), int(high)), float(passing)) if high - low > 1 else (slice(0, None), None)


def _main_and_linear(tree: DataTree) -> list[str]:
    names = laws(tree, VELOCITY)
    return [*(name for name in baselines_among(tree, names)[:1] if name != names[0]), names[0]]


def _of_points(tree: DataTree, entry: Entry, part: slice) -> dict[Any, Series]:
    """Lines of each law and point, over a part of their last dimension."""
    labels = point_labels(tree)
    return {
        (law, point): Series(
            f"{law}, {labels[point]}", entry.units, of_law(tree, entry, law, *entry.dims[1:])[point, part]
        )
        for law in laws(tree, entry)
        for point in _points(tree, entry)
    }


def velocity_data(tree: DataTree) -> Data:
    """Velocity of the rail at all passed points by all laws, every time step of the drawn pieces together."""
    time = values(tree, TIME)
    ends = [_around_passing(tree, point)[0].indices(len(time)) for point in _points(tree, VELOCITY)]
    part = slice(min(start for start, _, _ in ends), max(stop for _, stop, _ in ends))
    return Data(Series("time", TIME.units, time[part]), _of_points(tree, VELOCITY, part))


@styled()
def velocity_figure(tree: DataTree, data: Data) -> Figure:
    """Velocity of the rail at the passed points, around the passing, by the main law and by a linear one."""
    drawn = _points(tree, VELOCITY)[:POINTS]
    figure = new_figure(0.6 + 1.7 * len(drawn))
    panels = figure.subplots(len(drawn), 1, squeeze=False)[:, 0]
    names, main = _main_and_linear(tree), laws(tree, VELOCITY)[0]
    labels, whole = point_labels(tree), values(tree, TIME)
    for axes, point in zip(panels, drawn, strict=True):
        part, passing = _around_passing(tree, point)
        shown = np.isin(data.at, whole[part])
        time = data.at[shown] - (passing or 0.0)
        for law in names:
            style = law_style(tree, law, main) | {"linewidth": 1.0, "linestyle": "-"}
            axes.plot(time * 1e3, data.lines[law, point].values[shown] * 1e3, label=law, **style)
        if passing is not None:
            axes.axvline(0, color=INK, linewidth=0.8, linestyle=":")
        axes.set_xlim(time[0] * 1e3, time[-1] * 1e3)
        axes.yaxis.set_major_locator(MaxNLocator(5))
        axes.set_ylabel("velocity / (mm/s)")
        _name(axes, labels[point])
    panels[-1].set_xlabel("time since the wheel passed / ms" if number(tree, SPEED) else "time / ms")
    handles, texts = panels[0].get_legend_handles_labels()
    panels[0].legend(
        handles[::-1], texts[::-1], loc="lower left", bbox_to_anchor=(-0.01, 1.0), ncols=2, handlelength=2.6
    )
    return figure


def _velocity_caption(tree: DataTree) -> str:
    names = " and ".join(reversed(_main_and_linear(tree)))
    around = (
        "around the time at which the wheel passes it (dotted)"
        if number(tree, SPEED)
        else "over the whole run"
    )
    return (
        f"Velocity of the rail at a fixed point, positive downwards, {around}, by {names}. "
        "The CSV file holds all laws and points."
    )


def velocity_psd_data(tree: DataTree) -> Data:
    """Power spectral density of the rail's velocity by each law at each passed point, all lines."""
    return Data(series(tree, FREQUENCY), _of_points(tree, VELOCITY_PSD, slice(None)))


@styled()
def velocity_psd_figure(tree: DataTree, data: Data) -> Figure:
    """Power spectral densities of the rail's velocity at the passed points, all laws, a panel per point."""
    drawn = _points(tree, VELOCITY_PSD)[:POINTS]
    names = laws(tree, VELOCITY_PSD)
    figure = new_figure(0.7 + 2.6 * len(drawn))
    panels = figure.subplots(len(drawn), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
    labels = point_labels(tree)
    levels: list[NDArray[np.float64]] = []
    for axes, point in zip(panels, drawn, strict=True):
        for law in names:
            psd = data.lines[law, point].values
            frequency, level = narrow_level(tree, psd, schema.VELOCITY_REFERENCE**2)
            axes.plot(frequency, level, label=law, **law_style(tree, law, names[0]))
            levels.append(level)
        axes.set_ylabel("velocity PSD / dB re (1 nm/s)²/Hz", fontsize=8.5)
        _name(axes, labels[point])
    frequency_axis(panels[-1], *frequency_range(tree))
    level_limits(panels[0], levels)
    for axes in panels:
        shade_bands(axes, tree, labelled=axes is panels[0])
        draw_marks(axes, natural_frequencies(tree), labelled=False)
    legend_above(panels[0], columns=5)
    return figure


def _velocity_psd_caption(tree: DataTree) -> str:
    named = ", ".join(f"{mark.label} {mark.frequency:.0f} Hz" for mark in natural_frequencies(tree))
    dotted = f" Dotted: {named}." if named else ""
    return f"Velocity of the rail at fixed points over the whole run, {DRAWN}.{dotted}{shaded_words(tree)}"


MOTION = (
    Part(
        "displacement",
        "Wheel and rail at the contact",
        (TIME,),
        displacement_data,
        displacement_figure,
        _displacement_caption,
        tuple(MOTIONS),
    ),
    Part(
        "rail_velocity",
        "Rail velocity where the wheel passes",
        (VELOCITY, TIME, schema.ROLLING_POINT),
        velocity_data,
        velocity_figure,
        _velocity_caption,
    ),
    Part(
        "rail_velocity_psd",
        "Rail velocity against frequency",
        (VELOCITY_PSD, FREQUENCY, schema.ROLLING_POINT),
        velocity_psd_data,
        velocity_psd_figure,
        _velocity_psd_caption,
    ),
)
