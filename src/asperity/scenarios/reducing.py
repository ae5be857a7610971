"""The reduction of a case: from textures to the state functions that the laws use."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from asperity.config.sections import ContactCase, Numerics
from asperity.contact import Contact, HalfSpace
from asperity.contact.device import find_device
from asperity.errors import InputError
from asperity.progress import Progress
from asperity.reduction.accuracy import FILTER_SHARE, rtol_for
from asperity.reduction.areal import areal_texture, punch_weights
from asperity.reduction.ensemble import StiffnessEnsemble, patches, stiffness_ensemble
from asperity.reduction.filter import (
    FLOOR,
    ContactFilter,
    design_fir,
    estimate_filter,
    mean_filter,
    punch_filter,
    tap_count,
)
from asperity.reduction.pool import in_order
from asperity.reduction.real_contact import isolated_share
from asperity.reduction.scan import Cache, ScannedForces, first_touch, scan_forces, warn_of_scans
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.textures import Textures
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.strip import Strip
from asperity.threads import thread_count

STATES = 14
"""States chosen where the case names no approaches."""
LIGHTEST_STATE = 0.02
"""Least mean force of a state that has a filter, in working loads."""
LEAST_DATUM = 1e-12
"""Least datum, m: above the rounding of a touch at zero, between smooth bodies."""
SMOOTH_WAVENUMBERS = 120
"""Wavenumbers of the closed-form filter where a case has no texture."""
LONG_WAVE = 0.5
"""k a below which a filter is taken to be at its asymptote: sin q/q is 0.96 there."""


@dataclass(frozen=True, eq=False)
class Reduction:
    """State functions of a case.

    Attributes
    ----------
    approaches : ndarray, shape (k,)
        States, m: approaches from the plane that the nominal patch feels.
    ensemble : StiffnessEnsemble
        Loading curves.
    semi_axes : ndarray, shape (k, 2)
        Semi-axes of the nominal patch at the mean force of each state, m.
    contact_filter : ContactFilter
        Filters of the states that carry load, on their own approaches.
    taps : ndarray, shape (s, J + 1)
        FIR filters of those states.
    working : Contact
        First sample under the working load.
    working_approach : float
        Mean approach of the samples under the working load, m.
    area_ratio : float
        Contact area of the samples under the working load over that of smooth bodies, mean.
    isolated_share : float
        Share of that load on cells that touch alone, mean.
    solves, iterations, truncated : int
        Contact solutions done for the filters, their iterations, and those that are cut off.
    """

    approaches: NDArray[np.float64]
    ensemble: StiffnessEnsemble
    semi_axes: NDArray[np.float64]
    contact_filter: ContactFilter
    taps: NDArray[np.float64]
    working: Contact
    working_approach: float
    area_ratio: float
    isolated_share: float
    solves: int
    iterations: int
    truncated: int


def patch_planes(path: Strip, shape: Geometry) -> NDArray[np.float64]:
    """Height of the plane that the nominal patch feels at each row of a path, m.

    Parameters
    ----------
    path : Strip, shape (rows, ny)
        Texture of the path, m.
    shape : Geometry
        Its patch under the working load is the weight.

    Returns
    -------
    ndarray, shape (rows,)
        Mean height under the patch centred on each row, m, peaks positive.
    """
    return -areal_texture(path, shape.spacing, [0.0], [shape.semi_axes]).heights[0]


def reduce(
    contact: ContactCase,
    numerics: Numerics,
    textures: Textures,
    shape: Geometry,
    planes: NDArray[np.float64] | None,
    cache: Cache | None,
    progress: Progress,
) -> Reduction:
    """Press and move the body on the samples, and reduce the forces to state functions.

    Parameters
    ----------
    contact : ContactCase
        The contact section of the case.
    numerics : Numerics
        The numerics section of the case: how accurately contacts are solved.
    textures : Textures
        Samples, strips and path.
    shape : Geometry
        The gap on the grid.
    planes : ndarray, shape (rows,), optional
        From `patch_planes` for the path, where it is areal.
    cache : Cache, optional
        Keeps finished scans.
    progress : Progress
        Called while scanning.

    Returns
    -------
    Reduction
        Stiffness and filters.
    """
    hardness = contact.hardness
    weights = punch_weights(shape.spacing, shape.semi_axes)
    cells = (shape.body.shape[0], shape.body.shape[1])
    samples = patches([m.heights for m in textures.maps], cells, contact.samples, weights)
    half_space = HalfSpace(cells, shape.spacing, shape.modulus, hardness)
    contacts = [half_space.solve(shape.body - s, load=shape.load, rtol=numerics.rtol) for s in samples]
    smooth = half_space.solve(shape.body, load=shape.load, rtol=numerics.rtol)
    approaches = _approaches(contact, textures, shape, planes, samples, half_space)
    lowest = min(float(approaches[0]), _lowest_touch(textures, shape, planes, samples))
    datum = max(-lowest, LEAST_DATUM)
    working = float(np.mean([c.approach for c in contacts]))
    remedy = shape.remedy_for_cut_off(float(approaches[-1]), working, datum, textures.widest_window)
    ensemble = stiffness_ensemble(
        samples, shape.spacing, shape.body, shape.modulus, approaches, datum, hardness,
        rtol=rtol_for(numerics.force_accuracy), progress=progress, remedy=remedy,
    )  # fmt: skip
    mean = ensemble.mean_force
    if mean[-1] < shape.load:
        raise InputError(
            "contact.approaches",
            f"up to {approaches[-1] * 1e6:.4g} um, where the samples carry {mean[-1]:.3g} N",
            f"approaches that reach the working load of {shape.load:.3g} N and beyond",
            f"Go to {2e6 * contacts[0].approach:.3g} um or more, or leave the key out.",
        )
    semi_axes = np.array([shape.axes(f) for f in mean])
    loaded = mean >= LIGHTEST_STATE * shape.load
    accuracy = FILTER_SHARE * numerics.force_accuracy
    contact_filter, scans = _filters(contact, accuracy, textures, shape, ensemble, loaded, cache, progress)
    warn_of_scans(scans, "the filters", remedy)
    order = contact.filter_taps or tap_count(shape.spacing[0], float(semi_axes.max()))
    return Reduction(
        approaches,
        ensemble,
        semi_axes,
        contact_filter,
        design_fir(contact_filter, shape.spacing[0], order),
        contacts[0],
        working,
        float(np.mean([c.area for c in contacts])) / smooth.area,
        float(np.mean([isolated_share(c.pressure) for c in contacts])),
        sum(s.solved for s in scans),
        sum(s.iterations for s in scans),
        sum(s.truncated for s in scans),
    )


def _lowest_touch(
    textures: Textures,
    shape: Geometry,
    planes: NDArray[np.float64] | None,
    samples: Sequence[NDArray[np.float64]],
) -> float:
    """Lowest first touch of samples, strips and path, so that one datum serves all of them, m."""
    touches = [first_touch(s, shape.body).min() for s in samples]
    touches += [first_touch(s.heights, shape.body).min() for s in textures.strips]
    if textures.path is not None and planes is not None:
        touches.append((first_touch(textures.path, shape.body) + _centred(planes, shape)).min())
    return float(min(touches))


def _centred(planes: NDArray[np.float64], shape: Geometry) -> NDArray[np.float64]:
    """Planes at the middle rows of the window's positions."""
    half = shape.body.shape[0] // 2
    return planes[half : len(planes) - half]


def _approaches(
    contact: ContactCase,
    textures: Textures,
    shape: Geometry,
    planes: NDArray[np.float64] | None,
    samples: Sequence[NDArray[np.float64]],
    half_space: HalfSpace,
) -> NDArray[np.float64]:
    """States as given, or from the first touch to a high force, denser where contact begins."""
    if contact.approaches is not None:
        return np.array(contact.approaches)
    low = max(_lowest_touch(textures, shape, planes, samples), shape.lowest_approach)
    high = max(
        half_space.solve(shape.body - s, load=shape.largest_force, rtol=1e-3).approach for s in samples
    )
    return np.asarray(low + (high - low) * np.linspace(0.0, 1.0, STATES) ** 1.3)


def _filters(
    contact: ContactCase,
    accuracy: float,
    textures: Textures,
    shape: Geometry,
    ensemble: StiffnessEnsemble,
    loaded: NDArray[np.bool_],
    cache: Cache | None,
    progress: Progress,
) -> tuple[ContactFilter, list[ScannedForces]]:
    """Scan the strips and average their fitted filters."""
    b = shape.semi_axes[1]
    dx, dy = shape.spacing
    half, middle = (n // 2 for n in shape.body.shape)
    stride = filter_stride(shape)
    approaches = ensemble.approaches[loaded]
    curve = ensemble.curve
    tangent = curve.stiffness(approaches) if contact.normalise == "tangent" else None
    across = min(middle, int(b / dy))
    axes = [shape.axes(f)[0] for f in ensemble.mean_force[loaded]]
    if not any(np.ptp(strip.heights) for strip in textures.strips):
        return _closed_form(approaches, np.array(axes), curve.stiffness(approaches)), []
    asymptote = LONG_WAVE / (2 * np.pi * np.array(axes))
    workers = thread_count() if find_device() is None else 1  # one block fills a device
    message = "scanning for the contact filters"

    def scan_strip(strip: HeightMap) -> ScannedForces[NDArray[np.float64]]:
        # one strip is a block or two: strips beside each other keep all processors busy
        return scan_forces(
            strip.heights, shape.spacing, shape.body, shape.modulus, approaches, contact.hardness,
            stride=stride, rtol=rtol_for(accuracy), cache=cache,
            workers=math.ceil(workers / len(textures.strips)),
        )  # fmt: skip

    progress(0, len(textures.strips), message)
    estimates, scans = [], []
    scanning = in_order(scan_strip, textures.strips, workers)
    for strip, scanned in zip(textures.strips, scanning, strict=True):
        scans.append(scanned)
        progress(len(scans), len(textures.strips), message)
        lines = strip.heights[half::stride, middle - across : middle + across + 1]
        estimates.append(
            estimate_filter(
                scanned.forces, lines[: scanned.forces.shape[1]].T, stride * dx,
                tangent_stiffness=tangent, asymptote=asymptote,
            )
        )  # fmt: skip
    degree, normalise = contact.filter_degree, contact.normalise
    return mean_filter(estimates, approaches, degree=degree, normalise=normalise), scans  # type: ignore[arg-type]


def filter_stride(shape: Geometry) -> int:
    """Rows between the positions of a scan for a filter: a sixth of the patch.

    Parameters
    ----------
    shape : Geometry
        What presses on what.

    Returns
    -------
    int
        Rows of the contact grid.
    """
    return max(1, math.floor(shape.semi_axes[0] / 6 / shape.spacing[0]))


def _closed_form(
    approaches: NDArray[np.float64], semi_axes: NDArray[np.float64], stiffness: NDArray[np.float64]
) -> ContactFilter:
    """Filter of surfaces without texture: that of small roughness, uniform across."""
    wavenumber = np.geomspace(0.01, 2.0, SMOOTH_WAVENUMBERS) / semi_axes.max()
    signed = punch_filter(wavenumber[None, :], semi_axes[:, None])
    magnitude = np.clip(np.abs(signed), FLOOR, 1.0)
    return ContactFilter(
        approaches, wavenumber, magnitude, np.zeros_like(signed), signed, stiffness, "low-wavenumber"
    )
