"""X3P, the XML and binary container of ISO 25178-72 (earlier ISO 5436-2), with heights on a regular grid."""

import math
import zipfile
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from asperity.arguments import Array, require
from asperity.surfaces.readers import guards
from asperity.surfaces.readers.hints import Hints

DATA_TYPES = {"I": "<i2", "L": "<i4", "F": "<f4", "D": "<f8"}
AXES = "Record1/Axes"


def read(path: Path, hints: Hints) -> list[guards.Surface]:
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
        what, text = f"{field.lower()} of {axis}", self.text(f"{AXES}/{axis}/{field}") or default
        if field == "Offset":
            return guards.header_number(self.source, what, text)
        least = 0.0 if axis == "CY" else math.ulp(0.0)
        return guards.header_number(self.source, what, text, "a length above zero", least.__le__)

    def check_axes(self) -> None:
        """Refuse points that do not lie on a grid along x and y."""
        for axis in ("CX", "CY"):
            even, received = self.text(f"{AXES}/{axis}/AxisType") != "A", f"points with a {axis} each"
            require(even, self.source, received, "a regular grid", "Export it on a regular grid.")
        rotation, names = f"{AXES}/Rotation", [f"r{i}{j}" for i in "123" for j in "123"]
        if self.root.find(f"{rotation}/*") is None:
            return
        matrix = [
            guards.header_number(self.source, f"{name} of the rotation", self.text(f"{rotation}/{name}"))
            for name in names
        ]
        none, allowed = np.allclose(matrix, np.eye(3).ravel(), atol=1e-6), "no rotation of the axes"
        require(none, f"axes of {self.source}", "a rotation", allowed, "Export it unrotated.")

    def heights(self) -> Array:
        """Heights (layers, nx, ny), m, NaN where a point is not valid."""
        kind = self.text(f"{AXES}/CZ/DataType") or "D"
        what = f"data type of CZ in {self.source}"
        require(kind in DATA_TYPES, what, repr(kind[:20]), "I, L, F or D", guards.EXPORT)
        unit, offset = self.number("CZ", "Increment", "1"), self.number("CZ", "Offset", "0")
        texts = {f"Size{axis}": self.text(f"Record3/MatrixDimension/Size{axis}") for axis in "ZYX"}
        sizes = (guards.header_number(self.source, *item, *guards.WHOLE) for item in texts.items())
        shape, stored = tuple(map(int, sizes)), np.dtype(DATA_TYPES[kind])
        data = self._member(self.text("Record3/DataLink/PointDataLink") or "")
        points = guards.check_claim(self.source, shape, stored.itemsize, len(data))
        z = np.frombuffer(data, stored, points).astype(np.float64) * unit + offset
        z[~np.isfinite(z)] = np.nan  # instruments also mark missing points by infinite heights
        if link := self.text("Record3/DataLink/ValidPointsLink"):
            mask = self._member(link)
            guards.check_claim(self.source, (points,), 1 / 8, len(mask))
            valid = np.unpackbits(np.frombuffer(mask, np.uint8), count=points, bitorder="little")
            z[valid == 0] = np.nan
        return z.reshape(shape).transpose(0, 2, 1)  # stored as (layer, y, x)

    def _member(self, name: str) -> bytes:
        return guards.member_bytes(self.opened, name, self.source)
