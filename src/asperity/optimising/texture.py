"""The texture of a case by its one-third octaves of wavelength, and the case with another one."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from asperity.config.case import Case
from asperity.config.form import extra_of
from asperity.config.sections import Surface
from asperity.errors import InputError
from asperity.running import prepare_case
from asperity.scenarios.records import spectrum_levels
from asperity.spectra import HALF_BAND, third_octave_bands
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.levels import band_levels_of

C = TypeVar("C", bound=Case)
ROWS = 2**17
"""Most rows of a path whose levels are taken."""
HOLLOW = 80.0
"""Bands so far below the highest, dB, hold no texture."""
LOWEST_HEARD = 20.0
"""Hz."""
FEWEST_BANDS = 2


@dataclass(frozen=True, eq=False)
class Bands:
    """A texture by its one-third octaves of wavelength, the longest first."""

    wavelength: NDArray[np.float64]  # (n,), centres, m
    levels: NDArray[np.float64]  # (n,), dB re 1 µm
    changed: NDArray[np.bool_]  # (n,), which of them may be changed
    lateral: float | None  # correlation length across over that along; None of a line

    def with_changed(self, levels: NDArray[np.float64], lateral: float | None) -> Bands:
        """The same with other levels of those that may be changed."""
        every = self.levels.copy()
        every[self.changed] = levels
        return replace(self, levels=every, lateral=lateral)

    @property
    def table(self) -> NDArray[np.float64]:
        """Wavelengths and levels side by side (n, 2), as a case takes them."""
        return np.stack([self.wavelength, self.levels], axis=1)

    def edges(self, speed: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Frequencies, Hz, between which the changed bands are passed at a speed, m/s."""
        centre = np.concatenate([third_octave_bands(1.0 / w, 1.0 / w)[0] for w in self.changed_wavelength])
        return speed * centre / HALF_BAND, speed * centre * HALF_BAND

    @property
    def changed_wavelength(self) -> NDArray[np.float64]:
        """Centres of the bands that may be changed, m."""
        return self.wavelength[self.changed]


def bands_of(case: Case, longest: float | None, shortest: float | None) -> Bands:
    """Take the bands of a case's texture: of its spectrum, else of its path.

    Those between two wavelengths, m, may be changed; by default those that are heard, from 20 Hz to the
    highest frequency of the spectra. Waves that the grid of the contact cannot hold are left out.
    """
    surface = case.surface
    lateral = surface.lateral
    if lateral is None and not surface.has_line:
        lateral = 1.0 / surface.anisotropy if surface.rms is not None else 1.0
    if surface.spectrum is not None:
        wavelength, levels, _ = spectrum_levels(surface.spectrum)
        levels = levels + surface.level
    else:
        wavelength, levels = _measured(case)
    held = wavelength / HALF_BAND > 2.06 * case.contact.spacing
    wavelength, levels = wavelength[held], levels[held]
    low = longest or case.speed / LOWEST_HEARD
    high = shortest or case.speed / case.numerics.highest_frequency
    changed = (wavelength < low * HALF_BAND) & (wavelength > high / HALF_BAND)
    if np.count_nonzero(changed) < FEWEST_BANDS:
        received = f"{np.count_nonzero(changed)} bands of the texture between {high:.3g} m and {low:.3g} m"
        allowed = f"at least {FEWEST_BANDS}"
        remedy = (
            f"Its bands are {wavelength.min():.3g} m to {wavelength.max():.3g} m. Change longest or shortest."
        )
        raise InputError("bands that may be changed", received, allowed, remedy)
    return Bands(wavelength, levels, changed, lateral)


def _measured(case: Case) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Levels of the path, mean over its lines, at the wavelengths that it holds, the longest first."""
    textures, spacing = prepare_case(case).textures, case.contact.spacing
    line = Profile(textures.line - textures.line.mean(), spacing)
    if textures.path is None:
        wavelength, levels = band_levels_of(line)
    else:
        heights = textures.path.rows(0, min(textures.path.shape[0], ROWS))
        wavelength, levels = band_levels_of(HeightMap(heights - heights.mean(), (spacing, spacing)))
    full = levels > levels.max() - HOLLOW
    order = np.argsort(-wavelength[full])
    return wavelength[full][order], levels[full][order]


def with_texture(case: C, bands: Bands) -> C:
    """The case over a texture of these bands; defects and other bodies stay as they are."""
    keys = case.given()
    fields = type(case.surface).model_fields
    sources = set(Surface.model_fields) | {"smooth"}
    sources |= {name for name, field in fields.items() if extra_of(field)["goes_with"] in sources}
    kept = {name: value for name, value in keys.get("surface", {}).items() if name not in sources}
    lay = {} if bands.lateral is None else {"lateral": bands.lateral}
    keys["surface"] = kept | {"spectrum": bands.table} | lay
    return type(case)(**keys)
