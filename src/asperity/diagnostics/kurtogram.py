"""The kurtogram: how impulsive a signal is in each of many bands, and which one is the most."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from asperity.arguments import Array, ArrayLike
from asperity.diagnostics.envelopes import checked_signal

SPLITS = (1, 2, 3, 4, 6, 8, 12, 16)
"""Numbers of bands of equal width among which the most impulsive one is sought."""
LEAST_POWER = 0.02
"""Share of the mean square that it holds: filters leave next to nothing, where every click stands out."""


@dataclass(frozen=True, eq=False)
class Kurtogram:
    """How impulsive a signal is in bands of several widths.

    Attributes
    ----------
    count : ndarray (b,)
        Number of equal bands to which each one belongs, rising.
    low, high : ndarray (b,)
        Edges, Hz.
    kurtosis : ndarray (b,)
        E|z|⁴/(E|z|²)² − 2 of the analytic signal z in the band: 0 of Gaussian noise, −1 of a sine.
    power : ndarray (b,)
        Share of the mean square of the signal.
    """

    count: Array
    low: Array
    high: Array
    kurtosis: Array
    power: Array

    @property
    def best(self) -> tuple[float, float]:
        """Band of the largest kurtosis of those that hold at least 2 % of the mean square, Hz."""
        at = int(np.argmax(np.where(self.power >= LEAST_POWER, self.kurtosis, -np.inf)))
        return float(self.low[at]), float(self.high[at])

    @classmethod
    def mean(cls, several: Iterable["Kurtogram"]) -> "Kurtogram":
        """Mean over kurtograms of the same bands, as of the pieces of a record: a loud one counts no more."""
        found = list(several)
        kurtosis = np.mean([each.kurtosis for each in found], axis=0)
        power = np.mean([each.power for each in found], axis=0)
        return replace(found[0], kurtosis=kurtosis, power=power)


def kurtogram(signal: ArrayLike, rate: float, least_width: float = 0.0) -> Kurtogram:
    """Lay out how impulsive a signal is over bands of several widths.

    Parameters
    ----------
    signal : array_like (n,)
        In any unit.
    rate : float
        Samples per second, Hz.
    least_width : float
        Width of the bands, at least, Hz: an envelope holds frequencies up to it.

    Returns
    -------
    Kurtogram
        Of 1, 2, 3, 4, 6, 8, 12 and 16 equal bands, as far as they are wide enough.

    Notes
    -----
    The bands are those of the fast kurtogram, halves and thirds in turn, each cut out of the spectrum of the
    whole record in place of a tree of filters: J. Antoni, Mechanical Systems and Signal Processing 21 (2007)
    108.
    """
    values, rate = checked_signal(signal, rate)
    values /= np.abs(values).max()
    lines = np.fft.rfft(values)
    values *= values  # in place: a record may be as long as memory allows
    whole = values.sum() * values.size
    del values
    rows = []
    for count in SPLITS:
        width = 0.5 * rate / count
        if count > 1 and width < least_width:
            break
        for number in range(count):
            first, last = (1 + (lines.size - 1) * each // count for each in (number, number + 1))
            part = np.fft.ifft(lines[first:last])  # at the rate that the band needs
            power = np.abs(part)
            del part
            power *= power
            share = 2.0 * power.sum() * power.size / whole
            peaks = float((power**2).mean() / max(power.mean() ** 2, 1e-300) - 2.0)
            rows.append((float(count), number * width, (number + 1) * width, peaks, float(share)))
    return Kurtogram(*np.array(rows).T)


def impulsive_band(signal: ArrayLike, rate: float, least_width: float = 0.0) -> tuple[float, float]:
    """Band in which a signal is most impulsive: of the largest spectral kurtosis.

    Parameters
    ----------
    signal, rate, least_width
        As of `kurtogram`.

    Returns
    -------
    low, high : float
        Hz: of 1 to 16 equal bands those that hold at least 2 % of the mean square (`Kurtogram.best`).
    """
    return kurtogram(signal, rate, least_width).best
