"""Rolling, compiled: exact modal stepping of a beam, a rigid ball, and the contact between them.

The force varies linearly over a step; for that the motion of every mode and of the ball is exact.
Displacement and approach are then affine in the force at the end of the step, and one scalar
equation remains.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.options import INNER, LOOP, REASSOCIATE, compiled
from asperity.kernels.pointforce import evaluate, with_damping

FORCE_TOLERANCE = 1e-10  # of the force plus the load, at the end of each step
ITERATIONS = 100
TAYLOR_RADIUS, TAYLOR_TERMS = 0.5, 14  # remainder below 1e-16

BEAM_WORK, BEAM_DAMPING, CONTACT_WORK, SLOPE_WORK, THROUGHPUT = range(5)


class System(NamedTuple):
    """What does not change while rolling."""

    coefficients: NDArray  # (8, modes), from `modal_coefficients`
    stiffness: NDArray  # (modes,), ω² of mass-normalised modes
    damping: NDArray  # (modes,), 2 ζ ω
    sensors: NDArray  # (sensors, modes), mode shapes at the sensors, kg^(−1/2)
    mass: float  # of the ball, kg
    load: float  # of the ball, N
    time_step: float  # s
    speed: float  # m/s
    # compliance in series with the contact, m/N, that keeps a step stable which is too long for it
    softening: float


class BeamMotion(NamedTuple):
    """What changes from step to step; the arrays are written in place."""

    displacement: NDArray  # (modes,), modal coordinates
    velocity: NDArray  # (modes,)
    acceleration: NDArray  # (modes,)
    ball: NDArray  # (2,), displacement, m, and velocity, m/s, of the ball
    force: NDArray  # (2,), contact force, N, now and one step ago
    approach: NDArray  # (2,), as the law sees it, m, now and one step ago
    power: NDArray  # (5,), powers now, W, in the order of `ledger`
    # (5,), time integrals, J: work on the beam, its damping, work on the contact, against the slope,
    # throughput
    ledger: NDArray
    counts: NDArray  # (3,), steps done, steps not converged, evaluations of the law


class BeamRecord(NamedTuple):
    """Time histories, written in place."""

    force: NDArray  # (n,), contact force, N
    approach: NDArray  # (n,), m
    ball: NDArray  # (n,), displacement, m
    beam: NDArray  # (n,), displacement under the ball, m
    acceleration: NDArray  # (sensors, n), of the beam, m/s²


def modal_coefficients(natural: NDArray, damping_ratio: NDArray, time_step: float) -> NDArray:
    """Exact step of ``q'' + 2 ζ ω q' + ω² q = p`` for a force p linear over the step.

    ω in rad/s, zero for a free mode; ζ one or more for an overdamped one. Returns (8, modes): factors of q,
    q', p at the start and p at the end, first those that give q at the end of the step, then those that give
    q' there. They are the matrix exponential of the oscillator extended by its force, in time units of the
    step (Van Loan, IEEE Trans. Autom. Control 23 (1978) 395-404): one form for all kinds of modes, without
    division by ω.
    """
    phase = np.asarray(natural, dtype=float) * time_step
    generator = np.zeros((phase.size, 4, 4))
    generator[:, 0, 1] = generator[:, 1, 2] = generator[:, 2, 3] = 1.0
    generator[:, 1, 0] = -(phase**2)
    generator[:, 1, 1] = -2.0 * np.asarray(damping_ratio) * phase
    # rows and columns in q, h q', h^2 p_start, h^2 (p_end - p_start)
    step = exponentials(generator)[:, :2]
    step[..., 2] -= step[..., 3]
    step *= np.array([1.0, time_step, time_step**2, time_step**2])
    step[:, 1] /= time_step
    return np.ascontiguousarray(step.reshape(-1, 8).T)


def exponentials(matrices: NDArray) -> NDArray:
    """Exponentials of small matrices (k, n, n), all at once: Taylor series, scaled and squared."""
    largest = float(np.abs(matrices).sum(axis=2).max(initial=0.0))
    largest = max(largest, 1e-300)  # no logarithm of zero
    squarings = max(0, int(np.ceil(np.log2(largest / TAYLOR_RADIUS))))
    scaled, unit = matrices / 2.0**squarings, np.eye(matrices.shape[-1])
    result = unit + scaled / TAYLOR_TERMS
    for term in range(TAYLOR_TERMS - 1, 0, -1):
        result = unit + scaled @ result / term
    for _ in range(squarings):
        result = result @ result
    return result


@compiled(**INNER, **REASSOCIATE)
def free_beam_step(system, motion, shape, next_shape):  # type: ignore[no-untyped-def]
    """Where a step ends without the force at its end, and what that force does.

    Mode shapes (modes,) under the contact at start and end. Returns the approach, m, and its rate, m/s, for
    zero force at the end (see `backward`), and how much they fall per force there, m/N and m/(s N).
    """
    h, force, a = system.time_step, motion.force[0], system.coefficients
    beam, compliance = 0.0, 0.0
    for j in range(shape.shape[0]):
        q, v, p = motion.displacement[j], motion.velocity[j], shape[j] * force
        beam += next_shape[j] * (a[0, j] * q + a[1, j] * v + a[2, j] * p)
        compliance += next_shape[j] ** 2 * a[3, j]
    ball = motion.ball[0] + h * motion.ball[1] + h * h / system.mass * (0.5 * system.load - force / 3.0)
    compliance += h * h / (6.0 * system.mass) + system.softening
    return backward(ball - beam, compliance, motion.approach, h)


@compiled(**INNER)
def backward(approach, compliance, before, time_step):  # type: ignore[no-untyped-def]
    """Add the rate of the approach by the backward difference of second order, which damps at any step.

    The approach at the end of the step is for zero force there, `before` that at the start and one step
    earlier, m; the compliance is in m/N. Returns what `free_beam_step` does.
    """
    rate = (1.5 * approach - 2.0 * before[0] + 0.5 * before[1]) / time_step
    return approach, rate, compliance, 1.5 * compliance / time_step


@compiled(**INNER)
def refine(low, high, approach, residual, slope, iteration):  # type: ignore[no-untyped-def]
    """Newton step inside a bracket that it narrows; bisection where Newton fails or dawdles.

    The bracket is infinite where still open; the residual rises. Returns the bracket and the next trial
    value.
    """
    if residual < 0.0:
        low = max(low, approach)
    else:
        high = min(high, approach)
    # without contact the residual's slope is one; a smaller one is a texture that outruns the approach
    trial = approach - residual / max(slope, 1.0)
    closed = low > -np.inf and high < np.inf
    # eight steps are more than Newton needs; from there every other one halves the bracket, so that it ends
    if closed and (not (low < trial < high) or (iteration > 8 and iteration % 2 == 0)):
        trial = 0.5 * (low + high)
    return low, high, trial


@compiled(**INNER)
def tolerance(approach, compliance, force, load, relative):  # type: ignore[no-untyped-def]
    """Largest residual of the approach that counts as solved, m."""
    # the last term is what rounding leaves of the approach
    return relative * compliance * (abs(force) + load) + 1e-15 * abs(approach)


@compiled(**INNER)
def solve_step(law, step, free, load, guess):  # type: ignore[no-untyped-def]
    """Contact force at the end of a step, N, evaluations of the law that it took, whether it converged.

    `free` is from `free_beam_step`, `load` the scale of the force and `guess` the force expected, N.
    """
    free_approach, rate, compliance, rate_compliance = free
    low, high, approach = -np.inf, np.inf, free_approach - compliance * guess
    for iteration in range(ITERATIONS):
        elastic, stiffness = evaluate(law, step, approach)
        force, stiffness = with_damping(
            elastic, stiffness, rate, rate_compliance, law.damping, law.damped_in_flight
        )
        residual = approach - free_approach + compliance * force
        limit = tolerance(free_approach, compliance, force, load, FORCE_TOLERANCE)
        if abs(residual) <= limit:
            return force, iteration + 1, True
        low, high, approach = refine(low, high, approach, residual, 1.0 + compliance * stiffness, iteration)
        if law.damping > 0.0 and abs(high - low) <= limit:
            # a damper engages with a jump: the force lies inside it
            return (free_approach - approach) / compliance, iteration + 1, True
    return (free_approach - approach) / compliance, ITERATIONS, False


@compiled(**INNER, **REASSOCIATE)
def observe(system, motion, record, step, shape, slope):  # type: ignore[no-untyped-def]
    """Write the records of a step and the powers of its energy ledger.

    Mode shapes and slopes (modes,) under the contact.
    """
    force = motion.force[0]
    beam, beam_rate, beam_slope, dissipated = 0.0, 0.0, 0.0, 0.0
    # sums apart from what is written: compiled together, their order would hang on where arrays lie
    for j in range(shape.shape[0]):
        q, v = motion.displacement[j], motion.velocity[j]
        motion.acceleration[j] = shape[j] * force - system.damping[j] * v - system.stiffness[j] * q
    for j in range(shape.shape[0]):
        q, v = motion.displacement[j], motion.velocity[j]
        beam += shape[j] * q
        beam_rate += shape[j] * v
        beam_slope += slope[j] * q
        dissipated += system.damping[j] * v * v
    for s in range(system.sensors.shape[0]):
        total = 0.0
        for j in range(shape.shape[0]):
            total += system.sensors[s, j] * motion.acceleration[j]
        record.acceleration[s, step] = total
    climb = system.speed * beam_slope
    record.force[step] = force
    record.ball[step], record.beam[step] = motion.ball[0], beam
    record.approach[step] = motion.ball[0] - beam
    motion.power[BEAM_WORK] = force * beam_rate
    motion.power[BEAM_DAMPING] = dissipated
    motion.power[CONTACT_WORK] = force * (motion.ball[1] - beam_rate - climb)
    motion.power[SLOPE_WORK] = force * climb
    motion.power[THROUGHPUT] = abs(force * beam_rate) + abs(force * motion.ball[1])


@compiled(**INNER, **REASSOCIATE)
def complete_beam_step(  # type: ignore[no-untyped-def]
    system, motion, record, step, shape, next_shape, next_slope, force, evaluations, converged
):
    """Advance the state over a step, the force at its end, N, known, and keep the books.

    Mode shapes (modes,) under the contact at start and end, and slopes at the end.
    """
    h, mass, a, before = system.time_step, system.mass, system.coefficients, motion.force[0]
    q, v, ahead = motion.displacement, motion.velocity, motion.acceleration  # `observe` overwrites the last
    # one array is written at a time, so that loops vectorise
    for j in range(shape.shape[0]):
        p, next_p = shape[j] * before, next_shape[j] * force
        ahead[j] = a[0, j] * q[j] + a[1, j] * v[j] + a[2, j] * p + a[3, j] * next_p
    for j in range(shape.shape[0]):
        p, next_p = shape[j] * before, next_shape[j] * force
        v[j] = a[4, j] * q[j] + a[5, j] * v[j] + a[6, j] * p + a[7, j] * next_p
    for j in range(shape.shape[0]):
        q[j] = ahead[j]
    motion.ball[0] += h * motion.ball[1] + h * h / mass * (0.5 * system.load - before / 3.0 - force / 6.0)
    motion.ball[1] += h / mass * (system.load - 0.5 * (before + force))
    motion.force[1], motion.force[0] = before, force
    for k in range(motion.ledger.shape[0]):
        motion.ledger[k] += 0.5 * h * motion.power[k]
    observe(system, motion, record, step, next_shape, next_slope)
    motion.approach[1], motion.approach[0] = (
        motion.approach[0],
        record.approach[step] - system.softening * force,
    )
    for k in range(motion.ledger.shape[0]):
        motion.ledger[k] += 0.5 * h * motion.power[k]
    motion.counts[0] = step
    motion.counts[1] += 0 if converged else 1
    motion.counts[2] += evaluations


@compiled(**LOOP)
def roll_beam(system, motion, record, law, shapes, slopes, offset, stop, largest):  # type: ignore[no-untyped-def]
    """Roll a compiled law from the state's step to `stop`; False from a force larger than `largest`, or NaN.

    Then the state stands at that step. Row 0 of mode shapes and slopes (k, modes) belongs to the step
    `offset`.
    """
    for step in range(motion.counts[0] + 1, stop + 1):
        row = step - offset
        shape, next_shape, next_slope = shapes[row - 1], shapes[row], slopes[row]
        free = free_beam_step(system, motion, shape, next_shape)
        guess = 2.0 * motion.force[0] - motion.force[1]
        force, evaluations, converged = solve_step(law, step, free, system.load, guess)
        complete_beam_step(
            system, motion, record, step, shape, next_shape, next_slope, force, evaluations, converged
        )
        if not abs(force) <= largest:
            return False
    return True
