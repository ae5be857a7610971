"""Outline of the section of a solid of revolution: a closed polygon beside the axis, and a mesh inside it."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from asperity.arguments import (
    Array,
    ArrayLike,
    Flags,
    Integers,
    finite_array,
    one_of,
    positive,
    require,
)
from asperity.errors import ComputationError, InputError
from asperity.parameters import LENGTH, LENGTH_OR_ZERO, Number, Quantity, parameter
from asperity.reference.railways import SECTIONS
from asperity.written_numbers import rounded

MOST_POINTS = 2000
FINENESS = 0.25
"""Size of the triangles over the mean thickness of the section, twice its area over its circumference."""
BLUNT = 0.01
"""By which part of that size an outline may be straightened."""
MOST_CELLS = 2e7
"""Most triangles that fit beside the section, times pieces around it: real wheels have some 10⁵."""
MOST_TRIANGLES = 5000
"""Most triangles of a section: wheels have some 600, and each mode takes time like their number."""
MOST_SPLITS = 12
"""Times that edges of an outline are halved until triangles meet them."""
LARGEST_WHEEL = 0.65
"""Largest radius of the wheels that run today, with some room, m: locomotives have 0.625 m."""
HIGHEST_FLANGE = 42e-3
"""m: flanges are 19 to 38 mm high; one in a table of diameters has twice that."""
TO_AND_FRO = 5
"""Turns one after the other, each the other way, that no section has: steps of a hub are fewer."""
STANDS_OUT = 0.05
"""How far a web stands out of hub and rim along the axle, at most, m: bent ones stay within."""
SHARP = np.radians(20.0)
"""Angle from which a turn counts as one."""
SMOOTHED = 0.5e-3
"""By which an outline is straightened before its turns are counted, m."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles of six nodes in the section of a solid of revolution."""

    nodes: Array  # (k, 2), radius and axial place, m
    triangles: Integers  # (e, 6), corners, then the middles of the sides 01, 12 and 20
    edges: Integers  # (b, 3), of the outline, one behind the other: first, middle and last node


def checked_outline(points: ArrayLike, what: str = "outline of the section") -> Array:
    """Outline (n, 2), radius and axial place, m, as it is meshed: closed, counterclockwise, each point once.

    Raises
    ------
    InputError
        If it has too few points or too many, leaves the axis to the other side, crosses itself, or is as
        large or small as no wheel is.
    """
    allowed = f"3 to {MOST_POINTS} points, radius and axial place"
    given = finite_array(what, points, allowed, shape=(None, 2))
    repeated = (given == np.roll(given, 1, axis=0)).all(axis=1)
    outline = given[~repeated]
    require(3 <= len(outline) <= MOST_POINTS, what, f"{len(outline)} different points", allowed)
    least = outline[:, 0].min()
    largest = np.abs(outline).max()
    received = f"a radius of {least * 1e3:.4g} mm"
    allowed = "radii above 0, from the axis"
    require(least > 0.0, what, received, allowed, "Columns are radius and axial place.")
    received = f"a point {largest:.4g} m away"
    allowed = "wheels of 1 mm to 5 m"
    require(1e-3 <= largest <= 5.0, what, received, allowed, "Is the unit of the coordinates right?")
    if (crossing := _crossing(outline)) is not None:
        first, second = (f"({r * 1e3:.4g} mm, {z * 1e3:.4g} mm)" for r, z in outline[list(crossing)])
        received = f"edges from {first} and from {second} that touch"
        raise InputError(what, received, "an outline that goes round once", "List its points in order.")
    return outline if _doubled_area(outline) > 0.0 else outline[::-1]


def _doubled_area(outline: Array) -> float:
    r, z = outline.T
    r2, z2 = np.roll(outline, -1, axis=0).T
    return float(np.sum(r * z2 - r2 * z))


def doubts_of(outline: Array, radius: float) -> Iterator[str]:
    """Say what is hardly meant of a checked outline of a wheel, m, with a radius at its running circle, m.

    One or two sentences each: a diameter for a radius, a web beside hub and rim, edges that go to and fro.
    """
    if radius > LARGEST_WHEEL:
        yield (
            f"a wheel with a radius of {radius * 1e3:.4g} mm: wheels of trains have 170 mm to 625 mm. Is it "
            "the diameter, or are the radii of its section diameters? Then halve them."
        )
    if (height := float(outline[:, 0].max() - radius)) > HIGHEST_FLANGE:
        yield (
            f"a flange {height * 1e3:.4g} mm high: flanges are 19 mm to 38 mm high. Are the radii of its "
            "section diameters? Then halve them, and the radius."
        )
    if (beside := _web_beside(outline)) > STANDS_OUT:
        yield (
            f"a web that stands out of hub and rim by {beside * 1e3:.4g} mm along the axle: bent webs "
            "of wheels stay between their faces. Is its bend in mm?"
        )
    turns, (r, z) = _turns_to_and_fro(outline)
    if turns >= TO_AND_FRO:
        r = 1e3 * r
        z = 1e3 * z
        yield (
            f"an outline that turns to and fro {turns} times in a row, up to ({r:.4g} mm, {z:.4g} mm): a "
            "web that zigzags is none of a wheel. List its points in order, and smooth what was digitised."
        )


def _web_beside(outline: Array) -> float:
    """How far points between hub and rim lie beside the faces of both, along the axle, m."""
    radius, place = outline.T
    share = (radius - radius.min()) / np.ptp(radius)
    web = (share > 0.1) & (share < 0.8)
    if not web.any():
        return 0.0
    low = place[~web].min()
    high = place[~web].max()
    return float(max(place[web].max() - high, low - place[web].min()))


def _turns_to_and_fro(outline: Array) -> tuple[int, Array]:
    """Most sharp turns in a row, each the other way than the last, and the point of that (2,), m."""
    points = _straightened(outline, SMOOTHED, np.zeros(0, dtype=np.int64))
    edges = np.roll(points, -1, axis=0) - points
    heading = np.arctan2(edges[:, 1], edges[:, 0])
    turns = (heading - np.roll(heading, 1) + np.pi) % (2.0 * np.pi) - np.pi
    ways = np.where(np.abs(turns) > SHARP, np.sign(turns), 0.0)
    in_a_row = np.zeros(len(points), dtype=np.int64)
    for n in range(1, len(points)):
        in_a_row[n] = in_a_row[n - 1] + 1 if ways[n] * ways[n - 1] < 0.0 else 0
    return int(in_a_row.max()) + 1, points[np.argmax(in_a_row)]


def volume_of(outline: Array) -> float:
    """Volume of the solid of revolution in an outline, m³: 2π ∫ r dA (Pappus)."""
    r, z = outline.T
    r2, z2 = np.roll(outline, -1, axis=0).T
    return float(abs(np.sum((r + r2) * (r * z2 - r2 * z))) * np.pi / 3.0)


def _crossing(outline: Array) -> tuple[int, int] | None:
    """Numbers of the first two edges that meet, other than at the point between neighbours."""
    count = len(outline)
    to = np.roll(outline, -1, axis=0)

    def side(a: Array, b: Array, c: Array) -> Array:
        """Side of the lines from a to b on which points c lie."""
        along = b - a
        away = c - a
        area = along[..., 0] * away[..., 1] - along[..., 1] * away[..., 0]
        return np.sign(np.where(np.abs(area) < 1e-12 * np.abs(outline).max() ** 2, 0.0, area))

    a = outline[:, None]
    b = to[:, None]
    apart = side(a, b, outline) * side(a, b, to) > 0.0
    low = np.minimum(outline, to)
    high = np.maximum(outline, to)
    boxes = ((low[:, None] <= high) & (high[:, None] >= low)).all(axis=-1)
    meet = boxes & ~(apart | apart.T)
    number = np.arange(count)
    meet[number, number] = False
    for one, other in ((number, (number + 1) % count), ((number + 1) % count, number)):
        meet[one, other] = False  # neighbours share a point
    doubled = np.sum((to - outline) * (np.roll(to, -1, axis=0) - to), axis=1)
    back = (side(outline, to, np.roll(to, -1, axis=0)) == 0.0) & (doubled < 0.0)
    found = np.argwhere(meet)
    if back.any():
        return int(np.argmax(back)), int(np.argmax(back) + 1) % count
    return (int(found[0, 0]), int(found[0, 1])) if len(found) else None


def mean_thickness(outline: Array) -> float:
    """Twice the area of a section over its circumference, m."""
    length = np.hypot(*(np.roll(outline, -1, axis=0) - outline).T).sum()
    return float(abs(_doubled_area(outline)) / length)


def mesh_of(outline: Array, size: float | None = None, kept: ArrayLike = ()) -> Mesh:
    """Mesh the section in a checked outline by triangles of about a size, m.

    By default `FINENESS` times its mean thickness. Points of the outline closer to a straight line than a
    hundredth of this are left out, but those whose numbers are `kept`.
    """
    thick = mean_thickness(outline)
    step = FINENESS * thick if size is None else size
    width, height = np.ptp(outline, axis=0)
    if width * height * _doubled_area(outline) / thick > MOST_CELLS * step**3:
        received = f"a mean thickness of {rounded(thick * 1e3)} mm on {rounded(max(width, height) * 1e3)} mm"
        raise InputError("outline of the section", received, "a section that is not so thin or jagged")
    count = round(_doubled_area(outline) / (0.5 * np.sqrt(3.0) * step**2))
    received = (
        f"{count} triangles of {rounded(step * 1e3)} mm, for a mean thickness of {rounded(thick * 1e3)} mm"
    )
    allowed = f"at most {MOST_TRIANGLES}, some more than a disc of 3 mm has"
    require(count <= MOST_TRIANGLES, "outline of the section", received, allowed, "Is the unit right?")
    around = _divided(_straightened(outline, BLUNT * step, np.atleast_1d(np.asarray(kept, dtype=int))), step)
    inner = _lattice(around, step)
    for _ in range(MOST_SPLITS):
        corners = np.vstack([around, inner])
        triangles = _triangles(corners, around)
        missing = _missing_edges(triangles, len(around))
        if not missing.any():
            break
        middles = 0.5 * (around + np.roll(around, -1, axis=0))
        at = np.flatnonzero(missing) + 1
        around = np.insert(around, at, middles[missing], axis=0)
    area = 0.5 * np.sum(_areas(corners[triangles]))
    if missing.any() or abs(area / (0.5 * _doubled_area(around)) - 1.0) > 1e-9:
        raise ComputationError(
            "the section could not be meshed", "Draw its outline with fewer sharp corners."
        )
    return _quadratic(corners, triangles, len(around))


def _straightened(outline: Array, tolerance: float, kept: Integers) -> Array:
    """Leave out points within a tolerance, m, of the line between others (Ramer, Douglas and Peucker)."""
    far = int(np.argmax(np.hypot(*(outline - outline[0]).T)))
    stay = np.zeros(len(outline) + 1, dtype=bool)
    corners = sorted({0, far, len(outline), *kept.tolist()})
    closed = np.vstack([outline, outline[:1]])
    spans = list(pairwise(corners))
    while spans:
        first, last = spans.pop()
        stay[[first, last]] = True
        if last - first < 2:
            continue
        away = _distances(closed[first + 1 : last], closed[[first]], closed[[last]])[:, 0]
        if away.max() > tolerance:
            split = first + 1 + int(np.argmax(away))
            spans += [(first, split), (split, last)]
    return outline[stay[:-1]]


def _divided(outline: Array, step: float) -> Array:
    """Divide the edges of an outline into pieces of at most a length, m."""
    to = np.roll(outline, -1, axis=0)
    pieces = np.ceil(np.hypot(*(to - outline).T) / step * (1.0 - 1e-9)).astype(int)
    parts = [
        a + (b - a) * np.arange(count)[:, None] / count
        for a, b, count in zip(outline, to, pieces, strict=True)
    ]
    return np.vstack(parts)


def _lattice(around: Array, step: float) -> Array:
    """Points of a lattice of equilateral triangles inside an outline, away from it."""
    low = around.min(axis=0)
    high = around.max(axis=0)
    rows = np.arange(low[1], high[1], 0.5 * np.sqrt(3.0) * step)
    columns = np.arange(low[0], high[0] + step, step)
    r = columns + 0.5 * step * (np.arange(len(rows)) % 2)[:, None]
    points = np.stack([r, np.broadcast_to(rows[:, None], r.shape)], axis=-1).reshape(-1, 2)
    points = points[_inside(points, around)]
    near = _distances(points, around, np.roll(around, -1, axis=0)).min(axis=1, initial=np.inf)
    return points[near > 0.6 * step]


def _inside(points: Array, around: Array) -> Flags:
    """Whether points (n, 2) lie inside: an odd number of edges on the way out."""
    r, z = around.T
    r2, z2 = np.roll(around, -1, axis=0).T
    at = points[:, 1:]
    spanned = (z > at) != (z2 > at)
    beyond = r + (at - z) * (r2 - r) / np.where(z2 == z, 1.0, z2 - z) > points[:, :1]
    return np.sum(spanned & beyond, axis=1) % 2 == 1


def _distances(points: Array, a: Array, b: Array) -> Array:
    """Distances of points (n, 2) from the straight pieces from a to b (m, 2), (n, m)."""
    along = b - a
    square = np.maximum(np.sum(along**2, axis=1), 1e-300)
    share = np.clip(np.sum((points[:, None] - a) * along, axis=-1) / square, 0.0, 1.0)
    return np.linalg.norm(points[:, None] - a - share[..., None] * along, axis=-1)


def _areas(corners: Array) -> Array:
    """Twice the areas of triangles (e, 3, 2), positive if they are counterclockwise."""
    first = corners[:, 1] - corners[:, 0]
    second = corners[:, 2] - corners[:, 0]
    return first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]


def _triangles(corners: Array, around: Array) -> Integers:
    """Triangles of Delaunay that lie inside an outline, counterclockwise (e, 3)."""
    from scipy.spatial import Delaunay

    found = Delaunay(corners).simplices.astype(np.int64)
    area = _areas(corners[found])
    found = np.where((area < 0.0)[:, None], found[:, ::-1], found)
    flat = np.abs(area) < 1e-9 * np.abs(area).max()
    return found[~flat & _inside(corners[found].mean(axis=1), around)]


def _missing_edges(triangles: Integers, count: int) -> Flags:
    """Which edges of an outline of so many points are no side of one triangle."""
    sides = np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    start = np.arange(count)
    there = {(int(a), int(b)) for a, b in sides[(sides < count).all(axis=1)]}
    return np.array([(int(a), (int(a) + 1) % count) not in there for a in start])


def _quadratic(corners: Array, triangles: Integers, around: int) -> Mesh:
    """Put a node in the middle of each side; edges of the outline are those of the first corners."""
    sides = np.stack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]], axis=1)
    known, number = np.unique(np.sort(sides, axis=2).reshape(-1, 2), axis=0, return_inverse=True)
    middle = len(corners) + number.reshape(-1, 3)
    nodes = np.vstack([corners, 0.5 * corners[known].sum(axis=1)])
    start = np.arange(around)
    ends = np.stack([start, (start + 1) % around], axis=1)
    place = {(int(a), int(b)): i for i, (a, b) in enumerate(known)}
    on_edges = np.array([len(corners) + place[(min(a, b), max(a, b))] for a, b in ends.tolist()])
    return Mesh(nodes, np.hstack([triangles, middle]), np.stack([ends[:, 0], on_edges, ends[:, 1]], axis=1))


BACK = 0.070
"""Distance of the running circle from the back of the flange, m."""
_WITHIN = "1 mm to 1 m: wheels lie between"
_OFFSET = Quantity("m")
_SIDE = "-0.5 m to 0.5 m: wheels are narrower"
_POINTS = 41
"""Points along each side of the web."""


@dataclass(frozen=True)
class WheelSection:
    """Hub, web and rim of a wheel of a radius that is given beside it.

    Axial places count from the running circle, positive away from the flange, whose back is 70 mm from it.
    The middle of the web goes smoothly from that of the hub to that of the rim, and bends between them.

    Parameters
    ----------
    bore_radius, hub_radius, hub_width, hub_offset : float
        Radii of the seat on the axle and of the hub, its width, and by how much its middle stands outside
        that of the rim, m.
    web_thickness, web_thickness_rim, web_bend, fillet_radius : float
        Thickness of the web at hub and rim, by how much it bends outwards, and the radius of its fillets, m.
    rim_thickness, rim_width, flange_height, flange_thickness : float
        Of rim and flange, m.
    tread_slope : float
        By how much the radius of the tread falls per length outwards.

    Raises
    ------
    InputError
        Of `outline`, if hub, web and rim do not fit into the radius.

    Examples
    --------
    >>> from asperity import WheelSection
    >>> section = WheelSection.named("straight-web", rim_thickness=0.07)
    >>> outline = section.outline(0.46)  # radius and axial place, m
    >>> float(outline[:, 0].min())
    0.0925
    """

    bore_radius: float = parameter(
        LENGTH, "92.5 mm", "radius of the seat on the axle, where the wheel is held", _WITHIN
    )
    hub_radius: float = parameter(LENGTH, "135 mm", "radius of the hub", _WITHIN)
    hub_width: float = parameter(LENGTH, "175 mm", "width of the hub along the axle", _WITHIN)
    hub_offset: float = parameter(
        _OFFSET, "45 mm", "by how much the hub's middle stands outside that of the rim", _SIDE
    )
    web_thickness: float = parameter(LENGTH, "28 mm", "thickness of the web at the hub", _WITHIN)
    web_thickness_rim: float = parameter(LENGTH, "22 mm", "thickness of the web at the rim", _WITHIN)
    web_bend: float = parameter(
        _OFFSET, "20 mm", "by how much the web bends outwards in its middle, beside its way to the rim", _SIDE
    )
    fillet_radius: float = parameter(
        LENGTH_OR_ZERO, "25 mm", "radius of the fillets between web, hub and rim", _WITHIN
    )
    rim_thickness: float = parameter(LENGTH, "65 mm", "thickness of the rim at the running circle", _WITHIN)
    rim_width: float = parameter(LENGTH, "135 mm", "width of the rim with the flange", _WITHIN)
    flange_height: float = parameter(
        LENGTH_OR_ZERO, "28 mm", "height of the flange, 0 m without one", _WITHIN
    )
    flange_thickness: float = parameter(LENGTH, "32 mm", "thickness of the flange", _WITHIN)
    tread_slope: float = parameter(
        Number(at_least=0, at_most=0.5), 0.05, "by how much the tread's radius falls per length outwards"
    )

    @classmethod
    def named(cls, name: str, **changes: float) -> "WheelSection":
        """One of the named sections, with other dimensions where they are given.

        Raises
        ------
        InputError
            If there is none of this name.
        """
        return cls(**SECTIONS[one_of("wheel section", name, SECTIONS)] | changes)

    def outline(self, radius: float) -> Array:
        """Outline (n, 2), radius and axial place, m, of a wheel of a radius at its running circle, m."""
        rim = positive("radius of the wheel (m)", radius) - self.rim_thickness
        inside = self.rim_width - BACK
        what = "section of the wheel"
        allowed = "bore, hub and rim one outside the other"
        received = f"radii of {self.bore_radius:g}, {self.hub_radius:g} and, inside the rim, {rim:g} m"
        require(self.bore_radius < self.hub_radius < rim, what, received, allowed)
        allowed = "a tread as wide as the running circle and the flange need"
        slim = 1.5 * self.flange_thickness < BACK and inside > 0.0
        require(slim, what, f"a rim of {self.rim_width:g} m", allowed, f"Its back is {BACK:g} m inside.")
        middle = 0.5 * self.rim_width - BACK
        share = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, _POINTS))
        at = self.hub_radius + share * (rim - self.hub_radius)
        web = middle + self.hub_offset * (1.0 - share**2 * (3.0 - 2.0 * share))
        web = web + self.web_bend * 16.0 * (share * (1.0 - share)) ** 2
        half = 0.5 * (self.web_thickness + share * (self.web_thickness_rim - self.web_thickness))
        half = half + _fillet(np.minimum(at - self.hub_radius, rim - at), self.fillet_radius)
        hub = middle + self.hub_offset + 0.5 * self.hub_width * np.array([-1.0, 1.0])
        narrow = hub[0] < web[0] - half[0] and 2.0 * half[-1] < self.rim_width
        require(narrow, what, "a web wider than hub or rim", "a web narrower than both")
        root = -BACK + 1.5 * self.flange_thickness
        height = self.flange_height
        flange = [
            (radius - self.tread_slope * root, root),
            (radius + height, -BACK + 0.7 * self.flange_thickness),
            (radius + height, -BACK + 0.3 * self.flange_thickness),
            (radius + 0.6 * height, -BACK),
        ]
        if height == 0.0:
            flange = [(radius + self.tread_slope * BACK, -BACK)]
        tread = [(radius - self.tread_slope * inside, inside), (radius, 0.0)]
        return np.vstack(
            [
                [(self.bore_radius, hub[0]), (self.bore_radius, hub[1]), (self.hub_radius, hub[1])],
                np.stack([at, web + half], axis=1),
                [(rim, inside), *tread, *flange, (rim, -BACK)],
                np.stack([at, web - half], axis=1)[::-1],
                [(self.hub_radius, hub[0])],
            ]
        )


def _fillet(distance: Array, radius: float) -> Array:
    """By how much a quarter of a circle reaches out at distances from the face that it meets, m."""
    away = np.clip(radius - distance, 0.0, radius)
    return radius - np.sqrt(radius**2 - away**2)
