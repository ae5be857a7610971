"""The group of a result that shows what is rolled over: textures, their statistics and spectra."""

from __future__ import annotations

import json
import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from asperity.errors import InhomogeneousWarning, ShortRecordWarning
from asperity.scenarios.chain import Chain
from asperity.scenarios.textures import Textures
from asperity.schema import Entry, attributes, surface, variables
from asperity.spectra import psd
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.homogeneity import SIGNIFICANCE, TILES, homogeneity, more_than_chance
from asperity.surfaces.statistics import (
    Statistic,
    areal_statistics,
    line_statistics,
    profile_statistics,
    psd_1d,
)
from asperity.surfaces.strip_statistics import BINS, survey_strip

PATH_ROWS = 2000
"""Rows of a path, at most, that are kept to be looked at from above."""
FEWEST_POINTS = 16
"""Points of a segment of a line's spectrum, at least."""


def surface_group(chain: Chain, *, brief: bool = False) -> xarray.Dataset:
    """Lay out the textures of a case: first sample, a piece of the path, its line.

    And, if not in brief, of the whole path distribution, spectrum and statistics.
    """
    textures, dx = chain.textures, chain.shape.spacing[0]
    laid_out: dict[Entry, Any] = {}
    statistics: list[dict[str, Any]] = []
    if textures.maps:
        first = textures.maps[0]
        laid_out |= {
            surface.X: np.arange(first.shape[0]) * dx,
            surface.Y: np.arange(first.shape[1]) * dx,
            surface.SAMPLE_HEIGHTS: first.heights,
        }
        statistics += _areal(first) if textures.areal and not brief else []
    recorded = textures.recorded
    if textures.path is not None:
        piece = textures.surface.rows(recorded.start, min(recorded.stop, recorded.start + PATH_ROWS))
        laid_out |= {
            surface.PATH_X: np.arange(len(piece)) * dx,
            surface.PATH_Y: np.arange(piece.shape[1]) * dx,
            surface.PATH_HEIGHTS: piece,
        }
    measured = textures.untouched or textures
    if chain.case.surface.file is not None and measured.maps is not measured.strips:
        laid_out |= _homogeneity(measured.maps)
    line = textures.followed[recorded]
    laid_out |= {surface.DISTANCE: np.arange(len(line)) * dx, surface.LINE: line}
    if textures.untouched is not None:
        laid_out[surface.LINE_UNTOUCHED] = textures.untouched.followed[recorded]
    if not brief:
        path = _path(chain)
        laid_out |= _distribution(path) | _spectra(chain, path)
        statistics += path.statistics + _of_lines(textures)
    facts = {
        surface.STATISTICS: json.dumps(statistics, ensure_ascii=False),
        surface.SOURCE: textures.origin,
        surface.MISSING_SHARE: textures.missing_share,
        surface.ACROSS: "areal" if textures.areal else "lines",
    }
    return xarray.Dataset(variables(laid_out), attrs=attributes(facts))


@dataclass(frozen=True, eq=False)
class _Path:
    """Statistics of the whole path, the distribution of its heights (m), and its spectrum (m³ over 1/m)."""

    statistics: list[dict[str, Any]]
    edges: NDArray[np.float64]
    density: NDArray[np.float64]
    wavenumber: NDArray[np.float64]
    spectrum: NDArray[np.float64]


def _path(chain: Chain) -> _Path:
    """Survey the recorded path, as a surface or, where nothing is known beside it, as a line."""
    textures, recorded = chain.textures, chain.textures.recorded
    segment = min(_segment(textures), recorded.stop - recorded.start)
    if textures.path is None or not textures.areal:
        return _along_line(textures, chain.shape.spacing[0], segment)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", ShortRecordWarning)
        found = survey_strip(textures.surface, segment, recorded.start, recorded.stop)
        rough = (
            found
            if textures.defects is None
            else survey_strip(textures.path, segment, recorded.start, recorded.stop)
        )
    statistics = _without_bounds(found.statistics, caught)
    return _Path(_listed(statistics, "path"), found.edges, found.density, rough.wavenumber, rough.spectrum)


def _along_line(textures: Textures, dx: float, segment: int) -> _Path:
    line, rough = textures.followed[textures.recorded], textures.line[textures.recorded]
    statistics = profile_statistics(Profile(line, dx)) if np.ptp(line) else []
    edges = np.linspace(line.min(), line.max() or 1e-12, BINS + 1) - line.mean()
    density = np.histogram(line - line.mean(), edges, density=True)[0] if np.ptp(line) else np.zeros(BINS)
    wavenumber, spectrum = psd(rough, dx, segment=segment)
    return _Path(_listed(statistics, "middle line of the path"), edges, density, wavenumber, spectrum)


def _segment(textures: Textures) -> int:
    """Points of a segment of the spectrum: the length of the samples."""
    return textures.maps[0].shape[0] if textures.maps else max(FEWEST_POINTS, len(textures.line) // 8)


def _areal(surface: HeightMap) -> list[dict[str, Any]]:
    """Statistics of the samples; a smooth one has none."""
    if not np.ptp(surface.heights):
        return []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", ShortRecordWarning)
        found = areal_statistics(surface)
    return _listed(_without_bounds(found, caught), "first sample")


def _homogeneity(maps: tuple[HeightMap, ...]) -> dict[Entry, Any]:
    """Test measured maps for being the same everywhere; synthesised ones are."""
    if any(min(m.shape) < 2 * max(TILES) or not np.ptp(m.heights) for m in maps):
        return {}
    found = [homogeneity(m) for m in maps]
    p_values = [f.p_value for f in found]
    if more_than_chance(p_values):
        failed = sum(not f.homogeneous for f in found)
        worst = max(found, key=lambda f: f.variation / f.expected)
        warnings.warn(
            f"{failed} of {len(maps)} measured maps are not the same everywhere (p ≤ {SIGNIFICANCE:g}): the "
            f"mean squares of {TILES[0]} × {TILES[1]} tiles vary by up to {100 * worst.variation:.0f} %, "
            f"those of stationary textures by {100 * worst.expected:.0f} %. Samples of them do not stand for "
            "the whole path: take more maps, crop them, or remove form and waviness.",
            InhomogeneousWarning,
            stacklevel=2,
        )
    return {
        surface.HOMOGENEITY_P: surface.HOMOGENEITY_P.variable(p_values, significance=SIGNIFICANCE),
        surface.TILE_VARIATION: [f.variation for f in found],
        surface.TILE_VARIATION_EXPECTED: [f.expected for f in found],
        surface.TILE_RMS: np.stack([f.tile_rms for f in found]),
    }


def _without_bounds(found: list[Statistic], caught: list[warnings.WarningMessage]) -> list[Statistic]:
    """Leave out the texture ratio of what is narrower than its waves: it would be a bound."""
    bounds = {"Str"} if any(issubclass(w.category, ShortRecordWarning) for w in caught) else set()
    return [item for item in found if item.symbol not in bounds]


def _of_lines(textures: Textures) -> list[dict[str, Any]]:
    """Statistics of measured lines side by side: means over them."""
    return [
        item
        for body, lines in textures.lines.items()
        if len(lines) > 1
        for item in _listed(
            [mean for mean, _, _ in line_statistics(lines)], f"{len(lines)} lines of the {body}, mean"
        )
    ]


def _distribution(path: _Path) -> dict[Entry, Any]:
    if not path.density.any():
        return {}
    middle = 0.5 * (path.edges[1:] + path.edges[:-1])
    return {surface.PATH_HEIGHT: middle, surface.PATH_HEIGHT_DENSITY: path.density}


def _listed(statistics: list[Statistic], where: str) -> list[dict[str, Any]]:
    return [
        {
            "symbol": s.symbol,
            "value": s.value if np.isfinite(s.value) else None,
            "unit": s.unit,
            "bandwidth": f"{_length(s.bandwidth[0])} … {_length(s.bandwidth[1])}",
            "surface": where,
            "meaning": s.meaning,
        }
        for s in statistics
    ]


def _length(metres: float) -> str:
    if metres >= 1.0:
        return f"{metres:.3g} m"
    return f"{metres * 1e3:.3g} mm" if metres >= 1e-3 else f"{metres * 1e6:.3g} µm"


def _spectra(chain: Chain, path: _Path) -> dict[Entry, Any]:
    """Spectra of samples and path in the rolling direction, on the samples' wavenumbers."""
    maps, wavenumber = chain.textures.maps, path.wavenumber
    found: dict[Entry, Any] = {}
    if maps:
        spectra = [psd_1d(m)[1] for m in maps]
        wavenumber = psd_1d(maps[0])[0]
        found[surface.PSD_SAMPLE] = np.mean([s[1:] for s in spectra if s.shape == spectra[0].shape], axis=0)
    along = np.interp(wavenumber[1:], path.wavenumber[1:], path.spectrum[1:], left=np.nan)
    return found | {surface.PSD_PATH: along, surface.SURFACE_WAVENUMBER: wavenumber[1:]}
