"""Curves of cells at the rim of a contact: the gap that is left in them, and how much of them is covered.

They are functions of √(p/S) and of the slant, as `kernels.rims` says: cubics of the one, and straight in the
other between values that are even in its root. ``benchmarks/cell_rims.py`` computes them.
"""

import tomllib
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from asperity.files import packaged
from asperity.kernels.lanes import EIGHT, aligned, width
from asperity.kernels.options import INNER, UNCHECKED, compiled

KNOTS, SLANTS = 33, 7
"""Values of a curve, even in √(p/S) from 0 to END, and curves, even in the root of the slant.

The slant is the smaller of the differences over the larger: 0 for a rim along an axis of the grid, 1 along
the diagonal of its cells.
"""
END = 1.28
"""Largest √(p/S) of a cell at a rim: beyond it nothing is left."""
PER_UNIT = np.float32((KNOTS - 1) / END)
"""Knots per unit of √(p/S); like all numbers here in single precision, which computes in no other's stead."""
FIRST, SECOND, THIRD, FOURTH, FIFTH = ((np.arange(1, SLANTS - 1) / (SLANTS - 1)) ** 2).astype(np.float32)
"""Slants between which curves are straight."""
TWO, THREE = np.float32(2.0), np.float32(3.0)
_CURVES = tomllib.loads(packaged("kernels/rim_curves.toml"))
LEFT = np.array(_CURVES["left"])
"""Gap that is left, over S times the width of a cell and E*: slant after slant."""
COVERED = np.array(_CURVES["covered"])
"""Share of a cell inside a rim of pressures whose squares are straight, likewise."""
BENT = np.array(_CURVES["bent"])
"""What it gains where they bend, over the bend, at every third knot."""


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


def curve_rows(values: NDArray, dtype: DTypeLike) -> NDArray:
    """Coefficients of curves, interval after interval, in rows as wide as a vector.

    A row holds those of the cubic at a slant of zero, and what they gain with the slant.
    """
    slants = np.arange(SLANTS - 1.0)[:, None, None]
    each = cubics(values)
    turned = np.diff(each, axis=0) / (2.0 * slants + 1.0)
    straight = each[:-1] - slants**2 * turned
    both = np.concatenate([straight, (SLANTS - 1) ** 2 * turned], axis=2).reshape(-1, EIGHT)
    rows = aligned(len(both) * width(dtype), dtype)
    rows.reshape(len(both), -1)[:, :EIGHT] = both
    return rows


@cache
def left_rows(dtype: np.dtype) -> NDArray:
    """Coefficients of the gap that is left, as `curve_rows` lays them out: not to be written to."""
    return curve_rows(LEFT, dtype)


@compiled(**INNER, **UNCHECKED)
def row_behind(ratio: float, slant: float) -> tuple[Any, Any]:
    """Find the row of curves at a ratio √(p/S), from 0 to END, and a slant, and how far behind its knot."""
    place = ratio * PER_UNIT
    k = min(np.int32(place), np.int32(KNOTS - 2))  # whole numbers that fit beside each other into a vector
    j = np.int32(slant >= FIRST) + np.int32(slant >= SECOND) + np.int32(slant >= THIRD)
    j += np.int32(slant >= FOURTH) + np.int32(slant >= FIFTH)
    return j * np.int32(KNOTS - 1) + k, place - np.float32(k)


@compiled(**INNER)
def cubic(a: float, b: float, c: float, d: float, t: float) -> tuple[Any, Any]:
    """Value of a cubic, and its slope by t."""
    return a + t * (b + t * (c + t * d)), b + t * (TWO * c + t * (THREE * d))


@compiled(**INNER, **UNCHECKED)
def between_curves(rows: NDArray, ratio: float, slant: float) -> tuple[float, float, float]:
    """Find a value of curves, in double precision, and its derivatives by ratio and slant."""
    row, t = row_behind(ratio, slant)
    i = EIGHT * row
    straight, slope = cubic(rows[i], rows[i + 1], rows[i + 2], rows[i + 3], t)
    turn, steeper = cubic(rows[i + 4], rows[i + 5], rows[i + 6], rows[i + 7], t)
    return straight + slant * turn, (slope + slant * steeper) * PER_UNIT, turn


_LEFT, _COVERED, _BENT = (curve_rows(each, np.float64) for each in (LEFT, COVERED, every_knot(BENT)))


@compiled(**INNER, **UNCHECKED)
def remaining_gap(ratio: float, slant: float) -> tuple[float, float, float]:
    """Find the gap that is left at a ratio √(p/S), over S times the width and E*, and its derivatives."""
    return between_curves(_LEFT, ratio, slant)


@compiled(**INNER, **UNCHECKED)
def covered_share(ratio: float, slant: float, bend: float) -> float:
    """Find how much of a cell is covered, inside of a rim where the square of the pressure bends so much."""
    share = between_curves(_COVERED, ratio, slant)[0]
    share += bend * between_curves(_BENT, ratio, slant)[0]
    return min(max(share, 0.0), 1.0)
