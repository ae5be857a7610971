"""What lies along a path, compiled: splines, and waves by angle addition."""

import numpy as np

from asperity.kernels.options import CALLED, LOOP, compiled

BLOCK = 512
"""Points whose coefficients are found at once."""
OVERLAP = 24
"""Points by which blocks overlap: from point to point an end is felt by 2 − √3 less, 2e-14 over these."""


@compiled(**CALLED, nogil=True)
def spline_coefficients(values, first, end, coefficients, factor):  # type: ignore[no-untyped-def]
    """B-spline coefficients of natural cubic splines through rows (s, n) from one place to before another.

    One lies beyond each end: they fill (places + 2, s) of `coefficients`; `factor` is room. With
    c[i−1] + 4 c[i] + c[i+1] = 6 f[i], and c = f at both ends, where the curvature is zero.
    """
    m, s = end - first, values.shape[0]
    factor[0] = 0.0
    for j in range(s):
        coefficients[1, j] = values[j, first]
    for i in range(1, m - 1):
        factor[i] = 1.0 / (4.0 - factor[i - 1])
        for j in range(s):
            coefficients[i + 1, j] = (6.0 * values[j, first + i] - coefficients[i, j]) * factor[i]
    for j in range(s):
        coefficients[m, j] = values[j, end - 1]
    for i in range(m - 2, 0, -1):
        for j in range(s):
            coefficients[i + 1, j] -= factor[i] * coefficients[i + 2, j]
    for j in range(s):
        coefficients[0, j] = 2.0 * coefficients[1, j] - coefficients[2, j]
        coefficients[m + 1, j] = 2.0 * coefficients[m, j] - coefficients[m - 1, j]


@compiled(cache=True, nogil=True)
def splines_along(values, index):  # type: ignore[no-untyped-def]
    """Natural cubic splines of rows (s, m), m ≥ 2, at n places on their grid: values (n, s).

    Places count in steps of the grid from 0 to m − 1; rising or falling ones are fastest. The rows are worked
    off in blocks that stay in the processor's cache; a block overlaps its neighbours by as many points as
    make the cut at its ends felt by less than 1e-13.
    """
    s, m = values.shape
    result = np.empty((index.shape[0], s))
    first, end, origin = 0, 0, 0
    most = min(m, BLOCK + 1 + 2 * OVERLAP)
    coefficients, factor = np.empty((most + 2, s)), np.empty(most)
    for k in range(index.shape[0]):
        i = min(int(index[k]), m - 2)
        if not first <= i < end:
            if i >= first:
                first, end = i, min(i + BLOCK, m - 1)
            else:
                first, end = max(0, i + 1 - BLOCK), i + 1
            origin = max(0, first - OVERLAP)
            spline_coefficients(values, origin, min(m, end + 1 + OVERLAP), coefficients, factor)
        t = index[k] - i
        u = 1.0 - t
        w0, w3 = u * u * u / 6.0, t * t * t / 6.0
        w1, w2 = 2.0 / 3.0 - 0.5 * t * t * (1.0 + u), 2.0 / 3.0 - 0.5 * u * u * (1.0 + t)
        row = i - origin
        for j in range(s):
            result[k, j] = (
                w0 * coefficients[row, j]
                + w1 * coefficients[row + 1, j]
                + w2 * coefficients[row + 2, j]
                + w3 * coefficients[row + 3, j]
            )
    return result


STRIDE = 128
"""Places that follow from one exact value; rounding does not tell over so many."""


@compiled(**LOOP, fastmath={"contract"})
def turn_on(wave, slope, turn, shapes, slopes):  # type: ignore[no-untyped-def]
    """Sinusoidal parts of mode shapes, and their slopes, into (places, modes).

    `wave` and `slope` (blocks, modes) are exact at the first place and at every `STRIDE` places from there.
    `turn` (3, modes) is 1 − cos(k d), sin(k d)/k and k sin(k d) of the wavenumber k and the distance d of the
    places: the difference from one, small where places are close, adds less rounding than the cosine.
    """
    modes = turn.shape[1]
    for i in range(shapes.shape[0]):
        if i % STRIDE == 0:
            for j in range(modes):
                shapes[i, j], slopes[i, j] = wave[i // STRIDE, j], slope[i // STRIDE, j]
        else:
            for j in range(modes):
                a, b = shapes[i - 1, j], slopes[i - 1, j]
                shapes[i, j] = a + (turn[1, j] * b - turn[0, j] * a)
                slopes[i, j] = b - (turn[2, j] * a + turn[0, j] * b)


@compiled(**LOOP, fastmath={"contract"})
def add_near_fields(near, growth, shapes, slopes):  # type: ignore[no-untyped-def]
    """Add to mode shapes and slopes (places, modes) the exponentials beside the ends.

    `near` (2, blocks, modes) holds exact values of the parts that rise and that fall along the places, as in
    `turn_on`, and is overwritten; `growth` (3, modes) their factors from place to place, and the wavenumber.
    """
    modes = growth.shape[1]
    for i in range(shapes.shape[0]):
        block = i // STRIDE
        for j in range(modes):
            rising, falling = near[0, block, j], near[1, block, j]
            shapes[i, j] += rising + falling
            slopes[i, j] += growth[2, j] * (rising - falling)
            near[0, block, j], near[1, block, j] = rising * growth[0, j], falling * growth[1, j]
