# ruff: noqa: E402 (the threads are set before numpy is imported)
"""One contact after the other, as in a loop over `HalfSpace.solve`: at an approach and under a load.

First the time inside of the compiled entry for a cold ball, next to a convolution on its window: how many of
them a contact costs. Then the time under a load next to that of the same contact at its approach, smooth and
rough, with and without hardness. One thread, the least of some rounds.

    python benchmarks/single_contact.py
"""

from __future__ import annotations

import os

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[variable] = "1"

import itertools
import time
from collections.abc import Callable
from typing import Any
from unittest.mock import patch

import numpy as np
from solve_profile import bare

from asperity import HalfSpace, Hertz
from asperity.kernels import scanning
from asperity.kernels.box import empty_box
from asperity.kernels.influence import convolution
from asperity.kernels.options import LOOP, compiled
from asperity.kernels.scanning import room
from asperity.surfaces.synthesis import self_affine

MODULUS, RADIUS, LOAD = 115e9, 25e-3, 30.0
HERTZ = Hertz(MODULUS, RADIUS, RADIUS)


def least(work: Callable[[], Any], rounds: int, clock: Callable[[], float] = time.perf_counter) -> float:
    """Time of some work, s; the first time does not count."""
    work()
    seconds = []
    for _ in range(rounds):
        began = clock()
        work()
        seconds.append(clock() - began)
    return min(seconds)


def inside(half_space: HalfSpace, gap: np.ndarray, approach: float, rounds: int) -> float:
    """Least time in the compiled entry of a solution, s."""
    entry, seconds = scanning.solve_positions, []

    def timed(*arguments: Any) -> Any:
        began = time.perf_counter()
        result = entry(*arguments)
        seconds.append(time.perf_counter() - began)
        return result

    with patch.object(scanning, "solve_positions", timed):
        for _ in range(rounds):
            half_space.solve(gap, approach=approach)
    return min(seconds)


@compiled(**LOOP)
def convolve_often(known: Any, nx: int, ny: int, room: Any, times: int) -> None:
    bare(convolution(known, nx, ny), empty_box(nx, ny, room), times)


def cold(n: int) -> None:
    """Print the lines of the cold ball."""
    x = (np.arange(n) - (n - 1) / 2) * 1e-5
    gap = (x[:, None] ** 2 + x**2) / (2 * RADIUS)
    half_space = HalfSpace((n, n), (1e-5, 1e-5), MODULUS)
    half_space.solve(gap, approach=gap.max())
    known = half_space.influence
    space = room(known, n, n).outer
    convolving = least(lambda: convolve_often(known, n, n, space, 20), 50) / 20
    for share in (0.5, 0.7, 0.9, 1.0):
        approach = (share * x[-1]) ** 2 / RADIUS
        iterations = half_space.solve(gap, approach=approach).iterations
        seconds = inside(half_space, gap, approach, 300)
        outside = least(lambda a=approach: half_space.solve(gap, approach=a), 300) - seconds
        print(
            f"| {n}² | {share} | {iterations} | {1e3 * seconds:.3f} | {1e3 * outside:.3f} "
            f"| {1e6 * convolving:.1f} | {seconds / convolving:.1f} |"
        )


def problem(n: int, rms: float) -> tuple[np.ndarray, float]:
    """Gap of a ball on a surface, m, and its spacing, m."""
    half_width = 1.5 * HERTZ.semi_axes(HERTZ.approach(LOAD))[0]
    spacing = 2 * half_width / n
    x = (np.arange(n) - (n - 1) / 2) * spacing
    gap = (x[:, None] ** 2 + x**2) / (2 * RADIUS)
    if rms:
        waves = {"longest": half_width, "shortest": 4 * spacing}
        gap = gap - self_affine((n, n), (spacing,) * 2, rms=rms, hurst=0.8, seed=3, **waves).heights
    return gap, spacing


def under_load(n: int, rtol: float) -> tuple[list[float], list[float]]:
    """Ratios of times and of iterations under a load to those at the same approach."""
    times, iterations = [], []
    peak = HERTZ.peak_pressure(HERTZ.approach(LOAD))
    for rms, cap in itertools.product((0.0, 0.05e-6, 0.2e-6, 0.6e-6), (None, 0.5, 1.5, 4.0)):
        gap, spacing = problem(n, rms)
        half_space = HalfSpace((n, n), (spacing,) * 2, MODULUS, cap and cap * peak)
        by_load = half_space.solve(gap, load=LOAD, rtol=rtol)
        at = by_load.approach
        by_approach = half_space.solve(gap, approach=at, rtol=rtol)
        assert by_load.converged
        assert by_approach.converged
        loaded, prescribed = np.inf, np.inf
        for _ in range(6):  # in turn
            loaded = min(loaded, least(lambda h=half_space, g=gap: h.solve(g, load=LOAD, rtol=rtol), 3))
            prescribed = min(
                prescribed, least(lambda h=half_space, g=gap, a=at: h.solve(g, approach=a, rtol=rtol), 3)
            )
        times.append(loaded / prescribed)
        iterations.append(by_load.iterations / by_approach.iterations)
    return times, iterations


def main() -> None:
    print(
        "| grid | radius to half window | iterations | inside, ms | outside, ms | convolution, us | ratio |"
    )
    print("|---|---:|---:|---:|---:|---:|---:|")
    cold(64)
    cold(128)
    print("\n| grid | rtol | time, median | worst | iterations, median | worst |")
    print("|---|---:|---:|---:|---:|---:|")
    for n, rtol in itertools.product((64, 128), (1e-6, 1e-8)):
        times, iterations = under_load(n, rtol)
        figures = (np.median(times), max(times), np.median(iterations), max(iterations))
        print(f"| {n}² | {rtol:g} | " + " | ".join(f"{figure:.2f}" for figure in figures) + " |")


if __name__ == "__main__":
    main()
