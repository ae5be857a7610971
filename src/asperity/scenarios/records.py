"""The texture of one body along a path, from band levels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.config.content import name_of
from asperity.config.tables import TableSource, read_levels
from asperity.errors import InputError
from asperity.reference import cnossos
from asperity.spectra import HALF_BAND, nominal_length
from asperity.surfaces.bands import strip_from_bands
from asperity.surfaces.heightmap import Profile


@dataclass(frozen=True)
class Grid:
    """Where strips of texture are wanted."""

    rows: int  # points along
    lines: int  # points across
    spacing: float  # in both directions, m


@dataclass(frozen=True, eq=False)
class Record:
    """Texture of one body along the path."""

    heights: NDArray[np.float64]  # (rows, lines), m, peaks positive
    origin: str  # where it comes from
    areal: bool = True  # whether heights beside a line are a texture of their own, not carried over from it
    # measured lines that heights are interpolated between, m; none of an areal texture
    lines: tuple[Profile, ...] = ()


def spectrum_strip(
    wavelength: ArrayLike, levels: ArrayLike, grid: Grid, *, lateral: float, seed: int, name: str
) -> Record:
    """Synthesise a strip from band levels, dB re 1 µm, leaving out bands that grid or length cannot hold.

    Centres (b,) in m. The strip closes on itself along the grid; `lateral` is its correlation length across
    over that along. `name` is that of the spectrum.
    """
    given, level_db = np.asarray(wavelength, float), np.asarray(levels, float)
    length = grid.rows * grid.spacing
    held = (given * HALF_BAND < 0.97 * length) & (given / HALF_BAND > 2.06 * grid.spacing)
    if not held.any():
        received = f"a length of {length:.4g} m at {grid.spacing * 1e3:.4g} mm"
        raise InputError(f"bands of {name}", received, "a length and a spacing that hold a band")
    strip = strip_from_bands(
        (grid.rows, grid.lines),
        (grid.spacing, grid.spacing),
        given[held],
        level_db[held],
        lateral=lateral,
        seed=seed,
    )
    kept = given[held]
    bands = f"{name}, bands of {nominal_length(kept.max())} to {nominal_length(kept.min())}"
    return Record(strip.heights, bands, areal=bool(np.isfinite(lateral)))


def spectrum_levels(spectrum: str | TableSource) -> tuple[NDArray[np.float64], NDArray[np.float64], str]:
    """Band levels of a path, by name or from a table: wavelengths, m, levels, dB re 1 µm, and a name."""
    if not isinstance(spectrum, str):
        return *read_levels(spectrum), name_of(spectrum)
    return *cnossos.rail_roughness(spectrum), spectrum
