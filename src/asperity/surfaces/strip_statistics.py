"""Statistics of a strip of any length, of all its rows, read piece by piece."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from asperity.errors import InputError
from asperity.spectra import psd
from asperity.surfaces.correlation import lag_sums, lengths_of
from asperity.surfaces.statistics import Statistic, areal_parameters, slope
from asperity.surfaces.strip import Strip

PIECE = 2**20
"""Points of a strip that are looked at in one go."""
FEWEST_ROWS = 1024
"""Rows of such a piece, at least: correlations are known up to half of them."""
BINS = 80
MARGIN = 3
"""Neighbours on either side that the slope at a point needs."""


@dataclass(frozen=True, eq=False)
class StripSurvey:
    """What a whole strip is like."""

    # areal roughness parameters, in the order of `areal_parameters`; none of a flat strip
    statistics: list[Statistic]
    edges: NDArray[np.float64]  # (81,), heights about the mean, m
    density: NDArray[np.float64]  # (80,), probability density between them, 1/m
    wavenumber: NDArray[np.float64]  # (f,), cycles per metre
    spectrum: NDArray[np.float64]  # (f,), one-sided PSD along the strip, mean over its lines, m³


def survey_strip(strip: Strip, segment: int, first: int = 0, stop: int | None = None) -> StripSurvey:
    """Survey all rows of a strip, reading it twice and never holding more than a piece.

    Complete heights, m; their mean is removed here. Segments of the spectrum have `segment` rows. Pairs of
    points in different pieces do not count towards the autocorrelation, and segments of the spectrum end with
    their piece; all else is as if the strip were one map. Warns as `autocorrelation_lengths` does.
    """
    bounds = _bounds(strip, first, strip.shape[0] if stop is None else stop, segment)
    total, low, high = 0.0, np.inf, -np.inf
    for start, end in bounds:
        heights = strip.rows(start, end)
        total += float(heights.sum())
        low, high = min(low, float(heights.min())), max(high, float(heights.max()))
    points = (bounds[-1][1] - bounds[0][0]) * strip.shape[1]
    mean = total / points
    edges = np.linspace(low, high if high > low else low + 1e-12, BINS + 1) - mean
    reach = min(end - start for start, end in bounds) // 2
    sums = _Sums(strip.spacing, strip.shape[1], reach, edges, segment)
    for heights, inner in _with_margin(strip, bounds):
        sums.add(heights - mean, inner)
    density = np.asarray(sums.counts / (points * np.diff(edges)))
    spectrum = np.asarray(sums.spectrum / sums.segments)
    wavenumber = np.asarray(np.fft.rfftfreq(segment, strip.spacing[0]), dtype=np.float64)
    statistics = []
    if high > low:
        band = (2.0 * min(strip.spacing), max(points // strip.shape[1] * strip.spacing[0], strip.size[1]))
        amplitudes = sums.powers / points
        lengths = lengths_of(sums.products / sums.pairs, strip.spacing)
        slopes = (sums.square / sums.sloped, sums.stretch / sums.sloped)
        statistics = areal_parameters(amplitudes, high - low, slopes, lengths, band)
    return StripSurvey(statistics, edges, density, wavenumber, spectrum)


class _Sums:
    """What is added up over the pieces of a strip."""

    def __init__(
        self,
        spacing: tuple[float, float],
        width: int,
        reach: int,
        edges: NDArray[np.float64],
        segment: int,
    ) -> None:
        self.spacing, self.reach, self.edges, self.segment = spacing, reach, edges, segment
        self.powers = np.zeros(4)  # |z|, z², z³, z⁴
        self.square = self.stretch = 0.0
        self.sloped = self.segments = 0
        self.counts = np.zeros(len(edges) - 1)
        lags = (2 * reach + 1, 2 * (width // 2) + 1)
        self.products, self.pairs = np.zeros(lags), np.zeros(lags)
        self.spectrum = np.zeros(segment // 2 + 1)

    def add(self, heights: NDArray[np.float64], inner: slice) -> None:
        dx, dy = self.spacing
        square = slope(heights, dx, 0) ** 2 + slope(heights, dy, 1) ** 2
        square = square[np.isfinite(square)]
        self.square += float(square.sum())
        self.stretch += float((np.sqrt(1.0 + square) - 1.0).sum())
        self.sloped += square.size
        z = np.ascontiguousarray(heights[inner])
        squared = z * z
        self.powers += [np.abs(z).sum(), squared.sum(), (squared * z).sum(), (squared * squared).sum()]
        self.counts += np.histogram(z, self.edges)[0]
        products, pairs = lag_sums(z, np.ones(z.shape, bool), self.reach)
        self.products += products
        self.pairs += pairs
        _, density = psd(np.ascontiguousarray(z.T), dx, segment=self.segment)
        overlap = self.segment // 2
        count = (len(z) - overlap) // (self.segment - overlap)
        self.spectrum += count * density.mean(axis=0)
        self.segments += count


def _bounds(strip: Strip, first: int, stop: int, segment: int) -> list[tuple[int, int]]:
    """First and last rows of pieces of nearly one length."""
    rows = stop - first
    least = max(segment, 2 * MARGIN + 1)
    if rows < least:
        raise InputError("strip to survey", f"{rows} rows", f"at least {least} rows")
    longest = max(PIECE // strip.shape[1], FEWEST_ROWS, 2 * segment)
    edges = np.linspace(first, stop, -(-rows // longest) + 1).astype(int)
    return list(pairwise(edges.tolist()))


def _with_margin(strip: Strip, bounds: list[tuple[int, int]]) -> Iterator[tuple[NDArray[np.float64], slice]]:
    """Pieces with the rows beside them that slopes need, and where the piece is in it."""
    first, stop = bounds[0][0], bounds[-1][1]
    for start, end in bounds:
        before, beyond = max(first, start - MARGIN), min(stop, end + MARGIN)
        yield strip.rows(before, beyond), slice(start - before, end - before)
