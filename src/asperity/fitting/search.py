"""Least squares from several starts: the free values that leave the smallest sum of squares."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from asperity.arguments import Array, Flags, NDArray

FAR = 1e3
"""Residual, in uncertainties, of what cannot be computed at some values."""
SCREENED = 6
"""Places looked at for each start of the search."""
ROUGH, FINE = 12, 60
"""Most evaluations of residuals of a search from one start, and of the best one's end."""
TOLERANCE = 1e-8
STEP, RUN_STEP, WIDE_STEP = 1e-4, 0.02, 0.15
"""Of differences, on the scale of the search; of those of runs, whose grids may follow a value; and of those
that jump, far enough that what they follow is more than the jumps."""
ON_LIMIT = 2e-3
"""Share of its range by which a value may be off a limit that it lies on."""

Residuals = Callable[[Array], Array]
Jacobian = Callable[[Array], Array]


@dataclass(frozen=True, eq=False)
class Optimum:
    """Where a sum of squares is smallest."""

    place: Array  # (p,), on the scale of the search
    residuals: Array  # (n,), in uncertainties

    @property
    def square(self) -> float:
        """The sum of squares."""
        return float(self.residuals @ self.residuals)


def starts_within(low: Array, high: Array, start: Array, count: int, residuals: Residuals) -> list[Array]:
    """Places to search from (p,): the start, then the best of a few spread evenly between the limits."""
    from scipy.stats import qmc

    if count < 2 or not len(start):
        return [start]
    drawn = qmc.LatinHypercube(len(start), seed=np.random.default_rng(1)).random(SCREENED * (count - 1))
    places = low + (0.02 + 0.96 * drawn) * (high - low)
    squares = [float(np.sum(np.minimum(residuals(place) ** 2, FAR**2))) for place in places]
    best = np.argsort(squares, kind="stable")[: count - 1]
    return [start, *places[best]]


def descend(
    residuals: Residuals,
    slopes: Jacobian,
    start: Array,
    low: Array,
    high: Array,
    most: int,
    tolerance: float = TOLERANCE,
) -> Optimum:
    """Go down from one place to the nearest smallest sum of squares between limits (p,)."""
    from scipy.optimize import least_squares

    if not len(start):
        return Optimum(start, residuals(start))
    room = 1e-6 * (high - low)
    inside = np.clip(start, low + room, high - room)
    found = least_squares(
        residuals,
        inside,
        jac=slopes,
        bounds=(low, high),
        x_scale=1.0,
        ftol=tolerance,
        xtol=tolerance,
        gtol=tolerance,
        max_nfev=most,
    )
    return Optimum(np.asarray(found.x), np.asarray(found.fun))


def forward_slopes(residuals: Residuals, low: Array, high: Array) -> Jacobian:
    """Slopes of residuals (n, p) by differences forward, or back from an upper limit."""

    def slopes(place: Array) -> Array:
        here = residuals(place)
        columns = []
        for number in range(len(place)):
            step = STEP if place[number] + STEP <= high[number] else -STEP
            columns.append((residuals(_moved(place, number, step)) - here) / step)
        return np.stack(columns, axis=1)

    return slopes


def central_slopes(residuals: Residuals, low: Array, high: Array) -> Jacobian:
    """Slopes of residuals (n, p) by central differences, one-sided at a limit."""

    def slopes(place: Array) -> Array:
        columns = []
        for number, at in enumerate(place.tolist()):
            back, ahead = (float(np.clip(at + by, low[number], high[number])) - at for by in (-STEP, STEP))
            ends = residuals(_moved(place, number, ahead)) - residuals(_moved(place, number, back))
            columns.append(ends / (ahead - back))
        return np.stack(columns, axis=1)

    return slopes


def grouped_slopes(
    residuals: Residuals,
    place: Array,
    high: Array,
    groups: Sequence[tuple[NDArray[np.int_], Flags]],
    by: float,
) -> Array:
    """Slopes of residuals (n, p) by differences of runs, some values moved at once.

    Each group has the numbers of these values (k,), and which data each of them moves (n, k).
    """
    here = residuals(place)
    found = np.zeros((len(here), len(place)))
    for numbers, moves in groups:
        steps = np.where(place[numbers] + by <= high[numbers], by, -by)
        moved = place.copy()
        moved[numbers] += steps
        change = residuals(moved) - here
        found[:, numbers] = np.where(moves, change[:, None] / steps, 0.0)
    return found


def updated_slopes(residuals: Residuals, slopes: Jacobian) -> Jacobian:
    """Slopes that are found once, and then follow what residuals do from place to place (Broyden)."""
    held: list[tuple[Array, Array, Array]] = []  # place, residuals and slopes there

    def followed(place: Array) -> Array:
        left = residuals(place)
        if not held:
            found = slopes(place)
        else:
            before, left_before, found = held.pop()
            step = place - before
            missed = left - left_before - found @ step
            found = found + np.outer(missed, step) / max(float(step @ step), np.finfo(float).tiny)
        held.append((place.copy(), left, found))
        return found

    return followed


def _moved(place: Array, number: int, by: float) -> Array:
    moved = place.copy()
    moved[number] += by
    return moved


def on_limits(place: Array, low: Array, high: Array) -> Array:
    """Which values lie on a limit (p,): -1 the lower one, 1 the upper one, 0 none."""
    near = ON_LIMIT * (high - low)
    return np.where(place <= low + near, -1, np.where(place >= high - near, 1, 0))
