"""Textures of one body along a path: maps and lines read from files, and strips from band levels."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import cast

import numpy as np

from asperity.arguments import Array, require
from asperity.case import body, in_memory
from asperity.case.across import complete
from asperity.case.surface import MAP_KEYS, MeasuredLine, Surface, read_recipe
from asperity.case.tables import TableSource, read_levels
from asperity.errors import InputError, MissingPointsWarning, ShortRecordWarning, percent
from asperity.reference import cnossos
from asperity.spectra import HALF_BAND, nominal_length
from asperity.surfaces import measured_lines, synthesis
from asperity.surfaces.bands import SAMPLES, strip_from_bands
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.levelling import band_limit, level, resample
from asperity.surfaces.readers import read_all, read_surface
from asperity.surfaces.readers.belief import larger_reading, told_length
from asperity.surfaces.readers.hints import in_case, spelled
from asperity.surfaces.rotation import QUARTER, rotated
from asperity.surfaces.strip import Rows, Strip
from asperity.written_numbers import count_of, rounded

MOST_POINTS = 2.0**27
"""Points of a measured map on the contact grid (1 GiB)."""
FULL_TURN = 0.02
"""Share of the circumference that a measured line around what rolls may lack or exceed."""
JOIN = 10e-3
"""Length on either side over which the ends of a turn are made to meet, m."""
SAME_TEXTURE = 0.3
"""Median correlation of neighbouring lines from which they are brought into register."""


@dataclass(frozen=True)
class Grid:
    """Where strips of texture are wanted."""

    rows: int  # points along
    lines: int  # points across
    spacing: float  # in both directions, m

    @property
    def length(self) -> float:
        """Length of the strip, m."""
        return self.rows * self.spacing


@dataclass(frozen=True, eq=False)
class Record:
    """Texture of one body along the path."""

    strip: Strip  # (rows, lines), peaks positive; one line where nothing is known beside it
    origin: str  # where it comes from
    areal: bool = True  # whether heights beside a line are a texture of their own, not carried over from it
    # measured lines that heights are interpolated between, m; none of an areal texture
    lines: tuple[Profile, ...] = ()
    draw: str = ""  # what random numbers belong to; nothing of what is measured

    @property
    def heights(self) -> Array:
        """All heights, m, shape (rows, lines)."""
        return self.strip.rows(0, self.strip.shape[0])


# --- band levels


def spectrum_record(
    spectrum: str | TableSource, level_db: float, grid: Grid, *, lateral: float, seed: int, before: int
) -> Record:
    """Synthesise a strip of a spectrum by name or from a table, of any length, made where it is read.

    With a level added, dB; `lateral` is its correlation length across over that along. From row `before` on,
    and before it, it is the same however long the strip is, on whatever grid; bands that the grid cannot hold
    are left out.
    """
    wavelength, levels, name = spectrum_levels(spectrum)
    words = _in_words(wavelength, level_db, grid, name)
    strip = synthesis.long_strip_from_bands(
        (grid.rows, grid.lines), (grid.spacing, grid.spacing), wavelength, levels + level_db,
        lateral=lateral, seed=seed, before=before,
    )  # fmt: skip
    return Record(strip, words, areal=bool(np.isfinite(lateral)), draw=strip.draw)


def spectrum_around(
    spectrum: str | TableSource, level_db: float, grid: Grid, around: float, *, lateral: float, seed: int
) -> Record:
    """Synthesise one turn of a spectrum as `spectrum_record` does, closed on the length `around`, m.

    Bands that the turn cannot hold are left out.
    """
    wavelength, levels, name = spectrum_levels(spectrum)
    held = wavelength * HALF_BAND < 0.97 * around
    words = _in_words(wavelength[held], level_db, grid, name)
    strip = strip_from_bands(
        (grid.rows, grid.lines), (grid.spacing, grid.spacing), wavelength[held], levels[held] + level_db,
        lateral=lateral, seed=seed, around=around,
    )  # fmt: skip
    draw = f"bands around {around:.6g} m, seed {seed}"
    return Record(strip, words, areal=bool(np.isfinite(lateral)), draw=draw)


def _in_words(wavelength: Array, level_db: float, grid: Grid, name: str) -> str:
    """Say which bands a spacing holds."""
    held = wavelength[wavelength / HALF_BAND > SAMPLES * grid.spacing]
    if not held.size:
        waves = ""
        if wavelength.size:
            waves = f" of {told_length(wavelength.min())} to {told_length(wavelength.max())}"
        least = told_length(SAMPLES * grid.spacing)
        path = f"{told_length(grid.length)}, points {told_length(grid.spacing)} apart"
        received = f"bands of waves{waves} for a path of {path}"
        allowed = f"a band of waves longer than {least}"
        remedy = "Is the unit of the wavelengths right? If it is, take a finer contact.spacing."
        raise InputError(name, received, allowed, remedy)
    return f"{name}, bands of {nominal_length(held.max())} to {nominal_length(held.min())}, {level_db:+g} dB"


def spectrum_levels(spectrum: str | TableSource) -> tuple[Array, Array, str]:
    """Band levels of a texture, by name or from a table: wavelengths, m, levels, dB re 1 µm, and a name."""
    if not isinstance(spectrum, str):
        return *read_levels(spectrum), in_memory.name_of(spectrum)
    if spectrum in cnossos.WHEEL_ROUGHNESS:
        return *cnossos.wheel_roughness(spectrum), spectrum
    return *cnossos.rail_roughness(spectrum), spectrum


# --- measured maps

_LINE_KEYS = {"array": "line_array", "height_unit": "line_unit", "pixel": "line_spacing"}


def read_maps(surface: Surface) -> Sequence[HeightMap | Profile]:
    """Read the map, or all maps of an ensemble, that the surface section names, as they lie in the file."""
    assert surface.file is not None
    if not isinstance(surface.file, Path):
        maps = surface.file if isinstance(surface.file, tuple) else (surface.file,)
        if surface.index is not None:
            allowed = f"0 to {len(maps) - 1}, of the maps in memory"
            require(surface.index < len(maps), "surface.index", surface.index, allowed)
            maps = (maps[surface.index],)
        maps = tuple(each.without_spikes() for each in maps) if surface.spikes else maps
        return [each.filled() if surface.fill else each for each in maps]
    if surface.recipe is not None:
        return read_recipe(surface.recipe).surfaces(surface.file)
    with spelled(in_case("surface", MAP_KEYS)):
        return read_all(surface.file, **{name: getattr(surface, name) for name in MAP_KEYS})


def measured_maps(surface: Surface, spacing: float) -> tuple[tuple[HeightMap, ...], float]:
    """Read the maps of a case's file, complete, levelled and on the contact grid of a spacing, m.

    With the share of points that had no height in the file.
    """
    read = read_maps(surface)
    maps = []
    for measured in read:
        if not isinstance(measured, HeightMap):
            remedy = "A single line can be the path: give it as surface.line."
            raise InputError("surface.file", "a line of heights", "maps of heights", remedy)
        received = f"{percent(measured.missing_share)} of the points without a height"
        complete = measured.missing_share == 0.0
        require(complete, "surface.file", received, "complete maps", "Set fill = true in [surface].")
        points = math.prod(measured.size) / spacing**2
        if points > MOST_POINTS:
            sides = " × ".join(f"{1e3 * side:.4g} mm" for side in measured.size)
            received = (
                f"maps of {sides}, {rounded(points, 2)} points at contact.spacing = "
                f"{rounded(spacing * 1e6)} um"
            )
            remedy = "Is the pixel in µm, not mm? Else cut the map, or coarsen contact.spacing."
            raise InputError("surface.file", received, f"at most {rounded(MOST_POINTS, 2)} points", remedy)
        if min(measured.size) < 2.0 * spacing:
            received = "a map of " + " × ".join(map(told_length, measured.size))
            allowed = f"two points or more at contact.spacing = {rounded(spacing * 1e6)} um along each side"
            with spelled(in_case("surface", MAP_KEYS)):
                remedy = larger_reading(measured) or "Measure a larger one, or refine contact.spacing."
            raise InputError("surface.file", received, allowed, remedy)
        if max(measured.spacing) > spacing * (1 + 1e-9):
            ShortRecordWarning.warn(
                f"the map's points are {rounded(max(measured.spacing) * 1e6)} µm apart, more than "
                f"contact.spacing = {rounded(spacing * 1e6)} µm: shorter waves are missing. Coarsen "
                "contact.spacing."
            )
        levelled = level(measured, surface.form)
        if surface.direction % QUARTER:  # no wave that the spacing holds suffers from turning
            levelled = resample(levelled, 0.5 * spacing)
        on_grid = level(resample(rotated(levelled, surface.direction), spacing), surface.form)
        band = {"longest": surface.longest, "shortest": surface.shortest}
        maps.append(on_grid if band["longest"] is band["shortest"] is None else band_limit(on_grid, **band))
    return tuple(maps), float(np.mean([measured.missing_share for measured in read]))


# --- measured lines


def read_lines(section: MeasuredLine, name: str) -> HeightMap | Profile:
    """Read the measured line, or lines side by side, that a section of a name has.

    Lines side by side are a map; the distance across is not known to it.
    """
    assert section.line is not None
    if not isinstance(section.line, Path):
        return section.line
    hints = {hint: getattr(section, key) for hint, key in _LINE_KEYS.items()}
    with spelled(in_case(name, _LINE_KEYS)):
        return read_surface(section.line, **hints)


def single_line(surface: Surface, grid: Grid, lead: int, least: int, *, may_shorten: bool) -> Record:
    """Lay a measured line out for a record of `grid.rows` points behind `lead` points of a run-in.

    The record takes at least so many points; a shorter line ends the record where it `may_shorten`.
    """
    measured = read_lines(surface, "surface")
    if not isinstance(measured, Profile):
        remedy = "Give a map as surface.file, or the distance of the lines as surface.line_distance."
        raise InputError("surface.line", "a map of heights", "a line of heights", remedy)
    if surface.processing:
        (measured,), _ = processed(surface, "surface", degree=1)
    complete(measured, "surface.line")
    spacing = grid.spacing
    rows = grid.rows
    line = level(resample(level(measured), spacing)).heights
    continued = surface.continuation in ("mirror", "repeat") and line.size < rows
    if may_shorten and not continued:
        rows = min(rows, line.size)
    if not continued and (line.size < rows or rows < least):
        needed = f"{max(rows, least) * spacing:.4g} m: the path and a window at both ends"
        remedy = "Give a shorter duration, a longer line, or surface.continuation."
        raise InputError("surface.line", f"{line.size * spacing:.4g} m", f"at least {needed}", remedy)
    laid, how = behind_run_in(line, rows + lead, lead, surface.continuation, min(least, line.size) // 2)
    margin = 1e3 * spacing * ((least - 2) // 2)
    where = "" if continued else f", from {margin:.4g} mm before the record on"
    origin = f"measured, {in_memory.name_of(surface.line)}{where}{how}"  # type: ignore[arg-type]
    return Record(Rows(laid[:, None]), origin)


def behind_run_in(
    heights: Array, rows: int, run_in: int, continuation: str | None, fade: int
) -> tuple[Array, str]:
    """Lay a texture (n, ...) out over so many rows, the first of which are a run-in, and say how.

    Where it is long enough for all but the run-in, its mirror image stands before it, as far as it lacks
    that; else it is mirrored or repeated from behind the run-in on, closing over points to fade.
    """
    missing = rows - len(heights)
    if missing <= run_in:
        before = max(missing, 0)
        laid = synthesis.extend(heights, rows, "mirror", spacing=1.0, start=-before)
        return laid, ", its mirror image for the run-in" * bool(before)
    how = cast(synthesis.Continuation, continuation)
    fade = fade if continuation == "repeat" else 0
    return synthesis.extend(heights, rows, how, spacing=1.0, start=-run_in, crossfade=fade), f", {how}ed"


def lines_across(surface: Surface, grid: Grid) -> Record:
    """Lay measured lines out along the path, and across it, m; the record begins where the run-in begins.

    Refused is a record shorter than the path that is not to be continued.
    """
    profiles, origin = processed(surface, "surface", degree=1)
    lines = measured_lines.common_length([resample(profile, grid.spacing) for profile in profiles])
    if lines.shape[1] < grid.rows:
        origin += f", {surface.continuation}ed"
    how = cast(synthesis.Continuation, surface.continuation or "refuse")
    extended = synthesis.extend(lines.T, grid.rows, how, spacing=grid.spacing, what="rail's record").T
    return Record(Rows(_across(extended, surface, grid)), origin, areal=False, lines=tuple(profiles))


def lines_around(rolling: body.Rolling, name: str, grid: Grid) -> Record:
    """Lay measured lines around what rolls out as one turn that closes on itself, m.

    `grid` holds one turn of the path's grid; the rows returned are those of the record, if it is nearly as
    long. Lines that do not go round are left out, with a warning.
    """
    measured, origin = processed(rolling, name, degree=0)
    profiles = [p for p in measured if len(p.heights) * p.spacing >= (1.0 - FULL_TURN) * grid.length]
    if not profiles:
        longest = max(len(p.heights) * p.spacing for p in measured)
        raise _not_round(name, f"{longest:.4g} m without gaps", grid.length)
    if len(profiles) < len(measured):
        ShortRecordWarning.warn(
            f"{len(measured) - len(profiles)} of {len(measured)} lines of the {name} are shorter than its "
            "circumference and left out: the others move together across. Measure them again."
        )
    register = measured_lines.bring_into_register(profiles)
    lines = register.lines
    if len(lines) > 1 and np.median(register.correlations[1:]) > SAME_TEXTURE:
        moved = sum(bool(s) or r for s, r in zip(register.shifts, register.reversed, strict=True))
        origin += f", {moved} brought into register ({sum(register.reversed)} turned round)"
    else:
        lines = measured_lines.common_length(profiles)
    spacing = profiles[0].spacing
    if lines.shape[1] * spacing > (1.0 + FULL_TURN) * grid.length:
        lines = lines[:, : round(grid.length / spacing)]
    fine = np.array([resample(Profile(line, spacing), grid.spacing).heights for line in lines])
    heights = _across(synthesis.close(fine.T, round(JOIN / grid.spacing)).T, rolling, grid)
    return Record(Rows(heights), origin, areal=False, lines=tuple(profiles))


def line_around(rolling: body.Rolling, name: str, contact: int, grid: Grid) -> Record:
    """Lay the measured line of a contact out as one turn that closes on itself, the same all across, m."""
    measured, origin = processed(rolling, name, degree=0)
    line = measured[contact % len(measured)]
    whole = grid.length
    length = len(line.heights) * line.spacing
    if line.missing_share > 0.0 or length < (1.0 - FULL_TURN) * whole:
        raise _not_round(name, f"{length:.4g} m" + ", with gaps" * bool(line.missing_share), whole)
    once = line.heights[: round(whole / line.spacing)] if length > (1.0 + FULL_TURN) * whole else line.heights
    fine = resample(level(Profile(once, line.spacing), 0), grid.spacing).heights
    return Record(Rows(synthesis.close(fine[:, None], round(JOIN / grid.spacing))), origin, areal=False)


def _not_round(name: str, received: str, whole: float) -> InputError:
    allowed = f"a full turn of {name}.radius, {whole:.4g} m, or up to {100 * FULL_TURN:g} % less"
    return InputError(f"{name}.line", received, allowed, f"Does {name}.radius fit what was measured?")


def processed(section: MeasuredLine, name: str, *, degree: int) -> tuple[list[Profile], str]:
    """Complete lines of a file, processed as the section says and levelled, and what was done.

    A line that goes round keeps its slope: it has none, but what noise gives it.
    """
    # ends are trimmed and gaps refused below
    with MissingPointsWarning.ignored():
        measured = read_lines(section, name)
    raw = (measured,) if isinstance(measured, Profile) else measured_lines.lines_of(measured)
    done, how = measured_lines.process(raw, section.processing)
    count = f"{len(raw)} line{'s' if len(raw) > 1 else ''} measured"
    words = f"{in_memory.name_of(section.line)}, {count}, {how}"  # type: ignore[arg-type]
    return [level(line, degree) for line in done], words


def _across(lines: Array, section: MeasuredLine, grid: Grid) -> Array:
    if len(lines) > 1 and section.line_distance is None:
        key = f"{'wheel' if isinstance(section, body.Rolling) else 'surface'}.line_distance"
        allowed = "the distance across between neighbouring lines"
        remedy = 'Add line_distance = "5 mm", say.'
        raise InputError(key, f"no distance for {count_of(len(lines), 'line')}", allowed, remedy)
    distance = section.line_distance or grid.spacing
    return measured_lines.strip_from_lines(lines, distance, grid.lines, grid.spacing)
