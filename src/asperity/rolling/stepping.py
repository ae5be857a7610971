"""Advancing a run to its end: compiled or from Python, with progress and checkpoints."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from asperity.errors import ComputationError, InputError
from asperity.kernels.modal import (
    Motion,
    Record,
    System,
    complete_step,
    free_step,
    refine,
    roll_steps,
    tolerance,
)
from asperity.kernels.pointforce import Prepared, with_damping
from asperity.pointforce.base import SteppedLaw
from asperity.structures.beam import Beam

CHUNK = 2048  # steps whose mode shapes are held at once
STEPPED_BLOCK = 8  # steps between looks at the clock when the law is evaluated from Python
SAVE_EVERY = 10.0  # s
STEPPED_TOLERANCE = 1e-6  # of the force plus the load; a law stepped from Python iterates itself
STEPPED_ITERATIONS = 40

Progress = Callable[[int, int, str], None]


class Checkpoint(Protocol):
    """Where an interrupted run is kept."""

    def load(self) -> dict[str, NDArray] | None:
        """What was saved last, or None."""
        ...

    def save(self, arrays: dict[str, NDArray]) -> None:
        """Replace what was saved."""
        ...


def run(
    system: System,
    motion: Motion,
    record: Record,
    prepared: Prepared | SteppedLaw,
    damping: float,
    beam: Beam,
    positions: NDArray,
    progress: Progress | None,
    checkpoint: Checkpoint | None,
) -> None:
    """Step from the state of `motion` to the end of the path.

    Mode shapes are evaluated in chunks whose bounds do not depend on where a run was taken up, so
    that a resumed run equals an uninterrupted one bit by bit.

    Parameters
    ----------
    system, motion, record
        Constants, state and histories; the last two are written.
    prepared : Prepared or SteppedLaw
        The law on the path.
    damping : float
        Contact damping of a `SteppedLaw`, N s/m.
    beam : Beam
        Gives the mode shapes under the contact.
    positions : ndarray (n,)
        Of the contact, m.
    progress : callable or None
        Called with steps done, steps in all, and a message.
    checkpoint : Checkpoint or None
        Where the state is kept.

    Raises
    ------
    ComputationError
        If the motion is no longer finite.
    """
    total, saved = len(positions) - 1, time.monotonic()
    try:
        while motion.counts[0] < total:
            offset = int(motion.counts[0]) // CHUNK * CHUNK
            end = min(offset + CHUNK, total)
            shapes, slopes = beam.shapes(positions[offset : end + 1])
            while motion.counts[0] < end:
                if isinstance(prepared, Prepared):
                    finite = roll_steps(system, motion, record, prepared, shapes, slopes, offset, end)
                else:
                    stop = min(int(motion.counts[0]) + STEPPED_BLOCK, end)
                    finite = _step_from_python(
                        system, motion, record, prepared, damping, shapes, slopes, offset, stop
                    )
                if not finite:
                    _raise_not_finite(motion, system, positions)
                if progress is not None:
                    progress(int(motion.counts[0]), total, "rolling")
                if checkpoint is not None and time.monotonic() - saved > SAVE_EVERY:
                    checkpoint.save(_snapshot(motion, record, prepared))
                    saved = time.monotonic()
    finally:
        # at the end, and whatever stopped the run: it goes on from the last step done
        if checkpoint is not None and np.isfinite(motion.force[0]):
            checkpoint.save(_snapshot(motion, record, prepared))


def _step_from_python(
    system: System,
    motion: Motion,
    record: Record,
    law: SteppedLaw,
    damping: float,
    shapes: NDArray,
    slopes: NDArray,
    offset: int,
    stop: int,
) -> bool:
    """The loop of `asperity.kernels.modal.roll_steps` for a law that Python evaluates."""
    for step in range(int(motion.counts[0]) + 1, stop + 1):
        row = step - offset
        free = free_step(system, motion, shapes[row - 1], shapes[row], slopes[row])
        guess = 2.0 * motion.force[0] - motion.force[1]
        force, evaluations, converged = _solve_from_python(law, step, free, system.load, guess, damping)
        law.accept(step)
        complete_step(system, motion, record, step, shapes[row], slopes[row], force, evaluations, converged)
        if not np.isfinite(force):
            return False
    return True


def _solve_from_python(
    law: SteppedLaw,
    step: int,
    free: tuple[float, float, float, float],
    load: float,
    guess: float,
    damping: float,
) -> tuple[float, int, bool]:
    """The iteration of `asperity.kernels.modal.solve_contact` for a law that Python evaluates."""
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


def _snapshot(motion: Motion, record: Record, prepared: Prepared | SteppedLaw) -> dict[str, NDArray]:
    done = int(motion.counts[0]) + 1
    arrays = {f"motion.{name}": value.copy() for name, value in motion._asdict().items()}
    arrays |= {f"record.{name}": value[..., :done].copy() for name, value in record._asdict().items()}
    if not isinstance(prepared, Prepared):
        arrays |= {f"law.{name}": value for name, value in prepared.state().items()}
    return arrays


def restore(
    checkpoint: Checkpoint | None, motion: Motion, record: Record, prepared: Prepared | SteppedLaw
) -> None:
    """Take a run up where it was saved, if it was.

    Parameters
    ----------
    checkpoint : Checkpoint or None
        Where the state is kept.
    motion, record
        State and histories at the start; overwritten.
    prepared : Prepared or SteppedLaw
        The law on the path; a `SteppedLaw` is restored too.

    Raises
    ------
    InputError
        If what was saved is of another run.
    """
    arrays = checkpoint.load() if checkpoint is not None else None
    if arrays is None:
        return
    histories = {name: arrays[f"record.{name}"] for name in record._fields}
    same = arrays["motion.displacement"].shape == motion.displacement.shape and all(
        value.shape[:-1] == getattr(record, name).shape[:-1]
        and value.shape[-1] <= getattr(record, name).shape[-1]
        for name, value in histories.items()
    )
    if not same:
        remedy = "Clear what was kept, and roll anew."
        raise InputError("checkpoint", "a run with other modes, sensors or duration", "this run", remedy)
    for name in motion._fields:
        getattr(motion, name)[...] = arrays[f"motion.{name}"]
    for name, value in histories.items():
        getattr(record, name)[..., : value.shape[-1]] = value
    if not isinstance(prepared, Prepared):
        prefix = "law."
        prepared.restore({k[len(prefix) :]: v for k, v in arrays.items() if k.startswith(prefix)})


def _raise_not_finite(motion: Motion, system: System, positions: NDArray) -> None:
    step = int(motion.counts[0])
    raise ComputationError(
        f"the contact force is not finite at step {step}, time {step * system.time_step:.6g} s, "
        f"position {positions[step]:.6g} m",
        "a smaller time step, and check the force curve and the texture there",
    )
