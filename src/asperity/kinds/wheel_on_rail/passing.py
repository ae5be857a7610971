"""Motion of the rail at fixed points while the wheel passes them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial.chebyshev import chebpts1, chebvander
from numpy.typing import ArrayLike, NDArray
from scipy.fft import irfft, next_fast_len, rfft

from asperity.errors import InputError
from asperity.kinds.wheel_on_rail.roll import WheelRolling
from asperity.progress import Progress
from asperity.structures.hat_response import ZONES, HatResponse
from asperity.structures.moving_kernel import MovingKernel, lagrange_weights
from asperity.threads import thread_count

NODES = 24
"""Places of the force in a bay near the point; between them responses are interpolated by a cubic."""
TERMS = 12
"""Places of the force in a bay further away, where responses are smooth; one polynomial goes through them."""
FAINT = 3e-4
"""Bays whose responses stay below this share of the largest are left out, and all beyond them."""
ROOM = 1.3
"""Period of a transform over the time wanted of it: what rings before its cause wraps into the rest."""
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

    Bay by bay: what the forces in it do at a point. By reciprocity G(x_f|x) = G(x|x_f), so that one source at
    the point gives the responses to forces at all places of a bay. Responses as in
    `asperity.structures.moving_kernel`; those to forces more than a bay away are carried by the waves of the
    track, in which a bay differs from the next by a factor, so that its forces are transformed once for all
    points.
    """
    places = np.atleast_1d(np.asarray(points, dtype=float))
    if not np.isfinite(places).all():
        raise InputError("points on the rail (m)", places, "finite numbers")
    forces = np.stack([run.history for run in runs])
    path = _Path(
        forces, runs[0].history_start / kernel.spacing, kernel.speed * kernel.time_step / kernel.spacing
    )
    displacement = np.zeros((len(runs), len(places), forces.shape[1]))
    near, far = _Near(kernel), _Far(kernel, path.steps_in_bay)
    passed = [_Point(near, far, float(place)) for place in places]
    reach = [set(point.reach(path.bays)) for point in passed]
    for done, bay in enumerate(path.bays):
        sent = _BayWaves(far, path, bay)
        for i, point in enumerate(passed):
            if bay in reach[i]:
                point.add(displacement[:, i], path, bay, sent)
        if progress is not None:
            progress(done + 1, len(path.bays), "the rail at the points passed")
    settled = forces.shape[1] - len(runs[0].time)
    padded = np.pad(displacement, ((0, 0), (0, 0), (3, 3)), mode="reflect", reflect_type="odd")
    velocity = np.zeros_like(displacement)
    for offset, weight in enumerate(DIFFERENCE):
        velocity += weight / kernel.time_step * padded[..., offset : offset + forces.shape[1]]
    return displacement[..., settled:], velocity[..., settled:]


@dataclass(frozen=True, eq=False)
class _Path:
    """Forces, N, (runs, n), and where they act: first place and step, in bays from the sleeper at zero."""

    forces: NDArray[np.float64]
    first: float
    stride: float

    @property
    def bays(self) -> range:
        """Bays that the forces act in."""
        last = self.first + self.stride * (self.forces.shape[1] - 1)
        return range(math.floor(self.first), math.floor(last) + 1)

    @property
    def steps_in_bay(self) -> int:
        """Steps in a bay, at most."""
        return min(self.forces.shape[1], math.ceil(1.0 / self.stride))

    def within(self, bay: int) -> tuple[int, NDArray[np.float64], NDArray[np.float64]]:
        """First step in a bay, forces (runs, k) there, and their places (k,), from 0 to 1."""
        begin = max(0, math.ceil((bay - self.first) / self.stride))
        end = min(self.forces.shape[1], math.ceil((bay + 1 - self.first) / self.stride))
        return begin, self.forces[:, begin:end], self.first + self.stride * np.arange(begin, end) - bay


class _Far:
    """Waves at places all over a bay, at the frequencies of a transform of its forces and what follows."""

    def __init__(self, kernel: MovingKernel, steps: int) -> None:
        self.taps = kernel.weights.shape[1]
        grid = HatResponse(
            kernel.track, kernel.time_step, next_fast_len(math.ceil(0.5 * ROOM * (self.taps + steps))), 1
        )
        self.waves, self.amplitude, self.period = (
            grid.waves,
            grid.hat * grid.waves.coefficients,
            2 * grid.taps,
        )
        self.window = np.exp(grid.shift * grid.time_step * np.arange(self.period))
        nodes = chebpts1(TERMS)
        self.polynomials = np.linalg.inv(
            chebvander(nodes, TERMS - 1)
        )  # those that are one at a node, by column
        shapes = self.waves.symmetric_shapes(0.5 * kernel.spacing * (nodes + 1.0))
        self.shapes = dict(zip((1, -1), shapes, strict=True))  # (TERMS, 2, f) for either side
        self._powers = [np.ones_like(self.waves.multipliers)]

    def power(self, bays: int) -> NDArray[np.complex128]:
        """Change of the waves over some bays, (2, f)."""
        while len(self._powers) <= bays:
            self._powers.append(self._powers[-1] * self.waves.multipliers)
        return self._powers[bays]

    def shares(self, places: NDArray[np.float64]) -> NDArray[np.float64]:
        """Shares (TERMS, k) of the nodes in what acts at places (k,) from 0 to 1."""
        return np.asarray((chebvander(2.0 * places - 1.0, TERMS - 1) @ self.polynomials).T)

    def in_time(self, spectra: NDArray[np.complex128]) -> NDArray[np.float64]:
        """What spectra (..., f) are in time."""
        folded = spectra.copy()
        folded[..., -1] *= 2.0  # at half the sampling frequency two lines look alike
        return np.asarray(irfft(folded, self.period) * self.window)


class _BayWaves:
    """The waves that the forces in a bay send out on either side, found when first asked for."""

    def __init__(self, far: _Far, path: _Path, bay: int) -> None:
        self.far, self.path, self.bay = far, path, bay
        self._sent: dict[int, NDArray[np.complex128]] = {}

    @cached_property
    def spectra(self) -> NDArray[np.complex128]:
        """Spectra of the forces' shares of the nodes of the bay, (runs, TERMS, f)."""
        _, forces, places = self.path.within(self.bay)
        shared = forces[:, None] * (self.far.shares(places) / self.far.window[: len(places)])
        return np.asarray(rfft(shared, self.far.period, workers=thread_count()))

    def towards(self, side: int) -> NDArray[np.complex128]:
        """Waves, (runs, 2, f), to points that have the bay on their right (side 1) or left (side −1)."""
        if side not in self._sent:
            self._sent[side] = np.einsum("kwf,rkf->rwf", self.far.shapes[side], self.spectra)
        return self._sent[side]


class _Near:
    """Shapes of a track's waves at the nodes of a bay, with which responses to hats of force are found."""

    def __init__(self, kernel: MovingKernel) -> None:
        self.grid = HatResponse(kernel.track, kernel.time_step, kernel.weights.shape[1], ZONES)
        self.waves = self.grid.waves
        self.amplitude = self.grid.hat * self.waves.coefficients
        nodes = np.linspace(0.0, kernel.spacing, NODES + 1)
        self.outgoing, self.incoming = self.waves.symmetric_shapes(nodes)


class _Point:
    """A point of the rail, m, and what forces elsewhere do there."""

    def __init__(self, near: _Near, far: _Far, place: float) -> None:
        self.near, self.far = near, far
        self.spacing = near.waves.spacing
        self.bay = math.floor(place / self.spacing)
        self.at = place - self.bay * self.spacing
        self._near, self._far = (
            {1: of.amplitude * of.waves.incoming(self.at), -1: of.amplitude * of.waves.outgoing(self.at)}
            for of in (near, far)
        )
        self._responses = {bay: self._hats(bay) for bay in (-1, 0, 1)}

    def reach(self, bays: range) -> Iterator[int]:
        """Those of some bays whose forces are felt here."""
        largest = 0.0
        rightwards = range(max(self.bay, bays.start), bays.stop)
        leftwards = range(min(self.bay, bays.stop) - 1, bays.start - 1, -1)
        for outwards in (rightwards, leftwards):
            for bay in outwards:
                size = self._size(bay - self.bay)
                largest = max(largest, size)
                if size < FAINT * largest:
                    break
                yield bay

    def _size(self, distance: int) -> float:
        """Largest response to a hat of force so many bays away, m/N; further away, at two places there."""
        if distance in self._responses:
            return float(np.abs(self._responses[distance]).max())
        side, received = self._received(distance)
        spectra = (received * self.far.shapes[side][:: TERMS // 2]).sum(axis=1)
        return float(np.abs(self.far.in_time(spectra)[:, : self.far.taps]).max())

    def _received(self, distance: int) -> tuple[int, NDArray[np.complex128]]:
        """The side of a bay further away, and what the waves sent out there are here, m/N, (2, f)."""
        side = 1 if distance > 0 else -1
        return side, self._far[side] * self.far.power(abs(distance))

    def add(self, displacement: NDArray[np.float64], path: _Path, bay: int, sent: _BayWaves) -> None:
        """Add to the displacement here, m, (runs, n), what the forces in a bay do from then on."""
        begin, forces, places = path.within(bay)
        length = min(self.far.taps + len(places), displacement.shape[1] - begin)
        moved = displacement[:, begin : begin + length]
        if bay - self.bay in self._responses:
            moved += _convolved(forces, self._responses[bay - self.bay], places * NODES)[:, :length]
        else:
            side, received = self._received(bay - self.bay)
            moved += self.far.in_time((received * sent.towards(side)).sum(axis=1))[:, :length]

    def _hats(self, bay: int) -> NDArray[np.float64]:
        """Responses, (NODES + 3, taps), to forces at nodes −1 … NODES + 1 of a bay; the point's is bay 0."""
        of = self.near

        def receptance(place: int) -> NDArray[np.complex128]:
            bays, node = divmod(place, NODES)
            over = of.waves.multipliers ** abs(bays)
            if place * self.spacing >= NODES * self.at:
                (first, second) = self._near[1] * over * of.outgoing[node]
            else:
                (first, second) = self._near[-1] * over * of.incoming[node]
            return first + second

        places = range(bay * NODES - 1, (bay + 1) * NODES + 2)
        return of.grid.response(np.array([receptance(place) for place in places]))


def _convolved(
    forces: NDArray[np.float64], responses: NDArray[np.float64], places: NDArray[np.float64]
) -> NDArray[np.float64]:
    """What forces (runs, k), N, that move through one bay do from then on, m, (runs, k + taps).

    The responses (nodes + 3, taps), m/N, are those to hats of unit force at the nodes −1 … nodes + 1 of the
    bay; places (k,) count in nodes from 0 on. Each force is shared by the four nodes around it, and what a
    node gets is convolved with its response.
    """
    nodes, taps = responses.shape
    node = np.minimum(places.astype(int), nodes - 4)
    shares = np.zeros((nodes, len(places)))
    for offset, share in enumerate(lagrange_weights(places - node)):
        shares[node + offset, np.arange(len(places))] = share
    period = next_fast_len(len(places) + taps, real=True)
    spectra = rfft(forces[:, None] * shares, period)
    moved = irfft(np.einsum("rnf,nf->rf", spectra, rfft(responses, period)), period)
    return np.asarray(moved[:, : len(places) + taps])
