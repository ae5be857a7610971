"""Spectra and correlation of maps and lines, and whether they are the same everywhere."""

from collections.abc import Iterator

import numpy as np
import scipy
from scipy import fft

from asperity.arguments import Array, require
from asperity.errors import ShortRecordWarning
from asperity.spectra import hann_window, psd
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.threads import thread_count

PIECE = 2**18
"""Points of a map, or of its spectrum, that are looked at in one go."""


def psd_1d(surface: HeightMap | Profile, axis: int = 0) -> tuple[Array, Array]:
    """One-sided profile spectrum along an axis, averaged over all lines: wavenumber, cycles/m, and PSD, m³.

    The heights are complete and levelled, m; the mean of each line is removed. The integral of the PSD is
    Rq², weighted by the squared Hann window.
    """
    _require_complete(surface)
    lines = np.moveaxis(surface.heights, axis, -1)
    wavenumber, density = psd(lines, float(np.atleast_1d(surface.spacing)[axis]))
    return wavenumber, density.reshape(-1, wavenumber.size).mean(axis=0)


def _pieces(shape: tuple[int, int]) -> Iterator[slice]:
    """Rows of an array that are looked at together: a large map is not held many times."""
    rows = max(1, PIECE // shape[1])
    return (slice(first, first + rows) for first in range(0, shape[0], rows))


def _require_complete(surface: HeightMap | Profile) -> None:
    received = f"{surface.missing_share:.2%} missing points"
    allowed = "complete heights for a spectrum"
    require(not np.isnan(surface.heights).any(), "surface", received, allowed, "Use fill first.")


def psd_2d(surface: HeightMap) -> tuple[Array, Array, Array]:
    """Two-sided areal spectrum C(qx, qy), m⁴, with the angular wavenumbers qx and qy, rad/m, rising.

    The heights are complete and levelled, m; the mean is removed. The double integral is Sq², weighted by the
    squared Hann window.
    """
    qx, _, half = _half_plane(surface)
    nx, ny = surface.shape
    _, dy = surface.spacing
    density = np.empty((nx, ny))
    density[:, : ny // 2 + 1] = half
    density[:, ny // 2 + 1 :] = half[-np.arange(nx) % nx, (ny - 1) // 2 : 0 : -1]  # the same at −q
    del half
    qy = 2.0 * np.pi * fft.fftfreq(ny, dy)
    return fft.fftshift(qx), fft.fftshift(qy), fft.fftshift(density)


def _half_plane(surface: HeightMap) -> tuple[Array, Array, Array]:
    """Spectrum of `psd_2d` where qy is not below zero, with qx in the order of transforms."""
    _require_complete(surface)
    nx, ny = surface.shape
    dx, dy = surface.spacing
    along = hann_window(nx)
    across = hann_window(ny)
    mean = surface.heights.mean()
    lines = np.empty((nx, ny // 2 + 1), dtype=np.complex128)
    for rows in _pieces(surface.shape):
        lines[rows] = fft.rfft((surface.heights[rows] - mean) * along[rows, None] * across)
    lines = fft.fft(lines, axis=0, overwrite_x=True)  # in place, here and below: maps may be large
    np.square(lines.real, out=lines.real)
    np.square(lines.imag, out=lines.imag)
    lines.real += lines.imag
    energy = np.square(along).sum() * np.square(across).sum()
    lines.real *= dx * dy / (4.0 * np.pi**2 * energy)
    return 2.0 * np.pi * fft.fftfreq(nx, dx), 2.0 * np.pi * fft.rfftfreq(ny, dy), lines.real


def psd_radial(surface: HeightMap) -> tuple[Array, Array]:
    """Areal spectrum C(q), m⁴, averaged over directions, after the angular wavenumber q, rad/m.

    The heights are complete and levelled, m. Wavenumbers are means over rings as wide as the coarser of the
    two wavenumber steps, up to the largest that both directions reach. For an isotropic surface 2π ∫ C q dq =
    Sq².
    """
    qx, qy, density = _half_plane(surface)
    step = max(qx[1], qy[1])
    rings = int(min(-qx.min(), qy[-1]) / step)
    sums = np.zeros((3, rings + 1))
    for rows in _pieces(surface.shape):
        q = np.hypot(qx[rows, None], qy)
        index = np.rint(q / step).astype(np.intp)
        inside = index <= rings
        often = np.broadcast_to(_times_held(qy, surface.shape[1]), q.shape)[inside]
        values = 1.0, density[rows][inside], q[inside]
        sums += [np.bincount(index[inside], often * each, minlength=rings + 1) for each in values]
    count, total, radius = sums[:, 1:]
    return radius / count, total / count


def _times_held(qy: Array, columns: int) -> Array:
    """How often what stands at each qy (f,) of a half plane does so in the whole plane, at q and at −q."""
    return np.where((qy > 0.0) & (np.arange(qy.size) < 0.5 * columns), 2.0, 1.0)


def texture_direction(surface: HeightMap) -> float:
    """Direction in which a texture varies most, Std of ISO 25178-2:2021; the lay is at right angles to it.

    An angle from x, rad, 0 to π, within about 1° of parallel ridges and 5° of a texture of Str 0.5;
    meaningless for an isotropic texture. The angular spectrum is that of the slopes, q² C(q), summed over
    rings from three wavenumber steps, below which directions cannot be told apart, to the largest wavenumber
    that both directions reach; the direction is its mean within ±30° of where it is largest, smoothed twice
    over ±15°. Of heights it would be decided by the few waves that are nearly as long as the map, each with
    a power that is chance.
    """
    qx, qy, density = _half_plane(surface)
    often = _times_held(qy, surface.shape[1])
    power = np.zeros(180)
    for rows in _pieces(surface.shape):
        q = np.hypot(qx[rows, None], qy[None, :])
        angle = np.arctan2(qy[None, :], qx[rows, None]) % np.pi
        inside = (q >= 3.0 * max(qx[1], qy[1])) & (q <= min(-qx.min(), qy[-1]))
        degrees = np.rint(np.degrees(angle[inside])).astype(np.intp) % 180
        power += np.bincount(degrees, (often * q**2 * density[rows])[inside], minlength=180)
    smooth = power
    for _ in range(2):
        smooth = scipy.ndimage.uniform_filter1d(smooth, 31, mode="wrap")
    off = (np.arange(180) - smooth.argmax() + 90) % 180 - 90
    near = np.where(np.abs(off) <= 30, power, 0.0)
    turned = 0.5 * np.angle(np.sum(near * np.exp(2j * np.radians(off))))
    return float((np.radians(smooth.argmax()) + turned) % np.pi)


CORRELATION_THRESHOLD = 0.2
"""Default of ISO 25178-3 for Sal and Str."""
APART = 32
"""Points beyond which a spline feels nothing of where it ends: each takes three quarters off."""


def autocorrelation(surface: HeightMap) -> Array:
    """Normalised autocorrelation at lags up to half the map, zero lag in the middle.

    Of shape (2 (nx//2) + 1, 2 (ny//2) + 1). The heights are complete; the mean is removed. ISO 25178-2:2021
    (autocorrelation function).
    """
    _require_complete(surface)
    heights = surface.heights
    nx, ny = surface.shape
    require(np.ptp(heights), "surface", "equal heights everywhere", "a surface with roughness")
    found = lag_products(heights, nx // 2, float(heights.mean()))
    found /= lag_pairs(nx, ny, nx // 2)
    found /= found[nx // 2, ny // 2]
    return found


def lag_pairs(rows: int, columns: int, reach: int, pieces: int = 1) -> Array:
    """Numbers of pairs of points at the lags of `lag_products`, of so many rows in all, cut into pieces."""
    along, across = (np.abs(np.arange(-n, n + 1)) for n in (reach, columns // 2))
    return np.outer(rows - pieces * along, columns - across)


def lag_products(heights: Array, reach: int, mean: float = 0.0) -> Array:
    """Sums of products of heights about a mean, m², at lags up to `reach` along x and half of all across.

    Of shape (2 reach + 1, 2 (columns//2) + 1), zero lag in the middle.
    """
    rows, columns = heights.shape
    workers = thread_count()
    side = columns // 2
    length = fft.next_fast_len(rows + reach, real=True)  # what wraps is beyond the lags
    width = fft.next_fast_len(columns + side)
    lines = np.empty((length // 2 + 1, columns), dtype=np.complex128)
    for piece in _pieces((columns, length)):
        lines[:, piece] = fft.rfft(heights[:, piece] - mean, length, axis=0, workers=workers)
    for piece in _pieces((len(lines), width)):
        spectrum = fft.fft(lines[piece], width, axis=1, workers=workers)
        power = spectrum.real**2 + spectrum.imag**2
        lines[piece, : side + 1] = np.conj(fft.rfft(power, axis=1, workers=workers)[:, : side + 1]) / width
    half = np.empty((2 * reach + 1, side + 1))
    for piece in _pieces((side + 1, length)):
        lags = fft.irfft(lines[:, : side + 1][:, piece], length, axis=0, workers=workers)
        half[reach:, piece] = lags[: reach + 1]
        half[:reach, piece] = lags[length - reach :]
    del lines
    return np.hstack([half[::-1, :0:-1], half])  # the same at a lag and its opposite


def autocorrelation_lengths(surface: HeightMap) -> tuple[float, float]:
    """Shortest and longest lag, m, at which the central lobe of the autocorrelation falls to 0.2.

    Sal and Sal/Str of ISO 25178-2:2021, over directions one degree apart, of complete, levelled heights. If
    the lobe reaches half the map in some direction, a `ShortRecordWarning` says so: the longest lag is then
    at least the one returned.
    """
    return lengths_of(autocorrelation(surface), surface.spacing)


def lengths_of(correlation: Array, spacing: tuple[float, float]) -> tuple[float, float]:
    """Lags, m, at which the central lobe of an autocorrelation falls to 0.2 of its value at zero lag.

    The correlation (odd, odd) holds mean products of heights, zero lag in the middle; lags and warning are as
    those of `autocorrelation_lengths`.
    """
    lobe = _around_lobe(correlation)
    middle = np.array(lobe.shape) // 2
    step = np.asarray(spacing)
    coefficients = scipy.ndimage.spline_filter(lobe, order=3, mode="mirror")
    coefficients /= lobe[tuple(middle)]
    lengths = []
    open_ended = False
    for angle in np.radians(np.arange(0.0, 180.0)):
        direction = np.array([np.cos(angle), np.sin(angle)])
        limit = float(np.min(middle * step / np.maximum(np.abs(direction), 1e-12)))
        lags = np.append(np.arange(0.0, limit, step.min() / 4.0), limit)
        points = direction[:, None] * lags / step[:, None] + middle[:, None]
        values = scipy.ndimage.map_coordinates(coefficients, points, order=3, mode="mirror", prefilter=False)
        below = np.flatnonzero(values <= CORRELATION_THRESHOLD)
        if below.size:
            k = int(below[0])
            share = (values[k - 1] - CORRELATION_THRESHOLD) / (values[k - 1] - values[k])
            lengths.append(lags[k - 1] + share * (lags[k] - lags[k - 1]))
        else:
            lengths.append(limit)
            open_ended = True
    if open_ended:
        ShortRecordWarning.warn(
            f"the autocorrelation stays above {CORRELATION_THRESHOLD:g} up to half the map, "
            f"{max(lengths):.4g} m: Str is an upper bound; use a larger map or remove long wavelengths first"
        )
    return float(min(lengths)), float(max(lengths))


def _around_lobe(correlation: Array) -> Array:
    """Middle of a correlation, beyond whose edges nothing of the central lobe is left; all of it if need be.

    With points beside it, so that where it ends is not felt in a spline.
    """
    middle = np.array(correlation.shape) // 2
    least = 0.5 * CORRELATION_THRESHOLD * correlation[tuple(middle)]
    reach = APART
    while (reach + APART < middle).any():
        sides = np.minimum(reach, middle)
        box = correlation[tuple(slice(m - s, m + s + 1) for m, s in zip(middle, sides, strict=True))]
        if max(float(box[[0, -1]].max()), float(box[:, [0, -1]].max())) <= least:
            kept = np.minimum(sides + APART, middle)
            return correlation[tuple(slice(m - k, m + k + 1) for m, k in zip(middle, kept, strict=True))]
        reach *= 2
    return correlation
