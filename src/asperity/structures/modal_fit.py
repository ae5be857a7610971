"""Vector fitting: common poles of many responses, and modes that they make."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import scipy
from scipy.linalg import lapack

from asperity import errors
from asperity.arguments import Array, ArrayLike, Complex, Flags, Indices, NDArray, require
from asperity.errors import ComputationError, InputError
from asperity.spectra import root_mean_square
from asperity.structures.modal import modal_answers
from asperity.threads import one_thread_in_linear_algebra
from asperity.written_numbers import count_of, rounded

BLOCK = 64
"""Columns that are reflected together."""


def vector_fit(
    points: ArrayLike,
    responses: ArrayLike,
    poles: ArrayLike,
    *,
    weights: ArrayLike | None = None,
    iterations: int = 10,
    radius: float | None = None,
) -> Complex:
    """Common stable poles (p,) of rational functions without polynomial part that fit responses.

    A response is the sum of r/(s − p) over real poles, and of r/(s − p) + r*/(s − p*) over the others, which
    have Im p > 0 and stand for themselves and their conjugates.

    Responses (m, n) or (n,) are known at points (n,), more than two for each pole: s = iω, or with a radius
    z = e^{iωΔt}; they are those of real signals, so that conjugate points have conjugate responses. Start
    poles (p,) have Im >= 0. Stable poles lie where Re s < 0, or |z| < `radius`; others are mirrored there.
    They are relocated `iterations` times; the best set met is kept.

    B. Gustavsen and A. Semlyen, IEEE Trans. Power Delivery 14 (1999) 1052; relaxed: B. Gustavsen, ibid. 21
    (2006) 1587; one QR factorisation per response: D. Deschrijver et al., IEEE Microw. Wireless Compon. Lett.
    18 (2008) 383. Responses are first compressed to the few that span them.
    """
    s = np.asarray(points, dtype=complex)
    moved = np.asarray(poles, dtype=complex)
    weight = np.ones(s.size) if weights is None else np.asarray(weights, dtype=float)
    weighted = weight * np.atleast_2d(np.asarray(responses, dtype=complex))
    scale = np.linalg.norm(weighted)
    spanning = _spanning(weighted)
    right = np.concatenate([weighted.real, weighted.imag], axis=1).T
    best = moved
    least = np.inf
    fitted = FittedFractions(s, weight, moved)
    for _ in range(iterations):
        moved = _stable(_relocated(fitted, spanning), radius)
        if moved.size == 0 or not np.isfinite(moved).all():
            break
        fitted = FittedFractions(s, weight, moved)
        error = float(np.linalg.norm(fitted.left_of(right)) / scale) if scale > 0.0 else 0.0
        if error < least:
            best = moved
            least = error
    if not np.isfinite(least):
        raise ComputationError("the rational fit broke down", "fewer poles, or a smoother response")
    return best


def least_squares(matrix: Array, right: Array, smallest: float | None = None) -> Array:
    """Least squares in columns of size one; singular values below a share of the largest are left out."""
    size = np.linalg.norm(matrix, axis=0)
    return (np.linalg.lstsq(matrix / size, right, rcond=smallest)[0].T / size).T


def real_basis(poles: Complex) -> Flags:
    """Which of two real numbers for each pole count (2p,): the first of a real pole, both of a pair."""
    return np.stack([np.ones(poles.size, dtype=bool), poles.imag != 0.0], axis=1).ravel()


def partial_fractions(points: Complex, poles: Complex) -> Complex:
    """Real-coefficient basis (n, p + q) of partial fractions at points s (n,), poles (p,) with Im >= 0.

    For each pole 1/(s − p), or for Im > 0 the two columns 1/(s − p) ± 1/(s − p*), the second times i.
    """
    first, second = (1.0 / (points - each[:, None]) for each in (poles, poles.conj()))
    both = np.where((poles.imag == 0.0)[:, None], first, first + second)
    pairs = np.stack([both, 1j * (first - second)], axis=1).reshape(-1, points.size)
    return pairs[real_basis(poles)].T


def paired(coefficients: Array, poles: Complex) -> Complex:
    """Complex residues (m, p) from the real coefficients (p + q, m) of `partial_fractions`."""
    parts = np.zeros((2 * poles.size, coefficients.shape[1]))
    parts[real_basis(poles)] = coefficients
    return np.ascontiguousarray((parts[::2] + 1j * parts[1::2]).T)


def _spanning(weighted: Complex) -> Complex:
    """Few real combinations of the responses that span all of them, by singular values."""
    joined = np.concatenate([weighted.real, weighted.imag], axis=1)
    _, size, rows = np.linalg.svd(joined, full_matrices=False)
    large = size > 1e-4 * size[0]
    real, imaginary = np.hsplit(size[large, None] * rows[large], 2)
    return real + 1j * imaginary


def _stacked(matrix: Complex) -> Array:
    return np.concatenate([matrix.real, matrix.imag])


@dataclass(frozen=True, eq=False)
class FittedFractions:
    """Partial fractions of some poles, with which weighted responses are fitted by least squares."""

    points: Complex
    weight: Array
    poles: Complex

    @cached_property
    def basis(self) -> Complex:
        """Partial fractions (n, p) at the points, not weighted."""
        return partial_fractions(self.points, self.poles)

    @cached_property
    def _reflectors(self) -> tuple[Array, Array]:
        reflectors, scales, *_ = lapack.dgeqrf(_stacked(self.weight[:, None] * self.basis))
        return reflectors, scales

    def left_of(self, columns: Array) -> Array:
        """What no fractions fit of columns (2 n, k), in as many coordinates (2 n − p, k) as it has."""
        reflectors, scales = self._reflectors
        room = BLOCK * columns.shape[1]
        turned, *_ = lapack.dormqr("L", "T", reflectors, scales, columns, room)
        return np.asarray(turned[len(scales) :])


def _relocated(fitted: FittedFractions, spanning: Complex) -> Complex:
    """Zeros of the fitted scaling function: the next poles."""
    poles = fitted.poles
    scaling = np.column_stack([fitted.basis, np.ones(fitted.points.size)])
    blocks: list[Array] = []
    for response in spanning:  # already weighted
        left = fitted.left_of(_stacked(response[:, None] * scaling))
        blocks.append(np.asarray(np.linalg.qr(left, mode="r")))
    scale = np.linalg.norm(spanning) / fitted.points.size
    matrix = np.vstack([*blocks, scale * scaling.real.sum(axis=0)])  # the last row keeps it from zero
    right = np.zeros(len(matrix))
    right[-1] = scale * fitted.points.size
    solution = least_squares(matrix, right)
    # real state matrix and input vector of the partial fractions
    used = real_basis(poles)
    state = scipy.linalg.block_diag(*(np.array([[p.real, p.imag], [-p.imag, p.real]]) for p in poles))
    drive = np.ravel([[2.0 if p.imag else 1.0, 0.0] for p in poles])[used]
    with np.errstate(divide="ignore", invalid="ignore"):
        update = np.outer(drive, solution[:-1]) / solution[-1]
    if not np.isfinite(update).all():
        return np.zeros(0, dtype=complex)
    zeros = np.linalg.eigvals(state[np.ix_(used, used)] - update)
    zeros = np.where(np.abs(zeros.imag) <= 1e-12 * np.abs(zeros), zeros.real, zeros)
    return zeros[zeros.imag >= 0.0]


def _stable(poles: Complex, radius: float | None) -> Complex:
    if radius is None:
        return -np.abs(poles.real) + 1j * poles.imag
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(np.abs(poles) > radius, radius**2 / np.conj(poles), poles)


Modes = tuple[Array, Array, Array]
"""Frequencies (m,), Hz, damping ratios (m,), and modal masses (m,), kg, or shapes (p, m), kg^(−1/2)."""

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
FEWEST_FREQUENCIES = 10
DOUBTFUL_FIT, REFUSED_FIT = 1.0, 6.0  # dB: warned of, and where mass or unit cannot be right
LEAST_LINES = 0.5  # lines in the width of a mode at half its power, below which it is noted
FLOOR = 0.05  # of the rms of all responses at a frequency, below which errors count no more
MOST_RANKS, SMALL_RANK = 8, 0.02  # of the residual stiffness: its largest parts, and of the largest
SINGULAR = 1e-9  # of the largest eigenvalue of normal equations, below which one is left out
SWEEPS, SETTLED = 30, 1e-6  # of mode shapes at the places of excitation, and their last change


def fit_modes(frequency: Array, receptance: Complex, rigid: Complex) -> Modes:
    """Modes with positive modal masses that add to the rigid motion of a wheel.

    Frequency (n,), Hz, above zero and rising; receptances (n,) of the whole wheel, not zero, and of its rigid
    motion, m/N. Modes in order of frequency; none of a rigid wheel.

    Poles come from vector fitting, modal masses from non-negative least squares: the sum takes energy at
    every frequency, also outside of the band. Relative errors count the same at all points. Modes that
    contribute nothing are left out.
    """
    flexible = receptance - rigid
    weights = 1.0 / np.abs(receptance)
    none = np.zeros(0)
    masses = partial(_modal_masses, frequency, flexible, weights)
    left = float(np.linalg.norm(weights * flexible))
    level = np.abs(receptance)
    return _searched(frequency, flexible[None], weights, level, masses, ((none, none, none), left))


def fit_shapes(frequency: Array, receptance: Complex, rigid: Complex, driven: Indices) -> Modes:
    """Modes with real shapes that add to the rigid motion of a structure.

    Frequency (n,), Hz, above zero and rising; receptances (n, p, e) of p places under forces at e of them,
    whose numbers are `driven`, and of the rigid motion, m/N. Modes with their shapes in order of frequency.

    Poles are common to all responses; the residues of each are the products of its shape at both places, so
    that all modal masses are positive. Errors count relative to each response, but for responses far below
    the others.
    """
    flexible = receptance - rigid
    level = np.sqrt(np.mean(np.abs(receptance) ** 2, axis=(1, 2)))
    weights = 1.0 / np.hypot(np.abs(receptance), FLOOR * level[:, None, None])
    shapes = partial(_mode_shapes, frequency, flexible, weights, driven)
    none = np.zeros(0), np.zeros(0), np.zeros((receptance.shape[1], 0))
    left = float(np.linalg.norm(weights * flexible))
    responses = flexible.reshape(len(frequency), -1).T
    with one_thread_in_linear_algebra():
        return _searched(frequency, responses, 1.0 / level, level, shapes, (none, left))


def check_record(frequency: Array, receptance: Complex) -> None:
    """Refuse receptances (n, p, e), m/N, at rising frequencies (n,), Hz, that no modes can be fitted to."""
    what = "receptance"
    enough = frequency.size >= FEWEST_FREQUENCIES
    require(enough, what, count_of(frequency.size, "frequency"), f"at least {FEWEST_FREQUENCIES}")
    moves = np.abs(receptance).any(axis=(1, 2)).all()
    require(moves, what, "nothing but zeros at a frequency", "a response", "Leave it out.")
    check_range(frequency, receptance)


def level_error(fitted: Complex, given: Complex) -> float:
    """Root mean square of the level differences of receptances, dB."""
    with np.errstate(divide="ignore"):
        return root_mean_square(20.0 * np.log10(np.abs(fitted / given)))


def judge_fit(what: str, error: float, modes: str) -> None:
    """Refuse a fit that misses its receptances by decibels, and warn of one that is doubtful."""
    if not error <= REFUSED_FIT:
        meet = "meets" if modes.startswith("1 ") else "meet"
        received = f"values that {modes} {meet} to {error:.1f} dB only"
        allowed = f"a receptance that modes meet within {REFUSED_FIT:.0f} dB"
        remedy = "Check the mass, the unit m/N, and that it is displacement along the force, not velocity."
        raise InputError(what, received, allowed, remedy)
    if error > DOUBTFUL_FIT:
        errors.UnconvergedWarning.warn(
            f"{modes} meet the given {what} to {error:.1f} dB only, more than {DOUBTFUL_FIT:.0f} dB: "
            "resonances are uncertain by as much. Give a finer or smoother receptance, or the modes."
        )


def check_range(frequency: Array, receptance: Complex) -> None:
    """Refuse what cannot be computed with, m/N at rising frequencies, Hz; zeros are nothing."""
    size = np.abs(receptance).reshape(len(frequency), -1).max(axis=1)
    size = size[size > 0.0]
    low = float(size.min(initial=1.0))
    high = float(size.max(initial=1.0))
    if not (low > 1.0 / LARGEST and high < LARGEST and SLOWEST < frequency[0] < frequency[-1] < LARGEST):
        received = (
            f"{rounded(low, 2)} to {rounded(high, 2)} m/N at {rounded(frequency[0], 2)} to "
            f"{rounded(frequency[-1], 2)} Hz"
        )
        limits = tuple(map(rounded, (1.0 / LARGEST, LARGEST, SLOWEST, LARGEST)))
        allowed = "{} to {} m/N from {} to {} Hz".format(*limits)
        raise InputError("receptance", received, allowed, "Check the units, and the mass.")


def warn_of_short_band(what: str, frequency: Array, highest: float) -> None:
    """Warn where receptances, at rising frequencies, end below twice the highest that matters; Hz."""
    end = frequency[-1] + (frequency[-1] - frequency[-2])  # the next line would be there
    if end >= REACH * highest:
        return
    told = (
        f"The receptances of the {what} end at {rounded(frequency[-1], 4)} Hz, "
        f"{rounded(frequency[-1] / highest, 2)} times numerics.highest_frequency; {REACH:g} times it, "
        f"{rounded(REACH * highest, 4)} Hz, are wanted. Of what is above, little but the stiffness is "
        f"known, and the highest bands may be decibels off. Give them to {rounded(REACH * highest, 4)} Hz, "
        f"or lower numerics.highest_frequency to {rounded(end / REACH, 4)} Hz."
    )
    grade = errors.Grade.WARNING if end >= highest else errors.Grade.OUT
    errors.ShortRecordWarning.warn(told, grade)


def warn_of_wide_lines(frequency: Array, natural: Array, ratios: Array) -> None:
    """Note modes that fall between the lines of a record, rising Hz: noise leaves little of them."""
    inside = (natural > frequency[0]) & (natural < frequency[-1])
    own = natural[inside]
    width = 2.0 * (natural * ratios)[inside]
    apart = np.interp(own, 0.5 * (frequency[1:] + frequency[:-1]), np.diff(frequency))
    narrow = width < LEAST_LINES * apart
    if narrow.any():
        worst = int(np.argmin(width / apart))
        errors.CoarseSamplingWarning.warn(
            f"{int(narrow.sum())} of {own.size} modes are narrower at half their power than half a line of "
            f"the receptance: that at {rounded(own[worst], 4)} Hz is {rounded(width[worst], 2)} Hz wide, "
            f"of lines {rounded(apart[worst])} Hz apart. With noise its loss factor is a guess. Give lines "
            f"at most {rounded(width[worst], 2)} Hz apart there; they need not be even, and a netCDF file "
            "holds many.",
            errors.Grade.NOTE,
        )


def _searched(
    frequency: Array,
    responses: Complex,
    weights: Array,
    level: Array,
    modes_of: Callable[[Complex], tuple[Modes, float]],
    best: tuple[Modes, float],
) -> Modes:
    """Modes of the start poles that leave the least error, tried in turn while more of them are worthwhile.

    Responses (q, n), common weights (n,) and the level (n,) in which peaks are looked for. `modes_of` makes
    modes of given poles, and the weighted error that they leave; `best` are no modes, and that of them.
    """
    mixed = responses
    if len(responses) > MOST_RESPONSES:  # every pole is in every sum of them
        mixed = np.random.default_rng(0).standard_normal((MOST_RESPONSES, len(responses))) @ responses
    for start in _start_poles(frequency, level):
        before = best[1]
        if before <= GOOD_FIT * np.sqrt(responses.size):
            break
        try:
            poles = vector_fit(2j * np.pi * frequency, mixed, start, weights=weights)
            modes, error = modes_of(_with_residual(poles, frequency))
        except (ComputationError, np.linalg.LinAlgError):
            continue
        if error < before:
            best = modes, error
        if len(modes[0]) and error > WORTHWHILE * before:
            break
    return best[0]


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


def _of_poles(poles: Complex) -> tuple[Array, Array]:
    """Natural frequencies, Hz, and damping ratios of poles, rad/s."""
    size = np.abs(poles)
    return size / (2.0 * np.pi), -poles.real / size


def _modal_masses(frequency: Array, flexible: Complex, weights: Array, poles: Complex) -> tuple[Modes, float]:
    """Modes of given poles by non-negative least squares, and the weighted error that they leave."""
    natural, ratio = _of_poles(poles)
    matrix = _stacked(weights[:, None] * modal_answers(frequency, natural, ratio))
    right = _stacked(weights * flexible)
    size = np.linalg.norm(matrix, axis=0)
    # a share is the norm of what a mode contributes
    shares, error = _not_negative(matrix / size, right)
    kept = np.flatnonzero(shares**2 > max(NEGLIGIBLE * error**2, 1e-12 * shares.max(initial=0.0) ** 2))
    kept = kept[np.argsort(natural[kept])]
    shares, error = _not_negative(matrix[:, kept] / size[kept], right)
    kept = kept[shares > 0.0]
    shares = shares[shares > 0.0]
    return (natural[kept], ratio[kept], size[kept] / shares), error


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
    frequency: Array, flexible: Complex, weights: Array, driven: Indices, poles: Complex
) -> tuple[Modes, float]:
    """Modes of given poles with real shapes, and the weighted error that they leave."""
    natural, ratio = _of_poles(poles)
    answers = modal_answers(frequency, natural, ratio)
    scale = np.linalg.norm(answers, axis=0)
    answers = answers / scale
    target = weights * flexible
    sums = _summed(answers, target, weights)
    mode, at_driven = _first_shapes(sums, driven, len(RESIDUAL_MODES))
    for _ in range(2):  # the second time without modes that contribute nothing
        at_driven = _settled(sums, driven, mode, at_driven)
        shapes = _rows(sums, mode, at_driven)
        shapes[driven] = at_driven
        size = np.einsum("ijrr->ijr", sums.products)[:, :, mode]
        parts = np.sqrt(np.einsum("ijr,ir,jr->r", size, shapes**2, at_driven**2))
        left = target - weights * np.einsum(
            "nr,ir,jr->nij", answers[:, mode], shapes, at_driven, optimize=True
        )
        error = float(np.linalg.norm(left))
        kept = np.flatnonzero(parts**2 > max(ONLY_NOISE * error**2, 1e-12 * parts.max(initial=0.0) ** 2))
        kept = kept[np.argsort(natural[mode[kept]], kind="stable")]
        mode = mode[kept]
        at_driven = at_driven[:, kept]
        shapes = shapes[:, kept]
    return (natural[mode], ratio[mode], shapes / np.sqrt(scale[mode])), error


def _summed(answers: Complex, target: Complex, weights: Array) -> _Sums:
    products = np.array(
        [
            [(((answers.conj() * w[:, None] ** 2).T) @ answers).real for w in row.T]
            for row in weights.swapaxes(0, 1)
        ]
    )
    targets = np.einsum("nr,nij->ijr", answers.conj(), weights * target).real
    return _Sums(products, targets)


def _first_shapes(sums: _Sums, driven: Indices, residual: int) -> tuple[Indices, Array]:
    """Shapes at the places of excitation from residues without constraint: the pole of each, and (e, modes).

    Those of a mode are of rank one; the last `residual` poles stand for many modes and may have any rank.
    """
    e = len(driven)
    count = sums.targets.shape[-1]
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


def _settled(sums: _Sums, driven: Indices, mode: Indices, shapes: Array) -> Array:
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
            shapes = shapes + change
            damping = 0.1 * damping
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


def _rows(sums: _Sums, mode: Indices, at_driven: Array) -> Array:
    """Shapes (p, modes) by least squares, for given ones (e, modes) at the places of excitation."""
    rows = []
    for products, targets in zip(sums.products, sums.targets, strict=True):
        matrix = np.einsum("jr,jrs,js->rs", at_driven, products[:, mode[:, None], mode], at_driven)
        rows.append(_solved(matrix, np.einsum("jr,jr->r", at_driven, targets[:, mode])))
    return np.array(rows)


def _solved(matrix: Array, right: Array, positive: bool = False) -> Array:
    """Least squares from their normal equations, in columns of size one."""
    if not right.size:
        return right
    size = np.sqrt(np.diagonal(matrix))
    size = np.where(size > 0.0, size, 1.0)
    values, vectors = np.linalg.eigh(matrix / np.outer(size, size))
    kept = values > SINGULAR * values[-1]
    root = np.sqrt(values[kept])
    vectors = vectors[:, kept]
    turned = (vectors.T @ (right / size)) / root
    if positive:
        return _not_negative(root[:, None] * vectors.T, turned)[0] / size
    return vectors @ (turned / root) / size
