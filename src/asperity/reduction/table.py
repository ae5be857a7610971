"""The table of scanned forces F(x, approach) of a path."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.contact.accuracy import FORCE_ACCURACY
from asperity.errors import InputError
from asperity.kernels.along import OVERLAP, splines_along
from asperity.reduction.stored import StoredForces, columns
from asperity.reduction.texture import check_states, grid_index

FALL = 2.0 * FORCE_ACCURACY
"""Fall of the force from state to state, relative to the largest, that an iterative solver may leave."""
PIECE = 8192
"""Positions worked on in one go."""


@dataclass(frozen=True, eq=False)
class ForceTable:
    """Contact force at positions of the path and states of the contact, at least two."""

    # (s, m), at state i and position m, N, not negative; not falling with the approach but by accuracy
    forces: NDArray[np.float64] | StoredForces
    approaches: NDArray[np.float64]  # (s,), of the states, m, increasing
    start: float  # position of the first point on the path, m
    spacing: float  # distance of the points, m
    # (m,), approach at which contact begins, m; by default it is estimated from the forces
    touches: NDArray[np.float64] | None = None

    def __post_init__(self) -> None:
        forces = self.forces
        if not isinstance(forces, StoredForces):
            forces = np.asarray(forces, dtype=float)
        approaches = np.asarray(self.approaches, dtype=float)
        _check_forces(forces, approaches, self.spacing)
        if self.touches is not None and (
            np.shape(self.touches) != forces.shape[1:] or not np.all(np.isfinite(self.touches))
        ):
            allowed = f"{forces.shape[1]} finite approaches, one a position"
            raise InputError("first touches of the force table", f"shape {np.shape(self.touches)}", allowed)
        object.__setattr__(self, "forces", forces)
        object.__setattr__(self, "approaches", approaches)

    def at(self, positions: ArrayLike) -> NDArray[np.float64]:
        """Forces (n, s), N, at positions (n,), m, by cubic splines: not negative, not falling with states."""
        count = self.forces.shape[1]
        index = grid_index("force table", count, self.start, self.spacing, positions)
        result = np.empty((index.size, len(self.approaches)))
        for i in range(0, index.size, PIECE):
            piece = index[i : i + PIECE]
            first = max(0, int(piece.min()) - OVERLAP)
            stop = min(count, int(piece.max()) + 2 + OVERLAP)
            known = np.ascontiguousarray(columns(self.forces, first, stop))
            result[i : i + PIECE] = splines_along(known, piece - first)
        # a spline may undershoot beside a place where contact is lost
        return np.maximum.accumulate(np.maximum(result, 0.0, out=result), axis=1)

    def touch_at(self, positions: ArrayLike) -> NDArray[np.float64] | None:
        """Approach at first touch at positions (n,), m, interpolated linearly; None where it is not known."""
        if self.touches is None:
            return None
        at = self.start + self.spacing * np.arange(self.forces.shape[1])
        return np.interp(np.asarray(positions, dtype=float), at, self.touches)


def _check_forces(
    forces: NDArray[np.float64] | StoredForces, approaches: NDArray[np.float64], spacing: float
) -> None:
    """Refuse forces that no contact has, piece by piece."""
    lowest, largest, fall = 0.0, 0.0, 0.0
    for first in range(0, forces.shape[-1], PIECE):
        # the last four points again where fewer are left
        piece = columns(forces, min(first, max(0, forces.shape[-1] - 4)), first + PIECE)
        check_states("force table", piece, approaches, spacing)
        lowest, largest = min(lowest, piece.min()), max(largest, piece.max())
        fall = min(fall, np.diff(piece, axis=0).min(initial=0.0))
    if len(approaches) < 2:
        raise InputError(
            "force table", "one state", "at least two states", "Give contact.approaches two or more."
        )
    if lowest < 0.0:
        raise InputError("force table (N)", lowest, "forces of zero or more")
    if fall < -FALL * largest:
        raise InputError(
            "force table", "forces that fall while the approach grows", "forces that rise with the approach"
        )
