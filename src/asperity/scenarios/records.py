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
