"""X3P, the XML and binary container of ISO 25178-72 (earlier ISO 5436-2)."""

import hashlib
import math
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple
from xml.etree.ElementTree import Element

import numpy as np

from asperity.arguments import Array, require
from asperity.surfaces.heightmap import Profile
from asperity.surfaces.readers import arrays, guards
from asperity.surfaces.readers.hints import Hints
from asperity.text_files import number_in

DATA_TYPES = {"I": "<i2", "L": "<i4", "F": "<f4", "D": "<f8"}


class _Axis(NamedTuple):
    """One axis of an X3P record: coordinate = stored number (or index) times increment plus offset, in m."""

    name: str
    stored: bool  # with each point; else counted
    kind: str
    increment: float
    offset: float


def read(path: Path, hints: Hints) -> list[guards.Surface]:
    """Read an X3P file; there are no hints to it. One surface, or one per layer (SizeZ) of the matrix.

    Its x (CX, the fastest axis of the stored matrix) becomes the first axis of the map, its y (CY) the
    second. Lengths are in m by the standard. Points that the validity mask excludes, or whose height is not
    finite, are missing.
    """
    hints.refuse(path.name, "X3P")
    with guards.archive(path) as opened:
        xml = guards.member_bytes(opened, "main.xml", path.name, guards.MAX_XML_BYTES)
        if "md5checksum.hex" in opened.namelist():
            checksum = guards.member_bytes(opened, "md5checksum.hex", path.name, guards.MAX_XML_BYTES)
            _check_md5(xml, b"".join(checksum.split()[:1]).decode("ascii"), "main.xml", path.name)
        root = guards.parse_xml(xml, path.name)
        for element in root.iter():
            element.tag = element.tag.rpartition("}")[2]  # writers disagree about the namespace
        return _Record(opened, root, path.name).surfaces()


def _check_md5(data: bytes, stated: str | None, member: str, source: str) -> None:
    stated = (stated or "").lower()
    digest = hashlib.md5(data, usedforsecurity=False).hexdigest() if stated else ""
    received, allowed = f"{member} with the checksum {digest}", f"the checksum {stated[:40]} that it states"
    require(digest == stated, source, received, allowed, "Copy the file again.")


@dataclass(frozen=True)
class _Record:
    """The record of surfaces in an opened archive."""

    opened: zipfile.ZipFile
    root: Element
    source: str

    def surfaces(self) -> list[guards.Surface]:
        """All maps or profiles of the record, one for each layer, in m."""
        axes = [self._axis(name) for name in ("CX", "CY", "CZ")]
        self._check_rotation()
        shape = layers, _, columns = self._shape()
        points = self._points(axes, shape)
        z = points["CZ"]
        if "CX" not in points and "CY" not in points:
            heights = z.reshape(shape).transpose(0, 2, 1)  # stored as (layer, y, x)
            spacing = (axes[0].increment, axes[1].increment)
            return guards.surfaces_of(heights if layers > 1 else heights[0], spacing, self.source)
        require(layers == 1, self.source, f"{layers} layers of points", "one layer", "Export one layer.")
        row, column = np.divmod(np.arange(len(z)), columns)
        x = points.get("CX", column * axes[0].increment)
        y = points.get("CY", row * axes[1].increment)
        there = np.isfinite(x) & np.isfinite(y)
        if np.ptp(y[there]) == 0:
            return [Profile(*arrays.line(x[there], z[there], self.source), self.source)]
        return guards.surfaces_of(*arrays.rasterised(x[there], y[there], z[there], self.source), self.source)

    def _text(self, tag: str) -> str | None:
        return (self.root.findtext(tag) or "").strip() or None

    def _axis(self, name: str) -> _Axis:
        base = f"Record1/Axes/{name}"
        kind, absolute = self._text(f"{base}/DataType") or "D", self._text(f"{base}/AxisType") != "I"
        what = f"data type of {name} in {self.source}"
        require(kind in DATA_TYPES, what, repr(kind[:20]), "I, L, F or D", guards.EXPORT)
        # a coordinate stored with the points is in m; a single profile may state no increment across it
        default = "1" if absolute else "0" if name == "CY" else None
        stated, least = self._text(f"{base}/Increment") or default, 0.0 if name == "CY" else math.ulp(0.0)
        allowed = "a length above zero"
        increment = guards.header_number(self.source, f"increment of {name}", stated, allowed, least.__le__)
        stated = self._text(f"{base}/Offset") or "0"
        offset = guards.header_number(self.source, f"offset of {name}", stated)
        return _Axis(name, absolute or name == "CZ", DATA_TYPES[kind], increment, offset)

    def _check_rotation(self) -> None:
        rotation, names = "Record1/Axes/Rotation", [f"r{i}{j}" for i in "123" for j in "123"]
        if self.root.find(f"{rotation}/*") is None:
            return
        matrix = [
            guards.header_number(self.source, f"{name} of the rotation", self._text(f"{rotation}/{name}"))
            for name in names
        ]
        none, allowed = np.allclose(matrix, np.eye(3).ravel(), atol=1e-6), "no rotation of the axes"
        require(none, f"axes of {self.source}", "a rotation", allowed, "Export it unrotated.")

    def _shape(self) -> tuple[int, int, int]:
        """Sizes along z (layers), y and x."""
        if listed := self._text("Record3/ListDimension"):
            return 1, 1, int(guards.header_number(self.source, "ListDimension", listed, *guards.WHOLE))
        texts = {f"Size{axis}": self._text(f"Record3/MatrixDimension/Size{axis}") for axis in "ZYX"}
        sizes = (guards.header_number(self.source, *item, *guards.WHOLE) for item in texts.items())
        nz, ny, nx = map(int, sizes)
        return nz, ny, nx

    def _points(self, axes: list[_Axis], shape: tuple[int, int, int]) -> dict[str, Array]:
        """Coordinates in m of all points along each stored axis, NaN where a point is not valid."""
        stored = [axis for axis in axes if axis.stored]
        kinds = np.dtype([(axis.name, axis.kind) for axis in stored])
        if link := self._text("Record3/DataLink/PointDataLink"):
            size = self.opened.getinfo(link).file_size if link in self.opened.namelist() else 0
            n = guards.check_claim(self.source, shape, kinds.itemsize, size)
            raw = np.frombuffer(self._member(link, "PointData"), kinds, n)
            numbers = [raw[axis.name].astype(np.float64) for axis in stored]
        else:
            numbers = list(self._listed(len(stored), shape))
        points = {a.name: each * a.increment + a.offset for a, each in zip(stored, numbers, strict=True)}
        # instruments also mark missing points by infinite heights
        points["CZ"][~np.isfinite(points["CZ"])] = np.nan
        if link := self._text("Record3/DataLink/ValidPointsLink"):
            n, mask = len(points["CZ"]), self._member(link, "ValidPoints")
            guards.check_claim(self.source, (n,), 1 / 8, len(mask))
            valid = np.unpackbits(np.frombuffer(mask, np.uint8), count=n, bitorder="little")
            points["CZ"][valid == 0] = np.nan
        return points

    def _member(self, link: str, name: str) -> bytes:
        data = guards.member_bytes(self.opened, link, self.source)
        _check_md5(data, self._text(f"Record3/DataLink/MD5Checksum{name}"), link, self.source)
        return data

    def _listed(self, coordinates: int, shape: tuple[int, int, int]) -> Array:
        """Points as text: one Datum each, coordinates apart by semicolons, nothing in a missing one."""
        datums = [datum.text or "" for datum in self.root.findall("Record3/DataList/Datum")]
        points = guards.check_claim(self.source, shape, 1, len(datums))
        received, allowed = f"{len(datums)} points", f"the {points} that it claims"
        require(len(datums) == points, self.source, received, allowed, guards.EXPORT)
        table, allowed = np.full((coordinates, points), np.nan), f"{coordinates} numbers apart by semicolons"
        for i, text in enumerate(datums):
            if text.replace(";", "").strip():
                words, received = text.split(";"), f"the point {text!r}"[:80]
                require(len(words) == coordinates, self.source, received, allowed, guards.EXPORT)
                table[:, i] = [number_in(word) for word in words]
        return table
