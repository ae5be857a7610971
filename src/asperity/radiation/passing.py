"""Motion of the rail at fixed points while the wheel passes them."""

import math
from collections.abc import Iterable

import numpy as np
import scipy
from numpy.polynomial.chebyshev import chebpts1, chebvander
from scipy.fft import irfft, next_fast_len, rfft

from asperity.arguments import Array, ArrayLike, Complex, finite_array
from asperity.progress import Progress, counted
from asperity.structures.moving_kernel import ZONES, HatResponse, MovingKernel, lagrange_weights
from asperity.threads import in_order

NODES = 24
"""Places of the force in a bay near the point; between them responses are interpolated by a cubic."""
TERMS = 12
"""Places of the force in a bay further away, where responses are smooth; one polynomial goes through them."""
DIFFERENCE = np.array([-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0]) / 60.0


def passed_points(
    kernel: MovingKernel,
    forces: Array,
    positions: ArrayLike,
    points: ArrayLike,
    settled: int,
    progress: Progress | None = None,
) -> tuple[Array, Array]:
    """Displacement, m, and velocity, m/s, (runs, p, n), of the rail at fixed points under moving forces.

    Forces (runs, m), N, at every time step, at rising positions (m,), m from the sleeper at zero, as are the
    points (p,). Positive downwards, without the first `settled` time steps. The velocity is the central
    difference of sixth order (−0.2 % at an eighth of the sampling frequency).

    Bay by bay: what the forces in it do at a point. By reciprocity G(x_f|x) = G(x|x_f), so that one source at
    the point gives the responses to forces at all places of a bay. Responses as in
    `asperity.structures.moving_kernel`; those to forces more than a bay away are carried by the waves of the
    track, which change from a bay to the next by a factor each, so that its forces are transformed once
    for all points.
    """
    bay_length = kernel.track.sleeper_spacing
    places = np.atleast_1d(finite_array("points on the rail (m)", points)) / bay_length
    at = finite_array("positions on the rail (m)", positions, count=forces.shape[1]) / bay_length
    count = len(at)
    taps = kernel.weights.shape[1]
    bays = range(math.floor(at[0]), math.floor(at[-1]) + 1)
    ends = dict(zip((*bays, bays.stop), np.searchsorted(at, (*bays, bays.stop)).tolist(), strict=True))
    # rounding may put a step more into a bay, where a bay is passed in a whole number of steps
    most = max(ends[bay + 1] - ends[bay] for bay in bays) + 1
    waves = _Waves(kernel, next_fast_len(taps + most, real=True))
    passed = [_Point(waves, place, taps) for place in places]
    displacement = np.zeros((len(places), len(forces), count))

    def by_forces_in(bay: int) -> tuple[slice, list[Array]]:
        begin = ends[bay]
        end = ends[bay + 1]
        within = at[begin:end] - bay
        acting = forces[:, begin:end]
        sides = {point.side(bay) for point in passed} - {0}
        sent = waves.sent(bay, acting, within, sides)
        until = min(end + taps, count)
        moved = [point.moved(bay, acting, within, sent)[:, : until - begin] for point in passed]
        return slice(begin, until), moved

    parts = in_order(by_forces_in, bays)
    for steps, moved in counted(parts, len(bays), "the rail at the points passed", progress):
        displacement[..., steps] += moved
    displacement = displacement.swapaxes(0, 1)
    padded = np.pad(displacement, ((0, 0), (0, 0), (3, 3)), mode="reflect", reflect_type="odd")
    velocity = scipy.ndimage.correlate1d(padded, DIFFERENCE / kernel.time_step)[..., 3:-3]
    return displacement[..., settled:], velocity[..., settled:]


class _Waves:
    """The waves that forces in a bay send out, at the frequencies of a transform of `taps` lags.

    To points that have the bay on their right (side 1), or on their left (side −1).
    """

    def __init__(self, kernel: MovingKernel, taps: int) -> None:
        self.grid = HatResponse(kernel.track, kernel.time_step, taps, ZONES)
        nodes = chebpts1(TERMS)
        self.track = kernel.track
        self._near: dict[int, dict[int, Complex]] = {}
        first_zone = self.grid.waves.at_first(taps + 1)
        self.far = []  # in single precision, which takes half the time: they move a point by a few per cent
        for bay in range(self.track.cell_bays):
            far = first_zone.bay(bay).symmetric_shapes(0.5 * self.track.sleeper_spacing * (nodes + 1.0))
            self.far.append(dict(zip((1, -1), (shapes.astype(np.complex64) for shapes in far), strict=True)))
        self.polynomials = chebvander(nodes, TERMS - 1) / TERMS
        self.polynomials[:, 1:] *= 2.0  # by row one that is 1 at its node, and 0 at the others

    def near(self, bay: int) -> dict[int, Complex]:
        """Waves at the nodes of a bay near a point, by side (NODES + 1, 2, all f)."""
        bay %= self.track.cell_bays
        if bay not in self._near:
            self._near[bay] = dict(zip((1, -1), self.grid.waves.bay(bay).shapes_at_nodes(NODES), strict=True))
        return self._near[bay]

    def shares(self, places: Array) -> Array:
        """Shares (TERMS, k) of the nodes in what acts at places (k,) from 0 to 1 of a bay."""
        return self.polynomials @ chebvander(2.0 * places - 1.0, TERMS - 1).T

    def sent(self, bay: int, forces: Array, places: Array, sides: Iterable[int]) -> dict[int, Complex]:
        """Waves (runs, 2, f) to some sides of forces (runs, k), N, at places (k,) from 0 to 1 of a bay."""
        window = np.exp(-self.grid.shift * self.grid.time_step * np.arange(len(places)))
        shared = forces[:, None] * (self.shares(places) * window)
        spectra = rfft(shared.astype(np.float32), 2 * self.grid.taps)
        far = self.far[bay % self.track.cell_bays]
        return {side: np.einsum("rxf,xjf->rjf", spectra, far[side]) for side in sides}


class _Point:
    """A point of the rail, in bays from the sleeper at zero, and what forces elsewhere do there."""

    def __init__(self, waves: _Waves, place: float, taps: int) -> None:
        self.waves = waves
        self.bay = math.floor(place)
        self.at = place - self.bay  # from 0 to 1
        shapes = waves.grid.waves.bay(self.bay)
        at = self.at * waves.track.sleeper_spacing
        amplitude = waves.grid.hat * shapes.coefficients
        self.felt = {1: amplitude * shapes.incoming(at), -1: amplitude * shapes.outgoing(at)}  # m, (2, f)
        self.responses = {bay: self._hats(bay)[:, :taps] for bay in (-1, 0, 1)}

    def side(self, bay: int) -> int:
        """1 if waves from a bay come from the right, −1 from the left, 0 if it is near."""
        return 0 if bay - self.bay in self.responses else 1 if bay > self.bay else -1

    def moved(self, bay: int, forces: Array, places: Array, sent: dict[int, Complex]) -> Array:
        """Displacement here, m, (runs, n), by the forces in a bay and the waves that they send out."""
        side = self.side(bay)
        distance = bay - self.bay
        if not side:
            return _convolved(forces, self.responses[distance], places * NODES)
        received = self._received(side, distance, slice(self.waves.grid.taps + 1))
        return self.waves.grid.response(np.einsum("rjf,jf->rf", sent[side], received))

    def _received(self, side: int, bays: int, zone: slice = slice(None)) -> Complex:
        """What waves are here that were sent out so many bays on, m/N, (2, f), in a zone of frequencies."""
        return self.felt[side][:, zone] * self.waves.grid.waves.carried(self.bay, self.bay + bays, zone)

    def _hats(self, bay: int) -> Array:
        """Responses, (NODES + 3, n), to forces at nodes −1 … NODES + 1 of a bay; the point's is bay 0."""
        spectra = []
        received = dict[tuple[int, int], Complex]()
        for place in range(bay * NODES - 1, (bay + 1) * NODES + 2):
            bays, node = divmod(place, NODES)
            side = 1 if place >= NODES * self.at else -1
            if (side, bays) not in received:
                received[side, bays] = self._received(side, bays)
            near = self.waves.near(self.bay + bays)[side][node]
            spectra.append(np.einsum("jf,jf->f", received[side, bays], near))
        return self.waves.grid.response(np.array(spectra))


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
    return moved[:, : len(places) + taps]
