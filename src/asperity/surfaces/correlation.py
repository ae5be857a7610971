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
    size = [fft.next_fast_len(n + n // 2 + 1, real=True) for n in z.shape]
    products, pairs = (
        fft.irfft2(np.abs(fft.rfft2(a, s=size)) ** 2, s=size) for a in (z, valid.astype(np.float64))
    )
    mean = products / np.maximum(np.rint(pairs), 1.0)
    rows, columns = (np.arange(-(n // 2), n // 2 + 1) for n in z.shape)
    return np.asarray(mean[np.ix_(rows, columns)] / mean[0, 0])


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
    lobe = autocorrelation(surface)
    spacing = np.asarray(surface.spacing)
    reach = np.array([n // 2 for n in lobe.shape]) * spacing
    coefficients = ndimage.spline_filter(lobe, order=3, mode="mirror")
    lengths, open_ended = [], False
    for angle in np.radians(np.arange(0.0, 180.0)):
        direction = np.array([np.cos(angle), np.sin(angle)])
        limit = float(np.min(reach / np.maximum(np.abs(direction), 1e-12)))
        lags = np.append(np.arange(0.0, limit, spacing.min() / 4.0), limit)
        points = direction[:, None] * lags / spacing[:, None] + np.array(lobe.shape)[:, None] // 2
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
