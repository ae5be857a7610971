"""Strips along a path: read, or generated, piece by piece, so that no length is too long for memory."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from asperity.errors import InputError

PIECES_KEPT = 3
"""Generated pieces held at a time: those that threads on neighbouring positions read."""


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
    """A strip with heights added that are the same all across."""

    strip: Strip  # what lies below
    added: NDArray[np.float64]  # (nx,), heights added to each row, m

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
        return self.strip.rows(first, stop) + self.added[first:stop, None]


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
    alone and again, and a longer strip begins with the shorter one.
    """

    shape: tuple[int, int]
    spacing: tuple[float, float]
    piece: Callable[[int, int], NDArray[np.float64]]
    seed: int
    stride: int
    blend: int
    transform: Callable[[NDArray[np.float64]], NDArray[np.float64]] | None = None
    source: str = ""
    _kept: OrderedDict[int, tuple[NDArray[np.float64], NDArray[np.float64]]] = field(
        default_factory=OrderedDict, repr=False
    )
    _lock: threading.Lock = field(default_factory=threading.Lock, repr=False)

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
        at = first
        while at < stop:
            k, within = divmod(at, self.stride)
            end = min(stop - k * self.stride, self.stride)
            parts.append(self._blended(k)[within:end])
            at = k * self.stride + end
        found = np.concatenate(parts) if parts else np.empty((0, self.shape[1]))
        return found if self.transform is None else self.transform(found)

    def _blended(self, k: int) -> NDArray[np.float64]:
        """Rows k·stride … (k + 1)·stride − 1."""
        with self._lock:
            if k in self._kept:
                self._kept.move_to_end(k)
                return self._kept[k][0]
            whole = self._field(k)
            head, tail = whole[: self.stride].copy(), whole[self.stride :].copy()
            if k > 0:
                before = self._kept.get(k - 1)
                ending = self._field(k - 1)[self.stride :] if before is None else before[1]
                angle = 0.5 * np.pi * ((np.arange(self.blend) + 0.5) / self.blend)[:, None]
                head[: self.blend] *= np.sin(angle)
                head[: self.blend] += np.cos(angle) * ending
            self._kept[k] = head, tail
            if len(self._kept) > PIECES_KEPT:
                self._kept.popitem(last=False)
            return head

    def _field(self, k: int) -> NDArray[np.float64]:
        seed = int(np.random.SeedSequence([self.seed, k]).generate_state(1)[0])
        return self.piece(self.stride + self.blend, seed)
