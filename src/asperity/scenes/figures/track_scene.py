"""The scene to scale: a wheel on a few sleeper bays of the track, and the contact."""

from __future__ import annotations

import numpy as np
from xarray import DataTree

from asperity.reporting.chart import MUTED, Axis, Chart, Mark, Panel
from asperity.reporting.data import case_quantity, number, present, values
from asperity.reporting.drawing import (
    ground,
    length_of,
    lengths,
    lengths_named,
    patch_panel,
    patch_words,
    path_line,
    places,
    rolled,
    rolling_body,
)
from asperity.reporting.part import Data, Part
from asperity.scenes.schema import ROLLING_POINT
from asperity.schema.rolling import POSITION, SPEED

RAIL, PAD, SLEEPER, BALLAST = 0.17, 0.02, 0.2, 0.12
"""Heights in which rail, pads, sleepers and ballast are drawn, m: a case does not hold them."""
SLEEPER_WIDTH, BAYS = 0.26, 2
"""Width in which sleepers are drawn, m, and bays to either side of the wheel."""


def track_scene_data(tree: DataTree) -> Data:
    """Lengths of the scene."""
    own = {
        "wheel radius": case_quantity(tree, "wheel.radius", "m"),
        "sleeper spacing": case_quantity(tree, "track.sleeper_spacing", "m"),
    }
    points = values(tree, ROLLING_POINT) if present(tree, ROLLING_POINT) else ()
    return lengths(tree, own | {f"point {n} at x": float(x) for n, x in enumerate(points, start=1)})


def track_scene_chart(tree: DataTree, data: Data) -> Chart:
    """Wheel and track from the side, and the contact from above."""
    return Chart((_side(tree, data), patch_panel(data, beside=True, height=3.6)), drawing=True)


def _side(tree: DataTree, data: Data) -> Panel:
    begin, end = rolled(data)
    points = [point for point in lengths_named(data, "point") if np.isfinite(point)]
    at = points[-1] if points else (begin + end) / 2
    spacing, radius = length_of(data, "sleeper spacing") or 0.6, length_of(data, "wheel radius")
    half = (BAYS + 0.4) * spacing
    left, right = at - half, at + half
    path = path_line(*np.clip([begin, end], left, right))
    marks = [*_track(left, right, spacing), path, places(points, -RAIL / 2)]
    if radius is not None:
        marks += rolling_body(at, radius, 1.0, number(tree, SPEED), inside=0.12)
    x = Axis("x along the rail / m", left, right)
    y = Axis("m", -RAIL - PAD - SLEEPER - BALLAST, 2.1 * (radius or 0.46))
    return Panel(x, y, tuple(marks), "the wheel on the track", height=3.6, equal=True, share=1.9)


def _track(left: float, right: float, spacing: float) -> list[Mark]:
    """Rail, and pads, sleepers and ballast below it."""
    bottom, look = -RAIL - PAD - SLEEPER, {"colour": MUTED, "dashes": (3, 2)}
    marks: list[Mark] = [ground(left, -RAIL, right - left, RAIL, **look)]
    for x in np.arange(np.ceil(left / spacing), np.floor(right / spacing) + 1) * spacing:
        marks.append(ground(x - 0.08, -RAIL - PAD, 0.16, PAD, fill=MUTED, colour=""))
        marks.append(ground(x - SLEEPER_WIDTH / 2, bottom, SLEEPER_WIDTH, SLEEPER, **look))
    return [*marks, ground(left, bottom - BALLAST, right - left, BALLAST, fill="", **look)]


def _caption(tree: DataTree) -> str:
    data = track_scene_data(tree)
    begin, end = rolled(data)
    recorded = "; triangles: where the rail's motion is recorded" if lengths_named(data, "point") else ""
    return (
        "Radius of the wheel and distance of the sleepers to scale; dashed: rail, pads, sleepers and "
        f"ballast, whose shapes are no part of the case. Rolled from {begin:.4g} m to {end:.4g} m"
        f"{recorded}.{patch_words(data)}"
    )


TRACK_SCENE = Part("scene", "The scene, to scale", (POSITION,), track_scene_data, track_scene_chart, _caption)
