"""Influence of tractions and of pressures on displacement along the surface, cell by cell."""

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.influence import ALIAS, _edge_log


def _weighted_log(x: NDArray, y: NDArray, half: float) -> NDArray:
    """x ln[(y₊ + √(y₊² + x²)) / (y₋ + √(y₋² + x²))], zero at x = 0."""
    nothing = x == 0.0
    return np.where(nothing, 0.0, x * _edge_log(np.where(nothing, 1.0, x), np.abs(y), half))


def traction_displacement(
    x: NDArray, y: NDArray, dx: float, dy: float, poisson: float
) -> tuple[NDArray, NDArray, NDArray]:
    """Displacements at (x, y), times π G, under unit traction on the cell dx × dy at the origin.

    Of both bodies against each other, along x by a traction along x, along y by one along y, and along the
    one by the other. V. Cerruti's solution as in K. L. Johnson, Contact Mechanics (1985), 3.6, integrated
    over the cell.
    """
    hx, hy = 0.5 * dx, 0.5 * dy
    across = _weighted_log(x + hx, y, hy) - _weighted_log(x - hx, y, hy)
    along = _weighted_log(y + hy, x, hx) - _weighted_log(y - hy, x, hx)
    far = np.hypot(x + hx, y + hy) - np.hypot(x + hx, y - hy)
    near = np.hypot(x - hx, y + hy) - np.hypot(x - hx, y - hy)
    return (1.0 - poisson) * across + along, (1.0 - poisson) * along + across, -poisson * (far - near)


def pressure_displacement(x: NDArray, y: NDArray, dx: float, dy: float) -> NDArray:
    """Displacement x + iy of two unlike bodies, times −π G/K, at (x, y) under unit pressure on a cell.

    ∫∫ (x, y)/ρ², in which K/G = ¼ ((1 − 2ν₁)/G₁ − (1 − 2ν₂)/G₂).
    """
    total: NDArray = np.zeros(np.broadcast_shapes(x.shape, y.shape), dtype=complex)
    for sign_x in (1.0, -1.0):
        for sign_y in (1.0, -1.0):
            u, v = x + sign_x * 0.5 * dx, y + sign_y * 0.5 * dy
            log = 0.5 * np.log(np.maximum(u * u + v * v, np.finfo(float).tiny))
            angle_x, angle_y = (np.arctan(a / np.where(b == 0.0, np.inf, b)) for a, b in ((v, u), (u, v)))
            total += sign_x * sign_y * (v * log + u * angle_x + 1j * (u * log + v * angle_y))
    return total


def means_of_traction(x: NDArray, y: NDArray, dx: float, dy: float, poisson: float) -> NDArray:
    """Displacements (3, n, m) as in `traction_displacement`, of means over cells by means over cells.

    To the fourth order, as `influence.means_table` has them of pressures. Places x (n + 2, 1) and
    y (1, m + 2) reach a cell further on all sides; one of them may be the origin.
    """
    means = _between_means(np.stack(traction_displacement(x, y, dx, dy, poisson)))
    origin = _origin(x, y, dx, dy)
    along, across = _second_differences(origin)
    softer = 1.0 - poisson
    means[0] += np.pi * ALIAS * (softer * dx * along + dy * across)
    means[1] += np.pi * ALIAS * (dx * along + softer * dy * across)
    corners = origin[2:, 2:] + origin[:-2, :-2] - origin[2:, :-2] - origin[:-2, 2:]
    means[2] += np.pi * ALIAS * poisson * (dx**2 / dy + dy**2 / dx) / 8.0 * corners
    return means


def means_of_pressure(x: NDArray, y: NDArray, dx: float, dy: float) -> NDArray:
    """Displacement (n, m) as in `pressure_displacement`, of means on means, as in `means_of_traction`."""
    means = _between_means(pressure_displacement(x, y, dx, dy))
    origin = _origin(x, y, dx, dy)
    means += np.pi * dx / 24.0 * (origin[:-2, 1:-1] - origin[2:, 1:-1])
    means += 1j * np.pi * dy / 24.0 * (origin[1:-1, :-2] - origin[1:-1, 2:])
    return means


def _origin(x: NDArray, y: NDArray, dx: float, dy: float) -> NDArray:
    """One at the origin, else zero."""
    at = np.isclose(x, 0.0, atol=1e-9 * dx) & np.isclose(y, 0.0, atol=1e-9 * dy)
    return at.astype(float)


def _second_differences(field: NDArray) -> tuple[NDArray, NDArray]:
    """Second differences along and across (..., n, m) of a field (..., n + 2, m + 2)."""
    return np.diff(field[..., 1:-1], 2, axis=-2), np.diff(field[..., 1:-1, :], 2, axis=-1)


def _between_means(field: NDArray) -> NDArray:
    """Take off an influence at the middles of cells what means of both sides have less."""
    along, across = _second_differences(field)
    return field[..., 1:-1, 1:-1] - (along + across) / 24.0
