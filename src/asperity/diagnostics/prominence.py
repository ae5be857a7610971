"""How far the lines of a spectrum stand out, and which combs of harmonics they form."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from asperity.arguments import Array, Flags, Indices
from asperity.diagnostics.envelopes import Spectrum, mean_spectrum
from asperity.diagnostics.lines import AROUND, COUNTED, FEWEST, STANDS_OUT, WITHIN, median

HARMONICS = 5
"""Of a comb: what a resonance leaves of them differs, what most of them have counts."""
LOWEST_PLACE = 3
"""Of a spectrum: below, the window spreads the mean."""
PER_STEP = 3
"""Fundamentals that are tried in the width by which the last harmonic may be beside its place."""
TOGETHER = 2**14
"""Fundamentals that are looked at together: of long records there are millions."""
CANDIDATES = 5
"""Combs that are looked at, the clearest first."""
BESIDE = 2
"""Side bands on either side of a line that a shaft makes clear."""
SPREAD = 4
"""Places by which a line reaches beside its own: half the main lobe of the window."""
COMPARABLE = 0.3
"""Share of the lines of a comb that those between them must have to be told as its true fundamental, and
those of its own beside a deeper comb's."""


def _as_of_one(ratio: Array, means: int) -> Array:
    """Amplitudes over the median of the mean of so many power spectra, as high as those of one spectrum that
    noise reaches as seldom.

    The power of noise has a gamma distribution: of one spectrum it exceeds r² medians in one of 2^(r²)
    places.
    """
    from scipy.special import gammaincc, gammainccinv

    if means == 1:
        return ratio
    chance = gammaincc(means, ratio**2 * gammainccinv(means, 0.5))
    return np.sqrt(-np.log2(np.maximum(chance, 1e-300)))


@dataclass(frozen=True, eq=False)
class Prominence:
    """A spectrum by what its lines have over the median around them.

    Attributes
    ----------
    step : float
        Between places, Hz: half of what the record resolves.
    amplitude : ndarray (f,)
        In the unit of the signal.
    medians : (ndarray (m,), ndarray (m,))
        Places, and the median around each; see `background`.
    log_ratio : ndarray (f,)
        Logarithm of the highest of them within one resolution, from 0 to ln 30: a line shall not stand for
        all.
    level : float
        Mean of the envelope, in the unit of the signal; 1 of a spectrum that is none of an envelope.
    """

    step: float
    amplitude: Array
    medians: tuple[Array, Array]
    log_ratio: Array
    level: float

    @classmethod
    def of(
        cls, spectrum: Spectrum, level: float = 1.0, means: int = 1, highest: float = np.inf
    ) -> "Prominence":
        """How far the lines of a spectrum stand out up to a highest frequency, Hz, or of the mean of so many:
        noise has higher lines in one than in the mean of many."""
        from scipy.ndimage import maximum_filter1d

        frequency, amplitude = spectrum
        centres = [float(LOWEST_PLACE)]
        while centres[-1] < amplitude.size:
            centres.append(centres[-1] + max(0.5 * AROUND * centres[-1], 4.0))
        medians = []
        for centre in centres:
            half = max(AROUND * centre, FEWEST)
            first = max(int(centre - half), LOWEST_PLACE - 1)
            last = int(centre + half)
            medians.append(median(amplitude[min(first, amplitude.size - 1) : last]))
        ratio = np.interp(np.arange(amplitude.size), centres, medians)
        np.maximum(ratio, 1e-300, out=ratio)  # in place: a record may be as long as memory allows
        np.divide(amplitude, ratio, out=ratio)
        ratio[: LOWEST_PLACE - 1] = 0.0
        kept = slice(None)
        if highest < frequency[-1]:
            kept = slice(0, int(highest / frequency[1]) + 1)
        ratio = maximum_filter1d(ratio, 2 * WITHIN + 1)[kept]
        log_ratio = np.clip(_as_of_one(ratio, means), 1.0, COUNTED)
        np.log(log_ratio, out=log_ratio)
        around = np.array(centres), np.array(medians)
        return cls(float(frequency[1]), amplitude[kept].copy(), around, log_ratio, level)

    @classmethod
    def of_envelopes(
        cls,
        envelopes: Iterable[Array],
        rate: float,
        width: float,
        means: int,
        highest: float,
    ) -> "Prominence":
        """How far lines in the mean of so many envelopes, of one length and a band of a width, Hz, stand out,
        up to a highest frequency, Hz."""
        levelled = ((each, float(each.mean())) for each in envelopes)
        (frequency, amplitude), level = mean_spectrum(levelled, rate)
        held = slice(np.searchsorted(frequency, width, side="right"))
        return cls.of((frequency[held], amplitude[held]), level, means, highest)

    @property
    def spectrum(self) -> Spectrum:
        """Frequencies (f,), Hz, and amplitudes (f,)."""
        return np.arange(float(self.amplitude.size)) * self.step, self.amplitude

    def background(self, place: Indices) -> Array:
        """Median around places (k,), in the unit of the signal, between those where it was taken."""
        return np.interp(place, *self.medians)

    def at(self, frequency: Array) -> Array:
        """Logarithms of ratios at frequencies of any shape, Hz; NaN beyond the spectrum."""
        place = np.rint(frequency / self.step).astype(np.intp)
        found = self.log_ratio.take(place, mode="clip")
        found[(place < LOWEST_PLACE) | (place >= self.log_ratio.size)] = np.nan
        return found

    def standardised(self, frequency: Array, highest: float) -> Array:
        """What `at` finds, by the median and deviation of all places up to a highest one."""
        around = self.log_ratio[LOWEST_PLACE : max(int(highest / self.step), LOWEST_PLACE + 8)]
        return (self.at(frequency) - median(around)) / max(float(around.std()), 1e-3)

    def combs(self, fundamental: Array, least: float = STANDS_OUT) -> Array:
        """How clearly there is a comb of each fundamental (g,), Hz: 0, or the mean logarithm over harmonics.

        It is there where its first line has `least` times the background, and three of five in all.
        """
        begun = np.flatnonzero(self.at(fundamental) >= np.log(least))  # of noise, few of many
        terms = self.at(fundamental[begun, None] * np.arange(1, HARMONICS + 1))
        held = np.isfinite(terms).sum(axis=1)
        there = (terms >= np.log(least)).sum(axis=1) >= np.minimum(held, 3)
        clearness = np.zeros(fundamental.size)
        clearness[begun] = np.where(there, np.nansum(terms, axis=1) / held, 0.0)
        return clearness

    def lines_of(self, fundamental: float) -> tuple[Indices, Array]:
        """Places and amplitudes (h,) of the highest lines within one resolution of the harmonics of a
        comb."""
        last = self.amplitude.size - 1
        order = np.arange(1, HARMONICS + 1)
        middle = np.rint(order * fundamental / self.step).astype(int)
        middle = middle[(middle >= LOWEST_PLACE) & (middle <= last)]
        around = np.minimum(middle[:, None] + np.arange(-WITHIN, WITHIN + 1), last)
        place = np.take_along_axis(around, self.amplitude[around].argmax(axis=1)[:, None], axis=1)[:, 0]
        return place, self.amplitude[place]

    def refined(self, fundamental: float) -> float:
        """Fundamental of a comb by all of its lines that stand out, the higher ones the more."""
        place, amplitude = self.lines_of(fundamental)
        order = np.rint(place * self.step / fundamental)
        weight = np.log(np.maximum(amplitude / np.maximum(self.background(place), 1e-300), 1.0)) + 1e-9
        return float((weight * order * place).sum() / (weight * order**2).sum() * self.step)

    def true_fundamental(self, fundamental: float, shaft: float = 0.0) -> float:
        """Half, a third, a fifth or a seventh of a fundamental where lines as high lie between its own.

        Those of a shaft that turns so often, Hz, and side bands at its speed say nothing of that.
        """
        own = np.log(self.lines_of(fundamental)[1] + 1e-300).mean()
        for share in (2, 3, 5, 7):
            if fundamental / share < LOWEST_PLACE * self.step:
                break
            between = np.array([n for n in range(1, 2 * share) if n % share]) * fundamental / share
            if shaft:
                between = between[~self._beside_shaft(between, fundamental, shaft)]
            if not between.size or np.nan_to_num(self.at(between)).mean() < np.log(STANDS_OUT):
                continue
            place = np.rint(between / self.step).astype(int)
            around = place[:, None] + np.arange(-WITHIN, WITHIN + 1)
            height = self.amplitude[np.clip(around, 0, self.amplitude.size - 1)].max(axis=1)
            if np.log(height + 1e-300).mean() >= own + np.log(COMPARABLE):
                return self.true_fundamental(fundamental / share, shaft)
        return fundamental

    def _beside_shaft(self, frequency: Array, fundamental: float, shaft: float) -> Flags:
        """Which frequencies are not resolved from multiples of a shaft's speed, Hz, and side bands of a
        comb."""
        side = np.arange(-BESIDE, BESIDE + 1) * shaft
        lines = (np.arange(HARMONICS + 1)[:, None] * fundamental + side).ravel()
        off = np.abs(frequency[:, None] - lines).min(axis=1)
        off = np.minimum(off, np.abs(frequency - np.rint(frequency / shaft) * shaft))
        return off <= SPREAD * self.step

    def depth(self, fundamental: float, deepest: float = 0.0) -> float:
        """Share by which the envelope rises and falls with a comb: root of the squares of its lines over its
        mean.

        Without lines of the deepest comb, where its fundamental, Hz, is higher and those of its own are no
        match for them.
        """
        place, amplitude = self.lines_of(fundamental)
        beyond = np.maximum(amplitude**2 - (0.5 * STANDS_OUT * self.background(place)) ** 2, 0.0)
        own = beyond
        if deepest > fundamental + WITHIN * self.step:
            off = place * self.step / deepest
            own = beyond * (np.abs(off - np.maximum(np.rint(off), 1.0)) * deepest > WITHIN * self.step)
        counted = beyond if own.sum() >= COMPARABLE**2 * beyond.sum() else own
        return float(np.sqrt(counted.sum()) / self.level)

    def strongest(self, low: float, high: float) -> tuple[float, float]:
        """How clear the clearest deep comb with a fundamental in a range is, 0 for none, and its fundamental,
        Hz."""
        count = int(np.ceil((high - low) / self.step * HARMONICS / WITHIN * PER_STEP)) + 2
        step = (high - low) / (count - 1)
        places: list[Array] = []
        clearness: list[Array] = []
        for first in range(0, count, TOGETHER):
            part = low + step * np.arange(first, min(first + TOGETHER, count), dtype=np.float64)
            clear = self.combs(part)
            places.append(part[clear > 0.0])
            clearness.append(clear[clear > 0.0])
        fundamental = np.concatenate(places)
        clear = np.concatenate(clearness)
        found: list[tuple[float, float, float]] = []
        for _ in range(CANDIDATES):
            if not clear.any():
                break
            at = int(np.argmax(clear))
            clear[np.abs(fundamental - fundamental[at]) <= 2 * LOWEST_PLACE * self.step] = 0.0
            true = self.refined(self.true_fundamental(self.refined(float(fundamental[at]))))
            likeness = float(self.combs(np.array([true]), 1.0)[0])
            found.append((likeness + np.log(min(self.depth(true), 1.0) + 1e-3), likeness, true))
        return max(found)[1:] if found else (0.0, 0.0)
