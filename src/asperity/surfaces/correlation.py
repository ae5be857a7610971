"""Autocorrelation of a surface and the lengths taken from it."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import NDArray
from scipy import fft, ndimage

from asperity.errors import InputError, ShortRecordWarning
from asperity.surfaces.heightmap import HeightMap

CORRELATION_THRESHOLD = 0.2
"""Default of ISO 25178-3 for Sal and Str."""


def autocorrelation(surface: HeightMap) -> NDArray[np.float64]:
    """Normalised autocorrelation at lags up to half the map.

    Parameters
    ----------
    surface : HeightMap
        Heights, m; the mean is removed, pairs with a missing point are left out.

    Returns
    -------
    ndarray, shape (2 (nx//2) + 1, 2 (ny//2) + 1)
        Mean product of heights at a lag over that at zero lag; zero lag in the middle.

    Raises
    ------
    InputError
        If the heights are all equal.

    References
    ----------
    ISO 25178-2:2021 (autocorrelation function).
    """
    valid = np.isfinite(surface.heights)
    z = np.where(valid, surface.heights - np.nanmean(surface.heights), 0.0)
    if not z.any():
        raise InputError("surface", "equal heights everywhere", "a surface with roughness")
    products, pairs = lag_sums(z, valid, z.shape[0] // 2)
    middle = tuple(n // 2 for n in products.shape)
    mean = products / np.maximum(pairs, 1.0)
    return np.asarray(mean / mean[middle])


def lag_sums(
    heights: NDArray[np.float64], valid: NDArray[np.bool_], reach: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Sums of products of heights at all lags up to half their width, and the numbers of pairs.

    Parameters
    ----------
    heights : ndarray, shape (nx, ny)
        Heights about their mean, m; zero where they are not valid.
    valid : ndarray of bool, shape (nx, ny)
        Where there is a height.
    reach : int
        Largest lag along the first axis, points.

    Returns
    -------
    products, pairs : ndarray, shape (2 reach + 1, 2 (ny//2) + 1)
        m² and numbers; zero lag in the middle.
    """
    lags = (reach, heights.shape[1] // 2)
    size = [fft.next_fast_len(n + lag + 1, real=True) for n, lag in zip(heights.shape, lags, strict=True)]
    products, pairs = (
        fft.irfft2(np.abs(fft.rfft2(a, s=size)) ** 2, s=size) for a in (heights, valid.astype(np.float64))
    )
    kept = np.ix_(*(np.arange(-lag, lag + 1) for lag in lags))
    return products[kept], np.rint(pairs[kept])


def autocorrelation_lengths(
    surface: HeightMap, threshold: float = CORRELATION_THRESHOLD
) -> tuple[float, float]:
    """Shortest and longest lag at which the central lobe of the autocorrelation falls to a threshold.

    Parameters
    ----------
    surface : HeightMap
        Levelled heights, m.
    threshold : float, optional
        Value of the normalised autocorrelation, 0 < threshold < 1.

    Returns
    -------
    shortest, longest : float
        Sal and Sal/Str, m, over directions one degree apart.

    Raises
    ------
    InputError
        If the threshold is out of range or the map is flat.

    Warns
    -----
    ShortRecordWarning
        If the lobe reaches half the map in some direction: the longest lag is then at least the
        one returned, and Str at most the ratio.

    References
    ----------
    ISO 25178-2:2021 (Sal, Str).
    """
    if not 0.0 < threshold < 1.0:
        raise InputError("threshold", threshold, "between 0 and 1")
    return lengths_of(autocorrelation(surface), surface.spacing, threshold)


def lengths_of(
    correlation: NDArray[np.float64],
    spacing: tuple[float, float],
    threshold: float = CORRELATION_THRESHOLD,
) -> tuple[float, float]:
    """Find the lags at which the central lobe of an autocorrelation falls to a threshold.

    Parameters
    ----------
    correlation : ndarray, shape (odd, odd)
        Mean products of heights; zero lag in the middle.
    spacing : tuple of float
        (dx, dy), m.
    threshold : float, optional
        Share of the value at zero lag.

    Returns
    -------
    shortest, longest : float
        As `autocorrelation_lengths`, with its warning.
    """
    lobe = correlation / correlation[tuple(n // 2 for n in correlation.shape)]
    step = np.asarray(spacing)
    reach = np.array([n // 2 for n in lobe.shape]) * step
    coefficients = ndimage.spline_filter(lobe, order=3, mode="mirror")
    lengths, open_ended = [], False
    for angle in np.radians(np.arange(0.0, 180.0)):
        direction = np.array([np.cos(angle), np.sin(angle)])
        limit = float(np.min(reach / np.maximum(np.abs(direction), 1e-12)))
        lags = np.append(np.arange(0.0, limit, step.min() / 4.0), limit)
        points = direction[:, None] * lags / step[:, None] + np.array(lobe.shape)[:, None] // 2
        values = ndimage.map_coordinates(coefficients, points, order=3, mode="mirror", prefilter=False)
        below = np.flatnonzero(values <= threshold)
        if below.size:
            k = int(below[0])
            share = (values[k - 1] - threshold) / (values[k - 1] - values[k])
            lengths.append(lags[k - 1] + share * (lags[k] - lags[k - 1]))
        else:
            lengths.append(limit)
            open_ended = True
    if open_ended:
        message = (
            f"the autocorrelation stays above {threshold:g} up to half the map, {max(lengths):.4g} m: "
            "Str is an upper bound; use a larger map or remove long wavelengths first"
        )
        warnings.warn(message, ShortRecordWarning, stacklevel=2)
    return float(min(lengths)), float(max(lengths))
