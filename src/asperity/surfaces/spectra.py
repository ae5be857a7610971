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

PIECE = 2**20
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


def _complete(surface: HeightMap | Profile) -> Array:
    """Heights about their mean."""
    _require_complete(surface)
    return surface.heights - surface.heights.mean()


def _require_complete(surface: HeightMap | Profile) -> None:
    received = f"{surface.missing_share:.2%} missing points"
    allowed = "complete heights for a spectrum"
    require(not np.isnan(surface.heights).any(), "surface", received, allowed, "Use fill first.")


def psd_2d(surface: HeightMap) -> tuple[Array, Array, Array]:
    """Two-sided areal spectrum C(qx, qy), m⁴, with the angular wavenumbers qx and qy, rad/m, rising.

    The heights are complete and levelled, m; the mean is removed. The double integral is Sq², weighted by the
    squared Hann window.
    """
    z, (dx, dy) = _complete(surface), surface.spacing
    weights = np.outer(*map(hann_window, z.shape))
    z *= weights  # in place, here and below: maps may be large
    energy = float(np.sum(np.square(weights, out=weights)))
    del weights
    lines = fft.fft2(z)
    del z
    density = np.abs(lines)
    del lines
    np.square(density, out=density)
    density = fft.fftshift(density)
    density *= dx * dy / (4.0 * np.pi**2 * energy)
    steps = zip(density.shape, (dx, dy), strict=True)
    qx, qy = (2.0 * np.pi * fft.fftshift(fft.fftfreq(n, d)) for n, d in steps)
    return qx, qy, density


def psd_radial(surface: HeightMap) -> tuple[Array, Array]:
    """Areal spectrum C(q), m⁴, averaged over directions, after the angular wavenumber q, rad/m.

    The heights are complete and levelled, m. Wavenumbers are means over rings as wide as the coarser of the
    two wavenumber steps, up to the largest that both directions reach. For an isotropic surface 2π ∫ C q dq =
    Sq².
    """
    qx, qy, density = psd_2d(surface)
    q, step = np.hypot(qx[:, None], qy[None, :]), max(qx[1] - qx[0], qy[1] - qy[0])
    rings = int(min(-qx[0], -qy[0]) / step)
    index = np.rint(q / step).astype(np.intp)
    inside = (index >= 1) & (index <= rings)
    count, total, radius = (
        np.bincount(index[inside], weights, minlength=rings + 1)[1:]
        for weights in (None, density[inside], q[inside])
    )
    return radius / count, total / count


def texture_direction(surface: HeightMap) -> float:
    """Direction in which a texture varies most, Std of ISO 25178-2:2021; the lay is at right angles to it.

    An angle from x, rad, 0 to π, within about 1° of parallel ridges and 5° of a texture of Str 0.5;
    meaningless for an isotropic texture. The angular spectrum is that of the slopes, q² C(q), summed over
    rings from three wavenumber steps, below which directions cannot be told apart, to the largest wavenumber
    that both directions reach; the direction is its mean within ±30° of where it is largest, smoothed twice
    over ±15°. Of heights it would be decided by the few waves that are nearly as long as the map, each with
    a power that is chance.
    """
    qx, qy, density = psd_2d(surface)
    power = np.zeros(180)
    for rows in _pieces(density.shape):
        q = np.hypot(qx[rows, None], qy[None, :])
        angle = np.arctan2(qy[None, :], qx[rows, None]) % np.pi
        inside = (q >= 3.0 * max(qx[1] - qx[0], qy[1] - qy[0])) & (q <= min(-qx[0], -qy[0]))
        degrees = np.rint(np.degrees(angle[inside])).astype(np.intp) % 180
        power += np.bincount(degrees, (q**2 * density[rows])[inside], minlength=180)
    smooth = power
    for _ in range(2):
        smooth = scipy.ndimage.uniform_filter1d(smooth, 31, mode="wrap")
    off = (np.arange(180) - smooth.argmax() + 90) % 180 - 90
    near = np.where(np.abs(off) <= 30, power, 0.0)
    turned = 0.5 * np.angle(np.sum(near * np.exp(2j * np.radians(off))))
    return float((np.radians(smooth.argmax()) + turned) % np.pi)


CORRELATION_THRESHOLD = 0.2
"""Default of ISO 25178-3 for Sal and Str."""


def autocorrelation(surface: HeightMap) -> Array:
    """Normalised autocorrelation at lags up to half the map, zero lag in the middle.

    Of shape (2 (nx//2) + 1, 2 (ny//2) + 1). The heights are complete; the mean is removed. ISO 25178-2:2021
    (autocorrelation function).
    """
    z = _complete(surface)
    require(z.any(), "surface", "equal heights everywhere", "a surface with roughness")
    mean = lag_products(z, len(z) // 2) / lag_pairs(len(z), z.shape[1], len(z) // 2)
    return mean / mean[len(z) // 2, z.shape[1] // 2]


def lag_pairs(rows: int, columns: int, reach: int, pieces: int = 1) -> Array:
    """Numbers of pairs of points at the lags of `lag_products`, of so many rows in all, cut into pieces."""
    along, across = (np.abs(np.arange(-n, n + 1)) for n in (reach, columns // 2))
    return np.outer(rows - pieces * along, columns - across)


def lag_products(heights: Array, reach: int) -> Array:
    """Sums of products of heights about the mean, m², at lags up to `reach` along x and half of all across.

    Of shape (2 reach + 1, 2 (columns//2) + 1), zero lag in the middle.
    """
    (rows, columns), workers = heights.shape, thread_count()
    side = columns // 2
    length = fft.next_fast_len(rows + reach, real=True)  # what wraps is beyond the lags
    width = fft.next_fast_len(columns + side)
    along = fft.rfft(heights, length, axis=0, workers=workers)
    across = np.empty((len(along), side + 1), dtype=np.complex128)
    for piece in _pieces((len(along), width)):
        spectrum = fft.fft(along[piece], width, axis=1, workers=workers)
        power = spectrum.real**2 + spectrum.imag**2
        across[piece] = np.conj(fft.rfft(power, axis=1, workers=workers)[:, : side + 1]) / width
    del along
    half = fft.irfft(across, length, axis=0, overwrite_x=True, workers=workers)
    del across
    half = np.concatenate([half[length - reach :], half[: reach + 1]])
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
    middle = np.array(correlation.shape) // 2
    step = np.asarray(spacing)
    lobe = correlation / correlation[tuple(middle)]
    coefficients = scipy.ndimage.spline_filter(lobe, order=3, mode="mirror")
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
