"""One-third-octave levels in wavelength of lines and surfaces, dB re 1 µm."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import fft, linalg
from scipy.special import k1

from asperity.arguments import Array
from asperity.errors import InputError
from asperity.spectra import HALF_BAND, band_energies, band_levels, psd, third_octave_bands
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.threads import thread_count

MICROMETRE = 1e-6
"""Reference of roughness levels, m (ISO 3095:2013, EN 15610:2009)."""

LIKELY_LEVELS = (-60.0, 60.0)
"""Levels outside of these, dB re 1 µm, ask whether the unit of the heights is right."""

EMPTY = 120.0
"""A band this far below the highest holds rounding errors, dB."""

LIKELY_WAVELENGTHS = (3.15e-3, 0.4)
"""Wavelengths whose levels are checked, m: the bands of ISO 3095:2013."""


def band_levels_of(
    surface: Profile | HeightMap,
    *,
    segment: float | None = None,
    shortest: float | None = None,
    longest: float | None = None,
) -> tuple[Array, Array]:
    """One-third-octave levels, dB re 1 µm, with their wavelengths, m; of a map the mean power along x.

    Complete heights, m; the mean of each line is removed. Segments, m, are Hann-windowed with 50 % overlap,
    the whole length by default. `shortest` and `longest` lie in the last and the first band; by default all
    bands that the segment resolves and the spacing holds. The exact band centres fall; an empty band has a
    level of minus infinity.
    """
    spacing = surface.spacing[0] if isinstance(surface, HeightMap) else surface.spacing
    points = None if segment is None else round(segment / spacing)
    wavenumber, density = psd(surface.heights.T, spacing, segment=points)
    if density.ndim == 2:
        density = density.mean(axis=0)
    low = None if longest is None else 1.0 / longest
    high = None if shortest is None else 1.0 / shortest
    centres, levels = band_levels(wavenumber, density, MICROMETRE, low=low, high=high)
    return 1.0 / centres, levels


def check_levels(surfaces: Sequence[Profile | HeightMap], what: str = "heights") -> None:
    """Ask for the unit where levels are far from those of wheels and rails.

    That is beyond ±60 dB re 1 µm in a band between 3.15 mm and 0.4 m that the record resolves. Empty bands,
    120 dB below the highest, do not count. The heights are complete and without form, m.
    """
    for surface in surfaces:
        wavelength, level = band_levels_of(surface)
        step = surface.spacing[0] if isinstance(surface, HeightMap) else surface.spacing
        inside = (wavelength > LIKELY_WAVELENGTHS[0] / HALF_BAND) & (
            wavelength < LIKELY_WAVELENGTHS[1] * HALF_BAND
        )
        inside &= np.isfinite(level) & (wavelength >= 4.0 * step) & (level > level.max() - EMPTY)
        if not inside.any():
            continue
        for extreme in (level[inside].max(), level[inside].min()):
            if not LIKELY_LEVELS[0] <= extreme <= LIKELY_LEVELS[1]:
                at = wavelength[inside][np.argmin(np.abs(level[inside] - extreme))]
                received = f"{extreme:.0f} dB re 1 µm at a wavelength of {1e3 * at:.3g} mm"
                allowed = f"levels between {LIKELY_LEVELS[0]:g} and {LIKELY_LEVELS[1]:+g} dB"
                remedy = "Is the unit right? If these levels are meant, set surface.accept_levels = true."
                raise InputError(f"levels of the {what}", received, allowed, remedy)


SAME_COHERENCE = 1.05
"""Wavenumbers within this ratio share one lateral coherence."""


@dataclass(frozen=True, eq=False)
class _Lines:
    """Fourier lines of a periodic record and the energy that bands put on them."""

    wavenumbers: Array  # (k,) cycles/m, from zero
    energies: Array  # (k,) m², mean square of each line
    band_of: NDArray[np.intp]  # (k,) the band with the largest part of each line
    low: Array  # (b,) band edges, cycles/m
    high: Array
    targets: Array  # (b,) m², mean square of each band
    description: str


def from_bands(n: int, spacing: float, wavelengths: ArrayLike, levels_db: ArrayLike, seed: int) -> Profile:
    """Line with given one-third-octave levels in wavelength, dB re 1 µm rms (ISO 3095:2013, EN 15610:2019).

    Amplitudes are fixed and phases random, so every realisation has the levels asked for. The density is
    constant inside a band; bands that are not given hold nothing. Wavelengths are band centres, m, in any
    order, nominal (0.63 m) or exact (10^(n/10) m). The line closes on itself, as around a wheel. An
    `InputError` says where it is shorter than the edge of the longest band or its spacing too coarse for the
    shortest.
    """
    lines = _fourier_lines(n, spacing, wavelengths, levels_db)
    phases = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, lines.energies.size)
    spectrum = n * np.sqrt(lines.energies / 2.0) * np.exp(1j * phases)
    if n % 2 == 0:
        spectrum[-1] = n * np.sqrt(lines.energies[-1])
    return Profile(fft.irfft(spectrum, n), spacing, f"{lines.description}, seed {seed}")


def strip_from_bands(
    shape: tuple[int, int],
    spacing: tuple[float, float],
    wavelengths: ArrayLike,
    levels_db: ArrayLike,
    *,
    lateral: float = 1.0,
    seed: int,
) -> HeightMap:
    """Strip whose lines along x have given one-third-octave levels in wavelength, dB re 1 µm rms.

    The spectrum is S(kx, ky) = S1(kx) D(ky | kx): S1 is constant inside a band, as in `from_bands`, and

        D(ky | kx) = (1 + (ky/κ)²)^(-3/2) / 2κ,   κ = |kx| / lateral,   ∫ D dky = 1,

    so the share of the waves of wavenumber kx that lines a distance y apart have in common (their coherence)
    is κy K₁(κy), K₁ the modified Bessel function: 0.5 at κy = 1.26, that is at a fifth of a wavelength for
    lateral = 1, the correlation length across over that along; ``inf`` makes all lines equal.

    The strip closes on itself along x and does not across. The mean square over all its lines has the levels
    asked for, as `asperity.spectra.band_levels` finds them from the periodogram of the whole length; one line
    scatters about them. The lateral direction is sampled exactly, by the covariance of the lines at each
    wavenumber.

    An isotropic areal spectrum C ∝ q^(-p) has D = (1 + (ky/kx)²)^(-p/2) times a constant and a line density
    S1 ∝ kx^(1-p). With lateral = 1 the strip is thus exactly isotropic where the line density falls as ν^(-2)
    (1 dB from band to shorter band) and nearly so beside it: the limit of ISO 3095:2013 falls as ν^(-3) above
    100 mm and as ν^(-1.6) below 30 mm.
    """
    nx, ny = _checked_strip(shape, spacing, lateral)
    lines = _fourier_lines(nx, spacing[0], wavelengths, levels_db)
    rng = np.random.default_rng(seed)
    amplitudes = np.zeros((ny, lines.energies.size), dtype=np.complex128)
    for block in _blocks(lines):
        distance = 2.0 * np.pi * lines.wavenumbers[block].mean() / lateral * spacing[1] * np.arange(ny)
        mix = _lateral_factor(distance) if np.isfinite(lateral) else np.ones((ny, 1))
        real, imaginary = rng.standard_normal((2, mix.shape[1], block.stop - block.start))
        amplitudes[:, block] = mix @ (real + 1j * imaginary) * np.sqrt(0.5)
    share = np.full(lines.energies.size, np.sqrt(0.5))  # of two conjugate lines
    if nx % 2 == 0:
        amplitudes[:, -1] = np.sqrt(2.0) * amplitudes[:, -1].real
        share[-1] = 1.0
    found = np.mean(np.square(amplitudes.real) + np.square(amplitudes.imag), axis=0)
    amplitudes *= nx * share * np.sqrt(lines.energies * _correction(lines, lines.energies * found))
    heights = fft.irfft(amplitudes, nx, axis=1, overwrite_x=True, workers=thread_count()).T
    return HeightMap(heights, spacing, f"{lines.description}, lateral {lateral:g}, seed {seed}")


def _checked_strip(shape: tuple[int, int], spacing: tuple[float, float], lateral: float) -> tuple[int, int]:
    if len(shape) != 2 or min(shape) < 2:
        raise InputError("shape", shape, "(nx, ny), at least 2 points each")
    if len(spacing) != 2 or not min(spacing) > 0.0:
        raise InputError("spacing", spacing, "two positive lengths (dx, dy), m")
    if not lateral > 0.0:
        raise InputError("lateral", lateral, "above zero, or inf for equal lines")
    return shape


def _blocks(lines: _Lines) -> list[slice]:
    """Runs of lines that hold energy and have nearly the same wavenumber."""
    used = np.flatnonzero(lines.energies)
    if used.size == 0:
        return []
    index = np.arange(used[0], used[-1] + 1)
    group = np.floor(np.log(index / index[0]) / np.log(SAME_COHERENCE) + 1e-9)
    starts = np.append(index[np.append(True, np.diff(group) > 0)], index[-1] + 1)
    return [slice(int(i), int(j)) for i, j in pairwise(starts)]


def _lateral_factor(distance: Array) -> Array:
    """Matrix that mixes independent numbers into lines with coherence z K1(z) at `distance` z."""
    coherence = np.full(distance.size, 1.0 + 1e-10)  # keeps nearly equal lines factorable
    coherence[1:] = distance[1:] * k1(distance[1:])
    return np.asarray(linalg.cholesky(linalg.toeplitz(coherence), lower=True))


def _correction(lines: _Lines, energies: Array) -> Array:
    """Factor for the energy of each line that gives every band its mean square.

    Lines on an edge are shared by two bands, so the factors of the bands depend on each other.
    """
    step = lines.wavenumbers[1]
    wanted = lines.targets > 0.0
    factors = np.ones(wanted.size)
    for _ in range(50):
        density = energies * factors[lines.band_of] / step
        found = band_energies(lines.wavenumbers, density, lines.low, lines.high)
        ratio = lines.targets[wanted] / found[wanted]
        factors[wanted] *= ratio
        if np.allclose(ratio, 1.0, rtol=0.0, atol=1e-5):
            break
    return factors[lines.band_of]


def _fourier_lines(n: int, spacing: float, wavelengths: ArrayLike, levels_db: ArrayLike) -> _Lines:
    centres, low, high, levels = _wavenumber_bands(wavelengths, levels_db)
    if not (n >= 2 and spacing > 0.0):
        raise InputError("line", f"{n} points at {spacing} m", "2 points or more at a positive spacing")
    length = n * spacing
    if low.min() * length < 1.0:
        allowed = f"at least the longest band's edge, {1.0 / low.min():.4g} m"
        raise InputError("length of the line", f"{length:.4g} m", allowed, "Leave out the longest bands.")
    if high.max() > 0.5 / spacing * (1.0 + 1e-9):
        allowed = f"at most half the shortest band's edge, {0.5 / high.max():.4g} m"
        raise InputError("spacing", f"{spacing:.4g} m", allowed, "Leave out the shortest bands.")
    wavenumbers = np.arange(n // 2 + 1) / length
    half = 0.5 / length
    cell_low, cell_high = np.clip(wavenumbers - half, 0.0, None), wavenumbers + half
    energies, largest, band_of = (
        np.zeros(wavenumbers.size),
        np.zeros(wavenumbers.size),
        np.zeros(wavenumbers.size, np.intp),
    )
    targets = MICROMETRE**2 * 10.0 ** (levels / 10.0)
    for band, target in enumerate(targets):
        overlap = np.clip(np.minimum(cell_high, high[band]) - np.maximum(cell_low, low[band]), 0.0, None)
        energies += target * overlap / overlap.sum()
        band_of[overlap > largest] = band
        largest = np.maximum(largest, overlap)
    description = f"one-third octaves {1.0 / centres.max():.4g} to {1.0 / centres.min():.4g} m"
    return _Lines(wavenumbers, energies, band_of, low, high, targets, description)


def _wavenumber_bands(wavelengths: ArrayLike, levels_db: ArrayLike) -> tuple[Array, Array, Array, Array]:
    given = np.atleast_1d(np.asarray(wavelengths, dtype=np.float64))
    levels = np.atleast_1d(np.asarray(levels_db, dtype=np.float64))
    if (
        given.ndim != 1
        or given.shape != levels.shape
        or not (np.isfinite(levels) | np.isneginf(levels)).all()
    ):
        received = f"shapes {given.shape} and {levels.shape}"
        raise InputError("wavelengths and levels", received, "two lists of equal length, levels not NaN")
    if not ((given > 0.0) & np.isfinite(given)).all():
        raise InputError("wavelengths", given, "positive and finite, m")
    bands = [third_octave_bands(1.0 / w, 1.0 / w) for w in given]
    centres, low, high = (np.array([b[k][0] for b in bands]) for k in range(3))
    nominal = np.abs(given * centres - 1.0) < 0.03  # nominal values lie within 2.4 % of the exact ones
    if not nominal.all() or np.unique(centres).size != centres.size:
        remedy = "Give each band once by its centre, as 0.1, 0.125, 0.16 m."
        raise InputError("wavelengths", given, "distinct centres of base-10 one-third octaves", remedy)
    return centres, low, high, levels
