"""Constants of a mechanism for the kernels, with contacts soft enough for the time step."""

from collections.abc import Sequence

import numpy as np

from asperity.arguments import Array
from asperity.errors import InputError
from asperity.kernels.stepping import Motion, System
from asperity.laws.spec import Law
from asperity.rolling import resolution, steps
from asperity.rolling.course import Course
from asperity.rolling.ground import Ground
from asperity.rolling.rest import set_down
from asperity.structures.body import Body

NONE = np.zeros(0)
RUNAWAY = 1e4
"""Times the load, or the largest force that the law was made for, that no contact force reaches."""


def softened(
    ground: Ground, system: System, course: Course, highest_frequency: float | None
) -> tuple[System, Motion, float]:
    """Constants with contacts soft enough for the time step, a start, and a force beyond reach, N."""
    bodies = course.bodies
    stiffness, motion = set_down(ground, bodies, system, course.at_start, entering=not course.settled)
    own = alternating(system)
    least = ground.alternating + own
    thrown = ground.thrown + own
    direct = system.own + ground.shapes**2 @ system.coefficients[3, : len(ground.natural)]
    resonances = steps.contact_resonance(stiffness, direct, least, system.time_step)[~ground.on_rail]
    fastest = float(resonances.max(initial=0.0))
    resonance = "the contact resonance", fastest, resolution.steps_per_resonance(fastest, highest_frequency)
    on_bay = np.sqrt(float(stiffness[ground.on_rail].max(initial=0.0)) / ground.bay) / (2.0 * np.pi)
    on_rail = "the contact resonance on a bay of rail", on_bay, resolution.PER_RESONANCE_ON_RAIL
    natural = np.concatenate([body.natural_frequencies for body in bodies])
    asked = natural[natural <= (highest_frequency or np.inf)]  # of others nobody asked
    own_mode = "the highest mode of a body", float(asked.max(initial=0.0)), resolution.PER_MODE
    per_highest = resolution.PER_HIGHEST_ON_RAIL if ground.on_rail.any() else resolution.PER_HIGHEST
    highest = "the highest frequency asked for", highest_frequency or 0.0, per_highest
    steps.warn_if_coarse(system.time_step, (resonance, on_rail, *ground.limits, own_mode, highest))
    laws = zip(course.at_start, stiffness.tolist(), strict=True)
    values = [steps.largest_values(*each) for each in laws]
    damping = np.array([law.damping for law in course.laws])
    stiffest, impacts, forces = np.array(values).T
    softer = steps.softening(least, thrown, stiffest, impacts, damping, stiffness, system.time_step)
    if softer.any():
        system = system._replace(softening=softer)
        _, motion = set_down(ground, bodies, system, course.at_start, entering=not course.settled)
    return system, motion, RUNAWAY * max(*system.loads, *forces)


def offsets_of(bodies: Sequence[Body], laws: Sequence[Law], positions: Array) -> Array:
    """Where the contacts are ahead of the path (n,), m."""
    if not len(bodies):
        raise InputError("bodies", "none", "one or more")
    if positions.shape != (len(bodies),) or not np.isfinite(positions).all():
        allowed = f"{len(bodies)} finite numbers, one for each body"
        raise InputError("positions of the bodies (m)", positions.tolist(), allowed)
    offsets = np.concatenate([at + body.places for at, body in zip(positions, bodies, strict=True)])
    if len(laws) != len(offsets):
        raise InputError("laws", len(laws), f"{len(offsets)}, one for each contact")
    return offsets


def body_loads(bodies: Sequence[Body]) -> Array:
    """Scales of the contact forces (n,), N: static loads, no one less than the mean of several."""
    loads = np.concatenate([body.static_loads for body in bodies])
    mean = float(np.clip(loads, 0.0, None).mean())
    if not mean > 0.0:
        raise InputError("loads of the bodies (N)", "none that presses", "forces that press them down")
    return np.maximum(loads, mean) if len(loads) > 1 else loads


def system_of(ground: Ground, bodies: Sequence[Body], loads: Array, h: float, constant: Array) -> System:
    """Constants for the kernels, with contacts as they are.

    Scales of the contact forces (n,), N, time step, s, constant forces on the structure (s,).
    """
    b = len(bodies)
    n = len(loads)
    channels = ground.channels
    of = np.repeat(np.arange(b), [len(body.places) for body in bodies])
    frequencies = steps.padded([2.0 * np.pi * body.natural_frequencies for body in bodies])
    natural = np.concatenate([ground.natural, frequencies.ravel()])
    damping_ratios = steps.padded([body.damping_ratios for body in bodies])
    ratios = np.concatenate([ground.ratios, damping_ratios.ravel()])
    coefficients = steps.resolved_step(natural, ratios, h)
    shapes = steps.padded([row for body in bodies for row in body.shapes])
    rows = steps.padded([row for body in bodies for row in body.contacts])
    of_each = {body: steps.body_step(body, h) for body in dict.fromkeys(bodies)}  # balls are one body
    step = steps.padded([of_each[body] for body in bodies])  # (b, 2, d, 4, d)
    pressed = np.einsum("bxijk,bk->bxi", step[..., 2:, :], steps.padded([body.pressing for body in bodies]))
    before, now = np.einsum("nxijk,nk->jnxi", step[of][..., 2:, :], rows).reshape(2, n, -1)
    answers = coefficients[3, len(ground.natural) :].reshape(b, -1)[of]
    return System(
        coefficients=coefficients,
        stiffness=natural**2,
        damping=2.0 * ratios * natural,
        sensors=ground.sensors,
        core_step=step[..., :2, :].reshape(b, now.shape[1], now.shape[1]),
        core_pressed=-pressed.reshape(b, -1),
        core_damping=steps.padded([body.damping for body in bodies]),
        body=of,
        core_shapes=rows,
        core_before=before,
        core_now=now,
        shapes=shapes,
        own=np.sum(rows * now[:, : rows.shape[1]], axis=1) + np.sum(shapes**2 * answers, axis=1),
        loads=loads,
        ones=np.ones(len(natural)),
        constant=np.pad(constant, (0, len(natural) - len(constant))) if len(constant) else constant,
        softening=np.zeros(n),
        time_step=float(h),
        coupled=bool(
            (channels.source != channels.receiver).any() or (n > 1 and ground.natural.size > 0) or n > b
        ),
        channels=channels,
    )


def alternating(system: System) -> Array:
    """Least alternating compliance of the body at each contact (n,), m/N: of all its contacts at once."""
    found = np.zeros(len(system.body))
    d = system.core_shapes.shape[1]
    f = system.shapes.shape[1]
    first = len(system.stiffness) - f * len(system.core_step)  # of the modes of bodies
    modes = steps.alternating_of_modes(system.coefficients)[first:]
    for b, step in enumerate(system.core_step):
        at = np.flatnonzero(system.body == b)
        core = np.linalg.solve(np.eye(2 * d) + step, (system.core_now - system.core_before)[at].T)[:d]
        shapes = system.shapes[at]
        matrix = system.core_shapes[at] @ core + (shapes * modes[b * f : (b + 1) * f]) @ shapes.T
        found[at] = float(np.linalg.eigvalsh(0.5 * (matrix + matrix.T)).min())
    return found
