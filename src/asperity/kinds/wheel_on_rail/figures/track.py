"""Figures of the track: receptances of rail, wheel and contact, decay rate, moving kernel."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, LogLocator, NullFormatter
from numpy.typing import NDArray
from xarray import DataTree

from asperity.kinds.wheel_on_rail.figures.marks import draw_marks, natural_frequencies
from asperity.reporting.data import engineering, group_attrs, number, plain, present, values
from asperity.reporting.part import Columns, Part
from asperity.reporting.style import (
    INK,
    LAW_STYLES,
    MUTED,
    frequency_axis,
    legend_above,
    new_figure,
    power_axis,
    sequence,
    side_by_side,
    styled,
)

_BLUE, _ORANGE, _GREEN = (LAW_STYLES[law].colour for law in ("areal", "shifted", "table"))
FREQUENCY = "track/frequency"
_RECEPTANCES = {
    "receptance_midspan": ("rail, mid-span", _BLUE, "-"),
    "receptance_support": ("rail, over a sleeper", _ORANGE, (0, (6, 1.5))),
    "wheel_receptance": ("wheel", _GREEN, (0, (6, 1.5, 1.5, 1.5))),
    "contact_receptance": ("contact spring", MUTED, (0, (1.5, 1.5))),
}
_RATES = {
    "decay_rate": ("eigenvalue", _BLUE, "-", 1.6),
    "decay_rate_en15461": ("EN 15461, sum over distances", _ORANGE, (0, (6, 1.5)), 1.2),
    "decay_rate_limit": ("lower limit, ISO 3095", INK, (0, (4, 2)), 1.4),
}
KERNELS = 6
"""Start positions of the moving kernel that are drawn, at most."""


def _with_phase(tree: DataTree) -> list[str]:
    return [name for name in _RECEPTANCES if present(tree, f"track/{name}_phase")]


@styled()
def receptance_figure(tree: DataTree) -> Figure:
    """Magnitude of the receptances, and below it their phase."""
    phases = _with_phase(tree)
    figure = new_figure(6.2 if phases else 4.2)
    panels = figure.subplots(
        2 if phases else 1, 1, sharex=True, squeeze=False, height_ratios=[1.9, 1][: 2 if phases else 1]
    )[:, 0]
    frequency = values(tree, FREQUENCY)
    for name, (label, colour, dashes) in _RECEPTANCES.items():
        if present(tree, f"track/{name}"):
            panels[0].plot(
                frequency, values(tree, f"track/{name}"), color=colour, linestyle=dashes, label=label
            )
        if name in phases:
            degrees = np.degrees(values(tree, f"track/{name}_phase"))
            panels[-1].plot(frequency, (degrees + 180) % 360 - 180, color=colour, linestyle=dashes)
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


def receptance_columns(tree: DataTree) -> Columns:
    """Magnitude and phase of the receptances."""
    columns: Columns = {"frequency [Hz]": values(tree, FREQUENCY)}
    for name in _RECEPTANCES:
        if present(tree, f"track/{name}"):
            columns[f"{name} [m/N]"] = values(tree, f"track/{name}")
        if present(tree, f"track/{name}_phase"):
            columns[f"{name} phase [rad]"] = values(tree, f"track/{name}_phase")
    return columns


def _receptance_caption(tree: DataTree) -> str:
    facts = []
    speed = number(tree, "track", "critical_speed")
    if speed:
        facts.append(f"critical speed {plain(speed)} m/s")
    deflection = number(tree, "track", "static_deflection")
    if deflection:
        facts.append(f"static deflection of the rail under the wheel {engineering(deflection, 'm')}")
    stated = f" Of this track: {'; '.join(facts)}." if facts else ""
    return (
        "Displacement per force at the point of the force, both positive downwards, time factor e^{+iωt}: "
        "a spring has the phase 0°, a mass ±180°, a damper −90°. Dotted lines: frequencies of the resting "
        f"track.{stated}"
    )


@styled()
def decay_figure(tree: DataTree) -> Figure:
    """Decay rate along the rail against frequency, with the limit that tests of vehicles ask for."""
    figure = new_figure(3.9)
    axes = figure.subplots()
    frequency = values(tree, FREQUENCY)
    for name, (label, colour, dashes, width) in _RATES.items():
        if present(tree, f"track/{name}"):
            rate = values(tree, f"track/{name}")
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


def decay_columns(tree: DataTree) -> Columns:
    """Decay rates against frequency."""
    columns: Columns = {"frequency [Hz]": values(tree, FREQUENCY)}
    return columns | {
        f"{name} [dB/m]": values(tree, f"track/{name}") for name in _RATES if present(tree, f"track/{name}")
    }


def _decay_caption(tree: DataTree) -> str:
    limit = (
        " Dashed: the lowest decay that ISO 3095 allows the track of a vehicle's noise test, vertical."
        if present(tree, "track/decay_rate_limit")
        else ""
    )
    return (
        "Decay of the vertical bending wave along the rail. Eigenvalue: the least decaying wave of the "
        f"periodic track, −20 lg|λ|/L; EN 15461: from the responses at the distances of the standard.{limit}"
    )


def _starts(tree: DataTree) -> list[int]:
    """Start positions that are drawn, spread over the bay."""
    count = len(values(tree, "track/start_position"))
    return np.unique(np.linspace(0, count, min(KERNELS, count), endpoint=False).astype(int)).tolist()


def _until_quiet(lag: NDArray[np.float64], kernel: NDArray[np.float64]) -> float:
    """Lag in s from which the kernel stays below a hundredth of its largest value."""
    size = np.abs(kernel).max(axis=0)
    return float(lag[min(np.flatnonzero(size > size.max() / 100)[-1] + 1, len(lag) - 1)])


@styled()
def kernel_figure(tree: DataTree) -> Figure:
    """Response under the load to an impulse at some start positions: at first, and until it is quiet."""
    figure, panels = side_by_side(3.9, (1, 1.25))
    lag = values(tree, "track/lag")
    kernel = values(tree, "track/moving_kernel", "start_position", "lag") * 1e6
    position = values(tree, "track/start_position")
    starts = _starts(tree)
    quiet = _until_quiet(lag, kernel)
    for axes, end in zip(panels, (min(6e-3, quiet), quiet), strict=True):
        shown = lag <= end
        for start, colour in zip(starts, sequence(len(starts)), strict=True):
            label = f"{position[start]:.2f} m"
            axes.plot(lag[shown] * 1e3, kernel[start, shown], color=colour, label=label, linewidth=1.2)
        axes.axhline(0, color=MUTED, linewidth=0.8)
        axes.set_xlim(0, 1e3 * end)
        axes.set_xlabel("time since the impulse / ms")
    panels[0].set_ylabel("moving kernel / (µm/(N s))")
    panels[0].set_title("the first milliseconds")
    panels[1].set_title("until it stays below 1 % of its largest value")
    panels[1].legend(title="start, from a sleeper", loc="upper right", title_fontsize=8.5)
    return figure


def kernel_columns(tree: DataTree) -> Columns:
    """Moving kernel against lag, one column per drawn start position."""
    kernel = values(tree, "track/moving_kernel", "start_position", "lag")
    position = values(tree, "track/start_position")
    columns: Columns = {"lag [s]": values(tree, "track/lag")}
    return columns | {f"kernel(start={position[s]:.9g} m) [m/(N s)]": kernel[s] for s in _starts(tree)}


def _kernel_caption(tree: DataTree) -> str:
    method = group_attrs(tree, "track").get("kernel_method")
    poles, error = (number(tree, "track", f"kernel_{name}") for name in ("poles", "fit_error"))
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
        receptance_figure,
        receptance_columns,
        _receptance_caption,
        tuple(f"track/{name}" for name in _RECEPTANCES),
    ),
    Part(
        "decay_rate",
        "Decay rate of the track",
        (FREQUENCY,),
        decay_figure,
        decay_columns,
        _decay_caption,
        ("track/decay_rate", "track/decay_rate_en15461"),
    ),
    Part(
        "moving_kernel",
        "Response of the rail under the moving wheel",
        ("track/moving_kernel", "track/start_position", "track/lag"),
        kernel_figure,
        kernel_columns,
        _kernel_caption,
    ),
)
