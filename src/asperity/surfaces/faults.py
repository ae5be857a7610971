"""Faults of raceways and balls as heights, positive out of the material: pits, spalls, dents, particles."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from asperity.arguments import Array, ArrayLike, Flags, NDArray, require
from asperity.errors import OutOfRangeWarning
from asperity.parameters import (
    ANGLE,
    LENGTH,
    LENGTH_OR_ZERO,
    Choice,
    File,
    Number,
    Quantity,
    checked_parameters,
    optional_parameter,
    usual_parameter,
)
from asperity.surfaces.edges import FAR, REACH, Edges
from asperity.surfaces.heightmap import HeightMap

HOLLOWS = ("pit", "spall")
"""With a flat floor, and sharp edges along their outline."""
SHAPES = (*HOLLOWS, "dent", "particle", "mark", "map")
PARTS = 6
"""Parts of a cell along and across for the mean depth of one that an edge crosses."""
MAP = File(held=(HeightMap,), content="a height map")
_BURRS = "1 um to 10 mm: burrs lie between"
_SIZE = "1 um to 1 m: faults lie between"
_DEPTH = "1 nm to 100 mm: faults lie between"
_TURN = "-360 deg to 360 deg: raceways end there"
_OFFSET = "-1 m to 1 m: raceways end"
_RIM = Number(at_least=0, at_most=10)
_COUNT = "1 to 500: balls are fewer"
NEEDED = {
    "length": "a length along the path, as 0.18 mm",
    "depth": "a depth, or the height of a particle, as 0.28 mm",
    "map": "a file of heights, as spall.x3p",
}
"""What a fault takes, and its kind: a map has its own size, the others have no map."""


@dataclass(frozen=True)
class Fault:
    """One fault of a raceway or ball, or several alike around it.

    Parameters
    ----------
    shape : {"pit", "spall", "dent", "particle", "mark", "map"}
        An elliptic or a rectangular hollow with a flat floor; a round-bottomed dent with a raised rim; an
        elliptic bump; an elliptic worn hollow, as false brinelling leaves; heights of a file.
    angle : float
        Of its middle around the raceway or the ball, rad.
    offset : float
        Of its middle across the path, m.
    length, width : float
        Along and across the path, m; the width is the length if it is left out. Those of a map are its own.
    depth : float
        Of a hollow, or height of a particle, m; that of a map is its own.
    edge : float
        Over which a pit or spall falls to its floor, m, inside its outline.
    burr, burr_width : float
        Height of what a pit or spall has thrown up around it, and how wide that is, m: h sin²(πs/w) of the
        distance s from its outline.
    rim : float
        Volume of a dent's rim over that of the dent.
    rim_width : float
        Width of the rim over the half axes of the dent.
    count : int
        Faults alike, at even distances around, the first at the angle.
    map : HeightMap or path, optional
        Heights, laid with its x along the path; where it ends, the raceway goes on at height zero.

    Raises
    ------
    InputError
        If a size is missing or out of range.

    Examples
    --------
    >>> from asperity.surfaces.faults import Fault
    >>> pit = Fault("pit", length=0.18e-3, depth=0.28e-3)
    >>> (pit.heights([0.0, 0.08e-3, 0.1e-3], 0.0).round(5) + 0.0).tolist()  # along its middle
    [-0.00028, -0.00028, 0.0]
    """

    shape: str = usual_parameter(Choice(SHAPES), "pit", "kind of fault")
    angle: float = usual_parameter(ANGLE, "0 deg", "angle of its middle around", _TURN)
    offset: float = usual_parameter(Quantity("m"), "0 mm", "distance of its middle from the path", _OFFSET)
    length: float = optional_parameter(LENGTH, "0.18 mm", "length along the path", _SIZE)
    width: float = optional_parameter(LENGTH, "0.18 mm", "width across, as its length", _SIZE)
    depth: float = optional_parameter(LENGTH, "0.28 mm", "depth, or height of a particle", _DEPTH)
    edge: float = usual_parameter(LENGTH_OR_ZERO, "0 um", "length over which a pit or spall falls", _SIZE)
    burr: float = usual_parameter(LENGTH_OR_ZERO, "0 um", "height of the burr around a pit or spall", _DEPTH)
    burr_width: float = usual_parameter(LENGTH, "50 um", "width of that burr", _BURRS)
    rim: float = usual_parameter(_RIM, 1.0, "volume of a dent's rim over the dent's")
    rim_width: float = usual_parameter(
        Number(above=0, at_most=10), 1.0, "width of the rim over half a dent's"
    )
    count: int = usual_parameter(Number(at_least=1, whole=True), 1, "faults alike around", _COUNT)
    map: HeightMap | Path | None = optional_parameter(  # noqa: RUF009
        MAP, "spall.x3p", "heights of the fault"
    )

    def __post_init__(self) -> None:
        checked_parameters(self)
        for name, needed in NEEDED.items():
            wanted = (name == "map") == (self.shape == "map")
            given = getattr(self, name) is not None
            what = f"{name} of a fault, a {self.shape}"
            require(given or not wanted, what, "nothing", needed, f"Give its {name}.")
            without = (
                "none: a map has its own"
                if self.shape == "map"
                else "none: only a fault of shape map has one"
            )
            require(wanted or not given, what, "one", without, f"Remove its {name}.")
        hollow = self.shape in HOLLOWS or not self.burr
        allowed = f"none: only a {' or a '.join(HOLLOWS)} has one"
        require(hollow, f"burr of a fault, a {self.shape}", "one", allowed, "Remove its burr.")
        own: dict[str, Any] = {"width": self.width or self.length}
        if self.map is not None:
            laid = map_of(self.map)
            deepest = max(-float(laid.heights.min()), 0.0)
            own = {"map": laid, "length": laid.size[0], "width": laid.size[1], "depth": deepest}
        for name, value in own.items():
            object.__setattr__(self, name, value)

    @property
    def size(self) -> tuple[float, float]:
        """Length and width of all that is not at height zero, m."""
        wider = 1.0 + self.rim_width if self.shape == "dent" and self.rim else 1.0
        if self.burr and self.shape == "spall":
            return self.length + 2.0 * self.burr_width, self.width + 2.0 * self.burr_width
        if self.burr:
            wider += 2.0 * self.burr_width / min(self.length, self.width)
        return self.length * wider, self.width * wider

    @property
    def details(self) -> tuple[float, float]:
        """What asks for the finest grid along and across, m: its size, or twice the width of its burr."""
        length, width = self.size
        wave = 2.0 * self.burr_width if self.burr else math.inf
        return min(length, wave), min(width, wave)

    @property
    def highest(self) -> float:
        """Height by which it stands out of the surface, m: of a particle, a rim, a burr, or in a map."""
        if isinstance(self.map, HeightMap):
            return max(float(self.map.heights.max()), 0.0)
        if self.shape == "dent":
            # volumes over π times the half axes: d/3 of d (1 − ρ²)², and h w (1 + w/2) of h sin²(π (ρ − 1)/w)
            return self.rim * self.depth / (3.0 * self.rim_width * (1.0 + 0.5 * self.rim_width))
        return self.depth if self.shape == "particle" else self.burr

    def heights(self, along: ArrayLike, across: ArrayLike) -> Array:
        """Heights, m, at places along and across the path from its middle, m; arrays are broadcast."""
        x, y = np.broadcast_arrays(np.asarray(along, dtype=float), np.asarray(across, dtype=float))
        if isinstance(self.map, HeightMap):
            from scipy.ndimage import map_coordinates

            places = zip((x, y), self.map.spacing, self.map.shape, strict=True)
            index = [at / step + 0.5 * (points - 1) for at, step, points in places]
            return map_coordinates(self.map.heights, index, order=1, cval=0.0)
        a = 0.5 * self.length
        b = 0.5 * self.width
        depth = self.depth
        if self.shape == "spall":
            return self._hollow(np.minimum(a - abs(x), b - abs(y)))
        rho = np.hypot(x / a, y / b)
        if self.shape == "pit":
            return self._hollow((1.0 - rho) * min(a, b))
        bowl = np.clip(1.0 - rho**2, 0.0, None)
        if self.shape in ("mark", "particle"):
            return -depth * bowl if self.shape == "mark" else depth * bowl**2
        rim = np.sin(np.pi * np.clip((rho - 1.0) / self.rim_width, 0.0, 1.0)) ** 2
        return self.highest * rim - depth * bowl**2

    def _hollow(self, inside: Array) -> Array:
        """Heights of a pit or spall and its burr, m, at distances inside its outline, m."""
        floor: Array = -self.depth * np.clip(inside / self.edge if self.edge else np.sign(inside), 0.0, 1.0)
        if not self.burr:
            return floor
        beyond = -inside / self.burr_width
        wave = np.sin(np.pi * beyond) ** 2
        return floor + self.burr * np.where((beyond > 0.0) & (beyond < 1.0), wave, 0.0)

    def outline(self, along: ArrayLike, across: ArrayLike) -> tuple[Array, Array]:
        """Distance from the outline of a pit or spall, m, positive outside, and its normal's part along.

        At places as in `heights`. The distance from an ellipse is right to the second order.
        """
        x, y = (abs(each) for each in np.broadcast_arrays(along, across))
        a = 0.5 * self.length
        b = 0.5 * self.width
        if self.shape == "pit":
            rho = np.maximum(np.hypot(x / a, y / b), 1e-9)
            slopes = np.hypot(x / a**2, y / b**2) / rho
            steepest = np.maximum(slopes, 1e-9 / max(a, b))
            return (rho - 1.0) / steepest, np.minimum(x / (a**2 * rho * steepest), 1.0)
        out_x = x - a
        out_y = y - b
        corner = np.hypot(np.maximum(out_x, 0.0), np.maximum(out_y, 0.0))
        beside = (out_x > 0.0) & (out_y > 0.0)
        normal = np.where(beside, out_x / np.where(beside, corner, 1.0), out_x >= out_y)
        return corner + np.minimum(np.maximum(out_x, out_y), 0.0), normal


def map_of(source: HeightMap | Path) -> HeightMap:
    """Take a height map, or read it, and fill its missing points."""
    from asperity.surfaces.readers import read_surface

    found = source if isinstance(source, HeightMap) else read_surface(source)
    if not isinstance(found, HeightMap):
        require(False, "map", "a line", "a height map", "Give a line around as a trace.")
    return found.filled()  # type: ignore[return-value]


def lay(
    faults: tuple[Fault, ...], shape: tuple[int, int], spacing: tuple[float, float]
) -> tuple[Array, Edges | None]:
    """Heights (rows, lines), m, of faults on a surface that is closed along its rows, and their sharp edges.

    Row 0 is at angle zero, the path along the middle of the lines. Where there is no fault, and in cells that
    an edge crosses, the height is zero. Where faults overlap, heights add up, and a warning says so. Refused
    are those that no contact on so many lines meets, and those longer than the circumference.
    """
    result = np.zeros(shape)
    overlap = False
    edges = None
    if any(fault.shape in HOLLOWS for fault in faults):
        edges = Edges(np.full(shape, FAR), np.zeros(shape), np.zeros(shape), spacing)
    for fault in faults:
        _check_laid(fault, shape, spacing)
        for rows, along, across in _places(fault, shape, spacing):
            laid = fault.heights(along, across)
            under = np.mod(rows, shape[0])
            if edges is not None and fault.shape in HOLLOWS:
                sound = _lay_edge(edges, fault, under, (along, across))
                laid = np.where(sound, np.maximum(laid, 0.0), laid)
            overlap |= bool(np.any(result[under] * laid))
            for turn in range(0, len(under), shape[0]):
                result[under[turn : turn + shape[0]]] += laid[turn : turn + shape[0]]
    if overlap:
        OutOfRangeWarning.warn(
            "Faults overlap: where they do, their heights add up. Lay them apart, or as one map."
        )
    return result, edges


def _check_laid(fault: Fault, shape: tuple[int, int], spacing: tuple[float, float]) -> None:
    """Refuse a fault that no contact on the surface meets, or that is longer than it."""
    rows, lines = shape
    dx, dy = spacing
    length, width = fault.size
    name = f"of the fault, a {fault.shape}"
    around = rows * dx
    received = f"{fault.offset * 1e3:.4g} mm"
    most = 0.5 * (lines * dy + width)
    allowed = f"less than {most * 1e3:.4g} mm: contacts under these loads reach no farther"
    met = abs(fault.offset) < most
    require(met, f"offset {name}", received, allowed, "Move it towards the middle of the raceway.")
    received = f"{length * 1e3:.4g} mm, {fault.count} times"
    allowed = f"what fits on a circumference of {around * 1e3:.4g} mm"
    fits = fault.count * length <= around
    require(fits, f"length {name}", received, allowed, "Shorten it, or lay fewer.")


def _places(
    fault: Fault, shape: tuple[int, int], spacing: tuple[float, float]
) -> Iterator[tuple[NDArray[Any], Array, Array]]:
    """Rows about each of the faults alike, and their places along (rows, 1) and across (lines,), m."""
    rows, lines = shape
    dx, dy = spacing
    across = np.asarray((np.arange(lines) - lines // 2) * dy - fault.offset)
    margin = REACH * (dx + dy) if fault.shape in HOLLOWS else dx
    reach = math.ceil(0.5 * fault.size[0] / dx) + math.ceil(margin / dx)
    for k in range(fault.count):
        middle = (fault.angle / (2.0 * math.pi) + k / fault.count) * rows
        at = np.arange(round(middle) - reach, round(middle) + reach + 1)
        yield at, np.asarray(at - middle)[:, None] * dx, across


def _lay_edge(edges: Edges, fault: Fault, under: NDArray[Any], places: tuple[Array, Array]) -> Flags:
    """Write the edge of a fault where it is the next one; return which cells are sound at least in part."""
    distance, normal = fault.outline(*places)
    own = Edges(distance, normal, np.zeros(distance.shape), edges.spacing)
    dx, dy = edges.spacing
    nearer = distance < edges.distance[under]
    edges.distance[under] = np.where(nearer, distance, edges.distance[under])
    edges.normal[under] = np.where(nearer, normal, edges.normal[under])
    parts = (np.arange(PARTS) + 0.5) / PARTS - 0.5
    along, across = (each[own.crossed] for each in np.broadcast_arrays(*places))
    heights = [fault.heights(along + i * dx, across + j * dy) for i in parts for j in parts]
    drop = np.zeros(distance.shape)
    drop[own.crossed] = np.mean(np.maximum(np.negative(heights), 0.0), axis=0)
    edges.drop[under] += drop
    return own.sound
