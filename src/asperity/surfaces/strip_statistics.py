"""Statistics of a strip of any length, of all its rows, read piece by piece."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from asperity.arguments import Array
from asperity.errors import InputError
from asperity.spectra import psd
from asperity.surfaces.spectra import LagSums, lengths_of
from asperity.surfaces.statistics import Statistic, areal_parameters, inner_slope
from asperity.surfaces.strip import Strip

PIECE = 2**20
"""Points of a strip that are looked at in one go."""
FEWEST_ROWS = 1024
"""Rows of such a piece, at least: correlations are known up to half of them."""
STRETCH = 256
"""Rows of a piece that are looked at together: few enough to stay in the processor's cache."""
LINES = 8
"""Lines of a piece whose spectra are made together."""
BINS = 80
MARGIN = 3
"""Neighbours on either side that the slope at a point needs."""


@dataclass(frozen=True, eq=False)
class StripSurvey:
    """What a whole strip is like."""

    # areal roughness parameters, in the order of `areal_parameters`; none of a flat strip
    statistics: list[Statistic]
    edges: Array  # (81,), heights about the mean, m
    density: Array  # (80,), probability density between them, 1/m
    wavenumber: Array  # (f,), cycles per metre
    spectrum: Array  # (f,), one-sided PSD along the strip, mean over its lines, m³


def survey_strip(strip: Strip, segment: int, first: int = 0, stop: int | None = None) -> StripSurvey:
    """Survey all rows of a strip, reading it twice and never holding more than a piece.

    Complete heights, m; their mean is removed here. Segments of the spectrum have `segment` rows. Pairs of
    points in different pieces do not count towards the autocorrelation, and segments of the spectrum end with
    their piece; all else is as if the strip were one map. Warns as `autocorrelation_lengths` does.
    """
    bounds = _bounds(strip, first, strip.shape[0] if stop is None else stop, segment)
    total, low, high = _extent(strip, bounds)
    points = (bounds[-1][1] - bounds[0][0]) * strip.shape[1]
    mean = total / points
    edges = np.linspace(low - mean, (high if high > low else low + 1e-12) - mean, BINS + 1)
    lengths = [end - start for start, end in bounds]
    lags = LagSums(max(lengths), strip.shape[1], min(lengths) // 2)
    sums = _Sums(strip.spacing, edges, segment, lags)
    _add_all(sums, strip, bounds, mean)
    density = np.asarray(sums.counts / (points * np.diff(edges)))
    spectrum = np.asarray(sums.spectrum / sums.segments)
    wavenumber = np.asarray(np.fft.rfftfreq(segment, strip.spacing[0]), dtype=np.float64)
    statistics = []
    if high > low:
        band = (2.0 * min(strip.spacing), max(points // strip.shape[1] * strip.spacing[0], strip.size[1]))
        amplitudes = sums.powers / points
        correlation = lags.means()
        slopes = (sums.square / sums.sloped, sums.stretch / sums.sloped)
        statistics = areal_parameters(
            amplitudes, high - low, slopes, lengths_of(correlation, strip.spacing), band
        )
    return StripSurvey(statistics, edges, density, wavenumber, spectrum)


class _Sums:
    """What is added up over the pieces of a strip."""

    def __init__(self, spacing: tuple[float, float], edges: Array, segment: int, lags: LagSums) -> None:
        self.spacing, self.edges, self.segment, self.lags = spacing, edges, segment, lags
        self.powers = np.zeros(4)  # |z|, z², z³, z⁴
        self.square = self.stretch = 0.0
        self.sloped = self.segments = 0
        self.counts = np.zeros(len(edges) - 1)
        self.spectrum = np.zeros(segment // 2 + 1)

    def add(self, heights: Array, inner: slice) -> None:
        for first in range(MARGIN, len(heights) - MARGIN, STRETCH):
            stop = min(first + STRETCH, len(heights) - MARGIN)
            self._add_slopes(heights[first - MARGIN : stop + MARGIN])
        z = heights[inner]
        for first in range(0, len(z), STRETCH):
            self._add_heights(z[first : first + STRETCH])
        self.lags.add(z)
        self._add_spectrum(z)

    def _add_slopes(self, rows: Array) -> None:
        """Add what slopes are at all points but those within the margin."""
        dx, dy = self.spacing
        square = inner_slope(rows[:, MARGIN:-MARGIN], dx, 0) ** 2
        square += inner_slope(rows[MARGIN:-MARGIN], dy, 1) ** 2
        self.square += float(square.sum())
        self.stretch += float((np.sqrt(1.0 + square) - 1.0).sum())
        self.sloped += square.size

    def _add_heights(self, z: Array) -> None:
        squared = z * z
        self.powers += [np.abs(z).sum(), squared.sum(), (squared * z).sum(), (squared * squared).sum()]
        self.counts += np.histogram(z, len(self.counts), (self.edges[0], self.edges[-1]))[0]

    def _add_spectrum(self, z: Array) -> None:
        overlap = self.segment // 2
        count = (len(z) - overlap) // (self.segment - overlap)
        for first in range(0, z.shape[1], LINES):
            lines = np.ascontiguousarray(z[:, first : first + LINES].T)
            _, density = psd(lines, self.spacing[0], segment=self.segment)
            self.spectrum += count / z.shape[1] * density.sum(axis=0)
        self.segments += count


def _extent(strip: Strip, bounds: list[tuple[int, int]]) -> tuple[float, float, float]:
    """Sum, smallest and largest of all heights, m."""
    total, low, high = 0.0, np.inf, -np.inf
    for start, end in bounds:
        heights = strip.rows(start, end)
        total += float(heights.sum())
        low, high = min(low, float(heights.min())), max(high, float(heights.max()))
    return total, low, high


def _add_all(sums: _Sums, strip: Strip, bounds: list[tuple[int, int]], mean: float) -> None:
    """Add all pieces about a mean, m; none of them is held afterwards."""
    for heights, inner in _with_margin(strip, bounds, mean):
        sums.add(heights, inner)


def _bounds(strip: Strip, first: int, stop: int, segment: int) -> list[tuple[int, int]]:
    """First and last rows of pieces of nearly one length."""
    rows = stop - first
    least = max(segment, 2 * MARGIN + 1)
    if rows < least:
        raise InputError("strip to survey", f"{rows} rows", f"at least {least} rows")
    longest = max(PIECE // strip.shape[1], FEWEST_ROWS, 2 * segment)
    edges = np.linspace(first, stop, -(-rows // longest) + 1).astype(int)
    return list(pairwise(edges.tolist()))


def _with_margin(strip: Strip, bounds: list[tuple[int, int]], mean: float) -> Iterator[tuple[Array, slice]]:
    """Pieces about a mean, m, with the rows beside them that slopes need, and where the piece is in it."""
    first, stop = bounds[0][0], bounds[-1][1]
    for start, end in bounds:
        before, beyond = max(first, start - MARGIN), min(stop, end + MARGIN)
        yield strip.rows(before, beyond) - mean, slice(start - before, end - before)
