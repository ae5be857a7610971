"""Steps of oscillators and bodies: exact for forces that are linear over a step."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import block_diag, eigh

from asperity.arguments import Array
from asperity.errors import InputError
from asperity.structures.body import Body

TAYLOR_RADIUS, TAYLOR_TERMS = 0.5, 14  # remainder below 1e-16
RESOLVED = 0.9 * np.pi
"""Angle by which a mode may turn in a step to be followed."""
ROUNDING = 1e-12
"""Share of the largest squared natural frequency of a body that counts as none."""


def exact_step(stiffness: Array, damping: Array, time_step: float) -> Array:
    """Exact steps of ``z'' + D z' + K z = p`` for forces p linear over the step, (k, 2 d, 4 d).

    Of k systems with d coordinates of unit mass, K and D (k, d, d). Factors of z, z', p at the start and p at
    the end: first those that give z at the end of the step, then those that give z' there. They are the
    matrix exponential of the system extended by its force, in time units of the step (Van Loan, IEEE Trans.
    Autom. Control 23 (1978) 395-404): one form for all kinds of systems, without division by a frequency.
    """
    h, (k, d, _) = time_step, stiffness.shape
    generator = np.zeros((k, 4 * d, 4 * d))
    place, rate, force, rise = (slice(i * d, (i + 1) * d) for i in range(4))
    generator[:, place, rate] = generator[:, rate, force] = generator[:, force, rise] = np.eye(d)
    generator[:, rate, place] = -(h**2) * stiffness
    generator[:, rate, rate] = -h * damping
    # rows and columns in z, h z', h^2 p_start, h^2 (p_end - p_start)
    step = exponentials(generator)[:, : 2 * d]
    step[..., force] -= step[..., rise]
    step[..., rate] *= h
    step[..., 2 * d :] *= h**2
    step[:, rate] /= h
    return step


def exponentials(matrices: Array) -> Array:
    """Exponentials of small matrices (k, n, n), all at once: Taylor series, scaled and squared."""
    largest = max(float(np.abs(matrices).sum(axis=2).max(initial=0.0)), 1e-300)  # no logarithm of zero
    squarings = max(0, int(np.ceil(np.log2(largest / TAYLOR_RADIUS))))
    scaled, unit = matrices / 2.0**squarings, np.eye(matrices.shape[-1])
    result = unit + scaled / TAYLOR_TERMS
    for term in range(TAYLOR_TERMS - 1, 0, -1):
        result = unit + scaled @ result / term
    for _ in range(squarings):
        result = result @ result
    return result


def modal_coefficients(natural: ArrayLike, damping_ratio: ArrayLike, time_step: float) -> Array:
    """`exact_step` of modes ``q'' + 2 ζ ω q' + ω² q = p``, one after another: (8, modes).

    ω in rad/s, zero for a free mode; ζ one or more for an overdamped one; the time step in s.
    """
    omega, ratio = (np.asarray(given, dtype=float)[:, None, None] for given in (natural, damping_ratio))
    return np.ascontiguousarray(exact_step(omega**2, 2.0 * ratio * omega, time_step).reshape(-1, 8).T)


def resolved_step(natural: Array, damping_ratio: Array, time_step: float) -> Array:
    """`modal_coefficients`, but of modes that turn by more than RESOLVED in a step only their static answer.

    That is to the force at its end: sampled, they would seem slow, and move the wrong way.
    """
    coefficients = modal_coefficients(natural, damping_ratio, time_step)
    damped = natural * np.sqrt(np.maximum(1.0 - damping_ratio**2, 0.0))
    fast = damped * time_step > RESOLVED
    coefficients[:, fast] = 0.0
    coefficients[3, fast] = 1.0 / natural[fast] ** 2
    return coefficients


def alternating_of_modes(coefficients: Array) -> Array:
    """Alternating compliance of each mode, of coefficients (8, ...), for a shape of one."""
    a = coefficients
    # q and q' change their sign from step to step, as the force does
    determinant = (1.0 + a[0]) * (1.0 + a[5]) - a[1] * a[4]
    return np.asarray(((a[3] - a[2]) * (1.0 + a[5]) - a[1] * (a[7] - a[6])) / determinant)


def body_step(body: Body, time_step: float) -> Array:
    """Exact step of the coordinates y of a body, as `exact_step`: (2, d, 4, d), of y, y' and forces on them.

    Natural coordinates that turn by more than RESOLVED in a step only answer as those of `resolved_step`.
    """
    for what in ("mass", "damping", "stiffness"):
        matrix = getattr(body, what)
        if np.abs(matrix - matrix.T).max() > 1e-9 * np.abs(matrix).max():
            raise InputError(f"{what} of a body", "a matrix that is not symmetric", "a symmetric matrix")
    squares, basis = eigh(body.stiffness, body.mass)  # y = basis z
    largest, d = float(np.abs(squares).max()), len(squares)
    if squares.min() < -1e-9 * largest:
        raise InputError("stiffness of a body", "a negative one", "springs that pull back")
    squares = np.where(squares > ROUNDING * largest, squares, 0.0)
    damping = basis.T @ body.damping @ basis
    turned = np.sqrt(np.maximum(squares - 0.25 * np.diag(damping) ** 2, 0.0)) * time_step
    slow, fast = np.flatnonzero(turned <= RESOLVED), np.flatnonzero(turned > RESOLVED)
    step, places = np.zeros((2 * d, 4 * d)), np.concatenate([slow, d + slow])
    stiffness = np.diag(squares[slow])
    step[np.ix_(places, np.concatenate([places, 2 * d + places]))] = exact_step(
        stiffness[None], damping[np.ix_(slow, slow)][None], time_step
    )[0]
    step[fast, 3 * d + fast] = 1.0 / squares[fast]
    natural = basis.T @ body.mass  # z = natural y
    step = np.kron(np.eye(2), basis) @ step @ block_diag(natural, natural, basis.T, basis.T)
    return np.asarray(step.reshape(2, d, 4, d))


def padded(parts: Sequence[NDArray[Any]]) -> NDArray[Any]:
    """Stack arrays of different sizes, (parts, ...), with zeros behind each."""
    sizes = np.max([part.shape for part in parts], axis=0).astype(int)
    stack = np.zeros((len(parts), *sizes), dtype=parts[0].dtype)
    for k, part in enumerate(parts):
        where: tuple[Any, ...] = tuple(map(slice, part.shape))
        stack[k, *where] = part
    return stack
