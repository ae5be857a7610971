"""Sound pressure beside the track while axles pass: sources along the rail over reflecting ground.

All sources are incoherent, radiate evenly in all directions and stand on reflecting ground, so that
p² = W ρc Q/(4π d²) with Q = 2 at a distance d. They lie in the middle of the track.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import exp1

from asperity.errors import InputError
from asperity.radiation.air import IMPEDANCE

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

    def __post_init__(self) -> None:
        _check("distance of the receiver (m)", self.distance, above=0.0)
        _check("height of the receiver (m)", self.height)

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

    Raises
    ------
    InputError
        If a power or a length is negative, or something is not finite.
    """

    power: NDArray[np.float64]
    length: ArrayLike = 0.0
    height: float = 0.0

    def __post_init__(self) -> None:
        for what, values in (("sound power (W)", self.power), ("length of a source (m)", self.length)):
            given = np.asarray(values, dtype=float)
            if not (np.isfinite(given) & (given >= 0.0)).all():
                raise InputError(what, float(np.min(given)), "finite numbers, zero or more")
        _check("height of a source (m)", self.height)


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

    Raises
    ------
    InputError
        If the axles do not rise from zero, or speed or length are not possible.
    """

    axles: Sequence[float]
    speed: float
    length: float | None = None

    def __post_init__(self) -> None:
        at = np.asarray(self.axles, dtype=float)
        if (
            at.ndim != 1
            or not at.size
            or at[0] != 0.0
            or not (np.isfinite(at).all() and (np.diff(at) > 0).all())
        ):
            raise InputError("axles (m)", list(self.axles), "positions that rise from 0 m, the first axle")
        _check("speed (m/s)", self.speed, above=0.0)
        if self.length is not None:
            _check("length of the train (m)", self.length, above=0.0)
            if self.length < at[-1]:
                raise InputError(
                    "length of the train (m)", self.length, f"at least that over its axles, {at[-1]:g}"
                )

    @property
    def passed(self) -> tuple[float, float] | None:
        """Times, s, at which front and rear of the train are opposite the receiver; None without a length."""
        last, count = float(self.axles[-1]), len(self.axles)
        if self.length is None and count == 1:
            return None
        length = last * count / (count - 1) if self.length is None else self.length
        beyond = 0.5 * (length - last)
        return -beyond / self.speed, (last + beyond) / self.speed

    def times(self, receiver: Receiver, longest: float = 0.0) -> NDArray[np.float64]:
        """Times (t,), s, evenly spaced, of a record in which the level rises and falls by more than 10 dB.

        `longest` is the greatest length of a source, m.
        """
        start, end = self.passed or (0.0, 0.0)
        beyond = -start * self.speed
        lead = 10.0 * receiver.distance + 3.0 * longest + 3.0 * beyond  # at 1/d² −10 dB are at 2.2 `beyond`
        first, last = start * self.speed - lead, end * self.speed + lead
        count = int(np.ceil((last - first) / receiver.distance * _STEPS)) + 1
        return np.linspace(first, last, count) / self.speed


def divergence(length: float, distance: float, along: ArrayLike) -> NDArray[np.float64]:
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
    source: AxleSource, passage: Passage, receiver: Receiver, time: ArrayLike
) -> NDArray[np.float64]:
    """Mean square sound pressure (..., b, t), Pa², of what all axles make radiate, at times (t,), s."""
    spread = _divergences(source, passage, receiver, np.asarray(time, dtype=float))
    return _FACTOR * np.asarray(source.power, dtype=float)[..., None] * spread


def weighted_squared_pressure(
    source: AxleSource, passage: Passage, receiver: Receiver, time: ArrayLike, weights: ArrayLike
) -> NDArray[np.float64]:
    """The sum over the bands of `squared_pressure`, each with a weight (b,): (..., t), Pa²."""
    spread = _divergences(source, passage, receiver, np.asarray(time, dtype=float))
    power = np.asarray(source.power, dtype=float) * np.asarray(weights, dtype=float)
    return _FACTOR * np.asarray(power @ spread)


def exposure(source: AxleSource, passage: Passage, receiver: Receiver) -> NDArray[np.float64]:
    """Integral of the squared sound pressure over the whole passage (..., b), Pa² s: W ρc Q/(4 d v) per axle.

    However far the power is spread along the rail.
    """
    crossing = 4.0 * receiver.shortest(source.height) * passage.speed
    return 4.0 * np.pi * _FACTOR * len(passage.axles) / crossing * np.asarray(source.power, dtype=float)


def _divergences(
    source: AxleSource, passage: Passage, receiver: Receiver, time: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Sum of `divergence` over the axles (b, t), 1/m², of each band's length."""
    bands = np.shape(source.power)[-1:]
    lengths = np.broadcast_to(np.asarray(source.length, dtype=float), bands).tolist()
    distance = receiver.shortest(source.height)
    first = passage.speed * float(time.min()) - float(passage.axles[-1])
    last = passage.speed * float(time.max())
    farthest = max(-first, last)  # the same on either side
    grid = np.linspace(0.0, farthest, 2 * int(np.ceil(farthest / receiver.distance * _STEPS)) + 2)
    heard: dict[float, NDArray[np.float64]] = {}  # those of a wheel have one length in all bands
    for length in set(lengths):
        one = divergence(length, distance, grid)
        places = (np.abs(passage.speed * time - at) for at in passage.axles)
        heard[length] = np.sum([np.interp(each, grid, one) for each in places], axis=0)
    return np.stack([heard[length] for length in lengths])


def _scaled_exp1(z: NDArray[np.complex128]) -> NDArray[np.complex128]:
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


def _check(what: str, value: float, above: float = -np.inf) -> None:
    if not (np.isfinite(value) and value > above):
        raise InputError(what, value, "a finite number" if above == -np.inf else "a finite positive number")
