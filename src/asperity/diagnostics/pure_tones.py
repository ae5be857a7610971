"""Tones: records that hold a few of them alone, beside what rounding leaves, and bands that few of them make,
whose envelope is their beat."""

from functools import lru_cache

import numpy as np
from scipy.fft import rfft

from asperity.arguments import Array, floats
from asperity.diagnostics.missing_samples import BLOCK, Samples, least_step
from asperity.spectra import hann_window

MOST_TONES = 8
"""That are told as such: of more, what comes with each turn is a blow, too."""
FEW_TONES = 5
"""Lines of a band, of which the envelope has no comb of five harmonics: that takes one more."""
SHARE = 0.01
"""Of the mean square that may lie beside them."""
BEATS = 0.75
"""Of the mean square of a band that so many tones have, from which on its envelope is their beat: those of
measured blows have half of it at most."""
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


def tones_alone(signal: Samples, rate: float, *, clipped: bool = False) -> tuple[float, ...]:
    """Frequencies of all the tones that a signal (n,) holds, Hz, the loudest first; none of one that holds
    more.

    Squared lines of noise of variance σ² scatter about σ² with the median σ² ln 2. A record holds tones alone
    where in every part of its spectrum that is as small as what rounding leaves, and all but a hundredth of
    its mean square lies in eight lines: a train of blows without noise has more. Of a clipped one what lies
    beside them is what clipping makes of them, folded at half the sampling rate.
    """
    values = floats(signal[:BLOCK])
    power = _lines(values)
    parts = np.array_split(power, min(max(power.size // WIDE, 1), BLOCKS))
    noise = np.sqrt(max(np.median(part) for part in parts) / np.log(2.0))
    if not clipped and noise > ROUNDING * max(least_step(signal), LEAST_STEP * float(values.std())):
        return ()
    places, left = _loudest(power, MOST_TONES)
    return tuple(at * rate / values.size for at in places) if left <= SHARE else ()


def beat(signal: Samples, rate: float, band: tuple[float, float]) -> bool:
    """Whether a few tones make a band of a signal (n,), as of a gear: its envelope is their beat, no blow.

    Blows have a line at each of their multiples, as far as what rings reaches.
    """
    values = floats(signal[:BLOCK])
    first, last = (int(edge * values.size / rate) for edge in band)
    return _loudest(_lines(values)[first : last + 1], FEW_TONES)[1] <= 1.0 - BEATS


def _lines(values: Array) -> Array:
    """Squares of the lines of a signal (n,) by a window that leaves next to nothing beside them."""
    window = _window(values.size)
    return np.asarray(np.abs(rfft((values - values.mean()) * window)) ** 2 / (window**2).sum())


@lru_cache(maxsize=1)
def _window(size: int) -> Array:
    """A window of so many samples: powers take longer than a transform."""
    return np.asarray(hann_window(size, centred=True) ** SHARP)


def _loudest(power: Array, most: int) -> tuple[list[int], float]:
    """Places of the loudest lines that have all but a hundredth, so many at most, and the share of the
    rest."""
    left = power.copy()
    whole = power.sum()
    places = list[int]()
    while len(places) < most and left.sum() > SHARE * whole:
        at = int(left.argmax())
        places.append(at)
        left[max(at - LOBE, 0) : at + LOBE + 1] = 0.0
    return places, float(left.sum() / whole) if whole > 0.0 else 1.0
