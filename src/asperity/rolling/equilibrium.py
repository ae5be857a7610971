"""The state at rest from which rolling starts."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from asperity.errors import ComputationError
from asperity.kernels.modal import refine

FIRST_STEP = 1e-7  # m, doubled until the load is bracketed
LARGEST_STEP = 1.0  # m


def static_approach(
    evaluate: Callable[[float], tuple[float, float]], load: float, relative: float = 1e-9
) -> tuple[float, float]:
    """Approach, m, at which a law carries the load, N, and the stiffness there, N/m.

    `evaluate` gives force, N, and stiffness, N/m, of an approach, m; `relative` is the tolerance on the
    force, relative to the load. A `ComputationError` says that no approach up to a metre carries it.
    """
    low, high = -np.inf, np.inf
    approach, step = 0.0, FIRST_STEP
    for iteration in range(200):
        force, stiffness = evaluate(approach)
        if abs(force - load) <= relative * load:
            return approach, stiffness
        scale = max(stiffness, load / LARGEST_STEP)
        low, high, trial = refine.py_func(  # not compiled once more, for so few calls
            low, high, approach, (force - load) / scale, max(stiffness / scale, 1.0), iteration
        )
        if np.isinf(low) or np.isinf(high):
            # not bracketed yet: never leap far beyond what has been seen
            trial = approach + np.clip(trial - approach, -step, step)
            step *= 2.0
        if step > LARGEST_STEP or high - low <= 1e-15 * abs(approach):
            break
        approach = trial
    raise ComputationError(
        f"no approach carries the load of {load:.6g} N at the start of the path; "
        f"the last, {approach:.6g} m, gives {force:.6g} N",
        "a smaller load, or contact.approaches that reach higher forces",
    )
