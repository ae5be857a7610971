"""What is recorded of several contacts, compiled: displacements, accelerations, and where the energy goes.

Systems, motions and records are those of `asperity.kernels.several`.
"""

from __future__ import annotations

from asperity.kernels.options import INNER, ONCE, REASSOCIATE, compiled

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
