"""Figures as files, for papers and notebooks: what matplotlib draws of a chart."""

from __future__ import annotations

import io
import warnings
from collections.abc import Sequence
from typing import Any, BinaryIO

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec
from matplotlib.patches import Polygon
from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter, NullLocator
from matplotlib.transforms import ScaledTranslation, blended_transform_factory

from asperity.reporting.chart import (
    GRID,
    INK,
    MUTED,
    WIDE,
    Area,
    Axis,
    Boxes,
    Chart,
    Field,
    Line,
    Mark,
    Note,
    Panel,
    Rules,
    Second,
    Shape,
    limits,
    rows_of,
)
from asperity.reporting.data import engineering, power_of_ten

RC: dict[Any, Any] = {
    "svg.fonttype": "none",
    "svg.hashsalt": "asperity",
    "font.family": "sans-serif",
    "font.size": 9,
    "axes.titlesize": 9.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 9,
    "axes.edgecolor": MUTED,
    "axes.labelcolor": INK,
    "axes.titlecolor": INK,
    "axes.facecolor": "none",
    "axes.linewidth": 0.7,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.unicode_minus": True,
    "figure.facecolor": "white",
    "grid.color": GRID,
    "grid.linewidth": 0.6,
    "hatch.linewidth": 0.8,
    "text.color": INK,
    "text.parse_math": False,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.labelsize": 8.5,
    "ytick.labelsize": 8.5,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "lines.markersize": 4,
    "path.simplify_threshold": 0.2,  # of a pixel
    "image.interpolation": "nearest",
}
UNDATED = {"svg": {"Date": None}, "pdf": {"CreationDate": None}, "png": {}}
"""So that files of the same numbers are the same."""
DOTS = 150
"""Per inch, of a PNG, and of what is no line in the others."""
LETTER, ROW, HANDLE = 0.068, 13.0, 10
"""Width of a letter in inches, height of a row of a legend in points, letters that a handle takes."""
OPPOSITE = 32.0
"""Points that an axis opposite takes above a panel."""
HATCHES = {"/": "///", "\\": "\\\\\\", "x": "xxx", ".": "..", "-": "---"}


class ShownFigure(Figure):
    """A figure that a notebook shows, whether or not matplotlib was told to draw into it."""

    def _repr_png_(self) -> bytes:
        image = io.BytesIO()
        save_figure(self, image, "png")
        return image.getvalue()


def draw(chart: Chart, title: str = "") -> ShownFigure:
    """Draw a chart on white ground, in the width of the page, its panels beneath each other in rows."""
    with rc_context(RC):
        rows = rows_of(chart)
        heights = [max(panel.height for panel in row) for row in rows]
        figure = ShownFigure(figsize=(WIDE, sum(heights)), layout="constrained")
        grid = figure.add_gridspec(len(rows), 1, height_ratios=heights)
        named: set[tuple[str, str]] = set()
        for number, row in enumerate(rows):
            _draw_row(figure, grid[number], row, named)
            if len(row) == 1 and number + 1 < len(rows) and _goes_on(row[0], *rows[number + 1]):
                figure.axes[-1].tick_params(axis="x", labelbottom=False)
                figure.axes[-1].set_xlabel("")
        if title:
            figure.suptitle(title, x=0.01, ha="left", fontweight="bold", fontsize=10)
    return figure


def save_figure(figure: Figure, file: BinaryIO, format: str) -> None:
    """Write a figure to an open file, the same for the same numbers."""
    with rc_context(RC), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "constrained_layout not applied", UserWarning)
        figure.savefig(file, format=format, dpi=DOTS, metadata=UNDATED[format])


def _goes_on(panel: Panel, below: Panel, *beside: Panel) -> bool:
    """Whether the panel below has the same axis, which then need not be named twice."""
    same = (panel.x.label, panel.x.ticks) == (below.x.label, below.x.ticks)
    return same and limits(panel, "x") == limits(below, "x") and not (below.title or beside)


def _draw_row(figure: Figure, place: SubplotSpec, row: list[Panel], named: set[tuple[str, str]]) -> None:
    """Draw panels side by side; one alone stands in the column of the others."""
    shares = [panel.share for panel in row]
    inner = place.subgridspec(1, len(row), width_ratios=shares)
    for number, panel in enumerate(row):
        axes = figure.add_subplot(place if len(row) == 1 else inner[number])
        _draw_panel(axes, panel, WIDE * panel.share / sum(shares), named)


def _draw_panel(axes: Axes, panel: Panel, width: float, named: set[tuple[str, str]]) -> None:
    """Draw a panel of a width in inches; what is `named` already gets no second place in a legend."""
    x, y = limits(panel, "x"), limits(panel, "y")
    _draw_axis(axes, "x", panel.x, x, width)
    _draw_axis(axes, "y", panel.y, y, panel.height)
    for order, mark in enumerate(panel.marks):
        _draw_mark(axes, mark, x, y, width, 2 + order / len(panel.marks))
    axes.set(xlim=x, ylim=y)
    if panel.equal:
        axes.set_aspect("equal")
    if panel.plain or any(isinstance(mark, Field) for mark in panel.marks):
        axes.grid(visible=False)
    if panel.plain:
        shown: dict[str, Any] = {"left": bool(panel.y.label), "bottom": bool(panel.x.label)}
        axes.spines[["right", "top", *(side for side, name in shown.items() if not name)]].set_visible(False)
        axes.tick_params(**shown, **{f"label{side}": name for side, name in shown.items()})
    above = _legend(axes, width, OPPOSITE if panel.x.second else 0.0, named)
    if panel.title:
        axes.set_title(panel.title, pad=6 + above)


def _draw_axis(axes: Axes, way: str, axis: Axis, reach: tuple[float, float], length: float) -> None:
    """Scale, ticks and name of an axis of a length in inches, and what stands opposite to it."""
    side = axes.xaxis if way == "x" else axes.yaxis
    if axis.log:
        (axes.set_xscale if way == "x" else axes.set_yscale)("log")
    (axes.set_xlabel if way == "x" else axes.set_ylabel)(axis.label)
    if axis.ticks:
        at, names = zip(*axis.ticks, strict=True)
        side.set_major_locator(FixedLocator(at))
        side.set_major_formatter(FuncFormatter(dict(zip(at, names, strict=True)).get))
        shown = sum(len(name) + 1.5 for number, name in axis.ticks if min(reach) <= number <= max(reach))
        if way == "x" and shown * LETTER > 0.9 * length:
            axes.tick_params(axis="x", labelrotation=90)
    elif axis.log:
        _log_ticks(side, min(reach), max(reach))
    if axis.minor or axis.ticks:
        side.set_minor_locator(FixedLocator(axis.minor))
    side.set_minor_formatter(NullFormatter())
    if axis.second:
        _draw_second(axes, way, axis.second, axis.log, sorted(reach), length)


def _log_ticks(side: Any, low: float, high: float) -> None:
    """Name the decades of a logarithmic axis, or 1, 2 and 5 of each where there are few."""
    if high / low < 300 and low >= 1e-3 and high <= 1e5:
        side.set_major_locator(FixedLocator(series_125(low, high)))
        side.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    else:
        side.set_major_formatter(FuncFormatter(lambda value, _: power_of_ten(value)))


def series_125(low: float, high: float, steps: Sequence[float] = (1.0, 2.0, 5.0)) -> list[float]:
    """Numbers 1, 2, 5, 10, 20, … of all decades between two of them."""
    decades = range(int(np.floor(np.log10(low))), int(np.ceil(np.log10(high))) + 1)
    found = (step * 10.0**decade for decade in decades for step in steps)
    return [each for each in found if low * (1 - 1e-9) <= each <= high * (1 + 1e-9)]


def _draw_second(
    axes: Axes, way: str, second: Second, log: bool, reach: Sequence[float], length: float
) -> None:
    """Axis opposite to another, in what it is scaled to."""

    def there(q: Any) -> Any:
        with np.errstate(divide="ignore"):
            return second.scale / np.asarray(q) if second.inverse else second.scale * q + second.offset

    def back(q: Any) -> Any:
        return there(q) if second.inverse else (q - second.offset) / second.scale

    functions = (there, back)
    along_x = way == "x"
    opposite: Any = (
        axes.secondary_xaxis("top", functions=functions)
        if along_x
        else axes.secondary_yaxis("right", functions=functions)
    )
    side = opposite.xaxis if along_x else opposite.yaxis
    side.set_label_text(second.label)
    if log:
        low, high = sorted(float(there(np.array(end))) for end in reach)
        steps = (1.0, 2.0, 5.0) if high / low <= 3000 * length / WIDE else (1.0,)
        side.set_major_locator(FixedLocator(series_125(low, high, steps)))
        side.set_minor_locator(NullLocator())
    digits = 1 if log else 3
    if second.unit:
        side.set_major_formatter(FuncFormatter(lambda value, _: engineering(value, second.unit, digits)))


def _draw_mark(
    axes: Axes, mark: Mark, x: tuple[float, float], y: tuple[float, float], width: float, order: float
) -> None:
    """Draw a mark in a panel of a width in inches that reaches from end to end of `x` and `y`."""
    match mark:
        case Line():
            axes.plot(
                mark.x, mark.y, color=mark.colour, linestyle=_style(mark.dashes, mark.width),
                linewidth=mark.width, marker=mark.marker or None, alpha=mark.opacity,
                label=mark.label or None, zorder=order, solid_capstyle="butt",
            )  # fmt: skip
        case Area():
            thin = 0.4 if mark.opacity == 1.0 else 0.0  # seen at all where it is flat
            axes.fill_between(
                mark.x, mark.low, mark.high, color=mark.colour, alpha=mark.opacity, linewidth=thin,
                label=mark.label or None, zorder=order,
            )  # fmt: skip
        case Boxes():
            _draw_boxes(axes, mark, x, y, order)
        case Rules():
            _draw_rules(axes, mark, order)
        case Note():
            _write_note(axes, mark, x, y)
        case Field():
            _draw_field(axes, mark, width)
        case Shape():
            axes.add_patch(
                Polygon(
                    np.column_stack([mark.x, mark.y]), facecolor=mark.fill or "none",
                    edgecolor=mark.colour or "none", linewidth=mark.width, alpha=mark.opacity,
                    linestyle=_style(mark.dashes, mark.width), zorder=order,
                )
            )  # fmt: skip


def _style(dashes: Sequence[float], width: float) -> Any:
    if width <= 0:
        return "none"
    return (0, tuple(dashes)) if dashes else "-"


def _draw_boxes(
    axes: Axes, mark: Boxes, x: tuple[float, float], y: tuple[float, float], order: float
) -> None:
    """Draw rectangles, the endless ones behind the grid."""
    endless = not np.isfinite([*mark.left, *mark.right, *mark.low, *mark.high]).all()
    left, right = (np.clip(edge, min(x), max(x)) for edge in (mark.left, mark.right))
    low, high = (np.clip(edge, min(y), max(y)) for edge in (mark.low, mark.high))
    corners = np.stack([left, low, left, high, right, high, right, low], axis=-1).reshape(-1, 4, 2)
    look: dict[str, Any] = {"zorder": 0.2 if endless else order, "label": mark.label or None}
    if mark.hatch:  # drawn in the colour of the outline
        look |= {"hatch": HATCHES[mark.hatch]}
    edge = mark.edge or ("white" if mark.hatch else "none")
    width = 0.8 if mark.edge else 0.0
    axes.add_collection(
        PolyCollection(
            list(corners),
            facecolors=mark.colour,
            edgecolors=edge,
            linewidths=width,
            alpha=mark.opacity,
            **look,
        ),
        autolim=False,
    )


def _draw_rules(axes: Axes, mark: Rules, order: float) -> None:
    """Draw lines across the panel, or short ones at its edge."""
    look: dict[str, Any] = {
        "color": mark.colour, "linewidth": mark.width, "linestyle": _style(mark.dashes, mark.width),
        "label": mark.label or None, "zorder": order,
    }  # fmt: skip
    end = 0.04 if mark.short else 1.0
    if mark.along == "x":
        axes.vlines(mark.at, 0.0, end, transform=axes.get_xaxis_transform(), **look)
    else:
        axes.hlines(mark.at, 0.0, end, transform=axes.get_yaxis_transform(), **look)


def _write_note(axes: Axes, note: Note, x: tuple[float, float], y: tuple[float, float]) -> None:
    """Write words at a place, a little beside it; what lies outside the panel is left out."""
    inside = (note.x_share or min(x) <= note.x <= max(x)) and (note.y_share or min(y) <= note.y <= max(y))
    if not inside:
        return
    across = axes.transAxes if note.x_share else axes.transData
    upwards = axes.transAxes if note.y_share else axes.transData
    beside = {"left": 4.0, "right": -4.0, "center": 0.0}[note.align]
    axes.annotate(
        note.text,
        (note.x, note.y),
        xycoords=blended_transform_factory(across, upwards),
        xytext=(beside, 0.0),
        textcoords="offset points",
        ha=note.align,
        va=("top" if note.y > 0.5 else "bottom") if note.y_share else "center",
        rotation=90 if note.upright else 0,
        fontsize=8.5,
        color=note.colour,
        zorder=4,
        bbox={"facecolor": "white", "alpha": 0.6, "edgecolor": "none", "pad": 0.5},
    )


def _draw_field(axes: Axes, mark: Field, width: float) -> None:
    """Draw numbers as colours, with their scale."""
    image = axes.imshow(
        mark.values.T, origin="lower", extent=(*mark.x, *mark.y), aspect="auto", cmap=mark.colours,
        vmin=mark.low, vmax=mark.high, zorder=0.3,
    )  # fmt: skip
    below, above = bool(np.nanmin(mark.values) < mark.low), bool(np.nanmax(mark.values) > mark.high)
    extend = {(True, True): "both", (True, False): "min", (False, True): "max"}.get((below, above), "neither")
    beside = axes.inset_axes((1.0 + 0.1 / width, 0.0, 0.13 / width, 1.0))
    axes.figure.colorbar(image, cax=beside, label=mark.label, extend=extend)


def _legend(axes: Axes, width: float, above: float, named: set[tuple[str, str]]) -> float:
    """Legend in rows above the axes, clear of the data; return the points that it takes."""
    handles, labels = axes.get_legend_handles_labels()
    fresh = [
        (handle, label)
        for handle, label in zip(handles, labels, strict=True)
        if (label, _looks(handle)) not in named
    ]
    if not fresh:
        return above
    named |= {(label, _looks(handle)) for handle, label in fresh}
    columns = _columns([label for _, label in fresh], width / LETTER)
    axes.legend(
        *zip(*fresh, strict=True),
        loc="lower left",
        bbox_to_anchor=(-0.01, 1.0),
        bbox_transform=axes.transAxes + ScaledTranslation(0, above / 72, axes.figure.dpi_scale_trans),
        ncols=columns,
        handlelength=2.6,
        columnspacing=1.6,
        borderaxespad=0.2,
    )
    return above + 4 + ROW * -(-len(fresh) // columns)


def _looks(handle: Any) -> str:
    """What tells the marks of a legend apart."""
    return f"{type(handle).__name__} {handle.get_color() if hasattr(handle, 'get_color') else ''}"


def _columns(labels: Sequence[str], room: float, most: int = 7) -> int:
    """Columns of a legend that so many letters have room for."""
    for columns in range(min(most, len(labels)), 1, -1):
        widest = [max(map(len, column)) for column in np.array_split(labels, columns)]
        if sum(widest) + HANDLE * len(widest) <= room:
            return columns
    return 1
