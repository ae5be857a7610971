"""Motion of the rail at fixed points while the wheel passes them."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.fft import irfft, next_fast_len, rfft

from asperity.errors import InputError
from asperity.kinds.wheel_on_rail.roll import WheelRolling
from asperity.progress import Progress
from asperity.structures.hat_response import ZONES, HatResponse
from asperity.structures.moving_kernel import MovingKernel, lagrange_weights

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
    near, far = (_Waves(kernel, zones) for zones in (ZONES, 1))
    for i, place in enumerate(places):
        _pass(displacement[:, i], forces, _Point(near, far, float(place)), first, stride, progress)
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
            _add(displacement[:, begin:], forces[:, begin:end], responses, places)
            if progress is not None:
                progress(done, bays[1] - bays[0] + 1, f"rail at {point.bay * spacing + point.at:.6g} m")


def _add(
    displacement: NDArray[np.float64],
    forces: NDArray[np.float64],
    responses: NDArray[np.float64],
    places: NDArray[np.float64],
) -> None:
    """Add to the displacement of a point, m, what forces (runs, k), N, moving through one bay do from now on.

    The responses (nodes + 3, taps), m/N, are those to hats of unit force at the nodes −1 … nodes + 1 of the
    bay; places (k,) count in nodes from 0 on. Each force is shared by the four nodes around it, and what a
    node gets is convolved with its response.
    """
    nodes, taps = responses.shape
    node = np.minimum(places.astype(int), nodes - 4)
    shares = lagrange_weights(places - node)
    length = min(len(places) + taps - 1, displacement.shape[1])
    period = next_fast_len(len(places) + taps - 1, real=True)
    transfer = rfft(responses, period)
    for run, force in enumerate(forces):
        shared = np.zeros((nodes, len(places)))
        for offset, share in enumerate(shares):
            shared[node + offset, np.arange(len(places))] = share * force
        spectrum = np.einsum("nf,nf->f", rfft(shared, period), transfer)
        displacement[run, :length] += irfft(spectrum, period)[:length]


class _Waves:
    """Shapes of a track's waves at the nodes of a bay, with which responses to hats of force are found."""

    def __init__(self, kernel: MovingKernel, zones: int) -> None:
        taps = kernel.weights.shape[1]
        self.grid = HatResponse(kernel.track, kernel.time_step, taps, zones)
        self.waves = self.grid.waves
        self.amplitude = self.grid.hat * self.waves.coefficients
        nodes = kernel.spacing / NODES * np.arange(NODES)
        self.outgoing = [self.waves.outgoing(x) for x in nodes]
        self.incoming = [self.waves.incoming(x) for x in nodes]


class _Point:
    """A point of the rail, m, and its responses to hats of force elsewhere, as long as a kernel."""

    def __init__(self, near: _Waves, far: _Waves, place: float) -> None:
        self.spacing = near.waves.spacing
        self.bay = math.floor(place / self.spacing)
        self.at = place - self.bay * self.spacing
        self._known = [
            (of, of.amplitude * of.waves.incoming(self.at), of.amplitude * of.waves.outgoing(self.at))
            for of in (near, far)
        ]

    def responses(self, bay: int) -> NDArray[np.float64]:
        """Responses, (nodes + 3, taps), to forces at nodes −1 … NODES + 1 of a bay; the point's is bay 0."""
        of, incoming, outgoing = self._known[abs(bay) > 1]
        right, left = {}, {}  # what the point and whole bays contribute
        for bays in (bay - 1, bay, bay + 1):
            over = of.waves.multipliers ** abs(bays)
            right[bays], left[bays] = incoming * over, outgoing * over

        def receptance(place: int) -> NDArray[np.complex128]:
            bays, node = divmod(place, NODES)
            if place * self.spacing >= NODES * self.at:
                (first, second) = right[bays] * of.outgoing[node]
            else:
                (first, second) = left[bays] * of.incoming[node]
            return first + second

        places = range(bay * NODES - 1, (bay + 1) * NODES + 2)
        return of.grid.response(np.array([receptance(place) for place in places]))
