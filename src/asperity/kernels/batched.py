"""Convolutions and contacts in batches: the projected conjugate gradients of `projected_cg` on many at once.

Written on an array module `xp` (numpy or CuPy): members of a batch are the first axis of every array, nothing
is compiled and nothing leaves the device but a few counts. The iteration of each member is that of
`projected_cg.solve` at a given approach.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.edges import GIVEN, SHARPEST
from asperity.kernels.fourier import smooth_length
from asperity.kernels.projected_cg import LEAST, MOST, OFTEN, PATIENCE, WHOLE

Array = Any
"""An array of the module `xp`."""

SMALLEST = 16
"""Batches do not shrink below this: a smaller transform takes no less time on a device."""
FEW = 192
"""Cells up to which equations are solved at once: iterations take longer."""
STUCK = 0.9
"""Share of a residual above which its next value says that rounding hides what is left."""


def padded_spectrum(table: NDArray, nx: int, ny: int) -> NDArray:
    """Real spectrum (mx, my // 2 + 1) of an even kernel on the padded grid of an (nx, ny) box.

    The kernel (≥ nx, ≥ ny) is given at non-negative separations. Lengths mx ≥ 2 nx − 1 and my ≥ 2 ny − 1 are
    even and transform fast: a circular convolution on them does not wrap.
    """
    mx = smooth_length(2 * nx - 1)
    my = smooth_length(2 * ny - 1)
    circulant = np.zeros((mx, my))
    circulant[:nx, :ny] = table[:nx, :ny]
    circulant[mx - nx + 1 :, :ny] = table[nx - 1 : 0 : -1, :ny]
    circulant[:, my - ny + 1 :] = circulant[:, ny - 1 : 0 : -1]
    return np.ascontiguousarray(np.fft.rfft2(circulant).real)


def convolve_padded(fields: Array, spectrum: Array, xp: Any) -> Array:
    """Convolve fields (b, nx, ny) with an even kernel, whose `padded_spectrum` is of their box."""
    nx, ny = fields.shape[1:]
    padded = (spectrum.shape[0], 2 * spectrum.shape[1] - 2)
    full = xp.fft.rfft2(fields, s=padded)
    full *= spectrum
    return xp.ascontiguousarray(xp.fft.irfft2(full, s=padded)[:, :nx, :ny])


def between_cells(table: NDArray, cells: Sequence[NDArray]) -> NDArray:
    """Displacements (n, n) of cells at rows and lines (n,) by pressures on each of them, m/Pa.

    From an influence table at non-negative separations.
    """
    rows, lines = (np.abs(np.subtract.outer(each, each)) for each in cells)
    return np.asarray(table[rows, lines])


def unit_indentation(
    table: NDArray,
    taps: tuple[float, ...],
    inside: NDArray,
    rtol: float,
    max_iterations: int,
    soft: NDArray | None = None,
) -> tuple[NDArray, bool]:
    """Find the pressure that displaces a set of cells by one: K p = 1 on the set, p = 0 elsewhere.

    Preconditioned conjugate gradients, where cells are more than `FEW`. Influence table (≥ nx, ≥ ny), m/Pa,
    taps of `inverse_stencil`, Pa/m, the set (nx, ny), and the softness of cells at edges, m/Pa, which sink by
    that besides. Returns the pressure (nx, ny) in Pa per m of indentation, whose integral is the tangent
    stiffness, and whether the residual, relative to one, fell below `rtol`.
    """
    if np.count_nonzero(inside) <= FEW:
        matrix = between_cells(table, np.nonzero(inside))
        if soft is not None:
            matrix += np.diag(soft[inside])
        pressure = np.zeros(inside.shape)
        pressure[inside] = np.linalg.solve(matrix, np.ones(len(matrix)))
        return pressure, True
    spectrum = padded_spectrum(table, *inside.shape)
    rho = 1.0
    pressure = np.zeros(inside.shape)
    direction = np.zeros(inside.shape)
    residual = -inside.astype(np.float64)
    weight = inside.astype(np.float64) if soft is None else inside / np.sqrt(1.0 + soft * taps[0])
    for _ in range(max_iterations):
        if np.abs(residual).max() <= rtol:  # never of NaN
            return pressure, True
        z = apply_stencil((residual * weight)[None], taps, np)[0] * weight
        before = rho
        rho = float(np.vdot(residual, z))
        direction = rho / before * direction - z
        response = convolve_padded(direction[None], spectrum, np)[0]
        if soft is not None:
            response += soft * direction
        length = rho / float(np.vdot(direction, response))
        pressure += length * direction
        residual += length * response * inside
    return pressure, False


class _Members(NamedTuple):
    """Contacts being solved; each is a row of every array."""

    index: Array
    tolerance: Array
    pressure: Array
    residual: Array
    previous: Array
    direction: Array
    rho: Array
    length: Array
    iterations: Array
    active: Array
    softness: Array | None  # of cells at edges, from here on as in `contact.edges`; None where there is none
    drop: Array | None
    power: Array | None
    flow: Array | None
    flowing: Array | None
    yielding: Array | None


class BatchTask(NamedTuple):
    """What is asked of all contacts of a batch: 0 ≤ p ≤ hardness ⟂ K p − overlap."""

    spectrum: Array  # of K on the box of the contacts, from `padded_spectrum`, m/Pa
    taps: tuple[float, ...]  # from `projected_cg.inverse_stencil`, Pa/m
    hardness: float  # upper bound of the pressure, Pa (may be infinite)
    softest: float  # no pressure of unit norm displaces by more, m/Pa
    max_iterations: int


def first_guess(overlap: Array, task: BatchTask, xp: Any) -> Array:
    """Pressures of Hertzian form over the deeper half of each overlap, scaled to least energy.

    Overlaps (b, nx, ny), m; pressures within the bounds, Pa, zero where nothing overlaps.
    """
    p = xp.sqrt(xp.maximum(overlap - 0.5 * _each(overlap.max(axis=(1, 2))), 0.0))
    stored = _dot(p, convolve_padded(p, task.spectrum, xp))
    scale = _dot(p, overlap) / xp.where(stored > 0.0, stored, 1.0)
    return xp.minimum(p * _each(scale), task.hardness)


def solve_batch(
    overlap: Array,
    pressure: Array,
    tolerance: Array,
    task: BatchTask,
    xp: Any,
    at_edges: Sequence[Array] = (),
) -> tuple[Array, Array]:
    """Solve a task for many overlaps (b, nx, ny), m, from pressures, Pa, which are overwritten.

    What is known of cells at edges, if there are any, is given for all cells, as in `contact.edges.Softness`.
    Returns for each the iterations and the largest complementarity residual, m: where that is above its
    tolerance, the solution did not converge.

    Residuals are carried on from step to step. Where they claim convergence, true ones confirm it, or the
    iteration goes on from these. Members that are done are frozen; as soon as half of a batch is, they are
    left out.
    """
    count = len(overlap)
    iterations = xp.zeros(count, dtype=np.int64)
    worst = xp.ones(count) * np.inf
    while True:
        residual = convolve_padded(pressure, task.spectrum, xp) - overlap
        if at_edges:
            residual += sunk(at_edges, pressure, xp)
        before = worst
        worst = _complementarity(pressure, residual, task.hardness, xp)
        active = (worst > tolerance) & (worst <= STUCK * before) & (iterations < task.max_iterations)
        if not bool(active.any()):
            return iterations, worst
        nothing = xp.zeros_like(residual)
        none = xp.zeros(count)
        members = _Members(
            xp.arange(count), tolerance, pressure, residual, nothing, nothing, none, none + 1.0, iterations,
            active, *(at_edges or GIVEN * (None,)),
        )  # fmt: skip
        while running := int(members.active.sum()):
            size = max(SMALLEST, 1 << (running - 1).bit_length())  # few: each needs a plan of transforms
            if size < len(members.active):
                _record(members, pressure, iterations)
                kept = xp.argsort(~members.active, kind="stable")[:size]
                members = _Members(*(None if each is None else each[kept] for each in members))
            members = _iterate(members, task, xp)
        _record(members, pressure, iterations)


def sunk(at_edges: Sequence[Array], pressure: Array, xp: Any) -> Array:
    """By how much cells at edges, of `contact.edges.Softness`, sink under a pressure, Pa; m."""
    _, drop, power, *_ = at_edges
    alone = _alone(at_edges, pressure, xp)
    return alone * (1.0 + (alone / drop) ** power) ** (-1.0 / power)


def compliance(at_edges: Sequence[Array], pressure: Array, xp: Any) -> Array:
    """Derivative of `sunk` by the pressure, m/Pa; where cells begin to flow it is bounded."""
    softness, drop, power, flow, flowing, yielding = at_edges
    alone = _alone(at_edges, pressure, xp)
    ratio = pressure / flow
    rise = 8.0 / 3.0 * ratio**3 / xp.maximum(1.0 - ratio**4, SHARPEST) ** (1.0 / 3.0)
    giving = softness + xp.where(ratio < 1.0, flowing / flow * rise, yielding)
    return giving * (1.0 + (alone / drop) ** power) ** (-1.0 / power - 1.0)


def _alone(at_edges: Sequence[Array], pressure: Array, xp: Any) -> Array:
    """By how much the sound parts of cells at edges would sink alone, m."""
    softness, _, _, flow, flowing, yielding = at_edges
    left = (1.0 - xp.minimum(pressure / flow, 1.0) ** 4) ** (2.0 / 3.0)
    return softness * pressure + flowing * (1.0 - left) + yielding * xp.maximum(pressure - flow, 0.0)


def _record(members: _Members, pressure: Array, iterations: Array) -> None:
    """Write the state of the members to their places."""
    pressure[members.index] = members.pressure
    iterations[members.index] = members.iterations


def _iterate(m: _Members, task: BatchTask, xp: Any) -> _Members:
    """One iteration of every active member."""
    hardness = task.hardness
    count = m.iterations + m.active

    def project(direction: Array, length: Array) -> tuple[Array, Array, Array]:
        """Step of a length along a direction, within the bounds; its work; whether they held it back."""
        wanted = m.pressure + _each(length) * direction
        kept = xp.clip(wanted, 0.0, hardness)
        step = kept - m.pressure
        return step, _dot(m.residual, step), (kept != wanted).any(axis=(1, 2))

    free = ((m.pressure > 0.0) | (m.residual < 0.0)) & ((m.pressure < hardness) | (m.residual > 0.0))
    at_edges = m.softness, m.drop, m.power, m.flow, m.flowing, m.yielding
    if m.softness is not None:
        before = sunk(at_edges, m.pressure, xp)
        free = free / xp.sqrt(1.0 + task.taps[0] * compliance(at_edges, m.pressure, xp))
    z = apply_stencil(m.residual * free, task.taps, xp) * free
    rho = _dot(m.residual, z)
    known = m.rho > 0.0
    beta = xp.maximum((rho - _dot(m.previous, z)) / xp.where(known, m.rho, 1.0), 0.0) * known
    direction = (_each(beta) * m.direction - z) * (z != 0.0)
    step, work, clipped = project(direction, m.length)
    due = m.active & (count > PATIENCE) & (count % OFTEN == 0)
    idle = m.active & ~due & (work >= 0.0)
    if bool(idle.any()):
        direction = xp.where(_each(idle), -z, direction)
        step, work, clipped = project(direction, m.length)
    steepest = due | (m.active & (work >= 0.0))
    if bool(steepest.any()):
        direction = xp.where(_each(steepest), -m.residual, direction)
        step, work, clipped = project(direction, xp.where(steepest, 1.0 / task.softest, m.length))
    response = convolve_padded(step, task.spectrum, xp)
    if m.softness is not None:
        sinks = sunk(at_edges, m.pressure + step, xp) - before
        response += sinks
    curvature = _dot(step, response)
    moving = m.active & (work < 0.0) & (curvature > 0.0)
    share = xp.where(moving, -work / xp.where(curvature > 0.0, curvature, 1.0), 0.0)
    length = xp.where(steepest, m.length, xp.clip(m.length * share, LEAST, MOST))
    reached = m.pressure + _each(share) * step
    leaves = ((reached < 0.0) | (reached > hardness)).any(axis=(1, 2))
    whole = (clipped & (share >= WHOLE)) | (~clipped & leaves & (share > 1.0))
    share = _each(xp.where(whole, 1.0, share))
    pressure = xp.clip(m.pressure + share * step, 0.0, hardness)
    residual = m.residual + share * response
    if m.softness is not None:  # no straight line once what lies deeper carries, too
        residual += sunk(at_edges, pressure, xp) - before - share * sinks
    unmet = _complementarity(pressure, residual, hardness, xp) > m.tolerance
    return m._replace(
        pressure=pressure, residual=residual, previous=m.residual, direction=direction,
        rho=xp.where(steepest, 0.0, rho), length=length, iterations=count,
        active=moving & unmet & (count < task.max_iterations),
    )  # fmt: skip


def apply_stencil(fields: Array, taps: tuple[float, ...], xp: Any) -> Array:
    """Apply the stencil to fields (b, nx, ny), with nothing outside of them."""
    count, nx, ny = fields.shape
    padded = xp.zeros((count, nx + 4, ny + 4))
    padded[:, 2:-2, 2:-2] = fields

    def at(i: int, j: int) -> Array:
        return padded[:, 2 + i : 2 + i + nx, 2 + j : 2 + j + ny]

    z = taps[0] * at(0, 0)
    z += taps[1] * (at(-1, 0) + at(1, 0))
    z += taps[2] * (at(0, -1) + at(0, 1))
    z += taps[3] * (at(-1, -1) + at(-1, 1) + at(1, -1) + at(1, 1))
    z += taps[4] * (at(-2, 0) + at(2, 0))
    z += taps[5] * (at(0, -2) + at(0, 2))
    return z


def _complementarity(pressure: Array, residual: Array, hardness: float, xp: Any) -> Array:
    """Largest violation of the complementarity conditions of each member, in the unit of the residual."""
    capped = xp.where(pressure < hardness, xp.abs(residual), residual)
    return xp.maximum(xp.where(pressure > 0.0, capped, -residual).max(axis=(1, 2)), 0.0)


def _dot(a: Array, b: Array) -> Array:
    return (a * b).sum(axis=(1, 2))


def _each(values: Array) -> Array:
    """Values (b,), to be combined with fields (b, nx, ny)."""
    return values[:, None, None]
