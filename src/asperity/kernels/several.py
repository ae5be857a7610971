"""Several contacts at once, compiled: modes of a structure, bodies that roll, and the forces between them.

All forces are linear over a step; for that every mode and every body is exact, and all displacements are
affine in the forces at the end of the step. Those solve one convex problem, contact after contact, each
exactly with the others held, until all laws are met at once. What one contact does to the others goes through
the coordinates of structure and bodies, so that the cost grows with the number of contacts, not of pairs.
"""

from __future__ import annotations

from typing import NamedTuple

from numpy.typing import NDArray

from asperity.kernels.modal import FORCE_TOLERANCE, backward, solve_step
from asperity.kernels.options import INNER, LOOP, ONCE, REASSOCIATE, compiled
from asperity.kernels.pointforce import Prepared, evaluate
from asperity.kernels.rail import Channels, advance_channels, press_rail, rail_compliance

OVER_DAMPING, BODY_DAMPING, CONTACT_DAMPING, THROUGHPUT, CONTACT_WORK, SLOPE_WORK = range(6)
POWERS = 4
"""Those of the ledger that are integrated from their powers; work of contacts and slope is by the step."""


@compiled(**ONCE)
def contact_rates(system, motion, shapes, slopes, k):  # type: ignore[no-untyped-def]
    """Now at a contact: displacement of structure and of body, their rates, and the climb on the slope, m/s.

    The displacement of the structure is positive downwards, that of the body upwards; a rail, of which
    displacements alone are known, has no rate.
    """
    over, over_rate, slope = motion.rail_ahead[k], 0.0, 0.0
    for j in range(motion.displacement.shape[0]):
        q, v = motion.displacement[j], motion.velocity[j]
        over += shapes[k, j] * q
        over_rate += shapes[k, j] * v
        slope += slopes[k, j] * q
    b, states = system.body[k], system.core_shapes.shape[1]
    body, body_rate = 0.0, 0.0
    for j in range(states):
        body += system.core_shapes[k, j] * motion.core[b, j]
        body_rate += system.core_shapes[k, j] * motion.core[b, states + j]
    for j in range(system.flexible_shapes.shape[1]):
        body += system.flexible_shapes[k, j] * motion.flexible[0, b, j]
        body_rate += system.flexible_shapes[k, j] * motion.flexible[1, b, j]
    return over, over_rate, system.speed * slope, body, body_rate


@compiled(**ONCE)
def dissipated(system, motion):  # type: ignore[no-untyped-def]
    """Power that goes into the damping of the structure, and of the bodies, W."""
    over, bodies = 0.0, 0.0
    for j in range(motion.velocity.shape[0]):
        over += system.damping[j] * motion.velocity[j] * motion.velocity[j]
    states = system.core_damping.shape[1]
    for b in range(motion.core.shape[0]):
        for i in range(states):
            for j in range(states):
                rates = motion.core[b, states + i] * motion.core[b, states + j]
                bodies += system.core_damping[b, i, j] * rates
        for i in range(motion.flexible_push.shape[1]):
            bodies += system.flexible_damping[b, i] * motion.flexible[1, b, i] ** 2
    return over, bodies


@compiled(**ONCE)
def accelerations(system, motion, record, step):  # type: ignore[no-untyped-def]
    """Write those of the structure at its sensors."""
    for s in range(system.sensors.shape[0]):
        total = 0.0
        for j in range(motion.push.shape[0]):
            total += system.sensors[s, j] * (
                motion.push[j]
                - system.damping[j] * motion.velocity[j]
                - system.stiffness[j] * motion.displacement[j]
            )
        record.acceleration[s, step] = total


@compiled(**INNER, **REASSOCIATE)
def observe_contacts(system, motion, record, step, shapes, slopes):  # type: ignore[no-untyped-def]
    """Write the records of a step and the powers of its energy ledger, but for the contacts' dampers.

    Mode shapes and slopes (n, m) under the contacts. The approach that the laws see moves on, too.
    """
    power = motion.power
    for i in range(POWERS):
        power[i] = 0.0
    for k in range(motion.trial.shape[0]):
        over, over_rate, climb, body, body_rate = contact_rates(system, motion, shapes, slopes, k)
        force = motion.force[0, k]
        record.force[k, step], record.approach[k, step] = force, -(over + body)
        record.over[k, step], record.rolling[k, step] = over, -body
        power[THROUGHPUT] += abs(force * over_rate) + abs(force * body_rate)
        if step > 0:
            closer = record.approach[k, step] - record.approach[k, step - 1]
            if system.channels.source.shape[0] > 0:
                closer = record.rolling[k, step] - record.rolling[k, step - 1]
            work(system, motion, k, closer, -(body_rate + over_rate + climb), climb)
        motion.rate[k], motion.climb[k] = -(body_rate + over_rate + climb), climb
        motion.approach[1, k] = motion.approach[0, k]
        motion.approach[0, k] = record.approach[k, step] - system.softening[k] * force
    power[OVER_DAMPING], power[BODY_DAMPING] = dissipated(system, motion)
    for b in range(record.core.shape[0]):
        for i in range(record.core.shape[1]):
            record.core[b, i, step] = motion.core[b, i]
    accelerations(system, motion, record, step)


@compiled(**ONCE)
def work(system, motion, k, closer, rate, climb):  # type: ignore[no-untyped-def]
    """Add to the ledger what the force of a contact did over a step: on the contact, and against the slope.

    The force is linear over the step, whatever it does from step to step: by parts its work on the contact
    takes the integral of the approach alone, a cubic between its ends. The trapezoidal rule would miss what
    an impact does. `closer` is the change of the approach, m; rate of the approach and climb at the end, m/s.
    On a rail approach and rate are those of the body: the work is that on contact and rail.
    """
    h, before, force = system.time_step, motion.force[1, k], motion.force[0, k]
    rise = force - before
    motion.ledger[CONTACT_WORK] += 0.5 * (before + force) * closer - h / 12.0 * rise * (motion.rate[k] - rate)
    product = 0.5 * (before * motion.climb[k] + force * climb) - rise * (climb - motion.climb[k]) / 6.0
    motion.ledger[SLOPE_WORK] += h * product


@compiled(**ONCE)
def damper_power(system, motion, k, elastic):  # type: ignore[no-untyped-def]
    """Power into the damper of a contact, W, whose law without it gives the force `elastic`, N."""
    rate = motion.rate[k]
    if system.channels.source.shape[0] > 0:
        rate = (motion.approach[0, k] - motion.approach[1, k]) / system.time_step
    return (motion.force[0, k] - elastic) * rate


@compiled(**ONCE)
def book(system, motion):  # type: ignore[no-untyped-def]
    """Add half a step of the present powers to the ledger."""
    for i in range(POWERS):
        motion.ledger[i] += 0.5 * system.time_step * motion.power[i]


SWEEPS = 200
SETTLED = 4.0 * FORCE_TOLERANCE
"""Change of a force over a sweep, of itself plus the load, that counts as none."""


class Assembly(NamedTuple):
    """What does not change: a structure of m modes, b bodies, n contacts.

    Bodies have up to d coordinates that are coupled by dampers and s modes, all mass-normalised; what a body
    lacks is zero.
    """

    coefficients: NDArray  # (8, m), from `modal_coefficients`
    stiffness: NDArray  # (m,), ω²
    damping: NDArray  # (m,), 2 ζ ω
    sensors: NDArray  # (sensors, m), mode shapes, kg^(−1/2)
    core_step: NDArray  # (b, 2 d, 2 d), of coordinates and rates
    core_before: NDArray  # (b, 2 d, d), of forces at the start of the step
    core_now: NDArray  # (b, 2 d, d), at its end
    core_pressed: NDArray  # (b, 2 d), of the constant forces
    core_damping: NDArray  # (b, d, d)
    flexible: NDArray  # (8, b, s), as `coefficients`
    flexible_damping: NDArray  # (b, s), 2 ζ ω
    body: NDArray  # (n,), body of each contact
    core_shapes: NDArray  # (n, d), displacement of the contact for each coordinate, kg^(−1/2)
    answers: NDArray  # (n, d), coordinates at the end of a step for one newton there
    flexible_shapes: NDArray  # (n, s), kg^(−1/2)
    own: NDArray  # (n,), displacement of the body there for one newton at the end of a step, m/N
    loads: NDArray  # (n,), scales of the forces, N
    softening: NDArray  # (n,), compliance in series with each contact that keeps a step stable, m/N
    time_step: float  # s
    speed: float  # m/s
    coupled: bool  # whether one contact can feel another
    channels: Channels  # of a rail, none without one


class ContactsMotion(NamedTuple):
    """What changes from step to step; the arrays are written in place."""

    displacement: NDArray  # (m,), modal coordinates
    velocity: NDArray  # (m,)
    push: NDArray  # (m,), generalised forces now
    ahead: NDArray  # (m,), coordinates at the end of the step, as far as its forces are known
    core: NDArray  # (b, 2 d), coordinates and rates
    core_push: NDArray  # (b, d)
    core_ahead: NDArray  # (b, 2 d)
    flexible: NDArray  # (2, b, s), modal coordinates and rates
    flexible_push: NDArray  # (b, s)
    flexible_ahead: NDArray  # (b, s)
    force: NDArray  # (2, n), N, now and one step ago
    approach: NDArray  # (2, n), as the laws see it, m, now and one step ago
    rail: NDArray  # (p, 2 q), states of the poles of a rail's channels, m
    ring: NDArray  # (n, taps), displacement to come at each contact where the rail is scattered, m
    rail_ahead: NDArray  # (n,), displacement of the rail at the end of the step, as far as known, m
    rail_now: NDArray  # (p,), displacement of the rail for unit force at the end of the step, m/N
    trial: NDArray  # (n,), forces at the end of the step, as far as they are known, N
    compliance: NDArray  # (n,), of structure, body and softening at the contact in a step, m/N
    rate: NDArray  # (n,), of the approach, on a rail of the body alone, m/s
    climb: NDArray  # (n,), on the slope of the structure, m/s
    power: NDArray  # (POWERS,), now, W
    ledger: NDArray  # (6,), since the start, J, in the order of the names above
    counts: NDArray  # (3,), steps done, steps not converged, evaluations of the laws


class ContactsRecord(NamedTuple):
    """Time histories of t steps, written in place; displacements positive downwards."""

    force: NDArray  # (n, t), N
    approach: NDArray  # (n, t), m
    over: NDArray  # (n, t), of what is rolled over, at the contact, m
    rolling: NDArray  # (n, t), of what rolls, at the contact, m
    core: NDArray  # (b, d, t), coordinates, positive upwards
    acceleration: NDArray  # (sensors, t), m/s²


class Laws(NamedTuple):
    """`Prepared` laws of n contacts on r steps, padded to the largest."""

    form: NDArray  # (n,)
    planes: NDArray  # (n, r)
    state_count: NDArray  # (n,)
    states: NDArray  # (n, s)
    values: NDArray  # (n, r, s)
    slopes: NDArray  # (n, r, s), without rows if no law is a table
    touches: NDArray  # (n, r), likewise
    knot_count: NDArray  # (n,)
    knots: NDArray  # (n, k)
    coefficients: NDArray  # (n, k - 1, 4)
    exponent: NDArray  # (n,)
    bilateral: NDArray  # (n,)
    datum: NDArray  # (n,)
    damping: NDArray  # (n,)
    damped_in_flight: NDArray  # (n,)


@compiled(**INNER)
def law_of(laws, k):  # type: ignore[no-untyped-def]
    """The law of one contact, as views."""
    return Prepared(
        laws.form[k],
        laws.planes[k],
        laws.states[k, : laws.state_count[k]],
        laws.values[k],
        laws.slopes[k],
        laws.touches[k],
        laws.knots[k, : laws.knot_count[k]],
        laws.coefficients[k],
        laws.exponent[k],
        laws.bilateral[k],
        laws.datum[k],
        laws.damping[k],
        laws.damped_in_flight[k],
        0.0,
    )


@compiled(**INNER, **REASSOCIATE)
def begin_step(system, motion, shapes):  # type: ignore[no-untyped-def]
    """Move everything to the end of a step under forces that go on as they have changed.

    `shapes` (n, m) are the mode shapes under the contacts at the end.
    """
    a, f = system.coefficients, system.flexible
    for j in range(motion.ahead.shape[0]):
        motion.ahead[j] = (
            a[0, j] * motion.displacement[j] + a[1, j] * motion.velocity[j] + a[2, j] * motion.push[j]
        )
    if system.channels.source.shape[0] > 0:
        advance_channels(system.channels, motion, motion.force[0], motion.counts[0] + 1)
    bodies, states = motion.core.shape
    for b in range(bodies):
        for i in range(states):
            total = system.core_pressed[b, i]
            for j in range(states):
                total += system.core_step[b, i, j] * motion.core[b, j]
            for j in range(states // 2):
                total += system.core_before[b, i, j] * motion.core_push[b, j]
            motion.core_ahead[b, i] = total
        for i in range(motion.flexible_ahead.shape[1]):
            motion.flexible_ahead[b, i] = (
                f[0, b, i] * motion.flexible[0, b, i]
                + f[1, b, i] * motion.flexible[1, b, i]
                + f[2, b, i] * motion.flexible_push[b, i]
            )
    for k in range(motion.trial.shape[0]):
        compliance = 0.0
        for j in range(motion.ahead.shape[0]):
            compliance += shapes[k, j] * shapes[k, j] * a[3, j]
        if system.channels.source.shape[0] > 0:
            compliance += rail_compliance(system.channels, motion, k)
        motion.compliance[k] = compliance + system.own[k] + system.softening[k]
        motion.trial[k] = 2.0 * motion.force[0, k] - motion.force[1, k]
        press(system, motion, shapes, k, motion.trial[k])


@compiled(**INNER, **REASSOCIATE)
def press(system, motion, shapes, k, change):  # type: ignore[no-untyped-def]
    """Add to the force of a contact at the end of the step, N."""
    a, f, b = system.coefficients, system.flexible, system.body[k]
    for j in range(motion.ahead.shape[0]):
        motion.ahead[j] += a[3, j] * (shapes[k, j] * change)
    for j in range(system.answers.shape[1]):
        motion.core_ahead[b, j] += system.answers[k, j] * change
    for j in range(motion.flexible_ahead.shape[1]):
        motion.flexible_ahead[b, j] += f[3, b, j] * (system.flexible_shapes[k, j] * change)
    if system.channels.source.shape[0] > 0:
        press_rail(system.channels, motion, k, change)


@compiled(**ONCE)
def over_ahead(motion, shapes, k):  # type: ignore[no-untyped-def]
    """Displacement of what is rolled over under a contact at the end of the step, m."""
    total = motion.rail_ahead[k]
    for j in range(motion.ahead.shape[0]):
        total += shapes[k, j] * motion.ahead[j]
    return total


@compiled(**ONCE)
def body_ahead(system, motion, k):  # type: ignore[no-untyped-def]
    """Displacement of the body at a contact at the end of the step, m, upwards."""
    b, total = system.body[k], 0.0
    for j in range(system.core_shapes.shape[1]):
        total += system.core_shapes[k, j] * motion.core_ahead[b, j]
    for j in range(system.flexible_shapes.shape[1]):
        total += system.flexible_shapes[k, j] * motion.flexible_ahead[b, j]
    return total


@compiled(**ONCE)
def free_of(system, motion, shapes, k):  # type: ignore[no-untyped-def]
    """What `solve_step` needs of one contact while the forces of the others stay."""
    approach = -(over_ahead(motion, shapes, k) + body_ahead(system, motion, k))
    compliance = motion.compliance[k]
    approach += (compliance - system.softening[k]) * motion.trial[k]
    h, before = system.time_step, (motion.approach[0, k], motion.approach[1, k])
    return backward(approach, compliance, before, h)


@compiled(**ONCE)
def take(system, motion, shapes, k, sweep, force, evaluations, converged):  # type: ignore[no-untyped-def]
    """Take the force that a contact has found, N; whether it had been right before."""
    change, trial = force - motion.trial[k], motion.trial[k]
    motion.counts[2] += evaluations
    if sweep > 0 and converged and evaluations == 1:
        return True  # law and displacements agree as they stand
    press(system, motion, shapes, k, change)
    motion.trial[k] = force
    return converged and abs(change) <= SETTLED * (abs(trial) + system.loads[k])


@compiled(**INNER, **REASSOCIATE)
def solve_contacts(system, motion, laws, row, shapes):  # type: ignore[no-untyped-def]
    """Forces at the end of a step; whether all meet their laws to FORCE_TOLERANCE."""
    for sweep in range(SWEEPS):
        settled = True
        for k in range(motion.trial.shape[0]):
            free = free_of(system, motion, shapes, k)
            force, evaluations, converged = solve_step(
                law_of(laws, k), row, free, system.loads[k], motion.trial[k]
            )
            right = take(system, motion, shapes, k, sweep, force, evaluations, converged)
            settled = settled and (right if system.coupled else converged)
        if settled or not system.coupled:
            return settled
    return False


@compiled(**INNER, **REASSOCIATE)
def complete_contacts(system, motion, shapes):  # type: ignore[no-untyped-def]
    """Advance the state over a step whose forces at its end are known."""
    a, f = system.coefficients, system.flexible
    contacts, modes = shapes.shape
    for j in range(modes):
        motion.velocity[j] = (
            a[4, j] * motion.displacement[j] + a[5, j] * motion.velocity[j] + a[6, j] * motion.push[j]
        )
    for j in range(modes):
        motion.displacement[j] = motion.ahead[j]
        motion.push[j] = 0.0
    bodies, states = motion.core.shape
    for b in range(bodies):
        for i in range(states // 2):
            motion.core_push[b, i] = 0.0
        for i in range(motion.flexible_push.shape[1]):
            motion.flexible[1, b, i] = (
                f[4, b, i] * motion.flexible[0, b, i]
                + f[5, b, i] * motion.flexible[1, b, i]
                + f[6, b, i] * motion.flexible_push[b, i]
            )
            motion.flexible[0, b, i] = motion.flexible_ahead[b, i]
            motion.flexible_push[b, i] = 0.0
    for k in range(contacts):
        force, b = motion.trial[k], system.body[k]
        for j in range(modes):
            motion.push[j] += shapes[k, j] * force
        for i in range(states // 2):
            motion.core_push[b, i] += system.core_shapes[k, i] * force
        for i in range(motion.flexible_push.shape[1]):
            motion.flexible_push[b, i] += system.flexible_shapes[k, i] * force
        motion.force[1, k], motion.force[0, k] = motion.force[0, k], force
    for j in range(modes):
        motion.velocity[j] += a[7, j] * motion.push[j]
    for b in range(bodies):
        for i in range(states):
            total = motion.core_ahead[b, i]
            if i >= states // 2:
                for j in range(states // 2):
                    total += system.core_now[b, i, j] * motion.core_push[b, j]
            motion.core[b, i] = total
        for i in range(motion.flexible_push.shape[1]):
            motion.flexible[1, b, i] += f[7, b, i] * motion.flexible_push[b, i]


@compiled(**LOOP)
def roll_contacts(system, motion, record, laws, shapes, slopes, offset, stop, largest):  # type: ignore[no-untyped-def]
    """Roll compiled laws from the state's step to `stop`; False from a force larger than `largest`, or NaN.

    Then the state stands at that step. Row 0 of the laws, and of mode shapes and slopes (k, n, m), belongs to
    the step `offset`. Step zero is the start, which is only recorded.
    """
    for step in range(motion.counts[0] + 1, stop + 1):
        row, converged = step - offset, True
        if step > 0:
            begin_step(system, motion, shapes[row])
            converged = solve_contacts(system, motion, laws, row, shapes[row])
            complete_contacts(system, motion, shapes[row])
            book(system, motion)
        observe_contacts(system, motion, record, step, shapes[row], slopes[row])
        for k in range(motion.trial.shape[0]):
            if laws.damping[k] > 0.0:
                elastic = evaluate(law_of(laws, k), row, motion.approach[0, k])[0]
                motion.power[CONTACT_DAMPING] += damper_power(system, motion, k, elastic)
        if step > 0:
            book(system, motion)
        motion.counts[0] = step
        motion.counts[1] += 0 if converged else 1
        for k in range(motion.trial.shape[0]):
            if not abs(motion.trial[k]) <= largest:
                return False
    return True
