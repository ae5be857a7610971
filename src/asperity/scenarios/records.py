"""Textures of a body along a path: lines and maps read from files, and strips from band levels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.config.content import name_of
from asperity.config.recipe import read_recipe
from asperity.config.sections import MeasuredLine, Surface
from asperity.config.tables import TableSource, read_levels
from asperity.errors import InputError
from asperity.reference import cnossos
from asperity.spectra import HALF_BAND, nominal_length
from asperity.surfaces.bands import strip_from_bands
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.readers import read_surface, read_surfaces
from asperity.surfaces.readers.hints import in_case, spelled
from asperity.surfaces.strip import Strip
from asperity.surfaces.synthesis import long_strip_from_bands


@dataclass(frozen=True)
class Grid:
    """Where strips of texture are wanted."""

    rows: int  # points along
    lines: int  # points across
    spacing: float  # in both directions, m


@dataclass(frozen=True, eq=False)
class Record:
    """Texture of one body along the path."""

    strip: Strip  # (rows, lines), peaks positive
    origin: str  # where it comes from
    areal: bool = True  # whether heights beside a line are a texture of their own, not carried over from it
    # measured lines that heights are interpolated between, m; none of an areal texture
    lines: tuple[Profile, ...] = ()

    @property
    def heights(self) -> NDArray[np.float64]:
        """All heights, m, shape (rows, lines)."""
        return self.strip.rows(0, self.strip.shape[0])


def spectrum_strip(
    wavelength: ArrayLike, levels: ArrayLike, grid: Grid, *, lateral: float, seed: int, name: str
) -> Record:
    """Synthesise a strip from band levels, dB re 1 µm, leaving out bands that grid or length cannot hold.

    Centres (b,) in m. The strip closes on itself along the grid; `lateral` is its correlation length across
    over that along. `name` is that of the spectrum.
    """
    length = grid.rows * grid.spacing
    given, level_db = _held(wavelength, levels, grid, length, name)
    strip = strip_from_bands(
        (grid.rows, grid.lines), (grid.spacing, grid.spacing), given, level_db, lateral=lateral, seed=seed
    )
    return Record(strip, _bands(given, name), areal=bool(np.isfinite(lateral)))


def long_spectrum_strip(
    wavelength: ArrayLike,
    levels: ArrayLike,
    grid: Grid,
    *,
    lateral: float,
    seed: int,
    name: str,
    before: int,
) -> Record:
    """Synthesise a strip of any length as `spectrum_strip` does, in pieces, where it is read.

    It does not close on itself, and holds all bands that the spacing can. From row `before` on it is the same
    however many rows there are: a track that is rolled over at any speed.
    """
    given, level_db = _held(wavelength, levels, grid, np.inf, name)
    strip = long_strip_from_bands(
        (grid.rows, grid.lines), (grid.spacing, grid.spacing), given, level_db,
        lateral=lateral, seed=seed, before=before,
    )  # fmt: skip
    return Record(strip, _bands(given, name), areal=bool(np.isfinite(lateral)))


def _held(
    wavelength: ArrayLike, levels: ArrayLike, grid: Grid, length: float, name: str
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Bands that a spacing and a length, m, can hold."""
    given, level_db = np.asarray(wavelength, float), np.asarray(levels, float)
    held = (given * HALF_BAND < 0.97 * length) & (given / HALF_BAND > 2.06 * grid.spacing)
    if not held.any():
        received = f"a length of {grid.rows * grid.spacing:.4g} m at {grid.spacing * 1e3:.4g} mm"
        raise InputError(f"bands of {name}", received, "a length and a spacing that hold a band")
    return given[held], level_db[held]


def _bands(kept: NDArray[np.float64], name: str) -> str:
    return f"{name}, bands of {nominal_length(kept.max())} to {nominal_length(kept.min())}"


def spectrum_levels(spectrum: str | TableSource) -> tuple[NDArray[np.float64], NDArray[np.float64], str]:
    """Band levels of a path, by name or from a table: wavelengths, m, levels, dB re 1 µm, and a name."""
    if not isinstance(spectrum, str):
        return *read_levels(spectrum), name_of(spectrum)
    return *cnossos.rail_roughness(spectrum), spectrum


_MAP_KEYS = {name: name for name in ("array", "height_unit", "pixel", "index", "fill", "spikes")}
_LINE_KEYS = {"array": "line_array", "height_unit": "line_unit", "pixel": "line_spacing"}


def read_maps(surface: Surface) -> Sequence[HeightMap | Profile]:
    """Read the map, or all maps of an ensemble, that the surface section names, as they lie in the file."""
    assert surface.file is not None
    if not isinstance(surface.file, Path):
        maps = surface.file if isinstance(surface.file, tuple) else (surface.file,)
        if surface.index is not None and surface.index >= len(maps):
            allowed = f"0 to {len(maps) - 1}, of the maps in memory"
            raise InputError("surface.index", surface.index, allowed)
        chosen = maps if surface.index is None else (maps[surface.index],)
        if surface.spikes:
            chosen = tuple(each.without_spikes() for each in chosen)
        return [each.filled() if surface.fill else each for each in chosen]
    if surface.recipe is not None:
        return read_recipe(surface.recipe).read(surface.file)
    with spelled(in_case("surface", _MAP_KEYS)):
        read = read_surfaces if surface.index is None else partial(read_surface, index=surface.index)
        found = read(
            surface.file,
            array=surface.array,
            height_unit=surface.height_unit,
            pixel=surface.pixel,
            fill=surface.fill,
            spikes=surface.spikes,
        )
    return found if isinstance(found, list) else [found]


def read_lines(section: MeasuredLine, name: str) -> HeightMap | Profile:
    """Read the measured line, or lines side by side, that a section of a name has.

    Lines side by side are a map; the distance across is not known to it.
    """
    assert section.line is not None
    if not isinstance(section.line, Path):
        return section.line
    with spelled(in_case(name, _LINE_KEYS)):
        return read_surface(
            section.line, array=section.line_array, height_unit=section.line_unit, pixel=section.line_spacing
        )


def read_section(measured: Path | Profile, key: str) -> Profile:
    """Read a measured section of a body across the path.

    Parameters
    ----------
    measured : Path or Profile
        Its file, or itself.
    key : str
        The key that names it, for messages.

    Returns
    -------
    Profile
        Heights, complete.

    Raises
    ------
    InputError
        If the file does not hold one complete line.
    """
    with spelled(in_case(key.partition(".")[0], {})):
        section = read_surface(measured) if isinstance(measured, Path) else measured
    if not isinstance(section, Profile):
        raise InputError(key, "a map of heights", "one line across the path")
    if section.missing_share > 0.0:
        raise InputError(key, "points without a height", "a complete line", "Interpolate them in the file.")
    return section
