"""The linear reference in the frequency domain: roughness moved between a wheel and a rail at rest.

The force is F = −h/(α_W + α_C + α_R) with the receptances of wheel, contact spring and rail, and the texture
h positive away from contact: F = z/(α_W + α_C + α_R) of heights z. P. J. Remington, Wheel/rail
rolling noise, I: Theoretical analysis, J. Acoust. Soc. Am. 81 (1987); D. J. Thompson, Railway Noise and
Vibration (Elsevier, 2009).
"""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.errors import InputError


class AtContact(Protocol):
    """What rolls, as the linear reference knows it."""

    def receptance(self, frequency: ArrayLike, /) -> NDArray[np.complex128]:
        """Displacement per force at the contact point, m/N."""


def force_transfer(
    frequency: ArrayLike, wheel: AtContact, track: Any, stiffness: float, x: ArrayLike
) -> NDArray[np.complex128]:
    """Contact force per height of the texture, the wheel at given positions on the rail: (n, f), N/m.

    F/z = 1/(α_W + α_C + α_R), force compressive, height out of the material, e^{+iωt}. Frequencies (f,), Hz,
    zero or above: at zero the force is zero, since the wheel is free. Stiffness of the contact at the static
    load, N/m, infinite for a rigid one; positions (n,), m from a sleeper.
    """
    f = np.atleast_1d(np.asarray(frequency, dtype=float))
    if not (f >= 0.0).all():
        raise InputError("frequency (Hz)", float(np.min(f)), "zero or above")
    if not stiffness > 0.0:
        raise InputError("contact stiffness (N/m)", stiffness, "a positive number")
    positions, moving = np.atleast_1d(np.asarray(x, dtype=float)), f > 0.0
    transfer = np.zeros((positions.size, f.size), dtype=complex)
    carried = wheel.receptance(f[moving]) + 1.0 / stiffness
    transfer[:, moving] = 1.0 / (carried + track.receptance(f[moving], positions, positions))
    return transfer


def mean_square_transfer(
    frequency: ArrayLike,
    wheel: AtContact,
    track: Any,
    stiffness: float,
    positions: int = 12,
) -> NDArray[np.float64]:
    """Mean square over a bay of the contact force per height of the texture, |F/z|², (f,), (N/m)².

    As `force_transfer`, at the midpoints of `positions` equal parts of half a bay, which is its own mirror
    image.
    """
    if positions < 1:
        raise InputError("positions in a bay", positions, "one or more")
    x = (np.arange(positions) + 0.5) * 0.5 * track.sleeper_spacing / positions
    return np.mean(np.abs(force_transfer(frequency, wheel, track, stiffness, x)) ** 2, axis=0)


def linear_force_psd(
    frequency: ArrayLike,
    texture_psd: ArrayLike,
    speed: float,
    wheel: AtContact,
    track: Any,
    stiffness: float,
    positions: int = 12,
) -> NDArray[np.float64]:
    """One-sided power spectral density of the linear contact force, (f,), N²/Hz.

    The mean of |F/z|² times W(f/v)/v, where W is the one-sided PSD per cycle/m of the texture that the
    contact feels (wheel and rail added, filtered where a filter belongs), (f,), m³, at the wavenumbers
    frequency/speed; frequency in Hz, speed in m/s; the rest as in `mean_square_transfer`.

    Without motion: at each position the structures answer as if the wheel stood there. Valid while the speed
    is far below that of waves in the rail, and away from the pinned-pinned frequency, whose peak motion
    splits and lowers; without the tones of the sleepers.
    """
    f, texture = np.atleast_1d(np.asarray(frequency, dtype=float)), np.atleast_1d(np.asarray(texture_psd))
    if not (np.isfinite(speed) and speed > 0.0):
        raise InputError("speed (m/s)", speed, "a finite positive number")
    if f.shape != texture.shape:
        raise InputError("texture_psd", f"shape {texture.shape}", f"one value per frequency, {f.shape}")
    return mean_square_transfer(f, wheel, track, stiffness, positions) * texture / speed
