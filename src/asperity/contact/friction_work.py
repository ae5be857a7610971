"""Work of friction over a step of a contact, by what is known of it: forces, creepages and stored energy.

With tractions p on the first body and their displacement u, both bodies store E = ½ ∫ p·u. Over a rolled
distance δ material slips by s = δ r + u − u', r the rigid creep and a prime what was there before, at the
same material. Its mean traction ½ (p + p') turns W = −½ ∫ (p + p')·s into heat. As displacements are
reciprocal, ∫ p'·u = ∫ p·u', and so

    W = −½ δ [(F + F')·ξ + (M + M') φ − (C + C') χ] − (E − E'),

C = ∫ y² p along being what the curvature χ of the creepage works against. In steady rolling E is E'. In a
shift a cell slips under its bound alone, whatever it has carried before: W = ∫ µ p |s|, with the mean of its
pressures.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from asperity.arguments import Array, Complex
from asperity.contact.friction import SlidingContact, cell_places

Displacement = Callable[[Complex, Array, float], Complex]
"""`FrictionalHalfSpace.displacement`, of traction and pressure (nx, ny), Pa, at places so far ahead, m."""


def with_work(
    found: SlidingContact,
    before: SlidingContact | None,
    distance: float,
    displacement: Displacement,
    coupled: bool,
) -> SlidingContact:
    """A solution with its work, rolled by a distance, m, or shifted if that is zero, and its elastic energy.

    The latter is found where it is not known yet (NaN).
    Where pressure and traction act on each other, `coupled`, what the pressure displaces counts as well.
    """
    stored = found.elastic_energy
    if math.isnan(stored):
        traction = found.traction[0] + 1j * found.traction[1]
        moved = displacement(traction, np.zeros(found.normal.pressure.shape), 0.0)
        stored = 0.5 * float((traction.conj() * moved).real.sum()) * found.normal.half_space.cell_area
    if distance == 0.0:
        return replace(found, work=_shifted(found, before, displacement), elastic_energy=stored)
    past = before or found
    work = 0.5 * (driven(found, found) + driven(past, found))
    if before is not None:
        work -= (stored - before.elastic_energy) / distance
    if coupled:
        work -= _pressed(found, past, displacement, distance) / distance
    return replace(found, work=work, elastic_energy=stored)


def driven(state: SlidingContact, moved: SlidingContact) -> float:
    """What drives the creepages of a contact that moved against the friction of a state, J/m of distance."""
    along, across = state.force
    xi, eta, spin = moved.creepage
    against = along * xi + across * eta
    if spin:
        against += state.moment * spin
    if moved.creepage_curvature:
        against -= state.second_moment * moved.creepage_curvature
    return -against


def _pressed(
    found: SlidingContact, past: SlidingContact, displacement: Displacement, distance: float
) -> float:
    """Work of the mean traction on what pressure displaces in a step, J, of unlike bodies."""
    none = np.zeros(found.normal.pressure.shape, complex)
    total = 0.0
    for state, other, ahead, sign in (
        (found, found, 0.0, 1.0), (found, past, distance, -1.0),
        (past, found, -distance, 1.0), (past, past, 0.0, -1.0),
    ):  # fmt: skip
        moved = displacement(none, other.normal.pressure, ahead)
        total += sign * float((state.traction[0] * moved.real + state.traction[1] * moved.imag).sum())
    return 0.5 * total * found.normal.half_space.cell_area


def _shifted(found: SlidingContact, before: SlidingContact | None, displacement: Displacement) -> float:
    """Work of a shift, J: a cell slips under the mean of its pressures and the coefficient it ends with."""
    now = found.normal.pressure
    past = (before or found).normal.pressure
    slip = np.hypot(*found.slip)
    slip[found.sticks] = 0.0
    coefficient = _over(found.bound, now)
    if before is not None and ((now == 0.0) & (past > 0.0)).any():  # as it leaves the contact it slips freely
        x, y = cell_places(found.normal.half_space)
        xi, eta, spin = found.creepage
        moved = [
            displacement(each.traction[0] + 1j * each.traction[1], each.normal.pressure, 0.0)
            for each in (found, before)
        ]
        left = np.abs(xi - spin * y + 1j * (eta + spin * x) + moved[0] - moved[1])
        slip = np.where(now > 0.0, slip, left)
        coefficient = np.where(now > 0.0, coefficient, _over(before.bound, past))
    return float((coefficient * 0.5 * (now + past) * slip).sum()) * found.normal.half_space.cell_area


def _over(bound: Array, pressure: Array) -> Array:
    """Coefficient of friction of cells (nx, ny), zero out of contact."""
    return np.divide(bound, pressure, out=np.zeros_like(bound), where=pressure > 0.0)
