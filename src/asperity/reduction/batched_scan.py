"""A block of the scan on a device: all its positions at once, approach by approach."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.contact.batched import solve_batched
from asperity.contact.device import Device
from asperity.contact.halfspace import HalfSpace

BLOCK = 4096
"""Positions of a block of the scan on a device: enough to fill it, and few enough to be kept often."""


def solve_rows(
    half_space: HalfSpace,
    rows: NDArray[np.float64],
    body: NDArray[np.float64],
    approaches: NDArray[np.float64],
    planes: NDArray[np.float64],
    stride: int,
    rtol: float,
    device: Device,
    truncated: float,
) -> NDArray[np.float64]:
    """Solve the contacts of one block of the scan.

    Parameters
    ----------
    half_space : HalfSpace
        Grid, modulus and hardness.
    rows : ndarray, shape (rows, ny)
        Heights under all positions of the block, m.
    body : ndarray, shape (nx, ny)
        Shape of the body, m.
    approaches : ndarray, shape (k,)
        Increasing approaches, m.
    planes : ndarray, shape (n,)
        Height of the plane from which approaches count at each position, m.
    stride : int
        Rows between positions.
    rtol : float
        Tolerance of each solution.
    device : Device
        Where to solve.
    truncated : float
        Share of the force on the window's edge from which a contact counts as cut off.

    Returns
    -------
    ndarray, shape (4, k, n)
        Forces in N, iterations, unconverged (0 or 1) and truncated (0 or 1).
    """
    xp = device.xp
    heights, shape, plane = xp.asarray(rows), xp.asarray(body), xp.asarray(planes)
    window = xp.arange(body.shape[0])

    def gaps(first: int, last: int) -> Any:
        under = heights[xp.arange(first, last)[:, None] * stride + window]
        return shape + plane[first:last, None, None] - under

    found = solve_batched(half_space, gaps, len(planes), approaches, rtol, device)
    cut_off = found.edge_share > truncated
    return np.stack([found.force, found.iterations, ~found.converged, cut_off]).astype(np.float64)
