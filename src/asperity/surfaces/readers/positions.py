"""Points on a uniform line or grid, known by their coordinates as these were printed."""

import math
from collections.abc import Iterator

import numpy as np
import scipy

from asperity.arguments import Array, Indices, require
from asperity.errors import InputError
from asperity.written_numbers import count_of, rounded

TOLERANCE = 0.05
"""Largest distance of a point from the grid, in spacings, unless its coordinate was printed more coarsely."""
SPARSEST = 0.5
"""Smallest share of grid points that must be there."""
RESAMPLE = "Resample the heights at a uniform spacing first."
CHECK = "Check the file and its columns."
DOUBLED = "Remove rows that stand twice; of lines one below the other keep one, or write them side by side."
UNEVEN = "coordinates that are not uniform"
MOST_DIGITS = 13
"""Digits beyond which a number in double precision was not rounded as it was printed."""
CHANCE = 0.1
"""Largest chance that any points, rounded as coarsely, seem to be as even: few of them prove nothing."""
SURE = 0.75
"""Largest share of a spacing that counts there: beyond it, only that points stand in order tells."""
BISECTIONS = 40
"""Of a slope, each of which halves what is not known of it."""
WIDEST_GAP = 0.1
"""Largest share of a section without a point."""
MOST_TIMES = 8
"""Places of a section that was made even, over its points, at most."""
LARGEST = 1e60
"""Size of a coordinate in any unit."""
JITTER = 4.0
"""Least ratio of distances between the lines of a grid to those of coordinates within one of them."""
Index = Indices


def line(x: Array, z: Array, source: str) -> tuple[Array, float]:
    """Put points x, z, given in any order, on the uniform line that they lie on.

    Returns the heights along rising x, NaN where the line has no point, and the spacing, in the units given.
    Several heights (n, k) of each point stay beside each other. Refused are points that stand twice, or fill
    less than half of the line.
    """
    try:
        index, spacing = places(x, f"x of {source}")
    except InputError as error:
        if error.received == UNEVEN and z.ndim == 1 and are_even(z):
            remedy = "Its second column is even: exchange both, or name them in a heading."
            raise InputError(error.what, UNEVEN, error.allowed, remedy) from None
        raise
    return _gridded(index, z, (int(index.max()) + 1,), source), spacing


def made_even(x: Array, z: Array, source: str) -> tuple[Array, float]:
    """Put points of a section on a uniform line as `line` does, or interpolate them where they are on none.

    Between uneven points it is a spline that overshoots none of them (Akima 1970), at the median of their
    distances. Refused are two heights at one place, and gaps wider than any that a spline may fill.
    """
    try:
        return line(x, z, source)
    except InputError as error:
        if error.received != UNEVEN:
            raise
    order = np.argsort(x, kind="stable")
    place = x[order]
    height = z[order]
    gaps = np.diff(place)
    received = f"several heights at {rounded(place[int(np.argmin(gaps))])}"
    remedy = "Leave flanks out that overhang."
    require(gaps.min() > 0.0, f"x of {source}", received, "one height at each place", remedy)
    extent = place[-1] - place[0]
    widest = f"a gap of {rounded(gaps.max() / extent)} of the line without a point"
    require(gaps.max() <= WIDEST_GAP * extent, f"x of {source}", widest, f"at most {WIDEST_GAP}", RESAMPLE)
    count = 1 + min(math.ceil(extent / np.median(gaps)), MOST_TIMES * len(x))
    even = np.linspace(place[0], place[-1], count)
    heights = scipy.interpolate.Akima1DInterpolator(place, height)(even)
    return np.asarray(heights), float(extent / (count - 1))


def rasterised(x: Array, y: Array, z: Array, source: str) -> tuple[Array, tuple[float, float]]:
    """Sort points x, y, z, given in any order, into the regular grid that they lie on.

    Returns the heights (nx, ny) along rising x and y, NaN where the grid has no point, and (dx, dy), in the
    units given. Refused are points that stand twice, or fill less than half of the grid.
    """
    names = (f"x of {source}", f"y of {source}")
    if (scanned := _line_by_line(x, y)) is not None:
        (i, dx), (j, dy) = map(places, scanned[:2], names)
        i, j = (each.ravel() for each in np.meshgrid(i, j, indexing="xy" if scanned[2] else "ij"))
    else:
        (i, dx), (j, dy) = map(_places_in_lines, (x, y), names)
    shape = (int(i.max()) + 1, int(j.max()) + 1)
    return _gridded(i * shape[1] + j, z, shape, source), (dx, dy)


def _gridded(index: Index, z: Array, shape: tuple[int, ...], source: str) -> Array:
    """Heights on a grid; that points fill half of it is known before it is allocated."""
    received = f"{count_of(len(z), 'point')} that would need a grid of {' x '.join(str(n) for n in shape)}"
    dense = math.prod(shape) * SPARSEST <= len(z)
    require(dense, source, received, "points on a regular grid", RESAMPLE)
    rows = np.unique(index, return_index=True)[1]
    if len(rows) < len(index):
        again = int(np.setdiff1d(np.arange(len(index)), rows, assume_unique=True)[0])
        received = f"several points at one place, one of them again as point {again + 1}"
        raise InputError(source, received, "one height per grid point", DOUBLED)
    heights = np.full((math.prod(shape), *z.shape[1:]), np.nan)
    heights[index] = z
    return heights.reshape(*shape, *z.shape[1:])


# --- lines of a grid


def _line_by_line(x: Array, y: Array) -> tuple[Array, Array, bool] | None:
    """Coordinates of the lines of a grid that points fill line by line, and whether lines lie along x.

    They keep their order, which tells lines apart whose printed coordinates are the same. None for points
    that stand otherwise.
    """
    for fast, slow, along_x in ((x, y, True), (y, x, False)):
        steps = np.diff(fast)
        falls = np.count_nonzero(steps > 0.0) < np.count_nonzero(steps < 0.0)
        back = np.flatnonzero(steps > 0.0 if falls else steps < 0.0)
        length = int(back[0]) + 1 if len(back) else 0
        if length > 1 and len(fast) % length == 0:
            within = fast.reshape(-1, length)
            number = slow.reshape(-1, length)
            whole = (within == within[0]).all() and (number == number[:, :1]).all()
            if whole and _rises(number[:, 0]):
                return (within[0], number[:, 0], True) if along_x else (number[:, 0], within[0], False)
    return None


def _rises(coordinates: Array) -> bool:
    """Whether coordinates rise or fall all along, or stay the same for some of their points."""
    steps = np.diff(coordinates)
    return bool((steps >= 0.0).all() or (steps <= 0.0).all())


def _places_in_lines(coordinates: Array, what: str) -> tuple[Index, float]:
    """Number the lines of a grid that coordinates lie on, as `places` those of single points.

    What lies in one line may differ by little. Where the distances of neighbours, by their size, leap most,
    those between the lines begin.
    """
    _refuse_unknown(coordinates, what)
    order = np.argsort(coordinates, kind="stable")
    gaps = np.diff(coordinates[order])
    sizes = np.unique(gaps[gaps > 0.0])
    least = sizes[0] if len(sizes) else 0.0
    if len(sizes) > 1 and (leap := sizes[1:] / sizes[:-1]).max() > JITTER:
        least = sizes[1 + int(np.argmax(leap))]
    number = np.concatenate([[0], np.cumsum(gaps >= least)])[np.argsort(order)] if least else order * 0
    count = np.bincount(number)
    middles = np.bincount(number, coordinates) / count
    first = coordinates[order][np.concatenate([[0], np.cumsum(count)[:-1]])]
    same = np.bincount(number, coordinates == first[number]) == count  # all of a line: no sum rounds them
    index, step = places(np.where(same, first, middles), what)
    off = np.abs(coordinates - coordinates.min() - index[number] * step).max()
    even = same.all() or off <= TOLERANCE * step
    require(even, what, UNEVEN, f"coordinates at a uniform spacing (within {TOLERANCE} of it)", RESAMPLE)
    return index[number], step


# --- one line


def places(coordinates: Array, what: str) -> tuple[Index, float]:
    """Number the places of coordinates on a uniform line, from zero on, and return its spacing.

    Length over count: points that fill a line are as many as its places. Each lies within 0.05 spacings of
    its place, or within half of the last digit that its coordinate was printed with. Where points are left
    out, distances of neighbours tell how many. `what` they are is for messages.
    """
    _refuse_unknown(coordinates, what)
    turned = bool(coordinates[0] > coordinates[-1])
    given = coordinates[::-1] if turned else coordinates
    order = np.argsort(given, kind="stable")
    rising = given[order]
    extent = float(rising[-1] - rising[0])
    require(extent > 0.0, what, "fewer than two different coordinates", "at least two", CHECK)
    found = _places_of(rising, in_order=bool((order[1:] > order[:-1]).all()))
    allowed = f"coordinates at a uniform spacing (within {TOLERANCE} of it, or half of their last digit)"
    require(found is not None, what, UNEVEN, allowed, RESAMPLE)
    assert found is not None
    index = np.empty(len(rising), dtype=np.intp)
    index[order] = found
    return index[::-1] if turned else index, extent / float(found[-1])


def are_even(coordinates: Array) -> bool:
    """Whether numbers, five or more, rise or fall evenly, as positions do and heights do not."""
    if len(coordinates) < FEWEST_EVEN or not _known(coordinates) or not _rises(coordinates):
        return False
    return bool(np.ptp(coordinates)) and _near(np.sort(coordinates), np.arange(len(coordinates)))


FEWEST_EVEN = 5
"""Numbers that are not even by chance."""


def _places_of(rising: Array, *, in_order: bool) -> Index | None:
    """Places of rising coordinates, which may have stood in this order; None where they lie on no line."""
    each = np.arange(len(rising))
    if _near(rising, each):
        return each
    times = np.unique(rising, return_counts=True)[1]
    by_digits = times.max() == 1 or (in_order and times.min() < times.max())  # digits alone make points equal
    if by_digits and _as_printed(rising, each):  # nothing has to be left out
        return each
    counted = _counted(rising)
    return counted if _is_dense(counted) and _as_printed(rising, counted) else None


def _counted(rising: Array) -> Index:
    """Places of rising coordinates by their distances, in means of those that are single spacings."""
    gaps = np.diff(rising)
    positive = gaps[gaps > 0.0]
    single = np.mean(positive[positive < 1.5 * np.median(positive)])
    return np.concatenate([[0], np.cumsum(np.rint(gaps / single))]).astype(np.intp)


def _is_dense(index: Index) -> bool:
    """Whether at least half of the places that differ are next to each other."""
    steps = np.diff(index)
    return bool(steps.any() and np.median(steps[steps > 0]) == 1)


def _near(rising: Array, index: Index) -> bool:
    """Whether coordinates are near to their places between first and last."""
    if not index[-1]:
        return False
    step = (rising[-1] - rising[0]) / index[-1]
    return bool(np.abs(rising - rising[0] - index * step).max() <= TOLERANCE * step)


def _as_printed(rising: Array, index: Index) -> bool:
    """Whether coordinates are near to their places, or as near as their last digits tell."""
    return _near(rising, index) or any(_between(rising, index, half) for half in half_digits(rising))


def _between(rising: Array, index: Index, half: Array) -> bool:
    """Whether any straight line over the places passes all coordinates within half a digit.

    How far it stays within all of them is concave in its slope, whose optimum is found by bisection.
    """
    low = rising - half
    high = rising + half
    last = max(int(index[-1]), 1)
    share = min(2.0 * half.max() * last / (rising[-1] - rising[0]), SURE)
    if share ** (len(rising) - 2) > CHANCE:
        return False
    off = np.abs(rising - rising[0] - index * ((rising[-1] - rising[0]) / last))
    if (off > half + max(half[0], half[-1])).any():  # a line that passes both ends misses them
        return False
    steps = [(low[-1] - high[0]) / last, (high[-1] - low[0]) / last]
    for _ in range(BISECTIONS):
        step = 0.5 * sum(steps)
        over = high - index * step
        under = low - index * step
        above = int(np.argmin(over))
        below = int(np.argmax(under))
        if over[above] >= under[below]:
            return True
        steps[int(index[below] < index[above])] = step
    return False


def half_digits(coordinates: Array) -> Iterator[Array]:
    """Half of the last digit of each coordinate, by the ways in which columns are printed or stored.

    As many decimals for all of them, as many digits, or single precision; with what double precision rounds.
    """
    size = np.abs(coordinates)
    slack = 1e-9
    for decimals in range(MOST_DIGITS):
        scaled = size * 10.0**decimals
        if (np.abs(scaled - np.rint(scaled)) <= 1e-15 * scaled).all():
            yield np.full(len(size), (0.5 + slack) * 10.0**-decimals)
            break
    exponent = np.floor(np.log10(np.where(size > 0.0, size, 1.0)) + slack)
    for digits in range(1, MOST_DIGITS):
        unit = 10.0 ** (exponent - digits + 1)
        scaled = size / unit
        if (np.abs(scaled - np.rint(scaled)) <= 1e-14 * scaled).all():
            yield (0.5 + slack) * unit * (size > 0.0)
            break
    with np.errstate(over="ignore"):
        single = coordinates.astype(np.float32)
    if (single == coordinates).all():
        yield (0.5 + slack) * np.abs(np.spacing(single).astype(np.float64))


def _refuse_unknown(coordinates: Array, what: str) -> None:
    received = "missing or infinite coordinates"
    require(_known(coordinates), what, received, "a coordinate for each point", CHECK)


def _known(coordinates: Array) -> bool:
    """Whether all are numbers whose distances are numbers, too; none of a place is larger."""
    return bool((np.abs(coordinates) < LARGEST).all())
