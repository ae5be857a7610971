"""Influence of pressure on displacement: Love's coefficients of a cell, and their convolution on boxes.

Boxes have a free boundary without padding: by a quarter turn, what wraps around becomes imaginary. Across,
small boxes are not transformed, but summed.
"""

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from asperity.kernels.fourier import factors, read_parts, roots, smooth_length, transform, write_parts
from asperity.kernels.lanes import aligned, holds_vectors, lanes, load, store, transpose, width
from asperity.kernels.options import CALLED, INNER, compiled

AT_ONCE = 2**16
"""Coefficients that are computed in one go: some ten arrays of them take memory."""


def _edge_log(x: NDArray, y: NDArray, half: float) -> NDArray:
    """ln[(y₊ + √(y₊² + x²)) / (y₋ + √(y₋² + x²))] for y ≥ 0, without cancellation far away."""
    upper = y + half
    lower = y - half
    r_upper = np.hypot(upper, x)
    r_lower = np.hypot(lower, x)
    away = np.where(lower < 0.0, r_lower - lower, 1.0)
    denominator = np.where(lower < 0.0, x * x / away, lower + r_lower)
    step = 2.0 * half * (1.0 + 2.0 * y / (r_upper + r_lower))
    return np.log1p(step / denominator)


def cell_displacement(x: NDArray, y: NDArray, dx: float, dy: float) -> NDArray:
    """Surface displacement at (x, y), times π E*, under unit pressure on the cell dx × dy at the origin.

    All in m; to be divided by π E*, Pa. A. E. H. Love, Phil. Trans. R. Soc. A 228 (1929) 377; finite
    everywhere.
    """
    x = np.abs(x)
    y = np.abs(y)
    hx, hy = 0.5 * dx, 0.5 * dy
    return (
        (x + hx) * _edge_log(x + hx, y, hy)
        - (x - hx) * _edge_log(x - hx, y, hy)
        + (y + hy) * _edge_log(y + hy, x, hx)
        - (y - hy) * _edge_log(y - hy, x, hx)
    )


def influence_table(nx: int, ny: int, dx: float, dy: float) -> NDArray:
    """Influence coefficients (nx, ny), m, times π E*: entry (i, j) for the separation (i dx, j dy), m."""
    x = dx * np.arange(nx, dtype=np.float64)
    y = dy * np.arange(ny, dtype=np.float64)
    table = np.empty((nx, ny))
    rows = max(1, AT_ONCE // ny)
    for first in range(0, nx, rows):
        table[first : first + rows] = cell_displacement(x[first : first + rows, None], y, dx, dy)
    return table


ALIAS = 0.75 * 1.2020569031595942 / np.pi**3
"""Influence of cells on waves of length λ beyond 2/|k|, per (side of a cell)³ k²: 3 ζ(3)/(4 π³)."""


def means_table(nx: int, ny: int, dx: float, dy: float) -> NDArray:
    """Influence as in `influence_table`, of the mean pressure of a cell on the mean displacement of another.

    Of waves that are long against the cells, to the fourth order: a wave of pressure p̂ displaces by
    2 p̂/(E* |k|). Love's coefficients answer at the centre to a pressure that is constant on cells, which
    takes k²h²/12 off, and what waves have in common with others on the grid adds ALIAS h³k².
    """
    table = influence_table(nx + 1, ny + 1, dx, dy)
    whole = np.pad(table, ((1, 0), (1, 0)), mode="reflect")  # even in both separations
    middle = whole[1:-1, 1:-1]
    along = whole[2:, 1:-1] + whole[:-2, 1:-1]
    across = whole[1:-1, 2:] + whole[1:-1, :-2]
    means = middle - (along + across - 4.0 * middle) / 24.0
    means[0, 0] -= 2.0 * np.pi * ALIAS * (dx + dy)
    means[1, 0] += np.pi * ALIAS * dx
    means[0, 1] += np.pi * ALIAS * dy
    return means


class Convolution(NamedTuple):
    """A kernel on boxes of up to (mx, my) cells, ready to be convolved with."""

    radices_x: NDArray  # of the length mx
    radices_y: NDArray  # of the length my; none where it is not transformed, but summed
    roots_x: NDArray  # (2 mx,), from `fourier.roots`
    roots_y: NDArray  # (2 my,), from `fourier.roots`
    turn_x: NDArray  # (2 mx,), from `quarter_turn`
    turn_y: NDArray  # (2 my,), from `quarter_turn`
    spectrum: NDArray  # (whole_vectors(mx) my,), from `spectrum`


def spectrum(table: NDArray, mx: int, my: int, lanes: int, *, summed: bool) -> NDArray:
    """Spectrum (whole_vectors(mx) my,) of an even kernel, in the order in which it is multiplied with.

    At the frequencies (k + ¼)/m, divided by 2 mx my; along alone and divided by 2 mx where it is summed
    across. The kernel (≥ mx, ≥ my) is given at non-negative separations; mx and my are from
    `fourier.smooth_length`.
    """
    along = quarter_spectrum(table[:mx, :my], 0) / (2.0 * mx)
    blocks = np.zeros((-(-mx // lanes) * lanes, my))
    blocks[:mx] = along if summed else quarter_spectrum(along, 1) / my
    return blocks.reshape(-1, lanes, my).transpose(0, 2, 1).ravel()


@lru_cache
def quarter_turn(m: int) -> NDArray:
    """Factors exp(−iπj/2m) that turn a record by a right angle from one end to the other: (2 m,).

    Real and imaginary parts in turn.
    """
    return np.ascontiguousarray(roots(4 * m)[: 2 * m])


def quarter_spectrum(table: NDArray, axis: int) -> NDArray:
    """Spectrum of an even kernel along an axis, at the frequencies (k + ¼)/m; it is real.

    The kernel is given at its m non-negative separations.
    """
    turn = quarter_turn(table.shape[axis]).view(np.complex128)
    turned = table * (turn if axis else turn[:, None])
    return 2.0 * np.fft.fft(turned, axis=axis).real - table.take([0], axis)


@compiled(**INNER)
def whole_vectors(n: int, lanes: int) -> int:
    """Smallest number of whole vectors, in cells, that hold n cells."""
    return -(-n // lanes) * lanes


@compiled(**INNER)
def workspace(mx: int, my: int, lanes: int) -> int:
    """Room, in numbers, that a convolution needs whose largest box has mx × my cells."""
    x = whole_vectors(mx, lanes)
    y = whole_vectors(my, lanes)
    return 2 * x * y + 6 * max(x, y) * lanes


@compiled(**INNER)
def _clear(buffer: NDArray, first: int, end: int) -> None:
    buffer[first:end] = 0.0


@compiled(**INNER)
def _turn_in(c: Convolution, field: NDArray, pitch: int, first: int, nx: int, buffer: NDArray) -> None:
    """Turn a block of real columns into the buffer, zero behind the box."""
    part = lanes(buffer)
    for i in range(nx):
        re = load(field, i * pitch + first)
        write_parts(buffer, 2 * i * part, c.turn_x[2 * i] * re, c.turn_x[2 * i + 1] * re)
    _clear(buffer, 2 * nx * part, len(c.turn_x) * part)


@compiled(**INNER)
def _turn_out(c: Convolution, buffer: NDArray, pitch: int, first: int, nx: int, out: NDArray) -> None:
    """Turn a block back and keep its real part."""
    part = lanes(buffer)
    for i in range(nx):
        re, im = read_parts(buffer, 2 * i * part)
        store(out, i * pitch + first, c.turn_x[2 * i] * re - c.turn_x[2 * i + 1] * im)


@compiled(**INNER)
def _turned(source: NDArray, index: int, cosine: Any, sine: Any) -> Any:
    re, im = read_parts(source, index)
    return cosine * re - sine * im, cosine * im + sine * re


@compiled(**INNER)
def _across(c: Convolution, block: int, rows: NDArray, ny: int, a: NDArray, b: NDArray, s: NDArray) -> None:
    """Convolve across in both senses of turning; the conjugate of the sum replaces the rows."""
    my = len(c.turn_y) // 2
    part = lanes(rows)
    for sense in range(2):
        sign = 1.0 - 2.0 * sense
        for j in range(ny):
            o = 2 * j * part
            re, im = _turned(rows, o, c.turn_y[2 * j], sign * c.turn_y[2 * j + 1])
            write_parts(a, o, re, im)
        _clear(a, 2 * ny * part, 2 * my * part)
        swapped = transform(a, b, c.radices_y, c.roots_y)
        x, y = (b, a) if swapped else (a, b)
        for k in range(my):
            factor = load(c.spectrum, (block * my + (k if sense == 0 or k == 0 else my - k)) * part)
            re, im = read_parts(x, 2 * k * part)
            write_parts(x, 2 * k * part, factor * re, -1.0 * (factor * im))
        if transform(x, y, c.radices_y, c.roots_y):
            x = y
        for j in range(ny):
            o = 2 * j * part
            re, im = _turned(x, o, c.turn_y[2 * j], sign * c.turn_y[2 * j + 1])
            if sense == 0:
                write_parts(s, o, re, im)
            else:
                first, second = read_parts(s, o)
                write_parts(rows, o, re + first, im + second)


@compiled(**INNER)
def _read_half(halves: NDArray, k: int) -> Any:
    """Sum, real and imaginary, of the values that lie as far on either side of the middle, and difference."""
    part = lanes(halves)
    return *read_parts(halves, 4 * k * part), *read_parts(halves, (4 * k + 2) * part)


@compiled(**INNER)
def _write_halves(rows: NDArray, half: int, halves: NDArray) -> None:
    """Write what `_read_half` reads."""
    part = lanes(rows)
    for j in range(half):
        re, im = read_parts(rows, 2 * j * part)
        other_re, other_im = read_parts(rows, 2 * (2 * half - 1 - j) * part)
        write_parts(halves, 4 * j * part, re + other_re, im + other_im)
        write_parts(halves, (4 * j + 2) * part, re - other_re, im - other_im)


@compiled(**INNER)
def _add(total: Any, c: Convolution, first: int, near: int, far: int, half: Any) -> Any:
    """Add what cells on either side of the middle displace, of which the one is near and the other far."""
    part = lanes(c.spectrum)
    by_near = load(c.spectrum, first + abs(near) * part)
    by_far = load(c.spectrum, first + abs(far) * part)
    even, odd = by_near + by_far, by_near - by_far
    return (
        total[0] + even * half[0],
        total[1] + even * half[1],
        total[2] + odd * half[2],
        total[3] + odd * half[3],
    )


@compiled(**INNER)
def _unite(rows: NDArray, j: int, half: int, total: Any) -> None:
    """Write conjugate results on either side of the middle, unless j lies beyond it."""
    part = lanes(rows)
    re, im, odd_re, odd_im = total
    if j < half:
        write_parts(rows, 2 * j * part, re + odd_re, -1.0 * (im + odd_im))
        write_parts(rows, 2 * (2 * half - 1 - j) * part, re - odd_re, odd_im - im)


@compiled(**CALLED)
def _sum_across(c: Convolution, block: int, rows: NDArray, ny: int, halves: NDArray) -> None:
    """Convolve across as a sum of products; the conjugate of the result replaces the rows.

    With an even kernel a field that is even about the middle stays so, and an odd one, too: each has half as
    many cells. Four results at a time share what is read.
    """
    part = lanes(rows)
    half = (ny + 1) // 2
    last = 2 * half - 1
    first = block * (len(c.turn_y) // 2) * part
    _write_halves(rows, half, halves)
    zero = 0.0 * load(halves, 0)
    for j in range(0, half, 4):
        w = x = y = z = zero, zero, zero, zero
        for k in range(half):
            each = _read_half(halves, k)
            w = _add(w, c, first, j - k, last - j - k, each)
            x = _add(x, c, first, j + 1 - k, last - j - 1 - k, each)
            y = _add(y, c, first, j + 2 - k, last - j - 2 - k, each)
            z = _add(z, c, first, j + 3 - k, last - j - 3 - k, each)
        _unite(rows, j, half, w)
        _unite(rows, j + 1, half, x)
        _unite(rows, j + 2, half, y)
        _unite(rows, j + 3, half, z)


@compiled(**CALLED, nogil=True)
def convolve(
    c: Convolution, field: NDArray, nx: int, ny: int, pitch: int, work: NDArray, out: NDArray
) -> None:
    """Convolve a field on a box with an even kernel, with nothing outside the box.

    Field and result lie flat (nx pitch,), row after row, the field zero in the columns from `ny` on, where
    the result has no meaning; a row is at least ``whole_vectors(ny)`` long, `work` as `workspace` says.
    """
    mx = len(c.turn_x) // 2
    n = lanes(work)
    row = whole_vectors(ny, n)
    blocks = -(-mx // n)
    size = 2 * max(blocks * n, whole_vectors(len(c.turn_y) // 2, n)) * n
    a = work[:size]
    b = work[size : 2 * size]
    s = work[2 * size : 3 * size]
    rows = work[3 * size :]
    line = 2 * row * n
    for first in range(0, row, n):
        _turn_in(c, field, pitch, first, nx, a)
        x = b if transform(a, b, c.radices_x, c.roots_x) else a
        for k in range(blocks):
            for part in range(0, 2 * n, n):
                o = k * line + 2 * first * n + part
                transpose(x, 2 * k * n * n + part, 2 * n, rows, o, 2 * n)
    for k in range(blocks):
        across = rows[k * line : (k + 1) * line]
        if len(c.radices_y):
            _across(c, k, across, ny, a, b, s)
        else:
            _sum_across(c, k, across, ny, a)
    for first in range(0, row, n):
        for k in range(blocks):
            for part in range(0, 2 * n, n):
                o = k * line + 2 * first * n + part
                transpose(rows, o, 2 * n, a, 2 * k * n * n + part, 2 * n)
        x = b if transform(a, b, c.radices_x, c.roots_x) else a
        _turn_out(c, x, pitch, first, nx, out)


UNIT = 8
"""Boxes are convolved in multiples of this length."""
RADICES = 16
"""Room for the radices of a length: no length that fits into memory has as many."""
SUMMED_WIDE, SUMMED = 96, 24
"""Cells across up to which sums of products take less time than transforms.

Sixteen vectors are summed at a time: that pays less where registers do not hold a whole one.
"""


class Influence(NamedTuple):
    """Influence of pressure on displacement, with the convolutions prepared so far."""

    table: NDArray  # (≥ nx, ≥ ny), displacement per pressure at non-negative separations, m/Pa
    softest: float  # no pressure of unit norm displaces by more, m/Pa
    taps: NDArray  # (6,), preconditioner, from `projected_cg.inverse_stencil`, Pa/m
    summed: int  # cells across up to which convolutions are summed there, not transformed
    lengths: NDArray  # (k,), length in which n cells are convolved, at ⌈n / UNIT⌉
    radices: NDArray  # (RADICES k,), radices of the length UNIT i from RADICES i on, then zeros
    starts: NDArray  # (k,), where the roots and turns of the length UNIT i begin
    roots: NDArray  # from `fourier.roots`, length after length
    turns: NDArray  # from `quarter_turn`, length after length
    # (k, k), where the spectrum on UNIT i × UNIT j cells begins; −1 if it is not prepared
    places: NDArray
    spectra: NDArray  # from `spectrum`, one after the other


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
    summed = SUMMED_WIDE if holds_vectors() else SUMMED
    return Influence(
        table, softest, taps, summed, lengths, radices.ravel(), starts, known_roots, turns, places, spectra
    )


def prepared(known: Influence, nx: int, ny: int) -> Influence:
    """Add the convolution on a box of nx × ny cells, unless it is there."""
    mx, my = (int(known.lengths[-(-n // UNIT)]) for n in (nx, ny))
    if known.places[mx // UNIT, my // UNIT] >= 0:
        return known
    places = known.places.copy()
    places[mx // UNIT, my // UNIT] = len(known.spectra)
    dtype = known.spectra.dtype
    added = spectrum(known.table, mx, my, width(dtype), summed=my <= known.summed)
    spectra = aligned(len(known.spectra) + len(added), dtype)
    np.concatenate([known.spectra, added], out=spectra, casting="same_kind")
    return known._replace(places=places, spectra=spectra)


@compiled(**INNER)
def is_prepared(known: Influence, nx: int, ny: int) -> bool:
    """Whether the convolution on a box of nx × ny cells is there."""
    mx, my = known.lengths[-(-nx // UNIT)], known.lengths[-(-ny // UNIT)]
    return known.places[mx // UNIT, my // UNIT] >= 0


@compiled(**CALLED)
def convolution(known: Influence, nx: int, ny: int) -> Convolution:
    """Convolution on a box of nx × ny cells, which is prepared."""
    i, j = known.lengths[-(-nx // UNIT)] // UNIT, known.lengths[-(-ny // UNIT)] // UNIT
    x = known.starts[i]
    y = known.starts[j]
    place = known.places[i, j]
    end_x, end_y = RADICES * i, RADICES * j
    while known.radices[end_x]:
        end_x += 1
    while UNIT * j > known.summed and known.radices[end_y]:
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
