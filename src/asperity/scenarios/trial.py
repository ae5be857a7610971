"""Small pieces of a run, computed and timed, so that the whole of it can be expected."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from asperity.contact import HalfSpace
from asperity.contact.running_in import run_in
from asperity.contact.scan import FILTER_SHARE, ScanJob, first_touch, rtol_for, scan_forces
from asperity.errors import PhysicsWarning
from asperity.laws import Need, needs_of
from asperity.progress import Progress
from asperity.reduction.stiffness import isolated_share, patches
from asperity.reduction.texture import areal_texture, punch_weights
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.laws import table_stride
from asperity.scenarios.line_filters import filter_stride
from asperity.scenarios.preparing import PreparedCase
from asperity.scenarios.reducing import (
    chosen_states,
    filtered_loads,
    patch_planes,
    refuse_low_states,
    touched_places,
)
from asperity.scenarios.running_in import running_in_job
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.strip import Rows, Strip

T = TypeVar("T")

PLACES = (0.25, 0.5, 0.75)
"""Where along a strip positions are tried."""
POSITIONS = 4
"""Positions that are tried at each place after a first one, which starts cold."""
LONG = 2.0
"""Time of a trial, s, after which no further place is tried."""
ROWS = 2000
"""Rows of a path, at most, on which averages over patches are tried."""
STEPS = 400
"""Time steps that are tried."""


@dataclass(frozen=True, eq=False)
class ContactTrial:
    """Times of contact solutions and of what surrounds them, on one core, s."""

    approaches: NDArray[np.float64]  # (k,), states much as the run will choose them, m
    loaded: int  # states that have a filter
    load: float  # finding the working approach and the highest state of a sample
    curve: float  # a loading curve
    filters: float  # a position of the scan, all states together; zero where there is no such scan
    path: float  # likewise
    rolled: float  # a position of running-in; zero where there is none
    direct: float  # a solution from its neighbour's pressure
    touch: float  # a row in finding first touches
    average: float  # a row in averaging under one patch
    working: float = 0.0  # approach of a sample under the working load, m
    area_ratio: float = 1.0  # contact area of samples under that load over that of smooth bodies
    isolated_share: float = 0.0  # of that load on cells that touch alone
    cut_off: float = 0.0  # share of the contacts of its loading curve that the window cuts off


def timed(task: Callable[[], T]) -> tuple[T, float]:
    """Run a task silently, and measure its processor time, s: other work does not disturb it."""
    begin = time.process_time()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PhysicsWarning)
        result = task()
    return result, time.process_time() - begin


def try_contacts(prepared: PreparedCase, progress: Progress) -> ContactTrial:
    """Solve a few contacts of every kind that a case with samples needs."""
    case, shape, textures = prepared.case, prepared.shape, prepared.textures
    rtol = rtol_for(case.numerics.force_accuracy)
    message, (nx, ny) = "trying contacts", shape.body.shape
    progress(0, 4, message)
    weights = punch_weights(shape.spacing, shape.class_axes)
    samples = patches([m.heights for m in textures.maps], (nx, ny), case.contact.samples, weights)
    half_space = shape.half_space(case.contact.hardness)
    approaches, working, load = _states(prepared, half_space, samples)
    progress(1, 4, message)
    job = ScanJob(half_space, Rows(samples[0]), shape.body, approaches, rtol=rtol, device=None)
    scanned, curve = timed(partial(scan_forces, job, workers=1))
    force, (least, most) = scanned.forces[:, 0], filtered_loads(case.contact, shape)
    loaded = approaches[(force >= least) & (force <= most)]
    progress(2, 4, message)
    filters = path = 0.0
    if any(np.ptp(strip.heights) for strip in textures.strips) and len(loaded):
        finer = rtol_for(FILTER_SHARE * case.numerics.force_accuracy)
        like = replace(
            job, surface=textures.strips[0], approaches=loaded, stride=filter_stride(shape), rtol=finer
        )
        filters = _position_time(like)
    progress(3, 4, message)
    if Need.SCAN in needs_of(case.laws):
        path = _position_time(replace(job, surface=textures.surface, stride=table_stride(shape)), shape)
    rolled = _rolled_time(prepared) if case.contact.running_in is not None else 0.0
    rows = _middle(textures.path or textures.strips[0], ROWS)
    _, touch = timed(lambda: first_touch(rows.heights[: nx + 100], shape.body))
    axes = (min(shape.semi_axes[0], 0.45 * rows.size[0]), min(shape.semi_axes[1], 0.5 * rows.size[1]))
    _, average = timed(lambda: areal_texture(rows, shape.spacing, [0.0, 1e-9], [axes, axes]))
    solve = partial(half_space.solve, shape.body - samples[0], rtol=case.numerics.rtol)
    start = solve(approach=working * 0.98).pressure
    _, direct = timed(lambda: solve(approach=working, start=start))
    real = _real_contact(prepared, half_space, samples)
    progress(4, 4, message)
    shared = touch / min(101, rows.shape[0] - nx + 1), average / (2 * rows.shape[0])
    counts = scanned.counts
    return ContactTrial(
        approaches, len(loaded), load, curve, filters, path, rolled, direct, *shared, working=working, **real,
        cut_off=counts.truncated / max(counts.solved, 1),
    )  # fmt: skip


def _real_contact(
    prepared: PreparedCase, half_space: HalfSpace, samples: list[NDArray[np.float64]]
) -> dict[str, float]:
    """Mean area and grid of contacts under the working load, of a few samples where that takes long."""
    shape, rtol, begin = prepared.shape, prepared.case.numerics.rtol, time.process_time()
    smooth = half_space.solve(shape.body, load=shape.load, rtol=rtol).area
    pressed = []
    for sample in samples:
        pressed.append(half_space.solve(shape.body - sample, load=shape.load, rtol=rtol))
        if time.process_time() - begin > LONG:
            break
    return {
        "area_ratio": float(np.mean([contact.area for contact in pressed])) / smooth,
        "isolated_share": float(np.mean([isolated_share(contact.pressure) for contact in pressed])),
    }


def _states(
    prepared: PreparedCase, half_space: HalfSpace, samples: list[NDArray[np.float64]]
) -> tuple[NDArray[np.float64], float, float]:
    """States much as the run will choose them, the working approach, and the time of finding them, s."""
    shape, given = prepared.shape, prepared.case.contact.approaches
    gap = shape.body - samples[0]
    press = partial(half_space.solve, gap, load=shape.load, rtol=prepared.case.numerics.rtol)
    timed(press)  # what the first one prepares, the others find
    working, load = timed(press)
    if given is not None:
        approaches = np.array(given)
        pressed = [[half_space.solve(shape.body - s, r).force for r in given[-2:]] for s in samples]
        refuse_low_states(approaches, np.mean(pressed, axis=0), shape, working.approach)
        return approaches, working.approach, load
    places = [samples[0], *touched_places(prepared.textures, shape)]
    approaches, more = timed(partial(chosen_states, places, shape, half_space))
    of_each = more / len(places)
    return approaches, working.approach, load + of_each * (1 + (len(places) - 1) / len(samples))


def _position_time(job: ScanJob, level_by: Geometry | None = None) -> float:
    """Time of a position in a long scan: of those that start from a neighbour, at some places.

    States count from the plane that the patch of a geometry feels, if one is given.
    """
    nx, rows, found = job.body.shape[0], job.surface.shape[0], []
    begin = time.process_time()
    for place in PLACES:
        first = round(place * max(rows - nx - POSITIONS * job.stride, 0))
        piece = HeightMap(
            job.surface.rows(first, min(first + nx + POSITIONS * job.stride, rows)), job.surface.spacing
        )
        planes = np.zeros((piece.shape[0] - nx) // job.stride + 1)
        if level_by is not None:
            planes = patch_planes(piece, level_by)[nx // 2 :: job.stride][: len(planes)]
        here = replace(job, surface=piece, planes=planes)
        alone = replace(job, surface=Rows(piece.heights[:nx]), planes=planes[:1])
        _, cold = timed(partial(scan_forces, alone, workers=1))
        if cold > LONG or here.positions == 1:
            return cold
        _, all_of = timed(partial(scan_forces, here, workers=1))
        found.append(max(all_of - cold, 0.1 * all_of) / (here.positions - 1))
        if time.process_time() - begin > LONG:
            break
    return float(np.mean(found))


def _rolled_time(prepared: PreparedCase) -> float:
    """Time of a position of running-in, after a first pass over a piece of the samples."""
    job = running_in_job(prepared.case, prepared.shape)
    nx, heights = prepared.shape.body.shape[0], prepared.textures.strips[0].heights
    piece = heights[: nx + POSITIONS * job.stride]
    positions = (len(piece) - nx) // job.stride + 1
    twice = replace(job, passes=2)
    _, taken = timed(partial(run_in, piece, twice, workers=1))
    return taken / (2 * positions)


def _middle(strip: Strip, most: int) -> HeightMap:
    """At most so many rows from the middle of a strip."""
    first = max(0, (strip.shape[0] - most) // 2)
    return HeightMap(strip.rows(first, min(first + most, strip.shape[0])), strip.spacing)
