"""Where a case lies on the law accuracy map: how rough it is for its contact, and how hard it shakes it."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from asperity.reduction.areal import areal_texture
from asperity.reference.law_accuracy import HIGH, LOW, Place
from asperity.scenarios.geometry import Geometry
from asperity.spectra import psd
from asperity.surfaces.correlation import CORRELATION_THRESHOLD
from asperity.surfaces.strip import Strip
from asperity.threads import thread_count

ROWS = 2**15
"""Most rows of a path, from its middle, that are looked at: a length that is transformed fast."""
LINES = 8
"""Lines along a path that are transformed at a time: all of them would take much memory."""
STEEPNESS = 8
"""Power of the wavenumber with which waves are left out below the lowest: a steeper edge rings longer."""
RESOLUTION = 10.0
"""Step of the frequencies at which the linear force is summed, Hz, where the path is long enough."""

SquareTransfer = Callable[[float, NDArray[np.float64]], NDArray[np.float64] | None]
"""Mean square of the linear contact force per height of the texture (f,), (N/m)², by contact stiffness, N/m,
and frequencies (f,), Hz; None of bodies for which it is not known."""


def place_of(path: Strip, shape: Geometry, speed: float, square_transfer: SquareTransfer) -> Place | None:
    """Find the place of a texture under the bodies of a case on the map, if there is one.

    Waves that excite less than 100 Hz at the speed, m/s, are left out: the bodies follow them. Smooth paths
    have no place, nor have bodies of which no linear force is known.
    """
    heights, felt = _heard(path, shape, speed)
    if not heights.any():
        return None
    approach = shape.hertz.approach(shape.load)
    along, across = correlation_lengths(heights, shape.spacing)
    a, b = shape.semi_axes
    force = _linear_force(felt, shape, speed, square_transfer)
    if force is None:
        return None
    return Place(
        roughness=float(np.sqrt(np.mean(heights**2))) / approach,
        correlation=along / (2.0 * a),
        across=across / (2.0 * b),
        within=float(np.sqrt(np.mean((heights[:, heights.shape[1] // 2] - felt) ** 2))) / approach,
        dynamic=force / shape.load,
        highest_wavenumber=2.0 * math.pi * HIGH / speed * a,
    )


def _heard(path: Strip, shape: Geometry, speed: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Heights (rows, ny) and the plane (rows,) that the patch feels, m, of what excites 100 Hz or more."""
    beside = shape.body.shape[0] // 2  # at its ends the patch sees nothing
    rows = min(path.shape[0], ROWS + 2 * beside)
    first = (path.shape[0] - rows) // 2
    heights = path.rows(first, first + rows)
    felt = -areal_texture(heights, shape.spacing, [0.0], [shape.semi_axes]).heights[0]
    known, lowest = slice(beside, rows - beside), LOW / speed
    dx = shape.spacing[0]
    return without_slow(heights[known], dx, lowest), without_slow(felt[known], dx, lowest)


def without_slow(heights: NDArray[np.float64], spacing: float, lowest: float) -> NDArray[np.float64]:
    """Heights (rows, ...) without waves along x below a wavenumber, cycles/m.

    The edge is smooth, half the height at the wavenumber. They are mirrored at their ends, and what is within
    one such wave of these, up to an eighth, is cut off.
    """
    rows = len(heights)
    share = np.arange(rows) / (2.0 * rows * spacing * lowest)
    gain = (share**STEEPNESS / (1.0 + share**STEEPNESS))[:, None]
    cut = min(round(1.0 / (lowest * spacing)), rows // 8)
    kept = np.empty((rows - 2 * cut, *heights.shape[1:]))
    lines, found = heights.reshape(rows, -1), kept.reshape(len(kept), -1)
    for first in range(0, lines.shape[1], LINES):
        among = slice(first, first + LINES)
        spectra = fft.dct(lines[:, among], axis=0, workers=thread_count())  # of mirrored lines
        spectra *= gain
        passed = fft.idct(spectra, axis=0, overwrite_x=True, workers=thread_count())
        found[:, among] = passed[cut : rows - cut]
    return kept


def correlation_lengths(heights: NDArray[np.float64], spacing: tuple[float, float]) -> tuple[float, float]:
    """Lags along and across, m, at which the mean product of heights (rows, ny) falls to 0.2 of their square.

    The threshold is that of ISO 25178-2 for Sal. Where it is not reached: half the length, or half the width.
    """
    rows, columns = heights.shape
    furthest = rows // 2
    period = fft.next_fast_len(rows + furthest, real=True)
    power = np.zeros(period // 2 + 1)
    for first in range(0, columns, LINES):
        spectra = fft.rfft(heights[:, first : first + LINES], period, axis=0, workers=thread_count())
        power += np.einsum("fl,fl->f", spectra.real, spectra.real)
        power += np.einsum("fl,fl->f", spectra.imag, spectra.imag)
    along = fft.irfft(power, period)[: furthest + 1] / (columns * (rows - np.arange(furthest + 1)))
    across = [
        np.einsum("xy,xy->", heights[:, : columns - lag], heights[:, lag:]) / (rows * (columns - lag))
        for lag in range(columns // 2 + 1)
    ]
    return _fallen(along, spacing[0]), _fallen(np.array(across), spacing[1])


def _fallen(products: NDArray[np.float64], step: float) -> float:
    share = products / max(products[0], np.finfo(float).tiny)
    below = np.flatnonzero(share <= CORRELATION_THRESHOLD)
    if not below.size:
        return step * (len(share) - 1)
    k = max(int(below[0]), 1)
    fall = max(share[k - 1] - share[k], np.finfo(float).tiny)
    return step * (k - 1 + float((share[k - 1] - CORRELATION_THRESHOLD) / fall))


def _linear_force(
    felt: NDArray[np.float64], shape: Geometry, speed: float, square_transfer: SquareTransfer
) -> float | None:
    """Rms force, N, of the linear contact that follows the felt plane (rows,), m, up to 10 kHz."""
    dx = shape.spacing[0]
    wavenumber, density = psd(felt, dx, segment=min(len(felt), round(speed / RESOLUTION / dx)))
    frequency = wavenumber * speed
    among = (frequency >= LOW) & (frequency <= 2.0 * HIGH)
    stiffness = shape.hertz.tangent_stiffness(shape.hertz.approach(shape.load))
    transfer = square_transfer(stiffness, frequency[among])
    if transfer is None:
        return None
    return float(np.sqrt(density[among] @ transfer * (wavenumber[1] - wavenumber[0])))
