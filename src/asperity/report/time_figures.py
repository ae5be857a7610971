"""Figures of the contact force in time: the whole run as envelopes, a short piece in full."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from xarray import DataTree

from asperity.report.data import force_unit, laws, of_law, values
from asperity.report.part import Columns, Part
from asperity.report.style import INK, MUTED, envelope, law_style, legend_above, new_figure, styled

FORCE = "rolling/contact_force"
COLUMNS = 700  # stretches of an envelope
PIECE = 2000  # time steps of the short piece, at most


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


def time_unit(duration: float) -> tuple[float, str]:
    """Unit in which a time of `duration` s reads well: its size in s and its symbol."""
    return (1.0, "s") if duration >= 0.5 else (1e-3, "ms")


@styled()
def envelope_figure(tree: DataTree) -> Figure:
    """Contact force of the whole run, one row per law, as the envelope of its extremes."""
    names = laws(tree, FORCE)
    time = values(tree, "rolling/time")
    figure = new_figure(0.6 + 1.0 * len(names))
    panels = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
    unit, symbol = time_unit(time[-1] - time[0])
    size, force_symbol = _force_unit(tree)
    for axes, law in zip(panels, names, strict=True):
        colour = law_style(law, names[0])["color"]
        starts, low, high = envelope(of_law(tree, FORCE, law, "time") / size, COLUMNS)
        axes.fill_between(time[starts] / unit, low, high, color=colour, linewidth=0.5)
        axes.axhline(0, color=MUTED, linewidth=0.8)
        flights = np.logical_or.reduceat(lost(tree, law), starts)
        _flight_marks(axes, time[starts[flights]] / unit)
        axes.set_title(law + (" (main law)" if law == names[0] and len(names) > 1 else ""))
        axes.set_xlim(time[0] / unit, time[-1] / unit)
        axes.set_ylabel(f"F / {force_symbol}")
    _share_limits([axes for axes, law in zip(panels, names, strict=True) if not is_bilateral(law)])
    panels[-1].set_xlabel(f"time / {symbol}")
    return figure


def _share_limits(panels: list[Axes]) -> None:
    """One force axis for the laws that can lose contact; a linear law swings too far to share it."""
    limits = [axes.get_ylim() for axes in panels]
    for axes in panels:
        axes.set_ylim(min(low for low, _ in limits), max(high for _, high in limits))


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
    part, names = piece(tree), laws(tree, FORCE)
    figure = new_figure(3.9 + 0.16 * len(names))
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[1, 0.06 * len(names) + 0.04])
    draw_forces(upper, tree, part)
    upper.set_xlabel("")
    draw_flights(lower, tree, part)
    return figure


def draw_forces(axes: Axes, tree: DataTree, part: slice) -> None:
    """Draw the contact force of all laws over the time steps `part`."""
    names = laws(tree, FORCE)
    time = values(tree, "rolling/time")[part]
    unit, symbol = time_unit(time[-1])
    size, force_symbol = _force_unit(tree)
    for law in names:
        force = of_law(tree, FORCE, law, "time")[part] / size
        axes.plot(time / unit, force, label=law, **law_style(law, names[0]))
    axes.axhline(0, color=MUTED, linewidth=0.8)
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
    return f"A short piece {where}, every time step. Bars below: no contact (F ≤ 0); linear never does."


def _envelope_caption(tree: DataTree) -> str:
    count = len(values(tree, "rolling/time"))
    stretches = min(COLUMNS, count)
    return (
        f"Lowest and highest force in each of {stretches} stretches of the run, compression positive. "
        "Marks along the bottom: stretches with loss of contact. A linear law has an axis of its own. "
        "The full series is in run.nc."
    )


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
