"""Blocks of a scan: solved in compiled code, or in batches on a device."""

from __future__ import annotations

import threading
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from asperity.contact.device import Device
from asperity.contact.halfspace import HalfSpace
from asperity.kernels.scanning import TRUNCATED
from asperity.reduction import batched_scan


@dataclass(frozen=True, eq=False)
class Contacts:
    """What is solved at each position of a scan.

    Attributes
    ----------
    body : ndarray, shape (nx, ny)
        Shape of the smooth body, m.
    approaches : ndarray, shape (k,)
        Increasing approaches, m.
    spacing, modulus, hardness
        As in `asperity.contact.HalfSpace`.
    stride : int
        Rows between positions.
    rtol : float
        Tolerance of each solution.
    single : bool
        Whether to iterate in single precision.
    """

    body: NDArray[np.float64]
    approaches: NDArray[np.float64]
    spacing: tuple[float, float]
    modulus: float
    hardness: float | None
    stride: int
    rtol: float
    single: bool = False

    def half_space(self) -> HalfSpace:
        """Make the half-space of these contacts; one a thread, for it keeps what it has computed."""
        shape = self.body.shape
        return HalfSpace((shape[0], shape[1]), self.spacing, self.modulus, self.hardness)


def solve_block(
    contacts: Contacts, rows: NDArray[np.float64], planes: NDArray[np.float64], device: Device | None = None
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Solve the contacts at the positions of a block, from a cold start.

    Parameters
    ----------
    contacts : Contacts
        What is solved.
    rows : ndarray, shape (rows, ny)
        Heights under the block, m.
    planes : ndarray, shape (positions,)
        Height of the plane from which approaches count at each position, m.
    device : Device, optional
        For batches; by default the processor, where other threads run beside.

    Returns
    -------
    forces : ndarray, shape (k, positions)
        N.
    counts : ndarray of int, shape (4,)
        Solutions, iterations, unconverged and truncated solutions.
    """
    half_space = _half_space(contacts)
    if device is None:
        block = half_space.at_positions(
            rows, contacts.body, planes, contacts.approaches, contacts.stride, contacts.rtol,
            single=contacts.single,
        )  # fmt: skip
        return block.totals * half_space.cell_area, block.counts
    found = batched_scan.solve_rows(
        half_space, rows, contacts.body, contacts.approaches, planes, contacts.stride, contacts.rtol,
        device, TRUNCATED,
    )  # fmt: skip
    flaws = found[1:].sum(axis=(1, 2)).astype(np.int64)
    return found[0], np.concatenate([[np.count_nonzero(found[0])], flaws])


_KEPT = threading.local()


def _half_space(contacts: Contacts) -> HalfSpace:
    """Half-space of the last scan on this thread, with all it has prepared, or a new one."""
    key = (contacts.body.shape, contacts.spacing, contacts.modulus, contacts.hardness)
    if getattr(_KEPT, "key", None) != key:
        _KEPT.key, _KEPT.half_space = key, contacts.half_space()
    kept: HalfSpace = _KEPT.half_space
    return kept
