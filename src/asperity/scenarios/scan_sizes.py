"""How large the scans of a case are, and whether the disk holds them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from asperity.config.case import Case
from asperity.contact.device import find_device
from asperity.errors import InputError
from asperity.files import amount, free_space
from asperity.reduction.accuracy import FILTER_SHARE, in_single, rtol_for
from asperity.reduction.scan import BLOCK
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.laws import table_stride
from asperity.scenarios.line_filters import filter_stride
from asperity.scenarios.reducing import STATES
from asperity.scenarios.textures import Textures
from asperity.store import MOST_HELD

BLOCK_BYTES = 1200
"""What the file of a block holds beside its forces, bytes."""


@dataclass(frozen=True)
class Expected:
    """What a scan will take.

    Attributes
    ----------
    positions, states : int
        Size of the scan.
    step : float
        Distance of the positions, m.
    bytes : int
        Size on disk.
    single : bool
        Whether the iteration will be in single precision.
    seconds : float
        Time on all threads, nothing of it found in the cache; NaN before it was tried.
    """

    positions: int
    states: int
    step: float
    bytes: int
    single: bool
    seconds: float = math.nan

    @property
    def solutions(self) -> int:
        """Contact solutions, at most: states that do not touch need none."""
        return self.positions * self.states


def scan_sizes(case: Case, shape: Geometry, textures: Textures) -> dict[str, Expected]:
    """Find the sizes of the scans of a case.

    Parameters
    ----------
    case, shape, textures
        The case, what presses on what, and what is rolled over.

    Returns
    -------
    dict of Expected
        ``"filters"`` where rough samples are scanned, ``"path"`` where `table` is among the laws.
    """
    strips = [strip.shape[0] for strip in textures.strips if strip.heights.any()]
    result = {}
    if strips:
        result["filters"] = _sized(case, shape, strips, filter_stride(shape), FILTER_SHARE)
    if "table" in case.laws and textures.path is not None:
        result["path"] = _sized(case, shape, [textures.path.shape[0]], table_stride(shape))
    return result


def _sized(case: Case, shape: Geometry, rows: list[int], stride: int, share: float = 1.0) -> Expected:
    """Size of scans of so many rows whose forces are accurate to a share of what the case asks for."""
    window = shape.body.shape[0]
    positions = sum(max(n - window, 0) // stride + 1 for n in rows)
    states = STATES if case.contact.approaches is None else len(case.contact.approaches)
    cells = positions // len(rows) * states * shape.body.size  # of each scan
    single = find_device() is None and in_single(rtol_for(share * case.numerics.force_accuracy), cells)
    size = positions * states * 8 + sum(-(-positions // len(rows) // BLOCK) for _ in rows) * BLOCK_BYTES
    return Expected(positions, states, stride * shape.spacing[0], size, single)


def problem_of_disk(expected: Expected, root: Path) -> Iterator[InputError]:
    """Find out whether the disk of the cache has room for a scan, or memory is to hold it."""
    free = free_space(root)
    if free < expected.bytes > MOST_HELD:
        yield InputError(
            "disk of the cache",
            f"{amount(free)} free in {root}",
            f"{amount(expected.bytes)} for the scan of the path",
            "Set $ASPERITY_CACHE to a folder on another disk, or free some space.",
        )
