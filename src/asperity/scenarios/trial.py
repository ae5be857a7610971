"""A few contacts of a case, solved beforehand: how much of them is real, and how long one takes."""

from __future__ import annotations

import time
import warnings
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from asperity.contact import HalfSpace
from asperity.contact.scan import ScanJob, rtol_for, scan_forces
from asperity.errors import PhysicsWarning
from asperity.progress import Progress
from asperity.reduction.stiffness import isolated_share, patches
from asperity.reduction.texture import punch_weights
from asperity.scenarios.preparing import PreparedCase
from asperity.scenarios.reducing import chosen_states, refuse_low_states, touched_places
from asperity.surfaces.strip import Rows

LONG = 2.0
"""Processor time, s, after which no further sample is pressed."""


@dataclass(frozen=True, eq=False)
class ContactTrial:
    """What samples of a case say of its contact."""

    approaches: NDArray[np.float64]  # (k,), states much as the run will choose them, m
    working: float  # approach of a sample under the working load, m
    area_ratio: float  # contact area of samples under that load over that of smooth bodies
    isolated_share: float  # of that load on cells that touch alone
    cut_off: float  # share of the contacts of its loading curve that the window cuts off
    solution: float  # processor time of a contact of that curve, s


def try_contacts(prepared: PreparedCase, progress: Progress) -> ContactTrial:
    """Press some samples of a case, and compute the loading curve of the first."""
    case, shape, textures = prepared.case, prepared.shape, prepared.textures
    message = "trying contacts"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PhysicsWarning)
        progress(0, 3, message)
        weights = punch_weights(shape.spacing, shape.class_axes)
        heights = [sample.heights for sample in textures.maps]
        samples = patches(heights, shape.body.shape, case.contact.samples, weights)
        half_space = shape.half_space(case.contact.hardness)
        approaches, working = _states(prepared, half_space, samples)
        progress(1, 3, message)
        rtol = rtol_for(case.numerics.force_accuracy)
        job = ScanJob(half_space, Rows(samples[0]), shape.body, approaches, rtol=rtol, device=None)
        begin = time.process_time()
        counts = scan_forces(job, workers=1).counts
        solution = (time.process_time() - begin) / len(approaches)
        progress(2, 3, message)
        area_ratio, alone = _real_contact(prepared, half_space, samples)
        progress(3, 3, message)
    cut_off = counts.truncated / max(counts.solved, 1)
    return ContactTrial(approaches, working, area_ratio, alone, cut_off, solution)


def _real_contact(
    prepared: PreparedCase, half_space: HalfSpace, samples: list[NDArray[np.float64]]
) -> tuple[float, float]:
    """Mean area ratio and isolated share under the working load, of a few samples where that takes long."""
    shape, rtol, begin = prepared.shape, prepared.case.numerics.rtol, time.process_time()
    smooth = half_space.solve(shape.body, load=shape.load, rtol=rtol).area
    pressed = []
    for sample in samples:
        pressed.append(half_space.solve(shape.body - sample, load=shape.load, rtol=rtol))
        if time.process_time() - begin > LONG:
            break
    area = float(np.mean([contact.area for contact in pressed]))
    return area / smooth, float(np.mean([isolated_share(contact.pressure) for contact in pressed]))


def _states(
    prepared: PreparedCase, half_space: HalfSpace, samples: list[NDArray[np.float64]]
) -> tuple[NDArray[np.float64], float]:
    """States much as the run will choose them, and the working approach, m."""
    shape, given = prepared.shape, prepared.case.contact.approaches
    press = partial(half_space.solve, shape.body - samples[0], rtol=prepared.case.numerics.rtol)
    working = press(load=shape.load).approach
    if given is None:
        return chosen_states(
            [samples[0], *touched_places(prepared.textures, shape)], shape, half_space
        ), working
    approaches = np.array(given)
    pressed = [[half_space.solve(shape.body - s, r).force for r in given[-2:]] for s in samples]
    refuse_low_states(approaches, np.mean(pressed, axis=0), shape, working)
    return approaches, working
