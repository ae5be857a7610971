"""Spectra of what a measured file holds: those that its picture draws, and their CSV file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from asperity.reporting.part import write_columns
from asperity.surfaces.en15610 import full_lines
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.levelling import nearly_complete
from asperity.surfaces.spectra import psd_1d, psd_radial

Spectra = dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]]
"""Wavenumbers, cycles/m, above zero, and one-sided PSD, m³, by the direction of the lines."""


def spectra_of(surface: HeightMap | Profile) -> Spectra:
    """Spectra of levelled heights along x, and of a map along y; none where more than 5 % are missing."""
    if isinstance(surface, Profile):
        line = nearly_complete(surface)
        return {} if line is None else {"along the line": _above_zero(psd_1d(line))}
    whole = nearly_complete(surface)
    if whole is None:
        return {}
    return {f"along {name}": _above_zero(psd_1d(whole, axis)) for axis, name in enumerate("xy")}


def spectra_of_lines(lines: Sequence[Profile]) -> Spectra:
    """Mean of the spectra of lines side by side, of those that are as long as the others."""
    each = [_above_zero(psd_1d(line)) for line in full_lines(lines)]
    if not each:
        return {}
    return {"along the lines, mean": (each[0][0], np.mean([density for _, density in each], axis=0))}


def _above_zero(
    spectrum: tuple[NDArray[np.float64], NDArray[np.float64]],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    return spectrum[0][1:], spectrum[1][1:]


def write_spectra(spectra: Spectra, surface: HeightMap | Profile | None, path: Path) -> Path:
    """Write spectra to a CSV file; of a map also the areal one, averaged over directions."""
    pairs = {
        f"wavenumber {name} [1/m]": (wavenumber, f"PSD {name} [m³]", density)
        for name, (wavenumber, density) in spectra.items()
    }
    if isinstance(surface, HeightMap) and spectra:
        pairs["angular wavenumber [rad/m]"] = (*_areal(surface),)
    longest = max(len(first) for first, _, _ in pairs.values())
    columns = {}
    for heading, (first, title, second) in pairs.items():
        columns[heading], columns[title] = _padded(first, longest), _padded(second, longest)
    return write_columns(columns, path)


def _areal(surface: HeightMap) -> tuple[NDArray[np.float64], str, NDArray[np.float64]]:
    wavenumber, density = psd_radial(nearly_complete(surface) or surface)
    return wavenumber, "areal PSD, mean over directions [m⁴]", density


def _padded(values: NDArray[np.float64], length: int) -> NDArray[np.float64]:
    return np.concatenate([values, np.full(length - len(values), np.nan)])
