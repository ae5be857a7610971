"""A mechanism carried on in time, from rest, and what is kept of it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from asperity.arguments import Array, Integers, positive, require
from asperity.errors import Outcome
from asperity.progress import Progress
from asperity.rolling import assembly
from asperity.rolling.course import Course, laid_together
from asperity.rolling.ground import ground_of, small_motion, warn_if_bent
from asperity.rolling.ledger import Ledger, ledger_of
from asperity.rolling.mechanism import Mechanism
from asperity.rolling.rest import standing
from asperity.rolling.soundness import warn_of_counts
from asperity.rolling.stepper import Stepper
from asperity.store import Checkpoint


@dataclass(frozen=True, eq=False, kw_only=True)
class RolledMechanism:
    """What was recorded of n contacts at t steps, after the run-in."""

    time: Array  # (t,), s, uniform from zero, after the run-in
    body: Integers  # (n,), to which body each contact belongs
    contact_force: Array  # (n, t), N, compression positive
    history: Array  # (n, m), contact force of run-in and run, N
    # this and the next two without rows where displacements of sensors alone were asked for
    relative_displacement: Array  # (n, t), approach of the mean surfaces, m, positive closing
    over_displacement: Array  # (n, t), of what is rolled over, at the contacts, m, positive downwards
    rolling_displacement: Array  # (n, t), of what rolls, at the contacts, m, positive downwards
    degrees_of_freedom: tuple[Array, ...]  # of each body (d, t), m or rad, positive as its contacts open
    displacement: Array  # (sensors, t), of structures, m; without rows where it was not asked for
    acceleration: Array  # (sensors, t), of structures, m/s², positive as the contact force pushes
    softening: Array  # (n,), compliance that the time step puts in series with the contacts, m/N
    energy: Ledger  # where the work of the loads went, in run-in and run
    evaluations: int  # of the laws, in run-in and run
    unconverged_steps: int  # time steps in which a contact force missed the tolerance, of run-in and run
    outcome: Outcome  # whether all steps converged

    @property
    def reached(self) -> Array:
        """Least and largest contact force in run-in and run (n, 2), N."""
        return np.column_stack([self.history.min(axis=1), self.history.max(axis=1)])


def carried(
    course: Course,
    loads: Array,
    *,
    sensors: Array,
    displacements: bool = False,
    highest_frequency: float | None = None,
    progress: Progress | None = None,
    checkpoint: Checkpoint | None = None,
) -> Stepper:
    """A mechanism that was set down, with contacts soft enough for the time step, and carried on to the end.

    By scales of the contact forces (n,), N, and rows of sensors (k, s) over all modes, whose displacements
    are recorded beside accelerations where they are asked for, in place of those at the contacts, unless
    structures bend under these. What is doubted is warned of.
    """
    ground = ground_of(course, sensors)
    system = assembly.system_of(ground, course.bodies, loads, course.time_step, course.mechanism.constant)
    started = assembly.softened(ground, system, course, highest_frequency)
    bends = any(small_motion(each) is not None for each in course.mechanism.structures)
    at_contacts = bends or not displacements
    stepper = Stepper(course, *started, ground.softest, displacements, at_contacts)
    try:
        stepper.run(progress, checkpoint)
    finally:
        if bends:  # why a motion may have run away
            _warn_if_bent(course.mechanism, stepper.record.over_displacement)
    for law in stepper.stepped.values():
        law.warn_of_flaws()
    names = [law.name for law in course.laws]
    warn_of_counts(names, stepper.motion.counts, stepper.beyond.tolist(), course.total + 1)
    return stepper


def _warn_if_bent(mechanism: Mechanism, displaced: Array) -> None:
    """Compare displacements of structures under their contacts (n, t), m, with what their theory allows."""
    for index, structure in enumerate(mechanism.structures):
        if small_motion(structure) is None:
            continue
        alone = [[side.structure for side in contact.sides] == [index] for contact in mechanism.contacts]
        warn_if_bent(structure, displaced[alone])


def recorded(stepper: Stepper) -> dict[str, Any]:
    """Fields of a `RolledMechanism`."""
    kept = slice(stepper.course.settled, None)
    records = {name: value[..., kept] for name, value in stepper.record._asdict().items()}
    cores = records.pop("core")
    unconverged = int(stepper.motion.counts[1])
    return records | {
        "time": stepper.course.time_step * np.arange(cores.shape[-1]),
        "body": stepper.system.body,
        "history": stepper.record.contact_force,
        "degrees_of_freedom": tuple(
            core[: len(body.mass)] for body, core in zip(stepper.course.mechanism.bodies, cores, strict=False)
        ),
        "softening": stepper.system.softening,
        "energy": ledger_of(stepper),
        "evaluations": int(stepper.motion.counts[2]),
        "unconverged_steps": unconverged,
        "outcome": Outcome.STEPS_UNCONVERGED if unconverged else Outcome.CONVERGED,
    }


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
    """Carry a mechanism on in time, from rest under its constant forces on contacts that go on.

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
    steps = round(positive("duration (s)", duration) / h)
    require(steps >= 1, "duration (s)", duration, f"at least one time step of {h:.6g} s")
    course = Course(mechanism, h, settled + steps, settled)
    stepper = carried(
        course,
        np.full(course.contacts, positive("load (N)", load)),
        sensors=np.zeros((0, mechanism.first_modes[-1])) if sensors is None else np.asarray(sensors, float),
        displacements=True,
        highest_frequency=highest_frequency,
        progress=progress,
        checkpoint=checkpoint,
    )
    return RolledMechanism(**recorded(stepper))


def rests_of(mechanism: Mechanism, steps: Sequence[int], load: float) -> Array:
    """Coordinates of all modes (k, s) of a mechanism at rest, as it stands at each of some steps.

    It has no rail; the `load` as above, N.
    """
    course = Course(mechanism, 1.0, 0)
    ground = ground_of(course, np.zeros((0, mechanism.first_modes[-1])), range(1))
    loads = np.full(course.contacts, load)
    system = assembly.system_of(ground, course.bodies, loads, 1.0, mechanism.constant)
    found = []
    for step in steps:
        at = range(step, step + 1)
        shapes, rates = course.shapes_at(at)
        here = replace(ground, shapes=shapes[0], rates=rates[0])
        rest = standing(here, course.bodies, system, laid_together(mechanism.contacts, at))
        found.append(rest.motion.displacement[: mechanism.first_modes[-1]])
    return np.array(found)
