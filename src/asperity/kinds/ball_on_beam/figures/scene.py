"""The scene to scale: the beam with its supports and sensors, the ball and its path, and the contact."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon
from xarray import DataTree

from asperity.kinds.ball_on_beam.schema import ROLLING_SENSOR
from asperity.reporting.data import case_quantity, case_words, engineering, number, present, values
from asperity.reporting.part import Data, Part
from asperity.reporting.scene import draw_patch, ground, length_of, lengths, patch_words
from asperity.reporting.style import BLUE, INK, MUTED, VERMILLION, is_narrow, new_figure, styled
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


@styled()
def beam_scene_figure(tree: DataTree, data: Data) -> Figure:
    """The beam from the side over the whole width, below it the ball close by and the contact from above."""
    figure = new_figure(6.6 if is_narrow() else 4.6)
    if is_narrow():
        side, close, above = figure.subplots(3, 1, height_ratios=(1, 2, 3))
    else:
        grid = figure.add_gridspec(2, 2, height_ratios=(1, 2.2))
        side = figure.add_subplot(grid[0, :])
        close, above = (figure.add_subplot(grid[1, column]) for column in (0, 1))
    _draw_beam(side, tree, data)
    _draw_ball(close, tree, data)
    draw_patch(above, data)
    return figure


def _draw_beam(axes: Axes, tree: DataTree, data: Data) -> None:
    begin, end = (length_of(data, f"record {word} at x") or 0.0 for word in ("begins", "ends"))
    length, height = length_of(data, "beam length") or end, length_of(data, "beam height") or 0.01
    radius = length_of(data, "ball radius") or 0.0
    ground(axes, 0.0, -height, length, height)
    _draw_supports(axes, case_words(tree, "beam.support"), length, height)
    axes.plot([begin, end], [0.0, 0.0], color=VERMILLION, linewidth=2.5, solid_capstyle="butt")
    for x, edge in ((begin, (0, (2, 1.5))), (end, "-")):
        axes.add_patch(Circle((x, radius), radius, fill=False, edgecolor=BLUE, linewidth=1.2, linestyle=edge))
    if end - begin > 2 * radius:
        axes.annotate(
            "", (end - radius, radius), (begin + radius, radius),
            arrowprops={"arrowstyle": "->", "color": INK, "linewidth": 0.9},
        )  # fmt: skip
    sensors = [series.values[0] for name, series in data.lines.items() if str(name).startswith("sensor")]
    axes.plot(sensors, [-height - 0.006 * length] * len(sensors), "^", color=INK, markersize=5)
    axes.set_aspect("equal")
    axes.grid(visible=False)
    axes.set_xlim(-0.04 * length, 1.04 * length)
    axes.set_ylim(-height - 0.035 * length, max(2.2 * radius, 0.02 * length))
    axes.set_yticks([])
    axes.spines[["left", "right", "top"]].set_visible(False)
    axes.set_xlabel("x / m")
    axes.set_title("the beam from the side")


def _draw_supports(axes: Axes, support: str, length: float, height: float) -> None:
    size = 0.018 * length
    for x, outward in ((0.0, -1.0), (length, 1.0)):
        if support == "simply-supported":
            foot = [(x, -height), (x - size, -height - 1.5 * size), (x + size, -height - 1.5 * size)]
            axes.add_patch(Polygon(foot, fill=False, edgecolor=INK, linewidth=0.9))
        elif support == "clamped":
            ground(axes, min(x, x + outward * size), -height - size, size, height + 2 * size, hatch="////")


def _draw_ball(axes: Axes, tree: DataTree, data: Data) -> None:
    radius, height = length_of(data, "ball radius"), length_of(data, "beam height")
    axes.set_aspect("equal")
    axes.grid(visible=False)
    axes.set_title("the ball on the beam")
    if radius is None or height is None:
        return
    size = 1e-3
    reach, radius, height = 1.8 * radius / size, radius / size, height / size
    ground(axes, -reach, -height, 2 * reach, height)
    axes.add_patch(Circle((0.0, radius), radius, facecolor=BLUE, alpha=0.15, linewidth=0))
    axes.add_patch(Circle((0.0, radius), radius, fill=False, edgecolor=BLUE, linewidth=1.4))
    axes.plot([0.0, radius * 0.8], [radius, 1.6 * radius], color=MUTED, linewidth=0.9)
    axes.annotate(
        f"R = {engineering(radius * size, 'm', 2)}", (0.0, radius), xytext=(0, -12),
        textcoords="offset points", ha="center", fontsize=8.5, color=INK,
    )  # fmt: skip
    speed = number(tree, SPEED)
    axes.annotate(
        "" if speed is None else f"{speed:.3g} m/s", (reach, radius), (radius * 1.08, radius), va="center",
        arrowprops={"arrowstyle": "->", "color": INK, "linewidth": 1.0}, fontsize=8.5, color=INK,
    )  # fmt: skip
    axes.set_xlim(-reach, reach)
    axes.set_ylim(-1.3 * height, 2.1 * radius)
    axes.set_xlabel("mm")
    axes.set_ylabel("mm")


def _caption(tree: DataTree) -> str:
    data = beam_scene_data(tree)
    begin, end = (length_of(data, f"record {word} at x") or 0.0 for word in ("begins", "ends"))
    support = case_words(tree, "beam.support")
    ends = f", {support}" if support else ""
    return (
        f"To scale. The beam{ends}; the record is rolled from {begin:.3g} m (dashed) to {end:.3g} m; "
        f"triangles below: accelerometers.{patch_words(data)}"
    )


BEAM_SCENE = Part("scene", "The scene, to scale", (POSITION,), beam_scene_data, beam_scene_figure, _caption)
