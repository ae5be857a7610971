"""The scene: a ball on its beam, bodies on their path, a wheel on its track; and the contact from above."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from xarray import DataTree

from asperity.reporting import chart, data
from asperity.reporting.chart import (
    BLUE,
    GRID,
    INK,
    MUTED,
    VERMILLION,
    Axis,
    Line,
    Mark,
    Note,
    Numbers,
    Panel,
    Shape,
)
from asperity.reporting.figure import Figure, Lines, Series
from asperity.scenes.figures.track import sleepers_between
from asperity.scenes.schema import ROLLING_POINT, ROLLING_SENSOR
from asperity.schema import Entry, contact, provenance, rolling

Lengths = dict[str, float]
"""Of a scene, by name, m."""
OWN = ("ball-on-beam", "wheel-on-rail")
"""Kinds of case with a scene of their own; of all others contacts are drawn."""
BESIDE = 1.6
"""Half the side of what is drawn around a patch without a window, in its larger semi-axis."""
CORNERS, HEAD = 120, 0.1
"""Of an oval; and the length of the head of an arrow, as a share of it."""


def _scene(
    kind: str,
    title: str,
    own: Callable[[DataTree], dict[str, float | None]],
    draw: Callable[[DataTree, Lengths], list[Panel]],
    caption: Callable[[DataTree, Lengths], str],
    *needs: Entry,
    height: float = 3.4,
) -> Figure:
    """Declare the scene of a kind by its own lengths, what is drawn and what is said, without the contact."""

    def columns(tree: DataTree) -> Iterator[Series]:
        position = data.values(tree, rolling.POSITION)
        path = {"record begins at x": float(position[0]), "record ends at x": float(position[-1])}
        for name, value in (path | own(tree) | _of_contact(tree)).items():
            if value is not None:
                yield Series(name, "m", np.array([value]))

    def lengths(lines: Lines) -> Lengths:
        return {series.name: float(series.values[0]) for series in lines.lines}

    def drawn(tree: DataTree, lines: Lines) -> list[Panel]:
        return [*draw(tree, lengths(lines)), *_patch(lengths(lines), height)]

    def said(tree: DataTree) -> str:
        found = lengths(scene.collect(tree))
        return caption(tree, found) + _patch_words(found)

    def of_kind(tree: DataTree) -> bool:
        found = data.stated(tree, provenance.KIND)
        return (found if found in OWN else "") == kind

    scene = Figure("scene", title, None, (columns,), drawn, said, (rolling.POSITION, *needs), worth=of_kind)
    return scene


def _of_contact(tree: DataTree) -> dict[str, float | None]:
    found = {
        "semi-axis of the contact along": data.number(tree, contact.HERTZ_RADIUS),
        "semi-axis of the contact across": data.number(tree, contact.HERTZ_RADIUS_ACROSS),
    }
    if data.present(tree, contact.PX, contact.PY):
        x, y = data.values(tree, contact.PX), data.values(tree, contact.PY)
        for way, at in (("along", x), ("across", y)):
            found[f"window {way}"] = float(at[-1] - at[0]) * len(at) / (len(at) - 1)
        found["cell"] = float(x[1] - x[0])
    return found


def _numbered(tree: DataTree, entry: Entry, name: str) -> dict[str, float | None]:
    """Positions along x, as ``sensor 1 at x``."""
    found = data.values(tree, entry).tolist() if data.present(tree, entry) else []
    return {name.format(number): position for number, position in enumerate(found, 1)}


def _beginning(of: Lengths, word: str) -> list[float]:
    """Lengths whose names begin with a word."""
    return [length for name, length in of.items() if name.startswith(word)]


def _rolled(of: Lengths) -> tuple[float, float]:
    return of["record begins at x"], of["record ends at x"]


# --- the contact from above


def _semi_axes(of: Lengths) -> tuple[float, float] | None:
    along = of.get("semi-axis of the contact along")
    return None if along is None else (along, of.get("semi-axis of the contact across") or along)


def _patch(of: Lengths, height: float) -> list[Panel]:
    """The window with its cells, and the nominal patch in it."""
    if (semi_axes := _semi_axes(of)) is None:
        return []
    sides = [of.get(f"window {way}") or 2 * BESIDE * max(semi_axes) for way in ("along", "across")]
    size, symbol = data.length_unit(max(sides))
    wide, high, along, across = (side / size for side in (*sides, *semi_axes))
    marks: list[Mark] = []
    if cell := of.get("cell"):
        name, (left, bottom), side = data.engineering(cell, "m", 2), (-wide / 2, -high / 2), cell / size
        marks.append(_block(left, bottom, wide, high, fill=""))
        marks.append(_block(left, bottom, side, side, fill=INK, colour=""))
        marks.append(Note(f" a cell, {name}", left + side, bottom + 2 * side))
    marks += [*_oval(0.0, 0.0, along, across, 0.25), *_arrow(-0.45 * along, 0.45 * along, 0.0)]
    x = Axis(f"x / {symbol} (rolling direction →)", -0.54 * wide, 0.54 * wide)
    y = Axis(f"y / {symbol}", -0.54 * high, 0.54 * high)
    return [_view(x, y, marks, "the contact from above", height, beside=True)]


def _patch_words(of: Lengths) -> str:
    """Say what the drawing of the contact shows; a blank comes first."""
    if (semi_axes := _semi_axes(of)) is None:
        return ""
    along, across = (data.engineering(2 * side, "m") for side in semi_axes)
    window = of.get("window along")
    inside = f", inside the window of {data.engineering(window, 'm')} that is solved" if window else ""
    return (
        f" From above: the patch of smooth bodies under the load, {along} along and {across} across{inside}."
    )


# --- what scenes are drawn of


def _view(x: Axis, y: Axis, marks: list[Mark], title: str, height: float, **place: Any) -> Panel:
    return Panel(x, y, tuple(marks), title, height, equal=True, plain=True, **place)


def _path(begin: float, end: float) -> Line:
    """What is rolled over."""
    return Line(np.array([begin, end]), np.zeros(2), colour=VERMILLION, width=2.5)


def _places(x: list[float], y: float) -> Line:
    """Triangles where something is recorded."""
    return Line(np.array(x), np.full(len(x), y), width=0.0, marker="^")


def _rolling_body(x: float, radius: float, unit: float, speed: float | None, inside: float) -> list[Mark]:
    """A ball or wheel that stands at `x`, its radius, and its speed in m/s; lengths in `unit` m."""
    spoke = Line(np.array([x, x + 0.8 * radius]), np.array([radius, 1.6 * radius]), colour=MUTED, width=0.9)
    name = f"R = {data.engineering(radius * unit, 'm', 2)}"
    body = [*_circle(x, radius, inside), spoke, Note(name, x, 0.8 * radius, align="center", colour=INK)]
    if speed is None:
        return body
    ahead = Note(f"{speed:.3g} m/s", x + 1.42 * radius, radius, colour=INK)
    return [*body, *_arrow(x + 1.1 * radius, x + 1.4 * radius, radius), ahead]


def _block(left: float, bottom: float, length: float, height: float, fill: str = GRID, **look: Any) -> Shape:
    """A body as a rectangle, in the look of a `Shape`."""
    x, y = left + length * np.array([0, 1, 1, 0]), bottom + height * np.array([0, 0, 1, 1])
    return Shape(x, y, fill, **look)


def _oval(
    x: float, y: float, along: float, across: float, inside: float, width: float = 1.4, **look: Any
) -> list[Mark]:
    """An ellipse by its semi-axes, filled as densely as `inside` says, in the look of a `Shape`."""
    angle = np.linspace(0.0, 2 * np.pi, CORNERS, endpoint=False)
    outline = (x + along * np.cos(angle), y + across * np.sin(angle))
    fill = Shape(*outline, fill=BLUE, colour="", opacity=inside)
    return [*([fill] if inside else []), Shape(*outline, colour=BLUE, width=width, **look)]


def _circle(x: float, radius: float, inside: float = 0.0, **look: Any) -> list[Mark]:
    """What stands on the ground at a place."""
    return _oval(x, radius, radius, radius, inside, **look)


def _arrow(left: float, right: float, y: float, colour: str = INK) -> list[Mark]:
    """An arrow to the right."""
    head = HEAD * (right - left) * np.array([1, 0, 1])
    shaft = Line(np.array([left, right]), np.array([y, y]), colour=colour, width=1.0)
    return [shaft, Line(right - head, y + head * np.array([0.5, 0, -0.5]), colour=colour, width=1.0)]


# --- a ball on a beam


def _of_beam(tree: DataTree) -> dict[str, float | None]:
    names = ("ball radius", "beam length", "beam height")
    own = {name: data.case_quantity(tree, name.replace(" ", "."), "m") for name in names}
    return own | _numbered(tree, ROLLING_SENSOR, "sensor {} at x")


def _beam(tree: DataTree, of: Lengths) -> list[Panel]:
    """The beam from the side over the whole width, below it the ball close by, if its size is known."""
    begin, end = _rolled(of)
    length, height = of.get("beam length") or end, of.get("beam height") or 0.01
    radius = of.get("ball radius") or 0.0
    marks: list[Mark] = [
        _block(0.0, -height, length, height),
        *_supports(data.case_words(tree, "beam.support"), length, height),
        _path(begin, end),
        *_circle(begin, radius, dashes=(2, 1.5)),
        *_circle(end, radius),
        _places(_beginning(of, "sensor"), -height - 0.006 * length),
    ]
    if end - begin > 2 * radius:
        marks += _arrow(begin + radius, end - radius, radius)
    x = Axis("x / m", -0.04 * length, 1.04 * length)
    y = Axis("", -height - 0.035 * length, max(2.2 * radius, 0.02 * length))
    side = _view(x, y, marks, "the beam from the side", 1.5)
    radius, height = radius * 1e3, (of.get("beam height") or 0.0) * 1e3  # mm
    if not radius or not height:
        return [side]
    reach = 2.2 * radius
    ball = _rolling_body(0.0, radius, 1e-3, data.number(tree, rolling.SPEED), inside=0.15)
    x, y = Axis("x / mm", -reach, reach), Axis("z / mm", -1.3 * height, 2.1 * radius)
    close = [_block(-reach, -height, 2 * reach, height), *ball]
    return [side, _view(x, y, close, "the ball on the beam", 3.4)]


def _supports(support: str, length: float, height: float) -> list[Mark]:
    size = 0.018 * length
    marks: list[Mark] = []
    for x, outward in ((0.0, -1.0), (length, 1.0)):
        if support == "simply-supported":
            foot = np.array([x, x - size, x + size]), -height - 1.5 * size * np.array([0, 1, 1])
            marks.append(Shape(*foot, width=0.9))
        elif support == "clamped":
            edges = np.array([*sorted((x, x + outward * size)), -height - size, size])
            left, right, low, high = edges[:, None]
            marks.append(chart.Boxes(left, right, low, high, colour=GRID, hatch="/", edge=INK))
    return marks


def _beam_words(tree: DataTree, of: Lengths) -> str:
    (begin, end), support = _rolled(of), data.case_words(tree, "beam.support")
    return (
        f"To scale. The beam{f', {support}' if support else ''}; the record is rolled from {begin:.3g} m "
        f"(dashed) to {end:.3g} m; triangles below: accelerometers."
    )


# --- bodies on any number of contacts


def _of_bodies(tree: DataTree) -> dict[str, float | None]:
    own = {"radius": data.case_quantity(tree, "body.radius", "m")}
    if data.case_words(tree, "over") == "beam":
        own["length"] = data.case_quantity(tree, "beam.length", "m")
    own |= _numbered(tree, rolling.OFFSET, "contact {} ahead by")
    return own | _numbered(tree, ROLLING_SENSOR, "sensor {} at x")


def _bodies(_: DataTree, of: Lengths) -> list[Panel]:
    """The path with all contacts at the start of the record."""
    (begin, end), radius = _rolled(of), of.get("radius") or 0.0
    sensors, offsets = _beginning(of, "sensor"), _beginning(of, "contact")
    contacts = [begin + offset for offset in offsets]
    span = of.get("length") or max(end + max(offsets, default=0.0), *contacts, *sensors, 1e-3)
    drawn = max(radius, 0.012 * span)  # seen at all on a long path
    marks: list[Mark] = [_block(-0.02 * span, -0.03 * span, 1.04 * span, 0.03 * span), _path(begin, end)]
    for x in contacts:
        marks += _circle(x, drawn, width=1.2)
    marks.append(_places(sensors, -0.045 * span))
    if contacts:
        marks += _arrow(contacts[-1] + 1.6 * drawn, contacts[-1] + 5 * drawn, drawn, MUTED)
    along = Axis("x / m", -0.04 * span, 1.04 * span)
    up = Axis("", -0.08 * span, max(3.0 * drawn, 0.1 * span))
    return [_view(along, up, marks, "all contacts where the record begins", 3.4, share=2.2)]


def _bodies_words(tree: DataTree, of: Lengths) -> str:
    (begin, end), count = _rolled(of), len(_beginning(of, "contact"))
    seen = " Triangles below: accelerometers." if _beginning(of, "sensor") else ""
    contacts = "One contact" if count == 1 else f"{count} contacts"
    radius = data.engineering(of.get("radius") or 0.0, "m", 2)
    return (
        f"{contacts} over a {data.case_words(tree, 'over')}, radius {radius}, drawn larger where it would "
        f"not be seen; the position of the run goes from {begin:.3g} m to {end:.3g} m (red).{seen}"
    )


# --- a wheel on a track

RAIL, PAD, SLEEPER, BALLAST = 0.17, 0.02, 0.2, 0.12
"""Heights in which rail, pads, sleepers and ballast are drawn, m: a case does not hold them."""
SLEEPER_WIDTH, BAYS = 0.26, 2
"""Width in which sleepers are drawn, m, and bays to either side of the wheel."""


def _of_track(tree: DataTree) -> dict[str, float | None]:
    radius, spacing = (data.case_quantity(tree, f, "m") for f in ("wheel.radius", "track.sleeper_spacing"))
    own = {"wheel radius": radius, "sleeper spacing": spacing}
    return own | _numbered(tree, ROLLING_POINT, "point {} at x")


def _track(tree: DataTree, of: Lengths) -> list[Panel]:
    """Wheel and track from the side."""
    begin, end = _rolled(of)
    points = [point for point in _beginning(of, "point") if np.isfinite(point)]
    at = points[-1] if points else (begin + end) / 2
    spacing, radius = of.get("sleeper spacing") or 0.6, of.get("wheel radius")
    half = (BAYS + 0.4) * spacing
    left, right = at - half, at + half
    path = _path(*np.clip([begin, end], left, right))
    sleepers = sleepers_between(tree, left, right, spacing)
    marks = [*_rail(tree, left, right, sleepers), path, _places(points, -RAIL / 2)]
    if radius is not None:
        marks += _rolling_body(at, radius, 1.0, data.number(tree, rolling.SPEED), inside=0.12)
    x = Axis("x along the rail / m", left, right)
    y = Axis("m", -RAIL - PAD - SLEEPER - BALLAST, 2.1 * (radius or 0.46))
    return [_view(x, y, marks, "the wheel on the track", 3.6, share=1.9)]


def _rail(tree: DataTree, left: float, right: float, sleepers: Numbers) -> list[Mark]:
    """Rail with its dampers, and below it pads, sleepers and ballast; without sleepers that move a slab."""
    look: dict[str, Any] = {"colour": MUTED, "dashes": (3, 2)}
    width, bottom = right - left, -RAIL - PAD - SLEEPER
    marks: list[Mark] = [_block(left, -RAIL, width, RAIL, **look)]
    if data.case_words(tree, "track.rail_damper_mass"):
        for x in 0.5 * (sleepers[1:] + sleepers[:-1]):
            marks.append(_block(x - 0.1, -0.8 * RAIL, 0.2, 0.35 * RAIL, fill=MUTED, colour=""))
    spread = data.case_words(tree, "track.continuous") == "yes"
    pads = [(left, width)] if spread else [(x - 0.08, 0.16) for x in sleepers]
    marks += [_block(x, -RAIL - PAD, length, PAD, fill=MUTED, colour="") for x, length in pads]
    if spread or data.case_words(tree, "track.ballast_stiffness").startswith("inf"):
        return [*marks, _block(left, bottom - BALLAST, width, SLEEPER + BALLAST, fill="", **look)]
    marks += [_block(x - SLEEPER_WIDTH / 2, bottom, SLEEPER_WIDTH, SLEEPER, **look) for x in sleepers]
    return [*marks, _block(left, bottom - BALLAST, width, BALLAST, fill="", **look)]


def _track_words(_: DataTree, of: Lengths) -> str:
    begin, end = _rolled(of)
    recorded = "; triangles: where the rail's motion is recorded" if _beginning(of, "point") else ""
    return (
        "Radius of the wheel and distance of the sleepers to scale; dashed: rail, pads, sleepers and "
        "ballast or slab, whose shapes are no part of the case. Rolled from "
        f"{begin:.4g} m to {end:.4g} m{recorded}."
    )


SCENES = (
    _scene("ball-on-beam", "The scene, to scale", _of_beam, _beam, _beam_words),
    _scene("wheel-on-rail", "The scene, to scale", _of_track, _track, _track_words, height=3.6),
    _scene("", "The scene", _of_bodies, _bodies, _bodies_words, rolling.OFFSET),
)
