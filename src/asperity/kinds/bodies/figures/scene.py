"""The scene: all contacts along the path, what rolls close by, and the contact from above."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from xarray import DataTree

from asperity.kinds.bodies.schema import OFFSET, ROLLING_SENSOR
from asperity.reporting.data import case_quantity, case_words, engineering, present, values
from asperity.reporting.part import Data, Part
from asperity.reporting.scene import draw_patch, ground, length_of, lengths, patch_words
from asperity.reporting.style import BLUE, INK, MUTED, VERMILLION, is_narrow, new_figure, styled
from asperity.schema.rolling import POSITION


def scene_data(tree: DataTree) -> Data:
    """Lengths of the scene."""
    own = {"radius": case_quantity(tree, "body.radius", "m")}
    if case_words(tree, "over") == "beam":
        own["length"] = case_quantity(tree, "beam.length", "m")
    named = {f"contact {n} ahead by": float(x) for n, x in enumerate(values(tree, OFFSET), start=1)}
    sensors = values(tree, ROLLING_SENSOR) if present(tree, ROLLING_SENSOR) else ()
    return lengths(tree, own | named | {f"sensor {n} at x": float(x) for n, x in enumerate(sensors, start=1)})


@styled()
def scene_figure(tree: DataTree, data: Data) -> Figure:
    """The path with all contacts at the start of the record, and the contact from above."""
    if is_narrow():
        figure = new_figure(5.2)
        side, above = figure.subplots(2, 1, height_ratios=(1, 2.4))
    else:
        figure = new_figure(3.4)
        side, above = figure.subplots(1, 2, width_ratios=(2.2, 1))
    _draw_path(side, data)
    draw_patch(above, data)
    return figure


def _named(data: Data, word: str) -> list[float]:
    return [float(series.values[0]) for name, series in data.lines.items() if str(name).startswith(word)]


def _draw_path(axes: Axes, data: Data) -> None:
    begin, end = (length_of(data, f"record {word} at x") or 0.0 for word in ("begins", "ends"))
    radius = length_of(data, "radius") or 0.0
    contacts = [begin + offset for offset in _named(data, "contact")]
    farthest = end + max(_named(data, "contact"), default=0.0)
    sensors = _named(data, "sensor")
    span = length_of(data, "length") or max(farthest, *contacts, *sensors, 1e-3)
    drawn = max(radius, 0.012 * span)  # seen at all on a long path
    ground(axes, -0.02 * span, -0.03 * span, 1.04 * span, 0.03 * span)
    axes.plot([begin, end], [0.0, 0.0], color=VERMILLION, linewidth=2.5, solid_capstyle="butt")
    for x in contacts:
        axes.add_patch(Circle((x, drawn), drawn, fill=False, edgecolor=BLUE, linewidth=1.2))
    axes.plot(sensors, [-0.045 * span] * len(sensors), "^", color=INK, markersize=5)
    if contacts:
        axes.annotate(
            "", (contacts[-1] + 5 * drawn, drawn), (contacts[-1] + 1.6 * drawn, drawn),
            arrowprops={"arrowstyle": "->", "color": MUTED, "linewidth": 0.9},
        )  # fmt: skip
    axes.set_aspect("equal")
    axes.grid(visible=False)
    axes.set_xlim(-0.04 * span, 1.04 * span)
    axes.set_ylim(-0.08 * span, max(3.0 * drawn, 0.1 * span))
    axes.set_yticks([])
    axes.spines[["left", "right", "top"]].set_visible(False)
    axes.set_xlabel("x / m")
    axes.set_title("all contacts where the record begins")


def _caption(tree: DataTree) -> str:
    data = scene_data(tree)
    count, over = len(values(tree, OFFSET)), case_words(tree, "over")
    begin, end = (length_of(data, f"record {word} at x") or 0.0 for word in ("begins", "ends"))
    radius = engineering(length_of(data, "radius") or 0.0, "m", 2)
    seen = " Triangles below: accelerometers." if _named(data, "sensor") else ""
    contacts = "one contact" if count == 1 else f"{count} contacts"
    return (
        f"{contacts.capitalize()} over a {over}, radius {radius}, drawn larger where it would not be seen; "
        f"the position of the run goes from {begin:.3g} m to {end:.3g} m (red).{seen}{patch_words(data)}"
    )


BODIES_SCENE = Part("scene", "The scene", (POSITION, OFFSET), scene_data, scene_figure, _caption)
