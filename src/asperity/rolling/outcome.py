"""How a run went: contact lost, steps not converged, laws continued beyond their data."""

from __future__ import annotations

import warnings
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from asperity.errors import ExtrapolationWarning, Grade, UnconvergedWarning, percent
from asperity.kernels.pointforce import Prepared, count_beyond, evaluate, evaluate_all
from asperity.laws.base import SteppedLaw

STEPPED_EQUILIBRIUM = 1e-5  # of the load; the contact of a stepped law is itself solved to a tolerance


def evaluation(prepared: Prepared | SteppedLaw, step: int) -> Callable[[float], tuple[float, float]]:
    """Force and stiffness of a law at a step, as a function of the approach.

    Parameters
    ----------
    prepared : Prepared or SteppedLaw
        The law on the path.
    step : int
        Step of the path.

    Returns
    -------
    callable
        From approach, m, to N and N/m.
    """
    if isinstance(prepared, Prepared):
        return lambda approach: evaluate(prepared, step, float(approach))
    return lambda approach: prepared.evaluate(step, float(approach))


def flying(
    prepared: Prepared | SteppedLaw, force: NDArray[np.float64], approach: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Whether the bodies are apart at each step; never for a contact that can pull.

    Parameters
    ----------
    prepared : Prepared or SteppedLaw
        The law on the path.
    force, approach : ndarray (n,)
        Contact force, N, and approach, m, at every step.

    Returns
    -------
    ndarray (n,) of bool
    """
    if not isinstance(prepared, Prepared):
        return np.asarray(force <= 0.0)
    if prepared.bilateral:
        return np.zeros(force.shape, dtype=bool)
    if prepared.damped_in_flight:
        return np.asarray(evaluate_all(prepared, approach)[0] <= 0.0)
    return np.asarray(force <= 0.0)


def warn_after(
    name: str, counts: NDArray, prepared: Prepared | SteppedLaw, approach: NDArray[np.float64]
) -> None:
    """Warn of what went wrong on the way.

    Parameters
    ----------
    name : str
        Of the law.
    counts : ndarray (3,) of int
        Steps done, steps not converged, evaluations.
    prepared : Prepared or SteppedLaw
        The law on the path.
    approach : ndarray (n,)
        Approach at every step, m.

    Warns
    -----
    UnconvergedWarning, ExtrapolationWarning
        If contact forces missed the tolerance, or the law was continued beyond its data.
    """
    steps = max(int(counts[0]), 1)
    if counts[1]:
        share = int(counts[1]) / steps
        warnings.warn(
            UnconvergedWarning(
                f"{name}: {counts[1]} of {steps} time steps ({percent(share)}) missed the tolerance on "
                "the contact force: their force is uncertain; take a smaller time step",
                Grade.of_share(share),
            ),
            stacklevel=4,
        )
    if not isinstance(prepared, Prepared):
        prepared.warn_of_flaws()
        return
    beyond = count_beyond(prepared, approach)
    if beyond:
        warnings.warn(
            ExtrapolationWarning(
                f"{name}: the contact was closer than its largest computed state in {beyond} of {steps} time "
                f"steps ({percent(beyond / steps)}): the force there is a continuation; compute larger "
                "approaches",
                Grade.of_share(beyond / steps),
            ),
            stacklevel=4,
        )
