"""Modes of a solid of revolution by finite elements on its section, one number of nodal diameters at a time.

The displacement is u_r cos nθ, u_θ sin nθ, u_z cos nθ. With these the strains are

    ε_rr = u_r,r   ε_θθ = (u_r + n u_θ)/r   ε_zz = u_z,z   γ_rz = u_r,z + u_z,r
    γ_rθ = u_θ,r − (n u_r + u_θ)/r          γ_θz = u_θ,z − n u_z/r

and the integral around the axis is π, or 2π of n = 0.
"""

from typing import Any

import numpy as np

from asperity.arguments import Array, NDArray
from asperity.reference.materials import Material
from asperity.structures.outline import Mesh

# Radon's rule of seven points in a triangle, exact to the fifth degree
_ROOT = np.sqrt(15.0)
_NEAR, _FAR = (6.0 - _ROOT) / 21.0, (6.0 + _ROOT) / 21.0
_AT = np.array(
    [[1 / 3, 1 / 3, 1 / 3]]
    + [[*np.roll([1.0 - 2.0 * a, a, a], turn)] for a in (_NEAR, _FAR) for turn in range(3)]
)
_WEIGHT = np.array([9 / 40] + [(155.0 - _ROOT) / 1200.0] * 3 + [(155.0 + _ROOT) / 1200.0] * 3)
FIRST_MODES = 12
"""Modes that are sought at first."""
SHIFT = 0.1
"""Of the highest frequency: about where the inverse iteration is quickest."""


def _shapes() -> tuple[Array, Array]:
    """Quadratic functions at the seven points (7, 6), and derivatives by the areal coordinates (7, 6, 3)."""
    a, one = _AT, np.eye(3)
    pairs = ((0, 1), (1, 2), (2, 0))
    values = np.hstack([a * (2.0 * a - 1.0), np.stack([4.0 * a[:, i] * a[:, j] for i, j in pairs], axis=1)])
    corners = (4.0 * a - 1.0)[:, :, None] * one
    sides = [4.0 * (a[:, [i]] * one[j] + a[:, [j]] * one[i]) for i, j in pairs]
    return values, np.concatenate([corners, np.stack(sides, axis=1)], axis=1)


def matrices(mesh: Mesh, n: int, material: Material) -> tuple[Any, Any]:
    """Stiffness and mass, sparse (3k, 3k), of n nodal diameters; u_r, u_θ and u_z of node after node."""
    from scipy.sparse import coo_array

    values, slopes = _shapes()
    corners = mesh.nodes[mesh.triangles[:, :3]]
    sides = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)  # opposite to each corner
    area = 0.5 * (sides[:, 1, 1] * sides[:, 0, 0] - sides[:, 1, 0] * sides[:, 0, 1])
    areal = np.stack([-sides[..., 1], sides[..., 0]], axis=-1) / (2.0 * area)[:, None, None]  # (e, 3, 2)
    fr, fz = np.moveaxis(np.einsum("qsa,eac->eqsc", slopes, areal), -1, 0)
    r = np.einsum("qa,ea->eq", _AT, corners[..., 0])[..., None]
    f = np.broadcast_to(values, fr.shape)
    strain = np.zeros((*fr.shape[:2], 6, 18))  # rr, θθ, zz, rz, rθ, θz
    strain[:, :, 0, 0::3], strain[:, :, 2, 2::3] = fr, fz
    strain[:, :, 1, 0::3], strain[:, :, 1, 1::3] = f / r, n * f / r
    strain[:, :, 3, 0::3], strain[:, :, 3, 2::3] = fz, fr
    strain[:, :, 4, 0::3], strain[:, :, 4, 1::3] = -n * f / r, fr - f / r
    strain[:, :, 5, 1::3], strain[:, :, 5, 2::3] = fz, -n * f / r
    around = 2.0 * np.pi if n == 0 else np.pi
    weight = around * _WEIGHT * area[:, None] * r[..., 0]
    stress = np.einsum("ij,eqjb->eqib", _elasticity(material), strain) * weight[..., None, None]
    stiffness = strain.reshape(len(area), -1, 18).transpose(0, 2, 1) @ stress.reshape(len(area), -1, 18)
    product = np.einsum("eq,qa,qb->eab", material.density * weight, values, values, optimize=True)
    mass = np.einsum("eab,ij->eaibj", product, np.eye(3)).reshape(-1, 18, 18)
    unknown = (3 * mesh.triangles[:, :, None] + np.arange(3)).reshape(len(area), 18)
    where = np.repeat(unknown, 18, axis=1).ravel(), np.tile(unknown, (1, 18)).ravel()
    shape = (3 * len(mesh.nodes),) * 2
    found = [coo_array((each.ravel(), where), shape).tocsc() for each in (stiffness, mass)]
    return found[0], found[1]


def _elasticity(material: Material) -> Array:
    """Hooke's law of the six strains (6, 6), Pa."""
    nu = material.poisson_ratio
    scale = material.youngs_modulus / ((1.0 + nu) * (1.0 - 2.0 * nu))
    law = np.zeros((6, 6))
    law[:3, :3] = scale * (nu + (1.0 - 2.0 * nu) * np.eye(3))
    law[3:, 3:] = scale * (0.5 - nu) * np.eye(3)
    return law


def natural_modes(
    mesh: Mesh, n: int, material: Material, highest: float, held: NDArray[np.bool_]
) -> tuple[Array, Array]:
    """Natural frequencies up to the highest (p,), Hz, and mass-normalised shapes (p, k, 3), kg^(−1/2).

    `held` (k, 3) are the displacements that are zero. Of n = 0 torsion is left out: no radial or axial force
    excites it.
    """
    from scipy.sparse.linalg import eigsh

    stiffness, mass = matrices(mesh, n, material)
    fixed = held.copy()
    if n == 0:
        fixed[:, 1] = True
    free = np.flatnonzero(~fixed.ravel())
    stiffness, mass = stiffness[free][:, free], mass[free][:, free]
    start = np.random.default_rng(0).standard_normal(len(free))
    count, shift = FIRST_MODES, -((2.0 * np.pi * SHIFT * highest) ** 2)
    while True:
        count = min(count, len(free) - 1)
        squares, found = eigsh(stiffness, count, mass, sigma=shift, v0=start)
        if squares.max() > (2.0 * np.pi * highest) ** 2 or count == len(free) - 1:
            break
        count *= 2
    order = np.argsort(squares)
    frequency = np.sqrt(np.maximum(squares[order], 0.0)) / (2.0 * np.pi)
    below = order[frequency <= highest]
    shapes = np.zeros((len(below), 3 * len(mesh.nodes)))
    shapes[:, free] = found[:, below].T
    return frequency[: len(below)], shapes.reshape(len(below), len(mesh.nodes), 3)
