"""Vector fitting: common poles of many responses, and their residues."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal, NamedTuple, TypeVar

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from asperity.errors import CoarseSamplingWarning, ComputationError, Grade, InputError, ShortRecordWarning
from asperity.threads import one_thread_in_linear_algebra

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


Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Modes = tuple[Array, Array, Array]
M = TypeVar("M")

MOST_PEAKS = 60
MOST_RESPONSES = 8  # that poles are looked for in
SPARE_POLES = (0, 2, 5, 10)  # start poles beyond the peaks seen, tried in turn
GOOD_FIT = 1e-4  # relative error at which no further poles are tried
WORTHWHILE = 0.9  # or when they leave more than this share of the error
NEGLIGIBLE = 1e-3  # of the squared error: a mode below it only follows noise
ONLY_NOISE = 0.1  # the same for a mode with shapes, which has more numbers to follow noise with
RESIDUAL_MODES = (1.5, 3.0)  # of the highest frequency: the stiffness of all modes above the band
RESIDUAL_DAMPING = 0.01
LARGEST, SLOWEST = 1e20, 1e-6  # receptance, m/N, or one over it, and frequency, Hz: products stay finite
REACH = 2.0  # of the highest frequency that matters: how far receptances are to be known and are fitted
LEAST_LINES = 0.5  # lines in the width of a mode at half its power, below which it is noted
FLOOR = 0.05  # of the rms of all responses at a frequency, below which errors count no more
MOST_RANKS, SMALL_RANK = 8, 0.02  # of the residual stiffness: its largest parts, and of the largest
SINGULAR = 1e-9  # of the largest eigenvalue of normal equations, below which one is left out
SWEEPS, SETTLED = 30, 1e-6  # of mode shapes at the places of excitation, and their last change


def fit_modes(frequency: Array, receptance: Complex, rigid: Complex) -> Modes:
    """Modes with positive modal masses that add to the rigid motion of a wheel.

    Frequency (n,), Hz, above zero and rising; receptances (n,) of the whole wheel, not zero, and of its rigid
    motion, m/N. Returns frequencies, Hz, damping ratios and modal masses, kg, in order of frequency; none of
    a rigid wheel.

    Poles come from vector fitting, modal masses from non-negative least squares: the sum takes energy at
    every frequency, also outside of the band. Relative errors count the same at all points. Modes that
    contribute nothing are left out.
    """
    check_range(frequency, receptance, rigid)
    flexible, weights = receptance - rigid, 1.0 / np.abs(receptance)
    nothing = (np.zeros(0), np.zeros(0), np.zeros(0))

    def masses(poles: Complex) -> tuple[Modes, float, int]:
        found, error = _modal_masses(frequency, flexible, weights, poles)
        return found, error, len(found[0])

    return _searched(frequency, flexible[None], weights, np.abs(receptance), nothing, masses)


def fit_shapes(frequency: Array, receptance: Complex, rigid: Complex, driven: NDArray[np.intp]) -> Modes:
    """Modes with real shapes that add to the rigid motion of a structure.

    Frequency (n,), Hz, above zero and rising; receptances (n, p, e) of p places under forces at e of them,
    whose numbers are `driven`, and of the rigid motion, m/N. Returns frequencies, Hz, damping ratios and mode
    shapes (p, m), kg^(−1/2), in order of frequency.

    Poles are common to all responses; the residues of each are the products of its shape at both places, so
    that all modal masses are positive. Errors count relative to each response, but for responses far below
    the others.
    """
    check_range(frequency, receptance, rigid)
    flexible = receptance - rigid
    level = np.sqrt(np.mean(np.abs(receptance) ** 2, axis=(1, 2)))
    weights = 1.0 / np.hypot(np.abs(receptance), FLOOR * level[:, None, None])
    nothing = (np.zeros(0), np.zeros(0), np.zeros((receptance.shape[1], 0)))

    def shapes(poles: Complex) -> tuple[Modes, float, int]:
        found, error = _mode_shapes(frequency, flexible, weights, driven, poles)
        return found, error, len(found[0])

    responses, none = flexible.reshape(len(frequency), -1).T, float(np.linalg.norm(weights * flexible))
    with one_thread_in_linear_algebra():
        return _searched(frequency, responses, 1.0 / level, level, nothing, shapes, none)


def check_range(frequency: Array, *receptances: Complex) -> None:
    """Refuse what cannot be computed with, m/N at rising frequencies, Hz; zeros are nothing."""
    for each in receptances:
        size = np.abs(each).reshape(len(frequency), -1).max(axis=1)
        size = size[size > 0.0]
        low, high = float(size.min(initial=1.0)), float(size.max(initial=1.0))
        if not (low > 1.0 / LARGEST and high < LARGEST and SLOWEST < frequency[0] < frequency[-1] < LARGEST):
            received = f"{low:.2g} to {high:.2g} m/N at {frequency[0]:.2g} to {frequency[-1]:.2g} Hz"
            allowed = f"{1.0 / LARGEST:g} to {LARGEST:g} m/N from {SLOWEST:g} to {LARGEST:g} Hz"
            raise InputError("receptance", received, allowed, "Check the units, and the mass.")


def warn_of_short_band(what: str, frequency: Array, highest: float) -> None:
    """Warn where receptances, at rising frequencies, end below twice the highest that matters; Hz."""
    end = frequency[-1] + (frequency[-1] - frequency[-2])  # the next line would be there
    if end >= REACH * highest:
        return
    told = (
        f"The receptances of the {what} end at {frequency[-1]:.4g} Hz, {frequency[-1] / highest:.2g} times "
        f"numerics.highest_frequency; {REACH:g} times it, {REACH * highest:.4g} Hz, are wanted. Of what is "
        "above, little but the stiffness is known, and the highest bands may be decibels off. Give them to "
        f"{REACH * highest:.4g} Hz, or lower numerics.highest_frequency to {end / REACH:.4g} Hz."
    )
    grade = Grade.WARNING if end >= highest else Grade.OUT
    warnings.warn(ShortRecordWarning(told, grade), stacklevel=3)


def warn_of_wide_lines(frequency: Array, natural: Array, ratios: Array) -> None:
    """Note modes that fall between the lines of a record, rising Hz: noise leaves little of them."""
    inside = (natural > frequency[0]) & (natural < frequency[-1])
    own, width = natural[inside], 2.0 * (natural * ratios)[inside]
    apart = np.interp(own, 0.5 * (frequency[1:] + frequency[:-1]), np.diff(frequency))
    narrow = width < LEAST_LINES * apart
    if narrow.any():
        worst = int(np.argmin(width / apart))
        told = (
            f"{int(narrow.sum())} of {own.size} modes are narrower at half their power than half a line of "
            f"the receptance: that at {own[worst]:.4g} Hz is {width[worst]:.2g} Hz wide, of lines "
            f"{apart[worst]:.3g} Hz apart. With noise its loss factor is a guess. Give lines at most "
            f"{width[worst]:.2g} Hz apart there; they need not be even, and a netCDF file holds many."
        )
        warnings.warn(CoarseSamplingWarning(told, Grade.NOTE), stacklevel=4)


def _searched(
    frequency: Array,
    responses: Complex,
    weights: Array,
    level: Array,
    nothing: M,
    residues: Callable[[Complex], tuple[M, float, int]],
    error_of_none: float | None = None,
) -> M:
    """Modes of the start poles that leave the least error, tried in turn while more of them are worthwhile.

    Responses (q, n), common weights (n,) and the level (n,) in which peaks are looked for. `residues` makes
    modes of given poles: they, the weighted error that they leave, and their number.
    """
    best = nothing
    best_error = float(np.linalg.norm(weights * responses[0])) if error_of_none is None else error_of_none
    mixed = responses
    if len(responses) > MOST_RESPONSES:  # every pole is in every sum of them
        mixed = np.random.default_rng(0).standard_normal((MOST_RESPONSES, len(responses))) @ responses
    for start in _start_poles(frequency, level):
        if best_error <= GOOD_FIT * np.sqrt(responses.size):
            break
        try:
            poles = vector_fit(2j * np.pi * frequency, mixed, start, weights=weights).poles
            modes, error, count = residues(_with_residual(poles, frequency))
        except (ComputationError, np.linalg.LinAlgError):
            continue
        before = best_error
        if error < before:
            best, best_error = modes, error
        if count and error > WORTHWHILE * before:
            break
    return best


def _start_poles(frequency: Array, level: Array) -> list[NDArray[Any]]:
    """A weakly damped pole at each high peak, and spare ones spread over the widest gaps between."""
    from scipy.signal import find_peaks  # takes a second to import

    peaks, found = find_peaks(20.0 * np.log10(level), prominence=3.0)
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


def _with_residual(poles: Complex, frequency: Array) -> Complex:
    """Oscillating poles near the band, and those of the residual stiffness above it."""
    natural = np.abs(poles) / (2.0 * np.pi)
    upper = RESIDUAL_MODES[-1] * frequency[-1]
    near = (poles.imag > 0.0) & (poles.real < 0.0) & (natural > 0.5 * frequency[0]) & (natural < upper)
    residual = 2.0 * np.pi * frequency[-1] * np.array(RESIDUAL_MODES)
    damped = np.sqrt(1.0 - RESIDUAL_DAMPING**2)
    return np.concatenate([poles[near], residual * (1j * damped - RESIDUAL_DAMPING)])


def modal_answers(frequency: Array, natural: Array, ratios: Array) -> Complex:
    """Displacement of modes of unit mass per modal force (n, m), s²; frequencies in Hz, e^{+iωt}."""
    omega, own = 2.0 * np.pi * frequency[:, None], 2.0 * np.pi * natural
    return np.asarray(1.0 / (own**2 - omega**2 + 2j * ratios * own * omega))


def _modal_masses(frequency: Array, flexible: Complex, weights: Array, poles: Complex) -> tuple[Modes, float]:
    """Modes of given poles by non-negative least squares, and the weighted error that they leave."""
    omega, natural = 2.0 * np.pi * frequency[:, None], np.abs(poles)
    ratio = -poles.real / natural
    columns = weights[:, None] / (natural**2 - omega**2 + 2j * ratio * natural * omega)
    matrix = np.concatenate([columns.real, columns.imag])
    right = np.concatenate([(weights * flexible).real, (weights * flexible).imag])
    size = np.linalg.norm(matrix, axis=0)
    # a share is the norm of what a mode contributes
    shares, error = _not_negative(matrix / size, right)
    kept = np.flatnonzero(shares**2 > max(NEGLIGIBLE * error**2, 1e-12 * shares.max(initial=0.0) ** 2))
    kept = kept[np.argsort(natural[kept])]
    shares, error = _not_negative(matrix[:, kept] / size[kept], right)
    kept, shares = kept[shares > 0.0], shares[shares > 0.0]
    return (natural[kept] / (2.0 * np.pi), ratio[kept], size[kept] / shares), float(error)


def _not_negative(matrix: Array, right: Array) -> tuple[Array, float]:
    """Least squares without negative values, and the error that they leave."""
    if not matrix.shape[1]:  # scipy ends the process
        return np.zeros(0), float(np.linalg.norm(right))
    try:
        values, error = scipy.optimize.nnls(matrix, right)
    except (RuntimeError, ValueError) as reason:  # it does not converge, or has numbers that are not finite
        raise ComputationError(f"the fit of modal masses broke down: {reason}", "another table") from None
    return values, float(error)


class _Sums(NamedTuple):
    """Weighted sums over frequency of what modes answer: with one another, and with the responses."""

    products: Array  # (p, e, m, m)
    targets: Array  # (p, e, m)


def _mode_shapes(
    frequency: Array, flexible: Complex, weights: Array, driven: NDArray[np.intp], poles: Complex
) -> tuple[Modes, float]:
    """Modes of given poles with real shapes, and the weighted error that they leave."""
    natural = np.abs(poles)
    ratio = -poles.real / natural
    answers = modal_answers(frequency, natural / (2.0 * np.pi), ratio)
    scale = np.linalg.norm(answers, axis=0)
    answers, target = answers / scale, weights * flexible
    sums = _summed(answers, target, weights)
    mode, at_driven = _first_shapes(sums, driven, len(RESIDUAL_MODES))
    for _ in range(2):  # the second time without modes that contribute nothing
        at_driven = _settled(sums, driven, mode, at_driven)
        shapes = _rows(sums, range(target.shape[1]), mode, at_driven)
        shapes[driven] = at_driven
        size = np.einsum("ijrr->ijr", sums.products)[:, :, mode]
        parts = np.sqrt(np.einsum("ijr,ir,jr->r", size, shapes**2, at_driven**2))
        left = target - weights * np.einsum(
            "nr,ir,jr->nij", answers[:, mode], shapes, at_driven, optimize=True
        )
        error = float(np.linalg.norm(left))
        kept = np.flatnonzero(parts**2 > max(ONLY_NOISE * error**2, 1e-12 * parts.max(initial=0.0) ** 2))
        kept = kept[np.argsort(natural[mode[kept]], kind="stable")]
        mode, at_driven, shapes = mode[kept], at_driven[:, kept], shapes[:, kept]
    found = natural[mode] / (2.0 * np.pi), ratio[mode], shapes / np.sqrt(scale[mode])
    return found, error


def _summed(answers: Complex, target: Complex, weights: Array) -> _Sums:
    products = np.array(
        [
            [(((answers.conj() * w[:, None] ** 2).T) @ answers).real for w in row.T]
            for row in weights.swapaxes(0, 1)
        ]
    )
    targets = np.einsum("nr,nij->ijr", answers.conj(), weights * target).real
    return _Sums(products, targets)


def _first_shapes(sums: _Sums, driven: NDArray[np.intp], residual: int) -> tuple[NDArray[np.intp], Array]:
    """Shapes at the places of excitation from residues without constraint: the pole of each, and (e, modes).

    Those of a mode are of rank one; the last `residual` poles stand for many modes and may have any rank.
    """
    e, count = len(driven), sums.targets.shape[-1]
    residues = np.zeros((count, e, e))
    for i in range(e):
        for j in range(e):
            residues[:, i, j] = _solved(sums.products[driven[i], j], sums.targets[driven[i], j], e == 1)
    values, vectors = np.linalg.eigh(0.5 * (residues + residues.swapaxes(1, 2)))
    chosen = np.zeros_like(values, dtype=bool)
    chosen[:, -1] = True
    chosen[count - residual :, -MOST_RANKS:] = True
    chosen &= values > np.maximum(0.0, SMALL_RANK * values[:, -1:])
    mode, rank = np.nonzero(chosen)
    return mode, (np.sqrt(values[mode, rank])[:, None] * vectors[mode, :, rank]).T


def _settled(sums: _Sums, driven: NDArray[np.intp], mode: NDArray[np.intp], shapes: Array) -> Array:
    """Shapes (e, modes) at the places of excitation of least squares, by Levenberg and Marquardt."""
    products = sums.products[driven][:, :, mode[:, None], mode]
    targets = sums.targets[driven][:, :, mode]
    error, slope, curvature = _error_of(shapes, products, targets)
    damping = 1e-3
    for _ in range(SWEEPS):
        matrix = curvature + damping * np.diag(np.diagonal(curvature) + np.finfo(float).tiny)
        change = -np.linalg.solve(matrix, slope.ravel()).reshape(shapes.shape)
        found = _error_of(shapes + change, products, targets)
        if found[0] < error:
            shapes, damping = shapes + change, 0.1 * damping
            error, slope, curvature = found
            if np.linalg.norm(change) <= SETTLED * np.linalg.norm(shapes):
                break
        else:
            damping *= 10.0
            if damping > 1e8:
                break
    return shapes


def _error_of(shapes: Array, products: Array, targets: Array) -> tuple[float, Array, Array]:
    """Squared error of shapes (e, modes) but for a constant, half its slope and Gauss's half curvature."""
    residues = shapes[:, None] * shapes
    pulled = np.einsum("ijrs,ijs->ijr", products, residues)
    error = float(np.sum(residues * (pulled - 2.0 * targets)))
    left = pulled - targets
    slope = np.einsum("ijr,jr->ir", left + left.swapaxes(0, 1), shapes)
    both = products + products.swapaxes(0, 1)
    curvature = np.einsum("jr,ijrs,is->irjs", shapes, both, shapes)
    for i in range(len(shapes)):
        curvature[i, :, i] += np.einsum("jr,jrs,js->rs", shapes, both[i], shapes)
    return error, slope, curvature.reshape(shapes.size, shapes.size)


def _rows(sums: _Sums, places: Iterable[int], mode: NDArray[np.intp], at_driven: Array) -> Array:
    """Shapes (places, modes) by least squares, for given ones (e, modes) at the places of excitation."""
    rows = []
    for i in places:
        products = sums.products[i][:, mode[:, None], mode]
        matrix = np.einsum("jr,jrs,js->rs", at_driven, products, at_driven)
        rows.append(_solved(matrix, np.einsum("jr,jr->r", at_driven, sums.targets[i][:, mode])))
    return np.array(rows)


def _solved(matrix: Array, right: Array, positive: bool = False) -> Array:
    """Least squares from their normal equations, in columns of size one."""
    if not right.size:
        return right
    size = np.sqrt(np.diagonal(matrix))
    size = np.where(size > 0.0, size, 1.0)
    values, vectors = np.linalg.eigh(matrix / np.outer(size, size))
    kept = values > SINGULAR * values[-1]
    root, vectors = np.sqrt(values[kept]), vectors[:, kept]
    turned = (vectors.T @ (right / size)) / root
    if positive:
        return np.asarray(_not_negative(root[:, None] * vectors.T, turned)[0] / size)
    return np.asarray(vectors @ (turned / root) / size)
