"""Numbers that bound what the gap of a cell at a rim gains on another, found on samples and proved on boxes.

Lengths are in sides of a cell along, and E* is one. A cell of pressure p whose neighbours differ by x and y,
not negative, keeps the gap R = S·w·L(u, m), S = √(x² + y²), w = S/√(x² + e y²), u = √(p/S), m the smaller
difference over the larger; √e is the side along over that across. With a hardness of one what is left is
R(p, x, y) − R(1 − p, x, y), which stands for R from here on. Of a cell and a gap Γ, which is R, or further
from it where there is no pressure or where surfaces flow, it is asked for which c, a and b

    f = c (p′ − p)² + a (x′ − x)² + b (y′ − y)² − (p′ − p)(R′ − Γ) ≥ 0                                 (1)

whatever p′, x′ and y′ are: with a hardness, up to one. These are cut into boxes of p′, of the larger
difference M, and of the slant, until on each one of the following decides:

- f or p′ − p times R′ − Γ, by sums and products of intervals;
- f in the middle, and intervals of its derivatives;
- n₁²/a + n₂²/b ≤ 4 (c − ∂R/∂p), n = (∂R/∂x, ∂R/∂y), on a convex set that holds the box and the cell: R′ − R
  is a derivative along the straight way between them, somewhere on it.

Without a hardness f grows as M² and p′² do where (1) holds for a cell without pressure beside which there is
none either, of Γ = 0, with something to spare: beyond a bound it need not be asked. All is in double
precision: `ROUNDING` stands for what that rounds.
"""

import math
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.optimize import linprog

from asperity.kernels.rim_curves import END, KNOTS, LEFT, SLANTS, cubics

CUBICS = cubics(LEFT)
STEP = END / (KNOTS - 1)
SLANT_KNOTS = (np.arange(SLANTS) / (SLANTS - 1)) ** 2
BASE = np.array([0.02, 0.034, 0.034])
"""c, a and b that cells have at least without a hardness, and those beside which is none always."""
LEAST = 0.003
"""Least number of other cells."""
CORNER = 0.3
"""Pressures and differences, over a hardness, of cells that are far from flow: 1 − p ≥ `END`² S."""
SLACK = 1.25
"""Numbers that are to be proved over those that samples need."""
ROUNDING = 1e-12
MOST_BOXES = 20_000
"""Of one cell."""
GROUP = 200
"""Cells that are proved at a time."""
UNPROVED = 100.0
"""More than K holds of any cell."""


def times(a, b):
    """Products of intervals (2, n)."""
    products = np.stack([a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1]])
    return np.stack([products.min(0), products.max(0)])


def less(a, b):
    """Differences of intervals."""
    return a - b[::-1]


def squared(a):
    """Squares of intervals."""
    ends = a * a
    return np.stack([np.where((a[0] < 0.0) & (a[1] > 0.0), 0.0, ends.min(0)), ends.max(0)])


def on_curve(j, u, order):
    """Values of the curve of a slant, or slopes, of order one, at ratios up to `END`."""
    k = np.clip((u / STEP).astype(int), 0, KNOTS - 2)
    t = u / STEP - k
    a, b, c, d = (CUBICS[j, k, i] for i in range(4))
    return (b + t * (2.0 * c + 3.0 * t * d)) / STEP if order else a + t * (b + t * (c + t * d))


def turns(j, order):
    """Ratios inside a curve where its values may turn, or its slopes."""
    found = [k * STEP for k in range(1, KNOTS - 1)] if order else []
    for k in range(KNOTS - 1):
        roots = np.polynomial.Polynomial(CUBICS[j, k]).deriv(order + 1).roots()
        found += [(k + t.real) * STEP for t in roots if abs(t.imag) < 1e-9 and 0.0 <= t.real <= 1.0]
    return np.array(found)


def extremes(j, order):
    """Ratios where a curve or its slope turns, and its extremes from the first to below the second of two."""
    places = np.sort(turns(j, order))
    values = on_curve(j, places, order)
    low, high = np.full((2, len(places) + 1, len(places) + 1), [[[np.inf]], [[-np.inf]]])
    for first in range(len(places)):
        low[first, first + 1 :] = np.minimum.accumulate(values[first:])
        high[first, first + 1 :] = np.maximum.accumulate(values[first:])
    return places, low, high


EXTREMES = [[extremes(j, order) for j in range(SLANTS)] for order in (0, 1)]


def span(j, u, order):
    """Intervals that a curve, or its slope, covers on ratios (2, n)."""
    ends = on_curve(j, u, order)
    places, low, high = EXTREMES[order][j]
    inside = np.searchsorted(places, u[0], side="right"), np.searchsorted(places, u[1])
    return np.stack([np.minimum(ends.min(0), low[inside]), np.maximum(ends.max(0), high[inside])])


DEEPEST = -math.sqrt(2.0) * min(span(j, np.array([[0.0], [END]]), 0)[0, 0] for j in range(SLANTS))
"""How far below zero R is, at most, over the larger difference and the longer side."""


def curve(u, m):
    """Intervals of L and of its derivatives by ratio and slant, on boxes without a knot of slants inside."""
    found = np.zeros((3, *u.shape))
    within = np.minimum(u, END)
    place = np.clip(np.searchsorted(SLANT_KNOTS, 0.5 * (m[0] + m[1]), side="right") - 1, 0, SLANTS - 2)
    for j in range(SLANTS - 1):
        here = np.flatnonzero(place == j)
        gap = SLANT_KNOTS[j + 1] - SLANT_KNOTS[j]
        shares = np.clip((m[:, here] - SLANT_KNOTS[j]) / gap, 0.0, 1.0)
        for order in (1, 0):
            low, high = (span(i, within[:, here], order) for i in (j, j + 1))
            ends = np.concatenate([low + share * (high - low) for share in shares])
            found[order][:, here] = ends.min(0), ends.max(0)
        found[2][:, here] = less(high, low) / gap
    beyond = u[1] >= END  # where all is zero
    found[:, 0] = np.where(beyond, np.minimum(found[:, 0], 0.0), found[:, 0])
    found[:, 1] = np.where(beyond, np.maximum(found[:, 1], 0.0), found[:, 1])
    return found * (u[0] < END)


class Left(NamedTuple):
    """Intervals (2, n) of R and of its derivatives on boxes."""

    left: np.ndarray
    by_pressure: np.ndarray
    by_major: np.ndarray  # by the larger difference, the smaller one kept
    by_minor: np.ndarray
    by_size: np.ndarray  # by the larger difference, the slant kept
    by_slant: np.ndarray


def left_at_rim(p, size, m, widths):
    """R without a hardness, on boxes of pressure, larger difference and slant.

    S/w is the root of x² + e y², here that of M² (i + j m²): `widths` are i and j.
    """
    i, j = widths
    lengths = 1.0 + m * m
    widened = i + j * m * m
    with np.errstate(divide="ignore", invalid="ignore"):
        u = np.sqrt(p / (size * np.sqrt(lengths))[::-1])
    u = np.stack(
        [
            np.nan_to_num(each, nan=far, posinf=2.0 * END)
            for each, far in zip(u, (0.0, 2.0 * END), strict=True)
        ]
    )
    left, by_ratio, turn = curve(u, m)
    within = np.clip(u, 1e-9, END)
    step = less(left, 0.5 * times(within, by_ratio))
    skewed = times(left, (i - j) / widened)
    scale = lengths / np.sqrt(widened)[::-1]
    width = np.sqrt(lengths) / np.sqrt(widened)[::-1]
    by_minor = times(scale, times(m / lengths[::-1], step + skewed) + turn)
    by_major = less(times(step, 1.0 / lengths[::-1]), times(m * m / lengths[::-1], skewed) + times(m, turn))
    return Left(
        times(times(size, scale), left),
        times(width, times(by_ratio, 0.5 / within[::-1])),
        times(scale, by_major),
        by_minor,
        times(scale, step),
        times(size, by_minor),
    )


def left_on(box, widths, flows):
    """R on boxes (3, 2, n); flows: with a hardness of one."""
    p, size, m = box
    rim = left_at_rim(p, size, m, widths)
    if not flows:
        return rim
    border = left_at_rim(1.0 - p[::-1], size, m, widths)
    others = (less(a, b) for a, b in zip(rim[2:], border[2:], strict=True))
    return Left(less(rim.left, border.left), rim.by_pressure + border.by_pressure, *others)


class Cells(NamedTuple):
    """Cells (n,) whose numbers are to be proved: x here is the larger difference, a its number."""

    p: np.ndarray
    x: np.ndarray
    y: np.ndarray
    gap: np.ndarray
    c: np.ndarray
    a: np.ndarray
    b: np.ndarray
    end: np.ndarray  # pressure and difference up to which (1) is asked
    i: np.ndarray  # `widths` of x and y
    j: np.ndarray

    def take(self, which):
        """Some of the cells."""
        return Cells(*(each[which] for each in self))

    def swapped(self):
        """The cells with the smaller difference in place of the larger."""
        return self._replace(x=self.y, y=self.x, a=self.b, b=self.a, i=self.j, j=self.i)

    def slant(self):
        """Slants of cells in which x is the larger difference."""
        return self.y / np.maximum(self.x, 1e-300)


def spare(box, left, cells):
    """Intervals of f on a box for each cell, and of p′ − p, x′ − x and y′ − y."""
    p, size, m = box
    ways = p - cells.p, size - cells.x, times(m, size) - cells.y
    squares = sum(
        number * squared(way) for number, way in zip((cells.c, cells.a, cells.b), ways, strict=True)
    )
    return less(squares, times(ways[0], left.left - cells.gap)), ways


def slopes(box, left, cells, ways):
    """Intervals of the derivatives of f by the sides of boxes."""
    _, size, m = box
    own, x, y = ways
    by_pressure = less(less(2.0 * cells.c * own, left.left - cells.gap), times(own, left.by_pressure))
    by_size = less(2.0 * cells.a * x + 2.0 * cells.b * times(m, y), times(own, left.by_size))
    by_slant = less(2.0 * cells.b * times(size, y), times(own, left.by_slant))
    return np.stack([by_pressure, by_size, by_slant])


def steady(box, cells, swapped, flows):
    """Whether the third of the rules holds on boxes; swapped: also where the other difference is larger."""
    p, size, m = box
    holds = np.ones(p.shape[1], bool)
    for low, high in pairwise(SLANT_KNOTS):
        for turned in (False, True) if swapped else (False,):
            here = np.flatnonzero(holds & (m[1] >= low) & (m[0] <= high))
            some = cells.take(here).swapped() if turned else cells.take(here)
            part = np.stack([p[:, here], size[:, here], np.clip(m[:, here], low, high)])
            left = left_on(part, (some.i, some.j), flows)
            needed = np.abs(left.by_major).max(0) ** 2 / some.a + np.abs(left.by_minor).max(0) ** 2 / some.b
            holds[here] = needed <= 4.0 * (some.c - left.by_pressure[1]) - ROUNDING
    return holds


def hull(box, cells, swapped):
    """Boxes that hold a box for each cell, the cell, and all straight ways between them."""
    cell = np.stack([cells.p, cells.x, cells.slant()])
    low, high = np.minimum(box[:, 0], cell), np.maximum(box[:, 1], cell)
    if swapped:  # the ways cross the diagonal
        low[1] = 0.5 * np.minimum(cells.x + cells.y, box[1, 0] * (1.0 + box[2, 0]))
        high[2] = 1.0
    return np.stack([low, high], axis=1)


def first_boxes(cells, swapped):
    """Boxes that hold all that is asked of cells, and the number of the cell of each."""
    n = len(cells.p)
    bare = (cells.p == 0.0) & (cells.x == 0.0)
    zero = np.zeros(n)
    knots = np.tile(SLANT_KNOTS[:, None], n)
    edges = (
        np.stack([zero, np.where(bare, CORNER, cells.p), cells.end]),
        np.stack([zero, np.where(bare, CORNER, cells.x), cells.end]),
        knots if swapped else np.sort(np.concatenate([knots, cells.slant()[None]]), axis=0),
    )
    places = np.meshgrid(*(np.arange(len(each) - 1) for each in edges), indexing="ij")
    places = [each.ravel() for each in places]
    box = np.stack([np.stack([e[i].ravel(), e[i + 1].ravel()]) for e, i in zip(edges, places, strict=True)])
    of = np.tile(np.arange(n), len(places[0]))
    known = bare[of] & (box[:2, 1] <= CORNER).all(0)
    kept = (box[:, 1] > box[:, 0]).all(0) & ~known
    return box[:, :, kept], of[kept]


def look(box, cells, swapped, flows):
    """Find which boxes are open still, the side on which each is best cut, and which refute their cell."""
    some = cells.swapped() if swapped else cells
    left = left_on(box, (some.i, some.j), flows)
    f, ways = spare(box, left, some)
    floor = ROUNDING * (box[0, 1] + box[1, 1]) ** 2
    open_ = np.flatnonzero((f[0] < floor) & (times(ways[0], left.left - some.gap)[1] > 0.0))
    box, cells, some, floor = box[:, :, open_], cells.take(open_), some.take(open_), floor[open_]
    by_sides = slopes(box, Left(*(each[:, open_] for each in left)), some, [each[:, open_] for each in ways])
    middle = np.repeat(box.mean(axis=1, keepdims=True), 2, axis=1)
    at = spare(middle, left_on(middle, (some.i, some.j), flows), some)[0][0]
    reach = np.abs(by_sides).max(1) * 0.5 * (box[:, 1] - box[:, 0])
    left_open = at < reach.sum(0) + floor
    around = hull(box, cells, swapped)
    near = left_open & (around[:2, 1] - around[:2, 0] < 0.1 * (cells.p + cells.x)).all(0)
    left_open[near] = ~steady(around[:, :, near], cells.take(near), swapped, flows)
    side = (reach + 1e-6 * (box[:, 1] - box[:, 0])).argmax(0)
    return open_[left_open], side[left_open], open_[at < -floor]


def proved(cells, flows):
    """Whether (1) is proved for cells."""
    n = len(cells.p)
    holds = np.ones(n, bool)
    for swapped in (False, True):
        box, of = first_boxes(cells, swapped)
        count = np.zeros(n, int)
        while len(of):
            count += np.bincount(of, minlength=n)
            open_, side, refuted = look(box, cells.take(of), swapped, flows)
            holds[of[refuted]] = False
            holds &= count < MOST_BOXES
            box, of = halved(box[:, :, open_], side), np.tile(of[open_], 2)
            box, of = box[:, :, holds[of]], of[holds[of]]
    return holds


def halved(box, side):
    """Halves of boxes (sides, 2, n), each cut across a side of its own."""
    low, high, n = box.copy(), box.copy(), np.arange(box.shape[2])
    low[side, 1, n] = high[side, 0, n] = box[side, :, n].mean(axis=1)
    return np.concatenate([low, high], axis=2)


def base(across):
    """c, a and b of bare cells whose side across is given."""
    return BASE * (0.5 * (1.0 + across), 1.0, across)


@lru_cache
def growth(across):
    """Bound from below of f over the square of p′ or M, the larger, for bare cells without a hardness."""
    c, a, b = base(across)
    least = np.inf
    shares, slants = np.linspace(0.0, 1.0, 401), np.union1d(np.linspace(0.0, 1.0, 101), SLANT_KNOTS)
    places = (each.ravel() for each in np.meshgrid(np.arange(400), np.arange(len(slants) - 1)))
    share, m = (np.stack([each[i], each[i + 1]]) for each, i in zip((shares, slants), places, strict=True))
    whole, zero = np.ones_like(share), np.zeros(share.shape[1])
    for i, j, a_, b_ in ((1.0, across**-2, a, b), (across**-2, 1.0, b, a)):
        cells = Cells(zero, zero, zero, zero, zero + c, zero + a_, zero + b_, zero, zero + i, zero + j)
        for box in (np.stack([whole, share, m]), np.stack([share, whole, m])):
            f, _ = spare(box, left_on(box, (cells.i, cells.j), False), cells)
            least = min(least, f[0].min())
    return least


def left_in(p, x, y, across, flows):
    """R of cells, as an array."""
    size = np.maximum(x, y)
    box = np.stack([np.stack([each.ravel()] * 2) for each in (p, size, np.minimum(x, y) / (size + 1e-300))])
    alike = x.ravel() >= y.ravel()
    widths = np.where(alike, 1.0, across**-2), np.where(alike, across**-2, 1.0)
    return left_on(box, widths, flows).left[0].reshape(p.shape)


UNIFORM, LOGARITHMS = np.random.default_rng(0).random((2, 3, 5_000))
NEAR = np.random.default_rng(1).normal(size=(3, 5_000)) * 10.0 ** (4.0 * UNIFORM[0] - 4.0)
"""What samples are made of: others far and near, of many sizes, and close to a cell."""


def needed_on_samples(cell, across, flows, least):
    """Numbers c, a and b for which (1) holds on samples, of the least c + 2 (a + b), from given ones on."""
    *values, gap = cell
    here = np.array(values)[:, None]
    size, end = here.max(), 1.0 if flows else 20.0
    others = [UNIFORM * min(end, 3.0 * size), 10.0 ** (3.0 * (LOGARITHMS - 1.0)) * end, here + size * NEAR]
    others = np.abs(np.concatenate(others, axis=1))
    others = others[:, (others <= end).all(0)]
    own, x, y = others - here
    squares = np.stack([own, x, y]) ** 2
    over = squares.sum(0) + 1e-300
    gain, squares = own * (left_in(*others, across, flows) - gap) / over, squares / over
    numbers, rows = least, []
    for _ in range(12):
        lack = gain - numbers @ squares
        rows += list(np.argsort(lack)[-4:])
        if lack[rows[-1]] < 1e-5:
            break
        limits = [(each, None) for each in least]
        numbers = linprog([1.0, 2.0, 2.0], -squares[:, rows].T, -gain[rows], bounds=limits).x
    return numbers


def described(cells, numbers, across, flows):
    """`Cells` of cells (p, x, y, Γ; n) and their numbers (3, n)."""
    p, x, y, gap = cells
    c, a, b = numbers
    if flows:
        end = np.ones_like(p)
    else:
        below = DEEPEST * max(across, 1.0)
        slope = 2.0 * (c * p + a * x + b * y) + np.maximum(-gap, 0.0) + below * p
        spared = growth(across)
        end = np.maximum(slope / spared + np.sqrt(p * np.maximum(gap, 0.0) / spared), 1.0)
    turned = y > x
    pairs = ((x, y), (a, b), (np.ones_like(p), np.full_like(p, across**-2)))
    (x, y), (a, b), (i, j) = ((np.where(turned, v, u), np.where(turned, u, v)) for u, v in pairs)
    return Cells(p, x, y, gap, c, a, b, end, i, j)


def numbers_of(cells, across, flows):
    """Numbers (3, n) of cells (p, x, y, Γ; n) that (1) is proved with; c is `UNPROVED` where it is not.

    With a hardness pressures are up to half of it. Without, p or x or y is one, but in bare cells, whose
    numbers hold as `growth` is positive.
    """
    if growth(across) <= 0.0:
        raise ValueError("Numbers of bare cells do not hold.")
    bare = cells[:3].max(0) == 0.0
    least = np.where(bare | (not flows), base(across)[:, None], LEAST)
    samples = zip(cells.T, least.T / SLACK, strict=True)
    numbers = np.stack([needed_on_samples(cell, across, flows, each) for cell, each in samples], axis=1)
    numbers = np.maximum(SLACK * numbers, least)
    left = np.flatnonzero(~bare | flows)
    for _ in range(4):
        groups = np.array_split(left, range(GROUP, len(left), GROUP))
        failed = [~proved(described(cells[:, i], numbers[:, i], across, flows), flows) for i in groups]
        left = left[np.concatenate(failed)]
        numbers[:, left] *= 1.3
    numbers[0, left] = UNPROVED
    return numbers
