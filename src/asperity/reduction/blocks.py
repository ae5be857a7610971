"""Blocks of a scan: solved in turn on each thread, or in a process of its own where the scan is long."""

from __future__ import annotations

import sys
import threading
import time
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from asperity.contact.device import Device
from asperity.contact.halfspace import HalfSpace
from asperity.kernels.continuation import continued
from asperity.reduction import batched_scan
from asperity.reduction.worker import Worker

TRUNCATED = 0.01
"""Share of the force on the window's edge from which a contact counts as cut off."""
PAYS = 10.0
"""Time that a thread has still to work, s, from which a process of its own pays: it starts in about two."""


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
    """

    body: NDArray[np.float64]
    approaches: NDArray[np.float64]
    spacing: tuple[float, float]
    modulus: float
    hardness: float | None
    stride: int
    rtol: float

    def half_space(self) -> HalfSpace:
        """Make the half-space of these contacts; one a thread, for it keeps what it has computed."""
        shape = self.body.shape
        return HalfSpace((shape[0], shape[1]), self.spacing, self.modulus, self.hardness)

    def scalars(self) -> dict[str, Any]:
        """Return what is no array, by name."""
        names = ("spacing", "modulus", "hardness", "stride", "rtol")
        return {name: getattr(self, name) for name in names}


def solve_block(
    half_space: HalfSpace, contacts: Contacts, rows: NDArray, planes: NDArray
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Solve the contacts at the positions of a block, from a cold start.

    Parameters
    ----------
    half_space : HalfSpace
        Of these contacts.
    contacts : Contacts
        What is solved.
    rows : ndarray, shape (rows, ny)
        Heights under the block, m.
    planes : ndarray, shape (positions,)
        Height of the plane from which approaches count at each position, m.

    Returns
    -------
    forces : ndarray, shape (k, positions)
        N.
    counts : ndarray of int, shape (4,)
        Solutions, iterations, unconverged and truncated solutions.
    """
    nx, stride = contacts.body.shape[0], contacts.stride
    forces = np.zeros((len(contacts.approaches), len(planes)))
    counts = np.zeros(4, dtype=np.int64)
    cap = half_space.hardness or np.inf
    known: list[list[NDArray]] = [[] for _ in contacts.approaches]  # pressures at the last two positions
    for m, plane in enumerate(planes):
        gap = contacts.body + plane - rows[m * stride : m * stride + nx]
        touch = gap.min()
        below: list[tuple[float, NDArray]] = []
        for i, approach in enumerate(contacts.approaches):
            if approach <= touch:
                known[i] = []
                continue
            start = None
            if known[i] and stride < nx:  # pressures move with the asperities, against the body
                start = continued(known[i][-1], known[i][0], stride, len(known[i]) - 1.0, cap)
            elif below:
                (a, p), (b, q) = below[-1], below[-2:][0]
                start = continued(p, q, 0, (approach - a) / (a - b) if a > b else 0.0, cap)
            contact = half_space.at_approach(gap, float(approach), start, contacts.rtol)
            known[i] = [*known[i][-1:], contact.pressure]
            below = [*below[-1:], (float(approach), contact.pressure)]
            forces[i, m] = contact.force
            counts += (1, contact.iterations, not contact.converged, contact.edge_share > TRUNCATED)
    return forces, counts


_KEPT = threading.local()


def _half_space(contacts: Contacts) -> HalfSpace:
    """Half-space of the last scan on this thread, with all it has prepared, or a new one."""
    key = (contacts.body.shape, contacts.spacing, contacts.modulus, contacts.hardness)
    if getattr(_KEPT, "key", None) != key:
        _KEPT.key, _KEPT.half_space = key, contacts.half_space()
    kept: HalfSpace = _KEPT.half_space
    return kept


class Solvers:
    """Solves blocks for the threads of a scan, the same digits on a thread, in a process, alone or not.

    Parameters
    ----------
    contacts : Contacts
        What is solved.
    device : Device or None
        For batches; None for the processor.
    count : int
        Threads.
    """

    def __init__(self, contacts: Contacts, device: Device | None, count: int) -> None:
        self.contacts, self.device = contacts, device
        self._processes = device is None and count > 1 and bool(sys.executable)
        self._of_thread = threading.local()
        self._workers: list[Worker] = []

    def solve(self, rows: NDArray, planes: NDArray, left: float) -> tuple[NDArray, NDArray]:
        """Solve a block.

        Parameters
        ----------
        rows, planes
            As in `solve_block`.
        left : float
            Blocks that this thread has still to work on, about.

        Returns
        -------
        forces, counts : ndarray
            As from `solve_block`.
        """
        own = self._of_thread
        if self._processes and getattr(own, "seconds", 0.0) * left > PAYS and not hasattr(own, "worker"):
            own.worker = Worker(self.contacts.body, self.contacts.approaches, self.contacts.scalars())
            self._workers.append(own.worker)
        if hasattr(own, "worker"):
            found: tuple[NDArray, NDArray] | None = own.worker.solve(rows, planes)
            if found is not None:  # otherwise the process is gone, and this one does its work
                return found
        began = time.perf_counter()
        found = self._solve_here(rows, planes)
        own.seconds = time.perf_counter() - began
        return found

    def _solve_here(self, rows: NDArray, planes: NDArray) -> tuple[NDArray, NDArray]:
        contacts, half_space = self.contacts, _half_space(self.contacts)
        if self.device is None:
            return solve_block(half_space, contacts, rows, planes)
        found = batched_scan.solve_rows(
            half_space, rows, contacts.body, contacts.approaches, planes, contacts.stride, contacts.rtol,
            self.device, TRUNCATED,
        )  # fmt: skip
        flaws = found[1:].sum(axis=(1, 2)).astype(np.int64)
        return found[0], np.concatenate([[np.count_nonzero(found[0])], flaws])

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for worker in self._workers:
            worker.close()
