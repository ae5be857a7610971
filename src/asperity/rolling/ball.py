"""A rigid mass that rolls."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.rolling.path import Path
from asperity.structures.body import Ball


@dataclass(frozen=True)
class RollingBall:
    """A ball behind the protocol of `asperity.rolling.bodies.Rolls`."""

    ball: Ball

    @property
    def load(self) -> float:
        """Static contact force, N."""
        return float(self.ball.static_load)

    def placed(self, path: Path, displacement: float, velocity: float) -> FreeMass:
        """Place it on the path."""
        return FreeMass(self.ball.mass, self.load, path.time_step, displacement, velocity)

    def alternating_compliance(self, path: Path) -> float:
        """That of a free mass, m/N."""
        return -(path.time_step**2) / (12.0 * self.ball.mass)


class FreeMass:
    """A free mass, kg, under a constant load, N, that acts against the contact force; exact."""

    def __init__(
        self, mass: float, load: float, time_step: float, displacement: float, velocity: float
    ) -> None:
        self.mass, self.load, self.time_step = mass, load, time_step
        self.displacement, self.velocity = displacement, velocity

    def free(self, step: int, before: float) -> float:
        """Displacement at the end of a step without the force there, m."""
        h = self.time_step
        return self.displacement + h * self.velocity + h * h / self.mass * (before / 3.0 - 0.5 * self.load)

    def compliance(self, step: int) -> float:
        """Of the force at the end of a step, m/N."""
        return self.time_step**2 / (6.0 * self.mass)

    def complete(self, step: int, before: float, force: float) -> None:
        """Advance over a step."""
        self.displacement = self.free(step, before) + self.compliance(step) * force
        self.velocity += self.time_step / self.mass * (0.5 * (before + force) - self.load)

    def state(self) -> dict[str, NDArray[Any]]:
        """Displacement, m, and velocity, m/s."""
        return {"mass": np.array([self.displacement, self.velocity])}

    def restore(self, state: dict[str, NDArray[Any]]) -> None:
        """Go on from there."""
        self.displacement, self.velocity = (float(value) for value in state["mass"])
