"""Complex stiffness that is causal: a spring beside Maxwell elements."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class Relaxation:
    """Stiffness relative to a nominal one: a spring beside Maxwell elements (springs in line with dampers).

    Parameters
    ----------
    static : float
        Of the spring, zero or more: the stiffness at rest.
    strengths : tuple of float
        Of the Maxwell elements, zero or more: what each adds well above its frequency.
    frequencies : tuple of float
        At which they dissipate most, Hz.

    Notes
    -----
    K(ω)/k = static + Σ_j strength_j iω/(iω + 2π f_j). It is analytic in the lower half-plane, hence causal,
    and Im K >= 0 at all ω > 0, hence passive.
    """

    static: float
    strengths: tuple[float, ...]
    frequencies: tuple[float, ...]

    def at(self, omega: ArrayLike) -> NDArray[np.complex128]:
        """Stiffness relative to the nominal one.

        Parameters
        ----------
        omega : array_like of complex
            Angular frequency, rad/s, with Im ω <= 0.

        Returns
        -------
        ndarray of complex
            Of the shape of `omega`.
        """
        return relaxing(omega, self.frequencies) @ np.array([self.static, *self.strengths])


@dataclass(frozen=True)
class Relaxations:
    """What stands for the loss factors of a track; None where there is none.

    Parameters
    ----------
    rail, pad, ballast : Relaxation or None
        Of the rail's bending (and shear) stiffness, the pads and the ballast.
    """

    rail: Relaxation | None = None
    pad: Relaxation | None = None
    ballast: Relaxation | None = None


def relaxing(omega: ArrayLike, frequencies: ArrayLike) -> NDArray[np.complex128]:
    """Stiffnesses of a spring and of Maxwell elements of unit strength.

    Parameters
    ----------
    omega : array_like (...) of complex
        Angular frequency, rad/s.
    frequencies : array_like (j,)
        Of the Maxwell elements, Hz.

    Returns
    -------
    ndarray (..., 1 + j) of complex
        1, then iω/(iω + 2π f_j).
    """
    rate = 1j * np.asarray(omega, dtype=complex)[..., None]
    elements = rate / (rate + 2.0 * np.pi * np.asarray(frequencies, dtype=float))
    return np.concatenate([np.ones_like(rate), elements], axis=-1)
