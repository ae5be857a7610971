"""What rolls: bodies and structures, and contacts between any two, each with a trajectory along each side."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from asperity.arguments import Array, Flags, Integers, require
from asperity.laws.spec import Law
from asperity.rolling.trajectory import Trajectory, Values
from asperity.structures.body import Body
from asperity.structures.modal import Modal
from asperity.structures.rail_poles import RailBetween
from asperity.written_numbers import count_of


@dataclass(frozen=True, eq=False)
class Side:
    """A structure on one side of a contact, which opens with its displacement times the sign."""

    structure: int
    trajectory: Trajectory
    sign: float | Array = 1.0  # of all its modes, or of each (m,)


@dataclass(frozen=True, eq=False)
class RollingContact:
    """A contact of a body with structures, or of structures with each other."""

    law: Law
    positions: Values  # where the law is laid out, m; of one that takes several, a column for each
    sides: tuple[Side, ...] = ()
    heights: Values | None = None  # what is there beside the law's texture, m, positive out of the material


@dataclass(frozen=True, eq=False)
class Mechanism:
    """Bodies and structures, and the contacts between them.

    The contacts of the bodies come first, numbered through the bodies as in `roll_bodies`; those beyond them
    have structures on both sides. A body between two structures has two contacts; bodies that touch each
    other are one `Body` with both of their coordinates, whose contact is opened by the one and the other.

    Parameters
    ----------
    structures : sequence of Modal or RailBetween
        By their modes, as `asperity.structures.modal` or `asperity.structures.ring`; rotating frames too. One
        may be a rail (`asperity.structures.rail_poles`), on which contacts keep their distances, each with
        the rail as its only side.
    bodies : sequence of Body
        Their `places` along the path are not looked at.
    contacts : sequence of RollingContact
        One for each contact.
    pressed : sequence of ndarray, optional
        Constant forces on the modes of each structure.
    """

    structures: Sequence[Modal | RailBetween]
    bodies: Sequence[Body]
    contacts: Sequence[RollingContact]
    pressed: Sequence[Array] = field(default_factory=tuple)

    def __post_init__(self) -> None:
        touching = sum(len(body.places) for body in self.bodies)
        short = f"{len(self.contacts)} for {count_of(touching, 'contact')} of the bodies"
        allowed = "one for each contact of a body, or more"
        require(len(self.contacts) >= max(touching, 1), "contacts", short, allowed)
        last = len(self.structures) - 1
        for contact in self.contacts:
            known = all(0 <= side.structure <= last for side in contact.sides)
            require(known, "structure of a contact", "one that is not there", f"0 to {last}")
        rails = [isinstance(each, RailBetween) for each in self.structures]
        require(sum(rails) <= 1, "structures", count_of(sum(rails), "rail"), "one at most")
        for contact in self.contacts if any(rails) else ():
            signs = [side.sign for side in contact.sides]
            alone = not any(rails[side.structure] for side in contact.sides) or signs == [1.0]
            allowed = "the rail alone, with a sign of 1"
            require(alone, "sides of a contact on a rail", f"{len(signs)} of signs {signs}", allowed)

    @property
    def rail(self) -> RailBetween | None:
        """The rail, if it is one that is rolled over."""
        return next((each for each in self.structures if isinstance(each, RailBetween)), None)

    @property
    def on_rail(self) -> Flags:
        """Which contacts are on the rail (n,)."""
        sides = ([self.structures[side.structure] for side in each.sides] for each in self.contacts)
        return np.array([any(isinstance(each, RailBetween) for each in every) for every in sides])

    @property
    def first_modes(self) -> Integers:
        """Place of each structure among all modes, and their number at the end."""
        counts = [len(_of_modes(each, "natural_frequencies")) for each in self.structures]
        return np.concatenate([[0], np.cumsum(counts, dtype=np.int64)])

    @property
    def natural_frequencies(self) -> Array:
        """Undamped, of all modes of all structures (s,), Hz."""
        every = [_of_modes(each, "natural_frequencies") for each in self.structures]
        return np.concatenate([np.zeros(0), *every])

    @property
    def damping_ratios(self) -> Array:
        """Of all modes (s,)."""
        return np.concatenate([np.zeros(0), *(_of_modes(each, "damping_ratios") for each in self.structures)])

    @property
    def constant(self) -> Array:
        """Constant forces on all modes (s,), or none."""
        return np.concatenate([np.zeros(0), *self.pressed])

    def row(self, structure: int, values: Array) -> Array:
        """Row over all modes (s,) of values for the modes of one structure."""
        first = self.first_modes
        row = np.zeros(first[-1])
        row[first[structure] : first[structure + 1]] = values
        return row

    def still(self) -> Sequence[Body]:
        """Its bodies, and one that does not move for the contacts beyond them."""
        beyond = len(self.contacts) - sum(len(body.places) for body in self.bodies)
        if not beyond:
            return self.bodies
        none = np.zeros((1, 1))
        rest = Body(np.ones((1, 1)), none, none, np.zeros((beyond, 1)), np.zeros(1), np.zeros(beyond))
        return [*self.bodies, rest]


def _of_modes(structure: Modal | RailBetween, name: str) -> Array:
    """Values of its modes, of which a rail has none."""
    return np.zeros(0) if isinstance(structure, RailBetween) else np.asarray(getattr(structure, name))
