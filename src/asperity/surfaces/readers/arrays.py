"""Bare arrays, ``.npy`` and ``.npz``, never unpickled; and points on a line or a grid as arrays."""

import io
import math
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np

from asperity.arguments import Array, NDArray, listed, require, shown
from asperity.surfaces.readers import guards
from asperity.surfaces.readers.hints import Hints, advice

HEADER = 128
"""Bytes in which the header of a scalar ends."""
TOLERANCE = 0.05
"""Largest distance of a point from the grid, in spacings."""
SPARSEST = 0.5
"""Smallest share of grid points that must be there."""
RESAMPLE = "Resample the heights at a uniform spacing first."
UNEVEN = "coordinates that are not uniform"
Index = NDArray[np.intp]


def read_npy(path: Path, hints: Hints) -> list[guards.Surface]:
    """Read a ``.npy`` array of one axis as a line, of two as a map, x first, of three as maps, sample first.

    The hints `height_unit` and `pixel` are required; Python objects are refused.
    """
    return _surfaces(path.read_bytes(), hints, path.name, path.name)


def read_npz(path: Path, hints: Hints) -> list[guards.Surface]:
    """Read the array of a ``.npz`` archive that the hints name, or the only one that is no scalar.

    See `read_npy`.
    """
    name, data = array_of_archive(path, hints.array)
    return _surfaces(data, hints, path.name, f"{path.name}:{name}")


def array_of_archive(path: Path, name: str | None, what: str = "heights") -> tuple[str, bytes]:
    """Name and bytes of the array that is named in a ``.npz`` archive, or of the only one that is no scalar.

    `what` it should hold is for messages.
    """
    with guards.archive(path) as opened:
        names = [name.removesuffix(".npy") for name in opened.namelist() if name.endswith(".npy")]
        if name is None:  # scalars such as a pixel size do not count
            name = only_one([each for each in names if _has_axes(opened, each)], path.name, what)
        allowed = f"one of: {listed(names)}"
        require(name in names, f"array in {path.name}", shown(name), allowed, "Choose one.")
        return name, guards.member_bytes(opened, f"{name}.npy", path.name)


def _has_axes(opened: ZipFile, name: str) -> bool:
    """Whether an array holds more than a single number; nothing but its header is unpacked."""
    with opened.open(f"{name}.npy") as stream:
        return "'shape': ()" not in stream.read(HEADER).decode("latin-1")


def only_one(names: list[str], source: str, what: str = "heights") -> str:
    """Return the only array's name that could be meant, or raise an `InputError` that lists the choice."""
    remedy = advice("array", names[0], "Choose one, as in", "Keep one in the file.") if names else ""
    named, received = f"arrays of {what} in {source}", listed(names) or "none"
    require(len(names) == 1, named, received, "exactly one", remedy)
    return names[0]


def _surfaces(data: bytes, hints: Hints, file: str, source: str) -> list[guards.Surface]:
    heights = guards.scaled(array_in(data, file), hints.heights_in(source), source)
    return guards.surfaces_of(heights, hints.spacing_in(source), source)


def array_in(data: bytes, file: str) -> NDArray[Any]:
    """Array that the bytes of a ``.npy`` file hold, once its claims are checked against them."""
    stream = io.BytesIO(data)
    version = np.lib.format.read_magic(stream)
    readers = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
    received, allowed = f"npy version {version}", "version 1.0 or 2.0"
    require(version in readers, file, received, allowed, "Save it with numpy.save.")
    shape, fortran, kind = readers[version](stream)
    allowed, remedy = "numbers; Python objects are never unpickled", "Save it as a float array."
    numbers = not kind.hasobject and kind.itemsize > 0
    require(numbers, file, f"an array of type {kind}", allowed, remedy)
    points = guards.check_claim(file, shape, kind.itemsize, len(data) - stream.tell()) if shape else 1
    flat: NDArray[Any] = np.frombuffer(data, kind, points, stream.tell())
    return flat.reshape(shape, order="F" if fortran else "C")


def line(x: Array, z: Array, source: str) -> tuple[Array, float]:
    """Put points x, z, given in any order, on the uniform line that they lie on.

    Returns the heights along rising x, NaN where the line has no point, and the spacing, in the units given.
    Refused are points that stand twice, or fill less than half of the line.
    """
    index, spacing = places(x, f"x of {source}", np.diff(np.sort(x)))
    return _gridded(index, z, (int(index.max()) + 1,), source), spacing


def rasterised(x: Array, y: Array, z: Array, source: str) -> tuple[Array, tuple[float, float]]:
    """Sort points x, y, z, given in any order, into the regular grid that they lie on.

    Returns the heights (nx, ny) along rising x and y, NaN where the grid has no point, and (dx, dy), in the
    units given. Refused are points that stand twice, or fill less than half of the grid.
    """
    (i, dx), (j, dy) = (places(v, f"{name} of {source}", _steps(v)) for name, v in (("x", x), ("y", y)))
    shape = (int(i.max()) + 1, int(j.max()) + 1)
    return _gridded(i * shape[1] + j, z, shape, source), (dx, dy)


def _gridded(index: Index, z: Array, shape: tuple[int, ...], source: str) -> Array:
    """Heights on a grid; that points fill half of it is known before it is allocated."""
    received = f"{len(z)} points that would need a grid of {' x '.join(str(n) for n in shape)}"
    dense = math.prod(shape) * SPARSEST <= len(z)
    require(dense, source, received, "points on a regular grid", RESAMPLE)
    single, received = len(np.unique(index)) == len(index), "several points at one place"
    require(single, source, received, "one height per grid point", RESAMPLE)
    heights = np.full(math.prod(shape), np.nan)
    heights[index] = z
    return heights.reshape(shape)


def _steps(coordinates: Array) -> Array:
    """Gaps between grid lines; smaller ones are rounding within one grid line."""
    gaps = np.diff(np.sort(coordinates))
    return gaps[gaps > 0.5 * gaps.max(initial=0.0)]


def places(coordinates: Array, what: str, gaps: Array) -> tuple[Index, float]:
    """Number the places of coordinates on a uniform line, from zero on, and return its spacing.

    Each is within 0.05 spacings of its place. `gaps` are distances of neighbours, of which the median is one
    spacing; `what` they are is for messages.
    """
    finite, received = np.isfinite(coordinates).all(), "missing or infinite coordinates"
    require(finite, what, received, "a coordinate for each point", RESAMPLE)
    step = float(np.median(gaps)) if len(gaps) else 0.0
    require(step > 0, what, "fewer than two different coordinates", "at least two", RESAMPLE)
    origin, extent = coordinates.min(), np.ptp(coordinates)
    step = float(extent / round(extent / step))
    index = np.rint((coordinates - origin) / step)
    uniform = np.abs(coordinates - origin - index * step).max() <= TOLERANCE * step
    allowed = f"coordinates at a uniform spacing (within {TOLERANCE} of it)"
    require(uniform, what, UNEVEN, allowed, RESAMPLE)
    return index.astype(np.intp), step
