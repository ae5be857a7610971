"""A rail under several wheels: what a force does under the wheels beside its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.arguments import real, real_array
from asperity.errors import InputError
from asperity.progress import Progress
from asperity.store import Cache
from asperity.structures.moving_kernel import MovingKernel, moving_kernel
from asperity.structures.rail_poles import TOLERANCE, RailPoles, most_poles, rail_poles

NEGLIGIBLE = 0.01
"""Size of a kernel, relative to that under the force itself, below which it is left out."""
COUNTS = (100, 160)
"""Numbers of poles that are tried; where none is enough, the kernel is scattered."""
DECIMALS = 6
"""Of distances in metres that count as one."""


@dataclass(frozen=True, eq=False)
class RailBetween:
    """A rail for several contacts at fixed distances: moving kernels for all distances that matter."""

    direct: RailPoles | MovingKernel  # under the force itself
    crossing: Mapping[float, RailPoles | MovingKernel]  # by how far ahead of the force, m; negative behind
    # errors of `crossing`, rms over all lags and start positions, relative to the direct kernel
    errors: Mapping[float, float] = field(default_factory=dict)
    reach: float = np.inf  # m, beyond which contacts do not feel each other

    @property
    def kernel(self) -> MovingKernel:
        """The direct one."""
        return _kernel(self.direct)

    def between(self, distance: float) -> RailPoles | MovingKernel | None:
        """What carries a force to a contact so far ahead of it, m; None if it is out of reach."""
        apart = round(float(distance), DECIMALS)
        if not apart:
            return self.direct
        if abs(apart) > self.reach:
            return None
        found = self.crossing.get(apart)
        if found is None:
            known = ", ".join(f"{at:g}" for at in sorted(self.crossing)) or "none"
            remedy = "Compute the rail between them for the places of these contacts."
            raise InputError("distance of two contacts on the rail (m)", f"{apart:g}", known, remedy)
        return found


def rail_between(
    direct: RailPoles | MovingKernel,
    places: ArrayLike,
    *,
    reach: float | None = None,
    cache: Cache | None = None,
    progress: Progress | None = None,
) -> RailBetween:
    """Compute how a rail carries vibration between contacts.

    The moving kernel of every distance between two of them is computed from the same track as the direct one,
    for the same speed, time step and duration, and fitted by poles of its own (scattered where a fit is worse
    than half a percent of the direct kernel). Equal distances share a kernel. Contacts farther apart than the
    `reach` do not feel each other, so that a train costs in proportion to its wheels.

    Parameters
    ----------
    direct : RailPoles or MovingKernel
        The rail under one contact.
    places : array_like (n,)
        Of the contacts along the path, m.
    reach : float, optional
        m; by default the distance from which on the rms of a kernel is below 1 % of the direct one. On a
        lightly damped rail (loss factor 0.4 %) that is 40 m; leaving two wheels there alone changed the
        varying part of their forces by 3 % rms, and no one-third octave by more than 0.05 dB.
    cache : Cache, optional
        Keeps kernels and poles.
    progress : callable, optional
        Is told distances done, distances in all and what is done.

    Returns
    -------
    RailBetween

    Raises
    ------
    InputError
        If places or reach are not finite, or the reach is negative.
    """
    at = real_array("places of the contacts (m)", places, "finite numbers").ravel()
    if not np.isfinite(at).all():
        raise InputError("places of the contacts (m)", at.tolist(), "finite numbers")
    if reach is not None:
        reach = real("reach (m)", reach, "zero or a finite positive number, or None", at_least=0.0)
    apart = np.unique(np.round(np.subtract.outer(at, at), DECIMALS))
    lengths = np.unique(np.abs(apart[apart != 0.0]))
    crossing: dict[float, RailPoles | MovingKernel] = {}
    errors: dict[float, float] = {}
    for done, length in enumerate(lengths):
        if reach is not None and length > reach:
            break
        kernels = [_crossing(_kernel(direct), sign * float(length), cache) for sign in (1.0, -1.0)]
        size = max(_size(kernel.weights) for kernel in kernels) / _size(_kernel(direct).weights)
        if reach is None and size < NEGLIGIBLE:
            reach = float(lengths[done - 1]) if done else 0.0
            break
        for kernel in kernels:
            crossing[kernel.distance], errors[kernel.distance] = _fitted(direct, kernel, cache)
        if progress is not None:
            progress(done + 1, len(lengths), "rail between contacts")
    return RailBetween(direct, crossing, errors, np.inf if reach is None else reach)


def _kernel(rail: RailPoles | MovingKernel) -> MovingKernel:
    return rail.kernel if isinstance(rail, RailPoles) else rail


def _size(weights: NDArray[np.float64]) -> float:
    return float(np.linalg.norm(weights))


def _crossing(direct: MovingKernel, distance: float, cache: Cache | None) -> MovingKernel:
    positions, taps = direct.weights.shape
    return moving_kernel(
        direct.track,
        direct.speed,
        direct.time_step,
        duration=taps * direct.time_step,
        positions=positions,
        distance=distance,
        cache=cache,
    )


def _fitted(
    direct: RailPoles | MovingKernel, kernel: MovingKernel, cache: Cache | None
) -> tuple[RailPoles | MovingKernel, float]:
    """The fewest poles that are enough, else the kernel itself, and the error relative to the direct one."""
    if isinstance(direct, RailPoles):
        for count in COUNTS:
            if count > most_poles(kernel.weights.shape[1]):
                break
            fit = rail_poles(kernel, count, cache=cache)
            left = fit.missed()
            within = np.abs(left.sum(axis=1)).max() / np.abs(direct.kernel.weights.sum(axis=1)).min()
            error = max(_size(left) / _size(direct.kernel.weights), float(within))
            if error <= TOLERANCE:
                return fit, error
    return kernel, 0.0
