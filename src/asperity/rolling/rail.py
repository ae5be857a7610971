"""A rail that is rolled over: its moving kernel, carried on by poles or scattered."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.errors import InputError
from asperity.kernels.rail import cubic_weights
from asperity.rolling.path import Path
from asperity.structures.moving_kernel import MovingKernel
from asperity.structures.rail_poles import RailPoles, over_the_bay

PRELOAD = 2.0
"""Kernel lengths for which the load has rolled before the path."""


@dataclass(frozen=True, eq=False)
class RolledRail:
    """A rail, as poles or scattered, behind the protocol of `asperity.rolling.bodies.RolledOver`."""

    rail: RailPoles | MovingKernel

    @property
    def kernel(self) -> MovingKernel:
        """Its moving kernel."""
        return self.rail.kernel if isinstance(self.rail, RailPoles) else self.rail

    def laid(self, path: Path, load: float) -> RailSide:
        """Let the load roll up to the start of the path, long enough for the rail to be steady."""
        self.refuse_other(path)
        memory = _Poles(self.rail) if isinstance(self.rail, RailPoles) else _Scatter(self.rail)
        return RailSide(self.kernel, memory, path, load)

    def refuse_other(self, path: Path) -> None:
        """Refuse a path of another speed or time step than its kernel was made for."""
        given, made = (path.speed, path.time_step), (self.kernel.speed, self.kernel.time_step)
        if not np.allclose(given, made, rtol=1e-9, atol=0.0):
            received = f"{given[0]:.6g} m/s in steps of {given[1]:.6g} s"
            allowed = f"{made[0]:.6g} m/s and {made[1]:.6g} s, for which the rail's kernel was computed"
            raise InputError("path", received, allowed, "Compute the moving kernel of this path.")

    def alternating_compliance(self, path: Path) -> float:
        """Least of all places in a bay, m/N."""
        signs = (-1.0) ** np.arange(self.kernel.weights.shape[1])
        return float((self.kernel.weights @ signs).min())


class RailSide:
    """A rail in contact: what it remembers of earlier forces, and how it answers the present one."""

    def __init__(self, kernel: MovingKernel, memory: _Poles | _Scatter, path: Path, load: float) -> None:
        self.memory, self.time_step = memory, path.time_step
        self.first = path.positions[0] / kernel.spacing
        self.stride = kernel.speed * kernel.time_step / kernel.spacing
        self.direct = over_the_bay(kernel.weights[:, 0])
        self.to_come = before = 0.0
        for step in range(1 - int(PRELOAD * kernel.weights.shape[1]), 1):
            before, _ = self.to_come, self.free(step, load)
            self.memory.accept()
        self.displacement = self.to_come + self.compliance(0) * load
        self.velocity = (self.to_come - before) / self.time_step

    def _place(self, step: int, cells: int) -> tuple[int, float]:
        """Cell of the bay in which the contact is at a step, and the share of the cell behind it."""
        bays = self.first + self.stride * step
        at = float(bays - np.floor(bays)) * cells
        cell = min(int(at), cells - 1)
        return cell, at - cell

    def free(self, step: int, before: float) -> float:
        """Displacement at the end of a step without the force there, m."""
        self.to_come = self.memory.ahead(before, *self._place(step - 1, self.memory.cells))
        return self.to_come

    def compliance(self, step: int) -> float:
        """Of the force at the end of a step, m/N."""
        cell, share = self._place(step, len(self.direct) - 1)
        return float(self.direct[cell] + share * (self.direct[cell + 1] - self.direct[cell]))

    def complete(self, step: int, before: float, force: float) -> None:
        """Advance over a step; the velocity is the mean over it, as a kernel knows displacements alone."""
        earlier = self.displacement
        self.displacement = self.to_come + self.compliance(step) * force
        self.velocity = (self.displacement - earlier) / self.time_step
        self.memory.accept()

    def state(self) -> dict[str, NDArray[Any]]:
        """What the rail remembers, and what it does at the contact."""
        return {"memory": self.memory.held.copy(), "contact": np.array([self.displacement, self.velocity])}

    def restore(self, state: dict[str, NDArray[Any]]) -> None:
        """Go on from there."""
        self.memory.held = state["memory"].copy()
        self.displacement, self.velocity = (float(value) for value in state["contact"])


class _Poles:
    """States q of the poles z, q ← z q + c(x) F, of which Re Σ q is to come."""

    def __init__(self, rail: RailPoles) -> None:
        self.poles, self.residues = rail.poles, over_the_bay(rail.residues)
        self.cells = len(self.residues) - 1
        self.held = self.next = np.zeros(len(self.poles), dtype=complex)

    def ahead(self, force: float, cell: int, share: float) -> float:
        """Displacement one step after a force at a place of the bay, m."""
        residues = (force * (1.0 - share)) * self.residues[cell] + (force * share) * self.residues[cell + 1]
        self.next = self.poles * self.held + residues
        return float(self.next.real.sum())

    def accept(self) -> None:
        """Take the step that was looked at last."""
        self.held = self.next


class _Scatter:
    """Displacement to come, m, the next step first; nodes of the kernel by a periodic cubic."""

    def __init__(self, kernel: MovingKernel) -> None:
        self.weights, self.cells = kernel.weights, len(kernel.weights)
        self.held = self.next = np.zeros(kernel.weights.shape[1])

    def ahead(self, force: float, cell: int, share: float) -> float:
        """Displacement one step after a force at a place of the bay, m."""
        nodes = np.arange(cell - 1, cell + 3) % self.cells
        self.next = np.append(self.held[1:], 0.0)
        self.next[:-1] += force * (np.array(cubic_weights(share)) @ self.weights[nodes, 1:])
        return float(self.next[0])

    def accept(self) -> None:
        """Take the step that was looked at last."""
        self.held = self.next
