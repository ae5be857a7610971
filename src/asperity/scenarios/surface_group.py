"""The group of a result that shows what is rolled over: textures, their statistics and spectra."""

from __future__ import annotations

import json
import warnings
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from asperity.errors import ShortRecordWarning
from asperity.results import variable
from asperity.scenarios.chain import Chain
from asperity.spectra import psd
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.statistics import Statistic, areal_statistics, profile_statistics, psd_1d

PATH_ROWS = 2000
LINE_POINTS = 20000
SPECTRUM_ROWS = 2**16
"""Rows of a path, at most, that its spectrum is made of."""


def surface_group(chain: Chain[Any]) -> xarray.Dataset:
    """Lay out the textures of a case.

    Parameters
    ----------
    chain : Chain
        What was chain.

    Returns
    -------
    xarray.Dataset
        First sample, a piece of the path, its line, spectra and statistics.
    """
    textures, dx = chain.textures, chain.shape.spacing[0]
    variables: dict[str, xarray.Variable] = {}
    statistics: list[dict[str, Any]] = []
    if textures.maps:
        first = textures.maps[0]
        variables |= {
            "x": variable("x", np.arange(first.shape[0]) * dx, "m", "rolling direction"),
            "y": variable("y", np.arange(first.shape[1]) * dx, "m", "across"),
            "sample_heights": variable(("x", "y"), first.heights, "m", "height of the first sample"),
        }
        statistics += _areal(first, "samples")
    if textures.path is not None:
        recorded = textures.recorded
        piece = textures.surface.rows(recorded.start, min(recorded.stop, recorded.start + PATH_ROWS))
        variables |= {
            "path_x": variable("path_x", np.arange(len(piece)) * dx, "m", "rolling direction"),
            "path_y": variable("path_y", np.arange(piece.shape[1]) * dx, "m", "across"),
            "path_heights": variable(("path_x", "path_y"), piece, "m", "height of the path"),
        }
        statistics += _areal(HeightMap(piece, textures.path.spacing), "path")
    else:
        statistics += _listed(profile_statistics(Profile(textures.line, dx)), "path")
    line = textures.followed[textures.recorded][:LINE_POINTS]
    variables["distance"] = variable("distance", np.arange(len(line)) * dx, "m", "distance along the path")
    variables["line"] = variable("distance", line, "m", "height along the middle of the path")
    variables |= _texture_spectra(chain)
    attrs = {
        "statistics": json.dumps(statistics, ensure_ascii=False),
        "source": textures.origin,
        "missing_share": textures.missing_share,
    }
    return xarray.Dataset(variables, attrs=attrs)


def _areal(surface: HeightMap, where: str) -> list[dict[str, Any]]:
    """Statistics of a surface; a smooth one has none, one narrower than its waves no texture ratio."""
    if not np.ptp(surface.heights):
        return []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", ShortRecordWarning)
        found = areal_statistics(surface)
    bounds = {"Str"} if any(issubclass(w.category, ShortRecordWarning) for w in caught) else set()
    return _listed([s for s in found if s.symbol not in bounds], where)


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


def _texture_spectra(chain: Chain[Any]) -> dict[str, xarray.Variable]:
    """Spectra of samples and path in the rolling direction, on the samples' wavenumbers."""
    textures, dx = chain.textures, chain.shape.spacing[0]
    result: dict[str, xarray.Variable] = {}
    wavenumber: NDArray[np.floating[Any]]
    units, dims = "m3", "surface_wavenumber"
    if textures.maps:
        spectra = [psd_1d(m)[1] for m in textures.maps]
        wavenumber = psd_1d(textures.maps[0])[0]
        sampled = np.mean([s[1:] for s in spectra if s.shape == spectra[0].shape], axis=0)
        result["psd_sample"] = variable(dims, sampled, units, "PSD of the samples along the path, one-sided")
        segment = textures.maps[0].shape[0]
    else:
        segment = max(16, len(textures.line) // 8)
        wavenumber = np.fft.rfftfreq(segment, dx)
    path = textures.path
    lines = textures.line if path is None else path.rows(0, min(path.shape[0], SPECTRUM_ROWS)).T
    if segment <= lines.shape[-1]:
        k, density = psd(np.ascontiguousarray(lines), dx, segment=segment)
        mean = np.atleast_2d(density).mean(axis=0)
        along = np.interp(wavenumber[1:], k, mean)
        result["psd_path"] = variable(dims, along, units, "PSD of the path along it, one-sided")
    if result:
        result[dims] = variable(dims, wavenumber[1:], "1/m", "wavenumber, cycles per metre")
    return result
