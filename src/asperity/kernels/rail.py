"""Rolling on a rail, compiled: the rail by poles or by scattering, a wheel, and the contact between them.

The force varies linearly over a step. For that the wheel is exact, and so is the rail, whose kernel is
the response to one hat-shaped piece of such a force. Rail and wheel are then affine in the force at the
end of the step, and one scalar equation remains.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.modal import backward, solve_step
from asperity.kernels.options import ENTERED, INNER, LOOP, REASSOCIATE, compiled


class Vehicle(NamedTuple):
    """Wheel and rail: what does not change while rolling."""

    decay: NDArray  # (2 p,), poles of the rail, per step: real parts, then imaginary parts
    # (cells + 1, 2 p), residues at equal places over one sleeper bay, both ends included, m/N, in the same
    # order
    residue: NDArray
    # (cells + 1,), displacement at the end of a step for unit force at the end, m/N, at the same places
    direct: NDArray
    # (positions, taps), the kernel itself where the rail is scattered, m/N; else without rows
    scattered: NDArray
    flexible_decay: NDArray  # (w,), poles of the wheel per step
    flexible_before: NDArray  # (w,), factors of the force at the start of the step, m/N
    flexible_now: NDArray  # (w,), factors of the force at its end, m/N
    flexible_compliance: float  # twice the real part of the sum of the last, m/N
    mass: float  # of the wheel, kg
    load: float  # of the wheel, N
    time_step: float  # s
    # compliance in series with the contact, m/N, that keeps a step stable which is too long for it
    softening: float
    first: float  # position at step zero, in sleeper bays
    stride: float  # distance rolled in a step, in sleeper bays


class RailMotion(NamedTuple):
    """What changes from step to step; the arrays are written in place."""

    rail: NDArray  # (2 p,), states of the poles: real parts, then imaginary parts, m
    ring: NDArray  # (taps,), displacement to come where the rail is scattered, m
    flexible: NDArray  # (w,), states of the wheel's poles, m
    wheel: NDArray  # (2,), rigid displacement, m, and velocity, m/s
    force: NDArray  # (2,), contact force, N, now and one step ago
    approach: NDArray  # (2,), as the law sees it, m, now and one step ago
    # (2,), displacements of rail and flexible wheel at the end of the step without its last force, m
    free: NDArray
    counts: NDArray  # (3,), steps done, steps not converged, evaluations of the law


class RailRecord(NamedTuple):
    """Time histories (n,), written in place."""

    force: NDArray  # contact force, N
    approach: NDArray  # m
    wheel: NDArray  # displacement at the contact, m
    rail: NDArray  # displacement at the contact, m


@compiled(**INNER)
def place(vehicle, step, cells):  # type: ignore[no-untyped-def]
    """Cell of the bay in which the contact is at a step, and the share of the cell behind it."""
    bays = vehicle.first + vehicle.stride * step
    at = (bays - np.floor(bays)) * cells
    cell = min(int(at), cells - 1)
    return cell, at - cell


@compiled(**ENTERED)
def direct_at(vehicle, step):  # type: ignore[no-untyped-def]
    """Displacement of the rail at a step for unit force there, m/N."""
    cell, share = place(vehicle, step, vehicle.direct.shape[0] - 1)
    return vehicle.direct[cell] + share * (vehicle.direct[cell + 1] - vehicle.direct[cell])


@compiled(**ENTERED)
def cubic_weights(t):  # type: ignore[no-untyped-def]
    """Lagrange weights of the nodes -1, 0, 1, 2 at a place t between 0 and 1."""
    before, after, beyond = t + 1.0, t - 1.0, t - 2.0
    return (
        -t * after * beyond / 6.0,
        before * after * beyond / 2.0,
        -before * t * beyond / 2.0,
        before * t * after / 6.0,
    )


@compiled(**INNER, **REASSOCIATE)
def advance_poles(vehicle, motion, step, force):  # type: ignore[no-untyped-def]
    """Advance the rail by one step under the force at its start, N; return its displacement, m.

    That is the displacement at the end without the force there.
    """
    cell, share = place(vehicle, step, vehicle.direct.shape[0] - 1)
    state, decay = motion.rail, vehicle.decay
    residue = vehicle.residue
    low, high = force * (1.0 - share), force * share
    poles = state.shape[0] // 2
    total = 0.0
    for p in range(poles):
        a, b, c, d = state[p], state[poles + p], decay[p], decay[poles + p]
        real = c * a - d * b + low * residue[cell, p] + high * residue[cell + 1, p]
        q = poles + p
        state[q] = c * b + d * a + low * residue[cell, q] + high * residue[cell + 1, q]
        state[p] = real
        total += real
    return total


@compiled(**INNER, **REASSOCIATE)
def scatter(vehicle, motion, step, force):  # type: ignore[no-untyped-def]
    """Add to the ring what a force at a step, N, will do; the displacement of the next step, m.

    The start positions of the kernel are interpolated by a periodic cubic.
    """
    rows, taps = vehicle.scattered.shape
    cell, t = place(vehicle, step, rows)
    before, after = vehicle.scattered[(cell + rows - 1) % rows], vehicle.scattered[(cell + 1) % rows]
    here, beyond = vehicle.scattered[cell % rows], vehicle.scattered[(cell + 2) % rows]
    w0, w1, w2, w3 = cubic_weights(t)
    w0, w1, w2, w3 = w0 * force, w1 * force, w2 * force, w3 * force
    ring, now = motion.ring, step % taps
    for k in range(1, taps - now):
        ring[now + k] += w0 * before[k] + w1 * here[k] + w2 * after[k] + w3 * beyond[k]
    for k in range(max(taps - now, 1), taps):
        ring[now + k - taps] += w0 * before[k] + w1 * here[k] + w2 * after[k] + w3 * beyond[k]
    ring[now] = 0.0
    return ring[(step + 1) % taps]


@compiled(**INNER)
def advance_rail(vehicle, motion, step, force):  # type: ignore[no-untyped-def]
    """Advance the rail by poles or by scattering; see `advance_poles`."""
    if vehicle.scattered.shape[0] > 0:
        return scatter(vehicle, motion, step, force)
    return advance_poles(vehicle, motion, step, force)


@compiled(**LOOP)
def preload(vehicle, motion, force, steps):  # type: ignore[no-untyped-def]
    """Let a constant force, N, roll up to step zero.

    Returns the rail's displacement, m, at step zero and one step before, without the force at that step.
    """
    now, before = 0.0, 0.0
    for step in range(-steps, 0):
        before = now
        now = advance_rail(vehicle, motion, step, force)
    return now, before


@compiled(**INNER)
def free_rail_step(vehicle, motion, step):  # type: ignore[no-untyped-def]
    """Advance all but the last force of the step that ends at `step`; see `modal.free_beam_step`."""
    h, force = vehicle.time_step, motion.force[0]
    motion.free[0] = advance_rail(vehicle, motion, step - 1, force)
    flexible = 0.0
    for w in range(motion.flexible.shape[0]):
        state = vehicle.flexible_decay[w] * motion.flexible[w] - vehicle.flexible_before[w] * force
        motion.flexible[w] = state
        flexible += 2.0 * state.real
    motion.free[1] = flexible
    wheel = motion.wheel[0] + h * motion.wheel[1] + h * h / vehicle.mass * (0.5 * vehicle.load - force / 3.0)
    approach = wheel + flexible - motion.free[0]
    compliance = direct_at(vehicle, step) + h * h / (6.0 * vehicle.mass) + vehicle.flexible_compliance
    return backward(approach, compliance + vehicle.softening, motion.approach, h)


@compiled(**INNER)
def complete_rail_step(vehicle, motion, record, step, force, evaluations, converged):  # type: ignore[no-untyped-def]
    """Apply the force at the end of a step, N, advance the state and write the records."""
    h, mass, before = vehicle.time_step, vehicle.mass, motion.force[0]
    motion.wheel[0] += h * motion.wheel[1]
    motion.wheel[0] += h * h / mass * (0.5 * vehicle.load - before / 3.0 - force / 6.0)
    motion.wheel[1] += h / mass * (vehicle.load - 0.5 * (before + force))
    for w in range(motion.flexible.shape[0]):
        motion.flexible[w] -= vehicle.flexible_now[w] * force
    rail = motion.free[0] + direct_at(vehicle, step) * force
    wheel = motion.wheel[0] + motion.free[1] - vehicle.flexible_compliance * force
    motion.force[1], motion.force[0] = before, force
    motion.approach[1], motion.approach[0] = motion.approach[0], wheel - rail - vehicle.softening * force
    record.force[step], record.approach[step] = force, wheel - rail
    record.wheel[step], record.rail[step] = wheel, rail
    motion.counts[0] = step
    motion.counts[1] += 0 if converged else 1
    motion.counts[2] += evaluations


@compiled(**LOOP)
def roll_rail(vehicle, motion, record, law, stop, largest):  # type: ignore[no-untyped-def]
    """Roll a compiled law from the state's step to `stop`; False from a force larger than `largest`, or NaN.

    Then the state stands at that step.
    """
    for step in range(motion.counts[0] + 1, stop + 1):
        free = free_rail_step(vehicle, motion, step)
        guess = 2.0 * motion.force[0] - motion.force[1]
        force, evaluations, converged = solve_step(law, step, free, vehicle.load, guess)
        complete_rail_step(vehicle, motion, record, step, force, evaluations, converged)
        if not abs(force) <= largest:
            return False
    return True
