"""Whether a run can be believed: something moves, loads are carried, steps converge, laws have data."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from asperity import errors
from asperity.arguments import Array, Integers
from asperity.structures.body import Body
from asperity.written_numbers import engineering, rounded

Run = TypeVar("Run", bound=Any)
STILL = 1e-9
"""Share of forces and displacements by which they vary where nothing vibrates: each is found to 1e-10."""
LEAST = 100
"""Time steps of which anything is said."""
ERRORS = 5.0
"""Standard errors that a mean force may miss the load by."""
FAR = 10.0
"""How far, in what bodies and texture allow, a mass that misses its load has to be driven away."""


def steady(record: Array) -> Array:
    """A record (..., n) that keeps its last values throughout."""
    return np.repeat(record[..., -1:], record.shape[-1], axis=-1)


def without_rounding(run: Run, *names: str, **others: Any) -> Run:
    """A run in which nothing vibrates, without what rounding leaves of the records of some names."""
    records = {name: steady(getattr(run, name)) for name in names}
    return replace(run, **records, **others, acceleration=np.zeros_like(run.acceleration))


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
    name: str, force: Array, load: float, mass: float, reach: float, time_step: float, settled: int
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
        raise errors.ComputationError(
            f"{name}: nothing touches in all of the record: the contact force is 0 N, the load "
            f"{rounded(load, 4)} N",
            "a longer record, and look for what throws the bodies apart, as springs that are too soft",
        )
    driven = 0.5 * (force[1:] + force[:-1]) - load  # over each step
    if driven.size < LEAST:
        return
    missed = float(driven.mean())
    time = driven.size * time_step
    if abs(missed) <= STILL * load:
        return
    error = np.sqrt(2.0) * float(np.std(np.cumsum(driven - missed))) / driven.size
    away = 0.5 * abs(missed) / mass * time**2
    if away > FAR * reach and (abs(missed) > ERRORS * error or missed > load):
        raise errors.ComputationError(
            f"{name}: the mean contact force of {rounded(load + missed, 4)} N misses the load of "
            f"{rounded(load, 4)} N by more than bounded motion can, whose standard error is "
            f"{rounded(error, 2)} N: in {rounded(time)} s that drives what rolls {engineering(away, 'm', 2)} "
            "away",
            "what a warning asks for, if there is one; else look for what gives off energy or is not held: "
            'masses, springs and damping; for a track also numerics.kernel = "scatter"',
        )


def warn_of_counts(names: Sequence[str], counts: Integers, beyond: Sequence[int], recorded: int) -> None:
    """Warn of steps that missed the tolerance, and of steps at which a law was beyond its data.

    Of laws by their names: steps done and not converged, and steps beyond, of so many recorded.
    """
    if counts[1]:
        share = float(counts[1]) / max(int(counts[0]), 1)
        errors.UnconvergedWarning.warn(
            f"{', '.join(dict.fromkeys(names))}: {counts[1]} of {max(int(counts[0]), 1)} time steps "
            f"({errors.percent(share)}) missed the tolerance on the contact force: their force is uncertain; "
            "take a smaller numerics.time_step",
            errors.Grade.of_share(share),
        )
    of_law = dict.fromkeys(names, 0)
    for name, count in zip(names, beyond, strict=True):
        of_law[name] += int(count)
    for name, count in of_law.items():
        steps = names.count(name) * recorded
        if count:
            errors.ExtrapolationWarning.warn(
                f"{name}: the contact was closer than its largest computed state in {count} of {steps} time "
                f"steps ({errors.percent(count / steps)}): the force there is a continuation; let "
                "contact.approaches reach higher",
                errors.Grade.of_share(count / steps),
            )
