"""Bodies roll over a structure on any number of contacts: contact lost, load carried."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from asperity.arguments import Array, ArrayLike, Flags, as_row
from asperity.errors import InputError
from asperity.laws.spec import Law
from asperity.progress import Progress
from asperity.rolling.assembly import body_loads, offsets_of
from asperity.rolling.course import Course
from asperity.rolling.driver import RolledMechanism, carried, recorded
from asperity.rolling.mechanism import Mechanism, RollingContact, Side
from asperity.rolling.soundness import STILL, free_motion, refuse_missed_load, steady, without_rounding
from asperity.rolling.stepper import Stepper
from asperity.rolling.trajectory import Path
from asperity.store import Checkpoint
from asperity.structures.body import Body
from asperity.structures.modal import Modal
from asperity.structures.rail_poles import RailBetween


@dataclass(frozen=True, eq=False, kw_only=True)
class RolledBodies(RolledMechanism):
    """Bodies have rolled over a structure on n contacts, numbered through in the order of the bodies."""

    positions: Array  # (n, t), of the contacts, m
    history_start: Array  # (n,), position of the first value of `history`, m
    in_contact: Flags  # (n, t), whether the surfaces touch
    # (n, 2), least and largest approach that each law was asked for, from its plane, m, in run-in and run
    visited: Array

    @property
    def vibrates(self) -> bool:
        """Whether the force of any contact varies."""
        return bool(np.ptp(self.contact_force, axis=1).any())

    @property
    def flights(self) -> list[tuple[Array, Array]]:
        """When each contact is lost, and how long for, s."""
        none = np.zeros(1, dtype=bool)
        step = self.time[1]
        found = []
        for touching in self.in_contact:
            edges = np.diff(np.concatenate([none, ~touching, none]).astype(np.int8))
            starts = np.flatnonzero(edges == 1)
            ends = np.flatnonzero(edges == -1)
            found.append((starts * step, (ends - starts) * step))
        return found

    def steadied(self) -> Self:
        """The same, where nothing vibrates without what rounding leaves of motion and forces."""
        if any(map(_varies, (self.contact_force, self.over_displacement, self.relative_displacement))):
            return self
        energy = self.energy if self.over_displacement.any() else self.energy.of_nothing
        names = (
            "contact_force",
            "history",
            "relative_displacement",
            "over_displacement",
            "rolling_displacement",
        )
        moved = tuple(map(steady, self.degrees_of_freedom))
        return without_rounding(self, *names, degrees_of_freedom=moved, energy=energy)


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
    """Roll bodies over a structure at a speed, constant or not, and keep what follows the run-in.

    All contacts feel each other, through the structure and through the bodies. Structure and bodies are
    advanced exactly for contact forces that are linear over a step; the forces at the end of each step solve
    all contact laws at once, each to 1e-10 of itself plus its load (laws that Python steps: 1e-6), to second
    order in the time step. The time of a step grows linearly with the number of contacts. A step that is too
    long to be stable is kept so by softened contacts, with a warning (`asperity.rolling.steps`).

    Parameters
    ----------
    over : Modal or RailBetween or None
        What is rolled over: a structure by its modes, a rail (`asperity.structures.rail_poles`), or None
        for a plane that does not move. Loads have rolled on it long enough to be steady; without a run-in,
        one that stands on a support has just come on. Modes without stiffness are at rest.
    bodies : sequence of Body
        What rolls, pressed down by its constant forces; contacts are numbered through the bodies.
    laws : sequence of Law
        One for each contact; it reads its texture at the position of its own contact.
    speed : float
        m/s, of all bodies; or an `asperity.speeds.SpeedCourse`, on a rail that was made for it by
        `rail_at`. Forces along the path, which it asks for, are not in the model.
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
    ahead, seen = (as_row(given) for given in (positions, sensors))
    path = whole.ahead(offsets_of(bodies, laws, ahead))
    structures = [] if over is None else [over]
    contacts = [
        RollingContact(law, way.places, tuple(Side(index, way) for index in range(len(structures))))
        for law, way in zip(laws, path.trajectories, strict=True)
    ]
    mechanism = Mechanism(structures, bodies, contacts)
    course = Course(mechanism, time_step, path.total, path.settled)
    stepper = carried(
        course,
        body_loads(bodies),
        sensors=_rows_of(over, seen),
        highest_frequency=highest_frequency,
        progress=progress,
        checkpoint=checkpoint,
    )
    _refuse_missed_loads(stepper, path)
    kept = slice(path.settled, None)
    return RolledBodies(
        **recorded(stepper),
        positions=path.positions[:, kept],
        history_start=path.starts,
        in_contact=stepper.touching[:, kept],
        visited=stepper.visited,
    )


def _rows_of(over: Modal | RailBetween | None, sensors: Array) -> Array:
    """Mode shapes at sensors (k, s) of places (k,), m."""
    if not isinstance(over, RailBetween | None):
        return over.shapes(sensors)[0] if sensors.size else np.zeros((0, len(over.natural_frequencies)))
    if sensors.size and over is None:
        raise InputError("sensors", f"{sensors.size} on a rigid plane", "none: it does not move")
    if sensors.size:
        allowed = "none: a rail is known under the contacts alone"
        raise InputError("sensors", f"{sensors.size} on a rail", allowed)
    return np.zeros((0, 0))


def _refuse_missed_loads(stepper: Stepper, path: Path) -> None:
    """Hold each body that nothing but its contacts holds to its load."""
    record = stepper.record
    of = stepper.system.body
    touched = []  # how far texture and contact displace bodies while they touch, m
    for approach, on in zip(record.relative_displacement, stepper.touching, strict=True):
        touched.append(float(np.ptp(approach[on])) if on.any() else 0.0)
    sunk = stepper.softest * sum(float(np.abs(body.static_loads).sum()) for body in stepper.course.bodies)
    for k, body in enumerate(stepper.course.bodies):
        own = of == k
        if (free := free_motion(body)) is not None:
            shape, mass, load = free
            name = stepper.course.laws[int(np.argmax(own))].name
            reach = sunk + max(np.compress(own, touched))
            force = shape @ record.contact_force[own]
            refuse_missed_load(name, force, load, mass, reach, path.time_step, path.settled)


def _varies(record: Array) -> bool:
    """Whether any row of a record (..., n) varies by more than rounding."""
    return bool((np.ptp(record, axis=-1) > STILL * np.abs(record).max(axis=-1)).any())
