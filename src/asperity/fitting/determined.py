"""What data determine: directions in which they leave values open; intervals and correlations of the rest."""

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtrc, ndtri, stdtrit

from asperity.arguments import Array

CONFIDENCE = 0.95
WIDEST = float(np.log(3.0))
"""Half an interval, on the scale of the search, beyond which a value is not determined: a factor of three."""
LEAST_RATIO = 1e-6
"""Smallest singular value over the largest one that differences tell from nothing."""
LEAST_SCALE = 1e-3
"""Uncertainties that the data scatter by at least: nothing that is computed is exact."""
SHARED = 0.3
"""Part of a direction over its largest one, from which on a value takes part in it."""
NEARLY = 0.9
"""Part of the largest one, from which on another is as large: of these the last value is held."""
IMPLAUSIBLE = 0.01
"""Probability of a sum of squares, below which the stated uncertainties are not those of the data."""


@dataclass(frozen=True)
class Open:
    """A direction in which the data leave values open.

    Attributes
    ----------
    number : int
        Of the value that is to be held so that the others are determined.
    others : dict of int to float
        Values that take part: how many times its change each of them changes.
    half_width : float
        Half the interval of the number's value along it, on the scale of the search; infinite where nothing
        is known.
    """

    number: int
    others: dict[int, float]
    half_width: float


@dataclass(frozen=True)
class Spread:
    """How far data scatter about what is computed.

    Attributes
    ----------
    scale : float
        By which the uncertainties are multiplied.
    quantile : float
        Half of an interval, in standard deviations.
    """

    scale: float
    quantile: float


def spread_of(square: float, freedom: int, *, believed: bool, read: bool = False) -> Spread:
    """Scatter of data about a fit that leaves a sum of squares, with so many degrees of freedom.

    Uncertainties that are believed are those of the data; else what is left tells them, and intervals are
    those of Student. Read from a few repeats they are uncertain themselves, and what is left makes them
    larger, not smaller.
    """
    tail = 0.5 * (1.0 + CONFIDENCE)
    if believed:
        return Spread(1.0, float(ndtri(tail)))
    least = 1.0 if read else LEAST_SCALE
    return Spread(max(float(np.sqrt(square / freedom)), least), float(stdtrit(freedom, tail)))


def left_out(left: Array, uncertainty: Array, freedom: int) -> float:
    """Standard deviation of what a model leaves out, dB, beside the uncertainty of the data (n,), dB.

    By what is left (n,), dB: Σ left²/(uncertainty² + left out²) is the degrees of freedom (R. C. Paule and
    J. Mandel, J. Res. Natl. Bur. Stand. 87 (1982) 377). Zero where the data are met within their uncertainty,
    at least as well as in one case of a hundred.
    """
    from scipy.optimize import brentq

    def surplus(beyond: float) -> float:
        return float(np.sum(left**2 / (uncertainty**2 + beyond**2))) - freedom

    if chdtrc(freedom, surplus(0.0) + freedom) > IMPLAUSIBLE:
        return 0.0
    return float(brentq(surplus, 0.0, float(np.sqrt(np.sum(left**2) / freedom)) + 1e-9))


def open_direction(slopes: Array, spread: Spread, known: Collection[int] = ()) -> Open | None:
    """The direction that slopes of residuals (n, p) determine least, if they leave it open; else None.

    What is held of it is a value that is not among those `known` to differ from what it would be held at.
    """
    if not slopes.shape[1]:
        return None
    _, sizes, directions = np.linalg.svd(slopes, full_matrices=True)
    sizes = np.append(sizes, np.zeros(len(directions) - len(sizes)))
    for size, direction in zip(sizes[::-1].tolist(), directions[::-1], strict=True):
        parts = np.abs(direction)
        free = [n for n, part in enumerate(parts) if part >= SHARED * parts.max() and n not in known]
        if not free:
            continue
        number = max(free, key=lambda n: (parts[n] >= NEARLY * parts[free].max(), n))
        told = size > LEAST_RATIO * sizes[0] and sizes[0] > 0.0
        half_width = spread.quantile * spread.scale / size * parts[number] if told else np.inf
        if half_width > WIDEST:
            shares = direction / direction[number]
            others = {n: float(s) for n, s in enumerate(shares) if n != number and abs(s) >= SHARED}
            return Open(number, others, float(half_width))
    return None


def covariance(slopes: Array, spread: Spread) -> Array:
    """Covariance (p, p) of values whose residuals have such slopes (n, p), on the scale of the search."""
    _, sizes, directions = np.linalg.svd(slopes, full_matrices=False)
    scaled = directions.T / sizes
    return spread.scale**2 * scaled @ scaled.T


def correlations(found: Array) -> Array:
    """Correlations (p, p) of a covariance."""
    deviation = np.sqrt(np.diag(found))
    return found / np.outer(deviation, deviation)
