"""Bodies roll over a structure on any number of contacts, and what is kept of it.

How a run went is told: contact lost, load carried, steps not converged, laws continued beyond their data.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from asperity import errors
from asperity.arguments import Array, ArrayLike, NDArray
from asperity.kernels import pointforce, stepping
from asperity.laws.spec import Law, SteppedLaw
from asperity.progress import Progress
from asperity.rolling import assembly, ground, steps
from asperity.rolling.stepper import OnPaths, Stepper
from asperity.store import Checkpoint
from asperity.structures.body import Body
from asperity.structures.modal import Modal
from asperity.structures.rail_poles import RailBetween
from asperity.written_numbers import engineering, rounded


@dataclass(frozen=True)
class Ledger:
    """Energies gained and work done since the start, J, in run-in and run.

    The work of the loads, the constant forces that press the bodies down, equals the sum of kinetic and
    elastic energy gained by bodies and structure, of what their damping dissipated, of the work on the
    contacts (stored, damped, less what textures feed in), and of that against the slope of the bent
    structure, given up to the drive that keeps the speed; up to what the time step leaves open: the integrals
    are taken by the trapezoidal rule from the motion, the energies from the states at start and end. On a
    rail, of which displacements alone are known, the contacts hold what goes into contacts and rail together,
    and the terms of the structure are zero.
    """

    shares: dict[str, float]  # by their names in results; the first equals the sum of the others
    contact_damping: float  # what the dampers of the contacts took of their share
    throughput: float  # time integral of the moduli of the powers at both sides of all contacts

    @property
    def of_nothing(self) -> Ledger:
        """The same where nothing was gained or done."""
        return Ledger(dict.fromkeys(self.shares, 0.0), 0.0, 0.0)

    @property
    def residual(self) -> float:
        """What the balance leaves open, relative to the throughput."""
        loads, *others = self.shares.values()
        return abs(loads - sum(others)) / self.throughput if self.throughput > 0.0 else 0.0


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
    # (c, 2), least and largest approach that each law was asked for, from its plane, m, in run-in and run
    visited: Array
    softening: Array  # (c,), compliance that the time step puts in series with the contacts, m/N
    energy: Ledger  # where the work of the loads went, in run-in and run
    evaluations: int  # of the laws, in run-in and run
    unconverged_steps: int  # time steps in which a contact force missed the tolerance, of run-in and run
    outcome: errors.Outcome  # whether all steps converged

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
    whole = ground.Path.laid(start, speed, time_step, duration, settling)
    ahead, seen = (np.atleast_1d(np.asarray(given, dtype=float)) for given in (positions, sensors))
    path = whole.ahead(assembly.offsets_of(bodies, laws, ahead))
    under = ground.ground_of(over, path, seen)
    system = assembly.system_of(under, bodies, assembly.body_loads(bodies), time_step, speed)
    prepared = [law.prepare(at) for law, at in zip(laws, path.positions, strict=True)]
    given, damping = (under, bodies, system, prepared), np.array([law.damping for law in laws])
    at_rest = partial(assembly.start_at_rest, entering=not path.settled)
    started = assembly.softened(at_rest, *given, damping, highest_frequency)
    stepper = Stepper(OnPaths(over, path, prepared), bodies, laws, prepared, *started, under.softest)
    energies = stepper.energies()
    try:
        stepper.run(progress, checkpoint)
    finally:  # why a motion may have run away
        ground.warn_if_bent(over, stepper.record.over_displacement)
    return _rolled(stepper, path, energies)


def _rolled(stepper: Stepper, path: ground.Path, energies: tuple[float, float, float]) -> RolledBodies:
    """What is kept of a run that started with these energies."""
    record = stepper.record
    system = stepper.system
    counts = stepper.motion.counts
    kept = slice(path.settled, None)
    softened = system.softening[:, None] * record.contact_force
    seen = record.relative_displacement - softened
    apart = np.array(list(map(flying, stepper.prepared, record.contact_force, seen)))
    beyond = [
        int(pointforce.evaluate_all(law, at, 0)[2]) if isinstance(law, pointforce.Prepared) else 0
        for law, at in zip(stepper.prepared, seen, strict=True)
    ]
    for law in stepper.stepped.values():
        law.warn_of_flaws()
    warn_of_counts([law.name for law in stepper.laws], counts, beyond, seen.shape[1])
    _refuse_missed_loads(stepper, path, apart)
    apart = apart[:, kept]
    records = {name: value[..., kept] for name, value in record._asdict().items() if name != "displacement"}
    cores = zip(stepper.bodies, records.pop("core"), strict=True)
    return RolledBodies(
        **records,
        time=path.time,
        positions=path.positions[:, kept],
        body=system.body,
        history=record.contact_force,
        history_start=path.starts,
        degrees_of_freedom=tuple(core[: len(body.mass)] for body, core in cores),
        in_contact=~apart,
        visited=np.array(list(map(_visited, stepper.prepared, seen))),
        softening=system.softening,
        energy=ledger_of(stepper, energies),
        evaluations=int(counts[2]),
        unconverged_steps=int(counts[1]),
        outcome=errors.Outcome.STEPS_UNCONVERGED if counts[1] else errors.Outcome.CONVERGED,
    )


def _visited(prepared: pointforce.Prepared | SteppedLaw, approach: Array) -> tuple[float, float]:
    """Least and largest approach from the plane of a law, m; all there are, of one that Python steps."""
    if not isinstance(prepared, pointforce.Prepared):
        return -np.inf, np.inf
    from_plane = approach - prepared.planes
    return float(from_plane.min()), float(from_plane.max())


def _refuse_missed_loads(stepper: Stepper, path: ground.Path, apart: NDArray[np.bool_]) -> None:
    """Hold each body that nothing but its contacts holds to its load; `apart` (c, n) at every step."""
    record = stepper.record
    of = stepper.system.body
    touched = []  # how far texture and contact displace bodies while they touch, m
    for approach, off in zip(record.relative_displacement, apart, strict=True):
        touched.append(0.0 if off.all() else float(np.ptp(approach[~off])))
    sunk = stepper.softest * sum(float(np.abs(body.static_loads).sum()) for body in stepper.bodies)
    for k, body in enumerate(stepper.bodies):
        own = of == k
        if (free := free_motion(body)) is not None:
            shape, mass, load = free
            name = stepper.laws[int(np.argmax(own))].name
            reach = sunk + max(np.compress(own, touched))
            force = shape @ record.contact_force[own]
            refuse_missed_load(name, force, load, mass, reach, path.time_step, path.settled)


def ledger_of(stepper: Stepper, before: tuple[float, float, float]) -> Ledger:
    """Balance of a run that started with these energies of structure, of bodies and of their loads, J."""
    structure, bodies, loads = (now - then for now, then in zip(stepper.energies(), before, strict=True))
    ledger = stepper.motion.ledger.tolist()
    shares = {
        "work of the loads": -loads,
        "bodies": bodies,
        "damping of the bodies": ledger[stepping.BODY_DAMPING] + _missed_of_dampers(stepper),
        "structure": structure,
        "damping of the structure": ledger[stepping.OVER_DAMPING],
        "contacts": ledger[stepping.CONTACT_WORK],
        "slope of the structure": ledger[stepping.SLOPE_WORK],
    }
    return Ledger(shares, ledger[stepping.CONTACT_DAMPING], ledger[stepping.THROUGHPUT])


def _missed_of_dampers(stepper: Stepper) -> float:
    """Energy, J, that stiff dampers of bodies took beyond what the ledger has of them."""
    h = stepper.course.time_step
    of = stepper.system.body
    record = stepper.record
    missed = 0.0
    for k, (body, core, rates) in enumerate(zip(stepper.bodies, record.core, stepper.started, strict=True)):
        if steps.stiff_dampers(body, h):
            count = len(body.mass)
            force = record.contact_force[of == k]
            missed += steps.missed_by_powers(body, h, core[:count], rates[:count], force)
    return missed


def flying(prepared: pointforce.Prepared | SteppedLaw, force: Array, approach: Array) -> NDArray[np.bool_]:
    """Whether the bodies are apart at each step, by force, N, and approach, m, (n,) each.

    Never for a contact that can pull.
    """
    if isinstance(prepared, pointforce.Prepared):
        if prepared.bilateral:
            return np.zeros(force.shape, dtype=bool)
        if prepared.damped_in_flight:
            force = pointforce.evaluate_all(prepared, approach, 0)[0]
    return np.asarray(force <= 0.0)


STILL = 1e-9
"""Share of forces and displacements by which they vary where nothing vibrates: each is found to 1e-10."""


def _varies(record: Array) -> bool:
    """Whether any row of a record (..., n) varies by more than rounding."""
    return bool((np.ptp(record, axis=-1) > STILL * np.abs(record).max(axis=-1)).any())


def steady(record: Array) -> Array:
    """A record (..., n) that keeps its last values throughout."""
    return np.repeat(record[..., -1:], record.shape[-1], axis=-1)


def without_rounding(run: RolledBodies) -> RolledBodies:
    """The same, of a run in which nothing vibrates without what rounding leaves of motion and forces."""
    if any(map(_varies, (run.contact_force, run.over_displacement, run.relative_displacement))):
        return run
    energy = run.energy if run.over_displacement.any() else run.energy.of_nothing
    names = "contact_force", "history", "relative_displacement", "over_displacement", "rolling_displacement"
    records: dict[str, Any] = {name: steady(getattr(run, name)) for name in names}
    return replace(
        run,
        **records,
        degrees_of_freedom=tuple(map(steady, run.degrees_of_freedom)),
        acceleration=np.zeros_like(run.acceleration),
        energy=energy,
    )


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


def warn_of_counts(
    names: Sequence[str], counts: NDArray[np.int64], beyond: Sequence[int], recorded: int
) -> None:
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
