"""Bodies that roll, laid out for the compiled step: exact for forces that are linear over it."""

from __future__ import annotations
from collections.abc import Sequence
from typing import NamedTuple
import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh
from asperity.errors import InputError
from asperity.kernels.modal import exponentials
from asperity.rolling.beam import alternating_of_modes, resolved_step
from asperity.rolling.stability import RESOLVED
from asperity.structures.body import Body
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from asperity.errors import CoarseSamplingWarning, InputError
from asperity.kernels.pointforce import Prepared
from asperity.kernels.several import Assembly, ContactsRecord
from asperity.laws.base import Law, SteppedLaw
from asperity.rolling.beam import resolved_step
from asperity.rolling.equilibrium import Rest, Resting
from asperity.rolling.path import Path
from asperity.rolling.rolled import Limit, warn_if_coarse
from asperity.rolling.stability import (
    contact_resonance,
    largest_force,
    largest_stiffness,
    softening_told,
    stiffness_in_impacts,
)
from asperity.rolling.stepper import ContactsStepper
from asperity.rolling.support import OnModes, OnRail, Under
from asperity.structures.modal import Modal
from asperity.structures.rail_poles import RailBetween

Array = NDArray[np.float64]
ROUNDING = 1e-12
"""Share of the largest squared natural frequency of a body that counts as none."""


class BodySteps(NamedTuple):
    """Arrays of `asperity.kernels.several.Assembly`, of b bodies on n contacts, and what they stand for."""

    core_step: Array
    core_before: Array
    core_now: Array
    core_pressed: Array
    core_damping: Array
    core_stiffness: Array  # (b, d), squared natural frequencies, (rad/s)²
    flexible: Array
    flexible_stiffness: Array  # (b, s), ω²
    flexible_damping: Array
    body: NDArray[np.int64]
    core_shapes: Array
    answers: Array
    flexible_shapes: Array
    own: Array
    bases: tuple[Array, ...]  # of each body (d, d): y = basis z

    @property
    def alternating(self) -> Array:
        """Least alternating compliance of the body at each contact (n,), m/N: of all its contacts at once."""
        found = np.zeros(len(self.body))
        for b in range(len(self.bases)):
            at = np.flatnonzero(self.body == b)
            d = self.core_now.shape[2]
            core = np.linalg.solve(np.eye(2 * d) + self.core_step[b], self.core_now[b] - self.core_before[b])[
                :d
            ]
            modes = alternating_of_modes(self.flexible[:, b])
            rows, shapes = self.core_shapes[at], self.flexible_shapes[at]
            matrix = rows @ core @ rows.T + (shapes * modes) @ shapes.T
            found[at] = float(np.linalg.eigvalsh(0.5 * (matrix + matrix.T)).min())
        return found


def body_steps(bodies: Sequence[Body], time_step: float) -> BodySteps:
    """Lay bodies out for a time step, s, in coordinates z with unit mass and diagonal stiffness, y = V z.

    Coordinates and modes that turn by more than RESOLVED in a step only answer statically to the force at
    its end, as those of `asperity.rolling.beam.beam_step`.
    """
    b, d = len(bodies), max(len(body.mass) for body in bodies)
    s, n = max(body.shapes.shape[1] for body in bodies), sum(len(body.places) for body in bodies)
    steps = BodySteps(
        np.tile(np.eye(2 * d), (b, 1, 1)),
        np.zeros((b, 2 * d, d)),
        np.zeros((b, 2 * d, d)),
        np.zeros((b, 2 * d)),
        np.zeros((b, d, d)),
        np.zeros((b, d)),
        np.zeros((8, b, s)),
        np.zeros((b, s)),
        np.zeros((b, s)),
        np.repeat(np.arange(b), [len(body.places) for body in bodies]),
        np.zeros((n, d)),
        np.zeros((n, d)),
        np.zeros((n, s)),
        np.zeros(n),
        tuple(_natural(body)[1] for body in bodies),
    )
    for index, body in enumerate(bodies):
        _lay_core(steps, index, body, time_step)
        _lay_modes(steps, index, body, time_step)
    for k, index in enumerate(steps.body):
        steps.answers[k] = steps.core_now[index, :d] @ steps.core_shapes[k]
        flexible = steps.flexible_shapes[k] ** 2 @ steps.flexible[3, index]
        steps.own[k] = steps.core_shapes[k] @ steps.answers[k] + flexible
    return steps


def _natural(body: Body) -> tuple[Array, Array]:
    """Squared natural frequencies (d,), (rad/s)², without damping, and mass-normalised shapes (d, d)."""
    for what in ("mass", "damping", "stiffness"):
        matrix = getattr(body, what)
        if np.abs(matrix - matrix.T).max() > 1e-9 * np.abs(matrix).max():
            raise InputError(f"{what} of a body", "a matrix that is not symmetric", "a symmetric matrix")
    squares, basis = eigh(body.stiffness, body.mass)
    largest = float(np.abs(squares).max())
    if squares.min() < -1e-9 * largest:
        raise InputError("stiffness of a body", "a negative one", "springs that pull back")
    return np.where(squares > ROUNDING * largest, squares, 0.0), basis


def _lay_core(steps: BodySteps, index: int, body: Body, time_step: float) -> None:
    """Write the coordinates of one body."""
    squares, basis = _natural(body)
    h, count, d = time_step, len(squares), steps.core_now.shape[2]
    damping = basis.T @ body.damping @ basis
    rates = np.sqrt(np.maximum(squares - 0.25 * np.diag(damping) ** 2, 0.0))
    fast = rates * h > RESOLVED
    slow = np.flatnonzero(~fast)
    step, before, now = _core_step(squares[slow], damping[np.ix_(slow, slow)], h)
    both = np.concatenate([slow, d + slow])
    steps.core_step[index, :count, :count] = steps.core_step[index, d : d + count, d : d + count] = 0.0
    steps.core_step[index][np.ix_(both, both)] = step
    steps.core_before[index][np.ix_(both, slow)] = before
    steps.core_now[index][np.ix_(both, slow)] = now
    at = np.flatnonzero(fast)
    steps.core_now[index, at, at] = 1.0 / squares[at]
    pressing = np.zeros(d)
    pressing[:count] = basis.T @ body.pressing
    steps.core_pressed[index] = -(steps.core_before[index] + steps.core_now[index]) @ pressing
    steps.core_damping[index, :count, :count] = damping
    steps.core_stiffness[index, :count] = squares
    steps.core_shapes[np.flatnonzero(steps.body == index), :count] = body.contacts @ basis


def _core_step(squares: Array, damping: Array, time_step: float) -> tuple[Array, Array, Array]:
    """Exact step of z″ + D z′ + ω² z = g: factors of (z, z′), and of g at start and at end of the step.

    As `asperity.kernels.modal.modal_coefficients`, for oscillators that dampers couple.
    """
    h, d = time_step, len(squares)
    generator = np.zeros((4 * d, 4 * d))
    place, rate, force, rise = (slice(i * d, (i + 1) * d) for i in range(4))
    generator[place, rate] = generator[rate, force] = generator[force, rise] = np.eye(d)
    generator[rate, place] = -(h**2) * np.diag(squares)
    generator[rate, rate] = -h * damping
    # rows and columns in z, h z', h^2 g_start, h^2 (g_end - g_start)
    whole = exponentials(generator[None])[0][: 2 * d]
    whole[:, rate] *= h
    whole[:, force] = (whole[:, force] - whole[:, rise]) * h**2
    whole[:, rise] *= h**2
    whole[rate] /= h
    return whole[:, : 2 * d], whole[:, force], whole[:, rise]


def _lay_modes(steps: BodySteps, index: int, body: Body, time_step: float) -> None:
    """Write the modes of one body."""
    natural, ratio = 2.0 * np.pi * body.natural_frequencies, body.damping_ratios
    count = len(natural)
    steps.flexible[:, index, :count] = resolved_step(natural, ratio, time_step)
    steps.flexible_stiffness[index, :count] = natural**2
    steps.flexible_damping[index, :count] = 2.0 * ratio * natural
    steps.flexible_shapes[np.flatnonzero(steps.body == index), :count] = body.shapes


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
        softer[k], message = softening_told(least, stiff, law.damping, stiffness, time_step)
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
