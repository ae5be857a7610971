"""Records that hold tones alone: nothing beside a few lines but what rounding leaves, against which no line
stands out."""

import numpy as np
from scipy.fft import rfft

from asperity.arguments import Array
from asperity.diagnostics.missing_samples import BLOCK, least_step
from asperity.spectra import hann_window

MOST_TONES = 5
"""Lines of a band, of which the envelope has no comb of five harmonics: that takes one more."""
SHARE = 0.01
"""Of the mean square that may lie beside them."""
SHARP = 4
"""Power of the Hann window: beside the lobe of a line, five places wide either way, it leaves next to
nothing."""
LOBE = 5
BLOCKS, WIDE = 16, 128
"""Parts of the spectrum at most, in the noisiest of which a record has its noise, and places of each at
least."""
ROUNDING = 0.5
"""Rms of noise over the step of samples up to which it is that of rounding, which has 1/sqrt(12) and moves
with the signal: noise that is as loud makes rounding independent of it."""
LEAST_STEP = 2e-6
"""Of the rms of a record: no sensor and no converter resolves so little beside what it measures."""


def tones_alone(signal: Array, rate: float, *, clipped: bool = False) -> tuple[float, ...]:
    """Frequencies of all the tones that a signal (n,) holds, Hz, the loudest first; none of one that holds
    more.

    Squared lines of noise of variance σ² scatter about σ² with the median σ² ln 2. A record holds tones alone
    where in every part of its spectrum that is as small as what rounding leaves, and all but a hundredth of
    its mean square lies in five lines: a train of blows without noise has more. Of a clipped one what lies
    beside them is what clipping makes of them, folded at half the sampling rate.
    """
    values = signal[:BLOCK] - signal[:BLOCK].mean()
    window = hann_window(values.size, centred=True) ** SHARP
    power = np.abs(rfft(values * window)) ** 2 / (window**2).sum()
    parts = np.array_split(power, min(max(power.size // WIDE, 1), BLOCKS))
    noise = np.sqrt(max(np.median(part) for part in parts) / np.log(2.0))
    if not clipped and noise > ROUNDING * max(least_step(signal), LEAST_STEP * float(values.std())):
        return ()
    found = []
    all_of_them = power.sum()
    while power.sum() > SHARE * all_of_them:
        at = int(power.argmax())
        found.append(at * rate / values.size)
        power[max(at - LOBE, 0) : at + LOBE + 1] = 0.0
    return tuple(found) if len(found) <= MOST_TONES else ()
