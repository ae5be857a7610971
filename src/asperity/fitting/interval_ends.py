"""Ends of intervals where a sum of squares rises more slowly than the parabola at its minimum."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from asperity.arguments import Array, NDArray
from asperity.fitting.search import Residuals

MOST = 4
"""Evaluations of residuals for an end, at most."""
SAME = 0.01
"""Part of the height of an end, on the scale of standard deviations, by which it may be missed."""
FARTHER = 4.0
"""Times as far as before that an end is sought, at most."""
INWARD = 0.1
"""Part of the way between two steps by which the next one is off either, at least."""
STEEP = 1.5
"""Height of the nearest step over one, from which on the end before it is not told by it."""
LIMIT, FURTHER = "limit", "further"
"""Why an interval stops before its end: at a limit of the key; or as what lies beyond was not tried."""


@dataclass(frozen=True)
class End:
    """An end of an interval.

    Attributes
    ----------
    place : float
        On the scale of the search.
    stop : str
        `LIMIT` or `FURTHER` where the interval stops there although the data allow what lies beyond; else
        empty.
    """

    place: float
    stop: str = ""


@dataclass(frozen=True, eq=False)
class Bowl:
    """A sum of squares of p values about its minimum.

    Parameters
    ----------
    residuals : callable
        Residuals (n,) at a place.
    place : ndarray (p,)
        The minimum, on the scale of the search.
    left : ndarray (n,)
        Residuals there.
    slopes : ndarray (n, p)
        Their slopes there.
    low, high : ndarray (p,)
        Limits.
    inside : ndarray (k,)
        Numbers of the values that may move.
    allowed : float
        Rise of the sum of squares at an end of an interval.
    """

    residuals: Residuals
    place: Array
    left: Array
    slopes: Array
    low: Array
    high: Array
    inside: NDArray[np.int_]
    allowed: float

    def end(self, number: int, by: float) -> End:
        """The end of a value's interval: where slopes alone have it, by so much off, or farther away.

        Farther away where the sum of squares has not risen there by what is allowed, the other values found
        again: then where it has. Beyond a limit nothing is tried.
        """
        at = float(self.place[number])
        room = float((self.high if by > 0.0 else self.low)[number]) - at
        if abs(by) >= abs(room):
            return End(at + by)
        others = self.inside[self.inside != number]
        back = np.asarray(np.linalg.pinv(self.slopes[:, others]), dtype=float)
        along = -back @ self.slopes[:, number]
        bent = np.zeros(len(others))
        tried = [(0.0, 0.0)]  # heights, and the steps that have them
        step = by
        for _ in range(MOST):
            height, bent = self._height(number, step, others, back, along, bent)
            if abs(height - 1.0) <= SAME or (step == by and height > 1.0):
                return End(at + step)
            if step == room and height < 1.0:
                return End(at + room, LIMIT)
            tried.append((height, step))
            step = _next_step(tried, room)
        if any(1.0 < height < STEEP for height, _ in tried):
            return End(at + step)
        return End(at + max((step for height, step in tried if height < 1.0), key=abs), FURTHER)

    def _height(
        self, number: int, step: float, others: NDArray[np.int_], back: Array, along: Array, bent: Array
    ) -> tuple[float, Array]:
        """Root of the rise over what is allowed a step away, and how the other values bend there.

        They are where slopes have them, and the bend that is known; their slopes tell how far they would
        still go back from there.
        """
        trial = self.place.copy()
        trial[number] += step
        trial[others] += along * step + bent * step**2
        trial = np.clip(trial, self.low, self.high)
        left = self.residuals(trial)
        met = np.clip(trial[others] - back @ (left - self.left), self.low[others], self.high[others])
        nearest = left + self.slopes[:, others] @ (met - trial[others])
        rise = float(nearest @ nearest - self.left @ self.left)
        return np.sqrt(max(rise, 0.0) / self.allowed), (met - self.place[others] - along * step) / step**2


def _next_step(tried: Sequence[tuple[float, float]], room: float) -> float:
    """The step that has the height of one, by heights and steps that were tried, of which one has less.

    By the polynomial of steps over heights; off those that have less, and off those that have more.
    """
    under = max((step for height, step in tried if height < 1.0), key=abs)
    above, over = min(
        ((h, step) for h, step in tried if h > 1.0), key=lambda each: abs(each[1]), default=(1.0, 0.0)
    )
    farthest = over or min(FARTHER * under, room, key=abs)
    way = abs(farthest - under)
    nearest = abs(under) + INWARD * way
    last = abs(farthest) - way * (0.5 if above > STEEP else INWARD if over else 0.0)
    heights, steps = np.abs(np.array(tried).T)
    apart = heights[:, None] - heights + np.eye(len(heights))
    if not apart.all():
        return float(np.copysign(last, under))
    toward = np.where(np.eye(len(heights), dtype=bool), 1.0, (1.0 - heights) / apart)
    return float(np.copysign(np.clip(steps @ toward.prod(axis=1), nearest, last), under))
