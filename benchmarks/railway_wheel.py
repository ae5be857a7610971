"""Modes of a railway wheel of 920 mm by finite elements, as `wheel.modes` takes them.

    python benchmarks/railway_wheel.py wheel.csv    # about a minute on one core

A solid of revolution whose displacements go as cos nθ and sin nθ around it, in quadratic elements on its
section, fixed where the hub sits on its axle. The section has the main dimensions of a freight wheel, hub, a
curved web, and a rim of 135 mm; it is drawn, not measured. Damping ratios of 10⁻³, 10⁻² and 10⁻⁴ for n = 0, 1
and more nodal diameters are usual in the literature on railway wheels. Of a thin ring of radius R the same
elements find the breathing frequency (E/ρ)^½/2πR and those of bending within 0.1 %.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.linalg import eigsh

Array = NDArray[np.float64]

YOUNG, POISSON, DENSITY = 210e9, 0.3, 7850.0
SEAT, HUB, RIM, TREAD = 0.0925, 0.135, 0.395, 0.460  # radii, m
HUB_WIDTH, RIM_WIDTH, WEB_WIDTH, BEND = 0.175, 0.135, 0.028, 0.045  # m; by how much the hub stands aside
HIGHEST = 6000.0  # Hz
DIAMETERS = range(9)
DAMPING = {0: 1e-3, 1: 1e-2}
OTHERS = 1e-4


@dataclass(frozen=True)
class Mesh:
    """Quadratic elements of a section: nine nodes each."""

    nodes: Array  # (k, 2), radius and axial place, m
    elements: NDArray[np.int64]  # (e, 9), row by row in the square of an element


def section() -> Mesh:
    """Hub, web and rim on one grid, whose web is bent so that the hub stands aside of the rim."""
    half = 0.5 * WEB_WIDTH
    radii = np.concatenate(
        [np.linspace(SEAT, HUB, 4), np.linspace(HUB, RIM, 21)[1:], np.linspace(RIM, TREAD, 6)[1:]]
    )
    sides = np.concatenate(
        [np.linspace(-0.5 * HUB_WIDTH, -0.5 * RIM_WIDTH, 3), np.linspace(-0.5 * RIM_WIDTH, -half, 5)[1:]]
    )
    across = np.concatenate([sides, [0.0], -sides[::-1]])
    fine = [np.sort(np.concatenate([each, 0.5 * (each[1:] + each[:-1])])) for each in (radii, across)]
    number: dict[tuple[int, int], int] = {}
    elements, places = [], []
    for i in range(len(radii) - 1):
        for j in range(len(across) - 1):
            middle = 0.5 * (across[j] + across[j + 1])
            inside = radii[i + 1] <= HUB + 1e-9 or abs(middle) < half
            inside |= radii[i] >= RIM - 1e-9 and abs(middle) < 0.5 * RIM_WIDTH
            if not inside:
                continue
            element = []
            for a in range(3):
                for b in range(3):
                    key = (2 * i + a, 2 * j + b)
                    if key not in number:
                        number[key] = len(places)
                        places.append((fine[0][key[0]], fine[1][key[1]]))
                    element.append(number[key])
            elements.append(element)
    nodes = np.array(places)
    share = np.clip((nodes[:, 0] - HUB) / (RIM - HUB), 0.0, 1.0)
    nodes[:, 1] += BEND * (1.0 - share**2 * (3.0 - 2.0 * share))
    return Mesh(nodes, np.array(elements))


def _shapes(x: float, y: float) -> tuple[Array, Array]:
    """Lagrange's quadratic functions of an element (9,), and their derivatives (2, 9)."""

    def one(t: float) -> tuple[Array, Array]:
        return np.array([0.5 * t * (t - 1), 1 - t * t, 0.5 * t * (t + 1)]), np.array(
            [t - 0.5, -2 * t, t + 0.5]
        )

    (f, df), (g, dg) = one(x), one(y)
    return np.outer(f, g).ravel(), np.array([np.outer(df, g).ravel(), np.outer(f, dg).ravel()])


def matrices(mesh: Mesh, n: int) -> tuple[coo_array, coo_array]:
    """Stiffness and mass of motion u_r cos nθ, u_θ sin nθ, u_z cos nθ; three unknowns to a node."""
    c = YOUNG / ((1 + POISSON) * (1 - 2 * POISSON))
    elastic = np.zeros((6, 6))
    elastic[:3, :3] = c * (POISSON + (1 - 2 * POISSON) * np.eye(3))
    elastic[3:, 3:] = 0.5 * c * (1 - 2 * POISSON) * np.eye(3)
    around = (2.0 if n == 0 else 1.0) * np.pi
    at, weight = np.polynomial.legendre.leggauss(3)
    rows, columns, stiff, heavy = [], [], [], []
    for element in mesh.elements:
        corner = mesh.nodes[element]
        k, m = np.zeros((27, 27)), np.zeros((27, 27))
        for x, wx in zip(at, weight, strict=True):
            for y, wy in zip(at, weight, strict=True):
                f, derivative = _shapes(x, y)
                jacobian = derivative @ corner
                (fr, fz), r = np.linalg.solve(jacobian, derivative), f @ corner[:, 0]
                area = wx * wy * abs(np.linalg.det(jacobian)) * r * around
                strain = np.zeros((6, 27))  # rr, θθ, zz, rz, rθ, θz
                strain[0, 0::3], strain[2, 2::3] = fr, fz
                strain[1, 0::3], strain[1, 1::3] = f / r, n * f / r
                strain[3, 0::3], strain[3, 2::3] = fz, fr
                strain[4, 0::3], strain[4, 1::3] = -n * f / r, fr - f / r
                strain[5, 1::3], strain[5, 2::3] = fz, -n * f / r
                k += area * strain.T @ elastic @ strain
                m += area * DENSITY * np.kron(np.outer(f, f), np.eye(3))
        unknown = (3 * element[:, None] + np.arange(3)).ravel()
        rows.append(np.repeat(unknown, 27))
        columns.append(np.tile(unknown, 27))
        stiff.append(k.ravel())
        heavy.append(m.ravel())
    where = np.concatenate(rows), np.concatenate(columns)
    shape = (3 * len(mesh.nodes),) * 2
    return coo_array((np.concatenate(stiff), where), shape), coo_array((np.concatenate(heavy), where), shape)


def modes(mesh: Mesh, n: int) -> tuple[Array, Array]:
    """Natural frequencies up to the highest, Hz, and mass-normalised shapes (nodes, 3, modes)."""
    stiffness, mass = (each.tocsc() for each in matrices(mesh, n))
    free = np.repeat(mesh.nodes[:, 0] > SEAT + 1e-9, 3)
    if n == 0:
        free[1::3] = False  # torsion does not answer to a radial force
    kept = np.flatnonzero(free)
    squares, found = eigsh(stiffness[kept][:, kept], 14, mass[kept][:, kept], sigma=(2 * np.pi * 50.0) ** 2)
    order = np.argsort(squares)
    frequency = np.sqrt(squares[order]) / (2 * np.pi)
    shapes = np.zeros((3 * len(mesh.nodes), len(order)))
    shapes[kept] = found[:, order]
    below = frequency <= HIGHEST
    return frequency[below], shapes.reshape(-1, 3, len(order))[..., below]


def rows_of(mesh: Mesh, n: int) -> list[list[float]]:
    """Lines of the table: frequency, damping ratio, modal mass, n, axial and radial velocity."""
    r, z = mesh.nodes.T
    tread = np.flatnonzero(np.abs(r - TREAD) < 1e-9)
    contact = tread[np.argmin(np.abs(z[tread]))]
    middle = np.flatnonzero((r > HUB - 1e-9) & _in_the_middle(mesh))
    middle = middle[np.argsort(r[middle])]
    around = 1.0 if n == 0 else np.sqrt(0.5)
    found = []
    for frequency, shape in zip(*_listed(modes(mesh, n)), strict=True):
        here = shape[contact, 0]
        if abs(here) < 1e-3 * np.abs(shape).max():
            continue  # it does not answer to a radial force
        place, axial = r[middle], shape[middle, 2] / here
        disc = np.sqrt(np.trapezoid(axial**2 * place, place) / np.trapezoid(place, place)) * around
        rim = np.sqrt(np.mean((shape[tread, 0] / here) ** 2)) * around
        found.append([frequency, DAMPING.get(n, OTHERS), here**-2.0, n, disc, rim])
    return found


def _in_the_middle(mesh: Mesh) -> NDArray[np.bool_]:
    share = np.clip((mesh.nodes[:, 0] - HUB) / (RIM - HUB), 0.0, 1.0)
    bend = BEND * (1.0 - share**2 * (3.0 - 2.0 * share))
    return np.abs(mesh.nodes[:, 1] - bend) < 1e-9


def _listed(found: tuple[Array, Array]) -> tuple[Array, list[Array]]:
    return found[0], list(np.moveaxis(found[1], -1, 0))


def table() -> Array:
    """All modes that answer to a radial force, by frequency (modes, 6)."""
    mesh = section()
    every = [row for n in DIAMETERS for row in rows_of(mesh, n)]
    return np.array(sorted(every))


if __name__ == "__main__":
    found = table()
    head = "frequency (Hz), damping ratio, modal mass (kg), nodal diameters, axial velocity, radial velocity"
    np.savetxt(sys.argv[1], found, fmt="%.6g", delimiter=", ", header=head, comments="")
    print(f"{len(found)} modes from {found[0, 0]:.0f} to {found[-1, 0]:.0f} Hz in {sys.argv[1]}")
