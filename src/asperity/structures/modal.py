"""What a structure that is rolled over offers by its modes."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray


class Modal(Protocol):
    """A linear structure as the sum of its modes along a path, mass-normalised, displacement along the force.

    Each mode obeys q″ + 2ζω q′ + ω² q = Σ φ(x_k) F_k over the contacts k; the structure is displaced by
    Σ φ(x) q. A mode with ω = 0 is one of a rigid body that nothing holds.
    """

    @property
    def natural_frequencies(self) -> NDArray[np.float64]:
        """Undamped, of all modes (m,), Hz."""
        ...

    @property
    def damping_ratios(self) -> NDArray[np.float64]:
        """ζ of all modes (m,)."""
        ...

    @property
    def extent(self) -> tuple[float, float]:
        """Where it begins and ends on the path, m."""
        ...

    def shapes(self, x: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Mode shapes φ, kg^(−1/2), and their slopes, kg^(−1/2)/m, at positions (n,), m: both (n, m)."""
        ...

    def shapes_along(
        self, start: float, spacing: float, count: int
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """As `shapes`, at equally spaced positions."""
        ...
