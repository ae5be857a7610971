"""A ball under half of the tangential force that friction carries, in tamaas; run by its interpreter.

tamaas solves it on a periodic half-space, pressure and traction at once, and with an associated law of
friction: what slips also lifts, so that another part of it sticks. By how much tractions still change in the
second half of the iterations is printed beside the time.

    python friction_peer.py CELLS
"""

from __future__ import annotations

import os

os.environ["OMP_NUM_THREADS"] = "1"

import sys
import time

import numpy as np
import tamaas as tm

FRICTION, PRESSURE, ITERATIONS = 0.3, 1e-3, 3000


def solved(name: str, n: int, iterations: int, options: dict[str, float]) -> tuple[np.ndarray, float]:
    """Tractions (n, n, 3), and the processor time, s."""
    x = (np.arange(n) - 0.5 * (n - 1)) / n
    model = tm.ModelFactory.createModel(tm.model_type.surface_2d, [1.0, 1.0], [n, n])
    model.E, model.nu = 1.0, 0.0
    ball = np.ascontiguousarray(-np.add.outer(x**2, x**2) / 50.0)
    solver = getattr(tm, name)(model, ball, 1e-6, FRICTION)
    solver.max_iter = iterations
    began = time.process_time()
    solver.solve([0.5 * FRICTION * PRESSURE, 0.0, PRESSURE], **options)
    return model.traction.copy(), time.process_time() - began


def main() -> None:
    """Print a line for each solver."""
    n = int(sys.argv[1])
    tm.set_log_level(tm.LogLevel.error)
    for name, options in (("Condat", {"grad_step": 0.9}), ("Kato", {"proj_iter": 50})):
        half, _ = solved(name, n, ITERATIONS // 2, options)
        found, seconds = solved(name, n, ITERATIONS, options)
        change = np.abs(found - half).max() / found.max()
        print(
            f"tamaas {tm.__version__}, {name}, {n}²: {1e3 * seconds:.0f} ms, {ITERATIONS} iterations; "
            f"tractions change by {100 * change:.1g} % of the largest in the second half of them"
        )


if __name__ == "__main__":
    main()
