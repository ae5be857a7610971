"""Where bodies overlap, and the fields of a contact solution on the box around that.

They lie flat, row after row, with some idle columns behind each row: nothing overlaps there, so that no
pressure acts, and loops need not know where a row ends.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.influence import whole_vectors, workspace
from asperity.kernels.lanes import lanes
from asperity.kernels.options import CALLED, INNER, LOOP, REASSOCIATE, compiled

REACH = 2
"""How many cells the preconditioning stencil reaches from its centre."""
FAR = 1e30
"""Separation in the idle columns, m: no approach closes it, and single precision holds it."""


class Box(NamedTuple):
    """Fields of a solution on a box, each of nx rows of `pitch` cells."""

    nx: int  # rows
    ny: int  # columns
    pitch: int  # columns with the idle ones
    overlap: NDArray  # of the undeformed bodies, m
    pressure: NDArray  # Pa
    framed: NDArray  # that, between rows of zeros
    residual: NDArray  # K p − overlap, m
    previous: NDArray  # residual one iteration ago, m
    direction: NDArray  # of search, Pa
    step: NDArray  # change of the pressure, Pa
    response: NDArray  # what the step displaces, m
    z: NDArray  # preconditioned residual, Pa
    # about the pressure that an approach adds on the free set, Pa/m: at a load, and to look ahead
    unit: NDArray
    masked: NDArray  # residual on the free set, between REACH rows of zeros
    work: NDArray  # room for convolutions


@compiled(**INNER)
def _extent(nx: int, ny: int, lanes: int) -> tuple[int, int]:
    """Pitch of a box, and length of its fields: whole runs of four vectors."""
    pitch = max(whole_vectors(ny, lanes), ny + REACH)
    return pitch, whole_vectors(nx * pitch, 4 * lanes)


@compiled(**LOOP)
def box_room(nx: int, ny: int, mx: int, my: int, lanes: int) -> int:
    """Room, in numbers, that a box of nx × ny cells needs of which mx × my are convolved."""
    pitch, size = _extent(nx, ny, lanes)
    frames = 2 * whole_vectors(pitch, lanes) + whole_vectors(2 * REACH * pitch, lanes)
    return 10 * size + frames + workspace(mx, my, lanes)


@compiled(**CALLED)
def empty_box(nx: int, ny: int, room: NDArray) -> Box:
    """Make a box without overlap and pressure, whose fields lie in `room`, as long as `box_room` says."""
    pitch, size = _extent(nx, ny, lanes(room))
    frame = whole_vectors(pitch, lanes(room))
    fields = room[2 * (size + frame) :]
    masked = 7 * size
    end = 8 * size + 2 * REACH * pitch
    box = Box(
        nx, ny, pitch, room[:size], room[size + frame : 2 * size + frame], room[size : 2 * (size + frame)],
        fields[:size], fields[size : 2 * size], fields[2 * size : 3 * size], fields[3 * size : 4 * size],
        fields[4 * size : 5 * size], fields[5 * size : 6 * size], fields[6 * size : masked],
        fields[masked:end], fields[whole_vectors(end, lanes(room)) :],
    )  # fmt: skip
    for q in range(size):
        box.overlap[q] = -FAR
        box.residual[q] = FAR
    for q in range(size):
        box.pressure[q] = box.direction[q] = box.response[q] = box.unit[q] = 0.0
    for q in range(2 * frame):  # what is before the pressure and behind it
        box.framed[q if q < frame else size + q] = 0.0
    for q in range(2 * REACH * pitch):  # and the residual
        box.masked[q if q < REACH * pitch else size + q] = 0.0
    return box


@compiled(**INNER)
def _copy_part(
    source: NDArray, start: int, pitch: int, target: NDArray, first: int, step: int, b: Box
) -> None:
    """Copy as many rows and columns as a box has, rows a pitch apart to others a step apart."""
    for i in range(b.nx):
        known = source[start + i * pitch : start + i * pitch + b.ny]
        row = target[first + i * step : first + i * step + b.ny]
        for j in range(len(row)):
            row[j] = known[j]


@compiled(**INNER)
def cut(outer: Box, row: int, column: int, b: Box) -> None:
    """Copy what is known of a part of a box, from a row and a column on, to an empty box."""
    start = row * outer.pitch + column
    _copy_part(outer.overlap, start, outer.pitch, b.overlap, 0, b.pitch, b)
    _copy_part(outer.pressure, start, outer.pitch, b.pressure, 0, b.pitch, b)
    _copy_part(outer.residual, start, outer.pitch, b.residual, 0, b.pitch, b)
    _copy_part(outer.unit, start, outer.pitch, b.unit, 0, b.pitch, b)


@compiled(**INNER)
def paste(b: Box, outer: Box, row: int, column: int) -> None:
    """Copy pressure and `unit` of a part back, as in `cut`."""
    start = row * outer.pitch + column
    _copy_part(b.pressure, 0, b.pitch, outer.pressure, start, outer.pitch, b)
    _copy_part(b.unit, 0, b.pitch, outer.unit, start, outer.pitch, b)


@compiled(**INNER, **REASSOCIATE)
def _overlaps(row: NDArray, approach: float, lowest: NDArray) -> float:
    """Count gaps of a row below an approach, m, and lower to them the lowest of each column.

    Of a number that is summed the compiler makes vectors, where it would not of a least one.
    """
    count = 0.0
    for j in range(len(row)):
        g = row[j]
        lowest[j] = min(lowest[j], g)
        count += 1.0 if g < approach else 0.0
    return count


BALL = 4.0 / 3.0 / math.sqrt(math.pi / 2.0)
"""Makes the estimate of the approach exact for a ball: Hertz's force over √A × (mean overlap on A)."""


@compiled(**CALLED)
def overlap_box(gap: NDArray, approach: float, lowest: NDArray) -> tuple[float, int, int, int, int]:
    """Find where bodies with a gap (nx, ny), m, at zero approach overlap at an approach, m.

    Returns the largest overlap, m, not positive if there is none, and the first and end row and column of the
    smallest box that holds all overlapping cells, else zeros. `lowest` (ny,) receives the lowest gap of each
    column, m.
    """
    nx, ny = gap.shape
    for j in range(ny):
        lowest[j] = np.inf
    first = nx
    end = 0
    for i in range(nx):
        if _overlaps(gap[i], approach, lowest) > 0.0:
            first = min(first, i)
            end = i + 1
    smallest = np.inf
    for j in range(ny):
        smallest = min(smallest, lowest[j])
    if end == 0:
        return approach - smallest, 0, 0, 0, 0
    left = 0
    right = ny
    while lowest[left] >= approach:
        left += 1
    while lowest[right - 1] >= approach:
        right -= 1
    return approach - smallest, first, end, left, right


@compiled(**LOOP, nogil=True)
def foundation_approach(
    gap: NDArray, load: float, modulus: float, cell_area: float, hardness: float
) -> float:
    """Estimate the approach, m, under a load, N: BALL E* √A × (mean overlap on A).

    The overlapping cells can carry the load there. Gap (nx, ny), m, at zero approach; modulus and hardness,
    Pa; cell area, m². The load is less than the hardness over the grid.
    """
    count, added, lowest = _below(gap, np.inf)
    stiffness = BALL * modulus * np.sqrt(cell_area)
    approach = added / count + load / (stiffness * np.sqrt(count))
    for _ in range(30):  # the mean over all cells first, then over fewer and fewer
        count, added, _lowest = _below(gap, approach)
        last = approach
        approach = added / count + load / (stiffness * np.sqrt(count))
        if abs(approach - last) <= 1e-3 * (approach - lowest):  # an estimate is enough
            break
    # where all cells are near the hardness, so many must overlap that they carry a little more than the load
    while count * cell_area * hardness <= 1.05 * load and count < gap.size:
        approach += 0.25 * (approach - lowest)
        count, added, _lowest = _below(gap, approach)
    return approach


@compiled(**CALLED, **REASSOCIATE)
def _below(gap: NDArray, approach: float) -> tuple[float, float, float]:
    """Number and sum of the gaps below an approach, and the lowest."""
    count = 0.0
    added = 0.0
    lowest = np.inf
    for i in range(gap.shape[0]):
        for j in range(gap.shape[1]):
            g = gap[i, j]
            count += 1.0 if g < approach else 0.0
            added += g if g < approach else 0.0
            lowest = min(lowest, g)
    return count, added, lowest
