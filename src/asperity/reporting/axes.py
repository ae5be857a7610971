"""Axes of the field: frequency, one-third octaves, wavenumber beside wavelength, words, levels."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.reporting.chart import FREQUENCY, GRID, Axis, Boxes, Note, Numbers, Second
from asperity.reporting.data import nominal_band

EDGE = 10**0.05
"""From the centre of a one-third octave to its upper edge."""


def frequency_axis(low: float, high: float, label: str = "frequency / Hz") -> Axis:
    """Logarithmic frequency axis with grid lines at the one-third octaves, named at the octaves."""
    centres = (1000 * 10 ** (np.arange(-30, 21) / 10)).tolist()
    ticks = tuple((f, nominal_band(f)) for f in centres[::3])  # … 31.5, 63, 125, …, 1k, 2k, 4k
    minor = tuple(f for n, f in enumerate(centres) if n % 3)
    return Axis(label, float(low), float(high), log=True, ticks=ticks, minor=minor, linked=FREQUENCY)


def linear_frequency_axis(high: float) -> Axis:
    """Frequency axis from 0 on, for what stands at equal distances."""
    return Axis("frequency / Hz", 0.0, float(high), linked=FREQUENCY)


def band_axis(
    bands: Numbers, label: str = "one-third octave band / Hz", name: Callable[[float], str] = nominal_band
) -> Axis:
    """Logarithmic axis with every one-third octave named, of frequencies unless `name` says otherwise."""
    ticks = tuple((band, name(band)) for band in bands.tolist())
    low, high = float(bands[0] / EDGE), float(bands[-1] * EDGE)
    linked = FREQUENCY if name is nominal_band else ""
    return Axis(label, low, high, log=True, ticks=ticks, linked=linked)


def wavenumber_axis(low: float, high: float) -> Axis:
    """Logarithmic axis of wavenumber in 1/m (cycles per metre), with the wavelength opposite."""
    second = Second("wavelength", inverse=True, unit="m")
    label = "wavenumber / (1/m)"
    return Axis(label, float(low), float(high), log=True, second=second, linked="wavenumber")


def log_axis(label: str, values: Sequence[Numbers], lowest: float = 0.0) -> Axis:
    """Logarithmic axis that holds all positive values, at least `lowest`, between two of 1, 2, 5, 10, …"""
    found = np.concatenate([each[each > 0] for each in values])
    if found.size == 0:
        return Axis(label, 1.0, 10.0, log=True)
    low, high = max(found.min(), min(lowest, found.max())), found.max()
    steps = np.outer(10.0 ** np.arange(np.floor(np.log10(low)), np.log10(high) + 1), [1, 2, 5, 10]).ravel()
    return Axis(label, float(steps[steps <= low].max()), float(steps[steps >= high].min()), log=True)


def words_axis(words: Sequence[str], label: str = "") -> Axis:
    """Axis with a place, 0, 1, 2, …, for each word."""
    ticks = tuple((float(n), word) for n, word in enumerate(words))
    return Axis(label, -0.5, len(words) - 0.5, ticks=ticks)


def levels_axis(label: str, levels: Sequence[Numbers], span: float = 80.0, step: float = 10.0) -> Axis:
    """Axis in dB that holds all the peaks, and at most `span` dB below the highest."""
    finite = np.concatenate([np.ravel(each)[np.isfinite(np.ravel(each))] for each in levels] or [np.zeros(0)])
    if finite.size == 0:
        return Axis(label, 0.0, step)
    top = step * np.ceil((finite.max() + 0.1 * step) / step)
    bottom = max(step * np.floor(finite.min() / step), top - span)
    return Axis(label, float(bottom), float(top))


def stretches(flags: NDArray[np.bool_]) -> NDArray[np.intp]:
    """First and last index of each run of places (n,) that are flagged, (m, 2)."""
    edges = np.flatnonzero(np.diff(flags.astype(np.int8), prepend=0, append=0))
    return edges.reshape(-1, 2) - np.array([0, 1])


def shade(left: Numbers, right: Numbers, colour: str = GRID, **look: Any) -> Boxes:
    """Stretches of an axis, shaded from bottom to top."""
    whole = np.full(left.shape, np.inf)
    return Boxes(left, right, -whole, whole, colour=colour, **look)


def doubtful_boxes(bands: Numbers, doubtful: NDArray[np.bool_], labelled: bool = True) -> list[Boxes | Note]:
    """Shades of the bands (by their centres) whose levels say little, and their name."""
    if not doubtful.any():
        return []
    first, last = np.sort(bands[stretches(doubtful)], axis=1).T  # wavelengths may fall
    note = Note("says little", 0.005, 0.03, x_share=True, y_share=True)  # low bands are left
    return [shade(first / EDGE, last * EDGE, opacity=0.6), *([note] if labelled else [])]
