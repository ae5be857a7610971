"""Material ratio (Abbott) curve, and what it says of peaks, core and valleys."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from asperity.arguments import Array
from asperity.errors import InputError
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.levelling import nearly_complete
from asperity.surfaces.spectra import (
    autocorrelation,
    autocorrelation_lengths,
    psd_1d,
    psd_2d,
    psd_radial,
    texture_direction,
)

CORE = 0.4
"""Share of the curve over which its secant is least steep, and which the straight line is fitted to."""


@dataclass(frozen=True)
class Stratified:
    """Parameters of a surface of peaks, core and valleys, m and shares of all points."""

    core: float  # height of the core, Sk or Rk
    peaks: float  # reduced height of the peaks above it, Spk or Rpk
    valleys: float  # reduced depth of the valleys below it, Svk or Rvk
    peak_ratio: float  # material ratio where peaks end, Smr1 or Rmr1
    valley_ratio: float  # where valleys begin, Smr2 or Rmr2


def material_ratio_curve(heights: Array, points: int = 201) -> tuple[Array, Array]:
    """Material ratio (points,), 0 to 1, and the heights, m, that this share of the points reach or exceed."""
    ratio = np.linspace(0.0, 1.0, points)
    return ratio, np.quantile(heights[np.isfinite(heights)], 1.0 - ratio)


def stratified(heights: Array) -> Stratified:
    """Core, peaks and valleys by the straight line through the flattest 40 % of the material ratio curve.

    ISO 25178-2:2021 and ISO 21920-2:2021, as ISO 13565-2:1996 has it: of all secants over 40 % the first of
    least slope, the line of least squares of the heights there, from 0 to 100 % the core; peaks and valleys
    are as high as triangles of the same area over the share that they have. Heights of any shape, m; missing
    ones are left out.
    """
    falling = np.sort(heights[np.isfinite(heights)])[::-1]
    count = falling.size
    ratio = (np.arange(count) + 0.5) / count
    width = min(max(2, round(CORE * count)), count - 1)
    drop = falling[:-width] - falling[width:]
    first = int(np.argmax(drop <= drop.min() + 1e-9 * (falling[0] - falling[-1])))
    part = slice(first, first + width + 1)
    slope, at_zero = np.polyfit(ratio[part], falling[part], 1)
    top, bottom = at_zero, at_zero + slope
    above, below = np.maximum(falling - top, 0.0), np.maximum(bottom - falling, 0.0)
    peak_ratio, valley_ratio = np.mean(above > 0.0), 1.0 - np.mean(below > 0.0)
    return Stratified(
        float(top - bottom),
        float(2.0 * above.mean() / peak_ratio) if peak_ratio else 0.0,
        float(2.0 * below.mean() / (1.0 - valley_ratio)) if valley_ratio < 1.0 else 0.0,
        float(peak_ratio),
        float(valley_ratio),
    )


__all__ = [
    "Statistic",
    "areal_statistics",
    "autocorrelation",
    "autocorrelation_lengths",
    "line_statistics",
    "profile_statistics",
    "psd_1d",
    "psd_2d",
    "psd_radial",
    "rms_slope",
    "shortest_wave_for",
    "texture_direction",
]


@dataclass(frozen=True)
class Statistic:
    """One roughness parameter."""

    symbol: str  # of the standard, as ``"Sq"``
    value: float  # in `unit`; NaN if it cannot be determined
    unit: str  # ``"m"``, ``"rad"``, or ``"1"`` for a ratio
    bandwidth: tuple[float, float]  # shortest and longest wavelength of the data, m
    meaning: str  # what it is, in words


def areal_statistics(surface: HeightMap, bandwidth: tuple[float, float] | None = None) -> list[Statistic]:
    """Areal roughness parameters, ISO 25178-2:2021, from Sq to Std, and Sk, Spk, Svk, Smr1, Smr2.

    Levelled heights, m; the mean is removed here, missing points are left out; for Std up to 5 % are filled.
    `bandwidth` is that of
    filtered data, m; by default from two samples to the longest side. Slopes are by the seven-point formula
    of ISO 4287:1997. If the autocorrelation does not fall to 0.2 inside the map, there is a warning, see
    `autocorrelation_lengths`.
    """
    band = bandwidth or (2.0 * min(surface.spacing), max(surface.size))
    square = _square_slope(surface)
    slopes = (float(np.nanmean(square)), float(np.nanmean(np.sqrt(1.0 + square)) - 1.0))
    lengths = autocorrelation_lengths(surface)
    whole = nearly_complete(surface)
    direction = Statistic(
        "Std",
        np.nan if whole is None else texture_direction(whole),
        "rad",
        band,
        "direction from x in which it varies most, across the lay; means little where Str is above 0.5",
    )
    named = areal_parameters(*_amplitudes(surface.heights), slopes, lengths, band)
    return [*named, direction, *_stratified("S", surface.heights, band)]


def areal_parameters(
    powers: Array,
    total: float,
    slopes: tuple[float, float],
    lengths: tuple[float, float],
    band: tuple[float, float],
) -> list[Statistic]:
    """Name areal roughness parameters, in the order of `areal_statistics`, up to Str.

    `powers` are the means of |z|, z², z³ and z⁴ about the mean, m to m⁴; `total` is from the highest peak to
    the lowest valley, m; `slopes` are the mean square slope, and the developed area beyond the plane's over
    it; `lengths` those at which the autocorrelation falls to 0.2 and `band` the wavelengths, shortest and
    longest, m.
    """
    shortest, longest = lengths
    return [
        *_named("S", powers, total, band),
        Statistic("Sdq", float(np.sqrt(slopes[0])), "1", band, "rms slope"),
        Statistic("Sdr", slopes[1], "1", band, "developed area beyond the plane's"),
        Statistic("Sal", shortest, "m", band, "shortest lag at which the autocorrelation falls to 0.2"),
        Statistic("Str", shortest / longest, "1", band, "shortest over longest such lag; 1 is isotropic"),
    ]


def rms_slope(surface: HeightMap) -> float:
    """Rms slope Sdq of levelled heights, m; missing points are left out."""
    return float(np.sqrt(np.nanmean(_square_slope(surface))))


def _square_slope(surface: HeightMap) -> Array:
    along, across = (slope(surface.heights, d, axis) for axis, d in enumerate(surface.spacing))
    return along**2 + across**2


def shortest_wave_for(surface: HeightMap, slope: float) -> float:
    """Cut-off, m, that leaves a surface with an rms slope when `levelling.band_limit` has it.

    Complete, levelled heights, m. At most the surface's longest side; zero where it has no larger slope.
    """
    qx, qy, density = psd_2d(surface)
    square = qx[:, None] ** 2 + qy**2
    power = square * density * (qx[1] - qx[0]) * (qy[1] - qy[0])
    if power.sum() <= slope**2:
        return 0.0

    def left(octaves: float) -> float:
        """What a Gaussian of half transmission at this cut-off leaves too much."""
        passed = 4.0 ** -(square * (2.0**octaves / (2.0 * np.pi)) ** 2)
        return float(np.sum(power * passed)) - slope**2

    ends = np.log2(min(surface.spacing)) - 4.0, np.log2(max(surface.size))
    return float(2.0 ** (scipy.optimize.brentq(left, *ends, xtol=1e-3) if left(ends[1]) < 0.0 else ends[1]))


def profile_statistics(
    profile: Profile, bandwidth: tuple[float, float] | None = None, section: float | None = None
) -> list[Statistic]:
    """Profile roughness parameters, ISO 21920-2:2021: Rq to Rku, Rt, Rz, Rp, Rv, Rdq, and Rk to Rmr2.

    Levelled heights, m; the mean is removed here, missing points are left out. `bandwidth` is that of
    filtered data, m; by default from two samples to the length. The whole line is the evaluation length; Rz,
    Rp and Rv are means over its whole sections of a length, m: a fifth of it by default; of a line that was
    filtered, the nesting index of the L-filter. Slopes are by the seven-point formula of ISO 4287:1997.
    """
    band = bandwidth or (2.0 * profile.spacing, profile.size)
    rms_slope = float(np.sqrt(np.nanmean(slope(profile.heights, profile.spacing, 0) ** 2)))
    powers, total = _amplitudes(profile.heights)
    heights = profile.heights - np.nanmean(profile.heights)
    points = max(1, min(round(section / profile.spacing) if section else heights.size // 5, heights.size))
    pieces = heights[: heights.size // points * points].reshape(-1, points)
    pieces = pieces[np.isfinite(pieces).any(axis=1)]
    peak, valley = float(np.nanmax(pieces, axis=1).mean()), float(-np.nanmin(pieces, axis=1).mean())
    mean = f"mean of {len(pieces)} sections of {1e3 * points * profile.spacing:.4g} mm"
    return [
        *_named("R", powers, total, band)[:-1],
        Statistic("Rt", total, "m", band, "highest peak to lowest valley"),
        Statistic("Rz", peak + valley, "m", band, f"highest peak to lowest valley, {mean}"),
        Statistic("Rp", peak, "m", band, f"highest peak above the mean line, {mean}"),
        Statistic("Rv", valley, "m", band, f"lowest valley below the mean line, {mean}"),
        Statistic("Rdq", rms_slope, "1", band, "rms slope"),
        *_stratified("R", heights, band),
    ]


def _stratified(letter: str, heights: Array, band: tuple[float, float]) -> list[Statistic]:
    found = stratified(heights)
    values = [
        ("k", found.core, "m", "height of the core, by the flattest 40 % of the material ratio curve"),
        ("pk", found.peaks, "m", "reduced height of the peaks above the core"),
        ("vk", found.valleys, "m", "reduced depth of the valleys below the core"),
        ("mr1", found.peak_ratio, "1", "material ratio of the peaks (Smrk1 of 2021)"),
        ("mr2", found.valley_ratio, "1", "material ratio above the valleys (Smrk2 of 2021)"),
    ]
    return [
        Statistic(letter + name, value, unit, band, meaning.replace("Smrk", f"{letter}mrk"))
        for name, value, unit, meaning in values
    ]


def line_statistics(
    lines: Sequence[Profile], bandwidth: tuple[float, float] | None = None, section: float | None = None
) -> list[tuple[Statistic, float, float]]:
    """Roughness parameters of lines side by side, with the lowest and highest value of a single line.

    Bandwidth and section as of `profile_statistics`: their means over the lines, as ISO 21920-2:2021 takes
    over evaluation lengths.
    """
    rough = [line for line in lines if np.nanmax(line.heights) > np.nanmin(line.heights)] or list(lines[:1])
    each = [profile_statistics(line, bandwidth, section) for line in rough]
    found = []
    for same in zip(*each, strict=True):
        values = [item.value for item in same]
        found.append((replace(same[0], value=float(np.mean(values))), min(values), max(values)))
    return found


def _amplitudes(heights: Array) -> tuple[Array, float]:
    """Means of |z|, z², z³ and z⁴, and the total height."""
    z = heights[np.isfinite(heights)]
    z = z - z.mean()
    if not z.any():
        raise InputError("surface", "equal heights everywhere", "a surface with roughness")
    return np.array([np.abs(z).mean(), *(np.mean(z**n) for n in (2, 3, 4))]), float(np.ptp(z))


def _named(letter: str, powers: Array, total: float, band: tuple[float, float]) -> list[Statistic]:
    rms = float(np.sqrt(powers[1]))
    values = [
        ("q", rms, "m", "rms height"),
        ("a", float(powers[0]), "m", "mean absolute height"),
        ("sk", float(powers[2] / rms**3), "1", "skewness; negative for valleys in a plateau"),
        ("ku", float(powers[3] / rms**4), "1", "kurtosis; 3 for normally distributed heights"),
        ("z", total, "m", "highest peak to lowest valley"),
    ]
    return [Statistic(letter + name, value, unit, band, meaning) for name, value, unit, meaning in values]


def slope(heights: Array, spacing: float, axis: int) -> Array:
    """Seven-point derivative along an axis at points with three neighbours on either side, others NaN.

    Heights and spacing in m.
    """
    known = inner_slope(heights, spacing, axis)
    if np.isnan(known).all():
        received = f"no seven valid points in a row along axis {axis}"
        raise InputError("surface", received, "enough valid points for slopes", "Use fill first.")
    found = np.full(heights.shape, np.nan)
    np.moveaxis(found, axis, 0)[3:-3] = np.moveaxis(known, axis, 0)
    return found


def inner_slope(heights: Array, spacing: float, axis: int) -> Array:
    """Seven-point derivative along an axis, without the three points at either end; heights, spacing in m."""
    z = np.moveaxis(heights, axis, 0)
    n = z.shape[0] - 6
    if n < 1:
        raise InputError("surface", f"{z.shape[0]} points along axis {axis}", "at least 7 points for slopes")
    found = z[6:] - z[:n]
    found -= 9.0 * (z[5 : n + 5] - z[1 : n + 1])
    found += 45.0 * (z[4 : n + 4] - z[2 : n + 2])
    found /= 60.0 * spacing
    return np.moveaxis(found, 0, axis)
