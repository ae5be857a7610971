"""Response of a track to a hat of force in time, from its receptance in frequency."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import fft
from scipy.optimize import brentq

from asperity.structures.periodic_rail import PeriodicWaves
from asperity.structures.track import Track

ZONES = 4
"""Multiples of half the sampling frequency up to which the receptance near the contact is folded."""
SHIFT = 8.0
"""Exponential window over the period of the transform, neper, for tracks with viscous damping alone."""


class HatResponse:
    """From receptances to responses in time, on one grid of frequencies.

    Parameters
    ----------
    track : Track
        The track.
    time_step : float
        s.
    taps : int
        Number of lags; the period of the transform is twice that.
    zones : int
        Multiples of half the sampling frequency up to which receptances are folded.

    Attributes
    ----------
    omega : ndarray (f,)
        Angular frequencies at which receptances are wanted, rad/s; on ω − iσ for viscous damping alone.
    hat : ndarray (f,)
        Transform of the hat over the time step, sin²(ωΔt/2)/(ωΔt/2)².
    waves : PeriodicWaves
        Waves of the track at `omega`.
    """

    def __init__(self, track: Track, time_step: float, taps: int, zones: int) -> None:
        self.taps, self.time_step = taps, time_step
        self.causal = track.is_viscous and not track.rail_loss_factor
        step = np.pi / (taps * time_step)  # the period is twice the kernel
        self.shift = SHIFT / (2 * taps * time_step) if self.causal else 0.0
        self.omega = step * np.arange(0 if self.causal else 1, zones * taps + 1) - 1j * self.shift
        half = 0.5 * self.omega * time_step
        self.hat = (np.sin(half) / half) ** 2
        self.waves: PeriodicWaves = track.waves(self.omega)
        self.fade: NDArray[np.float64] | None = None
        if not self.causal:
            self.fade = _fade(self.omega.real, _fading_frequency(track, self.omega.real))

    def response(self, spectra: NDArray) -> NDArray[np.float64]:
        """Response to the hat at lags 0 … taps − 1 from receptances times the hat, (k, f) → (k, taps)."""
        n = self.taps
        if self.fade is None:
            response = fft.irfft(_folded(spectra, n), 2 * n, axis=1)[:, :n]
            return np.asarray(response * np.exp(self.shift * self.time_step * np.arange(n)))
        odd = np.zeros((len(spectra), spectra.shape[1] + 1), dtype=complex)
        odd[:, 1:] = 2j * self.fade * spectra.imag
        response = fft.irfft(_folded(odd, n), 2 * n, axis=1)[:, :n]
        # an odd signal says nothing about the rising half of the hat, an even one does
        static = (4.0 * spectra[:, 0].real - spectra[:, 1].real) / 3.0
        response[:, 0] = (static + 2.0 * spectra.real.sum(axis=1)) / (2 * n)
        return np.asarray(response)


def _folded(spectra: NDArray, n: int) -> NDArray:
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


def _fade(omega: NDArray, corner: float) -> NDArray[np.float64]:
    return np.asarray(omega**2 / (omega**2 + corner**2))


def _fading_frequency(track: Track, omega: NDArray) -> float:
    """Corner below which dissipation fades out so that the static deflection is exact, rad/s.

    By Kramers and Kronig the static receptance is −2/π ∫ Im G/ω dω; with loss factors that hold down to
    zero frequency, it would be too large.
    """
    middle = 0.5 * track.sleeper_spacing
    dissipative = -track.receptance(omega / (2.0 * np.pi), middle, middle).imag
    static, step = track.static_deflection(1.0, middle), omega[1] - omega[0]

    def excess(corner: float) -> float:
        return float(2.0 / np.pi * step * np.sum(dissipative * _fade(omega, corner) / omega) - static)

    if excess(step) <= 0.0:
        return float(step)
    return float(brentq(excess, step, omega[-1]))
