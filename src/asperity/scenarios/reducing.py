"""The reduction of a case: from textures to the state functions that the laws use."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from asperity.config.sections import ContactCase, Numerics
from asperity.contact import Contact, HalfSpace
from asperity.contact.scan import FILTER_SHARE, Counts, first_touch, rtol_for, total, warn_of_flaws
from asperity.errors import InputError
from asperity.progress import Progress
from asperity.reduction.filter import Normalise
from asperity.reduction.stiffness import (
    ForceCurve,
    StiffnessEnsemble,
    isolated_share,
    patches,
    stiffness_ensemble,
)
from asperity.reduction.texture import areal_texture, punch_weights
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.line_filters import LineFilters, line_filters
from asperity.scenarios.textures import Textures
from asperity.store import Cache
from asperity.surfaces.strip import Strip

STATES = 16
"""States chosen where the case names no approaches; up to twice as many where the path is touched earlier."""
EVENLY = 1.0 / 3.0
"""Power of the mean force in which chosen states are evenly apart: close where asperities join in, and half a
working approach under the largest force, where F^(2/3) is all but straight."""
PRESSED = 5
"""Forces for which approaches are found before states are chosen."""
LIGHTEST_STATE = 0.02
"""Mean force of the lowest chosen state, in loads of the class of the working load."""
FILTERED = 2.0
"""Times that the mean force of a state with a filter may lie outside the forces that chosen states cover."""
SCAN_TOLERANCE = "numerics.force_accuracy"
"""Key of a case that says how tightly contacts of scans and loading curves are solved."""
LEAST_DATUM = 1e-12
"""Least datum, m: above the rounding of a touch at zero, between smooth bodies."""


@dataclass(frozen=True, eq=False)
class Reduction:
    """State functions of a case."""

    approaches: NDArray[np.float64]  # (k,), of the states from the plane that the nominal patch feels, m
    ensemble: StiffnessEnsemble  # loading curves
    # d0, m, by what it counts from: ``"samples"``, or ``"path"`` with strips and path as well
    datums: dict[str, float]
    semi_axes: NDArray[np.float64]  # (k, 2), of the nominal patch at the mean force of each state, m
    filters: LineFilters  # of the states that carry load, on their own approaches, by normalisation
    working: Contact  # first sample under the working load
    stiffnesses: NDArray[np.float64]  # (N,), tangent stiffness of each sample under the working load, N/m
    working_approach: float  # mean of the samples under the working load, m
    area_ratio: float  # contact area under the working load over that of smooth bodies, mean
    isolated_share: float  # of that load on cells that touch alone, mean
    # (positions,), first touch along the path, before defects are put on it, at every row on which the window
    # may begin, m; None where the path is a line
    touches: NDArray[np.float64] | None
    counts: Counts  # contact solutions done for the filters


def patch_planes(path: Strip, shape: Geometry) -> NDArray[np.float64]:
    """Height (rows,) of the plane that the nominal patch feels at each row of a path, m, peaks positive.

    The mean under the patch of the class of the geometry's working load, centred on each row.
    """
    return -areal_texture(path, shape.spacing, [0.0], [shape.class_axes]).heights[0]


def reduce(
    contact: ContactCase,
    numerics: Numerics,
    textures: Textures,
    shape: Geometry,
    planes: NDArray[np.float64] | None,
    needed: Iterable[Normalise],
    cache: Cache | None,
    progress: Progress,
) -> Reduction:
    """Press and move the body on the samples, and reduce the forces to stiffness and filters.

    `planes` (rows,), m, are from `patch_planes` for the path, where it is areal; `needed` are the
    normalisations of the filters that the laws use. The cache keeps finished scans.
    """
    weights = punch_weights(shape.spacing, shape.class_axes)
    cells = (shape.body.shape[0], shape.body.shape[1])
    samples = patches([m.heights for m in textures.maps], cells, contact.samples, weights)
    half_space = shape.half_space(contact.hardness)
    contacts = [half_space.solve(shape.body - s, load=shape.load, rtol=numerics.rtol) for s in samples]
    smooth = half_space.solve(shape.body, load=shape.load, rtol=numerics.rtol)
    along = None
    if textures.path is not None and planes is not None:
        along = first_touch(textures.path, shape.body) + _centred(planes, shape)
    lowest = _lowest_touches(textures, shape, along, samples)
    approaches = _approaches(contact, textures, shape, along, samples, half_space)
    if not (np.isfinite(approaches).all() and (np.diff(approaches) > 0.0).all()):
        raise _too_rough(textures, f"first touch at {1e6 * approaches[0]:.3g} um")
    working = float(np.mean([c.approach for c in contacts]))
    remedy = shape.remedy_for_cut_off(float(approaches[-1]), working, -lowest["path"], textures.widest_window)
    ensemble = stiffness_ensemble(
        samples, half_space, shape.body, approaches, 0.0, rtol=rtol_for(numerics.force_accuracy),
        progress=progress, tolerance=SCAN_TOLERANCE, remedy=remedy,
    )  # fmt: skip
    mean = ensemble.mean_force
    if contact.approaches is None and np.count_nonzero(mean) < 2:
        raise _too_rough(textures, f"contact in {np.count_nonzero(mean)} of {len(mean)} states")
    refuse_low_states(approaches, mean, shape, contacts[0].approach)
    # the curve, drawn through few states, may start a little before the first touch
    datums = {
        name: -min(lowest[name], ensemble.curve.first_touch, -LEAST_DATUM) for name in ("samples", "path")
    }
    ensemble = replace(ensemble, datum=datums[contact.datum])
    filters, scans = line_filters(
        contact, textures, shape, ensemble, filtered_loads(contact, shape), needed,
        rtol=rtol_for(FILTER_SHARE * numerics.force_accuracy), cache=cache, progress=progress,
    )  # fmt: skip
    counts = total(scan.counts for scan in scans)
    warn_of_flaws(counts, "the filters", SCAN_TOLERANCE, remedy)
    return Reduction(
        approaches,
        ensemble,
        datums,
        np.array([shape.axes(f) for f in mean]),
        filters,
        contacts[0],
        np.array([half_space.tangent_stiffness(c.pressure) for c in contacts]),
        working,
        float(np.mean([c.area for c in contacts])) / smooth.area,
        float(np.mean([isolated_share(c.pressure) for c in contacts])),
        along,
        counts,
    )


def filtered_loads(contact: ContactCase, shape: Geometry) -> tuple[float, float]:
    """Least and largest mean force of a state that has a filter, N.

    Chosen states go on to where the flattest place carries the largest force, and others carry far more.
    """
    largest = shape.largest_force if contact.approaches is None else math.inf
    return LIGHTEST_STATE * shape.class_load / FILTERED, largest * FILTERED


def refuse_low_states(
    approaches: NDArray[np.float64], highest: NDArray[np.float64], shape: Geometry, working_approach: float
) -> None:
    """Refuse states (k,), m, that do not reach the working load, or of which only one is in contact.

    `highest` are the mean forces of the samples in the last states, two or more, N; the working approach, m,
    is that of a sample under the load.
    """
    reached = f"up to {approaches[-1] * 1e6:.4g} um, where the samples carry {highest[-1]:.3g} N"
    if highest[-1] < shape.load:
        raise InputError(
            "contact.approaches",
            reached,
            f"approaches that reach the working load of {shape.load:.3g} N and beyond",
            f"Go to {2e6 * working_approach:.3g} um or more, or leave the key out.",
        )
    if not highest[-2] > 0.0:
        raise InputError(
            "contact.approaches",
            f"{reached}, and none at {approaches[-2] * 1e6:.4g} um",
            "at least two approaches in contact",
            f"Add some around {1e6 * working_approach:.3g} um, or leave the key out.",
        )


def _too_rough(textures: Textures, sign: str) -> InputError:
    """Error about samples on which no contact can be followed from touch to load."""
    rms = float(np.mean([np.std(sample.heights) for sample in textures.maps]))
    return InputError(
        "surface",
        f"samples of {1e6 * rms:.3g} um rms, with {sign}",
        "heights that are small against the window, and states of contact from the touch to the load",
        "Check the unit of the heights.",
    )


def _lowest_touches(
    textures: Textures,
    shape: Geometry,
    along: NDArray[np.float64] | None,
    samples: Sequence[NDArray[np.float64]],
) -> dict[str, float]:
    """Lowest approach of first touch of all samples, and of these, strips and path, m."""
    lowest = min(float(first_touch(s, shape.body).min()) for s in samples)
    strips = min([lowest, *(float(first_touch(s.heights, shape.body).min()) for s in textures.strips)])
    path = strips if along is None else min(strips, float(along.min()))
    return {"samples": lowest, "path": path}


def _centred(planes: NDArray[np.float64], shape: Geometry) -> NDArray[np.float64]:
    """Planes at the middle rows of the window's positions."""
    half = shape.body.shape[0] // 2
    return planes[half : len(planes) - half]


def _approaches(
    contact: ContactCase,
    textures: Textures,
    shape: Geometry,
    along: NDArray[np.float64] | None,
    samples: Sequence[NDArray[np.float64]],
    half_space: HalfSpace,
) -> NDArray[np.float64]:
    """States as given, or by the load that places carry.

    Those of the samples do not depend on the path; more lie below where it is touched earlier, by whole
    steps: paths of other lengths over the same surface have them in common.
    """
    if contact.approaches is not None:
        return np.array(contact.approaches)
    places = touched_places(textures, shape)
    states = chosen_states([*samples, *places], shape, half_space)
    if along is None or len(states) < 2:
        return states
    earlier = min(float((shape.body - place).min()) for place in places) - float(along.min())
    step = 2.0 * (states[1] - states[0])
    count = min(math.ceil(max(earlier, 0.0) / step), STATES)
    return np.concatenate([states[0] - max(step, earlier / max(count, 1)) * np.arange(count, 0, -1), states])


def touched_places(textures: Textures, shape: Geometry) -> list[NDArray[np.float64]]:
    """Places (nx, ny) of each strip that are touched first and last, levelled to their patch planes, m.

    A few samples seldom meet the highest peak, nor the flattest place, which takes the largest forces last.
    """
    places, nx = [], shape.body.shape[0]
    for strip in textures.strips:
        planes = patch_planes(strip, shape)
        touches = first_touch(strip.heights, shape.body) + _centred(planes, shape)
        for row in (int(np.argmin(touches)), int(np.argmax(touches))):
            places.append(strip.heights[row : row + nx] - planes[row + nx // 2])
    return places


def chosen_states(
    places: Sequence[NDArray[np.float64]], shape: Geometry, half_space: HalfSpace
) -> NDArray[np.float64]:
    """States from a light load to the largest force at all of some places (nx, ny), m; shape (STATES,).

    From the touch of a place to its load F^(2/3) is bent, and straight beyond: few states suffice where many
    places carry much, many are wanted where few carry little. So they are even in a low power of the mean.
    """
    light = LIGHTEST_STATE * shape.class_load
    forces = np.geomspace(light, shape.largest_force, PRESSED)
    curves = []
    for place in places:
        pressed, start = [], None
        for force in forces:
            found = half_space.solve(shape.body - place, load=force, start=start, rtol=1e-3)
            pressed.append(found.approach)
            start = found.pressure
        curves.append(ForceCurve.from_samples(pressed, forces))
    lowest = min(curve.first_touch for curve in curves)
    highest = max(float(curve.inverse(shape.largest_force)) for curve in curves)
    approaches = np.linspace(lowest, highest, 64 * STATES)
    mean = np.mean([curve.force(approaches) for curve in curves], axis=0)
    even = np.linspace(light**EVENLY, mean[-1] ** EVENLY, STATES)
    return np.interp(even, mean**EVENLY, approaches)
