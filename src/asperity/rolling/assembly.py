"""Bodies set on what they roll over: at rest, with contacts soft enough for the time step."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from scipy.linalg import block_diag

from asperity.arguments import Array, NDArray
from asperity.errors import ComputationError, InputError
from asperity.kernels.pointforce import Prepared, evaluate_all
from asperity.kernels.rail import preload_channels
from asperity.kernels.stepping import POWERS, Motion, System
from asperity.laws.spec import Law, SteppedLaw
from asperity.rolling import resolution, steps
from asperity.rolling.ground import Ground
from asperity.structures.body import Body

NONE = np.zeros(0)
RUNAWAY = 1e4
"""Times the load, or the largest force that the law was made for, that no contact force reaches."""


def softened(
    start: Callable[..., tuple[Array, Motion]],
    ground: Ground,
    bodies: Sequence[Body],
    system: System,
    prepared: Sequence[Prepared | SteppedLaw],
    damping: Array,
    highest_frequency: float | None,
) -> tuple[System, Motion, float]:
    """Constants with contacts soft enough for the time step, a start with them, and a force beyond reach, N.

    `start` is `start_at_rest` or its like, with the damping of the contacts (n,), N s/m.
    """
    (stiffness, motion), own = start(ground, bodies, system, prepared), alternating(system)
    least, thrown = ground.alternating + own, ground.thrown + own
    if ground.bay:
        on_bay = np.sqrt(float(stiffness.max()) / ground.bay) / (2.0 * np.pi)
        resonance = "the contact resonance on a bay of rail", on_bay, resolution.PER_RESONANCE_ON_RAIL
    else:
        direct = system.own + ground.shapes**2 @ system.coefficients[3, : len(ground.natural)]
        resonances = steps.contact_resonance(stiffness, direct, least, system.time_step)
        resonance = "the contact resonance", float(resonances.max()), resolution.PER_RESONANCE
    natural = np.concatenate([body.natural_frequencies for body in bodies])
    asked = natural[natural <= (highest_frequency or np.inf)]  # of others nobody asked
    own_mode = "the highest mode of a body", float(asked.max(initial=0.0)), resolution.PER_MODE
    per_highest = resolution.PER_HIGHEST_ON_RAIL if ground.bay else resolution.PER_HIGHEST
    highest = "the highest frequency asked for", highest_frequency or 0.0, per_highest
    steps.warn_if_coarse(system.time_step, (resonance, ground.limit, own_mode, highest))
    values = [steps.largest_values(*each) for each in zip(prepared, stiffness.tolist(), strict=True)]
    stiffest, impacts, forces = np.array(values).T
    softer = steps.softening(least, thrown, stiffest, impacts, damping, stiffness, system.time_step)
    if softer.any():
        system = system._replace(softening=softer)
        _, motion = start(ground, bodies, system, prepared)
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


def system_of(
    ground: Ground, bodies: Sequence[Body], loads: Array, h: float, constant: Array = NONE
) -> System:
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
        speed=1.0,  # slopes of mode shapes are rates already
        coupled=bool(len(channels.source) > n or (n > 1 and ground.natural.size > 0) or n > b),
        channels=channels,
    )


def alternating(system: System) -> Array:
    """Least alternating compliance of the body at each contact (n,), m/N: of all its contacts at once."""
    found, (d, f) = np.zeros(len(system.body)), (system.core_shapes.shape[1], system.shapes.shape[1])
    first = len(system.stiffness) - f * len(system.core_step)  # of the modes of bodies
    modes = steps.alternating_of_modes(system.coefficients)[first:]
    for b, step in enumerate(system.core_step):
        at = np.flatnonzero(system.body == b)
        core = np.linalg.solve(np.eye(2 * d) + step, (system.core_now - system.core_before)[at].T)[:d]
        shapes = system.shapes[at]
        matrix = system.core_shapes[at] @ core + (shapes * modes[b * f : (b + 1) * f]) @ shapes.T
        found[at] = float(np.linalg.eigvalsh(0.5 * (matrix + matrix.T)).min())
    return found


Evaluation = Callable[[float], tuple[float, float]]
FIRST_MOVE = 1e-6  # m, of the contacts; doubled until they are at rest
LARGEST_MOVE = 1.0  # m
ITERATIONS = 200
TOLERANCE, STEPPED_TOLERANCE = 1e-9, 1e-5
"""Of the forces at rest, relative to the loads; contacts of stepped laws are themselves solved to one."""
PRELOAD = 2.0
"""Kernel lengths for which the load has rolled before the path."""
LOADINGS = 20
"""Times, at most, that a rail is loaded anew for bodies that share their load over several contacts."""
ON_SUPPORT = 1e-9
"""Time from a support that counts as none, s."""


def at_rest(
    bodies: Sequence[Body],
    displaced: Array,
    compliance: Array,
    laws: Sequence[Evaluation],
    relative: float = TOLERANCE,
) -> tuple[Array, Array, Array, Array]:
    """Where bodies rest on laws, which give force, N, and stiffness, N/m, of an approach, m.

    Displacements y of all bodies (d,), one after another, upwards, and of the contacts (n,) their forces, N,
    approaches as the laws see them, m, and stiffnesses, N/m.

    What is rolled over is displaced by u (n,), m, whatever the forces, and all that yields by a compliance
    Q Qᵀ (n, n), m/N, of structure and of the bodies' modes. With y of the bodies and c of what yields the
    approaches are δ = −(u + A y + Q c). At rest K y + p = Aᵀ F and c = Qᵀ F, which is where ½ yᵀKy + pᵀy +
    ½ c² plus the energy of the contacts is least: steps of Newton's, halved until they go down. The forces
    are exact to `relative` of the loads. A `ComputationError` says that nothing is at rest.
    """
    square, vectors = np.linalg.eigh(compliance)
    n = len(displaced)
    coordinates = sum(len(body.mass) for body in bodies)
    shapes = np.hstack([block_diag(*(body.contacts for body in bodies)), vectors * np.sqrt(square.clip(0.0))])
    matrix = block_diag(*(body.stiffness for body in bodies), np.eye(n))
    pressing = np.concatenate([*(body.pressing for body in bodies), np.zeros(n)])
    loads = np.concatenate([body.static_loads for body in bodies])
    scale = np.maximum(loads, loads.clip(0.0).mean())
    x, force, approach, stiffness = equilibrium(matrix, pressing, shapes, displaced, scale, laws, relative)
    return x[:coordinates], force, approach, stiffness


def equilibrium(
    matrix: Array,
    pressing: Array,
    shapes: Array,
    displaced: Array,
    scale: Array,
    laws: Sequence[Evaluation],
    relative: float = TOLERANCE,
) -> tuple[Array, Array, Array, Array]:
    """Coordinates x (d,) with K x + p = Aᵀ F, and forces, approaches and stiffnesses of the contacts (n,).

    The approaches are −(u + A x). K (d, d), p (d,) and A (n, d) are matrix, pressing and shapes, u (n,) what
    is displaced; the forces are exact to `relative` of their scale (n,), N.
    """
    most = FIRST_MOVE

    def state(x: Array) -> tuple[Array, Array, Array, Array]:
        """Approaches, forces, stiffnesses, and the gradient of the energy."""
        approach = -(displaced + shapes @ x)
        force, stiffness = np.array([law(float(at)) for law, at in zip(laws, approach, strict=True)]).T
        return approach, force, stiffness, matrix @ x + pressing - shapes.T @ force

    x = np.zeros(len(pressing))
    approach, force, stiffness, gradient = state(x)
    for _ in range(ITERATIONS):
        firm = np.maximum(stiffness, scale / LARGEST_MOVE)
        move = -_solved(matrix + (shapes.T * firm) @ shapes, gradient)
        closer = -shapes @ move
        rounding = 1e-15 * (np.abs(displaced) + np.abs(shapes) @ np.abs(x))
        if np.all(np.abs(firm * closer) <= relative * scale + firm * rounding):
            return x + move, force + firm * closer, approach + closer, stiffness
        move *= min(1.0, most / float(np.abs(closer).max()))
        most = min(2.0 * most, LARGEST_MOVE)
        slope = float(gradient @ move)
        for _ in range(60):
            approach, force, stiffness, gradient = state(x + move)
            if float(gradient @ move) <= 0.5 * abs(slope):
                break
            move, slope = 0.5 * move, 0.5 * slope
        x = x + move
    raise ComputationError(
        f"the bodies do not come to rest on their contacts ({len(laws)}) at the start of the path: under "
        f"loads of {_some(scale)} N the last forces are {_some(force)} N, at approaches of "
        f"{_some(approach)} m",
        "smaller loads, or contact.approaches that reach higher forces",
    )


def _solved(matrix: Array, right: Array) -> Array:
    """The least solution where some motion of all is held by nothing, and no force drives it."""
    try:
        return np.asarray(np.linalg.solve(matrix, right))
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.lstsq(matrix, right, rcond=None)[0])


def _some(values: Array) -> str:
    return ", ".join(f"{value:.4g}" for value in values[:8])


def evaluated(law: Prepared | SteppedLaw, approach: float) -> tuple[float, float]:
    """Force, N, and stiffness, N/m, of a law at the start, for an approach, m."""
    if not isinstance(law, Prepared):
        return law.evaluate(0, approach)
    force, stiffness, _ = evaluate_all(law, np.array([approach]), 0)
    return float(force[0]), float(stiffness[0])


def shapes_at_contacts(ground: Ground, system: System) -> Array:
    """Mode shapes of what is rolled over, and of the bodies (n, s + b f), at the contacts."""
    n, f = system.shapes.shape
    flexible = np.zeros((n, len(system.core_step), f))
    flexible[np.arange(n), system.body] = system.shapes
    return np.hstack([ground.shapes, flexible.reshape(n, -1)])


def evaluations(prepared: Sequence[Prepared | SteppedLaw]) -> tuple[list[Evaluation], float]:
    """Laws at the start, and to what the forces at rest are exact, relative to the loads."""
    looked_up = all(isinstance(law, Prepared) for law in prepared)
    return [partial(evaluated, law) for law in prepared], TOLERANCE if looked_up else STEPPED_TOLERANCE


def start_at_rest(
    ground: Ground,
    bodies: Sequence[Body],
    system: System,
    prepared: Sequence[Prepared | SteppedLaw],
    *,
    entering: bool = False,
) -> tuple[Array, Motion]:
    """Stiffnesses of contacts at rest at the start of their paths (n,), N/m, and the state that goes on.

    Modes and contacts move as under constant loads that have long rolled. Displacements of modes are the
    static ones: what is left to ring is less by (k v/ω)² than that of a mode of wavenumber k. A force that is
    entering on a support has just come onto a structure at rest; modes that nothing holds are at rest, too.
    """
    n = len(system.loads)
    s = len(ground.natural)
    shapes = shapes_at_contacts(ground, system)
    held = system.stiffness > 0.0
    softness = np.divide(1.0, system.stiffness, out=np.zeros(len(held)), where=held)
    compliance = ground.yields + (shapes * softness) @ shapes.T + np.diag(system.softening)
    laws, relative = evaluations(prepared)
    force = np.concatenate([body.static_loads for body in bodies])
    displaced = np.zeros(n)
    rates = np.zeros(n)
    motion = at_zero(system)
    for _ in range(LOADINGS if ground.memory else 1):
        if ground.memory:
            motion = at_zero(system)
            rail, rates = _rolled_up(system, motion, force, int(PRELOAD * ground.memory))
            displaced = rail - ground.yields @ force
        before = force
        coordinates, force, approach, stiffness = at_rest(bodies, displaced, compliance, laws, relative)
        change = np.abs(force - before).max()
        if change <= relative * np.abs(force).max():
            break
    moving = force * ~_on_support(ground) if entering else force
    motion.push[:] = force @ shapes
    motion.displacement[:] = motion.push * softness
    motion.velocity[:s] = (moving @ ground.rates) * softness[:s]
    rates = rates + ground.shapes @ motion.velocity[:s]
    rates += ground.rates @ motion.displacement[:s]
    d = system.core_shapes.shape[1]
    first = 0
    for index, body in enumerate(bodies):
        own = rates[system.body == index]
        count = len(body.mass)
        motion.core[index, :count] = coordinates[first : first + count]
        motion.core[index, d : d + count] = np.linalg.lstsq(body.contacts, -own, rcond=None)[0]
        first += count
    motion.force[:] = motion.trial[:] = motion.elastic[:] = force
    motion.approach[:] = approach
    return stiffness, motion


def _on_support(ground: Ground) -> NDArray[np.bool_]:
    """Which contacts (n,) start where no mode of the structure moves."""
    largest, steepest = (np.abs(each).max(axis=1, initial=0.0) for each in (ground.shapes, ground.rates))
    return np.asarray(largest <= ON_SUPPORT * steepest)


def _rolled_up(system: System, motion: Motion, force: Array, steps: int) -> tuple[Array, Array]:
    """Let constant forces roll on a rail; its displacements under the contacts, m, and their rates, m/s."""
    before = np.zeros(len(force))
    channels = system.channels
    preload_channels(channels, motion, force, steps, before)
    rates = (motion.rail_ahead - before) / system.time_step
    np.add.at(motion.rail_ahead, channels.receiver, motion.rail_now * force[channels.source])
    return motion.rail_ahead.copy(), rates


def at_zero(system: System) -> Motion:
    """A state of all zeros."""
    m = len(system.stiffness)
    n = len(system.loads)
    p = len(system.channels.source)
    shapes: dict[str, Any] = dict.fromkeys(("displacement", "velocity", "push", "ahead"), m)
    shapes |= dict.fromkeys(("elastic", "rail_ahead", "trial", "compliance", "rate", "climb"), n)
    shapes |= dict.fromkeys(("core", "core_ahead"), system.core_pressed.shape)
    shapes |= {"force": (2, n), "approach": (2, n), "power": POWERS, "ledger": 6, "rail_now": p}
    shapes |= {"rail": (p, system.channels.decay.shape[1])}
    shapes |= {"ring": (n, system.channels.scattered.shape[2] if p else 0)}
    arrays = {name: np.zeros(shape) for name, shape in shapes.items()}
    return Motion(**arrays, counts=np.zeros(3, dtype=np.int64))
