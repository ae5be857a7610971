"""``asperity creep``: creep of what rolls in a case, over creepage or over states, told, as CSV and drawn."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import numpy as np

from asperity.arguments import Array, real, require, whole
from asperity.case.cases import of_bodies, read_case
from asperity.cli.running import prepared_case
from asperity.contact.creep import CreepCurve, creep_curve
from asperity.contact.friction import Friction
from asperity.progress import progress_bar
from asperity.reduction.traction import TractionStates
from asperity.reporting.chart import (
    BLUE,
    GREEN,
    MUTED,
    VERMILLION,
    Area,
    Axis,
    Chart,
    Dashes,
    Line,
    Mark,
    Panel,
)
from asperity.reporting.data import engineering
from asperity.reporting.figure import write_chart, write_columns
from asperity.scenarios.scene import PreparedCase
from asperity.scenes import creep
from asperity.terminal import say, say_table
from asperity.written_numbers import count_of, rounded

NAMES = {"longitudinal": "creepage along", "lateral": "creepage across", "spin": "spin × √(ab)"}
MOST_POINTS = 1000
Scattered = Mapping[str, tuple[Array, Array | None]]
"""Means over samples, and their standard deviations where there are several."""
Told = tuple[str, dict[str, Array], Chart]
"""Title, columns of the table, and chart."""


def show_creep(
    case: Path,
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
    source = str(case)
    prepared = cast(PreparedCase, prepared_case(of_bodies(read_case(case), "creep"), source))
    with progress_bar() as progress:
        if states:
            found = _told_states(creep.states_of(prepared, count, progress), source)
        else:
            law = creep.friction_of(prepared.case) if friction is None else Friction(friction)
            rolling, smooth = creep.smooth_with_friction(prepared, law)
            curve = creep_curve(
                rolling, smooth, prepared.shape.semi_axes, direction or "longitudinal", count=count,
                samples=creep.rough_strips(prepared), speed=prepared.case.speed, progress=progress,
            )  # fmt: skip
            found = _told_curve(curve, smooth.force, source)
    title, columns, chart = found
    if table is not None:
        write_columns(columns, table)
        say(f"Table: {table.resolve()}")
    if picture is not None:
        write_chart(chart, title, picture)
        say(f"Picture: {picture.resolve()}")


def _told_curve(curve: CreepCurve, load: float, source: str) -> Told:
    """Forces over what friction carries; of rough samples their mean."""
    limit = curve.limit
    name = NAMES[curve.direction]
    slope, *rough = curve.slopes
    title = f"{source}: {engineering(load, 'N')}, friction {rounded(limit / load, 4)}, {curve.direction}"
    smooth = curve.force[0] / limit
    samples = curve.force[1:] / limit
    drawn: dict[str, tuple[Array, Array | None]] = {"smooth": (smooth, None)}
    words = f"At the smallest {name} the smooth contact has {slope:.4f} of Kalker's linear force"
    if rough:
        drawn["rough"] = samples.mean(axis=0), samples.std(axis=0)
        words += (
            f", the rough {np.mean(rough):.4f} (± {rounded(np.std(rough), 2)} over "
            f"{count_of(len(rough), 'sample')})"
        )
    drawn |= {"linear theory": (curve.linear / limit, None), "FASTSIM": (curve.fastsim / limit, None)}
    columns = {name: curve.creepage}
    for label, (mean, scatter) in drawn.items():
        columns |= {label: mean} | ({} if scatter is None else {"its scatter": scatter})
    columns["share that slips"] = curve.slip_share[0]
    _say_columns(f"{title}: creep force over friction", columns)
    say(f"{words}.")
    axes = Axis(name, 0.0, float(curve.creepage[-1])), Axis("creep force over friction", 0.0, 1.05)
    begun = {
        each: (_from_zero(mean), None if scatter is None else _from_zero(scatter))
        for each, (mean, scatter) in drawn.items()
    }
    return title, columns, Chart((_panel(*axes, _from_zero(curve.creepage), begun),))


def _from_zero(values: Array) -> Array:
    """Values of a curve with its origin: what does not creep has no creep force."""
    return np.concatenate([[0.0], values])


def _told_states(states: TractionStates, source: str) -> Told:
    """Rough over smooth under the same load in words, the functions themselves as columns."""
    load = states.load.mean(axis=0)
    change = states.change
    title = f"{source}: rough contact over smooth under the same load, {count_of(len(states.load), 'sample')}"
    told = {
        name: [f"{m:.3f} ± {rounded(s, 2)}" if m == m else "short sample" for m, s in zip(*each, strict=True)]
        for name, each in change.items()
    }
    _say_columns(title, {"approach / µm": 1e6 * states.approaches, "load / N": load} | told)
    columns = {"approach [m]": states.approaches, "load [N]": load}
    for name, (unit, values) in states.quantities.items():
        rough, smooth = values.mean(axis=1)
        columns |= {f"rough {name} [{unit}]": rough, f"smooth {name} [{unit}]": smooth}
        columns |= {f"ratio of {name} [1]": change[name][0], f"scatter of {name} [1]": change[name][1]}
    axes = Axis("load / N", log=True), Axis("rough over smooth")
    creeps = {name: each for name, each in change.items() if name.endswith("creep")}
    stiffnesses = {name: each for name, each in change.items() if name not in creeps}
    first, second = (_panel(*axes, load, drawn) for drawn in (stiffnesses, creeps))
    return title, columns, Chart((first, replace(second, beside=True)))


def _say_columns(title: str, columns: Mapping[str, Any]) -> None:
    rows = zip(*columns.values(), strict=True)
    cells = [[each if isinstance(each, str) else rounded(each, 4) for each in row] for row in rows]
    say_table(title, [*columns], cells, width=120)


LOOKS: tuple[tuple[str, Dashes], ...] = (
    (BLUE, ()),
    (VERMILLION, (6.0, 1.5)),
    (GREEN, (1.5, 1.5)),
    (MUTED, (6.0, 1.5, 1.5, 1.5)),
)
"""Colours and dashes of curves, the smooth contact first."""


def _panel(across: Axis, up: Axis, x: Array, drawn: Scattered) -> Panel:
    """A panel of curves over x, with their scatter."""
    marks: list[Mark] = []
    for (name, (mean, scatter)), (colour, dashes) in zip(drawn.items(), LOOKS, strict=False):
        if scatter is not None:
            marks.append(Area(x, mean - scatter, mean + scatter, "", colour, 0.2))
        marks.append(Line(x, mean, name, colour, dashes))
    return Panel(across, up, tuple(marks))
