"""How a run went: contact lost, load carried, steps not converged, laws continued beyond their data."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from asperity.errors import ComputationError, ExtrapolationWarning, Grade, UnconvergedWarning, percent
from asperity.kernels.pointforce import Prepared, evaluate_all
from asperity.laws.base import SteppedLaw
from asperity.structures.body import Body


@dataclass(frozen=True)
class ContactLoss:
    """One flight."""

    start: float  # time of the first sample out of contact, s
    duration: float  # samples out of contact times the time step, s


def contact_losses(flying: NDArray[np.bool_], time_step: float) -> list[ContactLoss]:
    """Flights in a record, in order of time; `flying` (n,) says whether bodies are apart; time step in s."""
    edges = np.diff(np.concatenate([[False], np.asarray(flying, dtype=bool), [False]]).astype(np.int8))
    starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    return [
        ContactLoss(float(start * time_step), float((end - start) * time_step))
        for start, end in zip(starts, ends, strict=True)
    ]


LEAST = 100
"""Time steps of which anything is said."""
ERRORS = 5.0
"""Standard errors that a mean force may miss the load by."""
FAR = 10.0
"""How far, in what bodies and texture allow, a mass that misses its load has to be driven away."""


def displaced_in_contact(approach: NDArray[np.float64], apart: NDArray[np.bool_]) -> float:
    """How far texture and contact displace bodies, m, by the approach while they touch."""
    touching = approach[~apart]
    return float(np.ptp(touching)) if touching.size else 0.0


def free_motion(body: Body) -> tuple[NDArray[np.float64], float, float] | None:
    """How a body that nothing but its contacts holds is driven by its load; None if springs hold it.

    Displacements of its contacts (c,), the largest one; its mass in this motion, kg, and its load, N.
    """
    held = np.vstack([each / (np.abs(each).max() or 1.0) for each in (body.stiffness, body.damping)])
    _, size, rows = np.linalg.svd(held, full_matrices=False)
    loose = rows[size < 1e-9]
    motion = loose.T @ (loose @ body.pressing)
    at_contacts = body.contacts @ motion
    largest = float(np.abs(at_contacts).max(initial=0.0))
    if not largest > 1e-9 * float(np.linalg.norm(body.pressing)):
        return None
    motion = motion / largest
    return at_contacts / largest, float(motion @ body.mass @ motion), float(motion @ body.pressing)


def refuse_missed_load(
    name: str,
    force: NDArray[np.float64],
    load: float,
    mass: float,
    reach: float,
    time_step: float,
    settled: int = 0,
) -> None:
    """Refuse a run whose mean contact force misses the load by more than its standard error.

    Force (n,) of run-in and run, and load, N, on a mass, kg, that nothing else holds; `reach` is how far
    deflection and texture displace it, m. The mean of F − P over a time T is the change of momentum over T,
    exactly. Where motion is bounded, that is the difference of two moments, so that √2 σ/T is its standard
    error, σ being the standard deviation of the momentum about its trend; a mass that falls has no other
    trend. Within a part of a slow swing it looks alike, but then the mass stays within reach. A mean of more
    than twice the load is more than rest and gravity account for. A record, from step `settled` on, in which
    nothing touches says nothing, however short it is.
    """
    if not force[settled:].any():
        raise ComputationError(
            f"{name}: nothing touches in all of the record: the contact force is 0 N, the load {load:.4g} N",
            "a longer record, and look for what throws the bodies apart, as springs that are too soft",
        )
    driven = 0.5 * (force[1:] + force[:-1]) - load  # over each step
    if driven.size < LEAST:
        return
    missed, time = float(driven.mean()), driven.size * time_step
    error = np.sqrt(2.0) * float(np.std(np.cumsum(driven - missed))) / driven.size
    away = 0.5 * abs(missed) / mass * time**2
    if away > FAR * reach and (abs(missed) > ERRORS * error or missed > load):
        raise ComputationError(
            f"{name}: the mean contact force of {load + missed:.4g} N misses the load of {load:.4g} N by "
            f"more than bounded motion can, whose standard error is {error:.2g} N: in {time:.3g} s that "
            f"drives what rolls {away:.2g} m away",
            "what a warning asks for, if there is one; else look for what gives off energy or is not held: "
            'masses, springs and damping; for a track also numerics.kernel = "scatter"',
        )


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


def warn_if_unconverged(name: str, counts: NDArray[np.int64], *, stacklevel: int) -> None:
    """Warn of forces that missed the tolerance; counts are of steps done, not converged, and evaluations."""
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
