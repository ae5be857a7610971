"""How a force moves rail and sleepers along a track: sums of squares over its length, in closed form."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.errors import InputError
from asperity.structures.periodic_rail import PeriodicWaves
from asperity.structures.track import Track

ForceOverBay = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""Mean square of the force at places (n,), m from a sleeper, at the frequencies (n, f), in any unit."""

FEWEST_NODES = 4  # of Gauss's rule, beside one per radian of the shortest wave


def squared_mobility(
    track: Track, frequency: ArrayLike, force: ForceOverBay | None = None
) -> NDArray[np.float64]:
    """Integral along the rail of the squared mobility, mean over the places of the force in a bay.

    Parameters
    ----------
    track : Track
        With its damping as it is: constant loss factors, or relaxations.
    frequency : array_like (f,)
        Hz, positive.
    force : callable, optional
        How the mean square of the force is spread over a bay, the same on both sides of its middle; evenly
        by default. A wheel presses less where the rail gives way, most of all at mid-span near the
        pinned-pinned frequency.

    Returns
    -------
    ndarray (f,)
        Mean over x₀ of ∫|Y(x|x₀)|² dx over the whole rail, m (m/s)²/N². Times the mean square force it is
        ∫⟨v²⟩dx, on both sides of the force.

    Raises
    ------
    InputError
        If a frequency is not positive, or so high that a wave is lost within a bay.

    Notes
    -----
    Both waves and their products: u_j is wave j in the bay after that of the force, and Σ_p Σ_ij u_i u_j*
    (λ_i λ_j*)^p = Σ_ij u_i u_j*/(1 − λ_i λ_j*) over all bays. Within a bay by Gauss's rule, in that of the
    force from the force on. A bay is its own mirror image, so both sides of the force are alike in the mean.
    """
    omega = 2.0 * np.pi * above_zero(frequency)
    waves, bay = track.waves(omega), track.sleeper_spacing
    node, weight, driven = _driven(waves)
    along = np.stack([waves.outgoing(x) for x in node])  # (x, j, f)
    within = np.einsum("x,xif,xjf->ijf", weight, along, along.conj(), optimize=True)
    total = _over_bays(waves, driven, within)
    for row, (x0, sent) in enumerate(zip(node, driven, strict=True)):
        places, lengths = _gauss(_nodes(waves, bay - x0), bay - x0)
        for x, length in zip(x0 + places, lengths, strict=True):
            total[row] += length * np.abs(np.sum(sent * waves.outgoing(x), axis=0)) ** 2
    return 2.0 * omega**2 * _mean(total, node, weight, force)


def squared_sleeper_mobility(
    track: Track, frequency: ArrayLike, force: ForceOverBay | None = None
) -> NDArray[np.float64]:
    """Sum over all half sleepers of the squared mobility, mean over the places of the force in a bay.

    Velocity of the sleeper per force on the rail, squared, (f,), (m/s)²/N², at positive frequencies (f,), Hz.
    A sleeper on its ballast moves by K_p/(K_p + K_b − m_s ω²) of the rail above it; the rest as in
    `squared_mobility`.
    """
    omega = 2.0 * np.pi * above_zero(frequency)
    waves = track.waves(omega)
    node, weight, driven = _driven(waves)
    above = waves.outgoing(0.0)
    total = _over_bays(waves, driven, above[:, None] * above.conj()[None, :])
    pad, ballast = track.layer_stiffnesses(omega)
    passed_on = np.abs(pad / (pad + ballast - track.sleeper_mass * omega**2)) ** 2
    return 2.0 * omega**2 * passed_on * _mean(total, node, weight, force)


def squared_point_mobility(
    track: Track, frequency: ArrayLike, force: ForceOverBay | None = None
) -> NDArray[np.float64]:
    """Squared mobility of the rail at the force, mean over a bay, (f,), (m/s)²/N²; as `squared_mobility`."""
    omega = 2.0 * np.pi * above_zero(frequency)
    waves = track.waves(omega)
    node, weight = _gauss(_nodes(waves, track.sleeper_spacing), track.sleeper_spacing)
    point = np.stack([np.abs(waves.receptance(x0, x0)) ** 2 for x0 in node])
    return omega**2 * _mean(point, node, weight, force)


def effective_length(track: Track, frequency: ArrayLike) -> NDArray[np.float64]:
    """Length of rail that, moving as it does at the force, holds all of the rail's mean square velocity.

    `squared_mobility` over `squared_point_mobility`, (f,), m; frequencies (f,), Hz, positive. Of one wave
    with a decay rate Δ, dB/m, it is 8.686/Δ.
    """
    return squared_mobility(track, frequency) / squared_point_mobility(track, frequency)


def above_zero(frequency: ArrayLike) -> NDArray[np.float64]:
    """Frequencies (f,), Hz, or an `InputError` where one is not positive."""
    f = np.atleast_1d(np.asarray(frequency, dtype=float))
    if not (np.isfinite(f) & (f > 0.0)).all():
        raise InputError("frequency (Hz)", float(np.min(f)), "finite positive numbers")
    return f


def _mean(
    values: NDArray[np.float64],
    node: NDArray[np.float64],
    weight: NDArray[np.float64],
    force: ForceOverBay | None,
) -> NDArray[np.float64]:
    """Mean over a bay of values (n, f) at places (n,) with the weights of Gauss's rule and of the force."""
    if force is None:
        return np.asarray(weight @ values / weight.sum())
    square = force(node)
    return np.asarray(weight @ (square * values) / (weight @ square))


def _driven(
    waves: PeriodicWaves,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.complex128]]:
    """Places x₀ of the force (n,) in a bay, their weights (n,), and how strongly each sends out the waves."""
    node, weight = _gauss(_nodes(waves, waves.spacing), waves.spacing)
    return node, weight, np.stack([waves.coefficients * waves.incoming(x0) for x0 in node])


def _over_bays(
    waves: PeriodicWaves, driven: NDArray[np.complex128], within: NDArray[np.complex128]
) -> NDArray[np.float64]:
    """Sum over the bays behind that of the force (n, f), of products of waves in one bay (i, j, f)."""
    product = waves.multipliers[:, None] * waves.multipliers.conj()[None, :]
    behind = within * product / (1.0 - product)
    return np.einsum("xif,xjf,ijf->xf", driven, driven.conj(), behind, optimize=True).real


def _nodes(waves: PeriodicWaves, length: float) -> int:
    return FEWEST_NODES + math.ceil(float(np.abs(waves.wavenumbers).max()) * length)


def _gauss(count: int, length: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Nodes and weights on 0 to `length`."""
    node, weight = np.polynomial.legendre.leggauss(count)
    return 0.5 * length * (node + 1.0), 0.5 * length * weight
