"""Where contacts are at the steps of a run, and how fast they go there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from asperity.arguments import Array, ArrayLike, positive, real
from asperity.errors import InputError
from asperity.speeds import SpeedCourse

Values = Callable[[range], Array]
"""Values at time steps, counted from the start of the run-in: one for each."""


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Where a contact is on a structure at time steps, and how fast it goes there."""

    places: Values  # m, or rad of a ring
    rates: Values  # m/s, or rad/s
    spacing: float | None = None  # m from step to step, where it is the same


def at_steps(values: Array, steps: range) -> Array:
    """Values at some steps of those at all steps."""
    return values[steps.start : steps.stop : steps.step]


@dataclass(frozen=True, eq=False)
class Path:
    """Positions of contacts that move at one speed, constant or not."""

    positions: Array  # (c, n), at every time step of run-in and record, m
    speed: float  # m/s, or the course of it
    time_step: float  # s
    settled: int = 0  # steps of the run-in; the record starts behind them

    @classmethod
    def laid(cls, start: float, speed: float, time_step: float, duration: float, settling: float) -> Path:
        """Lay out one contact: a run-in of `settling`, s, and from `start`, m, a record of `duration`, s."""
        for what, value in (("speed (m/s)", speed), ("duration (s)", duration), ("time step (s)", time_step)):
            positive(what, value)
        real("settling (s)", settling, "zero or a finite positive number", at_least=0.0)
        steps, settled = (int(np.floor(time / time_step * (1.0 + 1e-12))) for time in (duration, settling))
        if steps < 1:
            raise InputError("duration (s)", duration, f"at least one time step of {time_step:.6g} s")
        counted = np.arange(-settled, steps + 1)
        if isinstance(speed, SpeedCourse):
            positions = np.asarray(start + speed.covered(time_step * counted))
        else:
            positions = np.asarray(start + speed * time_step * counted)
        return cls(positions[None], speed, time_step, settled)

    def ahead(self, offsets: ArrayLike) -> Path:
        """Contacts that run ahead of the first one of this path by some distances (c,), m."""
        return replace(self, positions=self.positions[0] + np.asarray(offsets)[:, None])

    @property
    def total(self) -> int:
        """Time steps of run-in and record."""
        return self.positions.shape[1] - 1

    @property
    def starts(self) -> Array:
        """Positions of the contacts at step zero (c,), m."""
        return self.positions[:, 0]

    def rates(self, steps: range) -> Array:
        """Speeds of the contacts at steps (k,), m/s."""
        if isinstance(self.speed, SpeedCourse):
            counted = np.arange(steps.start, steps.stop, steps.step) - self.settled
            return self.speed.at(self.time_step * counted)
        return np.full(len(steps), self.speed)

    @property
    def trajectories(self) -> list[Trajectory]:
        """Those of all contacts."""
        spacing = None if isinstance(self.speed, SpeedCourse) else self.speed * self.time_step
        return [Trajectory(partial(at_steps, along), self.rates, spacing) for along in self.positions]
