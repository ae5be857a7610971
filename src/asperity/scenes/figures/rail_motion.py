"""Figures of motion: wheel and rail at the contact, and the rail at the points that the wheel passes."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.axes import levels_axis
from asperity.reporting.chart import INK, Axis, Chart, Line, Panel, Rules
from asperity.reporting.data import laws, number, of_law, present, stored_variable, values
from asperity.reporting.force_figures import (
    DRAWN,
    beyond_limits,
    frequency_range,
    main_last,
    main_limits,
    narrow_level,
    shaded_words,
    spectrum_panel,
    time_axis,
)
from asperity.reporting.law_entries import baselines_among, law_style, pulling
from asperity.reporting.part import Data, Part, Series, by_law, series
from asperity.scenes import schema
from asperity.scenes.figures.force import around_peak
from asperity.scenes.figures.marks import natural_frequencies, natural_rules, sleeper_times
from asperity.schema import Entry
from asperity.schema.rolling import CONTACT_FORCE, POSITION, RELATIVE_DISPLACEMENT, SPEED, TIME
from asperity.schema.spectra import FREQUENCY

MOTIONS = {
    schema.RAIL_DISPLACEMENT: ("rail", 1e-3, "mm"),
    schema.WHEEL_DISPLACEMENT: ("wheel", 1e-3, "mm"),
    RELATIVE_DISPLACEMENT: ("approach", 1e-6, "µm"),
}
"""What moves at the contact, and the unit it is drawn in."""
PIECE = 0.1  # s around the largest force
VELOCITY, VELOCITY_PSD = schema.POINT_VELOCITY, schema.POINT_VELOCITY_PSD
POINTS = 3
"""Passed points that are drawn, at most; the CSV files hold all."""
AROUND_PASSING = 0.15
"""Longest time before and after a passing that is drawn, s."""


def _piece(tree: DataTree) -> slice:
    if present(tree, CONTACT_FORCE):
        return around_peak(tree, PIECE)
    return slice(0, None)


def displacement_data(tree: DataTree) -> Data:
    """Displacements of each law over a piece of the run, every time step."""
    part = _piece(tree)
    named: dict[Any, Series] = {}
    if present(tree, POSITION):
        named[POSITION] = series(tree, POSITION, "position on the rail")
    for entry, (name, _, _) in MOTIONS.items():
        named |= {(entry, law): line for law, line in by_law(tree, entry, f"{name}, {{}}").items()}
    lines = {key: replace(line, values=line.values[part]) for key, line in named.items()}
    return Data(Series("time", TIME.units, values(tree, TIME)[part]), lines)


def _motions(data: Data) -> dict[Entry, dict[str, NDArray[np.float64]]]:
    """Motions that a result holds, by law."""
    return {entry: motions for entry in MOTIONS if (motions := data.of(entry))}


def displacement_chart(tree: DataTree, data: Data) -> Chart:
    """Displacement of rail and wheel at the contact and their approach, all laws, over a piece of the run."""
    time, unit = time_axis(tree, data.at)
    sleepers = sleeper_times(tree, data.at[0], data.at[-1], unit)
    panels = []
    for entry, motions in _motions(data).items():
        name, size, length = MOTIONS[entry]
        main = next(iter(motions))
        lines = [
            Line(data.at / unit, motions[law] / size, law, **law_style(tree, law, main))
            for law in main_last(motions)
        ]
        low, high = main_limits(motions, pulling(tree))
        downwards = Axis(f"{name} / {length}", high / size, low / size)
        panels.append(Panel(time, downwards, (*sleepers, *lines), height=1.75))
    return Chart(tuple(panels))


def _displaced_beyond(tree: DataTree) -> str:
    """Say which laws leave the axes."""
    words = ""
    for entry, motions in _motions(displacement_data(tree)).items():
        outside = beyond_limits(motions, main_limits(motions, pulling(tree)), "m")
        words += outside.replace("The axis suits", f"{MOTIONS[entry][0].capitalize()}: the axis suits")
    return words


def _displacement_caption(tree: DataTree) -> str:
    sleepers = " Ticks: the wheel passes a sleeper." if number(tree, schema.SLEEPER_SPACING) else ""
    return (
        "Motion at the contact around the largest force, positive downwards and drawn downwards; from the "
        "unloaded track, so that the static deflection is in. The approach of wheel and rail is positive "
        f"closing.{sleepers}{_displaced_beyond(tree)}"
    )


def point_labels(tree: DataTree) -> list[str]:
    """Positions of the passed points, with their place in the bay where it has a name."""
    bay = number(tree, schema.SLEEPER_SPACING)
    found = []
    for point in values(tree, schema.ROLLING_POINT).tolist():
        place = (point / bay) % 1 if bay else np.nan
        name = ", over a sleeper" if min(place, 1 - place) < 0.02 else ""
        name = ", mid-span" if abs(place - 0.5) < 0.02 else name
        found.append(f"x = {point:.4g} m{name}")
    return found


def _points(tree: DataTree, entry: Entry) -> list[int]:
    found = stored_variable(tree, entry)
    assert found is not None
    others = [dim for dim in found.dims if dim != "point"]
    return [int(index) for index in np.flatnonzero(found.notnull().any(others).values)]


def _around_passing(tree: DataTree, point: int) -> tuple[slice, float | None]:
    """Time steps around the wheel's passing of a point, and the time of it if the positions are known."""
    time, speed = values(tree, TIME), number(tree, SPEED)
    if not speed or not present(tree, POSITION):
        return slice(0, None), None
    passing = time[0] + (values(tree, schema.ROLLING_POINT)[point] - values(tree, POSITION)[0]) / speed
    low, high = np.searchsorted(time, [passing - AROUND_PASSING, passing + AROUND_PASSING])
    return (slice(int(low), int(high)), float(passing)) if high - low > 1 else (slice(0, None), None)


def _main_and_linear(tree: DataTree) -> list[str]:
    names = laws(tree, VELOCITY)
    return [*(name for name in baselines_among(tree, names)[:1] if name != names[0]), names[0]]


def _of_points(tree: DataTree, entry: Entry, part: slice) -> dict[Any, Series]:
    """Lines of each law and point, over a part of their last dimension."""
    labels = point_labels(tree)
    return {
        (law, point): Series(
            f"{law}, {labels[point]}", entry.units, of_law(tree, entry, law, *entry.dims[1:])[point, part]
        )
        for law in laws(tree, entry)
        for point in _points(tree, entry)
    }


def velocity_data(tree: DataTree) -> Data:
    """Velocity of the rail at all passed points by all laws, every time step of the drawn pieces together."""
    time = values(tree, TIME)
    ends = [_around_passing(tree, point)[0].indices(len(time)) for point in _points(tree, VELOCITY)]
    part = slice(min(start for start, _, _ in ends), max(stop for _, stop, _ in ends))
    return Data(Series("time", TIME.units, time[part]), _of_points(tree, VELOCITY, part))


def velocity_chart(tree: DataTree, data: Data) -> Chart:
    """Velocity of the rail at the passed points, around the passing, by the main law and by a linear one."""
    label = "time since the wheel passed / ms" if number(tree, SPEED) else "time / ms"
    panels = []
    for point in _points(tree, VELOCITY)[:POINTS]:
        part, passing = _around_passing(tree, point)
        shown = np.isin(data.at, values(tree, TIME)[part])
        time = (data.at[shown] - (passing or 0.0)) * 1e3
        lines = [
            Line(time, data.lines[law, point].values[shown] * 1e3, law, **_thin(tree, law))
            for law in _main_and_linear(tree)
        ]
        passed = [] if passing is None else [Rules(np.zeros(1), colour=INK)]
        axes = Axis(label, time[0], time[-1], linked="passing"), Axis("velocity / (mm/s)")
        panels.append(Panel(*axes, (*passed, *lines), point_labels(tree)[point], height=1.9))
    return Chart(tuple(panels))


def _thin(tree: DataTree, law: str) -> dict[str, Any]:
    """Look of a line that swings fast: dashes would not be seen."""
    return law_style(tree, law, "") | {"width": 1.0, "dashes": ()}


def _velocity_caption(tree: DataTree) -> str:
    names = " and ".join(reversed(_main_and_linear(tree)))
    around = (
        "around the time at which the wheel passes it (dotted)"
        if number(tree, SPEED)
        else "over the whole run"
    )
    return (
        f"Velocity of the rail at a fixed point, positive downwards, {around}, by {names}. "
        "The CSV file holds all laws and points."
    )


def velocity_psd_data(tree: DataTree) -> Data:
    """Power spectral density of the rail's velocity by each law at each passed point, all lines."""
    return Data(series(tree, FREQUENCY), _of_points(tree, VELOCITY_PSD, slice(None)))


def velocity_psd_chart(tree: DataTree, data: Data) -> Chart:
    """Power spectral densities of the rail's velocity at the passed points, all laws, a panel per point."""
    names, drawn = laws(tree, VELOCITY_PSD), _points(tree, VELOCITY_PSD)[:POINTS]
    levels = {
        (law, point): narrow_level(tree, data.lines[law, point].values, schema.VELOCITY_REFERENCE**2)
        for law in names
        for point in drawn
    }
    axis = levels_axis("velocity PSD / dB re (1 nm/s)²/Hz", [level for _, level in levels.values()])
    marks = natural_rules(tree, *frequency_range(tree), named=False)
    panels = []
    for point in drawn:
        lines = [Line(*levels[law, point], law, **law_style(tree, law, names[0])) for law in main_last(names)]
        panel = spectrum_panel(tree, lines, axis.label, marks)
        panels.append(replace(panel, y=axis, title=point_labels(tree)[point], height=2.8))
    return Chart(tuple(panels))


def _velocity_psd_caption(tree: DataTree) -> str:
    named = ", ".join(f"{label} {f:.0f} Hz" for label, f in natural_frequencies(tree).items())
    dotted = f" Dotted: {named}." if named else ""
    return f"Velocity of the rail at fixed points over the whole run, {DRAWN}.{dotted}{shaded_words(tree)}"


MOTION = (
    Part(
        "displacement",
        "Wheel and rail at the contact",
        (TIME, schema.RAIL_DISPLACEMENT),
        displacement_data,
        displacement_chart,
        _displacement_caption,
        tuple(MOTIONS),
    ),
    Part(
        "rail_velocity",
        "Rail velocity where the wheel passes",
        (VELOCITY, TIME, schema.ROLLING_POINT),
        velocity_data,
        velocity_chart,
        _velocity_caption,
    ),
    Part(
        "rail_velocity_psd",
        "Rail velocity against frequency",
        (VELOCITY_PSD, FREQUENCY, schema.ROLLING_POINT),
        velocity_psd_data,
        velocity_psd_chart,
        _velocity_psd_caption,
    ),
)
