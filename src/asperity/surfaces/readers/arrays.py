"""Bare arrays: ``.npy`` and ``.npz``, never unpickled."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np
from numpy.typing import NDArray

from asperity.arguments import listed, shown
from asperity.errors import InputError
from asperity.surfaces.readers.guards import archive, check_claim, hostile, member_bytes
from asperity.surfaces.readers.hints import Hints, Surface, scaled, surfaces_of
from asperity.surfaces.readers.spelling import advice

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
