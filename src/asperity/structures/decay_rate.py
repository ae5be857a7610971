"""Decay rate of the vertical vibration along a track."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.errors import InputError
from asperity.structures.track import Track

# EN 15461:2008, measuring points in sleeper bays from the force
EN_15461_BAYS = (
    0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.25, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0, 7.0, 8.0,
    10.0, 12.0, 16.0, 20.0, 24.0, 30.0, 36.0, 42.0, 48.0, 54.0, 66.0,
)  # fmt: skip


def decay_rate(track: Track, frequency: ArrayLike) -> NDArray[np.float64]:
    """Decay rate, dB/m, of the wave that reaches farthest, from its change over one bay; frequencies in Hz.

    -20 lg|lambda|/L of the larger multiplier.
    """
    frequency = _positive(frequency)
    largest = np.abs(track.waves(2.0 * np.pi * frequency.ravel()).multipliers).max(axis=0)
    return (-20.0 * np.log10(largest) / track.sleeper_spacing).reshape(frequency.shape)


def decay_rate_en15461(track: Track, frequency: ArrayLike) -> NDArray[np.float64]:
    """Decay rate, dB/m, as a measurement by EN 15461 finds it, force at mid-span; frequencies in Hz.

    It differs from `decay_rate` as measurements do: the near field at the force raises it, up to twofold for
    an Euler-Bernoulli rail, and 66 bays bound it from below.
    """
    frequency = _positive(frequency)
    waves = track.waves(2.0 * np.pi * frequency.ravel())
    force = 0.5 * track.sleeper_spacing
    distances = track.sleeper_spacing * np.array(EN_15461_BAYS)
    responses = np.array([waves.receptance(force + distance, force) for distance in distances])
    return decay_rate_of_responses(distances, np.abs(responses)).reshape(frequency.shape)


def decay_rate_of_responses(distances: ArrayLike, responses: ArrayLike) -> NDArray[np.float64]:
    """Decay rate, dB/m, of responses (n, ...) at distances (n,) from the force, m, EN 15461.

    4.343/sum(|A_n|^2/|A_0|^2 Delta x_n), with magnitudes in any unit and distances that ascend from zero. EN
    15461:2008: Delta x_n reaches half way to the neighbours; the first interval starts at the force, the last
    is symmetric about its point.
    """
    distances = np.asarray(distances, dtype=float)
    if distances.ndim != 1 or len(distances) < 2 or distances[0] != 0.0 or np.any(np.diff(distances) <= 0.0):
        raise InputError("distances from the force (m)", distances, "two or more, ascending from zero")
    middles = 0.5 * (distances[1:] + distances[:-1])
    edges = np.concatenate([[0.0], middles, [2.0 * distances[-1] - middles[-1]]])
    energy = np.abs(np.asarray(responses)) ** 2
    return 10.0 * np.log10(np.e) / np.tensordot(np.diff(edges), energy / energy[0], axes=1)


def _positive(frequency: ArrayLike) -> NDArray[np.float64]:
    frequency = np.asarray(frequency, dtype=float)
    if not (np.all(np.isfinite(frequency)) and np.all(frequency > 0.0)):
        raise InputError("frequency (Hz)", np.min(frequency), "finite positive numbers")
    return frequency
