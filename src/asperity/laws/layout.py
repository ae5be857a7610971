"""Laying laws out on a path: a force curve that follows a texture, or a table."""

import numpy as np

from asperity.arguments import Array, ArrayLike, as_row
from asperity.kernels.curves import lay_roots
from asperity.kernels.pointforce import DRY, SECANT, SHIFTED, TABLE, Prepared, evaluate_all
from asperity.laws.spec import Law
from asperity.reduction.stiffness import PIECE, ForceCurve, ForceTable
from asperity.reduction.texture import StateTexture


def on_curve(
    curve: ForceCurve,
    texture: StateTexture | None,
    positions: ArrayLike,
    *,
    datum: float | None = None,
    damping: float = 0.0,
    damped_in_flight: bool = False,
    plane: StateTexture | None = None,
) -> Prepared:
    """Lay out a law that is a force curve following a line texture, at positions (n,) of the contact, m.

    With a datum its form is `SECANT` of `asperity.kernels.pointforce`, where the rest is explained, else
    `SHIFTED`. Without texture the path is smooth. The states of the texture count from the plane, m, by
    default the mean plane.
    """
    at = as_row(positions)
    planes = _plane_at(plane, at)
    states = np.zeros(1) if texture is None else np.ascontiguousarray(texture.approaches, dtype=float)
    values = np.zeros((at.size, 1)) if texture is None else texture.at(at)
    if plane is not None:
        values -= planes[:, None]
    followed = states, values, np.zeros((0, len(states))), np.zeros(0)
    force = curve.knots, curve.coefficients, float(curve.exponent), curve.bilateral
    damper = float(damping), damped_in_flight
    form = SHIFTED if datum is None else SECANT
    return Prepared(form, planes, *followed, *force, float(datum or 0.0), *damper, float(curve.upper), DRY)


def _plane_at(plane: StateTexture | None, positions: Array) -> Array:
    """Plane (n,) from which states count at positions (n,) of the path, m, positive away from contact.

    None is the mean plane.
    """
    return np.zeros(positions.size) if plane is None else np.ascontiguousarray(plane.at(positions)[:, 0])


def on_table(
    table: ForceTable, positions: ArrayLike, *, damping: float, plane: StateTexture | None
) -> Prepared:
    """Lay out a law that looks the force up in a table, at positions (n,) of the contact, m.

    g = F^(2/3), straight and negative before first touch, and its monotone slopes. Damping in N s/m; the
    table's approaches count from the plane, m, by default the mean plane.
    """
    at = as_row(positions)
    states = np.ascontiguousarray(table.approaches, dtype=float)
    root, slopes = np.empty((2, at.size, len(states)))
    touches = table.touch_at(at)
    margins = 0.2 * np.gradient(states)
    for first in range(0, at.size, PIECE):
        piece = slice(first, first + PIECE)
        np.square(np.cbrt(table.at(at[piece])), out=root[piece])
    lay_roots(states, touches, margins, root, slopes)
    no_curve = np.zeros(2), np.zeros((1, 4)), 1.5, False, 0.0
    damper = float(damping), False
    planes = _plane_at(plane, at)
    return Prepared(TABLE, planes, states, root, slopes, touches, *no_curve, *damper, float(states[-1]), DRY)


def force(law: Law, positions: ArrayLike, approach: ArrayLike) -> Array:
    """Elastic contact force of a law, (n,), N, without damping, at positions (n,) and approaches, m."""
    at = as_row(positions)
    delta = np.ascontiguousarray(np.broadcast_to(np.asarray(approach, dtype=float), at.shape))
    prepared = law.prepare(at)
    if isinstance(prepared, Prepared):
        return evaluate_all(prepared, delta, 0)[0]
    return np.array([prepared.evaluate(step, value)[0] for step, value in enumerate(delta)])
