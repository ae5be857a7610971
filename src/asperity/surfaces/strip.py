"""Heights along a path, asked for in pieces; generated ones stay in a temporary file, and fill no memory."""

import tempfile
import threading
import weakref
from collections.abc import Callable, Hashable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import IO, Protocol

import numpy as np

from asperity.arguments import Array

BYTES_KEPT = 2**29
"""Bytes of fields in the file; where there would be more, all are forgotten, and made again when read."""
BYTES_IN_MEMORY = 2**26
"""The same in memory, where no file can be written."""
FEWEST = 3
"""Fields that are kept whatever their size: neighbours are read together."""


class Fields:
    """Fields (rows, ny) by their names, each made once; in memory where no temporary file can be written."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._held: dict[Hashable, Array | tuple[int, int]] = {}  # or offset in the file, bytes, and ny
        self._file: IO[bytes] | None = None
        self._close: Callable[[], object] = lambda: None
        self._length = 0  # of the file, bytes

    def rows(self, name: Hashable, make: Callable[[], Array], first: int, stop: int) -> Array:
        """Heights of the rows first … stop − 1 of a field, m, not to be written to; unknown ones are made.

        They take memory for as long as they are held.
        """
        with self._lock:
            if name not in self._held:
                self._put(name, make())
            held = self._held[name]
            if isinstance(held, np.ndarray):
                return held[first:stop]
            assert self._file is not None
            offset, columns = held
            # mapped: a position in the file would be shared with forked processes
            start, shape = offset + 8 * columns * first, (stop - first, columns)
            return np.memmap(self._file, np.float64, "r", start, shape)

    @property
    def nbytes(self) -> int:
        """Bytes that are held in memory."""
        return sum(held.nbytes for held in self._held.values() if isinstance(held, np.ndarray))

    def _put(self, name: Hashable, heights: Array) -> None:
        size = heights.nbytes
        full = self._length + size > BYTES_KEPT or self.nbytes + size > BYTES_IN_MEMORY
        if full and len(self._held) >= FEWEST:
            self._close()
            self._held, self._file, self._length = {}, None, 0
        self._held[name] = heights
        with suppress(OSError):
            if self._file is None:
                self._file = tempfile.TemporaryFile(prefix="asperity-")  # noqa: SIM115  closed below
                self._close = weakref.finalize(self, self._file.close)
            self._file.seek(self._length)
            self._file.write(np.ascontiguousarray(heights).data)
            self._file.flush()
            self._held[name] = self._length, heights.shape[1]
            self._length += size


fields = Fields()
"""Those of all strips: strips of one texture share them."""


class Strip(Protocol):
    """Heights along a path, asked for in pieces: a `HeightMap` is one."""

    @property
    def shape(self) -> tuple[int, int]:
        """Number of points (nx, ny); the first axis is the rolling direction."""

    @property
    def spacing(self) -> tuple[float, float]:
        """Distances (dx, dy), m."""

    def rows(self, first: int, stop: int) -> Array:
        """Heights of the rows first … stop − 1, m, shape (stop − first, ny)."""


class Rows:
    """Heights (nx, ny), m, in memory as a strip, without copying or checking them; spacing (dx, dy), m."""

    def __init__(self, heights: Array, spacing: tuple[float, float] = (1.0, 1.0)) -> None:
        self.heights, self.spacing, self.shape = heights, spacing, (heights.shape[0], heights.shape[1])

    def rows(self, first: int, stop: int) -> Array:
        """Heights of the rows first … stop − 1, m."""
        return self.heights[first:stop]


class Raised:
    """A strip with heights added to it: `added` for rows first … stop − 1, (stop − first, ny or 1), m."""

    def __init__(self, strip: Strip, added: Callable[[int, int], Array]) -> None:
        self.strip, self.added, self.shape, self.spacing = strip, added, strip.shape, strip.spacing

    def rows(self, first: int, stop: int) -> Array:
        """Heights of the rows first … stop − 1, m."""
        return self.strip.rows(first, stop) + self.added(first, stop)


def raised(strip: Strip, heights: Array) -> Raised:
    """Add heights (nx,), m, that are the same all across."""
    return Raised(strip, lambda first, stop: heights[first:stop, None])


def turning(strip: Strip, turn: Array, start: int) -> Raised:
    """Add one turn (n, ny), m, of what rolls, again and again; its row `start` touches row zero."""
    return Raised(strip, lambda first, stop: turn[(np.arange(first, stop) + start) % len(turn)])


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
    piece: Callable[[int, int], Array]
    seed: int
    stride: int
    blend: int
    transform: Callable[[Array], Array] | None = None
    source: str = ""
    before: int = 0
    name: Hashable = field(default_factory=object, repr=False)

    def rows(self, first: int, stop: int) -> Array:
        """Heights of the rows first … stop − 1, m, shape (stop − first, ny)."""
        heights = np.empty((stop - first, self.shape[1]))
        at, last = first - self.before, stop - self.before
        while at < last:
            k, within = divmod(at, self.stride)
            end = min(last - k * self.stride, self.stride)
            self._read(k, within, heights[at + self.before - first :][: end - within])
            at = k * self.stride + end
        return heights if self.transform is None else self.transform(heights)

    def _read(self, k: int, within: int, heights: Array) -> None:
        """Read heights (n, ny), m, of piece k from a row within it on, blended with the one before."""
        heights[:] = self._field(k, within, within + len(heights))
        blended = min(len(heights), self.blend - within)
        if blended > 0 and (k != 0 or self.before > 0):
            angle = 0.5 * np.pi * ((np.arange(within, within + blended) + 0.5) / self.blend)[:, None]
            heights[:blended] *= np.sin(angle)
            ending = self.stride + within
            heights[:blended] += np.cos(angle) * self._field(k - 1, ending, ending + blended)

    def _field(self, k: int, first: int, stop: int) -> Array:
        """Rows first … stop − 1 of piece k, which has stride + blend of them."""
        seed = int(np.random.SeedSequence([self.seed, k % 2**32]).generate_state(1)[0])
        name = self.name, seed, self.stride, self.blend, self.shape[1]
        return fields.rows(name, lambda: self.piece(self.stride + self.blend, seed), first, stop)
