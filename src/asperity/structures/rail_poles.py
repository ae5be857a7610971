"""The rail as a bank of poles: the moving kernel in a form that costs the same at any length."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy

from asperity.arguments import Array, ArrayLike, Complex, Integers, NDArray
from asperity.errors import ComputationError, InputError, UnconvergedWarning, percent
from asperity.progress import Progress
from asperity.speeds import slowest
from asperity.store import Store, content_key, made
from asperity.structures.modal_fit import least_squares, paired, real_basis, vector_fit
from asperity.structures.moving_kernel import DIED_AWAY, MovingKernel, moving_kernel
from asperity.structures.track import Track

POLES = 100
"""Poles of a rail where nothing is said of them."""
CELLS = 192
"""Places in one bay at which residues are tabulated; between them they are linear."""
ROWS = 48
"""Start positions of bays that differ from which poles are fitted: they are common to all."""
LOWEST = 2.0
"""Lowest frequency of the fit, Hz."""
LINES = 300
"""Frequencies of the fit in each of its two grids, logarithmic and linear."""
PIECE = 64
"""Frequencies transformed in one go."""
ITERATIONS = 8
TOLERANCE = 5e-3
"""Largest error of a fitted kernel that is accepted, relative (see `RailPoles`)."""
ENOUGH = 2e-3
"""Error from which on more poles are not worth their time."""
GONE = 0.01
"""Share of itself that a pole has at most left after a kernel that has died away."""
DETERMINED = 1e-8
"""Singular values of the residues, relative to the largest, below which the kernel says nothing of them."""


@dataclass(frozen=True, eq=False)
class RailPoles:
    """A moving kernel as a sum of decaying oscillations.

    For lags k >= 1 the weights of a start position x are Re Σ_p c_p(x) z_p^(k−1), so that the displacement of
    the next step follows from states q_p ← z_p q_p + c_p(x) F. They go on after the last lag of the kernel:
    where this has died away, errors are taken over twice its lags, zero beyond.
    """

    kernel: MovingKernel  # what was fitted
    poles: Complex  # (p,), z_p per time step, |z_p| < 1
    residues: Complex  # (positions, p), c_p at the start positions, m/N
    fit_error: float  # rms error of the weights of lags >= 1 over all start positions, relative to theirs
    # largest relative error of the deflection under a constant force, the sum of the weights
    static_error: float

    @property
    def count(self) -> int:
        """Number of poles, both of each conjugate pair counted."""
        return int(np.sum(np.where(self.poles.imag == 0.0, 1, 2)))

    @property
    def accepted(self) -> bool:
        """Whether the fit is good enough to stand for the kernel: near to it, and passive."""
        return max(self.fit_error, self.static_error) <= TOLERANCE and self.is_passive

    @property
    def is_passive(self) -> bool:
        """Whether no sinusoidal force that moves along, in the band of the fit, gets power from the rail.

        Looked at are the frequencies of the fit, and those at which a pole may hide between them. Over whole
        bays the power depends on the mean of the residues alone: it is −ω|F|² Im(W)/2 of their transform W.
        """
        step = self.kernel.time_step
        pole = self.poles
        residue = self.residues.mean(axis=0)
        own = np.abs(np.angle(pole))
        angle = np.union1d(_angles(step), own[own > 0.0])
        at = np.exp(1j * angle[angle <= 2.0 * np.pi * _highest(step) * step])[:, None]
        mean = (residue / (at - pole) + residue.conj() / (at - pole.conj())).sum(axis=1)
        return bool((mean.imag <= 0.0).all())

    def weights(self, taps: int | None = None) -> Array:
        """The fitted kernel, (positions, taps), m/N; as many as the kernel has by default."""
        direct = self.kernel.weights[:, :1]
        decays = _decays(self.poles, (taps or self.kernel.weights.shape[1]) - 1)
        return np.hstack([direct, self.residues.real @ decays.real - self.residues.imag @ decays.imag])

    def missed(self) -> Array:
        """What it has beyond the kernel from lag 1 on, (positions, lags), m/N, also after the last one."""
        wanted = _wanted(self.kernel)
        return self.weights(1 + wanted.shape[1])[:, 1:] - wanted


def rail_poles(kernel: MovingKernel, count: int, *, cache: Store | None = None) -> RailPoles:
    """Fit a moving kernel by common poles, both of each conjugate pair counted, and residues for every start.

    Their number is even, from 4 to `most_poles`. Poles by vector fitting of the transform on the unit circle,
    with weights between absolute and relative error, none slower than the kernel; residues by least squares
    in time, of the weights, of their running sums (the response to a force that stays), within the kernel and
    after it.
    """
    most = most_poles(kernel.weights.shape[1])
    if count % 2 or not 4 <= count <= most:
        allowed = f"an even number from 4 to {most}, a tenth of the kernel's lags or {LINES}"
        raise InputError("number of poles", count, allowed)
    key = content_key("rail-poles", kernel.weights, kernel.time_step, count, ITERATIONS, LINES, GONE, ROWS)

    def make() -> dict[str, NDArray[Any]]:
        poles = _poles(kernel, count)
        residues = _residues(_wanted(kernel), poles)
        left = RailPoles(kernel, poles, residues, 0.0, 0.0).missed()
        error = np.linalg.norm(left) / np.linalg.norm(kernel.weights[:, 1:])
        static = np.abs(left.sum(axis=1) / kernel.weights.sum(axis=1)).max()
        return {"poles": poles, "residues": residues, "errors": np.array([error, static])}

    kept = made(cache, key, make)
    error, static = kept["errors"].tolist()
    if not np.isfinite(error):
        raise ComputationError("the fit of the moving kernel by poles broke down", "fewer poles")
    return RailPoles(kernel, kept["poles"], kept["residues"], error, static)


def poles_or_kernel(
    kernel: MovingKernel, most: int | None, *, cache: Store | None = None
) -> RailPoles | MovingKernel:
    """Fit a moving kernel by poles, `POLES` of them by default, or as many as it has lags for.

    At most so many if told: `POLES` first, and twice as many as long as a fit misses it by more than
    `ENOUGH`. Where none is accepted, the kernel itself is returned, with a warning.
    """
    most = min(most or POLES, most_poles(kernel.weights.shape[1]))
    counts = [min(most, POLES)]
    fits = [rail_poles(kernel, counts[0], cache=cache)]
    while counts[-1] < most and not (fits[-1].accepted and fits[-1].fit_error <= ENOUGH):
        counts.append(min(most, 2 * counts[-1]))
        fits.append(rail_poles(kernel, counts[-1], cache=cache))
    best = min(fits, key=lambda fit: (not fit.accepted, fit.fit_error))
    if best.accepted:
        return best
    missed = f"miss the moving kernel by {percent(max(best.fit_error, best.static_error))}"
    UnconvergedWarning.warn(
        f"{counts[-1]} poles {missed if best.is_passive else 'give off energy'}: the track is scattered from "
        "the kernel itself, which is slower. Take more poles."
    )
    return kernel


def most_poles(lags: int) -> int:
    """Largest even number of poles for a kernel of so many lags."""
    return min(lags // 10 // 2 * 2, LINES)


def _wanted(kernel: MovingKernel) -> Array:
    """Weights from lag 1 on that a fit is held to, (positions, lags): with zeros after a kernel that died."""
    weights = kernel.weights[:, 1:]
    return np.hstack([weights, np.zeros_like(weights)]) if kernel.left_over <= DIED_AWAY else weights


def _highest(time_step: float) -> float:
    """Up to where frequencies are close, Hz."""
    return min(0.1 / time_step, 5000.0)


def _angles(time_step: float) -> Array:
    """Frequencies of the fit, rad per time step."""
    logarithmic = np.geomspace(LOWEST, 0.995 * 0.5 / time_step, LINES)
    linear = np.linspace(LOWEST, _highest(time_step), LINES)
    return 2.0 * np.pi * np.union1d(logarithmic, linear) * time_step


def _poles(kernel: MovingKernel, count: int) -> Complex:
    """Common poles, by vector fitting on the unit circle."""
    half = 0.5 / kernel.time_step
    taps = kernel.weights.shape[1]
    angle = _angles(kernel.time_step)
    lag = np.arange(1, taps)
    weights = kernel.weights[_spread(kernel), 1:].astype(complex)
    pieces = np.array_split(angle, math.ceil(angle.size / PIECE))  # the whole matrix is fifty megabytes
    transform = np.hstack([weights @ np.exp(-1j * lag[:, None] * piece) for piece in pieces])
    size = np.sqrt(np.mean(np.abs(transform) ** 2, axis=0))
    start = 2.0 * np.pi * np.geomspace(2.0 * LOWEST, 0.9 * half, count // 2) * kernel.time_step
    # a pole that a kernel of this length would not show to decay is not determined by it
    gone = np.clip(50.0 * kernel.left_over, GONE, 0.5)
    slowest = -np.log(gone) / taps
    return vector_fit(
        np.exp(1j * angle),
        transform,
        np.exp(1j * start - np.maximum(0.02 * start, slowest)),
        weights=1.0 / np.sqrt(size),
        iterations=ITERATIONS,
        radius=float(np.exp(-slowest)),
    )


def _spread(kernel: MovingKernel) -> Integers:
    """Start positions to fit poles from: all of one bay, or some all over bays that differ (golden ratio)."""
    count = len(kernel.weights)
    if kernel.track.cell_bays == 1:
        return np.arange(count)
    return np.unique((0.5 * (np.sqrt(5.0) - 1.0) * np.arange(ROWS) % 1.0 * count).astype(np.int64))


def _decays(poles: Complex, lags: int) -> Complex:
    with np.errstate(divide="ignore"):
        rates = np.log(np.where(poles == 0.0, 1e-300, poles))
    return np.exp(rates[:, None] * np.arange(lags))


def _residues(weights: Array, poles: Complex) -> Complex:
    """Least squares in time, of the weights, their running sums and their sum."""
    decays = _decays(poles, weights.shape[1])
    parts = np.stack([decays.real, -decays.imag], axis=1).reshape(-1, weights.shape[1])
    basis = parts[real_basis(poles)].T
    right = weights.T
    slow = 1.0 / np.sqrt(len(basis))  # running sums weigh like the weights of one step
    matrix = np.vstack([basis, slow * np.cumsum(basis, axis=0)])
    right = np.vstack([right, slow * np.cumsum(right, axis=0)])
    return paired(least_squares(matrix, right, DETERMINED), poles)


def over_the_period(values: NDArray[Any], bays: int) -> NDArray[Any]:
    """Values (positions, ...) at the start positions of a kernel, tabulated over so many bays, the period.

    At equal places, `CELLS` to a bay and both ends of the period, by a periodic cubic spline.
    """
    count = len(values)
    coefficients = scipy.ndimage.spline_filter1d(values, axis=0, output=values.dtype, mode="grid-wrap")
    place, share = np.divmod(np.linspace(0.0, count, CELLS * bays + 1), 1.0)
    nearest = (place[:, None].astype(int) + np.arange(-1, 3)) % count
    return np.einsum("pk,pk...->p...", cubic_weights(share), coefficients[nearest])


def cubic_weights(share: Array) -> Array:
    """Weights (p, 4) of the coefficients of a cubic B-spline at shares (p,) of the way between two knots."""
    rest = 1.0 - share
    inner = [3.0 * x**3 - 6.0 * x**2 + 4.0 for x in (share, rest)]
    return np.stack([rest**3, *inner, share**3], axis=1) / 6.0


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
    reach: float = np.inf  # m, beyond which contacts do not feel each other
    slower: "tuple[RailBetween, ...]" = ()  # the same at lower speeds, rising, for one that changes

    @property
    def at_speeds(self) -> "tuple[RailBetween, ...]":
        """It at all its speeds, rising."""
        return (*self.slower, self)

    @property
    def kernel(self) -> MovingKernel:
        """The direct one."""
        return self.direct.kernel

    def between(self, distance: float) -> RailPoles | MovingKernel | None:
        """What carries a force to a contact so far ahead of it, m; None if it is out of reach."""
        apart = round(float(distance), DECIMALS)
        if not apart:
            return self.direct
        if abs(apart) > self.reach:
            return None
        if apart not in self.crossing:
            known = ", ".join(f"{at:g}" for at in sorted(self.crossing)) or "none"
            remedy = "Compute the rail between them for the places of these contacts."
            raise InputError("distance of two contacts on the rail (m)", f"{apart:g}", known, remedy)
        return self.crossing[apart]


def rail_between(
    direct: RailPoles | MovingKernel,
    places: ArrayLike,
    *,
    cache: Store | None = None,
    progress: Progress | None = None,
) -> RailBetween:
    """Compute how a rail carries vibration between contacts.

    The moving kernel of every distance between two of them is computed from the same track as the direct one,
    for the same speed, time step and duration, and fitted by poles of its own (scattered where a fit is worse
    than half a percent of the direct kernel). Equal distances share a kernel. Contacts do not feel each other
    from the distance on at which the rms of a kernel is below 1 % of the direct one, so that a train costs in
    proportion to its wheels. On a lightly damped rail (loss factor 0.4 %) that is 40 m; leaving two wheels
    there alone changed the varying part of their forces by 3 % rms, and no one-third octave by more than
    0.05 dB.

    Parameters
    ----------
    direct : RailPoles or MovingKernel
        The rail under one contact.
    places : array_like (n,)
        Of the contacts along the path, m.
    cache : Store, optional
        Keeps kernels and poles.
    progress : callable, optional
        Is told distances done, distances in all and what is done.

    Returns
    -------
    RailBetween
    """
    at = np.ravel(places)
    reach = np.inf
    apart = np.unique(np.round(np.subtract.outer(at, at), DECIMALS))
    lengths = np.unique(np.abs(apart[apart != 0.0]))
    kernel = direct.kernel
    crossing: dict[float, RailPoles | MovingKernel] = {}
    positions = len(kernel.weights) // kernel.track.cell_bays
    taps = kernel.weights.shape[1]
    like = {"duration": taps * kernel.time_step, "positions": positions, "cache": cache}
    for done, length in enumerate(lengths):
        far = [
            moving_kernel(kernel.track, kernel.speed, kernel.time_step, distance=sign * float(length), **like)
            for sign in (1.0, -1.0)
        ]
        size = max(np.linalg.norm(each.weights) for each in far) / np.linalg.norm(kernel.weights)
        if size < NEGLIGIBLE:
            reach = float(lengths[done - 1]) if done else 0.0
            break
        crossing |= {each.distance: _fitted(direct, each, cache) for each in far}
        if progress is not None:
            progress(done + 1, len(lengths), "rail between contacts")
    return RailBetween(direct, crossing, reach)


SPEEDS_APART = 2.0
"""Between speeds whose kernels are computed for a speed that changes, m/s, at most."""


def rail_at(
    track: Track,
    speed: float,
    time_step: float,
    places: ArrayLike,
    *,
    poles: int | None = None,
    scattered: bool = False,
    cache: Store | None = None,
    progress: Progress | None = None,
) -> RailBetween:
    """Compute a rail for several contacts at a speed, constant or not.

    Of a speed that changes kernels are those of constant speeds, `SPEEDS_APART` at most from the slowest to
    the fastest, and between them straight lines, by the speed at which each force acts. That holds while the
    speed hardly changes as long as the rail remembers: within a lag τ a contact comes aτ²/2 further than
    such a kernel has it.

    Parameters
    ----------
    track : Track
        Of the rail.
    speed : float
        m/s, or an `asperity.speeds.SpeedCourse`.
    time_step : float
        s.
    places : array_like (n,)
        Of the contacts along the path, m.
    poles : int, optional
        As of `poles_or_kernel`.
    scattered : bool
        Whether kernels are scattered, not fitted by poles.
    cache : Store, optional
        Keeps kernels and poles.
    progress : callable, optional
        Is told parts done, parts in all and what is done.

    Returns
    -------
    RailBetween
    """
    low = slowest(speed)
    speeds = np.linspace(low, float(speed), math.ceil((speed - low) / SPEEDS_APART) + 1).tolist()
    rails = []
    for each in speeds:
        kernel = moving_kernel(track, each, time_step, cache=cache, progress=progress)
        direct = kernel if scattered else poles_or_kernel(kernel, poles, cache=cache)
        rails.append(rail_between(direct, places, cache=cache, progress=progress))
    return replace(rails[-1], slower=tuple(rails[:-1]))


def _fitted(
    direct: RailPoles | MovingKernel, kernel: MovingKernel, cache: Store | None
) -> RailPoles | MovingKernel:
    """The fewest poles that miss little, relative to the direct kernel; else the kernel itself."""
    weights = direct.kernel.weights
    for count in COUNTS if isinstance(direct, RailPoles) else ():
        if count <= most_poles(kernel.weights.shape[1]):
            fit = rail_poles(kernel, count, cache=cache)
            left = fit.missed()
            static = np.abs(left.sum(axis=1)).max() / np.abs(weights.sum(axis=1)).min()
            if max(np.linalg.norm(left) / np.linalg.norm(weights), static) <= TOLERANCE:
                return fit
    return kernel
