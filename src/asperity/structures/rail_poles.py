"""The rail as a bank of poles: the moving kernel in a form that costs the same at any length."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.errors import ComputationError, InputError, UnconvergedWarning
from asperity.store import Cache, content_key, made
from asperity.structures.moving_kernel import MovingKernel
from asperity.structures.rational_fit import paired, vector_fit

POLES = 100
"""Poles of a rail where nothing is said of them."""
CELLS = 192
"""Places in one bay at which residues are tabulated; between them they are linear."""
LOWEST = 2.0
"""Lowest frequency of the fit, Hz."""
LINES = 300
"""Frequencies of the fit in each of its two grids, logarithmic and linear."""
PIECE = 64
"""Frequencies transformed in one go."""
ITERATIONS = 8
TOLERANCE = 5e-3
"""Largest error of a fitted kernel that is accepted, relative (see `RailPoles`)."""


@dataclass(frozen=True, eq=False)
class RailPoles:
    """A moving kernel as a sum of decaying oscillations.

    For lags k >= 1 the weights of a start position x are Re Σ_p c_p(x) z_p^(k−1), so that the displacement of
    the next step follows from states q_p ← z_p q_p + c_p(x) F.
    """

    kernel: MovingKernel  # what was fitted
    poles: NDArray[np.complex128]  # (p,), z_p per time step, |z_p| < 1
    residues: NDArray[np.complex128]  # (positions, p), c_p at the start positions, m/N
    fit_error: float  # rms error of the weights of lags >= 1 over all start positions, relative to theirs
    # largest relative error of the deflection under a constant force, the sum of the weights
    static_error: float

    @property
    def count(self) -> int:
        """Number of poles, both of each conjugate pair counted."""
        return int(np.sum(np.where(self.poles.imag == 0.0, 1, 2)))

    @property
    def accepted(self) -> bool:
        """Whether the fit is good enough to stand for the kernel."""
        return max(self.fit_error, self.static_error) <= TOLERANCE

    def weights(self) -> NDArray[np.float64]:
        """The fitted kernel, in the shape of the kernel's weights, m/N."""
        result = self.kernel.weights.copy()
        result[:, 1:] = self.residues.real @ _decays(self.poles, result.shape[1] - 1).real
        result[:, 1:] -= self.residues.imag @ _decays(self.poles, result.shape[1] - 1).imag
        return result


def rail_poles(kernel: MovingKernel, count: int = 100, *, cache: Cache | None = None) -> RailPoles:
    """Fit a moving kernel by common poles, both of each conjugate pair counted, and residues for every start.

    Their number is even, from 4 to a tenth of that of the lags. Poles by vector fitting of the transform on
    the unit circle, with weights between absolute and relative error; residues by least squares in time, of
    the weights, of their running sums (the response to a force that stays) and of the static sum together.
    """
    taps = kernel.weights.shape[1]
    if count % 2 or not 4 <= count <= most_poles(taps):
        allowed = f"an even number from 4 to {most_poles(taps)}, a tenth of the kernel's lags"
        raise InputError("number of poles", count, allowed)
    key = content_key("rail-poles", kernel.weights, kernel.time_step, count, ITERATIONS, LINES)

    def make() -> dict[str, NDArray[Any]]:
        poles = _poles(kernel, count)
        return {"poles": poles, "residues": _residues(kernel.weights[:, 1:], poles)}

    kept = make() if cache is None else made(cache, key, make)
    fit = RailPoles(kernel, kept["poles"], kept["residues"], 0.0, 0.0)
    left = fit.weights()[:, 1:] - kernel.weights[:, 1:]
    error = float(np.linalg.norm(left) / np.linalg.norm(kernel.weights[:, 1:]))
    static = float(np.abs(left.sum(axis=1) / kernel.weights.sum(axis=1)).max())
    if not np.isfinite(error):
        raise ComputationError("the fit of the moving kernel by poles broke down", "fewer poles")
    return RailPoles(kernel, fit.poles, fit.residues, error, static)


def poles_or_kernel(
    kernel: MovingKernel, count: int | None = None, *, cache: Cache | None = None
) -> RailPoles | MovingKernel:
    """Fit a moving kernel by poles, `POLES` of them where it has lags enough, or as many as are asked for.

    Where they miss it, the kernel itself is returned, with a warning.
    """
    wanted = count or min(POLES, most_poles(kernel.weights.shape[1]))
    found = rail_poles(kernel, count=wanted, cache=cache)
    if found.accepted:
        return found
    warnings.warn(
        f"{wanted} poles miss the moving kernel by {100 * found.fit_error:.2g} %: the track is scattered "
        "from the kernel itself, which is slower. Take more poles.",
        UnconvergedWarning,
        stacklevel=2,
    )
    return kernel


def most_poles(lags: int) -> int:
    """Largest even number of poles for a kernel of so many lags."""
    return lags // 10 // 2 * 2


def _poles(kernel: MovingKernel, count: int) -> NDArray[np.complex128]:
    """Common poles, by vector fitting on the unit circle."""
    half = 0.5 / kernel.time_step
    frequency = np.union1d(
        np.geomspace(LOWEST, 0.995 * half, LINES), np.linspace(LOWEST, min(0.2 * half, 5000.0), LINES)
    )
    angle = 2.0 * np.pi * frequency * kernel.time_step
    lag = np.arange(1, kernel.weights.shape[1])
    weights = kernel.weights[:, 1:].astype(complex)
    pieces = np.array_split(angle, math.ceil(angle.size / PIECE))  # the whole matrix is fifty megabytes
    transform = np.hstack([weights @ np.exp(-1j * lag[:, None] * piece) for piece in pieces])
    size = np.sqrt(np.mean(np.abs(transform) ** 2, axis=0))
    start = 2.0 * np.pi * np.geomspace(2.0 * LOWEST, 0.9 * half, count // 2) * kernel.time_step
    fit = vector_fit(
        np.exp(1j * angle),
        transform,
        np.exp(start * (1j - 0.02)),
        weights=1.0 / np.sqrt(size),
        iterations=ITERATIONS,
        domain="disc",
    )
    return fit.poles


def _decays(poles: NDArray[np.complex128], lags: int) -> NDArray[np.complex128]:
    with np.errstate(divide="ignore"):
        rates = np.log(np.where(poles == 0.0, 1e-300, poles))
    return np.asarray(np.exp(rates[:, None] * np.arange(lags)))


def _residues(weights: NDArray[np.float64], poles: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Least squares in time, of the weights, their running sums and their sum."""
    decays = _decays(poles, weights.shape[1])
    columns = []
    for pole, decay in zip(poles, decays, strict=True):
        columns.append(decay.real)
        if pole.imag != 0.0:
            columns.append(-decay.imag)
    basis, right = np.array(columns).T, weights.T
    slow = 1.0 / np.sqrt(len(basis))  # running sums weigh like the weights of one step
    matrix = np.vstack([basis, slow * np.cumsum(basis, axis=0)])
    right = np.vstack([right, slow * np.cumsum(right, axis=0)])
    size = np.linalg.norm(matrix, axis=0)
    solution = np.linalg.lstsq(matrix / size, right, rcond=1e-13)[0] / size[:, None]
    return paired(solution, poles)


def over_the_bay(values: NDArray[Any]) -> NDArray[Any]:
    """Values (positions, ...) at the start positions of a kernel, tabulated over a bay: (CELLS + 1, ...).

    At equal places, both ends of the bay included, by a periodic cubic spline.
    """
    count = len(values)
    through = _periodic_splines(np.arange(float(count)), count)
    between = _periodic_splines(np.linspace(0.0, count, CELLS + 1), count)
    return np.asarray(np.tensordot(between @ np.linalg.inv(through), values, axes=1))


def _periodic_splines(places: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Cubic B-splines (places, count) around the whole numbers below `count`, where they begin again."""
    first = np.floor(places).astype(int)
    t = places - first
    weights = ((1.0 - t) ** 3, 4.0 - 6.0 * t**2 + 3.0 * t**3, 1.0 + 3.0 * (t + t**2 - t**3), t**3)
    splines = np.zeros((len(places), count))
    for shift, weight in zip(range(-1, 3), weights, strict=True):
        np.add.at(splines, (np.arange(len(places)), (first + shift) % count), weight / 6.0)
    return splines
