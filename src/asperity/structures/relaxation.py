"""Complex stiffness that is causal: a spring beside Maxwell elements."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class Relaxation:
    """Stiffness relative to a nominal one: a spring beside Maxwell elements (springs in line with dampers).

    K(ω)/k = static + Σ_j strength_j iω/(iω + 2π f_j). It is analytic in the lower half-plane, hence causal,
    and Im K >= 0 at all ω > 0, hence passive.
    """

    static: float  # of the spring, zero or more: the stiffness at rest
    # of the Maxwell elements, zero or more: what each adds well above its frequency
    strengths: tuple[float, ...]
    frequencies: tuple[float, ...]  # at which they dissipate most, Hz

    def at(self, omega: ArrayLike) -> NDArray[np.complex128]:
        """Stiffness relative to the nominal one at angular frequencies, rad/s, with Im ω <= 0."""
        return relaxing(omega, self.frequencies) @ np.array([self.static, *self.strengths])


@dataclass(frozen=True)
class Relaxations:
    """What stands for the loss factors of a track; None where there is none."""

    rail: Relaxation | None = None  # of its bending (and shear) stiffness
    pad: Relaxation | None = None
    ballast: Relaxation | None = None


def relaxing(omega: ArrayLike, frequencies: ArrayLike) -> NDArray[np.complex128]:
    """Stiffnesses (..., 1 + j) of a spring, 1, and of Maxwell elements of unit strength, iω/(iω + 2π f_j).

    Angular frequency (...), rad/s; frequencies f_j (j,), Hz.
    """
    rate = 1j * np.asarray(omega, dtype=complex)[..., None]
    elements = rate / (rate + 2.0 * np.pi * np.asarray(frequencies, dtype=float))
    return np.concatenate([np.ones_like(rate), elements], axis=-1)
