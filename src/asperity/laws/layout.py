"""Laying laws out on a path: a force curve that follows a texture, or a table."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.kernels.piecewise import continued_to_touch, monotone_slopes, zero_crossing
from asperity.kernels.pointforce import SHIFTED, TABLE, Prepared, evaluate_all
from asperity.laws.base import Law
from asperity.reduction.stiffness import ForceCurve
from asperity.reduction.table import PIECE, ForceTable
from asperity.reduction.texture import StateTexture


def on_curve(
    curve: ForceCurve,
    texture: StateTexture | None,
    positions: ArrayLike,
    *,
    form: int = SHIFTED,
    datum: float = 0.0,
    damping: float = 0.0,
    damped_in_flight: bool = False,
    plane: StateTexture | None = None,
) -> Prepared:
    """Lay out a law that is a force curve following a line texture, at positions (n,) of the contact, m.

    The form is `SHIFTED` or `SECANT` of `asperity.kernels.pointforce`, where the rest is explained; without
    texture the path is smooth. The states of the texture count from the plane, m, by default the mean plane.
    """
    at = np.atleast_1d(np.asarray(positions, dtype=float))
    states = np.zeros(1) if texture is None else texture.approaches
    values = np.zeros((at.size, 1)) if texture is None else texture.at(at)
    planes = plane_at(plane, at)
    if plane is not None:
        values -= planes[:, None]
    return Prepared(
        form,
        planes,
        np.ascontiguousarray(states, dtype=float),
        np.ascontiguousarray(values, dtype=float),
        np.zeros((0, len(states))),
        np.zeros(0),
        np.ascontiguousarray(curve.knots, dtype=float),
        np.ascontiguousarray(curve.coefficients, dtype=float),
        float(curve.exponent),
        bool(curve.bilateral),
        float(datum),
        float(damping),
        bool(damped_in_flight),
        float(curve.upper),
    )


def plane_at(plane: StateTexture | None, positions: NDArray[np.float64]) -> NDArray[np.float64]:
    """Plane (n,) from which states count at positions (n,) of the path, m, positive away from contact.

    None is the mean plane.
    """
    return np.zeros(positions.size) if plane is None else np.ascontiguousarray(plane.at(positions)[:, 0])


def on_table(
    table: ForceTable, positions: ArrayLike, *, damping: float = 0.0, plane: StateTexture | None = None
) -> Prepared:
    """Lay out a law that looks the force up in a table, at positions (n,) of the contact, m.

    g = F^(2/3), negative before first touch, and its monotone slopes at every position. Damping in N s/m; the
    table's approaches count from the plane, m, by default the mean plane.
    """
    at = np.atleast_1d(np.asarray(positions, dtype=float))
    root, slopes = np.empty((2, at.size, len(table.approaches)))
    touches = np.empty(at.size)
    for first in range(0, at.size, PIECE):
        piece = slice(first, first + PIECE)
        root[piece], slopes[piece], touches[piece] = _laid_out(table, at[piece])
    return Prepared(
        TABLE,
        plane_at(plane, at),
        np.ascontiguousarray(table.approaches, dtype=float),
        root,
        slopes,
        touches,
        np.zeros(2),
        np.zeros((1, 4)),
        1.5,
        False,
        0.0,
        float(damping),
        False,
        float(table.approaches[-1]),
    )


def _laid_out(
    table: ForceTable, at: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """g = F^(2/3), its slopes and the first touch at some positions."""
    root = np.cbrt(table.at(at)) ** 2
    touches = table.touch_at(at)
    if touches is None:
        # ripples of the spline beside a place where contact is lost are no contact
        touches = zero_crossing(table.approaches, continued_to_touch(table.approaches, root, least=0.05))
    root = _straight_to_touch(table.approaches, root, touches)
    return root, monotone_slopes(table.approaches, root), touches


def _straight_to_touch(
    states: NDArray[np.float64], root: NDArray[np.float64], touches: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Replace g before first touch, and a little after, by the line through the touch and the next state."""
    beyond = states - touches[:, None] > 0.2 * np.gradient(states)
    first = np.minimum(np.argmax(beyond, axis=1), len(states) - 1)
    rows = np.arange(len(root))
    rise = root[rows, first] / np.maximum(states[first] - touches, np.finfo(float).tiny)
    line = np.where(beyond.any(axis=1), rise, 0.0)[:, None] * (states - touches[:, None])
    return np.where(beyond, root, line)


def force(law: Law, positions: ArrayLike, approach: ArrayLike) -> NDArray[np.float64]:
    """Elastic contact force of a law, (n,), N, without damping, at positions (n,) and approaches, m."""
    at = np.atleast_1d(np.asarray(positions, dtype=float))
    delta = np.ascontiguousarray(np.broadcast_to(np.asarray(approach, dtype=float), at.shape))
    prepared = law.prepare(at)
    if isinstance(prepared, Prepared):
        return evaluate_all(prepared, delta, 0)[0]
    return np.array([prepared.evaluate(step, value)[0] for step, value in enumerate(delta)])
