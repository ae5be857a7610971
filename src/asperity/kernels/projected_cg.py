"""Approximate inverse of the influence of pressure, as a short stencil on a set of cells."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.at_load import balance_load, find_level, mark_free, project_at_load, rounding
from asperity.kernels.box import REACH, Box
from asperity.kernels.edges import (
    SoftCells,
    sink,
    sink_by_share,
    sink_by_step,
    weigh_edges,
    weigh_masked,
    weigh_target,
)
from asperity.kernels.influence import Convolution, convolve, quarter_spectrum
from asperity.kernels.lanes import lanes, load, store, sum_beside
from asperity.kernels.options import CALLED, INNER, REASSOCIATE, compiled
from asperity.kernels.rims import Rims, set_rims, set_shares, weigh


def inverse_stencil(table: NDArray) -> NDArray:
    """Fit a 13-point stencil whose symbol approximates the inverse of that of a kernel (≥ 32, ≥ 32).

    The kernel is given at non-negative separations. Returns the taps at (0,0), (±1,0), (0,±1), (±1,±1),
    (±2,0), (0,±2), in units of the inverse kernel. The symbol is positive, so the stencil restricted to any
    set of cells is positive definite.
    """
    n = 32
    symbol = quarter_spectrum(quarter_spectrum(table[:n, :n], 1), 0)
    q = 2.0 * np.pi * (np.arange(n) + 0.25) / n
    qx = q[:, None]
    qy = q[None, :]
    cx, cy = np.cos(qx), np.cos(qy)
    one = np.ones_like(symbol)
    taps = [one, 2 * cx * one, 2 * cy * one, 4 * cx * cy, 2 * np.cos(2 * qx) * one, 2 * np.cos(2 * qy) * one]
    basis = np.stack([tap * symbol for tap in taps], axis=-1).reshape(-1, len(taps))
    coefficients = np.linalg.lstsq(basis, np.ones(symbol.size), rcond=None)[0]
    lowest = float(np.min(np.stack(taps, axis=-1) @ coefficients))
    # the fit may fall below zero, where steps would climb: it keeps a tenth of the least it stands for
    floor = 0.1 / float(symbol.max())
    coefficients[0] += max(0.0, floor - lowest)
    return coefficients


@compiled(**INNER)
def _beside_rows(taps: NDArray, b: Box, q: int) -> tuple[Any, Any, Any]:
    """What is masked in a vector of cells, the sum above and below, and what they give to those beside."""
    m = load(b.masked, 2 * b.pitch + q)
    both = load(b.masked, b.pitch + q) + load(b.masked, 3 * b.pitch + q)
    return m, both, taps[2] * m + taps[3] * both


@compiled(**INNER)
def _apply(taps: NDArray, b: Box, target: NDArray) -> None:
    """Apply the stencil (Pa/m) to what is masked, m, into `target`.

    Vectors begin where lines of the cache do, if rows do: those that do not would be read twice.
    """
    part = lanes(target)
    before, _, given_before = _beside_rows(taps, b, -part)
    now, both, given = _beside_rows(taps, b, 0)
    for q in range(0, len(target), part):
        after, both_after, given_after = _beside_rows(taps, b, q + part)
        far = load(b.masked, q) + load(b.masked, 4 * b.pitch + q)
        along = taps[0] * now + taps[1] * both + taps[4] * far
        across = sum_beside(given_before, given, given_after, 1) + taps[5] * sum_beside(before, now, after, 2)
        store(target, q, along + across)
        before, now, both = now, after, both_after
        given_before, given = given, given_after


@compiled(**INNER, **REASSOCIATE)
def precondition(b: Box, taps: NDArray, target: NDArray, rims: Rims | None) -> tuple[float, float, float]:
    """Apply the stencil (Pa/m) to what is masked, m, where that is not zero, into `target`.

    At rims what is masked is weighed: with M its unweighed values, returns M·target, (M − previous)·target
    and the sum of the target. A cell of the weight w there moves by about 1/(2/w − 1) of what others do to a
    residual of its own, which is more than the w² of a stencil that is weighed on both sides.
    """
    _apply(taps, b, target)
    masked = b.masked[REACH * b.pitch :]
    real = b.z.dtype.type
    zero, half, one = real(0.0), real(0.5), real(1.0)
    rho = change = total = zero
    for q in range(len(target)):
        g = masked[q]
        s = target[q] if g != zero else zero
        moved = s
        if rims is not None:
            weight = rims.weight[q]
            s += taps[0] * (half - half * weight * weight) * (rims.softness[q] - one) * g
            moved = weight * s
        target[q] = moved
        rho += g * s
        change += g * s - b.previous[q] * moved
        total += moved
    return rho, change, total


@compiled(**INNER)
def _precondition(
    b: Box, taps: NDArray, target: NDArray, rims: Rims | None, edges: SoftCells
) -> tuple[float, float, float]:
    """Precondition as `precondition` does, and move the less what gives way at rims and edges."""
    weigh_masked(b, edges)
    rho, change, total = precondition(b, taps, target, rims)
    moved, lost = weigh_target(b, edges, target)
    return rho, change + moved, total - lost


WHOLE = 0.85
"""Share of a clipped step from which on it is taken whole: cells that reached a bound shall stay there."""
LEAST, MOST = 0.1, 3.0
"""Bounds of the expected length of a step; an exact inverse as preconditioner would make it one."""
PATIENCE, OFTEN = 100, 10
"""Iterations after which every tenth is a step of the projected gradient."""
SETTLED = 1.25
"""Relative change of the force expected, over `rtol`, from which on it counts as settled."""
CONJUGATE, PRECONDITIONED, STEEPEST = range(3)
"""What a step aims at: each is tried if the one before would do no work."""


class Task(NamedTuple):
    """What is asked of a solution."""

    hardness: float  # upper bound of the pressure, Pa (may be infinite)
    total: float  # sum of the pressure over the cells, Pa; negative at a given approach
    # by how much the approach falls with the sum of the pressure, m/Pa: the bodies yield; zero at a load
    compliance: float
    largest: float  # largest overlap of the undeformed bodies, m
    rtol: float  # largest complementarity residual relative to that overlap
    loose: float  # likewise, if the force settles: see `carried_and_lacked`; zero where it is not looked at
    # no pressure of unit norm displaces by more, m/Pa: bounds the step of the projected gradient
    softest: float
    max_iterations: int  # iterations allowed


@compiled(**INNER, **REASSOCIATE)
def _free(
    pressure: NDArray, b: Box, rims: Rims | None, hardness: float, level: float, tolerance: float
) -> float:
    """Mask the residual above a level with the free set, weighed at rims.

    Returns how many cells violate complementarity.
    """
    real = b.z.dtype.type  # numbers of another precision would be computed with in double
    zero = real(0.0)
    one, two = real(1.0), real(2.0)
    target = b.masked[REACH * b.pitch :]
    hardness = real(hardness)
    level = real(level)
    tolerance = real(tolerance)
    violated = zero
    for q in range(len(pressure)):
        p = pressure[q]
        r = b.residual[q] - level
        masked = r if p > zero else min(r, zero)
        masked = masked if p < hardness else max(masked, zero)
        allowed = tolerance
        if rims is not None:
            allowed *= two * rims.softness[q] - one
        violated += zero if abs(masked) <= allowed else one
        target[q] = masked if rims is None else masked * rims.weight[q]
    return violated


@compiled(**INNER, **REASSOCIATE)
def _turn(b: Box, beta: float) -> None:
    """Set the search direction from z and the one before."""
    zero = b.z.dtype.type(0.0)
    factor = b.z.dtype.type(beta)
    for q in range(len(b.z)):
        b.direction[q] = factor * b.direction[q] - b.z[q] if b.z[q] != zero else zero


@compiled(**INNER)
def _turn_to_gradient(b: Box, level: float) -> None:
    """Let the search go down the steepest way, where cells at a bound may go, too."""
    for q in range(len(b.z)):
        b.z[q] = b.residual[q] - level


@compiled(**INNER, **REASSOCIATE)
def _sum(values: NDArray) -> float:
    total = values.dtype.type(0.0)
    for q in range(len(values)):
        total += values[q]
    return total


@compiled(**INNER, **REASSOCIATE)
def _project(b: Box, beta: float, length: float, hardness: float) -> tuple[float, float]:
    """Turn the search direction and set the step to a length along it, projected on the bounds.

    Returns its work against the residual, and how many cells the bounds held back.
    """
    real = b.z.dtype.type
    zero = real(0.0)
    one = real(1.0)
    before = real(beta)
    factor = real(length)
    cap = real(hardness)
    work, clipped = zero, zero
    for q in range(len(b.z)):
        z = b.z[q]
        direction = before * b.direction[q] - z if z != zero else zero
        b.direction[q] = direction
        p = b.pressure[q]
        wanted = p + factor * direction
        kept = min(max(wanted, zero), cap)
        clipped += one if kept != wanted else zero
        step = kept - p
        b.step[q] = step
        work += b.residual[q] * step
    return work, clipped


@compiled(**INNER)
def _aim(b: Box, aim: int, beta: float, length: float, level: float, task: Task) -> tuple[float, float]:
    """Set direction and step; return the work of the step and how many cells the bounds held back."""
    if aim == STEEPEST:
        _turn_to_gradient(b, level)
        if task.total >= 0.0:
            for q in range(len(b.unit)):
                b.unit[q] = 1.0
        length = 1.0 / task.softest
    if aim != CONJUGATE:
        beta = 0.0
    if task.total < 0.0:
        return _project(b, beta, length, task.hardness)
    _turn(b, beta)
    work, clipped, _found = project_at_load(b, length, level, task.hardness, task.total)
    return work, clipped


@compiled(**INNER)
def _leaves(b: Box, share: float, hardness: float) -> bool:
    """Whether a share of the step leaves the bounds."""
    held = 0
    for q in range(len(b.z)):
        wanted = b.pressure[q] + share * b.step[q]
        held += wanted < 0.0 or wanted > hardness
    return held > 0


@compiled(**INNER, **REASSOCIATE)
def _advance(
    b: Box, rims: Rims | None, share: float, hardness: float, margin: float, completed: float
) -> None:
    """Go a share of the step, within the bounds, and on them within a margin; then no gap is taken off.

    Where the pressure is between them, `unit` is completed by another share.
    """
    real = b.z.dtype.type
    zero = real(0.0)
    factor, added = real(share), real(completed)
    cap = real(hardness)
    low = real(margin)
    high = real(hardness - margin)
    for q in range(len(b.z)):
        step = b.step[q]
        p = b.pressure[q] + factor * step
        p = zero if p <= low else p
        p = cap if p >= high else p
        unit = b.unit[q] + added * step
        unit = unit if p > zero else zero
        b.pressure[q] = p
        b.unit[q] = unit if p < cap else zero
    if rims is None:
        for q in range(len(b.z)):  # few arrays to a loop: else the compiler does not make vectors of it
            b.previous[q] = b.residual[q]
            b.residual[q] += factor * b.response[q]
    else:
        for q in range(len(b.z)):
            b.previous[q] = b.residual[q]
            bare = rims.bare[q] + factor * b.response[q]
            rims.bare[q] = bare
            b.residual[q] = bare


@compiled(**CALLED, **REASSOCIATE)
def carried_and_lacked(b: Box) -> tuple[float, float]:
    """Sum of the pressure, Pa, and what it lacks, but for what is of second order.

    On a contact set the pressure lacks A⁻¹r, where r is the gap that is left to close, and its sum lacks rᵀu,
    where Au = 1: what an approach adds to the pressure. If u is near that, the error is a product of two
    small ones.
    """
    total = lacked = b.z.dtype.type(0.0)
    for q in range(len(b.unit)):
        total += b.pressure[q]
        lacked -= b.unit[q] * b.residual[q]
    return total, lacked


@compiled(**INNER, **REASSOCIATE)
def _curvature(b: Box, rims: Rims | None, stiffness: float) -> tuple[float, float]:
    """Curvature of the energy along the step, Pa m, with what cells at rims add to it.

    And what `unit` lacks there: the sum of the step less what `unit` displaces along it.
    """
    real = b.z.dtype.type
    one, yields = real(1.0), real(2.0 / stiffness)
    curvature = missing = real(0.0)
    for q in range(len(b.step)):
        step = b.step[q]
        response = b.response[q]
        if rims is not None:
            response += yields * (rims.softness[q] - one) * step
        curvature += step * response
        missing += step - b.unit[q] * response
    return curvature, missing


@compiled(**INNER, **REASSOCIATE)
def _yield(pressure: NDArray, compliance: float, response: NDArray) -> float:
    """Add what bodies yield to a pressure, Pa, to what it displaces, m; return that."""
    yielded = response.dtype.type(compliance * _sum(pressure))
    for q in range(len(response)):
        response[q] += yielded
    return yielded


@compiled(**CALLED)
def true_residual(c: Convolution, b: Box, task: Task, edges: SoftCells) -> None:
    """Compute the residual of the pressure, with the kernel for this box, its edges and what a task says."""
    convolve(c, b.pressure, b.nx, b.ny, b.pitch, b.work, b.response)
    if task.compliance > 0.0:
        _yield(b.pressure, task.compliance, b.response)
    for q in range(len(b.residual)):
        b.residual[q] = b.response[q] - b.overlap[q]
    sink(b, edges)


@compiled(**INNER, **REASSOCIATE)
def _survey_row(b: Box, i: int, level: float, hardness: float, rims: Rims | None) -> tuple[float, float]:
    """Count the cells of a row under pressure or in overlap; return that and the sum of the pressure, Pa.

    Their number in each column is added to the first row of `direction`, and that of `step` is raised to the
    largest residual there.
    """
    real = b.z.dtype.type
    zero, one = real(0.0), real(1.0)
    level, cap = real(level), real(hardness)
    row = slice(i * b.pitch, i * b.pitch + b.ny)
    pressure, residual, shares = b.pressure[row], b.residual[row], b.z[row]
    touched, worst = b.direction[: b.ny], b.step[: b.ny]
    count, total = zero, zero
    for j in range(len(pressure)):
        p = pressure[j]
        r = residual[j] - level
        there = one if p > zero or r < zero else zero
        unmet = max(abs(r) if p < cap else r, zero) * there
        if rims is not None:
            unmet *= shares[j]
        touched[j] += there
        worst[j] = max(worst[j], unmet)
        count += there
        total += p
    return count, total


@compiled(**CALLED)
def survey(b: Box, task: Task, rims: Rims | None) -> tuple[float, float, int, int, int, int]:
    """Find how well a pressure with a known residual solves the task, and where something is left to solve.

    Residuals at rims count by the share that they move of what other cells would.
    Returns the largest complementarity residual, m; the approach beyond that of the overlap, m, zero if that
    is given and the bodies do not yield; and first and end row and column of the smallest box that holds all
    cells under pressure or in overlap, zeros if there are none.
    """
    level = find_level(b, task.hardness) if task.total >= 0.0 else 0.0
    if rims is not None:
        set_shares(b, rims)
    first = b.nx
    end = 0
    left = 0
    right = b.ny
    worst, total = 0.0, 0.0
    for j in range(b.ny):
        b.direction[j] = b.step[j] = 0.0
    for i in range(b.nx):
        touched, carried = _survey_row(b, i, level, task.hardness, rims)
        total += carried
        if touched > 0.0:
            first = min(first, i)
            end = i + 1
    if end:
        while not b.direction[left] > 0.0:
            left += 1
        while not b.direction[right - 1] > 0.0:
            right -= 1
    for j in range(left, right):
        worst = max(worst, float(b.step[j]))
    level -= task.compliance * total
    return (worst, level, first, end, left, right) if end else (worst, level, 0, 0, 0, 0)


@compiled(**INNER)
def _to_gradient(
    b: Box, taps: NDArray, task: Task, level: float, rims: Rims | None, edges: SoftCells
) -> tuple[float, float]:
    """Precondition the residual of free cells, of a load with as much added as taken; its two products."""
    weigh_edges(b, edges, taps[0])
    rho, change, added = _precondition(b, taps, b.z, rims, edges)
    if task.total < 0.0:
        return rho, change
    mark_free(b, task.hardness, level)
    if rims is not None:
        weigh(b, rims)
    units = _precondition(b, taps, b.unit, rims, edges)[2]
    if rims is not None or edges.number[0]:
        mark_free(b, task.hardness, level)
    return balance_load(b, added / units, level)


@compiled(**CALLED)
def solve(
    c: Convolution, taps: NDArray, b: Box, task: Task, done: int, rims: Rims | None, edges: SoftCells
) -> tuple[int, bool, bool]:
    """Solve the task on a box, from a residual and a pressure that is within the bounds and carries the load.

    Kernel in m/Pa, taps of `inverse_stencil` in Pa/m; rims where cells are covered in part, as `set_rims`
    left them; the edges in this box. Returns the iterations in all, with those done before; whether there is
    a step that lowers the energy: if not, rounding allows no more; and whether the force has settled.
    """
    cap = task.hardness
    at_load = task.total >= 0.0
    level = 0.0
    margin = rounding(cap, task.total)
    rho = 0.0
    length = 1.0
    iteration = done
    moving = True
    yielded = task.compliance * _sum(b.pressure)
    looks_ahead = task.loose > 0.0
    settled = False
    expected = np.inf
    while iteration < task.max_iterations:
        if at_load:
            level = find_level(b, cap)
        tolerance = task.rtol * (task.largest + level - yielded)
        if looks_ahead:
            carried, lacked = carried_and_lacked(b)
            force = carried + lacked
            settled = abs(force - expected) <= SETTLED * task.rtol * force
            expected = force
            tolerance *= task.loose / task.rtol if settled else 1.0
        violated = _free(b.pressure, b, rims, cap, level, tolerance)
        if not violated:
            break
        iteration += 1
        before = rho
        rho, change = _to_gradient(b, taps, task, level, rims, edges)
        beta = max(0.0, change / before) if before > 0.0 else 0.0
        aim = CONJUGATE if beta > 0.0 else PRECONDITIONED
        if iteration > PATIENCE and iteration % OFTEN == 0:
            aim = STEEPEST
        moving, work, clipped = False, 0.0, 0.0
        while not moving and aim <= STEEPEST:
            work, clipped = _aim(b, aim, beta, length, level, task)
            moving = work < 0.0
            aim += not moving
        if not moving:
            break
        convolve(c, b.step, b.nx, b.ny, b.pitch, b.work, b.response)
        sink_by_step(b, edges)
        further = _yield(b.step, task.compliance, b.response) if task.compliance > 0.0 else 0.0
        curvature, missing = _curvature(b, rims, taps[0])
        moving = curvature > 0.0
        if not moving:
            break
        share = -work / curvature
        if aim == STEEPEST:
            rho = 0.0
        else:
            length = min(max(length * share, LEAST), MOST)
        if clipped > 0.0:
            share = 1.0 if share >= WHOLE else share
        elif share > 1.0 and _leaves(b, share, cap):
            share = 1.0
        _advance(b, rims, share, cap, margin, missing / curvature if looks_ahead else 0.0)
        sink_by_share(b, edges, share)
        set_rims(b, rims, level, taps[0], cap)
        yielded += share * further
    return iteration, moving, settled
