"""Holes in a surface, of any size and shape, filled by the harmonic surface through their edges."""

from collections.abc import Callable

import numpy as np
from scipy import sparse
from scipy.sparse import linalg

from asperity.arguments import Array, Flags, Indices

FEW = 2**14
"""Unknown heights that a direct solution is the fastest for."""
AROUND = 3
"""Points along the sides of the blocks that are one point of the next coarser grid."""
ACCURACY = 1e-12
"""Norm of what is left of the equations, over that of their right side."""
Places = tuple[Indices, ...]


def harmonic(heights: Array, missing: Flags, spacings: Array) -> Array:
    """Heights of the missing points that solve the discrete Laplace equation, with no slope at the border.

    Parameters
    ----------
    heights : (nx,) or (nx, ny) ndarray
        Heights, m; at least one is known.
    missing : ndarray of bool
        Which of them are to be found.
    spacings : (d,) ndarray
        Distances of points along each axis, m.

    Returns
    -------
    (m,) ndarray
        The missing heights, m, in the order of ``heights[missing]``.
    """
    if np.count_nonzero(missing) <= FEW:
        matrix, right = _equations(heights, missing, spacings)
        return np.atleast_1d(linalg.spsolve(sparse.csc_array(matrix), right))
    datum = float(np.nanmean(heights))  # what is left of the equations is small against heights about it
    matrix, right = _equations(heights - datum, missing, spacings)
    correction = linalg.LinearOperator(matrix.shape, _cycle(matrix, np.nonzero(missing), spacings))
    found, _ = linalg.cg(matrix, right, rtol=ACCURACY, M=correction)
    return found + datum


def _equations(heights: Array, missing: Flags, spacings: Array) -> tuple[sparse.csr_array, Array]:
    """Matrix and right side of the five-point equations of the missing points."""
    count = int(missing.sum())
    number = np.full(heights.shape, -1, dtype=np.int32)
    number[missing] = np.arange(count)
    diagonal = np.zeros(count)
    right = np.zeros(count)
    matrix = sparse.csr_array((count, count))
    for axis, spacing in enumerate(spacings):
        weight = (spacings.max() / spacing) ** 2
        points = np.moveaxis(number, axis, 0)
        z = np.moveaxis(heights, axis, 0)
        for here, there, z_there in ((points[:-1], points[1:], z[1:]), (points[1:], points[:-1], z[:-1])):
            mine = here >= 0  # each point is here once
            diagonal[here[mine]] += weight
            known = mine & (there < 0)
            unknown = mine & (there >= 0)
            right[here[known]] += weight * z_there[known]
            pairs = here[unknown], there[unknown]
            coupling = np.full(len(pairs[0]), -weight)
            matrix = matrix + sparse.csr_array((coupling, pairs), shape=matrix.shape)
    return sparse.csr_array(matrix + sparse.diags_array(diagonal)), right


def _cycle(matrix: sparse.csr_array, places: Places, spacings: Array) -> Callable[[Array], Array]:
    """Approximate inverse of the equations of points at places, indices along each axis.

    One V-cycle of smoothed aggregation: P. Vaněk, J. Mandel and M. Brezina, Computing 56 (1996) 179-196.
    Blocks of three points along the axes of the smallest spacing, the only ones that couple strongly, are one
    point of the next grid, and errors are damped by two steps of Jacobi's on either side.
    """
    count = matrix.shape[0]
    if count <= FEW:
        return linalg.splu(sparse.csc_array(matrix)).solve
    steps = np.where(spacings < AROUND * spacings.min(), AROUND, 1)
    each = [index // step for index, step in zip(places, steps, strict=True)]
    blocks = np.ravel_multi_index(each, shape := [int(index.max()) + 1 for index in each])
    coarser, block = np.unique(blocks, return_inverse=True)
    together = sparse.csr_array((np.ones(count), (np.arange(count), block)), shape=(count, coarser.size))
    inverse = 1.0 / matrix.diagonal()
    damped = inverse * (4.0 / 3.0 / (np.asarray(abs(matrix).sum(axis=1)) * inverse).max())
    spread = sparse.csr_array(together - sparse.diags_array(damped) @ (matrix @ together))
    gathered = sparse.csr_array(spread.T)
    below = _cycle(gathered @ matrix @ spread, np.unravel_index(coarser, shape), spacings * steps)

    def corrected(left: Array) -> Array:
        found = damped * left
        found += damped * (left - matrix @ found)
        found += spread @ below(gathered @ (left - matrix @ found))
        for _ in range(2):
            found += damped * (left - matrix @ found)
        return found

    return corrected
