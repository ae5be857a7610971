"""Tractions under Coulomb's law: influence of tangential loads, its convolution, and Newton's iteration.

A traction is a vector in the plane of the surface. Taken as a complex number, x + iy, it displaces by
``u = α * p + β * conj(p)``: one transform there and one back for both directions.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.box import REACH
from asperity.kernels.fourier import factors, roots, smooth_length, transform
from asperity.kernels.influence import _clear, _edge_log, whole_vectors
from asperity.kernels.lanes import lanes, transpose, width
from asperity.kernels.options import CALLED, INNER, LOOP, REASSOCIATE, compiled


def _weighted_log(x: NDArray, y: NDArray, half: float) -> NDArray:
    """x ln[(y₊ + √(y₊² + x²)) / (y₋ + √(y₋² + x²))], zero at x = 0."""
    nothing = x == 0.0
    return np.where(nothing, 0.0, x * _edge_log(np.where(nothing, 1.0, x), np.abs(y), half))


def traction_displacement(
    x: NDArray, y: NDArray, dx: float, dy: float, poisson: float
) -> tuple[NDArray, NDArray, NDArray]:
    """Displacements at (x, y), times π G, under unit traction on the cell dx × dy at the origin.

    Of both bodies against each other, along x by a traction along x, along y by one along y, and along the
    one by the other. V. Cerruti's solution as in K. L. Johnson, Contact Mechanics (1985), 3.6, integrated
    over the cell.
    """
    hx, hy = 0.5 * dx, 0.5 * dy
    across = _weighted_log(x + hx, y, hy) - _weighted_log(x - hx, y, hy)
    along = _weighted_log(y + hy, x, hx) - _weighted_log(y - hy, x, hx)
    far = np.hypot(x + hx, y + hy) - np.hypot(x + hx, y - hy)
    near = np.hypot(x - hx, y + hy) - np.hypot(x - hx, y - hy)
    return (1.0 - poisson) * across + along, (1.0 - poisson) * along + across, -poisson * (far - near)


def pressure_displacement(x: NDArray, y: NDArray, dx: float, dy: float) -> NDArray:
    """Displacement x + iy of two unlike bodies, times −π G/K, at (x, y) under unit pressure on a cell.

    ∫∫ (x, y)/ρ², in which K/G = ¼ ((1 − 2ν₁)/G₁ − (1 − 2ν₂)/G₂).
    """
    total: NDArray = np.zeros(np.broadcast_shapes(x.shape, y.shape), dtype=complex)
    for sign_x in (1.0, -1.0):
        for sign_y in (1.0, -1.0):
            u, v = x + sign_x * 0.5 * dx, y + sign_y * 0.5 * dy
            log = 0.5 * np.log(np.maximum(u * u + v * v, np.finfo(float).tiny))
            angle_x, angle_y = (np.arctan(a / np.where(b == 0.0, np.inf, b)) for a, b in ((v, u), (u, v)))
            total += sign_x * sign_y * (v * log + u * angle_x + 1j * (u * log + v * angle_y))
    return total


class TractionConvolution(NamedTuple):
    """Influence of tractions on a box, ready to be convolved with."""

    radices_x: NDArray
    radices_y: NDArray
    roots_x: NDArray  # (2 mx,), from `fourier.roots`
    roots_y: NDArray  # (2 my,)
    spectra: NDArray  # (4, mx my): α and β, real and imaginary parts, divided by mx my; m/Pa


def traction_convolution(same: NDArray, mixed: NDArray) -> TractionConvolution:
    """Prepare the kernels α and β, (2 nx − 1, 2 ny − 1) with the origin in the middle, for nx × ny cells."""
    spectra = []
    for kernel in (same, mixed):
        sides = [(smooth_length(n), n // 2) for n in kernel.shape]
        (mx, back_x), (my, back_y) = sides
        padded = np.zeros((mx, my), dtype=complex)
        padded[: kernel.shape[0], : kernel.shape[1]] = kernel
        spectrum = np.fft.fft2(np.roll(padded, (-back_x, -back_y), (0, 1))).ravel() / (mx * my)
        spectra += [spectrum.real, spectrum.imag]
    return TractionConvolution(
        np.array(factors(mx)), np.array(factors(my)), roots(mx), roots(my), np.array(spectra)
    )


@compiled(**CALLED)
def _transform_rows(c: TractionConvolution, rows: NDArray, spare: NDArray, wide: int) -> None:
    """Transform each block of rows, which end behind `wide` columns."""
    my, n = len(c.roots_y) // 2, lanes(rows)
    line = 2 * my * n
    for k in range(len(c.roots_x) // 2 // n):
        row = rows[k * line : (k + 1) * line]
        _clear(row, 2 * wide * n, line)
        if transform(row, spare, c.radices_y, c.roots_y):
            for q in range(line):
                row[q] = spare[q]


@compiled(**CALLED)
def _multiply(c: TractionConvolution, rows: NDArray) -> None:
    """Replace the spectrum f by the conjugate of α f + β conj(f(−k))."""
    mx, my, n = len(c.roots_x) // 2, len(c.roots_y) // 2, lanes(rows)
    ar, ai, br, bi = c.spectra[0], c.spectra[1], c.spectra[2], c.spectra[3]
    for i in range(mx // 2 + 1):
        opposite_i = mx - i if i else 0
        own, other = (i // n) * 2 * my * n + i % n, (opposite_i // n) * 2 * my * n + opposite_i % n
        for j in range(my if i != opposite_i else my // 2 + 1):
            opposite_j = my - j if j else 0
            p, q = own + 2 * j * n, other + 2 * opposite_j * n
            fr, fi, gr, gi = rows[p], rows[p + n], rows[q], rows[q + n]
            s, t = i * my + j, opposite_i * my + opposite_j
            rows[p] = ar[s] * fr - ai[s] * fi + br[s] * gr + bi[s] * gi
            rows[p + n] = br[s] * gi - bi[s] * gr - ar[s] * fi - ai[s] * fr
            rows[q] = ar[t] * gr - ai[t] * gi + br[t] * fr + bi[t] * fi
            rows[q + n] = br[t] * fi - bi[t] * fr - ar[t] * gi - ai[t] * gr


@compiled(**LOOP, nogil=True)
def convolve_traction(
    c: TractionConvolution, field: NDArray, nx: int, ny: int, pitch: int, work: NDArray, out: NDArray
) -> None:
    """Convolve a complex field (nx pitch,) on a box; zero, and without meaning, in idle columns."""
    mx, my, n = len(c.roots_x) // 2, len(c.roots_y) // 2, lanes(work)
    size, line, wide = 2 * max(mx, my) * n, 2 * my * n, whole_vectors(ny, n)
    a, b, rows = work[:size], work[size : 2 * size], work[2 * size :]
    for first in range(0, wide, n):
        for i in range(nx):
            for j in range(n):
                value = field[i * pitch + first + j]
                a[2 * i * n + j], a[(2 * i + 1) * n + j] = value.real, value.imag
        _clear(a, 2 * nx * n, 2 * mx * n)
        x = b if transform(a, b, c.radices_x, c.roots_x) else a
        for k in range(mx // n):
            for part in range(0, 2 * n, n):
                transpose(x, 2 * k * n * n + part, 2 * n, rows, k * line + 2 * first * n + part, 2 * n)
    _transform_rows(c, rows, a, wide)
    _multiply(c, rows)
    _transform_rows(c, rows, a, my)
    for first in range(0, wide, n):
        for k in range(mx // n):
            for part in range(0, 2 * n, n):
                transpose(rows, k * line + 2 * first * n + part, 2 * n, a, 2 * k * n * n + part, 2 * n)
        x = b if transform(a, b, c.radices_x, c.roots_x) else a
        for i in range(nx):
            for j in range(n):
                out[i * pitch + first + j] = complex(x[2 * i * n + j], -x[(2 * i + 1) * n + j])


INNER_ITERATIONS, FORCING = 40, 0.1
"""Of a linear solution, at most; by how much it reduces the residual."""
EDGE = 1.0 - 1e-12
"""Share of the bound from which on a traction counts as on the edge."""
RETREAT, LEAST, ROUNDING = 4.0, 1e-2, 1e-12
"""Factor of the damping where a step would raise the energy, by more than this share, and the least then."""


class TractionBox(NamedTuple):
    """Fields of a solution on a box of nx rows of `pitch` cells, the idle ones without friction."""

    nx: int
    ny: int
    pitch: int
    bound: NDArray  # (size,), largest traction, Pa
    slope: NDArray  # (size,), slip over traction where that turns, and the damping, m/Pa
    kept: NDArray  # (size,), ``kept v + mirrored conj(v)`` is the part of v that is free to change
    weight: NDArray  # (size,), root of a cell's own flexibility over that with the slope
    mirrored: NDArray  # (size,), and all from here on complex
    rigid: NDArray  # (size,), slip without traction, m
    traction: NDArray  # (size,), Pa
    slip: NDArray  # (size,), m
    trial: NDArray  # (size,), traction that is tried, Pa
    response: NDArray  # (size,), its slip; of a direction what that displaces, m
    normal: NDArray  # (size,), direction of the traction in slipping cells, else zero
    residual: NDArray  # (size,), of the linear problem, m
    change: NDArray  # (size,), its solution, Pa
    carried: NDArray  # (size and REACH rows on both sides,)
    steps: NDArray  # (directions, size), Pa
    responses: NDArray  # (directions, size), m
    work: NDArray


def traction_box(nx: int, ny: int, c: TractionConvolution, directions: int = 2) -> TractionBox:
    """Make a box without friction and traction; a direction of search is made orthogonal to the others."""
    n = width(np.float64)
    pitch = max(whole_vectors(ny, n), ny + REACH)
    size = nx * pitch
    work = np.zeros(2 * c.spectra.shape[1] + 2 * n * max(len(c.roots_x), len(c.roots_y)))
    real, vectors = np.zeros((4, size)), np.zeros((9, size), complex)
    carried, searched = np.zeros(size + 2 * REACH * pitch, complex), np.zeros((2, directions, size), complex)
    return TractionBox._make((nx, ny, pitch, *real, *vectors, carried, *searched, work))


class TractionTask(NamedTuple):
    """What is asked of a solution, and what is known of its operator."""

    diagonal: float  # displacement of a cell by its own traction, m/Pa
    carried: float  # share of a row's slip that comes from the row ahead: below one, zero without rolling
    symmetric: bool  # whether there is an energy
    rtol: float  # largest slip that is against Coulomb's law, over the largest without traction
    max_iterations: int


@compiled(**INNER, **REASSOCIATE)
def _product(left: NDArray, right: NDArray) -> float:
    p, q, total = left.view(np.float64), right.view(np.float64), 0.0  # parts in turn, for vectors
    for i in range(len(p)):
        total += p[i] * q[i]
    return total


@compiled(**INNER, **REASSOCIATE)
def _add(target: NDArray, factor: float, field: NDArray) -> None:
    p, q = target.view(np.float64), field.view(np.float64)
    for i in range(len(p)):
        p[i] += factor * q[i]


@compiled(**INNER, **REASSOCIATE)
def _square(value: complex) -> float:
    return value.real**2 + value.imag**2  # abs() takes care of overflow, and time


@compiled(**INNER, **REASSOCIATE)
def _within(value: complex, bound: float) -> complex:
    square = _square(value)
    return value * (bound / np.sqrt(square)) if square > bound**2 else value


@compiled(**INNER, **REASSOCIATE)
def _free(b: TractionBox, q: int, value: complex) -> complex:
    """Part of a vector that may change in a cell: all where it sticks, along the edge where it slips."""
    return b.kept[q] * value + b.mirrored[q] * value.conjugate()


@compiled(**CALLED, **REASSOCIATE)
def _judge(b: TractionBox) -> tuple[float, float]:
    """Tell cells that stick from those that slip; return the largest slip against the law and the norm, m.

    A cell slips on the edge of its disc if the slip would take it out. All else should be without slip.
    """
    worst, total = 0.0, 0.0
    for q in range(len(b.bound)):
        g, p, s, n, missed = b.bound[q], b.traction[q], b.slip[q], 0.0j, 0.0
        b.kept[q] = 0.0
        if g > 0.0:
            square, b.kept[q] = _square(p), 1.0
            n = p / np.sqrt(square) if square > (EDGE * g) ** 2 else n
            along = (s * n.conjugate()).real
            if along < 0.0:
                b.kept[q] = 0.5
                s -= along * n
            else:
                n = 0.0j
            missed = _square(s)
        b.normal[q], b.mirrored[q] = n, -0.5 * n * n
        worst, total = max(worst, missed), total + missed
    return np.sqrt(worst), np.sqrt(total)


@compiled(**CALLED, **REASSOCIATE)
def _linearise(b: TractionBox, damping: float, diagonal: float) -> None:
    """Set residual, slope and weight at the traction."""
    sticking = 1.0 / np.sqrt(1.0 + damping / diagonal)
    for q in range(len(b.bound)):
        against = -(b.slip[q] * b.normal[q].conjugate()).real
        b.slope[q], b.weight[q] = damping, sticking
        if against > 0.0:
            b.slope[q] += against / b.bound[q]
            b.weight[q] = 1.0 / np.sqrt(1.0 + b.slope[q] / diagonal)
        b.residual[q], b.change[q] = -_free(b, q, b.slip[q]), 0.0


@compiled(**INNER, **REASSOCIATE)
def _stencil(masked: NDArray, taps: NDArray, pitch: int, target: NDArray) -> None:
    """Apply the stencil to a field between REACH rows of zeros, both given by their parts in turn."""
    row, c0, c1, c2, c3, c4, c5 = 2 * pitch, taps[0], taps[1], taps[2], taps[3], taps[4], taps[5]
    above, m, below = masked[row - 4 :], masked[2 * row - 4 :], masked[3 * row - 4 :]
    top, bottom = masked, masked[4 * row :]
    for q in range(len(target)):
        s = c0 * m[q + 4] + c1 * (above[q + 4] + below[q + 4]) + c2 * (m[q + 2] + m[q + 6])
        s += c3 * (above[q + 2] + above[q + 6] + below[q + 2] + below[q + 6])
        target[q] = s + c4 * (top[q] + bottom[q]) + c5 * (m[q] + m[q + 8])


@compiled(**CALLED, **REASSOCIATE)
def _precondition_traction(b: TractionBox, taps: NDArray, task: TractionTask, target: NDArray) -> None:
    """Carry the residual on from the leading edge, as in the simplified theory, and apply the stencil."""
    row, m = b.pitch, b.carried
    for q in range(len(b.bound) - 1, -1, -1):
        value = b.residual[q] + task.carried * m[(REACH + 1) * row + q]
        m[REACH * row + q] = b.weight[q] * _free(b, q, value)
    _stencil(m.view(np.float64), taps, row, target.view(np.float64))
    for q in range(len(b.bound)):
        target[q] = b.weight[q] * _free(b, q, target[q])


@compiled(**CALLED, **REASSOCIATE)
def _solve_linear(c: TractionConvolution, taps: NDArray, b: TractionBox, task: TractionTask) -> int:
    """Find the change of the traction; return the iterations.

    Conjugate gradients, or, without an energy, conjugate residuals, truncated.
    """
    first, held = _product(b.residual, b.residual), len(b.steps)
    against = b.steps if task.symmetric else b.responses
    for k in range(INNER_ITERATIONS):
        step, response = b.steps[k % held], b.responses[k % held]
        _precondition_traction(b, taps, task, step)
        convolve_traction(c, step, b.nx, b.ny, b.pitch, b.work, b.response)
        for q in range(len(step)):
            response[q] = _free(b, q, b.response[q]) + b.slope[q] * step[q]
        for other in range(max(0, k - held + 1), k):
            share = -_product(response, against[other % held])
            _add(response, share, b.responses[other % held])
            _add(step, share, b.steps[other % held])
        norm = np.sqrt(max(_product(response, against[k % held]), 0.0))
        if norm == 0.0:
            return k + 1
        for q in range(len(step)):
            step[q], response[q] = step[q] / norm, response[q] / norm
        share = _product(b.residual, against[k % held])
        _add(b.change, share, step)
        _add(b.residual, -share, response)
        if _product(b.residual, b.residual) <= FORCING**2 * first:
            return k + 1
    return INNER_ITERATIONS


@compiled(**CALLED, **REASSOCIATE)
def _take(b: TractionBox) -> None:
    """Change the traction, along the edges of the discs where it slips, and project it on them."""
    for q in range(len(b.bound)):
        b.trial[q] = _within(b.traction[q] + b.change[q], b.bound[q])


@compiled(**CALLED)
def _twice_energy(c: TractionConvolution, b: TractionBox) -> float:
    """Set the response to the slip under the trial traction; return twice its energy over a cell."""
    convolve_traction(c, b.trial, b.nx, b.ny, b.pitch, b.work, b.response)
    _add(b.response, 1.0, b.rigid)
    return _product(b.trial, b.response) + _product(b.trial, b.rigid)


@compiled(**INNER)
def _adopt(b: TractionBox) -> None:
    """Adopt the trial traction with its slip, which is the response."""
    for q in range(len(b.bound)):
        b.traction[q], b.slip[q] = b.trial[q], b.response[q]


@compiled(**CALLED, **REASSOCIATE)
def _shorten(b: TractionBox) -> None:
    """Go back to the least energy on the way to the trial traction, if it leads up to where it began."""
    work, curvature = 0.0, 0.0
    for q in range(len(b.bound)):
        step = (b.trial[q] - b.traction[q]).conjugate()
        work += (b.slip[q] * step).real
        curvature += ((b.response[q] - b.slip[q]) * step).real
    share = -work / curvature if work < 0.0 else 0.0
    for q in range(len(b.bound)):
        b.trial[q] = b.traction[q] + share * (b.trial[q] - b.traction[q])
        b.response[q] = b.slip[q] + share * (b.response[q] - b.slip[q])


@compiled(**LOOP, nogil=True)
def solve_traction(
    c: TractionConvolution, taps: NDArray, b: TractionBox, task: TractionTask
) -> tuple[int, int, float]:
    """Solve for tractions within the bound, opposite to the slip where they reach it, without slip elsewhere.

    Starts from the traction of the box, cut to the bound. Newton's iteration, projected on the discs and
    damped in proportion to what is left; with an energy, no step that raises it is taken. Returns the
    iterations, the convolutions, and the largest slip that is against the law, over that without traction.
    """
    damping, last, largest, convolutions, iteration = task.diagonal, 0.0, 0.0, 1, 0
    for q in range(len(b.bound)):
        b.trial[q] = _within(b.traction[q], b.bound[q])
        square = _square(b.rigid[q]) if b.bound[q] > 0.0 else 0.0
        last, largest = last + square, max(largest, square)
    last, largest = np.sqrt(last), np.sqrt(largest)
    energy = _twice_energy(c, b)
    _adopt(b)
    worst, norm = _judge(b)
    while worst > task.rtol * largest and iteration < task.max_iterations:
        iteration += 1
        if last > 0.0:
            damping = min(damping * norm / last, task.diagonal)
        last = norm
        _linearise(b, damping, task.diagonal)
        convolutions += 1 + _solve_linear(c, taps, b, task)
        _take(b)
        reached = _twice_energy(c, b)
        if task.symmetric and reached > energy + ROUNDING * abs(energy):
            damping, last = max(RETREAT * damping, LEAST * task.diagonal), 0.0
            _shorten(b)
            reached = _product(b.trial, b.response) + _product(b.trial, b.rigid)
        energy = reached
        _adopt(b)
        worst, norm = _judge(b)
    return iteration, convolutions, worst / largest if largest > 0.0 else worst
