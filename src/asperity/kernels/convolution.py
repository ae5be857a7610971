"""Free-boundary convolution with an even kernel, without padding: turned both ways, what wraps cancels."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.fourier import read_parts, roots, transform, write_parts
from asperity.kernels.lanes import lanes, load, store, transpose
from asperity.kernels.options import CALLED, INNER, compiled


class Convolution(NamedTuple):
    """A kernel on boxes of up to (mx, my) cells, ready to be convolved with."""

    radices_x: NDArray  # of the length mx
    radices_y: NDArray  # of the length my
    roots_x: NDArray  # (2 mx,), from `fourier.roots`
    roots_y: NDArray  # (2 my,), from `fourier.roots`
    turn_x: NDArray  # (2 mx,), from `quarter_turn`
    turn_y: NDArray  # (2 my,), from `quarter_turn`
    spectrum: NDArray  # (whole_vectors(mx) my,), from `spectrum`


def spectrum(table: NDArray, mx: int, my: int, lanes: int) -> NDArray:
    """Spectrum (whole_vectors(mx) my,) of an even kernel, in the order in which it is multiplied with.

    At the frequencies (k + ¼)/m, divided by 2 mx my. The kernel (≥ mx, ≥ my) is given at non-negative
    separations; mx and my are from `fourier.smooth_length`.
    """
    quarter = quarter_spectrum(quarter_spectrum(table[:mx, :my], 1), 0) / (2.0 * mx * my)
    blocks = np.zeros((-(-mx // lanes) * lanes, my))
    blocks[:mx] = quarter
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
    x, y = whole_vectors(mx, lanes), whole_vectors(my, lanes)
    return 2 * x * y + 6 * max(x, y) * lanes


@compiled(**INNER)
def _clear(buffer: NDArray, first: int, end: int) -> None:
    for i in range(first, end):
        buffer[i] = 0.0


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
    my, part = len(c.turn_y) // 2, lanes(rows)
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


@compiled(**CALLED, nogil=True)
def convolve(
    c: Convolution, field: NDArray, nx: int, ny: int, pitch: int, work: NDArray, out: NDArray
) -> None:
    """Convolve a field on a box with an even kernel, with nothing outside the box.

    Field and result lie flat (nx pitch,), row after row, the field zero in the columns from `ny` on, where
    the result has no meaning; a row is at least ``whole_vectors(ny)`` long, `work` as `workspace` says.
    """
    mx, n = len(c.turn_x) // 2, lanes(work)
    row, blocks = whole_vectors(ny, n), -(-mx // n)
    size = 2 * max(blocks * n, whole_vectors(len(c.turn_y) // 2, n)) * n
    a, b, s = work[:size], work[size : 2 * size], work[2 * size : 3 * size]
    rows, line = work[3 * size :], 2 * row * n
    for first in range(0, row, n):
        _turn_in(c, field, pitch, first, nx, a)
        x = b if transform(a, b, c.radices_x, c.roots_x) else a
        for k in range(blocks):
            for part in range(0, 2 * n, n):
                o = k * line + 2 * first * n + part
                transpose(x, 2 * k * n * n + part, 2 * n, rows, o, 2 * n)
    for k in range(blocks):
        _across(c, k, rows[k * line : (k + 1) * line], ny, a, b, s)
    for first in range(0, row, n):
        for k in range(blocks):
            for part in range(0, 2 * n, n):
                o = k * line + 2 * first * n + part
                transpose(rows, o, 2 * n, a, 2 * k * n * n + part, 2 * n)
        x = b if transform(a, b, c.radices_x, c.roots_x) else a
        _turn_out(c, x, pitch, first, nx, out)
