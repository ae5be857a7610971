"""Bare arrays, ``.npy`` and ``.npz``, never unpickled."""

import io
import re
from collections.abc import Collection
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np

from asperity.arguments import NDArray, listed, require, shown
from asperity.surfaces.readers import guards, positions
from asperity.surfaces.readers.hints import Hints, advice

COORDINATES = ("x", "y", "t", "time", "dx", "dy")
"""Names of arrays that are rarely meant."""
MOST_TRIED = 1000
"""Rows by which it is told whether their first column holds positions."""
HEADER = 128
"""Bytes in which the header of a scalar ends."""


def read_npy(path: Path, hints: Hints) -> list[guards.Surface]:
    """Read a ``.npy`` array of one axis as a line, of two as a map, x first, of three as maps, sample first.

    The hints `height_unit` and `pixel` are required; Python objects are refused.
    """
    return surfaces_of_array(array_in(path.read_bytes(), path.name), hints, path.name)


def read_npz(path: Path, hints: Hints) -> list[guards.Surface]:
    """Read the array of a ``.npz`` archive that the hints name, or the only one that is no scalar.

    See `read_npy`.
    """
    name, data = array_of_archive(path, hints.array)
    return surfaces_of_array(array_in(data, path.name), hints, f"{path.name}:{name}")


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
        return not _SINGLE.search(stream.read(HEADER).decode("latin-1"))


_SINGLE = re.compile(r"'shape': \((?:1, ?)*1?\)")


def beside_in_archive(path: Path, words: Collection[str]) -> dict[str, NDArray[Any]]:
    """Arrays of numbers in a ``.npz`` archive whose names are some words, see `plain_word`."""
    with guards.archive(path) as opened:
        names = [name.removesuffix(".npy") for name in opened.namelist() if name.endswith(".npy")]
        wanted = [name for name in names if plain_word(name) in words]
        held = {name: guards.member_bytes(opened, f"{name}.npy", path.name) for name in wanted}
    found = {name: array_in(data, path.name) for name, data in held.items()}
    return {name: array for name, array in found.items() if array.dtype.kind in "fiu"}


def plain_word(name: str) -> str:
    """Letters of a name, or of its last part if dots are in it, all small: ``"samplingrate"``."""
    return re.sub(r"[^a-zµ]", "", name.rpartition(".")[2].lower()).replace("µ", "u")


def only_one(names: list[str], source: str, what: str = "heights") -> str:
    """Return the only array's name that could be meant, or raise an `InputError` that lists the choice."""
    likely = [name for name in names if name.lower() not in COORDINATES] or names[::-1]
    remedy = "Save it as an array of real numbers by itself, in no cell."
    if names:
        remedy = advice("array", likely[0], "Choose one, as in", "Keep one in the file.")
    named = f"arrays of {what} in {source}"
    received = listed(names) or "none"
    require(len(names) == 1, named, received, "exactly one", remedy)
    return names[0]


def surfaces_of_array(array: NDArray[Any], hints: Hints, source: str) -> list[guards.Surface]:
    """Surfaces that an array without units holds, of which the hints tell the rest, see `read_npy`."""
    for turned in (array, array.T) if array.ndim == 2 and array.dtype.kind in "fiu" else ():
        first, *others = turned[:MOST_TRIED].T.astype(np.float64)
        received = "even positions beside heights"
        remedy = "Save the heights alone, and give the pixel size."
        bare = not positions.are_even(first) or not others or all(map(positions.are_even, others))
        require(bare, source, received, "heights alone", remedy)
    heights = guards.scaled(guards.without_marks(array), hints.heights_in(source), source)
    return guards.surfaces_of(heights, hints.spacing_in(source), source)


def array_in(data: bytes, file: str) -> NDArray[Any]:
    """Array that the bytes of a ``.npy`` file hold, once its claims are checked against them."""
    stream = io.BytesIO(data)
    version = np.lib.format.read_magic(stream)
    readers = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
    received = f"npy version {version}"
    allowed = "version 1.0 or 2.0"
    require(version in readers, file, received, allowed, "Save it with numpy.save.")
    shape, fortran, kind = readers[version](stream)
    allowed = "numbers; Python objects are never unpickled"
    remedy = "Save it as a float array."
    numbers = not kind.hasobject and kind.itemsize > 0
    require(numbers, file, f"an array of type {kind}", allowed, remedy)
    points = guards.check_claim(file, shape, kind.itemsize, len(data) - stream.tell()) if shape else 1
    flat: NDArray[Any] = np.frombuffer(data, kind, points, stream.tell())
    return flat.reshape(shape, order="F" if fortran else "C")
