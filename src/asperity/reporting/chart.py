"""A figure as numbers: panels with axes and marks, which the page and matplotlib draw alike."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import cycle
from typing import Any

import numpy as np

from asperity.arguments import Array, Integers

Dashes = tuple[float, ...]
"""Lengths that are drawn and left out, in turn, in points at a width of one; empty for a full line."""
FREQUENCY, TIME = "frequency", "time"
"""Quantities by which axes are linked: a cursor on one stands on all."""
WIDE = 9.6
"""Inches: a figure as wide as the page."""
SEEN = 1024
"""Numbers along a side of a field, about, that are drawn of more: no panel has as many dots."""
INK = "#1c2126"
MUTED = "#5b6670"
GRID = "#dfe3e7"
BLUE = "#0067a5"
VERMILLION = "#c8500a"
GREEN = "#00805c"

# The page replaces every colour of this table by a CSS variable, with a second value for dark screens.
COLOURS = {
    INK: "#e8eaed",
    MUTED: "#a3adb7",
    GRID: "#333a42",
    "#6b3e12": "#d6a074",  # brown
    "#2c3e91": "#8f9dff",  # navy
    "#b01b3c": "#ff7d90",  # crimson
    "#6750b8": "#b9a8ff",  # violet
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
DASHES = ((), (6, 1.5), (6, 1.5, 1.5, 1.5), (3, 1.5), (1.5, 1.5), (9, 1.5, 1.5, 1.5, 1.5, 1.5))
"""Of lines of a sequence, for the same."""
LAW_COLOURS = tuple(COLOURS)[3:-6]
SEQUENCE = tuple(COLOURS)[-6:]


def colour_variables(dark: bool, colours: Mapping[str, str] = COLOURS) -> str:
    """CSS declarations of colours, by their places in the table: of their own values, or for dark screens."""
    return "".join(
        f"--c{index}:{other if dark else colour};" for index, (colour, other) in enumerate(colours.items())
    )


def spread(count: int, most: int) -> list[int]:
    """At most so many of `count` places, from the first to the last."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(int)).tolist()


def part_shown(shown: int, count: int, what: str) -> str:
    """Say how many of something are shown where that is not all."""
    return f"{shown} of {count} {what} are shown; the CSV file has all." if shown < count else ""


def sequence(count: int) -> list[str]:
    """`count` colours from low to high; repeats nothing up to six."""
    picks = np.linspace(0, len(SEQUENCE) - 1, count).round().astype(int)
    return [SEQUENCE[pick] for pick in picks]


def sequence_styles(count: int) -> list[dict[str, Any]]:
    """Looks of `count` lines from low to high, by colour and by dashes."""
    looks = zip(sequence(count), cycle(DASHES), strict=False)
    return [{"colour": colour, "dashes": dashes} for colour, dashes in looks]


def decibels(power: Array, reference: float = 1.0) -> Array:
    """10 lg(power/reference); NaN where there is no power."""
    return 10 * np.log10(np.where(power > 0, power / reference, np.nan))


def envelope(signal: Array, columns: int) -> tuple[Integers, Array, Array]:
    """Smallest and largest value of a long series (n,) in each of at most `columns` stretches.

    Returns the index at which each stretch starts, and the extremes, all (m,).
    """
    starts = np.unique(
        np.linspace(0, len(signal), min(columns, len(signal)), endpoint=False).astype(np.int64)
    )
    return starts, np.fmin.reduceat(signal, starts), np.fmax.reduceat(signal, starts)


def as_seen(values: Array) -> tuple[Array, tuple[float, float]]:
    """Numbers (nx, ny) as means over blocks where more are held than a picture has dots, and the share of
    either side that they cover."""
    blocks = [max(1, round(n / SEEN)) for n in values.shape]
    if max(blocks) == 1:
        return values, (1.0, 1.0)
    nx, ny = (n // block * block for n, block in zip(values.shape, blocks, strict=True))
    within = values[:nx, :ny].reshape(nx // blocks[0], blocks[0], ny // blocks[1], blocks[1])
    known = np.isfinite(within).sum(axis=(1, 3))
    total = np.nansum(within, axis=(1, 3))
    means = np.divide(total, known, out=np.full(known.shape, np.nan), where=known > 0)
    return means, (nx / values.shape[0], ny / values.shape[1])


def smooth_on_log_axis(frequency: Array, psd: Array) -> tuple[Array, Array]:
    """Mean power in stretches of a 24th of an octave, where lines are denser than that; for drawing only.

    Positive, increasing frequencies or wavenumbers (n,) and PSD (..., n); returns the same, with fewer lines.
    """
    index = np.floor(np.log2(frequency / frequency[0]) * 24).astype(int)
    starts = np.flatnonzero(np.diff(index, prepend=-1))
    count = np.diff(np.append(starts, len(frequency)))
    return np.add.reduceat(frequency, starts) / count, np.add.reduceat(psd, starts, axis=-1) / count


@dataclass(frozen=True)
class Second:
    """A second scale opposite to an axis: ``scale q + offset``, or ``scale / q``, of what the axis shows."""

    label: str
    scale: float = 1.0
    offset: float = 0.0
    inverse: bool = False
    unit: str = ""  # in SI, where ticks are written with prefixes: ``"m"``


@dataclass(frozen=True)
class Axis:
    """What is drawn along one side of a panel, from `low` to `high`; None: as far as the marks reach.

    A `low` above `high` turns the axis round. Without `ticks` the drawer places them.
    """

    label: str
    low: float | None = None
    high: float | None = None
    log: bool = False
    ticks: tuple[tuple[float, str], ...] = ()
    minor: tuple[float, ...] = ()  # grid lines without a name
    second: Second | None = None
    linked: str = ""


@dataclass(frozen=True, eq=False)
class Line:
    """A line through points (n,); it is broken where a number is missing."""

    x: Array
    y: Array
    label: str = ""  # in legend and read-out; without one it stands in neither
    colour: str = INK
    dashes: Dashes = ()
    width: float = 1.3  # points; 0: markers alone
    marker: str = ""  # in the letters of matplotlib
    opacity: float = 1.0
    law: str = ""  # with which it is shown or not


@dataclass(frozen=True, eq=False)
class Area:
    """What lies between two lines over x, all (n,)."""

    x: Array
    low: Array
    high: Array
    label: str = ""
    colour: str = INK
    opacity: float = 0.25
    law: str = ""


@dataclass(frozen=True, eq=False)
class Boxes:
    """Rectangles, all (n,): bars, stretches of time, bands that say little. Infinite: to the edge."""

    left: Array
    right: Array
    low: Array
    high: Array
    label: str = ""
    colour: str = INK
    opacity: float = 1.0
    hatch: str = ""  # "/", "\\", "x", "." or "-", for those who do not see colours
    law: str = ""
    edge: str = ""  # colour of the outline


@dataclass(frozen=True, eq=False)
class Rules:
    """Lines across the panel, or short ones at its edge, at places (n,) of the axis `along`."""

    at: Array
    along: str = "x"
    label: str = ""
    colour: str = MUTED
    dashes: Dashes = (1.0, 1.5)
    width: float = 0.9
    short: bool = False


@dataclass(frozen=True)
class Note:
    """Words at a place; coordinates may be shares of the panel, from its lower left corner."""

    text: str
    x: float
    y: float
    x_share: bool = False
    y_share: bool = False
    align: str = "left"  # words begin ("left") or end ("right") at the place, or have it in their "center"
    upright: bool = False  # written along y
    colour: str = MUTED
    law: str = ""


@dataclass(frozen=True, eq=False)
class Field:
    """Numbers over a rectangle, (nx, ny), drawn in colours; nothing where a number is missing."""

    x: tuple[float, float]  # edges
    y: tuple[float, float]
    values: Array
    label: str  # of the scale of colours
    low: float
    high: float
    colours: str = "cividis"  # or "inferno_r"


@dataclass(frozen=True, eq=False)
class Shape:
    """A closed outline through points (n,), for drawings."""

    x: Array
    y: Array
    fill: str = ""
    colour: str = INK  # of the outline; empty for none
    width: float = 0.8
    opacity: float = 1.0
    dashes: Dashes = ()


Mark = Line | Area | Boxes | Rules | Note | Field | Shape


@dataclass(frozen=True, eq=False)
class Panel:
    """Two axes and what is drawn between them, from behind to the front."""

    x: Axis
    y: Axis
    marks: tuple[Mark, ...]
    title: str = ""
    height: float = 3.6  # inches, at a width of `style.WIDE`
    equal: bool = False  # a metre is as long along x as along y
    beside: bool = False  # in one row with the panel before, where the page is wide enough
    share: float = 1.0  # of the width of its row
    plain: bool = False  # a drawing: no grid, and no axis without a label


Drawn = Iterator[Panel | str]
"""What a figure yields: its panels, and sentences of its caption."""


@dataclass(frozen=True, eq=False)
class Chart:
    """Panels beneath each other; those whose x axes are linked zoom together."""

    panels: tuple[Panel, ...]


def rows_of(chart: Chart) -> list[list[Panel]]:
    """Panels of a chart that stand in one row."""
    rows: list[list[Panel]] = []
    for panel in chart.panels:
        if panel.beside and rows:
            rows[-1].append(panel)
        else:
            rows.append([panel])
    return rows
