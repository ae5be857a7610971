"""One look for all figures: colours that colour-blind readers can tell apart, dashes, axes of the field."""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter, NullLocator
from numpy.typing import NDArray

from asperity.reporting.data import engineering, nominal_band, power_of_ten

WIDE, NARROW = 9.6, 4.5  # inches; a figure as wide as the page, and as that of a phone
INK, MUTED, GRID = "#1c2126", "#5b6670", "#dfe3e7"
BLUE, VERMILLION, GREEN = "#0067a5", "#c8500a", "#00805c"

# The page replaces every colour of this table by a CSS variable, with a second value for dark screens.
COLOURS = {
    INK: "#e8eaed",
    MUTED: "#a3adb7",
    GRID: "#333a42",
    BLUE: "#58b0f0",
    VERMILLION: "#ff8b4d",
    "#a8458f": "#e58fcf",  # purple
    GREEN: "#2fc79a",
    "#96700a": "#e3b341",  # ochre
    "#2a93c4": "#8fd3f4",  # sky
    "#6f7a85": "#98a3ae",  # grey
    # a sequence from low to high (approaches, sensors)
    "#2b0f7a": "#7f8cff",
    "#7a0fa8": "#b083ff",
    "#b52f8c": "#e27fd0",
    "#d9566b": "#ff8c94",
    "#e07f2d": "#ffb066",
    "#b58a00": "#f5e05f",
}
SEQUENCE = tuple(COLOURS)[-6:]

Dashes = str | tuple[float, tuple[float, ...]]


NARROW_LETTERS, HANDLE_LETTERS = 66, 10  # in one row of a legend, and what a handle takes of them

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
    "figure.facecolor": "none",
    "figure.constrained_layout.use": True,
    "grid.color": GRID,
    "grid.linewidth": 0.6,
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
    "lines.linewidth": 1.3,
    "lines.markersize": 4,
    "path.simplify": True,
    "path.simplify_threshold": 0.2,  # of a pixel
    "image.interpolation": "nearest",
}


def styled() -> Any:
    """Context, or decorator, in which a figure is drawn in the style of the report."""
    return rc_context(RC)


_width: ContextVar[float] = ContextVar("width", default=WIDE)


@contextmanager
def narrow_page() -> Iterator[None]:
    """Draw figures for the width of a phone while the body of the ``with`` statement runs."""
    token = _width.set(NARROW)
    try:
        yield
    finally:
        _width.reset(token)


def is_narrow() -> bool:
    """Whether figures are drawn for the width of a phone."""
    return _width.get() == NARROW


class ShownFigure(Figure):
    """A figure that a notebook shows, whether or not matplotlib was told to draw into it."""

    def _repr_png_(self) -> bytes:
        image = io.BytesIO()
        self.savefig(image, format="png")
        return image.getvalue()


def new_figure(height: float) -> Figure:
    """Empty figure, as wide as the page and `height` inches high."""
    return ShownFigure(figsize=(_width.get(), height))


def side_by_side(height: float, widths: Sequence[float]) -> tuple[Figure, list[Axes]]:
    """Figure with panels of the relative `widths` in a row; beneath each other where the page is narrow."""
    if is_narrow():
        figure = new_figure(0.85 * height * len(widths))
        return figure, list(figure.subplots(len(widths), 1))
    figure = new_figure(height)
    return figure, list(figure.subplots(1, len(widths), width_ratios=widths))


def sequence(count: int) -> list[str]:
    """`count` colours from low to high; repeats nothing up to six."""
    picks = np.linspace(0, len(SEQUENCE) - 1, max(count, 1)).round().astype(int)
    return [SEQUENCE[pick] for pick in picks]


def frequency_axis(axes: Axes, low: float, high: float, label: str = "frequency / Hz") -> None:
    """Logarithmic frequency axis with grid lines at the one-third octaves, labelled at the octaves."""
    centres = 1000 * 10 ** (np.arange(-30, 21) / 10)
    axes.set_xscale("log")
    axes.set_xlim(low, high)
    octaves = [f for i, f in enumerate(centres) if i % 3 == 0]  # … 31.5, 63, 125, …, 1k, 2k, 4k
    axes.xaxis.set_major_locator(FixedLocator(octaves))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda f, _: nominal_band(f)))
    axes.xaxis.set_minor_locator(FixedLocator([f for i, f in enumerate(centres) if i % 3]))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_xlabel(label)


def band_axis(axes: Axes, bands: NDArray[np.float64], label: str = "one-third octave band / Hz") -> None:
    """Logarithmic frequency axis with every one-third octave named."""
    edge = 10**0.05
    axes.set_xscale("log")
    axes.set_xlim(bands[0] / edge, bands[-1] * edge)
    axes.xaxis.set_major_locator(FixedLocator(bands.tolist()))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda f, _: nominal_band(f)))
    axes.xaxis.set_minor_locator(NullLocator())
    if len(bands) > 14:
        axes.tick_params(axis="x", labelrotation=90)
    axes.set_xlabel(label)


def shade_doubtful(
    axes: Axes, bands: NDArray[np.float64], doubtful: NDArray[np.bool_], labelled: bool = True
) -> None:
    """Shade the bands (by their centres) whose levels say little."""
    if not doubtful.any():
        return
    edge = 10**0.05
    marked = np.flatnonzero(doubtful)
    for run in np.split(bands[marked], np.flatnonzero(np.diff(marked) > 1) + 1):
        axes.axvspan(run.min() / edge, run.max() * edge, color=GRID, alpha=0.6, linewidth=0, zorder=0)
    if labelled:
        note_at(axes, axes.get_xlim()[0], 0.03, "says little", va="bottom")  # low bands are left


def power_axis(axis: Any) -> None:
    """Write the decades of a logarithmic axis as powers of ten."""
    axis.set_major_formatter(FuncFormatter(lambda value, _: power_of_ten(value)))
    axis.set_minor_formatter(NullFormatter())


def wavenumber_axis(axes: Axes, low: float, high: float) -> None:
    """Logarithmic axis of wavenumber in 1/m (cycles per metre), with the wavelength along the top."""
    axes.set_xscale("log")
    axes.set_xlim(low, high)
    power_axis(axes.xaxis)
    if high / low < 300:  # few decades: name 1, 2 and 5 of each
        axes.xaxis.set_major_locator(FixedLocator(_series(low, high)))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda k, _: f"{k:g}"))
    axes.set_xlabel("wavenumber / (1/m)")
    top = axes.twiny()
    top.set_xscale("log")
    top.set_xlim(low, high)
    top.grid(visible=False)
    many = 300 if is_narrow() else 3000
    steps = _series(1 / high, 1 / low, (1.0,) if high / low > many else (1.0, 2.0, 5.0))
    top.xaxis.set_major_locator(FixedLocator([1 / step for step in steps]))
    top.xaxis.set_major_formatter(FuncFormatter(lambda k, _: engineering(1 / k, "m", 1)))
    top.xaxis.set_minor_locator(NullLocator())
    top.set_xlabel("wavelength")


def _series(low: float, high: float, mantissas: Sequence[float] = (1.0, 2.0, 5.0)) -> list[float]:
    decades = range(int(np.floor(np.log10(low))), int(np.ceil(np.log10(high))) + 1)
    candidates = (mantissa * 10.0**decade for decade in decades for mantissa in mantissas)
    return [c for c in candidates if low * (1 - 1e-9) <= c <= high * (1 + 1e-9)]


def level_limits(
    axes: Axes, levels: Iterable[NDArray[np.float64]], span: float = 80.0, step: float = 10.0
) -> None:
    """Limits of an axis in dB: all the peaks, and at most `span` dB below the highest."""
    finite = np.concatenate(
        [np.ravel(level)[np.isfinite(np.ravel(level))] for level in levels] or [np.zeros(1)]
    )
    if finite.size == 0:
        return
    top = step * np.ceil((finite.max() + 0.1 * step) / step)
    bottom = max(step * np.floor(finite.min() / step), top - span)
    axes.set_ylim(bottom, top)


def decibels(power: NDArray[np.float64], reference: float = 1.0) -> NDArray[np.float64]:
    """10 lg(power/reference); NaN where there is no power."""
    ratio = np.where(power > 0, power / reference, np.nan)
    return 10 * np.log10(ratio)


def note_at(axes: Axes, x: float, height: float, text: str, va: str) -> None:
    """Write `text` beside `x`, where there is more room, at the share `height` of the axes."""
    place = axes.transAxes.inverted().transform(axes.transData.transform((x, axes.get_ylim()[0])))[0]
    axes.annotate(
        text,
        (x, height),
        xycoords=axes.get_xaxis_transform(),
        xytext=(5 if place < 0.5 else -5, 0),
        textcoords="offset points",
        ha="left" if place < 0.5 else "right",
        va=va,
        fontsize=8.5,
        color=MUTED,
    )


def legend_above(axes: Axes, columns: int = 7) -> None:
    """Legend in one row above the axes, clear of the data; in more rows where the page has no room for it."""
    columns = _columns(axes.get_legend_handles_labels()[1], columns)
    axes.legend(
        loc="lower left", bbox_to_anchor=(-0.01, 1.0), ncols=columns, handlelength=2.6, columnspacing=1.6
    )


def _columns(labels: Sequence[str], most: int) -> int:
    """Columns of a legend that the page has room for."""
    room = NARROW_LETTERS * _width.get() / NARROW
    for columns in range(min(most, len(labels)), 1, -1):
        widest = [max(map(len, column)) for column in np.array_split(labels, columns)]
        if sum(widest) + HANDLE_LETTERS * len(widest) <= room:
            return columns
    return 1


def envelope(
    signal: NDArray[np.float64], columns: int
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
    """Smallest and largest value of a long series (n,) in each of at most `columns` stretches.

    Returns the index at which each stretch starts, and the extremes, all (m,).
    """
    starts = np.unique(
        np.linspace(0, len(signal), min(columns, len(signal)), endpoint=False).astype(np.int64)
    )
    return starts, np.fmin.reduceat(signal, starts), np.fmax.reduceat(signal, starts)


def smooth_on_log_axis(
    frequency: NDArray[np.float64], psd: NDArray[np.float64], per_octave: int = 24
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Mean power in stretches of 1/`per_octave` octave, where lines are denser than that; for drawing only.

    Positive, increasing frequencies or wavenumbers (n,) and PSD (..., n); returns the same, with fewer lines.
    """
    index = np.floor(np.log2(frequency / frequency[0]) * per_octave).astype(int)
    starts = np.flatnonzero(np.diff(index, prepend=-1))
    count = np.diff(np.append(starts, len(frequency)))
    return np.add.reduceat(frequency, starts) / count, np.add.reduceat(psd, starts, axis=-1) / count
