"""The energy balance of bodies on several contacts: where the work of the loads went."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.errors import Outcome
from asperity.kernels.pointforce import Prepared, evaluate_all
from asperity.kernels.several import (
    BODY_DAMPING,
    CONTACT_DAMPING,
    CONTACT_WORK,
    OVER_DAMPING,
    SLOPE_WORK,
    THROUGHPUT,
    ContactsMotion,
)
from asperity.laws.base import Law
from asperity.progress import Progress
from asperity.rolling.assembly import Stand, stand
from asperity.rolling.outcome import (
    ContactLoss,
    contact_losses,
    displaced_in_contact,
    flying,
    free_motion,
    refuse_missed_load,
    warn_if_beyond,
    warn_if_unconverged,
)
from asperity.rolling.path import Path
from asperity.rolling.stepper import ContactsStepper, Remembered, advance_to_end, restore
from asperity.store import Checkpoint
from asperity.structures.body import Body
from asperity.structures.modal import Modal
from asperity.structures.rail_poles import RailBetween


@dataclass(frozen=True)
class Ledger:
    """Energies gained and work done since the start, J, in run-in and run.

    The work of the loads equals the sum of the others, up to what the time step leaves open: the integrals
    are taken by the trapezoidal rule from the motion, the energies from the states at start and end. On a
    rail, of which displacements alone are known, `contact` holds what goes into contacts and rail together,
    and the terms of the structure are zero.
    """

    loads: float  # work of the constant forces that press the bodies down
    bodies: float  # kinetic and elastic energy gained by the bodies
    body_damping: float  # dissipated in their dampers and modes
    structure: float  # kinetic and elastic energy gained by what is rolled over
    structure_damping: float  # dissipated there
    contact: float  # work on the contacts: stored, damped, less what textures feed in
    slope: float  # work against the slope of the bent structure, given up to the drive that keeps the speed
    contact_damping: float  # the part of `contact` that their dampers took
    throughput: float  # time integral of the moduli of the powers at both sides of all contacts

    @property
    def residual(self) -> float:
        """What the balance leaves open, relative to the throughput."""
        gained = self.bodies + self.body_damping + self.structure + self.structure_damping
        left = self.loads - gained - self.contact - self.slope
        return abs(left) / self.throughput if self.throughput > 0.0 else 0.0

    def shares(self) -> dict[str, float]:
        """The terms by their names in results, J; the first equals the sum of the others."""
        return {
            "work of the loads": self.loads,
            "bodies": self.bodies,
            "damping of the bodies": self.body_damping,
            "structure": self.structure,
            "damping of the structure": self.structure_damping,
            "contacts": self.contact,
            "slope of the structure": self.slope,
        }


def warn_after_contacts(stepper: ContactsStepper, approach: NDArray[np.float64]) -> None:
    """Warn of forces that missed the tolerance, and of laws that were continued beyond their data.

    The approach (n, steps), m, is that which the laws saw. Contacts under laws of one name count together.
    """
    counts = stepper.motion.counts
    names = [law.name for law in stepper.laws]
    warn_if_unconverged(", ".join(dict.fromkeys(names)), counts, stacklevel=5)
    beyond = dict.fromkeys(names, 0)
    for name, law, seen in zip(names, stepper.prepared, approach, strict=True):
        if isinstance(law, Prepared):
            beyond[name] += int(evaluate_all(law, seen, 0)[2])
        else:
            law.warn_of_flaws()
    for name, count in beyond.items():
        warn_if_beyond(name, count, names.count(name) * approach.shape[1], stacklevel=5)


Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class RolledBodies:
    """Bodies have rolled over a structure on c contacts, numbered through in the order of the bodies."""

    time: Array  # (n,), s, uniform from zero, after the run-in
    positions: Array  # (c, n), of the contacts, m
    body: NDArray[np.int64]  # (c,), to which body each contact belongs
    contact_force: Array  # (c, n), N, compression positive
    history: Array  # (c, m), contact force of run-in and run, N
    history_start: Array  # (c,), position of its first value, m
    relative_displacement: Array  # (c, n), approach of the mean surfaces, m, positive closing
    over_displacement: Array  # (c, n), of what is rolled over, at the contacts, m, positive downwards
    rolling_displacement: Array  # (c, n), of what rolls, at the contacts, m, positive downwards
    degrees_of_freedom: tuple[Array, ...]  # of each body (d, n), m or rad, positive upwards
    acceleration: Array  # (sensors, n), of what is rolled over, m/s², positive downwards
    in_contact: NDArray[np.bool_]  # (c, n), whether the surfaces touch
    contact_loss: tuple[list[ContactLoss], ...]  # flights at each contact
    energy: Ledger  # where the work of the loads went, in run-in and run
    evaluations: int  # of the laws, in run-in and run
    unconverged_steps: int  # time steps in which a contact force missed the tolerance, of run-in and run
    outcome: Outcome  # whether all steps converged


@dataclass(frozen=True, eq=False)
class FirstContact:
    """What the first contact of bodies that have rolled recorded, and beside it what all of them did."""

    time: Array  # (n,), s, uniform from zero, after the run-in
    position: Array  # (n,), of the contact, m
    contact_force: Array  # (n,), N, compression positive
    relative_displacement: Array  # (n,), approach of the mean surfaces, m, positive closing
    in_contact: NDArray[np.bool_]  # (n,), whether the bodies touch
    contact_loss: list[ContactLoss]  # flights
    evaluations: int  # of the law, in run-in and run
    unconverged_steps: int  # time steps whose contact force missed the tolerance, of run-in and run
    outcome: Outcome  # whether all steps converged
    over_displacement: Array  # (n,), of what is rolled over, at the contact, m, positive downwards
    rolling_displacement: Array  # (n,), of what rolls, at the contact, m, positive downwards
    every: RolledBodies

    @property
    def contact_loss_share(self) -> float:
        """Share of the time out of contact."""
        return 1.0 - float(np.mean(self.in_contact))

    @property
    def longest_loss(self) -> float:
        """Duration of the longest flight, s."""
        return max((event.duration for event in self.contact_loss), default=0.0)

    @property
    def acceleration(self) -> Array:
        """Of what is rolled over (sensors, n), m/s², positive downwards."""
        return self.every.acceleration

    @property
    def energy(self) -> Ledger:
        """Where the work of the loads went, in run-in and run."""
        return self.every.energy


def first_contact(every: RolledBodies) -> FirstContact:
    """Take the first contact of bodies that have rolled."""
    return FirstContact(
        time=every.time,
        position=every.positions[0],
        contact_force=every.contact_force[0],
        relative_displacement=every.relative_displacement[0],
        in_contact=every.in_contact[0],
        contact_loss=every.contact_loss[0],
        evaluations=every.evaluations,
        unconverged_steps=every.unconverged_steps,
        outcome=every.outcome,
        over_displacement=every.over_displacement[0],
        rolling_displacement=every.rolling_displacement[0],
        every=every,
    )


def roll_bodies(
    over: Modal | RailBetween | None,
    bodies: Sequence[Body],
    laws: Sequence[Law],
    *,
    speed: float,
    start: float,
    duration: float,
    time_step: float,
    positions: ArrayLike,
    settling: float = 0.0,
    highest_frequency: float | None = None,
    sensors: ArrayLike = (),
    progress: Progress | None = None,
    checkpoint: Checkpoint | None = None,
) -> RolledBodies:
    """Roll bodies over a structure at constant speed, and keep what follows the run-in.

    All contacts feel each other, through the structure and through the bodies. Structure and bodies are
    advanced exactly for contact forces that are linear over a step; the forces at the end of each step solve
    all contact laws at once, each to 1e-10 of itself plus its load (laws that Python steps: 1e-6), to second
    order in the time step. The time of a step grows linearly with the number of contacts. A step that is too
    long to be stable is kept so by softened contacts, with a warning (`asperity.rolling.stability`).

    Parameters
    ----------
    over : Modal or RailBetween or None
        What is rolled over: a structure by its modes, a rail (`asperity.structures.rail_poles`), or None
        for a plane that does not move. Loads have rolled on it long enough to be steady; one that stands on a
        support has just come on, and modes without stiffness are at rest.
    bodies : sequence of Body
        What rolls, pressed down by its constant forces; contacts are numbered through the bodies.
    laws : sequence of Law
        One for each contact; it reads its texture at the position of its own contact.
    speed : float
        m/s, of all bodies.
    start : float
        Where the bodies are at time zero, after the run-in, m.
    duration, time_step : float
        s.
    positions : array_like (b,)
        Of the bodies ahead of `start`, m; their contacts lie at their `places` from there.
    settling : float
        Run-in before time zero, s.
    highest_frequency : float, optional
        Hz, against which the time step is checked.
    sensors : array_like (k,)
        Places on the structure whose acceleration is recorded, m.
    progress : callable, optional
        Is told steps done, steps in all and what is done.
    checkpoint : Checkpoint, optional
        Keeps the state about every 10 s, at the end and when interrupted, to go on from there.

    Returns
    -------
    RolledBodies

    Raises
    ------
    InputError
        If a contact leaves the structure, a rail was made for another speed, time step or distances, or
        numbers of bodies, laws and positions disagree.
    ComputationError
        If nothing is at rest at the start, or the motion runs away.
    """
    whole = Path.laid(start, speed, time_step, duration, settling)
    at = np.atleast_1d(np.asarray(positions, dtype=float))
    standing = stand(
        over, bodies, laws, whole, at, np.atleast_1d(np.asarray(sensors, dtype=float)), highest_frequency
    )
    stepper, remembered = standing.stepper, Remembered(standing.stepper.prepared)
    energies = standing.energies()
    restore(checkpoint, stepper, remembered)
    largest = standing.largest
    try:
        advance_to_end(stepper, remembered, lambda: stepper.advance(largest), largest, progress, checkpoint)
    finally:  # why a motion may have run away
        standing.under.judge(stepper.record.over)
    return _rolled(standing, whole, energies)


def _rolled(standing: Stand, whole: Path, energies: tuple[float, float, float]) -> RolledBodies:
    """What is kept of a run that is done."""
    stepper, kept = standing.stepper, slice(whole.settled, None)
    record, counts = stepper.record, stepper.motion.counts
    seen = record.approach - stepper.system.softening[:, None] * record.force
    apart = np.array(
        [
            flying(law, force, approach)
            for law, force, approach in zip(stepper.prepared, record.force, seen, strict=True)
        ]
    )
    warn_after_contacts(stepper, seen)
    _refuse_missed_loads(standing, apart, whole)
    apart = apart[:, kept]
    dofs = zip(standing.steps.bases, record.core, strict=True)
    return RolledBodies(
        time=whole.time,
        positions=np.array([path.positions[kept] for path in stepper.paths]),
        body=standing.steps.body,
        contact_force=record.force[:, kept],
        history=record.force,
        history_start=np.array([path.positions[0] for path in stepper.paths]),
        relative_displacement=record.approach[:, kept],
        over_displacement=record.over[:, kept],
        rolling_displacement=record.rolling[:, kept],
        degrees_of_freedom=tuple(basis @ core[: len(basis), kept] for basis, core in dofs),
        acceleration=record.acceleration[:, kept],
        in_contact=~apart,
        contact_loss=tuple(contact_losses(each, whole.time_step) for each in apart),
        energy=_ledger(stepper.motion, standing, energies),
        evaluations=int(counts[2]),
        unconverged_steps=int(counts[1]),
        outcome=Outcome.STEPS_UNCONVERGED if counts[1] else Outcome.CONVERGED,
    )


def _refuse_missed_loads(standing: Stand, apart: NDArray[np.bool_], whole: Path) -> None:
    """Hold each body that nothing but its contacts holds to its load; `apart` (c, n) at every step."""
    record, names = standing.stepper.record, [law.name for law in standing.stepper.laws]
    touched = [displaced_in_contact(*each) for each in zip(record.approach, apart, strict=True)]
    sunk = standing.compliance * sum(float(np.abs(body.static_loads).sum()) for body in standing.bodies)
    for k, body in enumerate(standing.bodies):
        own = standing.steps.body == k
        if (free := free_motion(body)) is not None:
            shape, mass, load = free
            name, reach = names[int(np.argmax(own))], sunk + max(np.compress(own, touched))
            force = shape @ record.force[own]
            refuse_missed_load(name, force, load, mass, reach, whole.time_step, whole.settled)


def _ledger(motion: ContactsMotion, standing: Stand, before: tuple[float, float, float]) -> Ledger:
    """Balance of a run that started with these energies of structure, of bodies and of their loads, J."""
    structure, bodies, loads = (now - then for now, then in zip(standing.energies(), before, strict=True))
    return Ledger(
        loads=-loads,
        bodies=bodies,
        body_damping=float(motion.ledger[BODY_DAMPING]),
        structure=structure,
        structure_damping=float(motion.ledger[OVER_DAMPING]),
        contact=float(motion.ledger[CONTACT_WORK]),
        slope=float(motion.ledger[SLOPE_WORK]),
        contact_damping=float(motion.ledger[CONTACT_DAMPING]),
        throughput=float(motion.ledger[THROUGHPUT]),
    )
