"""Response of a track to a hat of force in time, from its receptance in frequency."""

import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy import fft

from asperity.arguments import Array, Complex, Integers, not_negative, positive, real, shown, whole
from asperity.errors import CoarseSamplingWarning, InputError, percent
from asperity.progress import Progress
from asperity.store import Store, content_key, made
from asperity.structures.causal_track import causal_track
from asperity.structures.cell_waves import CellWaves
from asperity.structures.periodic_rail import PeriodicWaves
from asperity.structures.track import Track
from asperity.threads import thread_count
from asperity.written_numbers import engineering

ZONES = 4
"""Multiples of half the sampling frequency up to which the receptance near the contact is folded."""
SHIFT = 8.0
"""Exponential window over the period of the transform, neper."""


class HatResponse:
    """From receptances to responses in time, on one grid of frequencies.

    The track must be causal. There are `taps` lags, of one time step, s; the period of the transform is twice
    that. Receptances are folded up to `zones` multiples of half the sampling frequency. They are wanted at
    `omega` (f,), angular frequencies ω − iσ, rad/s, at which `waves` are those of the track and `hat` is the
    transform of the hat over the time step, sin²(ωΔt/2)/(ωΔt/2)².
    """

    def __init__(self, track: Track, time_step: float, taps: int, zones: int) -> None:
        self.track = track
        self.taps = taps
        self.time_step = time_step
        period = 2 * taps * time_step
        self.shift = SHIFT / period
        self.omega = 2.0 * np.pi / period * np.arange(zones * taps + 1) - 1j * self.shift
        half = 0.5 * self.omega * time_step
        self.hat = (np.sin(half) / half) ** 2
        self.waves: PeriodicWaves | CellWaves = track.waves(self.omega)

    def response(self, spectra: Complex) -> Array:
        """Response to the hat at lags 0 … taps − 1 from receptances times the hat, (k, f) → (k, taps)."""
        return self.windowed(spectra) * self.growth

    def windowed(self, spectra: Complex) -> Array:
        """The same over `growth` (taps,), which the exponential window took; spectra are folded in place."""
        return fft.irfft(_folded(spectra, self.taps), 2 * self.taps, axis=1)[:, : self.taps]

    @property
    def growth(self) -> Array:
        """What the exponential window takes from each lag, (taps,)."""
        return np.exp(self.shift * self.time_step * np.arange(self.taps))


def _folded(spectra: Complex, n: int) -> Complex:
    """Sum in place over frequencies that look alike at the time steps, up to half the sampling frequency."""
    folded = spectra[:, : n + 1]
    folded[:, n] = 2.0 * folded[:, n].real
    for first in range(n, spectra.shape[1] - 1, n):
        zone = spectra[:, first : first + n + 1]
        if (first // n) % 2:
            folded[:, 1:n] += np.conj(zone[:, n - 1 : 0 : -1])
            folded[:, 0] += 2.0 * zone[:, n].real
        else:
            folded[:, 1:n] += zone[:, 1:n]
            folded[:, n] += 2.0 * zone[:, n].real
    return folded


STARTS = 24
"""Start positions in one sleeper bay, by default."""
SHORTEST, LONGEST = 0.12, 0.6
"""Between these lengths, s, the kernel grows until it has died away."""
MOST_LINES = 10**7
"""Frequencies times bays that differ, of which waves are held at once: five gigabytes."""
DIED_AWAY = 1e-3
"""Largest value in the last tenth of a kernel, relative to its largest of all, by which it has died away."""
RINGS = 1.3 * DIED_AWAY
"""The same above a sleeper and amid a bay alone, where it is largest, by which all of it has surely not."""


@dataclass(frozen=True, eq=False)
class MovingKernel:
    """Response of the rail at the moving contact to one hat of force.

    Row s, column k of the weights: displacement at x_s + k v Δt, k steps after a force that rises to 1 N and
    falls again, linearly, within a step each, at x_s = s P/positions, P the period of the track; m/N. Column
    0 stands for the rising half alone. A force that is linear over each step displaces the rail by the sum of
    its values times these weights. With a distance, the displacement is that of another contact, which runs
    so far ahead.
    """

    track: Track  # with relaxations where it has loss factors
    speed: float  # of the contact, m/s
    time_step: float  # s
    weights: Array  # (positions, taps), m/N
    distance: float = 0.0  # of the contact whose displacement it is ahead of the force, m; negative behind

    @property
    def kernel(self) -> "MovingKernel":
        """Itself, as of `RailPoles` what was fitted."""
        return self

    @property
    def left_over(self) -> float:
        """Largest value in its last tenth, relative to the largest of all."""
        return _left_over(self.weights)


def _left_over(weights: Array) -> float:
    last = weights[:, -max(1, weights.shape[1] // 10) :]
    return float(np.abs(last).max() / np.abs(weights).max())


def moving_kernel(
    track: Track,
    speed: float,
    time_step: float,
    *,
    duration: float | None = None,
    positions: int = STARTS,
    distance: float = 0.0,
    cache: Store | None = None,
    progress: Progress | None = None,
) -> MovingKernel:
    """Compute the moving kernel of a track for a contact at constant speed, m/s, zero for one at rest.

    The track must dissipate; where it has constant loss factors, the kernel is that of its `causal_track`.
    The speed is below the critical one. The kernel lasts for `duration`, s, by default until it has died
    away, at most 0.6 s, with a warning. Start positions are equally spaced, so many to a bay; between them
    kernels are interpolated. With a `distance`, m, it is the displacement of a second contact, so far ahead
    of the force, or behind, at the same speed.

    Inverse Fourier transform of the exact receptance G(x_s + vτ | x_s) times that of the hat,
    sin²(ωΔt/2)/(ωΔt/2)², along ω − iσ and folded at half the sampling frequency; between the nodes of a bay
    the response is interpolated by a cubic. In the bay of the force and the one before, receptances up to
    four times that frequency are folded; those of other bays end at it, by which the first millisecond of
    weights is off by up to 3e-4 of the largest.
    """
    if not isinstance(track, Track):
        raise InputError("track", shown(track), "a Track, as Track.named('x2000')")
    time_step = positive("time step (s)", time_step)
    speed = not_negative("speed (m/s)", speed)
    positions = whole("start positions", positions, "a whole number, 1 or more", at_least=1)
    if duration is not None:
        duration = positive("duration (s)", duration)
    if not track.is_damped:
        remedy = "Give the rail a loss factor, or damping to pads or ballast."
        raise InputError("track", "no damping at all", "a track whose vibration dies away", remedy)
    if speed > 0.0:
        track.refuse_speed(speed)
    track = causal_track(track, cache)
    distance = real("distance (m)", distance, "a finite number")
    described = (track.parameters, speed, time_step, duration, positions, ZONES, SHIFT)
    key = content_key("moving-kernel", *described, *([distance] if distance else []))

    def weights_of(length: float, most: float) -> Array | None:
        taps = max(8, round(length / time_step))
        _refuse_size(track, length, ZONES * taps + 1)
        near = HatResponse(track, time_step, taps, ZONES)
        weights = _weights(near, speed, positions, distance, progress, RINGS if most < np.inf else most)
        return None if weights is None or _left_over(weights) > most else weights

    def make() -> dict[str, Array]:
        length = SHORTEST if duration is None else duration
        longest = LONGEST if duration is None else duration
        while (weights := weights_of(length, DIED_AWAY if length < longest else np.inf)) is None:
            length = min(1.6 * length, longest)
        return {"weights": weights}

    kept = made(cache, key, make)
    kernel = MovingKernel(track, speed, time_step, kept["weights"], distance)
    if duration is None and kernel.left_over > DIED_AWAY:
        CoarseSamplingWarning.warn(
            f"the moving kernel still has {percent(kernel.left_over)} of its largest value after "
            f"{LONGEST:g} s, more than {100 * DIED_AWAY:g} %: what comes later is cut off. Raise the "
            "damping or the loss factors of rail, pads and ballast."
        )
    return kernel


def refuse_kernel(track: Track, time_step: float) -> None:
    """Refuse a track of which no moving kernel can be computed in such time steps, s, however short it is.

    Waves at the highest frequency of the transform die away within a bay, or bays that differ are too many.
    """
    _refuse_size(track, SHORTEST, ZONES * max(8, round(SHORTEST / time_step)) + 1)
    track.waves(np.array([np.pi * ZONES / time_step]))


def _refuse_size(track: Track, length: float, lines: int) -> None:
    """Refuse more bays that differ than fit into memory, for a kernel of a length, s, and its frequencies."""
    if track.bays and track.cell_bays * lines > MOST_LINES:
        received = f"{track.cell_bays}, for a kernel of {engineering(length, 's', 2)} at {lines} frequencies"
        remedy = "Take fewer bays, a lower highest frequency, or more damping, so that the kernel is shorter."
        raise InputError("bays that differ", received, f"at most {MOST_LINES // lines} of them", remedy)


def _weights(
    near: HatResponse,
    speed: float,
    positions: int,
    distance: float,
    progress: Progress | None,
    most: float,
) -> Array | None:
    """All rows of the kernel; near the contact receptances are folded as that response says.

    None where more than `most` is left over of those above a sleeper and amid a bay, of bays that are alike.
    """
    taps = near.taps
    track = near.track
    way = _Way(near, HatResponse(track, near.time_step, taps, 1), speed, positions, distance)
    weights = np.zeros((track.cell_bays * positions, taps))
    shapes: Shapes = {}
    told = f"moving kernel of {engineering(taps * near.time_step, 's', 2)}"
    starts = list(dict.fromkeys([*way.first, *range(positions)]))
    felt = np.empty((positions, len(BESIDE), taps))
    with ThreadPoolExecutor(thread_count()) as pool:
        for own in range(track.cell_bays):
            begun = _Begun(way, own, shapes)
            shapes = begun.shapes  # of bays that are passed again
            for done, (start, found) in enumerate(zip(starts, pool.map(begun.felt, starts), strict=True), 1):
                felt[start] = found
                if done == len(way.first) and not track.bays and way.left_over(felt) > most:
                    return None  # rows that have not begun are not computed
                if progress is not None:
                    progress(own * positions + done, len(weights), told)
            for start in starts:
                weights[own * positions + start] = way.row(start, felt)
    return weights


BESIDE = np.arange(-1, 3)[:, None]
"""Nodes beside a contact, from the one behind it or under it on, between which responses are a cubic."""
Shapes = dict[tuple[HatResponse, int], tuple[Complex, Complex]]
"""Shapes of waves outwards and inwards, two of (positions, 2, f), on a grid of frequencies in a bay."""


@dataclass(frozen=True, eq=False)
class _Way:
    """Places of a contact from any start on, in nodes, of which each bay has as many as start positions."""

    near: HatResponse  # in the bay of the force and the one before
    far: HatResponse  # in all others
    speed: float  # m/s
    positions: int
    distance: float  # of the contact from the force, m
    rooms: threading.local = field(default_factory=threading.local)  # of each thread, for spectra

    @property
    def spacing(self) -> float:
        """Distance of two nodes, m."""
        return self.near.track.sleeper_spacing / self.positions

    @property
    def mirrored(self) -> bool:
        """Whether the displacement is that under the force, on a track that is symmetric about a sleeper."""
        return not (self.distance or self.near.track.bays)

    @property
    def first(self) -> tuple[int, ...]:
        """Starts above a sleeper and amid a bay."""
        return tuple(dict.fromkeys((0, self.positions // 2)))

    def grid(self, bay: int) -> HatResponse:
        """Frequencies on which the receptance of a bay is taken, counted from that of the force."""
        return self.near if bay in (-1, 0) else self.far

    @property
    def passed(self) -> range:
        """Bays that are passed from any start in the first one, with those of the nodes beside them."""
        ahead = self.distance / self.spacing
        begin = int(np.floor(ahead)) - 1
        steps = self.near.taps * self.speed * self.near.time_step / self.spacing
        end = int(ahead + self.positions + steps) + 2
        return range(begin // self.positions, end // self.positions + 1)

    @cached_property
    def at(self) -> Array:
        """Places (taps,) at all steps, from the start on."""
        step = self.speed * self.near.time_step / self.spacing
        return np.asarray(self.distance / self.spacing + np.arange(self.near.taps) * step)

    @cached_property
    def base(self) -> Integers:
        """The nodes (taps,) before these places, or there."""
        return np.floor(self.at).astype(int)

    @cached_property
    def cubic(self) -> Array:
        """Weights (4, taps) of the nodes beside these places, and the growth of what the window took."""
        return lagrange_weights(self.at - self.base) * self.far.growth

    def last(self, start: int) -> int:
        """Last node of each bay whose response is computed for a start.

        In bays that are alike G(bP + n|s) = G(bP + P − s|P − n), mirrored about the middle between both and
        by reciprocity, and the contact is at both at the same lag: the start P − n has it.
        """
        alike = not self.near.track.bays and start not in self.first
        return self.positions - start if alike else self.positions

    def row(self, start: int, felt: Array) -> Array:
        """Row (taps,) of the kernel from a start on, by what was `felt` from all (positions, 4, taps)."""
        node = (start + self.base + BESIDE) % self.positions
        by = np.where(node > self.last(start), self.positions - node, start)
        found = np.take_along_axis(felt, by[None], axis=0)[0]
        return np.asarray(np.sum(self.cubic * found, axis=0))

    def left_over(self, felt: Array) -> float:
        """What is left over of the first rows, as of a kernel."""
        return _left_over(np.array([self.row(start, felt) for start in self.first]))


class _Begun:
    """What all rows have in common that begin in one bay of the cell."""

    def __init__(self, way: _Way, own: int, known: Shapes) -> None:
        track = way.near.track
        self.way = way
        self.own = own
        self.bays = track.cell_bays
        needed = {(way.near, own), (way.far, own)}
        self.amplitudes: dict[int, Complex] = {}
        for bay in way.passed:
            grid = way.grid(bay)
            needed.add((grid, (own + bay) % self.bays))
            self.amplitudes[bay] = grid.hat * grid.waves.coefficients * grid.waves.carried(own, own + bay)
        self.shapes = {each: known.get(each) or _shapes(*each, way.positions) for each in needed}

    def felt(self, start: int) -> Array:
        """Responses (4, taps) at the nodes beside the contact at each lag, before they have grown.

        From a start on, bay by bay; zero where the start is not `_Way.last` to have them.
        """
        way = self.way
        positions = way.positions
        base = start + way.base
        result = np.zeros((len(BESIDE), way.near.taps))
        first = 0 if way.mirrored else int(base[0] - 1) // positions
        for bay in range(first, int(base[-1] + 2) // positions + 1):
            low = 0 if way.mirrored else max(int(base[0]) - 1 - bay * positions, 0)
            # others are not passed, or known of another start
            high = min(int(base[-1]) + 3 - bay * positions, positions, way.last(start) + 1)
            if low >= high:
                continue
            response = self._response(start, bay, low, high)
            passed = slice(*np.searchsorted(base, [bay * positions - 2, (bay + 1) * positions + 1]))
            node = base[passed] + BESIDE - bay * positions
            if bay == 0 and start == 0 and way.mirrored:
                node = np.abs(node)
            beside, lag = np.nonzero((node >= low) & (node < high))
            lags = lag + passed.start
            result[beside, lags] = response[node[beside, lag] - low, lags]
        return result

    def _response(self, start: int, bay: int, low: int, high: int) -> Array:
        """Responses (high − low, taps) at nodes of a bay to a force at a start, before they have grown."""
        positions = self.way.positions
        grid = self.way.grid(bay)
        here = self.shapes[grid, self.own]
        outgoing, incoming = self.shapes[grid, (self.own + bay) % self.bays]
        forwards, backwards = (self.amplitudes[bay] * here[side][start] for side in (1, 0))
        behind = min(positions if bay < 0 else start if bay == 0 else 0, high)  # by reciprocity
        spectra, part = (each[: high - low, : grid.omega.size] for each in self._room())
        _add_waves(forwards, outgoing[low:high], spectra, part)
        if behind > low:
            _add_waves(backwards, incoming[low:behind], spectra[: behind - low], part[: behind - low])
        return grid.windowed(spectra)

    def _room(self) -> Complex:
        """Room for spectra, once for a thread: fresh memory costs more than what is done in it."""
        rooms = self.way.rooms
        if not hasattr(rooms, "both"):
            rooms.both = np.empty((2, self.way.positions, self.way.near.omega.size), complex)
        return rooms.both


def _shapes(grid: HatResponse, bay: int, count: int) -> tuple[Complex, Complex]:
    """Shapes of the waves at so many nodes of a bay, two of (count, 2, f)."""
    outgoing, incoming = grid.waves.bay(bay).shapes_at_nodes(count)
    return outgoing[:-1], incoming[:-1]


def _add_waves(amplitude: Complex, shapes: Complex, total: Complex, part: Complex) -> None:
    """Set a sum (p, f) over the waves of a track, (w, f), each of its shape (p, w, f); `part` is room."""
    np.multiply(amplitude[0], shapes[:, 0], out=total)
    for wave in range(1, len(amplitude)):
        np.multiply(amplitude[wave], shapes[:, wave], out=part)
        np.add(total, part, out=total)


def lagrange_weights(share: Array) -> Array:
    """Weights (4, ...) of the nodes −1, 0, 1, 2 for places (...) between 0 and 1, of a cubic."""
    before = share + 1.0
    after = share - 1.0
    beyond = share - 2.0
    first = -share * after * beyond / 6.0
    last = before * share * after / 6.0
    return np.stack([first, before * after * beyond / 2.0, -before * share * beyond / 2.0, last])
