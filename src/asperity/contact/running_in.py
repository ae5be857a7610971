"""Running-in: a body rolled over a surface whose asperities flow, which lowers them for good."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.arguments import MOST_PASSES, SHAKEDOWN, Array, passes_of, real, real_array, whole
from asperity.contact.halfspace import HalfSpace
from asperity.contact.scan import Counts, total, warn_of_flaws
from asperity.errors import Grade, InputError, TruncatedContactWarning, UnconvergedWarning, percent
from asperity.kernels.scanning import TRUNCATED
from asperity.progress import Progress
from asperity.store import Cache, Checkpoint, content_key
from asperity.surfaces.heightmap import HeightMap
from asperity.threads import in_order

SETTLED_SHARE = 1e-3
"""Lowering in a pass, in approaches of the smooth bodies under the load, that counts as none."""
PIECE = 256
"""Positions at least that are rolled one after the other before the next piece may be taken."""


@dataclass(frozen=True, eq=False)
class RunningIn:
    """A body to be rolled over a surface, and how often: all that the lowering depends on."""

    half_space: HalfSpace  # grid of the window, (nx, ny) cells; modulus and hardness
    body: Array  # (nx, ny), shape of the smooth body, m, zero at its lowest point
    load: float  # N
    passes: int | None  # None for as many as it takes to shakedown
    tolerance: float  # lowering that counts as none, m
    stride: int = 1  # rows between positions
    rtol: float = 1e-6  # tolerance of each solution, as in `HalfSpace.solve`

    def key(self, heights: Array) -> str:
        """Name in the store of what these heights become."""
        space = self.half_space
        parameters = [list(space.spacing), space.modulus, space.hardness, self.load, self.tolerance]
        parameters += [self.passes or SHAKEDOWN, self.stride, self.rtol]
        return content_key("running-in", heights, self.body, parameters)

    def done(self, largest: Array) -> bool:
        """Whether passes that lowered places by so much, m, are enough."""
        if self.passes is not None:
            return len(largest) >= self.passes
        return len(largest) >= MOST_PASSES or (len(largest) > 0 and bool(largest[-1] <= self.tolerance))


@dataclass(frozen=True, eq=False)
class RunInHeights:
    """A surface after running-in."""

    heights: Array  # (n, ny), m, peaks positive
    lowering: Array  # (n, ny), by which places have been lowered for good, m, never negative
    touched: NDArray[np.bool_]  # (n, ny), places that have carried pressure
    largest: Array  # (passes,), largest lowering of a place in each pass, m
    yielding: Array  # (passes,), share of the touched area that yielded in each pass
    yielded_share: float  # of the touched area, in all passes together
    settled: bool  # whether the last pass lowered no place by more than the tolerance
    counts: Counts


def run_in(
    heights: Array,
    job: RunningIn,
    *,
    cache: Cache | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
) -> RunInHeights:
    """Roll a body over heights (n, ny), m, and lower what flows; passes that the cache knows are not rolled.

    At each position the contact is solved under the load with the pressure capped at the hardness. Where the
    cap leaves an overlap, the surface has yielded by as much and is lowered there before the body moves on:
    pressed again at the same place, it is elastic. Each place so keeps the largest indentation it has met.
    """
    state = _kept(heights, job, cache)
    lowering, touched, counts = state["lowering"], state["touched"], Counts(*state["counts"].tolist())
    largest, yielding = state["largest"], state["yielding"]
    checkpoint = None if cache is None else Checkpoint(cache, job.key(heights))
    while not job.done(largest):
        before, message = lowering.copy(), f"running in, pass {len(largest) + 1}"
        counts = total([counts, _pass(heights, lowering, touched, job, workers, progress, message)])
        step, area = lowering - before, max(int(np.count_nonzero(touched)), 1)
        largest = np.append(largest, step.max())
        yielding = np.append(yielding, np.count_nonzero(step > job.tolerance) / area)
        state = {"lowering": lowering, "touched": touched, "counts": np.array(counts)}
        if checkpoint is not None:
            checkpoint.save(state | {"largest": largest, "yielding": yielding})
    share = np.count_nonzero(lowering > job.tolerance) / max(int(np.count_nonzero(touched)), 1)
    settled = bool(largest[-1] <= job.tolerance)
    return RunInHeights(
        heights - lowering, lowering, touched, largest, yielding, share, settled, counts
    )  # fmt: skip


def _kept(heights: Array, job: RunningIn, cache: Cache | None) -> dict[str, NDArray[Any]]:
    """State after the passes that were rolled before, else an untouched surface."""
    kept = None if cache is None else cache.get(job.key(heights))
    if kept is not None:
        return kept
    return {
        "lowering": np.zeros(heights.shape),
        "touched": np.zeros(heights.shape, dtype=np.bool_),
        "counts": np.zeros(4, dtype=np.int64),
        "largest": np.empty(0),
        "yielding": np.empty(0),
    }


def _pass(
    heights: Array,
    lowering: Array,
    touched: NDArray[np.bool_],
    job: RunningIn,
    workers: int | None,
    progress: Progress | None,
    message: str,
) -> Counts:
    """Roll once over all heights, and add to the lowering.

    Pieces that share no row are rolled beside each other, first the even ones, then the odd ones: the number
    of threads changes no digit.
    """
    positions = range(0, len(heights) - job.body.shape[0] + 1, job.stride)
    size = max(PIECE, -(-job.body.shape[0] // job.stride))
    pieces = [positions[first : first + size] for first in range(0, len(positions), size)]
    roll, counts, done = partial(_piece, heights, lowering, touched, job), [], 0
    if progress:
        progress(0, len(positions), message)
    for parity in (0, 1):
        for found in in_order(roll, pieces[parity::2], workers):
            counts.append(found)
            done += found.solved
            if progress:
                progress(min(done, len(positions)), len(positions), message)
    return total(counts)


def _piece(
    heights: Array, lowering: Array, touched: NDArray[np.bool_], job: RunningIn, positions: range
) -> Counts:
    """Roll over a piece, from a cold start."""
    space, rows, counts = job.half_space, job.body.shape[0], []
    start: Array | None = None
    for first in positions:
        under = slice(first, first + rows)
        contact = space.at_load(job.body - (heights[under] - lowering[under]), job.load, start, job.rtol)
        touched[under] |= contact.pressure > 0.0
        if contact.pressure.max() >= space.pressure_cap:
            lowering[under] += contact.plastic_indentation
        start = np.zeros_like(contact.pressure)
        start[: -job.stride] = contact.pressure[job.stride :]
        cut_off = contact.edge_share > TRUNCATED
        counts.append(Counts(1, contact.iterations, int(not contact.converged), int(cut_off)))
    return total(counts)


def run_in_surface(
    half_space: HalfSpace,
    surface: ArrayLike | HeightMap,
    body: ArrayLike,
    load: float,
    passes: int | str,
    stride: int,
    tolerance: float | None,
    workers: int | None,
    cache: Cache | None,
    progress: Progress | None,
) -> HeightMap:
    """Check the arguments of `HalfSpace.run_in`, run in, and warn of flaws."""
    from asperity.contact.public_scan import check_settings, heights_on

    what = "body that runs in"
    if half_space.hardness is None:
        remedy = "Give the half-space a hardness; an elastic surface keeps no mark."
        raise InputError("hardness of the half-space", "None", "a pressure at which asperities flow", remedy)
    heights = heights_on(half_space, surface, "surface to be run in")
    shape = real_array(what, body, "an array (nx, ny) of lengths in m")
    if shape.shape != half_space.shape or not np.isfinite(shape).all():
        received = f"shape {shape.shape}" if shape.shape != half_space.shape else "values that are not finite"
        raise InputError(what, received, f"a finite array of the half-space's shape {half_space.shape}")
    (rows, width), (nx, ny) = heights.shape, shape.shape
    if width != ny or rows < nx:
        raise InputError(
            "surface to be run in",
            f"{rows} × {width} cells under a window of {nx} × {ny}",
            "a surface as wide as the window and not shorter",
            "Crop the surface to the window's width, or change the window.",
        )
    step = whole(
        "stride of running-in",
        stride,
        f"a whole number from 1 to {len(shape) - 1}",
        at_least=1,
        at_most=len(shape) - 1,
    )
    check_settings(workers, cache, progress)
    force = half_space.checked_load(load)
    settled = tolerance_of(half_space, shape, force) if tolerance is None else tolerance
    settled = real("tolerance of running-in", settled, "a length above zero, m", above=0.0)
    job = RunningIn(half_space, shape, force, passes_of(passes), settled, step)
    found = run_in(heights, job, cache=cache, workers=workers, progress=progress)
    warn_of_running_in(found, job, "rtol", "Enlarge the window.")
    number = f"{len(found.largest)} pass" + ("es" if len(found.largest) > 1 else "")
    words = f"run in by {number} under {force:.3g} N, {100 * found.yielded_share:.3g} % yielded"
    source = f"{surface.source}; {words}" if isinstance(surface, HeightMap) and surface.source else words
    return HeightMap(found.heights, half_space.spacing, source)


def tolerance_of(half_space: HalfSpace, body: Array, load: float) -> float:
    """Lowering that counts as none, m: `SETTLED_SHARE` of the approach of the smooth, elastic bodies."""
    elastic = HalfSpace(half_space.shape, half_space.spacing, half_space.modulus)
    return SETTLED_SHARE * elastic.at_load(body, load, None, 1e-4).approach


def warn_of_running_in(found: RunInHeights, job: RunningIn, tolerance: str, remedy: str) -> None:
    """Warn of contacts that went wrong, and of a surface that still yields where shakedown was asked for."""
    solved, iterations, unconverged, truncated = found.counts
    warn_of_flaws(Counts(solved, iterations, unconverged), "running-in", tolerance)
    if truncated:
        share = truncated / solved
        message = (
            f"in {truncated} of {solved} contacts of running-in ({percent(share)}) more than "
            f"{100 * TRUNCATED:.0f} % of the load acts on the window's edge: the contact is cut off, and "
            f"yields too much. {remedy}"
        )
        warnings.warn(TruncatedContactWarning(message, Grade.of_share(share)), stacklevel=3)
    if job.passes is None and not found.settled:
        last, least = (1e9 * length for length in (found.largest[-1], job.tolerance))
        message = (
            f"after {len(found.largest)} passes a place is still lowered by {last:.3g} nm in a pass, more "
            f"than {least:.3g} nm: the surface has not reached shakedown. The load is too high for the "
            "hardness: lower it, or give a number of passes."
        )
        warnings.warn(message, UnconvergedWarning, stacklevel=3)
