"""Mode shapes as splines: polynomials between their knots, looked up fast."""

from __future__ import annotations

from math import factorial
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import BSpline

from asperity.errors import InputError
from asperity.kernels.piecewise import evaluate_pieces

Array = NDArray[np.float64]


class Pieces(NamedTuple):
    """Polynomials between breaks."""

    coefficients: Array  # (pieces, degree + 1, modes), highest power of the distance from the break first
    breaks: Array  # (pieces + 1,), m


def pieces_of(spline: BSpline) -> Pieces:
    """Polynomials of a spline of many columns."""
    breaks = np.unique(spline.t)
    powers = range(spline.k, -1, -1)
    coefficients = np.stack([spline(breaks[:-1], nu=p) / factorial(p) for p in powers], axis=1)
    return Pieces(np.ascontiguousarray(coefficients), breaks)


def shapes_at(pieces: Pieces, x: ArrayLike) -> tuple[Array, Array]:
    """Shapes and slopes (n, modes) at positions, m; an `InputError` where one lies beyond the breaks."""
    at = np.ascontiguousarray(np.atleast_1d(np.asarray(x, dtype=float)))
    first, last = float(pieces.breaks[0]), float(pieces.breaks[-1])
    slack = 1e-9 * (last - first)
    if not (at.min() >= first - slack and at.max() <= last + slack):
        received = f"{at.min():.6g} to {at.max():.6g}"
        raise InputError("positions on the structure (m)", received, f"{first:.6g} to {last:.6g}")
    shapes, slopes = np.empty((2, at.size, pieces.coefficients.shape[-1]))
    evaluate_pieces(pieces.coefficients, pieces.breaks, at, shapes, slopes)
    return shapes, slopes
