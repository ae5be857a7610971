"""X3P, the XML and binary container of ISO 25178-72 (earlier ISO 5436-2)."""

from __future__ import annotations

import hashlib
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple
from xml.etree.ElementTree import Element

import numpy as np

from asperity.arguments import Array, require
from asperity.surfaces.heightmap import Profile
from asperity.surfaces.readers import guards
from asperity.surfaces.readers.arrays import line, rasterised
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
    with guards.archive(path) as opened, guards.hostile(path.name, "X3P"):
        xml = guards.member_bytes(opened, "main.xml", path.name, guards.MAX_XML_BYTES)
        if "md5checksum.hex" in opened.namelist():
            checksum = guards.member_bytes(opened, "md5checksum.hex", path.name, guards.MAX_XML_BYTES)
            _check_md5(xml, b"".join(checksum.split()[:1]).decode("ascii"), "main.xml", path.name)
        root = guards.parse_xml(xml, path.name)
        for element in root.iter():
            element.tag = element.tag.rpartition("}")[2]  # writers disagree about the namespace
        return _Record(opened, root, path.name).surfaces()


def _check_md5(data: bytes, stated: str | None, member: str, source: str) -> None:
    if stated:
        digest = hashlib.md5(data, usedforsecurity=False).hexdigest()
        received = f"{member} with the checksum {digest}"
        allowed = f"the checksum {stated[:40]} that it states"
        require(digest == stated.lower(), source, received, allowed, "Copy the file again.")


@dataclass(frozen=True)
class _Record:
    """The record of surfaces in an opened archive."""

    opened: zipfile.ZipFile
    root: Element
    source: str

    def surfaces(self) -> list[guards.Surface]:
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
            return [Profile(*line(x[there], z[there], self.source), self.source)]
        heights, spacing = rasterised(x[there], y[there], z[there], self.source)
        return guards.surfaces_of(heights, spacing, self.source)

    def _text(self, tag: str) -> str | None:
        text = self.root.findtext(tag)
        return text.strip() if text and text.strip() else None

    def _axis(self, name: str) -> _Axis:
        base = f"Record1/Axes/{name}"
        kind, absolute = self._text(f"{base}/DataType") or "D", self._text(f"{base}/AxisType") != "I"
        what = f"data type of {name} in {self.source}"
        require(kind in DATA_TYPES, what, repr(kind[:20]), "I, L, F or D", guards.EXPORT)
        # a coordinate stored with the points is in m; a single profile may state no increment across it
        default = "1" if absolute else "0" if name == "CY" else None
        stated = self._text(f"{base}/Increment") or default

        def long_enough(increment: float) -> bool:
            return increment > 0 or (name == "CY" and increment == 0)

        what, allowed = f"increment of {name}", "a length above zero"
        increment = guards.header_number(self.source, what, stated, allowed, long_enough)
        stated = self._text(f"{base}/Offset") or "0"
        offset = guards.header_number(self.source, f"offset of {name}", stated)
        return _Axis(name, absolute or name == "CZ", DATA_TYPES[kind], increment, offset)

    def _check_rotation(self) -> None:
        rotation = self.root.find("Record1/Axes/Rotation")
        if rotation is None or not len(rotation):
            return
        names = [f"r{i}{j}" for i in "123" for j in "123"]
        texts = [self._text(f"Record1/Axes/Rotation/{name}") for name in names]
        matrix = [
            guards.header_number(self.source, f"{name} of the rotation", text)
            for name, text in zip(names, texts, strict=True)
        ]
        none, allowed = np.allclose(matrix, np.eye(3).ravel(), atol=1e-6), "no rotation of the axes"
        require(none, f"axes of {self.source}", "a rotation", allowed, "Export it unrotated.")

    def _shape(self) -> tuple[int, int, int]:
        """Sizes along z (layers), y and x."""
        if listed := self._text("Record3/ListDimension"):
            return 1, 1, guards.count(self.source, "ListDimension", listed)
        texts = {f"Size{axis}": self._text(f"Record3/MatrixDimension/Size{axis}") for axis in "ZYX"}
        nz, ny, nx = (guards.count(self.source, name, text) for name, text in texts.items())
        return nz, ny, nx

    def _points(self, axes: list[_Axis], shape: tuple[int, int, int]) -> dict[str, Array]:
        """Coordinates in m of all points along each stored axis, NaN where a point is not valid."""
        kinds = np.dtype([(axis.name, axis.kind) for axis in axes if axis.stored])
        if link := self._text("Record3/DataLink/PointDataLink"):
            size = self.opened.getinfo(link).file_size if link in self.opened.namelist() else 0
            n = guards.check_claim(self.source, shape, kinds.itemsize, size)
            raw = np.frombuffer(self._member(link, "PointData"), kinds, n)
            points = {name: raw[name].astype(np.float64) for name in kinds.names or ()}
        else:
            points = self._listed(list(kinds.names or ()), shape)
        for axis in axes:
            if axis.stored:
                points[axis.name] = points[axis.name] * axis.increment + axis.offset
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

    def _listed(self, names: list[str], shape: tuple[int, int, int]) -> dict[str, Array]:
        """Points as text: one Datum each, coordinates apart by semicolons, nothing in a missing one."""
        datums = [datum.text or "" for datum in self.root.findall("Record3/DataList/Datum")]
        points = guards.check_claim(self.source, shape, 1, len(datums))
        received, allowed = f"{len(datums)} points", f"the {points} that it claims"
        require(len(datums) == points, self.source, received, allowed, guards.EXPORT)
        table, allowed = np.full((len(names), points), np.nan), f"{len(names)} numbers apart by semicolons"
        for i, text in enumerate(datums):
            words = text.split(";")
            if any(word.strip() for word in words):
                received = f"the point {text!r}"[:80]
                require(len(words) == len(names), self.source, received, allowed, guards.EXPORT)
                table[:, i] = [number_in(word) for word in words]
        return dict(zip(names, table, strict=True))
