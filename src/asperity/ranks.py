"""Values in rising order, of which few are put in order at a time: they are not held twice."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np

from asperity.arguments import Array, Flags, Indices, NDArray, floats

TOGETHER = 2**19
"""Values that are put in order together."""
SAMPLE = 2**10
"""Values that tell where others are cut."""
HELD = 4
"""Parts in order that are kept: the ends of two stretches that are looked at together."""


def known_pieces(arrays: Iterable[NDArray[Any]]) -> Iterator[Array]:
    """Values of arrays of any shape that are known, piece by piece; NaN stands for those that are not."""
    for values in arrays:
        flat = values.reshape(-1) if values.ndim == 1 else values.ravel(order="K")
        for first in range(0, flat.size, TOGETHER):
            piece = floats(flat[first : first + TOGETHER])
            known = np.isfinite(piece)
            yield piece if known.all() else piece[known]


class Ranked:
    """Values that are known, of arrays of any shape, by their ranks, from the lowest on.

    They are cut into parts, by some of them, and put in order part by part, whenever it is asked for; what
    occurs often is a part of its own.

    Parameters
    ----------
    arrays : sequence of ndarray
        At least one of their values is known; NaN stands for those that are not. They are left as they are.

    Attributes
    ----------
    count : int
        How many are known.
    lowest, highest : float
        Of them.
    """

    def __init__(self, arrays: Sequence[NDArray[Any]]) -> None:
        self._arrays = arrays
        ends = [(piece.min(), piece.max(), piece.size) for piece in self.pieces() if piece.size]
        self.count = sum(size for _, _, size in ends)
        self.lowest = float(min(low for low, _, _ in ends))
        self.highest = float(max(high for _, high, _ in ends))
        self._edges = np.array([self.lowest, np.nextafter(self.highest, np.inf)])
        self._begin = np.array([0, self.count])
        self._held = dict[int, Array]()
        while (large := self._too_large()).size:
            self._cut(np.concatenate([self._sample(int(part)) for part in large]))

    def pieces(self) -> Iterator[Array]:
        """Values that are known, piece by piece, in the order of the arrays."""
        return known_pieces(self._arrays)

    def _too_large(self) -> Indices:
        """Parts that hold more values than are put in order together."""
        return np.flatnonzero((np.diff(self._begin) > TOGETHER) & ~self._alike)

    @property
    def _alike(self) -> Flags:
        """Parts that hold one value, however often, (parts,)."""
        return np.nextafter(self._edges[:-1], np.inf) == self._edges[1:]

    def _sample(self, part: int) -> Array:
        """Values of a part, evenly spread over its ranks, a few for as many values as are put in order
        together."""
        count = int(self._begin[part + 1] - self._begin[part])
        some = np.concatenate([piece[:: count // SAMPLE + 1].copy() for piece in self._within(part)])
        some.sort()
        return some[np.linspace(0, some.size - 1, 2 + 2 * count // TOGETHER).astype(int)]

    def _within(self, part: int) -> Iterator[Array]:
        low, high = self._edges[part : part + 2]
        return (piece[(piece >= low) & (piece < high)] for piece in self.pieces())

    def _cut(self, values: Array) -> None:
        """Make each of some values the only one of a part."""
        self._edges = np.unique(np.concatenate([self._edges, values, np.nextafter(values, np.inf)]))
        counts = np.zeros(self._edges.size + 1, dtype=np.intp)
        for piece in self.pieces():
            counts += np.bincount(np.searchsorted(self._edges, piece, "right"), minlength=counts.size)
        self._begin = np.cumsum(counts)[:-1]

    def _in_order(self, part: int) -> Array:
        """Values of a part in rising order."""
        if part not in self._held:
            found = np.concatenate(list(self._within(part)))
            found.sort()
            self._held[part] = found
            if len(self._held) > HELD:
                del self._held[next(iter(self._held))]
        return self._held[part]

    def between(self, first: int, last: int) -> Array:
        """Values of some ranks in rising order, (last - first,)."""
        found = []
        begin = int(np.searchsorted(self._begin, first, "right")) - 1
        end = int(np.searchsorted(self._begin, last, "left"))
        for part in range(begin, end):
            start, stop = (min(max(rank, first), last) for rank in self._begin[part : part + 2])
            if stop > start and self._alike[part]:
                found.append(np.full(stop - start, self._edges[part]))
            elif stop > start:
                found.append(self._in_order(part)[start - self._begin[part] : stop - self._begin[part]])
        return np.concatenate(found)

    def quantiles(self, shares: Array) -> Array:
        """Values that shares (k,), 0 to 1, of all do not exceed, interpolated between two of them."""
        place = shares * (self.count - 1)
        ranks = np.floor(place).astype(int)
        ends = [self.between(rank, min(rank + 2, self.count)) for rank in ranks]
        low, high = (np.array([each[n] for each in ends]) for n in (0, -1))
        share = place - ranks
        step = high - low
        return np.where(share < 0.5, low + step * share, high - step * (1.0 - share))
