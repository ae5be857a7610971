"""Residual flexibility: what the modes that are left out add, as modes that follow a force at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.arguments import real_array
from asperity.errors import InputError

Array = NDArray[np.float64]

STATIC = 1e8
"""Hz, of modes that stand for residual flexibility: static in any time step above 5 ns."""
STATIC_DAMPING = 0.5
NEGLIGIBLE = 1e-9
"""Share of the largest residual flexibility that is left out."""
ROUNDED = 1e-6
"""Share of it that may be asymmetric or negative by rounding in a file."""


def checked_flexibility(given: ArrayLike | None, count: int) -> Array | None:
    """Take a residual flexibility that creates no energy; None where there is none."""
    if given is None:
        return None
    what, allowed = "residual flexibility (m/N)", f"{count} numbers, or a matrix of so many rows and columns"
    values = real_array(what, given, allowed)
    if values.shape not in ((count,), (count, count)) or not np.isfinite(values).all():
        raise InputError(what, f"shape {values.shape}, or numbers that are not finite", allowed)
    remedy = "It is the static compliance less that of the modes given."
    largest = np.abs(values).max()
    if values.ndim == 1 and values.min() < 0.0:
        raise InputError(what, float(values.min()), "0 and more at each place", remedy)
    if values.ndim == 2:
        if np.abs(values - values.T).max() > ROUNDED * largest:
            raise InputError(what, "a matrix that is not symmetric", "a symmetric one", remedy)
        least = np.linalg.eigvalsh(0.5 * (values + values.T))[0]
        if least < -ROUNDED * largest:
            received = f"a matrix with an eigenvalue of {least:.2g} m/N"
            raise InputError(what, received, "no negative one: it would create energy", remedy)
    return values if largest > 0.0 else None


def static_modes(flexibility: Array | None, count: int) -> Array:
    """Shapes (p, s) of modes at STATIC that have this flexibility, m/N."""
    if flexibility is None:
        return np.zeros((count, 0))
    omega = 2.0 * np.pi * STATIC
    if flexibility.ndim == 1:
        return omega * np.sqrt(flexibility)[:, None]
    values, vectors = np.linalg.eigh(0.5 * (flexibility + flexibility.T))
    kept = values > NEGLIGIBLE * values[-1]
    return np.asarray(omega * vectors[:, kept] * np.sqrt(values[kept]))
