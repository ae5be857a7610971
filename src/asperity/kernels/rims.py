"""Cells at the rim of a contact, which are covered in part: the gap that is left at their centre.

Where a contact ends, its pressure is A √s at a distance s inside the rim, and the deformed surfaces part by
(4/3)(A/E*) (−s)^(3/2) outside of it. A cell that the rim crosses has the mean of that pressure over all of
it, and keeps a gap at its centre, where constant pressures on cells displace a little else than that pressure
does. Both follow from how far the rim has come, as does the step S = √(Δₓp² + Δᵧp²) of the pressure between
the neighbours on either side of the cell. So the gap that is left is a function of p/S alone, times S and
the width of the cell normal to the rim, over E*: it falls from 0.84 (rim along an axis; 2.74 along a
diagonal) to nothing as the rim crosses the cell. Contacts whose cells keep this gap grow evenly with the
approach; where cells are all or nothing, each that enters makes the stiffness jump.

The two curves are those of a straight rim along an axis of the grid and along the diagonal of its cells,
computed by ``benchmarks/cell_rims.py``; between the directions the gap is interpolated. On cells that are not
square, directions count on the grid, and the width is that of a cell along the normal.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.box import Box
from asperity.kernels.options import CALLED, INNER, LOOP, REASSOCIATE, compiled

KNOTS = 33
"""Values of a curve, even in √(p/S) from 0 to 1."""
ALONG_AXIS = np.array([
    0.84482, 0.81154, 0.76436, 0.71188, 0.65694, 0.60107, 0.54546, 0.49076, 0.43762, 0.38652, 0.33786,
    0.29198, 0.24915, 0.20962, 0.17361, 0.14121, 0.11294, 0.08858, 0.06834, 0.05238, 0.04083, 0.03375,
    0.03127, 0.03127, 0.03127, 0.03127, 0.02747, 0.01970, 0.01246, 0.00638, 0.00176, 0.00000, 0.00000,
])  # fmt: skip
"""Gap that is left, over S times the width of a cell and E*: rim along an axis of the grid."""
ALONG_DIAGONAL = np.array([
    2.74388, 2.05257, 1.62620, 1.30081, 1.04323, 0.83609, 0.66828, 0.53195, 0.42110, 0.33120, 0.25868,
    0.20053, 0.15449, 0.11864, 0.09150, 0.07097, 0.05476, 0.04188, 0.03181, 0.02416, 0.01856, 0.01462,
    0.01193, 0.01003, 0.00850, 0.00696, 0.00535, 0.00390, 0.00265, 0.00161, 0.00076, 0.00007, 0.00000,
])  # fmt: skip
"""Likewise, rim along the diagonal of the cells."""
COVERED_ALONG_AXIS = np.array([
    0.00000, 0.00993, 0.02537, 0.04423, 0.06601, 0.09034, 0.11716, 0.14646, 0.17820, 0.21234, 0.24889,
    0.28786, 0.32928, 0.37315, 0.41950, 0.46836, 0.51975, 0.57368, 0.63020, 0.68931, 0.75104, 0.81541,
    0.88244, 0.95214, 0.99990, 1.00000, 1.00000, 1.00000, 1.00000, 1.00000, 1.00000, 1.00000, 1.00000,
])  # fmt: skip
"""Share of a cell inside the rim: rim along an axis of the grid."""
COVERED_ALONG_DIAGONAL = np.array([
    0.00000, 0.00297, 0.01009, 0.02132, 0.03702, 0.05756, 0.08328, 0.11451, 0.15152, 0.19441, 0.24321,
    0.29789, 0.35823, 0.42397, 0.49491, 0.56664, 0.63591, 0.70268, 0.76613, 0.82494, 0.87752, 0.92220,
    0.95744, 0.98221, 0.99624, 0.99999, 1.00000, 1.00000, 1.00000, 1.00000, 1.00000, 1.00000, 1.00000,
])  # fmt: skip
"""Likewise, rim along the diagonal of the cells."""
LEAST_SLOPE = 0.02
"""Slope of a curve, at least, by which the pressure that a residual asks for is estimated."""
TOGETHER = 1e-4
"""Difference in √(p/S) below which a slope stands for a difference quotient."""
SHARED = 0.5
"""Share of what a cell yields more that a preconditioner takes: its neighbours give way, too."""


def _cubics(values: NDArray) -> NDArray:
    """Coefficients (KNOTS − 1, 4) of cubics between knots that keep a falling curve falling.

    Slopes are harmonic means of those on both sides: F. N. Fritsch and J. Butland, SIAM J. Sci. Stat. Comput.
    5 (1984) 300.
    """
    step = np.diff(values)
    before, after = step[:-1], step[1:]
    both = np.where(before + after == 0.0, 1.0, before + after)
    slopes = np.concatenate([step[:1], 2.0 * before * after / both, step[-1:]])
    low, high = slopes[:-1], slopes[1:]
    return np.stack([values[:-1], low, 3.0 * step - 2.0 * low - high, low + high - 2.0 * step], axis=1)


_CURVES = np.concatenate([_cubics(ALONG_AXIS), _cubics(ALONG_DIAGONAL) - _cubics(ALONG_AXIS)], axis=1)


@compiled(**INNER)
def remaining_gap(ratio: float, slant: float) -> tuple[float, float]:
    """Find the gap that is left at a ratio √(p/S) from 0 to 1, and its derivative.

    The slant of the rim is from 0, along an axis of the grid, to 1, along the diagonal of its cells.
    """
    place = ratio * (KNOTS - 1)
    k = min(int(place), KNOTS - 2)
    t = place - k
    a = _CURVES[k, 0] + slant * _CURVES[k, 4]
    b = _CURVES[k, 1] + slant * _CURVES[k, 5]
    c = _CURVES[k, 2] + slant * _CURVES[k, 6]
    d = _CURVES[k, 3] + slant * _CURVES[k, 7]
    return a + t * (b + t * (c + t * d)), (b + t * (2.0 * c + t * 3.0 * d)) * (KNOTS - 1)


class Rims(NamedTuple):
    """Fields of the cells of a box that are at rims."""

    gap: NDArray  # that is left at their centres, m, zero elsewhere
    scale: NDArray  # S times the width of a cell over E*, m; zero elsewhere
    step: NDArray  # S, Pa
    ratio: NDArray  # √(p/S)
    slant: NDArray  # of the rim: 0 along an axis of the grid, 1 along the diagonal of its cells
    slope: NDArray  # of the gap over the ratio, in units of the scale
    softness: NDArray  # how much more a cell yields than others, m/Pa; zero elsewhere
    weight: NDArray  # of a cell where steps are preconditioned; one elsewhere


@compiled(**INNER)
def rims_of(b: Box) -> Rims:
    """Fields of a box's cells at rims."""
    n = len(b.pressure)
    return Rims(
        b.rims[:n], b.rims[n : 2 * n], b.rims[2 * n : 3 * n], b.rims[3 * n : 4 * n], b.rims[4 * n : 5 * n],
        b.rims[5 * n : 6 * n], b.rims[6 * n : 7 * n], b.rims[7 * n : 8 * n],
    )  # fmt: skip


@compiled(**CALLED)
def set_rims(b: Box, along: float, across: float) -> None:
    """Set the gap that cells at rims keep, m, and what it depends on, from the pressure.

    The residual is less by it; what was taken off before is given back. `along` and `across` are the sides of
    a cell over E*, m/Pa.
    """
    rims = rims_of(b)
    x_share, y_share = 1.0 / along**2, 1.0 / across**2
    for i in range(b.nx):
        above, below = (i - 1) * b.pitch, (i + 1) * b.pitch
        for j in range(b.pitch):
            q = i * b.pitch + j
            p = b.pressure[q]
            x = (b.pressure[below + j] if i + 1 < b.nx else 0.0) - (b.pressure[above + j] if i > 0 else 0.0)
            y = (b.pressure[q + 1] if j + 1 < b.ny else 0.0) - (b.pressure[q - 1] if j > 0 else 0.0)
            x, y = x * x, y * y
            squares = x + y
            gap = 0.0
            if j < b.ny and p * p < squares:
                step = np.sqrt(squares)
                ratio = np.sqrt(p / step)
                slant = 4.0 * x * y / (squares * squares)
                scale = squares / np.sqrt(x * x_share + y * y_share)
                share, slope = remaining_gap(ratio, slant)
                gap = scale * share
                rims.scale[q], rims.step[q], rims.ratio[q] = scale, step, ratio
                rims.slant[q], rims.slope[q] = slant, slope
            else:
                rims.scale[q] = rims.softness[q] = 0.0
                rims.weight[q] = 1.0
            b.residual[q] += rims.gap[q] - gap
            rims.gap[q] = gap


@compiled(**CALLED)
def soften(b: Box, level: float, stiffness: float) -> None:
    """Set how much more the cells at rims yield, m/Pa, and weigh what is masked by that.

    The gap at a rim falls with the pressure, the steeper the less there is: what counts is the difference
    quotient up to the pressure that would meet the residual above a level, m, if no other cell changed its
    own. The stiffness, Pa/m, is that of a cell among others.
    """
    rims = rims_of(b)
    margin = (len(b.masked) - len(b.residual)) // 2
    for q in range(len(b.residual)):
        scale = rims.scale[q]
        if scale > 0.0:
            masked, more, weight = b.masked[margin + q], 0.0, 1.0
            if masked != 0.0:
                more = _softness(rims, q, (b.residual[q] - level) / scale, stiffness)
                weight = 1.0 / np.sqrt(1.0 + SHARED * more * stiffness)
            rims.softness[q], rims.weight[q] = more, weight
            b.masked[margin + q] = masked * weight


@compiled(**INNER)
def _softness(rims: Rims, q: int, unmet: float, stiffness: float) -> float:
    """Difference quotient of the gap of a cell, m/Pa, up to where its residual, over the scale, is met."""
    scale, step = float(rims.scale[q]), float(rims.step[q])
    ratio, slant = float(rims.ratio[q]), float(rims.slant[q])
    before, slope = rims.gap[q] / scale, min(float(rims.slope[q]), -LEAST_SLOPE)
    own = step / (stiffness * scale)
    other = min(max(ratio - unmet / (2.0 * own * ratio - slope), 0.0), 1.0)
    share, there = remaining_gap(other, slant)
    unmet += before - share + own * (other * other - ratio * ratio)
    other = min(max(other - unmet / (2.0 * own * other - min(there, -LEAST_SLOPE)), 0.0), 1.0)
    if abs(other - ratio) > TOGETHER:
        slope = (remaining_gap(other, slant)[0] - before) / (other - ratio)
    return max(-slope / max(ratio + other, TOGETHER**2) * scale / step, 0.0)


@compiled(**INNER, **REASSOCIATE)
def weigh(b: Box) -> None:
    """Weigh what is masked by how much softer cells at rims are than others."""
    weight, margin = rims_of(b).weight, (len(b.masked) - len(b.residual)) // 2
    target = b.masked[margin:]
    for q in range(len(weight)):
        target[q] *= weight[q]


@compiled(**INNER, **REASSOCIATE)
def weigh_step(b: Box, target: NDArray) -> tuple[float, float]:
    """Weigh a preconditioned residual likewise; return previous·target and the sum of the target."""
    weight, zero = rims_of(b).weight, b.z.dtype.type(0.0)
    moved, total = zero, zero
    for q in range(len(target)):
        z = target[q] * weight[q]
        target[q] = z
        moved += b.previous[q] * z
        total += z
    return moved, total


@compiled(**INNER, **REASSOCIATE)
def bend(b: Box) -> float:
    """Add up step · softness · step: the curvature that cells at rims add to a step."""
    softness, stored = rims_of(b).softness, b.z.dtype.type(0.0)
    for q in range(len(b.step)):
        stored += softness[q] * b.step[q] * b.step[q]
    return stored


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
            squares = x * x + y * y
            if not (p > 0.0 and p * p < squares):
                continue
            step = np.sqrt(squares)
            ratio = np.sqrt(p / step)
            slant = 4.0 * (x * y / squares) ** 2
            width = step / np.sqrt((x / along) ** 2 + (y / across) ** 2)
            share, slope = remaining_gap(ratio, slant)
            turned = remaining_gap(ratio, 1.0)[0] - remaining_gap(ratio, 0.0)[0]
            slopes[0, i, j] = 0.5 * width * slope / ratio
            for axis in range(2):
                own, other, side = (x, y, along) if axis == 0 else (y, x, across)
                grown = own / step  # of the step with the difference
                wider = width * own / squares - width**3 * own / (squares * side * side)
                turn = 8.0 * own * other * other * (other * other - own * own) / squares**3
                slopes[1 + axis, i, j] = (
                    (width * grown + wider * step) * share
                    - 0.5 * width * slope * ratio * grown
                    + width * step * turned * turn
                )
            covered[i, j] = _covered_share(ratio, slant)


@compiled(**INNER)
def _covered_share(ratio: float, slant: float) -> float:
    """Share of a cell that is inside the rim, at a ratio from 0 to 1."""
    place = ratio * (KNOTS - 1)
    k = min(int(place), KNOTS - 2)
    t = place - k
    axis = COVERED_ALONG_AXIS[k] + t * (COVERED_ALONG_AXIS[k + 1] - COVERED_ALONG_AXIS[k])
    diagonal = COVERED_ALONG_DIAGONAL[k] + t * (COVERED_ALONG_DIAGONAL[k + 1] - COVERED_ALONG_DIAGONAL[k])
    return (1.0 - slant) * axis + slant * diagonal
