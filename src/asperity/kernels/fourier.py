"""Fourier transforms of many columns at once: each vector lane holds a column of its own.

A batch is a flat array (n, 2, lanes): n values of each column, real parts, then imaginary parts. Mixed-radix
transforms that sort themselves, called Stockham's; radices 2, 3, 4 and 5.
"""

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.lanes import lanes, load, store
from asperity.kernels.options import CALLED, INNER, compiled


@lru_cache
def smooth_length(n: int) -> int:
    """Smallest length from n on that transforms fast.

    A multiple of eight without prime factors above 5: whole vectors, and few lengths to prepare.
    """
    length = max(8, -(-n // 8) * 8)
    while factors(length)[-1] > 5:
        length += 8
    return length


def factors(n: int) -> list[int]:
    """Split a length into radices, fours first; what is left of it comes last."""
    radices = []
    for radix in (4, 5, 3, 2):
        while n % radix == 0:
            radices.append(radix)
            n //= radix
    return [*radices, n] if n > 1 or not radices else radices


@lru_cache
def roots(n: int) -> NDArray:
    """Powers of the root of unity exp(−2πi/n), real and imaginary parts in turn, (2 n,)."""
    return np.exp(-2j * np.pi * np.arange(n) / n).view(np.float64)


@compiled(**INNER)
def read_parts(source: NDArray, index: int) -> Any:
    """Real and imaginary parts of the values at an index of a batch."""
    return load(source, index), load(source, index + lanes(source))


@compiled(**INNER)
def write_parts(target: NDArray, index: int, re: Any, im: Any) -> None:
    """Write real and imaginary parts to an index of a batch."""
    store(target, index, re)
    store(target, index + lanes(target), im)


@compiled(**INNER)
def _put(target: NDArray, index: int, re: Any, im: Any, w: NDArray, power: int) -> None:
    c = w[2 * power]
    s = w[2 * power + 1]
    write_parts(target, index, c * re - s * im, c * im + s * re)


@compiled(**INNER)
def _by_two(x: NDArray, y: NDArray, n: int, stride: int, w: NDArray) -> None:
    m = n // 2
    unit = len(w) // (2 * n)
    row = 2 * lanes(x)
    hop = stride * m * row
    for p in range(m):
        for q in range(stride):
            i = (q + stride * p) * row
            o = (q + stride * 2 * p) * row
            a, ai = read_parts(x, i)
            b, bi = read_parts(x, i + hop)
            write_parts(y, o, a + b, ai + bi)
            _put(y, o + stride * row, a - b, ai - bi, w, p * unit)


@compiled(**INNER)
def _by_three(x: NDArray, y: NDArray, n: int, stride: int, w: NDArray) -> None:
    m = n // 3
    unit = len(w) // (2 * n)
    row = 2 * lanes(x)
    hop = stride * m * row
    half = 0.5
    sine = 0.75**0.5
    for p in range(m):
        for q in range(stride):
            i = (q + stride * p) * row
            o = (q + stride * 3 * p) * row
            a, ai = read_parts(x, i)
            b, bi = read_parts(x, i + hop)
            c, ci = read_parts(x, i + 2 * hop)
            t, ti = b + c, bi + ci
            u, ui = a - half * t, ai - half * ti
            v, vi = sine * (bi - ci), sine * (c - b)
            write_parts(y, o, a + t, ai + ti)
            _put(y, o + stride * row, u + v, ui + vi, w, p * unit)
            _put(y, o + 2 * stride * row, u - v, ui - vi, w, 2 * p * unit)


@compiled(**INNER)
def _by_four(x: NDArray, y: NDArray, n: int, stride: int, w: NDArray) -> None:
    m = n // 4
    unit = len(w) // (2 * n)
    row = 2 * lanes(x)
    hop = stride * m * row
    for p in range(m):
        for q in range(stride):
            i = (q + stride * p) * row
            o = (q + stride * 4 * p) * row
            a, ai = read_parts(x, i)
            b, bi = read_parts(x, i + hop)
            c, ci = read_parts(x, i + 2 * hop)
            d, di = read_parts(x, i + 3 * hop)
            s = a + c
            si = ai + ci
            t = a - c
            ti = ai - ci
            u = b + d
            ui = bi + di
            v = bi - di
            vi = d - b
            write_parts(y, o, s + u, si + ui)
            _put(y, o + stride * row, t + v, ti + vi, w, p * unit)
            _put(y, o + 2 * stride * row, s - u, si - ui, w, 2 * p * unit)
            _put(y, o + 3 * stride * row, t - v, ti - vi, w, 3 * p * unit)


@compiled(**INNER)
def _by_five(x: NDArray, y: NDArray, n: int, stride: int, w: NDArray) -> None:
    m = n // 5
    unit = len(w) // (2 * n)
    row = 2 * lanes(x)
    hop = stride * m * row
    c1 = np.cos(0.4 * np.pi)
    c2 = np.cos(0.8 * np.pi)
    s1 = np.sin(0.4 * np.pi)
    s2 = np.sin(0.8 * np.pi)
    for p in range(m):
        for q in range(stride):
            i = (q + stride * p) * row
            o = (q + stride * 5 * p) * row
            a, ai = read_parts(x, i)
            b, bi = read_parts(x, i + hop)
            c, ci = read_parts(x, i + 2 * hop)
            d, di = read_parts(x, i + 3 * hop)
            e, ei = read_parts(x, i + 4 * hop)
            t = b + e
            ti = bi + ei
            u = c + d
            ui = ci + di
            v = bi - ei
            vi = e - b
            z = ci - di
            zi = d - c
            write_parts(y, o, a + t + u, ai + ti + ui)
            f, fi = a + c1 * t + c2 * u, ai + c1 * ti + c2 * ui
            g, gi = s1 * v + s2 * z, s1 * vi + s2 * zi
            _put(y, o + stride * row, f + g, fi + gi, w, p * unit)
            _put(y, o + 4 * stride * row, f - g, fi - gi, w, 4 * p * unit)
            f, fi = a + c2 * t + c1 * u, ai + c2 * ti + c1 * ui
            g, gi = s2 * v - s1 * z, s2 * vi - s1 * zi
            _put(y, o + 2 * stride * row, f + g, fi + gi, w, 2 * p * unit)
            _put(y, o + 3 * stride * row, f - g, fi - gi, w, 3 * p * unit)


@compiled(**CALLED)
def transform(x: NDArray, y: NDArray, radices: NDArray, w: NDArray) -> bool:
    """Transform every column of a batch, forward and not normalised; return whether it is in `y`.

    If not, it is in `x`; both, (2 n lanes,), are overwritten. Radices are from `factors`, `w` from `roots`.
    """
    n = len(w) // 2
    stride = np.int64(1)
    swapped = False  # a literal one would be compiled apart
    for radix in radices:
        source, target = (y, x) if swapped else (x, y)
        if radix == 4:
            _by_four(source, target, n, stride, w)
        elif radix == 2:
            _by_two(source, target, n, stride, w)
        elif radix == 3:
            _by_three(source, target, n, stride, w)
        else:
            _by_five(source, target, n, stride, w)
        n = n // radix
        stride = stride * radix
        swapped = not swapped
    return swapped
