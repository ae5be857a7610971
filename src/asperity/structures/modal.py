"""What a structure that is rolled over offers by its modes."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.errors import InputError


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


def modal_receptance(structure: Modal, frequency: ArrayLike, x: float, x0: float) -> NDArray[np.complex128]:
    """Displacement at `x` per harmonic force at `x0`, m/N, e^{+iωt}, of the shape of the frequency, Hz.

    Zero frequency gives the static compliance, which a structure with modes of a rigid body has not.
    """
    (response, force), _ = structure.shapes([x, x0])
    return np.asarray(_answers(structure, frequency) @ (response * force), dtype=complex)


def driving_point(structure: Modal, frequency: ArrayLike, x: ArrayLike) -> NDArray[np.complex128]:
    """Displacement of places (p,), m, per harmonic force there (p, f), m/N, as `modal_receptance`."""
    return np.asarray(structure.shapes(x)[0] ** 2 @ _answers(structure, frequency).T, dtype=complex)


def _answers(structure: Modal, frequency: ArrayLike) -> NDArray[np.complex128]:
    """Of all modes to a unit force on each (..., m)."""
    omega = 2.0 * np.pi * np.asarray(frequency, dtype=float)[..., None]
    natural = 2.0 * np.pi * structure.natural_frequencies
    if not omega.all() and not natural.all():
        raise InputError("frequency (Hz)", 0, "above 0: what nothing holds has no static receptance")
    answers = 1.0 / (natural**2 - omega**2 + 2j * structure.damping_ratios * natural * omega)
    return np.asarray(answers, dtype=complex)
