"""What a drawing of the scene shows for every kind of case: where it rolls, and the contact from above."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Ellipse, Rectangle
from xarray import DataTree

from asperity.reporting.data import engineering, number, present, values
from asperity.reporting.part import Data, Series
from asperity.reporting.style import BLUE, GRID, INK, MUTED
from asperity.reporting.texture import length_unit
from asperity.schema import contact
from asperity.schema.rolling import POSITION

BESIDE = 1.6
"""Half the side of what is drawn around a patch without a window, in its larger semi-axis."""


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


def draw_patch(axes: Axes, data: Data) -> None:
    """Draw the contact from above: the window with its cells, and the nominal patch in it."""
    along, across = (length_of(data, f"semi-axis of the contact {way}") for way in ("along", "across"))
    axes.set_aspect("equal")
    axes.grid(visible=False)
    axes.set_title("the contact from above")
    if along is None:
        return
    across = across or along
    sides = [
        length_of(data, f"window {way}") or 2 * BESIDE * max(along, across) for way in ("along", "across")
    ]
    size, symbol = length_unit(max(sides))
    half = [side / 2 / size for side in sides]
    cell = length_of(data, "cell")
    if cell is not None:
        axes.add_patch(Rectangle((-half[0], -half[1]), 2 * half[0], 2 * half[1], fill=False, edgecolor=INK))
        axes.add_patch(Rectangle((-half[0], -half[1]), cell / size, cell / size, facecolor=INK, linewidth=0))
        axes.annotate(
            f"a cell, {engineering(cell, 'm', 2)}", (-half[0] + cell / size, -half[1] + cell / size),
            xytext=(4, 3), textcoords="offset points", fontsize=8, color=MUTED,
        )  # fmt: skip
    axes.add_patch(
        Ellipse((0, 0), 2 * along / size, 2 * across / size, facecolor=BLUE, alpha=0.25, linewidth=0)
    )
    axes.add_patch(
        Ellipse((0, 0), 2 * along / size, 2 * across / size, fill=False, edgecolor=BLUE, linewidth=1.4)
    )
    axes.annotate(
        "", (0.45 * along / size, 0), (-0.45 * along / size, 0),
        arrowprops={"arrowstyle": "->", "color": INK, "linewidth": 1.0},
    )  # fmt: skip
    axes.set_xlim(-1.08 * half[0], 1.08 * half[0])
    axes.set_ylim(-1.08 * half[1], 1.08 * half[1])
    axes.set_xlabel(f"x / {symbol} (rolling direction →)")
    axes.set_ylabel(f"y / {symbol}")


def patch_words(data: Data) -> str:
    """Say what the drawing of the contact shows; a blank comes first."""
    along, across = (length_of(data, f"semi-axis of the contact {way}") for way in ("along", "across"))
    if along is None:
        return ""
    size = f"{engineering(2 * along, 'm')} along and {engineering(2 * (across or along), 'm')} across"
    window = length_of(data, "window along")
    inside = f", inside the window of {engineering(window, 'm')} that is solved" if window else ""
    return f" From above: the patch of smooth bodies under the load, {size}{inside}."


def ground(axes: Axes, left: float, bottom: float, width: float, height: float, **look: Any) -> None:
    """Draw a body as a rectangle."""
    usual: dict[str, Any] = {"facecolor": GRID, "edgecolor": INK, "linewidth": 0.8}
    axes.add_patch(Rectangle((left, bottom), width, height, **usual | look))
