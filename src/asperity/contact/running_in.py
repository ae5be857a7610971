"""Running-in: a body rolled over a surface whose asperities flow, which lowers them for good."""

from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np

from asperity.arguments import MOST_PASSES, SHAKEDOWN, Array, Flags, NDArray
from asperity.contact.elastic_grid import ElasticGrid
from asperity.contact.pressed import at_load
from asperity.contact.scan import Counts, total, warn_of_flaws
from asperity.errors import UnconvergedWarning
from asperity.kernels.scanning import TRUNCATED
from asperity.progress import Progress, counted
from asperity.store import Store, content_key
from asperity.threads import in_order
from asperity.written_numbers import rounded

SETTLED_SHARE = 1e-3
"""Lowering in a pass, in approaches of the smooth bodies under the load, that counts as none."""
PIECE = 256
"""Positions at least that are rolled one after the other before the next piece may be taken."""


@dataclass(frozen=True, eq=False)
class RunningIn:
    """A body to be rolled over a surface, and how often: all that the lowering depends on."""

    half_space: ElasticGrid  # grid of the window, (nx, ny) cells; modulus and hardness
    body: Array  # (nx, ny), shape of the smooth body, m, zero at its lowest point
    load: float  # N
    passes: int | None  # None for as many as it takes to shakedown
    stride: int = 1  # rows between positions
    rtol: float = 1e-6  # tolerance of each solution, as in `HalfSpace.solve`

    @cached_property
    def tolerance(self) -> float:
        """Lowering that counts as none, m: `SETTLED_SHARE` of the approach of the smooth, elastic bodies."""
        space = self.half_space
        elastic = ElasticGrid(space.shape, space.spacing, space.modulus, cells=space.cells)
        return SETTLED_SHARE * at_load(elastic, self.body, self.load, None, 1e-4).approach

    def key(self, heights: Array) -> str:
        """Name in the store of what these heights become."""
        space = self.half_space
        parameters = [list(space.spacing), space.modulus, space.hardness, self.load, self.tolerance]
        parameters += [] if space.cells == "whole" else [space.cells]
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
    touched: Flags  # (n, ny), places that have carried pressure
    largest: Array  # (passes,), largest lowering of a place in each pass, m
    yielded_share: float  # of the touched area, in all passes together
    settled: bool  # whether the last pass lowered no place by more than the tolerance
    counts: Counts


def run_in(
    heights: Array,
    job: RunningIn,
    *,
    cache: Store | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
) -> RunInHeights:
    """Roll a body over heights (n, ny), m, and lower what flows; passes that the cache knows are not rolled.

    At each position the contact is solved under the load with the pressure capped at the hardness. Where the
    cap leaves an overlap, the surface has yielded by as much and is lowered there before the body moves on:
    pressed again at the same place, it is elastic. Each place so keeps the largest indentation it has met.
    """
    key = "" if cache is None else job.key(heights)
    state: dict[str, NDArray[Any]] = (cache.get(key) if cache is not None else None) or {
        "lowering": np.zeros(heights.shape),
        "touched": np.zeros(heights.shape, dtype=np.bool_),
        "counts": np.zeros(4, dtype=np.int64),
        "largest": np.empty(0),
    }
    lowering = state["lowering"]
    touched = state["touched"]
    while not job.done(state["largest"]):
        before = lowering.copy()
        state["counts"] = state["counts"] + _pass(heights, state, job, workers, progress)
        state["largest"] = np.append(state["largest"], (lowering - before).max())
        if cache is not None:
            cache.put(key, state)
    share = np.count_nonzero(lowering > job.tolerance) / max(int(np.count_nonzero(touched)), 1)
    largest = state["largest"]
    counts = Counts(*state["counts"].tolist())
    settled = bool(largest[-1] <= job.tolerance)
    return RunInHeights(heights - lowering, lowering, touched, largest, share, settled, counts)


def _pass(
    heights: Array,
    state: dict[str, NDArray[Any]],
    job: RunningIn,
    workers: int | None,
    progress: Progress | None,
) -> Counts:
    """Roll once over all heights, and add to the lowering.

    Pieces that share no row are rolled beside each other, first the even ones, then the odd ones: the number
    of threads changes no digit.
    """
    positions = range(0, len(heights) - job.body.shape[0] + 1, job.stride)
    size = max(PIECE, -(-job.body.shape[0] // job.stride))
    pieces = [positions[first : first + size] for first in range(0, len(positions), size)]
    roll = partial(_piece, heights, state, job)
    message = f"running in, pass {len(state['largest']) + 1}"
    rolled = (found for parity in (0, 1) for found in in_order(roll, pieces[parity::2], workers))
    return total(counted(rolled, len(positions), message, progress, lambda found: found.solved))


def _piece(heights: Array, state: dict[str, NDArray[Any]], job: RunningIn, positions: range) -> Counts:
    """Roll over a piece, from a cold start."""
    space = job.half_space
    rows = job.body.shape[0]
    counts = []
    lowering = state["lowering"]
    start = None
    for first in positions:
        under = slice(first, first + rows)
        contact = at_load(space, job.body - (heights[under] - lowering[under]), job.load, start, job.rtol)
        state["touched"][under] |= contact.pressure > 0.0
        if contact.pressure.max() >= space.pressure_cap:
            lowering[under] += contact.plastic_indentation
        start = np.zeros_like(contact.pressure)
        start[: -job.stride] = contact.pressure[job.stride :]
        cut_off = contact.edge_share > TRUNCATED
        counts.append(Counts(1, contact.iterations, int(not contact.converged), int(cut_off)))
    return total(counts)


def warn_of_running_in(found: RunInHeights, job: RunningIn, tolerance: str, remedy: str) -> None:
    """Warn of contacts that went wrong, and of a surface that still yields where shakedown was asked for."""
    warn_of_flaws(found.counts, "running-in", tolerance, remedy, "yields too much")
    if job.passes is None and not found.settled:
        last, least = (1e9 * length for length in (found.largest[-1], job.tolerance))
        UnconvergedWarning.warn(
            f"after {len(found.largest)} passes a place is still lowered by {rounded(last)} nm in a pass, "
            f"more than {rounded(least)} nm: the surface has not reached shakedown. The load is too high "
            "for the hardness: lower it, or give a number of passes."
        )
