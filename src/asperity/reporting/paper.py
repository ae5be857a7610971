"""Figures as files, for papers and notebooks: what matplotlib draws of a chart."""

import io
import warnings
from collections.abc import Sequence
from typing import Any, BinaryIO

import numpy as np
from matplotlib import rc_context, ticker
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.transforms import ScaledTranslation, blended_transform_factory

from asperity.reporting import chart, data

RC: dict[Any, Any] = {
    "svg.fonttype": "none",
    "svg.hashsalt": "asperity",
    "font.size": 9,
    "axes.titlesize": 9.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.edgecolor": chart.MUTED,
    "axes.labelcolor": chart.INK,
    "axes.facecolor": "none",
    "axes.linewidth": 0.7,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": chart.GRID,
    "hatch.linewidth": 0.8,
    "text.color": chart.INK,
    "text.parse_math": False,
    "xtick.color": chart.MUTED,
    "ytick.color": chart.MUTED,
    "xtick.labelcolor": chart.INK,
    "ytick.labelcolor": chart.INK,
    "xtick.labelsize": 8.5,
    "ytick.labelsize": 8.5,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "lines.markersize": 4,
    "image.interpolation": "nearest",
}
UNDATED = {"svg": {"Date": None}, "pdf": {"CreationDate": None}, "png": {}}
"""So that files of the same numbers are the same."""
DOTS = 150
"""Per inch, of a PNG, and of what is no line in the others."""
LETTER = 0.068
"""Width of a letter in inches."""
ROW = 13.0
"""Height of a row of a legend in points."""
HANDLE = 10
"""Letters that the handle of a legend takes."""
OPPOSITE = 32.0
"""Points that an axis opposite takes above a panel."""
HATCHES = {"/": "///", "\\": "\\\\\\", "x": "xxx", ".": "..", "-": "---"}
MARGIN = 0.04
"""Share of the height of a panel that is left free above and below its marks."""
Ends = tuple[float, float]


class ShownFigure(Figure):
    """A figure that a notebook shows, whether or not matplotlib was told to draw into it."""

    def _repr_png_(self) -> bytes:
        image = io.BytesIO()
        save_figure(self, image, "png")
        return image.getvalue()


def draw(drawn: chart.Chart, title: str = "") -> ShownFigure:
    """Draw a chart on white ground, in the width of the page, its panels beneath each other in rows."""
    with rc_context(RC):
        rows = chart.rows_of(drawn)
        heights = [max(panel.height for panel in row) for row in rows]
        figure = ShownFigure(figsize=(chart.WIDE, sum(heights)), layout="constrained")
        grid = figure.add_gridspec(len(rows), 1, height_ratios=heights)
        named: set[tuple[str, str]] = set()
        for number, row in enumerate(rows):
            shares = [panel.share for panel in row]
            inner = grid[number].subgridspec(1, len(row), width_ratios=shares)
            for n, panel in enumerate(row):  # one alone stands in the column of the others
                axes = figure.add_subplot(grid[number] if len(row) == 1 else inner[n])
                _draw_panel(axes, panel, chart.WIDE * panel.share / sum(shares), named)
        if title:
            figure.suptitle(title, x=0.01, ha="left", fontweight="bold", fontsize=10)
    return figure


def save_figure(figure: Figure, file: BinaryIO, format: str) -> None:
    """Write a figure to an open file, the same for the same numbers."""
    with rc_context(RC), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "constrained_layout not applied", UserWarning)
        figure.savefig(file, format=format, dpi=DOTS, metadata=UNDATED[format])


def _draw_panel(axes: Axes, panel: chart.Panel, width: float, named: set[tuple[str, str]]) -> None:
    """Draw a panel of a width in inches; what is `named` already gets no second place in a legend."""
    axes.set(xscale="log" if panel.x.log else "linear", yscale="log" if panel.y.log else "linear")
    axes.margins(0.0, MARGIN)
    ends = {"xlim": (panel.x.low, panel.x.high), "ylim": (panel.y.low, panel.y.high)}
    for endless in (False, True):  # what goes by the ends of the panel comes when the others have set them
        for order, mark in enumerate(panel.marks):
            if _is_endless(mark) == endless:
                _draw_mark(axes, mark, width, 2 + order / len(panel.marks))
        axes.set(**ends)
    _draw_axis(axes, "x", panel.x, axes.get_xlim(), width)
    _draw_axis(axes, "y", panel.y, axes.get_ylim(), panel.height)
    if panel.equal:
        axes.set_aspect("equal")
    if panel.plain or any(isinstance(mark, chart.Field) for mark in panel.marks):
        axes.grid(visible=False)
    if panel.plain:
        shown: dict[str, Any] = {"left": bool(panel.y.label), "bottom": bool(panel.x.label)}
        axes.spines[["right", "top", *(side for side, name in shown.items() if not name)]].set_visible(False)
        axes.tick_params(**shown, **{f"label{side}": name for side, name in shown.items()})
    above = _legend(axes, width, OPPOSITE if panel.x.second else 0.0, named)
    if panel.title:
        axes.set_title(panel.title, pad=6 + above)


def _is_endless(mark: chart.Mark) -> bool:
    """Whether a mark is as long as the panel, or stands where there is room."""
    if isinstance(mark, chart.Boxes):
        return not np.isfinite([mark.left, mark.right, mark.low, mark.high]).all()
    return isinstance(mark, chart.Rules | chart.Note)


def _draw_axis(axes: Axes, way: str, axis: chart.Axis, ends: Ends, length: float) -> None:
    """Ticks and name of an axis of a length in inches, and what stands opposite to it."""
    side = axes.xaxis if way == "x" else axes.yaxis
    low, high = sorted(ends)
    side.set_label_text(axis.label)
    if axis.ticks:
        at, names = zip(*axis.ticks, strict=True)
        side.set_major_locator(ticker.FixedLocator(at))
        side.set_major_formatter(ticker.FuncFormatter(dict(zip(at, names, strict=True)).get))
        shown = sum(len(name) + 1.5 for number, name in axis.ticks if low <= number <= high)
        if way == "x" and shown * LETTER > 0.9 * length:
            axes.tick_params(axis="x", labelrotation=90)
    elif axis.log and high / low < 300 and low >= 1e-3 and high <= 1e5:
        side.set_major_locator(ticker.LogLocator(subs=(1.0, 2.0, 5.0)))
        side.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:g}"))
    elif axis.log:
        side.set_major_formatter(ticker.FuncFormatter(lambda value, _: data.power_of_ten(value)))
    if axis.minor or axis.ticks:
        side.set_minor_locator(ticker.FixedLocator(axis.minor))
    side.set_minor_formatter(ticker.NullFormatter())
    if axis.second:
        _draw_second(axes, way, axis.second, axis.log, (low, high), length)


def _draw_second(axes: Axes, way: str, second: chart.Second, log: bool, ends: Ends, length: float) -> None:
    """Axis opposite to another, in what it is scaled to."""

    def there(q: Any) -> Any:
        with np.errstate(divide="ignore"):
            return second.scale / np.asarray(q) if second.inverse else second.scale * q + second.offset

    def back(q: Any) -> Any:
        return there(q) if second.inverse else (q - second.offset) / second.scale

    both = (there, back)
    x = way == "x"
    opposite: Any = (
        axes.secondary_xaxis("top", functions=both) if x else axes.secondary_yaxis("right", functions=both)
    )
    side = opposite.xaxis if x else opposite.yaxis
    side.set_label_text(second.label)
    if log:
        low, high = sorted(float(there(np.array(end))) for end in ends)
        steps = (1.0, 2.0, 5.0) if high / low <= 3000 * length / chart.WIDE else (1.0,)
        side.set_major_locator(ticker.LogLocator(subs=steps))
        side.set_minor_locator(ticker.NullLocator())
    if second.unit:
        digits = 1 if log else 3
        words = ticker.FuncFormatter(lambda value, _: data.engineering(value, second.unit, digits))
        side.set_major_formatter(words)
    elif log:
        side.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:g}"))


def _draw_mark(axes: Axes, mark: chart.Mark, width: float, order: float) -> None:
    """Draw a mark in a panel of a width in inches."""
    look: dict[str, Any] = {"label": getattr(mark, "label", "") or None, "zorder": order}
    match mark:
        case chart.Line():
            look |= {"linestyle": _style(mark.dashes, mark.width), "linewidth": mark.width}
            look |= {"marker": mark.marker or None, "alpha": mark.opacity, "solid_capstyle": "butt"}
            axes.plot(mark.x, mark.y, color=mark.colour, **look)
        case chart.Area():
            look["linewidth"] = 0.4 if mark.opacity == 1.0 else 0.0  # seen at all where it is flat
            axes.fill_between(mark.x, mark.low, mark.high, color=mark.colour, alpha=mark.opacity, **look)
        case chart.Boxes():
            _draw_boxes(axes, mark, look)
        case chart.Rules():  # across the panel, or short ones at its edge
            look |= {"linestyle": _style(mark.dashes, mark.width), "linewidth": mark.width}
            along_x = mark.along == "x"
            end = 0.04 if mark.short else 1.0
            transform = axes.get_xaxis_transform() if along_x else axes.get_yaxis_transform()
            lines = axes.vlines if along_x else axes.hlines
            lines(mark.at, 0.0, end, color=mark.colour, transform=transform, **look)
        case chart.Note():
            _write_note(axes, mark)
        case chart.Field():
            _draw_field(axes, mark, width)
        case chart.Shape():
            look |= {"facecolor": mark.fill or "none", "edgecolor": mark.colour or "none"}
            look |= {"linewidth": mark.width, "linestyle": _style(mark.dashes, mark.width)}
            axes.add_patch(Polygon(np.column_stack([mark.x, mark.y]), alpha=mark.opacity, **look))


def _style(dashes: Sequence[float], width: float) -> Any:
    return "none" if width <= 0 else (0, tuple(dashes)) if dashes else "-"


def _draw_boxes(axes: Axes, mark: chart.Boxes, look: dict[str, Any]) -> None:
    """Draw rectangles, the endless ones behind the grid."""
    left = mark.left
    right = mark.right
    low = mark.low
    high = mark.high
    if _is_endless(mark):
        look["zorder"] = 0.2
        x = axes.get_xlim()
        y = axes.get_ylim()
        left, right = (np.clip(edge, min(x), max(x)) for edge in (left, right))
        low, high = (np.clip(edge, min(y), max(y)) for edge in (low, high))
    corners = np.stack([left, low, left, high, right, high, right, low], axis=-1).reshape(-1, 4, 2)
    if mark.hatch:  # drawn in the colour of the outline
        look["hatch"] = HATCHES[mark.hatch]
    look |= {"edgecolors": mark.edge or ("white" if mark.hatch else "none")}
    look |= {"linewidths": 0.8 if mark.edge else 0.0, "alpha": mark.opacity}
    axes.add_collection(PolyCollection(list(corners), facecolors=mark.colour, **look))


def _write_note(axes: Axes, note: chart.Note) -> None:
    """Write words at a place, a little beside it; what lies outside the panel is left out."""
    x = axes.get_xlim()
    y = axes.get_ylim()
    inside = (note.x_share or min(x) <= note.x <= max(x)) and (note.y_share or min(y) <= note.y <= max(y))
    if not inside:
        return
    across, upwards = (axes.transAxes if share else axes.transData for share in (note.x_share, note.y_share))
    look: dict[str, Any] = {"ha": note.align, "rotation": 90 if note.upright else 0, "color": note.colour}
    axes.annotate(
        note.text,
        (note.x, note.y),
        xycoords=blended_transform_factory(across, upwards),
        xytext=({"left": 4.0, "right": -4.0, "center": 0.0}[note.align], 0.0),
        textcoords="offset points",
        va=("top" if note.y > 0.5 else "bottom") if note.y_share else "center",
        fontsize=8.5,
        zorder=4,
        bbox={"facecolor": "white", "alpha": 0.6, "edgecolor": "none", "pad": 0.5},
        **look,
    )


def _draw_field(axes: Axes, mark: chart.Field, width: float) -> None:
    """Draw numbers as colours, with their scale."""
    look: dict[str, Any] = {"cmap": mark.colours, "vmin": mark.low, "vmax": mark.high, "zorder": 0.3}
    values, (right, top) = chart.as_seen(mark.values)
    x, y = ((low, low + share * (high - low)) for (low, high), share in ((mark.x, right), (mark.y, top)))
    image = axes.imshow(values.T, origin="lower", extent=(*x, *y), aspect="auto", **look)
    axes.set(xlim=mark.x, ylim=mark.y)
    below = bool(np.nanmin(mark.values) < mark.low)
    above = bool(np.nanmax(mark.values) > mark.high)
    extend = {(True, True): "both", (True, False): "min", (False, True): "max"}.get((below, above), "neither")
    beside = axes.inset_axes((1.0 + 0.1 / width, 0.0, 0.13 / width, 1.0))
    axes.figure.colorbar(image, cax=beside, label=mark.label, extend=extend)


def _legend(axes: Axes, width: float, above: float, named: set[tuple[str, str]]) -> float:
    """Legend in rows above the axes, clear of the data; return the points that it takes."""
    fresh = {}
    for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
        colour = handle.get_color() if hasattr(handle, "get_color") else ""
        fresh[handle, label] = (label, f"{type(handle).__name__} {colour}")
    shown = [each for each, look in fresh.items() if look not in named]
    if not shown:
        return above
    named |= set(fresh.values())
    widest = max(len(label) for _, label in shown) + HANDLE
    columns = min(len(shown), max(1, int(width / LETTER / widest)), 7)
    shift = ScaledTranslation(0, above / 72, axes.figure.dpi_scale_trans)
    axes.legend(
        *zip(*shown, strict=True),
        loc="lower left",
        bbox_to_anchor=(-0.01, 1.0),
        bbox_transform=axes.transAxes + shift,
        ncols=columns,
        handlelength=2.6,
        columnspacing=1.6,
        borderaxespad=0.2,
    )
    return above + 4 + ROW * -(-len(shown) // columns)
