"""The path of the contacts: where they are at every time step."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.errors import InputError


@dataclass(frozen=True, eq=False)
class Path:
    """Positions of contacts that move at constant speed."""

    positions: NDArray[np.float64]  # (c, n), at every time step of run-in and record, m
    speed: float  # m/s
    time_step: float  # s
    settled: int = 0  # steps of the run-in; the record starts behind them

    @classmethod
    def laid(cls, start: float, speed: float, time_step: float, duration: float, settling: float) -> Path:
        """Lay out one contact: a run-in of `settling`, s, and from `start`, m, a record of `duration`, s."""
        for what, value in (("speed (m/s)", speed), ("duration (s)", duration), ("time step (s)", time_step)):
            if not (np.isfinite(value) and value > 0.0):
                raise InputError(what, value, "a finite positive number")
        if not (np.isfinite(settling) and settling >= 0.0):
            raise InputError("settling (s)", settling, "zero or a finite positive number")
        steps, settled = (int(np.floor(time / time_step * (1.0 + 1e-12))) for time in (duration, settling))
        if steps < 1:
            raise InputError("duration (s)", duration, f"at least one time step of {time_step:.6g} s")
        positions = np.asarray(start + speed * time_step * np.arange(-settled, steps + 1))
        return cls(positions[None], speed, time_step, settled)

    def ahead(self, offsets: ArrayLike) -> Path:
        """Contacts that run ahead of the first one of this path by some distances (c,), m."""
        return replace(self, positions=self.positions[0] + np.asarray(offsets)[:, None])

    @property
    def total(self) -> int:
        """Time steps of run-in and record."""
        return self.positions.shape[1] - 1

    @property
    def starts(self) -> NDArray[np.float64]:
        """Positions of the contacts at step zero (c,), m."""
        return self.positions[:, 0]

    @property
    def time(self) -> NDArray[np.float64]:
        """Times of the record, s, from zero."""
        return np.asarray(self.time_step * np.arange(self.total + 1 - self.settled))
