"""A map turned into the direction of rolling."""

import math
from dataclasses import replace

import numpy as np
import scipy

from asperity.arguments import require
from asperity.surfaces.heightmap import HeightMap

QUARTER = 0.5 * math.pi
ROUNDING = 1e-9
"""Difference from a whole number of quarter turns that is rounding, rad."""
ORDER = 5
"""Degree of the spline that turns a map: a wave of four points is then right within 0.2 %."""


def rotated(surface: HeightMap, direction: float) -> HeightMap:
    """Lay a map out so that its first axis is a direction, rad, from its x axis towards its y axis.

    Quarter turns move points and change none. Other directions keep the largest rectangle inside the area
    that was measured, about its middle, on the finer of the two spacings: heights are interpolated, none is
    made up beyond the points. Waves shorter than four points are damped; resample first to keep them. For
    these the map is complete.

    A texture that varies most at an angle Std does so at Std − direction afterwards.
    """
    turns = direction / QUARTER
    require(math.isfinite(turns), "direction", direction, "a finite angle, rad")
    if abs(turns - round(turns)) < ROUNDING:
        swapped = surface.spacing[::-1] if round(turns) % 2 else surface.spacing
        return replace(surface, heights=np.rot90(surface.heights, -round(turns)), spacing=swapped)
    received = f"{surface.missing_share:.2%} missing points"
    complete = surface.missing_share == 0.0
    remedy = "Use fill first."
    require(complete, "map to turn", received, "complete heights, or quarter turns", remedy)
    lengths = (surface.x[-1], surface.y[-1])
    step = min(surface.spacing)
    sides = inscribed(lengths[0], lengths[1], direction)
    counts = [math.floor(side / step * (1 + ROUNDING)) + 1 for side in sides]
    received = f"{math.degrees(direction):.4g} degrees on a map of {surface.shape[0]} x {surface.shape[1]}"
    allowed = "one that leaves two points or more along each side"
    require(min(counts) >= 2, "direction", received, allowed)
    along, across = (step * (np.arange(n) - 0.5 * (n - 1)) for n in counts)
    cos = math.cos(direction)
    sin = math.sin(direction)
    x = 0.5 * lengths[0] + along[:, None] * cos - across * sin
    y = 0.5 * lengths[1] + along[:, None] * sin + across * cos
    kx, ky = (min(ORDER, n - 1) for n in surface.shape)  # the spline needs more points than its degree
    spline = scipy.interpolate.RectBivariateSpline(surface.x, surface.y, surface.heights, kx=kx, ky=ky)
    return replace(surface, heights=spline.ev(x, y), spacing=(step, step))


def inscribed(length: float, width: float, angle: float) -> tuple[float, float]:
    """Sides of the largest rectangle, turned by an angle, rad, inside another one.

    The first side lies at the angle to the length. Either two opposite corners touch the long sides, or all
    four corners touch: a c + b s = length and a s + b c = width, c and s the absolute cosine and sine.
    """
    cos = abs(math.cos(angle))
    sin = abs(math.sin(angle))
    short = min(length, width)
    if short <= 2.0 * sin * cos * max(length, width) or abs(cos - sin) < ROUNDING:
        sides = 0.5 * short / sin, 0.5 * short / cos
        return sides if width <= length else (sides[1], sides[0])
    both = cos**2 - sin**2
    return (length * cos - width * sin) / both, (width * cos - length * sin) / both
