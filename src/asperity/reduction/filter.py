"""The contact filter: how much of a line texture reaches the contact force, by wavenumber and state."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.errors import InputError
from asperity.spectra import hann_window

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
    """What one scanned strip says about the contact filter: spectra added up in bands."""

    wavenumber: NDArray[np.float64]  # (k,), cycles/m, mean of each band
    bins: NDArray[np.intp]  # (k,), lines of the spectra in each band
    force: NDArray[np.float64]  # (s, k), power of the scanned force in each state, N²
    # (s, k), power of the line textures under the patch of each state, mean over the lines, m²
    lines: NDArray[np.float64]
    mean_line: NDArray[np.float64]  # (s, k), power of their mean, m²
    cross: NDArray[np.complex128]  # (s, k), cross spectrum of the force with their mean, N m


@dataclass(frozen=True, eq=False)
class ContactFilter:
    """Contact filters of an ensemble of strips, for s states and k wavenumbers."""

    approaches: NDArray[np.float64]  # (s,), of the states, m
    wavenumber: NDArray[np.float64]  # (k,), cycles/m
    # (k,), where the texture has the power to say something; beside it the filter is held
    excited: NDArray[np.bool_]
    raw: NDArray[np.float64]  # (s, k), |Ĥ| of Eq. 2.6, root of the ratio of the powers of all strips; no sign
    magnitude: NDArray[np.float64]  # (s, k), the fit to it
    spread: NDArray[np.float64]  # (s, k), standard deviation of the strips' own fits
    # (s, k), force regressed on the mean line under the patch, over k_t; by power of strips and lines
    signed: NDArray[np.float64]
    coherence: NDArray[np.float64]  # (s, k), share of the force's power that this explains
    # (s,), k_0: force and texture agree at low wavenumbers; mean over strips, N/m
    asymptotic_stiffness: NDArray[np.float64]
    tangent_stiffness: NDArray[np.float64]  # (s,), k_t, N/m
    # (s,), share of the lines' power at the low wavenumbers from which k_0 is taken
    long_wave_share: NDArray[np.float64]
    # "low-wavenumber", as printed: both spectra share their long-wave asymptote; or "tangent", k_0 = k_t:
    # keeps what a patch wider than the lateral correlation averages away
    normalise: Normalise


def punch_filter(wavenumber: ArrayLike, semi_axis: ArrayLike) -> NDArray[np.float64]:
    """Closed form of the filter for small roughness that is uniform across: sin q/q, negative beyond q = π.

    q = 2π wavenumber × semi-axis in the rolling direction, in cycles/m and m, broadcast.
    """
    return np.sinc(2.0 * np.asarray(wavenumber) * np.asarray(semi_axis))


def filter_spectra(
    forces: NDArray[np.float64],
    lines: NDArray[np.float64],
    spacing: float,
    half_widths: ArrayLike | None = None,
) -> FilterSpectra:
    """Take the spectra of a scanned force and of the line textures that it follows (Eqs. 2.4, 2.5).

    Forces F_c(x_m, r_i) (s, m), N, at constant approach. Lines (l, m · stride), m, peaks positive, from the
    first position on, their points a spacing apart, m; an odd number, the middle one that of the contact.
    They may be finer than the scan by a whole number, so that waves too short for its positions do not appear
    as longer ones. The nominal patch of each state covers `half_widths` (s,) lines on either side of the
    middle, all by default.

    Means are removed before the Hann window, and *power*, not amplitude, is averaged over the lines. Bands
    are a twelfth of an octave wide, or a bin where that is wider.
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
    return np.fft.rfft((rows - rows.mean(axis=1, keepdims=True)) * hann_window(rows.shape[1]))


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

    Strips have common wavenumbers; approaches, m, and k_t, N/m, are (s,). k_0 makes both spectra of each
    strip agree at low wavenumbers, below the asymptote (s,), cycles/m, and at least in the three lowest
    bands, as printed; or is k_t. A `degree` is that of the polynomial, in dB over wavenumber, that is fitted
    to the ratio of each strip by least squares, as printed; the fits are averaged. By default the powers of
    all strips are averaged over a sixth of an octave: a polynomial of low degree cannot hold the knee of the
    filter. The fit lies between `FLOOR` and one.
    """
    k, lines = strips[0].wavenumber, np.array([s.lines for s in strips])
    forces = np.array([s.force for s in strips])
    tangent = np.broadcast_to(np.asarray(tangent_stiffness, dtype=np.float64), lines.shape[1:2])
    limit = np.broadcast_to(np.asarray(asymptote, dtype=np.float64), tangent.shape)
    low = (k <= limit[:, None]) | (np.arange(k.size) < 3)
    anchored = np.sqrt((forces * low).sum(axis=2) / (lines * low).sum(axis=2))
    printed, whole = normalise == "low-wavenumber", lines.sum(axis=0)
    # a strip that is never touched in a state has no force to scale: what it lets pass is nothing
    scale = np.where(printed, np.where(anchored > 0.0, anchored, 1.0), tangent)
    forces = forces / scale[:, :, None] ** 2
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
    octaves = np.lib.stride_tricks.sliding_window_view(np.pad(weighted, BANDS // 2, mode="edge"), BANDS + 1)
    typical = np.median(octaves, axis=1)
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
    """Filter of bodies without texture, sin q/q: that of small roughness, uniform across; no raw estimate.

    Approaches, m, semi-axes in the rolling direction, m, and tangent stiffnesses, N/m, are (s,); wavenumbers
    (k,), cycles/m.
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
