"""Coordinates of a file to a uniform grid."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from asperity.errors import InputError

TOLERANCE = 0.05  # largest distance of a point from the grid, in spacings
SPARSEST = 0.5  # smallest share of grid points that must be there

_REMEDY = "Resample the heights at a uniform spacing first."


def uniform_step(coordinates: NDArray[np.float64], source: str, name: str) -> float:
    """Return the signed step of coordinates (n,) that must be uniform, within 0.05 steps of their places.

    That is (last - first) / (n - 1), negative for falling coordinates; source and name are for the message.
    """
    n = len(coordinates)
    step = float(coordinates[-1] - coordinates[0]) / (n - 1) if n > 1 else 0.0
    off = np.abs(coordinates - coordinates[0] - step * np.arange(n))
    if not (np.isfinite(step) and step != 0 and np.all(off <= TOLERANCE * abs(step))):
        allowed = f"at least two points at a uniform spacing (within {TOLERANCE} of it)"
        raise InputError(f"{name} of {source}", "coordinates that are not uniform", allowed, _REMEDY)
    return step


def line(x: NDArray[np.float64], z: NDArray[np.float64], source: str) -> tuple[NDArray[np.float64], float]:
    """Put points x, z, given in any order, on the uniform line that they lie on.

    Returns the heights along rising x, NaN where the line has no point, and the spacing, in the units given.
    Refused are points that stand twice, or fill less than half of the line.
    """
    index, spacing = _indices(x, source, "x", np.diff(np.sort(x)))
    return _filled_in(index, z, (int(index.max()) + 1,), source), spacing


def rasterised(
    x: NDArray[np.float64], y: NDArray[np.float64], z: NDArray[np.float64], source: str
) -> tuple[NDArray[np.float64], tuple[float, float]]:
    """Sort points x, y, z, given in any order, into the regular grid that they lie on.

    Returns the heights (nx, ny) along rising x and y, NaN where the grid has no point, and (dx, dy), in the
    units given. Refused are points that stand twice, or fill less than half of the grid.
    """
    (i, dx), (j, dy) = _indices(x, source, "x", _steps(x)), _indices(y, source, "y", _steps(y))
    shape = (int(i.max()) + 1, int(j.max()) + 1)
    return _filled_in(i * shape[1] + j, z, shape, source), (dx, dy)


def _filled_in(
    index: NDArray[np.intp], z: NDArray[np.float64], shape: tuple[int, ...], source: str
) -> NDArray[np.float64]:
    _check_share(source, shape, len(z))
    if len(np.unique(index)) != len(index):
        raise InputError(source, "several points at one place", "one height per grid point", _REMEDY)
    heights = np.full(math.prod(shape), np.nan)
    heights[index] = z
    return heights.reshape(shape)


def _steps(coordinates: NDArray[np.float64]) -> NDArray[np.float64]:
    """Gaps between grid lines; smaller ones are rounding within one grid line."""
    gaps = np.diff(np.sort(coordinates))
    return gaps[gaps > 0.5 * gaps.max(initial=0.0)]


def _indices(
    coordinates: NDArray[np.float64], source: str, name: str, steps: NDArray[np.float64]
) -> tuple[NDArray[np.intp], float]:
    what = f"{name} of {source}"
    if not np.isfinite(coordinates).all():
        raise InputError(what, "missing or infinite coordinates", "a coordinate for each point", _REMEDY)
    step = float(np.median(steps)) if len(steps) else 0.0
    if step <= 0:
        raise InputError(what, "fewer than two different coordinates", "at least two", _REMEDY)
    origin, extent = coordinates.min(), np.ptp(coordinates)
    step = float(extent / round(extent / step))
    index = np.rint((coordinates - origin) / step)
    if np.abs(coordinates - origin - index * step).max() > TOLERANCE * step:
        allowed = f"coordinates at a uniform spacing (within {TOLERANCE} of it)"
        raise InputError(what, "coordinates that are not uniform", allowed, _REMEDY)
    return index.astype(np.intp), step


def _check_share(source: str, shape: tuple[int, ...], points: int) -> None:
    """Raise an `InputError` if the points fill less than half of the grid, before it is allocated."""
    if math.prod(shape) * SPARSEST > points:
        received = f"{points} points that would need a grid of {' x '.join(str(n) for n in shape)}"
        raise InputError(source, received, "points on a regular grid", _REMEDY)
