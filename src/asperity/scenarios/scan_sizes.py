"""How large the scans of a case are, and whether the disk holds them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from asperity.config.case import Case
from asperity.contact.scan import FILTER_SHARE, ScanJob, rtol_for
from asperity.errors import InputError
from asperity.files import amount, free_space
from asperity.laws import Need, needs_of
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.laws import table_stride
from asperity.scenarios.line_filters import filter_stride
from asperity.scenarios.reducing import STATES
from asperity.scenarios.textures import Textures
from asperity.store import MOST_HELD
from asperity.surfaces.strip import Strip


@dataclass(frozen=True)
class Expected:
    """What a scan will take."""

    positions: int
    states: int
    step: float  # distance of the positions, m
    bytes: int  # on disk
    single: bool  # whether the iteration will be in single precision

    @property
    def solutions(self) -> int:
        """Contact solutions, at most: states that do not touch need none."""
        return self.positions * self.states


def scan_sizes(case: Case, shape: Geometry, textures: Textures) -> dict[str, Expected]:
    """Find the sizes of the scans of a case.

    ``"filters"`` where rough samples are scanned, ``"path"`` where a law looks its scan up.
    """
    strips = [strip for strip in textures.strips if strip.heights.any()]
    accuracy, result = case.numerics.force_accuracy, {}
    if strips:
        result["filters"] = _sized(case, shape, strips, filter_stride(shape), FILTER_SHARE * accuracy)
    if Need.SCAN in needs_of(case.laws) and textures.path is not None:
        result["path"] = _sized(case, shape, [textures.path], table_stride(shape), accuracy, textures.before)
    return result


def _sized(
    case: Case, shape: Geometry, strips: Sequence[Strip], stride: int, force_accuracy: float, anchor: int = 0
) -> Expected:
    """Size of the scans of some strips, of as many states as the case names or the run chooses."""
    states = np.arange(float(len(case.contact.approaches or range(STATES))))
    half_space = shape.half_space(None)
    jobs = [
        ScanJob(half_space, strip, shape.body, states, stride, rtol_for(force_accuracy), anchor=anchor)
        for strip in strips
    ]
    return Expected(
        positions=sum(job.positions for job in jobs),
        states=len(states),
        step=stride * shape.spacing[0],
        bytes=sum(job.bytes for job in jobs),
        single=any(job.single for job in jobs),
    )


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
