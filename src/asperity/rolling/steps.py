"""Steps of modes and bodies, laid out for the kernel: exact for forces that are linear over a step."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from asperity.errors import InputError
from asperity.kernels.modal import exponentials, modal_coefficients
from asperity.rolling.path import Path
from asperity.rolling.stability import RESOLVED
from asperity.structures.body import Body
from asperity.structures.modal import Modal

Array = NDArray[np.float64]
ON_SUPPORT = 1e-9
"""Distance to a support that counts as none, m."""
PLACES = 256
"""Positions at which mode shapes are looked at."""
ROUNDING = 1e-12
"""Share of the largest squared natural frequency of a body that counts as none."""


class BodySteps(NamedTuple):
    """Arrays of `asperity.kernels.several.Assembly`, of b bodies on n contacts, and what they stand for."""

    core_step: Array
    core_before: Array
    core_now: Array
    core_pressed: Array
    core_damping: Array
    core_stiffness: Array  # (b, d), squared natural frequencies, (rad/s)²
    flexible: Array
    flexible_stiffness: Array  # (b, s), ω²
    flexible_damping: Array
    body: NDArray[np.int64]
    core_shapes: Array
    answers: Array
    flexible_shapes: Array
    own: Array
    bases: tuple[Array, ...]  # of each body (d, d): y = basis z

    @property
    def alternating(self) -> Array:
        """Least alternating compliance of the body at each contact (n,), m/N: of all its contacts at once."""
        found = np.zeros(len(self.body))
        for b in range(len(self.bases)):
            at = np.flatnonzero(self.body == b)
            d = self.core_now.shape[2]
            core = np.linalg.solve(np.eye(2 * d) + self.core_step[b], self.core_now[b] - self.core_before[b])[
                :d
            ]
            modes = alternating_of_modes(self.flexible[:, b])
            rows, shapes = self.core_shapes[at], self.flexible_shapes[at]
            matrix = rows @ core @ rows.T + (shapes * modes) @ shapes.T
            found[at] = float(np.linalg.eigvalsh(0.5 * (matrix + matrix.T)).min())
        return found


def body_steps(bodies: Sequence[Body], time_step: float) -> BodySteps:
    """Lay bodies out for a time step, s, in coordinates z with unit mass and diagonal stiffness, y = V z.

    Coordinates and modes that turn by more than RESOLVED in a step only answer statically to the force at
    its end, as those of `resolved_step`.
    """
    b, d = len(bodies), max(len(body.mass) for body in bodies)
    s, n = max(body.shapes.shape[1] for body in bodies), sum(len(body.places) for body in bodies)
    steps = BodySteps(
        np.tile(np.eye(2 * d), (b, 1, 1)),
        np.zeros((b, 2 * d, d)),
        np.zeros((b, 2 * d, d)),
        np.zeros((b, 2 * d)),
        np.zeros((b, d, d)),
        np.zeros((b, d)),
        np.zeros((8, b, s)),
        np.zeros((b, s)),
        np.zeros((b, s)),
        np.repeat(np.arange(b), [len(body.places) for body in bodies]),
        np.zeros((n, d)),
        np.zeros((n, d)),
        np.zeros((n, s)),
        np.zeros(n),
        tuple(_natural(body)[1] for body in bodies),
    )
    for index, body in enumerate(bodies):
        _lay_core(steps, index, body, time_step)
        _lay_modes(steps, index, body, time_step)
    for k, index in enumerate(steps.body):
        steps.answers[k] = steps.core_now[index, :d] @ steps.core_shapes[k]
        flexible = steps.flexible_shapes[k] ** 2 @ steps.flexible[3, index]
        steps.own[k] = steps.core_shapes[k] @ steps.answers[k] + flexible
    return steps


def _natural(body: Body) -> tuple[Array, Array]:
    """Squared natural frequencies (d,), (rad/s)², without damping, and mass-normalised shapes (d, d)."""
    for what in ("mass", "damping", "stiffness"):
        matrix = getattr(body, what)
        if np.abs(matrix - matrix.T).max() > 1e-9 * np.abs(matrix).max():
            raise InputError(f"{what} of a body", "a matrix that is not symmetric", "a symmetric matrix")
    squares, basis = eigh(body.stiffness, body.mass)
    largest = float(np.abs(squares).max())
    if squares.min() < -1e-9 * largest:
        raise InputError("stiffness of a body", "a negative one", "springs that pull back")
    return np.where(squares > ROUNDING * largest, squares, 0.0), basis


def _lay_core(steps: BodySteps, index: int, body: Body, time_step: float) -> None:
    """Write the coordinates of one body."""
    squares, basis = _natural(body)
    h, count, d = time_step, len(squares), steps.core_now.shape[2]
    damping = basis.T @ body.damping @ basis
    rates = np.sqrt(np.maximum(squares - 0.25 * np.diag(damping) ** 2, 0.0))
    fast = rates * h > RESOLVED
    slow = np.flatnonzero(~fast)
    step, before, now = _core_step(squares[slow], damping[np.ix_(slow, slow)], h)
    both = np.concatenate([slow, d + slow])
    steps.core_step[index, :count, :count] = steps.core_step[index, d : d + count, d : d + count] = 0.0
    steps.core_step[index][np.ix_(both, both)] = step
    steps.core_before[index][np.ix_(both, slow)] = before
    steps.core_now[index][np.ix_(both, slow)] = now
    at = np.flatnonzero(fast)
    steps.core_now[index, at, at] = 1.0 / squares[at]
    pressing = np.zeros(d)
    pressing[:count] = basis.T @ body.pressing
    steps.core_pressed[index] = -(steps.core_before[index] + steps.core_now[index]) @ pressing
    steps.core_damping[index, :count, :count] = damping
    steps.core_stiffness[index, :count] = squares
    steps.core_shapes[np.flatnonzero(steps.body == index), :count] = body.contacts @ basis


def _core_step(squares: Array, damping: Array, time_step: float) -> tuple[Array, Array, Array]:
    """Exact step of z″ + D z′ + ω² z = g: factors of (z, z′), and of g at start and at end of the step.

    As `asperity.kernels.modal.modal_coefficients`, for oscillators that dampers couple.
    """
    h, d = time_step, len(squares)
    generator = np.zeros((4 * d, 4 * d))
    place, rate, force, rise = (slice(i * d, (i + 1) * d) for i in range(4))
    generator[place, rate] = generator[rate, force] = generator[force, rise] = np.eye(d)
    generator[rate, place] = -(h**2) * np.diag(squares)
    generator[rate, rate] = -h * damping
    # rows and columns in z, h z', h^2 g_start, h^2 (g_end - g_start)
    whole = exponentials(generator[None])[0][: 2 * d]
    whole[:, rate] *= h
    whole[:, force] = (whole[:, force] - whole[:, rise]) * h**2
    whole[:, rise] *= h**2
    whole[rate] /= h
    return whole[:, : 2 * d], whole[:, force], whole[:, rise]


def _lay_modes(steps: BodySteps, index: int, body: Body, time_step: float) -> None:
    """Write the modes of one body."""
    natural, ratio = 2.0 * np.pi * body.natural_frequencies, body.damping_ratios
    count = len(natural)
    steps.flexible[:, index, :count] = resolved_step(natural, ratio, time_step)
    steps.flexible_stiffness[index, :count] = natural**2
    steps.flexible_damping[index, :count] = 2.0 * ratio * natural
    steps.flexible_shapes[np.flatnonzero(steps.body == index), :count] = body.shapes


def most_compliance(structure: Modal, paths: Sequence[Path]) -> float:
    """Largest static compliance of a structure on some paths, m/N; infinite if nothing holds it."""
    natural = 2.0 * np.pi * structure.natural_frequencies
    if not (natural > 0.0).all():
        return float("inf")
    every = (path.positions[:: max(1, len(path.positions) // PLACES)] for path in paths)
    return float(max(((structure.shapes(at)[0] / natural) ** 2).sum(axis=1).max() for at in every))


def carried(
    stiffness: NDArray[np.float64],
    shapes: NDArray[np.float64],
    slopes: NDArray[np.float64],
    forces: NDArray[np.float64],
    speed: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Modal displacements and rates (modes,) under constant forces (k,), N, that have long moved at a speed.

    Of ω² (modes,) and of shapes and slopes (k, modes) under the forces. Displacements are the static ones:
    what is left to ring is less by (k v/ω)² than the static displacement of a mode of wavenumber k. A force
    on a support has just come onto a structure at rest; so are modes that nothing holds.
    """
    moving = forces * (
        np.abs(shapes).max(axis=1, initial=0.0) > ON_SUPPORT * np.abs(slopes).max(axis=1, initial=0.0)
    )
    displacement, rate = (
        np.divide(push, stiffness, out=np.zeros_like(stiffness), where=stiffness > 0.0)
        for push in (forces @ shapes, speed * (moving @ slopes))
    )
    return displacement, rate


def resolved_step(
    natural: NDArray[np.float64], damping_ratio: NDArray[np.float64], time_step: float
) -> NDArray[np.float64]:
    """Exact step of modes, (8, modes), as `asperity.kernels.modal.modal_coefficients` has it.

    Of natural angular frequencies (modes,), rad/s, and damping ratios (modes,); time step in s. Of modes that
    turn by more than RESOLVED in a step only the static answer to the force at its end: sampled, they would
    seem slow, and move the wrong way.
    """
    coefficients = modal_coefficients(natural, damping_ratio, time_step)
    damped = natural * np.sqrt(np.maximum(1.0 - damping_ratio**2, 0.0))
    fast = damped * time_step > RESOLVED
    coefficients[:, fast] = 0.0
    coefficients[3, fast] = 1.0 / natural[fast] ** 2
    return coefficients


def alternating_of_modes(coefficients: NDArray[np.float64]) -> NDArray[np.float64]:
    """Alternating compliance of each mode, of coefficients (8, ...), for a shape of one."""
    a = coefficients
    # q and q' change their sign from step to step, as the force does
    determinant = (1.0 + a[0]) * (1.0 + a[5]) - a[1] * a[4]
    return np.asarray(((a[3] - a[2]) * (1.0 + a[5]) - a[1] * (a[7] - a[6])) / determinant)
