"""The scene: what rolls, what it is rolled over and where it is looked at; and the contact from above."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from xarray import DataTree

from asperity.reporting import data
from asperity.reporting.chart import (
    BLUE,
    GRID,
    INK,
    MUTED,
    VERMILLION,
    Axis,
    Drawn,
    Line,
    Mark,
    Note,
    Panel,
    Shape,
)
from asperity.reporting.figure import Lines, Series, figure
from asperity.scenes.figures.track import sleepers_between
from asperity.scenes.schema import ROLLING_POINT, ROLLING_SENSOR
from asperity.schema import contact, rolling
from asperity.written_numbers import rounded

Lengths = dict[str, float]
"""Of a scene, by name, m."""
RADII = ("ball.radius", "wheel.radius", "body.radius")
BEAM_SIZE = ("beam.length", "beam.height")
"""Keys of a case, whose lengths are drawn."""
BESIDE = 1.6
"""Half the side of what is drawn around a patch without a window, in its larger semi-axis."""
CORNERS, HEAD = 120, 0.1
"""Of an oval; and the length of the head of an arrow, as a share of it."""
SEEN = 0.012
"""Least radius in which a body is drawn, as a share of what is drawn."""
BEAM, RAIL, PAD, SLEEPER, BALLAST = 0.01, 0.17, 0.02, 0.2, 0.12
"""Heights in which a path, rail, pads, sleepers and ballast are drawn, m: a case does not hold them."""
SLEEPER_WIDTH, BAYS = 0.26, 2.4
"""Width in which sleepers are drawn, m, and bays to either side of the contacts."""
SUPPORTS = {"simply-supported": "^", "clamped": "s"}


def _columns(tree: DataTree) -> Iterator[Series]:
    """Lengths of the case, positions along x, and of the contact its semi-axes, window and cell."""
    position = data.values(tree, rolling.POSITION)
    found: dict[str, float | None] = {
        "record begins at x": float(position[0]),
        "record ends at x": float(position[-1]),
    }
    over_beam = BEAM_SIZE if data.case_words(tree, "over") in ("", "beam") else ()
    over = ("track.sleeper_spacing",) if "track" in tree.children else over_beam
    found |= {
        key.replace(".", " ").replace("_", " "): data.case_quantity(tree, key, "m") for key in (*RADII, *over)
    }
    places = {
        rolling.OFFSET: "contact {} ahead by",
        ROLLING_SENSOR: "sensor {} at x",
        ROLLING_POINT: "point {} at x",
    }
    for entry, name in places.items():
        at = data.values(tree, entry).tolist() if data.present(tree, entry) else []
        found |= {name.format(number): each for number, each in enumerate(at, 1)}
    found["semi-axis of the contact along"] = data.number(tree, contact.HERTZ_RADIUS)
    found["semi-axis of the contact across"] = data.number(tree, contact.HERTZ_RADIUS_ACROSS)
    if data.present(tree, contact.PX, contact.PY):
        x = data.values(tree, contact.PX)
        y = data.values(tree, contact.PY)
        found |= {
            f"window {way}": float(at[-1] - at[0]) * len(at) / (len(at) - 1)
            for way, at in (("along", x), ("across", y))
        }
        found["cell"] = float(x[1] - x[0])
    for name, value in found.items():
        if value is not None:
            yield Series(name, "m", np.array([value]))


def _lengths(lines: Lines) -> Lengths:
    return {series.name: float(series.values[0]) for series in lines.lines}


def _beginning(of: Lengths, word: str) -> list[float]:
    """Lengths whose names begin with a word."""
    return [length for name, length in of.items() if name.startswith(word) and np.isfinite(length)]


def _radius(of: Lengths) -> float:
    return next((of[name.replace(".", " ")] for name in RADII if name.replace(".", " ") in of), 0.0)


# --- from the side


def _side(tree: DataTree, of: Lengths) -> Panel:
    """All contacts where the record begins, on what is rolled over."""
    begin = of["record begins at x"]
    end = of["record ends at x"]
    contacts = [begin + offset for offset in _beginning(of, "contact") or [0.0]]
    looked_at = _beginning(of, "sensor") + _beginning(of, "point")
    spacing = of.get("track sleeper spacing")
    if spacing:
        left = min(contacts) - BAYS * spacing
        right = max(contacts) + BAYS * spacing
        under = _track(tree, left, right, spacing)
        depth = RAIL + PAD + SLEEPER + BALLAST
    else:
        right = of.get("beam length") or max(end + max(contacts) - begin, *contacts, *looked_at, 1e-3)
        left = 0.0
        depth = of.get("beam height") or BEAM
        under = [_block(left, -depth, right, depth)]
        marker = SUPPORTS.get(data.case_words(tree, "beam.support"))
        if marker and "beam length" in of:
            ends = np.array([left, right]), np.full(2, -depth)
            under.append(Line(*ends, colour=MUTED, width=0.0, marker=marker))
    span = right - left
    path = np.clip([begin, end], left, right)
    radius = max(_radius(of), SEEN * span)
    marks = [*under, Line(path, np.zeros(2), colour=VERMILLION, width=2.5)]
    for x in contacts:
        marks += _oval(x, radius, radius, radius, 0.15)
    marks += _arrow(max(contacts) + 1.2 * radius, max(contacts) + 1.2 * radius + 0.06 * span, radius)
    shown = np.array([x for x in looked_at if left <= x <= right])
    marks.append(Line(shown, np.full(len(shown), -0.5 * (RAIL if spacing else depth)), width=0.0, marker="D"))
    along = Axis("x / m", left - 0.04 * span, right + 0.04 * span)
    up = Axis("", -depth - 0.03 * span, max(2.2 * radius, 0.05 * span))
    return _view(along, up, marks, "where the record begins", share=2.2)


def _track(tree: DataTree, left: float, right: float, spacing: float) -> list[Mark]:
    """Rail, and below it pads, sleepers and ballast; without sleepers that move a slab."""
    look: dict[str, Any] = {"colour": MUTED, "dashes": (3, 2)}
    width = right - left
    bottom = -RAIL - PAD - SLEEPER
    sleepers = sleepers_between(tree, left, right, spacing)
    marks: list[Mark] = [_block(left, -RAIL, width, RAIL, **look)]
    spread = data.case_words(tree, "track.continuous") == "yes"
    pads = [(left, width)] if spread else [(x - 0.08, 0.16) for x in sleepers]
    marks += [_block(x, -RAIL - PAD, length, PAD, fill=MUTED, colour="") for x, length in pads]
    if spread or data.case_words(tree, "track.ballast_stiffness").startswith("inf"):
        return [*marks, _block(left, bottom - BALLAST, width, SLEEPER + BALLAST, fill="", **look)]
    marks += [_block(x - SLEEPER_WIDTH / 2, bottom, SLEEPER_WIDTH, SLEEPER, **look) for x in sleepers]
    return [*marks, _block(left, bottom - BALLAST, width, BALLAST, fill="", **look)]


# --- the contact from above


def _semi_axes(of: Lengths) -> tuple[float, float] | None:
    along = of.get("semi-axis of the contact along")
    return None if along is None else (along, of.get("semi-axis of the contact across") or along)


def _patch(of: Lengths) -> list[Panel]:
    """The window with its cells, and the nominal patch in it."""
    if (semi_axes := _semi_axes(of)) is None:
        return []
    sides = [of.get(f"window {way}") or 2 * BESIDE * max(semi_axes) for way in ("along", "across")]
    size, symbol = data.length_unit(max(sides))
    wide, high, along, across = (side / size for side in (*sides, *semi_axes))
    marks: list[Mark] = []
    if cell := of.get("cell"):
        name = data.engineering(cell, "m", 2)
        left = -wide / 2
        bottom = -high / 2
        side = cell / size
        marks.append(_block(left, bottom, wide, high, fill=""))
        marks.append(_block(left, bottom, side, side, fill=INK, colour=""))
        marks.append(Note(f" a cell, {name}", left + side, bottom + 2 * side))
    marks += [*_oval(0.0, 0.0, along, across, 0.25), *_arrow(-0.45 * along, 0.45 * along, 0.0)]
    x = Axis(f"x / {symbol} (rolling direction →)", -0.54 * wide, 0.54 * wide)
    y = Axis(f"y / {symbol}", -0.54 * high, 0.54 * high)
    return [_view(x, y, marks, "the contact from above", beside=True)]


@figure("The scene", None, _columns)
def scene(tree: DataTree, lines: Lines) -> Drawn:
    """What rolls over what, from the side, and the contact from above."""
    of = _lengths(lines)
    speed = data.number(tree, rolling.SPEED)
    yield _side(tree, of)
    yield from _patch(of)
    count = len(_beginning(of, "contact")) or 1
    radius = _radius(of)
    contacts = "One contact" if count == 1 else f"{count} contacts"
    told = f"{contacts}, rolled from {of['record begins at x']:.4g} m to {of['record ends at x']:.4g} m (red)"
    told += f" at {rounded(speed)} m/s" if speed else ""
    told += (
        f"; radius {data.engineering(radius, 'm', 2)}, drawn larger where it is not seen" if radius else ""
    )
    if _beginning(of, "sensor") or _beginning(of, "point"):
        told += "; diamonds: where motion is recorded"
    if "beam length" in of:
        told += f"; the beam is {data.case_words(tree, 'beam.support')}"
    if "track sleeper spacing" in of:
        told += "; dashed: what has no shape in the case"
    yield f"{told}."
    if (semi_axes := _semi_axes(of)) is None:
        return
    along, across = (data.engineering(2 * side, "m") for side in semi_axes)
    window = of.get("window along")
    inside = f", inside the window of {data.engineering(window, 'm')} that is solved" if window else ""
    patch = f"the patch of smooth bodies under the load, {along} along and {across} across{inside}"
    yield f"From above: {patch}."


# --- what scenes are drawn of


def _view(x: Axis, y: Axis, marks: list[Mark], title: str, **place: Any) -> Panel:
    return Panel(x, y, tuple(marks), title, height=3.4, equal=True, plain=True, **place)


def _block(left: float, bottom: float, length: float, height: float, fill: str = GRID, **look: Any) -> Shape:
    """A body as a rectangle, in the look of a `Shape`."""
    x = left + length * np.array([0, 1, 1, 0])
    y = bottom + height * np.array([0, 0, 1, 1])
    return Shape(x, y, fill, **look)


def _oval(x: float, y: float, along: float, across: float, inside: float) -> list[Mark]:
    """An ellipse by its semi-axes, filled as densely as `inside` says."""
    angle = np.linspace(0.0, 2 * np.pi, CORNERS, endpoint=False)
    outline = (x + along * np.cos(angle), y + across * np.sin(angle))
    return [Shape(*outline, BLUE, "", opacity=inside), Shape(*outline, colour=BLUE, width=1.4)]


def _arrow(left: float, right: float, y: float) -> list[Mark]:
    """An arrow to the right."""
    head = HEAD * (right - left) * np.array([1, 0, 1])
    shaft = Line(np.array([left, right]), np.array([y, y]), colour=INK, width=1.0)
    return [shaft, Line(right - head, y + head * np.array([0.5, 0, -0.5]), colour=INK, width=1.0)]
