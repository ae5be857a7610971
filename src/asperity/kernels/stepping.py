"""Bodies that roll on several contacts, compiled: a step of everything linear, and the forces at its end.

All forces are linear over a step; for that every oscillator and every body is exact, and all displacements
are affine in the forces at the end of the step. Those solve one convex problem, contact after contact, each
exactly with the others held, until all laws are met at once. What one contact does to the others goes through
the coordinates of structure and bodies, so that the cost grows with the number of contacts, not of pairs.
Laws that Python evaluates go through the same loops (`roll`, `solve_contacts`, `solve_law`), not compiled.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.options import INNER, LOOP, ONCE, REASSOCIATE, compiled
from asperity.kernels.pointforce import (
    ITERATIONS,
    TABLE,
    Prepared,
    SeriesFilm,
    evaluate,
    film_under,
    refine,
    with_damping,
)
from asperity.kernels.rail import Channels, advance_channels, press_rail, rail_compliance

FORCE_TOLERANCE = 1e-10  # of the force plus the load, at the end of each step
SWEEPS = 200
SETTLED = 4.0 * FORCE_TOLERANCE
"""Change of a force over a sweep, of itself plus the load, that counts as none."""
NEAR = 0.1
"""Share of a force by which it may differ from its guess where one step of Newton's is enough at first."""
STRAIGHT_SWEEPS = 3
"""Sweeps after which laws are taken as straight until what contacts do to each other has settled."""
STRAIGHT = 1e-5
"""Share by which an elastic force may change on a straight line: what it misses is of second order."""
MISSED, FOUND, AS_GUESSED = range(3)
"""How the force of one contact was found, with the others held."""
OVER_DAMPING, BODY_DAMPING, CONTACT_DAMPING, THROUGHPUT, CONTACT_WORK, SLOPE_WORK = range(6)
POWERS = 4
"""Those of the ledger that are integrated from their powers; work of contacts and slope is by the step."""


class System(NamedTuple):
    """What does not change: m oscillators, b bodies, n contacts.

    Oscillators are mass-normalised modes: first the s of the structure, then f of each body. Beside its modes
    a body has d coordinates that springs and dampers couple; what it lacks is zero.
    """

    coefficients: NDArray  # (8, m), from `asperity.rolling.steps.modal_coefficients`
    stiffness: NDArray  # (m,), ω²
    damping: NDArray  # (m,), 2 ζ ω
    sensors: NDArray  # (sensors, s), mode shapes, kg^(−1/2)
    core_step: NDArray  # (b, 2 d, 2 d), of coordinates and rates
    core_pressed: NDArray  # (b, 2 d), what the constant forces add
    core_damping: NDArray  # (b, d, d)
    body: NDArray  # (n,), body of each contact
    core_shapes: NDArray  # (n, d), displacement of the contact for each coordinate
    core_before: NDArray  # (n, 2 d), coordinates and rates for one newton there at the start of a step
    core_now: NDArray  # (n, 2 d), likewise at its end
    shapes: NDArray  # (n, f), of the f oscillators of its body, kg^(−1/2)
    own: NDArray  # (n,), displacement of the body there for one newton at the end of a step, m/N
    loads: NDArray  # (n,), scales of the forces, N
    ones: NDArray  # (m,)
    constant: NDArray  # (m,), constant generalised forces of the oscillators; empty without any
    softening: NDArray  # (n,), compliance in series with each contact that keeps a step stable, m/N
    time_step: float  # s
    coupled: bool  # whether one contact can feel another
    channels: Channels  # of a rail, none without one


class Motion(NamedTuple):
    """What changes from step to step; the arrays are written in place."""

    displacement: NDArray  # (m,), of the oscillators
    velocity: NDArray  # (m,), in a step as far as it does not hang on the forces at its end
    push: NDArray  # (m,), generalised forces
    ahead: NDArray  # (m,), displacement at the end of the step, as far as its forces are known
    core: NDArray  # (b, 2 d), coordinates and rates
    core_ahead: NDArray  # (b, 2 d), at the end of the step, as far as its forces are known
    force: NDArray  # (4, n), N, now and up to three steps ago
    elastic: NDArray  # (n,), the part of the force that is not the damper's, N
    approach: NDArray  # (2, n), as the laws see it, m, now and one step ago
    placed: NDArray  # (2, n), now: approach of the mean surfaces, and displacement of what rolls, m
    rail: NDArray  # (p, 2 q), states of the poles of a rail's channels, m
    ring: NDArray  # (n, taps), displacement to come at each contact where the rail is scattered, m
    rail_ahead: NDArray  # (n,), displacement of the rail at the end of the step, as far as known, m
    rail_now: NDArray  # (p,), displacement of the rail for unit force at the end of the step, m/N
    trial: NDArray  # (n,), forces at the end of the step, as far as they are known, N
    compliance: NDArray  # (n,), of structure, body and softening at the contact in a step, m/N
    free: NDArray  # (n,), approach for zero force, m, for which `trial` was found
    # (4, n), of laws that are taken as straight: how the force rises with that approach, N/m; the approach at
    # which they were evaluated, how far they are straight there, m, and their stiffness, N/m; else zero
    straight: NDArray
    rate: NDArray  # (n,), of the approach, on a rail of the body alone, m/s
    climb: NDArray  # (n,), on the slope of the structure, m/s
    power: NDArray  # (POWERS,), now, W
    ledger: NDArray  # (6,), since the start, J, in the order of the names above
    counts: NDArray  # (3,), steps done, steps not converged, evaluations of the laws


class Histories(NamedTuple):
    """Time histories of t steps, displacements positive downwards: what is written together lies together."""

    contact_force: NDArray  # (t, n), N
    relative_displacement: NDArray  # (t, n), approach, m
    over_displacement: NDArray  # (t, n), of what is rolled over, at the contact, m
    rolling_displacement: NDArray  # (t, n), of what rolls, at the contact, m
    core: NDArray  # (t, b, d), coordinates, positive upwards
    acceleration: NDArray  # (t, sensors), m/s²
    displacement: NDArray  # (t, sensors), m; without columns where it is not asked for


class Found(NamedTuple):
    """What was found of the force of one contact, with those of the others held."""

    force: float  # N
    elastic: float  # its elastic part, N
    evaluations: int
    how: int  # `MISSED`, `FOUND` or `AS_GUESSED`
    straight: tuple[float, float, float, float]  # as in `Motion`


CURVED = (0.0, 0.0, 0.0, 0.0)


@compiled(**INNER)
def solve_law(evaluate, law, film, step, free, load, guess, damping, in_flight, relative, again):  # type: ignore[no-untyped-def]
    """Contact force at the end of a step.

    ``evaluate(law, step, approach)`` gives elastic force and stiffness of bodies that a film keeps
    apart, `damping`, N s/m, and `in_flight` are of `with_damping`. `free` is from `free_of`, `load` the scale
    of the force and `guess` the force expected, N; the force is exact to `relative` of itself plus the load.
    What is looked for is the approach of the bodies. A force that will be looked at `again` beside those of
    other contacts is one step of Newton's from a guess that was near.
    """
    free_approach, rate, compliance, rate_compliance = free
    low = -np.inf
    high = np.inf
    approach = free_approach - compliance * guess
    if film.thickness > 0.0:
        damped = damping * (rate - rate_compliance * guess)
        approach += film_under(film, guess - damped)[0]
    elastic = apart = 0.0
    for iteration in range(ITERATIONS):
        elastic, firm = evaluate(law, step, approach)
        apart, thinner = film_under(film, elastic)
        force, stiffness = with_damping(elastic, firm, rate, rate_compliance, damping, in_flight)
        residual = approach - apart - free_approach + compliance * force
        # the last term is what rounding leaves of the approach
        limit = relative * compliance * (abs(force) + load) + 1e-15 * abs(free_approach)
        if abs(residual) <= limit:
            return Found(force, elastic, iteration + 1, FOUND if iteration else AS_GUESSED, CURVED)
        slope = 1.0 - thinner * firm + compliance * stiffness
        if again and iteration == 0 and abs(residual) <= NEAR * compliance * force:
            closer = -residual / max(slope, 1.0)
            engaged = damping * rate_compliance  # a damper feels how fast the free approach rises, too
            rise = stiffness + (1.0 - thinner * firm) * engaged / (compliance * (1.0 + engaged))
            reach = STRAIGHT * elastic / firm if film.thickness == 0.0 else 0.0
            straight = rise / slope, approach, reach, firm / (1.0 - thinner * firm)
            return Found(force + stiffness * closer, elastic + firm * closer, 1, FOUND, straight)
        low, high, approach = refine(low, high, approach, residual, slope, iteration)
        if damping > 0.0 and abs(high - low) <= limit:
            # a damper engages with a jump: the force lies inside it
            inside = (free_approach + apart - approach) / compliance
            return Found(inside, elastic, iteration + 1, FOUND, CURVED)
    return Found((free_approach + apart - approach) / compliance, elastic, ITERATIONS, MISSED, CURVED)


@compiled(**INNER)
def solve_prepared(laws, k, step, free, load, guess, again):  # type: ignore[no-untyped-def]
    """As `solve_law`, by the law of contact k, of those that `asperity.rolling.course.Course` lays out."""
    stack, counts = laws
    states, knots = counts[0, k], counts[1, k]
    law = Prepared(
        stack.form[k], stack.planes[k], stack.states[k, :states], stack.values[k], stack.slopes[k],
        stack.touches[k], stack.knots[k, :knots], stack.coefficients[k], stack.exponent[k],
        stack.bilateral[k], stack.datum[k], stack.damping[k], stack.damped_in_flight[k], stack.upper[k],
        SeriesFilm(stack.film[k, 0], stack.film[k, 1], stack.film[k, 2]),
    )  # fmt: skip
    found = solve_law(
        evaluate, law, law.film, step, free, load, guess, law.damping, law.damped_in_flight, FORCE_TOLERANCE,
        again,
    )  # fmt: skip
    rise, place, reach, firm = found.straight
    if law.form != TABLE:  # where the texture of the next state comes in, laws have a kink
        for i in range(states):
            reach = min(reach, abs(law.states[i] - (place - law.planes[step])))
    return Found(found.force, found.elastic, found.evaluations, found.how, (rise, place, reach, firm))


@compiled(**INNER, **REASSOCIATE)
def begin_step(system, motion, shapes):  # type: ignore[no-untyped-def]
    """Move everything to the end of a step under forces that go on as they have changed.

    `shapes` (n, s) are the mode shapes under the contacts at the end.
    """
    a = system.coefficients
    q = motion.displacement
    v = motion.velocity
    p = motion.push
    ahead = motion.ahead
    for j in range(len(q)):  # few arrays to a loop: else the compiler does not make vectors of it
        ahead[j] = a[0, j] * q[j] + a[1, j] * v[j] + a[2, j] * p[j]
    for j in range(len(q)):
        v[j] = a[4, j] * q[j] + a[5, j] * v[j] + a[6, j] * p[j]
    for j in range(len(system.constant)):
        ahead[j] += a[3, j] * system.constant[j]
    advance_channels(system.channels, motion, motion.force[0], motion.counts[0] + 1)
    bodies, states = motion.core.shape
    for b in range(bodies):
        for i in range(states):
            total = system.core_pressed[b, i]
            for j in range(states):
                total += system.core_step[b, i, j] * motion.core[b, j]
            motion.core_ahead[b, i] = total
    for k in range(motion.trial.shape[0]):
        for i in range(states):
            motion.core_ahead[system.body[k], i] += system.core_before[k, i] * motion.force[0, k]
        compliance = system.own[k] + system.softening[k] + rail_compliance(system.channels, motion, k)
        for j in range(shapes.shape[1]):
            compliance += shapes[k, j] * shapes[k, j] * a[3, j]
        motion.compliance[k] = compliance
        last = motion.force[:, k]  # the next one lies on a cubic through them
        motion.trial[k] = 4.0 * (last[0] + last[2]) - 6.0 * last[1] - last[3]
    for k in range(motion.trial.shape[0]):
        press(system, motion, shapes, k, motion.trial[k])


@compiled(**INNER)
def first_mode(system, shapes, k):  # type: ignore[no-untyped-def]
    """First oscillator of the body of a contact."""
    return shapes.shape[1] + system.body[k] * system.shapes.shape[1]


@compiled(**INNER, **REASSOCIATE)
def product(row, values, first):  # type: ignore[no-untyped-def]
    """Sum of the products of a row and of values from one on."""
    total = 0.0
    if len(row) > 0:
        part = values[first : first + len(row)]
        for j in range(len(row)):
            total += row[j] * part[j]
    return total


@compiled(**INNER, **REASSOCIATE)
def add(values, first, row, factor, factors):  # type: ignore[no-untyped-def]
    """Add to values from one on a row times a factor, and times factors of their own."""
    if len(row) > 0:
        part = values[first : first + len(row)]
        own = factors[first : first + len(row)]
        for j in range(len(row)):
            part[j] += own[j] * (row[j] * factor)


@compiled(**INNER, **REASSOCIATE)
def press(system, motion, shapes, k, change):  # type: ignore[no-untyped-def]
    """Add to the force of a contact at the end of the step, N."""
    ahead = motion.ahead
    now = system.coefficients[3]
    add(ahead, 0, shapes[k], change, now)
    add(ahead, first_mode(system, shapes, k), system.shapes[k], change, now)
    core = motion.core_ahead[system.body[k]]
    for i in range(len(core)):
        core[i] += system.core_now[k, i] * change
    press_rail(system.channels, motion, k, change)


@compiled(**INNER, **REASSOCIATE)
def free_approach(system, motion, shapes, k):  # type: ignore[no-untyped-def]
    """Approach of one contact for zero force at the end of a step, m, with the forces of the others held."""
    apart = motion.rail_ahead[k] + product(shapes[k], motion.ahead, 0)
    apart += product(system.shapes[k], motion.ahead, first_mode(system, shapes, k))
    apart += product(system.core_shapes[k], motion.core_ahead[system.body[k]], 0)
    return (motion.compliance[k] - system.softening[k]) * motion.trial[k] - apart


@compiled(**ONCE)
def free_of(system, motion, shapes, k):  # type: ignore[no-untyped-def]
    """What `solve_law` needs of one contact while the forces of the others stay.

    Approach, m, and its rate, m/s, for zero force at the end of the step, and how much they fall per force
    there, m/N and m/(s N). The rate is the backward difference of second order, which damps at any step.
    """
    h = system.time_step
    compliance = motion.compliance[k]
    approach = free_approach(system, motion, shapes, k)
    rate = (1.5 * approach - 2.0 * motion.approach[0, k] + 0.5 * motion.approach[1, k]) / h
    return approach, rate, compliance, 1.5 * compliance / h


@compiled(**ONCE)
def take(system, motion, shapes, k, sweep, free, found):  # type: ignore[no-untyped-def]
    """Take the force that a contact has found, N; whether it had been right before."""
    before = motion.trial[k]
    motion.counts[2] += found.evaluations
    motion.elastic[k] = found.elastic
    motion.free[k] = free
    for i in range(len(found.straight)):
        motion.straight[i, k] = found.straight[i]
    if sweep > 0 and found.how == AS_GUESSED:
        return True  # law and displacements agree as they stand
    press(system, motion, shapes, k, found.force - before)
    motion.trial[k] = found.force
    close = abs(found.force - before) <= SETTLED * (abs(before) + system.loads[k])
    return found.how != MISSED and (close or not system.coupled)


@compiled(**ONCE)
def straighten(system, motion, shapes):  # type: ignore[no-untyped-def]
    """Let forces settle by laws that are straight where they were evaluated; whether they are that far."""
    for _ in range(SWEEPS):
        settled = True
        for k in range(motion.trial.shape[0]):
            free = free_approach(system, motion, shapes, k)
            closer = free - motion.free[k]
            change = motion.straight[0, k] * closer
            motion.free[k] = free
            motion.elastic[k] += motion.straight[3, k] * (closer - motion.compliance[k] * change)
            press(system, motion, shapes, k, change)
            motion.trial[k] += change
            if abs(change) > FORCE_TOLERANCE * (abs(motion.trial[k]) + system.loads[k]):
                settled = False
        if settled:
            break
    reached = settled
    for k in range(motion.trial.shape[0]):
        moved = motion.free[k] - motion.compliance[k] * motion.trial[k] - motion.straight[1, k]
        if not abs(moved) < motion.straight[2, k]:
            reached = False
    return reached


@compiled(**INNER, **REASSOCIATE)
def solve_contacts(solve, system, motion, laws, row, shapes):  # type: ignore[no-untyped-def]
    """Find the forces at the end of a step; whether all meet their laws.

    ``solve(laws, k, row, free, load, guess)`` finds that of one contact, as `solve_law`.
    """
    for sweep in range(SWEEPS):
        settled = True
        straight = False
        for k in range(motion.trial.shape[0]):
            free = free_of(system, motion, shapes, k)
            found = solve(laws, k, row, free, system.loads[k], motion.trial[k], system.coupled)
            settled = take(system, motion, shapes, k, sweep, free[0], found) and settled
            straight = straight or found.straight[0] > 0.0
        if settled or not system.coupled:
            return settled
        if straight and sweep < STRAIGHT_SWEEPS and straighten(system, motion, shapes):
            return True
    return False


@compiled(**INNER, **REASSOCIATE)
def end_step(system, motion, record, step, row, shapes, rates):  # type: ignore[no-untyped-def]
    """Take the forces at the end of a step as they are, and write a row of records, and the ledger.

    At step zero those of the start. Mode shapes under the contacts and their rates there (n, s), per second.
    """
    a = system.coefficients
    if step > 0:
        for j in range(motion.push.shape[0]):
            motion.displacement[j] = motion.ahead[j]
        for j in range(motion.push.shape[0]):
            motion.push[j] = 0.0
        for j in range(len(system.constant)):
            motion.push[j] = system.constant[j]
        for k in range(motion.trial.shape[0]):
            force = motion.trial[k]
            for i in range(motion.force.shape[0] - 1, 0, -1):
                motion.force[i, k] = motion.force[i - 1, k]
            motion.force[0, k] = force
            add(motion.push, 0, shapes[k], force, system.ones)
            add(motion.push, first_mode(system, shapes, k), system.shapes[k], force, system.ones)
        for j in range(motion.push.shape[0]):
            motion.velocity[j] += a[7, j] * motion.push[j]
        for b in range(motion.core.shape[0]):
            for i in range(motion.core.shape[1]):
                motion.core[b, i] = motion.core_ahead[b, i]
        book(system, motion)
    for i in range(POWERS):
        motion.power[i] = 0.0
    for k in range(motion.trial.shape[0]):
        observe_contact(system, motion, record, step, row, shapes, rates, k)
    motion.power[OVER_DAMPING], motion.power[BODY_DAMPING] = dissipated(system, motion, shapes.shape[1])
    if step > 0:
        book(system, motion)
    for b in range(record.core.shape[1]):
        for i in range(record.core.shape[2]):
            record.core[row, b, i] = motion.core[b, i]
    for s in range(system.sensors.shape[0]):
        total = 0.0
        for j in range(system.sensors.shape[1]):
            resisted = system.damping[j] * motion.velocity[j] + system.stiffness[j] * motion.displacement[j]
            total += system.sensors[s, j] * (motion.push[j] - resisted)
        record.acceleration[row, s] = total
    for s in range(record.displacement.shape[1]):
        record.displacement[row, s] = product(system.sensors[s], motion.displacement, 0)


@compiled(**ONCE)
def contact_rates(system, motion, shapes, rates, k):  # type: ignore[no-untyped-def]
    """Now at a contact: displacement of structure and of body, their rates, and the climb on the slope, m/s.

    The displacement of the structure is positive downwards, that of the body upwards; a rail, of which
    displacements alone are known, has no rate.
    """
    q = motion.displacement
    v = motion.velocity
    core = motion.core[system.body[k]]
    own = system.shapes[k]
    first = first_mode(system, shapes, k)
    coordinates = system.core_shapes.shape[1]
    over = motion.rail_ahead[k] + product(shapes[k], q, 0)
    over_rate = product(shapes[k], v, 0)
    climb = product(rates[k], q, 0)
    body = product(system.core_shapes[k], core, 0) + product(own, q, first)
    body_rate = product(system.core_shapes[k], core, coordinates) + product(own, v, first)
    return over, over_rate, climb, body, body_rate


@compiled(**ONCE)
def observe_contact(system, motion, record, step, row, shapes, rates, k):  # type: ignore[no-untyped-def]
    """Write the records of a contact, and what its force did over the step: to it, and on the slope.

    The force is linear over the step, whatever it does from step to step: by parts its work on the contact
    takes the integral of the approach alone, a cubic between its ends. The trapezoidal rule would miss what
    an impact does. On a rail the work is that on contact and rail: approach and rate are those of the body.
    The approach that the law sees moves on, too.
    """
    over, over_rate, climb, body, body_rate = contact_rates(system, motion, shapes, rates, k)
    h = system.time_step
    force = motion.force[0, k]
    rise = 0.0
    rate = -(body_rate + over_rate + climb)
    first = system.channels.first
    on_rail = system.channels.source.shape[0] > 0 and first[k + 1] > first[k]
    approach = -(over + body)
    record.contact_force[row, k] = force
    record.relative_displacement[row, k] = approach
    record.over_displacement[row, k] = over
    record.rolling_displacement[row, k] = -body
    motion.power[THROUGHPUT] += abs(force * over_rate) + abs(force * body_rate)
    if step > 0:
        closer = approach - motion.placed[0, k]
        if on_rail:
            closer = -body - motion.placed[1, k]
        before = motion.force[1, k]
        rise = force - before
        closing = 0.5 * (before + force) * closer
        motion.ledger[CONTACT_WORK] += closing - h / 12.0 * rise * (motion.rate[k] - rate)
        product = 0.5 * (before * motion.climb[k] + force * climb) - rise * (climb - motion.climb[k]) / 6.0
        motion.ledger[SLOPE_WORK] += h * product
    motion.rate[k], motion.climb[k] = rate, climb
    motion.approach[1, k] = motion.approach[0, k]
    motion.approach[0, k] = approach - system.softening[k] * force
    motion.placed[0, k] = approach
    motion.placed[1, k] = -body
    if on_rail:
        rate = (motion.approach[0, k] - motion.approach[1, k]) / h
    motion.power[CONTACT_DAMPING] += (force - motion.elastic[k]) * rate


@compiled(**ONCE)
def dissipated(system, motion, structure):  # type: ignore[no-untyped-def]
    """Power into damping, W: of the first oscillators, those of the structure, and of the bodies."""
    over = 0.0
    bodies = 0.0
    v = motion.velocity
    for j in range(structure):
        over += system.damping[j] * v[j] * v[j]
    for j in range(structure, len(v)):
        bodies += system.damping[j] * v[j] * v[j]
    coordinates = system.core_damping.shape[1]
    for b in range(motion.core.shape[0]):
        for i in range(coordinates):
            for j in range(coordinates):
                rates = motion.core[b, coordinates + i] * motion.core[b, coordinates + j]
                bodies += system.core_damping[b, i, j] * rates
    return over, bodies


@compiled(**ONCE)
def book(system, motion):  # type: ignore[no-untyped-def]
    """Add half a step of the present powers to the ledger."""
    for i in range(POWERS):
        motion.ledger[i] += 0.5 * system.time_step * motion.power[i]


@compiled(**ONCE)
def roll(sweep, solve, system, motion, record, laws, shapes, rates, offset, stop, largest):  # type: ignore[no-untyped-def]
    """Roll from the state's step to `stop`; False from a force larger than `largest`, or NaN.

    Then the state stands at that step. Row 0 of records, mode shapes, their rates (k, n, s), and of laws that
    are laid out, belongs to the step `offset`. Step zero is the start, which is only recorded. `sweep` is
    `solve_contacts` and `solve` what it calls.
    """
    for step in range(motion.counts[0] + 1, stop + 1):
        row = step - offset
        converged = True
        if step > 0:
            begin_step(system, motion, shapes[row])
            converged = sweep(solve, system, motion, laws, row, shapes[row])
        end_step(system, motion, record, step, row, shapes[row], rates[row])
        motion.counts[0] = step
        motion.counts[1] += 0 if converged else 1
        for k in range(motion.trial.shape[0]):
            if not abs(motion.trial[k]) <= largest:
                return False
    return True


@compiled(**LOOP, nogil=True)
def roll_prepared(system, motion, record, laws, shapes, rates, offset, stop, largest):  # type: ignore[no-untyped-def]
    """Roll compiled laws, as `roll`."""
    return roll(
        solve_contacts, solve_prepared, system, motion, record, laws, shapes, rates, offset, stop, largest
    )
