"""Drawings of what rolls: as SVG, and the vocabulary of marks that they are laid out with."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from itertools import accumulate
from typing import Any

import numpy as np
from xarray import DataTree

from asperity.reporting import chart, data
from asperity.reporting.chart import (
    BLUE,
    GRID,
    INK,
    MUTED,
    Axis,
    Boxes,
    Dashes,
    Line,
    Mark,
    Note,
    Numbers,
    Panel,
    Shape,
)
from asperity.reporting.figure import Lines, Series
from asperity.schema import contact
from asperity.schema.rolling import POSITION

POINTS = 72.0
"""Points per inch."""
TEXT, LETTER, LINE = 9.0, 0.55, 12.0
"""Size of letters in points, their mean width as a share of it, and the distance of lines."""
OUTSIDE = {"left": 44.0, "right": 10.0, "top": 20.0, "bottom": 34.0}
"""Points around a panel for the words of its axes and its title."""
APART = 35.0
"""Points between ticks, at least."""
HATCH = 5.0
"""Points between the lines of a hatched box."""
TRIANGLE = np.array([-0.9, 0.9, 0.0]), np.array([0.8, 0.8, -0.8])
"""Outline of a marker, in 3 points."""


def svg_of(drawing: chart.Chart, title: str, colours: Mapping[str, str]) -> str:
    """Draw a chart for a wide page, and again for that of a phone; of the two the style sheet shows one.

    `colours` become the CSS variables of `chart.colour_variables`. Drawn are lines, triangles, shapes,
    hatched boxes and words.
    """
    rows = chart.rows_of(drawing)
    narrow = [[panel] for row in rows for panel in row]
    return "".join(
        f'<div class="drawing {name}">{_svg(panels, POINTS * width, title, colours)}</div>'
        for name, panels, width in (("wide", rows, chart.WIDE), ("narrow", narrow, chart.NARROW))
    )


@dataclass
class _Sheet:
    """Elements of a drawing, and the places of its words, which keep clear of each other."""

    colours: list[str]
    elements: list[str] = field(default_factory=list)
    words: list[tuple[float, float, float, float]] = field(default_factory=list)

    def colour(self, name: str) -> str:
        return f"var(--c{self.colours.index(name)})" if name in self.colours else name or "none"

    def path(
        self,
        points: str,
        colour: str,
        width: float = 0.7,
        *,
        fill: str = "",
        dashes: Dashes = (),
        opacity: float = 1.0,
    ) -> None:
        """Draw an outline or a line."""
        look = f' fill="{self.colour(fill)}"'
        if colour and width > 0:
            look += f' stroke="{self.colour(colour)}" stroke-width="{width:g}"'
        if dashes:
            look += f' stroke-dasharray="{" ".join(f"{width * n:g}" for n in dashes)}"'
        if opacity < 1:
            look += f' opacity="{opacity:g}"'
        self.elements.append(f'<path d="{points}"{look}/>')

    def write(
        self, text: str, x: float, y: float, align: str = "left", colour: str = INK, *,
        must: bool = True, bold: bool = False, upright: bool = False,
    ) -> None:  # fmt: skip
        """Write words at a height; where others stand they move, or are left out where they need not be."""
        length = LETTER * TEXT * len(text) * (1.1 if bold else 1.0)
        before = {"left": 0.0, "center": 0.5, "right": 1.0}[align] * length
        for down in (LINE * step for step in ((0, 1, -1, 2, -2) if must else (0,))):
            box = (x - before, y + down - LINE / 2, x - before + length, y + down + LINE / 2)
            if upright:
                box = (x - LINE / 2, y + before - length, x + LINE / 2, y + before)
            if not any(_meet(box, other) for other in self.words):
                break
        else:
            if not must:
                return
        self.words.append(box)
        look = f' text-anchor="{ ({"left": "start", "center": "middle", "right": "end"}[align]) }"'
        look += ' font-weight="bold"' if bold else ""
        look += f' transform="rotate(-90 {x:.1f} {y:.1f})"' if upright else ""
        height, fill = y + down + 0.35 * TEXT, self.colour(colour)
        self.elements.append(f'<text x="{x:.1f}" y="{height:.1f}" fill="{fill}"{look}>{escape(text)}</text>')


def _meet(one: tuple[float, float, float, float], other: tuple[float, float, float, float]) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]


@dataclass(frozen=True)
class _Place:
    """Where a panel is drawn: corners in points, and the numbers that stand there."""

    left: float
    top: float
    width: float
    height: float
    ends: Mapping[str, tuple[float, float]]
    below: float  # points for its words

    def x(self, numbers: Numbers | float) -> Numbers:
        """Points from the left."""
        return self.left + self.width * _share(numbers, self.ends["x"])

    def y(self, numbers: Numbers | float) -> Numbers:
        """Points from above."""
        return self.top + self.height * (1.0 - _share(numbers, self.ends["y"]))


def _share(numbers: Numbers | float, ends: tuple[float, float]) -> Numbers:
    """Share of the way from end to end; what is beyond stands at the end."""
    return np.clip((np.asarray(numbers, dtype=float) - ends[0]) / (ends[1] - ends[0]), 0.0, 1.0)


def _svg(rows: list[list[Panel]], width: float, title: str, colours: Mapping[str, str]) -> str:
    sheet, height = _Sheet(list(colours)), 0.0
    for row in rows:
        shares = [panel.share * width / sum(panel.share for panel in row) for panel in row]
        places = [
            _place(*each, height) for each in zip(row, shares, accumulate(shares, initial=0.0), strict=False)
        ]
        for panel, place in zip(row, places, strict=True):
            _draw_panel(sheet, panel, place)
        height = max(place.top + place.height + place.below for place in places)
    return (
        f'<svg role="img" aria-label="{escape(title)}" viewBox="0 0 {width:.1f} {height:.1f}" '
        f'font-size="{TEXT:g}">{"".join(sheet.elements)}</svg>'
    )


def _place(panel: Panel, width: float, left: float, top: float) -> _Place:
    """Where the marks of a panel stand in a stretch of the page, as large as there is room."""
    needed = {"left": panel.y.label, "right": True, "bottom": panel.x.label, "top": panel.title}
    if panel.bare:
        needed = {"top": panel.title}
    before, after, below, above = (
        OUTSIDE[side] if needed.get(side) else 4.0 for side in ("left", "right", "bottom", "top")
    )
    ends = {way: chart.limits(panel, way) for way in ("x", "y")}
    wide, high = width - before - after, max(POINTS * panel.height - above - below, LINE)
    if panel.equal:
        across, upwards = (abs(end - start) for start, end in ends.values())
        scale = min(wide / across, high / upwards)
        before += (wide - scale * across) / 2
        wide, high = scale * across, scale * upwards
    return _Place(left + before, top + above, wide, high, ends, below)


def _draw_panel(sheet: _Sheet, panel: Panel, place: _Place) -> None:
    if panel.title:
        sheet.write(panel.title, place.left, place.top - 11.0, bold=True)
    for mark in panel.marks:
        _draw_mark(sheet, mark, place)
    if panel.x.label and not panel.bare:
        foot = place.top + place.height
        sheet.path(f"M{place.left:.1f} {foot:.1f}h{place.width:.1f}", MUTED)
        for at, name in _ticks(panel.x, place.ends["x"], place.width / APART):
            x = float(place.x(at))
            sheet.path(f"M{x:.1f} {foot:.1f}v3", MUTED)
            sheet.write(name, x, foot + 10, "center", must=False)
        sheet.write(panel.x.label, place.left + place.width / 2, foot + 24, "center")
    if panel.y.label and not panel.bare:
        sheet.path(f"M{place.left:.1f} {place.top:.1f}v{place.height:.1f}", MUTED)
        for at, name in _ticks(panel.y, place.ends["y"], place.height / APART):
            y = float(place.y(at))
            sheet.path(f"M{place.left:.1f} {y:.1f}h-3", MUTED)
            sheet.write(name, place.left - 5, y, "right", must=False)
        sheet.write(panel.y.label, place.left - 37, place.top + place.height / 2, "center", upright=True)
    for note in (mark for mark in panel.marks if isinstance(mark, Note)):
        beside = {"left": 3.0, "center": 0.0, "right": -3.0}[note.align]
        sheet.write(
            note.text.strip(),
            float(place.x(note.x)) + beside,
            float(place.y(note.y)),
            note.align,
            note.colour,
        )


def _ticks(axis: Axis, ends: tuple[float, float], most: float) -> Iterable[tuple[float, str]]:
    """Ticks of an axis: its own, or about so many in steps of 1, 2 or 5."""
    if axis.ticks:
        return axis.ticks
    low, high = sorted(ends)
    least = (high - low) / max(most, 1.0)
    decade = 10.0 ** np.floor(np.log10(least))
    step = decade * next(factor for factor in (1, 2, 5, 10) if factor * decade >= least * (1 - 1e-9))
    first, last = np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9)
    return [(n * step, data.plain(float(n * step) + 0.0, 6)) for n in np.arange(first, last + 1)]


def _draw_mark(sheet: _Sheet, mark: Mark, place: _Place) -> None:
    match mark:
        case Line():
            x, y = place.x(mark.x), place.y(mark.y)
            if mark.width > 0:
                sheet.path(_path(x, y), mark.colour, mark.width, dashes=mark.dashes, opacity=mark.opacity)
            for at in zip(x, y, strict=True) if mark.marker else ():
                sheet.path(
                    _path(*(3 * side + to for side, to in zip(TRIANGLE, at, strict=True))) + "z",
                    "",
                    fill=mark.colour,
                )
        case Shape():
            outline = _path(place.x(mark.x), place.y(mark.y)) + "z"
            sheet.path(
                outline, mark.colour, mark.width, fill=mark.fill, dashes=mark.dashes, opacity=mark.opacity
            )
        case Boxes():
            for box in zip(mark.left, mark.right, mark.low, mark.high, strict=True):
                (left, right), (top, foot) = (
                    np.sort(place.x(np.array(box[:2]))),
                    np.sort(place.y(np.array(box[2:]))),
                )
                corners = np.array([left, right, right, left]), np.array([foot, foot, top, top])
                sheet.path(_path(*corners) + "z", mark.edge, 0.8, fill=mark.colour)
                for start in np.arange(HATCH, right - left + foot - top, HATCH):
                    over, above = max(start - (right - left), 0.0), max(start - (foot - top), 0.0)
                    ends = (
                        np.array([left + above, left + start - over]),
                        np.array([top + start - above, top + over]),
                    )
                    sheet.path(_path(*ends), mark.edge, 0.6)


def _path(x: Numbers, y: Numbers) -> str:
    """Path through points."""
    return "".join(
        f"{'L' if n else 'M'}{one:.1f} {other:.1f}" for n, (one, other) in enumerate(zip(x, y, strict=True))
    )


# --- lengths of a scene

BESIDE = 1.6
"""Half the side of what is drawn around a patch without a window, in its larger semi-axis."""
CORNERS, HEAD = 120, 0.1
"""Of an oval; and the length of the head of an arrow, as a share of it."""


def lengths(own: Callable[[DataTree], Mapping[str, float | None]]) -> Callable[[DataTree], Iterator[Series]]:
    """Columns of a scene, one row, m: the path, those that are known of a kind's `own`, and the contact."""

    def columns(tree: DataTree) -> Iterator[Series]:
        position = data.values(tree, POSITION)
        found = {
            "record begins at x": float(position[0]),
            "record ends at x": float(position[-1]),
            **own(tree),
        }
        found["semi-axis of the contact along"] = data.number(tree, contact.HERTZ_RADIUS)
        found["semi-axis of the contact across"] = data.number(tree, contact.HERTZ_RADIUS_ACROSS)
        if data.present(tree, contact.PX, contact.PY):
            x, y = data.values(tree, contact.PX), data.values(tree, contact.PY)
            sides = {
                f"window {way}": float(c[-1] - c[0]) * len(c) / (len(c) - 1)
                for way, c in (("along", x), ("across", y))
            }
            found |= sides | {"cell": float(x[1] - x[0])}
        for name, value in found.items():
            if value is not None:
                yield Series(name, "m", np.array([value]))

    return columns


class Lengths(dict[str, float]):
    """Lengths of a scene by name, m."""

    @classmethod
    def of(cls, lines: Lines) -> Lengths:
        """Those that are known."""
        return cls({series.name: float(series.values[0]) for series in lines.lines})

    def beginning(self, word: str) -> list[float]:
        """Those whose names begin with a word."""
        return [length for name, length in self.items() if name.startswith(word)]

    @property
    def rolled(self) -> tuple[float, float]:
        """Where the record begins and ends."""
        return self["record begins at x"], self["record ends at x"]

    @property
    def patch(self) -> tuple[float, float] | None:
        """Semi-axes of the contact, along and across."""
        along = self.get("semi-axis of the contact along")
        return None if along is None else (along, self.get("semi-axis of the contact across") or along)


def patch_panel(of: Lengths, height: float) -> Panel:
    """The contact from above: the window with its cells, and the nominal patch in it."""
    place: dict[str, Any] = {"title": "the contact from above", "beside": True, "height": height}
    if of.patch is None:
        return Panel(Axis(""), Axis(""), (), bare=True, **place)
    sides = [of.get(f"window {way}") or 2 * BESIDE * max(of.patch) for way in ("along", "across")]
    size, symbol = data.length_unit(max(sides))
    wide, high, along, across = (side / size for side in (*sides, *of.patch))
    marks: list[Mark] = []
    if cell := of.get("cell"):
        marks = [
            ground(-wide / 2, -high / 2, wide, high, fill=""),
            ground(-wide / 2, -high / 2, cell / size, cell / size, fill=INK, colour=""),
            Note(
                f" a cell, {data.engineering(cell, 'm', 2)}",
                cell / size - wide / 2,
                2 * cell / size - high / 2,
            ),
        ]
    marks += [*oval(0.0, 0.0, along, across), *arrow(-0.45 * along, 0.45 * along, 0.0)]
    x = Axis(f"x / {symbol} (rolling direction →)", -0.54 * wide, 0.54 * wide)
    return Panel(x, Axis(f"y / {symbol}", -0.54 * high, 0.54 * high), tuple(marks), equal=True, **place)


def patch_words(of: Lengths) -> str:
    """Say what the drawing of the contact shows; a blank comes first."""
    if of.patch is None:
        return ""
    along, across = (data.engineering(2 * side, "m") for side in of.patch)
    window = of.get("window along")
    inside = f", inside the window of {data.engineering(window, 'm')} that is solved" if window else ""
    return (
        f" From above: the patch of smooth bodies under the load, {along} along and {across} across{inside}."
    )


# --- marks of a scene


def path_line(begin: float, end: float) -> Line:
    """Draw what is rolled over."""
    return Line(np.array([begin, end]), np.zeros(2), colour=chart.VERMILLION, width=2.5)


def places(x: Sequence[float], y: float) -> Line:
    """Draw triangles where something is recorded."""
    return Line(np.array(x), np.full(len(x), y), width=0.0, marker="^")


def rolling_body(x: float, radius: float, unit: float, speed: float | None, inside: float) -> list[Mark]:
    """Draw a ball or wheel that stands at `x`, its radius, and its speed in m/s; lengths in `unit` m."""
    spoke = Line(np.array([x, x + 0.8 * radius]), np.array([radius, 1.6 * radius]), colour=MUTED, width=0.9)
    name = f"R = {data.engineering(radius * unit, 'm', 2)}"
    body = [*circle(x, radius, inside), spoke, Note(name, x, 0.8 * radius, align="center", colour=INK)]
    if speed is None:
        return body
    ahead = Note(f"{speed:.3g} m/s", x + 1.42 * radius, radius, colour=INK)
    return [*body, *arrow(x + 1.1 * radius, x + 1.4 * radius, radius), ahead]


def ground(left: float, bottom: float, length: float, height: float, **look: Any) -> Shape:
    """Draw a body as a rectangle, in the look of a `Shape`."""
    x, y = left + length * np.array([0, 1, 1, 0]), bottom + height * np.array([0, 0, 1, 1])
    look.setdefault("fill", GRID)
    return Shape(x, y, **look)


def oval(x: float, y: float, along: float, across: float, inside: float = 0.25, **look: Any) -> list[Mark]:
    """Draw an ellipse by its semi-axes, filled as densely as `inside` says, in the look of a `Shape`."""
    angle = np.linspace(0.0, 2 * np.pi, CORNERS, endpoint=False)
    outline = (x + along * np.cos(angle), y + across * np.sin(angle))
    fill = Shape(*outline, fill=BLUE, colour="", opacity=inside)
    look.setdefault("width", 1.4)
    return [*([fill] if inside else []), Shape(*outline, colour=BLUE, **look)]


def circle(x: float, radius: float, inside: float = 0.0, **look: Any) -> list[Mark]:
    """Draw what stands on the ground at a place."""
    return oval(x, radius, radius, radius, inside, **look)


def arrow(left: float, right: float, y: float, colour: str = INK) -> list[Mark]:
    """Draw an arrow to the right."""
    head = HEAD * (right - left) * np.array([1, 0, 1])
    shaft = Line(np.array([left, right]), np.array([y, y]), colour=colour, width=1.0)
    return [shaft, Line(right - head, y + head * np.array([0.5, 0, -0.5]), colour=colour, width=1.0)]
