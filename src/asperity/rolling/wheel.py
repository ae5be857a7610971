"""A wheel that rolls: a free mass with resonances."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.rolling.ball import FreeMass
from asperity.rolling.path import Path
from asperity.rolling.stability import RESOLVED
from asperity.structures.wheel import Wheel


@dataclass(frozen=True, eq=False)
class RollingWheel:
    """A wheel behind the protocol of `asperity.rolling.bodies.Rolls`."""

    wheel: Wheel

    @property
    def load(self) -> float:
        """Static contact force, N."""
        return float(self.wheel.load)

    def placed(self, path: Path, displacement: float, velocity: float) -> WheelSide:
        """Place it on the path, its modes at rest under the load."""
        return WheelSide(self.wheel, path.time_step, displacement, velocity)

    def alternating_compliance(self, path: Path) -> float:
        """That of the mass and of the resonances, m/N."""
        decay, before, now = wheel_step(self.wheel, path.time_step)
        flexible = 2.0 * float(np.sum((now - before) / (1.0 + decay)).real)
        return flexible - path.time_step**2 / (12.0 * self.wheel.mass)


class WheelSide:
    """A wheel in contact: a free mass, and states q of its poles that add 2 Re Σ q to its displacement."""

    def __init__(self, wheel: Wheel, time_step: float, displacement: float, velocity: float) -> None:
        self.decay, self.before, self.now = wheel_step(wheel, time_step)
        self.poles, self.residues = wheel.poles, wheel.residues
        self.states = np.asarray(-wheel.load * wheel.residues / wheel.poles, dtype=complex)
        rigid = displacement - _displaced(self.states)
        self.mass = FreeMass(wheel.mass, wheel.load, time_step, rigid, velocity)
        self.force = float(wheel.load)

    @property
    def displacement(self) -> float:
        """At the contact, m."""
        return self.mass.displacement + _displaced(self.states)

    @property
    def velocity(self) -> float:
        """At the contact, m/s: q' = s q + r F."""
        return self.mass.velocity + _displaced(self.poles * self.states + self.residues * self.force)

    def free(self, step: int, before: float) -> float:
        """Displacement at the end of a step without the force there, m."""
        return self.mass.free(step, before) + _displaced(self.decay * self.states + self.before * before)

    def compliance(self, step: int) -> float:
        """Of the force at the end of a step, m/N."""
        return self.mass.compliance(step) + _displaced(self.now)

    def complete(self, step: int, before: float, force: float) -> None:
        """Advance over a step."""
        self.mass.complete(step, before, force)
        self.states = self.decay * self.states + self.before * before + self.now * force
        self.force = force

    def state(self) -> dict[str, NDArray[Any]]:
        """Of the mass, of the poles, and the force, N."""
        return self.mass.state() | {"poles": self.states, "force": np.array(self.force)}

    def restore(self, state: dict[str, NDArray[Any]]) -> None:
        """Go on from there."""
        self.mass.restore(state)
        self.states, self.force = state["poles"], float(state["force"])


def _displaced(states: NDArray[np.complex128]) -> float:
    return 2.0 * float(states.real.sum())


def wheel_step(
    wheel: Wheel, time_step: float
) -> tuple[NDArray[np.complex128], NDArray[np.complex128], NDArray[np.complex128]]:
    """Exact step, s, of a wheel's resonances for a force that is linear over it: q' = s q + r F.

    Returns factors of the states, and of the forces at start and end of the step, m/N. Fast ones are as in
    `asperity.rolling.beam.beam_step`.
    """
    phase = wheel.poles * time_step
    growth = np.expm1(phase)
    now = wheel.residues * (growth - phase) / (wheel.poles * phase)
    before = wheel.residues * growth / wheel.poles - now
    slow = np.abs(phase.imag) <= RESOLVED
    parts = np.exp(phase), before, np.where(slow, now, -wheel.residues / wheel.poles)
    decay, before, now = (part.astype(complex) for part in parts)
    return np.where(slow, decay, 0.0), np.where(slow, before, 0.0), now
