"""Lines in a spectrum: a fundamental, its harmonics and side bands, and of several families which is
which."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from asperity.arguments import Array, positive, real, require, whole
from asperity.diagnostics.envelopes import Spectrum
from asperity.written_numbers import rounded

STANDS_OUT = 4.0
"""Amplitude of a line over the median around it: noise is above in one of 65 000 places."""
COUNTED = 30.0
"""Such a ratio above which a line counts no more: a harmonic shall not stand for all."""
AROUND = 0.1
"""Share of a frequency on either side of it of which the median is taken."""
FEWEST = 20
"""Places that this covers at least, on either side."""
WITHIN = 2
"""Places of the spectrum by which a line may be beside its harmonic."""
FAINT = 0.1
"""Share of the clearest family below which another one is not told apart from what modulates it."""


def median(values: Array) -> float:
    """Median of numbers (n,), none of them NaN: of few, NumPy's takes ten times as long."""
    half = values.size // 2
    parted = np.partition(values, half)
    return float(parted[half] if values.size % 2 else 0.5 * (parted[:half].max() + parted[half]))


@dataclass(frozen=True, eq=False)
class LineFamily:
    """A fundamental and its harmonics, sought in a spectrum with one deviation in common.

    Attributes
    ----------
    expected, distance : float
        Of the fundamental, and of its side bands, Hz; 0 for none.
    deviation : float
        Share by which the lines lie higher than expected.
    frequency, amplitude, background : ndarray (h,)
        Of each harmonic: Hz, its amplitude, and the median around it, in the unit of the signal.
    side_bands : ndarray (h, 2)
        Amplitudes one distance below and above.
    """

    expected: float
    distance: float
    deviation: float
    frequency: Array
    amplitude: Array
    background: Array
    side_bands: Array

    @property
    def prominent(self) -> Array:
        """Which harmonics stand out from what is around them, (h,) 1 or 0."""
        return np.asarray(self.amplitude >= STANDS_OUT * self.background, dtype=float)

    @property
    def found(self) -> bool:
        """Whether it is there: its fundamental stands out, and three lines in all, or every one of fewer."""
        return bool(self.prominent[0] and self.prominent.sum() >= min(3, self.prominent.size))

    @property
    def weight(self) -> float:
        """How clearly it is there: the mean logarithm of amplitude over background."""
        ratio = self.amplitude / np.maximum(self.background, 1e-300)
        return float(np.log(np.clip(ratio, 1.0, COUNTED)).mean())


def find_lines(
    spectrum: Spectrum, expected: float, *, distance: float = 0.0, slip: float = 0.02, harmonics: int = 5
) -> LineFamily:
    """Look for a line, its harmonics and side bands near an expected frequency.

    Parameters
    ----------
    spectrum : (ndarray, ndarray)
        Frequencies (f,), Hz, from zero at equal steps, and amplitudes (f,).
    expected : float
        Of the fundamental, Hz.
    distance : float
        Of side bands, Hz.
    slip : float
        Largest deviation, as a share, that is common to all harmonics.
    harmonics : int
        How many, the fundamental among them, as far as the spectrum reaches.

    Returns
    -------
    LineFamily
        At the deviation at which they stand out most.
    """
    from scipy.ndimage import maximum_filter1d

    expected = positive("expected line (Hz)", expected)
    slip = real("slip", slip, "0 to 0.2", at_least=0.0, at_most=0.2)
    harmonics = whole("harmonics", harmonics, "a whole number, 1 or more", at_least=1)
    frequency, amplitude = (np.asarray(each, dtype=float) for each in spectrum)
    step = frequency[1] - frequency[0]
    count = min(harmonics, int((frequency[-1] / step - WITHIN - 1) * step / (expected * (1.0 + slip))))
    received = f"{rounded(expected, 4)} Hz"
    allowed = f"less than the spectrum reaches, {rounded(frequency[-1], 4)} Hz"
    require(count >= 1, "line that is sought", received, allowed, "Take a wider band, or a faster sampling.")
    allowed = f"at least {rounded(8.0 * step)} Hz, four times what the record resolves"
    require(expected >= 8.0 * step, "line that is sought", received, allowed, "Record longer.")
    order = np.arange(1, count + 1)
    spans = [(at, max(AROUND * at, FEWEST)) for at in order * expected / step]
    background = np.array([median(amplitude[max(int(at - n), 1) : int(at + n)]) for at, n in spans])
    highest = maximum_filter1d(amplitude, 2 * WITHIN + 1)
    shifts = np.linspace(-slip, slip, 2 * int(np.ceil(slip * count * expected / step)) + 1)
    places = np.rint((1.0 + shifts[:, None]) * order * expected / step).astype(int)
    ratio = highest[places] / np.maximum(background, 1e-300)
    clear = np.log(np.clip(ratio, 1.0, COUNTED)).sum(axis=1) + 1e-6 * ratio.sum(axis=1) / ratio.max()
    around = places[np.argmax(clear)][:, None] + np.arange(-WITHIN, WITHIN + 1)
    at = np.take_along_axis(around, amplitude[around].argmax(axis=1)[:, None], axis=1)[:, 0]
    beside = at[:, None] + np.rint(distance / step * np.array([-1.0, 1.0])).astype(int)
    inside = (beside > 0) & (beside < amplitude.size) & (distance > 0.0)
    sides = np.where(inside, highest[np.clip(beside, 0, amplitude.size - 1)], 0.0)
    weight = amplitude[at] * order  # harmonics tell it the more closely
    deviation = float((weight * frequency[at] / order).sum() / weight.sum() / expected - 1.0)
    return LineFamily(expected, distance, deviation, frequency[at], amplitude[at], background, sides)


def explained_lines(
    spectrum: Spectrum, expected: Mapping[str, tuple[float, float]], *, slip: float = 0.02, harmonics: int = 5
) -> dict[str, LineFamily]:
    """Look for several families of lines, the clearest first; what one explains counts for no other.

    Parameters
    ----------
    spectrum : (ndarray, ndarray)
        Frequencies (f,), Hz, and amplitudes (f,).
    expected : dict
        Fundamental and distance of its side bands, Hz, by name.
    slip, harmonics
        As of `find_lines`.

    Returns
    -------
    dict
        `LineFamily` by name, the clearest first. Harmonics fall on each other: three times the outer
        frequency of a 6205 is twice the inner one within 0.7 %.
    """
    frequency, amplitude = spectrum
    found = dict[str, LineFamily]()
    left = dict(expected)
    amplitude = np.array(amplitude)
    while left:
        tried = {
            name: find_lines((frequency, amplitude), line, distance=distance, slip=slip, harmonics=harmonics)
            for name, (line, distance) in left.items()
        }
        best = max(tried, key=lambda name: (tried[name].found, tried[name].weight))
        found[best] = tried[best]
        del left[best]
        if tried[best].found:
            amplitude = _without(frequency, amplitude, tried[best])
    return found


def clear_families(found: Mapping[str, LineFamily], least: float) -> list[str]:
    """Names of the families that are there, in their order.

    Without those that are faint beside the clearest (`FAINT`), or whose fundamental is below `least`.
    """
    there = {name: float(lines.amplitude[0]) for name, lines in found.items() if lines.found}
    return [name for name, line in there.items() if line >= max(least, FAINT * max(there.values()))]


def _without(frequency: Array, amplitude: Array, lines: LineFamily) -> Array:
    """Amplitudes (f,) with the median of all in place of the harmonics of lines and their side bands."""
    step = frequency[1] - frequency[0]
    first = lines.expected * (1.0 + lines.deviation)
    order = np.arange(1, int(frequency[-1] / first) + 1)
    sides = lines.distance * np.arange(-2, 3)
    places = np.rint((order[:, None] * first + sides) / step).astype(int)[..., None]
    width = np.arange(-3 * WITHIN, 3 * WITHIN + 1)
    places = np.unique(places + width)
    places = places[(places > 0) & (places < amplitude.size)]
    left = amplitude.copy()
    left[places] = np.minimum(left[places], median(amplitude))
    return left
