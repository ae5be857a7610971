"""SDF, the surface data file of ISO 25178-71: ASCII (``aISO-1.0``) and binary (``bISO-1.0``)."""

from __future__ import annotations

import re
import struct
from pathlib import Path

import numpy as np

from asperity.arguments import Array
from asperity.errors import InputError
from asperity.surfaces.readers.guards import (
    Hints,
    Surface,
    check_claim,
    count,
    header_number,
    hostile,
    scaled,
    surfaces_of,
)
from asperity.text_files import number_in

DATA_TYPES = ("u1", "<u2", "<u4", "<f4", "i1", "<i2", "<i4", "<f8")  # by the code in the header
# Integers of 16 and 32 bits mark a missing point by the largest unsigned or the smallest signed value.
MISSING = {"<u2": 2**16 - 1, "<u4": 2**32 - 1, "<i2": -(2**15), "<i4": -(2**31)}

_BINARY = struct.Struct("<8s10s12s12sHHddddBBB")
_FIELDS = (  # noqa: SIM905
    "version manufacid createdate moddate numpoints numprofiles "
    "xscale yscale zscale zresolution compression datatype checktype"
).split()


def read(path: Path, hints: Hints) -> list[Surface]:
    """Read an SDF file; there are no hints to it.

    Its profiles run along x, so x is the first axis of the map and profiles follow one another along y; a
    single one is a profile. Lengths are in m by the standard. Compressed data are refused.
    """
    hints.refuse(path.name, "SDF")
    data = path.read_bytes()
    with hostile(path.name, "SDF"):
        if data[:1] == b"b":
            header, raw = _read_binary(data, path.name)
        else:
            header, raw = _read_ascii(data, path.name)
        kind = DATA_TYPES[_data_type(header, path.name)]
        unit = header_number(path.name, "Zscale", header.get("zscale"))
        if unit == 0:
            raise InputError(f"Zscale in {path.name}", unit, "the height of one unit in m", "Export it.")
        heights = scaled(raw, unit, path.name)
        if kind in MISSING:
            heights[raw == MISSING[kind]] = np.nan
        spacing = tuple(header_number(path.name, f"{a}scale", header.get(f"{a.lower()}scale")) for a in "XY")
        return surfaces_of(heights.T, (spacing[0], spacing[1]), path.name)


def _read_binary(data: bytes, source: str) -> tuple[dict[str, str], Array]:
    if len(data) < _BINARY.size:
        raise InputError(
            source, f"{len(data)} bytes", f"a header of {_BINARY.size} bytes", "Export it again."
        )
    header = {name: str(v) for name, v in zip(_FIELDS, _BINARY.unpack_from(data), strict=True)}
    kind = np.dtype(DATA_TYPES[_data_type(header, source)])
    shape = _shape(header, source)
    points = check_claim(source, shape, kind.itemsize, len(data) - _BINARY.size)
    return header, np.frombuffer(data, kind, points, _BINARY.size).reshape(shape)


def _read_ascii(data: bytes, source: str) -> tuple[dict[str, str], Array]:
    head, _, rest = data.partition(b"*")
    pairs = (line.partition("=") for line in head.decode("latin-1").splitlines())
    header = {name.strip().lower(): value.strip() for name, _, value in pairs}
    shape = _shape(header, source)
    body = rest.partition(b"*")[0]  # a trailer may follow
    points = check_claim(source, shape, 2, len(body) + 1)  # a digit and a separator
    words = re.sub(rb"(?i)\bBAD\b", b"nan", body).replace(b",", b" ").split()
    if len(words) != points:
        raise InputError(
            source, f"{len(words)} heights", f"the {points} that its header claims", "Export it again."
        )
    _data_type(header, source)
    return header, np.array([number_in(word) for word in words]).reshape(shape)


def _shape(header: dict[str, str], source: str) -> tuple[int, int]:
    profiles = count(source, "NumProfiles", header.get("numprofiles"))
    return profiles, count(source, "NumPoints", header.get("numpoints"))


def _data_type(header: dict[str, str], source: str) -> int:
    if header_number(source, "Compression", header.get("compression", "0")) != 0:
        raise InputError(source, "compressed data", "Compression = 0", "Export it uncompressed.")
    code = header_number(source, "DataType", header.get("datatype"))
    if code not in range(len(DATA_TYPES)):
        raise InputError(f"DataType in {source}", code, "0 to 7", "Export the file again.")
    return int(code)
