"""Love's influence coefficients: displacement of a half-space under pressure on one rectangular cell."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from asperity.kernels.convolution import Convolution, quarter_turn, spectrum, whole_vectors
from asperity.kernels.fourier import factors, roots, smooth_length
from asperity.kernels.lanes import lanes, width
from asperity.kernels.options import CALLED, INNER, compiled

AT_ONCE = 2**16
"""Coefficients that are computed in one go: some ten arrays of them take memory."""


def _edge_log(x: NDArray, y: NDArray, half: float) -> NDArray:
    """ln[(y₊ + √(y₊² + x²)) / (y₋ + √(y₋² + x²))] for y ≥ 0, without cancellation far away."""
    upper, lower = y + half, y - half
    r_upper, r_lower = np.hypot(upper, x), np.hypot(lower, x)
    away = np.where(lower < 0.0, r_lower - lower, 1.0)
    denominator = np.where(lower < 0.0, x * x / away, lower + r_lower)
    step = 2.0 * half * (1.0 + 2.0 * y / (r_upper + r_lower))
    return np.log1p(step / denominator)


def cell_displacement(x: NDArray, y: NDArray, dx: float, dy: float) -> NDArray:
    """Surface displacement at (x, y), times π E*, under unit pressure on the cell dx × dy at the origin.

    All in m; to be divided by π E*, Pa. A. E. H. Love, Phil. Trans. R. Soc. A 228 (1929) 377; finite
    everywhere.
    """
    x, y = np.abs(x), np.abs(y)
    hx, hy = 0.5 * dx, 0.5 * dy
    return (
        (x + hx) * _edge_log(x + hx, y, hy)
        - (x - hx) * _edge_log(x - hx, y, hy)
        + (y + hy) * _edge_log(y + hy, x, hx)
        - (y - hy) * _edge_log(y - hy, x, hx)
    )


def influence_table(nx: int, ny: int, dx: float, dy: float) -> NDArray:
    """Influence coefficients (nx, ny), m, times π E*: entry (i, j) for the separation (i dx, j dy), m."""
    x, y = dx * np.arange(nx, dtype=np.float64), dy * np.arange(ny, dtype=np.float64)
    table, rows = np.empty((nx, ny)), max(1, AT_ONCE // ny)
    for first in range(0, nx, rows):
        table[first : first + rows] = cell_displacement(x[first : first + rows, None], y, dx, dy)
    return table


UNIT = 8
"""Boxes are convolved in multiples of this length."""
RADICES = 16
"""Room for the radices of a length: no length that fits into memory has as many."""


class Influence(NamedTuple):
    """Influence of pressure on displacement, with the convolutions prepared so far."""

    table: NDArray  # (≥ nx, ≥ ny), displacement per pressure at non-negative separations, m/Pa
    softest: float  # no pressure of unit norm displaces by more, m/Pa
    taps: NDArray  # (6,), preconditioner, from `preconditioner.inverse_stencil`, Pa/m
    lengths: NDArray  # (k,), length in which n cells are convolved, at ⌈n / UNIT⌉
    radices: NDArray  # (RADICES k,), radices of the length UNIT i from RADICES i on, then zeros
    starts: NDArray  # (k,), where the roots and turns of the length UNIT i begin
    roots: NDArray  # from `fourier.roots`, length after length
    turns: NDArray  # from `convolution.quarter_turn`, length after length
    # (k, k), where the spectrum on UNIT i × UNIT j cells begins; −1 if it is not prepared
    places: NDArray
    spectra: NDArray  # from `convolution.spectrum`, one after the other


def influence(table: NDArray, taps: NDArray, dtype: DTypeLike = np.float64) -> Influence:
    """Make the influence of a half-space, without any convolution prepared.

    Table and taps as in `Influence`, the table's sides from `fourier.smooth_length`. All but the table has
    the precision of the solution: float64 or float32.
    """
    count = max(table.shape) // UNIT + 1
    lengths = np.array([smooth_length(UNIT * i) for i in range(count)])
    radices = np.zeros((count, RADICES), dtype=np.int64)
    starts = np.zeros(count, dtype=np.int64)
    fast = np.unique(lengths)
    starts[fast // UNIT] = 2 * (np.cumsum(fast) - fast)
    for length in fast.tolist():
        split = factors(length)
        radices[length // UNIT, : len(split)] = split
    softest = 4.0 * float(np.abs(table).sum())  # over separations of both signs: no row of K adds up to more
    known_roots = np.concatenate([roots(n) for n in fast.tolist()])
    turns = np.concatenate([quarter_turn(n) for n in fast.tolist()])
    given = (taps, known_roots, turns, np.zeros(0))
    taps, known_roots, turns, spectra = (a.astype(dtype) for a in given)
    places = np.full((count, count), -1)
    return Influence(
        table, softest, taps, lengths, radices.ravel(), starts, known_roots, turns, places, spectra
    )


def prepared(known: Influence, nx: int, ny: int) -> Influence:
    """Add the convolution on a box of nx × ny cells, unless it is there."""
    mx, my = (int(known.lengths[-(-n // UNIT)]) for n in (nx, ny))
    if known.places[mx // UNIT, my // UNIT] >= 0:
        return known
    places = known.places.copy()
    places[mx // UNIT, my // UNIT] = len(known.spectra)
    dtype = known.spectra.dtype
    added = spectrum(known.table, mx, my, width(dtype)).astype(dtype)
    return known._replace(places=places, spectra=np.concatenate([known.spectra, added]))


@compiled(**INNER)
def is_prepared(known: Influence, nx: int, ny: int) -> bool:
    """Whether the convolution on a box of nx × ny cells is there."""
    mx, my = known.lengths[-(-nx // UNIT)], known.lengths[-(-ny // UNIT)]
    return known.places[mx // UNIT, my // UNIT] >= 0


@compiled(**CALLED)
def convolution(known: Influence, nx: int, ny: int) -> Convolution:
    """Convolution on a box of nx × ny cells, which is prepared."""
    i, j = known.lengths[-(-nx // UNIT)] // UNIT, known.lengths[-(-ny // UNIT)] // UNIT
    x, y, place = known.starts[i], known.starts[j], known.places[i, j]
    end_x, end_y = RADICES * i, RADICES * j
    while known.radices[end_x]:
        end_x += 1
    while known.radices[end_y]:
        end_y += 1
    return Convolution(
        known.radices[RADICES * i : end_x],
        known.radices[RADICES * j : end_y],
        known.roots[x : x + 2 * UNIT * i],
        known.roots[y : y + 2 * UNIT * j],
        known.turns[x : x + 2 * UNIT * i],
        known.turns[y : y + 2 * UNIT * j],
        known.spectra[place : place + whole_vectors(UNIT * i, lanes(known.spectra)) * UNIT * j],
    )
