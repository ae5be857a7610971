"""``asperity creep``: creep force over creepage of what rolls in a case, in words, as CSV, and drawn."""

from pathlib import Path
from typing import Any

import numpy as np

from asperity.arguments import real, require, whole
from asperity.case.cases import load_case
from asperity.cli.running import prepared_case
from asperity.contact.creep import CreepCurve
from asperity.contact.friction import Friction
from asperity.errors import InputError
from asperity.progress import progress_bar
from asperity.reporting.chart import BLUE, GREEN, MUTED, VERMILLION, Axis, Chart, Line, Mark, Panel
from asperity.reporting.figure import FORMATS, write_chart, write_columns
from asperity.scenarios.creep import creep_of
from asperity.scenarios.preparing import PreparedCase
from asperity.terminal import say, say_table

NAMES = {"longitudinal": "creepage along", "lateral": "creepage across", "spin": "spin × √(ab)"}
MOST_POINTS = 1000


def show_creep(
    source: Path, direction: str, friction: float, points: int, picture: Path | None, table: Path | None
) -> dict[str, Any]:
    """Print a creep curve of a case under its working load, draw and write it; return its numbers."""
    if picture is not None:
        ends = picture.suffix.lower().lstrip(".") in FORMATS
        require(ends, "picture", f"'{picture}'", f"a name that ends in .{', .'.join(FORMATS)}")
    law = Friction(real("--friction", friction, "a coefficient above 0", above=0.0))
    allowed = f"a whole number from 2 to {MOST_POINTS}"
    whole("--points", points, allowed, at_least=2, at_most=MOST_POINTS)
    case = load_case(source)
    prepared = prepared_case(case, str(source))
    if not isinstance(prepared, PreparedCase):
        raise InputError("case", f"one of kind {case.kind}", "a kind whose bodies roll over a surface")
    with progress_bar() as progress:
        curve = creep_of(prepared, law, direction, points, progress)
    shape = prepared.shape
    columns = _columns(curve)
    title = f"{source}: {shape.load:.4g} N, friction {friction:g}, {direction}"
    rows = [[f"{value:.4g}" for value in row] for row in zip(*columns.values(), strict=True)]
    say_table(f"{title}: creep force over friction", [*columns], rows, width=120)
    files, (smooth, *rough) = dict[str, Path](), curve.slopes
    words = f"At the smallest {NAMES[direction]} the smooth contact has {smooth:.4f} of Kalker's linear force"
    if rough:
        words += f", the rough {np.mean(rough):.4f} (± {np.std(rough):.2g} over {len(rough)} samples)"
    say(f"{words}.")
    if table is not None:
        files["table"] = write_columns(columns, table)
        say(f"Table: {table.resolve()}")
    if picture is not None:
        files["picture"] = write_chart(_chart(curve), title, picture)
        say(f"Picture: {picture.resolve()}")
    return {
        "load": shape.load, "semi_axes": shape.semi_axes, "limit": curve.limit, "direction": direction,
        "creepage": curve.creepage, "smooth": curve.force[0], "rough": curve.force[1:],
        "slip_share": curve.slip_share, "linear": curve.linear, "fastsim": curve.fastsim, "files": files,
    }  # fmt: skip


def _columns(curve: CreepCurve) -> dict[str, Any]:
    """Forces over what friction carries."""
    found = {NAMES[curve.direction]: curve.creepage, "smooth": curve.force[0] / curve.limit}
    if len(curve.force) > 1:
        rough = curve.force[1:] / curve.limit
        found |= {"rough": rough.mean(axis=0), "its scatter": rough.std(axis=0)}
    found |= {"linear theory": curve.linear / curve.limit, "FASTSIM": curve.fastsim / curve.limit}
    return found | {"share that slips": curve.slip_share[0]}


def _chart(curve: CreepCurve) -> Chart:
    x = np.append(0.0, curve.creepage)

    def line(y: Any, label: str, colour: str, **look: Any) -> Mark:
        return Line(x, np.append(0.0, y / curve.limit), label, colour, **look)

    marks = [
        line(each, "rough samples" if i == 0 else "", MUTED, width=0.8)
        for i, each in enumerate(curve.force[1:])
    ]
    marks += [line(curve.force[0], "smooth", BLUE, width=1.6), line(curve.fastsim, "FASTSIM", VERMILLION)]
    marks.append(
        line(np.where(curve.linear <= 1.2 * curve.limit, curve.linear, np.nan), "linear theory", GREEN)
    )
    across = Axis("creep force over friction", 0.0, 1.05)
    return Chart((Panel(Axis(NAMES[curve.direction], 0.0, float(x[-1])), across, tuple(marks), height=4.2),))
