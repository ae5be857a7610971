"""Figures of motion: wheel and rail at the contact, and the rail at the points that the wheel passes."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray
from xarray import DataTree

from asperity.kinds.wheel_on_rail.figures.force import around_peak
from asperity.kinds.wheel_on_rail.figures.marks import (
    draw_marks,
    draw_sleepers,
    natural_frequencies,
    sleeper_spacing,
    speed,
)
from asperity.reporting.data import baselines, laws, of_law, present, values, variable
from asperity.reporting.part import Columns, Part
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
    law_style,
    legend_above,
    level_limits,
    new_figure,
    styled,
)
from asperity.reporting.time_figures import beyond_limits, main_limits, time_unit

MOTIONS = {
    "rolling/rail_displacement": "rail",
    "rolling/wheel_displacement": "wheel",
    "rolling/relative_displacement": "approach",
}
PIECE = 0.1  # s around the largest force
VELOCITY, VELOCITY_PSD = "rolling/point_velocity", "spectra/point_velocity_psd"
VELOCITY_REFERENCE = 1e-9  # m/s
POINTS = 3
"""Passed points that are drawn, at most; the CSV files hold all."""
AROUND_PASSING = 0.15
"""Longest time before and after a passing that is drawn, s."""


def _moved(tree: DataTree) -> list[str]:
    return [path for path in MOTIONS if present(tree, path)]


def _piece(tree: DataTree) -> slice:
    if present(tree, "rolling/contact_force"):
        return around_peak(tree, PIECE)
    return slice(0, None)


@styled()
def displacement_figure(tree: DataTree) -> Figure:
    """Displacement of rail and wheel at the contact and their approach, all laws, over a piece of the run."""
    paths = _moved(tree)
    figure = new_figure(0.6 + 1.55 * len(paths))
    panels = figure.subplots(len(paths), 1, sharex=True, squeeze=False)[:, 0]
    part = _piece(tree)
    time = values(tree, "rolling/time")[part]
    unit, symbol = time_unit(time[-1])
    for axes, path in zip(panels, paths, strict=True):
        names = laws(tree, path)
        size, length = (1e-3, "mm") if "relative" not in path else (1e-6, "µm")
        for law in names:
            motion = of_law(tree, path, law, "time")[part] / size
            axes.plot(time / unit, motion, label=law, **law_style(law, names[0]))
        low, high = main_limits(_motions(tree, path, part))
        axes.set_ylim(high / size, low / size)  # downwards
        axes.set_ylabel(f"{MOTIONS[path]} / {length}")
        draw_sleepers(axes, tree, time[0], time[-1], unit)
    panels[0].set_xlim(time[0] / unit, time[-1] / unit)
    panels[-1].set_xlabel(f"time / {symbol}")
    legend_above(panels[0])
    return figure


def _motions(tree: DataTree, path: str, part: slice) -> dict[str, NDArray[np.float64]]:
    return {law: of_law(tree, path, law, "time")[part] for law in laws(tree, path)}


def _displaced_beyond(tree: DataTree) -> str:
    """Say which laws leave the axes."""
    part = _piece(tree)
    words = ""
    for path in _moved(tree):
        motions = _motions(tree, path, part)
        outside = beyond_limits(motions, main_limits(motions), "m")
        words += outside.replace("The axis suits", f"{MOTIONS[path].capitalize()}: the axis suits")
    return words


def displacement_columns(tree: DataTree) -> Columns:
    """Displacements per law over the piece, every time step."""
    part = _piece(tree)
    columns: Columns = {"time [s]": values(tree, "rolling/time")[part]}
    if present(tree, "rolling/position"):
        columns["position on the rail [m]"] = values(tree, "rolling/position")[part]
    for path in _moved(tree):
        for law in laws(tree, path):
            columns[f"{MOTIONS[path]}, {law} [m]"] = of_law(tree, path, law, "time")[part]
    return columns


def _displacement_caption(tree: DataTree) -> str:
    sleepers = " Ticks: the wheel passes a sleeper." if sleeper_spacing(tree) else ""
    return (
        "Motion at the contact around the largest force, positive downwards and drawn downwards; from the "
        "unloaded track, so that the static deflection is in. The approach of wheel and rail is positive "
        f"closing.{sleepers}{_displaced_beyond(tree)}"
    )


def point_labels(tree: DataTree) -> list[str]:
    """Positions of the passed points, with their place in the bay where it has a name."""
    bay = sleeper_spacing(tree)
    found = []
    for point in values(tree, "rolling/point").tolist():
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


def _points(tree: DataTree, path: str) -> list[int]:
    found = variable(tree, path)
    assert found is not None
    others = [dim for dim in found.dims if dim != "point"]
    return [int(index) for index in np.flatnonzero(found.notnull().any(others).values)]


def _around_passing(tree: DataTree, point: int) -> tuple[slice, float | None]:
    """Time steps around the wheel's passing of a point, and the time of it if the positions are known."""
    time, pace = values(tree, "rolling/time"), speed(tree)
    if pace is None:
        return slice(0, None), None
    passing = time[0] + (values(tree, "rolling/point")[point] - values(tree, "rolling/position")[0]) / pace
    low, high = np.searchsorted(time, [passing - AROUND_PASSING, passing + AROUND_PASSING])
    return (slice(int(low), int(high)), float(passing)) if high - low > 1 else (slice(0, None), None)


def _main_and_linear(tree: DataTree, path: str) -> list[str]:
    names = laws(tree, path)
    return [*(name for name in baselines(names)[:1] if name != names[0]), names[0]]


@styled()
def velocity_figure(tree: DataTree) -> Figure:
    """Velocity of the rail at the passed points, around the passing, by the main law and by a linear one."""
    drawn = _points(tree, VELOCITY)[:POINTS]
    figure = new_figure(0.6 + 1.7 * len(drawn))
    panels = figure.subplots(len(drawn), 1, squeeze=False)[:, 0]
    names, main = _main_and_linear(tree, VELOCITY), laws(tree, VELOCITY)[0]
    labels = point_labels(tree)
    for axes, point in zip(panels, drawn, strict=True):
        part, passing = _around_passing(tree, point)
        time = values(tree, "rolling/time")[part] - (passing or 0.0)
        for law in names:
            velocity = of_law(tree, VELOCITY, law, "point", "time")[point, part]
            style = law_style(law, main) | {"linewidth": 1.0, "linestyle": "-"}
            axes.plot(time * 1e3, velocity * 1e3, label=law, **style)
        if passing is not None:
            axes.axvline(0, color=INK, linewidth=0.8, linestyle=":")
        axes.set_xlim(time[0] * 1e3, time[-1] * 1e3)
        axes.yaxis.set_major_locator(MaxNLocator(5))
        axes.set_ylabel("velocity / (mm/s)")
        _name(axes, labels[point])
    panels[-1].set_xlabel("time since the wheel passed / ms" if speed(tree) else "time / ms")
    handles, texts = panels[0].get_legend_handles_labels()
    panels[0].legend(
        handles[::-1], texts[::-1], loc="lower left", bbox_to_anchor=(-0.01, 1.0), ncols=2, handlelength=2.6
    )
    return figure


def velocity_columns(tree: DataTree) -> Columns:
    """Velocity of the rail at all passed points by all laws, every time step of the drawn pieces together."""
    pieces = [_around_passing(tree, point)[0] for point in _points(tree, VELOCITY)]
    count = len(values(tree, "rolling/time"))
    ends = [piece.indices(count) for piece in pieces]
    part = slice(min(start for start, _, _ in ends), max(stop for _, stop, _ in ends))
    columns: Columns = {"time [s]": values(tree, "rolling/time")[part]}
    labels = point_labels(tree)
    for law in laws(tree, VELOCITY):
        velocity = of_law(tree, VELOCITY, law, "point", "time")
        columns |= {f"{law}, {labels[p]} [m/s]": velocity[p, part] for p in _points(tree, VELOCITY)}
    return columns


def _velocity_caption(tree: DataTree) -> str:
    names = " and ".join(reversed(_main_and_linear(tree, VELOCITY)))
    around = "around the time at which the wheel passes it (dotted)" if speed(tree) else "over the whole run"
    return (
        f"Velocity of the rail at a fixed point, positive downwards, {around}, by {names}. "
        "The CSV file holds all laws and points."
    )


@styled()
def velocity_psd_figure(tree: DataTree) -> Figure:
    """Power spectral densities of the rail's velocity at the passed points, all laws, a panel per point."""
    drawn = _points(tree, VELOCITY_PSD)[:POINTS]
    names = laws(tree, VELOCITY_PSD)
    figure = new_figure(0.7 + 2.6 * len(drawn))
    panels = figure.subplots(len(drawn), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
    labels = point_labels(tree)
    levels: list[NDArray[np.float64]] = []
    for axes, point in zip(panels, drawn, strict=True):
        for law in names:
            psd = of_law(tree, VELOCITY_PSD, law, "point", "frequency")[point]
            frequency, level = narrow_level(tree, psd, VELOCITY_REFERENCE**2)
            axes.plot(frequency, level, label=law, **law_style(law, names[0]))
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


def velocity_psd_columns(tree: DataTree) -> Columns:
    """Power spectral density of the rail's velocity per law and passed point, all lines."""
    columns: Columns = {"frequency [Hz]": values(tree, "spectra/frequency")}
    labels = point_labels(tree)
    for law in laws(tree, VELOCITY_PSD):
        psd = of_law(tree, VELOCITY_PSD, law, "point", "frequency")
        columns |= {f"{law}, {labels[p]} [(m/s)^2/Hz]": psd[p] for p in _points(tree, VELOCITY_PSD)}
    return columns


def _velocity_psd_caption(tree: DataTree) -> str:
    named = ", ".join(f"{mark.label} {mark.frequency:.0f} Hz" for mark in natural_frequencies(tree))
    dotted = f" Dotted: {named}." if named else ""
    return f"Velocity of the rail at fixed points over the whole run, {DRAWN}.{dotted}{shaded_words(tree)}"


MOTION = (
    Part(
        "displacement",
        "Wheel and rail at the contact",
        ("rolling/time",),
        displacement_figure,
        displacement_columns,
        _displacement_caption,
        tuple(MOTIONS),
    ),
    Part(
        "rail_velocity",
        "Rail velocity where the wheel passes",
        (VELOCITY, "rolling/time", "rolling/point"),
        velocity_figure,
        velocity_columns,
        _velocity_caption,
    ),
    Part(
        "rail_velocity_psd",
        "Rail velocity against frequency",
        (VELOCITY_PSD, "spectra/frequency", "rolling/point"),
        velocity_psd_figure,
        velocity_psd_columns,
        _velocity_psd_caption,
    ),
)
