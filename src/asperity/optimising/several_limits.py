"""The cheapest roughness of bands whose sums in several responses are limited, by a multiplier for each."""

import numpy as np

from asperity.arguments import Array
from asperity.errors import ComputationError

ROUNDS = 200
"""Of all multipliers in turn, at most."""
STILL = 1e-12
"""Change of all energies, relative, at which multipliers are the best."""
ABOVE = 1e3
"""By how much a multiplier is raised until its limit is kept."""


def cheapest(weights: Array, left: Array, price: Array, lowest: Array, highest: Array) -> Array:
    """Energies of bands with the lowest price Σ −price lg e, whose weighted sums are within limits.

    Parameters
    ----------
    weights : ndarray (k, b)
        What each band adds to each of the responses, for its energy.
    left : ndarray (k,)
        Largest sums Σ weights e; infinite where nothing is limited.
    price : ndarray (b,)
        Of lowering a band by a factor, positive.
    lowest, highest : ndarray (b,)
        Bounds of the energies, positive.

    Returns
    -------
    ndarray (b,)
        Energies e = price/Σ λ weights between their bounds, of multipliers λ of the limits: the problem is
        convex in the energies, so that there is no better one.

    Raises
    ------
    ComputationError
        If even the lowest energies do not keep the limits.

    Notes
    -----
    Each multiplier in turn is the root, between two that bracket it, at which its limit is just kept, where
    it is not kept without: the dual problem climbs with each.
    """
    from scipy.optimize import brentq

    over = weights @ lowest > left * (1.0 + 1e-9)
    if over.any():
        remedy = "a larger limit, or wider bounds of the levels"
        raise ComputationError(
            "no texture within the limits was found (the lowest levels exceed one)", remedy
        )
    left = np.maximum(left, (1.0 + STILL) * (weights @ lowest))
    limited = np.flatnonzero(np.isfinite(left) & (weights.max(axis=1) > 0.0))
    multipliers = np.zeros(len(left))

    def energies(number: int, multiplier: float) -> Array:
        heard = multiplier * weights[number] + multipliers @ weights - multipliers[number] * weights[number]
        free = np.divide(price, heard, out=np.full_like(price, np.inf), where=heard > 0.0)
        return np.clip(free, lowest, highest)

    def beyond(multiplier: float, number: int) -> float:
        return float(weights[number] @ energies(number, multiplier) - left[number])

    found = highest
    for _ in range(ROUNDS):
        before = found
        for number in limited.tolist():
            root = 0.0
            if beyond(0.0, number) > 0.0:
                low = 0.0
                high = float(price.sum() / (weights[number] @ highest))
                while beyond(high, number) > 0.0:
                    low = high
                    high *= ABOVE
                root = float(brentq(beyond, low, high, args=(number,), xtol=1e-300, rtol=1e-14))
            multipliers[number] = root
            found = energies(number, root)
        if np.abs(found / before - 1.0).max() < STILL:
            break
    return found
