"""The table of scanned forces F(x, approach) of a path."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.errors import InputError
from asperity.reduction.texture import along_path, check_states


@dataclass(frozen=True, eq=False)
class ForceTable:
    """Contact force at positions of the path and states of the contact.

    Parameters
    ----------
    forces : ndarray (s, m)
        Force at state i and position m, N, not negative and not falling with the approach.
    approaches : ndarray (s,)
        Approaches of the states, m, increasing; at least two.
    start : float
        Position of the first point on the path, m.
    spacing : float
        Distance of the points, m.

    Raises
    ------
    InputError
        If shapes, spacing or values do not fit.
    """

    forces: NDArray
    approaches: NDArray
    start: float
    spacing: float

    def __post_init__(self) -> None:
        forces = np.asarray(self.forces, dtype=float)
        approaches = np.asarray(self.approaches, dtype=float)
        check_states("force table", forces, approaches, self.spacing)
        if len(approaches) < 2:
            raise InputError("force table", "one state", "at least two states", "Scan at more approaches.")
        if forces.min() < 0.0:
            raise InputError("force table (N)", forces.min(), "forces of zero or more")
        # what an iterative contact solver leaves of a plateau is no fall
        if np.diff(forces, axis=0).min() < -1e-6 * forces.max():
            raise InputError(
                "force table",
                "forces that fall while the approach grows",
                "forces that rise with the approach",
            )
        object.__setattr__(self, "forces", forces)
        object.__setattr__(self, "approaches", approaches)

    def at(self, positions: ArrayLike) -> NDArray:
        """Forces at given positions, by cubic splines along the path.

        Parameters
        ----------
        positions : array_like (n,)
            Positions on the path, m.

        Returns
        -------
        ndarray (n, s)
            Force of every state, N; not negative, not falling with the approach.

        Raises
        ------
        InputError
            If a position lies outside the table.
        """
        forces = along_path("force table", self.forces, self.start, self.spacing, positions)
        # a spline may undershoot beside a place where contact is lost
        return np.maximum.accumulate(np.maximum(forces, 0.0), axis=1)
