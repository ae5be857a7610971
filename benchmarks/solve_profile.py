# ruff: noqa: E402 (the threads are set before numpy is imported)
"""Where the time of a contact solution goes, and how it grows.

Per grid: iterations and convolutions of a scan's solution, time per iteration against the convolutions that
it makes (bare: the same box again and again), and the share of what lies around the compiled loop. Then the
time of a scan against grid, path and number of approaches, drawn beside straight lines of the expected
slopes. One thread, CPU time, the least of some rounds.

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

from asperity.contact import halfspace
from asperity.kernels import contact, scanning
from asperity.kernels import projected_cg as cg
from asperity.kernels.convolution import Convolution, convolve
from asperity.kernels.lanes import width
from asperity.reduction.scan import scan_forces

ROUNDS = 5
FIELDS = ("overlap", "pressure", "residual", "previous", "direction", "response", "z", "masked")


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
    at = float(p["approaches"][0]) * np.linspace(1.0, 0.3, approaches)[::-1]

    def scan() -> None:
        scan_forces(
            p["heights"], (float(p["spacing"]),) * 2, p["body"], MODULUS, at,
            stride=int(p["offsets"][1]), rtol=1e-8, workers=1,
        )  # fmt: skip

    return least(scan, rounds)


@njit(_nrt=False)
def bare(c: Convolution, b: cg.Box, times: int) -> None:
    """Convolve again and again."""
    for _ in range(times):
        convolve(c, b.direction, b.nx, b.ny, b.pitch, b.work, b.response)


@njit(_nrt=False)  # as what is timed is compiled
def repeated(start: Any, times: int, c: Any, mirrored: Any, taps: Any, outer: Any, row: int, column: int,
             b: Any, cap: float, tolerance: float, limit: int) -> tuple[int, bool]:  # fmt: skip
    """Solve again and again from the same start."""
    result = (0, True)
    for _ in range(times):
        for q in range(len(start)):
            outer.pressure[q] = start[q]
        result = cg.solve(c, mirrored, taps, outer, row, column, b, cap, tolerance, limit)
    return result


def interpreted(kernel: Any) -> FunctionType:
    """Make a function of Python of a kernel, which knows how many numbers a vector has."""
    known = {**kernel.py_func.__globals__, "lanes": lambda array: width(array.dtype)}
    return FunctionType(kernel.py_func.__code__, known)


class Counted:
    """Stands for the compiled solution: times it, then does it again in steps and counts convolutions."""

    def __init__(self) -> None:
        self.seconds, self.convolving = 0.0, 0.0
        self.iterations = self.convolutions = self.solutions = 0

    def __call__(
        self, c: Any, mirrored: Any, taps: Any, outer: Any, row: int, column: int, b: Any, *limits: Any
    ) -> tuple[int, bool]:
        """Solve, timed."""
        start, empty = outer.pressure.copy(), b._replace(**{f: getattr(b, f).copy() for f in FIELDS})
        arguments = (c, mirrored, taps, outer, row, column, b, *limits)
        self.seconds += least(lambda: repeated(start, 5, *arguments), 2) / 5
        result = repeated(start, 1, *arguments)
        solution, outer.pressure[:] = outer.pressure.copy(), start
        count = self.count(c, taps, outer, row, column, empty, limits[0], result[0])
        outer.pressure[:] = solution
        self.convolving += count * least(lambda: bare(c, b, 40), 2) / 40
        self.iterations, self.convolutions = self.iterations + result[0], self.convolutions + count
        self.solutions += 1
        return result

    def count(
        self, c: Any, taps: Any, outer: Any, row: int, column: int, b: Any, cap: float, times: int
    ) -> int:
        """Convolutions of the same iterations: one each, another where many cells are clipped."""
        count, rho = times, 0.0
        for name in ("overlap", "pressure", "residual"):
            inner, whole = getattr(b, name), getattr(outer, name)
            part = whole[: outer.nx * outer.pitch].reshape(outer.nx, -1)[
                row : row + b.nx, column : column + b.ny
            ]
            inner[: b.nx * b.pitch].reshape(b.nx, -1)[:, : b.ny] = part
        for _ in range(times):
            cg._free(b.pressure, b, cap, 0.0)
            before = rho
            rho, change = cg._precondition(b, taps)
            slope = cg._turn(b, max(0.0, change / before) if before > 0.0 else 0.0)
            convolve(c, b.direction, b.nx, b.ny, b.pitch, b.work, b.response)
            clipped = cg._advance(b, -slope / cg._dot(b.direction, b.response), cap)
            count += clipped > cg.FEW
            if clipped:
                cg._true_residual(c, b)
        return count


def profile(cells: int) -> None:
    """Print a line of the table of one grid."""
    total, counted = scan_time(cells), Counted()
    p = problem(cells, options())
    with (
        patch.object(contact, "solve", counted),
        patch.object(contact, "convolution", interpreted(contact.convolution)),
        patch.object(contact, "empty_box", interpreted(contact.empty_box)),
        patch.object(scanning, "solve_contact", contact.solve_contact.py_func),
        patch.object(halfspace, "solve_positions", scanning.solve_positions.py_func),
    ):
        scan_forces(
            p["heights"], (float(p["spacing"]),) * 2, p["body"], MODULUS, p["approaches"][:1],
            stride=int(p["offsets"][1]), rtol=1e-8, workers=1,
        )  # fmt: skip
    n, iterations = counted.solutions, counted.iterations
    print(
        f"| {cells}² | {1e3 * total / 64:.3f} | {iterations / n:.1f} | {counted.convolutions / n:.1f} "
        f"| {1e6 * counted.seconds / iterations:.1f} | {1e6 * counted.convolving / iterations:.1f} "
        f"| {counted.seconds / counted.convolving:.2f} |"
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
    print("| grid | ms per solve | iterations | convolutions | us per iteration | of it convolving | ratio |")
    print("|---|---:|---:|---:|---:|---:|---:|")
    for cells in chosen.cells:
        profile(cells)
    if chosen.figure:
        draw(chosen.figure)


if __name__ == "__main__":
    main()
