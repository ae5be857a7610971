"""Generated fields of heights, kept in a temporary file: paths are read many times, and fill no memory."""

from __future__ import annotations

import tempfile
import threading
import weakref
from collections.abc import Callable, Hashable
from typing import IO

import numpy as np
from numpy.typing import NDArray

BYTES_KEPT = 2**29
"""Bytes of fields in the file; where there would be more, all are forgotten, and made again when read."""
BYTES_HELD = 2**26
"""The same in memory, where no file can be written."""
FEWEST = 3
"""Fields that are kept whatever their size: neighbours are read together."""


class Fields:
    """Fields (rows, ny) by their names, each made once; in memory where no temporary file can be written."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._kept: dict[Hashable, tuple[int, int]] = {}  # offset in the file, bytes, and ny
        self._held: dict[Hashable, NDArray[np.float64]] = {}
        self._file: IO[bytes] | None = None
        self._length = 0  # of the file, bytes

    def rows(
        self, name: Hashable, make: Callable[[], NDArray[np.float64]], first: int, stop: int
    ) -> NDArray[np.float64]:
        """Heights of the rows first … stop − 1 of a field, m, not to be written to; unknown ones are made.

        They take memory for as long as they are held.
        """
        with self._lock:
            if name not in self._kept and name not in self._held:
                self._put(name, make())
            if name in self._held:
                return self._held[name][first:stop]
            assert self._file is not None
            offset, columns = self._kept[name]
            # mapped: a position in the file would be shared with forked processes
            return np.memmap(
                self._file, np.float64, "r", offset + 8 * columns * first, (stop - first, columns)
            )

    @property
    def nbytes(self) -> int:
        """Bytes that are held in memory."""
        return sum(heights.nbytes for heights in self._held.values())

    def _put(self, name: Hashable, heights: NDArray[np.float64]) -> None:
        full = self._length + heights.nbytes > BYTES_KEPT or self.nbytes + heights.nbytes > BYTES_HELD
        if full and len(self._kept) + len(self._held) >= FEWEST:
            self._forget()
        try:
            self._write(name, heights)
        except OSError:
            self._held[name] = heights

    def _write(self, name: Hashable, heights: NDArray[np.float64]) -> None:
        if self._file is None:
            self._file = tempfile.TemporaryFile(prefix="asperity-")  # noqa: SIM115  closed below
            self._close = weakref.finalize(self, self._file.close)
        self._file.seek(self._length)
        self._file.write(np.ascontiguousarray(heights).data)
        self._file.flush()
        self._kept[name] = self._length, heights.shape[1]
        self._length += heights.nbytes

    def _forget(self) -> None:
        if self._file is not None:
            self._close()
        self._kept, self._held, self._file, self._length = {}, {}, None, 0


fields = Fields()
"""Those of all strips: strips of one texture share them."""
