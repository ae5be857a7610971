"""The contact filter: how much of a line texture reaches the contact force, by wavenumber and state."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.linalg import cho_factor, cho_solve

from asperity.arguments import Array, ArrayLike, Complex, Flags, Indices, as_row, require
from asperity.kernels.curves import shape_preserving
from asperity.reduction.texture import PIECE, LongConvolution, StateTexture
from asperity.spectra import hann_window
from asperity.threads import one_thread_in_linear_algebra

Normalise = Literal["low-wavenumber", "tangent"]

BANDS = 12
"""Bands of an octave."""
FLOOR = 1e-3
"""Smallest magnitude of a fitted filter (−60 dB)."""
FEWEST_POSITIONS = 16
"""Positions of a scan, at least, from which a filter is estimated."""
HIGHEST = 0.8
"""Largest wavenumber of a filter to that which the positions of the scan can tell apart."""
FITTED_WIDTH = 1.0 / 6.0
"""Half the width of the average that is the fit, octaves."""
FITTED_BINS = 1.5
"""Half its width in bins of the spectra, where those are wider."""
CUT_OFF, CUT_OFF_SLOPE = 1e-2, 4
"""Line power times k^slope below this share of its largest value at longer waves excites no contact."""


@dataclass(frozen=True, eq=False)
class FilterSpectra:
    """What one scanned strip says about the contact filter: spectra added up in bands."""

    wavenumber: Array  # (k,), cycles/m, mean of each band
    bins: Indices  # (k,), lines of the spectra in each band
    force: Array  # (s, k), power of the scanned force in each state, N²
    # (s, k), power of the line textures under the patch of each state, mean over the lines, m²
    lines: Array
    mean_line: Array  # (s, k), power of their mean, m²
    cross: Complex  # (s, k), cross spectrum of the force with their mean, N m


@dataclass(frozen=True, eq=False)
class ContactFilter:
    """Contact filters of an ensemble of strips, for s states and k wavenumbers."""

    approaches: Array  # (s,), of the states, m
    wavenumber: Array  # (k,), cycles/m
    # (k,), where the texture has the power to say something; beside it the filter is held
    excited: Flags
    raw: Array  # (s, k), |Ĥ| of Eq. 2.6, root of the ratio of the powers of all strips; no sign
    magnitude: Array  # (s, k), the fit to it
    spread: Array  # (s, k), standard deviation of the strips' own fits
    # (s, k), force regressed on the mean line under the patch, over k_t; by power of strips and lines
    signed: Array
    coherence: Array  # (s, k), share of the force's power that this explains
    # (s,), k_0: force and texture agree at low wavenumbers; mean over strips, N/m
    asymptotic_stiffness: Array
    tangent_stiffness: Array  # (s,), k_t, N/m
    # (s,), share of the lines' power at the low wavenumbers from which k_0 is taken
    long_wave_share: Array
    # "low-wavenumber", as printed: both spectra share their long-wave asymptote; or "tangent", k_0 = k_t:
    # keeps what a patch wider than the lateral correlation averages away
    normalise: Normalise


def punch_filter(wavenumber: ArrayLike, semi_axis: ArrayLike) -> Array:
    """Closed form of the filter for small roughness that is uniform across: sin q/q, negative beyond q = π.

    q = 2π wavenumber × semi-axis in the rolling direction, in cycles/m and m, broadcast.
    """
    return np.sinc(2.0 * np.asarray(wavenumber) * np.asarray(semi_axis))


def filter_spectra(
    forces: Array, lines: Array, spacing: float, half_widths: ArrayLike | None = None
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
    f = np.atleast_2d(forces)
    z = np.atleast_2d(lines)
    states, m = f.shape
    stride = z.shape[1] // m
    require(m >= FEWEST_POSITIONS, "scan for the filter", f"{m} forces", f"at least {FEWEST_POSITIONS}")
    middle = z.shape[0] // 2
    half = np.full(states, middle) if half_widths is None else np.minimum(half_widths, middle)
    highest = int(HIGHEST * (m // 2))
    force = _windowed(f)[:, 1 : highest + 1]
    texture = _windowed(z)[:, 1 : highest + 1] / stride
    under = [texture[middle - h : middle + h + 1] for h in half]
    power = np.array([np.mean(np.abs(t) ** 2, axis=0) for t in under])
    require(np.ptp(z) > 0.0, "line textures of the filter", "a flat surface", "a surface with texture")
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


def _windowed(rows: Array) -> Complex:
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
    k = strips[0].wavenumber
    lines = np.array([s.lines for s in strips])
    forces = np.array([s.force for s in strips])
    tangent = np.broadcast_to(np.asarray(tangent_stiffness, dtype=np.float64), lines.shape[1:2])
    limit = np.broadcast_to(np.asarray(asymptote, dtype=np.float64), tangent.shape)
    low = (k <= limit[:, None]) | (np.arange(k.size) < 3)
    anchored = np.sqrt((forces * low).sum(axis=2) / (lines * low).sum(axis=2))
    printed = normalise == "low-wavenumber"
    whole = lines.sum(axis=0)
    # a strip that is never touched in a state has no force to scale: what it lets pass is nothing
    scale = np.where(printed, np.where(anchored > 0.0, anchored, 1.0), tangent)
    forces = forces / scale[:, :, None] ** 2
    excited = _excited(k, whole[0] / strips[0].bins)
    weights = _neighbours(k, excited)
    known = np.where(excited, lines, np.nan)
    if degree is None:
        fits = _averaged(weights, forces, lines)
        fitted = _averaged(weights, forces.sum(axis=0), whole)
    else:
        fits = np.array([_polynomials(k, excited, r, degree, printed) for r in np.sqrt(forces / known)])
        fitted = fits.mean(axis=0)
    raw = np.sqrt(forces.sum(axis=0) / known.sum(axis=0))
    spread = fits.std(axis=0, ddof=1) if len(fits) > 1 else np.zeros(fits.shape[1:])
    share = (whole * low).sum(axis=1) / whole.sum(axis=1)
    states = np.asarray(approaches, dtype=np.float64)
    spectra = (raw, fitted, spread, *_regressed(weights, tangent, strips))
    return ContactFilter(states, k, excited, *spectra, anchored.mean(axis=0), tangent, share, normalise)


def _excited(wavenumber: Array, density: Array) -> Flags:
    """Where a texture has power, from the density of its lines.

    Rough surfaces fall no faster than k^−4; what does is a cut-off, beyond which the force holds products of
    longer waves alone. A single tone, as of corrugation, stands out above what is typical of its octave.
    """
    weighted = density * wavenumber**CUT_OFF_SLOPE
    octaves = np.lib.stride_tricks.sliding_window_view(np.pad(weighted, BANDS // 2, mode="edge"), BANDS + 1)
    typical = np.median(octaves, axis=1)
    return weighted > CUT_OFF * np.maximum.accumulate(typical)


def _neighbours(wavenumber: Array, excited: Flags) -> Array:
    """Weights, shape (k, k), with which bands count in the average about each wavenumber.

    A triangle over the logarithm of the wavenumber, times k²: spectra of rough lines then count evenly.
    """
    octaves = np.log2(wavenumber)
    half = np.maximum(FITTED_WIDTH, np.log2(1.0 + FITTED_BINS * wavenumber[0] / wavenumber))
    known = octaves[excited]
    at = known[np.argmin(np.abs(known[None, :] - octaves[:, None]), axis=1)]  # held beside what is excited
    weights = np.maximum(0.0, 1.0 - np.abs(octaves[None, :] - at[:, None]) / half[:, None])
    return weights * excited * wavenumber**2


def _averaged(weights: Array, force: Array, lines: Array) -> Array:
    """Root of the ratio of two powers, each averaged about every wavenumber."""
    return np.clip(np.sqrt((force @ weights.T) / (lines @ weights.T)), FLOOR, 1.0)


def _regressed(weights: Array, tangent: Array, strips: Sequence[FilterSpectra]) -> tuple[Array, Array]:
    """Force regressed on the mean line, over k_t (s,), N/m, and the coherence of the two."""
    cross, mean, force = (
        np.sum([getattr(s, name) for s in strips], axis=0) @ weights.T
        for name in ("cross", "mean_line", "force")
    )
    coherence = np.abs(cross) ** 2 / np.maximum(mean * force, np.finfo(float).tiny)
    return np.real(cross) / mean / tangent[:, None], coherence


def _polynomials(wavenumber: Array, excited: Flags, ratio: Array, degree: int, through_one: bool) -> Array:
    """Polynomials in dB over the wavenumber, fitted where the texture is excited and held beyond."""
    degree = min(degree, max(1, int(excited.sum()) - 2))
    highest = wavenumber[excited][-1]
    x = np.minimum(wavenumber, highest) / highest
    basis = x[:, None] ** np.arange(1 if through_one else 0, degree + 1)
    level = 20.0 * np.log10(np.maximum(ratio[:, excited], FLOOR))
    coefficients = np.linalg.lstsq(basis[excited], level.T, rcond=None)[0]
    return np.clip(10.0 ** ((basis @ coefficients).T / 20.0), FLOOR, 1.0)


def closed_form(approaches: Array, wavenumber: Array, semi_axes: Array, stiffness: Array) -> ContactFilter:
    """Filter of bodies without texture, sin q/q: that of small roughness, uniform across; no raw estimate.

    Approaches, m, semi-axes in the rolling direction, m, and tangent stiffnesses, N/m, are (s,); wavenumbers
    (k,), cycles/m.
    """
    signed = punch_filter(wavenumber[None, :], semi_axes[:, None])
    none = np.full_like(signed, math.nan)
    every = np.ones_like(signed)
    spectra = none, np.clip(np.abs(signed), FLOOR, 1.0), np.zeros_like(signed), signed, every
    share = np.ones(stiffness.shape)
    excited = np.ones(wavenumber.shape, dtype=bool)
    return ContactFilter(
        approaches, wavenumber, excited, *spectra, stiffness, stiffness, share, normalise="tangent"
    )


ACCURACY = 0.3
"""Within which a chosen order meets the fitted filter, dB."""
DOWN_TO = -30.0
"""Level of the fitted filter down to which it does, dB."""
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
    taps: Array  # (s, J + 1), b_j of each state, symmetric
    spacing: float  # sampling of the line texture, m

    @property
    def applied(self) -> Array:
        """Magnitude that the taps have at the filter's wavenumbers, shape (s, k)."""
        return np.abs(response(self.taps, self.spacing, self.contact_filter.wavenumber))

    @property
    def miss(self) -> float:
        """Largest distance of the applied filter from the fitted one, dB, where that is above `DOWN_TO`."""
        fine = _fine(self.contact_filter)
        return float(_missed(self.taps, self.spacing, fine, _target(self.contact_filter, fine)).max())


def response(taps: Array, spacing: float, wavenumber: ArrayLike) -> Array:
    """Response (s, k) of symmetric taps (s, odd) about their middle one, real and signed.

    Spacing in m, wavenumbers (k,) in cycles/m; one where a wave passes unchanged.
    """
    middle = taps.shape[1] // 2
    cosines = np.cos(2.0 * math.pi * spacing * np.arange(1, middle + 1)[:, None] * np.asarray(wavenumber))
    return taps[:, middle, None] + 2.0 * taps[:, middle + 1 :] @ cosines


def tap_count(spacing: float, largest_semi_axis: float) -> int:
    """Least even J with J dx ≥ 4 a_max, dx and semi-axis in m; the filter has J + 1 taps."""
    return 2 * math.ceil(2.0 * largest_semi_axis / spacing)


def punch_taps(semi_axes: ArrayLike, spacing: float) -> Array:
    """Taps (s, odd) of the closed-form filter sin q/q: the mean over the length of each patch.

    Semi-axes (s,) of the patch in the rolling direction and spacing, m; the taps sum to one.
    """
    a = as_row(semi_axes)[:, None]
    half = max(0, math.ceil(float(a.max()) / spacing - 0.5))
    edges = (np.arange(-half, half + 2) - 0.5) * spacing
    return np.diff(np.clip(edges, -a, a), axis=1) / (2.0 * a)


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
        return LineFilter(contact_filter, _by_window(contact_filter, spacing, order), spacing)
    fine = _fine(contact_filter)
    most = max(2, 2 * (min(most, LARGEST_ORDER) // 2))
    fitted = _target(contact_filter, fine)
    order = min(max(2, least), most)
    while True:
        with one_thread_in_linear_algebra():
            taps = _of_least_relative_error(contact_filter, spacing, order)
        if order == most or _missed(taps, spacing, fine, fitted).max() <= ACCURACY:
            return LineFilter(contact_filter, taps, spacing)
        order = min(2 * math.ceil(0.5 * GROWTH * order), most)


def _by_window(contact_filter: ContactFilter, spacing: float, order: int) -> Array:
    """Taps from the inverse transform of the magnitude under a Hamming window."""
    grid = np.linspace(0.0, 0.5 / spacing, 513)
    gain = _target(contact_filter, grid)
    fine = np.linspace(0.0, 0.5 / spacing, 1 + 2 ** math.ceil(math.log2(order + 1)))
    even = np.fft.irfft([np.interp(fine, grid, row) for row in gain])[:, : order // 2 + 1]
    return _summed(contact_filter, np.hamming(order + 1) * np.hstack((even[:, :0:-1], even)))


def _of_least_relative_error(contact_filter: ContactFilter, spacing: float, order: int) -> Array:
    """Taps (s, J + 1) with the least squared relative error of the response, octave for octave.

    Below the lowest wavenumber of the filter all octaves count as that. A response Σ_j c_j cos jω has normal
    equations of sums and differences of lags: those of the transforms of the weight and of the weighted
    target. As the weight is positive, so are they definite.
    """
    points = 2 ** math.ceil(math.log2(max(8 * order, 2048)))
    count = order // 2 + 1
    wavenumber = np.arange(points // 2 + 1) / points
    least = 10.0 ** ((DOWN_TO - 3.0) / 20.0)
    octaves = np.maximum(wavenumber, contact_filter.wavenumber[0] * spacing)
    taps = []
    for target in _target(contact_filter, wavenumber / spacing):
        weight = 1.0 / (np.maximum(target, least) ** 2 * octaves)
        of_weight = np.fft.irfft(weight, points)
        of_target = np.fft.irfft(weight * target, points)
        apart = sliding_window_view(np.concatenate([of_weight[count - 1 : 0 : -1], of_weight[:count]]), count)
        together = sliding_window_view(of_weight[: 2 * count - 1], count)
        cosines = cho_solve(cho_factor(0.5 * (apart[::-1] + together), overwrite_a=True), of_target[:count])
        taps.append(np.concatenate([0.5 * cosines[:0:-1], cosines[:1], 0.5 * cosines[1:]]))
    return _summed(contact_filter, np.array(taps))


def _fine(contact_filter: ContactFilter) -> Array:
    """Wavenumbers at which a response is held against the fit, cycles/m."""
    known = contact_filter.wavenumber[contact_filter.excited]
    return np.geomspace(known[0], known[-1], _FINE * known.size)


def _missed(taps: Array, spacing: float, wavenumber: Array, fitted: Array) -> Array:
    """Largest distances (s,) of what taps (s, J + 1) do from fitted magnitudes (s, k) above `DOWN_TO`, dB."""
    wanted = 20.0 * np.log10(fitted)
    applied = 20.0 * np.log10(np.maximum(np.abs(response(taps, spacing, wavenumber)), 1e-9))
    return np.max(np.abs(applied - wanted), axis=1, where=wanted >= DOWN_TO, initial=0.0)


def _target(contact_filter: ContactFilter, wavenumber: Array) -> Array:
    """Magnitude at any wavenumber: between the fitted ones smooth in dB over octaves, beyond them held.

    Under the printed normalisation it goes on to one at wavenumber zero.
    """
    known = contact_filter.wavenumber
    magnitude = contact_filter.magnitude
    inside = np.log(np.clip(wavenumber, known[0], known[-1]))
    found = np.exp(shape_preserving(np.log(known), np.log(magnitude), inside))
    if contact_filter.normalise == "low-wavenumber":
        share = np.minimum(wavenumber / known[0], 1.0)
        found = share * found + (1.0 - share)
    return found


def _summed(contact_filter: ContactFilter, taps: Array) -> Array:
    """Taps that let pass what the filter does at wavenumber zero."""
    at_zero = _target(contact_filter, np.zeros(1))
    return taps * at_zero / taps.sum(axis=1, keepdims=True)


def filtered_texture(
    heights: Array, spacing: float, taps: Array, approaches: ArrayLike, start: float = 0.0
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
