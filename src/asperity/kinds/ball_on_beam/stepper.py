"""A ball on a beam, advanced step by step."""

from __future__ import annotations

import numpy as np
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
from asperity.rolling.stepping import Free
from asperity.structures.beam import Beam

CHUNK = 2048  # steps whose mode shapes are held at once


class BeamStepper:
    """Ball and beam behind the protocol of `asperity.rolling.stepping.Stepper`.

    Mode shapes are evaluated in chunks whose bounds do not depend on where a run was taken up, so that a
    resumed run equals an uninterrupted one bit by bit.

    Parameters
    ----------
    system, motion, record
        Constants, state and histories.
    beam : Beam
        Gives the mode shapes under the contact.
    positions : ndarray (n,)
        Of the contact, m; equally spaced by speed and time step.
    """

    def __init__(
        self,
        system: System,
        motion: BeamMotion,
        record: BeamRecord,
        beam: Beam,
        positions: NDArray[np.float64],
    ) -> None:
        self.system, self.motion, self.record = system, motion, record
        self.beam, self.positions = beam, positions
        self.load, self.total = system.load, len(positions) - 1
        self._offset = -1
        self._shapes = self._slopes = np.zeros((0, 0))

    def bound(self) -> int:
        """End of the chunk in which the next step lies; its mode shapes are made ready."""
        offset = int(self.motion.counts[0]) // CHUNK * CHUNK
        end = min(offset + CHUNK, self.total)
        if offset != self._offset:
            start, spacing = float(self.positions[offset]), self.system.speed * self.system.time_step
            self._shapes, self._slopes = self.beam.shapes_along(start, spacing, end + 1 - offset)
            self._offset = offset
        return end

    def roll(self, law: Prepared, stop: int, largest: float) -> bool:
        """Advance to a step under a compiled law."""
        return bool(
            roll_beam(
                self.system,
                self.motion,
                self.record,
                law,
                self._shapes,
                self._slopes,
                self._offset,
                stop,
                largest,
            )
        )

    def free(self, step: int) -> Free:
        """Where a step ends without the force at its end."""
        row = step - self._offset
        result: Free = free_beam_step(self.system, self.motion, self._shapes[row - 1], self._shapes[row])
        return result

    def complete(self, step: int, force: float, evaluations: int, converged: bool) -> None:
        """Advance over the step whose end has this force."""
        row = step - self._offset
        shape, next_shape, next_slope = self._shapes[row - 1], self._shapes[row], self._slopes[row]
        complete_beam_step(
            self.system, self.motion, self.record, step, shape, next_shape, next_slope,
            force, evaluations, converged,
        )  # fmt: skip

    def where(self, step: int) -> str:
        """Time and position of a step."""
        return f"time {step * self.system.time_step:.6g} s, position {self.positions[step]:.6g} m"
