"""A ball on a beam, advanced step by step, compiled."""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray

from asperity.kernels.modal import (
    BeamMotion,
    BeamRecord,
    System,
    complete_beam_step,
    free_beam_step,
    roll_beam,
)
from asperity.kernels.pointforce import Prepared
from asperity.kinds.ball_on_beam.energy import beam_energy
from asperity.rolling.beam import ShapesAlong
from asperity.rolling.path import Path
from asperity.rolling.stepping import Free, copied, put_back
from asperity.structures.beam import Beam


class BeamStepper:
    """Ball and beam behind the protocol of `asperity.rolling.stepping.Stepper`.

    `first` holds displacement, m, and velocity, m/s, of the ball and the energy of the beam, J, at the start.
    """

    def __init__(
        self, system: System, motion: BeamMotion, record: BeamRecord, beam: Beam, path: Path
    ) -> None:
        self.system, self.motion, self.record = system, motion, record
        self.path, self.along = path, ShapesAlong(beam, path)
        self.load, self.total = system.load, path.total
        self.first = float(motion.ball[0]), float(motion.ball[1]), beam_energy(system, motion)

    def bound(self) -> int:
        """End of the chunk in which the next step lies; its mode shapes are made ready."""
        return self.along.end_of_chunk(int(self.motion.counts[0]) + 1)

    def roll(self, law: Prepared, stop: int, largest: float) -> bool:
        """Advance to a step under a compiled law."""
        along = self.along
        return bool(
            roll_beam(
                self.system,
                self.motion,
                self.record,
                law,
                along.shapes,
                along.slopes,
                along.offset,
                stop,
                largest,
            )
        )

    def free(self, step: int) -> Free:
        """Where a step ends without the force at its end."""
        shape, ahead, _ = self.along.around(step)
        result: Free = free_beam_step(self.system, self.motion, shape, ahead)
        return result

    def complete(self, step: int, force: float, evaluations: int, converged: bool) -> None:
        """Advance over the step whose end has this force."""
        around = self.along.around(step)
        complete_beam_step(
            self.system, self.motion, self.record, step, *around, force, evaluations, converged
        )  # fmt: skip

    def where(self, step: int) -> str:
        """Time and position of a step."""
        return self.path.where(step)

    def state(self) -> dict[str, NDArray[Any]]:
        """Of the motion."""
        return copied(self.motion)

    def restore(self, state: dict[str, NDArray[Any]]) -> None:
        """Go on from a saved state."""
        put_back(self.motion, state)
