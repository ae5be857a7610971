# ruff: noqa: E402 (the threads are set before numpy is imported)
"""Where the time of a contact solution goes, and how it grows.

Per grid: time and iterations of a scan's solution, time of an iteration against that of its convolution
(bare: the same box again and again). Then the time of a scan against grid, path and number of approaches,
drawn beside straight lines of the expected slopes. One thread, CPU time, the least of some rounds.

    python benchmarks/solve_profile.py --figure benchmarks/growth.svg
"""

from __future__ import annotations

import os

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[variable] = "1"

import argparse
import time
from collections.abc import Callable
from types import FunctionType
from typing import Any
from unittest.mock import patch

import numpy as np
from numba import njit
from scan_step import MODULUS, problem

from asperity import HalfSpace
from asperity.contact.scan import ScanJob, scan_forces
from asperity.kernels import projected_cg as cg
from asperity.kernels import scanning
from asperity.kernels.box import Box
from asperity.kernels.influence import Convolution, convolve
from asperity.kernels.lanes import width
from asperity.surfaces.strip import Rows

ROUNDS = 5


def least(work: Callable[[], Any], rounds: int = ROUNDS) -> float:
    """CPU time of some work, s; the first time does not count."""
    work()
    seconds = []
    for _ in range(rounds):
        began = time.process_time()
        work()
        seconds.append(time.process_time() - began)
    return min(seconds)


def options(**changed: Any) -> argparse.Namespace:
    given = {"radius_share": 0.35, "stride": None, "positions": 64, "rms": 0.1, "rtol": 1e-8}
    return argparse.Namespace(**(given | {"loading": 0, "cropped": False} | changed))


def scan_time(cells: int, positions: int = 64, approaches: int = 1, rounds: int = ROUNDS) -> float:
    """CPU time of a scan, s."""
    p = problem(cells, options(positions=positions))
    job = scan_job(p, float(p["approaches"][0]) * np.linspace(1.0, 0.3, approaches)[::-1])
    return least(lambda: scan_forces(job, workers=1), rounds)


def scan_job(p: dict[str, np.ndarray], approaches: np.ndarray) -> ScanJob:
    """Scan of a problem in double precision; what a solution has prepared, the next one finds."""
    half_space = HalfSpace(p["body"].shape, float(p["spacing"]), MODULUS)
    return ScanJob(half_space, Rows(p["heights"]), p["body"], approaches, int(p["offsets"][1]), 1e-8)


@njit(_nrt=False)
def bare(c: Convolution, b: Box, times: int) -> None:
    """Convolve again and again."""
    for _ in range(times):
        convolve(c, b.step, b.nx, b.ny, b.pitch, b.work, b.response)


@njit(_nrt=False)  # as what is timed is compiled
def repeated(
    start: Any, residual: Any, times: int, c: Any, taps: Any, b: Any, task: Any, edges: Any
) -> tuple[int, bool, bool]:
    """Solve again and again from the same start, on whole cells."""
    result = (0, True, False)
    for _ in range(times):
        for q in range(len(start)):
            b.pressure[q], b.residual[q] = start[q], residual[q]
        result = cg.solve(c, taps, b, task, 0, None, edges)
    return result


def interpreted(kernel: Any) -> FunctionType:
    """Make a function of Python of a kernel, which knows how many numbers a vector has."""
    known = {**kernel.py_func.__globals__, "lanes": lambda array: width(array.dtype)}
    return FunctionType(kernel.py_func.__code__, known)


class Timed:
    """Stands for the compiled solution: times it next to its convolutions, one for every iteration."""

    def __init__(self) -> None:
        self.seconds, self.convolving = 0.0, 0.0
        self.iterations = self.solutions = 0

    def __call__(
        self, c: Any, taps: Any, b: Any, task: Any, done: int, rims: None, edges: Any
    ) -> tuple[int, bool, bool]:
        """Solve, timed."""
        arguments = (b.pressure.copy(), b.residual.copy(), c, taps, b, task, edges)
        self.seconds += least(lambda: repeated(*arguments[:2], 5, *arguments[2:]), 2) / 5
        iterations, moving, settled = repeated(*arguments[:2], 1, *arguments[2:])
        self.convolving += iterations * least(lambda: bare(c, b, 40), 2) / 40
        self.iterations, self.solutions = self.iterations + iterations, self.solutions + 1
        return done + iterations, moving, settled


def profile(cells: int) -> None:
    """Print a line of the table of one grid."""
    total, timed = scan_time(cells), Timed()
    p = problem(cells, options())
    with (
        patch.object(scanning, "solve", timed),
        patch.object(scanning, "convolution", interpreted(scanning.convolution)),
        patch.object(scanning, "empty_box", interpreted(scanning.empty_box)),
        patch.object(scanning, "solve_contact", scanning.solve_contact.py_func),
        patch.object(scanning, "_solve_within", scanning._solve_within.py_func),
        patch.object(scanning, "solve_positions", scanning.solve_positions.py_func),
    ):
        scan_forces(scan_job(p, p["approaches"][:1]), workers=1)
    iterations = timed.iterations
    print(
        f"| {cells}² | {1e3 * total / 64:.3f} | {iterations / timed.solutions:.1f} "
        f"| {1e6 * timed.seconds / iterations:.1f} | {1e6 * timed.convolving / iterations:.1f} "
        f"| {timed.seconds / timed.convolving:.2f} |"
    )


def draw(path: str) -> None:
    """Measure how the time of a scan grows, and draw it."""
    import matplotlib.pyplot as plt

    cells, positions, approaches = [32, 64, 128, 256, 512], [16, 64, 256, 1024], [1, 2, 4, 8, 16, 32]
    by_cells = np.array([scan_time(n, 16, rounds=2) / 16 for n in cells])
    by_positions = np.array([scan_time(64, n, rounds=2) for n in positions])
    by_approaches = np.array([scan_time(64, 16, n, rounds=2) / 16 for n in approaches])
    grid = np.array(cells) ** 2 * np.log(cells)
    figure, axes = plt.subplots(1, 3, figsize=(10, 3.2), layout="constrained")
    panels = [
        (cells, by_cells, grid, "cells along the window", "N² log N"),
        (positions, by_positions, np.array(positions), "positions, 64² cells", "linear"),
        (approaches, by_approaches, np.array(approaches), "approaches at a position, 64² cells", "linear"),
    ]
    for axis, (x, y, slope, label, name) in zip(axes, panels, strict=True):
        axis.loglog(x, 1e3 * y, "o-", label="measured")
        axis.loglog(x, 1e3 * y[0] * slope / slope[0], "--", color="0.5", label=name)
        axis.set_xlabel(label)
        axis.set_xticks(x, [str(n) for n in x], minor=False)
        axis.minorticks_off()
        axis.legend(frameon=False)
        print(f"{label}: " + ", ".join(f"{n}: {1e3 * t:.3g}" for n, t in zip(x, y, strict=True)) + " ms")
    axes[0].set_ylabel("CPU time, ms")
    figure.savefig(path)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--cells", type=int, nargs="+", default=[64, 128, 256])
    parser.add_argument("--figure", metavar="FILE", help="measure growth, too, and draw it here")
    chosen = parser.parse_args()
    print("| grid | ms per solve | iterations | us per iteration | of it convolving | ratio |")
    print("|---|---:|---:|---:|---:|---:|")
    for cells in chosen.cells:
        profile(cells)
    if chosen.figure:
        draw(chosen.figure)


if __name__ == "__main__":
    main()
