"""Advancing bodies on their contacts to the end of the path: compiled or from Python, resumable."""

import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity.arguments import NDArray
from asperity.errors import ComputationError, InputError
from asperity.kernels import stepping
from asperity.kernels.pointforce import DRY, Prepared, evaluate
from asperity.laws.spec import SettlingLaw, SteppedLaw, settles
from asperity.progress import Progress
from asperity.rolling.course import Course, in_contact, laid_over, stacked, steps_beyond
from asperity.store import Checkpoint
from asperity.threads import refuse_to_go_on
from asperity.written_numbers import rounded

Free = tuple[float, float, float, float]
STEPPED_BLOCK = 8  # steps between looks at the clock when a law is evaluated from Python
SAVE_EVERY = 10.0  # s
STEPPED_TOLERANCE = 1e-6  # of the force plus the load; a law stepped from Python iterates itself
SHAPES_AT_ONCE = 2**18
"""Mode shapes that are held at once, of all contacts: they stay in the processor's cache."""
LONGEST, LEAST = 4096, 64
"""Steps whose mode shapes are held at once, at most and at least."""


@dataclass(eq=False)
class Stepper:
    """Bodies at rest on what they touch, under laws of their n contacts, to be advanced step by step."""

    course: Course
    system: stepping.System
    motion: stepping.Motion
    largest: float  # contact force that makes no sense any more, N
    softest: float  # largest static compliance under a contact on its path, m/N; infinite if nothing holds it
    displacements: bool  # whether those of the sensors are recorded
    at_contacts: bool  # whether approaches and displacements at the contacts are

    def __post_init__(self) -> None:
        n = self.course.contacts
        steps = self.course.total + 1
        b, states = self.system.core_pressed.shape
        sensors, modes = self.system.sensors.shape
        self.length = int(np.clip(SHAPES_AT_ONCE // max(n * modes, 1), LEAST, LONGEST))
        moved = sensors if self.displacements else 0
        widths = (n,), (n,), (n,), (n,), (b, states // 2), (sensors,), (moved,)
        # of the chunk in work, a row for each step, and of all steps, which come last
        self.piece = stepping.Histories(*(np.zeros((self.length + 1, *width)) for width in widths))
        kept = (n,), *(3 * ((n * self.at_contacts,),)), *widths[4:]
        self.record = stepping.Histories(*(np.zeros((*width, steps)) for width in kept))
        self.stepped = self.course.stepped
        # what laws say of the steps done: whether surfaces touch; least and largest approach from the plane
        # of each law, m, known of those that are looked up; and steps at which it was beyond its data
        self.touching = np.zeros((n, steps), dtype=bool)
        self.visited = np.array(
            [(-np.inf, np.inf) if k in self.stepped else (np.inf, -np.inf) for k in range(n)]
        )
        self.beyond = np.zeros(n, dtype=np.int64)
        self.offset = self.end = -1
        # one place for all chunks: fresh memory takes longer than what is computed
        self.shapes, self.rates = np.zeros((2, self.length + 1, n, modes))
        self.pieces: list[Any] = []
        self.laid: Any = None
        self.motion.counts[0] = -1
        closer = self.motion.approach[0] - self.motion.approach[1]
        self._advance(0, np.inf)
        self.motion.approach[1] = self.motion.approach[0] - closer
        self.energies_at_start = self.energies()
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
        for body, core in zip(self.course.bodies, motion.core, strict=True):
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
                refuse_to_go_on()
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
        state = (self.system, self.motion, self.piece)
        along = (self.shapes, self.rates, self.offset)
        if not self.stepped:
            sound = bool(stepping.roll_prepared(*state, self.laid, *along, stop, largest))
        else:
            sound = self._advance_stepped(state, along, range(done + 1, stop + 1), largest)
        self._keep(done + 1, int(self.motion.counts[0]) + 1)
        if sound:
            self._look(done + 1, stop + 1)
        return sound

    def _keep(self, first: int, stop: int) -> None:
        """Keep the histories of steps that were done."""
        for whole, piece in zip(self.record, self.piece, strict=True):
            if whole.size:
                whole[..., first:stop] = np.moveaxis(piece[first - self.offset : stop - self.offset], 0, -1)

    def _advance_stepped(
        self, state: tuple[Any, ...], along: tuple[Any, ...], steps: range, largest: float
    ) -> bool:
        loops = stepping.solve_contacts.py_func, self._solve
        for step in steps:
            if not stepping.roll.py_func(*loops, *state, self.pieces, *along, step, largest):
                return False
            for law in self.stepped.values() if step else ():
                law.accept(step)
        return True

    def _look(self, first: int, stop: int) -> None:
        """Note what laws say of steps that were done: without what softened contacts took of approaches."""
        done = slice(first, stop)
        row = first - self.offset
        rows = slice(row, stop - self.offset)
        force = self.piece.contact_force[rows]
        seen = np.ascontiguousarray(
            (self.piece.relative_displacement[rows] - self.system.softening * force).T
        )
        force = np.ascontiguousarray(force.T)
        for k, law in enumerate(self.pieces):
            self.touching[k, done] = in_contact(law, row, force[k], seen[k])
            if isinstance(law, Prepared):
                from_plane = seen[k] - law.planes[row : row + stop - first]
                self.visited[k, 0] = min(self.visited[k, 0], from_plane.min())
                self.visited[k, 1] = max(self.visited[k, 1], from_plane.max())
                self.beyond[k] += steps_beyond(law, row, seen[k])

    def _hold(self, step: int) -> None:
        """Make ready the chunk of a step, whose bounds do not depend on where a run was taken up."""
        offset = max(step - 1, 0) // self.length * self.length
        if offset == self.offset:
            return
        self.offset = offset
        self.end = min(offset + self.length, self.course.total)
        steps = range(offset, self.end + 1)
        count = len(steps)
        if self.shapes.shape[2]:
            self.course.write_shapes(steps, self.shapes[:count], self.rates[:count])
        self.pieces = self.course.pieces(steps)
        if self.laid is not None:
            laid_over(self.laid[0], self.pieces)
        elif not self.stepped:  # one kernel serves any number and mix
            self.laid = stacked(self.pieces)

    def _solve(
        self, laws: Any, k: int, row: int, free: Free, load: float, guess: float, again: bool
    ) -> stepping.Found:
        """As `asperity.kernels.stepping.solve_prepared`, by any law.

        One that settles with the bodies does without iteration, but where its damper engages or lets go.
        """
        law = laws[k]
        damping = float(self.course.laws[k].damping)
        solve = stepping.solve_law.py_func
        if isinstance(law, Prepared):
            how = damping, law.damped_in_flight, stepping.FORCE_TOLERANCE, again
            return solve(evaluate, law, law.film, row, free, load, guess, *how)
        step = self.offset + row
        if settles(law) and (settled := _settled(law, step, free, damping)) is not None:
            return stepping.Found(*settled, 1, stepping.FOUND, stepping.CURVED)
        return solve(_evaluate, law, DRY, step, free, load, guess, damping, False, STEPPED_TOLERANCE, False)

    def _ran_away(self) -> ComputationError:
        motion = self.motion
        course = self.course
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
        state |= {"seen.visited": self.visited.copy(), "seen.beyond": self.beyond.copy()}
        for k, law in self.stepped.items():
            state |= {f"law.{k}.{name}": value for name, value in law.state().items()}
        return state

    def _histories(self, state: dict[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
        """Records up to a state."""
        done = int(state["motion.counts"][0]) + 1
        return {name: value[..., :done].copy() for name, value in self._records().items()}

    def _records(self) -> dict[str, NDArray[Any]]:
        records = self.record._asdict() | {"touching": self.touching}
        return {f"record.{name}": value for name, value in records.items()}

    def _restore(self, checkpoint: Checkpoint) -> None:
        """Take the run up where it was saved, if it was: state, histories, and what laws remember."""
        arrays = checkpoint.load()
        if arrays is None:
            return
        ours = {f"motion.{name}": value for name, value in self.motion._asdict().items()}
        ours |= {"seen.visited": self.visited, "seen.beyond": self.beyond} | self._records()
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
