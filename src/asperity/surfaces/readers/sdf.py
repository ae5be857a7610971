"""SDF, the surface data file of ISO 25178-71: ASCII (``aISO-1.0``) and binary (``bISO-1.0``)."""

import math
import re
import struct
from pathlib import Path
from typing import Any

import numpy as np

from asperity.arguments import NDArray, require
from asperity.surfaces.readers import guards
from asperity.surfaces.readers.hints import Hints
from asperity.text_files import number_in

DATA_TYPES = ("u1", "<u2", "<u4", "<f4", "i1", "<i2", "<i4", "<f8")  # by the code in the header
# Integers of 16 and 32 bits mark a missing point by the largest unsigned or the smallest signed value.
MISSING = {"<u2": 2**16 - 1, "<u4": 2**32 - 1, "<i2": -(2**15), "<i4": -(2**31)}

_BINARY = struct.Struct("<8s10s12s12sHHddddBBB")
_FIELDS = {  # of the header, with what is allowed there
    "Compression": ("a number", math.isfinite),
    "DataType": ("0 to 7", range(len(DATA_TYPES)).__contains__),
    "NumProfiles": guards.WHOLE,
    "NumPoints": guards.WHOLE,
    "Zscale": ("the height of one unit in m", bool),
    "Xscale": ("a finite number", math.isfinite),
    "Yscale": ("a finite number", math.isfinite),
}
_IN_BINARY = ("NumPoints", "NumProfiles", "Xscale", "Yscale", "Zscale", "", "Compression", "DataType", "")


def read(path: Path, hints: Hints) -> list[guards.Surface]:
    """Read an SDF file; there are no hints to it.

    Its profiles run along x, so x is the first axis of the map and profiles follow one another along y; a
    single one is a profile. Lengths are in m by the standard. Compressed data are refused.
    """
    source = path.name
    hints.refuse(source, "SDF")
    data = path.read_bytes()
    binary = data[:1] == b"b"
    header, body = _binary_header(data, source) if binary else _ascii_header(data)
    compression, code, profiles, points, unit, dx, dy = (
        guards.header_number(source, name, header.get(name.lower()), *fits) for name, fits in _FIELDS.items()
    )
    require(compression == 0, source, "compressed data", "Compression = 0", "Export it uncompressed.")
    kind, shape = DATA_TYPES[int(code)], (int(profiles), int(points))
    least = np.dtype(kind).itemsize if binary else 2  # a digit and a separator
    count = guards.check_claim(source, shape, least, len(body) + (not binary))
    stored = np.frombuffer(body, kind, count) if binary else _ascii_heights(body, count, source)
    raw = stored.reshape(shape)
    heights = guards.scaled(raw, unit, source)
    if kind in MISSING:
        heights[raw == MISSING[kind]] = np.nan
    return guards.surfaces_of(heights.T, (dx, dy), source)


def _binary_header(data: bytes, source: str) -> tuple[dict[str, str], bytes]:
    size = _BINARY.size
    received, allowed = f"{len(data)} bytes", f"a header of {size} bytes"
    require(len(data) >= size, source, received, allowed, guards.EXPORT)
    values = map(str, _BINARY.unpack_from(data)[4:])
    return dict(zip(map(str.lower, _IN_BINARY), values, strict=True)), data[size:]


def _ascii_header(data: bytes) -> tuple[dict[str, str], bytes]:
    head, _, rest = data.partition(b"*")
    pairs = (line.partition("=") for line in head.decode("latin-1").splitlines())
    header = {name.strip().lower(): value.strip() for name, _, value in pairs}
    return {"compression": "0"} | header, rest.partition(b"*")[0]  # a trailer may follow


def _ascii_heights(body: bytes, points: int, source: str) -> NDArray[Any]:
    words = re.sub(rb"(?i)\bBAD\b", b"nan", body).replace(b",", b" ").split()
    received, allowed = f"{len(words)} heights", f"the {points} that its header claims"
    require(len(words) == points, source, received, allowed, guards.EXPORT)
    return np.array([number_in(word) for word in words])
