"""The scene: all contacts along the path, what rolls close by, and the contact from above."""

from __future__ import annotations

from xarray import DataTree

from asperity.reporting.chart import MUTED, Axis, Chart, Mark, Panel
from asperity.reporting.data import case_quantity, case_words, engineering, present, values
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
)
from asperity.reporting.part import Data, Part
from asperity.scenes.schema import ROLLING_SENSOR
from asperity.schema.rolling import OFFSET, POSITION


def scene_data(tree: DataTree) -> Data:
    """Lengths of the scene."""
    own = {"radius": case_quantity(tree, "body.radius", "m")}
    if case_words(tree, "over") == "beam":
        own["length"] = case_quantity(tree, "beam.length", "m")
    named = {f"contact {n} ahead by": float(x) for n, x in enumerate(values(tree, OFFSET), start=1)}
    sensors = values(tree, ROLLING_SENSOR) if present(tree, ROLLING_SENSOR) else ()
    return lengths(tree, own | named | {f"sensor {n} at x": float(x) for n, x in enumerate(sensors, start=1)})


def scene_chart(tree: DataTree, data: Data) -> Chart:
    """The path with all contacts at the start of the record, and the contact from above."""
    return Chart((_path(data), patch_panel(data, beside=True, height=3.4)), drawing=True)


def _path(data: Data) -> Panel:
    begin, end = rolled(data)
    radius = length_of(data, "radius") or 0.0
    offsets, sensors = lengths_named(data, "contact"), lengths_named(data, "sensor")
    contacts = [begin + offset for offset in offsets]
    span = length_of(data, "length") or max(end + max(offsets, default=0.0), *contacts, *sensors, 1e-3)
    drawn = max(radius, 0.012 * span)  # seen at all on a long path
    marks: list[Mark] = [ground(-0.02 * span, -0.03 * span, 1.04 * span, 0.03 * span), path_line(begin, end)]
    for x in contacts:
        marks += oval(x, drawn, drawn, drawn, inside=0.0, width=1.2)
    marks.append(places(sensors, -0.045 * span))
    if contacts:
        marks += arrow(contacts[-1] + 1.6 * drawn, contacts[-1] + 5 * drawn, drawn, MUTED)
    along = Axis("x / m", -0.04 * span, 1.04 * span)
    up = Axis("", -0.08 * span, max(3.0 * drawn, 0.1 * span), ticks=((0.0, "0"),))
    return Panel(
        along, up, tuple(marks), "all contacts where the record begins", height=3.4, equal=True, share=2.2
    )


def _caption(tree: DataTree) -> str:
    data = scene_data(tree)
    count, over = len(values(tree, OFFSET)), case_words(tree, "over")
    begin, end = rolled(data)
    radius = engineering(length_of(data, "radius") or 0.0, "m", 2)
    seen = " Triangles below: accelerometers." if lengths_named(data, "sensor") else ""
    contacts = "one contact" if count == 1 else f"{count} contacts"
    return (
        f"{contacts.capitalize()} over a {over}, radius {radius}, drawn larger where it would not be seen; "
        f"the position of the run goes from {begin:.3g} m to {end:.3g} m (red).{seen}{patch_words(data)}"
    )


BODIES_SCENE = Part("scene", "The scene", (POSITION, OFFSET), scene_data, scene_chart, _caption)
