"""Maps turned and moved: how far one lies from another."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import scipy
from scipy.special import ndtr

from asperity.arguments import Array
from asperity.errors import InputError
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.levelling import fill

REACH = 6.0
"""Largest standard normal deviate in the tables: one point in 10^9 lies beyond."""


@dataclass(frozen=True, eq=False)
class HeightTransform:
    """Monotone map from a standard normal variable to heights, tabulated uniformly."""

    deviates: Array  # (k,), standard normal, rising
    heights: Array  # (k,), m, not falling; beyond the table the end values hold

    def __call__(self, normal: Array) -> Array:
        """Heights, m, of standard normal values of any shape."""
        return np.interp(normal, self.deviates, self.heights)


def height_transform(heights: Array, points: int = 2401) -> HeightTransform:
    """Transform that gives a normal variable the distribution of measured heights, m, as a table.

    The quantiles are used as they are, so nothing higher or lower than measured can arise.
    """
    rising = np.sort(heights, axis=None)
    deviates = np.linspace(-REACH, REACH, points)
    probabilities = (np.arange(rising.size) + 0.5) / rising.size
    return HeightTransform(deviates, np.interp(ndtr(deviates), probabilities, rising))


def gaussian_correlation(transform: HeightTransform, correlation: Array) -> Array:
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


QUARTER = 0.5 * math.pi
ROUNDING = 1e-9
"""Difference from a whole number of quarter turns that is rounding, rad."""
ORDER = 5
"""Degree of the spline: a wave of four points is then right within 0.2 %."""


def rotated(surface: HeightMap, direction: float) -> HeightMap:
    """Lay a map out so that its first axis is a direction, rad, from its x axis towards its y axis.

    Quarter turns move points and change none. Other directions keep the largest rectangle inside the area
    that was measured, about its middle, on the finer of the two spacings: heights are interpolated, none is
    made up beyond the points. Waves shorter than four points are damped; resample first to keep them. Points
    next to a missing one are missing.

    A texture that varies most at an angle Std does so at Std − direction afterwards.
    """
    turns = direction / QUARTER
    if not math.isfinite(turns):
        raise InputError("direction", direction, "a finite angle, rad")
    if abs(turns - round(turns)) < ROUNDING:
        swapped = surface.spacing[::-1] if round(turns) % 2 else surface.spacing
        return replace(surface, heights=np.rot90(surface.heights, -round(turns)), spacing=swapped)
    lengths = (surface.x[-1], surface.y[-1])
    step = min(surface.spacing)
    sides = inscribed(lengths[0], lengths[1], direction)
    counts = [math.floor(side / step * (1 + ROUNDING)) + 1 for side in sides]
    if min(counts) < 2:
        received = (
            f"{math.degrees(direction):.4g} degrees on a map of {surface.shape[0]} x {surface.shape[1]}"
        )
        raise InputError("direction", received, "one that leaves two points or more along each side")
    along, across = (step * (np.arange(n) - 0.5 * (n - 1)) for n in counts)
    cos, sin = math.cos(direction), math.sin(direction)
    at = (
        0.5 * lengths[0] + along[:, None] * cos - across * sin,
        0.5 * lengths[1] + along[:, None] * sin + across * cos,
    )
    return replace(surface, heights=_interpolated(surface, at), spacing=(step, step))


def inscribed(length: float, width: float, angle: float) -> tuple[float, float]:
    """Sides of the largest rectangle, turned by an angle, rad, inside another one.

    The first side lies at the angle to the length. Either two opposite corners touch the long sides, or all
    four corners touch: a c + b s = length and a s + b c = width, c and s the absolute cosine and sine.
    """
    cos, sin = abs(math.cos(angle)), abs(math.sin(angle))
    short = min(length, width)
    if short <= 2.0 * sin * cos * max(length, width) or abs(cos - sin) < ROUNDING:
        sides = 0.5 * short / sin, 0.5 * short / cos
        return sides if width <= length else (sides[1], sides[0])
    both = cos**2 - sin**2
    return (length * cos - width * sin) / both, (width * cos - length * sin) / both


def _interpolated(surface: HeightMap, at: tuple[Array, Array]) -> Array:
    """Heights at places (x, y), m, inside a map; the spline needs more points than its degree."""
    missing = np.isnan(surface.heights)
    heights = fill(surface).heights if missing.any() else surface.heights
    kx, ky = (min(ORDER, n - 1) for n in surface.shape)
    found = scipy.interpolate.RectBivariateSpline(surface.x, surface.y, heights, kx=kx, ky=ky).ev(*at)
    if missing.any():
        index = np.stack([place / step for place, step in zip(at, surface.spacing, strict=True)])
        near = scipy.ndimage.map_coordinates(missing.astype(np.float64), index, order=1, mode="nearest")
        found[near > ROUNDING] = np.nan
    return np.asarray(found)
