"""Solids of revolution by finite elements, against modes of rings and thick cylinders.

Plates stand in the ledger of conformance.
"""

import math

import numpy as np
import pytest
from scipy.special import jv, jvp, yv, yvp

from asperity.reference.materials import MATERIALS
from asperity.structures.outline import checked_outline, mesh_of
from asperity.structures.wheel_modes import natural_modes

STEEL = MATERIALS["steel"]
E, NU, RHO = STEEL.youngs_modulus, STEEL.poisson_ratio, STEEL.density


def rectangle(inner, outer, height, size=None):
    corners = [[inner, 0.0], [outer, 0.0], [outer, height], [inner, height]]
    return mesh_of(checked_outline(corners), size)


def held(mesh, nodes=None, directions=(0, 1, 2)):
    """Displacements that are zero: of some nodes, in some directions."""
    fixed = np.zeros((len(mesh.nodes), 3), dtype=bool)
    if nodes is not None:
        for direction in directions:
            fixed[nodes, direction] = True
    return fixed


RING, SIDE = 0.5, 0.008


@pytest.mark.parametrize("n", [0, 2, 3])
def test_a_thin_ring_breathes_and_bends_in_its_plane(n):
    """Closed forms of Hoppe; the modal mass of a radial displacement of one at n = 0 is that of the ring."""
    mesh = rectangle(RING - 0.5 * SIDE, RING + 0.5 * SIDE, SIDE)
    frequency, shapes = natural_modes(mesh, n, STEEL, 2000.0, held(mesh))
    bending = E * SIDE**2 / (12.0 * RHO * RING**4) * n**2 * (n**2 - 1) ** 2 / (n**2 + 1)
    exact = math.sqrt(bending if n else E / RHO) / (2.0 * math.pi * (1.0 if n else RING))
    at = np.argmin(np.abs(frequency - exact))
    assert frequency[at] == pytest.approx(exact, rel=1e-3)
    middle = np.argmin(np.hypot(mesh.nodes[:, 0] - RING, mesh.nodes[:, 1] - 0.5 * SIDE))
    mass = RHO * SIDE**2 * 2.0 * math.pi * RING * (0.5 * (1.0 + 1.0 / n**2) if n else 1.0)
    assert shapes[at, middle, 0] ** -2.0 == pytest.approx(mass, rel=2e-3)


CYLINDER = (0.08, 0.16, 0.12)
"""Radii and length of a thick cylinder, m, whose faces slide: u_z = 0 without shear."""


def cylinder_determinant(n, frequency):
    """Gazis (J. Acoust. Soc. Am. 31, 1959, 568): waves with one half-wave along; zero at natural frequencies.

    From the potentials of Helmholtz: φ, ψ e_z and ∇×(χ e_z), by their Bessel functions.
    """
    inner, outer, length = CYLINDER
    shear, lame = E / (2.0 * (1.0 + NU)), E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU))
    omega, k = 2.0 * math.pi * frequency, math.pi / length
    along, across = (lame + 2.0 * shear) / RHO, shear / RHO
    columns = []
    for kind, square in enumerate([omega**2 / along, omega**2 / across, omega**2 / across]):
        part = np.sqrt(complex(square - k**2))
        for f, fp in ((jv, jvp), (yv, yvp)):
            entries = []
            for r in (inner, outer):
                x = part * r
                v, d1, d2 = f(n, x), part * fp(n, x), part**2 * fp(n, x, 2)
                if kind == 0:  # u = ∇(v cos nθ cos kz)
                    ur, dur, ut, dut, uz, duz = d1, d2, -n * v / r, -n * (d1 / r - v / r**2), -k * v, -k * d1
                elif kind == 1:  # u = ∇×(v sin nθ cos kz e_z)
                    ur, dur, ut, dut, uz, duz = n * v / r, n * (d1 / r - v / r**2), -d1, -d2, 0.0, 0.0
                else:  # u = ∇×∇×(v cos nθ sin kz e_z)
                    ur, dur, ut, dut = k * d1, k * d2, -k * n * v / r, -k * n * (d1 / r - v / r**2)
                    uz, duz = part**2 * v, part**2 * d1
                hoop = (ur + n * ut) / r
                uz_z = k * uz  # u_z goes as sin kz
                entries += [
                    (lame + 2 * shear) * dur + lame * (hoop + uz_z),
                    shear * (dut - (n * ur + ut) / r),
                    shear * (duz - k * ur),
                ]
            columns.append(np.array(entries) / shear)
    matrix = np.array(columns).T
    if n == 0:  # torsion apart
        matrix = matrix[np.ix_([0, 2, 3, 5], [0, 1, 4, 5])]
    return np.linalg.det(matrix / np.abs(matrix).max(axis=0))


def cylinder_modes(n, size=None, highest=25e3):
    """Natural frequencies whose shapes are those with one half-wave along the cylinder."""
    inner, outer, length = CYLINDER
    mesh = rectangle(inner, outer, length, size)
    faces = (mesh.nodes[:, 1] < 1e-9) | (mesh.nodes[:, 1] > length - 1e-9)
    frequency, shapes = natural_modes(mesh, n, STEEL, highest, held(mesh, faces, (2,)))
    lower, upper = (
        np.argmin(np.hypot(mesh.nodes[:, 0] - outer, mesh.nodes[:, 1] - z)) for z in (0.0, length)
    )
    first, last = shapes[:, lower, 0], shapes[:, upper, 0]
    return frequency[np.abs(first + last) < 0.02 * (np.abs(first) + np.abs(last))]


@pytest.mark.parametrize("n", [0, 1, 2, 3])
def test_a_thick_cylinder(n):
    lowest, second = cylinder_modes(n)[:2]
    for found in (lowest, second):
        low, high = (cylinder_determinant(n, found * (1.0 + part)) for part in (-5e-4, 5e-4))
        assert (low * np.conj(high)).real < 0.0  # the exact one is within 0.05 %


def test_finer_triangles_are_better_by_the_fourth_power():
    sizes = 0.02 * 0.5 ** np.arange(3)
    found = np.array([cylinder_modes(2, size)[0] for size in sizes])
    exact = found[-1]
    low, high = exact * (1.0 - 2e-4), exact
    phase = np.conj(cylinder_determinant(2, low))
    for _ in range(40):  # bisection
        middle = 0.5 * (low + high)
        if (cylinder_determinant(2, middle) * phase).real > 0.0:
            low = middle
        else:
            high = middle
    errors = found / low - 1.0
    assert (errors > 0.0).all()  # elements are too stiff
    assert (errors[:-1] / errors[1:] > 2.0**3.5).all()
