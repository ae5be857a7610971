"""Motion of the rail at fixed points while the wheel passes them."""

from __future__ import annotations

import math
from bisect import bisect_left
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from numpy.polynomial.chebyshev import chebpts1, chebvander
from numpy.typing import ArrayLike
from scipy.fft import irfft, next_fast_len, rfft

from asperity.arguments import Array, Complex, finite_array
from asperity.progress import Progress
from asperity.structures.moving_kernel import ZONES, HatResponse, MovingKernel, lagrange_weights
from asperity.threads import one_thread_in_linear_algebra

NODES = 24
"""Places of the force in a bay near the point; between them responses are interpolated by a cubic."""
TERMS = 16
"""Places of the force in a bay further away, where responses are smooth; one polynomial goes through them."""
TOGETHER = 8
"""Bays whose waves are found at a time."""
FAINT = 3e-4
"""Bays whose responses stay below this share of the largest are left out, and all beyond them."""
ROOM = 1.3
"""Period of a transform over the time wanted of it: what rings before its cause wraps into the rest."""
DIFFERENCE = np.array([-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0]) / 60.0


def passed_points(
    kernel: MovingKernel,
    forces: Array,
    origin: float,
    points: ArrayLike,
    settled: int = 0,
    progress: Progress | None = None,
) -> tuple[Array, Array]:
    """Displacement, m, and velocity, m/s, (runs, p, n), of the rail at fixed points under moving forces.

    Forces (runs, m), N, at every time step from a position `origin` on, m from the sleeper at zero, as are
    the points (p,). Positive downwards, without the first `settled` time steps. The velocity is the central
    difference of sixth order (−0.2 % at an eighth of the sampling frequency).

    Bay by bay: what the forces in it do at a point. By reciprocity G(x_f|x) = G(x|x_f), so that one source at
    the point gives the responses to forces at all places of a bay. Responses as in
    `asperity.structures.moving_kernel`; those to forces more than a bay away are carried by the waves of the
    track, in which a bay differs from the next by a factor, so that its forces are transformed once for all
    points.
    """
    places = np.atleast_1d(finite_array("points on the rail (m)", points))
    path = _Path(forces, origin / kernel.spacing, kernel.speed * kernel.time_step / kernel.spacing)
    displacement = np.zeros((len(forces), len(places), forces.shape[1]))
    near = _Waves(kernel, kernel.weights.shape[1], ZONES)
    far = _Far(kernel, path.steps_in_bay)
    passed = [_Point(near, far, float(place)) for place in places]
    reach = [point.reach(path.bays) for point in passed]
    with one_thread_in_linear_algebra():
        for first in path.bays[::TOGETHER]:
            some = range(first, min(first + TOGETHER, path.bays.stop))
            sent = _SentWaves(far, path, some)
            for bay in some:
                for i, point in enumerate(passed):
                    if bay in reach[i]:
                        point.add(displacement[:, i], path, bay, sent)
                if progress is not None:
                    progress(bay + 1 - path.bays.start, len(path.bays), "the rail at the points passed")
    padded = np.pad(displacement, ((0, 0), (0, 0), (3, 3)), mode="reflect", reflect_type="odd")
    velocity = np.zeros_like(displacement)
    for offset, weight in enumerate(DIFFERENCE):
        velocity += weight / kernel.time_step * padded[..., offset : offset + forces.shape[1]]
    return displacement[..., settled:], velocity[..., settled:]


@dataclass(frozen=True, eq=False)
class _Path:
    """Forces, N, (runs, n), and where they act: first place and step, in bays from the sleeper at zero."""

    forces: Array
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

    def within(self, bay: int) -> tuple[int, Array, Array]:
        """First step in a bay, forces (runs, k) there, and their places (k,), from 0 to 1."""
        begin = max(0, math.ceil((bay - self.first) / self.stride))
        end = min(self.forces.shape[1], math.ceil((bay + 1 - self.first) / self.stride))
        return begin, self.forces[:, begin:end], self.first + self.stride * np.arange(begin, end) - bay


class _Waves:
    """What a force at the nodes of a bay, or at places (n,) from 0 to 1, sends out on either side.

    A point that has the bay on its right is on side 1, on its left −1.
    """

    def __init__(self, kernel: MovingKernel, taps: int, zones: int, places: Array | None = None) -> None:
        self.grid = HatResponse(kernel.track, kernel.time_step, taps, zones)
        waves = self.waves = self.grid.waves
        self.amplitude = self.grid.hat * waves.coefficients
        at = None if places is None else kernel.spacing * places
        shapes = waves.shapes_at_nodes(NODES) if at is None else waves.symmetric_shapes(at)
        self.shapes = dict(zip((1, -1), shapes, strict=True))  # (n, 2, f) for either side
        self._powers = [np.ones_like(self.waves.multipliers)]

    def felt(self, at: float) -> dict[int, Complex]:
        """Amplitudes of the waves at a place of a bay, m, (2, f), for either side."""
        return {1: self.amplitude * self.waves.incoming(at), -1: self.amplitude * self.waves.outgoing(at)}

    def power(self, bays: int) -> Complex:
        """Change of the waves over some bays, (2, f)."""
        while len(self._powers) <= bays:
            self._powers.append(self._powers[-1] * self.waves.multipliers)
        return self._powers[bays]


class _Far(_Waves):
    """Waves at places all over a bay, at the frequencies of a transform of its forces and what follows.

    A force f at the place x sends out Σ f S(ω, x) exp(−iωt), where x = x_0 + v t. The transform is long, for
    what follows rings long; but the force is there for a short time. Each frequency ω_m of a transform of the
    bay alone has `between` of the others around it, at which S exp(−i(ω − ω_m)x/v) is as smooth over x as S:
    one polynomial goes through its values at the nodes, and short transforms of forces times polynomials do.
    """

    def __init__(self, kernel: MovingKernel, steps: int) -> None:
        self.taps = kernel.weights.shape[1]
        stride, wanted = kernel.speed * kernel.time_step / kernel.spacing, ROOM * (self.taps + steps)
        self.steps = 2 * next_fast_len(math.ceil(0.5 * min(1.0 / stride, wanted)))  # of all the bay
        self.between = math.ceil(wanted / self.steps)
        self.period = self.steps * self.between
        nodes = chebpts1(TERMS)
        self.polynomials = np.linalg.inv(chebvander(nodes, TERMS - 1))  # by column, one at a node each
        places = 0.5 * (nodes + 1.0)
        super().__init__(kernel, self.period // 2, 1, places)
        self.window = np.exp(self.grid.shift * self.grid.time_step * np.arange(self.period))
        beside = np.arange(self.between) - self.between // 2  # of ω_m, in steps of the frequencies
        self.delay = 2.0 * np.pi / (self.period * stride) * beside
        delayed = np.exp(-1j * self.delay * places[:, None])[:, None, None]
        self.sending = {  # (m, TERMS, 2 × between)
            side: (self.around(shape) * delayed).transpose(2, 0, 1, 3).reshape(-1, TERMS, 2 * self.between)
            for side, shape in self.shapes.items()
        }

    def around(self, spectra: Complex) -> Complex:
        """Spectra (..., f) laid out around the frequencies ω_m, (..., m, between), zero outside."""
        before, all_in_all = self.between // 2, (self.steps // 2 + 1) * self.between
        laid_out = np.zeros((*spectra.shape[:-1], all_in_all), complex)
        laid_out[..., before : before + spectra.shape[-1]] = spectra
        return laid_out.reshape(*spectra.shape[:-1], -1, self.between)

    def along(self, around: Complex) -> Complex:
        """Spectra (..., f) from (..., m, between)."""
        before = self.between // 2
        return around.reshape(*around.shape[:-2], -1)[..., before : before + self.period // 2 + 1]

    def shares(self, places: Array) -> Array:
        """Shares (TERMS, k) of the nodes in what acts at places (k,) from 0 to 1."""
        return np.asarray((chebvander(2.0 * places - 1.0, TERMS - 1) @ self.polynomials).T)

    def in_time(self, spectra: Complex, length: int) -> Array:
        """What spectra (..., f) are in time, at the first `length` steps."""
        folded = spectra.copy()
        folded[..., -1] *= 2.0  # at half the sampling frequency two lines look alike
        return np.asarray(irfft(folded, self.period)[..., :length] * self.window[:length])


class _SentWaves:
    """The waves that the forces in some bays send out on either side, found when first asked for."""

    def __init__(self, far: _Far, path: _Path, bays: range) -> None:
        self.far, self.path, self.bays = far, path, bays
        self._sent: dict[int, Complex] = {}

    @cached_property
    def spectra(self) -> Complex:
        """Spectra of the forces' shares of the nodes of the bays, (m, bays × runs, TERMS)."""
        runs = len(self.path.forces)
        found = np.empty((self.far.steps // 2 + 1, len(self.bays), runs, TERMS), complex)
        for i, bay in enumerate(self.bays):
            _, forces, places = self.path.within(bay)
            shared = forces[:, None] * (self.far.shares(places) / self.far.window[: len(places)])
            found[:, i] = rfft(shared, self.far.steps).transpose(2, 0, 1)
        return found.reshape(len(found), -1, TERMS)

    def towards(self, side: int, bay: int) -> Complex:
        """Waves, (m, runs, 2, between), to points that have a bay on their right (side 1) or left (−1)."""
        if side not in self._sent:
            sent = self.spectra @ self.far.sending[side]
            self._sent[side] = sent.reshape(len(sent), len(self.bays), -1, 2, self.far.between)
        return self._sent[side][:, bay - self.bays.start]


class _Point:
    """A point of the rail, m, and what forces elsewhere do there."""

    def __init__(self, near: _Waves, far: _Far, place: float) -> None:
        self.near, self.far = near, far
        spacing = near.waves.spacing
        self.bay = math.floor(place / spacing)
        self.at = place / spacing - self.bay  # from 0 to 1
        self._near, self._far = (of.felt(place - self.bay * spacing) for of in (near, far))
        self._responses = {bay: self._hats(bay) for bay in (-1, 0, 1)}

    def reach(self, bays: range) -> range:
        """Those of some bays whose forces are felt here: responses die away with the distance."""
        rightwards = range(max(self.bay, bays.start), bays.stop)
        leftwards = range(min(self.bay, bays.stop) - 1, bays.start - 1, -1)
        nearest = {bay - self.bay for outwards in (rightwards, leftwards) for bay in outwards[:1]}
        largest = max(self._size(distance) for distance in nearest)

        def faint(bay: int) -> bool:
            return self._size(bay - self.bay) < FAINT * largest

        right, left = (bisect_left(outwards, True, key=faint) for outwards in (rightwards, leftwards))
        return range(leftwards.start + 1 - left, rightwards.start + right)

    def _size(self, distance: int) -> float:
        """Largest response to a hat of force so many bays away, m/N; further away, at two places there."""
        if distance in self._responses:
            return float(np.abs(self._responses[distance]).max())
        side, received = self._received(distance)
        spectra = (received * self.far.shapes[side][:: TERMS // 2]).sum(axis=1)
        return float(np.abs(self.far.in_time(spectra, self.far.taps)).max())

    def _received(self, distance: int) -> tuple[int, Complex]:
        """The side of a bay further away, and what the waves sent out there are here, m/N, (2, f)."""
        side = 1 if distance > 0 else -1
        return side, self._far[side] * self.far.power(abs(distance))

    def add(self, displacement: Array, path: _Path, bay: int, sent: _SentWaves) -> None:
        """Add to the displacement here, m, (runs, n), what the forces in a bay do from then on."""
        begin, forces, places = path.within(bay)
        length = min(self.far.taps + len(places), displacement.shape[1] - begin)
        moved = displacement[:, begin : begin + length]
        if bay - self.bay in self._responses:
            moved += _convolved(forces, self._responses[bay - self.bay], places * NODES)[:, :length]
            return
        side, received = self._received(bay - self.bay)
        here = self.far.around(received) * np.exp(1j * self.far.delay * places[0])
        waves = sent.towards(side, bay)
        spectra = waves[:, :, 0] * here[0][:, None]
        spectra += waves[:, :, 1] * here[1][:, None]
        moved += self.far.in_time(self.far.along(spectra.transpose(1, 0, 2)), length)

    def _hats(self, bay: int) -> Array:
        """Responses, (NODES + 3, taps), to forces at nodes −1 … NODES + 1 of a bay; the point's is bay 0."""
        of, places = self.near, range(bay * NODES - 1, (bay + 1) * NODES + 2)
        spectra = np.empty((len(places), of.amplitude.shape[1]), complex)
        felt = cache(lambda side, bays: self._near[side] * of.power(bays))
        for place, spectrum in zip(places, spectra, strict=True):
            bays, node = divmod(place, NODES)
            side = 1 if place >= NODES * self.at else -1
            np.einsum("jf,jf->f", felt(side, abs(bays)), of.shapes[side][node], out=spectrum)
        return of.grid.response(spectra)


def _convolved(forces: Array, responses: Array, places: Array) -> Array:
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
