"""Roughness parameters, each with the bandwidth it holds for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from asperity.errors import InputError
from asperity.surfaces.areal_psd import psd_1d, psd_2d, psd_radial
from asperity.surfaces.correlation import autocorrelation, autocorrelation_lengths
from asperity.surfaces.heightmap import HeightMap, Profile

__all__ = [
    "Statistic",
    "areal_statistics",
    "autocorrelation",
    "autocorrelation_lengths",
    "profile_statistics",
    "psd_1d",
    "psd_2d",
    "psd_radial",
]


@dataclass(frozen=True)
class Statistic:
    """One roughness parameter.

    Parameters
    ----------
    symbol : str
        Symbol of the standard, as ``"Sq"``.
    value : float
        Value in `unit`; NaN if it cannot be determined.
    unit : str
        ``"m"``, or ``"1"`` for a ratio.
    bandwidth : tuple of float
        Shortest and longest wavelength of the data, m.
    meaning : str
        What it is, in words.
    """

    symbol: str
    value: float
    unit: str
    bandwidth: tuple[float, float]
    meaning: str


def areal_statistics(surface: HeightMap, bandwidth: tuple[float, float] | None = None) -> list[Statistic]:
    """Areal roughness parameters Sq, Sa, Ssk, Sku, Sz, Sdq, Sdr, Sal, Str.

    Parameters
    ----------
    surface : HeightMap
        Levelled heights, m; the mean is removed here, missing points are left out.
    bandwidth : tuple of float, optional
        Shortest and longest wavelength, m, if the data were filtered. Default: two samples to the
        longest side.

    Returns
    -------
    list of Statistic
        In the order above.

    Raises
    ------
    InputError
        If the map has fewer than seven points along an axis or is flat.

    Warns
    -----
    ShortRecordWarning
        If the autocorrelation does not fall to 0.2 inside the map; see `autocorrelation_lengths`.

    References
    ----------
    ISO 25178-2:2021. Slopes by the seven-point formula of ISO 4287:1997.
    """
    band = bandwidth or (2.0 * min(surface.spacing), max(surface.size))
    dx, dy = surface.spacing
    square = _slope(surface.heights, dx, 0) ** 2 + _slope(surface.heights, dy, 1) ** 2
    shortest, longest = autocorrelation_lengths(surface)
    return [
        *_amplitudes("S", surface.heights, band),
        Statistic("Sdq", float(np.sqrt(np.nanmean(square))), "1", band, "rms slope"),
        Statistic(
            "Sdr",
            float(np.nanmean(np.sqrt(1.0 + square)) - 1.0),
            "1",
            band,
            "developed area beyond the plane's",
        ),
        Statistic("Sal", shortest, "m", band, "shortest lag at which the autocorrelation falls to 0.2"),
        Statistic("Str", shortest / longest, "1", band, "shortest over longest such lag; 1 is isotropic"),
    ]


def profile_statistics(profile: Profile, bandwidth: tuple[float, float] | None = None) -> list[Statistic]:
    """Profile roughness parameters Rq, Ra, Rsk, Rku, Rz, Rdq.

    Parameters
    ----------
    profile : Profile
        Levelled heights, m; the mean is removed here, missing points are left out.
    bandwidth : tuple of float, optional
        Shortest and longest wavelength, m, if the data were filtered. Default: two samples to the
        length.

    Returns
    -------
    list of Statistic
        In the order above, over the whole line as one evaluation length.

    Raises
    ------
    InputError
        If the line has fewer than seven points or is flat.

    References
    ----------
    ISO 21920-2:2021; slopes by the seven-point formula of ISO 4287:1997. Rz is the total
    height over the evaluation length.
    """
    band = bandwidth or (2.0 * profile.spacing, profile.size)
    slope = _slope(profile.heights, profile.spacing, 0)
    rms_slope = float(np.sqrt(np.nanmean(slope**2)))
    return [
        *_amplitudes("R", profile.heights, band),
        Statistic("Rdq", rms_slope, "1", band, "rms slope"),
    ]


def _amplitudes(letter: str, heights: NDArray[np.float64], band: tuple[float, float]) -> list[Statistic]:
    z = heights[np.isfinite(heights)]
    z = z - z.mean()
    rms = float(np.sqrt(np.mean(z**2)))
    if rms == 0.0:
        raise InputError("surface", "equal heights everywhere", "a surface with roughness")
    values = [
        ("q", rms, "m", "rms height"),
        ("a", float(np.mean(np.abs(z))), "m", "mean absolute height"),
        ("sk", float(np.mean((z / rms) ** 3)), "1", "skewness; negative for valleys in a plateau"),
        ("ku", float(np.mean((z / rms) ** 4)), "1", "kurtosis; 3 for normally distributed heights"),
        ("z", float(np.ptp(z)), "m", "highest peak to lowest valley"),
    ]
    return [Statistic(letter + name, value, unit, band, meaning) for name, value, unit, meaning in values]


def _slope(heights: NDArray[np.float64], spacing: float, axis: int) -> NDArray[np.float64]:
    """Seven-point derivative at the points that have three neighbours on either side, others NaN."""
    z = np.moveaxis(heights, axis, 0)
    if z.shape[0] < 7:
        raise InputError("surface", f"{z.shape[0]} points along axis {axis}", "at least 7 points for slopes")
    n = z.shape[0] - 6
    weights = (-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0)
    slope = np.full(z.shape, np.nan)
    slope[3:-3] = sum(w * z[k : k + n] for k, w in enumerate(weights) if w) / (60.0 * spacing)
    if np.isnan(slope).all():
        received = f"no seven valid points in a row along axis {axis}"
        raise InputError("surface", received, "enough valid points for slopes", "Use fill first.")
    return np.moveaxis(slope, 0, axis)
