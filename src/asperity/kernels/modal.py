"""A step in time: modes, exact for a force linear over it, and the contact force at its end."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.options import INNER, compiled
from asperity.kernels.pointforce import evaluate, with_damping

FORCE_TOLERANCE = 1e-10  # of the force plus the load, at the end of each step
ITERATIONS = 100
TAYLOR_RADIUS, TAYLOR_TERMS = 0.5, 14  # remainder below 1e-16


def modal_coefficients(natural: NDArray, damping_ratio: NDArray, time_step: float) -> NDArray:
    """Exact step of ``q'' + 2 ζ ω q' + ω² q = p`` for a force p linear over the step.

    ω in rad/s, zero for a free mode; ζ one or more for an overdamped one. Returns (8, modes): factors of q,
    q', p at the start and p at the end, first those that give q at the end of the step, then those that give
    q' there. They are the matrix exponential of the oscillator extended by its force, in time units of the
    step (Van Loan, IEEE Trans. Autom. Control 23 (1978) 395-404): one form for all kinds of modes, without
    division by ω.
    """
    phase = np.asarray(natural, dtype=float) * time_step
    generator = np.zeros((phase.size, 4, 4))
    generator[:, 0, 1] = generator[:, 1, 2] = generator[:, 2, 3] = 1.0
    generator[:, 1, 0] = -(phase**2)
    generator[:, 1, 1] = -2.0 * np.asarray(damping_ratio) * phase
    # rows and columns in q, h q', h^2 p_start, h^2 (p_end - p_start)
    step = exponentials(generator)[:, :2]
    step[..., 2] -= step[..., 3]
    step *= np.array([1.0, time_step, time_step**2, time_step**2])
    step[:, 1] /= time_step
    return np.ascontiguousarray(step.reshape(-1, 8).T)


def exponentials(matrices: NDArray) -> NDArray:
    """Exponentials of small matrices (k, n, n), all at once: Taylor series, scaled and squared."""
    largest = float(np.abs(matrices).sum(axis=2).max(initial=0.0))
    largest = max(largest, 1e-300)  # no logarithm of zero
    squarings = max(0, int(np.ceil(np.log2(largest / TAYLOR_RADIUS))))
    scaled, unit = matrices / 2.0**squarings, np.eye(matrices.shape[-1])
    result = unit + scaled / TAYLOR_TERMS
    for term in range(TAYLOR_TERMS - 1, 0, -1):
        result = unit + scaled @ result / term
    for _ in range(squarings):
        result = result @ result
    return result


@compiled(**INNER)
def backward(approach, compliance, before, time_step):  # type: ignore[no-untyped-def]
    """Add the rate of the approach by the backward difference of second order, which damps at any step.

    The approach at the end of the step is for zero force there, `before` that at the start and one step
    earlier, m; the compliance is in m/N. Returns approach, m, and
    rate, m/s, for zero force at the end, and how much they fall per force there, m/N and m/(s N).
    """
    rate = (1.5 * approach - 2.0 * before[0] + 0.5 * before[1]) / time_step
    return approach, rate, compliance, 1.5 * compliance / time_step


@compiled(**INNER)
def refine(low, high, approach, residual, slope, iteration):  # type: ignore[no-untyped-def]
    """Newton step inside a bracket that it narrows; bisection where Newton fails or dawdles.

    The bracket is infinite where still open; the residual rises. Returns the bracket and the next trial
    value.
    """
    if residual < 0.0:
        low = max(low, approach)
    else:
        high = min(high, approach)
    # without contact the residual's slope is one; a smaller one is a texture that outruns the approach
    trial = approach - residual / max(slope, 1.0)
    closed = low > -np.inf and high < np.inf
    # eight steps are more than Newton needs; from there every other one halves the bracket, so that it ends
    if closed and (not (low < trial < high) or (iteration > 8 and iteration % 2 == 0)):
        trial = 0.5 * (low + high)
    return low, high, trial


@compiled(**INNER)
def tolerance(approach, compliance, force, load, relative):  # type: ignore[no-untyped-def]
    """Largest residual of the approach that counts as solved, m."""
    # the last term is what rounding leaves of the approach
    return relative * compliance * (abs(force) + load) + 1e-15 * abs(approach)


@compiled(**INNER)
def solve_step(law, step, free, load, guess):  # type: ignore[no-untyped-def]
    """Contact force at the end of a step, N, evaluations of the law that it took, whether it converged.

    `free` is from `backward`, `load` the scale of the force and `guess` the force expected, N.
    """
    free_approach, rate, compliance, rate_compliance = free
    low, high, approach = -np.inf, np.inf, free_approach - compliance * guess
    for iteration in range(ITERATIONS):
        elastic, stiffness = evaluate(law, step, approach)
        force, stiffness = with_damping(
            elastic, stiffness, rate, rate_compliance, law.damping, law.damped_in_flight
        )
        residual = approach - free_approach + compliance * force
        limit = tolerance(free_approach, compliance, force, load, FORCE_TOLERANCE)
        if abs(residual) <= limit:
            return force, iteration + 1, True
        low, high, approach = refine(low, high, approach, residual, 1.0 + compliance * stiffness, iteration)
        if law.damping > 0.0 and abs(high - low) <= limit:
            # a damper engages with a jump: the force lies inside it
            return (free_approach - approach) / compliance, iteration + 1, True
    return (free_approach - approach) / compliance, ITERATIONS, False
