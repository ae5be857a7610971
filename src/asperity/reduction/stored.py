"""Forces of a scan that are too many for memory: read from the cache where they are looked at."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from asperity.contact.flaws import total
from asperity.contact.scan import ScanJob, ScannedForces, solved_blocks
from asperity.errors import ComputationError
from asperity.progress import Progress
from asperity.store import Cache


@dataclass(frozen=True, eq=False)
class StoredForces:
    """Forces of a scan, block by block in a cache."""

    cache: Cache
    keys: tuple[str, ...]  # name of each block in the cache
    block: int  # positions in a block; the first lacks those `ahead`, the last may have fewer
    shape: tuple[int, ...]  # (states, positions)
    ahead: int = 0

    def columns(self, first: int, stop: int) -> NDArray[np.float64]:
        """Forces at the positions first … stop − 1, N, shape (states, stop − first)."""
        stop = min(stop, self.shape[1])
        whole = range((first + self.ahead) // self.block, (stop - 1 + self.ahead) // self.block + 1)
        blocks = whole if stop > first else range(0)
        parts = [np.empty((self.shape[0], 0)), *(self._forces(i) for i in blocks)]
        offset = max(blocks.start * self.block - self.ahead, 0)
        return np.concatenate(parts, axis=1)[:, first - offset : stop - offset]

    def _forces(self, index: int) -> NDArray[np.float64]:
        found = self.cache.get(self.keys[index])
        if found is None:
            raise ComputationError(
                "forces of the path are no longer in the cache",
                "the run again: it recomputes what is missing",
            )
        return found["forces"]


def scan_into(
    cache: Cache,
    job: ScanJob,
    *,
    workers: int | None = None,
    progress: Progress | None = None,
    message: str = "scanning the contact",
) -> ScannedForces[StoredForces]:
    """Scan a path of any length: its forces stay in the cache, block by block.

    Memory holds the blocks in work and eight bytes a position. Arguments as in `solved_blocks`.
    """
    keys, counts = [], []
    for block in solved_blocks(job, cache, workers, progress, message):
        keys.append(block.key)
        counts.append(block.counts)
    shape = (len(job.approaches), job.positions)
    forces = StoredForces(cache, tuple(keys), job.block, shape, job.ahead)
    return ScannedForces(forces, total(counts), job.single)


def columns(forces: NDArray[np.float64] | StoredForces, first: int, stop: int) -> NDArray[np.float64]:
    """Forces at the positions first … stop − 1, N, shape (states, stop − first), in memory or stored."""
    return forces[:, first:stop] if isinstance(forces, np.ndarray) else forces.columns(first, stop)
