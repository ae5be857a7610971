"""Solve the contacts of scan_step.py with a peer; run by the interpreter that the peer is installed in.

    python peers_worker.py PEER START problem.npz result.npz

PEER is ``tamaas`` or ``ContactMechanics``. START is ``cold`` (every contact from Hertz's pressure of the
smooth ball), ``warm`` (from the pressure of the previous position, moved with the surface), ``own`` (from
what the peer starts from when told nothing) or, for tamaas, ``load`` (cold, each at the force given in the
problem: one load-controlled solution without the search for the approach).

The result holds the force of every position, the CPU time of all of them, the accuracy reached (largest
complementarity residual relative to the largest overlap, evaluated outside of the time taken), and which
positions failed: no solution after 2000 iterations.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from importlib.metadata import version

import numpy as np

Solve = Callable[[np.ndarray, int], tuple[np.ndarray, float]]
Displace = Callable[[np.ndarray], np.ndarray]
MAX_ITERATIONS = 2000
FAILED = 1e-6  # relative residual above which a solution is none


class Start:
    """Gives every solution the pressure that it starts from, Pa; None leaves it to the peer."""

    def __init__(self, problem: dict[str, np.ndarray], start: str) -> None:
        self.start, self.stride = start, int(problem["stride"])
        inside = np.sqrt(np.maximum(float(problem["approach"]) - 2.0 * problem["body"], 0.0))
        self.smooth_force = float(problem["smooth_force"])
        self.smooth = inside * self.smooth_force / (inside.sum() * float(problem["spacing"]) ** 2)
        self.solved: tuple[np.ndarray, float] | None = None

    def pressure(self) -> np.ndarray | None:
        """Pressure of the previous position, moved against the motion, or of the smooth ball."""
        if self.start == "own":
            return None
        if self.start != "warm" or self.solved is None:
            return self.smooth
        previous, rows = self.solved[0], self.stride
        return np.concatenate([previous[rows:], np.zeros((rows, previous.shape[1]))])

    def force(self) -> float:
        """Force of the previous position, or of the smooth ball, N."""
        return self.smooth_force if self.start != "warm" or self.solved is None else self.solved[1]


def tamaas(problem: dict[str, np.ndarray], start: str) -> tuple[Solve, Displace]:
    """Polonsky–Keer at given mean pressure, free boundary; a secant on F^(2/3) finds the approach.

    The search begins with the smooth ball's force (cold) or the previous position's (warm), a solution that
    may stop at 1e-4, and the smooth ball's slope; later solutions start from the pressure of the one before.
    """
    import tamaas as tm

    tm.set_log_level(tm.LogLevel.error)
    n = problem["body"].shape
    size = [float(problem["spacing"]) * m for m in n]
    model = tm.ModelFactory.createModel(tm.model_type.basic_2d, size, list(n))
    model.E, model.nu = float(problem["modulus"]), 0.0
    tm.ModelFactory.registerNonPeriodic(model, "dcfft")
    operator, area = model.operators["dcfft"], size[0] * size[1]
    displacement = np.zeros(n)
    approach, rtol = float(problem["approach"]), float(problem["rtol"])
    begin = Start(problem, start)

    def displace(pressure: np.ndarray) -> np.ndarray:
        operator(np.ascontiguousarray(pressure), displacement)
        return displacement

    def at_load(gap: np.ndarray, force: float, tolerance: float) -> float:
        solver = tm.PolonskyKeerRey(model, -gap, tolerance)
        solver.setIntegralOperator("dcfft")
        solver.max_iter = MAX_ITERATIONS
        solver.solve(force / area)
        inside = model.traction > 0.0
        return float((displace(model.traction) + gap)[inside].mean())

    def at_approach(gap: np.ndarray) -> float:
        force, slope = begin.force(), begin.smooth_force ** (2 / 3) / approach
        limit = rtol * (approach - float(gap.min()))
        found, previous = at_load(gap, force, 1e-4), None
        for attempt in range(20):
            transformed = force ** (2 / 3)
            if previous is not None and found != previous[0]:
                slope = (transformed - previous[1]) / (found - previous[0])
            if attempt:  # the first point is too coarse for a slope
                previous = (found, transformed)
            force = max(transformed + slope * (approach - found), 1e-3 * transformed) ** 1.5
            found = at_load(gap, force, rtol)
            if abs(found - approach) <= limit:
                break
        begin.solved = (model.traction.copy(), force)
        return found

    def solve(gap: np.ndarray, m: int) -> tuple[np.ndarray, float]:
        pressure = begin.pressure()
        model.traction[:] = 0.0 if pressure is None else pressure
        found = at_load(gap, float(problem["forces"][m]), rtol) if start == "load" else at_approach(gap)
        return model.traction.copy(), found

    return solve, displace


def contact_mechanics(problem: dict[str, np.ndarray], start: str) -> tuple[Solve, Displace]:
    """Constrained conjugate gradients at a prescribed offset, free boundary."""
    from ContactMechanics import FreeFFTElasticHalfSpace
    from ContactMechanics.Systems import NonSmoothContactSystem
    from SurfaceTopography import Topography

    n = problem["body"].shape
    cell = float(problem["spacing"]) ** 2
    size = tuple(float(problem["spacing"]) * m for m in n)
    half_space = FreeFFTElasticHalfSpace(n, float(problem["modulus"]), size)
    approach, rtol = float(problem["approach"]), float(problem["rtol"])
    begin = Start(problem, start)

    def displace(pressure: np.ndarray) -> np.ndarray:
        return half_space.evaluate_disp(-cell * pressure)

    def solve(gap: np.ndarray, m: int) -> tuple[np.ndarray, float]:
        forces, pressure = None, begin.pressure()
        if pressure is not None:
            forces = np.zeros(half_space.nb_domain_grid_pts)
            forces[: n[0], : n[1]] = -cell * pressure
        result = NonSmoothContactSystem(half_space, Topography(-gap, size)).minimize_proxy(
            offset=approach,
            initial_forces=forces,
            pentol=rtol * (approach - float(gap.min())),
            forcetol=rtol * begin.smooth_force,
            maxiter=MAX_ITERATIONS,
        )
        pressure = np.maximum(result.jac, 0.0) / cell
        begin.solved = (pressure, float(pressure.sum() * cell))
        return pressure, approach

    return solve, displace


def residual(gap: np.ndarray, pressure: np.ndarray, displacement: np.ndarray, approach: float) -> float:
    """Largest complementarity residual, relative to the largest overlap."""
    deformed = gap + displacement - approach
    worst = np.where(pressure > 0.0, np.abs(deformed), -deformed).max()
    return float(worst / (approach - gap.min()))


def main() -> None:
    peer, start, source, target = sys.argv[1:]
    with np.load(source, allow_pickle=False) as arrays:
        problem = dict(arrays)
    body, heights, stride = problem["body"], problem["heights"], int(problem["stride"])
    positions = len(problem["forces"])
    gaps = [
        np.ascontiguousarray(body - heights[m * stride : m * stride + len(body)]) for m in range(positions)
    ]
    prepare = {"tamaas": tamaas, "ContactMechanics": contact_mechanics}[peer]
    prepare(problem, start)[0](gaps[0], 0)  # plans of the transforms, lazy imports
    began = time.process_time()
    solve, displace = prepare(problem, start)
    solved = [solve(gap, m) for m, gap in enumerate(gaps)]
    seconds = time.process_time() - began
    residuals = np.array(
        [residual(g, p, displace(p), found) for g, (p, found) in zip(gaps, solved, strict=True)]
    )
    found = np.array([approach for _, approach in solved])
    missed = np.abs(found - float(problem["approach"])) > 1e-6 * float(problem["approach"])
    np.savez(
        target,
        forces=[p.sum() * float(problem["spacing"]) ** 2 for p, _ in solved],
        seconds=seconds,
        residual=residuals,
        failed=(residuals > FAILED) | missed,
        version=version(peer),
    )


if __name__ == "__main__":
    main()
