"""Bodies at rest on their contacts, from where they start as if they had rolled for long."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from scipy.linalg import block_diag

from asperity.arguments import Array
from asperity.errors import ComputationError
from asperity.kernels.pointforce import Prepared, evaluate_all
from asperity.kernels.rail import preload_channels
from asperity.kernels.stepping import POWERS, Motion, System
from asperity.laws.base import SteppedLaw
from asperity.rolling.ground import Ground
from asperity.structures.body import Body

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
"""Distance to a support that counts as none, m."""


@dataclass(frozen=True, eq=False)
class Rest:
    """Bodies at rest on n contacts."""

    displacement: Array  # y of all bodies (d,), one after another, upwards
    force: Array  # (n,), N
    approach: Array  # (n,), as the laws see it, m
    stiffness: Array  # (n,), of the contacts, N/m


def at_rest(
    bodies: Sequence[Body],
    displaced: Array,
    compliance: Array,
    laws: Sequence[Evaluation],
    relative: float = TOLERANCE,
) -> Rest:
    """Where bodies rest on laws, which give force, N, and stiffness, N/m, of an approach, m.

    What is rolled over is displaced by u (n,), m, whatever the forces, and all that yields by a compliance
    Q Qᵀ (n, n), m/N, of structure and of the bodies' modes. With y of the bodies and c of what yields the
    approaches are δ = −(u + A y + Q c). At rest K y + p = Aᵀ F and c = Qᵀ F, which is where ½ yᵀKy + pᵀy +
    ½ c² plus the energy of the contacts is least: steps of Newton's, halved until they go down. The forces
    are exact to `relative` of the loads. A `ComputationError` says that nothing is at rest.
    """
    square, vectors = np.linalg.eigh(compliance)
    n, coordinates = len(displaced), sum(len(body.mass) for body in bodies)
    shapes = np.hstack([block_diag(*(body.contacts for body in bodies)), vectors * np.sqrt(square.clip(0.0))])
    matrix = block_diag(*(body.stiffness for body in bodies), np.eye(n))
    pressing = np.concatenate([*(body.pressing for body in bodies), np.zeros(n)])
    loads = np.concatenate([body.static_loads for body in bodies])
    scale, most = np.maximum(loads, loads.clip(0.0).mean()), FIRST_MOVE

    def state(x: Array) -> tuple[Array, Array, Array, Array]:
        """Approaches, forces, stiffnesses, and the gradient of the energy."""
        approach = -(displaced + shapes @ x)
        force, stiffness = np.array([law(float(at)) for law, at in zip(laws, approach, strict=True)]).T
        return approach, force, stiffness, matrix @ x + pressing - shapes.T @ force

    x = np.zeros(len(pressing))
    approach, force, stiffness, gradient = state(x)
    for _ in range(ITERATIONS):
        firm = np.maximum(stiffness, scale / LARGEST_MOVE)
        move = -np.linalg.solve(matrix + (shapes.T * firm) @ shapes, gradient)
        closer = -shapes @ move
        rounding = 1e-15 * (np.abs(displaced) + np.abs(shapes) @ np.abs(x))
        if np.all(np.abs(firm * closer) <= relative * scale + firm * rounding):
            x = x + move
            return Rest(x[:coordinates], force + firm * closer, approach + closer, stiffness)
        move *= min(1.0, most / float(np.abs(closer).max()))
        most, slope = min(2.0 * most, LARGEST_MOVE), float(gradient @ move)
        for _ in range(60):
            approach, force, stiffness, gradient = state(x + move)
            if float(gradient @ move) <= 0.5 * abs(slope):
                break
            move, slope = 0.5 * move, 0.5 * slope
        x = x + move
    raise ComputationError(
        f"the bodies do not come to rest on their contacts ({n}) at the start of the path: under loads of "
        f"{_some(loads)} N the last forces are {_some(force)} N, at approaches of {_some(approach)} m",
        "smaller loads, or contact.approaches that reach higher forces",
    )


def _some(values: Array) -> str:
    return ", ".join(f"{value:.4g}" for value in values[:8])


def evaluated(law: Prepared | SteppedLaw, approach: float) -> tuple[float, float]:
    """Force, N, and stiffness, N/m, of a law at the start, for an approach, m."""
    if not isinstance(law, Prepared):
        return law.evaluate(0, approach)
    force, stiffness, _ = evaluate_all(law, np.array([approach]), 0)
    return float(force[0]), float(stiffness[0])


def start_at_rest(
    ground: Ground, bodies: Sequence[Body], system: System, prepared: Sequence[Prepared | SteppedLaw]
) -> tuple[Rest, Motion]:
    """Bodies at rest at the start of their paths, and the state that goes on from there.

    Modes and contacts move as under constant loads that have long rolled. Displacements of modes are the
    static ones: what is left to ring is less by (k v/ω)² than that of a mode of wavenumber k. A force on a
    support has just come onto a structure at rest; so are modes that nothing holds.
    """
    n, (s, f) = len(system.loads), (len(ground.natural), system.shapes.shape[1])
    flexible = np.zeros((n, len(bodies), f))
    flexible[np.arange(n), system.body] = system.shapes
    shapes = np.hstack([ground.shapes, flexible.reshape(n, -1)])
    held = system.stiffness > 0.0
    softness = np.divide(1.0, system.stiffness, out=np.zeros(len(held)), where=held)
    compliance = ground.yields + (shapes * softness) @ shapes.T + np.diag(system.softening)
    compiled, laws = (
        all(isinstance(law, Prepared) for law in prepared),
        [partial(evaluated, law) for law in prepared],
    )
    relative = TOLERANCE if compiled else STEPPED_TOLERANCE
    force, displaced, rates = np.concatenate([body.static_loads for body in bodies]), np.zeros(n), np.zeros(n)
    motion = at_zero(system)
    for _ in range(LOADINGS if ground.memory else 1):
        if ground.memory:
            motion = at_zero(system)
            rail, rates = _rolled_up(system, motion, force, int(PRELOAD * ground.memory))
            displaced = rail - ground.yields @ force
        rest = at_rest(bodies, displaced, compliance, laws, relative)
        change, force = np.abs(rest.force - force).max(), rest.force
        if change <= relative * np.abs(force).max():
            break
    largest, steepest = (np.abs(each).max(axis=1, initial=0.0) for each in (ground.shapes, ground.slopes))
    moving = force * (largest > ON_SUPPORT * steepest)
    motion.push[:] = force @ shapes
    motion.displacement[:] = motion.push * softness
    motion.velocity[:s] = system.speed * (moving @ ground.slopes) * softness[:s]
    rates = rates + ground.shapes @ motion.velocity[:s]
    rates += system.speed * (ground.slopes @ motion.displacement[:s])
    d, first = system.core_shapes.shape[1], 0
    for index, body in enumerate(bodies):
        own, count = rates[system.body == index], len(body.mass)
        motion.core[index, :count] = rest.displacement[first : first + count]
        motion.core[index, d : d + count] = np.linalg.lstsq(body.contacts, -own, rcond=None)[0]
        first += count
    motion.force[:] = motion.trial[:] = motion.elastic[:] = force
    motion.approach[:] = rest.approach
    return rest, motion


def _rolled_up(system: System, motion: Motion, force: Array, steps: int) -> tuple[Array, Array]:
    """Let constant forces roll on a rail; its displacements under the contacts, m, and their rates, m/s."""
    before, channels = np.zeros(len(force)), system.channels
    preload_channels(channels, motion, force, steps, before)
    rates = (motion.rail_ahead - before) / system.time_step
    np.add.at(motion.rail_ahead, channels.receiver, motion.rail_now * force[channels.source])
    return motion.rail_ahead.copy(), rates


def at_zero(system: System) -> Motion:
    """A state of all zeros."""
    m, n, p = len(system.stiffness), len(system.loads), len(system.channels.source)
    modal = ("displacement", "velocity", "push", "ahead")
    of_contacts = ("elastic", "rail_ahead", "trial", "compliance", "rate", "climb")
    shapes: dict[str, Any] = dict.fromkeys(modal, m) | dict.fromkeys(of_contacts, n)
    shapes |= dict.fromkeys(("core", "core_ahead"), system.core_pressed.shape)
    shapes |= dict.fromkeys(("force", "approach"), (2, n))
    shapes |= {"rail": (p, system.channels.decay.shape[1]), "rail_now": p}
    shapes |= {"ring": (n, system.channels.scattered.shape[2] if p else 0)}
    shapes |= {"power": POWERS, "ledger": 6}
    arrays = {name: np.zeros(shape) for name, shape in shapes.items()}
    return Motion(**arrays, counts=np.zeros(3, dtype=np.int64))
