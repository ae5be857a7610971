"""Translation process: a Gaussian field made to have a given height distribution and correlation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

REACH = 6.0
"""Largest standard normal deviate in the tables: one point in 10^9 lies beyond."""


@dataclass(frozen=True, eq=False)
class HeightTransform:
    """Monotone map from a standard normal variable to heights, tabulated uniformly."""

    deviates: NDArray[np.float64]  # (k,), standard normal, rising
    heights: NDArray[np.float64]  # (k,), m, not falling; beyond the table the end values hold

    def __call__(self, normal: NDArray[np.float64]) -> NDArray[np.float64]:
        """Heights, m, of standard normal values of any shape."""
        return np.interp(normal, self.deviates, self.heights)


def height_transform(heights: NDArray[np.float64], points: int = 2401) -> HeightTransform:
    """Transform that gives a normal variable the distribution of measured heights, m, as a table.

    The quantiles are used as they are, so nothing higher or lower than measured can arise.
    """
    rising = np.sort(heights, axis=None)
    deviates = np.linspace(-REACH, REACH, points)
    probabilities = (np.arange(rising.size) + 0.5) / rising.size
    return HeightTransform(deviates, np.interp(ndtr(deviates), probabilities, rising))


def gaussian_correlation(transform: HeightTransform, correlation: NDArray[np.float64]) -> NDArray[np.float64]:
    """Correlation coefficient that a Gaussian field needs for its transform to have a given one, at most 1.

    Mehler's expansion: with g = Σ c_k He_k/√k!, the correlation of g is Σ c_k² ρ^k/Σ c_k². The relation is
    monotone because the transform is. M. Grigoriu, Applied Non-Gaussian Processes (1995).
    """
    u = transform.deviates
    weight = np.exp(-u * u / 2.0)
    weight /= weight.sum()
    order = 24
    previous, current = np.zeros_like(u), np.ones_like(u)
    coefficients = []
    for k in range(order):  # normalised Hermite polynomials
        previous, current = current, (u * current - np.sqrt(k) * previous) / np.sqrt(k + 1.0)
        coefficients.append(np.sum(weight * transform.heights * current))
    energies = np.square(coefficients)
    table = -np.cos(np.linspace(0.0, np.pi, 4001))
    mapped = np.polynomial.polynomial.polyval(table, np.concatenate([[0.0], energies / energies.sum()]))
    return np.interp(correlation, np.maximum.accumulate(mapped), table)
