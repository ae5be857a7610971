# ruff: noqa: E402 (the threads are set before numpy is imported)
"""Friction: a steady state and a step of a transient beside the normal solution, and FASTSIM beside them.

Wheel on rail of the creep curve printed by CONTACT (48 × 44 cells), and the same on finer grids. The normal
solution from nothing, and from the pressure at 2 % less load. Then likewise steps over a rough surface, and a
ball under half of the tangential force that friction carries, with the like in a peer (`benchmarks/peers.sh`
installs it), where a Python is named that has it. Processor time of one thread, the least of some rounds.

    python benchmarks/friction.py [--peers-python FOLDER/bin/python]
"""

from __future__ import annotations

import os

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[variable] = "1"

import argparse
import subprocess
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from single_contact import least

from asperity import FrictionalHalfSpace, HalfSpace, Hertz, Material
from asperity.contact.creep import RollingEllipse
from asperity.surfaces.synthesis import self_affine

SHEAR, POISSON, LOAD, FRICTION = 82e9, 0.28, 106.7e3, 0.33
STEPS = 60
SMOOTH = Hertz(SHEAR / (1.0 - POISSON), 0.625, 1.7767208179193736)
BODY = Material("steel", 2.0 * SHEAR * (1.0 + POISSON), POISSON, 7850.0)


def main() -> None:
    """Print a row for each grid, and the ball."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--peers-python")
    peer = parser.parse_args().peers_python
    axes = SMOOTH.semi_axes(SMOOTH.approach(LOAD))
    ellipse = RollingEllipse(axes, SHEAR, POISSON)
    fast = taken(lambda: ellipse.fastsim_force((1.6e-3, 0.0), 0.0, FRICTION * LOAD), 20)
    print(f"FASTSIM, 50 × 50: {1e3 * fast:.2f} ms")
    print("| cells | normal | warm | steady | convolutions | step | convolutions |")
    for n in ((48, 44), (96, 88), (192, 176)):
        spacing = (2.2 * axes[0] / n[0], 2.2 * axes[1] / n[1])
        x, y = (d * (np.arange(m) - 0.5 * (m - 1)) for m, d in zip(n, spacing, strict=True))
        gap = x[:, None] ** 2 / (2.0 * SMOOTH.radius_x) + y**2 / (2.0 * SMOOTH.radius_y)
        space = HalfSpace(n, spacing, SMOOTH.modulus)
        print(f"| {n[0]} × {n[1]} | {row(space, gap)} |")
    print("| rolled over a rough surface, cells | normal | step | convolutions |")
    for n in ((40, 28), (80, 56), (160, 112)):
        print(f"| {n[0]} × {n[1]} | {rolled(n)} |")
    print(ball(64))
    if peer:
        subprocess.run([peer, str(Path(__file__).with_name("friction_peer.py")), "64"], check=True)


def taken(work: Callable[[], Any], rounds: int) -> float:
    """Processor time of some work, s."""
    return least(work, rounds, time.thread_time)


def rolled(n: tuple[int, int]) -> str:
    """Mean times of contacts one cell apart, each from the one before, moved with the surface."""
    axes = SMOOTH.semi_axes(SMOOTH.approach(LOAD))
    spacing = (2.1 * axes[0] / n[0], 2.1 * axes[1] / n[1])
    x, y = (d * (np.arange(m) - 0.5 * (m - 1)) for m, d in zip(n, spacing, strict=True))
    gap = x[:, None] ** 2 / (2.0 * SMOOTH.radius_x) + y**2 / (2.0 * SMOOTH.radius_y)
    waves = {"longest": axes[0], "shortest": 4.0 * max(spacing)}
    heights = self_affine(
        (n[0] + STEPS, n[1]), spacing, rms=0.2 * SMOOTH.approach(LOAD), hurst=0.8, seed=2, **waves
    ).heights
    space = HalfSpace(n, spacing, SMOOTH.modulus)
    rolling, contact = FrictionalHalfSpace(space, (BODY, BODY), FRICTION), space.solve(gap, load=LOAD)
    state, sums = rolling.roll(contact, (1e-3, 0.0)), np.zeros(3)
    for row in range(STEPS):
        pressure = np.roll(state.normal.pressure, -1, axis=0)
        began = time.thread_time()
        contact = space.solve(gap - heights[row : row + n[0]], load=LOAD, start=pressure)
        middle = time.thread_time()
        start = replace(state, traction=np.roll(state.traction, -1, axis=1))
        state = rolling.roll(contact, (1e-3, 0.0), before=state, start=start)
        if row >= STEPS // 2:
            sums += middle - began, time.thread_time() - middle, state.convolutions
    normal, step, convolutions = sums / (STEPS - STEPS // 2)
    return f"{1e3 * normal:.2f} ms | {1e3 * step:.2f} ms | {convolutions:.0f}"


def ball(n: int) -> str:
    """Time of a shift to half of the force."""
    x = np.arange(n) - 0.5 * (n - 1)
    space = HalfSpace((n, n), 1e-4, SMOOTH.modulus)
    gap = np.add.outer(x**2, x**2) * 1e-8 / (2.0 * 0.46)
    rolling = FrictionalHalfSpace(space, (BODY, BODY), FRICTION)
    contact = space.solve(gap, approach=0.6 * float(gap[0].min()))
    half = -0.5 * FRICTION * contact.force
    found = rolling.shift(contact, force=(half, None))
    normal, shifted = (
        taken(work, 5)
        for work in (
            lambda: space.solve(gap, approach=contact.approach),
            lambda: rolling.shift(contact, force=(half, None)),
        )
    )
    return (
        f"a ball, {n}²: pressure {1e3 * normal:.1f} ms, shift to half of the force {1e3 * shifted:.1f} ms, "
        f"{found.convolutions} convolutions in the last solution"
    )


def row(space: HalfSpace, gap: np.ndarray) -> str:
    """Times on a grid, and the convolutions that they hold."""
    rolling, contact = FrictionalHalfSpace(space, (BODY, BODY), FRICTION), space.solve(gap, load=LOAD)
    steady = rolling.roll(contact, (1.6e-3, 0.0))
    state = rolling.roll(contact, (1.7e-3, 0.0), before=steady)
    lighter = space.solve(gap, load=0.98 * LOAD).pressure
    normal = taken(lambda: space.solve(gap, load=LOAD), 20)
    warm = taken(lambda: space.solve(gap, load=LOAD, start=lighter), 20)
    rolled = taken(lambda: rolling.roll(contact, (1.6e-3, 0.0)), 20)
    step = taken(lambda: rolling.roll(contact, (1.7e-3, 0.0), before=steady), 20)
    times = [f"{1e3 * each:.2f} ms" for each in (normal, warm)]
    for seconds, of in ((rolled, steady), (step, state)):
        times += [f"{1e3 * seconds:.2f} ms", str(of.convolutions)]
    return " | ".join(times)


if __name__ == "__main__":
    main()
