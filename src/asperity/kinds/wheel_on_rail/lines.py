"""Measured lines of rail and wheel: read, processed and laid out as strips."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import cast

import numpy as np
from numpy.typing import NDArray

from asperity.config.content import name_of
from asperity.errors import InputError, MissingPointsWarning, ShortRecordWarning
from asperity.kinds.wheel_on_rail.surface_keys import MeasuredLines, RailSurface
from asperity.kinds.wheel_on_rail.wheel_keys import WheelCase
from asperity.scenarios.records import Grid, Record, read_lines
from asperity.surfaces.continuation import Continuation, close, extend
from asperity.surfaces.en15610 import Processing, process
from asperity.surfaces.heightmap import Profile
from asperity.surfaces.levelling import level, resample
from asperity.surfaces.levels import check_levels
from asperity.surfaces.parallel_lines import bring_into_register, common_length, lines_of, strip_from_lines
from asperity.surfaces.strip import Rows

FULL_TURN = 0.02
"""Share of the circumference that a measured line around a wheel may lack or exceed."""
JOIN = 10e-3
"""Length on either side over which the ends of a turn are made to meet, m."""
SAME_TEXTURE = 0.3
"""Median correlation of neighbouring lines from which they are brought into register."""


def rail_lines(surface: RailSurface, grid: Grid) -> Record:
    """Lay measured lines of a rail out along the path, m; the record begins where the run-in begins.

    Refused are a record shorter than the path that is not to be continued, and unlikely levels.
    """
    profiles, origin = _measured(surface, "surface", degree=1)
    lines = common_length([resample(profile, grid.spacing) for profile in profiles])
    if not surface.accept_levels:
        _check(lines, grid, "rail's lines")
    if lines.shape[1] < grid.rows:
        origin += f", {surface.continuation}ed"
    how = cast(Continuation, surface.continuation)
    extended = extend(lines.T, grid.rows, how, spacing=grid.spacing, what="rail's record").T
    return Record(Rows(_across(extended, surface, grid)), origin, areal=False, lines=tuple(profiles))


def wheel_lines(wheel: WheelCase, grid: Grid, *, check: bool) -> Record:
    """Lay measured lines around a wheel out as one turn that closes on itself, m.

    `grid` holds one turn of the path's grid; the rows returned are those of the record, if it is nearly as
    long. `check` says whether unlikely levels are refused. Lines that do not go round are left out, with a
    warning.
    """
    measured, origin = _measured(wheel, "wheel", degree=0)
    whole = grid.rows * grid.spacing
    profiles = [p for p in measured if len(p.heights) * p.spacing >= (1.0 - FULL_TURN) * whole]
    if not profiles:
        longest = max(len(p.heights) * p.spacing for p in measured)
        raise InputError(
            "wheel.line",
            f"{longest:.4g} m without gaps",
            f"a full turn of wheel.radius, {whole:.4g} m, or up to {100 * FULL_TURN:g} % less",
            "Does wheel.radius fit the wheel that was measured?",
        )
    if len(profiles) < len(measured):
        warnings.warn(
            f"{len(measured) - len(profiles)} of {len(measured)} lines of the wheel are shorter than its "
            "circumference and left out: the others move together across. Measure them again.",
            ShortRecordWarning,
            stacklevel=2,
        )
    found = bring_into_register(profiles)
    lines = found.lines
    if len(lines) > 1 and np.median(found.correlations[1:]) > SAME_TEXTURE:
        moved = sum(bool(s) or r for s, r in zip(found.shifts, found.reversed, strict=True))
        origin += f", {moved} brought into register ({sum(found.reversed)} turned round)"
    else:
        lines = common_length(profiles)
    spacing = profiles[0].spacing
    if lines.shape[1] * spacing > (1.0 + FULL_TURN) * whole:
        lines = lines[:, : round(whole / spacing)]
    fine = np.array([resample(Profile(line, spacing), grid.spacing).heights for line in lines])
    if check:
        _check(fine, grid, "wheel's lines")
    heights = _across(close(fine.T, round(JOIN / grid.spacing)).T, wheel, grid)
    return Record(Rows(heights), origin, areal=False, lines=tuple(profiles))


def _measured(section: MeasuredLines, name: str, *, degree: int) -> tuple[list[Profile], str]:
    """Complete lines of a file, processed as the section says, and what was done.

    A line that goes round keeps its slope: it has none, but what noise gives it.
    """
    assert section.line is not None
    with warnings.catch_warnings():
        # ends are trimmed and gaps refused below
        warnings.simplefilter("ignore", MissingPointsWarning)
        measured = read_lines(section, name)
    raw = (measured,) if isinstance(measured, Profile) else lines_of(measured)
    if len(raw) > 1 and section.line_distance is None:
        raise InputError(
            f"{name}.line_distance",
            f"no distance for {len(raw)} lines",
            "the distance across between neighbouring lines",
            'Add line_distance = "5 mm", say.',
        )
    steps = {step: step in section.processing for step in ("spikes", "curvature")}
    done = [process(line, fill_gaps="fill" in section.processing, **steps) for line in raw]
    return [
        level(line, degree) for line, _ in done
    ], f"{name_of(section.line)}, {_done([how for _, how in done])}"


def _done(steps: Sequence[Processing]) -> str:
    """What processing did to all lines together."""
    together = Processing(
        trimmed=(sum(s.trimmed[0] for s in steps), sum(s.trimmed[1] for s in steps)),
        fill=steps[0].fill,
        filled=sum(s.filled for s in steps),
        spikes=steps[0].spikes,
        spikes_removed=sum(s.spikes_removed for s in steps),
        spike_points=sum(s.spike_points for s in steps),
        curvature=steps[0].curvature,
        radius=steps[0].radius,
        lifted=sum(s.lifted for s in steps) / len(steps),
        largest_lift=max(s.largest_lift for s in steps),
    )
    return f"{len(steps)} line{'s' if len(steps) > 1 else ''} measured, {together}"


def _check(lines: NDArray[np.float64], grid: Grid, what: str) -> None:
    check_levels([Profile(line, grid.spacing) for line in lines], what)


def _across(lines: NDArray[np.float64], section: MeasuredLines, grid: Grid) -> NDArray[np.float64]:
    distance = section.line_distance or grid.spacing
    return strip_from_lines(lines, grid.spacing, distance, grid.lines, grid.spacing)
