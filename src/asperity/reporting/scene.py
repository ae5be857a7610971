"""What a drawing of the scene shows for every kind of case: where it rolls, and the contact from above."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from xarray import DataTree

from asperity.reporting.chart import Axis, Dashes, Line, Mark, Note, Panel, Shape
from asperity.reporting.data import engineering, number, present, values
from asperity.reporting.part import Data, Series
from asperity.reporting.style import BLUE, GRID, INK, MUTED, VERMILLION
from asperity.reporting.texture import length_unit
from asperity.schema import contact
from asperity.schema.rolling import POSITION

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
