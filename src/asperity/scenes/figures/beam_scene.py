"""The scene to scale: the beam with its supports and sensors, the ball and its path, and the contact."""

from __future__ import annotations

import numpy as np
from xarray import DataTree

from asperity.reporting.chart import GRID, INK, Axis, Boxes, Chart, Mark, Panel, Shape
from asperity.reporting.data import case_quantity, case_words, number, present, values
from asperity.reporting.drawing import (
    arrow,
    ground,
    length_of,
    lengths,
    lengths_named,
    oval,
    patch_panel,
    patch_words,
    path_line,
    places,
    rolled,
    rolling_body,
)
from asperity.reporting.part import Data, Part
from asperity.scenes.schema import ROLLING_SENSOR
from asperity.schema.rolling import POSITION, SPEED


def beam_scene_data(tree: DataTree) -> Data:
    """Lengths of the scene."""
    own = {
        "ball radius": case_quantity(tree, "ball.radius", "m"),
        "beam length": case_quantity(tree, "beam.length", "m"),
        "beam height": case_quantity(tree, "beam.height", "m"),
    }
    sensors = values(tree, ROLLING_SENSOR) if present(tree, ROLLING_SENSOR) else ()
    return lengths(tree, own | {f"sensor {n} at x": float(x) for n, x in enumerate(sensors, start=1)})


def beam_scene_chart(tree: DataTree, data: Data) -> Chart:
    """The beam from the side over the whole width, below it the ball close by and the contact from above."""
    return Chart(
        (_beam(tree, data), *_ball(tree, data), patch_panel(data, beside=True, height=3.4)), drawing=True
    )


def _beam(tree: DataTree, data: Data) -> Panel:
    begin, end = rolled(data)
    length, height = length_of(data, "beam length") or end, length_of(data, "beam height") or 0.01
    radius = length_of(data, "ball radius") or 0.0
    marks: list[Mark] = [
        ground(0.0, -height, length, height),
        *_supports(case_words(tree, "beam.support"), length, height),
        path_line(begin, end),
        *oval(begin, radius, radius, radius, dashes=(2, 1.5), inside=0.0),
        *oval(end, radius, radius, radius, inside=0.0),
        places(lengths_named(data, "sensor"), -height - 0.006 * length),
    ]
    if end - begin > 2 * radius:
        marks += arrow(begin + radius, end - radius, radius)
    x = Axis("x / m", -0.04 * length, 1.04 * length)
    y = Axis("", -height - 0.035 * length, max(2.2 * radius, 0.02 * length), ticks=((0.0, "0"),))
    return Panel(x, y, tuple(marks), "the beam from the side", height=1.5, equal=True)


def _supports(support: str, length: float, height: float) -> list[Mark]:
    size = 0.018 * length
    marks: list[Mark] = []
    for x, outward in ((0.0, -1.0), (length, 1.0)):
        if support == "simply-supported":
            foot = np.array([x, x - size, x + size]), -height - 1.5 * size * np.array([0, 1, 1])
            marks.append(Shape(*foot, width=0.9))
        elif support == "clamped":
            left, right, low, high = (
                np.array([edge]) for edge in (*sorted((x, x + outward * size)), -height - size, size)
            )
            marks.append(Boxes(left, right, low, high, colour=GRID, hatch="/", edge=INK))
    return marks


def _ball(tree: DataTree, data: Data) -> list[Panel]:
    """The ball close by, if its size is known, in mm."""
    radius, height = ((length_of(data, name) or 0.0) * 1e3 for name in ("ball radius", "beam height"))
    if not radius or not height:
        return []
    reach = 2.2 * radius
    marks = [
        ground(-reach, -height, 2 * reach, height),
        *rolling_body(0.0, radius, 1e-3, number(tree, SPEED), inside=0.15),
    ]
    x, y = Axis("x / mm", -reach, reach), Axis("z / mm", -1.3 * height, 2.1 * radius)
    return [Panel(x, y, tuple(marks), "the ball on the beam", height=3.4, equal=True)]


def _caption(tree: DataTree) -> str:
    data = beam_scene_data(tree)
    begin, end = rolled(data)
    support = case_words(tree, "beam.support")
    ends = f", {support}" if support else ""
    return (
        f"To scale. The beam{ends}; the record is rolled from {begin:.3g} m (dashed) to {end:.3g} m; "
        f"triangles below: accelerometers.{patch_words(data)}"
    )


BEAM_SCENE = Part("scene", "The scene, to scale", (POSITION,), beam_scene_data, beam_scene_chart, _caption)
