"""One value that runs tell with jumps: smooth curves through a row of them, and where these meet the data."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial.polynomial import polyvander

from asperity.arguments import Array
from asperity.fitting.determined import Spread, left_out, spread_of
from asperity.fitting.interval_ends import FURTHER, End

STEP = 0.1
"""On the scale of the search, from one place of a row to the next, at most."""
NEIGHBOURS = 11
"""Places of a row through which a curve goes nearby."""
ORDER = 2
"""Of the polynomials that it is made of."""
NEAR = 1.0
"""On the scale of the search, as far as runs tell the chance at a place."""
FINE = 0.005
"""On the scale of the search, between places at which curves are compared with the data."""
ROUNDS = 6
"""In which a place, the chance there and what the case leaves out are found, each by the others."""


def places_of(low: float, high: float) -> Array:
    """Places of a row (m,) between two others: enough of them for a curve and what is off it."""
    return np.linspace(low, high, max(round((high - low) / STEP), 2 * NEIGHBOURS) + 1)


@dataclass(frozen=True, eq=False)
class Met:
    """Where a row meets the data.

    Attributes
    ----------
    place : float
        The nearest, on the scale of the search.
    ends : tuple of two End
        Of the interval.
    chance : ndarray (n,)
        Standard deviation, dB, of a record that was measured less the curve, by the chance of records.
    beyond : float
        Standard deviation of what the case leaves out, dB.
    """

    place: float
    ends: tuple[End, End]
    chance: Array
    beyond: float


@dataclass(frozen=True, eq=False)
class Row:
    """What is left of data at places of one value that lie in a row.

    Runs beside each other differ by chance, as each is another record. Curves through a few neighbours
    (W. S. Cleveland, J. Am. Stat. Assoc. 74 (1979) 829) leave that out; what is off them tells how much.

    Parameters
    ----------
    places : ndarray (m,)
        Values on the scale of the search, rising.
    left : ndarray (m, n)
        Level of what was measured over what is predicted, dB.
    """

    places: Array
    left: Array

    @cached_property
    def _smooth(self) -> Array:
        return weights(self.places, self.places)

    @cached_property
    def fine(self) -> Array:
        """Places (k,) at which curves are compared with the data."""
        low, high = self.places[[0, -1]]
        return np.linspace(low, high, max(round(float(high - low) / FINE), len(self.places)) + 1)

    @cached_property
    def curves(self) -> Array:
        """What is left by the curves at the fine places (k, n), dB."""
        return weights(self.places, self.fine) @ self.left

    def chance(self, place: float) -> Array:
        """Standard deviation (n,), dB, of another record less the curve, by runs near a place."""
        near = _nearness(self.places - place, NEAR)
        sizes = np.sum(self._smooth**2, axis=1)
        freedom = near @ (1.0 - 2.0 * np.diag(self._smooth) + sizes)
        of_record = near @ (self.left - self._smooth @ self.left) ** 2 / freedom
        return np.sqrt(of_record * (1.0 + float(np.median(sizes))))

    def met(self, uncertainty: Array, *, stated: bool, repeated: bool) -> Met:
        """Where curves are nearest to data of an uncertainty (n,), dB, that is known, or read from repeats.

        An interval reaches to all places whose sum of squares is within what chance makes of it.
        """
        freedom = len(uncertainty) - 1
        number = int(np.sum((self.curves / uncertainty) ** 2, axis=1).argmin())
        for _ in range(ROUNDS):
            chance = self.chance(float(self.fine[number]))
            of_data = np.hypot(uncertainty, chance)
            beyond = left_out(self.curves[number], of_data, freedom) if stated else 0.0
            squares = np.sum((self.curves / np.hypot(of_data, beyond)) ** 2, axis=1)
            number = int(squares.argmin())
        least = float(squares[number])
        believed = stated and not beyond and not repeated
        spread = spread_of(least, freedom, believed=believed, read=repeated)
        return Met(float(self.fine[number]), self._ends(squares, spread), chance, beyond)

    def _ends(self, squares: Array, spread: Spread) -> tuple[End, End]:
        allowed = np.flatnonzero(squares <= squares.min() + (spread.quantile * spread.scale) ** 2)
        first = int(allowed[0])
        last = int(allowed[-1])
        stops = FURTHER * (first == 0), FURTHER * (last == len(squares) - 1)
        return End(float(self.fine[first]), stops[0]), End(float(self.fine[last]), stops[1])


def weights(places: Array, at: Array) -> Array:
    """Of values at places (m,) in that of a curve at others (k, m): polynomials weighted by nearness."""
    away = places - at[:, None]
    near = np.argsort(np.abs(away), axis=1, kind="stable")[:, :NEIGHBOURS]
    away = np.take_along_axis(away, near, axis=1)
    away /= np.abs(away).max(axis=1, keepdims=True) * (1.0 + 1.0 / NEIGHBOURS)
    powers = polyvander(away, ORDER)
    weighted = powers * _nearness(away, 1.0)[..., None]
    of_value = np.linalg.solve(weighted.swapaxes(1, 2) @ powers, np.eye(ORDER + 1)[:, :1])
    found = np.zeros((len(at), len(places)))
    np.put_along_axis(found, near, (weighted @ of_value)[..., 0], axis=1)
    return found


def _nearness(away: Array, reach: Array | float) -> Array:
    """Weights of places by how far they are: one at none, none from the reach on."""
    return np.maximum(1.0 - np.abs(away / reach) ** 3, 0.0) ** 3
