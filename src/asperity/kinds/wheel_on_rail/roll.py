"""A wheel rolls along a track: the moving contact force couples them, step by step, compiled."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.rail import RailMotion, RailRecord, Vehicle, direct_at, preload
from asperity.kinds.wheel_on_rail.stepper import RailStepper
from asperity.laws.base import Law
from asperity.progress import Progress
from asperity.rolling.path import Path, count_steps
from asperity.rolling.rail import PRELOAD, RolledRail
from asperity.rolling.rolled import Limit, Rolled, roll_along
from asperity.rolling.wheel import RollingWheel, wheel_step
from asperity.store import Checkpoint
from asperity.structures.moving_kernel import MovingKernel
from asperity.structures.rail_poles import RailPoles, over_the_bay
from asperity.structures.wheel import Wheel


@dataclass(frozen=True, eq=False)
class WheelRolling(Rolled):
    """A wheel has rolled along a track; positions count from the sleeper at zero."""

    wheel_displacement: NDArray[np.float64]  # (n,), at the contact, m, positive downwards
    rail_displacement: NDArray[np.float64]  # (n,), at the contact, m, positive downwards
    history: NDArray[np.float64]  # (m,), contact force of run-in and run, N
    history_start: float  # position of its first value, m


def roll_wheel(
    rail: RailPoles | MovingKernel,
    wheel: Wheel,
    law: Law,
    *,
    start: float,
    duration: float,
    settling: float,
    highest_frequency: float | None = None,
    progress: Progress | None = None,
    checkpoint: Checkpoint | None = None,
) -> WheelRolling:
    """Roll a wheel along a track at constant speed, and keep what follows the run-in.

    The track is given for one speed and time step, as poles, or scattered. The contact is at `start` at time
    zero, after the run-in, m from a sleeper; the law reads its texture at that coordinate. Times in s. The
    time step is checked against the highest frequency of interest, Hz. A checkpoint keeps the state about
    every 10 s, at the end and when interrupted, to go on from there.

    Before the run-in the load alone has rolled long enough for the rail to be steady. Rail and wheel are
    advanced exactly for a contact force that varies linearly over a step, and the force at the end of each
    step solves the contact law implicitly, to second order. A step that is too long to be stable is kept so
    by a softened contact, with a warning (`asperity.rolling.stability`). Warned of are also a coarse time
    step, a law that was continued beyond its data and forces that missed the tolerance.
    """
    over, rolls = RolledRail(rail), RollingWheel(wheel)
    kernel, step = over.kernel, over.kernel.time_step
    steps, settled = count_steps(duration, settling, step)
    origin = start - kernel.speed * step * settled
    positions = np.asarray(origin + kernel.speed * step * np.arange(settled + steps + 1))
    path = Path(positions, kernel.speed, step, settled)

    def stand(approach: float, softening: float) -> RailStepper:
        return RailStepper(*_at_rest(rail, wheel, path, approach, softening), path)

    def limits(stiffness: float) -> Iterator[Limit]:
        mass = kernel.track.mass_per_length * kernel.spacing
        yield "the highest frequency asked for", highest_frequency or 0.0, 5.0
        yield "the passing of sleepers v/L", kernel.speed / kernel.spacing, 20.0
        yield "the contact resonance on a bay of rail", np.sqrt(stiffness / mass) / (2.0 * np.pi), 5.0

    thrown = rolls.alternating_compliance(path)  # an endless rail carries impacts away
    rolled, stepper = roll_along(
        path,
        law,
        rolls.load,
        stand,
        alternating=(over.alternating_compliance(path) + thrown, thrown),
        limits=limits,
        free=(wheel.mass, float(kernel.weights.sum(axis=1).max())),
        progress=progress,
        checkpoint=checkpoint,
    )
    record = stepper.record
    return WheelRolling(
        **vars(rolled),
        wheel_displacement=record.wheel[settled:],
        rail_displacement=record.rail[settled:],
        history=record.force,
        history_start=float(origin),
    )


def _vehicle(rail: RailPoles | MovingKernel, wheel: Wheel, origin: float, softening: float) -> Vehicle:
    """Constants of wheel and rail for the kernels."""
    kernel = RolledRail(rail).kernel
    step = kernel.time_step
    poles, residues, scattered = np.zeros(0, complex), np.zeros((1, 0), complex), kernel.weights
    if isinstance(rail, RailPoles):
        poles, residues, scattered = rail.poles, over_the_bay(rail.residues), np.zeros((0, 0))
    decay, before, now = wheel_step(wheel, step)
    return Vehicle(
        np.concatenate([poles.real, poles.imag]),
        np.concatenate([residues.real, residues.imag], axis=1),
        over_the_bay(kernel.weights[:, 0]),
        np.ascontiguousarray(scattered),
        decay,
        before,
        now,
        float(2.0 * now.real.sum()),
        float(wheel.mass),
        float(wheel.load),
        float(step),
        float(softening),
        float(origin / kernel.spacing),
        float(kernel.speed * step / kernel.spacing),
    )


def _at_rest(
    rail: RailPoles | MovingKernel, wheel: Wheel, path: Path, approach: float, softening: float
) -> tuple[Vehicle, RailMotion, RailRecord]:
    """Constants, state and records with the load rolling steadily on a smooth rail."""
    vehicle = _vehicle(rail, wheel, float(path.positions[0]), softening)
    closer = approach + softening * wheel.load
    kernel, samples = RolledRail(rail).kernel, len(path.positions)
    states, taps = len(vehicle.decay), vehicle.scattered.shape[1]
    flexible = -wheel.load * (-wheel.residues / wheel.poles)
    motion = RailMotion(
        np.zeros(states),
        np.zeros(taps),
        np.asarray(flexible, dtype=complex),
        np.zeros(2),
        np.full(2, wheel.load),
        np.full(2, approach),
        np.zeros(2),
        np.zeros(3, dtype=np.int64),
    )
    now, before = preload(vehicle, motion, wheel.load, int(PRELOAD * kernel.weights.shape[1]))
    direct = float(direct_at(vehicle, 0))
    motion.wheel[0] = now + direct * wheel.load + closer - 2.0 * flexible.real.sum()
    motion.wheel[1] = (now - before) / vehicle.time_step
    record = RailRecord(*(np.zeros(samples) for _ in RailRecord._fields))
    record.force[0], record.approach[0] = wheel.load, closer
    record.rail[0] = now + direct * wheel.load
    record.wheel[0] = record.rail[0] + closer
    return vehicle, motion, record
