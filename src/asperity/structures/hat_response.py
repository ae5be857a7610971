"""Response of a track to a hat of force in time, from its receptance in frequency."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from asperity.structures.periodic_rail import PeriodicWaves
from asperity.structures.track import Track

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
        self.taps, self.time_step = taps, time_step
        period = 2 * taps * time_step
        self.shift = SHIFT / period
        self.omega = 2.0 * np.pi / period * np.arange(zones * taps + 1) - 1j * self.shift
        half = 0.5 * self.omega * time_step
        self.hat = (np.sin(half) / half) ** 2
        self.waves: PeriodicWaves = track.waves(self.omega)

    def response(self, spectra: NDArray[np.complex128]) -> NDArray[np.float64]:
        """Response to the hat at lags 0 … taps − 1 from receptances times the hat, (k, f) → (k, taps)."""
        n = self.taps
        response = fft.irfft(_folded(spectra, n), 2 * n, axis=1)[:, :n]
        return np.asarray(response * np.exp(self.shift * self.time_step * np.arange(n)))


def _folded(spectra: NDArray[np.complex128], n: int) -> NDArray[np.complex128]:
    """Sum over all frequencies that look alike at the time steps, up to half the sampling frequency."""
    folded = spectra[:, : n + 1].copy()
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
