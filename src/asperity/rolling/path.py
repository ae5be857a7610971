"""The path of the contact: where it is at every time step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from asperity.errors import InputError


@dataclass(frozen=True, eq=False)
class Path:
    """Positions of a contact that moves at constant speed."""

    positions: NDArray[np.float64]  # (n,), at every time step of run-in and record, m
    speed: float  # m/s
    time_step: float  # s
    settled: int = 0  # steps of the run-in; the record starts behind them

    @classmethod
    def laid(cls, start: float, speed: float, time_step: float, duration: float, settling: float) -> Path:
        """Lay out a run-in of `settling`, s, and from `start`, m, on a record of `duration`, s."""
        for what, value in (("speed (m/s)", speed), ("duration (s)", duration), ("time step (s)", time_step)):
            if not (np.isfinite(value) and value > 0.0):
                raise InputError(what, value, "a finite positive number")
        steps, settled = count_steps(duration, settling, time_step)
        positions = np.asarray(start + speed * time_step * np.arange(-settled, steps + 1))
        return cls(positions, speed, time_step, settled)

    @property
    def total(self) -> int:
        """Time steps of run-in and record."""
        return len(self.positions) - 1

    @property
    def time(self) -> NDArray[np.float64]:
        """Times of the record, s, from zero."""
        return np.asarray(self.time_step * np.arange(len(self.positions) - self.settled))

    def where(self, step: int) -> str:
        """Time and position of a step, in words."""
        return f"time {step * self.time_step:.6g} s, position {self.positions[step]:.6g} m"


def count_steps(duration: float, settling: float, time_step: float) -> tuple[int, int]:
    """Whole time steps in the record and in the run-in before it, both in s; one at least to record."""
    if not (np.isfinite(duration) and duration > 0.0):
        raise InputError("duration (s)", duration, "a finite positive number")
    if not (np.isfinite(settling) and settling >= 0.0):
        raise InputError("settling (s)", settling, "zero or a finite positive number")
    steps, settled = (int(np.floor(time / time_step * (1.0 + 1e-12))) for time in (duration, settling))
    if steps < 1:
        raise InputError("duration (s)", duration, f"at least one time step of {time_step:.6g} s")
    return steps, settled
