"""The contact filter: how much of a line texture reaches the contact force, by wavenumber and state."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.signal import fftconvolve, firwin2
from scipy.signal.windows import hann

from asperity.errors import InputError
from asperity.reduction.texture import StateTexture

Normalise = Literal["low-wavenumber", "tangent"]

FLOOR = 1e-3
"""Smallest magnitude of a fitted filter (−60 dB)."""
LEAST_POWER = 1e-8
"""Texture power, relative to its largest, below which a wavenumber says nothing about the filter."""


@dataclass(frozen=True, eq=False)
class FilterEstimate:
    """Filter of one sample, estimated at each state.

    Attributes
    ----------
    wavenumber : ndarray, shape (k,)
        Cycles/m.
    magnitude : ndarray, shape (s, k)
        |Ĥ| of Eq. 2.6, as printed: no sign.
    signed : ndarray, shape (s, k)
        Real part of the cross-spectral estimate: the force regressed on the line textures.
    usable : ndarray of bool, shape (k,)
        Where the texture has power.
    stiffness : ndarray, shape (s,)
        k_0 used, N/m.
    """

    wavenumber: NDArray[np.float64]
    magnitude: NDArray[np.float64]
    signed: NDArray[np.float64]
    usable: NDArray[np.bool_]
    stiffness: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ContactFilter:
    """Ensemble mean of fitted contact filters.

    Attributes
    ----------
    approaches : ndarray, shape (s,)
        Approaches of the states, m.
    wavenumber : ndarray, shape (k,)
        Cycles/m.
    magnitude, spread : ndarray, shape (s, k)
        Mean of the fitted magnitudes and their standard deviation between samples.
    signed : ndarray, shape (s, k)
        Mean of the signed estimates.
    stiffness : ndarray, shape (s,)
        Mean of k_0, N/m.
    normalise : str
        ``"low-wavenumber"`` (printed: both spectra share their long-wave asymptote) or ``"tangent"``
        (k_0 = dF/dδ: keeps what a patch wider than the lateral correlation averages away).
    """

    approaches: NDArray[np.float64]
    wavenumber: NDArray[np.float64]
    magnitude: NDArray[np.float64]
    spread: NDArray[np.float64]
    signed: NDArray[np.float64]
    stiffness: NDArray[np.float64]
    normalise: str


def punch_filter(wavenumber: ArrayLike, semi_axis: ArrayLike) -> NDArray[np.float64]:
    """Closed form of the filter for small roughness that is uniform across the rolling direction.

    Parameters
    ----------
    wavenumber : array_like
        Cycles/m.
    semi_axis : array_like
        Semi-axis of the contact in the rolling direction, m; broadcast against `wavenumber`.

    Returns
    -------
    ndarray
        sin q/q with q = 2π wavenumber × semi-axis; negative beyond q = π.
    """
    return np.sinc(2.0 * np.asarray(wavenumber) * np.asarray(semi_axis))


def estimate_filter(
    forces: NDArray[np.float64],
    lines: NDArray[np.float64],
    spacing: float,
    *,
    tangent_stiffness: ArrayLike | None = None,
    asymptote: ArrayLike | None = None,
) -> FilterEstimate:
    """Compare scanned forces with a point force that follows line textures (Eqs. 2.4–2.6).

    Parameters
    ----------
    forces : ndarray, shape (s, m)
        F_c(x_m, r_i) at constant approach, N.
    lines : ndarray, shape (l, m)
        Heights of the line textures that cover the nominal contact width, at the same positions, m,
        peaks positive.
    spacing : float
        Distance of the positions, m.
    tangent_stiffness : array_like, shape (s,), optional
        k_0 = k_t of each state, N/m. Without it k_0 makes both spectra agree at low wavenumbers.
    asymptote : array_like, shape (s,), optional
        Wavenumber below which the spectra must agree, cycles/m; the lowest bins if there are none below.

    Returns
    -------
    FilterEstimate
        The estimate; the mean of the force is removed before the Hann window, and *power*, not
        amplitude, is averaged over the lines.

    Raises
    ------
    InputError
        If forces and lines differ in length, are too short, or the texture is flat.
    """
    f, z = np.atleast_2d(forces), np.atleast_2d(lines)
    m = f.shape[1]
    if z.shape[1] != m or m < 16:
        raise InputError(
            "scan for the filter", f"{m} forces, {z.shape[1]} heights", "equally many, at least 16"
        )
    window = hann(m, sym=False)
    force = np.fft.rfft((f - f.mean(axis=1, keepdims=True)) * window)[:, 1:]
    texture = np.fft.rfft((z - z.mean(axis=1, keepdims=True)) * window)[:, 1:]
    wavenumber = np.fft.rfftfreq(m, spacing)[1:]
    power = np.mean(np.abs(texture) ** 2, axis=0)
    if not power.max() > 0.0:
        raise InputError("line textures of the filter", "a flat surface", "a surface with texture")
    cross = np.real(force * np.conj(texture.mean(axis=0)))
    centres, (force_power, cross, power) = _banded(wavenumber, np.abs(force) ** 2, cross, power)
    if tangent_stiffness is not None:
        k0 = np.broadcast_to(np.asarray(tangent_stiffness, dtype=np.float64), (f.shape[0],))
    else:
        k0 = _common_asymptote(centres, force_power, power, asymptote)
    usable = power[0] > LEAST_POWER * power.max()
    scale = np.where(k0 > 0.0, k0, np.inf)[:, None]
    safe = np.where(usable, power, np.inf)
    return FilterEstimate(
        centres, np.sqrt(force_power / safe) / scale, cross / safe / scale, usable, np.asarray(k0)
    )


def _banded(
    wavenumber: NDArray, *spectra: NDArray
) -> tuple[NDArray[np.float64], tuple[NDArray[np.float64], ...]]:
    """Add up spectra in bands of a twelfth octave, single bins where those are wider."""
    band = np.round(12.0 * np.log2(wavenumber / wavenumber[0])).astype(int)
    _, first = np.unique(band, return_index=True)
    counts = np.diff(np.append(first, len(band)))
    centres = np.add.reduceat(wavenumber, first) / counts
    return centres, tuple(np.add.reduceat(np.atleast_2d(s), first, axis=1) for s in spectra)


def _common_asymptote(
    wavenumber: NDArray, force_power: NDArray, power: NDArray, asymptote: ArrayLike | None
) -> NDArray[np.float64]:
    """k_0 for which force and texture have the same power at low wavenumbers."""
    states = force_power.shape[0]
    limit = np.broadcast_to(np.asarray(0.0 if asymptote is None else asymptote), (states,))
    k0 = np.empty(states)
    for i in range(states):
        count = max(3, int(np.count_nonzero(wavenumber <= limit[i])))
        k0[i] = math.sqrt(force_power[i, :count].sum() / power[0, :count].sum())
    return k0


def fit_filter(estimate: FilterEstimate, degree: int, *, through_one: bool) -> NDArray[np.float64]:
    """Fit each magnitude by a polynomial in dB over the usable wavenumbers, by least squares.

    Parameters
    ----------
    estimate : FilterEstimate
        Filter of one sample.
    degree : int
        Degree of the polynomial.
    through_one : bool
        Whether the fit is one at wavenumber zero (the printed normalisation) or free there.

    Returns
    -------
    ndarray, shape (s, k)
        Fitted magnitudes between `FLOOR` and one, held constant above the last usable wavenumber.
    """
    k, usable = estimate.wavenumber, estimate.usable
    degree = min(degree, max(1, int(usable.sum()) - 2))
    highest = k[usable][-1]
    x = np.minimum(k, highest) / highest
    powers = np.arange(1 if through_one else 0, degree + 1)
    basis = x[:, None] ** powers
    fitted = np.empty_like(estimate.magnitude)
    for i, magnitude in enumerate(estimate.magnitude):
        level = 20.0 * np.log10(np.maximum(magnitude[usable], FLOOR))
        coefficients = np.linalg.lstsq(basis[usable], level, rcond=None)[0]
        fitted[i] = 10.0 ** (basis @ coefficients / 20.0)
    return np.clip(fitted, FLOOR, 1.0)


def mean_filter(
    estimates: Sequence[FilterEstimate],
    approaches: ArrayLike,
    *,
    degree: int = 6,
    normalise: Normalise = "low-wavenumber",
) -> ContactFilter:
    """Average the fitted filters of all samples.

    Parameters
    ----------
    estimates : sequence of FilterEstimate
        One a sample, on common wavenumbers.
    approaches : array_like, shape (s,)
        Approaches of the states, m.
    degree : int
        Degree of the polynomial fit.
    normalise : {"low-wavenumber", "tangent"}
        How k_0 was chosen.

    Returns
    -------
    ContactFilter
        Mean and spread between samples.
    """
    through_one = normalise == "low-wavenumber"
    fits = np.array([fit_filter(e, degree, through_one=through_one) for e in estimates])
    return ContactFilter(
        np.asarray(approaches, dtype=np.float64),
        estimates[0].wavenumber,
        fits.mean(axis=0),
        fits.std(axis=0, ddof=1) if len(fits) > 1 else np.zeros(fits.shape[1:]),
        np.mean([e.signed for e in estimates], axis=0),
        np.mean([e.stiffness for e in estimates], axis=0),
        normalise,
    )


def tap_count(spacing: float, largest_semi_axis: float) -> int:
    """Least even J with J dx ≥ 4 a_max.

    Parameters
    ----------
    spacing : float
        Sampling of the line texture, m.
    largest_semi_axis : float
        Largest semi-axis of the contact in the rolling direction, m.

    Returns
    -------
    int
        J; the filter has J + 1 taps.
    """
    return 2 * math.ceil(2.0 * largest_semi_axis / spacing)


def design_fir(contact_filter: ContactFilter, spacing: float, order: int) -> NDArray[np.float64]:
    """Design linear-phase FIR filters with the mean magnitudes (Matlab's fir2).

    Parameters
    ----------
    contact_filter : ContactFilter
        Mean filter.
    spacing : float
        Sampling of the line texture, m.
    order : int
        J, even.

    Returns
    -------
    ndarray, shape (s, J + 1)
        Taps b_j of each state, symmetric; they sum to one under the printed normalisation, else to the
        magnitude at the lowest wavenumber.

    Raises
    ------
    InputError
        If the order is odd or less than 2.
    """
    if order < 2 or order % 2:
        raise InputError(
            "order of the contact filter", order, "an even number ≥ 2", "J + 1 taps need J even."
        )
    nyquist = 0.5 / spacing
    grid = np.linspace(0.0, 1.0, 513)
    taps = np.empty((len(contact_filter.approaches), order + 1))
    for i, magnitude in enumerate(contact_filter.magnitude):
        at_zero = 1.0 if contact_filter.normalise == "low-wavenumber" else magnitude[0]
        k = np.concatenate([[0.0], contact_filter.wavenumber])
        gain = np.interp(grid * nyquist, k, np.concatenate([[at_zero], magnitude]))
        taps[i] = firwin2(order + 1, grid, gain)
        taps[i] *= at_zero / taps[i].sum()
    return taps


def filtered_texture(
    heights: NDArray[np.float64],
    spacing: float,
    taps: NDArray[np.float64],
    approaches: ArrayLike,
    start: float = 0.0,
) -> StateTexture:
    """Filter the line texture of a path for every state (Eq. 2.7).

    Parameters
    ----------
    heights : ndarray, shape (m,)
        Line texture, m, peaks positive.
    spacing : float
        Distance of the points, m.
    taps : ndarray, shape (s, J + 1)
        From `design_fir`.
    approaches : array_like, shape (s,)
        Approaches of the states, m.
    start : float
        Position of the first point, m.

    Returns
    -------
    StateTexture
        h̃(m, r_i) = Σ_j b_j(r_i) h(m − J/2 + j) with h = −z, m, positive away from the contact. The first
        and last J/2 points see a texture mirrored at the ends.
    """
    half = taps.shape[1] // 2
    padded = np.pad(-np.asarray(heights, dtype=np.float64), half, mode="reflect")
    result = np.array([fftconvolve(padded, b, mode="valid") for b in taps])
    return StateTexture(result, np.asarray(approaches, dtype=np.float64), start, spacing)
