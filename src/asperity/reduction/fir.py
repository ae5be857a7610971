"""Filters that a line texture runs through: designed from a contact filter, finite, without delay."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import cho_factor, cho_solve

from asperity.errors import InputError
from asperity.kernels.monotone import shape_preserving
from asperity.reduction.convolving import PIECE, LongConvolution
from asperity.reduction.filter import ContactFilter
from asperity.reduction.texture import StateTexture
from asperity.threads import one_thread_in_linear_algebra

ACCURACY, DOWN_TO = 0.3, -30.0
"""A chosen order meets the fitted filter within so many dB, down to a level in dB."""
GROWTH = 1.25
"""From one order tried to the next."""
LARGEST_ORDER = 4096
"""No longer filter is tried."""
_FINE = 3
"""Points a band at which the response is held against the fit."""


@dataclass(frozen=True, eq=False)
class LineFilter:
    """A contact filter and the taps that apply it."""

    contact_filter: ContactFilter  # what was estimated
    taps: NDArray[np.float64]  # (s, J + 1), b_j of each state, symmetric
    spacing: float  # sampling of the line texture, m

    @property
    def applied(self) -> NDArray[np.float64]:
        """Magnitude that the taps have at the filter's wavenumbers, shape (s, k)."""
        return np.abs(response(self.taps, self.spacing, self.contact_filter.wavenumber))

    @property
    def miss(self) -> float:
        """Largest distance of the applied filter from the fitted one, dB, where that is above `DOWN_TO`."""
        fine = _fine(self.contact_filter)
        return float(_missed(self.taps, self.spacing, fine, _target(self.contact_filter, fine)).max())


def response(taps: NDArray[np.float64], spacing: float, wavenumber: ArrayLike) -> NDArray[np.float64]:
    """Response (s, k) of symmetric taps (s, odd) about their middle one, real and signed.

    Spacing in m, wavenumbers (k,) in cycles/m; one where a wave passes unchanged.
    """
    middle = taps.shape[1] // 2
    cosines = np.cos(2.0 * math.pi * spacing * np.arange(1, middle + 1)[:, None] * np.asarray(wavenumber))
    return np.asarray(taps[:, middle, None] + 2.0 * taps[:, middle + 1 :] @ cosines)


def tap_count(spacing: float, largest_semi_axis: float) -> int:
    """Least even J with J dx ≥ 4 a_max, dx and semi-axis in m; the filter has J + 1 taps."""
    return 2 * math.ceil(2.0 * largest_semi_axis / spacing)


def punch_taps(semi_axes: ArrayLike, spacing: float) -> NDArray[np.float64]:
    """Taps (s, odd) of the closed-form filter sin q/q: the mean over the length of each patch.

    Semi-axes (s,) of the patch in the rolling direction and spacing, m; the taps sum to one.
    """
    a = np.atleast_1d(np.asarray(semi_axes, dtype=np.float64))[:, None]
    half = max(0, math.ceil(float(a.max()) / spacing - 0.5))
    edges = (np.arange(-half, half + 2) - 0.5) * spacing
    return np.asarray(np.diff(np.clip(edges, -a, a), axis=1) / (2.0 * a))


def design_fir(
    contact_filter: ContactFilter,
    spacing: float,
    order: int | None = None,
    *,
    least: int = 2,
    most: int = LARGEST_ORDER,
) -> LineFilter:
    """Design linear-phase FIR filters with the fitted magnitudes, for a line of a spacing, m.

    With an even order J given, by window, as the thesis' (Matlab's fir2). By default J is chosen between two
    orders, and the taps are those of the least relative error: the first tried that meets the fit within 0.3
    dB down to −30 dB; where none does, the largest: see `LineFilter.miss`. Under the printed normalisation
    the taps of each state sum to one.
    """
    if order is not None:
        if order < 2 or order % 2:
            raise InputError(
                "order of the contact filter", order, "an even number ≥ 2", "J + 1 taps need J even."
            )
        return LineFilter(contact_filter, _by_window(contact_filter, spacing, order), spacing)
    most = max(2, 2 * (min(most, LARGEST_ORDER) // 2))
    with one_thread_in_linear_algebra():
        taps = _of_first_order(contact_filter, spacing, min(max(2, least), most), most)
    return LineFilter(contact_filter, taps, spacing)


def _of_first_order(
    contact_filter: ContactFilter, spacing: float, order: int, most: int
) -> NDArray[np.float64]:
    """Taps (s, J + 1) of the first order, from one on, of which no state misses the fit, or of the largest.

    The state that missed it most is asked first: the others need no taps where it misses it again.
    """
    fine = _fine(contact_filter)
    fitted, worst = _target(contact_filter, fine), 0

    @cache
    def target(points: int) -> NDArray[np.float64]:
        return _target(contact_filter, np.arange(points // 2 + 1) / (points * spacing))

    at_zero = _target(contact_filter, np.zeros(1))
    while True:
        points = 2 ** math.ceil(math.log2(max(8 * order, 2048)))
        for states in ([worst], range(len(fitted))):
            designed = [
                _least_relative_error(target(points)[k], contact_filter.wavenumber[0] * spacing, order)
                for k in states
            ]
            taps = np.array(designed) * at_zero[states] / np.sum(designed, axis=1, keepdims=True)
            missed = _missed(taps, spacing, fine, fitted[states])
            if order < most and missed.max() > ACCURACY:
                worst = states[int(np.argmax(missed))]
                break
        else:
            return taps
        order = min(2 * math.ceil(0.5 * GROWTH * order), most)


def _by_window(contact_filter: ContactFilter, spacing: float, order: int) -> NDArray[np.float64]:
    """Taps from the inverse transform of the magnitude under a Hamming window."""
    grid = np.linspace(0.0, 0.5 / spacing, 513)
    gain = _target(contact_filter, grid)
    fine = np.linspace(0.0, 0.5 / spacing, 1 + 2 ** math.ceil(math.log2(order + 1)))
    even = np.fft.irfft([np.interp(fine, grid, row) for row in gain])[:, : order // 2 + 1]
    return _summed(contact_filter, np.hamming(order + 1) * np.hstack((even[:, :0:-1], even)))


def _least_relative_error(target: NDArray[np.float64], lowest: float, order: int) -> NDArray[np.float64]:
    """Taps (J + 1,) with the least squared relative error of the response, octave for octave.

    The target (k,) is at equal steps from wavenumber zero to half the sampling one; below the lowest, in
    cycles per point, all octaves count as that. A response Σ_j c_j cos jω has normal equations of sums and
    differences of lags: those of the transforms of the weight and of the weighted target. As the weight is
    positive, so are they definite.
    """
    points, count = 2 * (len(target) - 1), order // 2 + 1
    wavenumber, least = np.arange(len(target)) / points, 10.0 ** ((DOWN_TO - 3.0) / 20.0)
    weight = 1.0 / (np.maximum(target, least) ** 2 * np.maximum(wavenumber, lowest))
    of_weight, of_target = np.fft.irfft(weight, points), np.fft.irfft(weight * target, points)
    apart = sliding_window_view(np.concatenate([of_weight[count - 1 : 0 : -1], of_weight[:count]]), count)
    together = sliding_window_view(of_weight[: 2 * count - 1], count)
    normal = cho_factor(0.5 * (apart[::-1] + together), overwrite_a=True)
    cosines = cho_solve(normal, of_target[:count])
    return np.concatenate([0.5 * cosines[:0:-1], cosines[:1], 0.5 * cosines[1:]])


def _fine(contact_filter: ContactFilter) -> NDArray[np.float64]:
    """Wavenumbers at which a response is held against the fit, cycles/m."""
    known = contact_filter.wavenumber[contact_filter.excited]
    return np.geomspace(known[0], known[-1], _FINE * known.size)


def _missed(
    taps: NDArray[np.float64],
    spacing: float,
    wavenumber: NDArray[np.float64],
    fitted: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Largest distances (s,) of what taps (s, J + 1) do from fitted magnitudes (s, k) above `DOWN_TO`, dB."""
    wanted = 20.0 * np.log10(fitted)
    applied = 20.0 * np.log10(np.maximum(np.abs(response(taps, spacing, wavenumber)), 1e-9))
    return np.asarray(np.max(np.abs(applied - wanted), axis=1, where=wanted >= DOWN_TO, initial=0.0))


def _target(contact_filter: ContactFilter, wavenumber: NDArray[np.float64]) -> NDArray[np.float64]:
    """Magnitude at any wavenumber: between the fitted ones smooth in dB over octaves, beyond them held.

    Under the printed normalisation it goes on to one at wavenumber zero.
    """
    known, magnitude = contact_filter.wavenumber, contact_filter.magnitude
    inside = np.log(np.clip(wavenumber, known[0], known[-1]))
    found = np.exp(shape_preserving(np.log(known), np.log(magnitude), inside))
    if contact_filter.normalise == "low-wavenumber":
        share = np.minimum(wavenumber / known[0], 1.0)
        found = share * found + (1.0 - share)
    return np.asarray(found)


def _summed(contact_filter: ContactFilter, taps: NDArray[np.float64]) -> NDArray[np.float64]:
    """Taps that let pass what the filter does at wavenumber zero."""
    at_zero = _target(contact_filter, np.zeros(1))
    return np.asarray(taps * at_zero / taps.sum(axis=1, keepdims=True))


def filtered_texture(
    heights: NDArray[np.float64],
    spacing: float,
    taps: NDArray[np.float64],
    approaches: ArrayLike,
    start: float = 0.0,
) -> StateTexture:
    """Filter the line texture (m,) of a path, m, peaks positive, for every state (Eq. 2.7).

    h̃(m, r_i) = Σ_j b_j(r_i) h(m − J/2 + j) with h = −z, m, positive away from the contact, taps (s, J + 1)
    and approaches (s,), m; `start` is the position of the first point, m. The first and last J/2 points see a
    texture mirrored at the ends.
    """
    half = taps.shape[1] // 2
    padded = np.pad(-np.asarray(heights, dtype=np.float64), half, mode="reflect")
    result = LongConvolution(taps[:, None], min(PIECE, len(heights))).of(padded[None])
    return StateTexture(result, np.asarray(approaches, dtype=np.float64), start, spacing)
