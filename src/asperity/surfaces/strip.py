"""Heights along a path, asked for in pieces; generated ones stay in a temporary file, and fill no memory."""

import os
import tempfile
import threading
import weakref
from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import IO, Protocol

import numpy as np

from asperity.arguments import Array
from asperity.surfaces.tiles import Drawn, fine, heights_at
from asperity.threads import begun_in_order, refuse_to_go_on

BYTES_KEPT = 2**29
"""Bytes of fields in the file; where there would be more, all are forgotten, and made again when read."""
BYTES_IN_MEMORY = 2**26
"""The same in memory: of fields that need no file, and where none can be written."""
FEWEST = 3
"""Fields that are kept whatever their size: neighbours are read together."""
PIECE = 2**11
"""Rows of a strip that are made together."""


class Fields:
    """Fields (rows, ny) by their names, each made once; in memory where no temporary file can be written.

    Threads make different ones at once, and who wants one that another thread makes waits for it.
    With `fewest` they are in memory alone, and so many are kept whatever their size. A process that is forked
    reads what it has inherited, and writes into a file of its own.
    """

    def __init__(self, fewest: int | None = None) -> None:
        self._changed = threading.Condition()
        self._making = set[Hashable]()  # names of those that a thread makes
        self._in_memory = fewest is not None
        self._fewest = FEWEST if fewest is None else fewest
        self._held: dict[Hashable, Array | tuple[int, tuple[int, ...]]] = {}  # or offset in bytes, and shape
        self._file: IO[bytes] | None = None
        self._writer = 0  # number of the process whose file it is
        self._close: Callable[[], object] = lambda: None
        self._length = 0  # of the file, bytes
        self.nbytes = 0  # that are held in memory

    def rows(self, name: Hashable, make: Callable[[], Array]) -> Array:
        """Heights of all rows of a field, m, not to be written to; unknown ones are made.

        They take memory for as long as they are held.
        """
        with self._changed:
            self._changed.wait_for(lambda: name not in self._making)
            if name in self._held:
                return self._read(name)
            self._making.add(name)
        try:
            heights = make()  # others are made meanwhile
            with self._changed:
                self._put(name, heights)
                return self._read(name)
        finally:
            with self._changed:
                self._making.remove(name)
                self._changed.notify_all()

    def _read(self, name: Hashable) -> Array:
        held = self._held[name]
        if isinstance(held, np.ndarray):
            return held
        assert self._file is not None
        # mapped: a position in the file would be shared with forked processes
        return np.memmap(self._file, np.float64, "r", *held)

    def _put(self, name: Hashable, heights: Array) -> None:
        size = heights.nbytes
        full = self._length + size > BYTES_KEPT or self.nbytes + size > BYTES_IN_MEMORY
        inherited = self._file is not None and self._writer != os.getpid()
        if inherited or (full and len(self._held) >= self._fewest):
            self._close()
            self._held = {}
            self._file = None
            self._length = 0
            self.nbytes = 0
        if self._in_memory:
            self._hold(name, heights)
            return
        try:
            if self._file is None:
                self._file = tempfile.TemporaryFile(prefix="asperity-")  # noqa: SIM115  closed below
                self._writer = os.getpid()
                self._close = weakref.finalize(self, self._file.close)
            self._file.seek(self._length)
            self._file.write(np.ascontiguousarray(heights).data)
            self._file.flush()
            self._held[name] = self._length, heights.shape
            self._length += size
        except OSError:
            self._hold(name, heights)

    def _hold(self, name: Hashable, heights: Array) -> None:
        self._held[name] = heights
        self.nbytes += heights.nbytes


pieces = Fields()
"""Pieces of all strips, as they are read: strips of one texture share them."""
tiles = Fields(fewest=24)
"""Tiles that pieces beside each other are made of, two or three of each range of waves."""


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
        self.heights = heights
        self.spacing = spacing
        self.shape = (heights.shape[0], heights.shape[1])

    def rows(self, first: int, stop: int) -> Array:
        """Heights of the rows first … stop − 1, m."""
        return self.heights[first:stop]


class Raised:
    """A strip with heights added to it: `added` for rows first … stop − 1, (stop − first, ny or 1), m."""

    def __init__(self, strip: Strip, added: Callable[[int, int], Array]) -> None:
        self.strip = strip
        self.added = added
        self.shape = strip.shape
        self.spacing = strip.spacing

    def rows(self, first: int, stop: int) -> Array:
        """Heights of the rows first … stop − 1, m."""
        return self.strip.rows(first, stop) + self.added(first, stop)


def raised(strip: Strip, heights: Array) -> Raised:
    """Add heights (nx,), m, that are the same all across."""
    return Raised(strip, lambda first, stop: heights[first:stop, None])


def turning(strip: Strip, turn: Array, start: int) -> Raised:
    """Add one turn (n, ny), m, of what rolls, again and again; its row `start` touches row zero."""
    return Raised(strip, lambda first, stop: turn[(np.arange(first, stop) + start) % len(turn)])


Range = tuple[int, int]


def joined_pieces(
    rows: Range, lines: int, piece: Callable[[int], Range], made: Callable[[int, int], Array]
) -> Array:
    """Heights (rows, lines), m, of rows from one to before another, of the pieces that hold them."""
    start, stop = rows
    heights = np.empty((max(stop - start, 0), lines))
    while start < stop:
        begin, end = piece(stop - 1)  # the last first: threads that read one behind another each make one
        since = max(start, begin)
        heights[since - start : stop - start] = made(begin, end)[since - begin : stop - begin]
        stop = since
    return heights


@contextmanager
def drawn_meanwhile(strip: Strip | None) -> Iterator[None]:
    """Draw pieces of a strip that will be read, if any, on a thread while the ``with`` statement runs."""
    with begun_in_order(_draw, [] if strip is None else [strip]):
        yield


def _draw(strip: Strip) -> None:
    rows, _ = strip.shape
    for row in range(0, rows, PIECE):
        refuse_to_go_on()
        strip.rows(row, row + 1)  # all of the piece that holds it is made


@dataclass(frozen=True, eq=False)
class LongStrip:
    """Gaussian strip of any length, drawn where it is read.

    The surface is `drawn` as `asperity.surfaces.tiles` says: what lies at a place depends neither on the
    strip's length or width nor on its spacing. Place zero is at row `before`, and in the middle across, at
    line ny // 2. `transform` translates the heights, m, point by point.

    Any part of the strip can be had alone and again, to the bit. It is made in pieces, which are kept, as a
    path is read several times; strips of one surface, width and spacing share those within both.
    """

    shape: tuple[int, int]
    spacing: tuple[float, float]
    drawn: Drawn
    transform: Callable[[Array], Array] | None = None
    source: str = ""
    before: int = 0

    @property
    def draw(self) -> str:
        """What its random numbers belong to."""
        return self.drawn.draw

    def rows(self, first: int, stop: int) -> Array:
        """Heights of the rows first … stop − 1, m, shape (stop − first, ny)."""
        heights = joined_pieces((first, stop), self.shape[1], self._piece, self._made)
        return heights if self.transform is None else self.transform(heights)

    def _piece(self, row: int) -> tuple[int, int]:
        """First row of the piece that holds a row, and the one behind it: counted from place zero on."""
        begin = (row - self.before) // PIECE * PIECE + self.before
        end = begin + PIECE
        return (max(begin, 0), min(end, self.shape[0])) if 0 <= row < self.shape[0] else (begin, end)

    def _made(self, first: int, stop: int) -> Array:
        """Heights of rows of one piece, m, before they are translated."""
        lines = self.shape[1]
        dx, dy = self.spacing
        rows = np.arange(first, stop) - self.before
        name = self.drawn.name, dx, dy, lines, int(rows[0]), len(rows)
        return pieces.rows(
            name, lambda: heights_at(self.drawn.ranges, np.asarray(dx * rows), lines, self._tile)
        )

    def _tile(self, which: int, tile: int) -> Array:
        """Heights of a range of waves in a tile on its own fine grid, m."""
        lines = self.shape[1]
        dy = self.spacing[1]
        name = self.drawn.name, which, tile, dy, lines
        waves = self.drawn.ranges[which]
        return tiles.rows(name, lambda: fine(waves.waves(tile, places_across(lines, dy))))


def places_across(lines: int, spacing: float) -> Array:
    """Places across (lines,), m, of lines a spacing apart; the middle one is at zero."""
    return np.asarray(spacing * (np.arange(lines) - lines // 2))
