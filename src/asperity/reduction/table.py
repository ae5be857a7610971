"""The scanned force of a path, kept on disk in blocks, to look forces up in."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity.arguments import Array, ArrayLike
from asperity.contact.scan import ScanJob, ScannedForces, solved_blocks, total
from asperity.errors import ComputationError
from asperity.kernels.along import OVERLAP, splines_along
from asperity.reduction.texture import grid_index
from asperity.store import Store


@dataclass(frozen=True, eq=False)
class StoredForces:
    """Forces of a scan, block by block in a cache."""

    cache: Store
    keys: tuple[str, ...]  # name of each block in the cache
    block: int  # positions in a block; the first lacks those `ahead`, the last may have fewer
    shape: tuple[int, ...]  # (states, positions)
    ahead: int = 0

    def columns(self, first: int, stop: int) -> Array:
        """Forces at the positions first … stop − 1, N, shape (states, stop − first)."""
        stop = min(stop, self.shape[1])
        whole = range((first + self.ahead) // self.block, (stop - 1 + self.ahead) // self.block + 1)
        blocks = whole if stop > first else range(0)
        parts = [np.empty((self.shape[0], 0)), *(self._forces(i) for i in blocks)]
        offset = max(blocks.start * self.block - self.ahead, 0)
        return np.concatenate(parts, axis=1)[:, first - offset : stop - offset]

    def _forces(self, index: int) -> Array:
        if (found := self.cache.get(self.keys[index])) is not None:
            return found["forces"]
        remedy = "the run again: it recomputes what is missing"
        raise ComputationError("forces of the path are no longer in the cache", remedy)


def scan_into(cache: Store, job: ScanJob, **how: Any) -> ScannedForces[StoredForces]:
    """Scan a path of any length: its forces stay in the cache, block by block.

    Memory holds the blocks in work and eight bytes a position. Further arguments as in `solved_blocks`.
    """
    keys, counts = [], []
    for block in solved_blocks(job, cache, **how):
        keys.append(block.key)
        counts.append(block.counts)
    shape = (len(job.approaches), job.positions)
    forces = StoredForces(cache, tuple(keys), job.block, shape, job.ahead)
    return ScannedForces(forces, total(counts), job.single)


def columns(forces: Array | StoredForces, first: int, stop: int) -> Array:
    """Forces at the positions first … stop − 1, N, shape (states, stop − first), in memory or stored."""
    return forces[:, first:stop] if isinstance(forces, np.ndarray) else forces.columns(first, stop)


PIECE = 8192
"""Positions worked on in one go."""


@dataclass(frozen=True, eq=False)
class ForceTable:
    """Contact force at positions of the path and states of the contact, at least two."""

    # (s, m), at state i and position m, N, not negative; not falling with the approach but by accuracy
    forces: Array | StoredForces
    approaches: Array  # (s,), of the states, m, increasing
    start: float  # position of the first point on the path, m
    spacing: float  # distance of the points, m
    touches: Array  # (m,), approach at which contact begins, m

    def at(self, positions: ArrayLike) -> Array:
        """Forces (n, s), N, at positions (n,), m, by cubic splines: not negative, not falling with states."""
        count = self.forces.shape[1]
        index = grid_index("force table", count, self.start, self.spacing, positions)
        result = np.empty((index.size, len(self.approaches)))
        for i in range(0, index.size, PIECE):
            piece = index[i : i + PIECE]
            first = max(0, int(piece.min()) - OVERLAP)
            stop = min(count, int(piece.max()) + 2 + OVERLAP)
            known = np.ascontiguousarray(columns(self.forces, first, stop))
            result[i : i + PIECE] = splines_along(known, piece - first)
        # a spline may undershoot beside a place where contact is lost
        return np.maximum.accumulate(np.maximum(result, 0.0, out=result), axis=1)

    def touch_at(self, positions: ArrayLike) -> Array:
        """Approach at first touch at positions (n,), m, interpolated linearly."""
        at = self.start + self.spacing * np.arange(self.forces.shape[1])
        return np.interp(np.asarray(positions, dtype=float), at, self.touches)
