"""The areal texture: what a nominal contact patch sees of a rough surface, in closed form."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.errors import InputError
from asperity.reduction.convolving import LongConvolution
from asperity.reduction.texture import StateTexture
from asperity.surfaces.strip import Rows, Strip

PIECE = 2**11
"""Rows averaged in one go: few, so that their spectra stay in the processor's cache."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)


def punch_weights(spacing: tuple[float, float], semi_axes: tuple[float, float]) -> NDArray[np.float64]:
    """Share (odd, odd) of the flat-punch pressure on each cell of a grid under an elliptic patch.

    (dx, dy) and the semi-axes (a_x, a_y) in m, the patch centred on the middle cell; the weights sum to one.
    w(ξ, η) = 1/(2π a_x a_y √(1 − ξ²/a_x² − η²/a_y²)), integrated over x in closed form and over y by Gauss's
    rule after y = a_y sin θ. By reciprocity this is the weight with which small heights enter the force of a
    Hertzian contact at constant approach; its transform is sin q/q, q² = (k_x a_x)² + (k_y a_y)².
    """
    dx, dy = spacing
    a, b = semi_axes
    columns = max(0, math.ceil(b / dy - 0.5))
    rows = max(0, math.ceil(a / dx - 0.5))
    edges_y = np.clip((np.arange(-columns, columns + 2) - 0.5) * dy / b, -1.0, 1.0)
    edges_x = (np.arange(-rows, rows + 2) - 0.5) * dx
    low, high = np.arcsin(edges_y[:-1]), np.arcsin(edges_y[1:])
    theta = 0.5 * (low + high)[:, None] + 0.5 * (high - low)[:, None] * _NODES
    chord = a * np.cos(theta)
    cumulative = np.arcsin(np.clip(edges_x[:, None, None] / chord, -1.0, 1.0)) / math.pi
    inside = np.diff(cumulative, axis=0) * np.cos(theta)
    return 0.5 * np.sum(inside * _WEIGHTS, axis=2) * 0.5 * (high - low)


def areal_texture(
    heights: NDArray[np.float64] | Strip,
    spacing: tuple[float, float],
    approaches: ArrayLike,
    semi_axes: ArrayLike,
    start: float = 0.0,
) -> StateTexture:
    """Average a strip of texture under the flat-punch weight of the patch of each state: h̃_a, m.

    Heights (n, ny), m, peaks positive; the contact runs along the middle of the strip, so ny is odd, and the
    strip at least as wide as the widest patch. Approaches (k,), m, and semi-axes (k, 2) (a_x, a_y) of the
    nominal patch of each state, m; `start` is the position of the first row, m. The result is positive away
    from the contact; its ends, one semi-axis long, see zeros beyond the strip.
    """
    axes = np.atleast_2d(np.asarray(semi_axes, dtype=np.float64))
    strip = Rows(heights) if isinstance(heights, np.ndarray) else heights
    n, ny = strip.shape
    if ny % 2 == 0:
        raise InputError(
            "width of the texture strip", f"{ny} lines", "an odd number, so that one is the middle"
        )
    if axes[:, 1].max() > 0.5 * ny * spacing[1]:
        raise InputError(
            "width of the texture strip",
            f"{ny * spacing[1]:.3g} m",
            f"at least the width of the widest patch, {2 * axes[:, 1].max():.3g} m",
            "Enlarge contact.window.",
        )
    middle = ny // 2
    halves = [_half(punch_weights(spacing, (float(a), float(b))), middle) for a, b in axes]
    reach = max(half.shape[0] // 2 for half in halves)
    weights = np.zeros((len(halves), max(half.shape[1] for half in halves), 2 * reach + 1))
    for row, half in zip(weights, halves, strict=True):
        side = reach - half.shape[0] // 2
        row[: half.shape[1], side : 2 * reach + 1 - side] = -half.T
    averaged, result = LongConvolution(weights, min(PIECE, n)), np.empty((len(axes), n))
    for first in range(0, n, PIECE):
        low, high = max(0, first - reach), min(n, first + PIECE + reach)
        rows = strip.rows(low, high)
        folded = rows[:, middle : middle + weights.shape[1]].copy()
        folded[:, 1:] += rows[:, middle - 1 :: -1][:, : folded.shape[1] - 1] if middle else 0.0
        last = min(first + PIECE, n)
        beyond = (reach - (first - low), reach - (high - last))  # zeros
        result[:, first:last] = averaged.of(np.pad(folded.T, ((0, 0), beyond)))
    return StateTexture(result, np.asarray(approaches, dtype=np.float64), start, spacing[0])


def _half(weights: NDArray[np.float64], middle: int) -> NDArray[np.float64]:
    """Columns of the weights from the middle on, no more than half a strip has."""
    return weights[:, weights.shape[1] // 2 :][:, : middle + 1]
