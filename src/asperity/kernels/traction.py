"""Tractions under Coulomb's law: influence of tangential loads, its convolution, and Newton's iteration.

A traction is a vector in the plane of the surface. Taken as a complex number, x + iy, it displaces by
``u = α * p + β * conj(p)``: one transform there and one back for both directions.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from asperity.kernels.box import REACH
from asperity.kernels.fourier import factors, read_parts, roots, smooth_length, transform, write_parts
from asperity.kernels.influence import _clear, whole_vectors
from asperity.kernels.lanes import aligned, lanes, transpose, width
from asperity.kernels.options import CALLED, INNER, LOOP, ONCE, REASSOCIATE, compiled
from asperity.kernels.traction_rims import (
    TractionRims,
    add_giving,
    add_left,
    carried_on,
    forget_secants,
    giving_aside,
    set_bound,
    set_giving,
    set_secants,
    weigh_giving,
)


class TractionConvolution(NamedTuple):
    """Influence of tractions on a box, ready to be convolved with."""

    radices_x: NDArray
    radices_y: NDArray
    roots_x: NDArray  # (2 mx,), from `fourier.roots`
    roots_y: NDArray  # (2 my,)
    turn: NDArray  # (2 mx,), exp(−iπ x/mx)
    spectra: NDArray  # of x by x, y by y and x by y, over 2 mx my, m/Pa; see `traction_convolution`


def traction_convolution(kernels: NDArray, nx: int, ny: int, dtype: DTypeLike) -> TractionConvolution:
    """Prepare displacements along x by x, y by y and x by y, (3, 2 nx − 1, 2 ny − 1), for nx × ny cells.

    Turned by half of a period along x, a spectrum is at i + ½ and j: its opposite is mx − 1 − i and −j, and a
    block of rows has its opposite in a block. Of half of the blocks, six vectors (block, my, 6, lanes).
    """
    mx = 2 * smooth_length(nx)
    my = 2 * smooth_length(ny)
    n = width(dtype)
    x = np.arange(1 - nx, nx)
    blocks = -(-mx // (2 * n))
    padded = np.zeros((3, mx, my), dtype=complex)
    padded[:, : 2 * nx - 1, : 2 * ny - 1] = kernels * np.exp(-1j * np.pi / mx * x)[:, None]
    found = np.fft.fft2(np.roll(padded, (1 - nx, 1 - ny), (1, 2)))[:, : blocks * n] / (2 * mx * my)
    vectors = np.stack([found.real, found.imag], axis=1).reshape(6, blocks, n, my).transpose(1, 3, 0, 2)
    spectra = aligned(vectors.size, dtype)
    spectra[:] = vectors.ravel()
    x, y, turn = (a.astype(dtype) for a in (roots(mx), roots(my), roots(2 * mx)[: 2 * mx]))
    return TractionConvolution(np.array(factors(mx)), np.array(factors(my)), x, y, turn, spectra)


@compiled(**INNER)
def _multiply(spectra: NDArray, place: int, x: NDArray, p: int, y: NDArray, q: int) -> None:
    """Replace a spectrum, and its opposite, by the conjugate of that of the displacements."""
    n = lanes(x)
    (fr, fi), (gr, gi) = read_parts(x, p), read_parts(y, q)
    a = fr + gr
    b = fi - gi
    c = fi + gi
    d = gr - fr  # twice the spectra of both directions
    xr, xi = read_parts(spectra, place)
    yr, yi = read_parts(spectra, place + 2 * n)
    mr, mi = read_parts(spectra, place + 4 * n)
    ur = xr * a - xi * b + mr * c - mi * d
    ui = xr * b + xi * a + mr * d + mi * c
    vr = mr * a - mi * b + yr * c - yi * d
    vi = mr * b + mi * a + yr * d + yi * c
    write_parts(x, p, ur - vi, -1.0 * (ui + vr))
    write_parts(y, q, ur + vi, ui - vr)


@compiled(**CALLED)
def _across(
    c: TractionConvolution, block: int, x: NDArray, y: NDArray, wide: int, a: NDArray, b: NDArray
) -> None:
    """Convolve a block of rows and its opposite, which end behind `wide` columns, to conjugates."""
    my = len(c.roots_y) // 2
    n = lanes(x)
    _clear(x, 2 * wide * n, 2 * my * n)
    _clear(y, 2 * wide * n, 2 * my * n)
    swapped = transform(x, a, c.radices_y, c.roots_y)
    transform(y, b, c.radices_y, c.roots_y)
    p, q, r, s = (a, b, x, y) if swapped else (x, y, a, b)
    for j in range(my):
        _multiply(c.spectra, 6 * (block * my + j) * n, p, 2 * j * n, q, 2 * (my - j if j else 0) * n)
    transform(p, r, c.radices_y, c.roots_y)  # twice as many passes end where they began
    transform(q, s, c.radices_y, c.roots_y)


@compiled(**LOOP, nogil=True)
def convolve_traction(
    c: TractionConvolution, field: NDArray, nx: int, ny: int, pitch: int, work: NDArray, out: NDArray
) -> None:
    """Convolve a complex field (nx pitch,) on a box; zero, and without meaning, in idle columns."""
    mx = len(c.roots_x) // 2
    my = len(c.roots_y) // 2
    n = lanes(work)
    size = 2 * max(mx, my) * n
    line = 2 * my * n
    wide = whole_vectors(ny, n)
    half = -(-mx // (2 * n))
    a = work[:size]
    b = work[size : 2 * size]
    rows = work[2 * size :]
    for first in range(0, wide, n):
        for i in range(nx):
            cosine = c.turn[2 * i]
            sine = c.turn[2 * i + 1]
            for j in range(n):
                value = field[i * pitch + first + j]
                a[2 * i * n + j] = cosine * value.real - sine * value.imag
                a[(2 * i + 1) * n + j] = cosine * value.imag + sine * value.real
        _clear(a, 2 * nx * n, 2 * mx * n)
        x = b if transform(a, b, c.radices_x, c.roots_x) else a
        for k in range(half):
            for part in range(0, 2 * n, n):
                o = 2 * k * n * n + part
                opposite = 2 * (mx - 1 - k * n) * n + part
                transpose(x, o, 2 * n, rows, k * line + 2 * first * n + part, 2 * n)
                transpose(x, opposite, -2 * n, rows, (half + k) * line + 2 * first * n + part, 2 * n)
    for k in range(half):
        one = rows[k * line : (k + 1) * line]
        other = rows[(half + k) * line : (half + k + 1) * line]
        _across(c, k, one, other, wide, a, b)
    for first in range(0, wide, n):
        for k in range(half):
            for part in range(0, 2 * n, n):
                o = 2 * k * n * n + part
                opposite = 2 * (mx - 1 - k * n) * n + part
                transpose(rows, k * line + 2 * first * n + part, 2 * n, a, o, 2 * n)
                transpose(rows, (half + k) * line + 2 * first * n + part, 2 * n, a, opposite, -2 * n)
        x = b if transform(a, b, c.radices_x, c.roots_x) else a
        for i in range(nx):
            cosine = c.turn[2 * i]
            sine = c.turn[2 * i + 1]
            for j in range(n):
                re = x[2 * i * n + j]
                im = x[(2 * i + 1) * n + j]
                out[i * pitch + first + j] = complex(cosine * re - sine * im, -cosine * im - sine * re)


INNER_ITERATIONS, FORCING = 40, 0.1
"""Of a linear solution, at most; by how much it reduces the residual."""
EDGE = 1.0 - 1e-12
"""Share of the bound from which on a traction counts as on the edge."""
RETREAT, LEAST, ROUNDING = 4.0, 1e-2, 1e-12
"""Factor of the damping where a step would raise the energy, by more than this share, and the least then."""
PATIENCE, GROWTH, MOST = 16, 1.5, 10.0
"""Iterations that should halve what is left; growth of the damping with each one more, and its end."""


class LinearProblem(NamedTuple):
    """Fields of the problem that is linear in a change of the traction, in single precision.

    Slip is in units of its norm, traction in what displaces its own cell by that.
    """

    convolution: TractionConvolution
    taps: NDArray  # from `projected_cg.inverse_stencil`
    kept: NDArray  # (size,), ``kept v + mirrored conj(v)`` is the part of v that is free to change
    slope: NDArray  # (size,), slip over traction where that turns, and the damping
    weight: NDArray  # (size,), root of a cell's own flexibility over that with the slope
    mirrored: NDArray  # (size,), and all from here on complex
    residual: NDArray  # (size,), slip
    change: NDArray  # (size,), the solution
    response: NDArray  # (size,), slip by a direction of search
    carried: NDArray  # (size and REACH rows on both sides,)
    steps: NDArray  # (directions, size), directions of search
    responses: NDArray  # (directions, size), what is left free of their slip
    work: NDArray


class TractionBox(NamedTuple):
    """Fields of a solution on a box of nx rows of `pitch` cells, the idle ones without friction."""

    nx: int
    ny: int
    pitch: int
    convolution: TractionConvolution
    bound: NDArray  # (size,), largest traction, Pa
    rigid: NDArray  # (size,), slip without traction, m, and all from here on complex
    traction: NDArray  # (size,), Pa
    slip: NDArray  # (size,), m
    trial: NDArray  # (size,), traction that is tried, Pa
    response: NDArray  # (size,), its slip, m
    normal: NDArray  # (size,), direction of the traction in slipping cells, else zero
    work: NDArray


def traction_box(nx: int, ny: int, c: TractionConvolution) -> TractionBox:
    """Make a box without friction and traction."""
    pitch = max(whole_vectors(ny, width(np.float32)), ny + REACH)
    size = nx * pitch
    fields = np.zeros((6, size), complex)
    return TractionBox._make((nx, ny, pitch, c, np.zeros(size), *fields, _room(c)))


def linear_problem(b: TractionBox, c: TractionConvolution, taps: NDArray, directions: int) -> LinearProblem:
    """Make room for linear problems, where a direction of search is made orthogonal to the others."""
    size = len(b.bound)
    real = np.zeros((3, size), np.float32)
    fields = np.zeros((4, size), np.complex64)
    carried = np.zeros(size + 2 * REACH * b.pitch, np.complex64)
    searched = np.zeros((2, directions, size), np.complex64)
    known = c, taps.astype(np.float32)
    return LinearProblem._make((*known, *real, *fields, carried, *searched, _room(c)))


def _room(c: TractionConvolution) -> NDArray:
    """Work of a convolution: all blocks of rows, and two more of the longer side."""
    mx = len(c.roots_x) // 2
    my = len(c.roots_y) // 2
    n = width(c.roots_x.dtype)
    return aligned(4 * n * (-(-mx // (2 * n)) * my + max(mx, my)), c.roots_x.dtype)


class TractionTask(NamedTuple):
    """What is asked of a solution, and what is known of its operator."""

    diagonal: float  # displacement of a cell by its own traction, m/Pa
    carried: float  # share of a row's slip that comes from the row ahead: below one, zero without rolling
    symmetric: bool  # whether there is an energy
    rtol: float  # largest slip that is against Coulomb's law, over the largest without traction
    max_iterations: int


@compiled(**ONCE)
def _parts(field: NDArray) -> NDArray:
    """Real and imaginary parts in turn, for vectors."""
    return field.view(field.real.dtype)


@compiled(**INNER, **REASSOCIATE)
def _product(left: NDArray, right: NDArray) -> float:
    p = _parts(left)
    q = _parts(right)
    total = p.dtype.type(0.0)
    for i in range(len(p)):
        total += p[i] * q[i]
    return total


@compiled(**INNER, **REASSOCIATE)
def _add(target: NDArray, factor: float, field: NDArray) -> None:
    p = _parts(target)
    q = _parts(field)
    share = p.dtype.type(factor)
    for i in range(len(p)):
        p[i] += share * q[i]


@compiled(**INNER, **REASSOCIATE)
def _square(value: complex) -> float:
    return value.real**2 + value.imag**2  # abs() takes care of overflow, and time


@compiled(**INNER, **REASSOCIATE)
def _within(value: complex, bound: float) -> complex:
    square = _square(value)
    return value * (bound / np.sqrt(square)) if square > bound**2 else value


@compiled(**INNER, **REASSOCIATE)
def _free(p: LinearProblem, q: int, value: complex) -> complex:
    """Part of a vector that may change in a cell: all where it sticks, along the edge where it slips."""
    return p.kept[q] * value + p.mirrored[q] * value.conjugate()


@compiled(**INNER)
def _on_edge(b: TractionBox, q: int) -> bool:
    return b.bound[q] > 0.0 and _square(b.traction[q]) > (EDGE * b.bound[q]) ** 2


@compiled(**INNER)
def _slips_on(b: TractionBox, rims: TractionRims, q: int) -> bool:
    """Whether the material of a cell slipped before."""
    if rims.ahead == 0:
        return rims.earlier[q] != 0.0
    return q + rims.ahead < len(b.slip) and _on_edge(b, q + rims.ahead)


@compiled(**INNER)
def _slip_at_end(b: TractionBox, rims: TractionRims | None, q: int) -> complex:
    """Slip of a cell at the end of a step: of what goes on, the mean and half of its growth.

    By half of itself at most, as what begins grows: what falls faster ends within the step.
    """
    slip = b.slip[q]
    if rims is None or not _slips_on(b, rims, q):
        return slip
    earlier = b.slip[q + rims.ahead] if rims.ahead > 0 else rims.earlier[q]
    return slip + _within(0.5 * (slip - earlier), 0.5 * np.sqrt(_square(slip)))


@compiled(**CALLED, **REASSOCIATE)
def _judge(b: TractionBox, linear: LinearProblem, rims: TractionRims | None) -> tuple[float, float]:
    """Tell cells that stick from those that slip; return the largest slip against the law and the norm, m.

    A cell slips on the edge of its disc if the slip would take it out. All else should be without slip.
    """
    worst, total = 0.0, 0.0
    for q in range(len(b.bound)):
        g = b.bound[q]
        p = b.traction[q]
        s = b.slip[q]
        n = 0.0j
        missed = 0.0
        linear.kept[q] = 0.0
        if g > 0.0:
            square = _square(p)
            linear.kept[q] = 1.0
            n = p * (1.0 / np.sqrt(square)) if square > (EDGE * g) ** 2 else n
            if (s * n.conjugate()).real < 0.0:
                linear.kept[q] = 0.5
                s = _slip_at_end(b, rims, q)
                s -= (s * n.conjugate()).real * n
            else:
                n = 0.0j
            missed = _square(s)
        b.normal[q] = n
        linear.mirrored[q] = -0.5 * n * n
        worst = max(worst, missed)
        total = total + missed
    return np.sqrt(worst), np.sqrt(total)


@compiled(**CALLED, **REASSOCIATE)
def _linearise(
    b: TractionBox,
    linear: LinearProblem,
    rims: TractionRims | None,
    damping: float,
    norm: float,
    diagonal: float,
) -> None:
    """Set residual, slope and weight at the traction."""
    unit = 1.0 / norm
    set_giving(rims, b.slip, b.normal, diagonal)
    for q in range(len(b.bound)):
        n = b.normal[q]
        left = 0.0j
        slip = b.slip[q] if n == 0.0 else _slip_at_end(b, rims, q)
        against = -(slip * n.conjugate()).real
        slope = giving_aside(rims, q, diagonal)
        if against > 0.0:
            slope += against / (b.bound[q] * diagonal)
        slope = damping + max(slope, 0.0)
        linear.slope[q] = slope
        linear.weight[q] = 1.0 / np.sqrt(1.0 + slope)
        if b.bound[q] > 0.0:
            left = -unit * (slip + against * n)
        linear.residual[q] = left
        linear.change[q] = 0.0


@compiled(**INNER, **REASSOCIATE)
def _stencil(masked: NDArray, taps: NDArray, pitch: int, target: NDArray) -> None:
    """Apply the stencil to a field between REACH rows of zeros, both given by their parts in turn."""
    row = 2 * pitch
    c0 = taps[0]
    c1 = taps[1]
    c2 = taps[2]
    c3 = taps[3]
    c4 = taps[4]
    c5 = taps[5]
    above = masked[row - 4 :]
    m = masked[2 * row - 4 :]
    below = masked[3 * row - 4 :]
    top = masked
    bottom = masked[4 * row :]
    for q in range(len(target)):
        s = c0 * m[q + 4] + c1 * (above[q + 4] + below[q + 4]) + c2 * (m[q + 2] + m[q + 6])
        s += c3 * (above[q + 2] + above[q + 6] + below[q + 2] + below[q + 6])
        target[q] = s + c4 * (top[q] + bottom[q]) + c5 * (m[q] + m[q + 8])


@compiled(**INNER, **REASSOCIATE)
def _weighted(linear: LinearProblem, rims: TractionRims | None, q: int, value: complex) -> complex:
    return weigh_giving(rims, q, linear.slope[q], linear.weight[q], value)


@compiled(**INNER, **REASSOCIATE)
def _carry(
    linear: LinearProblem, rims: TractionRims | None, diagonal: float, row: int, share: float, target: NDArray
) -> None:
    """Carry the residual on from the leading edge, as in the simplified theory."""
    for q in range(len(target) - 1, -1, -1):
        p = q + row
        target[q] = linear.residual[q]
        if p < len(target):
            ahead = _free(linear, p, target[p])
            sticks = linear.kept[p] == 1.0
            target[q] += carried_on(rims, p, share, linear.weight[p], sticks, diagonal) * ahead


@compiled(**CALLED, **REASSOCIATE)
def _precondition_traction(
    b: TractionBox, linear: LinearProblem, rims: TractionRims | None, task: TractionTask, target: NDArray
) -> None:
    """Apply the stencil to the residual, carried on in steady rolling."""
    masked = linear.carried[REACH * b.pitch :]
    source = linear.residual
    if task.carried > 0.0:
        source = linear.response
        _carry(linear, rims, task.diagonal, b.pitch, np.float32(task.carried), source)
    for q in range(len(source)):
        masked[q] = _weighted(linear, rims, q, _free(linear, q, source[q]))
    _stencil(_parts(linear.carried), linear.taps, b.pitch, _parts(target))
    for q in range(len(target)):
        target[q] = _free(linear, q, _weighted(linear, rims, q, target[q]))


@compiled(**INNER)
def _response_at_end(b: TractionBox, linear: LinearProblem, rims: TractionRims | None, q: int) -> complex:
    """Response to a change of the traction, of cells that slip on at the end of a step."""
    slip = linear.response[q]
    if rims is None or b.normal[q] == 0.0 or not _slips_on(b, rims, q):
        return slip
    earlier = linear.response[q + rims.ahead] if rims.ahead > 0 else slip * np.float32(0.0)
    return slip + np.float32(0.5) * (slip - earlier)


@compiled(**CALLED, **REASSOCIATE)
def _solve_linear(
    b: TractionBox, linear: LinearProblem, rims: TractionRims | None, task: TractionTask
) -> int:
    """Find the change of the traction; return the iterations.

    Conjugate gradients, or, without an energy, conjugate residuals, truncated.
    """
    first = _product(linear.residual, linear.residual)
    held = len(linear.steps)
    against = linear.steps if task.symmetric else linear.responses
    for k in range(INNER_ITERATIONS):
        step, response = linear.steps[k % held], linear.responses[k % held]
        _precondition_traction(b, linear, rims, task, step)
        convolve_traction(linear.convolution, step, b.nx, b.ny, b.pitch, linear.work, linear.response)
        add_giving(rims, step, linear.response)
        for q in range(len(step)):
            slip = _response_at_end(b, linear, rims, q)
            response[q] = _free(linear, q, slip) + linear.slope[q] * step[q]
        for other in range(max(0, k - held + 1), k):
            share = -_product(response, against[other % held])
            _add(response, share, linear.responses[other % held])
            _add(step, share, linear.steps[other % held])
        norm = np.sqrt(max(_product(response, against[k % held]), np.float32(0.0)))
        if norm == 0.0:
            return k + 1
        unit = np.float32(1.0) / norm
        for q in range(len(step)):
            step[q], response[q] = step[q] * unit, response[q] * unit
        share = _product(linear.residual, against[k % held])
        _add(linear.change, share, step)
        _add(linear.residual, -share, response)
        if _product(linear.residual, linear.residual) <= FORCING**2 * first:
            return k + 1
    return INNER_ITERATIONS


@compiled(**CALLED, **REASSOCIATE)
def _take(b: TractionBox, change: NDArray, unit: float) -> None:
    """Change the traction, along the edges of the discs where it slips, and project it on them."""
    for q in range(len(b.bound)):
        step = unit * change[q]
        n = b.normal[q]
        step -= (
            step * n.conjugate()
        ).real * n  # what is left of it, in single precision, would leave the edge
        b.trial[q] = _within(b.traction[q] + step, b.bound[q])


@compiled(**CALLED)
def _twice_energy(b: TractionBox, rims: TractionRims | None) -> float:
    """Set the response to the slip under the trial traction; return twice its energy over a cell.

    With rims there is none.
    """
    convolve_traction(b.convolution, b.trial, b.nx, b.ny, b.pitch, b.work, b.response)
    _add(b.response, 1.0, b.rigid)
    add_left(rims, b.trial, b.response)
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
    b: TractionBox, linear: LinearProblem, rims: TractionRims | None, task: TractionTask
) -> tuple[int, int, float]:
    """Solve for tractions within the bound, opposite to the slip where they reach it, without slip elsewhere.

    Starts from the traction of the box, cut to the bound. Newton's iteration, projected on the discs and
    damped in proportion to what is left; with an energy, no step that raises it is taken. Returns the
    iterations, the convolutions, and the largest slip that is against the law, over that without traction.
    """
    damping = 1.0
    last = 0.0
    largest = 0.0
    convolutions = 1
    iteration = 0
    least = np.inf
    waited = 0
    for q in range(len(b.bound)):
        b.trial[q] = _within(b.traction[q], b.bound[q])
        square = _square(b.rigid[q]) if b.bound[q] > 0.0 else 0.0
        last = last + square
        largest = max(largest, square)
    last = np.sqrt(last)
    largest = np.sqrt(largest)
    set_bound(rims)
    energy = _twice_energy(b, rims)
    _adopt(b)
    worst, norm = _judge(b, linear, rims)
    while worst > task.rtol * largest and iteration < task.max_iterations:
        iteration += 1
        if last > 0.0:
            damping = min(damping * norm / last, 1.0)
        waited += 1
        if norm < 0.5 * least:
            least = norm
            waited = 0
            forget_secants(rims)
        if rims is not None:  # without an energy, for what secants alone do not bring to an end
            damping = max(damping, min(LEAST * GROWTH ** (waited - PATIENCE), MOST))
        last = norm
        _linearise(b, linear, rims, damping, norm, task.diagonal)
        convolutions += 1 + _solve_linear(b, linear, rims, task)
        _take(b, linear.change, norm / task.diagonal)
        reached = _twice_energy(b, rims)
        if rims is None and task.symmetric and reached > energy + ROUNDING * abs(energy):
            damping = max(RETREAT * damping, LEAST)
            last = 0.0
            _shorten(b)
            reached = _product(b.trial, b.response) + _product(b.trial, b.rigid)
        energy = reached
        set_secants(rims, b.traction, b.trial, task.diagonal)
        _adopt(b)
        worst, norm = _judge(b, linear, rims)
    return iteration, convolutions, worst / largest if largest > 0.0 else worst
