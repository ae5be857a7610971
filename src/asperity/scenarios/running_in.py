"""Running-in of a case: its textures after passes in which asperities have yielded."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from asperity.arguments import Array, passes_of
from asperity.contact.running_in import RunInHeights, RunningIn, run_in, warn_of_running_in
from asperity.contact.scan import total
from asperity.progress import Progress
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.reducing import samples_of
from asperity.scenarios.scanned_positions import edge_stride
from asperity.scenarios.scene import PreparedCase
from asperity.scenarios.textures import Textures
from asperity.schema import Values, contact
from asperity.store import Store
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.strip import Rows
from asperity.threads import in_order, thread_count
from asperity.written_numbers import in_newtons, rounded

EXPECTED_PASSES = 10
"""Passes to shakedown, for the plan: four to twenty."""


def run_in_case(prepared: PreparedCase, progress: Progress) -> tuple[Textures, Values]:
    """Run samples and path of a case in, each rolled over lengthwise under the working load.

    Samples are then cut from the strips, whose middles the body has passed. A path that is a line alone stays
    as it is. The cache keeps what was rolled. Returned are textures after running-in, and what it did.
    """
    case = prepared.case
    shape = prepared.shape
    textures = prepared.textures
    half_space = shape.half_space(case.contact.hardness)
    job = RunningIn(
        half_space, shape.body, shape.load, passes_of(case.contact.running_in), edge_stride(shape),
        case.numerics.rtol,
    )  # fmt: skip
    roll = partial(run_in, job=job, cache=Store(), progress=progress)
    strips = list(in_order(lambda strip: roll(strip.heights, workers=1), textures.strips, thread_count()))
    surfaces = [*strips]
    line = textures.line
    path = textures.path
    parts = textures.parts
    if textures.path is not None:
        along = roll(textures.path.rows(0, textures.path.shape[0]))
        surfaces.append(along)
        path = Rows(along.heights, textures.path.spacing)
        lowered = along.lowering[:, along.lowering.shape[1] // 2]
        line = line - lowered
        if parts:  # what is rolled over stands first, and takes it all
            over = next(iter(parts))
            parts = parts | {over: parts[over] - lowered}
    worst = max(surfaces, key=lambda each: float(each.largest[-1]))
    together = replace(worst, counts=total(each.counts for each in surfaces))
    window = f"now {rounded(shape.body.shape[0] * shape.spacing[0] * 1e3)} mm"
    remedy = f"Enlarge contact.window, {window}, or leave long waves out by surface.longest."
    warn_of_running_in(together, job, "numerics.rtol", remedy)
    maps = tuple(HeightMap(s.heights, shape.spacing, "run in") for s in strips)
    origin = f"{textures.origin}; {_words(surfaces, job, textures)}"
    after = replace(
        textures, maps=maps, strips=maps, path=path, line=line, parts=parts, untouched=textures, origin=origin
    )
    before = replace(textures, maps=textures.strips)
    conditions = np.array([_condition(prepared, each) for each in (before, after)])
    return after, _passes(surfaces, conditions)


def _passes(surfaces: Sequence[RunInHeights], conditions: Array) -> Values:
    """What each pass did to all surfaces together, and their conditions (2, 2) before and after."""
    weights = np.array([np.count_nonzero(each.touched) for each in surfaces], dtype=np.float64)
    weights /= max(weights.sum(), 1.0)
    passes = max(len(each.largest) for each in surfaces)
    largest = np.zeros((len(surfaces), passes))
    for n, each in enumerate(surfaces):
        largest[n, : len(each.largest)] = each.largest
    return {
        contact.RUNNING_IN_PASS: np.arange(1, passes + 1),
        contact.RUNNING_IN_LOWERING: largest.max(axis=0),
        contact.CONDITION: ["before", "after"],
        contact.TRACK_RMS: conditions[:, 0],
        contact.TRACK_STIFFNESS: conditions[:, 1],
        contact.YIELDED_SHARE: float(weights @ np.array([each.yielded_share for each in surfaces])),
        contact.SHAKEN_DOWN: int(all(each.settled for each in surfaces)),
    }


def running_in_solutions(prepared: PreparedCase) -> int:
    """Contacts to solve in all passes over samples and path, as far as their number is known."""
    shape = prepared.shape
    textures = prepared.textures
    rolled = [*textures.strips, *([] if textures.path is None else [textures.path])]
    spare = [max(strip.shape[0] - shape.body.shape[0], 0) for strip in rolled]
    passes = passes_of(prepared.case.contact.running_in) or EXPECTED_PASSES
    return passes * sum(rows // edge_stride(shape) + 1 for rows in spare)


def _words(surfaces: Sequence[RunInHeights], job: RunningIn, textures: Textures) -> str:
    what = "samples" if textures.path is None else "samples and path"
    passes = sorted({len(each.largest) for each in surfaces})
    number = " to ".join(map(str, sorted({passes[0], passes[-1]})))
    words = f"{what} run in by {number} pass{'es' if passes[-1] > 1 else ''} under {in_newtons(job.load)}"
    return words if textures.path is not None else f"{words}, line of the path as given"


def _condition(prepared: PreparedCase, textures: Textures) -> tuple[float, float]:
    """Of samples and path rms height on the track, m; pressed, their stiffness, N/m.

    The track is as wide as the nominal patch; the stiffness is that which small vibration feels: elastic.
    """
    case = prepared.case
    shape = prepared.shape
    half_space = shape.half_space(case.contact.hardness)
    elastic = shape.half_space(None)
    samples = samples_of(case, shape, textures.maps, shape.semi_axes)
    rtol = case.numerics.rtol
    contacts = [half_space.solve(shape.body - each, load=shape.load, rtol=rtol) for each in samples]
    stiffnesses = [elastic.tangent_stiffness(each.pressure) for each in contacts]
    tracks = [_track(strip.heights, shape) for strip in textures.strips]
    if textures.path is not None:
        tracks.append(_track(textures.path.rows(0, textures.path.shape[0]), shape))
    weights = np.array([track.size for track in tracks], dtype=np.float64)
    square = weights @ np.array([np.var(track) for track in tracks]) / weights.sum()
    return float(np.sqrt(square)), float(np.mean(stiffnesses))


def _track(heights: Array, shape: Geometry) -> Array:
    """Heights over which the middle of the body has rolled, as wide as the nominal patch."""
    nx, ny = shape.body.shape
    half = min(max(1, round(shape.semi_axes[1] / shape.spacing[1])), ny // 2)
    rows = slice(nx // 2, max(len(heights) - nx // 2, nx // 2 + 2))
    return heights[rows, ny // 2 - half : ny // 2 + half + 1]
