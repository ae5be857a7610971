"""Roughness parameters of maps, lines and strips of any length; whether a map is the same everywhere."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import reduce
from itertools import pairwise, starmap

import numpy as np
import scipy

from asperity.arguments import Array, require
from asperity.ranks import Ranked, known_pieces
from asperity.spectra import psd
from asperity.surfaces import cleaning, levelling, spectra, synthesis
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.levelling import PIECE
from asperity.surfaces.strip import Strip
from asperity.written_numbers import rounded

SEVEN_POINTS = ((3, 1.0), (2, -9.0), (1, 45.0))
"""Distances, points, and sixty times the weights of differences of heights in the slope between them."""
SLOPES = ("dq", "dr")
"""Parameters of the slopes of a map."""
MARGIN = 3
"""Neighbours on either side that the slope at a point needs."""
CORE = 0.4
"""Share of the curve over which its secant is least steep, and which the straight line is fitted to."""

PARAMETERS = {
    "q": ("m", "rms height"),
    "a": ("m", "mean absolute height"),
    "sk": ("1", "skewness; negative for valleys in a plateau"),
    "ku": ("1", "kurtosis; 3 for normally distributed heights"),
    "z": ("m", "highest peak to lowest valley"),
    "t": ("m", "highest peak to lowest valley"),
    "p": ("m", "highest peak above the mean line"),
    "v": ("m", "lowest valley below the mean line"),
    "dq": ("1", "rms slope"),
    "dr": ("1", "developed area beyond the plane's"),
    "al": ("m", "shortest lag at which the autocorrelation falls to 0.2"),
    "tr": ("1", "shortest over longest such lag; 1 is isotropic"),
    "td": (
        "rad",
        "direction from x in which it varies most, across the lay; means little where Str is above 0.5",
    ),
    "k": ("m", "height of the core, by the flattest 40 % of the material ratio curve"),
    "pk": ("m", "reduced height of the peaks above the core"),
    "vk": ("m", "reduced depth of the valleys below the core"),
    "mr1": ("1", "material ratio of the peaks ({}mrk1 of 2021)"),
    "mr2": ("1", "material ratio above the valleys ({}mrk2 of 2021)"),
}
"""Unit and meaning of the parameters of the standards, by their symbols without the letter S or R."""


@dataclass(frozen=True)
class Statistic:
    """One roughness parameter."""

    symbol: str  # of the standard, as ``"Sq"``
    value: float  # in `unit`; NaN if it cannot be determined
    unit: str  # ``"m"``, ``"rad"``, or ``"1"`` for a ratio
    bandwidth: tuple[float, float]  # shortest and longest wavelength of the data, m
    meaning: str  # what it is, in words


def _statistics(
    letter: str, values: dict[str, float], band: tuple[float, float], mean: str = ""
) -> list[Statistic]:
    """Name values by their symbols; `mean` says of a line what its section heights are means of."""
    named = []
    for symbol, value in values.items():
        unit, meaning = PARAMETERS[symbol]
        meaning = meaning.format(letter) + mean * (letter == "R" and symbol in ("z", "p", "v"))
        named.append(Statistic(letter + symbol, float(value), unit, band, meaning))
    return named


def areal_statistics(surface: HeightMap, bandwidth: tuple[float, float] | None = None) -> list[Statistic]:
    """Areal roughness parameters, ISO 25178-2:2021, from Sq to Std, and Sk, Spk, Svk, Smr1, Smr2.

    Levelled heights, m; the mean is removed here, missing points are left out; for Sal, Str and Std up to 5 %
    are filled.
    `bandwidth` is that of filtered data, m; by default from two samples to the longest side. Slopes are by
    the seven-point formula of ISO 4287:1997, NaN where no seven are in a row. If the autocorrelation does
    not fall to 0.2 inside the map, there is a warning, see `autocorrelation_lengths`.
    """
    steepness = _steepness(_slope_sums(surface.heights, surface.spacing))
    whole = cleaning.nearly_complete(surface)
    texture = dict.fromkeys(("al", "tr", "td"), np.nan)
    if whole is not None:
        shortest, longest = spectra.autocorrelation_lengths(whole)
        texture = {"al": shortest, "tr": shortest / longest, "td": spectra.texture_direction(whole)}
    values = _amplitudes(*_powers(surface.heights)) | steepness | texture | stratified(surface.heights)
    return _statistics("S", values, bandwidth or (2.0 * min(surface.spacing), max(surface.size)))


def profile_statistics(
    profile: Profile, bandwidth: tuple[float, float] | None = None, section: float | None = None
) -> list[Statistic]:
    """Profile roughness parameters, ISO 21920-2:2021: Rq to Rku, Rt, Rz, Rp, Rv, Rdq, and Rk to Rmr2.

    Levelled heights, m; the mean is removed here, missing points are left out. `bandwidth` is that of
    filtered data, m; by default from two samples to the length. The whole line is the evaluation length; Rz,
    Rp and Rv are means over its whole sections of a length, m: a fifth of it by default; of a line that was
    filtered, the nesting index of the L-filter. Slopes are by the seven-point formula of ISO 4287:1997, NaN
    where no seven are in a row.
    """
    values = _amplitudes(*_powers(profile.heights))
    mean = _mean_height(profile.heights)
    count = profile.heights.size
    points = max(1, min(round(section / profile.spacing) if section else count // 5, count))
    sections = profile.heights[: count // points * points].reshape(-1, points)
    peaks = np.fmax.reduce(sections, axis=1) - mean
    valleys = np.fmin.reduce(sections, axis=1) - mean
    whole = np.isfinite(peaks)
    peak = float(peaks[whole].mean())
    valley = float(-valleys[whole].mean())
    values |= {"t": values.pop("z"), "z": peak + valley, "p": peak, "v": valley, "dq": _rms_slope_of(profile)}
    length = points * profile.spacing
    written = f"{rounded(length, 4)} m" if length >= 1.0 else f"{rounded(1e3 * length, 4)} mm"
    means = f", mean of {whole.sum()} sections of {written}"
    band = bandwidth or (2.0 * profile.spacing, profile.size)
    return _statistics("R", values | stratified(profile.heights, mean), band, means)


def line_statistics(
    lines: Sequence[Profile], bandwidth: tuple[float, float] | None = None, section: float | None = None
) -> list[tuple[Statistic, float, float]]:
    """Roughness parameters of lines side by side, with the lowest and highest value of a single line.

    Bandwidth and section as of `profile_statistics`: their means over the lines, as ISO 21920-2:2021 takes
    over evaluation lengths.
    """
    rough = [line for line in lines if np.nanmax(line.heights) > np.nanmin(line.heights)] or list(lines[:1])
    means = []
    for same in zip(*(profile_statistics(line, bandwidth, section) for line in rough), strict=True):
        values = [item.value for item in same]
        means.append((replace(same[0], value=float(np.mean(values))), min(values), max(values)))
    return means


def _mean_height(heights: Array) -> float:
    """Mean of the heights that are known."""
    sums = [(piece.sum(), piece.size) for piece in known_pieces([heights])]
    total, count = map(sum, zip(*sums, strict=True))
    return float(total / count)


def _powers(heights: Array) -> tuple[Array, float]:
    """Means of |z|, z², z³ and z⁴ about the mean, and the total height."""
    mean = _mean_height(heights)
    sums = np.zeros(4)
    count = 0
    low = np.inf
    high = -np.inf
    for piece in known_pieces([heights]):
        z = piece - mean
        sums += [np.abs(z).sum(), *(np.sum(z**n) for n in (2, 3, 4))]
        count += z.size
        low = min(low, z.min(initial=np.inf))
        high = max(high, z.max(initial=-np.inf))
    require(sums[0], "surface", "equal heights everywhere", "a surface with roughness")
    return sums / count, float(high - low)


def _amplitudes(powers: Array, total: float) -> dict[str, float]:
    """Parameters of the heights, from the means of their powers, m to m⁴, and the total height, m."""
    rms = float(np.sqrt(powers[1]))
    return {"q": rms, "a": powers[0], "sk": powers[2] / rms**3, "ku": powers[3] / rms**4, "z": total}


def rms_slope(surface: HeightMap) -> float:
    """Rms slope Sdq of levelled heights, m; missing points are left out."""
    found = _steepness(_slope_sums(surface.heights, surface.spacing))["dq"]
    received = "no seven valid points in a row along both axes"
    allowed = "enough valid points for slopes"
    require(math.isfinite(found), "surface", received, allowed, "Use fill first.")
    return found


def _steepness(sums: Array) -> dict[str, float]:
    """Rms slope and developed area beyond the plane's, of `_slope_sums`; NaN of no slope."""
    square, area, count = sums
    return {"dq": math.sqrt(square / count), "dr": area / count} if count else dict.fromkeys(SLOPES, math.nan)


def _slope_sums(heights: Array, spacing: tuple[float, float]) -> Array:
    """Sums of squares of slopes, of developed areas beyond the plane's, and number of these, piece by piece.

    At all points with three neighbours on every side; heights and spacings in m.
    """
    rows = max(1, PIECE // (4 * heights.shape[1]))
    sums = np.zeros(3)
    for first in range(0, len(heights) - 2 * MARGIN, rows):
        square = _square_slopes(heights[first : first + rows + 2 * MARGIN], spacing)
        known = square[np.isfinite(square)]
        sums += [known.sum(), (np.sqrt(1.0 + known) - 1.0).sum(), known.size]
    return sums


def _square_slopes(heights: Array, spacing: tuple[float, float]) -> Array:
    """Squares of slopes at all points with three neighbours on every side; heights and spacings in m."""
    along = _slopes(heights[:, MARGIN:-MARGIN], spacing[0], 0)
    return along**2 + _slopes(heights[MARGIN:-MARGIN], spacing[1], 1) ** 2


def _rms_slope_of(line: Profile) -> float:
    """Rms slope of a line by the seven-point formula, of all points with three neighbours on either side."""
    total = 0.0
    known = 0
    count = len(line.heights)
    for first in range(0, count - 2 * MARGIN, PIECE):
        slopes = _slopes(line.heights[first : first + PIECE + 2 * MARGIN], line.spacing, 0)
        total += float(np.nansum(slopes**2))
        known += int(np.isfinite(slopes).sum())
    return math.sqrt(total / known) if known else math.nan


def _slopes(heights: Array, spacing: float, axis: int) -> Array:
    """Seven-point derivative along an axis, without the three points at either end; heights, spacing in m."""
    z = np.moveaxis(heights, axis, 0)
    n = max(z.shape[0] - 2 * MARGIN, 0)
    slope = np.zeros_like(z[:n])
    for k, weight in SEVEN_POINTS:
        slope += weight / (60.0 * spacing) * (z[3 + k : n + 3 + k] - z[3 - k : n + 3 - k])
    return np.moveaxis(slope, 0, axis)


def material_ratio_curve(known: Ranked, points: int = 201) -> tuple[Array, Array]:
    """Material ratio (points,), 0 to 1, and the heights, m, that this share of the points reach or exceed."""
    ratio = np.linspace(0.0, 1.0, points)
    return ratio, known.quantiles(1.0 - ratio)


def stratified(heights: Array, mean: float = 0.0) -> dict[str, float]:
    """Core, peaks and valleys by the straight line through the flattest 40 % of the material ratio curve.

    ISO 25178-2:2021 and ISO 21920-2:2021, as ISO 13565-2:1996 has it: of all secants over 40 % the first of
    least slope, the line of least squares of the heights there, from 0 to 100 % the core; peaks and valleys
    are as high as triangles of the same area over the share that they have. Heights of any shape, m, from
    their mean on; missing ones are left out. By the symbols of `PARAMETERS`: k, pk and vk, m, and the
    material ratios mr1, where peaks end, and mr2, where valleys begin.
    """
    known = Ranked([heights])
    count = known.count
    width = min(max(2, round(CORE * count)), count - 1)
    first = _flattest(known, width)
    level, slope = _line_through(known, first, first + width + 1)
    level -= mean
    top = level - slope * (first + 0.5 * width + 0.5) / count
    bottom = top + slope
    peaks, above = _beyond(known, 1.0, mean + top)
    valleys, below = _beyond(known, -1.0, mean + bottom)
    ratios = {"mr1": above / count, "mr2": 1.0 - below / count}
    return {"k": top - bottom, "pk": 2.0 * peaks, "vk": 2.0 * valleys} | ratios


def _line_through(known: Ranked, first: int, last: int) -> tuple[float, float]:
    """Mean of the values from one rank to before another, from the highest on, and slope of the line of least
    squares through them over the share of all."""
    middle = 0.5 * (first + last - 1)
    total = 0.0
    along = 0.0
    squares = 0.0
    for start in range(first, last, PIECE):
        stop = min(start + PIECE, last)
        piece = _falling(known, start, stop)
        about = (np.arange(start, stop) - middle) / known.count
        total += float(piece.sum())
        along += float(about @ piece)
        squares += float(about @ about)
    return total / (last - first), along / squares


def _falling(known: Ranked, first: int, last: int) -> Array:
    """Values of some ranks, from the highest on, (last - first,)."""
    return known.between(known.count - last, known.count - first)[::-1]


def _beyond(known: Ranked, sign: float, level: float) -> tuple[float, int]:
    """How far values are beyond a level, above it or below, on the mean, and how many; 0 of none."""
    sums = [0.0, 0]
    for piece in known.pieces():
        beyond = sign * (piece - level)
        sums = [sums[0] + float(beyond.sum(where=beyond > 0.0)), sums[1] + np.count_nonzero(beyond > 0.0)]
    return sums[0] / max(sums[1], 1), int(sums[1])


def _flattest(known: Ranked, width: int) -> int:
    """First point of a falling curve from which on it falls least, or nearly, over a width, points."""
    count = known.count - width
    pieces = [(first, min(first + PIECE, count)) for first in range(0, count, PIECE)]

    def drops(first: int, last: int) -> Array:
        return _falling(known, first, last) - _falling(known, first + width, last + width)

    most = min(float(drops(*piece).min()) for piece in pieces) + 1e-9 * (known.highest - known.lowest)
    found = ((first, drops(first, last) <= most) for first, last in pieces)
    return next(first + int(np.argmax(flat)) for first, flat in found if flat.any())


FEWEST_ROWS = 1024
"""Rows of such a piece, at least: correlations are known up to half of them."""


@dataclass(frozen=True, eq=False)
class StripSurvey:
    """What a whole strip is like."""

    # areal roughness parameters up to Str, as of `areal_statistics`; none of a flat strip
    statistics: list[Statistic]
    wavenumber: Array  # (f,), cycles per metre
    spectrum: Array  # (f,), one-sided PSD along the strip, mean over its lines, m³


def survey_strip(strip: Strip, segment: int, first: int = 0, stop: int | None = None) -> StripSurvey:
    """Survey all rows of a strip, reading it twice and never holding more than a piece.

    Complete heights, m; their mean is removed here. Segments of the spectrum have `segment` rows. Pairs of
    points in different pieces do not count towards the autocorrelation, and segments of the spectrum end with
    their piece; all else is as if the strip were one map. Warns as `autocorrelation_lengths` does.
    """
    stop = strip.shape[0] if stop is None else stop
    bounds = _bounds(strip, first, stop, segment)
    total = 0.0
    low = np.inf
    high = -np.inf
    for start, end in bounds:
        heights = strip.rows(start, end)
        total += float(heights.sum())
        low = min(low, float(heights.min()))
        high = max(high, float(heights.max()))
    del heights
    points = (stop - first) * strip.shape[1]
    mean = total / points
    reach = min(end - start for start, end in bounds) // 2

    def sums(start: int, end: int) -> tuple[Array, ...]:
        before = max(first, start - MARGIN)
        beyond = min(stop, end + MARGIN)
        rows = strip.rows(before, beyond) - mean
        inner = slice(start - before, end - before)
        return *_sums(rows, inner, strip.spacing, segment), spectra.lag_products(rows[inner], reach)

    added = reduce(lambda these, those: tuple(map(np.add, these, those)), starmap(sums, bounds))
    powers, slopes, densities, segments, products = added
    statistics = []
    if high > low:
        sides = (stop - first) * strip.spacing[0], strip.shape[1] * strip.spacing[1]
        values = _amplitudes(powers / points, high - low)
        values |= _steepness(slopes)
        pairs = spectra.lag_pairs(stop - first, strip.shape[1], reach, len(bounds))
        shortest, longest = spectra.lengths_of(products / pairs, strip.spacing)
        values |= {"al": shortest, "tr": shortest / longest}
        statistics = _statistics("S", values, (2.0 * min(strip.spacing), max(sides)))
    wavenumber = np.asarray(np.fft.rfftfreq(segment, strip.spacing[0]), dtype=np.float64)
    return StripSurvey(statistics, wavenumber, densities / segments)


def _bounds(strip: Strip, first: int, stop: int, segment: int) -> list[tuple[int, int]]:
    """First and last rows of pieces of nearly one length."""
    rows = stop - first
    least = max(segment, 2 * MARGIN + 1)
    require(rows >= least, "strip to survey", f"{rows} rows", f"at least {least} rows")
    longest = max(PIECE // strip.shape[1], FEWEST_ROWS, 2 * segment)
    edges = np.linspace(first, stop, -(-rows // longest) + 1).astype(int)
    return list(pairwise(edges.tolist()))


def _sums(rows: Array, inner: slice, spacing: tuple[float, float], segment: int) -> tuple[Array, ...]:
    """What is added up over pieces of a strip, of rows about the mean, m, of which the inner ones count.

    Of |z|, z², z³ and z⁴; those of `_slope_sums`; spectra, m³, and the number of segments that they are of.
    """
    slopes = _slope_sums(rows, spacing)
    z = rows[inner]
    squared = z * z
    powers = np.array([np.abs(z).sum(), squared.sum(), (squared * z).sum(), (squared * squared).sum()])
    segments = np.array((len(z) - segment // 2) // (segment - segment // 2), dtype=np.float64)
    density = psd(np.ascontiguousarray(z.T), spacing[0], segment=segment)[1]
    return powers, slopes, segments * density.mean(axis=0), segments


# --- whether a measured map is the same everywhere

SIGNIFICANCE = 0.05
TILES = (4, 4)
"""Tiles that a map is cut into."""
MOST_POINTS = 192
"""Points along a side on which the test is made: short waves add little to the mean square of a tile."""
FEWEST_POINTS = 8
"""Points along a tile's side that are left."""


@dataclass(frozen=True, eq=False)
class Homogeneity:
    """Outcome of the homogeneity test."""

    # (kx, ky), root mean square height of each tile about the map's mean plane, m
    tile_rms: Array
    variation: float  # coefficient of variation of the tiles' mean squares
    expected: float  # median of the same over stationary surrogates
    p_value: float  # share of surrogates, this map included, that vary at least as much

    @property
    def homogeneous(self) -> bool:
        """Whether the tiles differ no more than chance makes them, at 5 % significance."""
        return self.p_value > SIGNIFICANCE


def homogeneity(surface: HeightMap, *, surrogates: int = 39, seed: int = 0) -> Homogeneity:
    """Test whether the mean square of tiles varies more than on a stationary surface.

    The surrogates are pieces of a stationary surface with the spectrum and the height distribution of the map
    (see `asperity.surfaces.synthesis.from_map`), levelled and tiled as the map is; there are at least 19, and
    the smallest p-value is 1/(surrogates + 1). Rows and columns left over by the tiles are not used.

    One-sided rank test (Monte Carlo test), on at most 192 points along a side (J. Theiler et al., Physica D
    58 (1992) 77: surrogate data). Finds patches and trends of roughness larger than a tile; a change of the
    spectrum at equal mean square goes unseen.
    """
    allowed = f"2 points or more in each of {TILES[0]} × {TILES[1]} tiles"
    fit = all(n >= 2 * count for n, count in zip(surface.shape, TILES, strict=True))
    require(fit, "surface", f"{surface.shape} points", allowed)
    whole = levelling.level(surface)
    coarse = _coarse(whole)
    tile_rms = np.sqrt(_tile_mean_squares(whole))
    del whole
    measured = _tile_mean_squares(levelling.level(coarse))
    nx, ny = coarse.shape
    variation = float(measured.std() / measured.mean())
    long = synthesis.from_map(coarse, (nx * surrogates, ny), seed).heights
    pieces = (HeightMap(long[k * nx : (k + 1) * nx], coarse.spacing) for k in range(surrogates))
    squares = [_tile_mean_squares(levelling.level(piece)) for piece in pieces]
    chance = np.array([s.std() / s.mean() for s in squares])
    p_value = (1.0 + float(np.sum(chance >= variation))) / (surrogates + 1.0)
    return Homogeneity(tile_rms, variation, float(np.median(chance)), p_value)


def _coarse(surface: HeightMap) -> HeightMap:
    """The surface on fewer points where it has more than the test needs."""
    room = min(n / (FEWEST_POINTS * count) for n, count in zip(surface.shape, TILES, strict=True))
    step = max(1.0, min(max(surface.shape) / MOST_POINTS, room))
    return levelling.resample(surface, (step * surface.spacing[0], step * surface.spacing[1]))


def _tile_mean_squares(surface: HeightMap) -> Array:
    px, py = (n // k for n, k in zip(surface.shape, TILES, strict=True))
    tiles = ((slice(i * px, (i + 1) * px), slice(j * py, (j + 1) * py)) for i, j in np.ndindex(TILES))
    return np.array([np.mean(np.square(surface.heights[tile])) for tile in tiles]).reshape(TILES)


def more_than_chance(p_values: Sequence[float]) -> bool:
    """Whether more maps fail the test than chance makes fail, at 5 % significance.

    One of one, two of two to seven, three of eight or more, and so on: the binomial tail.
    """
    count = sum(p <= SIGNIFICANCE for p in p_values)
    return bool(scipy.special.bdtrc(count - 1, len(p_values), SIGNIFICANCE) <= SIGNIFICANCE * (1 + 1e-9))
