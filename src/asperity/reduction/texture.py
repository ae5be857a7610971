"""The state-dependent line texture: what a point force follows at each state of the contact."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.errors import InputError
from asperity.kernels.along import splines_along


@dataclass(frozen=True, eq=False)
class StateTexture:
    """Filtered line textures along the path, one for each state (thesis Eq. 2.7).

    Between the approaches of the states the texture is interpolated linearly, outside them the nearest is
    used.
    """

    heights: NDArray[
        np.float64
    ]  # (s, m), at state i and position m, m, positive *away* from the contact (h = −z)
    approaches: NDArray[np.float64]  # (s,), of the states, m, increasing
    start: float  # position of the first point on the path, m
    spacing: float  # distance of the points, m

    def __post_init__(self) -> None:
        heights = np.atleast_2d(np.asarray(self.heights, dtype=float))
        approaches = np.atleast_1d(np.asarray(self.approaches, dtype=float))
        check_states("state texture", heights, approaches, self.spacing)
        object.__setattr__(self, "heights", heights)
        object.__setattr__(self, "approaches", approaches)

    @classmethod
    def unfiltered(cls, heights: ArrayLike, spacing: float, start: float = 0.0) -> StateTexture:
        """One line texture (m,) for all states, m, positive away from the contact, from a position on, m."""
        return cls(np.atleast_2d(np.asarray(heights, dtype=float)), np.zeros(1), start, spacing)

    def held_at(self, approach: float) -> StateTexture:
        """One line texture for all states: that at an approach, m."""
        states = self.approaches
        above = int(np.clip(np.searchsorted(states, approach), 1, max(len(states) - 1, 1)))
        lower, upper = above - 1, min(above, len(states) - 1)
        step = states[upper] - states[lower]
        share = float(np.clip((approach - states[lower]) / step, 0.0, 1.0)) if step else 0.0
        heights = (1.0 - share) * self.heights[lower] + share * self.heights[upper]
        return StateTexture.unfiltered(heights, self.spacing, self.start)

    def at(self, positions: ArrayLike) -> NDArray[np.float64]:
        """Texture (n, s), m, of every state at positions (n,) on the path, m, by cubic splines along it."""
        return along_path("state texture", self.heights, self.start, self.spacing, positions)


def check_states(
    what: str, values: NDArray[np.float64], approaches: NDArray[np.float64], spacing: float
) -> None:
    """Refuse values (s, m) at approaches (s,) and positions along a path whose shapes or values do not fit.

    Approaches and spacing in m; `what` they are is for the message.
    """
    if values.ndim != 2 or values.shape[0] != len(approaches) or values.shape[1] < 4:
        received = f"{values.shape} values for {len(approaches)} states"
        raise InputError(what, received, "an array (states, positions) with at least 4 positions")
    if not (np.all(np.isfinite(values)) and np.all(np.isfinite(approaches))):
        raise InputError(what, "NaN or infinite values", "finite numbers", "Fill missing points first.")
    if np.any(np.diff(approaches) <= 0.0):
        raise InputError(f"approaches of the {what}", approaches, "strictly increasing approaches (m)")
    if not (np.isfinite(spacing) and spacing > 0.0):
        raise InputError(f"spacing of the {what} (m)", spacing, "a finite positive number")


def along_path(
    what: str, values: NDArray[np.float64], start: float, spacing: float, positions: ArrayLike
) -> NDArray[np.float64]:
    """Natural cubic splines (n, s) of rows (s, m) along a path, at positions (n,), m.

    The rows are sampled at ``start + spacing * arange(m)``; `what` they are is for the message.
    """
    index = grid_index(what, values.shape[1], start, spacing, positions)
    return np.asarray(splines_along(np.ascontiguousarray(values, dtype=float), index))


def grid_index(
    what: str, points: int, start: float, spacing: float, positions: ArrayLike
) -> NDArray[np.float64]:
    """Places, from 0 to points − 1, of positions on the path, m, on the grid of a state function.

    Its points begin at `start` and are a spacing apart, m; `what` is known there is for the message.
    """
    index = (np.atleast_1d(np.asarray(positions, dtype=float)) - start) / spacing
    last = points - 1
    slack = 1e-6  # of a spacing: rounding of the positions
    if index.min() < -slack or index.max() > last + slack:
        raise InputError(
            "path (m)",
            f"{start + spacing * index.min():.6g} to {start + spacing * index.max():.6g}",
            f"{start:.6g} to {start + spacing * last:.6g}, where the {what} is known",
            "Shorten the duration or provide a longer texture.",
        )
    return np.clip(index, 0.0, last)
