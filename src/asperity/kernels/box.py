"""Fields of a contact solution on a box.

They lie flat, row after row, with some idle columns behind each row: nothing overlaps there, so that no
pressure acts, and loops need not know where a row ends.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.convolution import whole, workspace
from asperity.kernels.lanes import lanes
from asperity.kernels.options import INNER, LOOP, compiled

REACH = 2
"""How many cells the preconditioning stencil reaches from its centre."""
FAR = 1e30
"""Separation in the idle columns, m."""


class Box(NamedTuple):
    """Fields of a solution on a box, each of nx rows of `pitch` cells.

    Attributes
    ----------
    nx, ny, pitch : int
        Rows, columns, and columns with the idle ones.
    overlap : ndarray
        Overlap of the undeformed bodies, m.
    pressure : ndarray
        Pressure, Pa.
    residual, previous : ndarray
        K p − overlap, m, now and one iteration ago.
    direction : ndarray
        Search direction, Pa.
    step, response : ndarray
        Change of the pressure, Pa, and what it displaces, m.
    z : ndarray
        Preconditioned residual, Pa.
    unit : ndarray
        At a given load, about the pressure that an approach adds on the free set, Pa/m.
    masked : ndarray
        Residual on the free set, between REACH rows of zeros.
    work : ndarray
        Room for convolutions.
    """

    nx: int
    ny: int
    pitch: int
    overlap: NDArray[np.float64]
    pressure: NDArray[np.float64]
    residual: NDArray[np.float64]
    previous: NDArray[np.float64]
    direction: NDArray[np.float64]
    step: NDArray[np.float64]
    response: NDArray[np.float64]
    z: NDArray[np.float64]
    unit: NDArray[np.float64]
    masked: NDArray[np.float64]
    work: NDArray[np.float64]


@compiled(**INNER)
def _extent(nx: int, ny: int, lanes: int) -> tuple[int, int]:
    """Pitch of a box, and length of its fields: whole runs of four vectors."""
    pitch = max(whole(ny, lanes), ny + REACH)
    return pitch, whole(nx * pitch, 4 * lanes)


@compiled(**LOOP)
def box_room(nx: int, ny: int, mx: int, my: int, lanes: int) -> int:
    """Room that a box needs.

    Parameters
    ----------
    nx, ny : int
        Cells.
    mx, my : int
        Cells that are convolved.
    lanes : int
        Numbers in a vector.

    Returns
    -------
    int
        Numbers.
    """
    pitch, size = _extent(nx, ny, lanes)
    return 10 * size + 2 * REACH * pitch + workspace(mx, my, lanes)


@compiled(**LOOP)
def empty_box(nx: int, ny: int, room: NDArray[np.float64]) -> Box:
    """Make a box on which nothing overlaps.

    Parameters
    ----------
    nx, ny : int
        Cells.
    room : ndarray
        As many numbers as `box_room` says, of any value, or more: the fields will lie here.

    Returns
    -------
    Box
        With pressure zero.
    """
    pitch, size = _extent(nx, ny, lanes(room))
    masked, end = 9 * size, 10 * size + 2 * REACH * pitch
    box = Box(
        nx, ny, pitch, room[:size], room[size : 2 * size], room[2 * size : 3 * size],
        room[3 * size : 4 * size], room[4 * size : 5 * size], room[5 * size : 6 * size],
        room[6 * size : 7 * size], room[7 * size : 8 * size], room[8 * size : masked], room[masked:end],
        room[end:],
    )  # fmt: skip
    for q in range(size):
        box.overlap[q], box.residual[q] = -FAR, FAR
    for q in range(size):
        box.pressure[q] = box.direction[q] = box.response[q] = 0.0
    for q in range(2 * REACH * pitch):  # what is behind the residual and before it
        box.masked[q if q < REACH * pitch else size + q] = 0.0
    return box


@compiled(**INNER)
def cut(outer: Box, row: int, column: int, b: Box) -> None:
    """Copy overlap, pressure and residual of a part of a box.

    Parameters
    ----------
    outer : Box
        The whole.
    row, column : int
        Where the part begins.
    b : Box
        The part, empty.
    """
    for i in range(b.nx):
        here, there = i * b.pitch, (row + i) * outer.pitch + column
        for j in range(b.ny):
            b.overlap[here + j] = outer.overlap[there + j]
            b.pressure[here + j] = outer.pressure[there + j]
            b.residual[here + j] = outer.residual[there + j]


@compiled(**INNER)
def paste(b: Box, outer: Box, row: int, column: int) -> None:
    """Copy the pressure of a part back.

    Parameters
    ----------
    b, outer, row, column
        As in `cut`.
    """
    for i in range(b.nx):
        for j in range(b.ny):
            outer.pressure[(row + i) * outer.pitch + column + j] = b.pressure[i * b.pitch + j]
