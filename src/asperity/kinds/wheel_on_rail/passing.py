"""Motion of the rail at fixed points while the wheel passes them."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.errors import InputError
from asperity.kernels.rail import add_passing
from asperity.kinds.wheel_on_rail.roll import WheelRolling
from asperity.progress import Progress
from asperity.structures.hat_response import ZONES, HatResponse
from asperity.structures.moving_kernel import MovingKernel

NODES = 24
"""Places of the force in one bay; between them responses are interpolated by a cubic."""
FAINT = 3e-4
"""Bays whose responses stay below this share of the largest are left out, and all beyond them."""
DIFFERENCE = np.array([-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0]) / 60.0


def passed_points(
    kernel: MovingKernel,
    runs: Sequence[WheelRolling],
    points: ArrayLike,
    progress: Progress | None = None,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Displacement, m, and velocity, m/s, (runs, p, n), of the rail at fixed points under the forces of runs.

    Positive downwards, at the times of the runs, which go over the same path; points (p,), m from the sleeper
    at zero. The force acts from the start of the run-in on; the velocity is the central difference of sixth
    order (−0.2 % at an eighth of the sampling frequency).

    By reciprocity G(x_f|x) = G(x|x_f), so that one source at the point gives the responses to forces at all
    places of a bay. Responses as in `asperity.structures.moving_kernel`.
    """
    places = np.atleast_1d(np.asarray(points, dtype=float))
    if not np.isfinite(places).all():
        raise InputError("points on the rail (m)", places, "finite numbers")
    forces = np.stack([run.history for run in runs])
    first, stride = runs[0].history_start, kernel.speed * kernel.time_step
    settled = forces.shape[1] - len(runs[0].time)
    displacement = np.zeros((len(runs), len(places), forces.shape[1]))
    for i, place in enumerate(places):
        _pass(displacement[:, i], forces, _Point(kernel, float(place)), first, stride, progress)
    padded = np.pad(displacement, ((0, 0), (0, 0), (3, 3)), mode="reflect", reflect_type="odd")
    velocity = np.zeros_like(displacement)
    for offset, weight in enumerate(DIFFERENCE):
        velocity += weight / kernel.time_step * padded[..., offset : offset + forces.shape[1]]
    return displacement[..., settled:], velocity[..., settled:]


def _pass(
    displacement: NDArray[np.float64],
    forces: NDArray[np.float64],
    point: _Point,
    first: float,
    stride: float,
    progress: Progress | None,
) -> None:
    """Add up, bay by bay outwards from the point, what the forces there do at the point."""
    spacing, steps = point.spacing, forces.shape[1]
    bays = [math.floor(x / spacing) - point.bay for x in (first, first + stride * (steps - 1))]
    largest, done = 0.0, 0
    for outwards in (range(max(0, bays[0]), bays[1] + 1), range(min(-1, bays[1]), bays[0] - 1, -1)):
        for bay in outwards:
            responses = point.responses(bay)
            size = float(np.abs(responses).max())
            largest, done = max(largest, size), done + 1
            if size < FAINT * largest:
                break
            begins = (point.bay + bay) * spacing
            begin = max(0, math.ceil((begins - first) / stride))
            end = min(steps, math.ceil((begins + spacing - first) / stride))
            places = (first + stride * np.arange(begin, end) - begins) / spacing * NODES
            add_passing(displacement, forces, responses, places, begin)
            if progress is not None:
                progress(done, bays[1] - bays[0] + 1, f"rail at {point.bay * spacing + point.at:.6g} m")


class _Point:
    """A point of the rail, m, and its responses to hats of force elsewhere, as long as a kernel."""

    def __init__(self, kernel: MovingKernel, place: float) -> None:
        self.spacing = kernel.spacing
        self.bay = math.floor(place / self.spacing)
        self.at = place - self.bay * self.spacing
        taps = kernel.weights.shape[1]
        self.near, self.far = (
            HatResponse(kernel.track, kernel.time_step, taps, zones) for zones in (ZONES, 1)
        )
        waves = self.far.waves
        inside = [self.spacing / NODES * node for node in range(NODES)]
        right = [waves.outgoing(x) for x in inside]
        left = [waves.incoming(x) for x in inside]
        factor = waves.multipliers  # of an outgoing wave over a bay; its inverse of an incoming one
        amplitude = self.far.hat * waves.coefficients
        right = [right[-1] / factor, *right, right[0] * factor, right[1] * factor]
        left = [left[-1] * factor, *left, left[0] / factor, left[1] / factor]
        self._right = amplitude * waves.incoming(self.at) * np.array(right)
        self._left = amplitude * waves.outgoing(self.at) * np.array(left)

    def responses(self, bay: int) -> NDArray[np.float64]:
        """Responses, (nodes, taps), to forces at nodes −1 … NODES + 1 of a bay, counted from the point's."""
        if abs(bay) > 1:
            shapes = self._right if bay > 0 else self._left
            return self.far.response((shapes * self.far.waves.multipliers ** abs(bay)).sum(axis=1))
        places = [self.spacing * (bay + node / NODES) for node in range(-1, NODES + 2)]
        waves = self.near.waves
        return self.near.response(np.array([self.near.hat * waves.receptance(x, self.at) for x in places]))
