"""Figures of the contact force in time: the whole run as envelopes, a short piece in full."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.data import engineering, force_unit, laws, of_law, values
from asperity.reporting.law_entries import law_entry, law_style, pulling
from asperity.reporting.part import Data, Part, Series, by_law, series
from asperity.reporting.style import (
    INK,
    MUTED,
    envelope,
    is_narrow,
    legend_above,
    new_figure,
    styled,
)
from asperity.schema.rolling import CONTACT_FORCE, CONTACT_LOSS_SHARE, TIME

COLUMNS = 700  # stretches of an envelope
PIECE = 2000  # time steps of the short piece, at most
HEADROOM = 0.5  # share of the main law's range by which other laws may widen its axis


def lost(tree: DataTree, law: str, force: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Where contact is lost, as `force` of `law` shows; nowhere if the contact pulls as well."""
    if law_entry(tree, law).may_pull or (
        law in laws(tree, CONTACT_LOSS_SHARE) and of_law(tree, CONTACT_LOSS_SHARE, law) == 0
    ):
        return np.zeros(len(force), dtype=bool)
    return force <= 0


def stretches(flight: NDArray[np.bool_]) -> list[list[int]]:
    """First and last time step of each stretch in which contact is lost."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], flight.astype(np.int8), [0]))))
    return [[int(start), int(end) - 1] for start, end in zip(edges[::2], edges[1::2], strict=True)]


def piece(tree: DataTree) -> slice:
    """Short piece of the run: around the main law's longest loss of contact, else in the middle."""
    flight = _main_flight(tree)
    count = len(flight)
    middle = count // 2
    if flight.any():
        first, last = max(stretches(flight), key=lambda stretch: stretch[1] - stretch[0])
        middle = (first + last + 1) // 2
    length = min(PIECE, max(count // 5, min(count, 200)))
    start = min(max(middle - length // 2, 0), count - length)
    return slice(start, start + length)


def _main_flight(tree: DataTree) -> NDArray[np.bool_]:
    """Time steps at which the main law has lost contact."""
    main = laws(tree, CONTACT_FORCE)[0]
    return lost(tree, main, of_law(tree, CONTACT_FORCE, main, "time"))


def force_unit_of(tree: DataTree) -> tuple[float, str]:
    """Unit in which the forces of a result read well: its size in N and its symbol."""
    return force_unit(float(np.nanmax(np.abs(values(tree, CONTACT_FORCE)))))


def main_limits(series: Mapping[str, NDArray[np.float64]], pulling: Collection[str]) -> tuple[float, float]:
    """Limits of an axis that suit the main law, the first of `series`.

    Its range, wider by at most `HEADROOM` of it on either side where zero, or another law that can lose
    contact, needs it. A law that pulls, and swings as if nothing could be lost, widens nothing.
    """
    main, *others = series
    low, high = float(np.nanmin(series[main])), float(np.nanmax(series[main]))
    bottom, top, room = low, high, HEADROOM * (high - low)
    for law in others:
        if law not in pulling:
            bottom = min(bottom, max(low - room, float(np.nanmin(series[law]))))
            top = max(top, min(high + room, float(np.nanmax(series[law]))))
    if low - room <= 0.0 <= high + room:
        bottom, top = min(bottom, 0.0), max(top, 0.0)
    margin = 0.04 * (top - bottom) or 1e-12
    return bottom - margin, top + margin


def beyond_limits(series: Mapping[str, NDArray[np.float64]], limits: tuple[float, float], unit: str) -> str:
    """Sentence that names the laws which leave the axis, with their extremes; empty if none does."""
    ends = {law: (float(np.nanmin(values)), float(np.nanmax(values))) for law, values in series.items()}
    left = [
        f"{law} ({engineering(low, unit)} to {engineering(high, unit)})"
        for law, (low, high) in ends.items()
        if low < limits[0] or high > limits[1]
    ]
    return f" The axis suits the main law; beyond it: {', '.join(left)}." if left else ""


def time_unit(duration: float) -> tuple[float, str]:
    """Unit in which a time of `duration` s reads well: its size in s and its symbol."""
    return (1.0, "s") if duration >= 0.5 else (1e-3, "ms")


def envelope_data(tree: DataTree) -> Data:
    """Lowest and highest contact force of each law in each stretch of the run."""
    time = values(tree, TIME)
    lines: dict[Any, Series] = {}
    for law, force in by_law(tree, CONTACT_FORCE).items():
        _, low, high = envelope(force.values, COLUMNS)
        lines[law, "lowest"] = Series(f"{law} lowest", CONTACT_FORCE.units, low)
        lines[law, "highest"] = Series(f"{law} highest", CONTACT_FORCE.units, high)
    return Data(Series("time", TIME.units, time[envelope(time, COLUMNS)[0]]), lines)


@styled()
def envelope_figure(tree: DataTree, data: Data) -> Figure:
    """Contact force of the whole run, one row per law, as the envelope of its extremes."""
    names = laws(tree, CONTACT_FORCE)
    whole, limits = values(tree, TIME), main_limits(_forces(tree), pulling(tree))
    figure = new_figure(0.6 + 1.0 * len(names))
    panels = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
    unit, symbol = time_unit(whole[-1] - whole[0])
    size, force_symbol = force_unit_of(tree)
    for axes, law in zip(panels, names, strict=True):
        lowest, highest = (data.lines[law, end].values for end in ("lowest", "highest"))
        columns = COLUMNS // 2 if is_narrow() else COLUMNS
        starts, low, _ = envelope(lowest, columns)
        high, time = envelope(highest, columns)[2], data.at[starts] / unit
        axes.fill_between(time, low / size, high / size, color=law_entry(tree, law).colour, linewidth=0.5)
        axes.axhline(0, color=MUTED, linewidth=0.8)
        _flight_marks(axes, time[lost(tree, law, low)])
        axes.set_title(law + (" (main law)" if law == names[0] and len(names) > 1 else ""))
        axes.set_xlim(whole[0] / unit, whole[-1] / unit)
        axes.set_ylabel(f"F / {force_symbol}")
        if law == names[0] or not law_entry(tree, law).may_pull:
            axes.set_ylim(*(limit / size for limit in limits))
    panels[-1].set_xlabel(f"time / {symbol}")
    return figure


def _forces(tree: DataTree) -> dict[str, NDArray[np.float64]]:
    """Contact force of each law over the whole run."""
    return {law: force.values for law, force in by_law(tree, CONTACT_FORCE).items()}


def cut_off(tree: DataTree, data: Data) -> str:
    """Say which laws leave the force axis of a piece."""
    forces = {law: force.values for law, force in data.lines.items()}
    return beyond_limits(forces, main_limits(forces, pulling(tree)), "N")


def _flight_marks(axes: Axes, instants: NDArray[np.float64]) -> None:
    ends = np.tile([-0.04, 0.1, np.nan], len(instants))  # one line with gaps: far smaller than many marks
    (marks,) = axes.plot(
        np.repeat(instants, 3), ends, transform=axes.get_xaxis_transform(), color=INK, linewidth=0.8,
        clip_on=False, zorder=5,
    )  # fmt: skip
    marks.set_in_layout(False)


def piece_data(tree: DataTree) -> Data:
    """Contact force of each law over a short piece of the run."""
    return forces_data(tree, piece(tree))


def forces_data(tree: DataTree, part: slice) -> Data:
    """Contact force of each law over the time steps `part`, every one."""
    lines: dict[Any, Series] = {
        law: replace(force, values=force.values[part]) for law, force in by_law(tree, CONTACT_FORCE).items()
    }
    time = series(tree, TIME)
    return Data(replace(time, values=time.values[part]), lines)


@styled()
def forces_figure(tree: DataTree, data: Data) -> Figure:
    """Contact force of all laws over a piece of the run, and below it, where there is any, the loss of it."""
    flights = {law: lost(tree, law, force.values) for law, force in data.lines.items()}
    flies = any(flight.any() for flight in flights.values())
    unit, symbol = time_unit(data.at[-1])
    time = data.at / unit
    figure = new_figure(3.9 + 0.16 * len(flights) if flies else 3.9)
    rows = [1, 0.06 * len(flights) + 0.04] if flies else [1]
    panels = figure.subplots(len(rows), 1, sharex=True, squeeze=False, height_ratios=rows)[:, 0]
    _draw_forces(panels[0], tree, time, {law: data.lines[law].values for law in flights})
    if flies:
        _draw_flights(panels[1], tree, time, flights)
    panels[-1].set_xlabel(f"time / {symbol}")
    return figure


def _draw_forces(
    axes: Axes, tree: DataTree, time: NDArray[np.float64], forces: dict[str, NDArray[np.float64]]
) -> None:
    main, (low, high) = next(iter(forces)), main_limits(forces, pulling(tree))
    size, symbol = force_unit_of(tree)
    for law, force in forces.items():
        faint = {"alpha": 0.5, "linewidth": 0.8} if force.min() < low or force.max() > high else {}
        axes.plot(time, force / size, label=law, **law_style(tree, law, main) | faint)
    axes.axhline(0, color=MUTED, linewidth=0.8)
    axes.set_ylim(low / size, high / size)
    axes.set_ylabel(f"contact force / {symbol}")
    axes.set_xlim(time[0], time[-1])
    legend_above(axes)


def _draw_flights(
    axes: Axes, tree: DataTree, time: NDArray[np.float64], flights: dict[str, NDArray[np.bool_]]
) -> None:
    """Draw a bar per law where it has lost contact."""
    for row, (law, flight) in enumerate(flights.items()):
        found, half = stretches(flight), 0.5 * (time[1] - time[0])
        bars = [(time[first] - half, time[last] - time[first] + 2 * half) for first, last in found]
        colour = law_entry(tree, law).colour
        axes.broken_barh(bars, (row - 0.35, 0.7), color=colour, linewidth=0.8)
    axes.set_ylim(len(flights) - 0.4, -0.6)
    axes.set_yticks(range(len(flights)), list(flights))
    axes.grid(visible=False, axis="y")
    axes.set_ylabel("no contact", fontsize=8.5)


def _piece_caption(tree: DataTree) -> str:
    where = "around the main law's longest loss of contact"
    if not _main_flight(tree).any():
        where = "in the middle of the run"
    data = piece_data(tree)
    return f"A short piece {where}, every time step.{bars_words(tree, data)}{cut_off(tree, data)}"


def bars_words(tree: DataTree, data: Data) -> str:
    """Sentence about the bars below the forces of a piece, where there are any."""
    if not any(lost(tree, law, force.values).any() for law, force in data.lines.items()):
        return ""
    held = " and ".join(law for law in data.lines if law_entry(tree, law).may_pull)
    return " Bars below: no contact (F ≤ 0)" + (f"; {held} cannot lose it." if held else ".")


def _envelope_caption(tree: DataTree) -> str:
    stretches = min(COLUMNS, len(values(tree, TIME)))
    return (
        "Compression positive. Contact is lost where bars stand along the bottom, by law; where the main law "
        f"loses it, the background is shaded. As a drawing: lowest and highest force in each of {stretches} "
        "stretches of the run, with marks where contact is lost; a linear law beside the main one has its "
        "own axis. All time steps are in run.nc."
        f"{_cut_off_of_those_that_let_go(tree)}"
    )


def _cut_off_of_those_that_let_go(tree: DataTree) -> str:
    forces = _forces(tree)
    main = next(iter(forces))
    shared = {law: force for law, force in forces.items() if law == main or law not in pulling(tree)}
    return beyond_limits(shared, main_limits(forces, pulling(tree)), "N")


FORCE_PIECE = Part(
    "force_piece",
    "Contact force, a short piece",
    (CONTACT_FORCE, TIME),
    piece_data,
    forces_figure,
    _piece_caption,
)
FORCE_ENVELOPE = Part(
    "force_envelope",
    "Contact force, the whole run",
    (CONTACT_FORCE, TIME),
    envelope_data,
    envelope_figure,
    _envelope_caption,
)
