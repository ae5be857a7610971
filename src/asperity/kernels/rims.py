"""Cells at the rim of a contact, which are covered in part: the gap that is left in them.

Where a contact ends, its pressure is A √s at a distance s inside the rim, and the deformed surfaces part by
(4/3)(A/E*) (−s)^(3/2) outside of it. A cell that the rim crosses has the mean of that pressure over all of
it, and keeps a gap, its own mean over the cell and what constant pressures on cells displace otherwise than
that pressure does. Both follow from how far the rim has come and how it lies on the grid, as do the pressure
p of the cell and the differences Δₓp, Δᵧp between its neighbours on either side. So the gap that is left is a
function of p/S and of the slant, times S = √(Δₓp² + Δᵧp²) and the width of the cell normal to the rim, over
E*: it falls to nothing as the rim crosses the cell. Contacts whose cells keep this gap grow evenly with the
approach; where cells are all or nothing, each that enters makes the stiffness jump.

Where surfaces flow, at a hardness H, the border of the flow is a rim as well: what is missing of H is A √s at
a distance s outside of it, and inside bodies overlap by as much as they part elsewhere. So H − p stands for
p, and what is left is an overlap, a gap below zero.

The curves, of `kernels.rim_curves`, are those of Hertz's contacts, whose cells are known. On cells that are
not square, directions count on the grid, and the width is that of a cell along the normal.

After each iteration cells at rims are listed. They are computed by whole vectors: what is known of them is
copied together, in chunks.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from asperity.kernels.box import Box
from asperity.kernels.lanes import EIGHT, aligned, columns, lanes, write_places
from asperity.kernels.options import CALLED, CONTRACT, INNER, LOOP, REASSOCIATE, UNCHECKED, compiled
from asperity.kernels.rim_curves import (
    END,
    PER_UNIT,
    covered_share,
    cubic,
    left_rows,
    remaining_gap,
    row_behind,
)

MOST_BENT = 1.0 / 6.0
"""Bend, at most: that of a ball with six cells in the half-width. Smaller asperities are not resolved."""
BEND_SHARE, BEND_LEFT = 0.85, 0.006
"""Bend at a rim over that of three cells inside, and what means over cells add to it: of balls."""
STEEP_END = np.float32(0.9)
"""Largest √(p/S) of a cell whose gap is steep: beyond it a cell gives way as those that keep none.

Those, a third of them or more, keep a hundredth of it."""
LEAST_SLOPE = np.float32(0.02)
"""Slope of a curve, at least, by which the pressure that a residual asks for is estimated."""
MOST_LEFT = 2.2
"""Bound of the gap that is left without pressure, over that of both differences."""
NO_STEP = np.float32(1e-10)
"""Difference of pressures, Pa, beside which none is zero."""
TOGETHER = np.float32(1e-4)
"""Difference in √(p/S) below which a slope stands for a difference quotient."""
SHARED = np.float32(0.5)
"""Share of what a cell yields more that a preconditioner takes: its neighbours give way, too."""
ZERO, ONE, TWO, LARGEST = (np.float32(each) for each in (0.0, 1.0, 2.0, END))
"""Numbers in single precision, which computes in no other's stead."""

CHUNK = 128
"""Cells at rims that are computed in one go: whole vectors, of which the last is filled up."""
P, X, Y, UNMET, RATIO, SLANT, WITHIN, COLUMNS = range(8)
"""What is known of the cells of a chunk while it is computed, one number after the other.

Pressure and the differences beside it, along and across, Pa; the residual, m; √(p/S), the slant, and how far
behind its knot; then the numbers of a row of curves. In place of the pressure comes the step, Pa, in those
of the differences its inverse and the width, m/Pa.
"""
SIGN, BEYOND, NUMBERS = range(COLUMNS + EIGHT, COLUMNS + EIGHT + 3)
"""Behind these the sign of the gap, and what is left at the other border, m."""
GAP, SOFTNESS, WEIGHT = range(3)
"""What is kept of the cells of a chunk.

The gap that is left, m; the softness V of a cell, and 1/V, its weight where steps are preconditioned. Up to
the pressure that the residual asks for, the gap falls by 2 (V - 1)/k with the pressure, where k is the
stiffness of a cell among others, Pa/m.
"""
KEPT = 3
GATHER, LAST = np.uint64(0x0102040810204080), np.uint64(56)
"""What brings the first bits of eight bytes together in the last byte, and where that begins."""
POSITIONS = np.array(
    [[*(i for i in range(8) if m >> i & 1), *range(8)][:8] for m in range(256)], np.uint8
).ravel()
COUNTS = np.array([m.bit_count() for m in range(256)], np.uint8)
"""Places of the bits that are set in a byte, and their number."""


class Rims(NamedTuple):
    """Cells of a box that are at rims, one after the other, and how their gap changes with a step.

    For contacts of whole cells None stands in place of this, and nothing of this is compiled.
    """

    along: float  # side of a cell over E*, m/Pa
    across: float  # likewise
    number: NDArray  # (1,), number of cells at rims
    cell: NDArray  # their places in the box
    kept: NDArray  # what is kept of them, chunk after chunk: each number of all its cells
    softness: NDArray  # of all cells of the box, one elsewhere than at rims
    weight: NDArray  # likewise
    bare: NDArray  # residual of all cells of the box with no gap taken off, m
    marks: NDArray  # of the cells of the box: one at a rim
    eights: NDArray  # eight of them in one number
    chunk: NDArray  # room for what is computed of a chunk
    places: NDArray  # (CHUNK,), where its rows of the curves begin
    curves: NDArray  # from `rim_curves.left_rows`


def rims(along: float, across: float, size: int, dtype: DTypeLike) -> Rims:
    """Make room for what is known of the rims of a box whose fields have a size, with sides over E*, m/Pa."""
    chunks = -(-size // CHUNK)
    eights: NDArray = np.zeros(CHUNK * chunks // 8, dtype=np.uint64)
    return Rims(
        along, across, np.zeros(1, dtype=np.int64), np.zeros(size + EIGHT, dtype=np.uint32),
        aligned(KEPT * CHUNK * chunks, dtype), aligned(size, dtype), aligned(size, dtype),
        aligned(size, dtype), eights.view(np.uint8), eights,
        aligned(NUMBERS * CHUNK, dtype), np.zeros(CHUNK, dtype=np.int32), left_rows(np.dtype(dtype)),
    )  # fmt: skip


@compiled(**INNER)
def _is_at_rim(p: float, apart: float, x: float, y: float, wide: float, most: float) -> bool:
    """Whether a cell is at a rim: its pressure is less than the step between its neighbours.

    Not without pressure, if it stays apart by more than a rim leaves in any cell.
    """
    return bool(p * p < most * (x * x + y * y) and (p > ZERO or apart < wide * (x + y)))


@compiled(**INNER, **REASSOCIATE)
def _mark_rims(b: Box, rims: Rims, level: float, hardness: float) -> bool:
    """Mark the cells at rims; level of residuals in m.

    Where surfaces flow likewise, by what cells lack of the hardness. Returns whether any of them do.
    """
    real = b.z.dtype.type
    zero, one = real(0.0), real(1.0)
    flowing = zero
    most = real(END**4)
    side = max(rims.along, rims.across)
    wide = real(side * MOST_LEFT)
    level = real(level)
    cap = real(hardness)
    margin = (len(b.framed) - len(b.z)) // 2
    above = b.framed[margin - b.pitch :]
    middle = b.framed[margin - 1 :]
    below = b.framed[margin + b.pitch :]
    if hardness < np.inf:
        for q in range(len(b.z)):
            p = middle[q + 1]
            lacked = cap - p
            apart = b.residual[q] - level
            x = abs(below[q] - above[q])
            y = abs(middle[q + 2] - middle[q])
            apart = apart if p <= lacked else -apart
            rims.marks[q] = np.uint8(_is_at_rim(min(p, lacked), apart, x, y, wide, most))
            flowing += one if lacked * lacked < most * (x * x + y * y) else zero
    else:
        for q in range(len(b.z)):
            x = abs(below[q] - above[q])
            y = abs(middle[q + 2] - middle[q])
            rims.marks[q] = np.uint8(_is_at_rim(middle[q + 1], b.residual[q] - level, x, y, wide, most))
    return flowing > zero


@compiled(**INNER)
def _list(rims: Rims, size: int) -> int:
    """List those of so many cells that are marked; return how many there are."""
    found = 0
    for k in range(size // 8):
        byte = rims.eights[k] * GATHER >> LAST
        write_places(rims.cell, found, POSITIONS, np.int64(byte), 8 * k)
        found += COUNTS[byte]
    return found


@compiled(**INNER, **UNCHECKED)
def _at_rim(
    p: float, x: float, y: float, side: float, elongation: float
) -> tuple[float, float, float, float, float]:
    """Find how a rim crosses a cell, from its pressure and its neighbours' differences, not negative, Pa.

    Side along over E*, m/Pa; the elongation is the square of that side over the other. Returns the step S and
    its inverse; width of the cell along the normal, over E*; ratio √(p/S) and slant.
    """
    xx = x * x + NO_STEP * NO_STEP
    yy = y * y
    step = np.sqrt(xx + yy)
    normal = np.sqrt(xx + elongation * yy)
    far = max(max(x, y), NO_STEP)
    product = ONE / (step * normal * far)
    per_step = normal * far * product
    width = side * (step * step * far * product)
    slant = min(x, y) * (step * normal * product)
    return step, per_step, width, min(np.sqrt(p * per_step), LARGEST), slant


@compiled(**CALLED, **CONTRACT, **UNCHECKED)
def _place(c: NDArray, places: NDArray, count: int, side: float, elongation: float) -> None:
    """Find how a rim crosses the cells of a chunk, and where the curves begin that hold there."""
    real = c.dtype.type
    side = real(side)
    elongation = real(elongation)
    for k in range(count):
        x = abs(c[X * CHUNK + k])
        y = abs(c[Y * CHUNK + k])
        step, per_step, width, ratio, slant = _at_rim(c[P * CHUNK + k], x, y, side, elongation)
        row, within = row_behind(ratio, slant)
        c[P * CHUNK + k] = step
        c[X * CHUNK + k] = per_step
        c[Y * CHUNK + k] = width
        c[RATIO * CHUNK + k] = ratio
        c[SLANT * CHUNK + k] = slant
        c[WITHIN * CHUNK + k] = within
        places[k] = row * np.int32(lanes(c))


@compiled(**INNER, **CONTRACT, **UNCHECKED)
def _between(c: NDArray, k: int) -> tuple[float, float]:
    """Gap that is left in a cell of a chunk, over S, and its slope from knot to knot, likewise, m/Pa.

    The slope is zero where the gap is not steep.
    """
    o = COLUMNS * CHUNK + k
    slant = c[SLANT * CHUNK + k]
    left, slope = cubic(
        c[o] + slant * c[o + 4 * CHUNK],
        c[o + CHUNK] + slant * c[o + 5 * CHUNK],
        c[o + 2 * CHUNK] + slant * c[o + 6 * CHUNK],
        c[o + 3 * CHUNK] + slant * c[o + 7 * CHUNK],
        c[WITHIN * CHUNK + k],
    )
    width = c[Y * CHUNK + k]
    steep = c[RATIO * CHUNK + k] < STEEP_END
    return width * left, width * (min(slope, -LEAST_SLOPE / PER_UNIT) if steep else ZERO)


@compiled(**INNER, **CONTRACT, **UNCHECKED)
def _find_gaps(c: NDArray, gaps: NDArray, count: int) -> None:
    """Find the gap that is left in the cells of a chunk, alone."""
    for k in range(count):
        gaps[k] = c[P * CHUNK + k] * _between(c, k)[0]


@compiled(**CALLED, **CONTRACT, **UNCHECKED)
def _find_kept(c: NDArray, kept: NDArray, count: int, stiffness: float) -> None:
    """Find all that is kept of the cells of a chunk, with one division."""
    stiffness = c.dtype.type(stiffness)
    for k in range(count):
        ratio = c[RATIO * CHUNK + k]
        left, slope = _between(c, k)
        # what p - p₀ + stiffness (unmet - gap + gap₀) = 0 gives, the gap straight in the ratio
        soft = -SHARED * PER_UNIT * stiffness * slope
        far = soft * soft + TWO * soft * ratio + ratio * ratio
        far -= stiffness * (c[UNMET * CHUNK + k] * c[X * CHUNK + k] - left)
        between = max(ratio + max(np.sqrt(max(far, ZERO)) - soft, ZERO), TOGETHER)
        softer = between + soft
        share = ONE / (between * softer)
        kept[GAP * CHUNK + k] = c[P * CHUNK + k] * left
        kept[SOFTNESS * CHUNK + k] = softer * softer * share
        kept[WEIGHT * CHUNK + k] = between * between * share


@compiled(**INNER)
def _look(b: Box, rims: Rims, first: int, count: int, level: float) -> None:
    """Copy what is known of so many cells from the first on together."""
    margin = (len(b.framed) - len(b.z)) // 2
    above = b.framed[margin - b.pitch :]
    middle = b.framed[margin - 1 :]
    below = b.framed[margin + b.pitch :]
    level = b.z.dtype.type(level)
    c = rims.chunk
    cells = rims.cell[first:]
    for i in range(count):
        q = cells[i]
        c[P * CHUNK + i] = middle[q + 1]
        c[X * CHUNK + i] = below[q] - above[q]
        c[Y * CHUNK + i] = middle[q + 2] - middle[q]
        c[UNMET * CHUNK + i] = b.residual[q] - level


@compiled(**CALLED)
def _look_from_flow(c: NDArray, count: int, hardness: float) -> bool:
    """Let what cells of a chunk lack of the hardness stand for their pressure where that is less.

    Their gaps then have another sign. Returns whether some are at a rim and at a border of flow at once.
    """
    real = c.dtype.type
    cap, most = real(hardness), real(END**4)
    both = 0
    for i in range(count):
        p = c[P * CHUNK + i]
        lacked = cap - p
        sign = real(-1.0) if lacked < p else real(1.0)
        far = max(p, lacked)
        c[SIGN * CHUNK + i] = sign
        c[P * CHUNK + i] = min(p, lacked)
        c[UNMET * CHUNK + i] *= sign
        both += far * far < most * (c[X * CHUNK + i] ** 2 + c[Y * CHUNK + i] ** 2)
    return both > 0


@compiled(**INNER)
def _compute(rims: Rims, count: int) -> int:
    """Find how rims cross the cells of a chunk, by number; return how many cells its vectors hold."""
    lane = lanes(rims.chunk)
    filled = (count + lane - 1) // lane * lane
    _place(rims.chunk, rims.places, filled, rims.along, (rims.along / rims.across) ** 2)
    for k in range(0, filled, lane):
        columns(rims.curves, rims.places, k, rims.chunk, COLUMNS * CHUNK + k, CHUNK)
    return filled


@compiled(**CALLED)
def _leave_to_flow(
    b: Box, rims: Rims, first: int, count: int, gaps: NDArray, hardness: float, both: bool
) -> None:
    """Take off gaps of cells, by number, what the other border leaves; where cells flow, they overlap."""
    c = rims.chunk
    cap = c.dtype.type(hardness)
    beyond = c[BEYOND * CHUNK :]
    if both:
        _look(b, rims, first, count, 0.0)
        for i in range(count):
            c[P * CHUNK + i] = max(c[P * CHUNK + i], cap - c[P * CHUNK + i])
        _find_gaps(c, beyond, _compute(rims, count))
        for i in range(count):
            gaps[i] -= beyond[i]
    for i in range(count):
        gaps[i] *= c[SIGN * CHUNK + i]


@compiled(**INNER)
def _clear(rims: Rims, size: int) -> None:
    """Let so many cells of a box be as soft as those elsewhere than at rims."""
    for q in range(size):
        rims.softness[q] = rims.weight[q] = 1.0


@compiled(**INNER)
def _soften(rims: Rims, kept: NDArray, i: int, q: int) -> None:
    """Let a cell of the box be as soft as one of a chunk, by number."""
    rims.softness[q] = kept[SOFTNESS * CHUNK + i]
    rims.weight[q] = kept[WEIGHT * CHUNK + i]


@compiled(**INNER)
def _take(b: Box, rims: Rims, first: int, count: int) -> None:
    """Take the gaps of so many cells from the first on, by number, off the residual; soften them."""
    cells, kept = rims.cell[first:], rims.kept[KEPT * first :]
    for i in range(count):
        q = cells[i]
        b.residual[q] -= kept[GAP * CHUNK + i]
        _soften(rims, kept, i, q)


@compiled(**CALLED)
def set_rims(b: Box, rims: Rims | None, level: float, stiffness: float, hardness: float) -> None:
    """Find the cells at rims, and take the gap that is left in them off a residual that lacks none.

    The gap falls with the pressure, the steeper the less there is: what counts is the difference quotient up
    to the pressure that would meet the residual above a level, m, if no other cell changed its own. The
    stiffness, Pa/m, is that of a cell among others; at the hardness, Pa, surfaces flow.
    """
    if rims is not None:
        flows = _mark_rims(b, rims, level, hardness)
        _clear(rims, len(b.z))
        number = _list(rims, len(b.z))
        rims.number[0] = number
        both = False
        for first in range(0, number, CHUNK):
            count = min(CHUNK, number - first)
            kept = rims.kept[KEPT * first :]
            _look(b, rims, first, count, level)
            if flows:
                both = _look_from_flow(rims.chunk, count, hardness)
            _find_kept(rims.chunk, kept, _compute(rims, count), stiffness)
            if flows:
                _leave_to_flow(b, rims, first, count, kept[GAP * CHUNK :], hardness, both)
            _take(b, rims, first, count)


@compiled(**INNER)
def _gap(rims: Rims, k: int) -> float:
    """Gap that is left in a cell, by number, m."""
    within = k & (CHUNK - 1)
    return rims.kept[KEPT * (k - within) + GAP * CHUNK + within]


@compiled(**INNER)
def take_off(b: Box, rims: Rims | None) -> None:
    """Take the gap that is left at rims off a residual."""
    if rims is not None:
        for q in range(len(b.z)):
            rims.bare[q] = b.residual[q]
        for k in range(rims.number[0]):
            b.residual[rims.cell[k]] -= _gap(rims, k)


@compiled(**INNER)
def lay_bare(b: Box, rims: Rims | None) -> None:
    """Find the residual with no gap taken off."""
    if rims is not None:
        for q in range(len(b.z)):
            rims.bare[q] = b.residual[q]
        for k in range(rims.number[0]):
            rims.bare[rims.cell[k]] += _gap(rims, k)


@compiled(**INNER)
def without_rims(b: Box, rims: Rims | None) -> None:
    """Begin with a residual of which no gap is taken off."""
    if rims is not None:
        rims.number[0] = 0
        lay_bare(b, rims)


@compiled(**INNER, **UNCHECKED)
def move_rims(b: Box, rims: Rims | None, pitch: int, row: int, column: int) -> None:
    """Place cells at rims in a box that begins in a row and a column of theirs, whose pitch is given."""
    if rims is not None:
        for k in range(rims.number[0]):
            i = rims.cell[k] // pitch
            rims.cell[k] += i * (b.pitch - pitch) - row * b.pitch - column
        _clear(rims, len(b.z))
        for first in range(0, rims.number[0], CHUNK):
            cells, kept = rims.cell[first:], rims.kept[KEPT * first :]
            for i in range(min(CHUNK, rims.number[0] - first)):
                _soften(rims, kept, i, cells[i])


@compiled(**INNER, **UNCHECKED)
def set_shares(b: Box, rims: Rims) -> None:
    """Set `z` to what the residual of each cell counts for: how far it moves, over what others do."""
    for q in range(len(b.z)):
        b.z[q] = 1.0 / (2.0 * rims.softness[q] - 1.0)


@compiled(**INNER)
def weigh(b: Box, rims: Rims) -> None:
    """Weigh what is masked by how much softer cells at rims are than others."""
    masked = b.masked[(len(b.masked) - len(b.residual)) // 2 :]
    for q in range(len(b.z)):
        masked[q] *= rims.weight[q]


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


@compiled(**INNER)
def _steps_beside(pressure: NDArray, i: int, j: int) -> tuple[float, float]:
    """Differences of the pressure between the neighbours of a cell, along and across, Pa."""
    nx, ny = pressure.shape
    x = (pressure[i + 1, j] if i + 1 < nx else 0.0) - (pressure[i - 1, j] if i > 0 else 0.0)
    y = (pressure[i, j + 1] if j + 1 < ny else 0.0) - (pressure[i, j - 1] if j > 0 else 0.0)
    return x, y


@compiled(**LOOP)
def rim_slopes(pressure: NDArray, along: float, across: float, hardness: float, slopes: NDArray) -> None:
    """Find how the gap at rims changes with the pressure, and at borders of flow what is left there.

    Pressure (nx, ny), Pa; sides of a cell over E*, m/Pa; hardness, Pa. `slopes` (3, nx, ny), zeros, receives
    derivatives, m/Pa: by the pressure of the cell itself, by the difference of its neighbours along, and
    across.
    """
    nx, ny = pressure.shape
    elongation = (along / across) ** 2
    for i in range(nx):
        for j in range(ny):
            p = pressure[i, j]
            x, y = _steps_beside(pressure, i, j)
            # gap and pressure change their signs together at a border of flow, and so their slopes do not
            for near, beside, aside in ((p, x, y), (hardness - p, -x, -y)):
                if near > 0.0 and near * near < END**4 * (x * x + y * y):
                    _add_slopes(near, beside, aside, along, elongation, slopes[:, i, j])


@compiled(**INNER)
def _add_slopes(p: float, x: float, y: float, along: float, elongation: float, slopes: NDArray) -> None:
    """Add to slopes (3,) those of the gap in a cell at a rim, m/Pa."""
    step, _, width, ratio, slant = _at_rim(p, abs(x), abs(y), along, elongation)
    left, slope, turn = remaining_gap(ratio, slant)
    by_step = (2.0 * left - 0.5 * slope * ratio) * width / step
    by_width = left * (width / along) ** 2 * width / step
    by_near = turn * step * width / max(abs(x), abs(y))
    by_far = -slant * by_near
    wide = abs(x) >= abs(y)
    slopes[0] += 0.5 * slope * width / ratio
    slopes[1] += x * (by_step - by_width) + np.sign(x) * (by_far if wide else by_near)
    slopes[2] += y * (by_step - by_width * elongation) + np.sign(y) * (by_near if wide else by_far)


@compiled(**LOOP)
def cells_covered(pressure: NDArray, along: float, across: float) -> float:
    """Number of cells in contact, those at rims as far as they are covered; arguments as in `rim_slopes`."""
    nx, ny = pressure.shape
    elongation = (along / across) ** 2
    number = 0.0
    for i in range(nx):
        for j in range(ny):
            p = pressure[i, j]
            if not p > 0.0:
                continue
            x, y = _steps_beside(pressure, i, j)
            if p * p < END**4 * (x * x + y * y):
                _, _, _, ratio, slant = _at_rim(p, abs(x), abs(y), along, elongation)
                number += covered_share(ratio, slant, bend_inside(pressure, i, j, x, y, slant))
            else:
                number += 1.0
    return number
