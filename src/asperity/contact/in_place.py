"""One contact after the other on the same grid, as a body rolls along, without making anything anew."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from asperity.arguments import Array
from asperity.kernels.continuation import continue_rolling

if TYPE_CHECKING:
    from asperity.contact.halfspace import HalfSpace


class Found(NamedTuple):
    """A contact solved in place; its pressure stands in `ContactInPlace.pressure` until the next."""

    force: float  # N
    approach: float  # m
    overlap: float  # largest of the undeformed bodies at the approach asked for, m
    iterations: int  # of conjugate gradients
    converged: bool
    truncated: bool  # whether a noticeable share of the force acts on the window's edge


class ContactInPlace:
    """The contact of a body with the heights under it, unchecked and silent: look at `Found.converged`.

    The body (nx, ny), m, has the shape of the half-space; `rtol` is as in `HalfSpace.solve`.
    """

    def __init__(self, half_space: "HalfSpace", body: Array, rtol: float) -> None:
        self.half_space = half_space
        self.block = half_space.block(np.zeros(half_space.shape), body, np.zeros(1), np.zeros(1), 0, rtol)
        self.pressure, self.start = self.block.pressures[:, 0]

    def forget(self) -> None:
        """Let the next contact start from nothing."""
        self.block.solved[0] = 0

    def start_again(self) -> None:
        """Let the next contact start from the pressure of the last, whose window is the same."""
        self.start[:] = self.pressure
        self.block.solved[0] = 1

    def start_from(self, last: Array, before: Array, rows: int, rows_before: int) -> None:
        """Let the next contact start from the pressures of the last two, Pa, (nx, ny).

        The next is so many rows on from the last, as that was from the one before.
        """
        continue_rolling(last, before, rows, rows_before, self.half_space.pressure_cap, self.start)
        self.block.solved[0] = 1

    def solve(
        self, heights: Array, approach: float, compliance: float = 0.0, rtol: float | None = None
    ) -> Found:
        """Solve at an approach, m, or where it falls with the force by a compliance of the bodies, m/N.

        Heights under the body (nx, ny), m. In the second case `approach` is that without force: the contact
        and what the bodies yield are found together. Another `rtol` holds for this contact alone.
        """
        space, counts = self.half_space, self.block.counts
        counts[:] = 0
        self.block.approaches[0] = approach
        self.block.rows[:] = heights
        block = self.block._replace(
            compliance=compliance * space.cell_area, rtol=self.block.rtol if rtol is None else rtol
        )
        space.solve_block(block)
        overlap = approach - float(block.room.lowest.min())
        if not counts[0]:
            self.pressure[:] = 0.0
            return Found(0.0, approach, overlap, 0, True, False)
        force = float(block.totals[0, 0]) * space.cell_area
        _, iterations, unconverged, truncated = counts.tolist()
        level = float(block.levels[0, 0])
        return Found(force, approach + level, overlap + level, iterations, not unconverged, truncated > 0)
