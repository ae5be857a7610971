"""The state from which several bodies start: loads carried as if they had rolled steadily for long."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.pointforce import Prepared
from asperity.kernels.rail import preload_channels
from asperity.kernels.several import POWERS, Assembly, ContactsMotion
from asperity.laws.base import SteppedLaw
from asperity.rolling.beam import carried
from asperity.rolling.outcome import STEPPED_EQUILIBRIUM, evaluation
from asperity.rolling.path import Path
from asperity.rolling.rail import PRELOAD
from asperity.rolling.several.statics import Rest, at_rest
from asperity.rolling.several.steps import BodySteps
from asperity.rolling.several.under import Under
from asperity.structures.body import Body

Array = NDArray[np.float64]
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
