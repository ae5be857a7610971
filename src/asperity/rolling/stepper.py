"""Advancing bodies on their contacts to the end of the path: compiled or from Python, resumable."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.errors import ComputationError, InputError
from asperity.kernels.modal import refine, solve_step, tolerance
from asperity.kernels.pointforce import Prepared, with_damping
from asperity.kernels.several import (
    CONTACT_DAMPING,
    SWEEPS,
    Assembly,
    ContactsMotion,
    ContactsRecord,
    Laws,
    begin_step,
    book,
    complete_contacts,
    damper_power,
    free_of,
    observe_contacts,
    roll_contacts,
    take,
)
from asperity.laws.base import Law, SettlingLaw, SteppedLaw, settles
from asperity.progress import Progress
from asperity.rolling.outcome import evaluation
from asperity.rolling.path import Path
from asperity.store import Checkpoint
from asperity.structures.modal import Modal


class Stack:
    """`Prepared` laws of all contacts, padded to the largest: one kernel serves any number and mix."""

    def __init__(self, prepared: Sequence[Prepared]) -> None:
        self.prepared = prepared
        self.states = max(len(law.states) for law in prepared)
        self.table = any(len(law.slopes) for law in prepared)
        knots = max(len(law.knots) for law in prepared)
        n = len(prepared)

        def each(name: str, kind: type) -> NDArray[np.generic]:
            return np.array([getattr(law, name) for law in prepared], dtype=kind)

        none = np.zeros((n, 0))
        self.laws = Laws(
            each("form", np.int64),
            none,
            np.array([len(law.states) for law in prepared]),
            np.zeros((n, self.states)),
            np.zeros((n, 0, self.states)),
            np.zeros((n, 0, self.states)),
            none,
            np.array([len(law.knots) for law in prepared]),
            np.zeros((n, knots)),
            np.zeros((n, max(knots - 1, 0), 4)),
            each("exponent", float),
            each("bilateral", bool),
            each("datum", float),
            each("damping", float),
            each("damped_in_flight", bool),
        )
        for k, law in enumerate(prepared):
            self.laws.states[k, : len(law.states)] = law.states
            self.laws.knots[k, : len(law.knots)] = law.knots
            self.laws.coefficients[k, : len(law.coefficients)] = law.coefficients

    def piece(self, first: int, end: int) -> Laws:
        """Laws on the steps from `first` to before `end`."""
        n, rows = len(self.prepared), end - first
        planes, values = np.zeros((n, rows)), np.zeros((n, rows, self.states))
        slopes = np.zeros((n, rows if self.table else 0, self.states))
        touches = np.zeros((n, rows if self.table else 0))
        for k, law in enumerate(self.prepared):
            count = len(law.states)
            planes[k], values[k, :, :count] = law.planes[first:end], law.values[first:end]
            if len(law.slopes):
                slopes[k, :, :count], touches[k] = law.slopes[first:end], law.touches[first:end]
        return self.laws._replace(planes=planes, values=values, slopes=slopes, touches=touches)


Array = NDArray[np.float64]
STEPPED_BLOCK = 8  # steps between looks at the clock when the law is evaluated from Python
SAVE_EVERY = 10.0  # s
STEPPED_TOLERANCE = 1e-6  # of the force plus the load; a law stepped from Python iterates itself
STEPPED_ITERATIONS = 40
MOTION, LAW = "motion.", "law."  # prefixes of what is kept

Free = tuple[float, float, float, float]
PIECE = 2**18
"""Mode shapes that are held at once, of all contacts: they stay in the processor's cache."""
LONGEST, LEAST = 2048, 64
"""Steps whose mode shapes are held at once, at most and at least."""


class ContactsStepper:
    """Structure and bodies that contact forces couple, advanced step by step."""

    def __init__(
        self,
        system: Assembly,
        motion: ContactsMotion,
        record: ContactsRecord,
        over: Modal | None,
        paths: Sequence[Path],
        laws: Sequence[Law],
        prepared: Sequence[Prepared | SteppedLaw],
    ) -> None:
        self.system, self.motion, self.record = system, motion, record
        self.paths, self.laws, self.prepared = paths, laws, prepared
        self.load, self.total = float(system.loads.max()), paths[0].total
        compiled = [law for law in prepared if isinstance(law, Prepared)]
        self.stack = Stack(compiled) if len(compiled) == len(prepared) else None
        self.along = ShapesUnder(over, paths, len(system.stiffness))
        self.piece = self.stack.piece(0, 1) if self.stack else None
        self.along.hold(0)
        if self.stack is None:
            observe_contacts(system, motion, record, 0, *self.along.at(0))
        else:
            motion.counts[0] = -1
            self._compiled(0, np.inf)
        motion.approach[1] = motion.approach[0]

    def advance(self, largest: float) -> bool:
        """Go on to the end of a chunk of the path; False if a force exceeds what makes sense, N."""
        done = int(self.motion.counts[0])
        fresh = self.along.hold(done + 1)
        end = self.along.end
        if self.stack is None:
            return self._from_python(min(done + STEPPED_BLOCK, end), largest)
        if fresh or self.piece is None or self.piece.planes.shape[1] != end + 1 - self.along.offset:
            self.piece = self.stack.piece(self.along.offset, end + 1)
        return self._compiled(end, largest)

    def _compiled(self, stop: int, largest: float) -> bool:
        """Go on to a step of the chunk."""
        along, bodies = self.along, (self.system, self.motion, self.record)
        return bool(
            roll_contacts(*bodies, self.piece, along.shapes, along.slopes, along.offset, stop, largest)
        )

    def _from_python(self, stop: int, largest: float) -> bool:
        """The loop of `asperity.kernels.several.roll_contacts` with laws that Python evaluates."""
        system, motion = self.system, self.motion
        for step in range(int(motion.counts[0]) + 1, stop + 1):
            shapes, slopes = self.along.at(step)
            begin_step(system, motion, shapes)
            converged = self._solve(step, shapes)
            for law in self.prepared:
                if not isinstance(law, Prepared):
                    law.accept(step)
            complete_contacts(system, motion, shapes)
            book(system, motion)
            observe_contacts(system, motion, self.record, step, shapes, slopes)
            self._dampers(step)
            book(system, motion)
            motion.counts[0] = step
            motion.counts[1] += not converged
            if not np.all(np.abs(motion.trial) <= largest):
                return False
        return True

    def _solve(self, step: int, shapes: Array) -> bool:
        """The sweeps of `asperity.kernels.several.solve_contacts`."""
        system, motion = self.system, self.motion
        for sweep in range(SWEEPS):
            settled = True
            for k, law in enumerate(self.prepared):
                free, load = free_of(system, motion, shapes, k), float(system.loads[k])
                guess = float(motion.trial[k])
                if isinstance(law, Prepared):
                    found = solve_step(law, step, free, load, guess)
                else:
                    found = solve_from_python(law, step, free, load, guess, self.laws[k].damping)
                # one evaluation says that the guess was right, but of a law that settles: its force does
                known = 0 if settles(law) else sweep
                right = take(system, motion, shapes, k, known, *found)
                settled = settled and (right if system.coupled else found[2])
            if settled or not system.coupled:
                return settled
        return False

    def _dampers(self, step: int) -> None:
        motion = self.motion
        for k, law in enumerate(self.prepared):
            if self.laws[k].damping > 0.0:
                elastic = evaluation(law, step)(float(motion.approach[0, k]))[0]
                motion.power[CONTACT_DAMPING] += damper_power(self.system, motion, k, elastic)

    def where(self, step: int) -> str:
        """Time and position of a step."""
        return self.paths[int(np.argmax(np.abs(self.motion.force[0])))].where(step)

    def state(self) -> dict[str, NDArray[Any]]:
        """Of the motion."""
        return {name: value.copy() for name, value in self.motion._asdict().items()}

    def restore(self, state: dict[str, NDArray[Any]]) -> None:
        """Go on from a saved state."""
        for name in self.motion._fields:
            getattr(self.motion, name)[...] = state[name]


class Remembered:
    """What the laws of all contacts hold from step to step."""

    def __init__(self, prepared: Sequence[Prepared | SteppedLaw]) -> None:
        self.stepped = {str(k): law for k, law in enumerate(prepared) if not isinstance(law, Prepared)}

    def state(self) -> dict[str, NDArray[Any]]:
        """Of each, under the number of its contact."""
        return {
            f"{k}.{name}": value for k, law in self.stepped.items() for name, value in law.state().items()
        }

    def restore(self, state: dict[str, NDArray[Any]]) -> None:
        """Give back to each what it held."""
        for k, law in self.stepped.items():
            own = f"{k}."
            law.restore({name.removeprefix(own): v for name, v in state.items() if name.startswith(own)})


class ShapesUnder:
    """Mode shapes under all contacts, in chunks whose bounds do not depend on where a run was taken up."""

    def __init__(self, over: Modal | None, paths: Sequence[Path], modes: int) -> None:
        self.over, self.paths, self.modes = over, paths, modes
        self.length = int(np.clip(PIECE // max(len(paths) * modes, 1), LEAST, LONGEST))
        self.offset = self.end = -1
        # one place for all chunks: fresh memory takes longer than what is computed
        self.shapes, self.slopes = np.zeros((2, self.length + 1, len(paths), modes))

    def hold(self, step: int) -> bool:
        """Make ready the chunk of the step that ends at `step`; whether it is another one."""
        offset = max(step - 1, 0) // self.length * self.length
        if offset == self.offset:
            return False
        self.offset, self.end = offset, min(offset + self.length, self.paths[0].total)
        count = self.end + 1 - offset
        if self.over is not None:
            for k, path in enumerate(self.paths):
                start, spacing = float(path.positions[offset]), path.speed * path.time_step
                found = self.over.shapes_along(start, spacing, count)
                self.shapes[:count, k], self.slopes[:count, k] = found
        return True

    def at(self, step: int) -> tuple[Array, Array]:
        """Shapes (n, m) at a step, kg^-1/2, and slopes, kg^-1/2 per metre."""
        self.hold(step)
        return self.shapes[step - self.offset], self.slopes[step - self.offset]


def advance_to_end(
    stepper: ContactsStepper,
    laws: Remembered,
    advance: Callable[[], bool],
    largest: float,
    progress: Progress | None,
    checkpoint: Checkpoint | None,
) -> None:
    """Call `advance` to the end of the path; it says False from a force larger than `largest`, N, or NaN."""
    motion, saved = stepper.motion, time.monotonic()
    held = _state(stepper, laws)
    try:
        while motion.counts[0] < stepper.total:
            if not advance():
                step, forces = int(motion.counts[0]), np.atleast_1d(motion.force[0])
                raise ComputationError(
                    f"the motion runs away: at step {step}, {stepper.where(step)}, the contact force is "
                    f"{forces[np.argmax(np.abs(forces))]:.3g} N under a load of {stepper.load:.4g} N",
                    "what a warning asks for, as a smaller numerics.time_step; without one, other masses, "
                    "damping or texture there, or a track without poles",
                )
            held = _state(stepper, laws)
            if progress is not None:
                progress(int(motion.counts[0]), stepper.total, "rolling")
            if checkpoint is not None and time.monotonic() - saved > SAVE_EVERY:
                checkpoint.save(held | _histories(stepper, held))
                saved = time.monotonic()
    finally:
        # at the end, and whatever stopped the run, maybe amid a step: it goes on from the last steps done
        if checkpoint is not None and np.all(np.abs(motion.force[0]) <= largest):
            checkpoint.save(held | _histories(stepper, held))


def solve_from_python(
    law: SteppedLaw, step: int, free: Free, load: float, guess: float, damping: float
) -> tuple[float, int, bool]:
    """The iteration of `asperity.kernels.modal.solve_step` for a law that Python evaluates.

    A law that settles with the bodies does without, but where its damper engages or lets go.
    """
    if settles(law):
        settled = _settled(law, step, free, damping)
        if settled is not None:
            return settled, 1, True
    free_approach, rate, compliance, rate_compliance = free
    low, high, approach = -np.inf, np.inf, free_approach - compliance * guess
    for iteration in range(STEPPED_ITERATIONS):
        elastic, stiffness = law.evaluate(step, approach)
        force, stiffness = with_damping(elastic, stiffness, rate, rate_compliance, damping, False)
        residual = approach - free_approach + compliance * force
        limit = tolerance(free_approach, compliance, force, load, STEPPED_TOLERANCE)
        if abs(residual) <= limit:
            return force, iteration + 1, True
        low, high, approach = refine(low, high, approach, residual, 1.0 + compliance * stiffness, iteration)
        if damping > 0.0 and abs(high - low) <= limit:
            return (free_approach - approach) / compliance, iteration + 1, True
    return (free_approach - approach) / compliance, STEPPED_ITERATIONS, False


def _settled(law: SettlingLaw, step: int, free: Free, damping: float) -> float | None:
    """Contact force, N, found together with what the bodies yield to it; None where its damper decides.

    With the damper in contact, as `asperity.kernels.pointforce.with_damping` has it, the force is still
    straight in the elastic one. Whether it is in contact is known only then.
    """
    free_approach, rate, compliance, rate_compliance = free
    share = 1.0 / (1.0 + damping * rate_compliance)
    pushed = share * damping * rate
    elastic = law.settle(step, free_approach - compliance * pushed, compliance * share)
    force = share * elastic + pushed
    if elastic > 0.0:
        return force if force >= 0.0 else None
    return 0.0 if pushed <= 0.0 else None


def _state(stepper: ContactsStepper, laws: Remembered) -> dict[str, NDArray[Any]]:
    """What bodies and laws need to go on from here."""
    found = {f"{MOTION}{name}": value for name, value in stepper.state().items()}
    return found | {f"{LAW}{name}": value for name, value in laws.state().items()}


def _histories(stepper: ContactsStepper, held: dict[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """Records up to a state."""
    done = int(held[f"{MOTION}counts"][0]) + 1
    return {f"record.{name}": value[..., :done].copy() for name, value in stepper.record._asdict().items()}


def restore(checkpoint: Checkpoint | None, stepper: ContactsStepper, laws: Remembered) -> None:
    """Take a run up where it was saved, if it was: state, histories, and what laws remember."""
    arrays = checkpoint.load() if checkpoint is not None else None
    if arrays is None:
        return
    record, state = stepper.record, _named(arrays, MOTION)
    histories = {name: arrays.get(f"record.{name}", np.zeros(0)) for name in record._fields}
    same = {name: value.shape for name, value in state.items()} == {
        name: value.shape for name, value in stepper.state().items()
    } and all(
        value.shape[:-1] == getattr(record, name).shape[:-1]
        and value.shape[-1] <= getattr(record, name).shape[-1]
        for name, value in histories.items()
    )
    if not same:
        remedy = "Clear what was kept, and roll anew."
        raise InputError("checkpoint", "a run with other modes, sensors or duration", "this run", remedy)
    stepper.restore(state)
    for name, value in histories.items():
        getattr(record, name)[..., : value.shape[-1]] = value
    laws.restore(_named(arrays, LAW))


def _named(arrays: dict[str, NDArray[Any]], prefix: str) -> dict[str, NDArray[Any]]:
    """Arrays whose names have a prefix, without it."""
    return {name.removeprefix(prefix): value for name, value in arrays.items() if name.startswith(prefix)}
