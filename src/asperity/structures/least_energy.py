"""Where the energy of contacts is least: what lies between them is in balance there."""

from collections.abc import Callable

import numpy as np

from asperity.arguments import Array
from asperity.errors import ComputationError
from asperity.written_numbers import rounded

TOLERANCE = 1e-10
"""Force out of balance over the load."""
PATIENCE, ROUNDED = 30, 1e-7
"""Steps after which this much is taken: where loads are of millinewtons, rounding may allow no better."""
MOST_STEPS = 100
LOOSE = 1e-4
"""Way, m, that what nothing holds yet is moved by a step, at most."""
HALVINGS = 40
"""Of a step that does not go downhill."""


def least_energy(
    energy_of: Callable[[Array], tuple[Array, Array, Array]], start: Array, scale: float, what: str
) -> tuple[Array, float]:
    """Least energies by Newton's method with halved steps: places (…, n), and the imbalance.

    Parameters
    ----------
    energy_of : callable
        Energies (…), gradients (…, n) and Hessians (…, n, n) of convex functions at places (…, n).
    start : ndarray (…, n)
        Where it begins, m.
    scale : float
        N: a gradient counts as zero below `TOLERANCE` of it.
    what : str
        For messages.

    Returns
    -------
    places : ndarray (…, n)
        m.
    imbalance : float
        Largest gradient over the scale.

    Raises
    ------
    ComputationError
        Where none is found.
    """
    place = start
    energy, gradient, hessian = energy_of(place)
    for step in range(MOST_STEPS):
        size = np.linalg.norm(gradient, axis=-1)
        if size.max() <= (TOLERANCE if step < PATIENCE else ROUNDED) * scale:
            return place, float(size.max() / scale)
        trace = np.trace(hessian, axis1=-2, axis2=-1)
        least = np.maximum(np.maximum(1e-13 * trace, 1e-9 * trace.max()), (trace == 0.0) * scale / LOOSE)
        ridge = least[..., None, None] * np.eye(place.shape[-1])
        move = -np.linalg.solve(hessian + ridge, gradient[..., None])[..., 0]
        slope = (move * gradient).sum(-1)
        share = np.ones(size.shape)
        for _ in range(HALVINGS):
            tried = energy_of(place + share[..., None] * move)
            left = np.linalg.norm(tried[1], axis=-1)
            lower = tried[0] <= energy + 1e-4 * share * slope
            down = lower | (left <= np.maximum((1.0 - 1e-4 * share) * size, TOLERANCE * scale))
            if down.all():
                break
            share = np.where(down, share, 0.5 * share)
        place = place + share[..., None] * move
        energy, gradient, hessian = tried
    raise ComputationError(
        f"{what}: {rounded(np.linalg.norm(gradient, axis=-1).max() / scale, 1)} of the load is out of "
        f"balance after {MOST_STEPS} steps",
        "another load, clearance or speed",
    )
