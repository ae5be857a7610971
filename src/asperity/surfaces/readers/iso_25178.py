"""The data files of ISO 25178: SDF of part 71, ASCII or binary, and X3P of part 72, an archive with XML."""

import math
import re
import struct
import zipfile
from array import array
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np

from asperity.arguments import Array, Flags, NDArray, require
from asperity.errors import OutOfRangeWarning
from asperity.surfaces.readers import guards
from asperity.surfaces.readers.belief import FEWEST_POINTS
from asperity.surfaces.readers.hints import Hints
from asperity.text_files import number_in
from asperity.written_numbers import count_of

SDF_TYPES = ("u1", "<u2", "<u4", "<f4", "i1", "<i2", "<i4", "<f8")  # by the code in the header
NAMES = ("UCHAR", "UINTEGER", "ULONGINT", "FLOAT", "CHAR", "INTEGER", "LONGINT", "DOUBLE")
"""Of these types in headers of BCR in ASCII."""
BEYOND = {"<f4": 3.4e38, "<f8": 1.7e308}
"""Size from which a number with a floating point is none, by the proposal of 1993."""
APART = 4.0
"""Distance of an end of a type from other heights, over their median one from the middle, that is told."""
OLD = b"BCR"
"""What follows the first letter of a file by that proposal; ISO 25178-71 came after it."""

BLOCK = 1 << 16
"""Bytes of text whose numbers are read at a time."""
_BLANK = re.compile(rb"\s")
_BINARY = struct.Struct("<8s10s12s12sHHddddBBB")
_WIDE = struct.Struct("<8s10s12s12sIIddddBBB")
"""Header of the second revision of ISO 25178-71, which counts more points."""
_FIELDS = {  # of the header, with what is allowed there
    "Compression": ("a number", math.isfinite),
    "DataType": ("0 to 7", range(len(SDF_TYPES)).__contains__),
    "NumProfiles": guards.WHOLE,
    "NumPoints": guards.WHOLE,
    "Zscale": ("the height of one unit in m", bool),
    "Xscale": ("a finite number", math.isfinite),
    "Yscale": ("a finite number", math.isfinite),
}
_IN_BINARY = ("NumPoints", "NumProfiles", "Xscale", "Yscale", "Zscale", "", "Compression", "DataType", "")


def read_sdf(path: Path, hints: Hints) -> list[guards.Surface]:
    """Read an SDF file; there are no hints to it.

    Its profiles run along x, so x is the first axis of the map and profiles follow one another along y; a
    single one is a profile. Lengths are in m by the standard. Compressed data are refused. A point without a
    height has the smallest value of its type, by the proposal of 1993 (BCR) the largest, see `missing_in`.
    """
    source = path.name
    hints.refuse(source, "SDF")
    data = path.read_bytes()
    binary = data[:1].lower() == b"b"
    old = data[1:4].upper() == OLD
    header, body = _binary_header(data, source) if binary else _ascii_header(data)
    compression, code, profiles, points, unit, dx, dy = (
        guards.header_number(source, name, header.get(name.lower()), *fits) for name, fits in _FIELDS.items()
    )
    require(compression == 0, source, "compressed data", "Compression = 0", "Export it uncompressed.")
    kind = SDF_TYPES[int(code)]
    shape = (int(profiles), int(points))
    least = np.dtype(kind).itemsize if binary else 2  # a digit and a separator
    count = guards.check_claim(source, shape, least, len(body) + (not binary))
    stored = np.frombuffer(body, kind, count) if binary else _ascii_heights(body, count, source)
    raw = stored.reshape(shape)
    missing = missing_in(raw, kind, old=old)
    if kind not in BEYOND:
        _doubt_ends(raw[~missing], np.iinfo(kind), source)
    heights = guards.scaled(np.where(missing, np.zeros(1, raw.dtype), raw), unit, source)
    heights[missing] = np.nan
    return guards.surfaces_of(heights.T, (dx, dy), source)


def missing_in(raw: NDArray[Any], kind: str, *, old: bool) -> Flags:
    """Points without a height, by their stored values: the end of their type that a revision reserves.

    The smallest value by ISO 25178-71, and the largest of unsigned types, which it does not have; of one byte
    of these, which no revision of it has reserved, none. The largest by the proposal of 1993. Of numbers with
    a floating point both ends, and what is no number.

    Parameters
    ----------
    raw : ndarray
    kind : str
        Their type, of `SDF_TYPES`.
    old : bool
        Whether the file is one by the proposal.

    Returns
    -------
    ndarray of bool
    """
    if kind in BEYOND:
        return ~(np.abs(raw) < BEYOND[kind])
    ends = np.iinfo(kind)
    signed = np.dtype(kind).kind == "i"
    if old:
        return (raw == ends.max) | np.isnan(raw)
    if signed:
        return (raw == ends.min) | np.isnan(raw)
    return ((raw == ends.max) & (ends.bits > 8)) | np.isnan(raw)


def _doubt_ends(stored: NDArray[Any], ends: "np.iinfo[Any]", source: str) -> None:
    """Warn of an end of a type that its revision does not reserve, where it stands away from all others."""
    if stored.size < FEWEST_POINTS:
        return
    spread = max(float(np.median(np.abs(stored - np.median(stored)))), 1.0)
    for end in (ends.min, ends.max):
        at_end = stored == end
        if at_end.any() and float(np.abs(stored[~at_end] - float(end)).min(initial=np.inf)) > APART * spread:
            OutOfRangeWarning.warn(
                f"{source}: {count_of(int(at_end.sum()), 'point')} of {stored.size} stored as {end}, an end "
                "of the type, away from all others: taken for heights. If it marks what is missing, export "
                "the file as text with NaN there."
            )


def _binary_header(data: bytes, source: str) -> tuple[dict[str, str], bytes]:
    """Fields of a header, and what follows it; the second revision may count as the first one does."""
    layouts = [_BINARY]
    if data[1:8].upper() == b"ISO-2.0":
        layouts = sorted([_WIDE, _BINARY], key=lambda layout: not _fits(data, layout))
    size = layouts[0].size
    received = count_of(len(data), "byte")
    allowed = f"a header of {size} bytes"
    require(len(data) >= size, source, received, allowed, guards.EXPORT)
    values = map(str, layouts[0].unpack_from(data)[4:])
    return dict(zip(map(str.lower, _IN_BINARY), values, strict=True)), data[size:]


def _fits(data: bytes, layout: struct.Struct) -> bool:
    """Whether what a header says in a layout is in the file."""
    if len(data) < layout.size:
        return False
    points, profiles, *_, code, _ = layout.unpack_from(data)[4:]
    known = code < len(SDF_TYPES) and points * profiles > 0
    return known and layout.size + points * profiles * np.dtype(SDF_TYPES[code]).itemsize <= len(data)


def _ascii_header(data: bytes) -> tuple[dict[str, str], bytes]:
    if data[1:4].upper() == OLD:  # which has comments, and words in the place of codes
        data = re.sub(rb";[^\r\n]*", b"", data)
    head, _, rest = data.partition(b"*")
    pairs = (line.partition("=") for line in head.decode("latin-1").splitlines())
    header = {"compression": "0"} | {name.strip().lower(): value.strip() for name, _, value in pairs}
    if header["compression"].upper() in ("NULL", "NONE"):
        header["compression"] = "0"
    if (word := header.get("datatype", "").upper()) in NAMES:
        header["datatype"] = str(NAMES.index(word))
    return header, rest.partition(b"*")[0]  # a trailer may follow


def _ascii_heights(body: bytes, points: int, source: str) -> NDArray[Any]:
    text = re.sub(rb"(?i)\bBAD\b", b"nan", body).replace(b",", b" ")
    heights = array("d")
    start = 0
    while start < len(text):  # words of all would take many times the memory
        blank = _BLANK.search(text, start + BLOCK)
        end = blank.end() if blank else len(text)
        heights.extend(map(number_in, text[start:end].split()))
        start = end
    received = count_of(len(heights), "height")
    allowed = f"the {points} that its header claims"
    require(len(heights) == points, source, received, allowed, guards.EXPORT)
    return np.frombuffer(heights)


# --- X3P: heights on a regular grid

X3P_TYPES = {"I": "<i2", "L": "<i4", "F": "<f4", "D": "<f8"}
AXES = "Record1/Axes"


def read_x3p(path: Path, hints: Hints) -> list[guards.Surface]:
    """Read an X3P file; there are no hints to it. One surface, or one per layer (SizeZ) of the matrix.

    Its x (CX, the fastest axis of the stored matrix) becomes the first axis of the map, its y (CY) the
    second. Lengths are in m by the standard. Points that the validity mask excludes, or whose height is not
    finite, are missing.
    """
    hints.refuse(path.name, "X3P")
    with guards.archive(path) as opened:
        xml = guards.member_bytes(opened, "main.xml", path.name, guards.MAX_XML_BYTES)
        root = guards.parse_xml(xml, path.name)
        for element in root.iter():
            element.tag = element.tag.rpartition("}")[2]  # writers disagree about the namespace
        record = _Record(opened, root, path.name)
        record.check_axes()
        heights = record.heights()
        # a single profile may state no increment across it
        spacing = record.number("CX", "Increment", None), record.number("CY", "Increment", "0")
    return guards.surfaces_of(heights if len(heights) > 1 else heights[0], spacing, path.name)


@dataclass(frozen=True)
class _Record:
    """The record of surfaces in an opened archive."""

    opened: zipfile.ZipFile
    root: Element
    source: str

    def text(self, tag: str) -> str | None:
        """What stands in an element, if anything does."""
        return (self.root.findtext(tag) or "").strip() or None

    def number(self, axis: str, field: str, default: str | None) -> float:
        """Number of an axis, m; an increment is above zero, across a profile zero."""
        what = f"{field.lower()} of {axis}"
        text = self.text(f"{AXES}/{axis}/{field}") or default
        if field == "Offset":
            return guards.header_number(self.source, what, text)
        least = 0.0 if axis == "CY" else math.ulp(0.0)
        return guards.header_number(self.source, what, text, "a length above zero", least.__le__)

    def check_axes(self) -> None:
        """Refuse points that do not lie on a grid along x and y."""
        for axis in ("CX", "CY"):
            even = self.text(f"{AXES}/{axis}/AxisType") != "A"
            received = f"points with a {axis} each"
            require(even, self.source, received, "a regular grid", "Export it on a regular grid.")
        rotation = f"{AXES}/Rotation"
        names = [f"r{i}{j}" for i in "123" for j in "123"]
        if self.root.find(f"{rotation}/*") is None:
            return
        matrix = [
            guards.header_number(self.source, f"{name} of the rotation", self.text(f"{rotation}/{name}"))
            for name in names
        ]
        none = np.allclose(matrix, np.eye(3).ravel(), atol=1e-6)
        allowed = "no rotation of the axes"
        require(none, f"axes of {self.source}", "a rotation", allowed, "Export it unrotated.")

    def heights(self) -> Array:
        """Heights (layers, nx, ny), m, NaN where a point is not valid."""
        kind = self.text(f"{AXES}/CZ/DataType") or "D"
        what = f"data type of CZ in {self.source}"
        require(kind in X3P_TYPES, what, repr(kind[:20]), "I, L, F or D", guards.EXPORT)
        unit = self.number("CZ", "Increment", "1")
        offset = self.number("CZ", "Offset", "0")
        texts = {f"Size{axis}": self.text(f"Record3/MatrixDimension/Size{axis}") for axis in "ZYX"}
        sizes = (guards.header_number(self.source, *item, *guards.WHOLE) for item in texts.items())
        shape = tuple(map(int, sizes))
        stored = np.dtype(X3P_TYPES[kind])
        if written := self.root.findall("Record3/DataList/Datum"):
            z = self._listed(written, shape) * unit + offset
            points = z.size
        else:
            data = self._member(self.text("Record3/DataLink/PointDataLink") or "")
            points = guards.check_claim(self.source, shape, stored.itemsize, len(data))
            z = np.frombuffer(data, stored, points).astype(np.float64) * unit + offset
        z[~(np.abs(z) < guards.MARKED)] = np.nan  # instruments also mark missing points by such heights
        if link := self.text("Record3/DataLink/ValidPointsLink"):
            mask = self._member(link)
            guards.check_claim(self.source, (points,), 1 / 8, len(mask))
            valid = np.unpackbits(np.frombuffer(mask, np.uint8), count=points, bitorder="little")
            z[valid == 0] = np.nan
        return z.reshape(shape).transpose(0, 2, 1)  # stored as (layer, y, x)

    def _listed(self, written: list[Element], shape: tuple[int, ...]) -> Array:
        """Heights that stand in the XML itself, as last of the numbers of a point; NaN of an empty one."""
        points = math.prod(shape)
        received = f"{count_of(len(written), 'height')} in its list"
        require(len(written) == points, self.source, received, f"the {points} of its matrix", guards.EXPORT)
        words = ((each.text or "").rpartition(";")[2].strip() or "nan" for each in written)
        return np.array([number_in(word) for word in words])

    def _member(self, name: str) -> bytes:
        return guards.member_bytes(self.opened, name, self.source)
