# ruff: noqa: E402 (the threads are set before numpy is imported)
"""Friction: a steady state and a step of a transient beside the normal solution, and FASTSIM beside them.

Wheel on rail of the creep curve printed by CONTACT (48 × 44 cells), and the same on finer grids. One thread,
the least of some rounds.

    python benchmarks/friction.py
"""

from __future__ import annotations

import os

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[variable] = "1"

import numpy as np
from single_contact import least

from asperity import FrictionalHalfSpace, HalfSpace, Hertz, Material
from asperity.contact.creep import RollingEllipse

SHEAR, POISSON, LOAD, FRICTION = 82e9, 0.28, 106.7e3, 0.33
SMOOTH = Hertz(SHEAR / (1.0 - POISSON), 0.625, 1.7767208179193736)
BODY = Material("steel", 2.0 * SHEAR * (1.0 + POISSON), POISSON, 7850.0)


def main() -> None:
    """Print a row for each grid."""
    axes = SMOOTH.semi_axes(SMOOTH.approach(LOAD))
    ellipse = RollingEllipse(axes, SHEAR, POISSON)
    fast = least(lambda: ellipse.fastsim_force((1.6e-3, 0.0), 0.0, FRICTION * LOAD), 20)
    print(f"FASTSIM, 50 × 50: {1e3 * fast:.2f} ms")
    print("| cells | normal | steady | convolutions | step | convolutions |")
    for n in ((48, 44), (96, 88), (192, 176)):
        spacing = (2.2 * axes[0] / n[0], 2.2 * axes[1] / n[1])
        x, y = (d * (np.arange(m) - 0.5 * (m - 1)) for m, d in zip(n, spacing, strict=True))
        gap = x[:, None] ** 2 / (2.0 * SMOOTH.radius_x) + y**2 / (2.0 * SMOOTH.radius_y)
        space = HalfSpace(n, spacing, SMOOTH.modulus)
        print(f"| {n[0]} × {n[1]} | {row(space, gap)} |")


def row(space: HalfSpace, gap: np.ndarray) -> str:
    """Times on a grid, and the convolutions that they hold."""
    rolling, contact = FrictionalHalfSpace(space, (BODY, BODY), FRICTION), space.solve(gap, load=LOAD)
    steady = rolling.roll(contact, (1.6e-3, 0.0))
    state = rolling.roll(contact, (1.7e-3, 0.0), before=steady)
    normal = least(lambda: space.solve(gap, load=LOAD), 10)
    rolled = least(lambda: rolling.roll(contact, (1.6e-3, 0.0)), 10)
    step = least(lambda: rolling.roll(contact, (1.7e-3, 0.0), before=steady), 10)
    times = [f"{1e3 * normal:.1f} ms"]
    for time, of in ((rolled, steady), (step, state)):
        times += [f"{1e3 * time:.1f} ms", str(of.convolutions)]
    return " | ".join(times)


if __name__ == "__main__":
    main()
