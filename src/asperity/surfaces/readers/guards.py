"""Guards at the door: every file is treated as hostile until its claims are checked against its bytes."""

import math
import zipfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from asperity.arguments import Array, NDArray, file_path, listed, no_file, require
from asperity.errors import InputError, reason
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.readers.hints import advice
from asperity.text_files import number_in
from asperity.written_numbers import count_of

MAX_FILE_BYTES = 4 << 30  # largest file, and largest content of an archive
MAX_XML_BYTES = 16 << 20
MAX_POINTS = 1 << 28  # 2 GiB of float64 heights
MAX_RATIO = 200  # uncompressed to compressed size of an archive ...
RATIO_FREE_BYTES = 16 << 20  # ... which is checked above this size only

EXPORT = "Export the file again."
Surface = HeightMap | Profile


def readable_file(path: str | Path, what: str = "heights") -> Path:
    """Check that a path is a readable, non-empty file, no pipe and no device, of at most 4 GiB.

    Messages say that it should hold heights, or what else is asked for.
    """
    allowed = f"a file with {what}"
    file = file_path(allowed.removeprefix("a "), path, "the path of a file")
    received = no_file(file)
    remedies = {"a folder": "Name a file inside it.", "an empty file": "Export it again."}
    require(not received, str(file), received, allowed, remedies.get(received, "Check the path."))
    try:
        with file.open("rb"):
            size = file.stat().st_size
    except OSError as error:
        received = f"a file that cannot be read ({error.strerror})"
        raise InputError(str(file), received, allowed, "Check its permissions.") from None
    allowed = f"at most {MAX_FILE_BYTES} bytes"
    remedy = "Crop or split the measurement."
    require(size <= MAX_FILE_BYTES, f"size of {file.name}", count_of(size, "byte"), allowed, remedy)
    return file


@contextmanager
def hostile(source: str, kind: str) -> Iterator[None]:
    """Turn whatever goes wrong while decoding a file of some kind into an `InputError`."""
    try:
        yield
    except InputError:
        raise
    except Exception as error:  # malformed bytes surface as many kinds of exception
        received = f"{reason(error)} while it was opened"
        remedy = "The file is damaged or not of this format; export it again."
        raise InputError(source, received, f"an intact {kind} file", remedy) from error


def check_claim(source: str, shape: Sequence[int], item_bytes: float, available: int) -> int:
    """Compare the points that a header claims with the bytes that follow it, before anything is allocated.

    Returns their number: at least one along each axis, at most 2**28, and no more than the bytes can hold.
    """
    points = math.prod(shape)
    received = f"{' x '.join(str(n) for n in shape)} points in {available} bytes"
    require(min(shape, default=0) >= 1, source, received, "at least one point along each axis", EXPORT)
    few = points <= MAX_POINTS
    require(few, source, received, f"at most {MAX_POINTS} points", "Crop or split the measurement.")
    needed = math.ceil(points * item_bytes)
    allowed = f"at least {needed} bytes for so many points"
    remedy = "The file is truncated; copy or export it again."
    require(points * item_bytes <= available, source, received, allowed, remedy)
    return points


WHOLE = ("a whole number above zero", lambda value: value == int(value) and 1 <= value <= 1e12)
"""What is allowed as a number of points, and whether it fits, for `header_number`."""


def header_number(
    source: str,
    name: str,
    text: str | None,
    allowed: str = "a finite number",
    fits: Callable[[float], bool] = math.isfinite,
) -> float:
    """Parse a field of a header that must be one finite number, and fit what is allowed there."""
    try:
        value = number_in("nan" if text is None else text)
    except ValueError:
        value = math.nan
    what = f"{name} in {source}"
    received = "nothing" if text is None else repr(text[:40])
    require(math.isfinite(value), what, received, "a finite number", EXPORT)
    require(fits(value), what, value, allowed, EXPORT)
    return value


@contextmanager
def archive(path: Path) -> Iterator[zipfile.ZipFile]:
    """Open a zip archive whose members are of bounded size; they are unpacked into memory alone.

    Refused are damaged ones, and what would unpack to more than 4 GiB or to more than 200 times its size (zip
    bomb).
    """
    with zipfile.ZipFile(path) as opened:
        unpacked = sum(member.file_size for member in opened.infolist())
        packed = max(path.stat().st_size, 1)
        bounded = unpacked <= min(MAX_FILE_BYTES, max(RATIO_FREE_BYTES, MAX_RATIO * packed))
        received = f"{packed} bytes that unpack to {unpacked}"
        allowed = f"at most {MAX_RATIO} times the packed size and {MAX_FILE_BYTES} bytes"
        require(bounded, path.name, received, allowed, "Store the data uncompressed if it is genuine.")
        yield opened


def member_bytes(opened: zipfile.ZipFile, name: str, source: str, limit: int = MAX_FILE_BYTES) -> bytes:
    """Unpack one member of an archive, never more than `limit` bytes."""
    names = opened.namelist()
    require(name in names, source, f"no member {name[:80]!r}", f"one of: {listed(names)}", EXPORT)
    with opened.open(name) as stream:
        data = stream.read(limit + 1)
    received = f"more than {limit} bytes in {name}"
    require(len(data) <= limit, source, received, f"at most {limit}", "Do not trust it.")
    return data


def parse_xml(data: bytes, source: str) -> ElementTree.Element:
    """Parse XML, in UTF-8 or UTF-16, that declares no document type and no entity."""
    utf16 = data[:2] in (b"\xff\xfe", b"\xfe\xff")
    text = data.decode("utf-16" if utf16 else "utf-8-sig")
    plain = "<!DOCTYPE" not in text.upper() and "<!ENTITY" not in text.upper()
    received = "an XML document type or entity"
    allowed = "XML without document type and entities"
    require(plain, source, received, allowed, "Do not trust this file.")
    # decoded text: the parser sees exactly what was checked, whatever encoding the document claims
    return ElementTree.fromstring(text)  # noqa: S314


def surfaces_of(array: NDArray[Any], spacing: tuple[float, float], source: str) -> list[Surface]:
    """Wrap a bare array of heights, m: one axis is a line, two are a map, x first, three are maps.

    A 2-D array with a single row or column is a line, too: of the spacing (dx, dy), m, one along x takes dx,
    one along y dy. Nobody else writes to the array, or to what it is a view of: it is kept as it is.
    """
    for fixed in (array, array.base):
        if isinstance(fixed, np.ndarray):
            fixed.flags.writeable = False
    if array.ndim == 3 and len(array):
        return [HeightMap(sample, spacing, f"{source}[{i}]") for i, sample in enumerate(array)]
    if array.ndim == 2 and array.shape[0] == 1:
        return [Profile(array[0], spacing[1], source)]
    if array.ndim == 1 or (array.ndim == 2 and array.shape[1] == 1):
        return [Profile(array.ravel(), spacing[0], source)]
    allowed = "1 (a line), 2 (a map) or 3 (an ensemble of maps) axes, none empty"
    remedy = _of_several(source, "Select one", "Keep one map or line in the file.")
    require(array.ndim == 2, source, f"an array of shape {array.shape}", allowed, remedy)
    return [HeightMap(array, spacing, source)]


def _of_several(source: str, lead: str, otherwise: str) -> str:
    """Advise to name another array, where the source says which one of a file was read."""
    return advice("array", "name", f"{lead}, as in", otherwise) if ":" in source else otherwise


MARKED = 1e30
"""Size from which a number marks a missing point: no height is as large in any unit.

The largest numbers of both floating point types do so, 1.70141e38 of Surfer, 1e37 of netCDF.
"""


def without_marks(array: NDArray[Any]) -> NDArray[Any]:
    """Array with NaN where numbers stand that mark a missing point.

    Of a floating point they are those beyond any height, of either sign. Of signed whole numbers of two bytes
    and more it is the smallest: what NaN becomes when it is cast, and what instruments write. One without
    such numbers is returned as it is.
    """
    if array.dtype.itemsize < 2 or not array.size:
        return array
    if array.dtype.kind == "i":
        missing = array == np.iinfo(array.dtype).min
        return np.where(missing, np.nan, array) if missing.any() else array
    if array.dtype.kind != "f" or array.dtype.itemsize < 4:
        return array
    if np.fmin.reduce(array, axis=None) > -MARKED and np.fmax.reduce(array, axis=None) < MARKED:
        return array
    return np.where(np.isfinite(array) & (np.abs(array) >= MARKED), np.array(np.nan, array.dtype), array)


def numbers_alone(array: NDArray[Any], source: str) -> NDArray[Any]:
    """Return an array as it is, if it holds real numbers."""
    remedy = _of_several(source, "Select another one", "Keep numbers alone in the file.")
    allowed = "real numbers"
    require(array.dtype.kind in "fiu", source, f"data of type {array.dtype}", allowed, remedy)
    return array


def scaled(array: NDArray[Any], unit: float, source: str) -> Array:
    """Return real numbers times the length of their unit, m, as float64."""
    numbers = numbers_alone(array, source).astype(np.float64)
    with np.errstate(over="ignore", invalid="ignore"):  # infinite heights are refused by name afterwards
        numbers *= unit
    return numbers
