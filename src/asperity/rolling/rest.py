"""Bodies at rest on several contacts, from where they start as if they had rolled for long."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from asperity.errors import ComputationError
from asperity.kernels.modal import refine
from asperity.kernels.pointforce import Prepared
from asperity.kernels.rail import preload_channels
from asperity.kernels.several import POWERS, Assembly, ContactsMotion
from asperity.laws.base import SteppedLaw
from asperity.rolling.outcome import STEPPED_EQUILIBRIUM, evaluation
from asperity.rolling.path import Path
from asperity.rolling.steps import BodySteps, carried
from asperity.rolling.support import Under
from asperity.structures.body import Body

Array = NDArray[np.float64]
Evaluation = Callable[[float], tuple[float, float]]
FIRST_MOVE = 1e-6  # m, of the contacts; doubled until they are at rest
ITERATIONS = 200
PRELOAD = 2.0
"""Kernel lengths for which the load has rolled before the path."""


@dataclass(frozen=True, eq=False)
class Rest:
    """Bodies at rest on n contacts."""

    displacement: Array  # y of all bodies (d,), one after another, upwards
    force: Array  # (n,), N
    approach: Array  # (n,), as the laws see it, m
    stiffness: Array  # (n,), of the contacts, N/m


class Statics:
    """Bodies on what is rolled over, at rest, displaced by y, and by c where structure and modes yield.

    The approaches are δ = −(u + A y + Q c), with u (n,) what is rolled over is displaced by already, m, and
    Q Qᵀ the static compliance (n, n) of all else that yields, m/N. At rest K y + p = Aᵀ F and c = Qᵀ F, which
    is where ½ yᵀKy + pᵀy + ½ c² plus the energy of the contacts is least.
    """

    def __init__(self, bodies: Sequence[Body], displaced: Array, compliance: Array) -> None:
        square, vectors = np.linalg.eigh(compliance)
        root = vectors * np.sqrt(np.maximum(square, 0.0))
        n, self.held = len(displaced), sum(len(body.mass) for body in bodies)
        self.displaced = displaced
        self.stiffness = block_diag(*(body.stiffness for body in bodies), np.eye(n))
        self.shapes = np.hstack([block_diag(*(body.contacts for body in bodies)), root])
        self.pressing = np.concatenate([*(body.pressing for body in bodies), np.zeros(n)])
        self.loads = np.concatenate([body.static_loads for body in bodies])

    def approach(self, x: Array) -> Array:
        """Of all contacts, m."""
        return -(self.displaced + self.shapes @ x)

    def guess(self, approach: Array) -> Array:
        """Displacements for these approaches, m, under the loads on a rigid plane, as near as can be."""
        force = np.maximum(self.loads, 0.0)
        scale = max(float(np.abs(self.stiffness[: self.held, : self.held]).max()), 1.0)
        yielding = self.shapes[:, self.held :].T @ force
        target = -(self.displaced + approach + self.shapes[:, self.held :] @ yielding)
        rows = self.shapes[:, : self.held]
        carried = rows.T @ force - self.pressing[: self.held]
        matrix = np.vstack([rows, self.stiffness[: self.held, : self.held] / scale])
        y = np.linalg.lstsq(matrix, np.concatenate([target, carried / scale]), rcond=None)[0]
        return np.concatenate([y, yielding])

    def gradient(self, x: Array, force: Array) -> Array:
        """Of the energy."""
        return self.stiffness @ x + self.pressing - self.shapes.T @ force


def at_rest(
    bodies: Sequence[Body],
    displaced: Array,
    compliance: Array,
    laws: Sequence[Evaluation],
    relative: float = 1e-9,
) -> Rest:
    """Where bodies rest on laws, which give force, N, and stiffness, N/m, of an approach, m.

    What is rolled over is displaced by `displaced` (n,), m, whatever the forces, and by `compliance` (n, n),
    m/N, of structure and of the bodies' modes. The forces are exact to `relative` of the loads. A
    `ComputationError` says that nothing up to a metre away is at rest.
    """
    statics = Statics(bodies, displaced, compliance)
    scale = np.maximum(statics.loads, statics.loads.clip(0.0).mean())
    known = [
        static_approach(law, load, relative) if load > 0.0 else (0.0, 0.0)
        for law, load in zip(laws, statics.loads, strict=True)
    ]
    x, most = statics.guess(np.array([approach for approach, _ in known])), FIRST_MOVE
    if len(laws) == len(bodies) and statics.loads.min() > 0.0:  # each contact carries what presses its body
        return Rest(x[: statics.held], statics.loads, *np.array(known).T)
    for _ in range(ITERATIONS):
        force, stiffness = _evaluated(laws, statics.approach(x))
        firm = np.maximum(stiffness, scale / LARGEST_STEP)
        gradient = statics.gradient(x, force)
        hessian = statics.stiffness + (statics.shapes.T * firm) @ statics.shapes
        move = -np.linalg.solve(hessian, gradient)
        moved = statics.shapes @ move
        if np.all(np.abs(firm * moved) <= relative * scale):
            balanced = force - firm * moved
            return Rest(x[: statics.held], balanced, statics.approach(x), stiffness)
        far = float(np.abs(moved).max())
        move *= min(1.0, most / far)
        most = min(2.0 * most, LARGEST_STEP)
        x = x + _share(statics, laws, x, move, float(gradient @ move)) * move
    force, _ = _evaluated(laws, statics.approach(x))
    raise ComputationError(
        f"the bodies do not come to rest on their {len(laws)} contacts at the start of the path; the last "
        f"forces are {', '.join(f'{value:.4g}' for value in force[:8])} N",
        "smaller loads, or contact.approaches that reach higher forces",
    )


def _evaluated(laws: Sequence[Evaluation], approach: Array) -> tuple[Array, Array]:
    found = np.array([law(float(value)) for law, value in zip(laws, approach, strict=True)])
    return found[:, 0], found[:, 1]


def _share(statics: Statics, laws: Sequence[Evaluation], x: Array, move: Array, slope: float) -> float:
    """Share of a move that lowers the energy: where its slope along the move has halved, or all of it."""
    low, high = 0.0, 1.0
    share = 1.0
    for _ in range(60):
        there = x + share * move
        found = float(statics.gradient(there, _evaluated(laws, statics.approach(there))[0]) @ move)
        if found <= 0.5 * abs(slope):
            if share == 1.0 or found >= 0.5 * slope:
                return share
            low = share
        else:
            high = share
        share = 0.5 * (low + high)
    return share


LOADINGS = 20
"""Times, at most, that a rail is loaded anew for bodies that share their load over several contacts."""


class Resting:
    """Bodies, what they roll over and the laws between them at the start of the path."""

    def __init__(
        self,
        under: Under,
        bodies: Sequence[Body],
        steps: BodySteps,
        system: Assembly,
        paths: Sequence[Path],
        prepared: Sequence[Prepared | SteppedLaw],
    ) -> None:
        self.bodies, self.steps, self.system = bodies, steps, system
        self.laws = [evaluation(law, 0) for law in prepared]
        self.relative = 1e-9 if all(isinstance(law, Prepared) for law in prepared) else STEPPED_EQUILIBRIUM
        self.yields = under.static_compliance(paths)
        self.shapes, self.slopes = under.shapes(np.array([path.positions[0] for path in paths]))
        self.taps = under.memory
        self.motion = blank(system)
        self.rates = np.zeros(len(paths))  # of what is under the contacts, m/s

    def on(self, softer: Array) -> Rest:
        """Bodies at rest with compliances (n,), m/N, in series with the contacts."""
        compliance = self.yields + _yielding(self.steps) + np.diag(softer)
        force = np.concatenate([body.static_loads for body in self.bodies])
        if not self.taps:
            return at_rest(self.bodies, np.zeros(len(force)), compliance, self.laws, self.relative)
        for _ in range(LOADINGS):
            displaced = self._roll_up(force) - self.yields @ force
            rest = at_rest(self.bodies, displaced, compliance, self.laws, self.relative)
            change, force = np.abs(rest.force - force).max(), rest.force
            if change <= self.relative * np.abs(force).max():
                break
        return rest

    def _roll_up(self, force: Array) -> Array:
        """Let constant forces roll on a rail long enough; displacements of the rail, m."""
        self.motion = blank(self.system)
        motion, channels, before = self.motion, self.system.channels, np.zeros(len(force))
        preload_channels(channels, motion, force, int(PRELOAD * self.taps), before)
        self.rates = (motion.rail_ahead - before) / self.system.time_step
        np.add.at(motion.rail_ahead, channels.receiver, motion.rail_now * force[channels.source])
        return motion.rail_ahead.copy()

    def start(self, rest: Rest) -> ContactsMotion:
        """The state, from that at rest: modes and contacts move as their loads roll on."""
        motion, steps, speed = self.motion, self.steps, self.system.speed
        motion.push[:] = rest.force @ self.shapes
        motion.displacement[:], motion.velocity[:] = carried(
            self.system.stiffness, self.shapes, self.slopes, rest.force, speed
        )
        self.rates += self.shapes @ motion.velocity + speed * (self.slopes @ motion.displacement)
        np.add.at(motion.core_push, steps.body, rest.force[:, None] * steps.core_shapes)
        np.add.at(motion.flexible_push, steps.body, rest.force[:, None] * steps.flexible_shapes)
        motion.flexible[0] = _held(motion.flexible_push, steps.flexible_stiffness)
        d = motion.core_push.shape[1]
        bounds = np.cumsum([0, *(len(body.mass) for body in self.bodies)])
        for index, (body, (low, high)) in enumerate(zip(self.bodies, pairwise(bounds), strict=True)):
            rates = np.linalg.lstsq(body.contacts, -self.rates[steps.body == index], rcond=None)[0]
            # the basis is orthonormal in the masses
            dual = steps.bases[index].T @ body.mass
            motion.core[index, : high - low] = dual @ rest.displacement[low:high]
            motion.core[index, d : d + high - low] = dual @ rates
        motion.force[:], motion.approach[:], motion.trial[:] = rest.force, rest.approach, rest.force
        return motion


def blank(system: Assembly) -> ContactsMotion:
    """A state of all zeros."""
    modes, (b, s), n = len(system.stiffness), system.flexible_damping.shape, len(system.loads)
    d, channels = system.core_shapes.shape[1], system.channels
    taps = channels.scattered.shape[2] if len(channels.source) else 0
    return ContactsMotion(
        displacement=np.zeros(modes),
        velocity=np.zeros(modes),
        push=np.zeros(modes),
        ahead=np.zeros(modes),
        core=np.zeros((b, 2 * d)),
        core_push=np.zeros((b, d)),
        core_ahead=np.zeros((b, 2 * d)),
        flexible=np.zeros((2, b, s)),
        flexible_push=np.zeros((b, s)),
        flexible_ahead=np.zeros((b, s)),
        force=np.zeros((2, n)),
        approach=np.zeros((2, n)),
        rail=np.zeros((len(channels.source), channels.decay.shape[1])),
        ring=np.zeros((n, taps)),
        rail_ahead=np.zeros(n),
        rail_now=np.zeros(len(channels.source)),
        trial=np.zeros(n),
        compliance=np.zeros(n),
        rate=np.zeros(n),
        climb=np.zeros(n),
        power=np.zeros(POWERS),
        ledger=np.zeros(6),
        counts=np.zeros(3, dtype=np.int64),
    )


def _yielding(steps: BodySteps) -> Array:
    """Static compliance of the bodies' modes at the contacts (n, n), m/N; none of those nothing holds."""
    n = len(steps.body)
    found = np.zeros((n, n))
    for b, squares in enumerate(steps.flexible_stiffness):
        own, held = np.flatnonzero(steps.body == b), squares > 0.0
        rows = steps.flexible_shapes[np.ix_(own, held)]
        found[np.ix_(own, own)] = (rows / squares[held]) @ rows.T
    return found


def _held(push: Array, stiffness: Array) -> Array:
    """Static displacement of modes; none of those that nothing holds."""
    return np.divide(push, stiffness, out=np.zeros_like(push), where=stiffness > 0.0)


FIRST_STEP = 1e-7  # m, doubled until the load is bracketed
LARGEST_STEP = 1.0  # m


def static_approach(
    evaluate: Callable[[float], tuple[float, float]], load: float, relative: float = 1e-9
) -> tuple[float, float]:
    """Approach, m, at which a law carries the load, N, and the stiffness there, N/m.

    `evaluate` gives force, N, and stiffness, N/m, of an approach, m; `relative` is the tolerance on the
    force, relative to the load. A `ComputationError` says that no approach up to a metre carries it.
    """
    low, high = -np.inf, np.inf
    approach, step = 0.0, FIRST_STEP
    for iteration in range(200):
        force, stiffness = evaluate(approach)
        if abs(force - load) <= relative * load:
            return approach, stiffness
        scale = max(stiffness, load / LARGEST_STEP)
        low, high, trial = refine.py_func(  # not compiled once more, for so few calls
            low, high, approach, (force - load) / scale, max(stiffness / scale, 1.0), iteration
        )
        if np.isinf(low) or np.isinf(high):
            # not bracketed yet: never leap far beyond what has been seen
            trial = approach + np.clip(trial - approach, -step, step)
            step *= 2.0
        if step > LARGEST_STEP or high - low <= 1e-15 * abs(approach):
            break
        approach = trial
    raise ComputationError(
        f"no approach carries the load of {load:.6g} N at the start of the path; "
        f"the last, {approach:.6g} m, gives {force:.6g} N",
        "a smaller load, or contact.approaches that reach higher forces",
    )
