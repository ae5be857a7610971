"""The contact filter: how much of a line texture reaches the contact force, by wavenumber and state."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import median_filter
from scipy.signal.windows import hann

from asperity.errors import InputError

Normalise = Literal["low-wavenumber", "tangent"]

BANDS = 12
"""Bands of an octave."""
FLOOR = 1e-3
"""Smallest magnitude of a fitted filter (−60 dB)."""
FEWEST_POSITIONS = 16
"""Positions of a scan, at least, from which a filter is estimated."""
HIGHEST = 0.8
"""Largest wavenumber of a filter to that which the positions of the scan can tell apart."""
FITTED_WIDTH, FITTED_BINS = 1.0 / 6.0, 1.5
"""Half the width of the average that is the fit: octaves, and bins of the spectra where those are wider."""
CUT_OFF, CUT_OFF_SLOPE = 1e-2, 4
"""Line power times k^slope below this share of its largest value at longer waves excites no contact."""


@dataclass(frozen=True, eq=False)
class FilterSpectra:
    """What one scanned strip says about the contact filter: spectra added up in bands.

    Attributes
    ----------
    wavenumber : ndarray, shape (k,)
        Cycles/m, mean of each band.
    bins : ndarray, shape (k,)
        Lines of the spectra in each band.
    force : ndarray, shape (s, k)
        Power of the scanned force in each state, N².
    lines : ndarray, shape (s, k)
        Power of the line textures under the patch of each state, mean over the lines, m².
    mean_line : ndarray, shape (s, k)
        Power of their mean, m².
    cross : ndarray, shape (s, k)
        Cross spectrum of the force with their mean, N m; complex.
    """

    wavenumber: NDArray[np.float64]
    bins: NDArray[np.intp]
    force: NDArray[np.float64]
    lines: NDArray[np.float64]
    mean_line: NDArray[np.float64]
    cross: NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class ContactFilter:
    """Contact filters of an ensemble of strips.

    Attributes
    ----------
    approaches : ndarray, shape (s,)
        Approaches of the states, m.
    wavenumber : ndarray, shape (k,)
        Cycles/m.
    excited : ndarray of bool, shape (k,)
        Where the texture has the power to say something; beside it the filter is held.
    raw : ndarray, shape (s, k)
        |Ĥ| of Eq. 2.6 over all strips: root of the ratio of their powers. No sign.
    magnitude, spread : ndarray, shape (s, k)
        The fit to it, and the standard deviation of the strips' own fits.
    signed, coherence : ndarray, shape (s, k)
        Force regressed on the mean line under the patch, over k_t, and the share of the force's power that
        this explains. Each strip and line of the spectra counts by its power, and so by its coherence.
    asymptotic_stiffness, tangent_stiffness : ndarray, shape (s,)
        k_0 that makes force and texture agree at low wavenumbers, mean over the strips, and k_t, N/m.
    long_wave_share : ndarray, shape (s,)
        Share of the lines' power at the low wavenumbers from which k_0 is taken.
    normalise : str
        ``"low-wavenumber"`` (printed: both spectra share their long-wave asymptote) or ``"tangent"``
        (k_0 = k_t: keeps what a patch wider than the lateral correlation averages away).
    """

    approaches: NDArray[np.float64]
    wavenumber: NDArray[np.float64]
    excited: NDArray[np.bool_]
    raw: NDArray[np.float64]
    magnitude: NDArray[np.float64]
    spread: NDArray[np.float64]
    signed: NDArray[np.float64]
    coherence: NDArray[np.float64]
    asymptotic_stiffness: NDArray[np.float64]
    tangent_stiffness: NDArray[np.float64]
    long_wave_share: NDArray[np.float64]
    normalise: Normalise


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


def filter_spectra(
    forces: NDArray[np.float64],
    lines: NDArray[np.float64],
    spacing: float,
    half_widths: ArrayLike | None = None,
) -> FilterSpectra:
    """Take the spectra of a scanned force and of the line textures that it follows (Eqs. 2.4, 2.5).

    Parameters
    ----------
    forces : ndarray, shape (s, m)
        F_c(x_m, r_i) at constant approach, N.
    lines : ndarray, shape (l, m · stride)
        Heights of the line textures from the first position on, m, peaks positive; an odd number of lines,
        the middle one that of the contact. They may be finer than the scan by a whole number, so that waves
        too short for its positions do not appear as longer ones.
    spacing : float
        Distance of the points of the lines, m.
    half_widths : array_like of int, shape (s,), optional
        Lines on either side of the middle that the nominal patch of each state covers; all by default.

    Returns
    -------
    FilterSpectra
        Means are removed before the Hann window, and *power*, not amplitude, is averaged over the lines.
        Bands are a twelfth of an octave wide, or a bin where that is wider.

    Raises
    ------
    InputError
        If forces and lines do not fit, are too short, or the texture is flat.
    """
    f, z = np.atleast_2d(forces), np.atleast_2d(lines)
    states, m = f.shape
    stride, rest = divmod(z.shape[1], m)
    if rest or m < FEWEST_POSITIONS:
        received = f"{m} forces, {z.shape[1]} heights"
        allowed = f"a whole number of heights a force, at least {FEWEST_POSITIONS}"
        raise InputError("scan for the filter", received, allowed)
    middle = z.shape[0] // 2
    half = np.full(states, middle) if half_widths is None else np.minimum(half_widths, middle)
    highest = int(HIGHEST * (m // 2))
    force = _windowed(f)[:, 1 : highest + 1]
    texture = _windowed(z)[:, 1 : highest + 1] / stride
    under = [texture[middle - h : middle + h + 1] for h in half]
    power = np.array([np.mean(np.abs(t) ** 2, axis=0) for t in under])
    if not np.ptp(z) > 0.0:
        raise InputError("line textures of the filter", "a flat surface", "a surface with texture")
    mean = np.array([t.mean(axis=0) for t in under])
    wavenumber = np.arange(1, highest + 1) / (z.shape[1] * spacing)
    band = np.round(BANDS * np.log2(wavenumber / wavenumber[0])).astype(int)
    _, first = np.unique(band, return_index=True)
    bins = np.diff(np.append(first, len(band)))
    sums = [
        np.add.reduceat(spectrum, first, axis=-1)
        for spectrum in (np.abs(force) ** 2, power, np.abs(mean) ** 2, force * np.conj(mean))
    ]
    return FilterSpectra(np.add.reduceat(wavenumber, first) / bins, bins, *sums)


def _windowed(rows: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Spectra of rows without their means, under a Hann window."""
    return np.fft.rfft((rows - rows.mean(axis=1, keepdims=True)) * hann(rows.shape[1], sym=False))


def estimate_filter(
    strips: Sequence[FilterSpectra],
    approaches: ArrayLike,
    tangent_stiffness: ArrayLike,
    *,
    normalise: Normalise = "tangent",
    asymptote: ArrayLike = 0.0,
    degree: int | None = None,
) -> ContactFilter:
    """Compare scanned forces with a point force that follows line textures (Eq. 2.6), and fit the ratio.

    Parameters
    ----------
    strips : sequence of FilterSpectra
        One a strip, on common wavenumbers.
    approaches : array_like, shape (s,)
        Approaches of the states, m.
    tangent_stiffness : array_like, shape (s,)
        k_t of each state, N/m.
    normalise : {"low-wavenumber", "tangent"}
        Whether k_0 makes both spectra of each strip agree at low wavenumbers, as printed, or is k_t.
    asymptote : array_like, shape (s,), optional
        Wavenumber below which spectra agree under the former, cycles/m; at least the three lowest bands.
    degree : int, optional
        Degree of the polynomial, in dB over wavenumber, that is fitted to the ratio of each strip by least
        squares, as printed; the fits are averaged. By default the powers of all strips are averaged over a
        sixth of an octave: a polynomial of low degree cannot hold the knee of the filter.

    Returns
    -------
    ContactFilter
        The fit lies between `FLOOR` and one.
    """
    k, lines = strips[0].wavenumber, np.array([s.lines for s in strips])
    forces = np.array([s.force for s in strips])
    tangent = np.broadcast_to(np.asarray(tangent_stiffness, dtype=np.float64), lines.shape[1:2])
    limit = np.broadcast_to(np.asarray(asymptote, dtype=np.float64), tangent.shape)
    low = (k <= limit[:, None]) | (np.arange(k.size) < 3)
    anchored = np.sqrt((forces * low).sum(axis=2) / (lines * low).sum(axis=2))
    printed, whole = normalise == "low-wavenumber", lines.sum(axis=0)
    forces = forces / np.where(printed, anchored, tangent)[:, :, None] ** 2
    excited = _excited(k, whole[0] / strips[0].bins)
    known = np.where(excited, lines, np.nan)
    if degree is None:
        fits = _averaged(k, excited, forces, lines)
        fitted = _averaged(k, excited, forces.sum(axis=0), whole)
    else:
        fits = np.array([_polynomials(k, excited, r, degree, printed) for r in np.sqrt(forces / known)])
        fitted = fits.mean(axis=0)
    signed, coherence = _regressed(k, excited, strips)
    return ContactFilter(
        np.asarray(approaches, dtype=np.float64),
        k,
        excited,
        np.sqrt(forces.sum(axis=0) / known.sum(axis=0)),
        fitted,
        fits.std(axis=0, ddof=1) if len(fits) > 1 else np.zeros(fits.shape[1:]),
        signed / tangent[:, None],
        coherence,
        anchored.mean(axis=0),
        tangent,
        (whole * low).sum(axis=1) / whole.sum(axis=1),
        normalise,
    )


def _excited(wavenumber: NDArray[np.float64], density: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Where a texture has power, from the density of its lines.

    Rough surfaces fall no faster than k^−4; what does is a cut-off, beyond which the force holds products of
    longer waves alone. A single tone, as of corrugation, stands out above what is typical of its octave.
    """
    weighted = density * wavenumber**CUT_OFF_SLOPE
    typical = median_filter(weighted, BANDS + 1, mode="nearest")
    return np.asarray(weighted > CUT_OFF * np.maximum.accumulate(typical))


def _neighbours(wavenumber: NDArray[np.float64], excited: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Weights, shape (k, k), with which bands count in the average about each wavenumber.

    A triangle over the logarithm of the wavenumber, times k²: spectra of rough lines then count evenly.
    """
    octaves = np.log2(wavenumber)
    half = np.maximum(FITTED_WIDTH, np.log2(1.0 + FITTED_BINS * wavenumber[0] / wavenumber))
    known = octaves[excited]
    at = known[np.argmin(np.abs(known[None, :] - octaves[:, None]), axis=1)]  # held beside what is excited
    weights = np.maximum(0.0, 1.0 - np.abs(octaves[None, :] - at[:, None]) / half[:, None])
    return np.asarray(weights * excited * wavenumber**2)


def _averaged(
    wavenumber: NDArray[np.float64],
    excited: NDArray[np.bool_],
    force: NDArray[np.float64],
    lines: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Root of the ratio of two powers, each averaged about every wavenumber."""
    weights = _neighbours(wavenumber, excited)
    return np.clip(np.sqrt((force @ weights.T) / (lines @ weights.T)), FLOOR, 1.0)


def _regressed(
    wavenumber: NDArray[np.float64], excited: NDArray[np.bool_], strips: Sequence[FilterSpectra]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Force regressed on the mean line, N/m, and the coherence of the two."""
    weights = _neighbours(wavenumber, excited).T
    cross = np.sum([s.cross for s in strips], axis=0) @ weights
    mean = np.sum([s.mean_line for s in strips], axis=0) @ weights
    force = np.sum([s.force for s in strips], axis=0) @ weights
    return np.real(cross) / mean, np.abs(cross) ** 2 / np.maximum(mean * force, np.finfo(float).tiny)


def _polynomials(
    wavenumber: NDArray[np.float64],
    excited: NDArray[np.bool_],
    ratio: NDArray[np.float64],
    degree: int,
    through_one: bool,
) -> NDArray[np.float64]:
    """Polynomials in dB over the wavenumber, fitted where the texture is excited and held beyond."""
    degree = min(degree, max(1, int(excited.sum()) - 2))
    highest = wavenumber[excited][-1]
    x = np.minimum(wavenumber, highest) / highest
    basis = x[:, None] ** np.arange(1 if through_one else 0, degree + 1)
    level = 20.0 * np.log10(np.maximum(ratio[:, excited], FLOOR))
    coefficients = np.linalg.lstsq(basis[excited], level.T, rcond=None)[0]
    return np.clip(10.0 ** ((basis @ coefficients).T / 20.0), FLOOR, 1.0)


def closed_form(
    approaches: NDArray[np.float64],
    wavenumber: NDArray[np.float64],
    semi_axes: NDArray[np.float64],
    stiffness: NDArray[np.float64],
) -> ContactFilter:
    """Filter of bodies without texture: that of small roughness, uniform across.

    Parameters
    ----------
    approaches, semi_axes, stiffness : ndarray, shape (s,)
        Approaches of the states, m, semi-axes in the rolling direction, m, and tangent stiffnesses, N/m.
    wavenumber : ndarray, shape (k,)
        Cycles/m.

    Returns
    -------
    ContactFilter
        sin q/q; no raw estimate.
    """
    signed = punch_filter(wavenumber[None, :], semi_axes[:, None])
    none, every = np.full_like(signed, math.nan), np.ones_like(signed)
    return ContactFilter(
        approaches,
        wavenumber,
        np.ones(wavenumber.shape, dtype=bool),
        none,
        np.clip(np.abs(signed), FLOOR, 1.0),
        np.zeros_like(signed),
        signed,
        every,
        stiffness,
        stiffness,
        np.ones(stiffness.shape),
        "tangent",
    )
