"""Many contacts of one grid at once: the projected conjugate gradients of `projected_cg` on whole batches.

Written on an array module `xp` (numpy or CuPy): positions are the first axis of every array, nothing is
compiled and nothing leaves the device but a few counts. The iteration of each member is that of
`projected_cg.solve` at a given approach; members that have converged are frozen, and left out as soon as half
of a batch has.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from asperity.kernels.convolution import convolve_padded
from asperity.kernels.projected_cg import LEAST, MOST, OFTEN, PATIENCE, WHOLE

Array = Any
"""An array of the module `xp`."""

SMALLEST = 16
"""Batches do not shrink below this: a smaller transform takes no less time on a device."""


class _Members(NamedTuple):
    """Contacts being solved; each is a row of every array."""

    index: Array
    overlap: Array
    tolerance: Array
    pressure: Array
    residual: Array
    previous: Array
    direction: Array
    rho: Array
    length: Array
    iterations: Array
    worst: Array
    active: Array


def first_guess(overlap: Array, spectrum: Array, my: int, hardness: float, xp: Any) -> Array:
    """Pressures of Hertzian form over the deeper half of each overlap, scaled to least energy.

    Overlaps (b, nx, ny), m, each positive somewhere; pressures within the bounds, Pa.
    """
    p = xp.sqrt(xp.maximum(overlap - 0.5 * overlap.max(axis=(1, 2))[:, None, None], 0.0))
    scale = _dot(p, overlap) / _dot(p, convolve_padded(p, spectrum, my, xp))
    return xp.minimum(p * scale[:, None, None], hardness)


def solve_batch(
    overlap: Array,
    spectrum: Array,
    my: int,
    taps: tuple[float, ...],
    pressure: Array,
    hardness: float,
    softest: float,
    tolerance: Array,
    max_iterations: int,
    xp: Any,
) -> tuple[Array, Array]:
    """Solve 0 ≤ p ≤ hardness ⟂ K p − overlap for many overlaps, from `pressure`, which is overwritten.

    Overlaps, m, and pressures, Pa, are (b, nx, ny). Kernel and stencil are from `padded.padded_spectrum`
    (m/Pa; `my` is ``padded_length(ny)``) and `preconditioner.inverse_stencil` (Pa/m); no pressure of unit
    norm displaces by more than `softest`, m/Pa. Returns for each the iterations and the largest
    complementarity residual, m: where that is above its tolerance, the solution did not converge.
    """
    count = overlap.shape[0]
    iterations, reached = xp.zeros(count, dtype=xp.int64), xp.zeros(count)
    residual = convolve_padded(pressure, spectrum, my, xp) - overlap
    worst = _complementarity(pressure, residual, hardness, xp)
    members = _Members(
        xp.arange(count), overlap, tolerance, pressure.copy(), residual, xp.zeros_like(residual),
        xp.zeros_like(residual), xp.zeros(count), xp.ones(count), iterations.copy(), worst, worst > tolerance,
    )  # fmt: skip
    for _ in range(max_iterations):
        running = int(members.active.sum())
        if not running:
            break
        if _capacity(running) < len(members.active):
            _record(members, pressure, iterations, reached)
            members = _compacted(members, _capacity(running), xp)
        members = _iterate(members, spectrum, my, taps, hardness, softest, xp)
    _record(members, pressure, iterations, reached)
    return iterations, reached


def _record(members: _Members, pressure: Array, iterations: Array, reached: Array) -> None:
    """Write the state of the members to their places."""
    pressure[members.index] = members.pressure
    iterations[members.index] = members.iterations
    reached[members.index] = members.worst


def _capacity(count: int) -> int:
    """Batch that holds `count` members: few different sizes, as each needs its own plan of transforms."""
    return max(SMALLEST, 1 << (count - 1).bit_length())


def _compacted(members: _Members, size: int, xp: Any) -> _Members:
    """Keep the active members, and as many others as fill the batch."""
    kept = xp.concatenate([xp.nonzero(members.active)[0], xp.nonzero(~members.active)[0]])[:size]
    return _Members(*(values[kept] for values in members))


def _iterate(
    members: _Members,
    spectrum: Array,
    my: int,
    taps: tuple[float, ...],
    hardness: float,
    softest: float,
    xp: Any,
) -> _Members:
    """One iteration of every active member."""
    m, count = members, members.iterations + members.active
    z = _precondition(m.pressure, m.residual, hardness, taps, xp)
    rho = _dot(m.residual, z)
    beta = _conjugate(m, z, rho, xp)
    due = m.active & (count > PATIENCE) & (count % OFTEN == 0)
    direction = (beta[:, None, None] * m.direction - z) * (z != 0.0)
    step, work, clipped = _project(m, direction, m.length, hardness, xp)
    idle = m.active & ~due & (work >= 0.0)
    if bool(idle.any()):
        direction = xp.where(idle[:, None, None], -z, direction)
        step, work, clipped = _project(m, direction, m.length, hardness, xp)
    steepest = due | (m.active & (work >= 0.0))
    if bool(steepest.any()):
        chosen = steepest[:, None, None]
        direction = xp.where(chosen, -m.residual, direction)
        step, work, clipped = _project(
            m, direction, xp.where(steepest, 1.0 / softest, m.length), hardness, xp
        )
    response = convolve_padded(step, spectrum, my, xp)
    curvature = _dot(step, response)
    moving = m.active & (work < 0.0) & (curvature > 0.0)
    share = xp.where(moving, -work / xp.where(curvature > 0.0, curvature, 1.0), 0.0)
    length = xp.where(steepest, m.length, xp.clip(m.length * share, LEAST, MOST))
    share = _bounded(m.pressure, step, share, clipped, hardness, xp)[:, None, None]
    pressure = xp.clip(m.pressure + share * step, 0.0, hardness)
    residual = m.residual + share * response
    worst = _complementarity(pressure, residual, hardness, xp)
    claiming = moving & (worst <= m.tolerance)
    if bool(claiming.any()):  # the recurrence says converged: let the true residual confirm it
        residual = _true_residual(claiming, pressure, m.overlap, residual, spectrum, my, xp)
        worst = _complementarity(pressure, residual, hardness, xp)
    worst = xp.where(moving, worst, m.worst)
    return m._replace(
        pressure=pressure, residual=residual, previous=m.residual, direction=direction,
        rho=xp.where(steepest, 0.0, rho), length=length, iterations=count, worst=worst,
        active=moving & (worst > m.tolerance),
    )  # fmt: skip


def _conjugate(m: _Members, z: Array, rho: Array, xp: Any) -> Array:
    """Share of the last direction in the next one (Polak–Ribière)."""
    change, known = rho - _dot(m.previous, z), m.rho > 0.0
    return xp.where(known, xp.maximum(change / xp.where(known, m.rho, 1.0), 0.0), 0.0)


def _project(
    m: _Members, direction: Array, length: Array, hardness: float, xp: Any
) -> tuple[Array, Array, Array]:
    """Step of a length along a direction, projected on the bounds; its work; whether they held it back."""
    wanted = m.pressure + length[:, None, None] * direction
    kept = xp.clip(wanted, 0.0, hardness)
    step = kept - m.pressure
    return step, _dot(m.residual, step), (kept != wanted).any(axis=(1, 2))


def _bounded(pressure: Array, step: Array, share: Array, clipped: Array, hardness: float, xp: Any) -> Array:
    """Share of a step that leads to least energy, as far as the bounds allow."""
    reached = pressure + share[:, None, None] * step
    leaves = ((reached < 0.0) | (reached > hardness)).any(axis=(1, 2))
    share = xp.where(clipped & (share >= WHOLE), 1.0, share)
    return xp.where(~clipped & leaves, xp.minimum(share, 1.0), share)


def _precondition(
    pressure: Array, residual: Array, hardness: float, taps: tuple[float, ...], xp: Any
) -> Array:
    """Apply the stencil to the residual on the free set; zero elsewhere."""
    free = ((pressure > 0.0) | (residual < 0.0)) & ((pressure < hardness) | (residual > 0.0))
    z = apply_stencil(residual * free, taps, xp)
    z *= free
    return z


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


def _true_residual(
    wanted: Array, pressure: Array, overlap: Array, residual: Array, spectrum: Array, my: int, xp: Any
) -> Array:
    """Replace the residuals of the wanted members, carried on by recurrence, by the true ones."""
    chosen = xp.nonzero(wanted)[0]
    count = len(chosen)
    if not count:
        return residual
    if _capacity(count) >= len(wanted):
        return xp.where(
            wanted[:, None, None], convolve_padded(pressure, spectrum, my, xp) - overlap, residual
        )
    padded = xp.concatenate([chosen, xp.zeros(_capacity(count) - count, dtype=chosen.dtype)])
    true = convolve_padded(pressure[padded], spectrum, my, xp)[:count]
    residual[chosen] = true - overlap[chosen]
    return residual


def _complementarity(pressure: Array, residual: Array, hardness: float, xp: Any) -> Array:
    """Largest violation of the complementarity conditions of each member, in the unit of the residual."""
    capped = xp.where(pressure < hardness, xp.abs(residual), residual)
    return xp.maximum(xp.where(pressure > 0.0, capped, -residual).max(axis=(1, 2)), 0.0)


def _dot(a: Array, b: Array) -> Array:
    return (a * b).sum(axis=(1, 2))
