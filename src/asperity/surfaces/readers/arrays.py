"""Bare arrays: ``.npy`` and ``.npz``, never unpickled."""

from __future__ import annotations

import io
import math
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np
from numpy.typing import NDArray

from asperity.arguments import Array, listed, shown
from asperity.errors import InputError
from asperity.surfaces.readers.guards import (
    Hints,
    Surface,
    archive,
    check_claim,
    hostile,
    member_bytes,
    scaled,
    surfaces_of,
)
from asperity.surfaces.readers.headers import advice

HEADER = 128
"""Bytes in which the header of a scalar ends."""


def read_npy(path: Path, hints: Hints) -> list[Surface]:
    """Read a ``.npy`` array of one axis as a line, of two as a map, x first, of three as maps, sample first.

    The hints `height_unit` and `pixel` are required; Python objects are refused.
    """
    with hostile(path.name, "npy"):
        return _surfaces(_decoded(path.read_bytes(), path.name), hints, path.name)


def read_npz(path: Path, hints: Hints) -> list[Surface]:
    """Read the array of a ``.npz`` archive that the hints name, or the only one that is no scalar.

    See `read_npy`.
    """
    with archive(path) as opened, hostile(path.name, "npz"):
        names = [name.removesuffix(".npy") for name in opened.namelist() if name.endswith(".npy")]
        members = {name: f"{name}.npy" for name in names}
        chosen = hints.array
        if chosen is None:  # scalars such as a pixel size do not count
            chosen = only_one([name for name in names if _has_axes(opened, members[name])], path.name)
        if chosen not in members:
            allowed = f"one of: {listed(names)}"
            raise InputError(f"array in {path.name}", shown(chosen), allowed, "Choose one.")
        array = _decoded(member_bytes(opened, members[chosen], path.name), path.name)
        return _surfaces(array, hints, f"{path.name}:{chosen}")


def _has_axes(opened: ZipFile, member: str) -> bool:
    """Whether a member holds more than a single number; nothing but its header is unpacked."""
    with opened.open(member) as stream:
        return "'shape': ()" not in stream.read(HEADER).decode("latin-1")


def only_one(names: list[str], source: str) -> str:
    """Return the only array's name that could be meant, or raise an `InputError` that lists the choice."""
    if len(names) == 1:
        return names[0]
    received = listed(names) or "none"
    remedy = advice("array", names[0], "Choose one, as in", "Keep one in the file.") if names else ""
    raise InputError(f"arrays of heights in {source}", received, "exactly one", remedy)


def _decoded(data: bytes, source: str) -> NDArray[Any]:
    stream = io.BytesIO(data)
    version = np.lib.format.read_magic(stream)
    readers = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
    if version not in readers:
        raise InputError(source, f"npy version {version}", "version 1.0 or 2.0", "Save it with numpy.save.")
    shape, fortran, kind = readers[version](stream)
    if kind.hasobject or kind.itemsize == 0:
        allowed = "numbers; Python objects are never unpickled"
        raise InputError(source, f"an array of type {kind}", allowed, "Save the heights as a float array.")
    points = check_claim(source, shape, kind.itemsize, len(data) - stream.tell()) if shape else 1
    flat = np.frombuffer(data, kind, points, stream.tell())
    return flat.reshape(shape, order="F" if fortran else "C")


def _surfaces(array: NDArray[Any], hints: Hints, source: str) -> list[Surface]:
    heights = scaled(array, hints.heights_in(source), source)
    return surfaces_of(heights, hints.spacing_in(source), source)


TOLERANCE = 0.05  # largest distance of a point from the grid, in spacings
SPARSEST = 0.5  # smallest share of grid points that must be there

_REMEDY = "Resample the heights at a uniform spacing first."


def uniform_step(coordinates: Array, source: str, name: str) -> float:
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


def line(x: Array, z: Array, source: str) -> tuple[Array, float]:
    """Put points x, z, given in any order, on the uniform line that they lie on.

    Returns the heights along rising x, NaN where the line has no point, and the spacing, in the units given.
    Refused are points that stand twice, or fill less than half of the line.
    """
    index, spacing = _indices(x, source, "x", np.diff(np.sort(x)))
    return _filled_in(index, z, (int(index.max()) + 1,), source), spacing


def rasterised(x: Array, y: Array, z: Array, source: str) -> tuple[Array, tuple[float, float]]:
    """Sort points x, y, z, given in any order, into the regular grid that they lie on.

    Returns the heights (nx, ny) along rising x and y, NaN where the grid has no point, and (dx, dy), in the
    units given. Refused are points that stand twice, or fill less than half of the grid.
    """
    (i, dx), (j, dy) = _indices(x, source, "x", _steps(x)), _indices(y, source, "y", _steps(y))
    shape = (int(i.max()) + 1, int(j.max()) + 1)
    return _filled_in(i * shape[1] + j, z, shape, source), (dx, dy)


def _filled_in(index: NDArray[np.intp], z: Array, shape: tuple[int, ...], source: str) -> Array:
    _check_share(source, shape, len(z))
    if len(np.unique(index)) != len(index):
        raise InputError(source, "several points at one place", "one height per grid point", _REMEDY)
    heights = np.full(math.prod(shape), np.nan)
    heights[index] = z
    return heights.reshape(shape)


def _steps(coordinates: Array) -> Array:
    """Gaps between grid lines; smaller ones are rounding within one grid line."""
    gaps = np.diff(np.sort(coordinates))
    return gaps[gaps > 0.5 * gaps.max(initial=0.0)]


def _indices(coordinates: Array, source: str, name: str, steps: Array) -> tuple[NDArray[np.intp], float]:
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
