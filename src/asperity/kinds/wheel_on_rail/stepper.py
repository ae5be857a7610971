"""A wheel on a rail, advanced step by step, compiled."""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray

from asperity.kernels.pointforce import Prepared
from asperity.kernels.rail import (
    RailMotion,
    RailRecord,
    Vehicle,
    complete_rail_step,
    free_rail_step,
    roll_rail,
)
from asperity.rolling.path import Path
from asperity.rolling.stepping import Free, copied, put_back

CHUNK = 16384  # steps between reports of progress


class RailStepper:
    """Wheel and rail behind the protocol of `asperity.rolling.stepping.Stepper`."""

    def __init__(self, vehicle: Vehicle, motion: RailMotion, record: RailRecord, path: Path) -> None:
        self.vehicle, self.motion, self.record, self.path = vehicle, motion, record, path
        self.load, self.total = vehicle.load, path.total

    def bound(self) -> int:
        """Step up to which it is advanced in one go."""
        return min(int(self.motion.counts[0]) + CHUNK, self.total)

    def roll(self, law: Prepared, stop: int, largest: float) -> bool:
        """Advance to a step under a compiled law."""
        return bool(roll_rail(self.vehicle, self.motion, self.record, law, stop, largest))

    def free(self, step: int) -> Free:
        """Advance all but the last force of a step."""
        result: Free = free_rail_step(self.vehicle, self.motion, step)
        return result

    def complete(self, step: int, force: float, evaluations: int, converged: bool) -> None:
        """Apply the force at the end of the step."""
        complete_rail_step(self.vehicle, self.motion, self.record, step, force, evaluations, converged)

    def where(self, step: int) -> str:
        """Time and position of a step."""
        return self.path.where(step)

    def state(self) -> dict[str, NDArray[Any]]:
        """Of the motion."""
        return copied(self.motion)

    def restore(self, state: dict[str, NDArray[Any]]) -> None:
        """Go on from a saved state."""
        put_back(self.motion, state)
