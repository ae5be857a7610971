"""A figure as numbers: panels with axes and marks, which the page and matplotlib draw alike."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from asperity.reporting.style import INK, MUTED

Numbers = NDArray[np.float64]
Dashes = tuple[float, ...]
"""Lengths that are drawn and left out, in turn, in points at a width of one; empty for a full line."""

FREQUENCY, TIME = "frequency", "time"
"""Quantities by which axes are linked: a cursor on one stands on all."""


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

    x: Numbers
    y: Numbers
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

    x: Numbers
    low: Numbers
    high: Numbers
    label: str = ""
    colour: str = INK
    opacity: float = 0.25
    law: str = ""


@dataclass(frozen=True, eq=False)
class Boxes:
    """Rectangles, all (n,): bars, stretches of time, bands that say little. Infinite: to the edge."""

    left: Numbers
    right: Numbers
    low: Numbers
    high: Numbers
    label: str = ""
    colour: str = INK
    opacity: float = 1.0
    hatch: str = ""  # "/", "\\", "x", "." or "-", for those who do not see colours
    law: str = ""
    edge: str = ""  # colour of the outline


@dataclass(frozen=True, eq=False)
class Rules:
    """Lines across the panel, or short ones at its edge, at places (n,) of the axis `along`."""

    at: Numbers
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
    values: Numbers
    label: str  # of the scale of colours
    low: float
    high: float
    colours: str = "cividis"  # or "inferno_r"


@dataclass(frozen=True, eq=False)
class Shape:
    """A closed outline through points (n,), for drawings."""

    x: Numbers
    y: Numbers
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
    bare: bool = False  # without axes: a drawing


@dataclass(frozen=True, eq=False)
class Chart:
    """Panels beneath each other; those whose x axes are linked zoom together."""

    panels: tuple[Panel, ...]
    # where a reader may want to go: by name, stretches of x (n, 2); a button shows one after the other
    places: Mapping[str, Numbers] = field(default_factory=lambda: MappingProxyType({}))
    # no diagram: drawn once, as it is, and not zoomed; an axis without a label is not drawn
    drawing: bool = False

    @property
    def laws(self) -> list[str]:
        """Laws that can be shown or not, in the order of the marks."""
        found = (getattr(mark, "law", "") for panel in self.panels for mark in panel.marks)
        return [law for law in dict.fromkeys(found) if law]
