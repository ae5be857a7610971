"""Bodies set on what they roll over: at rest, with contacts soft enough for the time step."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from asperity.errors import CoarseSamplingWarning, InputError
from asperity.kernels.pointforce import Prepared
from asperity.kernels.several import Assembly, ContactsRecord
from asperity.laws.base import Law, SteppedLaw
from asperity.rolling.path import Path
from asperity.rolling.rest import Rest, Resting
from asperity.rolling.stability import (
    Limit,
    contact_resonance,
    largest_force,
    largest_stiffness,
    softening,
    stiffness_in_impacts,
    warn_if_coarse,
)
from asperity.rolling.stepper import ContactsStepper
from asperity.rolling.steps import BodySteps, body_steps, resolved_step
from asperity.rolling.support import OnModes, OnRail, Under
from asperity.structures.body import Body
from asperity.structures.modal import Modal
from asperity.structures.rail_poles import RailBetween

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Stand:
    """Bodies that stand on a structure, ready to roll."""

    under: Under
    bodies: Sequence[Body]
    steps: BodySteps
    stepper: ContactsStepper
    largest: float  # contact force that makes no sense any more, N
    compliance: float  # largest static one under a contact on its path, m/N; infinite if nothing holds it

    def energies(self) -> tuple[float, float, float]:
        """Now, J: of the structure, of the bodies, and of the bodies under their constant forces."""
        motion, system, steps = self.stepper.motion, self.stepper.system, self.steps
        structure = np.sum(motion.velocity**2 + system.stiffness * motion.displacement**2)
        d = steps.core_stiffness.shape[1]
        cores = np.sum(motion.core[:, d:] ** 2 + steps.core_stiffness * motion.core[:, :d] ** 2)
        modes = np.sum(motion.flexible[1] ** 2 + steps.flexible_stiffness * motion.flexible[0] ** 2)
        loads = sum(
            float(body.pressing @ (basis @ core[: len(basis)]))
            for body, basis, core in zip(self.bodies, steps.bases, motion.core, strict=True)
        )
        return 0.5 * float(structure), 0.5 * float(cores + modes), loads


def stand(
    over: Modal | RailBetween | None,
    bodies: Sequence[Body],
    laws: Sequence[Law],
    whole: Path,
    positions: Array,
    sensors: Array,
    highest_frequency: float | None,
) -> Stand:
    """Set bodies at `positions` ahead of a path, m, at rest on what they roll over; see `roll_bodies`."""
    offsets = _offsets(bodies, laws, positions)
    under: Under = OnRail(over) if isinstance(over, RailBetween) else OnModes(over)
    paths = [Path(whole.positions + at, whole.speed, whole.time_step, whole.settled) for at in offsets]
    under.refuse(paths)
    steps = body_steps(bodies, whole.time_step)
    system = _assembly(under, steps, bodies, sensors, paths)
    prepared = [law.prepare(path.positions) for law, path in zip(laws, paths, strict=True)]
    resting = Resting(under, bodies, steps, system, paths, prepared)
    rest = resting.on(np.zeros(len(laws)))
    both, thrown = (least + steps.alternating for least in under.alternating(paths))
    warn_if_coarse(whole.time_step, _limits(under, system, bodies, paths, both, rest, highest_frequency))
    softer, largest = _softened(laws, prepared, (both, thrown), rest, whole.time_step)
    if softer.any():
        rest = resting.on(softer)
    system = system._replace(softening=softer)
    modal = None if isinstance(over, RailBetween) else over
    stepper = ContactsStepper(
        system, resting.start(rest), _record(system, paths), modal, paths, laws, prepared
    )
    return Stand(under, bodies, steps, stepper, largest, under.most_compliance(paths))


def _offsets(bodies: Sequence[Body], laws: Sequence[Law], positions: Array) -> Array:
    """Where the contacts are ahead of the path (n,), m."""
    if not len(bodies):
        raise InputError("bodies", "none", "one or more")
    if positions.shape != (len(bodies),) or not np.isfinite(positions).all():
        allowed = f"{len(bodies)} finite numbers, one for each body"
        raise InputError("positions of the bodies (m)", positions.tolist(), allowed)
    offsets = np.concatenate([at + body.places for at, body in zip(positions, bodies, strict=True)])
    if len(laws) != len(offsets):
        raise InputError("laws", len(laws), f"{len(offsets)}, one for each contact")
    return offsets


def _assembly(
    under: Under, steps: BodySteps, bodies: Sequence[Body], sensors: Array, paths: Sequence[Path]
) -> Assembly:
    """Constants for the kernels, with contacts as they are."""
    natural, ratios = under.modes
    loads = np.concatenate([body.static_loads for body in bodies])
    mean = float(np.clip(loads, 0.0, None).mean())
    if not mean > 0.0:
        raise InputError("loads of the bodies (N)", "none that presses", "forces that press them down")
    n, channels = len(loads), under.channels(paths)
    return Assembly(
        coefficients=resolved_step(natural, ratios, paths[0].time_step),
        stiffness=natural**2,
        damping=2.0 * ratios * natural,
        sensors=under.at_sensors(sensors),
        core_step=steps.core_step,
        core_before=steps.core_before,
        core_now=steps.core_now,
        core_pressed=steps.core_pressed,
        core_damping=steps.core_damping,
        flexible=steps.flexible,
        flexible_damping=steps.flexible_damping,
        body=steps.body,
        core_shapes=steps.core_shapes,
        answers=steps.answers,
        flexible_shapes=steps.flexible_shapes,
        own=steps.own,
        loads=np.maximum(loads, mean) if n > 1 else loads,
        softening=np.zeros(n),
        time_step=float(paths[0].time_step),
        speed=float(paths[0].speed),
        coupled=bool(len(channels.source) > n or (n > 1 and natural.size > 0) or n > len(bodies)),
        channels=channels,
    )


def _limits(
    under: Under,
    system: Assembly,
    bodies: Sequence[Body],
    paths: Sequence[Path],
    alternating: Array,
    rest: Rest,
    highest_frequency: float | None,
) -> Iterator[Limit]:
    """What the time step must resolve."""
    shapes = under.shapes(np.array([path.positions[0] for path in paths]))[0]
    direct = system.own + shapes**2 @ system.coefficients[3]
    resonances = [
        contact_resonance(stiffness, own, least, system.time_step)
        for stiffness, own, least in zip(rest.stiffness, direct, alternating, strict=True)
    ]
    yield from under.limits(max(resonances), float(rest.stiffness.max()), paths[0])
    natural = np.concatenate([body.natural_frequencies for body in bodies])
    asked = natural[natural <= (highest_frequency or np.inf)]  # of others nobody asked
    yield "the highest mode of a body", float(asked.max(initial=0.0)), 4.0
    yield "the highest frequency asked for", highest_frequency or 0.0, under.steps_asked


def _softened(
    laws: Sequence[Law],
    prepared: Sequence[Prepared | SteppedLaw],
    alternating: tuple[Array, Array],
    rest: Rest,
    time_step: float,
) -> tuple[Array, float]:
    """Compliances in series with the contacts, m/N, and the force that makes no sense any more, N.

    The contact that is softened most is warned of.
    """
    softer, largest, told = np.zeros(len(laws)), 0.0, []
    for k, (law, laid) in enumerate(zip(laws, prepared, strict=True)):
        stiffness = float(rest.stiffness[k])
        stiffest, strongest = largest_stiffness(laid, (float(rest.approach[k]), stiffness))
        stiff = stiffest, stiffness_in_impacts(laid, stiffest, stiffness)
        least = float(alternating[0][k]), float(alternating[1][k])
        softer[k], message = softening(least, stiff, law.damping, stiffness, time_step)
        told += [(softer[k] * stiffness, message)] if message else []
        largest = max(largest, largest_force(float(rest.force[k]), strongest))
    if told:
        warnings.warn(max(told)[1], CoarseSamplingWarning, stacklevel=4)
    return softer, largest


def _record(system: Assembly, paths: Sequence[Path]) -> ContactsRecord:
    n, samples = len(paths), len(paths[0].positions)
    b, d = system.core_pressed.shape[0], system.core_shapes.shape[1]
    return ContactsRecord(
        force=np.zeros((n, samples)),
        approach=np.zeros((n, samples)),
        over=np.zeros((n, samples)),
        rolling=np.zeros((n, samples)),
        core=np.zeros((b, d, samples)),
        acceleration=np.zeros((len(system.sensors), samples)),
    )
