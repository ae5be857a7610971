"""``asperity creep``: creep of what rolls in a case, over creepage or over states, told, as CSV and drawn."""

from collections.abc import Mapping
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
from asperity.reduction.traction import TractionStates
from asperity.reporting.chart import BLUE, GREEN, MUTED, VERMILLION, Area, Axis, Chart, Line, Mark, Panel
from asperity.reporting.data import engineering
from asperity.reporting.figure import write_chart, write_columns
from asperity.scenarios.creep import creep_of, friction_of, states_of
from asperity.scenarios.preparing import PreparedCase
from asperity.terminal import say, say_table

NAMES = {"longitudinal": "creepage along", "lateral": "creepage across", "spin": "spin × √(ab)"}
STIFFNESSES = ("normal stiffness", "stiffness along", "stiffness across", "real area")
CREEPS = ("longitudinal creep", "lateral creep", "spin creep")
MOST_POINTS = 1000


def show_creep(
    source: Path,
    direction: str | None,
    friction: float | None,
    points: int | None,
    picture: Path | None,
    table: Path | None,
    states: bool,
) -> None:
    """Print a creep curve, or state functions, of a case, draw and write them."""
    alone = (direction is None and friction is None) or not states
    remedy = "In states nothing slips, and all directions are computed: leave the other away."
    require(alone, "--states", "--direction or --friction with it", "one without the other", remedy)
    if friction is not None:
        real("--friction", friction, "a coefficient above 0", above=0.0)
    allowed = f"a whole number from 2 to {MOST_POINTS}"
    count = (6 if states else 16) if points is None else points
    whole("--points", count, allowed, at_least=2, at_most=MOST_POINTS)
    case = load_case(source)
    prepared = prepared_case(case, str(source))
    if not isinstance(prepared, PreparedCase):
        raise InputError("case", f"one of kind {case.kind}", "a kind whose bodies roll over a surface")
    with progress_bar() as progress:
        if states:
            found = _told_states(states_of(prepared, count, progress), str(source))
        else:
            law = friction_of(prepared.case) if friction is None else Friction(friction)
            curve = creep_of(prepared, law, direction or "longitudinal", count, progress)
            found = _told_curve(curve, prepared, str(source))
    title, columns, chart = found
    if table is not None:
        write_columns(columns, table)
        say(f"Table: {table.resolve()}")
    if picture is not None:
        write_chart(chart, title, picture)
        say(f"Picture: {picture.resolve()}")


Told = tuple[str, dict[str, Any], Chart]
"""Title, columns of the table, and chart."""


def _told_curve(curve: CreepCurve, prepared: PreparedCase, source: str) -> Told:
    given, columns, (smooth, *rough) = prepared.shape.load, _columns(curve), curve.slopes
    load, friction = engineering(given, "N"), f"{curve.limit / given:.4g}"
    title = f"{source}: {load}, friction {friction}, {curve.direction}"
    _say_columns(f"{title}: creep force over friction", columns)
    at, linear = f"At the smallest {NAMES[curve.direction]}", "of Kalker's linear force"
    words = f"{at} the smooth contact has {smooth:.4f} {linear}"
    if rough:
        words += f", the rough {np.mean(rough):.4f} (± {np.std(rough):.2g} over {len(rough)} samples)"
    say(f"{words}.")
    return title, columns, _chart(curve)


def _told_states(states: TractionStates, source: str) -> Told:
    """Rough over smooth under the same load in words, the functions themselves as columns."""
    load, change, panels = states.load.mean(axis=0), states.change, list[Panel]()
    title = f"{source}: rough contact over smooth under the same load, {len(states.load)} samples"
    told = {
        name: [f"{m:.3f} ± {s:.2g}" if m == m else "short sample" for m, s in zip(*each, strict=True)]
        for name, each in change.items()
    }
    _say_columns(title, {"approach / µm": 1e6 * states.approaches, "load / N": load} | told)
    columns = {"approach [m]": states.approaches, "load [N]": load}
    for name, (unit, values) in states.quantities.items():
        rough, smooth = values.mean(axis=1)
        columns |= {f"rough {name} [{unit}]": rough, f"smooth {name} [{unit}]": smooth}
        columns |= {f"ratio of {name} [1]": change[name][0], f"scatter of {name} [1]": change[name][1]}
    for group in (STIFFNESSES, CREEPS):
        marks: list[Mark] = []
        for name, colour in zip(group, (BLUE, VERMILLION, GREEN, MUTED), strict=False):
            mean, scatter = change[name]
            marks.append(Area(load, mean - scatter, mean + scatter, "", colour, 0.2))
            marks.append(Line(load, mean, name, colour))
        axes = Axis("load / N", log=True), Axis("rough over smooth")
        panels.append(Panel(*axes, tuple(marks), beside=bool(panels)))
    return title, columns, Chart(tuple(panels))


def _say_columns(title: str, columns: Mapping[str, Any]) -> None:
    rows = zip(*columns.values(), strict=True)
    cells = [[each if isinstance(each, str) else f"{each:.4g}" for each in row] for row in rows]
    say_table(title, [*columns], cells, width=120)


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
