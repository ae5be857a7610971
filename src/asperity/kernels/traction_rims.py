"""Cells at rims of a contact with friction: how tractions displace them otherwise than whole cells.

What is missing of the bound, m = g − |q|, is like a pressure where the region that sticks ends: A √s at a
distance s inside, and beyond it the bodies slip as surfaces part beyond a contact. Where contact ends the
bound does so as well. A traction is the difference of both (C. Cattaneo, J. Jäger, M. Ciavarella), and so is
what is left in the cells that their rims cross, by the curves of `kernels.rims`. With q = |q| t, G and ν, the
normal n of a rim, and w, S and R of `kernels.rims`,

    Ψ = L(m) − L(g),  L(f) = w S R(√(f/S)) (t − ν n (n·t))/G

is added to the displacement by tractions on cells: a body gives way along a rim as under a pressure there,
and 1/(1 − ν) times as much aside. Cells that stick have no slip then, as those of a normal contact no gap.

Where a shift turns back, rims of the slip before stay. What changes from there is as a traction of its own,
whose bound is the room that it has: `room` and `change` stand for g and q, and Ψ for its growth.

In steady rolling the slip of a cell is that of its material since it was a cell ahead, Ψ less Ψ ahead.
Material that rolls in from beyond the contact slips freely until then. Near a leading edge tractions are in
proportion to pressures, and what they displace to the gap beyond, so that Ψ is −L(g) q/g there, and the free
slip counts against the traction. What slips on is opposite to its traction at the end of a step, half a cell
behind the mean of the step.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.options import CALLED, INNER, LOOP, compiled
from asperity.kernels.rim_curves import END, remaining_gap
from asperity.kernels.rims import _add_slopes, _at_rim

SMALL = 0.5
"""Share of the bound up to which what is left is, in part, what small tractions leave.

Those leave in proportion to themselves and to tractions beside them, in whatever direction those are.
"""
LEAST_ROOT = 1e-6
"""Of √m and what it becomes, over √g, at least, by which a quotient of differences is divided."""
MEMORY, LARGEST_SECANT = 0.4, 1e9
"""Share of a secant that outlasts a step; and the largest, over the displacement of a cell by itself."""


class TractionRims(NamedTuple):
    """Cells of a box at rims of its bound and of what is missing of it.

    For contacts of whole cells None stands in place of this, and nothing of this is compiled.
    """

    along: float  # side of a cell over G, m/Pa
    across: float  # likewise
    poisson: float
    pitch: int  # cells of a row
    ahead: int  # from a cell to the one ahead of it in steady rolling, else zero
    enters: NDArray  # (size,), of cells in contact: whether their material was beyond it before
    beyond: NDArray  # (size,), its free slip over the traction, m/Pa
    behind: NDArray  # (size,), slip over traction of a cell behind one that entered in the step before, m/Pa
    earlier: NDArray  # (size,), slip of the material in the step before, where it slipped, x + iy, m
    origin: NDArray  # (size,), tractions from which they change, of which rims are known, x + iy, Pa
    change: NDArray  # (size,), tractions less these, Pa
    room: NDArray  # (size,), from there to the bound, along the way that they change, Pa
    missing: NDArray  # (size, and a row on both sides,), what is missing of that, Pa
    bound_left: NDArray  # (size,), w S R/G of the room, m
    bound_normal: NDArray  # (size,), normal of its rims, x + iy
    slopes: NDArray  # (3, size), of w S R/G of the room: by itself, and differences beside it, m/Pa
    left: NDArray  # (size,), Ψ, x + iy, m
    fall: NDArray  # (size,), by how much that falls with the root of what is missing, m/√Pa
    # how much more than others cells give way, over their own displacement: as the traction turns, along it
    # beyond that, and to a traction that enters ahead
    turning: NDArray
    steep: NDArray
    entry: NDArray
    toward: NDArray  # (size,), direction of the traction
    added: NDArray  # (size,), what rims add to the slip, m
    growth: NDArray  # (size,), by how much that grew in the last step, m
    secant: NDArray  # (size,), how much more cells gave way in it than they were to, over their displacement


def traction_rims(
    sides: tuple[float, float], poisson: float, pitch: int, ahead: int, enters: NDArray, beyond: NDArray
) -> TractionRims:
    """Make room for the rims of a box whose rows have a pitch; sides over G, m/Pa."""
    size = len(enters)
    missing = np.zeros(size + 2 * pitch)
    room, bound_left, fall, *slopes = np.zeros((6, size))
    bound_normal, left, earlier, origin, change, added, growth = np.zeros((7, size), complex)
    giving = np.zeros((3, size), np.float32)
    known = (*sides, poisson, pitch, ahead, enters, beyond, np.zeros(size), earlier, origin, change)
    of_bound = (room, missing, bound_left, bound_normal, np.array(slopes))
    toward = np.zeros(size, np.complex64)
    of_steps = (added, growth, np.zeros(size))
    return TractionRims._make((*known, *of_bound, left, fall, *giving, toward, *of_steps))


@compiled(**INNER)
def _turned(rims: TractionRims, value: complex, normal: complex) -> complex:
    """What a traction displaces at a rim, over what it does beside one that lies along it."""
    return value - rims.poisson * (value * normal.conjugate()).real * normal


@compiled(**INNER)
def _steps(rims: TractionRims, q: int) -> tuple[float, float, float]:
    """What is missing in a cell, and differences of that beside it along and across, Pa."""
    middle = q + rims.pitch
    x = rims.missing[middle + rims.pitch] - rims.missing[middle - rims.pitch]
    y = rims.missing[middle + 1] - rims.missing[middle - 1]
    return rims.missing[middle], x, y


@compiled(**INNER)
def _rim_at(rims: TractionRims, q: int) -> tuple[float, float, complex]:
    """What a rim of what is missing leaves in a cell, m; by how much it falls with its root; the normal."""
    missing, x, y = _steps(rims, q)
    squares = x * x + y * y
    if squares == 0.0 or missing * missing >= END**4 * squares:
        return 0.0, 0.0, 0.0j
    elongation = (rims.along / rims.across) ** 2
    step, _, width, ratio, slant = _at_rim(missing, abs(x), abs(y), rims.along, elongation)
    left, slope, _ = remaining_gap(ratio, slant)
    return step * width * left, max(-slope * width * np.sqrt(step), 0.0), complex(x, y) / np.sqrt(squares)


@compiled(**LOOP)
def set_bound(rims: TractionRims | None) -> None:
    """Find what rims of the room leave, which is known before any change of the tractions."""
    if rims is not None:
        bound = rims.room
        elongation = (rims.along / rims.across) ** 2
        for q in range(len(bound)):
            rims.missing[q + rims.pitch] = bound[q]
        for q in range(len(bound)):
            if bound[q] > 0.0:
                rims.bound_left[q], _, rims.bound_normal[q] = _rim_at(rims, q)
                if rims.enters[q]:  # what has slipped freely is more than what is left of it
                    rims.beyond[q] = max(rims.beyond[q], rims.bound_left[q] / bound[q])
                if rims.bound_normal[q] != 0.0:
                    g, x, y = _steps(rims, q)
                    _add_slopes(g, x, y, rims.along, elongation, rims.slopes[:, q])


@compiled(**INNER)
def _share_around(bound: NDArray, traction: NDArray, q: int, pitch: int) -> complex:
    """Traction over its bound around a cell."""
    total = traction[q]
    most = bound[q]
    for near in (q - pitch, q - 1, q + 1, q + pitch):
        if 0 <= near < len(traction):
            total += traction[near]
            most += bound[near]
    return total / most


@compiled(**INNER)
def _left_by_large(rims: TractionRims, bound: NDArray, traction: NDArray, q: int) -> complex:
    """Find Ψ of a cell, m, and by how much it falls.

    Where the bound leaves more, the traction around tells the direction: a cell that is hardly covered would
    turn by what it leaves itself.
    """
    size = abs(traction[q])
    toward = traction[q] / size
    left, fall, normal = _rim_at(rims, q)
    rims.fall[q] = fall * (1.0 - rims.poisson * (toward * normal.conjugate()).real ** 2)
    outer = rims.bound_left[q]
    turn = rims.bound_normal[q]
    inside = left * _turned(rims, toward, normal)
    if left >= outer:
        return inside - outer * _turned(rims, toward, turn)
    share = _share_around(bound, traction, q, rims.pitch)
    reached = abs(share)
    less = min((outer - left) / reached, max(outer, 0.0)) if reached > 0.0 else 0.0
    return inside - left * _turned(rims, toward, turn) - less * _turned(rims, share, turn)


@compiled(**INNER)
def _at(traction: NDArray, q: int) -> complex:
    return traction[q] if 0 <= q < len(traction) else 0.0j


@compiled(**INNER)
def _left_by_small(rims: TractionRims, traction: NDArray, q: int) -> complex:
    """Find Ψ of a cell, m, by the slopes of what its bound leaves, which tractions lower."""
    change = rims.slopes[0, q] * traction[q]
    change += rims.slopes[1, q] * (_at(traction, q + rims.pitch) - _at(traction, q - rims.pitch))
    change += rims.slopes[2, q] * (_at(traction, q + 1) - _at(traction, q - 1))
    return -_turned(rims, change, rims.bound_normal[q])


@compiled(**INNER)
def _largeness(bound: NDArray, traction: NDArray, q: int) -> float:
    """Share in which a traction counts as large, from 0 to 1."""
    size = min(abs(traction[q]) / (SMALL * bound[q]), 1.0)
    return size * size * (3.0 - 2.0 * size)


@compiled(**LOOP)
def find_left(rims: TractionRims, tractions: NDArray) -> None:
    """Find what is left in cells under tractions, beyond what is where they change from."""
    bound, traction = rims.room, rims.change
    for q in range(len(bound)):
        traction[q] = tractions[q] - rims.origin[q]
    for q in range(len(bound)):
        rims.missing[q + rims.pitch] = max(bound[q] - abs(traction[q]), 0.0)
    for q in range(len(bound)):
        rims.left[q] = 0.0j
        rims.fall[q] = 0.0
        if rims.enters[q]:
            share = rims.bound_left[q] / bound[q]
            rims.left[q] = -share * _turned(rims, traction[q], rims.bound_normal[q])
        elif bound[q] > 0.0:
            large = _largeness(bound, traction, q)
            if large > 0.0:
                rims.left[q] = large * _left_by_large(rims, bound, traction, q)
            if large < 1.0 and rims.bound_normal[q] != 0.0:
                rims.left[q] += (1.0 - large) * _left_by_small(rims, traction, q)


@compiled(**INNER)
def _left_ahead(rims: TractionRims, bound: NDArray, traction: NDArray, q: int) -> complex:
    """What is left in a cell, as the material behind it has left it, m.

    A cell that its material has just entered, and that may hardly be covered, has the share of both.
    """
    if not rims.enters[q]:
        return rims.left[q]
    behind = q - rims.ahead
    share = rims.bound_left[q] / (bound[q] + bound[behind])
    return -share * _turned(rims, traction[q] + traction[behind], rims.bound_normal[q])


@compiled(**CALLED)
def add_left(rims: TractionRims | None, traction: NDArray, slip: NDArray) -> None:
    """Add what is left under a traction to a slip on whole cells: in steady rolling less that ahead."""
    if rims is not None:
        find_left(rims, traction)
        for q in range(len(traction)):
            added = rims.left[q] + rims.behind[q] * traction[q]
            if rims.enters[q]:
                added += rims.beyond[q] * _turned(rims, traction[q], rims.bound_normal[q])
            if rims.ahead > 0 and q + rims.ahead < len(traction):
                added -= _left_ahead(rims, rims.room, traction, q + rims.ahead)
            rims.growth[q] = added - rims.added[q]
            rims.added[q] = added
            slip[q] += added


@compiled(**INNER)
def _quotient(rims: TractionRims, q: int, most: float, unmet: float, diagonal: float) -> float:
    """By how much what is left falls over what is missing, m/Pa, up to where no slip would be unmet.

    What is left is straight in the root of what is missing, and no other cell changes.
    """
    fall = rims.fall[q]
    if fall == 0.0:
        return 0.0
    missing = rims.missing[q + rims.pitch]
    root = np.sqrt(missing)
    square = fall * fall + 4.0 * diagonal * (diagonal * missing + fall * root + unmet)
    met = max(np.sqrt(max(square, 0.0)) - fall, 0.0) / (2.0 * diagonal)
    return fall / max(root + met, LEAST_ROOT * np.sqrt(most))


@compiled(**INNER)
def _set_giving_of(
    rims: TractionRims, bound: NDArray, traction: NDArray, q: int, sticks: bool, unmet: float, diagonal: float
) -> None:
    """Find how much more than a whole one a cell gives way, whose slip along its traction is unmet, m."""
    large = _largeness(bound, traction, q)
    small = max(-rims.slopes[0, q], 0.0)
    turning = small
    if large == 1.0:
        turning = max((rims.left[q] * traction[q].conjugate()).real / abs(traction[q]) ** 2, 0.0)
    rims.turning[q] = turning / diagonal
    if sticks:
        along = large * _quotient(rims, q, bound[q], unmet, diagonal) + (1.0 - large) * small
        rims.steep[q] = (along - turning) / diagonal


@compiled(**CALLED)
def set_giving(rims: TractionRims | None, slip: NDArray, normal: NDArray, diagonal: float) -> None:
    """Find how much more cells give way than whole ones do, of which each does by its diagonal, m/Pa."""
    if rims is not None:
        bound, traction = rims.room, rims.change
        for q in range(len(bound)):
            rims.turning[q] = rims.steep[q] = rims.entry[q] = 0.0
            rims.toward[q] = 0.0j
            size = abs(traction[q])
            if rims.enters[q]:
                rims.turning[q] = -rims.bound_left[q] / (bound[q] * diagonal)
                behind = q - rims.ahead
                if rims.ahead > 0 and behind >= 0:
                    rims.entry[q] = rims.bound_left[q] / ((bound[q] + bound[behind]) * diagonal)
            elif bound[q] > 0.0:
                toward = traction[q] / size if size > 0.0 else 0.0j
                rims.toward[q] = toward
                unmet = (slip[q] * toward.conjugate()).real
                _set_giving_of(rims, bound, traction, q, normal[q] == 0.0, unmet, diagonal)


@compiled(**INNER)
def _giving_aside(rims: TractionRims, q: int, diagonal: float) -> float:
    """The same, but for what the last step told."""
    entering = q + rims.ahead if rims.ahead > 0 and q + rims.ahead < len(rims.entry) else q
    entry = rims.entry[entering] if entering > q else np.float32(0.0)
    return (rims.beyond[q] + rims.behind[q]) / diagonal + rims.turning[q] + entry


@compiled(**INNER)
def giving_aside(rims: TractionRims | None, q: int, diagonal: float) -> float:
    """How much more a cell gives way to a change that turns its traction, over its diagonal."""
    return 0.0 if rims is None else _giving_aside(rims, q, diagonal) + rims.secant[q]


@compiled(**INNER)
def _along(rims: TractionRims, q: int, value: complex) -> complex:
    """Part of a change that lies along the traction."""
    return (value * rims.toward[q].conjugate()).real * rims.toward[q]


@compiled(**CALLED)
def set_secants(rims: TractionRims | None, before: NDArray, traction: NDArray, diagonal: float) -> None:
    """Find by a step how much more cells gave way than `set_giving` tells of each by itself.

    What a cell leaves also follows the tractions beside it, and bends. Where a step overshoots by that the
    next one is shorter, cell by cell: else few cells would go to and fro, and all wait for them. A step that
    turns the traction more than it changes its size is held to what gives way aside.
    """
    if rims is not None:
        for q in range(len(traction)):
            rims.secant[q] *= MEMORY
            step = traction[q] - before[q]
            square = (step * step.conjugate()).real
            if square > 0.0:
                along = _along(rims, q, step)
                more = rims.growth[q] / diagonal - _giving_aside(rims, q, diagonal) * step
                if 2.0 * (along * along.conjugate()).real > square:
                    more -= rims.steep[q] * along
                else:
                    step -= along
                    square = (step * step.conjugate()).real
                secant = (more * step.conjugate()).real / square
                rims.secant[q] = min(max(secant, rims.secant[q]), LARGEST_SECANT)


@compiled(**CALLED)
def forget_secants(rims: TractionRims | None) -> None:
    """Trust in `set_giving` alone, as long as steps halve what is left."""
    if rims is not None:
        rims.secant[:] = 0.0


@compiled(**INNER)
def add_giving(rims: TractionRims | None, step: NDArray, response: NDArray) -> None:
    """Add to the response to a change of the traction what cells give way along it, less that ahead."""
    if rims is not None:
        for q in range(len(step)):
            response[q] += rims.steep[q] * _along(rims, q, step[q])
            ahead = q + rims.ahead
            if rims.ahead > 0 and ahead < len(step):
                if rims.enters[ahead]:
                    response[q] += rims.entry[ahead] * step[ahead]
                else:
                    response[q] -= rims.turning[ahead] * step[ahead]
                    response[q] -= rims.steep[ahead] * _along(rims, ahead, step[ahead])


@compiled(**INNER)
def weigh_giving(rims: TractionRims | None, q: int, slope: float, weight: float, value: complex) -> complex:
    """Weigh a slip, or a change of the traction, by how much a cell gives way in its direction."""
    if rims is None or rims.steep[q] == 0.0:
        return weight * value
    one = np.float32(1.0)
    less = weight - one / np.sqrt(max(one + slope + rims.steep[q], one))
    return weight * value - less * _along(rims, q, value)


@compiled(**INNER)
def carried_on(
    rims: TractionRims | None, q: int, share: float, weight: float, sticks: bool, diagonal: float
) -> float:
    """Share of the slip of a cell that the one behind has as well, if a preconditioner tells it."""
    if rims is None or not sticks:
        return share * weight
    if rims.beyond[q] == 0.0:
        return share
    alone = np.float32(1.0 + rims.beyond[q] / diagonal) + rims.turning[q]
    return (share - rims.entry[q]) / max(alone, share)
