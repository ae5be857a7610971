"""Advancing bodies on their contacts to the end of the path: compiled or from Python, resumable."""

import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from asperity.arguments import Array, NDArray
from asperity.errors import ComputationError, InputError
from asperity.kernels import stepping
from asperity.kernels.pointforce import Prepared, evaluate
from asperity.laws.spec import Law, SettlingLaw, SteppedLaw, settles
from asperity.progress import Progress
from asperity.rolling.ground import Path
from asperity.rolling.steps import padded
from asperity.speeds import SpeedCourse
from asperity.store import Checkpoint
from asperity.structures.body import Body
from asperity.structures.modal import Modal
from asperity.structures.rail_poles import RailBetween
from asperity.written_numbers import rounded

Free = tuple[float, float, float, float]
Found = tuple[float, float, int, int]
STEPPED_BLOCK = 8  # steps between looks at the clock when a law is evaluated from Python
SAVE_EVERY = 10.0  # s
STEPPED_TOLERANCE = 1e-6  # of the force plus the load; a law stepped from Python iterates itself
SHAPES_AT_ONCE = 2**18
"""Mode shapes that are held at once, of all contacts: they stay in the processor's cache."""
LONGEST, LEAST = 2048, 64
"""Steps whose mode shapes are held at once, at most and at least."""
ALONG = ("planes", "values", "slopes", "touches")
"""What a `Prepared` law has at every step."""


def stacked(prepared: Sequence[Any], names: Iterable[str], rows: Any = ...) -> dict[str, Any]:
    """Fields of `Prepared` laws of n contacts by their names, (n, ...), padded to the largest."""
    fields = {name: [np.asarray(getattr(law, name))[rows] for law in prepared] for name in names}
    return {name: padded(parts) for name, parts in fields.items()}


class Course(Protocol):
    """Where n contacts are in the course of time, and what their laws say there."""

    time_step: float
    contacts: int
    total: int

    def place(self, contact: int, step: int) -> float:
        """Position of a contact at a step, m."""

    def shapes_into(self, first: int, shapes: Array, slopes: Array) -> None:
        """Write mode shapes under the contacts and their slopes (steps, n, s), from a step on."""

    def laid(self, first: int, stop: int) -> Any:
        """Laws from a step on to another, as `asperity.kernels.stepping.solve_prepared` takes them."""


@dataclass(eq=False)
class OnPaths:
    """Contacts that run over a structure, all alike fast, under laws that are laid out on all of their paths.

    Where the speed changes, slopes of mode shapes are multiplied by it: they are rates.
    """

    over: Modal | RailBetween | None
    path: Path
    prepared: Sequence[Prepared | SteppedLaw]

    def __post_init__(self) -> None:
        self.time_step, self.total = self.path.time_step, self.path.total
        self.contacts = len(self.path.positions)

    def place(self, contact: int, step: int) -> float:
        """Position of a contact at a step, m."""
        return float(self.path.positions[contact, step])

    def shapes_into(self, first: int, shapes: Array, slopes: Array) -> None:
        """Write mode shapes under the contacts and their slopes (steps, n, s), from a step on."""
        over = self.over
        speed = self.path.speed
        count = len(shapes)
        if over is None or isinstance(over, RailBetween):
            return
        if isinstance(speed, SpeedCourse):
            rates = self.path.rates(first, count)[:, None]
            for k, positions in enumerate(self.path.positions[:, first : first + count]):
                shapes[:, k], slopes[:, k] = over.shapes(positions)
                slopes[:, k] *= rates
            return
        spacing = speed * self.path.time_step
        for k, at in enumerate(self.path.positions[:, first]):
            shapes[:, k], slopes[:, k] = over.shapes_along(float(at), spacing, count)

    def laid(self, first: int, stop: int) -> Any:
        """Laws from a step on to another; what no step changes is stacked once."""
        along = stacked(self.prepared, ALONG, slice(first, stop))
        return Prepared(**self._fixed, **along), self._sizes

    @cached_property
    def _fixed(self) -> dict[str, Any]:
        return stacked(self.prepared, set(Prepared._fields).difference(ALONG))

    @cached_property
    def _sizes(self) -> NDArray[np.int64]:
        return sizes_of(self.prepared)


def sizes_of(prepared: Sequence[Any]) -> NDArray[np.int64]:
    """Numbers of states and of knots of `Prepared` laws (2, n)."""
    return np.array([[len(getattr(law, name)) for law in prepared] for name in ("states", "knots")])


@dataclass(eq=False)
class Stepper:
    """Bodies at rest on what they touch, under laws of their n contacts, to be advanced step by step."""

    course: Course
    bodies: Sequence[Body]
    laws: Sequence[Law]
    prepared: Sequence[Prepared | SteppedLaw]  # the laws on their paths; none that are laid out on the way
    system: stepping.System
    motion: stepping.Motion
    largest: float  # contact force that makes no sense any more, N
    softest: float  # largest static compliance under a contact on its path, m/N; infinite if nothing holds it
    displacements: bool = False  # whether those of the sensors are recorded

    def __post_init__(self) -> None:
        n = self.course.contacts
        steps = self.course.total + 1
        (b, states), (sensors, modes) = self.system.core_pressed.shape, self.system.sensors.shape
        force, approach, over, rolling = np.zeros((4, n, steps))
        core = np.zeros((b, states // 2, steps))
        acceleration = np.zeros((sensors, steps))
        moved = np.zeros((sensors if self.displacements else 0, steps))
        self.record = stepping.Histories(force, approach, over, rolling, core, acceleration, moved)
        self.stepped = {k: law for k, law in enumerate(self.prepared) if not isinstance(law, Prepared)}
        self.length = int(np.clip(SHAPES_AT_ONCE // max(n * modes, 1), LEAST, LONGEST))
        self.offset = self.end = -1
        # one place for all chunks: fresh memory takes longer than what is computed
        self.shapes, self.slopes = np.zeros((2, self.length + 1, n, modes))
        self.laid: Any = self.prepared
        self.motion.counts[0] = -1
        self._advance(0, np.inf)
        self.motion.approach[1] = self.motion.approach[0]
        self.started = self.motion.core[:, states // 2 :].copy()  # rates of the bodies

    def energies(self) -> tuple[float, float, float]:
        """Now, J: of the structure, of the bodies, and of the bodies under their constant forces."""
        motion = self.motion
        system = self.system
        structure = self.system.sensors.shape[1]
        modes = 0.5 * (motion.velocity**2 + system.stiffness * motion.displacement**2)
        d = system.core_shapes.shape[1]
        stored = float(modes[structure:].sum())
        pressed = 0.0
        for body, core in zip(self.bodies, motion.core, strict=True):
            y = core[: len(body.mass)]
            rate = core[d : d + len(body.mass)]
            stored += 0.5 * float(rate @ body.mass @ rate + y @ body.stiffness @ y)
            pressed += float(body.pressing @ y)
        pressed -= float(system.constant @ motion.displacement) if len(system.constant) else 0.0
        return float(modes[:structure].sum()), stored, pressed

    def run(self, progress: Progress | None, checkpoint: Checkpoint | None) -> None:
        """Go on to the end of the path, from where a checkpoint was left, if it was."""
        motion = self.motion
        saved = time.monotonic()
        total = self.course.total
        if checkpoint is not None:
            self._restore(checkpoint)
        state = self._state()
        try:
            while motion.counts[0] < total:
                done = int(motion.counts[0])
                if not self._advance(done + STEPPED_BLOCK if self.stepped else total, self.largest):
                    raise self._ran_away()
                state = self._state()
                if progress is not None:
                    progress(int(motion.counts[0]), total, "rolling")
                if checkpoint is not None and time.monotonic() - saved > SAVE_EVERY:
                    checkpoint.save(state | self._histories(state))
                    saved = time.monotonic()
        finally:
            # at the end, and whatever stopped the run, maybe amid a step: it goes on from the last steps done
            if checkpoint is not None and np.all(np.abs(motion.force[0]) <= self.largest):
                checkpoint.save(state | self._histories(state))

    def _advance(self, stop: int, largest: float) -> bool:
        """Go on to a step, or the end of a chunk of the path; False from a force larger than `largest`, N."""
        done = int(self.motion.counts[0])
        self._hold(done + 1)
        stop = min(stop, self.end)
        state, along = (self.system, self.motion, self.record), (self.shapes, self.slopes, self.offset)
        if not self.stepped:
            return bool(stepping.roll_prepared(*state, self.laid, *along, stop, largest))
        for step in range(done + 1, stop + 1):
            loops = stepping.solve_contacts.py_func, self._solve
            if not stepping.roll.py_func(*loops, *state, self.laid, *along, step, largest):
                return False
            for law in self.stepped.values() if step else ():
                law.accept(step)
        return True

    def _hold(self, step: int) -> None:
        """Make ready the chunk of a step, whose bounds do not depend on where a run was taken up."""
        offset = max(step - 1, 0) // self.length * self.length
        if offset == self.offset:
            return
        self.offset, self.end = offset, min(offset + self.length, self.course.total)
        count = self.end + 1 - offset
        if self.shapes.shape[2]:
            self.course.shapes_into(offset, self.shapes[:count], self.slopes[:count])
        if not self.stepped:  # one kernel serves any number and mix
            self.laid = self.course.laid(offset, self.end + 1)

    def _solve(self, laws: Any, k: int, row: int, free: Free, load: float, guess: float) -> Found:
        """As `asperity.kernels.stepping.solve_prepared`, by any law.

        One that settles with the bodies does without iteration, but where its damper engages or lets go.
        """
        step = self.offset + row
        law = laws[k]
        damping = float(self.laws[k].damping)
        solve = stepping.solve_law.py_func
        if isinstance(law, Prepared):
            in_flight = law.damped_in_flight
            return solve(evaluate, law, step, free, load, guess, damping, in_flight, stepping.FORCE_TOLERANCE)
        if settles(law) and (settled := _settled(law, step, free, damping)) is not None:
            return *settled, 1, stepping.FOUND
        return solve(_evaluate, law, step, free, load, guess, damping, False, STEPPED_TOLERANCE)

    def _ran_away(self) -> ComputationError:
        motion, course = self.motion, self.course
        step = int(motion.counts[0])
        worst = int(np.argmax(np.abs(motion.force[0])))
        return ComputationError(
            f"the motion runs away: at step {step}, time {step * course.time_step:.6g} s, position "
            f"{course.place(worst, step):.6g} m, the contact force is {rounded(motion.force[0, worst])} N "
            f"under a load of {rounded(self.system.loads.max(), 4)} N",
            "what a warning asks for, as a smaller numerics.time_step; without one, other masses, damping or "
            "texture there, or a track without poles",
        )

    def _state(self) -> dict[str, NDArray[Any]]:
        """What bodies and laws need to go on from here."""
        state = {f"motion.{name}": value.copy() for name, value in self.motion._asdict().items()}
        for k, law in self.stepped.items():
            state |= {f"law.{k}.{name}": value for name, value in law.state().items()}
        return state

    def _histories(self, state: dict[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
        """Records up to a state."""
        done = int(state["motion.counts"][0]) + 1
        return {f"record.{name}": value[..., :done].copy() for name, value in self.record._asdict().items()}

    def _restore(self, checkpoint: Checkpoint) -> None:
        """Take the run up where it was saved, if it was: state, histories, and what laws remember."""
        arrays = checkpoint.load()
        if arrays is None:
            return
        ours = {f"motion.{name}": value for name, value in self.motion._asdict().items()}
        ours |= {f"record.{name}": value for name, value in self.record._asdict().items()}
        for name, value in ours.items():
            kept = arrays.get(name, np.zeros(0))
            last = kept.shape[-1] if name.startswith("record.") else value.shape[-1]
            if kept.shape != (*value.shape[:-1], last) or last > value.shape[-1]:
                received = "a run with other modes, sensors or duration"
                raise InputError("checkpoint", received, "this run", "Clear what was kept, and roll anew.")
            value[..., :last] = kept
        for k, law in self.stepped.items():
            own = f"law.{k}."
            law.restore({name.removeprefix(own): v for name, v in arrays.items() if name.startswith(own)})


def _evaluate(law: SteppedLaw, step: int, approach: float) -> tuple[float, float]:
    return law.evaluate(step, float(approach))


def _settled(law: SettlingLaw, step: int, free: Free, damping: float) -> tuple[float, float] | None:
    """Contact force, N, found together with what the bodies yield to it, and its elastic part.

    None where its damper decides. With the damper in contact, as `asperity.kernels.pointforce.with_damping`
    has it, the force is still straight in the elastic one. Whether it is in contact is known only then.
    """
    free_approach, rate, compliance, rate_compliance = free
    share = 1.0 / (1.0 + damping * rate_compliance)
    pushed = share * damping * rate
    elastic = law.settle(step, free_approach - compliance * pushed, compliance * share)
    force = share * elastic + pushed
    if elastic > 0.0:
        return (force, elastic) if force >= 0.0 else None
    return (0.0, 0.0) if pushed <= 0.0 else None
