"""The scene: a ball on its beam, bodies on their path, a wheel on its track; and the contact from above."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from xarray import DataTree

from asperity.reporting import data, drawing
from asperity.reporting.chart import GRID, INK, MUTED, Axis, Boxes, Chart, Mark, Panel, Shape
from asperity.reporting.drawing import Lengths, arrow, circle, ground, path_line, places
from asperity.reporting.figure import Figure, Lines
from asperity.scenes.schema import ROLLING_POINT, ROLLING_SENSOR
from asperity.schema import Entry
from asperity.schema.rolling import OFFSET, POSITION, SPEED

Own = Callable[[DataTree], dict[str, float | None]]


def _numbered(tree: DataTree, entry: Entry, name: str) -> dict[str, float | None]:
    """Positions along x, as ``sensor 1 at x``."""
    found = data.values(tree, entry).tolist() if data.present(tree, entry) else []
    return {name.format(number): position for number, position in enumerate(found, 1)}


def _scene(
    title: str,
    own: Own,
    draw: Callable[[DataTree, Lengths], list[Panel]],
    caption: Callable[[DataTree, Lengths], str],
    *needs: Entry,
    height: float = 3.4,
) -> Figure:
    """Declare a scene by its own lengths, what is drawn of it and what is said, both without the contact."""

    def drawn(tree: DataTree, lines: Lines) -> Chart:
        sizes = Lengths.of(lines)
        return Chart((*draw(tree, sizes), drawing.patch_panel(sizes, height)), drawing=True)

    def said(tree: DataTree) -> str:
        sizes = Lengths.of(scene.collect(tree))
        return caption(tree, sizes) + drawing.patch_words(sizes)

    scene = Figure("scene", title, None, (drawing.lengths(own),), drawn, said, (POSITION, *needs))
    return scene


# --- a ball on a beam


def _of_beam(tree: DataTree) -> dict[str, float | None]:
    own = {
        name: data.case_quantity(tree, name.replace(" ", "."), "m")
        for name in ("ball radius", "beam length", "beam height")
    }
    return own | _numbered(tree, ROLLING_SENSOR, "sensor {} at x")


def _beam(tree: DataTree, of: Lengths) -> list[Panel]:
    """The beam from the side over the whole width, below it the ball close by, if its size is known."""
    begin, end = of.rolled
    length, height = of.get("beam length") or end, of.get("beam height") or 0.01
    radius = of.get("ball radius") or 0.0
    marks: list[Mark] = [
        ground(0.0, -height, length, height),
        *_supports(data.case_words(tree, "beam.support"), length, height),
        path_line(begin, end),
        *circle(begin, radius, dashes=(2, 1.5)),
        *circle(end, radius),
        places(of.beginning("sensor"), -height - 0.006 * length),
    ]
    if end - begin > 2 * radius:
        marks += arrow(begin + radius, end - radius, radius)
    x = Axis("x / m", -0.04 * length, 1.04 * length)
    y = Axis("", -height - 0.035 * length, max(2.2 * radius, 0.02 * length), ticks=((0.0, "0"),))
    side = Panel(x, y, tuple(marks), "the beam from the side", height=1.5, equal=True)
    radius, height = radius * 1e3, (of.get("beam height") or 0.0) * 1e3  # mm
    if not radius or not height:
        return [side]
    reach = 2.2 * radius
    ball = drawing.rolling_body(0.0, radius, 1e-3, data.number(tree, SPEED), inside=0.15)
    x, y = Axis("x / mm", -reach, reach), Axis("z / mm", -1.3 * height, 2.1 * radius)
    close = (ground(-reach, -height, 2 * reach, height), *ball)
    return [side, Panel(x, y, close, "the ball on the beam", height=3.4, equal=True)]


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
            marks.append(Boxes(left, right, low, high, colour=GRID, hatch="/", edge=INK))
    return marks


def _beam_words(tree: DataTree, of: Lengths) -> str:
    (begin, end), support = of.rolled, data.case_words(tree, "beam.support")
    return (
        f"To scale. The beam{f', {support}' if support else ''}; the record is rolled from {begin:.3g} m "
        f"(dashed) to {end:.3g} m; triangles below: accelerometers."
    )


BEAM_SCENE = _scene("The scene, to scale", _of_beam, _beam, _beam_words)


# --- bodies on any number of contacts


def _of_bodies(tree: DataTree) -> dict[str, float | None]:
    own = {"radius": data.case_quantity(tree, "body.radius", "m")}
    if data.case_words(tree, "over") == "beam":
        own["length"] = data.case_quantity(tree, "beam.length", "m")
    own |= _numbered(tree, OFFSET, "contact {} ahead by")
    return own | _numbered(tree, ROLLING_SENSOR, "sensor {} at x")


def _bodies(_: DataTree, of: Lengths) -> list[Panel]:
    """The path with all contacts at the start of the record."""
    begin, end = of.rolled
    radius, sensors, offsets = of.get("radius") or 0.0, of.beginning("sensor"), of.beginning("contact")
    contacts = [begin + offset for offset in offsets]
    span = of.get("length") or max(end + max(offsets, default=0.0), *contacts, *sensors, 1e-3)
    drawn = max(radius, 0.012 * span)  # seen at all on a long path
    marks: list[Mark] = [ground(-0.02 * span, -0.03 * span, 1.04 * span, 0.03 * span), path_line(begin, end)]
    for x in contacts:
        marks += circle(x, drawn, width=1.2)
    marks.append(places(sensors, -0.045 * span))
    if contacts:
        marks += arrow(contacts[-1] + 1.6 * drawn, contacts[-1] + 5 * drawn, drawn, MUTED)
    along = Axis("x / m", -0.04 * span, 1.04 * span)
    up = Axis("", -0.08 * span, max(3.0 * drawn, 0.1 * span), ticks=((0.0, "0"),))
    title = "all contacts where the record begins"
    return [Panel(along, up, tuple(marks), title, height=3.4, equal=True, share=2.2)]


def _bodies_words(tree: DataTree, of: Lengths) -> str:
    (begin, end), count = of.rolled, len(of.beginning("contact"))
    seen = " Triangles below: accelerometers." if of.beginning("sensor") else ""
    contacts = "One contact" if count == 1 else f"{count} contacts"
    radius = data.engineering(of.get("radius") or 0.0, "m", 2)
    return (
        f"{contacts} over a {data.case_words(tree, 'over')}, radius {radius}, drawn larger where it would "
        f"not be seen; the position of the run goes from {begin:.3g} m to {end:.3g} m (red).{seen}"
    )


BODIES_SCENE = _scene("The scene", _of_bodies, _bodies, _bodies_words, OFFSET)


# --- a wheel on a track

RAIL, PAD, SLEEPER, BALLAST = 0.17, 0.02, 0.2, 0.12
"""Heights in which rail, pads, sleepers and ballast are drawn, m: a case does not hold them."""
SLEEPER_WIDTH, BAYS = 0.26, 2
"""Width in which sleepers are drawn, m, and bays to either side of the wheel."""


def _of_track(tree: DataTree) -> dict[str, float | None]:
    own = {
        "wheel radius": data.case_quantity(tree, "wheel.radius", "m"),
        "sleeper spacing": data.case_quantity(tree, "track.sleeper_spacing", "m"),
    }
    return own | _numbered(tree, ROLLING_POINT, "point {} at x")


def _track(tree: DataTree, of: Lengths) -> list[Panel]:
    """Wheel and track from the side."""
    begin, end = of.rolled
    points = [point for point in of.beginning("point") if np.isfinite(point)]
    at = points[-1] if points else (begin + end) / 2
    spacing, radius = of.get("sleeper spacing") or 0.6, of.get("wheel radius")
    half = (BAYS + 0.4) * spacing
    left, right = at - half, at + half
    path = path_line(*np.clip([begin, end], left, right))
    marks = [*_rail(left, right, spacing), path, places(points, -RAIL / 2)]
    if radius is not None:
        marks += drawing.rolling_body(at, radius, 1.0, data.number(tree, SPEED), inside=0.12)
    x = Axis("x along the rail / m", left, right)
    y = Axis("m", -RAIL - PAD - SLEEPER - BALLAST, 2.1 * (radius or 0.46))
    return [Panel(x, y, tuple(marks), "the wheel on the track", height=3.6, equal=True, share=1.9)]


def _rail(left: float, right: float, spacing: float) -> list[Mark]:
    """Rail, and pads, sleepers and ballast below it."""
    bottom, look = -RAIL - PAD - SLEEPER, {"colour": MUTED, "dashes": (3, 2)}
    marks: list[Mark] = [ground(left, -RAIL, right - left, RAIL, **look)]
    for x in np.arange(np.ceil(left / spacing), np.floor(right / spacing) + 1) * spacing:
        marks.append(ground(x - 0.08, -RAIL - PAD, 0.16, PAD, fill=MUTED, colour=""))
        marks.append(ground(x - SLEEPER_WIDTH / 2, bottom, SLEEPER_WIDTH, SLEEPER, **look))
    return [*marks, ground(left, bottom - BALLAST, right - left, BALLAST, fill="", **look)]


def _track_words(_: DataTree, of: Lengths) -> str:
    begin, end = of.rolled
    recorded = "; triangles: where the rail's motion is recorded" if of.beginning("point") else ""
    return (
        "Radius of the wheel and distance of the sleepers to scale; dashed: rail, pads, sleepers and "
        f"ballast, whose shapes are no part of the case. Rolled from {begin:.4g} m to {end:.4g} m{recorded}."
    )


TRACK_SCENE = _scene("The scene, to scale", _of_track, _track, _track_words, height=3.6)
