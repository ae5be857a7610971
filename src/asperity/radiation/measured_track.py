"""What a hammer finds on a track in one-third octaves, measured or computed; and what follows for sound."""

from dataclasses import dataclass, replace

import numpy as np

from asperity.arguments import Array, ArrayLike, Complex, NDArray
from asperity.spectra import HALF_BAND
from asperity.structures.track import Track, decay_rate_en15461

LINES = 64
"""Frequencies in a band: they resolve the resonance of a rail whose loss factor is 1 %."""


@dataclass(frozen=True, eq=False)
class HammerTest:
    """Decay rates by EN 15461 and point mobility at mid-span of a track, in one-third octaves.

    Parameters
    ----------
    frequency : ndarray (b, n)
        Lines in each band, Hz.
    decay_rate : ndarray (b,)
        Vertical, dB/m; NaN in bands without one.
    mobility : ndarray (b, n)
        (m/s)/N, e^{+iωt}; NaN in bands without one.

    Notes
    -----
    EN 15461 makes a decay rate of the sum over one side of the rail, Δ = 4.343/Σ(|A_n|²/|A_0|² Δx_n), where
    4.343 = 10/ln 10. On both sides, then, ∫|v|² dx = |v_0|² · 2 · 4.343/Δ. At the force the rail moves by
    v_0 = Y h/(α_W + α_C + α_R) of a texture h, α_R = Y/iω: on a softer rail the force is smaller.
    """

    frequency: Array
    decay_rate: Array
    mobility: Complex

    @classmethod
    def of_track(cls, track: Track, band: ArrayLike) -> "HammerTest":
        """What the test would find on a computed track, in bands by their centres (b,), Hz.

        Responses are summed over the band before they are compared: 1/Δ is a mean that is weighted with the
        squared mobility.
        """
        centre = np.atleast_1d(np.asarray(band, dtype=float))
        steps = (np.arange(LINES) + 0.5) / LINES
        frequency = centre[:, None] * HALF_BAND ** (2.0 * steps - 1.0)
        half, lines = float(track.mid_spans[0]), frequency.ravel()
        mobility = 2j * np.pi * frequency * track.receptance(lines, half, half).reshape(frequency.shape)
        lengths = 1.0 / decay_rate_en15461(track, lines).reshape(frequency.shape)
        rate = 1.0 / np.average(lengths, axis=1, weights=np.abs(mobility) ** 2)
        return cls(frequency, rate, mobility)

    def measured(
        self, decay_rates: tuple[Array, Array] | None, mobility: tuple[Array, NDArray[np.inexact]] | None
    ) -> "HammerTest":
        """What was measured, in the bands of this test of the computed track.

        Decay rates in one-third octaves by their centres, dB/m; mobility over frequencies that rise, Hz,
        (m/s)/N: its phase is that of the computed track if magnitudes are given alone.
        """
        found = np.full(self.frequency.shape, np.nan + 0j)
        rate = np.full(len(found), np.nan)
        if decay_rates is not None:
            rate = in_bands(self.centre, *decay_rates)
        if mobility is not None:
            at, given = mobility
            held = (self.frequency[:, -1] > at[0]) & (self.frequency[:, 0] < at[-1])
            found[held] = _interpolated(self.frequency[held], at, given)
            if not np.iscomplexobj(given):
                found *= np.exp(1j * np.angle(self.mobility))
        return replace(self, decay_rate=rate, mobility=found)

    @property
    def centre(self) -> Array:
        """Of the bands (b,), Hz."""
        return np.sqrt(self.frequency[:, 0] * self.frequency[:, -1])

    @property
    def rms_mobility(self) -> Array:
        """Root mean square over each band (b,), (m/s)/N."""
        return np.sqrt(np.mean(np.abs(self.mobility) ** 2, axis=1))

    def driven(self, other: Complex) -> Array:
        """Mean square velocity at the contact per height of the texture (b,), (m/s)²/m².

        Receptance of wheel and contact spring together, m/N, at the lines (b, n).
        """
        receptance = self.mobility / (2j * np.pi * self.frequency)
        with np.errstate(invalid="ignore"):  # where none was measured
            return np.asarray(np.mean(np.abs(self.mobility / (other + receptance)) ** 2, axis=1))

    def longer(self, computed: "HammerTest") -> Array:
        """Length of the rail that radiates over that computed (b,); one where no decay rate was measured."""
        return np.nan_to_num(computed.decay_rate / self.decay_rate, nan=1.0)

    def louder(self, computed: "HammerTest", other: Complex) -> Array:
        """Mean square velocity at the contact over that computed (b,); one where no mobility was measured.

        With the linear contact's force: the other receptance as in `driven`.
        """
        return np.nan_to_num(self.driven(other) / computed.driven(other), nan=1.0)


def in_bands(band: Array, centres: Array, values: Array) -> Array:
    """Values of one-third octaves in bands (b,), both by their centres; NaN in those without one."""
    numbers, own = (np.rint(10.0 * np.log10(each)) for each in (band, centres))
    found = np.full(len(band), np.nan)
    _, at, of = np.intersect1d(numbers, own, return_indices=True)
    found[at] = values[of]
    return found


def _interpolated(frequency: Array, at: Array, given: NDArray[np.inexact]) -> NDArray[np.inexact]:
    """Numbers between those of a table, and beyond them as at its ends; magnitudes by their logarithms."""
    if np.iscomplexobj(given):
        return np.asarray(np.interp(frequency, at, given))
    return np.exp(np.interp(np.log(frequency), np.log(at), np.log(given)))
