"""Guards at the door: every file is treated as hostile until its claims are checked against its bytes."""

from __future__ import annotations

import math
import zipfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from xml.etree import ElementTree

from asperity.apart import reason
from asperity.arguments import file_path, listed, no_file
from asperity.decoding import number_in
from asperity.errors import InputError

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
