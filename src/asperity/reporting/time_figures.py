"""Figures of the contact force in time: the whole run as envelopes, a short piece in full."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.data import engineering, force_unit, laws, of_law, values
from asperity.reporting.part import Columns, Part
from asperity.reporting.style import (
    INK,
    MUTED,
    envelope,
    is_narrow,
    law_style,
    legend_above,
    new_figure,
    styled,
)

FORCE = "rolling/contact_force"
COLUMNS = 700  # stretches of an envelope
PIECE = 2000  # time steps of the short piece, at most
HEADROOM = 0.5  # share of the main law's range by which other laws may widen its axis


def lost(tree: DataTree, law: str) -> NDArray[np.bool_]:
    """Time steps at which `law` has lost contact; none for a law whose contact pulls as well (linear)."""
    force = of_law(tree, FORCE, law, "time")
    share = "rolling/contact_loss_share"
    if is_bilateral(law) or (law in laws(tree, share) and of_law(tree, share, law) == 0):
        return np.zeros(len(force), dtype=bool)
    return force <= 0


def is_bilateral(law: str) -> bool:
    """Whether the contact of `law` pulls as well as it pushes, so that it cannot be lost."""
    return law.partition("-")[0] == "linear"


def piece(tree: DataTree) -> slice:
    """Short piece of the run: around the main law's longest loss of contact, else in the middle."""
    flight = lost(tree, laws(tree, FORCE)[0])
    count = len(flight)
    middle = count // 2
    if flight.any():
        edges = np.flatnonzero(np.diff(np.concatenate(([0], flight.astype(np.int8), [0]))))
        starts, ends = edges[::2], edges[1::2]
        longest = int(np.argmax(ends - starts))
        middle = int(starts[longest] + ends[longest]) // 2
    length = min(PIECE, max(count // 5, min(count, 200)))
    start = min(max(middle - length // 2, 0), count - length)
    return slice(start, start + length)


def _force_unit(tree: DataTree) -> tuple[float, str]:
    return force_unit(float(np.nanmax(np.abs(values(tree, FORCE)))))


def main_limits(series: Mapping[str, NDArray[np.float64]]) -> tuple[float, float]:
    """Limits of an axis that suit the main law, the first of `series`.

    Parameters
    ----------
    series : mapping of str to array
        What is drawn, by law.

    Returns
    -------
    low, high : float
        The main law's range, wider by at most `HEADROOM` of it on either side where zero, or another law that
        can lose contact, needs it. A linear law, which swings as if nothing could be lost, widens nothing.
    """
    main, *others = series
    low, high = float(np.nanmin(series[main])), float(np.nanmax(series[main]))
    bottom, top, room = low, high, HEADROOM * (high - low)
    for law in others:
        if not is_bilateral(law):
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


@styled()
def envelope_figure(tree: DataTree) -> Figure:
    """Contact force of the whole run, one row per law, as the envelope of its extremes."""
    names = laws(tree, FORCE)
    time, limits = values(tree, "rolling/time"), main_limits(_forces(tree, slice(None)))
    figure = new_figure(0.6 + 1.0 * len(names))
    panels = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
    unit, symbol = time_unit(time[-1] - time[0])
    size, force_symbol = _force_unit(tree)
    for axes, law in zip(panels, names, strict=True):
        colour = law_style(law, names[0])["color"]
        columns = COLUMNS // 2 if is_narrow() else COLUMNS
        starts, low, high = envelope(of_law(tree, FORCE, law, "time") / size, columns)
        axes.fill_between(time[starts] / unit, low, high, color=colour, linewidth=0.5)
        axes.axhline(0, color=MUTED, linewidth=0.8)
        flights = np.logical_or.reduceat(lost(tree, law), starts)
        _flight_marks(axes, time[starts[flights]] / unit)
        axes.set_title(law + (" (main law)" if law == names[0] and len(names) > 1 else ""))
        axes.set_xlim(time[0] / unit, time[-1] / unit)
        axes.set_ylabel(f"F / {force_symbol}")
        if law == names[0] or not is_bilateral(law):
            axes.set_ylim(*(limit / size for limit in limits))
    panels[-1].set_xlabel(f"time / {symbol}")
    return figure


def _forces(tree: DataTree, part: slice) -> dict[str, NDArray[np.float64]]:
    """Contact force of each law over the time steps `part`."""
    return {law: of_law(tree, FORCE, law, "time")[part] for law in laws(tree, FORCE)}


def cut_off(tree: DataTree, part: slice) -> str:
    """Say which laws leave the force axis of a piece."""
    forces = _forces(tree, part)
    return beyond_limits(forces, main_limits(forces), "N")


def _flight_marks(axes: Axes, instants: NDArray[np.float64]) -> None:
    (marks,) = axes.plot(
        instants, np.full(len(instants), 0.03), "|", transform=axes.get_xaxis_transform(), color=INK,
        markersize=7, markeredgewidth=0.8, clip_on=False, zorder=5,
    )  # fmt: skip
    marks.set_in_layout(False)


def envelope_columns(tree: DataTree) -> Columns:
    """Envelope of the contact force per law."""
    time = values(tree, "rolling/time")
    columns: Columns = {"time [s]": time[envelope(time, COLUMNS)[0]]}
    for law in laws(tree, FORCE):
        _, low, high = envelope(of_law(tree, FORCE, law, "time"), COLUMNS)
        columns[f"{law} lowest [N]"], columns[f"{law} highest [N]"] = low, high
    return columns


@styled()
def piece_figure(tree: DataTree) -> Figure:
    """Contact force of all laws over a short piece of the run, and below it where each has lost contact."""
    return forces_with_flights(tree, piece(tree))


def forces_with_flights(tree: DataTree, part: slice) -> Figure:
    """Contact force over the time steps `part`, and below it, where there is any, the loss of contact."""
    names, flies = laws(tree, FORCE), any_lost(tree, part)
    figure = new_figure(3.9 + 0.16 * len(names) if flies else 3.9)
    rows = [1, 0.06 * len(names) + 0.04] if flies else [1]
    panels = figure.subplots(len(rows), 1, sharex=True, squeeze=False, height_ratios=rows)[:, 0]
    draw_forces(panels[0], tree, part)
    if flies:
        panels[0].set_xlabel("")
        draw_flights(panels[1], tree, part)
    return figure


def any_lost(tree: DataTree, part: slice) -> bool:
    """Whether any law loses contact within the time steps `part`."""
    return any(lost(tree, law)[part].any() for law in laws(tree, FORCE))


def draw_forces(axes: Axes, tree: DataTree, part: slice) -> None:
    """Draw the contact force of all laws over the time steps `part`."""
    names = laws(tree, FORCE)
    time = values(tree, "rolling/time")[part]
    unit, symbol = time_unit(time[-1])
    size, force_symbol = _force_unit(tree)
    forces = _forces(tree, part)
    low, high = main_limits(forces)
    for law, force in forces.items():
        faint = {"alpha": 0.5, "linewidth": 0.8} if force.min() < low or force.max() > high else {}
        axes.plot(time / unit, force / size, label=law, **law_style(law, names[0]) | faint)
    axes.axhline(0, color=MUTED, linewidth=0.8)
    axes.set_ylim(low / size, high / size)
    axes.set_xlabel(f"time / {symbol}")
    axes.set_ylabel(f"contact force / {force_symbol}")
    axes.set_xlim(time[0] / unit, time[-1] / unit)
    legend_above(axes)


def draw_flights(axes: Axes, tree: DataTree, part: slice) -> None:
    """Draw a bar per law where it has lost contact, over the time steps `part`."""
    names = laws(tree, FORCE)
    time = values(tree, "rolling/time")[part]
    unit, symbol = time_unit(time[-1])
    for row, law in enumerate(names):
        axes.fill_between(
            time / unit,
            row - 0.35,
            row + 0.35,
            where=lost(tree, law)[part],
            color=law_style(law, "")["color"],
            step="mid",
            linewidth=0.8,
        )
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.set_yticks(range(len(names)), names)
    axes.grid(visible=False, axis="y")
    axes.set_xlabel(f"time / {symbol}")
    axes.set_ylabel("no contact", fontsize=8.5)


def piece_columns(tree: DataTree) -> Columns:
    """Contact force per law over the short piece, every time step."""
    return columns_of_piece(tree, piece(tree))


def columns_of_piece(tree: DataTree, part: slice) -> Columns:
    """Contact force per law over the time steps `part`."""
    columns: Columns = {"time [s]": values(tree, "rolling/time")[part]}
    for law in laws(tree, FORCE):
        columns[f"{law} [N]"] = of_law(tree, FORCE, law, "time")[part]
    return columns


def _piece_caption(tree: DataTree) -> str:
    where = "around the main law's longest loss of contact"
    if not lost(tree, laws(tree, FORCE)[0]).any():
        where = "in the middle of the run"
    part = piece(tree)
    return f"A short piece {where}, every time step.{bars_words(tree, part)}{cut_off(tree, part)}"


def bars_words(tree: DataTree, part: slice) -> str:
    """Sentence about the bars below the forces of a piece, where there are any."""
    return " Bars below: no contact (F ≤ 0); linear never lets go." if any_lost(tree, part) else ""


def _envelope_caption(tree: DataTree) -> str:
    count = len(values(tree, "rolling/time"))
    stretches = min(COLUMNS, count)
    return (
        f"Lowest and highest force in each of {stretches} stretches of the run, compression positive. "
        "Marks along the bottom: stretches with loss of contact. A linear law beside the main one has an "
        f"axis of its own. The full series is in run.nc.{_cut_off_of_those_that_let_go(tree)}"
    )


def _cut_off_of_those_that_let_go(tree: DataTree) -> str:
    forces = _forces(tree, slice(None))
    main = next(iter(forces))
    shared = {law: force for law, force in forces.items() if law == main or not is_bilateral(law)}
    return beyond_limits(shared, main_limits(forces), "N")


FORCE_PIECE = Part(
    "force_piece",
    "Contact force, a short piece",
    (FORCE, "rolling/time"),
    piece_figure,
    piece_columns,
    _piece_caption,
)
FORCE_ENVELOPE = Part(
    "force_envelope",
    "Contact force, the whole run",
    (FORCE, "rolling/time"),
    envelope_figure,
    envelope_columns,
    _envelope_caption,
)
TIME = (FORCE_PIECE, FORCE_ENVELOPE)
