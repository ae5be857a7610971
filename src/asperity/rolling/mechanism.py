"""Contacts between any two of bodies and structures, each with a path of its own along each side."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import numpy as np
from scipy.linalg import block_diag

from asperity.arguments import Array, NDArray, positive, require
from asperity.kernels.pointforce import TABLE, Prepared, evaluate_all
from asperity.kernels.stepping import Motion, System
from asperity.laws.spec import Law, SteppedLaw, settles
from asperity.progress import Progress
from asperity.rolling import assembly, steps
from asperity.rolling.ground import Ground, no_channels
from asperity.rolling.ledger import Ledger, ledger_of
from asperity.rolling.resolution import PER_MODE
from asperity.rolling.soundness import warn_of_counts
from asperity.rolling.stepper import Stepper, sizes_of, stacked
from asperity.store import Checkpoint
from asperity.structures.body import Body
from asperity.structures.modal import HIGHEST, Modal
from asperity.written_numbers import count_of

Values = Callable[[range], Array]
"""Values at time steps, counted from the start of the run-in: one for each."""
LOOKED_AT = 64
"""Steps at which compliances are looked at."""


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Where a contact is on a structure at time steps, and how fast it goes there."""

    places: Values  # m, or rad of a ring
    rates: Values  # m/s, or rad/s


@dataclass(frozen=True, eq=False)
class Side:
    """A structure on one side of a contact, which opens with its displacement times the sign."""

    structure: int
    trajectory: Trajectory
    sign: float = 1.0


@dataclass(frozen=True, eq=False)
class Contact:
    """A contact of a body with structures, or of structures with each other."""

    law: Law
    positions: Values  # where the law is laid out, m; of one that takes several, a column for each
    sides: tuple[Side, ...] = ()
    heights: Values | None = None  # what is there beside the law's texture, m, positive out of the material


@dataclass(frozen=True, eq=False)
class Mechanism:
    """Bodies and structures, and the contacts between them.

    The contacts of the bodies come first, numbered through the bodies as in `roll_bodies`; those beyond them
    have structures on both sides. A body between two structures has two contacts; bodies that touch each
    other are one `Body` with both of their coordinates, whose contact is opened by the one and the other.

    Parameters
    ----------
    structures : sequence of Modal
        By their modes, as `asperity.structures.modal` or `asperity.structures.ring`; rotating frames too.
    bodies : sequence of Body
        Their `places` along the path are not looked at.
    contacts : sequence of Contact
        One for each contact.
    pressed : sequence of ndarray, optional
        Constant forces on the modes of each structure.
    """

    structures: Sequence[Modal]
    bodies: Sequence[Body]
    contacts: Sequence[Contact]
    pressed: Sequence[Array] = field(default_factory=tuple)

    def __post_init__(self) -> None:
        touching = sum(len(body.places) for body in self.bodies)
        short = f"{len(self.contacts)} for {count_of(touching, 'contact')} of the bodies"
        allowed = "one for each contact of a body, or more"
        require(len(self.contacts) >= max(touching, 1), "contacts", short, allowed)
        last = len(self.structures) - 1
        for contact in self.contacts:
            known = all(0 <= side.structure <= last for side in contact.sides)
            require(known, "structure of a contact", "one that is not there", f"0 to {last}")

    @property
    def first_modes(self) -> NDArray[np.int64]:
        """Place of each structure among all modes, and their number at the end."""
        counts = [len(each.natural_frequencies) for each in self.structures]
        return np.concatenate([[0], np.cumsum(counts, dtype=np.int64)])

    @property
    def constant(self) -> Array:
        """Constant forces on all modes (s,), or none."""
        return np.concatenate([np.zeros(0), *self.pressed])

    def row(self, structure: int, values: Array) -> Array:
        """Row over all modes (s,) of values for the modes of one structure."""
        first = self.first_modes
        row = np.zeros(first[-1])
        row[first[structure] : first[structure + 1]] = values
        return row

    def still(self) -> Sequence[Body]:
        """Its bodies, and one that does not move for the contacts beyond them."""
        beyond = len(self.contacts) - sum(len(body.places) for body in self.bodies)
        if not beyond:
            return self.bodies
        none = np.zeros((1, 1))
        rest = Body(np.ones((1, 1)), none, none, np.zeros((beyond, 1)), np.zeros(1), np.zeros(beyond))
        return [*self.bodies, rest]


@dataclass(eq=False)
class _OnContacts:
    """The course of a mechanism: everything is laid out piece by piece."""

    mechanism: Mechanism
    time_step: float
    total: int

    def __post_init__(self) -> None:
        self.contacts = len(self.mechanism.contacts)
        first = [contact.law.prepare(contact.positions(range(1))) for contact in self.mechanism.contacts]
        solved = not all(isinstance(law, Prepared) for law in first)
        # laws that are solved in every step remember where they were: all are laid out on all the way
        self.whole = self._laid(range(self.total + 1)) if solved else []
        # approach of each contact that is within its data at all steps laid out; and where these begin
        self.within = np.full(self.contacts, np.inf)
        self.begun = self.total

    def place(self, contact: int, step: int) -> float:
        """Position of a contact at a step, m."""
        return float(self.mechanism.contacts[contact].positions(range(step, step + 1)).flat[0])

    def shapes_into(self, first: int, shapes: Array, slopes: Array) -> None:
        """Write mode shapes under the contacts and their rates (steps, n, s), from a step on."""
        starts = self.mechanism.first_modes
        steps = range(first, first + len(shapes))
        shapes[:], slopes[:] = 0.0, 0.0
        for k, contact in enumerate(self.mechanism.contacts):
            for side in contact.sides:
                modes = slice(starts[side.structure], starts[side.structure + 1])
                of = self.mechanism.structures[side.structure]
                found, rising = of.shapes(side.trajectory.places(steps))
                shapes[:, k, modes] += side.sign * found
                slopes[:, k, modes] += side.sign * rising * side.trajectory.rates(steps)[:, None]

    def _laid(self, steps: range) -> list[Any]:
        return [_laid(contact, steps) for contact in self.mechanism.contacts]

    def at_start(self) -> Sequence[Prepared | SteppedLaw]:
        """Laws whose first step is the first of all."""
        return self.whole or self._laid(range(1))

    def laid(self, first: int, stop: int) -> Any:
        """The same, for the compiled kernel."""
        prepared = self._laid(range(first, stop))
        lowest = [law.planes.min() + (0.0 if law.form == TABLE else law.values.min()) for law in prepared]
        self.within = np.minimum(
            self.within, [law.upper + h for law, h in zip(prepared, lowest, strict=True)]
        )
        self.begun = min(self.begun, first)
        return Prepared(**stacked(prepared, Prepared._fields)), sizes_of(prepared)


def _laid(contact: Contact, steps: range) -> Any:
    """The law of a contact, `Prepared` or a `SteppedLaw`, whose textures are raised by its heights."""
    law = contact.law.prepare(contact.positions(steps))
    if contact.heights is None:
        return law
    heights = contact.heights(steps)
    return law._replace(planes=law.planes - heights) if isinstance(law, Prepared) else _raised(law, heights)


def _raised(law: SteppedLaw, heights: Array) -> SimpleNamespace:
    """A law that is solved in every step, as it is where bodies are closer by heights (steps,), m."""

    def evaluate(step: int, approach: float) -> tuple[float, float]:
        return law.evaluate(step, approach + float(heights[step]))

    def settle(step: int, approach: float, compliance: float) -> float:
        assert settles(law)
        return law.settle(step, approach + float(heights[step]), compliance)

    other = {name: getattr(law, name) for name in ("accept", "state", "restore", "warn_of_flaws")}
    return SimpleNamespace(evaluate=evaluate, **other, **({"settle": settle} if settles(law) else {}))


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
    course = _OnContacts(mechanism, h, settled + recorded)
    seen = np.zeros((0, mechanism.first_modes[-1])) if sensors is None else np.asarray(sensors, dtype=float)
    looked_at = np.unique(np.linspace(0, course.total, LOOKED_AT).astype(int)).tolist()
    bodies = mechanism.still()
    laws = [contact.law for contact in mechanism.contacts]
    prepared = course.at_start()
    ground = _ground(course, seen, looked_at)
    damping = np.array([law.damping for law in laws])
    loads = np.full(course.contacts, positive("load (N)", load))
    system = assembly.system_of(ground, bodies, loads, h, 1.0, mechanism.constant)
    # with contacts that are soft enough for the time step
    given = assembly.softened(_start, ground, bodies, system, prepared, damping, highest_frequency)
    stepper = Stepper(course, bodies, laws, course.whole, *given, np.inf, displacements=True)
    energies = stepper.energies()
    stepper.run(progress, checkpoint)
    _warn(stepper, course)
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
    course = _OnContacts(mechanism, 1.0, 0)
    bodies = mechanism.still()
    ground = _ground(course, np.zeros((0, mechanism.first_modes[-1])), [step])
    system = assembly.system_of(ground, bodies, np.full(course.contacts, load), 1.0, 1.0, mechanism.constant)
    laws = [_laid(contact, range(step, step + 1)) for contact in mechanism.contacts]
    return _start(ground, bodies, system, laws)[1].displacement[: mechanism.first_modes[-1]]


def _ground(course: _OnContacts, sensors: Array, looked_at: Sequence[int]) -> Ground:
    """All structures as one: what they are to the contacts at the first of some steps, and at worst."""
    mechanism, n = course.mechanism, course.contacts
    none = np.zeros(0)
    of = mechanism.structures
    natural = 2.0 * np.pi * np.concatenate([none, *(each.natural_frequencies for each in of)])
    ratios = np.concatenate([none, *(each.damping_ratios for each in of)])
    each = steps.alternating_of_modes(steps.resolved_step(natural, ratios, course.time_step))
    shapes, slopes = np.zeros((2, 1, n, natural.size))
    least = 0.0
    for step in reversed(looked_at):  # the first is kept
        course.shapes_into(step, shapes, slopes)
        least = min(least, float(np.linalg.eigvalsh((shapes[0] * each) @ shapes[0].T).min()))
    frequencies = natural / (2.0 * np.pi)
    followed = frequencies[frequencies <= HIGHEST]
    limit = "the highest mode of a structure", float(followed.max(initial=0.0)), PER_MODE
    under = (shapes[0], slopes[0])
    channels = no_channels(n)
    return Ground(natural, ratios, *under, sensors, channels, np.inf, least, least, limit, np.zeros((n, n)))


def _start(
    ground: Ground, bodies: Sequence[Body], system: System, prepared: Sequence[Prepared | SteppedLaw]
) -> tuple[Array, Motion]:
    """Stiffnesses of the contacts at rest (n,), N/m, and the state that goes on from there."""
    n = len(system.loads)
    shapes = assembly.shapes_at_contacts(ground, system)
    rows = block_diag(*(body.contacts for body in bodies))
    answers = shapes.any(axis=0) | (system.stiffness > 0.0)  # others there is nothing to say of
    held = np.diag(np.where(answers, system.stiffness, 1.0))
    matrix = block_diag(held, *(body.stiffness for body in bodies), np.eye(n))
    constant = np.pad(system.constant, (0, shapes.shape[1] - len(system.constant)))
    pressing = np.concatenate([-constant, *(body.pressing for body in bodies), np.zeros(n)])
    every = np.hstack([shapes, rows, np.diag(np.sqrt(system.softening))])
    laws, relative = assembly.evaluations(prepared)
    given = matrix, pressing, every, np.zeros(n), system.loads
    x, force, approach, stiffness = assembly.equilibrium(*given, laws, relative)
    motion = assembly.at_zero(system)
    count = shapes.shape[1]
    motion.displacement[:] = x[:count]
    motion.push[:] = constant + force @ shapes
    first = count
    for own, body in zip(motion.core, bodies, strict=True):
        own[: len(body.mass)] = x[first : first + len(body.mass)]
        first += len(body.mass)
    motion.force[:] = motion.trial[:] = motion.elastic[:] = force
    motion.approach[:] = approach
    return stiffness, motion


CHECKED = 2**14
"""Steps at once of which is asked whether the laws went beyond what they were made for."""


def _warn(stepper: Stepper, course: _OnContacts) -> None:
    """Warn of steps that missed the tolerance, and of laws that were continued beyond their data."""
    counts, seen = stepper.motion.counts, stepper.record.relative_displacement
    seen = seen - stepper.system.softening[:, None] * stepper.record.contact_force
    beyond = np.zeros(course.contacts, dtype=np.int64)
    doubted = (seen.max(axis=1) > course.within) | (course.begun > 0)  # a run taken up has not laid out all
    for solved in stepper.stepped.values():
        solved.warn_of_flaws()
    for k in np.flatnonzero(doubted & [k not in stepper.stepped for k in range(len(doubted))]).tolist():
        for first in range(0, course.total + 1, CHECKED):
            steps = range(first, min(first + CHECKED, course.total + 1))
            law = _laid(course.mechanism.contacts[k], steps)
            beyond[k] += evaluate_all(law, np.ascontiguousarray(seen[k, first : steps.stop]), 0)[2]
    warn_of_counts([law.name for law in stepper.laws], counts, beyond.tolist(), seen.shape[1])
