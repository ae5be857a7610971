"""The textures of a finer or wider layout, restricted to a coarser or narrower one: the same surface."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from asperity.errors import InputError
from asperity.scenarios.textures import Textures
from asperity.spectra import psd
from asperity.surfaces.heightmap import HeightMap

MOST_POINTS = 2**27
"""Points of a path that is held at once: 1 GiB."""
SHORT_WAVES = 1e-4
"""Share of the mean square slope in waves that a coarser grid does not hold, from which they are removed."""
SEGMENTS = 8
"""Segments of the spectrum in which such waves are looked for."""


def restricted(textures: Textures, spacing: float, every: int, lines: int) -> Textures:
    """Restrict textures to a layout of fewer points.

    Parameters
    ----------
    textures : Textures
        Of the finer or wider layout.
    spacing : float
        Its spacing, m.
    every : int
        Every which point is kept, in both directions; where the record starts, one is.
    lines : int
        Points across that are kept of path and strips, about the middle one; odd.

    Returns
    -------
    Textures
        The same heights at fewer points, without the waves that only the finer grid holds, if there are any.

    Raises
    ------
    InputError
        If the path is too long to be held at once.
    """
    smooth = every > 1 and _short_waves(textures.line, every) > SHORT_WAVES
    first = textures.before % every

    def along(line: NDArray[np.float64]) -> NDArray[np.float64]:
        return (_long_waves(line, every) if smooth else line)[first::every]

    def area(heights: NDArray[np.float64], phase: int, kept: int | None) -> NDArray[np.float64]:
        found = _long_waves(heights, every) if smooth else heights
        middle = heights.shape[1] // 2
        reach = (middle if kept is None else kept // 2 * every) // every * every
        return found[phase::every, middle - reach : middle + reach + 1 : every]

    def thinned(surface: HeightMap, kept: int | None) -> HeightMap:
        return replace(surface, heights=area(surface.heights, 0, kept), spacing=(wide, wide))

    wide = every * spacing
    path = _held_path(textures, spacing)
    if path is not None:
        path = HeightMap(area(path.heights, first, lines), (wide, wide), path.source)
    line = along(textures.line) if path is None else path.heights[:, path.shape[1] // 2].copy()
    strips = tuple(thinned(strip, lines) for strip in textures.strips)
    every_map = tuple(thinned(one, None) for one in textures.maps)
    before = (textures.before - first) // every
    recorded = -(-(len(textures.line) - textures.before - textures.beyond - 1) // every) + 1
    return replace(
        textures,
        maps=strips if textures.maps is textures.strips else every_map,
        strips=strips,
        path=path,
        line=line,
        start=textures.start + first * spacing,
        before=before,
        beyond=len(line) - before - recorded,
        parts={name: along(part) for name, part in textures.parts.items()},
        defects=None if textures.defects is None else textures.defects[first::every],
        trajectory=None if textures.trajectory is None else textures.trajectory[first::every],
    )


def _held_path(textures: Textures, spacing: float) -> HeightMap | None:
    """The path in memory, if there is one."""
    path = textures.path
    if path is None or isinstance(path, HeightMap):
        return path
    rows, across = path.shape
    if rows * across > MOST_POINTS:
        received = f"a path of {rows} x {across} points"
        raise InputError("path", received, f"at most {MOST_POINTS} points, to be compared on another grid")
    return HeightMap(path.rows(0, rows), (spacing, spacing))


def _short_waves(line: NDArray[np.float64], every: int) -> float:
    """Share of the mean square slope of a line in waves of less than two of every so many points."""
    wavenumber, density = psd(line, 1.0, segment=max(16, len(line) // SEGMENTS))
    slope = wavenumber**2 * density
    beyond = wavenumber > 1.1 * 0.5 / every  # the window smears what lies at the limit
    return float(slope[beyond].sum() / slope.sum()) if slope.any() else 0.0


def _long_waves(heights: NDArray[np.float64], every: int) -> NDArray[np.float64]:
    """Heights (n, ...) without waves of less than two of every so many points, by cosine series."""
    found = heights
    for axis, points in enumerate(heights.shape):
        series = np.moveaxis(fft.dct(found, axis=axis), axis, 0)
        series[points // every + 1 :] = 0.0  # term k has the wavelength 2 points/k
        found = fft.idct(np.moveaxis(series, 0, axis), axis=axis)
    return np.asarray(found)
