"""Bodies set on a structure: at rest, with contacts soft enough for the time step."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from asperity.errors import InputError
from asperity.kernels.pointforce import Prepared
from asperity.kernels.several import POWERS, Assembly, ContactsMotion, ContactsRecord
from asperity.laws.base import Law, SteppedLaw
from asperity.rolling.beam import PLACES, alternating_of_modes, resolved_step
from asperity.rolling.outcome import STEPPED_EQUILIBRIUM, evaluation
from asperity.rolling.path import Path
from asperity.rolling.rolled import Limit, warn_if_coarse
from asperity.rolling.several.statics import Rest, at_rest
from asperity.rolling.several.stepper import ContactsStepper
from asperity.rolling.several.steps import BodySteps, body_steps
from asperity.rolling.stability import (
    contact_resonance,
    largest_force,
    largest_stiffness,
    softening,
    stiffness_in_impacts,
)
from asperity.structures.body import Body
from asperity.structures.modal import Modal

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Stand:
    """Bodies that stand on a structure, ready to roll."""

    bodies: Sequence[Body]
    steps: BodySteps
    stepper: ContactsStepper
    largest: float  # contact force that makes no sense any more, N

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
    over: Modal | None,
    bodies: Sequence[Body],
    laws: Sequence[Law],
    whole: Path,
    positions: Array,
    sensors: Array,
    highest_frequency: float | None,
) -> Stand:
    """Set bodies at `positions` ahead of a path, m, at rest on a structure; see `roll_bodies`."""
    offsets = _offsets(bodies, laws, positions)
    paths = [Path(whole.positions + at, whole.speed, whole.time_step, whole.settled) for at in offsets]
    _refuse_off_the_structure(over, paths)
    prepared = [law.prepare(path.positions) for law, path in zip(laws, paths, strict=True)]
    steps = body_steps(bodies, whole.time_step)
    system = _assembly(over, steps, bodies, sensors, whole)
    evaluations = [evaluation(law, 0) for law in prepared]
    exact = all(isinstance(law, Prepared) for law in prepared)
    yielding = _static_compliance(over, system, steps, paths)

    def rest(softer: Array) -> Rest:
        relative = 1e-9 if exact else STEPPED_EQUILIBRIUM
        return at_rest(bodies, np.zeros(len(laws)), yielding + np.diag(softer), evaluations, relative)

    found = rest(system.softening)
    alternating = _alternating_under(over, system, paths) + steps.alternating
    warn_if_coarse(
        whole.time_step, _limits(over, system, bodies, paths, alternating, found, highest_frequency)
    )
    softer, largest = _softened(laws, prepared, alternating, found, whole.time_step)
    if softer.any():
        found = rest(softer)
    system = system._replace(softening=softer)
    motion, record = _motion(over, system, steps, bodies, paths, found)
    stepper = ContactsStepper(system, motion, record, over, paths, laws, prepared)
    return Stand(bodies, steps, stepper, largest)


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


def _refuse_off_the_structure(over: Modal | None, paths: Sequence[Path]) -> None:
    """Refuse contacts that leave what is rolled over."""
    if over is None:
        return
    low, high = over.extent
    margin = 1e-9 * (high - low)
    for k, path in enumerate(paths):
        first, end = float(path.positions[0]), float(path.positions[-1])
        if not (first >= low - margin and end <= high + margin):
            raise InputError(
                f"path of contact {k + 1} (m)",
                f"{first:.6g} to {end:.6g}",
                f"{low:.6g} to {high:.6g}, on the structure",
                "Choose start, duration, run-in and positions so that all contacts stay on it.",
            )


def _assembly(
    over: Modal | None, steps: BodySteps, bodies: Sequence[Body], sensors: Array, path: Path
) -> Assembly:
    """Constants for the kernels, with contacts as they are."""
    natural = np.zeros(0) if over is None else 2.0 * np.pi * over.natural_frequencies
    ratios = np.zeros(0) if over is None else over.damping_ratios
    if sensors.size and over is None:
        raise InputError("sensors", f"{sensors.size} on a rigid plane", "none: it does not move")
    loads = np.concatenate([body.static_loads for body in bodies])
    mean = float(np.clip(loads, 0.0, None).mean())
    if not mean > 0.0:
        raise InputError("loads of the bodies (N)", "none that presses", "forces that press them down")
    n = len(loads)
    return Assembly(
        resolved_step(natural, ratios, path.time_step),
        natural**2,
        2.0 * ratios * natural,
        over.shapes(sensors)[0] if over is not None and sensors.size else np.zeros((0, natural.size)),
        *steps[:5],
        steps.flexible,
        steps.flexible_damping,
        steps.body,
        steps.core_shapes,
        steps.answers,
        steps.flexible_shapes,
        steps.own,
        np.maximum(loads, mean) if n > 1 else loads,
        np.zeros(n),
        float(path.time_step),
        float(path.speed),
        bool(n > 1 and (natural.size > 0 or n > len(bodies))),
    )


def _shapes_at(over: Modal | None, paths: Sequence[Path], step: int) -> Array:
    """Mode shapes under all contacts at a step (n, m)."""
    if over is None:
        return np.zeros((len(paths), 0))
    return over.shapes(np.array([path.positions[step] for path in paths]))[0]


def _static_compliance(
    over: Modal | None, system: Assembly, steps: BodySteps, paths: Sequence[Path]
) -> Array:
    """Of structure and of the bodies' modes at the contacts at the start (n, n), m/N."""
    shapes = _shapes_at(over, paths, 0)
    held = system.stiffness > 0.0
    found = (shapes[:, held] / system.stiffness[held]) @ shapes[:, held].T
    for b, (squares, rows) in enumerate(zip(steps.flexible_stiffness, _by_body(steps), strict=True)):
        own = np.flatnonzero(steps.body == b)
        held = squares > 0.0
        found[np.ix_(own, own)] += (rows[:, held] / squares[held]) @ rows[:, held].T
    return np.asarray(found)


def _by_body(steps: BodySteps) -> list[Array]:
    return [steps.flexible_shapes[steps.body == b] for b in range(len(steps.bases))]


def _alternating_under(over: Modal | None, system: Assembly, paths: Sequence[Path]) -> float:
    """Least alternating compliance of the structure, of all contacts at once, at places on the path, m/N."""
    if over is None:
        return 0.0
    each = alternating_of_modes(system.coefficients)
    total = paths[0].total
    least = np.inf
    for step in range(0, total + 1, max(1, (total + 1) // PLACES)):
        shapes = _shapes_at(over, paths, step)
        least = min(least, float(np.linalg.eigvalsh((shapes * each) @ shapes.T)[0]))
    return least


def _limits(
    over: Modal | None,
    system: Assembly,
    bodies: Sequence[Body],
    paths: Sequence[Path],
    alternating: Array,
    rest: Rest,
    highest_frequency: float | None,
) -> Iterator[Limit]:
    """What the time step must resolve."""
    shapes = _shapes_at(over, paths, 0)
    direct = system.own + shapes**2 @ system.coefficients[3]
    resonances = [
        contact_resonance(stiffness, own, least, system.time_step)
        for stiffness, own, least in zip(rest.stiffness, direct, alternating, strict=True)
    ]
    yield "the contact resonance", max(resonances), 10.0
    if over is not None:
        yield "the highest mode of the structure", float(over.natural_frequencies.max(initial=0.0)), 4.0
    highest = max(float(body.natural_frequencies.max(initial=0.0)) for body in bodies)
    yield "the highest mode of a body", highest, 4.0
    yield "the highest frequency asked for", highest_frequency or 0.0, 10.0


def _softened(
    laws: Sequence[Law],
    prepared: Sequence[Prepared | SteppedLaw],
    alternating: Array,
    rest: Rest,
    time_step: float,
) -> tuple[Array, float]:
    """Compliances in series with the contacts, m/N, and the force that makes no sense any more, N."""
    softer, largest = np.zeros(len(laws)), 0.0
    for k, (law, laid) in enumerate(zip(laws, prepared, strict=True)):
        stiffness = float(rest.stiffness[k])
        stiffest, strongest = largest_stiffness(laid, (float(rest.approach[k]), stiffness))
        stiff = stiffest, stiffness_in_impacts(laid, stiffest, stiffness)
        both = (float(alternating[k]),) * 2
        softer[k] = softening(both, stiff, law.damping, stiffness, time_step)
        largest = max(largest, largest_force(float(rest.force[k]), strongest))
    return softer, largest


def _motion(
    over: Modal | None,
    system: Assembly,
    steps: BodySteps,
    bodies: Sequence[Body],
    paths: Sequence[Path],
    rest: Rest,
) -> tuple[ContactsMotion, ContactsRecord]:
    """State and records at rest."""
    modes, (b, s), n = len(system.stiffness), system.flexible_damping.shape, len(rest.force)
    d, samples = system.core_shapes.shape[1], len(paths[0].positions)
    push = rest.force @ _shapes_at(over, paths, 0)
    core, core_push, flexible_push = np.zeros((b, 2 * d)), np.zeros((b, d)), np.zeros((b, s))
    np.add.at(core_push, steps.body, rest.force[:, None] * steps.core_shapes)
    np.add.at(flexible_push, steps.body, rest.force[:, None] * steps.flexible_shapes)
    bounds = np.cumsum([0, *(len(body.mass) for body in bodies)])
    for index, (body, (low, high)) in enumerate(zip(bodies, pairwise(bounds), strict=True)):
        # the basis is orthonormal in the masses
        core[index, : high - low] = steps.bases[index].T @ body.mass @ rest.displacement[low:high]
    motion = ContactsMotion(
        displacement=_held(push, system.stiffness),
        velocity=np.zeros(modes),
        push=push,
        ahead=np.zeros(modes),
        core=core,
        core_push=core_push,
        core_ahead=np.zeros((b, 2 * d)),
        flexible=np.stack([_held(flexible_push, steps.flexible_stiffness), np.zeros((b, s))]),
        flexible_push=flexible_push,
        flexible_ahead=np.zeros((b, s)),
        force=np.stack([rest.force, rest.force]),
        approach=np.stack([rest.approach, rest.approach]),
        trial=rest.force.copy(),
        compliance=np.zeros(n),
        rate=np.zeros(n),
        climb=np.zeros(n),
        power=np.zeros(POWERS),
        ledger=np.zeros(6),
        counts=np.zeros(3, dtype=np.int64),
    )
    record = ContactsRecord(
        force=np.zeros((n, samples)),
        approach=np.zeros((n, samples)),
        over=np.zeros((n, samples)),
        rolling=np.zeros((n, samples)),
        core=np.zeros((b, d, samples)),
        acceleration=np.zeros((len(system.sensors), samples)),
    )
    return motion, record


def _held(push: Array, stiffness: Array) -> Array:
    """Static displacement of modes; none of those that nothing holds."""
    return np.divide(push, stiffness, out=np.zeros_like(push), where=stiffness > 0.0)
