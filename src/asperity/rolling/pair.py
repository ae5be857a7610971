"""Any body rolls over any other: both behind the protocols of `asperity.rolling.bodies`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.modal import backward, solve_step
from asperity.kernels.pointforce import Prepared
from asperity.laws.base import Law
from asperity.progress import Progress
from asperity.rolling.bodies import RolledOver, Rolls, Side
from asperity.rolling.path import Path
from asperity.rolling.rolled import Limit, Rolled, roll_along
from asperity.rolling.stability import contact_resonance
from asperity.rolling.stepping import Free, copied, put_back
from asperity.store import Checkpoint

CHUNK = 256  # steps between looks at progress and checkpoint


class PairMotion(NamedTuple):
    """What couples the bodies: force, N, and approach as the law sees it, m, now and one step ago; counts."""

    force: NDArray[np.float64]
    approach: NDArray[np.float64]
    counts: NDArray[np.int64]


class PairRecord(NamedTuple):
    """Histories (n,): contact force, N; approach, and displacements of both bodies downwards, m."""

    force: NDArray[np.float64]
    approach: NDArray[np.float64]
    over: NDArray[np.float64]
    rolling: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class RolledPair(Rolled):
    """One body has rolled over another, both of any kind."""

    # (n,), of what is rolled over, at the contact, m, positive downwards
    over_displacement: NDArray[np.float64]
    rolling_displacement: NDArray[np.float64]  # (n,), of what rolls, at the contact, m, positive downwards


def roll_pair(
    over: RolledOver,
    rolls: Rolls,
    law: Law,
    *,
    speed: float,
    start: float,
    duration: float,
    time_step: float,
    settling: float = 0.0,
    highest_frequency: float | None = None,
    progress: Progress | None = None,
    checkpoint: Checkpoint | None = None,
) -> RolledPair:
    """Roll one body over another at constant speed, m/s, and keep what follows the run-in.

    The contact is at `start` at time zero, after the run-in, m; the law reads its texture at its position.
    Times in s. The time step is checked against the highest frequency of interest, Hz. A checkpoint keeps the
    state about every 10 s, at the end and when interrupted, to go on from there.

    Both are advanced exactly, or as exactly as they know, for a contact force that varies linearly over a
    step; the force at the end of each step solves the contact law implicitly. A step that is too long to be
    stable is kept so by a softened contact, with a warning (`asperity.rolling.stability`). Bodies are stepped
    from Python, some 50 µs a step. Warned of is what `asperity.rolling.rolled.roll_along` warns of.
    """
    path = Path.laid(start, speed, time_step, duration, settling)
    below = over.laid(path, rolls.load)

    def stand(approach: float, softening: float) -> Pair:
        closer = approach + softening * rolls.load
        above = rolls.placed(path, -(below.displacement + closer), -below.velocity)
        return Pair(path, rolls.load, below, above, approach, softening)

    alternating = over.alternating_compliance(path) + rolls.alternating_compliance(path)

    def limits(stiffness: float) -> Iterator[Limit]:
        direct = below.compliance(1) + rolls.placed(path, 0.0, 0.0).compliance(1)
        yield "the contact resonance", contact_resonance(stiffness, direct, alternating, time_step), 10.0
        yield "the highest frequency asked for", highest_frequency or 0.0, 10.0

    rolled, pair = roll_along(
        path,
        law,
        rolls.load,
        stand,
        alternating=(alternating, alternating),
        limits=limits,
        progress=progress,
        checkpoint=checkpoint,
    )
    kept = slice(path.settled, None)
    return RolledPair(
        **vars(rolled),
        over_displacement=pair.record.over[kept],
        rolling_displacement=pair.record.rolling[kept],
    )


class Pair:
    """Two bodies, from rest, behind the protocol of `asperity.rolling.stepping.Stepper`.

    Under the load, N, the approach is as the law sees it, m; `softening` is a compliance in series with the
    contact, m/N.
    """

    def __init__(
        self, path: Path, load: float, below: Side, above: Side, approach: float, softening: float
    ) -> None:
        self.path, self.load, self.total = path, load, path.total
        self.below, self.above, self.softening = below, above, softening
        self.motion = PairMotion(np.full(2, load), np.full(2, approach), np.zeros(3, dtype=np.int64))
        self.record = PairRecord(*(np.zeros(path.total + 1) for _ in PairRecord._fields))
        self._observe(0)

    def bound(self) -> int:
        """Step up to which it is advanced in one go."""
        return min(int(self.motion.counts[0]) + CHUNK, self.total)

    def roll(self, law: Prepared, stop: int, largest: float) -> bool:
        """Advance to a step under a compiled law."""
        force = self.motion.force
        for step in range(int(self.motion.counts[0]) + 1, stop + 1):
            guess = 2.0 * force[0] - force[1]
            self.complete(step, *solve_step(law, step, self.free(step), self.load, guess))
            if not abs(force[0]) <= largest:
                return False
        return True

    def free(self, step: int) -> Free:
        """Where a step ends without the force at its end, and what that force does."""
        force = float(self.motion.force[0])
        approach = -(self.below.free(step, force) + self.above.free(step, force))
        compliance = self.below.compliance(step) + self.above.compliance(step) + self.softening
        found: Free = backward(approach, compliance, self.motion.approach, self.path.time_step)
        return found

    def complete(self, step: int, force: float, evaluations: int, converged: bool) -> None:
        """Advance over the step whose end has this force."""
        motion, before = self.motion, float(self.motion.force[0])
        self.below.complete(step, before, force)
        self.above.complete(step, before, force)
        motion.force[:] = force, before
        self._observe(step)
        motion.approach[:] = self.record.approach[step] - self.softening * force, motion.approach[0]
        motion.counts[:] = step, motion.counts[1] + (not converged), motion.counts[2] + evaluations

    def _observe(self, step: int) -> None:
        below, above, record = self.below.displacement, self.above.displacement, self.record
        record.force[step], record.approach[step] = self.motion.force[0], -(below + above)
        record.over[step], record.rolling[step] = below, -above

    def where(self, step: int) -> str:
        """Time and position of a step."""
        return self.path.where(step)

    def state(self) -> dict[str, NDArray[Any]]:
        """Of the coupling and of both bodies."""
        sides = {"over": self.below.state(), "rolling": self.above.state()}
        return copied(self.motion) | {
            f"{side}.{name}": value for side, state in sides.items() for name, value in state.items()
        }

    def restore(self, state: dict[str, NDArray[Any]]) -> None:
        """Go on from a saved state."""
        put_back(self.motion, state)
        for side, body in (("over.", self.below), ("rolling.", self.above)):
            body.restore({k.removeprefix(side): v for k, v in state.items() if k.startswith(side)})
