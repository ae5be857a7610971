"""The scene to scale: a wheel on a few sleeper bays of the track, and the contact."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from xarray import DataTree

from asperity.kinds.wheel_on_rail.schema import ROLLING_POINT
from asperity.reporting.data import case_quantity, engineering, number, present, values
from asperity.reporting.part import Data, Part
from asperity.reporting.scene import draw_patch, ground, length_of, lengths, patch_words
from asperity.reporting.style import BLUE, INK, MUTED, VERMILLION, side_by_side, styled
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


@styled()
def track_scene_figure(tree: DataTree, data: Data) -> Figure:
    """Wheel and track from the side, and the contact from above."""
    figure, (side, above) = side_by_side(3.6, (1.9, 1))
    _draw_track(side, tree, data)
    draw_patch(above, data)
    return figure


def _points(data: Data) -> list[float]:
    return [float(series.values[0]) for name, series in data.lines.items() if str(name).startswith("point")]


def _draw_track(axes: Axes, tree: DataTree, data: Data) -> None:
    begin, end = (length_of(data, f"record {word} at x") or 0.0 for word in ("begins", "ends"))
    points = [point for point in _points(data) if np.isfinite(point)]
    at = points[-1] if points else (begin + end) / 2
    spacing = length_of(data, "sleeper spacing") or 0.6
    half = (BAYS + 0.4) * spacing
    bottom = -RAIL - PAD - SLEEPER
    look = {"edgecolor": MUTED, "linestyle": (0, (3, 2))}
    ground(axes, at - half, -RAIL, 2 * half, RAIL, **look)
    for sleeper in np.arange(np.ceil((at - half) / spacing), np.floor((at + half) / spacing) + 1) * spacing:
        ground(axes, sleeper - 0.08, -RAIL - PAD, 0.16, PAD, facecolor=MUTED, linewidth=0)
        ground(axes, sleeper - SLEEPER_WIDTH / 2, bottom, SLEEPER_WIDTH, SLEEPER, **look)
    ground(axes, at - half, bottom - BALLAST, 2 * half, BALLAST, facecolor="none", **look)
    axes.plot(np.clip([begin, end], at - half, at + half), [0.0, 0.0], color=VERMILLION, linewidth=2.5)
    axes.plot(points, [-RAIL / 2] * len(points), "^", color=INK, markersize=6)
    radius = length_of(data, "wheel radius")
    if radius is not None:
        axes.add_patch(Circle((at, radius), radius, facecolor=BLUE, alpha=0.12, linewidth=0))
        axes.add_patch(Circle((at, radius), radius, fill=False, edgecolor=BLUE, linewidth=1.6))
        axes.plot([at, at + 0.8 * radius], [radius, 1.6 * radius], color=MUTED, linewidth=0.9)
        axes.annotate(
            f"R = {engineering(radius, 'm', 2)}", (at, radius), xytext=(0, -12), textcoords="offset points",
            ha="center", fontsize=8.5, color=INK,
        )  # fmt: skip
        speed = number(tree, SPEED)
        axes.annotate(
            "" if speed is None else f"{speed:.3g} m/s", (at + half, radius), (at + 1.1 * radius, radius),
            va="center", arrowprops={"arrowstyle": "->", "color": INK, "linewidth": 1.0}, fontsize=8.5,
        )  # fmt: skip
    axes.set_aspect("equal")
    axes.grid(visible=False)
    axes.set_xlim(at - half, at + half)
    axes.set_ylim(bottom - BALLAST, 2.1 * (radius or 0.46))
    axes.set_xlabel("x along the rail / m")
    axes.set_ylabel("m")
    axes.set_title("the wheel on the track")


def _caption(tree: DataTree) -> str:
    data = track_scene_data(tree)
    begin, end = (length_of(data, f"record {word} at x") or 0.0 for word in ("begins", "ends"))
    recorded = "; triangles: where the rail's motion is recorded" if _points(data) else ""
    return (
        "Radius of the wheel and distance of the sleepers to scale; dashed: rail, pads, sleepers and "
        f"ballast, whose shapes are no part of the case. Rolled from {begin:.4g} m to {end:.4g} m"
        f"{recorded}.{patch_words(data)}"
    )


TRACK_SCENE = Part(
    "scene", "The scene, to scale", (POSITION,), track_scene_data, track_scene_figure, _caption
)
