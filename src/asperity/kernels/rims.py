"""Cells at the rim of a contact, which are covered in part: the gap that is left in them.

Where a contact ends, its pressure is A √s at a distance s inside the rim, and the deformed surfaces part by
(4/3)(A/E*) (−s)^(3/2) outside of it. A cell that the rim crosses has the mean of that pressure over all of
it, and keeps a gap, its own mean over the cell and what constant pressures on cells displace otherwise than
that pressure does. Both follow from how far the rim has come and how it lies on the grid, as do the pressure
p of the cell and the differences Δₓp, Δᵧp between its neighbours on either side. So the gap that is left is a
function of p/S and of the slant, times S = √(Δₓp² + Δᵧp²) and the width of the cell normal to the rim, over
E*: it falls to nothing as the rim crosses the cell. Contacts whose cells keep this gap grow evenly with the
approach; where cells are all or nothing, each that enters makes the stiffness jump.

The curves are those of Hertz's contacts, whose cells are known: ``benchmarks/cell_rims.py`` computes them. On
cells that are not square, directions count on the grid, and the width is that of a cell along the normal.
"""

import tomllib
from typing import NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from asperity.files import packaged
from asperity.kernels.box import Box
from asperity.kernels.options import CALLED, INNER, LOOP, REASSOCIATE, UNCHECKED, compiled

KNOTS, SLANTS = 33, 7
"""Values of a curve, even in √(p/S) from 0 to END, and curves, even in the root of the slant.

The slant is the smaller of the differences over the larger: 0 for a rim along an axis of the grid, 1 along
the diagonal of its cells.
"""
END = 1.28
"""Largest √(p/S) of a cell at a rim: beyond it nothing is left."""
PER_UNIT = (KNOTS - 1) / END
"""Knots per unit of √(p/S)."""
_CURVES = tomllib.loads(packaged("kernels/rims.toml"))
LEFT = np.array(_CURVES["left"])
"""Gap that is left, over S times the width of a cell and E*: slant after slant."""
COVERED = np.array(_CURVES["covered"])
"""Share of a cell inside a rim of pressures whose squares are straight, likewise."""
BENT = np.array(_CURVES["bent"])
"""What it gains where they bend, over the bend, at every third knot."""
MOST_BENT = 1.0 / 6.0
"""Bend, at most: that of a ball with six cells in the half-width. Smaller asperities are not resolved."""
BEND_SHARE, BEND_LEFT = 0.85, 0.006
"""Bend at a rim over that of three cells inside, and what means over cells add to it: of balls."""
LEAST_SLOPE = 0.02
"""Slope of a curve, at least, by which the pressure that a residual asks for is estimated."""
STEEP, MOST_LEFT = 9.0, 3.0
"""Bounds of the gap that is left without pressure, over the larger difference and that of both."""
NO_STEP = 1e-30
"""Square of a difference of pressures, Pa², beside which none is zero."""
TOGETHER = 1e-4
"""Difference in √(p/S) below which a slope stands for a difference quotient."""
SHARED = 0.5
"""Share of what a cell yields more that a preconditioner takes: its neighbours give way, too."""


def cubics(values: NDArray) -> NDArray:
    """Coefficients (curves, KNOTS − 1, 4) of splines through values, level at the last."""
    knots = values.shape[1]
    matrix = 4.0 * np.eye(knots) + np.eye(knots, k=1) + np.eye(knots, k=-1)
    matrix[0, 0], matrix[-1, -2] = 2.0, 0.0
    target = np.zeros_like(values)
    target[:, 0] = 3.0 * (values[:, 1] - values[:, 0])
    target[:, 1:-1] = 3.0 * (values[:, 2:] - values[:, :-2])
    slopes = np.linalg.solve(matrix, target.T).T
    low = slopes[:, :-1]
    high = slopes[:, 1:]
    step = np.diff(values)
    return np.stack([values[:, :-1], low, 3.0 * step - 2.0 * low - high, low + high - 2.0 * step], axis=2)


def every_knot(values: NDArray) -> NDArray:
    """Values (curves, KNOTS) of curves that are known at every third knot, straight between them."""
    knots = np.arange(KNOTS) / 3.0
    return np.stack([np.interp(knots, np.arange(len(each)), each) for each in values])


_LEFT, _COVERED, _BENT = (cubics(each).ravel() for each in (LEFT, COVERED, every_knot(BENT)))


@compiled(**INNER, **UNCHECKED)
def between_curves(curves: NDArray, ratio: float, slant: float) -> tuple[float, float, float]:
    """Find a value of curves, and its derivatives by the ratio √(p/S), from 0 to END, and by the slant."""
    place = ratio * PER_UNIT
    turn = np.sqrt(slant) * (SLANTS - 1)
    k = min(np.int32(place), np.int32(KNOTS - 2))  # whole numbers that fit beside each other into a vector
    j = min(np.int32(turn), np.int32(SLANTS - 2))
    t = place - k
    lower = float(j)
    per_slant = (SLANTS - 1) ** 2 / (2.0 * lower + 1.0)
    share = slant * per_slant - lower * lower / (2.0 * lower + 1.0)
    i = 4 * (j * np.int32(KNOTS - 1) + k)
    o = i + np.int32(4 * (KNOTS - 1))
    a = curves[i]
    b = curves[i + 1]
    c = curves[i + 2]
    d = curves[i + 3]
    one = a + t * (b + t * (c + t * d))
    slope = b + t * (2.0 * c + t * 3.0 * d)
    a = curves[o]
    b = curves[o + 1]
    c = curves[o + 2]
    d = curves[o + 3]
    turned = a + t * (b + t * (c + t * d)) - one
    steeper = b + t * (2.0 * c + t * 3.0 * d) - slope
    return one + share * turned, (slope + share * steeper) * PER_UNIT, turned * per_slant


@compiled(**INNER, **UNCHECKED)
def remaining_gap(ratio: float, slant: float) -> tuple[float, float, float]:
    """Find the gap that is left at a ratio √(p/S), over S times the width and E*, and its derivatives."""
    return between_curves(_LEFT, ratio, slant)


CHUNK = 64
"""Cells at rims that are computed in one go, a power of two."""
LANES = 8
"""Cells of a vector, at most: a last one is filled with cells that nobody asks for."""
P, X, Y, UNMET, GAP, OWN, WEIGHT, ALONE, MASKED = range(9)
"""What is known of a cell at a rim, one number after the other.

Its pressure and the differences beside it, along and across, Pa, and the residual, m, of which all else is
computed; the gap that is left, m; its difference quotient up to the pressure that the residual asks for, not
positive, m/Pa; weight of the cell where steps are preconditioned, and what it yields beyond that to a
residual of its own, Pa/m; residual on the free set, m, before it is weighed.
"""
NUMBERS = 9


class Rims(NamedTuple):
    """Cells of a box that are at rims, one after the other, and how their gap changes with a step.

    For contacts of whole cells None stands in place of this, and nothing of this is compiled.
    """

    along: float  # side of a cell over E*, m/Pa
    across: float  # likewise
    number: NDArray  # (1,), number of cells at rims
    cell: NDArray  # their places in the box
    # what is known of them, chunk after chunk: each of the numbers, of all cells of the chunk
    known: NDArray


def rims(along: float, across: float, count: int, dtype: DTypeLike) -> Rims:
    """Make room for what is known of the rims among so many cells, with sides over E*, m/Pa."""
    cell: NDArray = np.zeros(count + 1, dtype=np.int64)  # one is written ahead
    number = np.zeros(1, dtype=np.int64)
    known: NDArray = np.zeros(NUMBERS * CHUNK * -(-count // CHUNK), dtype=dtype)
    return Rims(along, across, number, cell, known)


@compiled(**INNER)
def cells_beside(rims: Rims | None) -> int:
    """Cells beside the overlap that may be in contact: one that overlaps in part may not in the mean."""
    return 0 if rims is None else 1


@compiled(**INNER, **REASSOCIATE)
def _mark_rims(b: Box, side: float, level: float) -> None:
    """Set `z` to one in cells whose pressure is less than the step between their neighbours, else to zero.

    Not in those without pressure that stay apart by more than a rim leaves in any cell. The side of a cell is
    over E*, m/Pa, the level of residuals in m.
    """
    real = b.z.dtype.type
    zero, one = real(0.0), real(1.0)
    most = real(END**4)
    steep = real(side * STEEP)
    wide = real(side * MOST_LEFT)
    rise = real(side)
    level = real(level)
    margin = (len(b.framed) - len(b.z)) // 2
    above = b.framed[margin - b.pitch :]
    middle = b.framed[margin - 1 :]
    below = b.framed[margin + b.pitch :]
    for q in range(len(b.z)):
        p = middle[q + 1]
        x = abs(below[q] - above[q])
        y = abs(middle[q + 2] - middle[q])
        far, near = max(x, y), min(x, y)
        apart = min(rise * far + steep * near, wide * (far + near))
        at_rim = p * p < most * (x * x + y * y) and (p > zero or b.residual[q] - level < apart)
        b.z[q] = one if at_rim else zero


@compiled(**INNER)
def _find_rims(b: Box, rims: Rims, level: float) -> int:
    """List the cells at rims; return how many there are."""
    _mark_rims(b, max(rims.along, rims.across), level)
    found = 0
    for q in range(len(b.z)):
        rims.cell[found] = q
        found += b.z[q] > 0.0
    return found


@compiled(**INNER, **UNCHECKED)
def _at_rim(
    p: float, x: float, y: float, x_share: float, y_share: float
) -> tuple[float, float, float, float, float, float, float, float]:
    """Find what a cell at a rim keeps, from its pressure and the differences of its neighbours', Pa.

    The shares are the inverse squares of the sides of a cell over E*. Returns the scale of the gap, m, and
    the step S; ratio and slant; the gap over the scale, and its derivative by the ratio; derivatives of
    the gap by the differences along and across, m/Pa.
    """
    xx = x * x + NO_STEP
    yy = y * y
    squares = xx + yy
    step = np.sqrt(squares)
    width = 1.0 / np.sqrt(xx * x_share + yy * y_share)
    scale = squares * width
    ratio = min(np.sqrt(p / step), END)
    wide = xx >= yy
    along = np.sqrt(xx)
    across = abs(y)
    far, near = along if wide else across, across if wide else along
    per_far = 1.0 / far
    slant = near * per_far
    left, slope, turn = remaining_gap(ratio, slant)
    by_step = (2.0 * left - 0.5 * slope * ratio) * width
    by_width = left * scale * width * width
    by_near = turn * scale * per_far
    by_far = -slant * by_near
    along = x * (by_step - by_width * x_share) + np.copysign(1.0, x) * (by_far if wide else by_near)
    across = y * (by_step - by_width * y_share) + np.copysign(1.0, y) * (by_near if wide else by_far)
    return scale, step, ratio, slant, left, slope, along, across


@compiled(**CALLED, **REASSOCIATE, **UNCHECKED)
def _compute(c: NDArray, count: int, x_share: float, y_share: float, stiffness: float) -> None:
    """Compute what is known of the cells of a chunk: see `set_rims`."""
    for k in range(count):
        p, unmet = c[P * CHUNK + k], c[UNMET * CHUNK + k]
        found = _at_rim(p, c[X * CHUNK + k], c[Y * CHUNK + k], x_share, y_share)
        scale = found[0]
        step = found[1]
        ratio = found[2]
        left = found[4]
        slope = found[5]
        unmet -= scale * left
        # what p - p₀ + stiffness (unmet - gap + gap₀) = 0 gives, the gap straight in the ratio
        steep = min(slope, -LEAST_SLOPE)
        soft = step / stiffness
        half = 0.5 * scale * steep / soft
        far = half * half - 2.0 * half * ratio + ratio * ratio - unmet / soft
        other = max(half + np.sqrt(max(far, 0.0)), 0.0)
        own = scale / step * steep / max(ratio + other, TOGETHER)
        weight = 1.0 / (1.0 - SHARED * own * stiffness)
        c[GAP * CHUNK + k] = scale * left
        c[OWN * CHUNK + k] = own
        c[WEIGHT * CHUNK + k] = weight
        c[ALONE * CHUNK + k] = stiffness * (1.0 / (1.0 - own * stiffness) - weight * weight)


@compiled(**INNER)
def _look(b: Box, rims: Rims, k: int, c: NDArray, i: int) -> None:
    """Note the pressure of a cell, by number, and the differences beside it, in a place of a chunk."""
    q = rims.cell[k] + (len(b.framed) - len(b.z)) // 2
    p = b.framed
    c[P * CHUNK + i] = p[q]
    c[X * CHUNK + i] = p[q + b.pitch] - p[q - b.pitch]
    c[Y * CHUNK + i] = p[q + 1] - p[q - 1]


@compiled(**CALLED)
def set_rims(b: Box, rims: Rims | None, level: float, stiffness: float) -> None:
    """Find the cells at rims, and take the gap that is left in them off the residual, from the pressure.

    What was taken off before is given back. The gap falls with the pressure, the steeper the less there is:
    what counts is the difference quotient up to the pressure that would meet the residual above a level, m,
    if no other cell changed its own. The stiffness, Pa/m, is that of a cell among others.
    """
    if rims is not None:
        give_back(b, rims)
        number = _find_rims(b, rims, level)
        rims.number[0] = number
        x_share, y_share = 1.0 / rims.along**2, 1.0 / rims.across**2
        for first in range(0, number, CHUNK):
            count = min(CHUNK, number - first)
            c = rims.known[NUMBERS * first :]
            for i in range(count):
                _look(b, rims, first + i, c, i)
                c[UNMET * CHUNK + i] = b.residual[rims.cell[first + i]] - level
            _compute(c, (count + LANES - 1) // LANES * LANES, x_share, y_share, stiffness)
            for i in range(count):
                b.residual[rims.cell[first + i]] -= c[GAP * CHUNK + i]


@compiled(**INNER)
def _place(k: int) -> int:
    """Place of the first number that is known of a cell, by number."""
    within = k & (CHUNK - 1)
    return NUMBERS * (k - within) + within


@compiled(**INNER)
def take_off(b: Box, rims: Rims | None) -> None:
    """Take the gap that is left at rims off the residual."""
    if rims is not None:
        for k in range(rims.number[0]):
            b.residual[rims.cell[k]] -= rims.known[_place(k) + GAP * CHUNK]


@compiled(**INNER, **UNCHECKED)
def move_rims(b: Box, rims: Rims | None, pitch: int, row: int, column: int) -> None:
    """Place cells at rims in a box that begins in a row and a column of theirs, whose pitch is given."""
    if rims is not None:
        for k in range(rims.number[0]):
            i = rims.cell[k] // pitch
            rims.cell[k] += i * (b.pitch - pitch) - row * b.pitch - column


@compiled(**INNER)
def forget_rims(rims: Rims | None) -> None:
    """Forget the cells at rims; what they keep is on the residual."""
    if rims is not None:
        rims.number[0] = 0


@compiled(**INNER)
def give_back(b: Box, rims: Rims | None) -> None:
    """Give the gap that was taken off the residual back."""
    if rims is not None:
        for k in range(rims.number[0]):
            b.residual[rims.cell[k]] += rims.known[_place(k) + GAP * CHUNK]


@compiled(**INNER, **UNCHECKED)
def _stiffness_share(rims: Rims, k: int, stiffness: float) -> float:
    """How far a cell at a rim gives way to a residual, over what a cell among others does."""
    return 1.0 / (1.0 - rims.known[_place(k) + OWN * CHUNK] * stiffness)


@compiled(**CALLED)
def still_violated(b: Box, rims: Rims, violated: float, tolerance: float, stiffness: float) -> float:
    """Take those cells off a number of violated ones that are soft enough not to matter."""
    margin = (len(b.masked) - len(b.residual)) // 2
    for k in range(rims.number[0]):
        m = abs(b.masked[margin + rims.cell[k]])
        if m > tolerance and m * _stiffness_share(rims, k, stiffness) <= tolerance:
            violated -= 1.0
    return violated


@compiled(**INNER)
def set_shares(b: Box, rims: Rims, stiffness: float) -> None:
    """Set `z` to what the residual of each cell counts for."""
    for q in range(len(b.z)):
        b.z[q] = 1.0
    for k in range(rims.number[0]):
        b.z[rims.cell[k]] = _stiffness_share(rims, k, stiffness)


@compiled(**INNER)
def weigh(b: Box, rims: Rims) -> None:
    """Weigh what is masked by how much softer cells at rims are than others."""
    margin = (len(b.masked) - len(b.residual)) // 2
    for k in range(rims.number[0]):
        m = b.masked[margin + rims.cell[k]]
        rims.known[_place(k) + MASKED * CHUNK] = m
        b.masked[margin + rims.cell[k]] = m * rims.known[_place(k) + WEIGHT * CHUNK]


@compiled(**INNER)
def weigh_step(b: Box, rims: Rims, target: NDArray) -> tuple[float, float, float]:
    """Weigh a preconditioned residual likewise; return what m·target, previous·target and its sum gain."""
    rho = 0.0
    moved = 0.0
    total = 0.0
    for k in range(rims.number[0]):
        q = rims.cell[k]
        o = _place(k)
        before = target[q]
        m = rims.known[o + MASKED * CHUNK]
        alone = rims.known[o + ALONE * CHUNK] * m
        target[q] = before * rims.known[o + WEIGHT * CHUNK] + alone
        gained = target[q] - before
        rho += alone * m
        moved += b.previous[q] * gained
        total += gained
    return rho, moved, total


@compiled(**INNER)
def bend(b: Box, rims: Rims) -> float:
    """Add up −step · (quotient of the gap) · step: the curvature that cells at rims add to a step."""
    stored = 0.0
    for k in range(rims.number[0]):
        step = b.step[rims.cell[k]]
        stored -= rims.known[_place(k) + OWN * CHUNK] * step * step
    return stored


@compiled(**INNER)
def _squared_pressure(pressure: NDArray, i: int, j: int) -> float:
    inside = 0 <= i < pressure.shape[0] and 0 <= j < pressure.shape[1]
    return pressure[i, j] ** 2 if inside else 0.0


@compiled(**INNER)
def bend_inside(pressure: NDArray, i: int, j: int, x: float, y: float, slant: float) -> float:
    """Find how much the square of the pressure bends inside a rim, over its slope there, on a cell's width.

    It is h/a of a ball, zero where the square is straight. Cell (i, j) has the differences x and y between
    its neighbours' pressures, Pa; three cells further inside are looked at.
    """
    wide = abs(x) >= abs(y)
    down = int(np.sign(x)) if wide else 0
    aside = 0 if wide else int(np.sign(y))
    first = _squared_pressure(pressure, i + down, j + aside)
    second = _squared_pressure(pressure, i + 2 * down, j + 2 * aside)
    third = _squared_pressure(pressure, i + 3 * down, j + 3 * aside)
    rise = second - first
    loss = 2.0 * second - first - third
    slope = (rise + 1.5 * loss) * np.sqrt(1.0 + slant * slant)  # 1.5 cells from there, normal to the rim
    if rise <= 0.0 or slope <= 0.0:
        return MOST_BENT
    return BEND_SHARE * max(min(loss / slope - BEND_LEFT, MOST_BENT / BEND_SHARE), 0.0)


@compiled(**LOOP)
def rim_slopes(pressure: NDArray, along: float, across: float, slopes: NDArray, covered: NDArray) -> None:
    """Find how the gap at rims changes with the pressure, and how much of each cell is covered.

    Pressure (nx, ny), Pa; sides of a cell over E*, m/Pa. `slopes` (3, nx, ny), zeros, receives derivatives,
    m/Pa: by the pressure of the cell itself, by the difference of its neighbours along, and across; `covered`
    (nx, ny) shares.
    """
    nx, ny = pressure.shape
    for i in range(nx):
        for j in range(ny):
            p = pressure[i, j]
            covered[i, j] = 1.0 if p > 0.0 else 0.0
            x = (pressure[i + 1, j] if i + 1 < nx else 0.0) - (pressure[i - 1, j] if i > 0 else 0.0)
            y = (pressure[i, j + 1] if j + 1 < ny else 0.0) - (pressure[i, j - 1] if j > 0 else 0.0)
            if p > 0.0 and p * p < END**4 * (x * x + y * y):
                found = _at_rim(p, x, y, 1.0 / along**2, 1.0 / across**2)
                scale, step, ratio, slant, _left, slope, slopes[1, i, j], slopes[2, i, j] = found
                slopes[0, i, j] = 0.5 * slope * scale / (step * ratio)
                bend = bend_inside(pressure, i, j, x, y, slant)
                share = between_curves(_COVERED, ratio, slant)[0]
                share += bend * between_curves(_BENT, ratio, slant)[0]
                covered[i, j] = min(max(share, 0.0), 1.0)
