"""Strips along a path: read, or generated, piece by piece, so that no length is too long for memory."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from asperity.errors import InputError

PIECES_KEPT = 3
"""Generated pieces held at a time, at least: those that threads on neighbouring positions read."""
BYTES_KEPT = 2**26
"""Bytes of generated pieces, of all strips, up to which more of them are held: a path is read many times."""

Piece = tuple[NDArray[np.float64], NDArray[np.float64] | None]
"""Rows of a piece up to the next one, m, and those that give way to it, while they are held."""


class Strip(Protocol):
    """Heights along a path, asked for in pieces: a `HeightMap` is one."""

    @property
    def shape(self) -> tuple[int, int]:
        """Number of points (nx, ny); the first axis is the rolling direction."""
        ...

    @property
    def spacing(self) -> tuple[float, float]:
        """Distances (dx, dy), m."""
        ...

    @property
    def size(self) -> tuple[float, float]:
        """Lengths (nx dx, ny dy), m."""
        ...

    def rows(self, first: int, stop: int) -> NDArray[np.float64]:
        """Heights of the rows first … stop − 1, m, shape (stop − first, ny)."""
        ...


@dataclass(frozen=True, eq=False)
class Rows:
    """Heights in memory as a strip, without copying or checking them."""

    heights: NDArray[np.float64]  # (nx, ny), m
    spacing: tuple[float, float] = (1.0, 1.0)  # (dx, dy), m

    @property
    def shape(self) -> tuple[int, int]:
        """Number of points (nx, ny)."""
        return self.heights.shape[0], self.heights.shape[1]

    @property
    def size(self) -> tuple[float, float]:
        """Lengths (nx dx, ny dy), m."""
        return self.shape[0] * self.spacing[0], self.shape[1] * self.spacing[1]

    def rows(self, first: int, stop: int) -> NDArray[np.float64]:
        """Heights of the rows first … stop − 1, m."""
        return self.heights[first:stop]


@dataclass(frozen=True, eq=False)
class Raised:
    """A strip with heights added to it."""

    strip: Strip  # what lies below
    added: Callable[[int, int], NDArray[np.float64]]  # for rows first … stop − 1: (stop − first, ny or 1), m

    @property
    def shape(self) -> tuple[int, int]:
        """Number of points (nx, ny)."""
        return self.strip.shape

    @property
    def spacing(self) -> tuple[float, float]:
        """Distances (dx, dy), m."""
        return self.strip.spacing

    @property
    def size(self) -> tuple[float, float]:
        """Lengths (nx dx, ny dy), m."""
        return self.strip.size

    def rows(self, first: int, stop: int) -> NDArray[np.float64]:
        """Heights of the rows first … stop − 1, m."""
        return self.strip.rows(first, stop) + self.added(first, stop)


def raised(strip: Strip, heights: NDArray[np.float64]) -> Raised:
    """Add heights (nx,), m, that are the same all across."""
    return Raised(strip, lambda first, stop: heights[first:stop, None])


def turning(strip: Strip, turn: NDArray[np.float64], start: int) -> Raised:
    """Add one turn (n, ny), m, of what rolls, again and again; its row `start` touches row zero."""
    return Raised(strip, lambda first, stop: turn[(np.arange(first, stop) + start) % len(turn)])


class _Pieces:
    """Generated pieces of all strips, those read last, so that strips of one texture share them."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self._held: OrderedDict[Hashable, Piece] = OrderedDict()

    def get(self, name: Hashable) -> Piece | None:
        if name in self._held:
            self._held.move_to_end(name)
        return self._held.get(name)

    def put(self, name: Hashable, piece: Piece) -> None:
        self._held[name] = piece
        for older in list(self._held)[:-PIECES_KEPT]:
            self._held[older] = self._held[older][0], None
        size = sum(head.nbytes for head, _ in self._held.values())
        while size > BYTES_KEPT and len(self._held) > PIECES_KEPT:
            size -= self._held.popitem(last=False)[1][0].nbytes


_pieces = _Pieces()


@dataclass(frozen=True, eq=False)
class LongStrip:
    """Gaussian strip of any length, generated in pieces that blend into each other.

    ``piece(rows, seed)`` returns a Gaussian field (rows, ny), stationary, with zero mean; fields of different
    seeds, one made of the strip's seed and the piece's number, are independent. Pieces begin `stride` rows
    apart, and give way to the next over `blend` rows, at most as many. `transform` translates the blended
    heights, m, point by point.

    In a blend the two pieces are weighted by cos θ and sin θ, θ rising from 0 to π/2: the sum of two
    independent Gaussian fields keeps variance, distribution and lateral correlation exactly, and the
    correlation at a lag τ along the path times cos(πτ/2 blend) at least. Any part of the strip can be had
    alone and again, and a longer strip begins with the shorter one. With rows `before` the first piece, the
    strip has no beginning: however many there are, all rows from there on are the same.

    Strips of one `name` and seed have the same pieces, and share those that are held.
    """

    shape: tuple[int, int]
    spacing: tuple[float, float]
    piece: Callable[[int, int], NDArray[np.float64]]
    seed: int
    stride: int
    blend: int
    transform: Callable[[NDArray[np.float64]], NDArray[np.float64]] | None = None
    source: str = ""
    before: int = 0
    name: Hashable = field(default_factory=object, repr=False)

    def __post_init__(self) -> None:
        if len(self.shape) != 2 or min(self.shape) < 2:
            raise InputError("shape", self.shape, "(nx, ny), at least 2 points each")
        if not 1 <= self.blend <= self.stride:
            raise InputError(
                "blend of the strip", f"{self.blend} rows", f"1 to {self.stride} rows, the stride"
            )

    @property
    def size(self) -> tuple[float, float]:
        """Lengths (nx dx, ny dy), m."""
        return self.shape[0] * self.spacing[0], self.shape[1] * self.spacing[1]

    def rows(self, first: int, stop: int) -> NDArray[np.float64]:
        """Heights of the rows first … stop − 1, m, shape (stop − first, ny)."""
        if not 0 <= first <= stop <= self.shape[0]:
            raise InputError("rows of the strip", f"{first} to {stop}", f"rows from 0 to {self.shape[0]}")
        parts = []
        at, last = first - self.before, stop - self.before
        while at < last:
            k, within = divmod(at, self.stride)
            end = min(last - k * self.stride, self.stride)
            parts.append(self._blended(k)[within:end])
            at = k * self.stride + end
        found = np.concatenate(parts) if parts else np.empty((0, self.shape[1]))
        return found if self.transform is None else self.transform(found)

    def _blended(self, k: int) -> NDArray[np.float64]:
        """Rows k·stride … (k + 1)·stride − 1."""
        begins = self.before == 0
        kind = self.name, self.seed, self.stride, self.blend, self.shape[1], begins
        with _pieces.lock:
            held = _pieces.get((kind, k))
            if held is not None:
                return held[0]
            whole = self._field(k)
            head, tail = whole[: self.stride].copy(), whole[self.stride :].copy()
            del whole
            if k != 0 or not begins:
                known = _pieces.get((kind, k - 1))
                ending = None if known is None else known[1]
                if ending is None:
                    ending = self._field(k - 1)[self.stride :]
                angle = 0.5 * np.pi * ((np.arange(self.blend) + 0.5) / self.blend)[:, None]
                head[: self.blend] *= np.sin(angle)
                head[: self.blend] += np.cos(angle) * ending
            _pieces.put((kind, k), (head, tail))
            return head

    def _field(self, k: int) -> NDArray[np.float64]:
        seed = int(np.random.SeedSequence([self.seed, k % 2**32]).generate_state(1)[0])
        return self.piece(self.stride + self.blend, seed)
