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
    touches : ndarray (m,), optional
        Approach at which contact begins at each position, m; by default it is
        estimated from the forces.

    Raises
    ------
    InputError
        If shapes, spacing or values do not fit.
    """

    forces: NDArray
    approaches: NDArray
    start: float
    spacing: float
    touches: NDArray | None = None

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
        if self.touches is not None and (
            np.shape(self.touches) != forces.shape[1:] or not np.all(np.isfinite(self.touches))
        ):
            allowed = f"{forces.shape[1]} finite approaches, one a position"
            raise InputError("first touches of the force table", f"shape {np.shape(self.touches)}", allowed)
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

    def touch_at(self, positions: ArrayLike) -> NDArray | None:
        """Approach at first touch at given positions, interpolated linearly.

        Parameters
        ----------
        positions : array_like (n,)
            Positions on the path, m.

        Returns
        -------
        ndarray (n,) or None
            Approaches, m; None where they are not known.
        """
        if self.touches is None:
            return None
        at = self.start + self.spacing * np.arange(self.forces.shape[1])
        return np.interp(np.asarray(positions, dtype=float), at, self.touches)
