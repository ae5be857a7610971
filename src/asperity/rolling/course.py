"""A mechanism in the course of time: mode shapes under its contacts, and their laws, laid out as it goes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import SimpleNamespace
from typing import Any

import numpy as np

from asperity.arguments import Array, NDArray
from asperity.kernels.pointforce import SHIFTED, Prepared, evaluate_all
from asperity.laws.spec import SteppedLaw, settles
from asperity.rolling.mechanism import Mechanism, RollingContact
from asperity.rolling.steps import padded
from asperity.rolling.trajectory import Trajectory, at_steps
from asperity.structures.modal import Modal
from asperity.structures.rail_poles import RailBetween

ALONG = ("planes", "values", "slopes", "touches")
"""What a `Prepared` law has at every step."""
FIXED = tuple(name for name in Prepared._fields if name not in ALONG)
"""What it has once."""
CHECKED = 2**14
"""Steps at once of which is asked whether the laws went beyond what they were made for."""


@dataclass(eq=False)
class Course:
    """A mechanism at the time steps of a run, counted from where the run-in begins.

    Laws that are solved in every step remember where they were: then all are laid out on all the way.

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
    whole : bool
        Whether laws are laid out on all the way at once, not piece by piece.
    """

    mechanism: Mechanism
    time_step: float
    total: int
    settled: int = 0
    whole: bool = False

    def __post_init__(self) -> None:
        self.bodies = self.mechanism.still()
        self.laws = [contact.law for contact in self.mechanism.contacts]
        self.contacts = len(self.laws)
        # approach of each contact that is within its data at all steps laid out; and where these begin
        self.within = np.full(self.contacts, np.inf)
        self.begun = self.total

    @cached_property
    def everywhere(self) -> list[Any]:
        """Laws that are laid out on all the way; none where they are laid out piece by piece."""
        contacts = self.mechanism.contacts
        whole = self.whole or not all(isinstance(laid_out(each, range(1)), Prepared) for each in contacts)
        return [laid_out(contact, range(self.total + 1)) for contact in contacts] if whole else []

    @cached_property
    def at_start(self) -> list[Any]:
        """Laws whose first step is the first of all."""
        return self.everywhere or self.pieces(range(1))

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
                modes = slice(first[side.structure], first[side.structure + 1])
                seen, slopes, rate = _seen_along(structure, side.trajectory, steps)
                for into, values, factor in ((shapes, seen, side.sign), (rates, slopes, side.sign * rate)):
                    if side.structure in written:
                        into[:, k, modes] += factor * values
                    else:
                        np.multiply(factor, values, out=into[:, k, modes])
                written.add(side.structure)

    def pieces(self, steps: range) -> list[Any]:
        """Laws of all contacts at some steps."""
        if self.everywhere:
            return [self.piece(k, steps) for k in range(self.contacts)]
        return laid_together(self.mechanism.contacts, steps)

    def piece(self, k: int, steps: range) -> Any:
        """That of one contact."""
        if not self.everywhere:
            return laid_out(self.mechanism.contacts[k], steps)
        return _at_rows(self.everywhere[k], steps)

    def laid(self, steps: range) -> Any:
        """Laws at some steps, as `asperity.kernels.stepping.solve_prepared` takes them."""
        pieces = self.pieces(steps)
        self.within = np.minimum(self.within, list(map(_within, pieces)))
        self.begun = min(self.begun, steps.start)
        fixed, sizes = self._fixed if self.everywhere else _fixed_of(pieces)
        return Prepared(**fixed, **_stacked(pieces, ALONG)), sizes

    @cached_property
    def _fixed(self) -> tuple[dict[str, Any], NDArray[np.int64]]:
        return _fixed_of(self.everywhere)

    def beyond(self, approach: Array) -> list[int]:
        """Steps at which each law was beyond its data, of approaches that it saw at all steps (n, t), m."""
        # a run that was taken up has not laid out all
        doubted = (approach.max(axis=1) > self.within) | (self.begun > 0)
        counts = [0] * self.contacts
        for k in np.flatnonzero(doubted & [isinstance(law, Prepared) for law in self.at_start]).tolist():
            for first in range(0, self.total + 1, CHECKED):
                steps = range(first, min(first + CHECKED, self.total + 1))
                seen = np.ascontiguousarray(at_steps(approach[k], steps))
                counts[k] += int(evaluate_all(self.piece(k, steps), seen, 0)[2])
        return counts


def _seen_along(structure: Modal, trajectory: Trajectory, steps: range) -> tuple[Array, Array, Array | float]:
    """Mode shapes and their slopes (k, m) along a trajectory, and its rates, (k, 1) or one for all."""
    if trajectory.spacing is None or len(steps) == 1:
        return *structure.shapes(trajectory.places(steps)), trajectory.rates(steps)[:, None]
    start = float(trajectory.places(steps[:1])[0])
    along = structure.shapes_along(start, trajectory.spacing * steps.step, len(steps))
    return *along, float(trajectory.rates(steps[:1])[0])


def laid_out(contact: RollingContact, steps: range) -> Any:
    """The law of a contact, `Prepared` or a `SteppedLaw`, whose textures are raised by its heights."""
    return _at_height(contact, contact.law.prepare(contact.positions(steps)), steps)


def laid_together(contacts: Sequence[RollingContact], steps: range) -> list[Prepared]:
    """As `laid_out`, of contacts with compiled laws: one that several have is laid out once, for all."""
    alike: dict[int, list[int]] = {}
    for k, contact in enumerate(contacts):
        alike.setdefault(id(contact.law), []).append(k)
    found = {}
    for members in alike.values():
        along = np.concatenate([contacts[k].positions(steps) for k in members])
        law: Any = contacts[members[0]].law.prepare(along)
        for i, k in enumerate(members):
            own = _at_rows(law, range(i * len(steps), (i + 1) * len(steps)))
            found[k] = _at_height(contacts[k], own, steps)
    return [found[k] for k in range(len(contacts))]


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


def _within(law: Prepared) -> float:
    """Approach up to which a law is within its data wherever it is laid out, m."""
    lowest = float(law.values.min()) if law.form == SHIFTED else 0.0
    return float(law.planes.min()) + law.upper + lowest


def _stacked(prepared: Sequence[Any], names: Iterable[str]) -> dict[str, Any]:
    """Fields of `Prepared` laws of n contacts by their names, (n, ...), padded to the largest."""
    return {name: padded([np.asarray(getattr(law, name)) for law in prepared]) for name in names}


def _fixed_of(prepared: Sequence[Any]) -> tuple[dict[str, Any], NDArray[np.int64]]:
    """What no step changes, and numbers of states and of knots (2, n)."""
    sizes = [[len(getattr(law, name)) for law in prepared] for name in ("states", "knots")]
    return _stacked(prepared, FIXED), np.array(sizes)
