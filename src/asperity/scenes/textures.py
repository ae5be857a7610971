"""The textures of a path: a measured map or line, or synthesised."""

from __future__ import annotations

import math
import warnings
from dataclasses import replace
from typing import cast

import numpy as np
from numpy.typing import NDArray

from asperity.config.case import SETTLED, Case
from asperity.config.content import name_of
from asperity.errors import InputError, ShortRecordWarning
from asperity.scenarios.geometry import Geometry, cells_over, window_cells
from asperity.scenarios.laws import OwnContact
from asperity.scenarios.records import Grid, Record, read_lines, spectrum_levels, spectrum_strip
from asperity.scenarios.textures import (
    Textures,
    cut_from,
    direction_words,
    measured_maps,
    middle_line,
    mirrored_before,
    mirrored_words,
    path_of,
    strip_rows,
    strips_of,
    synthesised,
    synthesised_path,
)
from asperity.spectra import HALF_BAND
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.levelling import level, resample
from asperity.surfaces.strip import Strip
from asperity.surfaces.synthesis import Continuation, extend, from_bands


def textures_of(case: Case) -> Textures:
    """Gather the textures of a case, with a window before and beyond the path."""
    return gather(case, window_cells(case.contact))


def warn_of(case: Case, shape: Geometry, textures: Textures) -> None:
    """Warn of what is doubtful before anything is computed."""
    warn_of_start(case, "shorten the duration or start farther along the path")


def warn_of_start(case: Case, remedy: str) -> None:
    """Warn of a record that holds the start from rest; `remedy` is how to make room for a run-in."""
    settling = case.settled_time
    if settling < SETTLED * (1 - 1e-9):
        warnings.warn(
            f"the record starts {settling * 1e3:.3g} ms after rest, less than {SETTLED * 1e3:.3g} ms: its "
            f"levels hold the start. So that there is time for settling, {remedy}.",
            ShortRecordWarning,
            stacklevel=3,
        )


def contacts_of(case: Case, loads: NDArray[np.float64]) -> tuple[list[int], list[OwnContact]]:
    """All contacts roll by the laws of the first."""
    return [0] * len(loads), []


def gather(case: Case, margin: int, ahead: float = 0.0) -> Textures:
    """Read or synthesise all textures of a case, with `margin` rows before the path and beyond its end.

    The path reaches farther than the position of the case by what its contacts are `ahead` of it, m.
    """
    seeds = [int(s) for s in np.random.SeedSequence(case.seed).generate_state(case.contact.samples + 1)]
    ny, spacing = window_cells(case.contact), case.contact.spacing
    lead = cells_over(case.settled_time * case.speed, spacing)
    rows = lead + cells_over(case.rolled_time * case.speed + ahead, spacing) + 1 + 2 * margin
    missing, origin, areal = 0.0, "", True
    maps: tuple[HeightMap, ...] = ()
    strips: tuple[HeightMap, ...] = ()
    path: Strip | None = None
    if case.surface.file is not None:
        maps, missing = measured_maps(case.surface, spacing)
        strips, strip_origin = strips_of(maps, case.contact, seeds[1:])
        how = case.surface.continuation
        path, path_origin = path_of(maps, (rows, ny), seeds[0], lead, margin + lead, how)
        measured = f"{len(maps)} measured from {name_of(case.surface.file)}"
        measured += direction_words(case.surface, maps)
        origin = f"{measured}; {strip_origin}; {path_origin}"
    elif case.surface.rms is not None:
        size = (strip_rows(case.contact), ny)
        strips = tuple(synthesised(case.surface, spacing, size, seed) for seed in seeds[1:])
        maps = strips
        path = synthesised_path(case.surface, spacing, (rows, ny), seeds[0], margin + lead)
        origin = "samples and path synthesised: self-affine, Gaussian"
    elif case.surface.has_areal_spectrum:
        record = _strip(case, Grid(rows, ny, spacing), seeds[0])
        path = HeightMap(record.strip.rows(0, rows), (spacing, spacing))
        maps = strips = cut_from(path, case.contact, case.rolled_time)
        origin = f"path of {record.origin}; {len(strips)} samples cut from it"
        areal = record.areal
    if case.surface.has_line:
        line, line_origin = _line(case, rows - lead, 2 * margin + 2, lead, seeds[0])
        path, origin = None, "; ".join(filter(None, [origin, line_origin]))
    elif path is not None:
        line = middle_line(path)
    before = margin + lead
    start = case.record_start - before * spacing
    return Textures(maps, strips, path, line, start, before, margin, missing, origin, areal=areal)


def _strip(case: Case, grid: Grid, seed: int) -> Record:
    """Strip that closes on itself, of the areal spectrum: longer than the path and than the longest band."""
    surface = case.surface
    assert surface.spectrum is not None
    assert surface.lateral is not None
    wavelengths, levels, name = spectrum_levels(surface.spectrum)
    rows = max(grid.rows, math.ceil(1.2 * wavelengths.max() / grid.spacing))
    longer = Grid(rows, grid.lines, grid.spacing)
    record = spectrum_strip(
        wavelengths, levels + surface.level, longer, lateral=surface.lateral, seed=seed, name=name
    )
    return replace(record, origin=f"{record.origin}, {surface.level:+g} dB")


def _line(case: Case, rows: int, least: int, lead: int, seed: int) -> tuple[NDArray[np.float64], str]:
    """Line of the path: `lead` points for the run-in, then `rows`, at least `least`, for the record."""
    spacing = case.contact.spacing
    if case.surface.spectrum is not None:
        table, every, name = spectrum_levels(case.surface.spectrum)
        fits = table / HALF_BAND > 2.06 * spacing  # as on a rail: bands that the grid can hold
        wavelengths, levels = table[fits], every[fits]
        # a line that closes on itself: longer than the path and than the longest band
        points = max(rows + lead, math.ceil(1.2 * wavelengths.max() / spacing))
        profile = from_bands(points, spacing, wavelengths, levels + case.surface.level, seed)
        return profile.heights[: rows + lead], f"path of {name}, {case.surface.level:+g} dB"
    assert case.surface.line is not None
    measured = read_lines(case.surface, "surface")
    if not isinstance(measured, Profile):
        remedy = "Give a map as surface.file."
        raise InputError("surface.line", "a map of heights", "a line of heights", remedy)
    if measured.missing_share > 0.0:
        raise InputError(
            "surface.line", "points without a height", "a complete line", "Interpolate them in the file."
        )
    profile = level(resample(level(measured), spacing))
    length = profile.heights.size * spacing
    how = case.surface.continuation
    if how is not None and profile.heights.size < rows:
        origin = f"path measured, {name_of(case.surface.line)}, {how}ed"
        fade = min(least, profile.heights.size) // 2 if how == "repeat" else 0
        kind = cast(Continuation, how)
        line = extend(profile.heights, rows + lead, kind, spacing=spacing, start=-lead, crossfade=fade)
        return line, origin
    if case.duration is None:
        rows = min(rows, profile.heights.size)  # the run lasts as long as the line
    if profile.heights.size < rows or rows < least:
        raise InputError(
            "surface.line",
            f"{length:.4g} m",
            f"at least {max(rows, least) * spacing:.4g} m: the path and a window at both ends",
            "Give a shorter duration, a longer line, or surface.continuation.",
        )
    held = profile.heights[: rows + lead]
    margin = 1e3 * spacing * ((least - 2) // 2)
    origin = (
        f"path measured, {name_of(case.surface.line)}, from {margin:.4g} mm before the record on"
        f"{mirrored_words(held, rows + lead)}"
    )
    return mirrored_before(held, rows + lead), origin


def recorded_time(case: Case, textures: Textures) -> float:
    """Time of the record, s: that of the case, or until its line ends."""
    pace = case.contact.spacing / case.speed
    return min(case.rolled_time, (len(textures.line[textures.recorded]) - 1) * pace)
