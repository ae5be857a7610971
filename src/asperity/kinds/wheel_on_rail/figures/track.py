"""Figures of the track: receptances of rail, wheel and contact, decay rate, moving kernel."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, LogLocator, NullFormatter
from numpy.typing import NDArray
from xarray import DataTree

from asperity.kinds.wheel_on_rail import schema
from asperity.kinds.wheel_on_rail.figures.marks import draw_marks, natural_frequencies
from asperity.reporting.data import engineering, number, plain, present, stated, values
from asperity.reporting.part import Data, Part, Series, present_series, series
from asperity.reporting.style import (
    BLUE,
    GREEN,
    INK,
    MUTED,
    VERMILLION,
    frequency_axis,
    legend_above,
    new_figure,
    power_axis,
    sequence,
    side_by_side,
    styled,
)

FREQUENCY = schema.TRACK_FREQUENCY
_RECEPTANCES = {
    schema.RECEPTANCE_MIDSPAN: ("rail, mid-span", BLUE, "-"),
    schema.RECEPTANCE_SUPPORT: ("rail, over a sleeper", VERMILLION, (0, (6, 1.5))),
    schema.WHEEL_RECEPTANCE: ("wheel", GREEN, (0, (6, 1.5, 1.5, 1.5))),
    schema.CONTACT_RECEPTANCE: ("contact spring", MUTED, (0, (1.5, 1.5))),
}
_PHASES = {
    schema.RECEPTANCE_MIDSPAN: schema.RECEPTANCE_MIDSPAN_PHASE,
    schema.RECEPTANCE_SUPPORT: schema.RECEPTANCE_SUPPORT_PHASE,
}
_RATES = {
    schema.DECAY_RATE: ("eigenvalue", BLUE, "-", 1.6),
    schema.DECAY_RATE_EN15461: ("EN 15461, sum over distances", VERMILLION, (0, (6, 1.5)), 1.2),
    schema.DECAY_RATE_LIMIT: ("lower limit, ISO 3095", INK, (0, (4, 2)), 1.4),
}
KERNELS = 6
"""Start positions of the moving kernel that are drawn, at most."""


def receptance_data(tree: DataTree) -> Data:
    """Magnitude and phase of the receptances."""
    named = {}
    for entry in _RECEPTANCES:
        named[entry] = entry.name
        if entry in _PHASES:
            named[_PHASES[entry]] = f"{entry.name} phase"
    return Data(series(tree, FREQUENCY), present_series(tree, named))


@styled()
def receptance_figure(tree: DataTree, data: Data) -> Figure:
    """Magnitude of the receptances, and below it their phase."""
    phases = {entry: phase for entry, phase in _PHASES.items() if phase in data.lines}
    figure = new_figure(6.2 if phases else 4.2)
    rows = [1.9, 1] if phases else [1.9]
    panels = figure.subplots(len(rows), 1, sharex=True, squeeze=False, height_ratios=rows)[:, 0]
    frequency = data.at
    for entry, (label, colour, dashes) in _RECEPTANCES.items():
        look = {"color": colour, "linestyle": dashes}
        if entry in data.lines:
            panels[0].plot(frequency, data.lines[entry].values, label=label, **look)
        if entry in phases:
            degrees = np.degrees(data.lines[phases[entry]].values)
            panels[-1].plot(frequency, (degrees + 180) % 360 - 180, **look)
    panels[0].set_yscale("log")
    power_axis(panels[0].yaxis)
    _decades(panels[0])
    panels[0].set_ylabel("|receptance| / (m/N)")
    if phases:
        panels[1].set_ylabel("phase / °")
        panels[1].set_ylim(-190, 190)
        panels[1].yaxis.set_major_locator(FixedLocator([-180, -90, 0, 90, 180]))
    frequency_axis(panels[-1], frequency[frequency > 0][0], frequency[-1])
    for axes in panels:
        draw_marks(axes, natural_frequencies(tree), labelled=axes is panels[0])
    legend_above(panels[0])
    return figure


def _decades(axes: Axes) -> None:
    low, high = axes.get_ylim()
    decades = 10.0 ** np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1)
    axes.yaxis.set_major_locator(FixedLocator(decades.tolist()))


def _receptance_caption(tree: DataTree) -> str:
    facts = []
    speed = number(tree, schema.CRITICAL_SPEED)
    if speed:
        facts.append(f"critical speed {plain(speed)} m/s")
    deflection = number(tree, schema.STATIC_DEFLECTION)
    if deflection:
        facts.append(f"static deflection of the rail under the wheel {engineering(deflection, 'm')}")
    stated = f" Of this track: {'; '.join(facts)}." if facts else ""
    return (
        "Displacement per force at the point of the force, both positive downwards, time factor e^{+iωt}: "
        "a spring has the phase 0°, a mass ±180°, a damper −90°. Dotted lines: frequencies of the resting "
        f"track.{stated}"
    )


def decay_data(tree: DataTree) -> Data:
    """Decay rates against frequency."""
    return Data(series(tree, FREQUENCY), present_series(tree, {entry: entry.name for entry in _RATES}))


@styled()
def decay_figure(tree: DataTree, data: Data) -> Figure:
    """Decay rate along the rail against frequency, with the limit that tests of vehicles ask for."""
    figure = new_figure(3.9)
    axes = figure.subplots()
    frequency = data.at
    for entry, (label, colour, dashes, width) in _RATES.items():
        if entry in data.lines:
            rate = data.lines[entry].values
            rate = np.where(rate > 0, rate, np.nan)
            axes.plot(frequency, rate, color=colour, linestyle=dashes, linewidth=width, label=label)
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    axes.set_ylim(max(low, 1e-2 * min(1.0, high)), high)
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.set_ylabel("decay rate / (dB/m)")
    frequency_axis(axes, frequency[frequency > 0][0], frequency[-1])
    draw_marks(axes, natural_frequencies(tree))
    legend_above(axes)
    return figure


def _decay_caption(tree: DataTree) -> str:
    limit = (
        " Dashed: the lowest decay that ISO 3095 allows the track of a vehicle's noise test, vertical."
        if present(tree, schema.DECAY_RATE_LIMIT)
        else ""
    )
    return (
        "Decay of the vertical bending wave along the rail. Eigenvalue: the least decaying wave of the "
        f"periodic track, −20 lg|λ|/L; EN 15461: from the responses at the distances of the standard.{limit}"
    )


def _starts(tree: DataTree) -> list[int]:
    """Start positions that are drawn, spread over the bay."""
    count = len(values(tree, schema.START_POSITION))
    return np.unique(np.linspace(0, count, min(KERNELS, count), endpoint=False).astype(int)).tolist()


def _until_quiet(lag: NDArray[np.float64], kernel: NDArray[np.float64]) -> float:
    """Lag in s from which the kernel stays below a hundredth of its largest value."""
    size = np.abs(kernel).max(axis=0)
    return float(lag[min(np.flatnonzero(size > size.max() / 100)[-1] + 1, len(lag) - 1)])


def kernel_data(tree: DataTree) -> Data:
    """Moving kernel against lag, one line per drawn start position."""
    entry, position = schema.MOVING_KERNEL, values(tree, schema.START_POSITION)
    kernel = values(tree, entry, *entry.dims)
    lines: dict[Any, Series] = {
        position[start]: Series(f"kernel(start={position[start]:.9g} m)", entry.units, kernel[start])
        for start in _starts(tree)
    }
    return Data(series(tree, schema.LAG), lines)


@styled()
def kernel_figure(tree: DataTree, data: Data) -> Figure:
    """Response under the load to an impulse at some start positions: at first, and until it is quiet."""
    figure, panels = side_by_side(3.9, (1, 1.25))
    lag = data.at
    quiet = _until_quiet(lag, data.field.T)
    for axes, end in zip(panels, (min(6e-3, quiet), quiet), strict=True):
        shown = lag <= end
        for (start, line), colour in zip(data.lines.items(), sequence(len(data.lines)), strict=True):
            kernel = line.values[shown] * 1e6
            axes.plot(lag[shown] * 1e3, kernel, color=colour, label=f"{start:.2f} m", linewidth=1.2)
        axes.axhline(0, color=MUTED, linewidth=0.8)
        axes.set_xlim(0, 1e3 * end)
        axes.set_xlabel("time since the impulse / ms")
    panels[0].set_ylabel("moving kernel / (µm/(N s))")
    panels[0].set_title("the first milliseconds")
    panels[1].set_title("until it stays below 1 % of its largest value")
    panels[1].legend(title="start, from a sleeper", loc="upper right", title_fontsize=8.5)
    return figure


def _kernel_caption(tree: DataTree) -> str:
    method = stated(tree, schema.KERNEL_METHOD)
    poles, error = number(tree, schema.KERNEL_POLES), number(tree, schema.KERNEL_FIT_ERROR)
    used = " The run used the kernel itself." if method else ""
    if method == "poles" and poles:
        fitted = "" if error is None else f", fitted with a relative error of {error:.1e}"
        used = f" The run used {poles:.0f} common poles instead{fitted}."
    return (
        "Displacement of the rail, positive downwards, at the place that the wheel has reached a time after "
        f"an impulse of 1 N s at the start position: the rail seen from the moving wheel.{used}"
    )


TRACK = (
    Part(
        "receptance",
        "Receptance of rail, wheel and contact",
        (FREQUENCY,),
        receptance_data,
        receptance_figure,
        _receptance_caption,
        tuple(_RECEPTANCES),
    ),
    Part(
        "decay_rate",
        "Decay rate of the track",
        (FREQUENCY,),
        decay_data,
        decay_figure,
        _decay_caption,
        (schema.DECAY_RATE, schema.DECAY_RATE_EN15461),
    ),
    Part(
        "moving_kernel",
        "Response of the rail under the moving wheel",
        (schema.MOVING_KERNEL, schema.START_POSITION, schema.LAG),
        kernel_data,
        kernel_figure,
        _kernel_caption,
    ),
)
