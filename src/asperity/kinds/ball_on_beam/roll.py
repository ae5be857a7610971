"""A ball rolls over a beam: the moving contact force couples them, step by step, compiled."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.errors import LargeDeflectionWarning
from asperity.kernels.modal import BeamMotion, BeamRecord, System, observe
from asperity.kinds.ball_on_beam.energy import EnergyBalance, balance
from asperity.kinds.ball_on_beam.stepper import BeamStepper
from asperity.laws.base import Law
from asperity.progress import Progress
from asperity.rolling.ball import RollingBall
from asperity.rolling.beam import RolledBeam, beam_step, carried, most_compliance, refuse_off_the_beam
from asperity.rolling.path import Path
from asperity.rolling.rolled import Limit, Rolled, roll_along
from asperity.store import Checkpoint
from asperity.structures.beam import Beam
from asperity.structures.body import Ball

LARGEST_DEFLECTION = 0.02
"""Share of the length up to which a beam may be displaced: slopes are then below about 0.06."""


@dataclass(frozen=True, eq=False)
class Rolling(Rolled):
    """A ball has rolled over a beam."""

    ball_displacement: NDArray[np.float64]  # (n,), m, positive downwards
    beam_displacement: NDArray[np.float64]  # (n,), under the ball, m, positive downwards
    acceleration: NDArray[np.float64]  # (sensors, n), of the beam, m/s², positive downwards
    energy: EnergyBalance  # where the work of the load went, in run-in and run


def roll_ball(
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
    """Roll a ball over a beam at constant speed, and keep what follows the run-in.

    The contact is at `start` at time zero, after the run-in, m; the law reads its texture at the same
    coordinate. Speed in m/s, times in s, sensors (k,) on the beam, m. The time step is checked against the
    highest frequency of interest, Hz. A checkpoint keeps the state about every 10 s, at the end and when
    interrupted, to go on from there.

    The beam starts as under a load that has long rolled on it, or at rest where the path begins on its
    support. It is advanced exactly mode by mode and the ball exactly, for a contact force that varies
    linearly over a step; the force at the end of each step solves the contact law implicitly, to second
    order. A step that is too long to be stable is kept so by a softened contact, with a warning
    (`asperity.rolling.stability`). Warned of are also a coarse time step, a law that was continued beyond its
    data, large deflections and forces that missed the tolerance.
    """
    path = Path.laid(start, speed, time_step, duration, settling)
    refuse_off_the_beam(beam, path)
    system = _system(beam, ball, np.atleast_1d(np.asarray(sensors, float)), path)
    over, rolls = RolledBeam(beam), RollingBall(ball)

    def stand(approach: float, softening: float) -> BeamStepper:
        softened = system._replace(softening=softening)
        return BeamStepper(softened, *_carried(softened, beam, path, approach), beam, path)

    def limits(stiffness: float) -> Iterator[Limit]:
        resonance = np.sqrt(max(stiffness, 0.0) / ball.mass) / (2.0 * np.pi)
        yield "the contact resonance sqrt(k/m)", resonance, 10.0
        yield "the highest mode of the beam", beam.natural_frequencies.max(), 4.0
        yield "the highest frequency asked for", highest_frequency or 0.0, 10.0

    alternating = over.alternating_compliance(path) + rolls.alternating_compliance(path)
    rolled, stepper = roll_along(
        path,
        law,
        rolls.load,
        stand,
        alternating=(alternating, alternating),
        limits=limits,
        free=(ball.mass, most_compliance(beam, [path])),
        judge=lambda stepper: _warn_if_bent(stepper.record.beam, beam),
        progress=progress,
        checkpoint=checkpoint,
    )
    record = stepper.record
    return Rolling(
        **vars(rolled),
        ball_displacement=record.ball[path.settled :],
        beam_displacement=record.beam[path.settled :],
        acceleration=record.acceleration[:, path.settled :],
        energy=balance(stepper.system, stepper.motion, stepper.first),
    )


def _system(beam: Beam, ball: Ball, sensors: NDArray[np.float64], path: Path) -> System:
    natural = 2.0 * np.pi * beam.natural_frequencies
    return System(
        beam_step(beam, path.time_step),
        natural**2,
        2.0 * beam.damping_ratio * natural,
        beam.shapes(sensors)[0] if sensors.size else np.zeros((0, natural.size)),
        float(ball.mass),
        float(ball.static_load),
        float(path.time_step),
        float(path.speed),
        0.0,
    )


def _carried(system: System, beam: Beam, path: Path, approach: float) -> tuple[BeamMotion, BeamRecord]:
    """State and records with the load carried at the start of the path as if it had rolled for long."""
    (shape,), (slope,) = under = beam.shapes(path.positions[0])
    displacement, velocity = carried(system.stiffness, *under, np.array([system.load]), path.speed)
    modes, samples = displacement.size, len(path.positions)
    below, sinking = shape @ displacement, shape @ velocity + path.speed * (slope @ displacement)
    motion = BeamMotion(
        displacement,
        velocity,
        np.zeros(modes),
        np.array([approach + system.softening * system.load + below, sinking]),
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
    observe.py_func(system, motion, record, 0, shape, slope)  # not compiled once more, for one call
    return motion, record


def _warn_if_bent(deflection: NDArray[np.float64], beam: Beam) -> None:
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
