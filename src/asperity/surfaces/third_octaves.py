"""Measured lines against the limit of a rail's roughness, in one-third octaves of wavelength."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from asperity.errors import PhysicsWarning
from asperity.reference.cnossos import rail_roughness
from asperity.spectra import HALF_BAND
from asperity.surfaces.en15610 import process, trim
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.levelling import nearly_complete
from asperity.surfaces.levels import LIKELY_WAVELENGTHS, band_levels_of
from asperity.surfaces.parallel_lines import FULL_LINE, common_length

FEWEST_BANDS = 6
"""Of the limit, that a line resolves: others are no rail's or wheel's."""


@dataclass(frozen=True, eq=False)
class ThirdOctaves:
    """One-third-octave levels of lines, mean power of all, dB re 1 µm, at wavelengths (b,), m, that fall."""

    wavelength: NDArray[np.float64]
    measured: NDArray[np.float64]  # levelled, gaps filled
    processed: NDArray[np.float64]  # after EN 15610: without spikes, rolled over with a circle
    limit: NDArray[np.float64]  # EN ISO 3095:2013; NaN where it gives none

    @property
    def limited(self) -> NDArray[np.bool_]:
        """Bands for which there is a limit."""
        return np.isfinite(self.limit)


def full_lines(lines: Sequence[Profile]) -> list[Profile]:
    """Lines that a spectrum can be taken of, cut to one length: those of a full length, nearly complete."""
    cut = [trim(line)[0] for line in lines]
    longest = max(len(line.heights) for line in cut)
    whole = [nearly_complete(line) for line in cut if len(line.heights) >= FULL_LINE * longest]
    kept = [line for line in whole if line is not None]
    return [Profile(each, kept[0].spacing) for each in common_length(kept)] if kept else []


def third_octaves(lines: Sequence[Profile]) -> ThirdOctaves | None:
    """Levels of lines measured side by side, or of one, m, and the limit of EN ISO 3095:2013.

    A Hann window lies over each whole line, so that its ends count less. None of lines that resolve fewer
    than six bands of the limit, 400 mm to 3.15 mm. Whether lines have been processed after EN 15610 already
    their file does not say: of those the levels as measured count.
    """
    full = full_lines(lines)
    if not full or 4.0 * full[0].spacing > LIKELY_WAVELENGTHS[1] or full[0].size < LIKELY_WAVELENGTHS[0]:
        return None
    spacing = full[0].spacing
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PhysicsWarning)  # of a spacing beyond 1 mm
        done = [process(line)[0] for line in full]
    found = []
    for each in (full, done):
        together = np.array([line.levelled().heights for line in each]).T
        surface = (
            HeightMap(together, (spacing, spacing)) if len(each) > 1 else Profile(together[:, 0], spacing)
        )
        found.append(band_levels_of(surface))
    wavelength = found[0][0]
    nominal, limits = rail_roughness("iso3095")
    inside = (nominal > LIKELY_WAVELENGTHS[0] / HALF_BAND) & (nominal < LIKELY_WAVELENGTHS[1] * HALF_BAND)
    limit = np.full(wavelength.shape, np.nan)
    for at, level in zip(nominal[inside], limits[inside], strict=True):
        limit[np.abs(np.log10(wavelength / at)) < 0.03] = level
    if np.isfinite(limit).sum() < FEWEST_BANDS:
        return None
    return ThirdOctaves(wavelength, found[0][1], found[1][1], limit)
