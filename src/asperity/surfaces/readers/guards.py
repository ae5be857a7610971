"""Guards at the door: every file is treated as hostile until its claims are checked against its bytes."""

from __future__ import annotations

import math
import zipfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields
from pathlib import Path, PurePosixPath
from typing import Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from asperity.arguments import Array, file_path, listed, no_file, real, shown
from asperity.errors import InputError, reason
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.readers.headers import advice, spell
from asperity.text_files import number_in
from asperity.units import factor, quantity

MAX_FILE_BYTES = 4 << 30  # largest file, and largest content of an archive
MAX_XML_BYTES = 16 << 20
MAX_POINTS = 1 << 28  # 2 GiB of float64 heights
MAX_RATIO = 200  # uncompressed to compressed size of an archive ...
RATIO_FREE_BYTES = 16 << 20  # ... which is checked above this size only
MAX_MEMBERS = 10_000


def readable_file(path: str | Path) -> Path:
    """Check that a path is a readable, non-empty file, no pipe and no device, of at most 4 GiB."""
    file = file_path("surface file", path, "the path of a file")
    allowed = "a file with heights"
    if received := no_file(file):
        remedies = {"a folder": "Name a file inside it.", "an empty file": "Export it again."}
        raise InputError(str(file), received, allowed, remedies.get(received, "Check the path."))
    try:
        with file.open("rb"):
            size = file.stat().st_size
    except OSError as error:
        received = f"a file that cannot be read ({error.strerror})"
        raise InputError(str(file), received, allowed, "Check its permissions.") from None
    if size > MAX_FILE_BYTES:
        allowed = f"at most {MAX_FILE_BYTES} bytes"
        raise InputError(f"size of {file.name}", f"{size} bytes", allowed, "Crop or split the measurement.")
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
    if min(shape, default=0) < 1:
        raise InputError(source, received, "at least one point along each axis", "Export the file again.")
    if points > MAX_POINTS:
        raise InputError(source, received, f"at most {MAX_POINTS} points", "Crop or split the measurement.")
    if points * item_bytes > available:
        allowed = f"at least {math.ceil(points * item_bytes)} bytes for so many points"
        raise InputError(source, received, allowed, "The file is truncated; copy or export it again.")
    return points


def header_number(source: str, name: str, text: str | None) -> float:
    """Parse a field of a header that must be one finite number."""
    try:
        value = number_in(text if text is not None else "nan")
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        shown = "nothing" if text is None else repr(text[:40])
        raise InputError(f"{name} in {source}", shown, "a finite number", "Export the file again.")
    return value


def count(source: str, name: str, text: str | None) -> int:
    """Parse one number of points of a header, see `header_number`."""
    value = header_number(source, name, text)
    if value != int(value) or not 1 <= value <= 1e12:
        raise InputError(f"{name} in {source}", value, "a whole number above zero", "Export the file again.")
    return int(value)


@contextmanager
def archive(path: Path) -> Iterator[zipfile.ZipFile]:
    """Open a zip archive whose members have safe names and bounded sizes; nothing is unpacked yet.

    Refused are damaged and encrypted ones, names that leave the archive or stand twice, and what would unpack
    to more than 4 GiB or to more than 200 times its size (zip bomb).
    """
    with hostile(path.name, "zip"), zipfile.ZipFile(path) as opened:
        members = opened.infolist()
        _check_names(path.name, members)
        unpacked = sum(member.file_size for member in members)
        packed = max(path.stat().st_size, 1)
        if unpacked > MAX_FILE_BYTES or unpacked > max(RATIO_FREE_BYTES, MAX_RATIO * packed):
            received = f"{packed} bytes that unpack to {unpacked}"
            allowed = f"at most {MAX_RATIO} times the packed size and {MAX_FILE_BYTES} bytes"
            raise InputError(path.name, received, allowed, "Store the data uncompressed if it is genuine.")
        yield opened


def _check_names(source: str, members: list[zipfile.ZipInfo]) -> None:
    allowed = "unencrypted members with unique names inside the archive"
    remedy = "Do not trust this file; export it again."
    if len(members) > MAX_MEMBERS:
        raise InputError(source, f"{len(members)} members", f"at most {MAX_MEMBERS}", remedy)
    names = [member.filename for member in members]
    for member, name in zip(members, names, strict=True):
        path = PurePosixPath(name.replace("\\", "/"))
        if path.is_absolute() or ".." in path.parts or ":" in name:
            raise InputError(source, f"a member named {name[:80]!r}", allowed, remedy)
        if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            raise InputError(source, f"the member {name[:80]!r} compressed in a rare way", "deflate", remedy)
        if member.flag_bits & 1:
            raise InputError(source, f"the encrypted member {name[:80]!r}", allowed, remedy)
    if len(set(names)) != len(names):
        raise InputError(source, "two members of one name", allowed, remedy)


def member_bytes(opened: zipfile.ZipFile, name: str, source: str, limit: int = MAX_FILE_BYTES) -> bytes:
    """Unpack one member of an archive, never more than `limit` bytes."""
    if name not in opened.namelist():
        present = f"one of: {listed(opened.namelist())}"
        raise InputError(source, f"no member {name[:80]!r}", present, "Export the file again.")
    with opened.open(name) as stream:
        data = stream.read(limit + 1)
    if len(data) > limit:
        raise InputError(source, f"more than {limit} bytes in {name}", f"at most {limit}", "Do not trust it.")
    return data


def parse_xml(data: bytes, source: str) -> ElementTree.Element:
    """Parse XML, in UTF-8 or UTF-16, that declares no document type and no entity."""
    utf16 = data[:2] in (b"\xff\xfe", b"\xfe\xff")
    with hostile(source, "XML"):
        text = data.decode("utf-16" if utf16 else "utf-8-sig")
        if "<!DOCTYPE" in text.upper() or "<!ENTITY" in text.upper():
            allowed = "XML without document type and entities"
            raise InputError(source, "an XML document type or entity", allowed, "Do not trust this file.")
        # decoded text: the parser sees exactly what was checked, whatever encoding the document claims
        return ElementTree.fromstring(text)  # noqa: S314


Surface = HeightMap | Profile
_GIVEN = {"height_factor": "height_unit", "spacing": "pixel", "lateral_factor": "pixel_unit"}
_HEADING = 'Save it as text with a heading, as "{}".'
Length = str | float


@dataclass(frozen=True)
class Hints:
    """Checked hints in SI; None where nothing was said."""

    array: str | None = None  # name of the array, variable or channel to read
    height_factor: float | None = None  # length in m of one unit of the heights
    spacing: tuple[float, float] | None = None  # (dx, dy), m
    lateral_factor: float | None = None  # length in m of one unit of the coordinates
    decimal: str | None = None  # mark of a text file

    def heights_in(self, source: str, stated: float | None = None) -> float:
        """Return the factor of the heights: the hint, else what the file states, else an `InputError`."""
        chosen = self.height_factor or stated
        if chosen is None:
            allowed = "a unit of the heights"
            remedy = advice("height_unit", "um", "Give it, as in", _HEADING.format("z (um)"))
            raise InputError(source, "heights without a unit", allowed, remedy)
        return chosen

    def spacing_in(self, source: str, stated: tuple[float, float] | None = None) -> tuple[float, float]:
        """Return the spacing: the hint, else what the file states, else an `InputError`."""
        chosen = self.spacing or stated
        if chosen is None:
            allowed = "the distance of neighbouring points"
            remedy = advice("pixel", "1.5 um", "Give it, as in", _HEADING.format("# pixel: 1.5 um"))
            raise InputError(source, "heights without a pixel size", allowed, remedy)
        return chosen

    def refuse(self, source: str, kind: str) -> None:
        """Raise an `InputError` if anything was said about a format that states everything itself."""
        said = [field.name for field in fields(self) if getattr(self, field.name) is not None]
        if said:
            allowed = f"no hints, because {kind} files state their lengths and have one array"
            names = ", ".join(spell(_GIVEN.get(name, name)) for name in said)
            raise InputError(f"hints for {source}", names, allowed, "Leave them out.")


def checked_hints(
    array: str | None = None,
    height_unit: Length | None = None,
    pixel: Length | Sequence[Length] | None = None,
    pixel_unit: Length | None = None,
    decimal: str | None = None,
) -> Hints:
    """Convert hints as a user writes them, see `read_surface`, to SI.

    A unit may be given as its length in m; a bare pixel size is in `pixel_unit`, else in m.
    """
    if decimal is not None and decimal not in (".", ","):
        raise InputError("decimal", shown(decimal), '"." or ","', "Give one of these.")
    if array is not None and not isinstance(array, str):
        raise InputError("array", shown(array), "the name of an array", "Write it in quotes.")
    lateral = _unit("pixel_unit", pixel_unit)
    spacing = None if pixel is None else _pair(pixel, lateral or 1.0)
    return Hints(array, _unit("height_unit", height_unit), spacing, lateral, decimal)


def _unit(name: str, unit: Length | None) -> float | None:
    if unit is None:
        return None
    return _positive(name, factor(unit, "m") if isinstance(unit, str) else unit)


def _pair(pixel: Length | Sequence[Length], unit: float) -> tuple[float, float]:
    sizes = list(pixel) if isinstance(pixel, list | tuple | np.ndarray) and np.ndim(pixel) == 1 else [pixel]
    if len(sizes) not in (1, 2):
        raise InputError("pixel", shown(pixel), "one length, or two (dx, dy)", 'Write it as "1.5 um".')
    metres = [quantity(s, "m") if isinstance(s, str) else _positive("pixel", s) * unit for s in sizes]
    return _positive("pixel", metres[0]), _positive("pixel", metres[-1])


def _positive(name: str, value: object) -> float:
    remedy = "Check the number and its unit."
    return real(name, value, "a finite length above zero", above=0.0, remedy=remedy)


def surfaces_of(array: NDArray[Any], spacing: tuple[float, float], source: str) -> list[Surface]:
    """Wrap a bare array of heights, m: one axis is a line, two are a map, x first, three are maps.

    A 2-D array with a single row or column is a line, too: of the spacing (dx, dy), m, one along x takes dx,
    one along y dy.
    """
    if array.ndim == 3 and len(array):
        return [HeightMap(sample, spacing, f"{source}[{i}]") for i, sample in enumerate(array)]
    if array.ndim == 2 and array.shape[0] == 1:
        return [Profile(array[0], spacing[1], source)]
    if array.ndim == 1 or (array.ndim == 2 and array.shape[1] == 1):
        return [Profile(array.ravel(), spacing[0], source)]
    if array.ndim != 2:
        allowed = "1 (a line), 2 (a map) or 3 (an ensemble of maps) axes, none empty"
        remedy = advice("array", "name", "Select one, as in", "Keep one map or line in the file.")
        raise InputError(source, f"an array of shape {array.shape}", allowed, remedy)
    return [HeightMap(array, spacing, source)]


def scaled(array: NDArray[Any], unit: float, source: str) -> Array:
    """Return real numbers times the length of their unit, m, as float64."""
    if array.dtype.kind not in "fiu":
        raise InputError(
            source,
            f"data of type {array.dtype}",
            "real numbers",
            advice("array", "name", "Select another one, as in", "Keep numbers alone in the file."),
        )
    with np.errstate(over="ignore", invalid="ignore"):  # infinite heights are refused by name afterwards
        return np.asarray(array.astype(np.float64) * unit)
