"""Tractions under Coulomb's law: influence of tangential loads, its convolution, and Newton's iteration.

A traction is a vector in the plane of the surface. Taken as a complex number, x + iy, it displaces by
``u = α * p + β * conj(p)``: one transform there and one back for both directions.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.box import REACH
from asperity.kernels.fourier import factors, read_parts, roots, smooth_length, transform, write_parts
from asperity.kernels.influence import _clear, _edge_log, whole_vectors
from asperity.kernels.lanes import lanes, load, store, transpose, width
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
    """Convolve a field of vectors (2, nx pitch) on a box; zero, and without meaning, in idle columns."""
    mx, my, n = len(c.roots_x) // 2, len(c.roots_y) // 2, lanes(work)
    size, line, wide = 2 * max(mx, my) * n, 2 * my * n, whole_vectors(ny, n)
    a, b, rows = work[:size], work[size : 2 * size], work[2 * size :]
    for first in range(0, wide, n):
        for i in range(nx):
            at = i * pitch + first
            write_parts(a, 2 * i * n, load(field[0], at), load(field[1], at))
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
            re, im = read_parts(x, 2 * i * n)
            store(out[0], i * pitch + first, re)
            store(out[1], i * pitch + first, -1.0 * im)


KEPT = 16
"""Directions of search against which a new one is made orthogonal."""
INNER_ITERATIONS, FORCING = 40, 0.1
"""Of a linear solution, at most; by how much it reduces the residual."""
LEANING = 0.5
"""Weight of a cell's own stiffness against slip in the preconditioner, found by trial."""
LONGEST_TURN = 1.0
"""Of a traction in a step, rad."""
ACROSS = 1.0
"""Largest distance, in radii of its disc, by which slip is let move a traction when it is judged."""
RETREAT, LEAST, ROUNDING = 4.0, 1e-2, 1e-12
"""Factor of the damping where a step would raise the energy, by more than this share, and the least then."""


class TractionBox(NamedTuple):
    """Fields of a solution on a box of nx rows of `pitch` cells, the idle ones without friction."""

    nx: int
    ny: int
    pitch: int
    bound: NDArray  # (size,), largest traction, Pa
    rigid: NDArray  # (2, size), slip without traction, m
    traction: NDArray  # (2, size), Pa
    slip: NDArray  # (2, size), m
    trial: NDArray  # (2, size), traction with slipping cells on the edge of their discs, Pa
    response: NDArray  # (2, size), what a traction displaces, m
    normal: NDArray  # (2, size), direction of the traction in slipping cells, else zeros
    free: NDArray  # (3, size), xx, xy and yy of the projection on where a traction may go
    slope: NDArray  # (size,), slip over traction where that turns, and the damping, m/Pa
    residual: NDArray  # (2, size), of the linear problem, m
    change: NDArray  # (2, size), its solution, Pa
    carried: NDArray  # (2, size and REACH rows on both sides)
    steps: NDArray  # (KEPT, 2, size), Pa
    responses: NDArray  # (KEPT, 2, size), m
    work: NDArray


def traction_box(nx: int, ny: int, c: TractionConvolution) -> TractionBox:
    """Make a box without friction and traction."""
    pitch = max(whole_vectors(ny, width(np.float64)), ny + REACH)
    size, longest = nx * pitch, max(len(c.roots_x), len(c.roots_y))
    work = np.zeros(c.spectra.shape[1] * 2 + 2 * longest * width(np.float64))
    vectors = [np.zeros((2, size)) for _ in range(8)]
    rigid, traction, slip, trial, response, normal, residual, change = vectors
    return TractionBox(
        nx, ny, pitch, np.zeros(size), rigid, traction, slip, trial, response, normal, np.zeros((3, size)),
        np.zeros(size), residual, change, np.zeros((2, size + 2 * REACH * pitch)),
        np.zeros((KEPT, 2, size)), np.zeros((KEPT, 2, size)), work,
    )  # fmt: skip


class TractionTask(NamedTuple):
    """What is asked of a solution, and what is known of its operator."""

    diagonal: float  # displacement of a cell by its own traction, m/Pa
    carried: float  # share of a row's slip that comes from the row ahead: below one, zero without rolling
    damping: float  # at most, m/Pa: about what long waves of traction displace
    symmetric: bool  # whether there is an energy
    tolerance: float  # largest slip, m, that is against Coulomb's law
    max_iterations: int


@compiled(**INNER, **REASSOCIATE)
def _product(left: NDArray, right: NDArray) -> float:
    total = 0.0
    for axis in range(2):
        for q in range(left.shape[1]):
            total += left[axis, q] * right[axis, q]
    return total


@compiled(**INNER)
def _add(target: NDArray, factor: float, field: NDArray) -> None:
    for axis in range(2):
        for q in range(target.shape[1]):
            target[axis, q] += factor * field[axis, q]


@compiled(**CALLED)
def _judge(b: TractionBox, diagonal: float) -> tuple[float, float]:
    """Tell cells that stick from those that slip; return the largest slip against the law and the norm, m.

    A cell slips if p − s/d leaves its disc; d is so large that no slip takes it through the disc.
    """
    worst, total = 0.0, 0.0
    for q in range(len(b.bound)):
        g, px, py, sx, sy = b.bound[q], b.traction[0, q], b.traction[1, q], b.slip[0, q], b.slip[1, q]
        d = max(diagonal, np.hypot(sx, sy) / (ACROSS * g)) if g > 0.0 else diagonal
        zx, zy = px - sx / d, py - sy / d
        length = np.hypot(zx, zy)
        slips, carries = length > g, 1.0 if g > 0.0 else 0.0
        nx, ny = (carries * zx / length, carries * zy / length) if slips else (0.0, 0.0)
        b.normal[0, q], b.normal[1, q] = nx, ny
        b.free[0, q] = ny * ny if slips else carries
        b.free[1, q] = -nx * ny
        b.free[2, q] = nx * nx if slips else carries
        b.trial[0, q], b.trial[1, q] = (g * nx, g * ny) if slips else (px, py)
        missed = d * np.hypot(px - g * nx, py - g * ny) if slips else np.hypot(sx, sy)
        worst, total = max(worst, missed), total + missed**2
    return worst, np.sqrt(total)


@compiled(**CALLED)
def _linearise(b: TractionBox, damping: float) -> None:
    """Set residual and slope at the trial traction, whose displacement is the response."""
    for q in range(len(b.bound)):
        sx = b.rigid[0, q] + b.response[0, q] + damping * (b.trial[0, q] - b.traction[0, q])
        sy = b.rigid[1, q] + b.response[1, q] + damping * (b.trial[1, q] - b.traction[1, q])
        against = -(sx * b.normal[0, q] + sy * b.normal[1, q])
        b.slope[q] = damping + (against / b.bound[q] if against > 0.0 else 0.0)
        b.residual[0, q] = -(b.free[0, q] * sx + b.free[1, q] * sy)
        b.residual[1, q] = -(b.free[1, q] * sx + b.free[2, q] * sy)
        b.change[0, q] = b.change[1, q] = 0.0


@compiled(**CALLED)
def _apply(c: TractionConvolution, b: TractionBox, step: NDArray, target: NDArray) -> None:
    """Apply the linear operator to a step."""
    convolve_traction(c, step, b.nx, b.ny, b.pitch, b.work, b.response)
    for q in range(len(b.bound)):
        u, v = b.response[0, q], b.response[1, q]
        target[0, q] = b.free[0, q] * u + b.free[1, q] * v + b.slope[q] * step[0, q]
        target[1, q] = b.free[1, q] * u + b.free[2, q] * v + b.slope[q] * step[1, q]


@compiled(**CALLED, **REASSOCIATE)
def _precondition_traction(b: TractionBox, taps: NDArray, task: TractionTask, target: NDArray) -> None:
    """Carry the residual on from the leading edge, as in the simplified theory, and apply the stencil."""
    row, carried = b.pitch, b.carried
    ahead = REACH * row
    for i in range(b.nx - 1, -1, -1):
        for q in range(i * row, (i + 1) * row):
            share = 1.0 / (1.0 + LEANING * b.slope[q] / task.diagonal)
            u = (b.residual[0, q] + task.carried * carried[0, ahead + q + row]) * share
            v = (b.residual[1, q] + task.carried * carried[1, ahead + q + row]) * share
            carried[0, ahead + q] = b.free[0, q] * u + b.free[1, q] * v
            carried[1, ahead + q] = b.free[1, q] * u + b.free[2, q] * v
    for axis in range(2):
        m = carried[axis]
        for q in range(len(b.bound)):
            o = ahead + q
            s = taps[0] * m[o] + taps[1] * (m[o - row] + m[o + row]) + taps[2] * (m[o - 1] + m[o + 1])
            s += taps[3] * (m[o - row - 1] + m[o - row + 1] + m[o + row - 1] + m[o + row + 1])
            target[axis, q] = (
                s + taps[4] * (m[o - 2 * row] + m[o + 2 * row]) + taps[5] * (m[o - 2] + m[o + 2])
            )
    for q in range(len(b.bound)):
        u, v = target[0, q], target[1, q]
        target[0, q] = b.free[0, q] * u + b.free[1, q] * v
        target[1, q] = b.free[1, q] * u + b.free[2, q] * v


@compiled(**CALLED)
def _solve_linear(c: TractionConvolution, taps: NDArray, b: TractionBox, task: TractionTask) -> int:
    """Find the change of the trial traction: conjugate residuals, truncated; return the iterations."""
    first = _product(b.residual, b.residual)
    for k in range(INNER_ITERATIONS):
        step, response = b.steps[k % KEPT], b.responses[k % KEPT]
        _precondition_traction(b, taps, task, step)
        _apply(c, b, step, response)
        for other in range(max(0, k - KEPT + 1), k):
            share = _product(response, b.responses[other % KEPT])
            _add(response, -share, b.responses[other % KEPT])
            _add(step, -share, b.steps[other % KEPT])
        norm = np.sqrt(_product(response, response))
        if norm == 0.0:
            return k + 1
        for axis in range(2):
            for q in range(len(b.bound)):
                step[axis, q] /= norm
                response[axis, q] /= norm
        share = _product(b.residual, response)
        _add(b.change, share, step)
        _add(b.residual, -share, response)
        if _product(b.residual, b.residual) <= FORCING**2 * first:
            return k + 1
    return INNER_ITERATIONS


@compiled(**CALLED)
def _take(b: TractionBox) -> None:
    """Change the trial traction, along the edges of the discs where it slips, and project it on them."""
    for q in range(len(b.bound)):
        g, nx, ny = b.bound[q], b.normal[0, q], b.normal[1, q]
        px, py = b.trial[0, q] + b.change[0, q], b.trial[1, q] + b.change[1, q]
        if nx != 0.0 or ny != 0.0:
            turn = (nx * b.change[1, q] - ny * b.change[0, q]) / g
            turn = min(max(turn, -LONGEST_TURN), LONGEST_TURN)
            cosine, sine = np.cos(turn), np.sin(turn)
            px, py = g * (nx * cosine - ny * sine), g * (ny * cosine + nx * sine)
        length = np.hypot(px, py)
        share = g / length if length > g else 1.0
        b.trial[0, q], b.trial[1, q] = share * px, share * py


@compiled(**CALLED)
def _slip(c: TractionConvolution, b: TractionBox, traction: NDArray) -> None:
    """Set the response to the slip under a traction."""
    convolve_traction(c, traction, b.nx, b.ny, b.pitch, b.work, b.response)
    _add(b.response, 1.0, b.rigid)


@compiled(**INNER)
def _adopt(b: TractionBox) -> float:
    """Adopt the trial traction with its slip, which is the response; return twice its energy over a cell."""
    for axis in range(2):
        for q in range(len(b.bound)):
            b.traction[axis, q], b.slip[axis, q] = b.trial[axis, q], b.response[axis, q]
    return _product(b.traction, b.slip) + _product(b.traction, b.rigid)


@compiled(**LOOP, nogil=True)
def solve_traction(
    c: TractionConvolution, taps: NDArray, b: TractionBox, task: TractionTask
) -> tuple[int, int, float]:
    """Solve for tractions within the bound, opposite to the slip where they reach it, without slip elsewhere.

    Starts from the traction of the box. Newton's iteration on ``p = P(p − s/d)`` with the projection P on the
    discs, damped in proportion to what is left; with an energy, no step that raises it is taken. Returns the
    iterations, the convolutions, and the largest slip that is against the law, m.
    """
    damping, last, convolutions, iteration = task.damping, 0.0, 1, 0
    for axis in range(2):
        for q in range(len(b.bound)):
            b.trial[axis, q] = b.traction[axis, q]
    _slip(c, b, b.trial)
    energy = _adopt(b)
    worst, norm = _judge(b, task.diagonal)
    while worst > task.tolerance and iteration < task.max_iterations:
        iteration += 1
        if last > 0.0:
            damping = min(damping * norm / last, task.damping)
        last = norm
        _judge(b, max(damping, task.diagonal))
        convolve_traction(c, b.trial, b.nx, b.ny, b.pitch, b.work, b.response)
        _linearise(b, damping)
        convolutions += 2 + _solve_linear(c, taps, b, task)
        _take(b)
        _slip(c, b, b.trial)
        reached = _product(b.trial, b.response) + _product(b.trial, b.rigid)
        if task.symmetric and reached > energy + ROUNDING * abs(energy):
            damping, last = max(RETREAT * damping, LEAST * task.damping), 0.0
            continue
        energy = _adopt(b)
        worst, norm = _judge(b, task.diagonal)
    return iteration, convolutions, worst
