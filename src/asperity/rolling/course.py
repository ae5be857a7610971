"""A mechanism in the course of time: mode shapes under its contacts, and their laws, laid out as it goes."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from types import SimpleNamespace
from typing import Any

import numpy as np

from asperity.arguments import Array, Flags, Integers
from asperity.kernels.curves import write_seen
from asperity.kernels.pointforce import SHIFTED, SLICED, Prepared, evaluate_all
from asperity.laws.spec import SteppedLaw, settles
from asperity.rolling.mechanism import Mechanism, RollingContact
from asperity.rolling.steps import padded
from asperity.rolling.trajectory import Trajectory, at_steps
from asperity.structures.modal import Modal
from asperity.structures.rail_poles import RailBetween

ALONG = ("planes", "values", "slopes", "touches")
"""What a `Prepared` law has at every step."""


@dataclass(eq=False)
class Course:
    """A mechanism at the time steps of a run, counted from where the run-in begins.

    Laws are laid out piece by piece; those that are solved in every step remember where they were, so that
    all of their way is one piece.

    Parameters
    ----------
    mechanism : Mechanism
        Structures, bodies and contacts.
    time_step : float
        s.
    total : int
        Steps.
    settled : int
        Steps of the run-in.
    """

    mechanism: Mechanism
    time_step: float
    total: int
    settled: int = 0

    def __post_init__(self) -> None:
        self.bodies = self.mechanism.still()
        self.laws = [contact.law for contact in self.mechanism.contacts]
        self.contacts = len(self.laws)

    @cached_property
    def stepped(self) -> dict[int, SteppedLaw]:
        """Laws that are solved in every step, by their contacts; all are asked whether the way is theirs."""
        ends = range(0, self.total + 1, max(self.total, 1))
        contacts = enumerate(self.mechanism.contacts)
        other = [each for each in contacts if not isinstance(laid_out(each[1], ends), Prepared)]
        return {k: laid_out(contact, range(self.total + 1)) for k, contact in other}

    @cached_property
    def at_start(self) -> list[Any]:
        """Laws whose first step is the first of all."""
        return self.pieces(range(1))

    def place(self, contact: int, step: int) -> float:
        """Position of a contact at a step, m."""
        return float(self.mechanism.contacts[contact].positions(range(step, step + 1)).flat[0])

    def shapes_at(self, steps: range) -> tuple[Array, Array]:
        """Mode shapes under the contacts at some steps (k, n, s), kg^(−1/2), and their rates, per second."""
        shapes, rates = np.zeros((2, len(steps), self.contacts, self.mechanism.first_modes[-1]))
        self.write_shapes(steps, shapes, rates)
        return shapes, rates

    def write_shapes(self, steps: range, shapes: Array, rates: Array) -> None:
        """Write `shapes_at` into arrays that are zero, or were written by this before."""
        first = self.mechanism.first_modes
        for k, contact in enumerate(self.mechanism.contacts):
            written: set[int] = set()
            for side in contact.sides:
                structure = self.mechanism.structures[side.structure]
                if isinstance(structure, RailBetween):
                    continue
                seen, slopes, rate = _seen_along(structure, side.trajectory, steps)
                signs = np.full(seen.shape[1:], side.sign, dtype=float)
                where = side.structure in written, k, first[side.structure]
                write_seen(seen, signs, np.ones(1), *where, shapes)
                write_seen(slopes, signs, rate, *where, rates)
                written.add(side.structure)

    def pieces(self, steps: range) -> list[Any]:
        """Laws of all contacts at some steps, those that are solved in every step at all."""
        if not self.stepped:
            return laid_together(self.mechanism.contacts, steps)
        contacts = enumerate(self.mechanism.contacts)
        return [self.stepped[k] if k in self.stepped else laid_out(each, steps) for k, each in contacts]


def _seen_along(structure: Modal, trajectory: Trajectory, steps: range) -> tuple[Array, Array, Array]:
    """Mode shapes and their slopes (k, m) along a trajectory, and its rates, (k,) or one for all."""
    if trajectory.spacing is None or len(steps) == 1:
        return *structure.shapes(trajectory.places(steps)), trajectory.rates(steps)
    start = float(trajectory.places(steps[:1])[0])
    along = structure.shapes_along(start, trajectory.spacing * steps.step, len(steps))
    return *along, trajectory.rates(steps[:1])


def laid_out(contact: RollingContact, steps: range) -> Any:
    """The law of a contact, `Prepared` or a `SteppedLaw`, whose textures are raised by its heights."""
    return _at_height(contact, contact.law.prepare(contact.positions(steps)), steps)


def laid_together(contacts: Sequence[RollingContact], steps: range) -> list[Any]:
    """As `laid_out`: a compiled law that several contacts have is laid out once, for all of them."""
    of_laws: dict[int, list[int]] = {}
    for k, contact in enumerate(contacts):
        of_laws.setdefault(id(contact.law), []).append(k)
    found = {}
    for members in of_laws.values():
        along = np.concatenate([contacts[k].positions(steps) for k in members])
        law = contacts[members[0]].law.prepare(along)
        for i, k in enumerate(members):
            if isinstance(law, Prepared):
                own = _at_rows(law, range(i * len(steps), (i + 1) * len(steps)))
                found[k] = _at_height(contacts[k], own, steps)
            else:
                found[k] = laid_out(contacts[k], steps)
    return [found[k] for k in range(len(contacts))]


def alike(pieces: Sequence[tuple[int, Prepared]]) -> list[tuple[list[int], Prepared]]:
    """Contacts whose laws differ in what they have at every step alone, with their first steps as one law."""
    sharing: dict[Any, dict[int, Prepared]] = {}
    for k, law in pieces:
        shared = [each for name, each in law._asdict().items() if name not in ALONG]
        key = tuple(id(each) if isinstance(each, np.ndarray) else each for each in shared)
        sharing.setdefault(key, {})[k] = law
    return [(list(of), _first_steps(list(of.values()))) for of in sharing.values()]


def _first_steps(laws: Sequence[Prepared]) -> Prepared:
    along: dict[str, Any] = {name: np.concatenate([getattr(law, name)[:1] for law in laws]) for name in ALONG}
    return laws[0]._replace(**along)


def _at_rows(law: Prepared, rows: range) -> Prepared:
    along: dict[str, Any] = {name: at_steps(getattr(law, name), rows) for name in ALONG}
    return law._replace(**along)


def _at_height(contact: RollingContact, law: Any, steps: range) -> Any:
    """A law on the positions of a contact at some steps, as it is where bodies are closer by its heights."""
    if contact.heights is None:
        return law
    heights = contact.heights(steps)
    return law._replace(planes=law.planes - heights) if isinstance(law, Prepared) else _raised(law, heights)


def _raised(law: SteppedLaw, heights: Array) -> SimpleNamespace:
    """A law that is solved in every step, as it is where bodies are closer by heights (steps,), m."""

    def evaluate(step: int, approach: float) -> tuple[float, float]:
        return law.evaluate(step, approach + float(heights[step]))

    def settle(step: int, approach: float, compliance: float) -> float:
        assert settles(law)
        return law.settle(step, approach + float(heights[step]), compliance)

    other = {name: getattr(law, name) for name in ("accept", "state", "restore", "warn_of_flaws")}
    return SimpleNamespace(evaluate=evaluate, **other, **({"settle": settle} if settles(law) else {}))


def in_contact(law: Prepared | SteppedLaw, first: int, force: Array, approach: Array) -> Flags:
    """Whether surfaces touch from a step of a piece on, by force, N, and approach as the law sees it, m (n,).

    Always where the contact can pull.
    """
    if isinstance(law, Prepared):
        if law.bilateral:
            return np.ones(force.shape, dtype=bool)
        if law.damped_in_flight:
            force = evaluate_all(law, approach, first)[0]
    return force > 0.0


def steps_beyond(law: Prepared, first: int, approach: Array) -> int:
    """Number of steps from one of a piece on at which its law is beyond its data, at approaches (n,), m."""
    lowest = float(law.values.min()) if law.form in (SHIFTED, SLICED) else 0.0
    if approach.max() <= float(law.planes.min()) + law.upper + lowest - law.film.thickness:  # as mostly
        return 0
    return int(evaluate_all(law, approach, first)[2])


def stacked(pieces: Sequence[Any]) -> tuple[Prepared, Integers]:
    """Laws of n contacts as `asperity.kernels.stepping.solve_prepared` takes them, padded to the largest.

    And numbers of states and of knots (2, n).
    """
    sizes = [[len(getattr(law, name)) for law in pieces] for name in ("states", "knots")]
    arrays: dict[str, Any] = {
        name: padded([np.asarray(getattr(law, name)) for law in pieces]) for name in Prepared._fields
    }
    return Prepared(**arrays), np.array(sizes)


def laid_over(stack: Prepared, pieces: Sequence[Prepared]) -> None:
    """Lay later pieces of the same laws, no longer ones, into what `stacked` has made of the first."""
    for name in ALONG:
        for room, law in zip(getattr(stack, name), pieces, strict=True):
            part = getattr(law, name)
            room[tuple(map(slice, part.shape))] = part
