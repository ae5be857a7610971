"""Textures of wheel and rail: measured lines and maps, spectra, defects, laid out along the path."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import replace
from typing import cast

import numpy as np
from numpy.typing import NDArray

from asperity.config.case import Case
from asperity.config.content import name_of
from asperity.config.tables import TableSource, read_levels
from asperity.errors import (
    InputError,
    MissingPointsWarning,
    OutOfRangeWarning,
    ShortRecordWarning,
    TruncatedContactWarning,
)
from asperity.kinds.wheel_on_rail.case import WheelOnRail
from asperity.kinds.wheel_on_rail.defects import corrugated, defects
from asperity.kinds.wheel_on_rail.surface_keys import MeasuredLines, RailSurface
from asperity.kinds.wheel_on_rail.wheel_keys import WheelCase
from asperity.laws import spec_of
from asperity.reference import cnossos
from asperity.scenarios.geometry import Geometry, cells_over, window_cells
from asperity.scenarios.records import (
    Grid,
    Record,
    long_spectrum_strip,
    read_lines,
    spectrum_levels,
    spectrum_strip,
)
from asperity.scenarios.textures import (
    Textures,
    cut_from,
    direction_words,
    measured_maps,
    middle_line,
    path_of,
    strip_rows,
    strips_of,
    synthesised,
    synthesised_path,
)
from asperity.scenes.textures import warn_of_start
from asperity.surfaces.bands import check_levels
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.levelling import level, resample
from asperity.surfaces.measured_lines import (
    Processing,
    bring_into_register,
    common_length,
    lines_of,
    process,
    strip_from_lines,
)
from asperity.surfaces.strip import LongStrip, Raised, Rows, raised, turning
from asperity.surfaces.synthesis import Continuation, close, extend

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


SAMPLED_LENGTH = 5.0
"""Samples of a synthesised rail are cut from so much of it at least, from where the record starts, m."""


def textures_of(case: WheelOnRail) -> Textures:
    """Read or synthesise all textures of a case: what rail and wheel bear together, m from a sleeper.

    Heights of wheel and rail add up; the wheel's repeat with its circumference, rounded to whole cells.
    Samples and strips are cut from the path, before defects are put on it, unless [surface] names samples and
    the wheel is smooth. A synthesised rail is the same track at every speed, and so are its samples.
    """
    contact, margin = case.contact, window_cells(case.contact)
    before = margin + cells_over(case.speed * case.settling, contact.spacing)
    rows = before + cells_over(case.speed * case.duration, contact.spacing) + 1 + margin
    grid = Grid(rows, margin, contact.spacing)
    seeds = [int(s) for s in np.random.SeedSequence(case.seed).generate_state(contact.samples + 3)]
    maps, strips, missing, sampled = _samples(case, seeds[3:])
    rail = _rail(case, grid, maps, seeds[0], before)
    turn = _wheel(case, grid, seeds[1])
    wheel = turn.heights
    rough = turning(rail.strip, wheel, -before)
    if not maps or wheel.any():
        maps = strips = _cut(case, rough, before)
        sampled = f"{len(strips)} samples cut from the path"
    on_rail = corrugated(case, rows, seeds[2])
    middle = margin // 2
    parts = {
        "rail": middle_line(rail.strip) + on_rail,
        "wheel": wheel[(np.arange(rows) - before) % len(wheel), middle],
    }
    start = case.start - before * contact.spacing
    at = start + contact.spacing * np.arange(rows, dtype=np.float64)
    geometry, trajectory = defects(case, at, len(wheel))
    lines = {name: body.lines for name, body in (("rail", rail), ("wheel", turn)) if body.lines}
    return Textures(
        maps,
        strips,
        raised(rough, on_rail) if on_rail.any() else rough,
        parts["rail"] + parts["wheel"],
        start,
        before,
        margin,
        missing,
        "; ".join(filter(None, [f"rail: {rail.origin}", f"wheel: {turn.origin}", sampled])),
        parts,
        geometry,
        trajectory,
        areal=(rail.areal or turn.areal) and not lines,
        lines=lines,
    )


def _samples(
    case: WheelOnRail, seeds: list[int]
) -> tuple[tuple[HeightMap, ...], tuple[HeightMap, ...], float, str]:
    """Samples and strips that the surface section names; none where they are to be cut from the path."""
    surface, contact = case.surface, case.contact
    if surface.file is not None:
        maps, missing = measured_maps(surface, contact.spacing)
        strips, origin = strips_of(maps, contact, seeds)
        measured = f"{len(maps)} samples measured, {name_of(surface.file)}"
        return maps, strips, missing, f"{measured}{direction_words(surface, maps)}; {origin}"
    if surface.rms is not None:
        shape = (strip_rows(contact), window_cells(contact))
        strips = tuple(synthesised(surface, contact.spacing, shape, seed) for seed in seeds)
        return strips, strips, 0.0, "samples synthesised like the rail"
    return (), (), 0.0, ""


def _cut(case: WheelOnRail, rough: Raised, before: int) -> tuple[HeightMap, ...]:
    """Cut samples from the path; of a synthesised rail from a stretch that does not depend on the speed."""
    contact, strip = case.contact, rough.strip
    if not isinstance(strip, LongStrip) or case.surface.spectrum is None:
        return cut_from(rough, contact, case.duration)
    rows = max(math.ceil(SAMPLED_LENGTH / contact.spacing), contact.samples * strip_rows(contact))
    longer = replace(rough, strip=replace(strip, shape=(before + rows, strip.shape[1])))
    return cut_from(longer, contact, case.duration, first=before)


def _rail(case: WheelOnRail, grid: Grid, maps: tuple[HeightMap, ...], seed: int, before: int) -> Record:
    """Texture of the rail; the record starts behind so many rows `before`."""
    surface, shape = case.surface, (grid.rows, grid.lines)
    if surface.spectrum is not None:
        wavelength, levels, name = spectrum_levels(surface.spectrum)
        levels, lateral = levels + surface.level, surface.lateral
        made = long_spectrum_strip(
            wavelength, levels, grid, lateral=lateral, seed=seed, name=name, before=before
        )
        return replace(made, origin=f"{made.origin}, {surface.level:+g} dB")
    if surface.line is not None:
        return rail_lines(surface, grid)
    if surface.rms is not None:
        path = synthesised_path(surface, grid.spacing, shape, seed, before)
        return Record(path, "self-affine, Gaussian")
    if maps:
        return Record(*path_of(maps, shape, seed, 0, before, surface.continuation))
    return Record(Rows(np.zeros(shape)), "smooth", areal=False)


def _wheel(case: WheelOnRail, grid: Grid, seed: int) -> Record:
    """One turn of the wheel, closed on itself; row 0 touches the rail where the record starts."""
    wheel = case.wheel
    turn = Grid(round(wheel.circumference / grid.spacing), grid.lines, grid.spacing)
    if wheel.roughness is not None:
        wavelength, levels, name = _wheel_levels(wheel.roughness)
        levels = levels + wheel.roughness_level
        lateral = case.surface.lateral
        strip = spectrum_strip(wavelength, levels, turn, lateral=lateral, seed=seed, name=name)
        return replace(strip, origin=f"{strip.origin}, {wheel.roughness_level:+g} dB")
    if wheel.line is not None:
        return wheel_lines(wheel, turn, check=not case.surface.accept_levels)
    return Record(Rows(np.zeros((turn.rows, turn.lines))), "smooth", areal=False)


def _wheel_levels(roughness: str | TableSource) -> tuple[NDArray[np.float64], NDArray[np.float64], str]:
    """Band levels of a wheel, by name or from a table: wavelengths, m, levels, dB re 1 µm, and a name."""
    if not isinstance(roughness, str):
        return *read_levels(roughness), name_of(roughness)
    return *cnossos.wheel_roughness(roughness), roughness


def warn_of(case: WheelOnRail, shape: Geometry, textures: Textures) -> None:
    """Warn of a record that holds the start, and of a window too short for what a law sees of a defect."""
    warn_of_start(case, "set settling")
    if textures.defects is not None:
        warn_of_defects(case, shape, case.wheel.flat)


def warn_of_defects(case: Case, shape: Geometry, flat: tuple[float, float] | None) -> None:
    """Warn of laws that do not see the shape of a defect, and of a window too short for a flat.

    Depth and length of the flat, m, if there is one.
    """
    seen = [law for law in case.laws if spec_of(law).sees_heights]
    if case.laws[0] not in seen:
        warnings.warn(
            f"{case.laws[0]} follows the path of the wheel's centre over a flat or a joint, not their shape: "
            "peaks of the force come out up to a quarter too high, and levels above 1.6 kHz up to 6 dB. Take "
            "direct, or table, as the first law.",
            OutOfRangeWarning,
            stacklevel=2,
        )
    if not seen or flat is None:
        return
    _, length = flat
    window, a = case.contact.window, shape.semi_axes[0]
    if length + 2 * a > window:
        warnings.warn(
            f"the flat is {length * 1e3:.3g} mm long and the contact {2e3 * a:.3g} mm, together more than "
            f"contact.window = {window * 1e3:.3g} mm: where the wheel stands on the flat's ends, "
            f"{' and '.join(seen)} cut the contact off. Enlarge the window.",
            TruncatedContactWarning,
            stacklevel=2,
        )
