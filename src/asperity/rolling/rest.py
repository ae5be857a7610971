"""Where every run begins: at rest under its loads, and moving on as if all had long rolled."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import block_diag

from asperity.arguments import Array, Flags
from asperity.errors import ComputationError
from asperity.kernels.pointforce import Prepared, evaluate_all
from asperity.kernels.rail import preload_channels
from asperity.kernels.stepping import POWERS, Motion, System
from asperity.laws.spec import SteppedLaw
from asperity.rolling.course import alike
from asperity.rolling.ground import Ground
from asperity.structures.body import Body

Evaluation = Callable[[Array], tuple[Array, Array]]
"""Forces (n,), N, and stiffnesses (n,), N/m, of n contacts at an approach each (n,), m."""
FIRST_MOVE = 1e-6  # m, of the contacts
LARGEST_MOVE = 1.0  # m
ITERATIONS = 200
TOLERANCE, STEPPED_TOLERANCE = 1e-9, 1e-5
"""Of the forces at rest, relative to the loads; contacts of stepped laws are themselves solved to one."""
PRELOAD = 2
"""Kernel lengths for which the load has rolled before the path: of what is scattered one is all there is."""
LOADINGS = 20
"""Times, at most, that a rail is loaded anew for bodies that share their load over several contacts."""
ON_SUPPORT = 1e-9
"""Time from a support that counts as none, s."""


def at_rest(
    bodies: Sequence[Body],
    displaced: Array,
    compliance: Array,
    laws: Evaluation,
    scale: Array,
    relative: float = TOLERANCE,
    free: tuple[Array, Array] | None = None,
) -> tuple[Array, Array, Array, Array]:
    """Where bodies rest on the laws of all contacts.

    Coordinates of free modes (f,), then displacements y of all bodies (d,), one after another, upwards, and
    of the contacts (n,) their forces, N, approaches as the laws see them, m, and stiffnesses, N/m.

    What is rolled over is displaced by u (n,), m, whatever the forces, and all that yields by a compliance
    Q Qᵀ (n, n), m/N, of structure and of the bodies' modes; modes that nothing but contacts holds have
    shapes Φ (n, f) and are pressed by constant forces p₀ (f,). With q of these, y of the bodies and c of what
    yields the approaches are δ = −(u + Φ q + A y + Q c). At rest p₀ + Φᵀ F = 0, K y + p = Aᵀ F and c = Qᵀ F,
    which is where ½ yᵀKy + pᵀy − p₀ᵀq + ½ c² plus the energy of the contacts is least: steps of Newton's,
    halved until they go down, and at most twice as long as the last. The forces are exact to `relative` of
    their scale (n,), N. A `ComputationError` says that nothing is at rest.
    """
    moved, pressed = (np.zeros((len(displaced), 0)), np.zeros(0)) if free is None else free
    matrix, shapes = _coordinates(bodies, compliance, moved)
    forces = [-pressed, *(body.pressing for body in bodies), np.zeros(len(displaced))]
    found = equilibrium(matrix, np.concatenate(forces), shapes, displaced, scale, laws, relative)
    x, force, approach, stiffness = found
    return x[: -len(displaced)], force, approach, stiffness


def _coordinates(bodies: Sequence[Body], compliance: Array, moved: Array) -> tuple[Array, Array]:
    """Stiffness of all coordinates x of `at_rest`, and displacements of the contacts by them."""
    square, vectors = np.linalg.eigh(compliance)
    contacts = block_diag(*(body.contacts for body in bodies))
    free = np.zeros((moved.shape[1], moved.shape[1]))
    matrix = block_diag(free, *(body.stiffness for body in bodies), np.eye(len(square)))
    return matrix, np.hstack([moved, contacts, vectors * np.sqrt(square.clip(0.0))])


def equilibrium(
    matrix: Array,
    pressing: Array,
    shapes: Array,
    displaced: Array,
    scale: Array,
    laws: Evaluation,
    relative: float,
) -> tuple[Array, Array, Array, Array]:
    """Coordinates x (d,) with K x + p = Aᵀ F, and forces, approaches and stiffnesses of the contacts (n,).

    The approaches are −(u + A x). K (d, d), p (d,) and A (n, d) are matrix, pressing and shapes, u (n,) what
    is displaced; the forces are exact to `relative` of their scale (n,), N.
    """
    most = FIRST_MOVE

    def state(x: Array) -> tuple[Array, Array, Array, Array]:
        """Approaches, forces, stiffnesses, and the gradient of the energy."""
        approach = -(displaced + shapes @ x)
        force, stiffness = laws(approach)
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
        slope = float(gradient @ move)
        for _ in range(60):
            approach, force, stiffness, gradient = state(x + move)
            if float(gradient @ move) <= 0.5 * abs(slope):
                break
            move = 0.5 * move
            slope = 0.5 * slope
        most = float(np.clip(2.0 * np.abs(shapes @ move).max(), FIRST_MOVE, LARGEST_MOVE))
        x = x + move
    raise ComputationError(
        f"the bodies do not come to rest on their contacts ({len(scale)}) at the start of the path: under "
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


def evaluated(laws: Sequence[Prepared | SteppedLaw], dampers: Array) -> Evaluation:
    """Laws of n contacts at the start, with forces of the dampers of those that are compiled (n,), N."""
    compiled = alike([(k, law) for k, law in enumerate(laws) if isinstance(law, Prepared)])
    stepped = [(k, law) for k, law in enumerate(laws) if not isinstance(law, Prepared)]

    def evaluate(approach: Array) -> tuple[Array, Array]:
        force, stiffness = np.empty((2, len(laws)))
        for members, together in compiled:
            elastic, stiffness[members], _ = evaluate_all(together, approach[members], 0)
            force[members] = elastic + dampers[members]
        for k, law in stepped:
            force[k], stiffness[k] = law.evaluate(0, float(approach[k]))
        return force, stiffness

    return evaluate


def shapes_at_contacts(ground: Ground, system: System) -> Array:
    """Mode shapes of what is rolled over, and of the bodies (n, s + b f), at the contacts."""
    n, f = system.shapes.shape
    flexible = np.zeros((n, len(system.core_step), f))
    flexible[np.arange(n), system.body] = system.shapes
    return np.hstack([ground.shapes, flexible.reshape(n, -1)])


def set_down(
    ground: Ground,
    bodies: Sequence[Body],
    system: System,
    prepared: Sequence[Prepared | SteppedLaw],
    *,
    entering: bool,
) -> tuple[Array, Motion]:
    """Stiffnesses of contacts at rest at the start of a run (n,), N/m, and the state from which it goes on.

    Everything rests on its contacts under the constant forces, and moves on as this rest does while contacts
    go along what they roll over, and laws stay as they are: what is left to ring is less by (k v/ω)² than the
    static answer of a mode ω along which a contact goes by k v. A force that is entering on a support has
    just come onto a structure at rest. Modes that nothing holds are where constant forces and contacts hold
    each other; without constant forces on any structure they stay where they are.
    """
    damping = np.array([law.damping if isinstance(law, Prepared) else 0.0 for law in prepared])
    rest = standing(ground, bodies, system, prepared)
    closer = _move_on(ground, bodies, system, rest, entering)
    most = np.maximum(rest.motion.force[0], 0.0)  # of what hardly touches it is not known
    dampers = np.clip(damping * closer, -most, most)
    if np.any(np.abs(dampers) > TOLERANCE * system.loads):  # as the rest moves on, they press, too
        rest = standing(ground, bodies, system, prepared, dampers)
        closer = _move_on(ground, bodies, system, rest, entering)
    rest.motion.approach[1] -= system.time_step * closer
    return rest.stiffness, rest.motion


def _move_on(ground: Ground, bodies: Sequence[Body], system: System, rest: Rest, entering: bool) -> Array:
    """Give everything at rest the rates of a rest that goes on; those of the approaches (n,), m/s."""
    motion = rest.motion
    moving = motion.force[0] * ~_on_support(ground) if entering else motion.force[0]
    s = len(ground.natural)
    pushed = np.zeros(len(system.stiffness))
    pushed[:s] = moving @ ground.rates
    softness = _softness(system)
    matrix, shapes = _coordinates(bodies, rest.compliance, rest.shapes[:, rest.free])
    moved = rest.rates + ground.rates @ motion.displacement[:s] + rest.shapes @ (softness * pushed)
    pulled = np.zeros(len(matrix))
    pulled[: int(rest.free.sum())] = pushed[rest.free]
    firm = shapes.T * rest.stiffness
    rates = _solved(matrix + firm @ shapes, pulled - firm @ moved)
    closer = -(moved + shapes @ rates)
    motion.velocity[:] = (pushed + (rest.stiffness * closer) @ rest.shapes) * softness
    _place(bodies, rest.free, rates, motion.velocity, motion.core[:, system.core_shapes.shape[1] :])
    return closer


def _place(bodies: Sequence[Body], free: Flags, values: Array, modes: Array, core: Array) -> None:
    """Write values of the coordinates of `at_rest` to free ones of all modes (m,), and to bodies (b, d)."""
    first = int(free.sum())
    modes[free] = values[:first]
    for index, body in enumerate(bodies):
        count = len(body.mass)
        core[index, :count] = values[first : first + count]
        first += count


def _softness(system: System) -> Array:
    """Static compliance of each mode (m,), 0 of one that nothing holds."""
    held = system.stiffness > 0.0
    return np.divide(1.0, system.stiffness, out=np.zeros(len(held)), where=held)


@dataclass(frozen=True, eq=False)
class Rest:
    """Everything at rest on n contacts, with m modes."""

    motion: Motion
    stiffness: Array  # (n,), of the contacts, N/m
    shapes: Array  # (n, m), of all modes
    free: Flags  # (m,), modes that contacts alone hold
    compliance: Array  # (n, n), of what else yields, m/N
    rates: Array  # (n,), how fast a rail moves under them, m/s


def standing(
    ground: Ground,
    bodies: Sequence[Body],
    system: System,
    prepared: Sequence[Prepared | SteppedLaw],
    dampers: Array | None = None,
) -> Rest:
    """Everything at rest under its loads, with forces of the contacts' dampers (n,), N, where they press."""
    n = len(system.loads)
    dampers = np.zeros(n) if dampers is None else dampers
    shapes = shapes_at_contacts(ground, system)
    softness = _softness(system)
    constant = np.pad(system.constant, (0, len(softness) - len(system.constant)))
    free = shapes.any(axis=0) & (system.stiffness == 0.0) & constant.any()
    compliance = ground.yields + (shapes * softness) @ shapes.T + np.diag(system.softening)
    laws = evaluated(prepared, dampers)
    looked_up = all(isinstance(law, Prepared) for law in prepared)
    relative = TOLERANCE if looked_up else STEPPED_TOLERANCE
    force = np.concatenate([body.static_loads for body in bodies])
    pressed = shapes @ (softness * constant)
    displaced = pressed
    rates = np.zeros(n)
    motion = at_zero(system)
    for _ in range(LOADINGS if ground.memory else 1):
        if ground.memory:
            motion = at_zero(system)
            rail, rates = _rolled_up(system, motion, force, ground.memory)
            displaced = rail - ground.yields @ force + pressed
        before = force
        given = bodies, displaced, compliance, laws, system.loads, relative
        coordinates, force, approach, stiffness = at_rest(*given, (shapes[:, free], constant[free]))
        change = np.abs(force - before).max()
        if change <= relative * np.abs(force).max():
            break
    motion.push[:] = constant + force @ shapes
    motion.displacement[:] = motion.push * softness
    _place(bodies, free, coordinates, motion.displacement, motion.core)
    motion.force[:] = motion.trial[:] = force
    motion.elastic[:] = force - dampers
    motion.approach[:] = approach
    return Rest(motion, stiffness, shapes, free, compliance, rates)


def _on_support(ground: Ground) -> Flags:
    """Which contacts (n,) start where no mode of the structure moves."""
    largest, steepest = (np.abs(each).max(axis=1, initial=0.0) for each in (ground.shapes, ground.rates))
    return largest <= ON_SUPPORT * steepest


def _rolled_up(system: System, motion: Motion, force: Array, memory: int) -> tuple[Array, Array]:
    """Let constant forces roll on a rail; its displacements under the contacts, m, and their rates, m/s.

    The rail remembers so many time steps.
    """
    before = np.zeros(len(force))
    channels = system.channels
    steps = memory if channels.scatters.all() else PRELOAD * memory
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
    shapes |= dict.fromkeys(("elastic", "rail_ahead", "trial", "compliance", "free", "rate", "climb"), n)
    shapes |= dict.fromkeys(("core", "core_ahead"), system.core_pressed.shape)
    shapes |= {
        "force": (4, n),
        "approach": (2, n),
        "placed": (2, n),
        "straight": (4, n),
        "power": POWERS,
        "ledger": 6,
        "rail_now": p,
    }
    shapes |= {"rail": (p, system.channels.decay.shape[1])}
    shapes |= {"ring": (n, system.channels.scattered.shape[2] if p else 0)}
    arrays = {name: np.zeros(shape) for name, shape in shapes.items()}
    return Motion(**arrays, counts=np.zeros(3, dtype=np.int64))
