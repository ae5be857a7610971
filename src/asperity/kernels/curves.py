"""Curves, compiled: splines and waves along a path, and piecewise cubics that keep their shape."""

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.options import CALLED, INNER, LOOP, UNCHECKED, compiled

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
    m = end - first
    s = values.shape[0]
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
    first = 0
    end = 0
    origin = 0
    most = min(m, BLOCK + 1 + 2 * OVERLAP)
    coefficients = np.empty((most + 2, s))
    factor = np.empty(most)
    for k in range(index.shape[0]):
        i = min(int(index[k]), m - 2)
        if not first <= i < end:
            if i >= first:
                first = i
                end = min(i + BLOCK, m - 1)
            else:
                first = max(0, i + 1 - BLOCK)
                end = i + 1
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


@compiled(**LOOP)
def write_seen(values, signs, rates, added, contact, first, seen):  # type: ignore[no-untyped-def]
    """Write what a contact sees of modes (places, modes) from a first one on into all (places, n, s), or add.

    Times signs of the modes (modes,) and rates at the places, or one for all (1,).
    """
    last = rates.shape[0] - 1
    for i in range(values.shape[0]):
        rate = rates[min(i, last)]
        for j in range(values.shape[1]):
            before = seen[i, contact, first + j] if added else 0.0
            seen[i, contact, first + j] = before + signs[j] * rate * values[i, j]


# --- piecewise cubics


@compiled(**LOOP, fastmath={"contract"})
def evaluate_pieces(coefficients, breaks, places, values, slopes):  # type: ignore[no-untyped-def]
    """Values and slopes (places, columns) of polynomials by Horner's rule.

    `coefficients` (pieces, degree + 1, columns), highest power of the distance from `breaks` (pieces + 1,)
    first. The piece is looked for from that of the place before.
    """
    pieces, powers, columns = coefficients.shape
    piece = 0
    for i in range(places.shape[0]):
        x = places[i]
        while piece + 1 < pieces and x >= breaks[piece + 1]:
            piece += 1
        while piece > 0 and x < breaks[piece]:
            piece -= 1
        t = x - breaks[piece]
        for j in range(columns):
            values[i, j] = coefficients[piece, 0, j]
            slopes[i, j] = 0.0
        for p in range(1, powers):
            for j in range(columns):
                slopes[i, j] = slopes[i, j] * t + values[i, j]
                values[i, j] = values[i, j] * t + coefficients[piece, p, j]


@compiled(**INNER)
def _end_slope(outer, inner, secant, inner_secant):  # type: ignore[no-untyped-def]
    """Slope at an end by the three-point formula, held between half and twice the end secant."""
    estimate = ((2.0 * outer + inner) * secant - outer * inner_secant) / (outer + inner)
    return np.minimum(np.maximum(estimate, 0.5 * secant), 2.0 * secant)


@compiled(**INNER)
def slopes_of_row(knots, row, slopes):  # type: ignore[no-untyped-def]
    """Write the slopes of `monotone_slopes` at the knots (k,) of a row (k,)."""
    last = len(knots) - 1
    width = knots[1] - knots[0]
    secant = (row[1] - row[0]) / width
    slopes[0] = slopes[last] = secant
    for j in range(1, last):
        wide = knots[j + 1] - knots[j]
        steep = (row[j + 1] - row[j]) / wide
        if j == 1:
            slopes[0] = _end_slope(width, wide, secant, steep)
        if j == last - 1:
            slopes[last] = _end_slope(wide, width, steep, secant)
        slopes[j] = 0.0
        if secant * steep > 0.0:
            before = width + 2.0 * wide
            behind = 2.0 * width + wide
            slopes[j] = (before + behind) / (before / secant + behind / steep)
        width = wide
        secant = steep


@compiled(**LOOP, **UNCHECKED)
def write_slopes(knots, rows, slopes):  # type: ignore[no-untyped-def]
    """Write the slopes of `monotone_slopes` of rows (n, k)."""
    for i in range(rows.shape[0]):
        slopes_of_row(knots, rows[i], slopes[i])


@compiled(**LOOP, **UNCHECKED)
def lay_roots(states, touches, margins, root, slopes):  # type: ignore[no-untyped-def]
    """Lay out rows (n, s) of g = F^(2/3) in states (s,), and their slopes, from first touches (n,) on.

    Before the touch, and by margins (s,) after it, g is replaced by the line through the touch and the first
    state that lies beyond.
    """
    count = len(states)
    for i in range(root.shape[0]):
        row = root[i]
        touch = touches[i]
        rise = 0.0
        for j in range(count - 1, -1, -1):
            if states[j] - touch > margins[j]:
                rise = row[j] / (states[j] - touch)
        for j in range(count):
            if not states[j] - touch > margins[j]:
                row[j] = rise * (states[j] - touch)
        slopes_of_row(states, row, slopes[i])


def monotone_slopes(knots: NDArray, values: NDArray) -> NDArray:
    """Slopes at the knots (k,), k ≥ 2, that keep piecewise cubics through rows (..., k) monotone.

    The rows do not fall. Inside: the weighted harmonic mean of the neighbouring secants (Fritsch and Butland,
    SIAM J. Sci. Stat. Comput. 5 (1984) 300-304, with the weights of Brodlie). At both ends: the three-point
    formula, held between half and twice the end secant, so that a continuation beyond the ends goes on
    rising.
    """
    rows = np.ascontiguousarray(values, dtype=float)
    slopes = np.empty_like(rows)
    count = len(knots)
    write_slopes(np.ascontiguousarray(knots, dtype=float), rows.reshape(-1, count), slopes.reshape(-1, count))
    return slopes


def shape_preserving(knots: NDArray, values: NDArray, places: NDArray) -> NDArray:
    """Rows (..., k), k ≥ 3, of any shape at places (n,) within their knots (k,), by cubic pieces: (..., n).

    They rise and fall where the rows do, and turn only at knots. Slopes as in `monotone_slopes`, but for the
    ends: there the three-point formula has to agree with the end secant in sign, and is held within thrice it
    where the rows turn (C. Moler, Numerical Computing with MATLAB (2004), Sec. 3.6).
    """
    width = np.diff(knots)
    secant = np.diff(values, axis=-1) / width
    slopes = monotone_slopes(knots, values)
    slopes[..., 0] = _turning_end_slope(width[0], width[1], secant[..., 0], secant[..., 1])
    slopes[..., -1] = _turning_end_slope(width[-1], width[-2], secant[..., -1], secant[..., -2])
    piece = np.clip(np.searchsorted(knots, places, side="right") - 1, 0, len(knots) - 2)
    s = places - knots[piece]
    h = width[piece]
    start = slopes[..., piece] - secant[..., piece]
    end = slopes[..., piece + 1] - secant[..., piece]
    rest = start - (2.0 * start + end) * (s / h) + (start + end) * (s / h) ** 2
    return values[..., piece] + s * (secant[..., piece] + rest)


def continued_to_touch(knots: NDArray, root: NDArray) -> NDArray:
    """Replace the zeros before first touch in rows (n, k) of g = F^(2/3) by the continuation of what follows.

    With this root of the force, contact starts on a straight line (exactly so for Hertz). Where that line is
    flatter than the one to the last sample without contact, the latter is taken; so every zero becomes a
    value of zero or less, and first touch lies where g crosses zero.
    """
    rows = np.arange(len(root))
    first = np.argmax(root > 0.0, axis=1)
    before = first - 1
    after = first + 1
    second = first + 2
    last = len(knots) - 1

    def secant(low: NDArray, high: NDArray) -> NDArray:
        low = np.clip(low, 0, last)
        high = np.clip(high, 0, last)
        width = np.where(high > low, knots[high] - knots[low], 1.0)
        return (root[rows, high] - root[rows, low]) / width

    steepness = secant(first, after)
    outer = knots[np.minimum(after, last)] - knots[first]
    inner = knots[np.minimum(second, last)] - knots[np.minimum(after, last)]
    # where there is no interval behind, the straight line is taken: only the division must not fail
    curved = _end_slope.py_func(outer, np.maximum(inner, 1e-300), steepness, secant(after, second))
    slope = np.maximum(np.where(second <= last, curved, steepness), secant(before, first))
    line = root[rows, first][:, None] + slope[:, None] * (knots - knots[first][:, None])
    return np.where(np.arange(len(knots)) < first[:, None], np.minimum(line, root), root)


def cubic_coefficients(knots: NDArray, values: NDArray, slopes: NDArray) -> NDArray:
    """Coefficients (k − 1, 4) of (s − knot)³, ², ¹, ⁰ of the cubics with values and slopes at k knots."""
    width = np.diff(knots)
    secant = np.diff(values) / width
    # what a straight line leaves; exactly zero when values and slopes lie on one
    start = slopes[:-1] - secant
    end = slopes[1:] - secant
    cubic = (start + end) / width**2
    square = -(2.0 * start + end) / width
    return np.stack([cubic, square, slopes[:-1], values[:-1]], axis=1)


def _turning_end_slope(outer: NDArray, inner: NDArray, secant: NDArray, inner_secant: NDArray) -> NDArray:
    estimate = ((2.0 * outer + inner) * secant - outer * inner_secant) / (outer + inner)
    turns = (np.sign(secant) != np.sign(inner_secant)) & (np.abs(estimate) > 3.0 * np.abs(secant))
    return np.where(np.sign(estimate) != np.sign(secant), 0.0, np.where(turns, 3.0 * secant, estimate))
