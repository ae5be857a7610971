"""What lies between a bearing and its record: a path to the sensor, measured or drawn, and noise."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np

from asperity.arguments import Array, ArrayLike, file_path, finite_array, floats, positive, require, shown
from asperity.errors import InputError
from asperity.studies.draws import Span
from asperity.studies.recorded import read_columns, read_signal
from asperity.studies.times import clock_of, rate_beside
from asperity.units import quantity, unit_in
from asperity.written_numbers import rounded

MOST_TERMS = 10_000
"""Largest number in the ratio of two sampling rates, which is taken as one of whole numbers."""
_RESONANCES = re.compile(r"(.*[^,\s])\s*,\s*(\d{1,2})\s*resonances?\s*")
DAMPING = (0.01, 0.05)
"""Damping ratios between which those of drawn resonances are, in equal ratios: chosen."""
FINER = 8
"""Samples of the impulse response of such a path in one of the signal."""
DIED_AWAY = 9.2
"""Time constants after which it is cut off: at 1/10 000."""
MOST_LEVEL = 200.0  # dB


@dataclass(frozen=True, eq=False)
class MeasuredPath:
    """A path whose impulse response was measured: weights (m,) and their rate, Hz."""

    weights: Array
    rate: float

    @property
    def content(self) -> list[Any]:
        """What decides of it."""
        return [self.weights, self.rate]

    def behind(self, signal: Array, rate: float, random: np.random.Generator) -> Array:
        """Signals (sensors, n) of a rate, Hz, behind it."""
        return np.stack([through_path(each, rate, self.weights, self.rate) for each in signal])


@dataclass(frozen=True)
class DrawnPath:
    """A path with so many resonances, whose frequencies, Hz, are drawn from a span for each signal.

    Masses on springs side by side, which carry the sensor together: ``H(f) = Σ w_k (1 + 2iζ_k f/f_k)/(1 −
    f²/f_k² + 2iζ_k f/f_k)``, with equal chances of all weights ``w_k`` of sum one, so that slow motion passes
    as it is.
    """

    span: Span
    count: int

    @property
    def content(self) -> list[Any]:
        """What decides of it."""
        return [self.span.low, self.span.high, self.span.in_ratios, self.count]

    def behind(self, signal: Array, rate: float, random: np.random.Generator) -> Array:
        """Signals (sensors, n) of a rate, Hz, behind it."""
        received = f"resonances up to {rounded(self.span.high, 4)} Hz"
        allowed = f"below half of the sampling rate, {rounded(0.5 * rate, 4)} Hz"
        require(self.span.high < 0.5 * rate, "path of the signals", received, allowed)
        natural = 2.0 * np.pi * np.array([self.span.drawn(random) for _ in range(self.count)])
        ratios = DAMPING[0] * (DAMPING[1] / DAMPING[0]) ** random.random(self.count)
        shares = random.dirichlet(np.ones(self.count))
        weights = resonant_response(natural, ratios, shares, FINER * rate, signal.shape[1] / rate)
        return np.stack([through_path(each, rate, weights, FINER * rate) for each in signal])


def resonant_response(natural: Array, ratios: Array, shares: Array, rate: float, longest: float) -> Array:
    """Weights of a filter at a rate, Hz, that is masses on springs side by side.

    Natural frequencies (k,), rad/s, damping ratios (k,) and shares (k,) of them; no longer than a time, s.
    """
    decay = ratios * natural
    time = np.arange(ceil(min(DIED_AWAY / decay.min(), longest) * rate)) / rate
    damped = natural * np.sqrt(1.0 - ratios**2)
    phase = np.multiply.outer(time, damped)
    along = 2.0 * decay * np.cos(phase) + (natural**2 - 2.0 * decay**2) / damped * np.sin(phase)
    response = (along * np.exp(-np.multiply.outer(time, decay))) @ shares
    response[0] *= 0.5  # it begins with a jump, between whose ends the first sample lies
    return response / rate


def path_to_sensor(given: Any, rate: str | float | None) -> MeasuredPath | DrawnPath | None:
    """Path to a sensor by a file with its impulse response, or by ``"1..6 kHz, 3 resonances"``."""
    allowed = "the file with the response"
    require(rate is None or given is not None, "sampling rate of the path", "a rate without a path", allowed)
    if given is None:
        return None
    drawn = _RESONANCES.fullmatch(given) if isinstance(given, str) else None
    if drawn is not None:
        what = "path of the signals"
        span = Span.read(what, drawn[1])
        example = "1..6 kHz, 3 resonances"
        if span is None or rate is not None or int(drawn[2]) < 1:
            raise InputError(what, shown(given), f"resonances as '{example}', without a rate of the path")
        in_hertz = span.in_si("Hz")
        require(in_hertz.low > 0.0 and in_hertz.high > 0.0, what, shown(given), "frequencies above zero")
        return DrawnPath(in_hertz, int(drawn[2]))
    return MeasuredPath(*_response(file_path("path to the sensor", given, "the path of a file"), rate))


def _response(file: Path, rate: str | float | None) -> tuple[Array, float]:
    """Impulse response of a file, and its sampling rate, Hz."""
    rate = quantity(rate, "Hz") if isinstance(rate, str) else rate
    if rate is not None or file.suffix.lower() == ".wav":
        return read_signal(file, rate)
    values, titles, stated, _ = read_columns(file, None)
    if stated and values.ndim == 1:
        return floats(values), stated
    received = f"an array of shape {values.shape}"
    allowed = "a column of times (s), then the response"
    columns = values.ndim == 2 and values.shape[1] == 2
    require(columns, file.name, received, allowed, "Or give the sampling rate.")
    times = clock_of(values, titles or ["time (s)", ""], file.name)
    even = times.rate if times and not times.gaps else None
    return floats(values[:, 1]), rate_beside(None, even, file.name)


@dataclass(frozen=True)
class Noise:
    """White noise of a level that is given, or drawn from a span for each signal."""

    span: Span | float
    is_level: bool  # dB below the rms of the signal; else it is the rms, m/s2

    @property
    def content(self) -> list[Any]:
        """What decides of it."""
        span = self.span
        ends = [span.low, span.high, span.in_ratios] if isinstance(span, Span) else [span]
        return [*ends, self.is_level]

    def level(self, random: np.random.Generator) -> float:
        """Draw its level."""
        return self.span.drawn(random) if isinstance(self.span, Span) else self.span


def noise_of(given: Any) -> Noise | None:
    """Noise by its words: ``"20 dB"``, ``"0.5 m/s^2"``, or a span, ``"0..30 dB"``."""
    if given is None:
        return None
    what = "noise of the signals"
    received = shown(given)
    allowed = "a level as '20 dB', or an rms above 0 as '0.5 m/s^2', or a span of one as '0..30 dB'"
    try:
        span = Span.read(what, given)
        is_level = (span.unit if span else unit_in(given)) == "dB"
        unit = "dB" if is_level else "m/s^2"
        found = span.in_si(unit) if span else quantity(given, unit)
    except (InputError, TypeError):
        raise InputError(what, received, allowed) from None
    ends = [found.low, found.high] if isinstance(found, Span) else [found]
    right = max(map(abs, ends)) <= MOST_LEVEL if is_level else 0.0 < min(ends) <= max(ends) < np.inf
    require(right, what, received, f"{allowed}, within ±{MOST_LEVEL:g} dB")
    return Noise(found, is_level)


def through_path(signal: ArrayLike, rate: float, response: ArrayLike, response_rate: float) -> Array:
    """Signal behind a path whose impulse response was measured, at whatever sampling rate.

    Parameters
    ----------
    signal : array_like (n,)
        In any unit.
    rate : float
        Its samples per second, Hz.
    response : array_like (m,)
        Weights of a filter at its own sampling rate: 1 alone leaves the signal as it is. What was measured
        in 1/s is divided by its sampling rate. No longer than the signal.
    response_rate : float
        Samples per second of the response, Hz.

    Returns
    -------
    ndarray (n,)
        In the unit of the signal times that of the response; it starts from rest.

    Notes
    -----
    The transfer function ``H(f) = Σ h_k exp(−2πi f k/response_rate)`` is taken at the frequencies of the
    signal itself, so that nothing is lost by resampling. Above half of `response_rate` nothing is known of
    the path, and nothing passes.

    Examples
    --------
    >>> from asperity.studies.sensor_path import through_path
    >>> through_path([1.0, 0.0, 0.0, 0.0], 8e3, [0.5, 0.25], 8e3).round(12).tolist()
    [0.5, 0.25, 0.0, 0.0]
    """
    from scipy.fft import irfft, next_fast_len, rfft

    values = finite_array("signal", signal, "a series of finite numbers", shape=(None,))
    weights = finite_array("impulse response", response, "a series of finite numbers", shape=(None,))
    rates = positive("sampling rate (Hz)", rate), positive("sampling rate of the path (Hz)", response_rate)
    ratio = Fraction(rates[0] / rates[1]).limit_denominator(MOST_TERMS)
    received = f"{rates[0]:g} and {rates[1]:g} Hz"
    allowed = f"up to {MOST_TERMS} times apart"
    require(0 < ratio < MOST_TERMS, "sampling rates of the signal and the path", received, allowed)
    received = f"{weights.size / rates[1]:.4g} s"
    allowed = f"above 0, and at most {values.size / rates[0]:.4g} s, as the signal"
    remedy = "Cut it where it has died away."
    require(0 < weights.size * ratio <= values.size, "impulse response", received, allowed, remedy)
    ours, theirs = ratio.as_integer_ratio()  # samples of the same time
    pieces = next_fast_len(ceil((values.size + weights.size * ratio) / ours), real=True)
    lines = rfft(values, pieces * ours)
    transfer = rfft(weights, pieces * theirs)
    known = min(lines.size, transfer.size)
    return irfft(lines[:known] * transfer[:known], pieces * ours)[: values.size]


def with_noise(
    signal: ArrayLike, seed: int | Sequence[int], *, below: float | None = None, rms: float | None = None
) -> Array:
    """Signal with white noise of a normal distribution.

    Parameters
    ----------
    signal : array_like (n,)
        In any unit.
    seed : int or sequence of int
        Of the noise: the same seed makes the same noise.
    below : float
        Level by which the rms of the noise lies below that of the signal, less its mean, dB; or
    rms : float
        Rms of the noise, in the unit of the signal.

    Returns
    -------
    ndarray (n,)

    Examples
    --------
    >>> import numpy as np
    >>> from asperity.studies.sensor_path import with_noise
    >>> sine = np.sin(np.arange(10_000))
    >>> noise = with_noise(sine, 1, below=20.0) - sine
    >>> bool(abs(noise.std() / sine.std() - 0.1) < 0.002)
    True
    """
    values = finite_array("signal", signal, "a series of finite numbers", shape=(None,))
    require((below is None) != (rms is None), "level of the noise", "both or none", "one of below and rms")
    spread = rms or 0.0 if below is None else float(values.std()) * 10.0 ** (-below / 20.0)
    return values + spread * np.random.default_rng(seed).standard_normal(values.size)
