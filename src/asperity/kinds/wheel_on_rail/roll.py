"""A wheel rolls along a track: the moving contact force couples them, step by step."""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from asperity.errors import CoarseSamplingWarning, InputError, Outcome
from asperity.kernels.pointforce import Prepared
from asperity.kernels.rail import RailMotion, RailRecord, Vehicle, direct_at, preload
from asperity.kinds.wheel_on_rail.stepper import RailStepper
from asperity.laws.base import Law
from asperity.progress import Progress
from asperity.rolling.equilibrium import static_approach
from asperity.rolling.events import ContactLoss, contact_losses
from asperity.rolling.outcome import STEPPED_EQUILIBRIUM, evaluation, flying, warn_after
from asperity.rolling.stability import (
    largest_force,
    largest_stiffness,
    rail_and_wheel,
    softening,
    wheel_step,
)
from asperity.rolling.stepping import restore, run
from asperity.store import Checkpoint
from asperity.structures.moving_kernel import MovingKernel
from asperity.structures.rail_poles import RailPoles, over_the_bay
from asperity.structures.wheel import Wheel

PRELOAD = 2.0  # kernel lengths for which the load has rolled before the run


@dataclass(frozen=True, eq=False)
class WheelRolling:
    """A wheel has rolled along a track.

    Parameters
    ----------
    time : ndarray (n,)
        s, uniform from zero, after the run-in.
    position : ndarray (n,)
        Of the contact, m from the sleeper at zero.
    contact_force : ndarray (n,)
        N, compression positive.
    relative_displacement : ndarray (n,)
        Approach of the mean surfaces, m, positive closing.
    wheel_displacement, rail_displacement : ndarray (n,)
        At the contact, m, positive downwards.
    in_contact : ndarray (n,) of bool
        Whether the bodies touch.
    contact_loss : list of ContactLoss
        Flights.
    evaluations, unconverged_steps : int
        Evaluations of the law, and time steps whose contact force missed the tolerance, of run-in and run.
    outcome : Outcome
        Whether all steps converged.
    history : ndarray (m,)
        Contact force of run-in and run, N.
    history_start : float
        Position of the first value of `history`, m.
    """

    time: NDArray[np.float64]
    position: NDArray[np.float64]
    contact_force: NDArray[np.float64]
    relative_displacement: NDArray[np.float64]
    wheel_displacement: NDArray[np.float64]
    rail_displacement: NDArray[np.float64]
    in_contact: NDArray[np.bool_]
    contact_loss: list[ContactLoss]
    evaluations: int
    unconverged_steps: int
    outcome: Outcome
    history: NDArray[np.float64]
    history_start: float

    @property
    def contact_loss_share(self) -> float:
        """Share of the time out of contact."""
        return 1.0 - float(np.mean(self.in_contact))

    @property
    def longest_loss(self) -> float:
        """Duration of the longest flight, s."""
        return max((event.duration for event in self.contact_loss), default=0.0)


def roll(
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

    Before the run-in the load alone has rolled long enough for the rail to be steady. Rail and wheel
    are advanced exactly for a contact force that varies linearly over a step, and the force at the end of
    each step solves the contact law implicitly, to second order. A step that is too long to be stable is kept
    so by a softened contact, with a warning (`asperity.rolling.stability`).

    Parameters
    ----------
    rail : RailPoles or MovingKernel
        The track for one speed and time step, as poles, or scattered.
    wheel : Wheel
        Mass, load and resonances.
    law : Law
        The contact. It reads its texture at the position along the rail.
    start : float
        Position of the contact at time zero, m from a sleeper.
    duration : float
        s.
    settling : float
        Run-in before time zero, s; not kept.
    highest_frequency : float, optional
        Highest frequency of interest, Hz, checked against the time step.
    progress : callable, optional
        Called with steps done, steps in all, and a message.
    checkpoint : Checkpoint, optional
        Where to keep the state about every 10 s, at the end and when interrupted, and to go on from.

    Returns
    -------
    WheelRolling
        Time histories and losses of contact.

    Raises
    ------
    InputError
        If a number is not positive, or the checkpoint is of another run.
    ComputationError
        If the load cannot be carried, or the motion runs away.

    Warns
    -----
    CoarseSamplingWarning
        If the time step is coarse for the contact resonance or the highest frequency.
    ExtrapolationWarning
        If the law was continued beyond its data.
    UnconvergedWarning
        If contact forces missed the tolerance.
    """
    kernel = rail.kernel if isinstance(rail, RailPoles) else rail
    step = kernel.time_step
    steps, settled = _steps(duration, settling, step)
    origin = start - kernel.speed * step * settled
    positions = np.asarray(origin + kernel.speed * step * np.arange(settled + steps + 1))
    prepared = law.prepare(positions)
    relative = 1e-9 if isinstance(prepared, Prepared) else STEPPED_EQUILIBRIUM
    approach, stiffness = static_approach(evaluation(prepared, 0), wheel.load, relative)
    _warn_if_coarse(step, stiffness, kernel, highest_frequency)
    stiffest, strongest = largest_stiffness(prepared, (approach, stiffness))
    softer = softening(rail_and_wheel(kernel, wheel), stiffest, law.damping, stiffness, step)
    stepper = RailStepper(*_at_rest(rail, wheel, origin, approach, softer, len(positions)), positions)
    restore(checkpoint, stepper, prepared)
    run(stepper, prepared, law.damping, largest_force(wheel.load, strongest), progress, checkpoint)
    record, motion = stepper.record, stepper.motion
    seen = record.approach - softer * record.force
    apart = flying(prepared, record.force, seen)[settled:]
    warn_after(law.name, motion.counts, prepared, seen)
    return WheelRolling(
        time=np.asarray(step * np.arange(steps + 1)),
        position=positions[settled:],
        contact_force=record.force[settled:],
        relative_displacement=record.approach[settled:],
        wheel_displacement=record.wheel[settled:],
        rail_displacement=record.rail[settled:],
        in_contact=~apart,
        contact_loss=contact_losses(apart, step),
        evaluations=int(motion.counts[2]),
        unconverged_steps=int(motion.counts[1]),
        outcome=Outcome.STEPS_UNCONVERGED if motion.counts[1] else Outcome.CONVERGED,
        history=record.force,
        history_start=float(origin),
    )


def _steps(duration: float, settling: float, step: float) -> tuple[int, int]:
    """Steps of the run and of its run-in, checked."""
    if not (np.isfinite(duration) and duration > 0.0):
        raise InputError("duration (s)", duration, "a finite positive number")
    if not (np.isfinite(settling) and settling >= 0.0):
        raise InputError("settling (s)", settling, "zero or a finite positive number")
    steps = int(np.floor(duration / step * (1.0 + 1e-12)))
    if steps < 1:
        raise InputError("duration (s)", duration, f"at least one time step of {step:.6g} s")
    return steps, int(np.floor(settling / step * (1.0 + 1e-12)))


def _vehicle(rail: RailPoles | MovingKernel, wheel: Wheel, origin: float, softening: float) -> Vehicle:
    """Constants of wheel and rail for the kernels."""
    kernel = rail.kernel if isinstance(rail, RailPoles) else rail
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
    rail: RailPoles | MovingKernel,
    wheel: Wheel,
    origin: float,
    approach: float,
    softening: float,
    samples: int,
) -> tuple[Vehicle, RailMotion, RailRecord]:
    """Constants, state and records with the load rolling steadily on a smooth rail."""
    vehicle, closer = _vehicle(rail, wheel, origin, softening), approach + softening * wheel.load
    kernel = rail.kernel if isinstance(rail, RailPoles) else rail
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


def _warn_if_coarse(
    step: float, stiffness: float, kernel: MovingKernel, highest_frequency: float | None
) -> None:
    """Compare the time step with the frequencies and lengths that it must resolve."""
    limits = [
        ("the highest frequency asked for", highest_frequency or 0.0, 5.0),
        ("the passing of sleepers v/L", kernel.speed / kernel.spacing, 20.0),
    ]
    rail_mass = kernel.track.mass_per_length * kernel.spacing
    limits.append(
        ("the contact resonance on a bay of rail", np.sqrt(stiffness / rail_mass) / (2 * np.pi), 5.0)
    )
    for what, frequency, least in limits:
        if frequency * step * least > 1.0:
            warnings.warn(
                f"{what}, {frequency:.4g} Hz, has {1.0 / (frequency * step):.3g} time steps in a period, "
                f"fewer than {least:.0f}: its response is distorted; take a time step of at most "
                f"{1.0 / (least * frequency):.2g} s",
                CoarseSamplingWarning,
                stacklevel=3,
            )
