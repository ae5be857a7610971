"""How a run went: contact lost, load carried, steps not converged, laws continued beyond their data."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from asperity.arguments import Array
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


def flying(prepared: Prepared | SteppedLaw, force: Array, approach: Array) -> NDArray[np.bool_]:
    """Whether the bodies are apart at each step, by force, N, and approach, m, (n,) each.

    Never for a contact that can pull.
    """
    if isinstance(prepared, Prepared):
        if prepared.bilateral:
            return np.zeros(force.shape, dtype=bool)
        if prepared.damped_in_flight:
            force = evaluate_all(prepared, approach, 0)[0]
    return np.asarray(force <= 0.0)


LEAST = 100
"""Time steps of which anything is said."""
ERRORS = 5.0
"""Standard errors that a mean force may miss the load by."""
FAR = 10.0
"""How far, in what bodies and texture allow, a mass that misses its load has to be driven away."""


def free_motion(body: Body) -> tuple[Array, float, float] | None:
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
    name: str, force: Array, load: float, mass: float, reach: float, time_step: float, settled: int = 0
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


def warn_of_steps(
    names: Sequence[str],
    prepared: Sequence[Prepared | SteppedLaw],
    counts: NDArray[np.int64],
    approach: Array,
) -> None:
    """Warn of forces that missed the tolerance, and of laws that were continued beyond their data.

    Laws by their names; counts are of steps done, not converged, and evaluations; the approach (n, steps), m,
    is that which the laws saw. Contacts under laws of one name count together.
    """
    if counts[1]:
        share = float(counts[1]) / max(int(counts[0]), 1)
        missed = (
            f"{', '.join(dict.fromkeys(names))}: {counts[1]} of {max(int(counts[0]), 1)} time steps "
            f"({percent(share)}) missed the tolerance on the contact force: their force is uncertain; take a "
            "smaller numerics.time_step"
        )
        warnings.warn(UnconvergedWarning(missed, Grade.of_share(share)), stacklevel=5)
    beyond = dict.fromkeys(names, 0)
    for name, law, seen in zip(names, prepared, approach, strict=True):
        if isinstance(law, Prepared):
            beyond[name] += int(evaluate_all(law, seen, 0)[2])
        else:
            law.warn_of_flaws()
    for name, count in beyond.items():
        steps = names.count(name) * approach.shape[1]
        if count:
            message = (
                f"{name}: the contact was closer than its largest computed state in {count} of {steps} time "
                f"steps ({percent(count / steps)}): the force there is a continuation; let "
                "contact.approaches reach higher"
            )
            warnings.warn(ExtrapolationWarning(message, Grade.of_share(count / steps)), stacklevel=5)
