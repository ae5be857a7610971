"""A ball rolls over a beam: the moving contact force couples them, step by step."""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.errors import (
    CoarseSamplingWarning,
    InputError,
    LargeDeflectionWarning,
    Outcome,
)
from asperity.kernels.modal import (
    BeamMotion,
    BeamRecord,
    System,
    observe,
)
from asperity.kernels.pointforce import Prepared
from asperity.kinds.ball_on_beam.energy import EnergyBalance, balance, beam_energy
from asperity.kinds.ball_on_beam.stepper import BeamStepper
from asperity.laws.base import Law
from asperity.progress import Progress
from asperity.rolling.equilibrium import static_approach
from asperity.rolling.events import ContactLoss, contact_losses
from asperity.rolling.outcome import STEPPED_EQUILIBRIUM, evaluation, flying, warn_after
from asperity.rolling.stability import (
    PLACES,
    beam_step,
    largest_force,
    largest_stiffness,
    modes_and_ball,
    softening,
)
from asperity.rolling.stepping import restore, run
from asperity.store import Checkpoint
from asperity.structures.ball import Ball
from asperity.structures.beam import Beam

LARGEST_DEFLECTION = 0.02
"""Share of the length up to which a beam may be displaced: slopes are then below about 0.06."""


@dataclass(frozen=True, eq=False)
class Rolling:
    """A ball has rolled over a beam.

    Parameters
    ----------
    time : ndarray (n,)
        s, uniform from zero, after the run-in.
    position : ndarray (n,)
        Of the contact on the beam, m.
    contact_force : ndarray (n,)
        N, compression positive.
    relative_displacement : ndarray (n,)
        Approach of the mean surfaces, m, positive closing.
    ball_displacement, beam_displacement : ndarray (n,)
        Of the ball, and of the beam under it, m, positive downwards.
    acceleration : ndarray (sensors, n)
        Of the beam at the sensors, m/s^2, positive downwards.
    in_contact : ndarray (n,) of bool
        Whether the bodies touch.
    contact_loss : list of ContactLoss
        Flights.
    energy : EnergyBalance
        Where the work of the load went, in run-in and run.
    evaluations, unconverged_steps : int
        Evaluations of the law, and time steps whose contact force missed the tolerance, of run-in and run.
    outcome : Outcome
        Whether all steps converged.
    """

    time: NDArray
    position: NDArray
    contact_force: NDArray
    relative_displacement: NDArray
    ball_displacement: NDArray
    beam_displacement: NDArray
    acceleration: NDArray
    in_contact: NDArray
    contact_loss: list[ContactLoss]
    energy: EnergyBalance
    evaluations: int
    unconverged_steps: int
    outcome: Outcome

    @property
    def contact_loss_share(self) -> float:
        """Share of the time out of contact."""
        return 1.0 - float(np.mean(self.in_contact))

    @property
    def longest_loss(self) -> float:
        """Duration of the longest flight, s."""
        return max((event.duration for event in self.contact_loss), default=0.0)


def roll(
    beam: Beam,
    ball: Ball,
    law: Law,
    *,
    speed: float,
    start: float,
    duration: float,
    time_step: float,
    sensors: ArrayLike,
    settling: float = 0.0,
    highest_frequency: float | None = None,
    progress: Progress | None = None,
    checkpoint: Checkpoint | None = None,
) -> Rolling:
    """Roll a ball over a beam at constant speed, from static equilibrium, and keep what follows the run-in.

    The beam is advanced exactly mode by mode and the ball exactly, for a contact force that varies
    linearly over a step; the force at the end of each step solves the contact law implicitly, to second
    order. A step that is too long to be stable is kept so by a softened contact, with a warning
    (`asperity.rolling.stability`).

    Parameters
    ----------
    beam, ball, law
        The structures and the contact law between them.
    speed : float
        m/s.
    start : float
        Position of the contact on the beam at time zero, after the run-in, m. The law reads its texture
        at the same coordinate.
    duration : float
        s.
    time_step : float
        s.
    sensors : array_like (k,)
        Positions of the accelerometers on the beam, m.
    settling : float, optional
        Run-in before time zero, s; not kept.
    highest_frequency : float, optional
        Highest frequency of interest, Hz, checked against the time step.
    progress : callable, optional
        Called with steps done, steps in all, and a message.
    checkpoint : Checkpoint, optional
        Where to keep the state about every 10 s, at the end and when interrupted, and to go on from.

    Returns
    -------
    Rolling
        Time histories, events and energy balance.

    Raises
    ------
    InputError
        If a number is not positive, the path leaves the beam, or the checkpoint is of another run.
    ComputationError
        If the load cannot be carried, or the motion runs away.

    Warns
    -----
    CoarseSamplingWarning
        If the time step is coarse for the contact, the modes or the highest frequency.
    ExtrapolationWarning
        If the law was continued beyond its data.
    LargeDeflectionWarning
        If the beam leaves the range of beam theory.
    UnconvergedWarning
        If contact forces missed the tolerance.
    """
    positions, settled = _path(beam, speed, start, duration, settling, time_step)
    at = np.atleast_1d(np.asarray(sensors, float))
    prepared = law.prepare(positions)
    relative = 1e-9 if isinstance(prepared, Prepared) else STEPPED_EQUILIBRIUM
    approach, stiffness = static_approach(evaluation(prepared, 0), ball.static_load, relative)
    _warn_if_coarse(time_step, stiffness, ball.mass, beam, highest_frequency)
    system = _system(beam, ball, at, speed, time_step)
    shapes = beam.shapes(positions[:: max(1, len(positions) // PLACES)])[0]
    alternating = modes_and_ball(system.coefficients, shapes, ball.mass, time_step)
    stiffest, strongest = largest_stiffness(prepared, (approach, stiffness))
    system = system._replace(softening=softening(alternating, stiffest, law.damping, stiffness, time_step))
    motion, record = _at_rest(system, beam, positions[0], approach, len(positions))
    beam_start, ball_start = beam_energy(system, motion), float(motion.ball[0])
    stepper = BeamStepper(system, motion, record, beam, positions)
    restore(checkpoint, stepper, prepared)
    try:
        run(stepper, prepared, law.damping, largest_force(ball.static_load, strongest), progress, checkpoint)
    finally:  # why a motion may have run away
        _warn_if_bent(record.beam, beam)
    seen = record.approach - system.softening * record.force
    apart = flying(prepared, record.force, seen)[settled:]
    warn_after(law.name, motion.counts, prepared, seen)
    return Rolling(
        time=time_step * np.arange(len(positions) - settled),
        position=positions[settled:],
        contact_force=record.force[settled:],
        relative_displacement=record.approach[settled:],
        ball_displacement=record.ball[settled:],
        beam_displacement=record.beam[settled:],
        acceleration=record.acceleration[:, settled:],
        in_contact=~apart,
        contact_loss=contact_losses(apart, time_step),
        energy=balance(
            system,
            motion,
            ball_start=ball_start,
            ball_end=float(motion.ball[0]),
            beam_start=beam_start,
        ),
        evaluations=int(motion.counts[2]),
        unconverged_steps=int(motion.counts[1]),
        outcome=Outcome.STEPS_UNCONVERGED if motion.counts[1] else Outcome.CONVERGED,
    )


def _path(
    beam: Beam, speed: float, start: float, duration: float, settling: float, time_step: float
) -> tuple[NDArray, int]:
    """Positions of the contact at every time step of run-in and record, checked, and steps of the run-in."""
    for what, value in (
        ("speed (m/s)", speed),
        ("duration (s)", duration),
        ("time step (s)", time_step),
    ):
        if not (np.isfinite(value) and value > 0.0):
            raise InputError(what, value, "a finite positive number")
    if not (np.isfinite(settling) and settling >= 0.0):
        raise InputError("settling (s)", settling, "zero or a finite positive number")
    steps, settled = (int(np.floor(time / time_step * (1.0 + 1e-12))) for time in (duration, settling))
    if steps < 1:
        raise InputError("duration (s)", duration, f"at least one time step of {time_step:.6g} s")
    step = speed * time_step
    first, end = start - step * settled, start + step * steps
    if not (first >= -1e-9 * beam.length and end <= beam.length * (1.0 + 1e-9)):
        longest = (beam.length - start) / speed
        remedy = f"From there the beam ends after {longest:.6g} s." if first >= 0.0 else "Start on the beam."
        raise InputError(
            "path (m)", f"{first:.6g} to {end:.6g}", f"0 to {beam.length:.6g}, on the beam", remedy
        )
    return start + step * np.arange(-settled, steps + 1), settled


def _system(beam: Beam, ball: Ball, sensors: NDArray, speed: float, time_step: float) -> System:
    natural = 2.0 * np.pi * beam.natural_frequencies
    ratio = np.full(natural.shape, beam.damping_ratio)
    return System(
        beam_step(natural, ratio, time_step),
        natural**2,
        2.0 * ratio * natural,
        beam.shapes(sensors)[0] if sensors.size else np.zeros((0, natural.size)),
        float(ball.mass),
        float(ball.static_load),
        float(time_step),
        float(speed),
        0.0,
    )


def _at_rest(
    system: System, beam: Beam, start: float, approach: float, samples: int
) -> tuple[BeamMotion, BeamRecord]:
    """State and records with the load carried statically at the start of the path."""
    shape, slope = (row[0] for row in beam.shapes(start))
    displacement = shape * system.load / system.stiffness
    modes = displacement.size
    motion = BeamMotion(
        displacement,
        np.zeros(modes),
        np.zeros(modes),
        np.array([approach + system.softening * system.load + float(shape @ displacement), 0.0]),
        np.full(2, system.load),
        np.full(2, approach),
        np.zeros(5),
        np.zeros(5),
        np.zeros(3, dtype=np.int64),
    )
    record = BeamRecord(
        np.zeros(samples),
        np.zeros(samples),
        np.zeros(samples),
        np.zeros(samples),
        np.zeros((len(system.sensors), samples)),
    )
    observe(system, motion, record, 0, shape, slope)
    return motion, record


def _warn_if_bent(deflection: NDArray, beam: Beam) -> None:
    """Compare the deflection with what beam theory allows."""
    share = float(np.abs(deflection).max()) / beam.length
    if share > LARGEST_DEFLECTION:
        warnings.warn(
            f"the beam is displaced by up to {share * beam.length:.3g} m under the contact, "
            f"{100 * share:.2g} % of its length: beam theory needs small slopes, as up to "
            f"{100 * LARGEST_DEFLECTION:.0f} %; check load, section, length and support of the beam",
            LargeDeflectionWarning,
            stacklevel=3,
        )


def _warn_if_coarse(
    time_step: float, stiffness: float, mass: float, beam: Beam, highest_frequency: float | None
) -> None:
    """Compare the time step with the periods that it must resolve."""
    limits = [
        ("the contact resonance sqrt(k/m)", np.sqrt(max(stiffness, 0.0) / mass) / (2.0 * np.pi), 10.0),
        ("the highest mode of the beam", beam.natural_frequencies.max(), 4.0),
        ("the highest frequency asked for", highest_frequency or 0.0, 10.0),
    ]
    for what, frequency, least in limits:
        if frequency * time_step * least > 1.0:
            warnings.warn(
                f"{what}, {frequency:.4g} Hz, has {1.0 / (frequency * time_step):.3g} time steps in a "
                f"period, fewer than {least:.0f}: its response is distorted; "
                f"take a time step of at most {1.0 / (least * frequency):.2g} s",
                CoarseSamplingWarning,
                stacklevel=3,
            )
