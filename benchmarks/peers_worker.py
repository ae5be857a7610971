"""Solve the contacts of scan_step.py with a peer; run by the interpreter that the peer is installed in.

    python peers_worker.py PEER START problem.npz result.npz

PEER is ``tamaas``, ``ContactMechanics``, ``slippy`` or ``aspher``. START is ``cold`` (every contact from
Hertz's pressure of the smooth ball), ``warm`` (from the pressure of the previous contact, moved with the
surface), ``own`` (from what the peer starts from when told nothing) or, for tamaas and aspher, ``load``
(cold, each at the force given in the problem: one load-controlled solution without a search).

The problem is a number of contacts, each with the offset of the body's window on the surface and an approach.
The result holds the force of every contact, the CPU time of all of them, the accuracy reached (largest
complementarity residual relative to the largest overlap, evaluated outside of the time taken), and which
contacts failed: no solution after 2000 iterations.
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
        self.start, self.offsets, self.approaches = start, problem["offsets"], problem["approaches"]
        self.body, self.cell = problem["body"], float(problem["spacing"]) ** 2
        self.stiffness = float(problem["smooth_force"]) / float(self.approaches[-1]) ** 1.5
        self.solved: tuple[np.ndarray, float] | None = None

    def _warm(self) -> bool:
        return self.start == "warm" and self.solved is not None

    def smooth_force(self, m: int) -> float:
        """Force of the smooth ball, N."""
        return self.stiffness * float(self.approaches[m]) ** 1.5

    def pressure(self, m: int) -> np.ndarray | None:
        """Pressure of the previous contact, moved against the motion, or of the smooth ball."""
        if self.start == "own":
            return None
        if not self._warm() or self.solved is None:
            inside = np.sqrt(np.maximum(float(self.approaches[m]) - 2.0 * self.body, 0.0))
            return inside * self.smooth_force(m) / (max(inside.sum(), 1e-300) * self.cell)
        previous, rows = self.solved[0], int(self.offsets[m] - self.offsets[m - 1])
        return np.concatenate([previous[rows:], np.zeros((rows, previous.shape[1]))])

    def force(self, m: int) -> float:
        """Force of the previous contact, as the smooth ball's grows, or of the smooth ball, N."""
        if not self._warm() or self.solved is None:
            return self.smooth_force(m)
        return self.solved[1] * self.smooth_force(m) / self.smooth_force(m - 1)


AtLoad = Callable[[np.ndarray, float, float], float]  # gap, force, tolerance: approach


def search(at_load: AtLoad, begin: Start, m: int, gap: np.ndarray, rtol: float) -> tuple[float, float]:
    """Find the force at an approach by a secant on F^(2/3); return approach and force.

    The search begins with the smooth ball's force (cold) or the previous contact's (warm), a solution that
    may stop at 1e-4, and the smooth ball's slope; later solutions start from the pressure of the one before.
    """
    approach = float(begin.approaches[m])
    force, slope = begin.force(m), begin.smooth_force(m) ** (2 / 3) / approach
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
    return found, force


def tamaas(problem: dict[str, np.ndarray], start: str) -> tuple[Solve, Displace]:
    """Polonsky–Keer at given mean pressure, free boundary; a secant finds the approach."""
    import tamaas as tm

    tm.set_log_level(tm.LogLevel.error)
    n = problem["body"].shape
    size = [float(problem["spacing"]) * m for m in n]
    model = tm.ModelFactory.createModel(tm.model_type.basic_2d, size, list(n))
    model.E, model.nu = float(problem["modulus"]), 0.0
    tm.ModelFactory.registerNonPeriodic(model, "dcfft")
    operator, area = model.operators["dcfft"], size[0] * size[1]
    displacement = np.zeros(n)
    rtol = float(problem["rtol"])
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

    def solve(gap: np.ndarray, m: int) -> tuple[np.ndarray, float]:
        pressure = begin.pressure(m)
        model.traction[:] = 0.0 if pressure is None else pressure
        if start == "load":
            found = at_load(gap, float(problem["forces"][m]), rtol)
            return model.traction.copy(), found
        found, force = search(at_load, begin, m, gap, rtol)
        begin.solved = (model.traction.copy(), force)
        return begin.solved[0], found

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
    rtol = float(problem["rtol"])
    begin = Start(problem, start)

    def displace(pressure: np.ndarray) -> np.ndarray:
        return half_space.evaluate_disp(-cell * pressure)

    def solve(gap: np.ndarray, m: int) -> tuple[np.ndarray, float]:
        forces, pressure, approach = None, begin.pressure(m), float(begin.approaches[m])
        if pressure is not None:
            forces = np.zeros(half_space.nb_domain_grid_pts)
            forces[: n[0], : n[1]] = -cell * pressure
        result = NonSmoothContactSystem(half_space, Topography(-gap, size)).minimize_proxy(
            offset=approach,
            initial_forces=forces,
            pentol=rtol * (approach - float(gap.min())),
            forcetol=rtol * begin.smooth_force(m),
            maxiter=MAX_ITERATIONS,
        )
        pressure = np.maximum(result.jac, 0.0) / cell
        begin.solved = (pressure, float(pressure.sum() * cell))
        return pressure, approach

    return solve, displace


def overlap_width(problem: dict[str, np.ndarray]) -> int:
    """Side of the largest bounding box of the overlap at any contact, cells."""
    body, widest = problem["body"], 0
    for m, approach in zip(problem["offsets"], problem["approaches"], strict=True):
        overlap = body - problem["heights"][m : m + len(body)] < approach
        for axis in (0, 1):
            used = np.flatnonzero(overlap.any(axis=axis))
            widest = max(widest, int(used[-1] - used[0]) + 1)
    return widest


def slippy(problem: dict[str, np.ndarray], start: str) -> tuple[Solve, Displace]:
    """Bound-constrained conjugate gradients on the overlapping cells at a prescribed approach, free boundary.

    Its steps plan a convolution for every contact; so does this, with the influence matrix kept and no wider
    than the overlap needs, which halves what slippy pads. Thresholds inside of it are absolute: lengths are
    divided by the approach.
    """
    import slippy as package

    package.CORES, package.CUDA = 1, False
    from slippy.contact.influence_matrix_utils import bccg, elastic_influence_matrix, plan_convolve

    n, h = problem["body"].shape, float(problem["spacing"])
    unit = float(problem["approaches"][-1])
    modulus = 0.5 * float(problem["modulus"])  # shear modulus of a body with E = E* and ν = 0
    begin = Start(problem, start)

    def influence(width: int) -> np.ndarray:
        """Influence of cells up to a width apart, an array with zero separation in its middle."""
        return elastic_influence_matrix("zz", (2 * width, 2 * width), (h, h), modulus, 0.0) / unit

    everywhere, narrow = plan_convolve(np.zeros(n), influence(max(n))), influence(overlap_width(problem))

    def displace(pressure: np.ndarray) -> np.ndarray:
        return unit * everywhere(pressure)

    def solve(gap: np.ndarray, m: int) -> tuple[np.ndarray, float]:
        approach = float(begin.approaches[m])
        overlap = (approach - gap) / unit
        domain, pressure = overlap > 0.0, begin.pressure(m)
        first = np.zeros(n) if pressure is None else pressure
        solved = np.zeros(n)
        solved[domain], _ = bccg(
            plan_convolve(gap, narrow, domain), overlap[domain], float(problem["rtol"]), MAX_ITERATIONS,
            first[domain],
        )  # fmt: skip
        begin.solved = (solved, float(solved.sum()) * h**2)
        return solved, approach

    return solve, displace


def aspher(problem: dict[str, np.ndarray], start: str) -> tuple[Solve, Displace]:
    """Preconditioned Polonsky–Keer at given mean pressure, FFT operator; a secant finds the approach."""
    from aspher import ContactSolver

    n = problem["body"].shape
    side = float(problem["spacing"]) * n[0]
    modulus, rtol = float(problem["modulus"]), float(problem["rtol"])
    solver = ContactSolver(grid_size=n[0], domain_size=side, E_star=modulus, backend="fft")
    begin = Start(problem, start)
    held: list[np.ndarray | None] = [None]

    def displace(pressure: np.ndarray) -> np.ndarray:
        return np.asarray(solver.matvec(np.ascontiguousarray(pressure))).reshape(n)

    def at_load(gap: np.ndarray, force: float, tolerance: float) -> float:
        result = solver.solve(
            gap.ravel(), force / side**2, tol=tolerance, max_iter=MAX_ITERATIONS, precond="fourier",
            p_init=held[0],
        )  # fmt: skip
        held[0] = np.asarray(result.pressure)
        inside = held[0] > 0.0
        return float((np.asarray(result.displacement).reshape(n) + gap)[inside].mean())

    def solve(gap: np.ndarray, m: int) -> tuple[np.ndarray, float]:
        held[0] = begin.pressure(m)
        if start == "load":
            found = at_load(gap, float(problem["forces"][m]), rtol)
            return held[0], found
        found, force = search(at_load, begin, m, gap, rtol)
        begin.solved = (held[0], force)
        return held[0], found

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
    body, heights = problem["body"], problem["heights"]
    gaps = [np.ascontiguousarray(body - heights[m : m + len(body)]) for m in problem["offsets"]]
    prepare = {"tamaas": tamaas, "ContactMechanics": contact_mechanics, "slippy": slippy, "aspher": aspher}[
        peer
    ]
    prepare(problem, start)[0](gaps[0], 0)  # plans of the transforms, lazy imports
    began = time.process_time()
    solve, displace = prepare(problem, start)
    solved = [solve(gap, m) for m, gap in enumerate(gaps)]
    seconds = time.process_time() - began
    residuals = np.array(
        [residual(g, p, displace(p), found) for g, (p, found) in zip(gaps, solved, strict=True)]
    )
    found = np.array([approach for _, approach in solved])
    missed = np.abs(found - problem["approaches"]) > 1e-6 * problem["approaches"]
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
