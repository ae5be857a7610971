"""Sound pressure beside the track while axles pass: sources along the rail over reflecting ground.

All sources are incoherent. Unless a `asperity.radiation.sound_path.SoundPath` says otherwise they radiate
evenly in all directions and stand on reflecting ground, so that p² = W ρc Q/(4π d²) with Q = 2 at a distance
d, and lie in the middle of the track.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import solve_banded
from scipy.special import exp1

from asperity.arguments import Array, ArrayLike, Complex
from asperity.errors import ComputationError
from asperity.radiation.track import IMPEDANCE
from asperity.spectra import level_of

if TYPE_CHECKING:
    from asperity.radiation.sound_path import SoundPath

DIRECTIVITY_FACTOR = 2.0
"""Q: all of the power goes above the ground."""
_FACTOR = IMPEDANCE * DIRECTIVITY_FACTOR / (4.0 * np.pi)  # of p² = W ρc Q/(4π d²)
_FAR = 40.0  # |z| from which exp(z) E1(z) follows its asymptotic series
_TERMS = 20
_STEPS = 25  # of a record, per distance of the receiver


@dataclass(frozen=True)
class Receiver:
    """Distance from the middle of the track, height above the rail head, m; by default of ISO 3095:2013."""

    distance: float = 7.5
    height: float = 1.2

    def shortest(self, height: float) -> float:
        """Distance, m, from a source of this height above the rail head, m, that is just opposite."""
        return float(np.hypot(self.distance, self.height - height))


@dataclass(frozen=True, eq=False)
class AxleSource:
    """What one axle makes radiate: its wheels, or the track around them.

    Parameters
    ----------
    power : ndarray (..., b)
        Sound power in each band, W.
    length : array_like (b,) or float
        Along the rail, m: the power is spread as exp(−2|ξ|/ℓ)/ℓ, ξ from the axle. Of a wave with the decay
        rate Δ, dB/m, ℓ is 8.686/Δ. Zero for a source in one place.
    height : float
        Above the rail head, m.
    """

    power: Array
    length: ArrayLike = 0.0
    height: float = 0.0


@dataclass(frozen=True, eq=False)
class Passage:
    """Axles that pass at one speed; time zero is when the first of them is opposite the receiver.

    Parameters
    ----------
    axles : sequence of float
        Distances behind the first axle, m, rising from zero.
    speed : float
        m/s.
    length : float, optional
        Of the whole train, m, equally far beyond both outer axles. Without it half a mean distance of the
        axles is added at each end; one axle alone has no length then.
    """

    axles: Sequence[float]
    speed: float
    length: float | None = None

    @property
    def passed(self) -> tuple[float, float] | None:
        """Times, s, at which front and rear of the train are opposite the receiver; None without a length."""
        last, count = float(self.axles[-1]), len(self.axles)
        if self.length is None and count == 1:
            return None
        length = last * count / (count - 1) if self.length is None else self.length
        beyond = 0.5 * (length - last)
        return -beyond / self.speed, (last + beyond) / self.speed

    def times(self, receiver: Receiver, longest: float = 0.0) -> Array:
        """Times (t,), s, evenly spaced, of a record in which the level rises and falls by more than 10 dB.

        `longest` is the greatest length of a source, m.
        """
        start, end = self.passed or (0.0, 0.0)
        beyond = -start * self.speed
        lead = 10.0 * receiver.distance + 3.0 * longest + 3.0 * beyond  # at 1/d² −10 dB are at 2.2 `beyond`
        first, last = start * self.speed - lead, end * self.speed + lead
        count = int(np.ceil((last - first) / receiver.distance * _STEPS)) + 1
        return np.linspace(first, last, count) / self.speed


def divergence(length: float, distance: float, along: ArrayLike) -> Array:
    """Mean of 1/d² over a source that is spread along the rail, 1/m².

    Parameters
    ----------
    length : float
        ℓ of the source, m, spread as exp(−2|ξ|/ℓ)/ℓ around its middle; zero for one place.
    distance : float
        From the line of the source, m.
    along : array_like
        Place of its middle along the line, m from the point opposite the receiver.

    Returns
    -------
    ndarray
        Of the shape of `along`.

    Notes
    -----
    ∫ exp(−2|ξ|/ℓ)/(d² + (s + ξ)²) dξ/ℓ, exact: with 1/(d² + u²) = Im 1/(u − id)/d it is
    Im [g(2(s − id)/ℓ) + g(2(−s − id)/ℓ)]/(ℓ d), g(z) = exp(z) E₁(z).
    """
    s = np.asarray(along, dtype=float)
    if length == 0.0:
        return np.asarray(1.0 / (distance**2 + s**2))
    ahead, behind = (_scaled_exp1(2.0 / length * (each - 1j * distance)) for each in (s, -s))
    return np.asarray((ahead + behind).imag / (length * distance))


def squared_pressure(
    source: AxleSource, passage: Passage, receiver: Receiver, time: ArrayLike, path: "SoundPath | None" = None
) -> Array:
    """Mean square sound pressure (..., b, t), Pa², of what all axles make radiate, at times (t,), s.

    On a path with the bands of the source, where one is given.
    """
    spread = _divergences(source, passage, receiver, np.asarray(time, dtype=float), path)
    return _FACTOR * np.asarray(source.power, dtype=float)[..., None] * spread


def exposure(
    source: AxleSource, passage: Passage, receiver: Receiver, path: "SoundPath | None" = None
) -> Array:
    """Integral of the squared sound pressure over the whole passage (..., b), Pa² s: W ρc Q/(4 d v) per axle.

    However far the power is spread along the rail; on a path with its integral in place of π/d.
    """
    if path is not None:
        share = len(passage.axles) / passage.speed * path.integral(source.height)
        return _FACTOR * share * np.asarray(source.power, dtype=float)
    crossing = 4.0 * receiver.shortest(source.height) * passage.speed
    return 4.0 * np.pi * _FACTOR * len(passage.axles) / crossing * np.asarray(source.power, dtype=float)


def _divergences(
    source: AxleSource, passage: Passage, receiver: Receiver, time: Array, path: "SoundPath | None"
) -> Array:
    """Sum of `divergence` over the axles (b, t), 1/m², of each band's length."""
    bands = np.shape(source.power)[-1:]
    lengths = np.broadcast_to(np.asarray(source.length, dtype=float), bands)
    distance = receiver.shortest(source.height)
    first = passage.speed * float(time.min()) - float(passage.axles[-1])
    last = passage.speed * float(time.max())
    farthest = max(-first, last)  # the same on either side
    grid = np.linspace(0.0, farthest, 2 * int(np.ceil(farthest / receiver.distance * _STEPS)) + 2)
    places = [np.abs(passage.speed * time - at) for at in passage.axles]
    if path is None:
        spread = np.stack([divergence(length, distance, grid) for length in lengths.tolist()])
    else:
        spread = path.spread(source.height, lengths, grid)
    return np.stack([np.sum([np.interp(each, grid, one) for each in places], axis=0) for one in spread])


def _scaled_exp1(z: Complex) -> Complex:
    """exp(z) E₁(z), off the negative real axis."""
    far = np.abs(z) > _FAR
    found = np.empty(z.shape, dtype=complex)
    found[~far] = np.exp(z[~far]) * exp1(z[~far])
    inverse = 1.0 / z[far]
    term = total = inverse
    for n in range(1, _TERMS + 1):
        term = -n * inverse * term
        total = total + term
    found[far] = total
    return found


REFERENCE_PRESSURE = 20e-6
"""Pa."""
FAST = 0.125
"""Time constant of time weighting F, s (IEC 61672-1)."""
DROP = 10.0
"""What the level has risen by, and falls by, in the measurement time of TEL, dB (ISO 3095:2013)."""


@dataclass(frozen=True, eq=False)
class PassByLevels:
    """Levels of a pass-by by source, dB re 20 µPa, (s,) each; NaN where the train has no length."""

    maximum: Array  # L_pAFmax, with time weighting F
    equivalent: Array  # L_pAeq,Tp, from when the front is opposite to when the rear is
    transit_exposure: Array  # TEL: the energy of the whole measured time, over Tp


def pass_by_levels(time: ArrayLike, squared: ArrayLike, passed: tuple[float, float] | None) -> PassByLevels:
    """Levels of a pass-by by source, of which the last is the whole.

    Parameters
    ----------
    time : array_like (t,)
        s, evenly spaced.
    squared : array_like (s, t)
        Squared sound pressure of each source, A-weighted, Pa²; the last decides what time is measured.
    passed : tuple of float, optional
        Times at which front and rear of the train are opposite, s; without them there is a maximum only.

    Returns
    -------
    PassByLevels

    Raises
    ------
    ComputationError
        If the record does not rise and fall by 10 dB.

    Notes
    -----
    TEL is 10 lg (1/Tp) ∫ p_A²/p_0² dt from when the level lies 10 dB below that of the front just opposite to
    when it lies 10 dB below that of the rear (ISO 3095:2013). No time weighting enters it.
    """
    instants, parts = np.asarray(time, dtype=float), np.asarray(squared, dtype=float)
    step = float(instants[-1] - instants[0]) / (len(instants) - 1)
    maximum = pressure_level(time_weighted(parts, step).max(axis=-1))
    if passed is None:
        unknown = np.full(maximum.shape, np.nan)
        return PassByLevels(maximum, unknown, unknown)
    duration = passed[1] - passed[0]
    measured = _measured(instants, parts[-1], passed)
    equivalent, exposed = (integral(instants, parts, *each) / duration for each in (passed, measured))
    return PassByLevels(maximum, pressure_level(equivalent), pressure_level(exposed))


def time_weighted(squared: ArrayLike, step: float, time_constant: float = FAST) -> Array:
    """Squared pressure (..., t), Pa², with exponential time weighting, by default F.

    Exact for a squared pressure that is linear between its samples, `step` apart, s; it is steady before.
    """
    values = np.asarray(squared, dtype=float)
    kept = np.exp(-step / time_constant)
    mean = -np.expm1(-step / time_constant) * time_constant / step
    forced = (1.0 - mean) * values
    forced[..., 1:] += (mean - kept) * values[..., :-1]
    forced[..., 0] = values[..., 0]  # steady before
    bands = np.stack([np.ones(values.shape[-1]), np.full(values.shape[-1], -kept)])
    found = solve_banded((1, 0), bands, forced.reshape(-1, values.shape[-1]).T)  # y_n − kept y_n−1 = forced
    return np.asarray(found.T.reshape(values.shape))


def pressure_level(squared: ArrayLike) -> Array:
    """Level of a squared sound pressure, Pa², in dB re 20 µPa."""
    return level_of(np.asarray(squared, dtype=float) / REFERENCE_PRESSURE**2)


def _measured(time: Array, whole: Array, passed: tuple[float, float]) -> tuple[float, float]:
    """Times before the front and after the rear at which the level has fallen by `DROP`."""
    limits = np.interp(passed, time, whole) * 10.0 ** (-DROP / 10.0)
    before = np.flatnonzero((time < passed[0]) & (whole < limits[0]))
    after = np.flatnonzero((time > passed[1]) & (whole < limits[1]))
    if not before.size or not after.size:
        problem = f"the level does not fall by {DROP:g} dB before and after the train"
        between = f"between {time[0]:.3g} s and {time[-1]:.3g} s"
        raise ComputationError(f"{problem} {between}", "a record that begins earlier and ends later")
    rise, fall = (slice(at, at + 2) for at in (before[-1], after[0] - 1))
    start = np.interp(limits[0], whole[rise], time[rise])
    end = np.interp(-limits[1], -whole[fall], time[fall])
    return float(start), float(end)


def integral(time: Array, squared: Array, start: float, end: float) -> Array:
    """Integral from a start to an end of what (s, t) is linear between its samples, (s,)."""
    nodes = np.concatenate([[start], time[(time > start) & (time < end)], [end]])
    return np.trapezoid([np.interp(nodes, time, one) for one in squared], nodes, axis=1)
