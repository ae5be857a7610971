"""Numbers as they are read, however many there will be: in little memory until all are there."""

from typing import Any

import numpy as np

from asperity.arguments import Array, ArrayLike, NDArray

BLOCK = 2**16
"""Numbers that are held as they are, until so many are there."""
SMALL = (np.int8, np.int16, np.float32)
"""Types that they are held in then, where these have each of them to the last bit."""


class GrowingNumbers:
    """A row of numbers that grows: those of one or two digits take a byte each, beside a block."""

    def __init__(self) -> None:
        self._blocks = list[NDArray[Any]]()
        self._last = np.empty(0)  # a block from the first numbers on
        self._used = 0
        self._count = 0

    def __len__(self) -> int:
        return self._count

    def extend(self, values: ArrayLike) -> None:
        """Add numbers of any shape, row by row."""
        left = np.asarray(values, dtype=np.float64).reshape(-1)
        self._count += left.size
        if left.size and not self._last.size:
            self._last = np.empty(BLOCK)
        while left.size:
            some = left[: BLOCK - self._used]
            self._last[self._used : self._used + some.size] = some
            self._used += some.size
            left = left[some.size :]
            if self._used == BLOCK:
                self._close()

    def _close(self) -> None:
        """Put the last block to the others, in a small type where that holds it."""
        if self._used:
            self._blocks.append(_small(self._last[: self._used]))
            self._used = 0

    def poured(self) -> Array:
        """All of them (n,), which are here no more: they are never held twice."""
        self._close()
        return self._into(np.empty(self._count))

    def kept_small(self) -> NDArray[Any]:
        """All of them (n,), as `poured`, in the smallest type that has each of them."""
        self._close()
        kinds = {block.dtype for block in self._blocks} or {np.dtype(np.float64)}
        return self._into(np.empty(self._count, np.result_type(*kinds)))

    def _into(self, poured: NDArray[Any]) -> NDArray[Any]:
        while self._blocks:
            block = self._blocks.pop()
            poured[self._count - block.size : self._count] = block
            self._count -= block.size
        return poured


def _small(block: Array) -> NDArray[Any]:
    """Copy of numbers in the smallest type that has all of them, the sign of zero and NaN among them."""
    with np.errstate(invalid="ignore", over="ignore"):
        for kind in SMALL:
            small = block.astype(kind)
            if (small.astype(np.float64).view(np.int64) == block.view(np.int64)).all():
                return small
    return block.copy()
