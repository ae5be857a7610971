"""The state at rest of bodies on several contacts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from asperity.errors import ComputationError
from asperity.rolling.equilibrium import LARGEST_STEP, static_approach
from asperity.structures.body import Body

Array = NDArray[np.float64]
Evaluation = Callable[[float], tuple[float, float]]
FIRST_MOVE = 1e-6  # m, of the contacts; doubled until they are at rest
ITERATIONS = 200


@dataclass(frozen=True, eq=False)
class Rest:
    """Bodies at rest on n contacts."""

    displacement: Array  # y of all bodies (d,), one after another, upwards
    force: Array  # (n,), N
    approach: Array  # (n,), as the laws see it, m
    stiffness: Array  # (n,), of the contacts, N/m


class Statics:
    """Bodies on what is rolled over, at rest, displaced by y, and by c where structure and modes yield.

    The approaches are δ = −(u + A y + Q c), with u (n,) what is rolled over is displaced by already, m, and
    Q Qᵀ the static compliance (n, n) of all else that yields, m/N. At rest K y + p = Aᵀ F and c = Qᵀ F, which
    is where ½ yᵀKy + pᵀy + ½ c² plus the energy of the contacts is least.
    """

    def __init__(self, bodies: Sequence[Body], displaced: Array, compliance: Array) -> None:
        square, vectors = np.linalg.eigh(compliance)
        root = vectors * np.sqrt(np.maximum(square, 0.0))
        n, self.held = len(displaced), sum(len(body.mass) for body in bodies)
        self.displaced = displaced
        self.stiffness = block_diag(*(body.stiffness for body in bodies), np.eye(n))
        self.shapes = np.hstack([block_diag(*(body.contacts for body in bodies)), root])
        self.pressing = np.concatenate([*(body.pressing for body in bodies), np.zeros(n)])
        self.loads = np.concatenate([body.static_loads for body in bodies])

    def approach(self, x: Array) -> Array:
        """Of all contacts, m."""
        return -(self.displaced + self.shapes @ x)

    def guess(self, approach: Array) -> Array:
        """Displacements for these approaches, m, under the loads on a rigid plane, as near as can be."""
        force = np.maximum(self.loads, 0.0)
        scale = max(float(np.abs(self.stiffness[: self.held, : self.held]).max()), 1.0)
        yielding = self.shapes[:, self.held :].T @ force
        target = -(self.displaced + approach + self.shapes[:, self.held :] @ yielding)
        rows = self.shapes[:, : self.held]
        carried = rows.T @ force - self.pressing[: self.held]
        matrix = np.vstack([rows, self.stiffness[: self.held, : self.held] / scale])
        y = np.linalg.lstsq(matrix, np.concatenate([target, carried / scale]), rcond=None)[0]
        return np.concatenate([y, yielding])

    def gradient(self, x: Array, force: Array) -> Array:
        """Of the energy."""
        return self.stiffness @ x + self.pressing - self.shapes.T @ force


def at_rest(
    bodies: Sequence[Body],
    displaced: Array,
    compliance: Array,
    laws: Sequence[Evaluation],
    relative: float = 1e-9,
) -> Rest:
    """Where bodies rest on laws, which give force, N, and stiffness, N/m, of an approach, m.

    What is rolled over is displaced by `displaced` (n,), m, whatever the forces, and by `compliance` (n, n),
    m/N, of structure and of the bodies' modes. The forces are exact to `relative` of the loads. A
    `ComputationError` says that nothing up to a metre away is at rest.
    """
    statics = Statics(bodies, displaced, compliance)
    scale = np.maximum(statics.loads, statics.loads.clip(0.0).mean())
    known = [
        static_approach(law, load, relative) if load > 0.0 else (0.0, 0.0)
        for law, load in zip(laws, statics.loads, strict=True)
    ]
    x, most = statics.guess(np.array([approach for approach, _ in known])), FIRST_MOVE
    if len(laws) == len(bodies) and statics.loads.min() > 0.0:  # each contact carries what presses its body
        return Rest(x[: statics.held], statics.loads, *np.array(known).T)
    for _ in range(ITERATIONS):
        force, stiffness = _evaluated(laws, statics.approach(x))
        firm = np.maximum(stiffness, scale / LARGEST_STEP)
        gradient = statics.gradient(x, force)
        hessian = statics.stiffness + (statics.shapes.T * firm) @ statics.shapes
        move = -np.linalg.solve(hessian, gradient)
        moved = statics.shapes @ move
        if np.all(np.abs(firm * moved) <= relative * scale):
            balanced = force - firm * moved
            return Rest(x[: statics.held], balanced, statics.approach(x), stiffness)
        far = float(np.abs(moved).max())
        move *= min(1.0, most / far)
        most = min(2.0 * most, LARGEST_STEP)
        x = x + _share(statics, laws, x, move, float(gradient @ move)) * move
    force, _ = _evaluated(laws, statics.approach(x))
    raise ComputationError(
        f"the bodies do not come to rest on their {len(laws)} contacts at the start of the path; the last "
        f"forces are {', '.join(f'{value:.4g}' for value in force[:8])} N",
        "smaller loads, or contact.approaches that reach higher forces",
    )


def _evaluated(laws: Sequence[Evaluation], approach: Array) -> tuple[Array, Array]:
    found = np.array([law(float(value)) for law, value in zip(laws, approach, strict=True)])
    return found[:, 0], found[:, 1]


def _share(statics: Statics, laws: Sequence[Evaluation], x: Array, move: Array, slope: float) -> float:
    """Share of a move that lowers the energy: where its slope along the move has halved, or all of it."""
    low, high = 0.0, 1.0
    share = 1.0
    for _ in range(60):
        there = x + share * move
        found = float(statics.gradient(there, _evaluated(laws, statics.approach(there))[0]) @ move)
        if found <= 0.5 * abs(slope):
            if share == 1.0 or found >= 0.5 * slope:
                return share
            low = share
        else:
            high = share
        share = 0.5 * (low + high)
    return share
