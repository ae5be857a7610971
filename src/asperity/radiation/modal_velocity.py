"""How fast each mode of a wheel moves in a run, from the spectra of its contact force and of its motion."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from asperity.structures.wheel import Wheel

POINTS = 41
"""Places at which a resonance is looked at, where lines are too far apart for it."""


def modal_velocity_psd(
    wheel: Wheel,
    frequency: NDArray[np.float64],
    force: NDArray[np.float64],
    displacement: NDArray[np.float64],
    compliance: NDArray[np.float64],
) -> NDArray[np.float64]:
    """PSDs of the radial velocity at the contact of the wheel's rigid motion and of each of its modes.

    Parameters
    ----------
    wheel : Wheel
        With p modes.
    frequency : ndarray (f,)
        Lines, Hz, above zero, uniform and rising.
    force, displacement : ndarray (l, f)
        One-sided PSDs of the contact force, N²/Hz, and of the wheel's displacement at the contact, m²/Hz.
    compliance : ndarray (f,)
        |α₀| about that of contact and rail, m/N.

    Returns
    -------
    ndarray (p + 1, l, f)
        (m/s)²/Hz; the rigid motion first.

    Notes
    -----
    S_i = ω²|α_i|²/(|α₀|² + |α_W|²) · (|α₀|² S_F + S_x). For S_x = |α_W|² S_F this is ω²|α_i|² S_F whatever
    α₀ is. The force falls where the wheel resonates, and its motion where the resonances cancel, both within
    less than a line; their sum does neither, so that what multiplies it may be averaged over each line.
    """
    weight = _line_means(wheel, frequency, compliance)
    return np.asarray(weight[:, None] * (compliance**2 * force + displacement))


def _line_means(
    wheel: Wheel, frequency: NDArray[np.float64], compliance: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Mean of ω²|α_i|²/(|α₀|² + |α_W|²) over each line (p + 1, f), with every resonance resolved."""
    step = frequency[1] - frequency[0]
    edges = np.concatenate([frequency - 0.5 * step, frequency[-1:] + 0.5 * step])
    edges[0] = max(edges[0], 1e-3 * step)
    at = [edges, frequency]
    for natural, ratio in zip(wheel.natural_frequencies, wheel.damping_ratios, strict=True):
        reach = np.arcsinh(2.0 * step / (ratio * natural))
        at.append(natural * (1.0 + ratio * np.sinh(np.linspace(-reach, reach, POINTS))))
    fine = np.unique(np.clip(np.concatenate(at), edges[0], edges[-1]))
    omega = 2.0 * np.pi * fine
    pole, residue = wheel.poles[:, None], wheel.residues[:, None]
    flexible = residue / (1j * omega - pole) + residue.conj() / (1j * omega - pole.conj())
    each = np.concatenate([-1.0 / (wheel.mass * omega[None] ** 2) + 0j, flexible])
    other = np.interp(fine, frequency, compliance) ** 2
    value = omega**2 * np.abs(each) ** 2 / (other + np.abs(each.sum(axis=0)) ** 2)
    area = 0.5 * (value[:, 1:] + value[:, :-1]) * np.diff(fine)
    summed = np.concatenate([np.zeros((len(value), 1)), np.cumsum(area, axis=1)], axis=1)
    return np.diff(summed[:, np.searchsorted(fine, edges)], axis=1) / np.diff(edges)
