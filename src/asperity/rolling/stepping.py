"""Advancing a run to its end: compiled or from Python, with progress and checkpoints."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from asperity.errors import ComputationError, InputError
from asperity.kernels.modal import refine, tolerance
from asperity.kernels.pointforce import Prepared, with_damping
from asperity.laws.base import SettlingLaw, SteppedLaw, settles
from asperity.progress import Progress
from asperity.store import Checkpoint

STEPPED_BLOCK = 8  # steps between looks at the clock when the law is evaluated from Python
SAVE_EVERY = 10.0  # s
STEPPED_TOLERANCE = 1e-6  # of the force plus the load; a law stepped from Python iterates itself
STEPPED_ITERATIONS = 40
MOTION, LAW = "motion.", "law."  # prefixes of what is kept

Free = tuple[float, float, float, float]


class Advanced(Protocol):
    """Bodies that contact forces couple, advanced step by step.

    `motion` and `record` are named tuples of arrays written in place. The motion holds ``force`` and
    ``approach`` (as the law sees it; both now first) and ``counts`` (steps done, not converged, evaluations);
    records hold ``force`` and ``approach``, and the last axis of all of them is time.
    """

    @property
    def motion(self) -> Any:
        """State."""
        ...

    @property
    def record(self) -> Any:
        """Histories."""
        ...

    @property
    def load(self) -> float:
        """Static force, N."""
        ...

    @property
    def total(self) -> int:
        """Number of steps in all."""
        ...

    def where(self, step: int) -> str:
        """Time and position of a step, in words."""
        ...

    def state(self) -> dict[str, NDArray[Any]]:
        """Copies of all that changes from step to step, but for the records."""
        ...

    def restore(self, state: dict[str, NDArray[Any]]) -> None:
        """Go on from a saved state."""
        ...


class Stepper(Advanced, Protocol):
    """Two bodies that one contact force couples."""

    def bound(self) -> int:
        """Step up to which it can be advanced in one go from where it stands."""
        ...

    def roll(self, law: Prepared, stop: int, largest: float) -> bool:
        """Advance to a step under a compiled law; False if the force exceeds what makes sense."""
        ...

    def free(self, step: int) -> Free:
        """Approach, rate and their compliances at the end of a step, for no force there."""
        ...

    def complete(self, step: int, force: float, evaluations: int, converged: bool) -> None:
        """Apply the force at the end of the step."""
        ...


class Remembers(Protocol):
    """Laws that hold something from step to step."""

    def state(self) -> dict[str, NDArray[Any]]:
        """Copies of what they hold."""
        ...

    def restore(self, state: dict[str, NDArray[Any]]) -> None:
        """Go on from a saved state."""
        ...


def copied(motion: Any) -> dict[str, NDArray[Any]]:
    """Copies of the arrays of a named tuple, by their names."""
    return {name: value.copy() for name, value in motion._asdict().items()}


def put_back(motion: Any, state: dict[str, NDArray[Any]]) -> None:
    """Write saved arrays into those of a named tuple."""
    for name in motion._fields:
        getattr(motion, name)[...] = state[name]


def step_through(
    stepper: Stepper,
    prepared: Prepared | SteppedLaw,
    damping: float,
    largest: float,
    progress: Progress | None,
    checkpoint: Checkpoint | None,
) -> None:
    """Step from where the bodies stand to the end of the path; state and histories are written.

    The damping is that of a `SteppedLaw`, N s/m. A force beyond the `largest` that makes sense, N, or none,
    says that the motion has run away.
    """

    def advance() -> bool:
        end = stepper.bound()
        if isinstance(prepared, Prepared):
            return stepper.roll(prepared, end, largest)
        stop = min(int(stepper.motion.counts[0]) + STEPPED_BLOCK, end)
        return _step_from_python(stepper, prepared, damping, stop, largest)

    advance_to_end(stepper, prepared, advance, largest, progress, checkpoint)


def advance_to_end(
    stepper: Advanced,
    laws: Prepared | Remembers,
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


def _step_from_python(stepper: Stepper, law: SteppedLaw, damping: float, stop: int, largest: float) -> bool:
    """The loop of `Stepper.roll` for a law that Python evaluates."""
    motion = stepper.motion
    for step in range(int(motion.counts[0]) + 1, stop + 1):
        free = stepper.free(step)
        guess = 2.0 * motion.force[0] - motion.force[1]
        force, evaluations, converged = solve_from_python(law, step, free, stepper.load, guess, damping)
        law.accept(step)
        stepper.complete(step, force, evaluations, converged)
        if not abs(force) <= largest:
            return False
    return True


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


def _state(stepper: Advanced, laws: Prepared | Remembers) -> dict[str, NDArray[Any]]:
    """What bodies and laws need to go on from here."""
    found = {f"{MOTION}{name}": value for name, value in stepper.state().items()}
    if not isinstance(laws, Prepared):
        found |= {f"{LAW}{name}": value for name, value in laws.state().items()}
    return found


def _histories(stepper: Advanced, held: dict[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """Records up to a state."""
    done = int(held[f"{MOTION}counts"][0]) + 1
    return {f"record.{name}": value[..., :done].copy() for name, value in stepper.record._asdict().items()}


def restore(checkpoint: Checkpoint | None, stepper: Advanced, laws: Prepared | Remembers) -> None:
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
    if not isinstance(laws, Prepared):
        laws.restore(_named(arrays, LAW))


def _named(arrays: dict[str, NDArray[Any]], prefix: str) -> dict[str, NDArray[Any]]:
    """Arrays whose names have a prefix, without it."""
    return {name.removeprefix(prefix): value for name, value in arrays.items() if name.startswith(prefix)}
