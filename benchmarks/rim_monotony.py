"""Contacts on covered cells: that there is one, whether it is the only one, and what is not monotone.

    python benchmarks/rim_monotony.py             # that there is one; pressures where nothing is monotone
    python benchmarks/rim_monotony.py --boxes     # proves `CLASSES` and `APART`: two minutes
    python benchmarks/rim_monotony.py --contacts  # how many contacts are proved to be the only ones
    python benchmarks/rim_monotony.py --adversary # looks for pressures with a singular derivative

Lengths are in cells, which are squares, and E* is one. A cell of pressure p whose neighbours differ by x and
y keeps the gap R = S·L(u, m), S = √(x² + y²), u = √(p/S), m the smaller difference over the larger. One cell
on its own is asked whether, for any other pressure and differences,

    (p′ − p)(R′ − R) ≤ c (p′ − p)² + a (x′ − x)² + b (y′ − y)²,   x ≥ y ≥ 0.                           (1)

Of S = 1 this is a parabola in S′, A S′² + B S′ + C ≥ 0, which holds for all S′ ≥ 0 where A and C are positive
and

    f(u, m; u′, m′) = 2 √(A C) + B ≥ 0.                                                                (2)

It is zero where the other cell is the same one. There the derivatives of R tell: (1) holds on any set of
cells that contains the straight way between two of its cells, and on which

    n₁²/a + n₂²/b ≤ 4 (c − ∂R/∂p),   n = (∂R/∂x, ∂R/∂y).                                               (3)

`proved` cuts (u, m; u′, m′) into boxes until on each one (3), or the value in the middle of (2) and bounds of
its derivatives, decide. Bounds are those of Bernstein's coefficients of the cubics, and of sums and products
of intervals, in double precision: `ROUNDING` stands for what that rounds.

With these numbers of all cells, and matrices Δ of the differences, no other pressure solves a contact without
hardness if

    K − diag(c) − Δₓᵀ diag(a) Δₓ − Δᵧᵀ diag(b) Δᵧ                                                      (4)

is positive definite: docs/method/theory.md has the proof.
"""

import argparse
import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from cell_rims import rough_waves
from scipy.linalg import eig, eigh

from asperity import HalfSpace
from asperity.kernels.influence import means_table
from asperity.kernels.rim_curves import END, KNOTS, LEFT, PER_UNIT, SLANTS, cubics
from asperity.kernels.rims import rim_slopes

CUBICS = cubics(LEFT)
STEP = END / (KNOTS - 1)
SLANT_KNOTS = (np.arange(SLANTS) / (SLANTS - 1)) ** 2
RATIO_KNOTS = np.append(np.arange(KNOTS) * STEP, (2.0, 3.0, 4.0))
FAR = RATIO_KNOTS[-1]
"""Ratio beyond which `far_enough` stands for boxes."""
USUAL = (0.05, 0.038, 0.038)
"""c, a and b of (1) for all cells that `CLASSES` and `APART` do not name."""
STEEP_RATIOS = (0.0, 0.02, 0.04, 0.08, 0.1, 0.16)
STEEP_SLANTS = (0.0, 0.01, SLANT_KNOTS[1], 0.045, 0.07, 0.12, 0.2, 0.35, 1.0)
STEEP = (
    (0.202, 0.144, 0.091, 0.050, 0.038, 0.038, 0.038, 0.038),
    (0.240, 0.183, 0.136, 0.090, 0.063, 0.041, 0.038, 0.038),
    (0.267, 0.196, 0.141, 0.110, 0.090, 0.069, 0.050, 0.038),
    (0.112, 0.112, 0.104, 0.101, 0.089, 0.069, 0.053, 0.038),
    (0.045, 0.058, 0.055, 0.062, 0.066, 0.064, 0.055, 0.040),
)
"""b of cells that have just been reached, by ratio and slant.

c is the usual one; so is a, but for the last slants, where it is b.
"""
CLASSES = (
    ((0.6, 0.68), (0.0, 0.45), 0.12, 0.038, 0.038),
    ((0.68, 0.8), (0.0, 0.45), 0.2, 0.08, 0.08),
    ((0.8, 0.84), (0.0, 0.45), 0.12, 0.038, 0.038),
    ((0.96, 1.32), (0.0, 1.0), 0.12, 0.038, 0.038),
    *(
        ((low, high), (flat, slanted), USUAL[0], across if slanted == 1.0 else USUAL[1], across)
        for low, high, row in zip(STEEP_RATIOS, STEEP_RATIOS[1:], STEEP, strict=False)
        for flat, slanted, across in zip(STEEP_SLANTS, STEEP_SLANTS[1:], row, strict=False)
    ),
)
"""Ratios and slants of cells under pressure, and c, a and b of (1)."""
REST = (
    ((0.16, 0.6), (0.0, 1.0)),
    ((0.6, 0.84), (0.45, 1.0)),
    ((0.84, 0.96), (0.0, 1.0)),
    ((1.32, FAR), (0.0, 1.0)),
)
"""Ratios and slants of other cells under pressure."""
ROUNDING = 1e-12
"""What is asked of (2) and (3) beyond zero."""
APART = (
    ((0.0, 0.01), 0.0, 0.096),
    ((0.0, 0.01), 0.05, 0.057),
    ((0.0, 0.01), 0.1, 0.038),
    ((0.01, SLANT_KNOTS[1]), 0.0, 0.058),
    ((0.01, SLANT_KNOTS[1]), 0.05, 0.038),
    ((SLANT_KNOTS[1], 1.0), 0.0, 0.038),
)
"""Slants of cells without pressure, by how much, at least, over S they are further apart than R; and b."""
NOT_MONOTONE = np.array([
    [4.2e-4, 1.0, 4.4e-4, 2.3e-4],
    [5.4e-4, 1.0e-3, 4.8e-4, 1.1e-4],
    [3.9e-4, 4.5e-1, 4.2e-4, 2.1e-1],
    [5.2e-4, 3.0e-4, 5.1e-4, 2.5e-4],
])  # fmt: skip
"""Pressures of cells, with none around them, whose derivative K + D − N is not positive."""


def times(a, b):
    """Products of intervals (2, n)."""
    products = np.stack([a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1]])
    return np.stack([products.min(0), products.max(0)])


def scaled(factor, a):
    """Intervals times a number."""
    return factor * (a if factor >= 0.0 else a[::-1])


def less(a, b):
    """Differences of intervals."""
    return a - (b[::-1] if np.ndim(b) else b)


def falling(function, a):
    """Values of a falling function on intervals."""
    return function(a[::-1])


def bernstein(cubic, first, last):
    """Bernstein's coefficients (4, n) of cubics (n, 4) on parts of their intervals: they bound the values."""
    width = last - first
    value = cubic[:, 0] + first * (cubic[:, 1] + first * (cubic[:, 2] + first * cubic[:, 3]))
    slope = (cubic[:, 1] + first * (2.0 * cubic[:, 2] + 3.0 * first * cubic[:, 3])) * width
    bend = (cubic[:, 2] + 3.0 * first * cubic[:, 3]) * width**2
    twist = cubic[:, 3] * width**3
    return np.stack(
        [value, value + slope / 3.0, value + (2.0 * slope + bend) / 3.0, value + slope + bend + twist]
    )


def curve(u, m):
    """Intervals of L and of its derivatives by ratio and slant, on boxes (2, n) without a knot inside."""
    k = np.clip((0.5 * (u[0] + u[1]) * PER_UNIT).astype(int), 0, KNOTS - 2)
    j = np.clip(np.searchsorted(SLANT_KNOTS, 0.5 * (m[0] + m[1]), side="right") - 1, 0, SLANTS - 2)
    first, last = (np.clip(each * (KNOTS - 1) / END - k, 0.0, 1.0) for each in u)
    gap = SLANT_KNOTS[j + 1] - SLANT_KNOTS[j]
    shares = [np.clip((each - SLANT_KNOTS[j]) / gap, 0.0, 1.0) for each in m]

    def bounds(low, high):
        at_ends = np.concatenate([low + share * (high - low) for share in shares])
        return np.stack([at_ends.min(0), at_ends.max(0)])

    low, high = (bernstein(CUBICS[each, k], first, last) for each in (j, j + 1))
    slopes = [CUBICS[each, k] @ np.diag((1.0, 2.0, 3.0), -1)[:, :4] / STEP for each in (j, j + 1)]
    turn = (high - low) / gap
    inside = u[0] < END - 1e-9
    return (
        bounds(low, high) * inside,
        bounds(*(bernstein(each, first, last) for each in slopes)) * inside,
        np.stack([turn.min(0), turn.max(0)]) * inside,
    )


def weighed(weights, square):
    """Intervals of a x² + b y², x² + y² = 1, from those of y²."""
    return weights[0] + scaled(weights[1] - weights[0], square)


class Cell(NamedTuple):
    """Intervals (2, n) of what (2) takes of a cell with S = 1: of A or C, too, and all derivatives."""

    u: np.ndarray
    way: tuple  # of the differences: cosine and sine
    slide: tuple  # derivatives of these by the slant
    left: np.ndarray  # L
    by_ratio: np.ndarray
    by_slant: np.ndarray
    square: np.ndarray  # A or C
    square_by_ratio: np.ndarray
    square_by_slant: np.ndarray


def cell(u, m, swapped, constants, apart=0.0):
    """Describe cells of ratios and slants; swapped: their larger difference is y."""
    c, a, b = constants
    angle = np.arctan(m)
    major, minor = falling(np.cos, angle), np.sin(angle)
    per_slant = falling(lambda x: 1.0 / (1.0 + x * x), m)
    slide = less(0.0, times(minor, per_slant)), times(major, per_slant)
    way = (major, minor)
    if swapped:
        way, slide = way[::-1], slide[::-1]
    left, by_ratio, by_slant = curve(u, m)
    left = left + apart  # of a cell without pressure the whole gap counts
    square = c * u**4 + a + less(scaled(b - a, way[1] ** 2), times(u * u, left))
    by_u = less(4.0 * c * u**3, 2.0 * times(u, left) + times(u * u, by_ratio))
    by_m = less(scaled(2.0 * (b - a), times(way[1], slide[1])), times(u * u, by_slant))
    return Cell(u, way, slide, left, by_ratio, by_slant, square, by_u, by_m)


def product(one, other, constants):
    """Intervals of a x x′ + b y y′."""
    return sum(weight * times(x, y) for weight, x, y in zip(constants[1:], one, other, strict=True))


def least(one, other, constants):
    """Bounds of f of (2) from below; minus infinity where A or C may be negative."""
    f = 2.0 * np.sqrt(np.maximum(one.square[0], 0.0) * np.maximum(other.square[0], 0.0))
    f -= 2.0 * constants[0] * (one.u[1] * other.u[1]) ** 2 + 2.0 * product(one.way, other.way, constants)[1]
    f += times(one.u**2, other.left)[0] + times(other.u**2, one.left)[0]
    return np.where(np.minimum(one.square[0], other.square[0]) > 0.0, f, -math.inf)


def slopes(one, other, constants):
    """Intervals of the derivatives of f by ratio and slant of the first cell, A and C positive."""
    stretch = np.sqrt(np.maximum(other.square, 1e-9) / np.maximum(one.square, 1e-9)[::-1])
    by_u = less(times(stretch, one.square_by_ratio), 4.0 * constants[0] * times(other.u**2, one.u))
    by_u = by_u + times(other.u**2, one.by_ratio) + 2.0 * times(one.u, other.left)
    by_m = less(times(stretch, one.square_by_slant), 2.0 * product(one.slide, other.way, constants))
    return by_u, by_m + times(other.u**2, one.by_slant)


def steady(u, m, constants, turns=1.0):
    """Whether (3) holds on boxes (2, n), knots inside or not, and on the straight ways in them.

    On these S is less than between their ends, by the cosine of half the angle that they turn at most, and
    the ratio greater.
    """
    turn = turns * (np.arctan(m[1]) - np.arctan(m[0]))
    u = np.stack([u[0], u[1] / np.sqrt(np.cos(turn))])
    first, last = (np.clip(f(u[i] / STEP + e), 0, KNOTS - 1).astype(int) for f, i, e in ROUNDED)
    low = np.searchsorted(SLANT_KNOTS, m[0] + 1e-12, side="right") - 1
    high = np.maximum(np.searchsorted(SLANT_KNOTS, m[1] - 1e-12), low + 1)
    holds = np.ones(u.shape[1], bool)
    for k in range(first.min(), last.max()):
        for j in range(low.min(), high.max()):
            here = np.flatnonzero(holds & (first <= k) & (k < last) & (low <= j) & (j < high))
            if len(here):
                ratios = np.clip(u[:, here], k * STEP, (k + 1) * STEP)
                holds[here] = _steady(ratios, np.clip(m[:, here], *SLANT_KNOTS[j : j + 2]), constants)
    return holds


ROUNDED = ((np.floor, 0, 1e-9), (np.ceil, 1, -1e-9))
"""How knots below and above are found."""


def _steady(u, m, constants):
    left, by_ratio, by_slant = curve(u, m)
    angle = np.arctan(m)
    major, minor = falling(np.cos, angle), np.sin(angle)
    step = less(left, 0.5 * times(u, by_ratio))
    turn = times(1.0 / major[::-1], by_slant)
    along, across = less(times(major, step), times(m, turn)), times(minor, step) + turn
    c, a, b = constants
    needed = np.abs(along).max(0) ** 2 / a + np.abs(across).max(0) ** 2 / b - 4.0 * c
    return needed * 2.0 * np.where(needed > 0.0, u[1], u[0]) <= -4.0 * by_ratio[1] - ROUNDING * (u[1] < END)


def close_by(here, there, swapped, constants):
    """Whether (3) decides boxes of two cells, as there are few knots between them."""
    (u, m), (w, k) = here, there
    ratios = np.stack([np.minimum(u[0], w[0]), np.maximum(u[1], w[1])])
    slants = np.stack([np.minimum(m[0], k[0]), np.ones_like(m[0]) if swapped else np.maximum(m[1], k[1])])
    near = (ratios[1] - ratios[0] < 1.01 * STEP) & (slants[1] - slants[0] < 0.35)
    near &= constants[1] == constants[2] if swapped else True
    decided = (u[0] > END - 1e-9) & (w[0] > END - 1e-9)  # R is zero in both
    if near.any():
        decided[near] |= steady(ratios[:, near], slants[:, near], constants, 2.0 if swapped else 1.0)
    return decided


def boxes(*edges):
    """All boxes (sides, 2, n) between edges of each side."""
    places = np.meshgrid(*(np.arange(len(each) - 1) for each in edges), indexing="ij")
    return np.stack([np.stack([e[i.ravel()], e[i.ravel() + 1]]) for e, i in zip(edges, places, strict=True)])


def edges(ends, knots):
    """Ends of an interval, and the knots inside of it."""
    low, high = ends
    return np.concatenate([[low], knots[(knots > low + 1e-12) & (knots < high - 1e-12)], [high]])


def far_enough(ratios, slants, constants, apart=0.0):
    """Whether f is positive between cells of ratios and slants and any cell of a ratio of `FAR` or more.

    Over the square of that ratio f is at least 2 √(c C) − 2 c u² + L − 2 max(a, b)/`FAR`².
    """
    c = constants[0]
    known = ((ratios, RATIO_KNOTS), (slants, SLANT_KNOTS))
    parts = (np.union1d(np.linspace(*ends, 200), edges(ends, knots)) for ends, knots in known)
    one = cell(*boxes(*parts), False, constants, apart)
    f = 2.0 * np.sqrt(c * np.maximum(one.square[0], 0.0)) - 2.0 * c * one.u[1] ** 2 + one.left[0]
    return bool((f > 2.0 * max(constants[1:]) / FAR**2)[one.u[0] < END - 1e-9].all())


def proved(ratios, slants, constants, apart=0.0, most=10_000_000):
    """Number of boxes that prove (1) for cells whose ratios and slants are given, as intervals.

    Zero if there is a pair of cells where (2) does not hold, or more boxes than the most are needed.
    """
    count = 0
    if not far_enough(ratios, slants, constants, apart):
        return 0
    for swapped in (False, True):
        left = boxes(edges(ratios, RATIO_KNOTS), edges(slants, SLANT_KNOTS), RATIO_KNOTS, SLANT_KNOTS)
        while left.shape[2]:
            count += left.shape[2]
            left = left[:, :, ~close_by(left[:2], left[2:], swapped, constants)]
            one, other = cell(*left[:2], False, constants, apart), cell(*left[2:], swapped, constants)
            middle = np.repeat(left.mean(axis=1, keepdims=True), 2, axis=1)
            at = least(
                cell(*middle[:2], False, constants, apart), cell(*middle[2:], swapped, constants), constants
            )
            if (at < -ROUNDING).any() or count > most:
                return 0
            by = (*slopes(one, other, constants), *slopes(other, one, constants))
            reach = np.abs(np.stack(by)).max(1) * 0.5 * (left[:, 1] - left[:, 0])
            below = least(one, other, constants)
            positive = np.minimum(one.square[0], other.square[0]) > 0.0
            open_ = np.flatnonzero(~(positive & (at >= reach.sum(0) + ROUNDING)) & (below < ROUNDING))
            left, reach = left[:, :, open_], reach[:, open_] + 1e-6 * (left[:, 1] - left[:, 0])[:, open_]
            left = halved(left, reach.argmax(0))
    return count


def halved(left, side):
    """Halves of boxes (sides, 2, n), each cut across a side of its own."""
    low, high, n = left.copy(), left.copy(), np.arange(left.shape[2])
    low[side, 1, n] = high[side, 0, n] = left[side, :, n].mean(axis=1)
    return np.concatenate([low, high], axis=2)


def prove_boxes():
    """Prove (1) for all cells, and print how many boxes that takes."""
    print("| ratio | slant | c | a | b | boxes |\n|---|---|---|---|---|---|")
    jobs = [(*each, 0.0) for each in CLASSES] + [(*each, *USUAL, 0.0) for each in REST]
    jobs += [((0.0, 0.0), slants, *USUAL[:2], across, apart) for slants, apart, across in APART]
    for ratios, slants, *constants, apart in jobs:
        count = proved(ratios, slants, constants, apart)
        name = f"none, {apart} S apart" if ratios[1] == 0.0 else f"{ratios[0]} to {ratios[1]}"
        values = " | ".join(f"{each:.3f}" for each in constants)
        row = f"| {name} | {slants[0]:.3f} to {slants[1]:.3f} | {values} | {count or 'NOT PROVED'} |"
        print(row, flush=True)
    beyond = far_enough((0.0, END), (0.0, 1.0), USUAL)
    print(f"beyond a ratio of {FAR:.0f}: {'proved' if beyond else 'NOT PROVED'}")


def largest_product():
    """Bound of u² L from above: p·R is at most this times the width times S²."""
    u, m = boxes(np.union1d(np.linspace(0.0, END, 2001), RATIO_KNOTS[:KNOTS]), SLANT_KNOTS)
    return times(u * u, curve(u, m)[0])[1].max()


def coercive(elongation, size=512):
    """Least of K's coefficients over that of a cell itself, and that over what R takes of it at most.

    Sides of the cells are 1 and the elongation.
    """
    table = means_table(size, size, 1.0, elongation) / math.pi
    return table.min() / table[0, 0], table[0, 0] / (4.0 * largest_product() * elongation)


def steps_beside(pressure):
    """Differences of the pressures beside each cell, not negative."""
    p = np.pad(pressure, 1)
    return np.abs(p[2:, 1:-1] - p[:-2, 1:-1]), np.abs(p[1:-1, 2:] - p[1:-1, :-2])


def needed(pressure, gap, margin=1e-6):
    """Numbers c of (1) for the cells of a contact, and those of the differences along and across.

    Gaps are K p + g − δ. Cells within a relative margin of an edge of a class are in it.
    """
    x, y = steps_beside(pressure)
    step = np.hypot(x, y) + 1e-300
    ratio, slant, over = np.sqrt(pressure / step), np.minimum(x, y) / (np.maximum(x, y) + 1e-300), gap / step
    c, a, b = (np.full(pressure.shape, each) for each in USUAL)

    def within(values, ends):
        return (values >= ends[0] * (1.0 - margin)) & (values <= ends[1] * (1.0 + margin))

    for ratios, slants, *constants in CLASSES:
        here = (pressure > 0.0) & within(ratio, ratios) & within(slant, slants)
        for field, constant in zip((c, a, b), constants, strict=True):
            field[here] = np.maximum(field[here], constant)
    alone = np.interp(slant, SLANT_KNOTS, LEFT[:, 0])
    for slants, apart, across in APART:
        above = min((each[1] for each in APART if each[0] == slants and each[1] > apart), default=math.inf)
        here = (pressure <= 0.0) & (step > 1e-200) & within(slant, slants) & (over - alone <= above + margin)
        b[here] = np.maximum(b[here], across)
    return c, np.where(x >= y, a, b), np.where(x >= y, b, a)


@lru_cache
def influence(shape):
    """Matrix K between the cells of a grid."""
    table = means_table(*shape, 1.0, 1.0) / math.pi
    i, j = np.divmod(np.arange(shape[0] * shape[1]), shape[1])
    return table[np.abs(i[:, None] - i), np.abs(j[:, None] - j)]


@lru_cache
def beside(shape, axis):
    """Matrix of the differences between the cells on both sides of each."""
    one = [np.eye(n) for n in shape]
    one[axis] = np.eye(shape[axis], k=1) - np.eye(shape[axis], k=-1)
    return np.kron(*one)


def needed_alone(pressure, numbers, margin=1e-4):
    """Numbers of (1) as `needed` finds them, but for cells that have just been reached those of their own."""
    c, along, across = (each.copy() for each in numbers)
    x, y = steps_beside(pressure)
    larger, smaller = np.maximum(x, y), np.minimum(x, y)
    for place in zip(*np.nonzero((pressure > 0.0) & (np.maximum(along, across) > 0.1)), strict=True):
        ratio = math.sqrt(pressure[place] / np.hypot(x[place], y[place]))
        slant = smaller[place] / larger[place]
        ends = [(max(each - margin, 0.0), each + margin) for each in (ratio, slant)]
        flatter = across if x[place] >= y[place] else along
        tried = np.arange(0.05, flatter[place], 0.02)
        found = (b for b in tried if slant < 0.3 and proved(*ends, (*USUAL[:2], b), most=200_000))
        flatter[place] = next(found, flatter[place])
    return c, along, across


def left_over(pressure, numbers):
    """Smallest eigenvalue of (4): if it is positive, no other pressure solves the contact."""
    c, along, across = numbers
    matrix = influence(pressure.shape) - np.diag(c.ravel())
    for axis, each in enumerate((along, across)):
        differences = beside(pressure.shape, axis)
        matrix -= differences.T @ (each.reshape(-1, 1) * differences)
    return eigh(matrix, eigvals_only=True, subset_by_index=[0, 0])[0]


def contact_of_ball(across, height, rng):
    """Pressure and gap of a ball at a random place, of so many cells in its half-width at an approach of one.

    The rms height of its waves and its approach, 0.6 to 1.4, are in approaches.
    """
    count = math.ceil(2.6 * across) + 4
    x, y = ((np.arange(count) - 0.5 * (count - 1) + rng.random()) / across for _ in range(2))
    waves = rough_waves(x, height, rng.integers(2**31)) if height else 0.0
    undeformed = across * (0.5 * np.add.outer(x**2, y**2) + waves)
    space = HalfSpace((count, count), 1.0, 1.0, cells="covered")
    approach = across * (0.6 + 0.8 * rng.random())
    pressure = space.solve(undeformed, approach=approach, rtol=1e-10).pressure
    return pressure, space.displacement(pressure) + undeformed - approach


def check_contacts(count=50):
    """Print how many contacts are proved to be the only ones."""
    head = f"| cells in the half-width | rms / approach | proved by classes, of {count} "
    print(head + "| proved | least of (4) |")
    print("|---|---|---|---|---|")
    for across in (6, 9, 12):
        for height in (0.0, 0.03, 0.1, 0.3):
            rng = np.random.default_rng(7)
            found = []
            for _ in range(count):
                pressure, gap = contact_of_ball(across, height, rng)
                numbers = needed(pressure, gap)
                found.append([left_over(pressure, numbers)] * 2)
                if found[-1][0] < 1e-6:
                    found[-1][1] = left_over(pressure, needed_alone(pressure, numbers))
            by_class, alone = np.transpose(found)
            proofs = f"{(by_class > 1e-6).sum()} | {(alone > 1e-6).sum()}"
            print(f"| {across} | {height} | {proofs} | {alone.min():.3f} |", flush=True)


def derivative(pressure):
    """Matrices K + D and N of the derivative of K p − R."""
    own, along, across = slopes_ = np.zeros((3, *pressure.shape))
    rim_slopes(pressure, 1.0, 1.0, math.inf, slopes_)
    beside_it = [beside(pressure.shape, axis) for axis in (0, 1)]
    n = along.reshape(-1, 1) * beside_it[0] + across.reshape(-1, 1) * beside_it[1]
    return influence(pressure.shape) - np.diag(own.ravel()), n


def not_monotone(pressure):
    """Smallest eigenvalue of the symmetric part of the derivative."""
    stiff, n = derivative(pressure)
    return np.linalg.eigvalsh(stiff - 0.5 * (n + n.T))[0]


def nearest_to_singular(pressure):
    """Largest real eigenvalue of (K + D)⁻¹N: at one the derivative is singular; and its two vectors."""
    stiff, n = derivative(pressure)
    values, left, right = eig(n, stiff, left=True)
    real = np.where(np.abs(values.imag) < 1e-9, values.real, -math.inf)
    k = real.argmax()
    return real[k], left[:, k].real, right[:, k].real


def climb(size, rng, tries=300):
    """Look for a pressure whose derivative is nearest to singular, from a random one; return how near."""
    logs = rng.normal(size=(size, size)) * rng.choice([0.3, 1.0, 3.0, 5.0])
    logs = np.clip(logs, -25.0, 5.0)
    best, left, right = nearest_to_singular(np.exp(logs))
    step = 0.5
    for _ in range(tries):
        shape = (60, size, size)
        moved = rng.random(shape) < rng.choice([1.0 / size**2, 0.1, 0.3, 1.0], size=(60, 1, 1))
        tried = logs + step * np.exp(rng.normal(size=(60, 1, 1))) * rng.normal(size=shape) * moved
        tried = np.clip(tried, -25.0, 5.0)
        gains = []
        for each in tried:
            stiff, n = derivative(np.exp(each))
            gains.append(left @ (n - best * stiff) @ right / (left @ stiff @ right))
        found = np.exp(tried[int(np.argmax(gains))])
        value, *vectors = nearest_to_singular(found)
        step *= 1.1 if value > best else 0.95
        if value > best:
            best, logs = value, np.log(found)
            left, right = vectors
    return best


def look_for_singular(starts=8):
    """Print how near to singular derivatives are that are looked for."""
    print("| cells | largest real eigenvalue of (K + D)⁻¹N |\n|---|---|")
    for size in (3, 4, 5, 6):
        rng = np.random.default_rng(size)
        print(f"| {size} × {size} | {max(climb(size, rng) for _ in range(starts)):.3f} |", flush=True)


def print_numbers():
    """Print what the proof of a solution takes, and what is not monotone."""
    print(f"u² L is at most {largest_product():.4f}")
    print("| elongation | least coefficient of K over the largest | the largest over what R takes |")
    print("|---|---|---|")
    for elongation in (1.0, 2.0, 4.0, 8.0):
        smallest, times_over = coercive(elongation)
        print(f"| {elongation:.0f} | {smallest:.4f} | {times_over:.2f} |")
    eigenvalue, near = not_monotone(NOT_MONOTONE), nearest_to_singular(NOT_MONOTONE)[0]
    print(f"Not monotone: eigenvalue {eigenvalue:.3f}; largest real eigenvalue of (K + D)⁻¹N {near:.3f}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    work = {"boxes": prove_boxes, "contacts": check_contacts, "adversary": look_for_singular}
    chosen = parser.add_mutually_exclusive_group()
    for name, function in work.items():
        chosen.add_argument(f"--{name}", dest="work", action="store_const", const=function)
    (parser.parse_args().work or print_numbers)()
