"""Spectra: power spectral density, base-10 one-third octaves, levels, A-weighting.

The same functions serve time signals (s, Hz) and textures (m, cycles per metre): one-third octaves
in wavelength are those in wavenumber read backwards, since both have their centres at powers of
10^(1/10) of the SI unit.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from asperity.arguments import Array, ArrayLike, Complex, require
from asperity.written_numbers import count_of

HALF_BAND = 10.0 ** (1.0 / 20.0)
"""Ratio of a one-third octave's upper edge to its centre, base 10 (IEC 61260-1)."""

TOGETHER = 2**15
"""Samples that are transformed at a time: each call takes time of its own."""

LONGEST_KEPT = 2**17
"""Samples of windows that are kept, at most: a megabyte."""
LEAST_PRODUCT = 10.0
"""Bandwidth times averaging time B T below which a band level says little: its standard deviation,
4.34/sqrt(B T) dB, is then above 1.4 dB (the relative error of an rms value is 1/(2 sqrt(B T)))."""
MOST_START = 0.2
"""Share of the mean square of a band that may not be built up yet in a record: its level is then 1 dB low."""


def root_mean_square(values: Array) -> float:
    """Of all values."""
    return float(np.sqrt(np.mean(values**2)))


def psd(signal: ArrayLike, spacing: float, *, segment: int | None = None) -> tuple[Array, Array]:
    """One-sided power spectral density (..., f) by Welch's method with a Hann window, after its frequencies.

    The signal (..., n) has any unit U; `spacing` is the step between samples along its last axis, s or m, so
    that frequencies, from zero to half the sampling frequency, are in Hz or cycles per metre and the density
    is in U² per Hz or per cycle per metre. The mean over the whole record is removed. The sum of the PSD
    times the frequency step is the variance of the signal, weighted by the squared windows.

    By default the whole record is one segment, but for long ones, see `longest_segment`. Segments of fewer
    samples, which overlap by half, give a smoother estimate and a coarser frequency step, 1/(segment ·
    spacing). P. D. Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70-73.
    """
    from scipy.fft import rfft  # not where only bands are looked up

    values = np.asarray(signal, dtype=np.float64)
    long_enough = values.ndim > 0 and values.shape[-1] > 1
    allowed = "at least 2 samples on the last axis"
    require(long_enough, "signal", f"shape {values.shape}", allowed)
    finite = np.isfinite(values).all()
    remedy = "Fill or cut missing samples."
    require(finite, "signal", "NaN or infinite values", "finite values", remedy)
    require(0.0 < spacing < np.inf, "spacing", spacing, "a positive finite step")
    samples = values.shape[-1]
    length = longest_segment(samples) if segment is None else int(segment)
    require(2 <= length <= samples, "segment", length, f"2 to {samples} samples", "Shorten the segment.")
    mean = values.mean(axis=-1, keepdims=True)[..., None, :]
    energy = np.square(hann_window(length)).sum()
    advance = length - length // 2
    segments = sliding_window_view(values, length, axis=-1)[..., ::advance, :]
    count = segments.shape[-2]
    together = max(1, TOGETHER // max(1, values[..., 0].size * length))
    power = np.zeros((*values.shape[:-1], length // 2 + 1))
    for first in range(0, count, together):
        windowed = segments[..., first : first + together, :] - mean
        windowed *= hann_window(length)  # not held beside what is transformed
        spectra = rfft(windowed, overwrite_x=True)
        del windowed
        np.square(spectra.real, out=spectra.real)  # in place: records may be as long as memory allows
        np.square(spectra.imag, out=spectra.imag)
        spectra.real += spectra.imag
        power += spectra.real.sum(axis=-2)
        del spectra
    power *= 2.0 * spacing / (count * energy)
    power[..., 0] *= 0.5
    if length % 2 == 0:
        power[..., -1] *= 0.5  # zero and half the sampling frequency have no other side
    return np.asarray(np.fft.rfftfreq(length, spacing), dtype=np.float64), power


LONGEST_SEGMENT = 2**20
"""Samples that are transformed in one piece: a transform takes four times their memory beside the record."""
ROUND = 2**14
"""Numbers of samples that are multiples of this are transformed fast."""


def longest_segment(samples: int) -> int:
    """Samples of a segment by default: the whole record, of one of more than a million samples fewer.

    Beyond, segments are as long as possible, and reach from its beginning nearly to its end.
    """
    if samples <= LONGEST_SEGMENT:
        return samples
    segments = math.ceil(2 * samples / LONGEST_SEGMENT) - 1
    return 2 * samples // (segments + 1) // ROUND * ROUND


def quick_length(samples: int) -> int:
    """Largest length up to a number of samples whose prime factors are at most 11, but for a few thousandths
    of it."""
    from scipy.fft import next_fast_len

    shorter = samples
    while next_fast_len(shorter) > samples:
        shorter -= 1 + samples // 10_000
    return int(next_fast_len(shorter))


SEGMENT = (0.025, 0.2)
"""Shortest and longest segment of the spectra of a record, s: lines 40 Hz and 5 Hz apart."""


def spectrum_segment(samples: int, step: float) -> int:
    """Length of the segments that spectra of a record are averaged over, in time steps, s.

    A quarter of the record within `SEGMENT`, so that windows leave most of it.
    """
    shortest, longest = (round(length / step) for length in SEGMENT)
    return min(max(samples // 4, shortest), longest, samples)


def lowest_band(samples: int, step: float, *, segment: int | None = None) -> float:
    """Centre, Hz, of the lowest one-third octave that is a line wide in the spectra of a record.

    By default of its own segments.
    """
    length = spectrum_segment(samples, step) if segment is None else segment
    lines = np.asarray(np.fft.rfftfreq(length, step), dtype=np.float64)
    return _covered_centres(lines, float(lines[1]))[0] if lines.size > 1 else math.inf


def hann_window(length: int, *, centred: bool = False) -> Array:
    """Hann window of `length` samples, periodic from the first of them; centred, even about their middle."""
    return _window_kept(length, centred).copy() if length <= LONGEST_KEPT else _window(length, centred)


def _window(length: int, centred: bool) -> Array:
    window = np.arange(length, dtype=np.float64)
    if centred:
        window += 0.5
    window *= 2.0 * np.pi / length
    np.cos(window, out=window)
    window *= -0.5
    window += 0.5
    return window


_window_kept = lru_cache(maxsize=4)(_window)  # records are read in many pieces of few lengths


def averaging_time(samples: int, spacing: float, *, segment: int | None = None) -> float:
    """Time, s or m, that `psd` averages over: less than the record, since windows weigh its parts unequally.

    (Σu)²/Σu² steps, where u is the sum of the squared windows of all segments. With it the standard deviation
    of the mean square of noise in a band is 1/sqrt(B T), as long as the band is some lines wide: J. S. Bendat
    and A. G. Piersol, Random Data, 4th ed. (2010).
    """
    length = longest_segment(samples) if segment is None else int(segment)
    window = hann_window(length) ** 2
    weight = np.zeros(samples)
    for first in range(0, samples - length + 1, length - length // 2):
        weight[first : first + length] += window
    return float(spacing * weight.sum() ** 2 / (weight**2).sum())


def band_product(centres: ArrayLike, time: float) -> Array:
    """Bandwidth times averaging time B T of one-third octaves (b,), Hz and s, or cycles per metre and m.

    Levels of bands below `LEAST_PRODUCT` say little.
    """
    return np.asarray(centres, dtype=np.float64) * (HALF_BAND - 1.0 / HALF_BAND) * time


def say_little(product: Any, start: Any) -> Any:
    """Which bands have levels that say little, by B T and by the share that is not built up yet: arrays."""
    return (product < LEAST_PRODUCT) | (start > MOST_START)


def level_deviation(values: ArrayLike) -> Array:
    """Standard deviation, dB, of the level of a mean square of as many independent complex values, from 1.

    4.34 √ψ′(n) of a gamma distribution, ψ′ the trigamma function: 4.34/√n for many, 5.57 dB for one.
    """
    from scipy.special import polygamma

    return np.asarray(10.0 / np.log(10.0) * np.sqrt(polygamma(1, np.maximum(values, 1.0))), dtype=np.float64)


LINES = (512, 4096)
"""Frequencies in a band at which a force is looked at: few, or as many as resolve loss factors of 10⁻⁴."""
RUNG_OUT = 1e-3
"""Share of the energy of a pulse that is left in the middle of its record if few frequencies resolve it."""


def values_seen(signal: Array, step: float, centres: Array) -> Array:
    """Number of independent values that bands of a record (n,) are seen to hold, for each one of B T (b,).

    (Σ S)²/Σ S² of the lines of a band over what noise has that is white in it; fewer where a few lines stand
    out, as those of a texture that comes again with each turn of a wheel. Time step in s, centres in Hz.
    """
    frequency = np.fft.rfftfreq(signal.size, step)
    density = np.abs(np.fft.rfft(signal - signal.mean())) ** 2  # a window would make each line several
    found = np.ones(len(centres))
    for band, centre in enumerate(centres):
        lines = density[(frequency >= centre / HALF_BAND) & (frequency < centre * HALF_BAND)]
        if lines.size > 1 and lines.any():
            # of lines from one record the mean square is twice that of their expected values, less the share
            # of each in the sum
            ratio = lines @ lines / lines.sum() ** 2
            found[band] = (2.0 - ratio) / ratio / lines.size
    return np.minimum(found, 1.0)


@dataclass(frozen=True, eq=False)
class RingingBand:
    """How a band of a force rings after a blow, with all places of a record together."""

    width: float  # of the band, Hz
    energy: Array  # of its pulse, (n,), at times k over the width
    likeness: Array  # |R|²/R(0)² of its correlation at the same lags, the second half of which are negative

    def not_built_up(self, settled: float, record: float) -> float:
        """Share of its mean square that is not there in a record, s, `settled`, s, after vibration began.

        The mean square of a force that begins at zero grows as the integral of ``|g|²``: the share is what
        is still to come, as a mean over the record.
        """
        half = self.energy.size // 2
        coming = np.clip((np.arange(half) / self.width - settled) / record, 0.0, 1.0)
        return float(coming @ self.energy[:half] / self.energy.sum())

    def values(self, record: float) -> float:
        """Number of independent values that a record T, s, of it holds.

        The mean square of a force with the correlation R(τ) has a relative variance of
        ``∫|R|²(1 − |τ|/T) dτ/(T R(0)²)``; its inverse is that number, bandwidth times T for noise that is
        white in the band.
        """
        after = np.arange(self.likeness.size)
        lag = np.minimum(after, self.likeness.size - after) / self.width
        alike = self.likeness @ np.maximum(1.0 - lag / record, 0.0)
        return max(self.width * record / float(alike), 1.0)


def ringing_band(transfer: Callable[[Array], Complex], centre: float) -> RingingBand:
    """Find how a band of a centre, Hz, rings of the force per height (p, f) at places and frequencies, Hz."""
    low = centre / HALF_BAND
    width = centre * (HALF_BAND - 1.0 / HALF_BAND)
    for lines in LINES:
        force = transfer(low + width * (np.arange(lines) + 0.5) / lines)
        energy = np.sum(np.abs(np.fft.ifft(force)) ** 2, axis=0)
        if energy[lines // 4 : 3 * lines // 4].sum() < RUNG_OUT * energy.sum():
            break
    power = np.abs(force) ** 2
    likeness = np.mean(np.abs(np.fft.ifft(power)) ** 2, axis=0) / np.mean(power) ** 2
    return RingingBand(width, energy, likeness)


def third_octave_numbers(centres: ArrayLike) -> Array:
    """Numbers n of the one-third octaves 10^(n/10) that hold frequencies, Hz, or wavelengths, m."""
    return np.rint(10.0 * np.log10(centres))


def in_bands(bands: ArrayLike, centres: ArrayLike, values: Array) -> Array:
    """Values (…, n) of one-third octaves by their centres (n,) in others (b,); NaN in those without one."""
    same = third_octave_numbers(bands)[:, None] == third_octave_numbers(centres)
    return np.where(same.any(axis=1), values[..., same.argmax(axis=1)], np.nan)


def nominal(centre: float) -> float:
    """Nominal value of a one-third octave's exact centre: 3150 for 3162.28 (IEC 61260-1:2014, annex E)."""
    tenths = round(10.0 * np.log10(centre))
    mantissa = (1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0)[tenths % 10]
    return float(f"{mantissa}e{tenths // 10}")


def nominal_frequency(centre: float) -> str:
    """Nominal name of a one-third octave in text: ``"3.15 kHz"`` for the centre 3162.28 Hz."""
    return _named(centre, {"kHz": 1e3, "Hz": 1.0})


def nominal_length(centre: float) -> str:
    """Nominal name of a one-third octave of wavelength in text: ``"3.15 mm"`` for the centre 3.16228 mm."""
    return _named(centre, {"m": 1.0, "mm": 1e-3, "µm": 1e-6})


def _named(centre: float, units: dict[str, float]) -> str:
    """Nominal value in the largest unit of which it is one or more, or in the last."""
    unit = next((name for name, size in units.items() if nominal(centre) >= 0.999 * size), list(units)[-1])
    return f"{nominal(centre / units[unit]):g} {unit}"


def third_octave_bands(f_low: float, f_high: float) -> tuple[Array, Array, Array]:
    """Exact one-third octaves of base 10, from the band that holds `f_low` to that of `f_high`.

    Centres 1000 · 10^(n/10) and edges, a factor 10^(1/20) below and above, (b,), Hz (or cycles per metre),
    rising. IEC 61260-1:2014 (base-ten system, b = 3).
    """
    rising = 0.0 < f_low <= f_high < np.inf
    require(rising, "band limits", f"{f_low} to {f_high}", "0 < f_low <= f_high, finite")
    first, last = (int(np.rint(10.0 * np.log10(f / 1000.0))) for f in (f_low, f_high))
    centres = 1000.0 * 10.0 ** (np.arange(first, last + 1) / 10.0)
    return centres, centres / HALF_BAND, centres * HALF_BAND


def band_energies(frequency: ArrayLike, psd: ArrayLike, edges_low: ArrayLike, edges_high: ArrayLike) -> Array:
    """Mean square (..., b), U², in bands; a line that straddles an edge is shared in proportion.

    Each line of the density (..., f), U² per Hz, stands for the frequencies half a step around it, so
    neighbouring bands add up to the energy of their union. Frequencies and edges are in Hz or cycles per
    metre, the former uniform and rising; parts of a band outside of them hold nothing.
    """
    lines = np.asarray(frequency, dtype=np.float64)
    density = np.asarray(psd, dtype=np.float64)
    step = _frequency_step(lines, density)
    cell_edges = np.concatenate([lines - step / 2.0, [lines[-1] + step / 2.0]])
    start = np.zeros((*density.shape[:-1], 1))
    cumulative = np.concatenate([start, np.cumsum(density, axis=-1) * step], axis=-1)
    edges = np.concatenate([np.atleast_1d(edges_low), np.atleast_1d(edges_high)])
    below = np.apply_along_axis(lambda sums: np.interp(edges, cell_edges, sums), -1, cumulative)
    return below[..., edges.size // 2 :] - below[..., : edges.size // 2]


def _frequency_step(lines: Array, density: Array) -> float:
    fit = density.shape[-1:] == lines.shape
    received = f"shapes {lines.shape} and {density.shape}"
    require(fit and lines.size > 1, "frequency and psd", received, "(f,) and (..., f), f >= 2")
    step = (lines[-1] - lines[0]) / (lines.size - 1)
    uniform = step > 0.0 and np.allclose(np.diff(lines), step, rtol=1e-6, atol=0.0)
    require(uniform, "frequency", "unequal steps", "uniform, rising frequencies")
    return float(step)


def band_levels(
    frequency: ArrayLike,
    psd: ArrayLike,
    reference: float = 1.0,
    *,
    low: float | None = None,
    high: float | None = None,
) -> tuple[Array, Array]:
    """One-third-octave band levels of a PSD: centres (b,), Hz, and levels (..., b), dB.

    10 lg(mean square / reference²), minus infinity for an empty band, of a density (..., f), U² per Hz, at
    uniform, rising frequencies; `reference` is in U (1e-6 for dB re 1 µm and dB re 1 µm/s²). `low` and `high`
    lie in the first and the last band; by default all bands that the frequencies cover and that are at least
    one frequency step wide. For a texture, frequencies are in cycles per metre and the wavelengths of the
    bands are ``1 / centres``.
    """
    lines = np.asarray(frequency, dtype=np.float64)
    step = _frequency_step(lines, np.asarray(psd, dtype=np.float64))
    require(reference > 0.0, "reference", reference, "a positive value")
    smallest, largest = _covered_centres(lines, step)
    first = smallest if low is None else low
    last = largest if high is None else high
    covered = first <= last * HALF_BAND
    require(covered, "frequency", count_of(lines.size, "line"), "enough lines to cover a band")
    centres, edges_low, edges_high = third_octave_bands(first, max(first, last))
    energies = np.maximum(band_energies(lines, psd, edges_low, edges_high), 0.0)
    return centres, level_of(energies / reference**2)


def _covered_centres(lines: Array, step: float) -> tuple[float, float]:
    """First and last centre of the bands that the lines cover and that are a step wide."""
    widest_step = step / (HALF_BAND - 1.0 / HALF_BAND)
    above = max(widest_step, (lines[0] - step / 2.0) * HALF_BAND)
    below = (lines[-1] + step / 2.0) / HALF_BAND
    first = np.ceil(10.0 * np.log10(above) - 1e-9)
    last = np.floor(10.0 * np.log10(below) + 1e-9)
    return float(10.0 ** (first / 10.0)), float(10.0 ** (last / 10.0))


def level_of(energies: ArrayLike) -> Array:
    """Levels of energies over that of their reference, dB; minus infinity where there is none."""
    with np.errstate(divide="ignore"):
        return 10.0 * np.log10(energies)


def energy_of(levels: ArrayLike) -> Array:
    """Energies over that of the reference of levels, dB: 10^(L/10)."""
    return np.asarray(10.0 ** (np.asarray(levels, dtype=np.float64) / 10.0))


def energy_sum(levels: ArrayLike, axis: int = -1) -> Array:
    """Level of the sum of the energies of levels with one reference, dB: 10 lg Σ 10^(L/10)."""
    return level_of(np.sum(energy_of(levels), axis=axis))


def energy_mean(levels: ArrayLike, axis: int = -1) -> Array:
    """Level of the mean of the energies of levels with one reference, dB."""
    return level_of(np.mean(energy_of(levels), axis=axis))


def a_weighting(frequency: ArrayLike) -> Array:
    """A-weighting of sound pressure levels at frequencies >= 0, Hz: dB to add to an unweighted level.

    0 dB at 1 kHz within 0.001 dB, minus infinity at 0 Hz. IEC 61672-1:2013, analytical A-weighting, with the
    rounded constants 20.60, 107.7, 737.9 and 12194 Hz and -2.000 dB.
    """
    f = np.asarray(frequency, dtype=np.float64)
    require(not (f < 0.0).any(), "frequency", f.min(), "0 Hz or more")
    f2 = f * f
    low = (f2 + 20.60**2) * np.sqrt((f2 + 107.7**2) * (f2 + 737.9**2))
    gain = 12194.0**2 * f2 * f2 / (low * (f2 + 12194.0**2))
    with np.errstate(divide="ignore"):
        return 20.0 * np.log10(gain) + 2.000


def a_weighted_total(levels: ArrayLike, centres: ArrayLike) -> Array:
    """A-weighted level of one-third octaves, dB: 10 lg Σ 10^((L + A)/10) over the last axis.

    Levels (..., bands) with one reference, dB; centres (bands,), Hz. Bands without a level add nothing; NaN
    where none has one.
    """
    weighted = np.asarray(levels, dtype=np.float64) + a_weighting(centres)
    total = energy_sum(np.where(np.isfinite(weighted), weighted, -np.inf))
    return np.where(np.isfinite(total), total, np.nan)
