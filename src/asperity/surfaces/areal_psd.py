"""Power spectral densities of surfaces.

Spectra come in two conventions. One-sided profile spectrum W(ν), m³ per cycle/m, ν >= 0:
∫ W dν = Sq². Two-sided areal spectrum C(qx, qy), m⁴, angular wavenumbers: ∫∫ C dqx dqy = Sq².
They are tied by W(ν) = 4π ∫ C(2πν, qy) dqy: a factor 2 for one side and 2π for cycles.
"""

from __future__ import annotations

import numpy as np
import scipy
from numpy.typing import NDArray
from scipy import fft

from asperity.errors import InputError
from asperity.surfaces.heightmap import HeightMap, Profile


def psd_1d(surface: HeightMap | Profile, axis: int = 0) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """One-sided profile spectrum along an axis, averaged over all lines: wavenumber, cycles/m, and PSD, m³.

    The heights are complete and levelled, m; the mean of the surface is removed, not that of each line. The
    integral of the PSD is Sq², weighted by the squared Hann window.
    """
    if axis not in range(surface.heights.ndim):
        raise InputError("axis", axis, f"0 to {surface.heights.ndim - 1}")
    lines = np.moveaxis(_complete(surface), axis, -1)
    length = lines.shape[-1]
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(length) / length)
    spacing = float(np.atleast_1d(surface.spacing)[axis])
    density = np.abs(fft.rfft(lines * window, axis=-1)) ** 2 * (2.0 * spacing / np.sum(window**2))
    density[..., 0] /= 2.0
    if length % 2 == 0:
        density[..., -1] /= 2.0
    return fft.rfftfreq(length, spacing), density.reshape(-1, density.shape[-1]).mean(axis=0)


def _complete(surface: HeightMap | Profile) -> NDArray[np.float64]:
    if np.isnan(surface.heights).any():
        received = f"{surface.missing_share:.2%} missing points"
        raise InputError("surface", received, "complete heights for a spectrum", "Use fill first.")
    return surface.heights - surface.heights.mean()


def psd_2d(
    surface: HeightMap, window: bool = True
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Two-sided areal spectrum C(qx, qy), m⁴, with the angular wavenumbers qx and qy, rad/m, rising.

    The heights are complete and levelled, m; the mean is removed. The double integral is Sq², weighted by the
    squared Hann window, without which only a periodic surface is free of leakage.
    """
    z = _complete(surface)
    if window:
        hann = [0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(n) / n) for n in z.shape]
        weights = np.outer(hann[0], hann[1])
        z, energy = z * weights, float(np.sum(weights**2))
    else:
        energy = float(z.size)
    dx, dy = surface.spacing
    density = fft.fftshift(np.abs(fft.fft2(z)) ** 2) * (dx * dy / (4.0 * np.pi**2 * energy))
    qx, qy = (2.0 * np.pi * fft.fftshift(fft.fftfreq(n, d)) for n, d in zip(z.shape, (dx, dy), strict=True))
    return qx, qy, density


def psd_radial(surface: HeightMap, window: bool = True) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Areal spectrum C(q), m⁴, averaged over directions, after the angular wavenumber q, rad/m.

    The heights are complete and levelled, m. Wavenumbers are means over rings as wide as the coarser of the
    two wavenumber steps, up to the largest that both directions reach. For an isotropic surface 2π ∫ C q dq =
    Sq².
    """
    qx, qy, density = psd_2d(surface, window)
    q = np.hypot(qx[:, None], qy[None, :])
    step = max(qx[1] - qx[0], qy[1] - qy[0])
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
    q, angle = np.hypot(qx[:, None], qy[None, :]), np.arctan2(qy[None, :], qx[:, None]) % np.pi
    inside = (q >= 3.0 * max(qx[1] - qx[0], qy[1] - qy[0])) & (q <= min(-qx[0], -qy[0]))
    degrees = np.rint(np.degrees(angle[inside])).astype(np.intp) % 180
    found = smooth = np.bincount(degrees, (q**2 * density)[inside], minlength=180)
    for _ in range(2):
        smooth = scipy.ndimage.uniform_filter1d(smooth, 31, mode="wrap")
    off = (np.arange(180) - smooth.argmax() + 90) % 180 - 90
    near = np.where(np.abs(off) <= 30, found, 0.0)
    turned = 0.5 * np.angle(np.sum(near * np.exp(2j * np.radians(off))))
    return float((np.radians(smooth.argmax()) + turned) % np.pi)
