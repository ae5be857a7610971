"""Contacts with friction on cells that are covered in part: what their rims leave, from step to step."""

from dataclasses import dataclass

import numpy as np

from asperity.arguments import Array, Complex, Flags, require
from asperity.contact.elastic_grid import box_around
from asperity.contact.friction import SlidingContact, cell_places
from asperity.contact.friction_work import Displacement
from asperity.contact.solved import Contact
from asperity.kernels.traction_rims import find_left, set_bound, traction_rims
from asperity.written_numbers import rounded

NO_ROOM = 1e-6
"""Of tractions to the bound, over that, at least: cells without any are at rims, too."""


def rows_ahead(distance: float, side: float, steady: bool) -> int:
    """Number of cells in a rolled distance, m, of sides along the rolling direction, m.

    Raises
    ------
    InputError
        If it is none that covered cells roll by.
    """
    rows = max(round(distance / side), 1)
    fits = abs(distance - rows * side) <= 1e-6 * side and (rows == 1 or not steady)
    allowed = f"{'' if steady else 'whole numbers of '}the length of a cell, {rounded(side * 1e6, 6)} µm"
    remedy = 'Leave it out, or take cells = "whole".'
    require(fits, "rolled distance on covered cells", f"{rounded(distance * 1e6, 6)} µm", allowed, remedy)
    return rows


def free_slip(normal: Contact, last: Contact, rows: int, poisson: float) -> tuple[Flags, Array]:
    """Cells in contact (nx, ny) whose material was beyond it so many rows ahead, and its free slip.

    Of a contact after the last one; slip over traction, m/Pa: displacements are to the gap, near a leading
    edge, as tractions to pressures.
    """
    pressure = normal.pressure
    enters = _entering(pressure, last.pressure, rows)
    ahead = np.zeros(pressure.shape)
    ahead[:-rows] = last.gap[rows:]
    softness = np.zeros(pressure.shape)
    softness[enters] = ahead[enters] / ((1.0 - poisson) * pressure[enters])
    return enters, softness


def left_ahead(
    state: SlidingContact, rows: int, sides: tuple[float, float], poisson: float
) -> tuple[Complex, Array]:
    """What rims leave in a state (nx, ny), m, so many rows ahead of a cell: see `kernels.traction_rims`.

    And what of it comes from the traction of the cell itself, over that, m/Pa. Sides of a cell over the shear
    modulus, m/Pa. Zero beyond the contact, where slip is that of `free_slip`.
    """
    traction = state.traction[0] + 1j * state.traction[1]
    pressure = state.normal.pressure
    enters = _entering(pressure, pressure, rows) & (state.bound > 0.0) & (state.distance > 0.0)
    left, outer, normal = _left_in(state.bound, traction, enters, sides, poisson)
    behind = np.zeros(pressure.shape)
    if rows == 1:  # the material behind has the share of both
        entered = enters[1:]
        bound = (state.bound[1:] + state.bound[:-1])[entered]
        behind[:-1][entered] = np.maximum(outer[1:][entered], 0.0) / bound
        both = (traction[1:] + traction[:-1])[entered] / bound
        turn = normal[1:][entered]
        both -= poisson * (both * turn.conj()).real * turn
        left[1:][entered] = -outer[1:][entered] * both
    return _ahead(left, rows), behind


def slip_ahead(state: SlidingContact, rows: int) -> Complex:
    """Slip over the distance in a state that rolled (nx, ny), of cells that slip so many rows ahead."""
    if state.distance == 0.0:
        return np.zeros(state.bound.shape, complex)
    return _ahead(np.where(state.sticks, 0.0, state.slip[0] + 1j * state.slip[1]), rows)


def left_by(
    bound: Array, traction: Complex, sides: tuple[float, float], poisson: float, *, rolls: bool = False
) -> Complex:
    """What rims leave by tractions under a bound (nx, ny), m; sides as in `left_ahead`."""
    enters = _entering(bound, bound, 1) & rolls
    return _left_in(bound, traction, enters, sides, poisson)[0]


def stored_energy(
    found: SlidingContact, displacement: Displacement, sides: tuple[float, float], poisson: float
) -> float:
    """Elastic energy of tractions that roll, J; sides as in `left_ahead`."""
    traction = found.traction[0] + 1j * found.traction[1]
    moved = displacement(traction, np.zeros(found.bound.shape), 0.0)
    moved += left_by(found.bound, traction, sides, poisson, rolls=True)
    return 0.5 * float((traction.conj() * moved).real.sum()) * found.normal.half_space.cell_area


@dataclass(frozen=True)
class Turn:
    """A state from which tractions turn back, or have before: rims of the slip until then stay.

    While tractions grow one way, the bound and what is missing of it tell all that their rims leave. Where
    they turn, what changes is as a shift of its own from there, within the room to the bound (R. D. Mindlin
    and H. Deresiewicz, 1953).
    """

    traction: Complex  # (nx, ny), x + iy, Pa
    left: Complex  # what rims leave in it, m
    room: Array  # from there to the bound, the way tractions change, Pa

    def to(self, more: Complex, inside: tuple[slice, slice]) -> Array:
        """What rims leave where more has come in a part of the grid (2, nx, ny), m."""
        left = self.left.copy()
        left[inside] += more
        return np.stack([left.real, left.imag])


def turn_at(
    before: SlidingContact,
    motion: tuple[float, ...],
    bound: Array,
    sides: tuple[float, float],
    poisson: float,
) -> Turn | None:
    """Where a shift turns back from a state, or goes on from one that has; None if it does neither.

    Motion and bound (nx, ny), Pa, are those of the shift; sides as in `left_ahead`.
    """
    traction = before.traction[0] + 1j * before.traction[1]
    xi, eta, spin = motion
    x, y = cell_places(before.normal.half_space)
    change = -complex(xi, eta) - spin * (1j * x - y)
    if not np.any(change):  # a bound that falls lowers them
        change = -traction
    size = np.abs(change)
    way = change / np.where(size > 0.0, size, 1.0)
    along = (traction * way.conj()).real
    if before.left is not None:
        left = before.left[0] + 1j * before.left[1]
    elif float(along.sum()) < 0.0:
        left = left_by(before.bound, traction, sides, poisson)
    else:
        return None
    square = along**2 + bound**2 - np.abs(traction) ** 2
    room = np.maximum(np.sqrt(np.maximum(square, 0.0)) - along, 0.0)
    return Turn(traction, left, np.where(bound > 0.0, np.maximum(room, NO_ROOM * bound), 0.0))


def with_patches(slipping: Flags, bound: Array) -> Flags:
    """All cells (nx, ny) of patches, which a bound above zero connects, in which cells slip.

    Where friction falls at once, tractions at the end of a region that slips rise above any bound as cells
    get smaller, and slip runs on until none is above the lower one.
    """
    from scipy.ndimage import label

    patches, _ = label(bound > 0.0)
    return np.isin(patches, patches[slipping])


def _ahead(field: Complex, rows: int) -> Complex:
    """A field so many rows ahead of a cell, zero beyond the grid."""
    found = np.zeros_like(field)
    found[:-rows] = field[rows:]
    return found


def _entering(pressure: Array, last: Array, rows: int) -> Flags:
    """Cells in contact (nx, ny) that were not so many rows ahead in the last contact, or not on the grid."""
    enters = pressure > 0.0
    enters[:-rows] &= last[rows:] == 0.0
    return enters


def _left_in(
    bound: Array, traction: Complex, enters: Flags, sides: tuple[float, float], poisson: float
) -> tuple[Complex, Array, Complex]:
    """What rims leave in cells (nx, ny), what those of the bound leave, m, and the normals of those."""
    inside = box_around(bound > 0.0)
    nx, ny = bound[inside].shape
    pitch = ny + 1  # a cell between the rows
    rims = traction_rims(sides, poisson, pitch, 0, np.zeros(nx * pitch, bool), np.zeros(nx * pitch))
    tractions = np.zeros(nx * pitch, complex)
    for flat, field in ((rims.enters, enters), (rims.room, bound), (tractions, traction)):
        flat.reshape(nx, pitch)[:, :ny] = field[inside]
    set_bound(rims)
    find_left(rims, tractions)
    left, normal = np.zeros((2, *bound.shape), complex)
    outer = np.zeros(bound.shape)
    for field, flat in ((left, rims.left), (outer, rims.bound_left), (normal, rims.bound_normal)):
        field[inside] = flat.reshape(nx, pitch)[:, :ny]
    return left, outer, normal
