"""How a run went: contact lost, steps not converged, laws continued beyond their data."""

from __future__ import annotations

import warnings
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from asperity.errors import ExtrapolationWarning, Grade, UnconvergedWarning, percent
from asperity.kernels.pointforce import Prepared, evaluate_all
from asperity.laws.base import SteppedLaw

STEPPED_EQUILIBRIUM = 1e-5  # of the load; the contact of a stepped law is itself solved to a tolerance


def evaluation(prepared: Prepared | SteppedLaw, step: int) -> Callable[[float], tuple[float, float]]:
    """Force, N, and stiffness, N/m, of a law at a step, as a function of the approach, m."""
    if not isinstance(prepared, Prepared):
        return lambda approach: prepared.evaluate(step, float(approach))

    def evaluate(approach: float) -> tuple[float, float]:
        force, stiffness, _ = evaluate_all(prepared, np.array([approach], dtype=np.float64), step)
        return float(force[0]), float(stiffness[0])

    return evaluate


def flying(
    prepared: Prepared | SteppedLaw, force: NDArray[np.float64], approach: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Whether the bodies are apart at each step, by force, N, and approach, m, (n,) each.

    Never for a contact that can pull.
    """
    if not isinstance(prepared, Prepared):
        return np.asarray(force <= 0.0)
    if prepared.bilateral:
        return np.zeros(force.shape, dtype=bool)
    if prepared.damped_in_flight:
        return np.asarray(evaluate_all(prepared, approach, 0)[0] <= 0.0)
    return np.asarray(force <= 0.0)


def warn_after(
    name: str, counts: NDArray[np.int64], prepared: Prepared | SteppedLaw, approach: NDArray[np.float64]
) -> None:
    """Warn of forces that missed the tolerance, and of a law that was continued beyond its data.

    `counts` holds steps done, steps not converged and evaluations; approach (n,) at every step, m.
    """
    warn_if_unconverged(name, counts, stacklevel=5)
    if not isinstance(prepared, Prepared):
        prepared.warn_of_flaws()
        return
    warn_if_beyond(name, int(evaluate_all(prepared, approach, 0)[2]), max(int(counts[0]), 1), stacklevel=5)


def warn_if_unconverged(name: str, counts: NDArray[np.int64], *, stacklevel: int) -> None:
    """Warn of forces that missed the tolerance; `counts` as of `warn_after`."""
    if not counts[1]:
        return
    steps = max(int(counts[0]), 1)
    share = int(counts[1]) / steps
    warnings.warn(
        UnconvergedWarning(
            f"{name}: {counts[1]} of {steps} time steps ({percent(share)}) missed the tolerance on "
            "the contact force: their force is uncertain; take a smaller numerics.time_step",
            Grade.of_share(share),
        ),
        stacklevel=stacklevel,
    )


def warn_if_beyond(name: str, beyond: int, steps: int, *, stacklevel: int) -> None:
    """Warn of time steps, of so many, at which a law was continued beyond its data."""
    if not beyond:
        return
    warnings.warn(
        ExtrapolationWarning(
            f"{name}: the contact was closer than its largest computed state in {beyond} of {steps} time "
            f"steps ({percent(beyond / steps)}): the force there is a continuation; let "
            "contact.approaches reach higher",
            Grade.of_share(beyond / steps),
        ),
        stacklevel=stacklevel,
    )
