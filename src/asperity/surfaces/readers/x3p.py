"""X3P, the XML and binary container of ISO 25178-72 (earlier ISO 5436-2)."""

from __future__ import annotations

import hashlib
import zipfile
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from asperity.arguments import Array
from asperity.errors import InputError
from asperity.surfaces.heightmap import Profile
from asperity.surfaces.readers.arrays import line, rasterised
from asperity.surfaces.readers.guards import (
    MAX_XML_BYTES,
    Hints,
    Surface,
    archive,
    check_claim,
    count,
    header_number,
    hostile,
    member_bytes,
    parse_xml,
    surfaces_of,
)
from asperity.text_files import number_in

DATA_TYPES = {"I": "<i2", "L": "<i4", "F": "<f4", "D": "<f8"}


@dataclass(frozen=True)
class _Axis:
    """One axis of an X3P record: coordinate = stored number (or index) times increment plus offset, in m."""

    name: str
    absolute: bool  # stored with each point; else counted
    kind: str
    increment: float
    offset: float


def read(path: Path, hints: Hints) -> list[Surface]:
    """Read an X3P file; there are no hints to it. One surface, or one per layer (SizeZ) of the matrix.

    Its x (CX, the fastest axis of the stored matrix) becomes the first axis of the map, its y (CY) the
    second. Lengths are in m by the standard. Points that the validity mask excludes, or whose height is not
    finite, are missing.
    """
    hints.refuse(path.name, "X3P")
    with archive(path) as opened, hostile(path.name, "X3P"):
        xml = member_bytes(opened, "main.xml", path.name, MAX_XML_BYTES)
        _check_main(opened, xml, path.name)
        root = parse_xml(xml, path.name)
        for element in root.iter():
            element.tag = element.tag.rpartition("}")[2]  # writers disagree about the namespace
        axes = [_axis(root, name, path.name) for name in ("CX", "CY", "CZ")]
        _check_rotation(root, path.name)
        shape = _shape(root, path.name)
        columns = _points(opened, root, axes, shape, path.name)
        return _surfaces(axes, shape, columns, path.name)


def _text(root: Element, tag: str) -> str | None:
    text = root.findtext(tag)
    return text.strip() if text and text.strip() else None


def _axis(root: Element, name: str, source: str) -> _Axis:
    base = f"Record1/Axes/{name}"
    kind = _text(root, f"{base}/DataType") or "D"
    absolute = _text(root, f"{base}/AxisType") != "I"
    if kind not in DATA_TYPES:
        raise InputError(
            f"data type of {name} in {source}", repr(kind[:20]), "I, L, F or D", "Export it again."
        )
    # a coordinate stored with the points is in m; a single profile may state no increment across it
    default = "1" if absolute else "0" if name == "CY" else None
    increment = header_number(source, f"increment of {name}", _text(root, f"{base}/Increment") or default)
    offset = header_number(source, f"offset of {name}", _text(root, f"{base}/Offset") or "0")
    if increment <= 0 and not (name == "CY" and increment == 0):
        allowed = "a length above zero"
        raise InputError(f"increment of {name} in {source}", increment, allowed, "Export it again.")
    return _Axis(name, absolute or name == "CZ", DATA_TYPES[kind], increment, offset)


def _check_rotation(root: Element, source: str) -> None:
    rotation = root.find("Record1/Axes/Rotation")
    if rotation is None or not len(rotation):
        return
    matrix = [
        header_number(source, f"r{i}{j} of the rotation", _text(rotation, f"r{i}{j}"))
        for i in "123"
        for j in "123"
    ]
    if not np.allclose(np.reshape(matrix, (3, 3)), np.eye(3), atol=1e-6):
        raise InputError(f"axes of {source}", "a rotation", "no rotation of the axes", "Export it unrotated.")


def _shape(root: Element, source: str) -> tuple[int, int, int]:
    listed = _text(root, "Record3/ListDimension")
    if listed is not None:
        return 1, 1, count(source, "ListDimension", listed)
    sizes = [count(source, f"Size{a}", _text(root, f"Record3/MatrixDimension/Size{a}")) for a in "ZYX"]
    return sizes[0], sizes[1], sizes[2]


def _points(
    opened: zipfile.ZipFile, root: Element, axes: list[_Axis], shape: tuple[int, int, int], source: str
) -> dict[str, Array]:
    """Coordinates in m of all points along each stored axis, NaN where a point is not valid."""
    stored = np.dtype([(axis.name, axis.kind) for axis in axes if axis.absolute])
    link = _text(root, "Record3/DataLink/PointDataLink")
    if link is None:
        points = _listed(root, stored, shape, source)
    else:
        size = opened.getinfo(link).file_size if link in opened.namelist() else 0
        n = check_claim(source, shape, stored.itemsize, size)
        data = member_bytes(opened, link, source)
        _check_md5(data, _text(root, "Record3/DataLink/MD5ChecksumPointData"), link, source)
        raw = np.frombuffer(data, stored, n)
        points = {name: raw[name].astype(np.float64) for name in stored.names or ()}
    for axis in axes:
        if axis.absolute:
            points[axis.name] = points[axis.name] * axis.increment + axis.offset
    valid = _valid_points(opened, root, len(points["CZ"]), source)
    # instruments also mark missing points by infinite heights
    points["CZ"][~(valid & np.isfinite(points["CZ"]))] = np.nan
    return points


def _listed(
    root: Element, stored: np.dtype[np.void], shape: tuple[int, int, int], source: str
) -> dict[str, Array]:
    """Points written as text: one Datum each, coordinates apart by semicolons, nothing in a missing one."""
    datums = root.findall("Record3/DataList/Datum")
    names = list(stored.names or ())
    points = check_claim(source, shape, 1, len(datums))
    if len(datums) != points:
        raise InputError(source, f"{len(datums)} points", f"the {points} that it claims", "Export it again.")
    table = np.full((len(names), points), np.nan)
    for i, datum in enumerate(datums):
        words = (datum.text or "").split(";")
        if any(word.strip() for word in words):
            if len(words) != len(names):
                allowed = f"{len(names)} numbers apart by semicolons"
                raise InputError(source, f"the point {datum.text!r}"[:80], allowed, "Export it again.")
            table[:, i] = [number_in(word) for word in words]
    return dict(zip(names, table, strict=True))


def _valid_points(opened: zipfile.ZipFile, root: Element, n: int, source: str) -> NDArray[np.bool_]:
    link = _text(root, "Record3/DataLink/ValidPointsLink")
    if link is None:
        return np.ones(n, dtype=bool)
    data = member_bytes(opened, link, source)
    check_claim(source, (n,), 1 / 8, len(data))
    _check_md5(data, _text(root, "Record3/DataLink/MD5ChecksumValidPoints"), link, source)
    return np.unpackbits(np.frombuffer(data, np.uint8), count=n, bitorder="little").astype(bool)


def _check_main(opened: zipfile.ZipFile, xml: bytes, source: str) -> None:
    if "md5checksum.hex" in opened.namelist():
        stated = member_bytes(opened, "md5checksum.hex", source, MAX_XML_BYTES).split()
        _check_md5(xml, stated[0].decode("ascii") if stated else None, "main.xml", source)


def _check_md5(data: bytes, stated: str | None, member: str, source: str) -> None:
    if stated is None:
        return
    found = hashlib.md5(data, usedforsecurity=False).hexdigest()
    if found != stated.lower():
        received = f"{member} with the checksum {found}"
        raise InputError(
            source, received, f"the checksum {stated[:40]} that it states", "Copy the file again."
        )


def _surfaces(
    axes: list[_Axis], shape: tuple[int, int, int], points: dict[str, Array], source: str
) -> list[Surface]:
    z = points["CZ"]
    if "CX" not in points and "CY" not in points:
        heights = z.reshape(shape).transpose(0, 2, 1)  # stored as (layer, y, x)
        spacing = (axes[0].increment, axes[1].increment)
        return surfaces_of(heights if shape[0] > 1 else heights[0], spacing, source)
    if shape[0] > 1:
        raise InputError(source, f"{shape[0]} layers of points", "one layer", "Export one layer.")
    row, column = np.divmod(np.arange(len(z)), shape[2])
    x = points.get("CX", column * axes[0].increment)
    y = points.get("CY", row * axes[1].increment)
    there = np.isfinite(x) & np.isfinite(y)
    if np.ptp(y[there]) == 0:
        profile, dx = line(x[there], z[there], source)
        return [Profile(profile, dx, source)]
    return surfaces_of(*rasterised(x[there], y[there], z[there], source), source)
