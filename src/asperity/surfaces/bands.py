"""One-third-octave levels in wavelength, dB re 1 µm: those of surfaces, and surfaces that have given ones."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy import fft, linalg
from scipy.special import k1

from asperity.arguments import Array, ArrayLike, NDArray, require
from asperity.spectra import HALF_BAND, band_energies, band_levels, psd
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.threads import thread_count

MICROMETRE = 1e-6
"""Reference of roughness levels, m (ISO 3095:2013, EN 15610:2009)."""
LIKELY_WAVELENGTHS = (3.15e-3, 0.4)
"""Wavelengths of the bands of ISO 3095:2013, m."""
SAME_COHERENCE = 1.05
"""Wavenumbers within this ratio share one lateral coherence."""


def band_levels_of(surface: Profile | HeightMap) -> tuple[Array, Array]:
    """One-third-octave levels, dB re 1 µm, with their wavelengths, m; of a map the mean power along x.

    Complete heights, m, under a Hann window; the mean of each line is removed. The bands are those that the
    length resolves and the spacing holds. The exact band centres fall; an empty band has a level of minus
    infinity.
    """
    wavenumber, density = psd(surface.heights.T, float(np.atleast_1d(surface.spacing)[0]))
    if density.ndim == 2:
        density = density.mean(axis=0)
    centres, levels = band_levels(wavenumber, density, MICROMETRE)
    return 1.0 / centres, levels


def likely_band(wavelength: Array) -> NDArray[np.bool_]:
    """Which bands of a wavelength, m, lie between those of 3.15 mm and 0.4 m."""
    shortest, longest = LIKELY_WAVELENGTHS
    return (wavelength > shortest / HALF_BAND) & (wavelength < longest * HALF_BAND)


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
    order, nominal (0.63 m) or exact (10^(n/10) m). The line closes on itself, as around a wheel; it is no
    shorter than the edge of the longest band, and holds two points in that of the shortest.
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
    nx, ny = shape
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
    power = np.mean(np.square(amplitudes.real) + np.square(amplitudes.imag), axis=0)
    amplitudes *= nx * share * np.sqrt(lines.energies * _correction(lines, lines.energies * power))
    heights = fft.irfft(amplitudes, nx, axis=1, overwrite_x=True, workers=thread_count()).T
    return HeightMap(heights, spacing, f"{lines.description}, lateral {lateral:g}, seed {seed}")


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
    step, wanted = lines.wavenumbers[1], lines.targets > 0.0
    factors = np.ones(wanted.size)
    for _ in range(50):
        density = energies * factors[lines.band_of] / step
        squares = band_energies(lines.wavenumbers, density, lines.low, lines.high)
        ratio = lines.targets[wanted] / squares[wanted]
        factors[wanted] *= ratio
        if np.allclose(ratio, 1.0, rtol=0.0, atol=1e-5):
            break
    return factors[lines.band_of]


def _fourier_lines(n: int, spacing: float, wavelengths: ArrayLike, levels_db: ArrayLike) -> _Lines:
    centres, low, high, levels = _wavenumber_bands(wavelengths, levels_db)
    length = n * spacing
    wavenumbers, half = np.arange(n // 2 + 1) / length, 0.5 / length
    cell_low, cell_high = np.clip(wavenumbers - half, 0.0, None), wavenumbers + half
    energies, largest = np.zeros((2, wavenumbers.size))
    band_of = np.zeros(wavenumbers.size, np.intp)
    targets = MICROMETRE**2 * 10.0 ** (levels / 10.0)
    for band, target in enumerate(targets):
        overlap = np.clip(np.minimum(cell_high, high[band]) - np.maximum(cell_low, low[band]), 0.0, None)
        energies += target * overlap / overlap.sum()
        band_of[overlap > largest] = band
        largest = np.maximum(largest, overlap)
    description = f"one-third octaves {1.0 / centres.max():.4g} to {1.0 / centres.min():.4g} m"
    return _Lines(wavenumbers, energies, band_of, low, high, targets, description)


def _wavenumber_bands(wavelengths: ArrayLike, levels_db: ArrayLike) -> tuple[Array, Array, Array, Array]:
    given, levels = (np.atleast_1d(np.asarray(each, dtype=np.float64)) for each in (wavelengths, levels_db))
    centres = 10.0 ** (np.rint(-10.0 * np.log10(given)) / 10.0)
    near = np.abs(given * centres - 1.0) < 0.03  # nominal ones lie within 2.4 % of the exact ones
    right = near.all() and np.unique(centres).size == centres.size
    remedy = "Give each band once by its centre, as 0.1, 0.125, 0.16 m."
    require(right, "wavelengths", given, "distinct centres of base-10 one-third octaves", remedy)
    return centres, centres / HALF_BAND, centres * HALF_BAND, levels
