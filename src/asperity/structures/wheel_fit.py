"""Modes of a wheel from its receptance."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls
from scipy.signal import find_peaks

from asperity.errors import ComputationError
from asperity.structures.rational_fit import vector_fit

Modes = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]

MOST_PEAKS = 60
SPARE_POLES = (0, 2, 5, 10)  # start poles beyond the peaks seen, tried in turn
GOOD_FIT = 1e-4  # relative error at which no further poles are tried
WORTHWHILE = 0.9  # or when they leave more than this share of the error
NEGLIGIBLE = 1e-3  # of the squared error: a mode below it only follows noise
RESIDUAL_MODES = (1.5, 3.0)  # of the highest frequency: the stiffness of all modes above the band
RESIDUAL_DAMPING = 0.01


def fit_modes(
    frequency: NDArray[np.float64], receptance: NDArray[np.complex128], rigid: NDArray[np.complex128]
) -> Modes:
    """Modes with positive modal masses that add to the rigid motion of a wheel.

    Frequency (n,), Hz, above zero and rising; receptances (n,) of the whole wheel, not zero, and of its rigid
    motion, m/N. Returns frequencies, Hz, damping ratios and modal masses, kg, in order of frequency; none of
    a rigid wheel.

    Poles come from vector fitting, modal masses from non-negative least squares: the sum takes energy at
    every frequency, also outside of the band. Relative errors count the same at all points. Modes that
    contribute nothing are left out.
    """
    flexible, weights = receptance - rigid, 1.0 / np.abs(receptance)
    best: Modes = (np.zeros(0), np.zeros(0), np.zeros(0))
    best_error = float(np.linalg.norm(weights * flexible))
    for start in _start_poles(frequency, receptance):
        if best_error <= GOOD_FIT * np.sqrt(frequency.size):
            break
        try:
            poles = vector_fit(2j * np.pi * frequency, flexible, start, weights=weights).poles
        except ComputationError:
            continue
        modes, error = _modal_masses(frequency, flexible, weights, _with_residual(poles, frequency))
        before = best_error
        if error < before:
            best, best_error = modes, error
        if len(best[0]) and error > WORTHWHILE * before:
            break
    return best


def _start_poles(frequency: NDArray[np.float64], receptance: NDArray[np.complex128]) -> list[NDArray[Any]]:
    """A weakly damped pole at each high peak, and spare ones spread over the widest gaps between."""
    peaks, found = find_peaks(20.0 * np.log10(np.abs(receptance)), prominence=3.0)
    peaks = peaks[np.argsort(-found["prominences"])[:MOST_PEAKS]]
    starts = []
    for spare in SPARE_POLES:
        natural = list(frequency[peaks])
        for _ in range(max(spare, 2 - len(natural))):
            knots = sorted([frequency[0], *natural, 1.2 * frequency[-1]])
            low, high = max(pairwise(knots), key=lambda gap: gap[1] - gap[0])
            natural.append(0.5 * (low + high))
        if 2 * len(natural) < frequency.size:
            starts.append(2.0 * np.pi * np.sort(natural) * (1j - 0.01))
    return starts


def _with_residual(poles: NDArray[np.complex128], frequency: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Oscillating poles near the band, and those of the residual stiffness above it."""
    natural = np.abs(poles) / (2.0 * np.pi)
    upper = RESIDUAL_MODES[-1] * frequency[-1]
    near = (poles.imag > 0.0) & (poles.real < 0.0) & (natural > 0.5 * frequency[0]) & (natural < upper)
    residual = 2.0 * np.pi * frequency[-1] * np.array(RESIDUAL_MODES)
    damped = np.sqrt(1.0 - RESIDUAL_DAMPING**2)
    return np.concatenate([poles[near], residual * (1j * damped - RESIDUAL_DAMPING)])


def _modal_masses(
    frequency: NDArray[np.float64],
    flexible: NDArray[np.complex128],
    weights: NDArray[np.float64],
    poles: NDArray[np.complex128],
) -> tuple[Modes, float]:
    """Modes of given poles by non-negative least squares, and the weighted error that they leave."""
    omega, natural = 2.0 * np.pi * frequency[:, None], np.abs(poles)
    ratio = -poles.real / natural
    columns = weights[:, None] / (natural**2 - omega**2 + 2j * ratio * natural * omega)
    matrix = np.concatenate([columns.real, columns.imag])
    right = np.concatenate([(weights * flexible).real, (weights * flexible).imag])
    size = np.linalg.norm(matrix, axis=0)
    shares, error = nnls(matrix / size, right)  # a share is the norm of what a mode contributes
    kept = np.flatnonzero(shares**2 > max(NEGLIGIBLE * error**2, 1e-12 * shares.max(initial=0.0) ** 2))
    kept = kept[np.argsort(natural[kept])]
    shares, error = nnls(matrix[:, kept] / size[kept], right)
    kept, shares = kept[shares > 0.0], shares[shares > 0.0]
    return (natural[kept] / (2.0 * np.pi), ratio[kept], size[kept] / shares), float(error)
