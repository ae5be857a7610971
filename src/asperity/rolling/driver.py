"""A mechanism carried on in time, from rest, and what is kept of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asperity.arguments import Array, positive, require
from asperity.progress import Progress
from asperity.rolling import assembly
from asperity.rolling.course import Course, laid_out
from asperity.rolling.ground import ground_of
from asperity.rolling.ledger import Ledger, ledger_of
from asperity.rolling.mechanism import Mechanism
from asperity.rolling.rest import start_still
from asperity.rolling.soundness import warn_of_counts
from asperity.rolling.stepper import Stepper
from asperity.store import Checkpoint


@dataclass(frozen=True, eq=False)
class RolledMechanism:
    """What was recorded of n contacts at t steps, after the run-in."""

    contact_force: Array  # (n, t), N, compression positive
    bodies: tuple[Array, ...]  # coordinates of each (d, t), m or rad, positive as its contacts open
    displacement: Array  # (sensors, t), m
    acceleration: Array  # (sensors, t), m/s²
    reached: Array  # (n, 2), least and largest contact force in run-in and run, N
    softening: Array  # (n,), compliance that the time step puts in series with the contacts, m/N
    energy: Ledger  # where the work of the loads went, in run-in and run
    unconverged_steps: int


def roll_mechanism(
    mechanism: Mechanism,
    load: float,
    *,
    time_step: float,
    duration: float,
    settling: float = 0.0,
    sensors: Array | None = None,
    highest_frequency: float | None = None,
    progress: Progress | None = None,
    checkpoint: Checkpoint | None = None,
) -> RolledMechanism:
    """Carry a mechanism on in time, from rest under its constant forces.

    As `asperity.rolling.roll.roll_bodies`, and by the same steps: structures and bodies are advanced exactly
    for contact forces that are linear over a step, and the forces at its end solve all laws at once.

    Parameters
    ----------
    mechanism : Mechanism
        Its contacts give their places from step 0 on, where the run-in begins.
    load : float
        A usual contact force, N: each is found to 1e-10 of itself plus this.
    time_step, duration, settling : float
        s; the record starts after the run-in, `settling`.
    sensors : ndarray (k, s), optional
        Rows over all modes, as `Mechanism.row` makes them, whose motion is recorded.
    highest_frequency : float, optional
        Hz, against which the time step is checked.
    progress, checkpoint : optional
        As in `roll_bodies`.

    Returns
    -------
    RolledMechanism

    Raises
    ------
    ComputationError
        If nothing is at rest at the start, or the motion runs away.
    """
    h = positive("time step (s)", time_step)
    settled = round(settling / h)
    recorded = round(positive("duration (s)", duration) / h)
    require(recorded >= 1, "duration (s)", duration, f"at least one time step of {h:.6g} s")
    course = Course(mechanism, h, settled + recorded)
    seen = np.zeros((0, mechanism.first_modes[-1])) if sensors is None else np.asarray(sensors, dtype=float)
    ground = ground_of(course, seen)
    loads = np.full(course.contacts, positive("load (N)", load))
    system = assembly.system_of(ground, course.bodies, loads, h, mechanism.constant)
    # with contacts that are soft enough for the time step
    started = assembly.softened(start_still, ground, system, course, highest_frequency)
    stepper = Stepper(course, *started, np.inf, displacements=True)
    energies = stepper.energies()
    stepper.run(progress, checkpoint)
    _warn(stepper)
    kept = slice(settled, None)
    record = stepper.record
    return RolledMechanism(
        record.contact_force[:, kept],
        tuple(
            core[: len(body.mass), kept] for body, core in zip(mechanism.bodies, record.core, strict=False)
        ),
        record.displacement[:, kept],
        record.acceleration[:, kept],
        np.column_stack([record.contact_force.min(axis=1), record.contact_force.max(axis=1)]),
        stepper.system.softening,
        ledger_of(stepper, energies),
        int(stepper.motion.counts[1]),
    )


def rest_of(mechanism: Mechanism, step: int, load: float) -> Array:
    """Coordinates of all modes (s,) of a mechanism at rest, as it stands at a step; `load` as above, N."""
    course = Course(mechanism, 1.0, 0)
    at = range(step, step + 1)
    ground = ground_of(course, np.zeros((0, mechanism.first_modes[-1])), at)
    loads = np.full(course.contacts, load)
    system = assembly.system_of(ground, course.bodies, loads, 1.0, mechanism.constant)
    laws = [laid_out(contact, at) for contact in mechanism.contacts]
    return start_still(ground, course.bodies, system, laws)[1].displacement[: mechanism.first_modes[-1]]


def _warn(stepper: Stepper) -> None:
    """Warn of steps that missed the tolerance, and of laws that were continued beyond their data."""
    course = stepper.course
    record = stepper.record
    seen = record.relative_displacement - stepper.system.softening[:, None] * record.contact_force
    for solved in stepper.stepped.values():
        solved.warn_of_flaws()
    names = [law.name for law in course.laws]
    warn_of_counts(names, stepper.motion.counts, course.beyond(seen), seen.shape[1])
