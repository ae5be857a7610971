"""Fields of a contact solution on a box.

They lie flat, row after row, with some idle columns behind each row: nothing overlaps there, so that no
pressure acts, and loops need not know where a row ends.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.convolution import whole_vectors, workspace
from asperity.kernels.lanes import lanes
from asperity.kernels.options import CALLED, INNER, LOOP, compiled

REACH = 2
"""How many cells the preconditioning stencil reaches from its centre."""
FAR = 1e30
"""Separation in the idle columns, m: no approach closes it, and single precision holds it."""


class Box(NamedTuple):
    """Fields of a solution on a box, each of nx rows of `pitch` cells."""

    nx: int  # rows
    ny: int  # columns
    pitch: int  # columns with the idle ones
    overlap: NDArray[np.float64]  # of the undeformed bodies, m
    pressure: NDArray[np.float64]  # Pa
    residual: NDArray[np.float64]  # K p − overlap, m
    previous: NDArray[np.float64]  # residual one iteration ago, m
    direction: NDArray[np.float64]  # of search, Pa
    step: NDArray[np.float64]  # change of the pressure, Pa
    response: NDArray[np.float64]  # what the step displaces, m
    z: NDArray[np.float64]  # preconditioned residual, Pa
    # at a given load, about the pressure that an approach adds on the free set, Pa/m
    unit: NDArray[np.float64]
    masked: NDArray[np.float64]  # residual on the free set, between REACH rows of zeros
    work: NDArray[np.float64]  # room for convolutions


@compiled(**INNER)
def _extent(nx: int, ny: int, lanes: int) -> tuple[int, int]:
    """Pitch of a box, and length of its fields: whole runs of four vectors."""
    pitch = max(whole_vectors(ny, lanes), ny + REACH)
    return pitch, whole_vectors(nx * pitch, 4 * lanes)


@compiled(**LOOP)
def box_room(nx: int, ny: int, mx: int, my: int, lanes: int) -> int:
    """Room, in numbers, that a box of nx × ny cells needs of which mx × my are convolved."""
    pitch, size = _extent(nx, ny, lanes)
    return 10 * size + 2 * REACH * pitch + workspace(mx, my, lanes)


@compiled(**CALLED)
def empty_box(nx: int, ny: int, room: NDArray[np.float64]) -> Box:
    """Make a box without overlap and pressure, whose fields lie in `room`, as long as `box_room` says."""
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
    """Copy overlap, pressure and residual of a part of a box, from a row and a column on, to an empty box."""
    for i in range(b.nx):
        here, there = i * b.pitch, (row + i) * outer.pitch + column
        for j in range(b.ny):
            b.overlap[here + j] = outer.overlap[there + j]
            b.pressure[here + j] = outer.pressure[there + j]
            b.residual[here + j] = outer.residual[there + j]


@compiled(**INNER)
def paste(b: Box, outer: Box, row: int, column: int) -> None:
    """Copy the pressure of a part back, as in `cut`."""
    for i in range(b.nx):
        for j in range(b.ny):
            outer.pressure[(row + i) * outer.pitch + column + j] = b.pressure[i * b.pitch + j]
