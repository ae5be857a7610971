"""Vector fitting: common poles of many responses, and their residues."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.errors import ComputationError, InputError

Domain = Literal["half-plane", "disc"]


@dataclass(frozen=True, eq=False)
class RationalFit:
    """Responses as sums over common stable poles.

    A response is the sum of r/(s − p) over real poles, and of r/(s − p) + r*/(s − p*) over the others.
    """

    # (p,), im >= 0; those with Im > 0 stand for themselves and their conjugates
    poles: NDArray[np.complex128]
    residues: NDArray[np.complex128]  # (m, p), of each response; real where the pole is real
    error: float  # root mean square of the weighted error, relative to that of the weighted responses


def vector_fit(
    points: ArrayLike,
    responses: ArrayLike,
    poles: ArrayLike,
    *,
    weights: ArrayLike | None = None,
    iterations: int = 10,
    domain: Domain = "half-plane",
    radius: float = 1.0,
) -> RationalFit:
    """Fit responses by rational functions with common poles and no polynomial part.

    Responses (m, n) or (n,) are known at points (n,): s = iω for ``"half-plane"``, z = e^{iωΔt} for
    ``"disc"``; they are those of real signals, so that conjugate points have conjugate responses. Start poles
    (p,) have Im >= 0. Stable poles lie where Re s < 0, or |z| < `radius`; others are mirrored there. They are
    relocated `iterations` times; the best set met is kept.

    B. Gustavsen and A. Semlyen, IEEE Trans. Power Delivery 14 (1999) 1052; relaxed: B. Gustavsen, ibid. 21
    (2006) 1587; one QR factorisation per response: D. Deschrijver et al., IEEE Microw. Wireless Compon. Lett.
    18 (2008) 383. Responses are first compressed to the few that span them.
    """
    s, found = np.asarray(points, dtype=complex), np.asarray(poles, dtype=complex)
    values = np.atleast_2d(np.asarray(responses, dtype=complex))
    weight = np.ones(s.size) if weights is None else np.asarray(weights, dtype=float)
    if not (np.isfinite(s).all() and np.isfinite(values).all() and np.isfinite(weight).all()):
        raise InputError("responses to fit", "values that are not finite", "finite values")
    if s.size < 2 * found.size + 1:
        received = f"{s.size} points for {found.size} poles"
        raise InputError(
            "responses to fit", received, "more than two points per pole", "Fit fewer poles, or give more."
        )
    weighted = weight * values
    scale, spanning = np.linalg.norm(weighted), _spanning(weighted)
    best = RationalFit(found, np.zeros((len(values), found.size), dtype=complex), np.inf)
    for _ in range(iterations):
        found = _stable(_relocated(s, weight, spanning, found), domain, radius)
        if found.size == 0 or not np.isfinite(found).all():
            break
        residues, left = _residues(s, weight, weighted, found)
        error = float(np.linalg.norm(left) / scale) if scale > 0.0 else 0.0
        if error < best.error:
            best = RationalFit(found, residues, error)
    if not np.isfinite(best.error):
        raise ComputationError("the rational fit broke down", "fewer poles, or a smoother response")
    return best


def partial_fractions(
    points: NDArray[np.complex128], poles: NDArray[np.complex128]
) -> NDArray[np.complex128]:
    """Real-coefficient basis (n, p + q) of partial fractions at points s (n,), poles (p,) with Im >= 0.

    For each pole 1/(s − p), or for Im > 0 the two columns 1/(s − p) ± 1/(s − p*), the second times i.
    """
    columns = []
    for pole in poles:
        first = 1.0 / (points - pole)
        if pole.imag == 0.0:
            columns.append(first)
        else:
            second = 1.0 / (points - np.conj(pole))
            columns += [first + second, 1j * (first - second)]
    return np.array(columns).T


def _spanning(weighted: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Few real combinations of the responses that span all of them, by singular values."""
    joined = np.concatenate([weighted.real, weighted.imag], axis=1)
    _, size, rows = np.linalg.svd(joined, full_matrices=False)
    large = size > 1e-4 * size[0]
    real, imaginary = np.hsplit(size[large, None] * rows[large], 2)
    return np.asarray(real + 1j * imaginary)


def _stacked(matrix: NDArray[np.complex128]) -> NDArray[np.float64]:
    return np.concatenate([matrix.real, matrix.imag])


def _relocated(
    s: NDArray[np.complex128],
    weight: NDArray[np.float64],
    spanning: NDArray[np.complex128],
    poles: NDArray[np.complex128],
) -> NDArray[np.complex128]:
    """Zeros of the fitted scaling function: the next poles."""
    basis = partial_fractions(s, poles)
    known, unknowns = _stacked(weight[:, None] * basis), basis.shape[1]
    scaling = np.column_stack([basis, np.ones(s.size)])
    blocks: list[NDArray[np.float64]] = []
    for response in spanning:  # already weighted
        system = np.hstack([known, -_stacked(response[:, None] * scaling)])
        blocks.append(np.asarray(np.linalg.qr(system, mode="r"))[unknowns:, unknowns:])
    scale = np.linalg.norm(spanning) / s.size
    relaxation = scale * scaling.real.sum(axis=0)
    matrix = np.vstack([*blocks, relaxation])
    right = np.zeros(len(matrix))
    right[-1] = scale * s.size
    size = np.linalg.norm(matrix, axis=0)
    solution = np.linalg.lstsq(matrix / size, right, rcond=None)[0] / size
    state, drive = _realisation(poles)
    with np.errstate(divide="ignore", invalid="ignore"):
        update = np.outer(drive, solution[:-1]) / solution[-1]
    if not np.isfinite(update).all():
        return np.zeros(0, dtype=complex)
    zeros = np.linalg.eigvals(state - update)
    zeros = np.where(np.abs(zeros.imag) <= 1e-12 * np.abs(zeros), zeros.real, zeros)
    return zeros[zeros.imag >= 0.0]


def _realisation(poles: NDArray[np.complex128]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Real state matrix and input vector of the partial fractions."""
    columns = int(np.sum(np.where(poles.imag == 0.0, 1, 2)))
    state, drive, i = np.zeros((columns, columns)), np.zeros(columns), 0
    for pole in poles:
        if pole.imag == 0.0:
            state[i, i], drive[i] = pole.real, 1.0
            i += 1
        else:
            state[i : i + 2, i : i + 2] = [[pole.real, pole.imag], [-pole.imag, pole.real]]
            drive[i] = 2.0
            i += 2
    return state, drive


def _stable(poles: NDArray[np.complex128], domain: Domain, radius: float) -> NDArray[np.complex128]:
    if domain == "disc":
        with np.errstate(divide="ignore", invalid="ignore"):
            mirrored = np.where(np.abs(poles) > radius, radius**2 / np.conj(poles), poles)
    else:
        mirrored = -np.abs(poles.real) + 1j * poles.imag
    return np.asarray(mirrored, dtype=complex)


def _residues(
    s: NDArray[np.complex128],
    weight: NDArray[np.float64],
    weighted: NDArray[np.complex128],
    poles: NDArray[np.complex128],
) -> tuple[NDArray[np.complex128], NDArray[np.float64]]:
    """Residues by least squares, and what they leave of the weighted responses."""
    matrix = _stacked(weight[:, None] * partial_fractions(s, poles))
    right = np.concatenate([weighted.real, weighted.imag], axis=1).T
    size = np.linalg.norm(matrix, axis=0)
    solution = np.linalg.lstsq(matrix / size, right, rcond=None)[0] / size[:, None]
    return paired(solution, poles), matrix @ solution - right


def paired(coefficients: NDArray[np.float64], poles: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Complex residues (m, p) from the real coefficients (p + q, m) of `partial_fractions`."""
    result, i = np.zeros((coefficients.shape[1], poles.size), dtype=complex), 0
    for j, pole in enumerate(poles):
        if pole.imag == 0.0:
            result[:, j] = coefficients[i]
            i += 1
        else:
            result[:, j] = coefficients[i] + 1j * coefficients[i + 1]
            i += 2
    return result
