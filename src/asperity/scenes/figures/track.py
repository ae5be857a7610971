"""Figures of the track: receptances of rail, wheel and contact, decay rate, moving kernel."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.axes import frequency_axis, log_axis
from asperity.reporting.chart import (
    BLUE,
    GREEN,
    INK,
    MUTED,
    VERMILLION,
    Axis,
    Chart,
    Dashes,
    Line,
    Panel,
    Rules,
    sequence_styles,
)
from asperity.reporting.data import engineering, number, plain, present, stated, values
from asperity.reporting.part import Data, Part, Series, present_series, series
from asperity.scenes import schema
from asperity.scenes.figures.marks import natural_rules
from asperity.schema import Entry

FREQUENCY = schema.TRACK_FREQUENCY
_RECEPTANCES: dict[Entry, tuple[str, str, Dashes]] = {
    schema.RECEPTANCE_MIDSPAN: ("rail, mid-span", BLUE, ()),
    schema.RECEPTANCE_SUPPORT: ("rail, over a sleeper", VERMILLION, (6, 1.5)),
    schema.WHEEL_RECEPTANCE: ("wheel", GREEN, (6, 1.5, 1.5, 1.5)),
    schema.CONTACT_RECEPTANCE: ("contact spring", MUTED, (1.5, 1.5)),
}
_PHASES = {
    schema.RECEPTANCE_MIDSPAN: schema.RECEPTANCE_MIDSPAN_PHASE,
    schema.RECEPTANCE_SUPPORT: schema.RECEPTANCE_SUPPORT_PHASE,
}
_RATES: dict[Entry, tuple[str, str, Dashes, float]] = {
    schema.DECAY_RATE: ("eigenvalue", BLUE, (), 1.6),
    schema.DECAY_RATE_EN15461: ("EN 15461, sum over distances", VERMILLION, (6, 1.5), 1.2),
    schema.DECAY_RATE_LIMIT: ("lower limit, ISO 3095", INK, (4, 2), 1.4),
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


def receptance_chart(tree: DataTree, data: Data) -> Chart:
    """Magnitude of the receptances, and below it their phase."""
    magnitudes, phases = [], []
    for entry, look in _RECEPTANCES.items():
        if entry in data.lines:
            magnitudes.append(Line(data.at, data.lines[entry].values, *look))
        if _PHASES.get(entry) in data.lines:
            degrees = np.degrees(data.lines[_PHASES[entry]].values)
            phases.append(Line(data.at, (degrees + 180) % 360 - 180, *look))
    along, ends = _along(data)
    size = Axis("|receptance| / (m/N)", log=True)
    panels = [Panel(along, size, (*natural_rules(tree, *ends), *magnitudes), height=4.0)]
    if phases:
        turns = tuple((degrees, f"{degrees:g}") for degrees in (-180.0, -90.0, 0.0, 90.0, 180.0))
        phase = Axis("phase / °", -190.0, 190.0, ticks=turns)
        panels.append(Panel(along, phase, (*natural_rules(tree, *ends, named=False), *phases), height=2.2))
    return Chart(tuple(panels))


def _along(data: Data) -> tuple[Axis, tuple[float, float]]:
    """Axis of all positive frequencies, and its ends."""
    ends = float(data.at[data.at > 0][0]), float(data.at[-1])
    return frequency_axis(*ends), ends


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


def decay_chart(tree: DataTree, data: Data) -> Chart:
    """Decay rate along the rail against frequency, with the limit that tests of vehicles ask for."""
    rates = {entry: data.lines[entry].values for entry in _RATES if entry in data.lines}
    lines = [Line(data.at, np.where(rate > 0, rate, np.nan), *_RATES[entry]) for entry, rate in rates.items()]
    along, ends = _along(data)
    axis = log_axis("decay rate / (dB/m)", [line.y for line in lines], lowest=0.01)
    return Chart((Panel(along, axis, (*natural_rules(tree, *ends), *lines), height=3.9),))


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


def kernel_chart(tree: DataTree, data: Data) -> Chart:
    """Response under the load to an impulse at some start positions: at first, and until it is quiet."""
    quiet = _until_quiet(data.at, data.field.T)
    return Chart(
        (
            _kernel_panel(data, min(6e-3, quiet), "the first milliseconds"),
            replace(
                _kernel_panel(data, quiet, "until it stays below 1 % of its largest value"),
                beside=True,
                share=1.25,
            ),
        )
    )


def _kernel_panel(data: Data, end: float, title: str) -> Panel:
    shown = data.at <= end
    lines = [
        Line(data.at[shown] * 1e3, line.values[shown] * 1e6, f"start {start:.2f} m", width=1.2, **look)
        for (start, line), look in zip(data.lines.items(), sequence_styles(len(data.lines)), strict=True)
    ]
    time = Axis("time since the impulse / ms", 0.0, 1e3 * end)
    zero = Rules(np.zeros(1), "y", dashes=(), width=0.8)
    return Panel(time, Axis("moving kernel / (µm/(N s))"), (zero, *lines), title, height=3.9)


def _kernel_caption(tree: DataTree) -> str:
    method = stated(tree, schema.KERNEL_METHOD)
    poles, error = number(tree, schema.KERNEL_POLES), number(tree, schema.KERNEL_FIT_ERROR)
    used = " The run used the kernel itself." if method else ""
    if method == "poles" and poles:
        fitted = "" if error is None else f", fitted with a relative error of {error:.1e}"
        used = f" The run used {poles:.0f} common poles instead{fitted}."
    return (
        "Displacement of the rail, positive downwards, at the place that the wheel has reached a time after "
        "an impulse of 1 N s at the start position, counted from a sleeper: the rail seen from the moving "
        f"wheel.{used}"
    )


TRACK = (
    Part(
        "receptance",
        "Receptance of rail, wheel and contact",
        (FREQUENCY,),
        receptance_data,
        receptance_chart,
        _receptance_caption,
        tuple(_RECEPTANCES),
    ),
    Part(
        "decay_rate",
        "Decay rate of the track",
        (FREQUENCY,),
        decay_data,
        decay_chart,
        _decay_caption,
        (schema.DECAY_RATE, schema.DECAY_RATE_EN15461),
    ),
    Part(
        "moving_kernel",
        "Response of the rail under the moving wheel",
        (schema.MOVING_KERNEL, schema.START_POSITION, schema.LAG),
        kernel_data,
        kernel_chart,
        _kernel_caption,
    ),
)
