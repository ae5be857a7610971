"""Textures of one body of a wheel-on-rail case, from band levels."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.errors import InputError
from asperity.kinds.wheel_on_rail.tables import read_levels
from asperity.reference import cnossos
from asperity.spectra import HALF_BAND, nominal_length
from asperity.surfaces.bands import strip_from_bands
from asperity.surfaces.heightmap import Profile


@dataclass(frozen=True)
class Grid:
    """Where strips of texture are wanted.

    Attributes
    ----------
    rows, lines : int
        Points along and across.
    spacing : float
        In both directions, m.
    """

    rows: int
    lines: int
    spacing: float


@dataclass(frozen=True, eq=False)
class Record:
    """Texture of one body along the path.

    Attributes
    ----------
    heights : ndarray, shape (rows, lines)
        m, peaks positive.
    origin : str
        Where it comes from.
    areal : bool
        Whether heights beside a line are a texture of their own, not carried over from it.
    lines : tuple of Profile
        Measured lines that heights are interpolated between, m; none of an areal texture.
    """

    heights: NDArray[np.float64]
    origin: str
    areal: bool = True
    lines: tuple[Profile, ...] = ()


def spectrum_strip(
    wavelength: ArrayLike, levels: ArrayLike, grid: Grid, *, lateral: float, seed: int, name: str
) -> Record:
    """Synthesise a strip from band levels, leaving out bands that grid or length cannot hold.

    Parameters
    ----------
    wavelength, levels : array_like, shape (b,)
        Band centres, m, and levels, dB re 1 µm.
    grid : Grid
        Size; the strip closes on itself along it.
    lateral : float
        Correlation length across over that along.
    seed : int
        Of the synthesis.
    name : str
        Of the spectrum.

    Returns
    -------
    Record
        The strip, and which bands it holds.

    Raises
    ------
    InputError
        If no band is left.
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


def rail_levels(spectrum: str | Path) -> tuple[NDArray[np.float64], NDArray[np.float64], str]:
    """Band levels of a rail: a named spectrum or a table.

    Parameters
    ----------
    spectrum : str or Path
        Name or file.

    Returns
    -------
    wavelength, level : ndarray
        m and dB re 1 µm.
    name : str
        For the record.
    """
    if isinstance(spectrum, Path):
        return *read_levels(spectrum), spectrum.name
    return *cnossos.rail_roughness(spectrum), spectrum


def wheel_levels(roughness: str | Path) -> tuple[NDArray[np.float64], NDArray[np.float64], str]:
    """Band levels of a wheel: a named roughness or a table.

    Parameters
    ----------
    roughness : str or Path
        Name or file.

    Returns
    -------
    wavelength, level : ndarray
        m and dB re 1 µm.
    name : str
        For the record.
    """
    if isinstance(roughness, Path):
        return *read_levels(roughness), roughness.name
    return *cnossos.wheel_roughness(roughness), roughness
