"""The reduction of a case: from textures to the state functions that the laws use."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from asperity.config import BallOnBeamCase
from asperity.contact import Contact, HalfSpace, Hertz
from asperity.errors import CoarseSamplingWarning, HalfSpaceWarning, InputError
from asperity.progress import Progress
from asperity.reduction.areal import areal_texture, punch_weights
from asperity.reduction.ensemble import StiffnessEnsemble, patches, stiffness_ensemble
from asperity.reduction.filter import (
    ContactFilter,
    design_fir,
    estimate_filter,
    mean_filter,
    tap_count,
)
from asperity.reduction.scan import Cache, ScannedForces, first_touch, scan_forces, warn_of_scans
from asperity.scenarios.textures import Textures, window_cells

STATES = 14
"""States chosen where the case names no approaches."""
HIGHEST_FORCE = 8.0
"""Largest force that the chosen states cover, in working loads."""
LIGHTEST_STATE = 0.02
"""Least mean force of a state that has a filter, in working loads."""
LONG_WAVE = 0.5
"""k a below which a filter is taken to be at its asymptote: sin q/q is 0.96 there."""


@dataclass(frozen=True, eq=False)
class Geometry:
    """What presses on what: the ball's shape on the contact grid, and Hertz's answer.

    Attributes
    ----------
    body : ndarray, shape (n, n)
        Shape of the ball, m, zero at its lowest point, the middle cell.
    spacing : tuple of float
        (dx, dy), m.
    modulus : float
        Contact modulus E*, Pa.
    hertz : Hertz
        Smooth contact.
    load : float
        Working load, N.
    """

    body: NDArray[np.float64]
    spacing: tuple[float, float]
    modulus: float
    hertz: Hertz
    load: float

    @property
    def semi_axes(self) -> tuple[float, float]:
        """Semi-axes of the nominal patch under the working load, m."""
        return self.hertz.semi_axes(self.hertz.approach(self.load))


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
    solves, iterations : int
        Contact solutions done for the filters, and their iterations.
    """

    approaches: NDArray[np.float64]
    ensemble: StiffnessEnsemble
    semi_axes: NDArray[np.float64]
    contact_filter: ContactFilter
    taps: NDArray[np.float64]
    working: Contact
    working_approach: float
    solves: int
    iterations: int


def geometry(case: BallOnBeamCase, load: float, modulus: float) -> Geometry:
    """Ball and window of a case, checked against the half-space assumption.

    Parameters
    ----------
    case : BallOnBeamCase
        The case.
    load : float
        Working load, N.
    modulus : float
        Contact modulus E*, Pa.

    Returns
    -------
    Geometry
        Shape of the ball on the contact grid.

    Raises
    ------
    InputError
        If the contact is not small against the ball (a > R/3), or the window does not hold it.
    """
    n, h, radius = window_cells(case), case.contact.spacing, case.ball.radius
    hertz = Hertz(modulus, radius, radius)
    a = hertz.semi_axes(hertz.approach(load))[0]
    _check_half_space(a, radius, f"a working load of {load:.3g} N")
    if case.contact.approaches is not None:
        top = case.contact.approaches[-1]
        _check_half_space(hertz.semi_axes(top)[0], radius, f"an approach of {top * 1e6:.3g} µm")
    if 2.2 * a > n * h:
        raise InputError(
            "contact.window",
            f"{n * h * 1e6:.4g} um",
            f"at least {2.2e6 * a:.4g} um, 1.1 times the width of the smooth contact under {load:.3g} N",
            "Enlarge the window.",
        )
    if h > a / 8:
        warnings.warn(
            f"contact.spacing = {h * 1e6:.3g} µm is coarser than an eighth of the contact radius "
            f"({a * 1e6:.3g} µm under {load:.3g} N): forces carry an error of some per cent. "
            "Refine the spacing.",
            CoarseSamplingWarning,
            stacklevel=2,
        )
    x = (np.arange(n) - n // 2) * h
    return Geometry((x[:, None] ** 2 + x[None, :] ** 2) / (2 * radius), (h, h), modulus, hertz, load)


def _check_half_space(a: float, radius: float, cause: str) -> None:
    if a > radius / 3:
        raise InputError(
            "contact",
            f"{cause}, a contact radius of {a / radius:.2g} R",
            "a contact radius of at most R/3, where the ball is an elastic half-space",
            "Lower the load or the approaches, or take a larger ball.",
        )
    if a > radius / 10:
        warnings.warn(
            f"{cause} makes a contact radius of {a / radius:.2g} R, above 0.1 R: the elastic half-space "
            "overestimates the stiffness by some per cent. Lower the load.",
            HalfSpaceWarning,
            stacklevel=3,
        )


def patch_planes(path: NDArray[np.float64], shape: Geometry) -> NDArray[np.float64]:
    """Height of the plane that the nominal patch feels at each row of a path, m.

    Parameters
    ----------
    path : ndarray, shape (rows, ny)
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
    case: BallOnBeamCase,
    textures: Textures,
    shape: Geometry,
    planes: NDArray[np.float64] | None,
    cache: Cache | None,
    progress: Progress,
) -> Reduction:
    """Press and move the ball on the samples, and reduce the forces to state functions.

    Parameters
    ----------
    case : BallOnBeamCase
        The case.
    textures : Textures
        Samples, strips and path.
    shape : Geometry
        The ball on the grid.
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
    hardness, rtol = case.contact.hardness, case.numerics.rtol
    weights = punch_weights(shape.spacing, shape.semi_axes)
    n = shape.body.shape[0]
    samples = patches([m.heights for m in textures.maps], (n, n), case.contact.samples, weights)
    half_space = HalfSpace((n, n), shape.spacing, shape.modulus, hardness)
    contacts = [half_space.solve(shape.body - s, load=shape.load, rtol=rtol) for s in samples]
    approaches = _approaches(case, textures, shape, planes, samples, half_space)
    datum = -min(float(approaches[0]), _lowest_touch(textures, shape, planes, samples))
    ensemble = stiffness_ensemble(
        samples, shape.spacing, shape.body, shape.modulus, approaches, datum, hardness,
        rtol=rtol, progress=progress,
    )  # fmt: skip
    mean = ensemble.mean_force
    if mean[-1] < shape.load:
        raise InputError(
            "contact.approaches",
            f"up to {approaches[-1] * 1e6:.4g} um, where the samples carry {mean[-1]:.3g} N",
            f"approaches that reach the working load of {shape.load:.3g} N and beyond",
            f"Go to {2e6 * contacts[0].approach:.3g} um or more, or leave the key out.",
        )
    semi_axes = np.array([shape.hertz.semi_axes(shape.hertz.approach(f)) for f in mean])
    loaded = mean >= LIGHTEST_STATE * shape.load
    contact_filter, scans = _filters(case, textures, shape, ensemble, loaded, cache, progress)
    order = case.contact.filter_taps or tap_count(shape.spacing[0], float(semi_axes.max()))
    return Reduction(
        approaches,
        ensemble,
        semi_axes,
        contact_filter,
        design_fir(contact_filter, shape.spacing[0], order),
        contacts[0],
        float(np.mean([c.approach for c in contacts])),
        sum(int(np.count_nonzero(s.forces)) for s in scans),
        sum(s.iterations for s in scans),
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
        touches.append((first_touch(textures.path.heights, shape.body) + _centred(planes, shape)).min())
    return float(min(touches))


def _centred(planes: NDArray[np.float64], shape: Geometry) -> NDArray[np.float64]:
    """Planes at the middle rows of the window's positions."""
    half = shape.body.shape[0] // 2
    return planes[half : len(planes) - half]


def _approaches(
    case: BallOnBeamCase,
    textures: Textures,
    shape: Geometry,
    planes: NDArray[np.float64] | None,
    samples: Sequence[NDArray[np.float64]],
    half_space: HalfSpace,
) -> NDArray[np.float64]:
    """States as given, or from the first touch to a high force, denser where contact begins."""
    if case.contact.approaches is not None:
        return np.array(case.contact.approaches)
    low = _lowest_touch(textures, shape, planes, samples)
    largest = HIGHEST_FORCE * shape.load
    high = max(half_space.solve(shape.body - s, load=largest, rtol=1e-3).approach for s in samples)
    return np.asarray(low + (high - low) * np.linspace(0.0, 1.0, STATES) ** 1.3)


def _filters(
    case: BallOnBeamCase,
    textures: Textures,
    shape: Geometry,
    ensemble: StiffnessEnsemble,
    loaded: NDArray[np.bool_],
    cache: Cache | None,
    progress: Progress,
) -> tuple[ContactFilter, list[ScannedForces]]:
    """Scan the strips and average their fitted filters."""
    a, b = shape.semi_axes
    dx, dy = shape.spacing
    n = shape.body.shape[0]
    stride = max(1, math.floor(a / 6 / dx))
    approaches = ensemble.approaches[loaded]
    curve = ensemble.curve
    tangent = curve.stiffness(approaches) if case.contact.normalise == "tangent" else None
    across = min(n // 2, int(b / dy))
    axes = [shape.hertz.semi_axes(shape.hertz.approach(f))[0] for f in ensemble.mean_force[loaded]]
    asymptote = LONG_WAVE / (2 * np.pi * np.array(axes))
    estimates, scans = [], []
    for i, strip in enumerate(textures.strips):
        z = strip.heights
        scanned = scan_forces(
            z, shape.spacing, shape.body, shape.modulus, approaches, case.contact.hardness,
            stride=stride, rtol=case.numerics.rtol, cache=cache, progress=progress,
            message=f"contact filter, strip {i + 1} of {len(textures.strips)}",
        )  # fmt: skip
        scans.append(scanned)
        lines = z[n // 2 :: stride, n // 2 - across : n // 2 + across + 1][: scanned.forces.shape[1]].T
        estimates.append(
            estimate_filter(
                scanned.forces, lines, stride * dx, tangent_stiffness=tangent, asymptote=asymptote
            )
        )
    warn_of_scans(scans, "the filters")
    degree, normalise = case.contact.filter_degree, case.contact.normalise
    return mean_filter(estimates, approaches, degree=degree, normalise=normalise), scans  # type: ignore[arg-type]
