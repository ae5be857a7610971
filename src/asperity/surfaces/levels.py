"""One-third-octave levels in wavelength of lines and surfaces, dB re 1 µm."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from asperity.errors import InputError
from asperity.spectra import HALF_BAND, band_levels, psd
from asperity.surfaces.heightmap import HeightMap, Profile

MICROMETRE = 1e-6
"""Reference of roughness levels, m (ISO 3095:2013, EN 15610:2009)."""

LIKELY_LEVELS = (-60.0, 60.0)
"""Levels outside of these, dB re 1 µm, ask whether the unit of the heights is right."""

EMPTY = 120.0
"""A band this far below the highest holds rounding errors, dB."""

LIKELY_WAVELENGTHS = (3.15e-3, 0.4)
"""Wavelengths whose levels are checked, m: the bands of ISO 3095:2013."""


def band_levels_of(
    surface: Profile | HeightMap,
    *,
    segment: float | None = None,
    shortest: float | None = None,
    longest: float | None = None,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """One-third-octave levels, dB re 1 µm, with their wavelengths, m; of a map the mean power along x.

    Complete heights, m; the mean of each line is removed. Segments, m, are Hann-windowed with 50 % overlap,
    the whole length by default. `shortest` and `longest` lie in the last and the first band; by default all
    bands that the segment resolves and the spacing holds. The exact band centres fall; an empty band has a
    level of minus infinity.
    """
    spacing = surface.spacing[0] if isinstance(surface, HeightMap) else surface.spacing
    points = None if segment is None else round(segment / spacing)
    wavenumber, density = psd(surface.heights.T, spacing, segment=points)
    if density.ndim == 2:
        density = density.mean(axis=0)
    low = None if longest is None else 1.0 / longest
    high = None if shortest is None else 1.0 / shortest
    centres, levels = band_levels(wavenumber, density, MICROMETRE, low=low, high=high)
    return 1.0 / centres, levels


def check_levels(surfaces: Sequence[Profile | HeightMap], what: str = "heights") -> None:
    """Ask for the unit where levels are far from those of wheels and rails.

    That is beyond ±60 dB re 1 µm in a band between 3.15 mm and 0.4 m that the record resolves. Empty bands,
    120 dB below the highest, do not count. The heights are complete and without form, m.
    """
    for surface in surfaces:
        wavelength, level = band_levels_of(surface)
        step = surface.spacing[0] if isinstance(surface, HeightMap) else surface.spacing
        inside = (wavelength > LIKELY_WAVELENGTHS[0] / HALF_BAND) & (
            wavelength < LIKELY_WAVELENGTHS[1] * HALF_BAND
        )
        inside &= np.isfinite(level) & (wavelength >= 4.0 * step) & (level > level.max() - EMPTY)
        if not inside.any():
            continue
        for extreme in (level[inside].max(), level[inside].min()):
            if not LIKELY_LEVELS[0] <= extreme <= LIKELY_LEVELS[1]:
                at = wavelength[inside][np.argmin(np.abs(level[inside] - extreme))]
                received = f"{extreme:.0f} dB re 1 µm at a wavelength of {1e3 * at:.3g} mm"
                allowed = f"levels between {LIKELY_LEVELS[0]:g} and {LIKELY_LEVELS[1]:+g} dB"
                remedy = "Is the unit right? If these levels are meant, set surface.accept_levels = true."
                raise InputError(f"levels of the {what}", received, allowed, remedy)
