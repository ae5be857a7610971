"""Running-in of a case: its textures after passes in which asperities have yielded."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from asperity.arguments import passes_of
from asperity.config.case import Case
from asperity.contact import HalfSpace
from asperity.contact.running_in import RunInHeights, RunningIn, run_in, tolerance_of, warn_of_running_in
from asperity.contact.scan import total
from asperity.progress import Progress
from asperity.reduction.stiffness import patches
from asperity.reduction.texture import punch_weights
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.laws import table_stride
from asperity.scenarios.textures import Textures
from asperity.store import Cache
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.statistics import rms_slope
from asperity.surfaces.strip import Rows
from asperity.threads import in_order, thread_count

EXPECTED_PASSES = 10
"""Passes to shakedown, for the plan: four to twenty."""


@dataclass(frozen=True, eq=False)
class Condition:
    """A surface before or after running-in, on the track: as wide as the nominal patch."""

    rms: float  # height, m
    slope: float  # rms, both directions
    area_ratio: float  # real contact area under the working load over that of smooth bodies
    stiffness: float  # dF/dr that small vibration feels under that load: elastic, N/m


@dataclass(frozen=True, eq=False)
class RunInCase:
    """Textures of a case after running-in, and what the passes did to samples and path together."""

    textures: Textures
    largest: NDArray[np.float64]  # (passes,), largest lowering of a place in each, m
    yielding: NDArray[np.float64]  # (passes,), share of the touched area that yielded in each
    yielded_share: float  # of the touched area, in all passes
    settled: bool  # whether the last pass changed nothing
    before: Condition
    after: Condition


def run_in_case(
    case: Case, textures: Textures, shape: Geometry, cache: Cache | None, progress: Progress
) -> RunInCase:
    """Run samples and path of a case in, each rolled over lengthwise under the working load.

    Samples are then cut from the strips, whose middles the body has passed. A path that is a line alone stays
    as it is. The cache keeps what was rolled.
    """
    job = running_in_job(case, shape)
    roll = partial(run_in, job=job, cache=cache, progress=progress)
    single = partial(roll, workers=1)
    strips = list(in_order(lambda strip: single(strip.heights), textures.strips, thread_count()))
    found, line, path, parts = [*strips], textures.line, textures.path, textures.parts
    if textures.path is not None:
        along = roll(textures.path.rows(0, textures.path.shape[0]))
        found.append(along)
        path = Rows(along.heights, textures.path.spacing)
        lowered = along.lowering[:, along.lowering.shape[1] // 2]
        line = line - lowered
        if parts:  # what is rolled over stands first, and takes it all
            over = next(iter(parts))
            parts = parts | {over: parts[over] - lowered}
    worst = max(found, key=lambda each: float(each.largest[-1]))
    together = replace(worst, counts=total(each.counts for each in found))
    warn_of_running_in(together, job, "numerics.rtol", _remedy(shape))
    maps = tuple(HeightMap(s.heights, shape.spacing, "run in") for s in strips)
    after = replace(
        textures, maps=maps, strips=maps, path=path, line=line, parts=parts, untouched=textures,
        origin=f"{textures.origin}; {_words(found, job, textures)}",
    )  # fmt: skip
    conditions = [_condition(case, shape, each) for each in (replace(textures, maps=textures.strips), after)]
    weights = np.array([np.count_nonzero(each.touched) for each in found], dtype=np.float64)
    weights /= max(weights.sum(), 1.0)
    passes = max(len(each.largest) for each in found)
    padded = [np.pad(each.yielding, (0, passes - len(each.yielding))) for each in found]
    return RunInCase(
        after,
        np.max([np.pad(each.largest, (0, passes - len(each.largest))) for each in found], axis=0),
        weights @ np.array(padded),
        float(weights @ np.array([each.yielded_share for each in found])),
        all(each.settled for each in found),
        *conditions,
    )


def running_in_job(case: Case, shape: Geometry) -> RunningIn:
    """The body of a case under its working load, and how often it rolls."""
    half_space = shape.half_space(case.contact.hardness)
    return RunningIn(
        half_space, shape.body, shape.load, passes_of(case.contact.running_in),
        tolerance_of(half_space, shape.body, shape.load), table_stride(shape), case.numerics.rtol,
    )  # fmt: skip


def running_in_passes(case: Case) -> int:
    """Passes of a case, as far as they are known."""
    return passes_of(case.contact.running_in) or EXPECTED_PASSES


def running_in_positions(shape: Geometry, textures: Textures) -> int:
    """Positions of a pass over samples and path."""
    rolled = [*textures.strips, *([] if textures.path is None else [textures.path])]
    spare = [max(strip.shape[0] - shape.body.shape[0], 0) for strip in rolled]
    return sum(rows // table_stride(shape) + 1 for rows in spare)


def _words(found: Sequence[RunInHeights], job: RunningIn, textures: Textures) -> str:
    what = "samples" if textures.path is None else "samples and path"
    passes = sorted({len(each.largest) for each in found})
    number = " to ".join(map(str, sorted({passes[0], passes[-1]})))
    words = f"{what} run in by {number} pass{'es' if passes[-1] > 1 else ''} under {job.load:.3g} N"
    return words if textures.path is not None else f"{words}, line of the path as given"


def _remedy(shape: Geometry) -> str:
    side = shape.body.shape[0] * shape.spacing[0]
    return f"Enlarge contact.window, now {side * 1e3:.3g} mm, or leave long waves out by surface.longest."


def _condition(case: Case, shape: Geometry, textures: Textures) -> Condition:
    """Describe samples and path, and press the body on the samples."""
    half_space, (nx, ny) = shape.half_space(case.contact.hardness), shape.body.shape
    elastic = HalfSpace((nx, ny), shape.spacing, shape.modulus)
    weights = punch_weights(shape.spacing, shape.semi_axes)
    samples = patches([m.heights for m in textures.maps], (nx, ny), case.contact.samples, weights)
    contacts = [half_space.solve(shape.body - s, load=shape.load, rtol=case.numerics.rtol) for s in samples]
    smooth = elastic.solve(shape.body, load=shape.load, rtol=case.numerics.rtol)
    tracks = [_track(strip.heights, shape) for strip in textures.strips]
    if textures.path is not None:
        tracks.append(_track(textures.path.rows(0, textures.path.shape[0]), shape))
    weights = np.array([track.heights.size for track in tracks], dtype=np.float64)
    squares = np.array([[np.var(track.heights), rms_slope(track) ** 2] for track in tracks])
    rms, slope = np.sqrt(weights @ squares / weights.sum())
    return Condition(
        float(rms),
        float(slope),
        float(np.mean([c.area for c in contacts])) / smooth.area,
        float(np.mean([elastic.tangent_stiffness(c.pressure) for c in contacts])),
    )


def _track(heights: NDArray[np.float64], shape: Geometry) -> HeightMap:
    """Heights over which the middle of the body has rolled, as wide as the nominal patch."""
    nx, ny = shape.body.shape
    half = min(max(1, round(shape.semi_axes[1] / shape.spacing[1])), ny // 2)
    rows = slice(nx // 2, max(len(heights) - nx // 2, nx // 2 + 2))
    return HeightMap(heights[rows, ny // 2 - half : ny // 2 + half + 1], shape.spacing)
