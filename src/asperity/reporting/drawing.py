"""Drawings of what rolls: laid out from a result, and as SVG."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from itertools import accumulate
from typing import Any

import numpy as np
from xarray import DataTree

from asperity.reporting.chart import (
    BLUE,
    GRID,
    INK,
    MUTED,
    NARROW,
    VERMILLION,
    WIDE,
    Axis,
    Boxes,
    Chart,
    Dashes,
    Line,
    Mark,
    Note,
    Numbers,
    Panel,
    Rules,
    Shape,
    limits,
    rows_of,
)
from asperity.reporting.data import engineering, number, plain, present, values
from asperity.reporting.part import Data, Series
from asperity.reporting.texture_figures import length_unit
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
_MARKERS = {
    "^": (np.array([-0.9, 0.9, 0.0]), np.array([0.8, 0.8, -0.8])),
    "v": (np.array([-0.9, 0.9, 0.0]), np.array([-0.8, -0.8, 0.8])),
    ">": (np.array([-0.8, -0.8, 0.8]), np.array([-0.9, 0.9, 0.0])),
    "s": (np.array([-0.8, 0.8, 0.8, -0.8]), np.array([-0.8, -0.8, 0.8, 0.8])),
    "o": (np.cos(np.arange(12) * np.pi / 6), np.sin(np.arange(12) * np.pi / 6)),
}
"""Outlines of markers, in 3 points."""


def svg_of(chart: Chart, title: str, colours: Mapping[str, str]) -> str:
    """Draw a chart for a wide page, and again for that of a phone; of the two the style sheet shows one.

    `colours` become the CSS variables of `style.colour_variables`.
    """
    rows = rows_of(chart)
    narrow = [[panel] for row in rows for panel in row]
    return "".join(
        f'<div class="drawing {name}">{_svg(panels, POINTS * width, title, colours)}</div>'
        for name, panels, width in (("wide", rows, WIDE), ("narrow", narrow, NARROW))
    )


@dataclass
class _Sheet:
    """Elements of a drawing, and the places of its words, which keep clear of each other."""

    colours: list[str]
    elements: list[str] = field(default_factory=list)
    words: list[tuple[float, float, float, float]] = field(default_factory=list)

    def colour(self, name: str) -> str:
        return f"var(--c{self.colours.index(name)})" if name in self.colours else name or "none"

    def path(self, points: str, fill: str, stroke: str, width: float, dashes: Dashes, opacity: float) -> None:
        """Draw an outline or a line."""
        look = f' fill="{self.colour(fill)}"'
        if stroke and width > 0:
            look += f' stroke="{self.colour(stroke)}" stroke-width="{width:g}"'
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
        moved = (LINE * step for step in (0, 1, -1, 2, -2)) if must else (0.0,)
        for down in moved:
            box = (x - before, y + down - LINE / 2, x - before + length, y + down + LINE / 2)
            if upright:
                box = (x - LINE / 2, y + before - length, x + LINE / 2, y + before)
            if not any(_meet(box, other) for other in self.words):
                break
        else:
            if not must:
                return
        self.words.append(box)
        anchor = {"left": "start", "center": "middle", "right": "end"}[align]
        look = f' text-anchor="{anchor}"' + (' font-weight="bold"' if bold else "")
        if upright:
            look += f' transform="rotate(-90 {x:.1f} {y:.1f})"'
        self.elements.append(
            f'<text x="{x:.1f}" y="{y + down + 0.35 * TEXT:.1f}" fill="{self.colour(colour)}"{look}>'
            f"{escape(text)}</text>"
        )


def _meet(one: tuple[float, float, float, float], other: tuple[float, float, float, float]) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]


@dataclass(frozen=True)
class _Place:
    """Where a panel is drawn: corners in points, and the numbers that stand there."""

    left: float
    top: float
    width: float
    height: float
    across: tuple[float, float]
    upwards: tuple[float, float]

    def x(self, numbers: Numbers | float) -> Numbers:
        """Points from the left."""
        return self.left + self.width * _share(numbers, self.across)

    def y(self, numbers: Numbers | float) -> Numbers:
        """Points from above."""
        return self.top + self.height * (1.0 - _share(numbers, self.upwards))


def _share(numbers: Numbers | float, ends: tuple[float, float]) -> Numbers:
    """Share of the way from end to end; what is beyond stands at the end."""
    return np.clip((np.asarray(numbers, dtype=float) - ends[0]) / (ends[1] - ends[0]), 0.0, 1.0)


def _svg(rows: list[list[Panel]], width: float, title: str, colours: Mapping[str, str]) -> str:
    sheet = _Sheet(list(colours))
    height = 0.0
    for row in rows:
        shares = [panel.share * width / sum(panel.share for panel in row) for panel in row]
        lefts = accumulate(shares, initial=0.0)
        places = [_place(*each, height) for each in zip(row, shares, lefts, strict=False)]
        for panel, place in zip(row, places, strict=True):
            _draw_panel(sheet, panel, place)
        height = max(
            place.top + place.height + _outside(panel, "bottom")
            for panel, place in zip(row, places, strict=True)
        )
    return (
        f'<svg role="img" aria-label="{escape(title)}" viewBox="0 0 {width:.1f} {height:.1f}" '
        f'font-size="{TEXT:g}">{"".join(sheet.elements)}</svg>'
    )


def _outside(panel: Panel, side: str) -> float:
    """Points that a panel needs for its words on a side."""
    named = {"left": panel.y.label, "bottom": panel.x.label}
    if side == "top":
        return OUTSIDE["top"] if panel.title else 4.0
    return OUTSIDE[side] if not panel.bare and named.get(side, panel.x.label) else 4.0


def _place(panel: Panel, width: float, left: float, top: float) -> _Place:
    """Where the marks of a panel stand in a stretch of the page, as large as there is room."""
    across, upwards = limits(panel, "x"), limits(panel, "y")
    before, above = _outside(panel, "left"), _outside(panel, "top")
    wide = width - before - _outside(panel, "right")
    high = max(POINTS * panel.height - above - _outside(panel, "bottom"), LINE)
    if panel.equal:
        scale = min(wide / abs(across[1] - across[0]), high / abs(upwards[1] - upwards[0]))
        room = wide - scale * abs(across[1] - across[0])
        wide, high, before = wide - room, scale * abs(upwards[1] - upwards[0]), before + room / 2
    return _Place(left + before, top + above, wide, high, across, upwards)


def _draw_panel(sheet: _Sheet, panel: Panel, place: _Place) -> None:
    if panel.title:
        sheet.write(panel.title, place.left, place.top - 11.0, bold=True)
    for mark in panel.marks:
        _draw_mark(sheet, mark, place)
    if not panel.bare:
        if panel.x.label:
            _draw_along(sheet, panel.x, place)
        if panel.y.label:
            _draw_upwards(sheet, panel.y, place)
    for mark in panel.marks:
        if isinstance(mark, Note):
            _write_note(sheet, mark, place)


def _draw_along(sheet: _Sheet, axis: Axis, place: _Place) -> None:
    foot = place.top + place.height
    sheet.path(f"M{place.left:.1f} {foot:.1f}h{place.width:.1f}", "", MUTED, 0.7, (), 1.0)
    for at, name in _ticks(axis, place.across, place.width / APART):
        x = float(place.x(at))
        sheet.path(f"M{x:.1f} {foot:.1f}v3", "", MUTED, 0.7, (), 1.0)
        sheet.write(name, x, foot + 10, "center", must=False)
    sheet.write(axis.label, place.left + place.width / 2, foot + 24, "center")


def _draw_upwards(sheet: _Sheet, axis: Axis, place: _Place) -> None:
    sheet.path(f"M{place.left:.1f} {place.top:.1f}v{place.height:.1f}", "", MUTED, 0.7, (), 1.0)
    for at, name in _ticks(axis, place.upwards, place.height / APART):
        y = float(place.y(at))
        sheet.path(f"M{place.left:.1f} {y:.1f}h-3", "", MUTED, 0.7, (), 1.0)
        sheet.write(name, place.left - 5, y, "right", must=False)
    sheet.write(axis.label, place.left - 37, place.top + place.height / 2, "center", upright=True)


def _ticks(axis: Axis, ends: tuple[float, float], most: float) -> Iterable[tuple[float, str]]:
    """Ticks of an axis: its own, or about so many in steps of 1, 2 or 5."""
    if axis.ticks:
        return axis.ticks
    low, high = sorted(ends)
    least = (high - low) / max(most, 1.0)
    decade = 10.0 ** np.floor(np.log10(least))
    step = decade * next(factor for factor in (1, 2, 5, 10) if factor * decade >= least * (1 - 1e-9))
    first, last = np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9)
    return [(n * step, plain(float(n * step) + 0.0, 6)) for n in np.arange(first, last + 1)]


def _draw_mark(sheet: _Sheet, mark: Mark, place: _Place) -> None:
    match mark:
        case Line():
            if mark.width > 0:
                points = _path(place.x(mark.x), place.y(mark.y))
                sheet.path(points, "", mark.colour, mark.width, mark.dashes, mark.opacity)
            for x, y in zip(place.x(mark.x), place.y(mark.y), strict=True):
                if mark.marker in _MARKERS:
                    outline = _MARKERS[mark.marker]
                    points = _path(x + 3 * outline[0], y + 3 * outline[1]) + "z"
                    sheet.path(points, mark.colour, "", 0.0, (), mark.opacity)
        case Shape():
            points = _path(place.x(mark.x), place.y(mark.y)) + "z"
            sheet.path(points, mark.fill, mark.colour, mark.width, mark.dashes, mark.opacity)
        case Boxes():
            _draw_boxes(sheet, mark, place)
        case Rules():
            for at in mark.at.tolist():
                if mark.along == "x":
                    foot, high = place.top + place.height, place.height * (0.04 if mark.short else 1.0)
                    points = f"M{place.x(at):.1f} {foot:.1f}v-{high:.1f}"
                else:
                    wide = place.width * (0.04 if mark.short else 1.0)
                    points = f"M{place.left:.1f} {place.y(at):.1f}h{wide:.1f}"
                sheet.path(points, "", mark.colour, mark.width, mark.dashes, 1.0)


def _draw_boxes(sheet: _Sheet, mark: Boxes, place: _Place) -> None:
    for box in zip(mark.left, mark.right, mark.low, mark.high, strict=True):
        (left, right), (foot, top) = (
            np.sort(place.x(np.array(box[:2]))),
            -np.sort(-place.y(np.array(box[2:]))),
        )
        outline = _path(np.array([left, right, right, left]), np.array([foot, foot, top, top])) + "z"
        sheet.path(outline, mark.colour, mark.edge, 0.8, (), mark.opacity)
        for start in np.arange(HATCH, right - left + foot - top, HATCH) if mark.hatch else ():
            over, above = max(start - (right - left), 0.0), max(start - (foot - top), 0.0)
            x, y = np.array([left + above, left + start - over]), np.array([top + start - above, top + over])
            sheet.path(_path(x, y), "", mark.edge or MUTED, 0.6, (), 1.0)


def _path(x: Numbers, y: Numbers) -> str:
    """Path through points; it is broken where a number is missing."""
    known = np.isfinite(x) & np.isfinite(y)
    starts = known & ~np.concatenate([[False], known[:-1]])
    kept = zip(x[known].tolist(), y[known].tolist(), starts[known].tolist(), strict=True)
    return "".join(f"{'M' if start else 'L'}{one:.1f} {other:.1f}" for one, other, start in kept)


def _write_note(sheet: _Sheet, note: Note, place: _Place) -> None:
    x = place.left + note.x * place.width if note.x_share else float(place.x(note.x))
    y = place.top + (1 - note.y) * place.height if note.y_share else float(place.y(note.y))
    if note.y_share:
        y += LINE / 2 if note.y > 0.5 else -LINE / 2
    beside = {"left": 3.0, "center": 0.0, "right": -3.0}[note.align]
    sheet.write(note.text.strip(), x + beside, y, note.align, note.colour, upright=note.upright)


BESIDE = 1.6
"""Half the side of what is drawn around a patch without a window, in its larger semi-axis."""
CORNERS, HEAD = 120, 0.1
"""Of an oval; and the length of the head of an arrow, as a share of it."""


def lengths(tree: DataTree, own: Mapping[str, float | None]) -> Data:
    """Lengths of a scene, a row: the path, those that are known of a kind's `own`, and the contact, m."""
    position = values(tree, POSITION)
    found = {"record begins at x": float(position[0]), "record ends at x": float(position[-1]), **own}
    found["semi-axis of the contact along"] = number(tree, contact.HERTZ_RADIUS)
    found["semi-axis of the contact across"] = number(tree, contact.HERTZ_RADIUS_ACROSS)
    if present(tree, contact.PX, contact.PY):
        x, y = values(tree, contact.PX), values(tree, contact.PY)
        found |= {"window along": _side(x), "window across": _side(y), "cell": float(x[1] - x[0])}
    known = {name: value for name, value in found.items() if value is not None}
    lines: dict[Any, Series] = {name: Series(name, "m", np.array([value])) for name, value in known.items()}
    return Data(None, lines)


def _side(cells: np.ndarray) -> float:
    return float(cells[-1] - cells[0]) * len(cells) / (len(cells) - 1)


def length_of(data: Data, name: str) -> float | None:
    """A length of a scene, m, if it is known."""
    return float(data.lines[name].values[0]) if name in data.lines else None


def lengths_named(data: Data, word: str) -> list[float]:
    """Lengths of a scene whose names begin with a word, m."""
    return [float(line.values[0]) for name, line in data.lines.items() if str(name).startswith(word)]


def rolled(data: Data) -> tuple[float, float]:
    """Where the record begins and ends, m."""
    begin, end = (length_of(data, f"record {word} at x") or 0.0 for word in ("begins", "ends"))
    return begin, end


def path_line(begin: float, end: float) -> Line:
    """Draw what is rolled over."""
    return Line(np.array([begin, end]), np.zeros(2), colour=VERMILLION, width=2.5)


def places(x: Sequence[float], y: float) -> Line:
    """Draw triangles where something is recorded."""
    return Line(np.array(x), np.full(len(x), y), width=0.0, marker="^")


def rolling_body(x: float, radius: float, unit: float, speed: float | None, inside: float) -> list[Mark]:
    """Draw a ball or wheel that stands at `x`, its radius, and its speed in m/s; lengths in `unit` m."""
    spoke = Line(np.array([x, x + 0.8 * radius]), np.array([radius, 1.6 * radius]), colour=MUTED, width=0.9)
    name = Note(f"R = {engineering(radius * unit, 'm', 2)}", x, 0.8 * radius, align="center", colour=INK)
    body = [*oval(x, radius, radius, radius, inside=inside), spoke, name]
    if speed is None:
        return body
    ahead = Note(f"{speed:.3g} m/s", x + 1.42 * radius, radius, colour=INK)
    return [*body, *arrow(x + 1.1 * radius, x + 1.4 * radius, radius), ahead]


def patch_panel(data: Data, **place: Any) -> Panel:
    """The contact from above: the window with its cells, and the nominal patch in it."""
    along, across = (length_of(data, f"semi-axis of the contact {way}") for way in ("along", "across"))
    if along is None:
        return Panel(Axis(""), Axis(""), (), title="the contact from above", bare=True, **place)
    across = across or along
    sides = [
        length_of(data, f"window {way}") or 2 * BESIDE * max(along, across) for way in ("along", "across")
    ]
    size, symbol = length_unit(max(sides))
    wide, high = (side / size for side in sides)
    marks: list[Mark] = []
    if cell := length_of(data, "cell"):
        side = cell / size
        marks = [
            ground(-wide / 2, -high / 2, wide, high, fill=""),
            ground(-wide / 2, -high / 2, side, side, fill=INK, colour=""),
            Note(f" a cell, {engineering(cell, 'm', 2)}", side - wide / 2, 2 * side - high / 2),
        ]
    marks += oval(0.0, 0.0, along / size, across / size)
    marks += arrow(-0.45 * along / size, 0.45 * along / size, 0.0)
    x = Axis(f"x / {symbol} (rolling direction →)", -0.54 * wide, 0.54 * wide)
    y = Axis(f"y / {symbol}", -0.54 * high, 0.54 * high)
    return Panel(x, y, tuple(marks), title="the contact from above", equal=True, **place)


def patch_words(data: Data) -> str:
    """Say what the drawing of the contact shows; a blank comes first."""
    along, across = (length_of(data, f"semi-axis of the contact {way}") for way in ("along", "across"))
    if along is None:
        return ""
    size = f"{engineering(2 * along, 'm')} along and {engineering(2 * (across or along), 'm')} across"
    window = length_of(data, "window along")
    inside = f", inside the window of {engineering(window, 'm')} that is solved" if window else ""
    return f" From above: the patch of smooth bodies under the load, {size}{inside}."


def ground(left: float, bottom: float, length: float, height: float, **look: Any) -> Shape:
    """Draw a body as a rectangle, in the look of a `Shape`."""
    x, y = left + length * np.array([0, 1, 1, 0]), bottom + height * np.array([0, 0, 1, 1])
    return Shape(x, y, **{"fill": GRID} | look)


def oval(
    x: float,
    y: float,
    along: float,
    across: float,
    *,
    dashes: Dashes = (),
    inside: float = 0.25,
    width: float = 1.4,
) -> list[Mark]:
    """Draw an ellipse by its semi-axes, or a circle, filled as densely as `inside` says."""
    angle = np.linspace(0.0, 2 * np.pi, CORNERS, endpoint=False)
    outline = (x + along * np.cos(angle), y + across * np.sin(angle))
    fill = Shape(*outline, fill=BLUE, colour="", opacity=inside)
    return [*([fill] if inside else []), Shape(*outline, colour=BLUE, width=width, dashes=dashes)]


def arrow(left: float, right: float, y: float, colour: str = INK) -> list[Mark]:
    """Draw an arrow to the right."""
    head = HEAD * (right - left)
    shaft = Line(np.array([left, right]), np.array([y, y]), colour=colour, width=1.0)
    tip = Line(
        right - np.array([head, 0, head]), y + np.array([head, 0, -head]) / 2, colour=colour, width=1.0
    )
    return [shaft, tip]
