"""What lies between a machine and its record: a measured path to the sensor, and noise."""

from collections.abc import Sequence
from fractions import Fraction
from math import ceil

import numpy as np

from asperity.arguments import Array, ArrayLike, finite_array, positive, require

MOST_TERMS = 10_000
"""Largest number in the ratio of two sampling rates, which is taken as one of whole numbers."""


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
    >>> from asperity.sensing import through_path
    >>> through_path([1.0, 0.0, 0.0, 0.0], 8e3, [0.5, 0.25], 8e3).round(12).tolist()
    [0.5, 0.25, 0.0, 0.0]
    """
    from scipy.fft import irfft, next_fast_len, rfft

    values = finite_array("signal", signal, "a series of finite numbers", shape=(None,))
    weights = finite_array("impulse response", response, "a series of finite numbers", shape=(None,))
    rates = positive("sampling rate (Hz)", rate), positive("sampling rate of the path (Hz)", response_rate)
    ratio = Fraction(rates[0] / rates[1]).limit_denominator(MOST_TERMS)
    received, allowed = f"{rates[0]:g} and {rates[1]:g} Hz", f"up to {MOST_TERMS} times apart"
    require(0 < ratio < MOST_TERMS, "sampling rates of the signal and the path", received, allowed)
    received = f"{weights.size / rates[1]:.4g} s"
    allowed = f"above 0, and at most {values.size / rates[0]:.4g} s, as the signal"
    remedy = "Cut it where it has died away."
    require(0 < weights.size * ratio <= values.size, "impulse response", received, allowed, remedy)
    ours, theirs = ratio.as_integer_ratio()  # samples of the same time
    pieces = next_fast_len(ceil((values.size + weights.size * ratio) / ours), real=True)
    lines, transfer = rfft(values, pieces * ours), rfft(weights, pieces * theirs)
    known = min(lines.size, transfer.size)
    return np.asarray(irfft(lines[:known] * transfer[:known], pieces * ours)[: values.size])


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
    >>> from asperity.sensing import with_noise
    >>> sine = np.sin(np.arange(10_000))
    >>> noise = with_noise(sine, 1, below=20.0) - sine
    >>> bool(abs(noise.std() / sine.std() - 0.1) < 0.002)
    True
    """
    values = finite_array("signal", signal, "a series of finite numbers", shape=(None,))
    require((below is None) != (rms is None), "level of the noise", "both or none", "one of below and rms")
    spread = rms or 0.0 if below is None else float(values.std()) * 10.0 ** (-below / 20.0)
    return np.asarray(values + spread * np.random.default_rng(seed).standard_normal(values.size))
