"""Contacts on the grid of a half-space, solved: at an approach, under a load, and many in a block."""

from dataclasses import replace

import numpy as np

from asperity.arguments import Array
from asperity.contact.edges import Softness
from asperity.contact.elastic_grid import MAX_ITERATIONS, ElasticGrid, contiguous
from asperity.contact.solved import Contact
from asperity.errors import Outcome
from asperity.kernels import scanning
from asperity.kernels.box import foundation_approach
from asperity.kernels.influence import prepared
from asperity.surfaces.edges import Edges
from asperity.threads import refuse_to_go_on

AT_ONCE = 16
"""Positions between two looks at whether the user wants to stop."""


def at_approach(
    grid: ElasticGrid,
    gap: Array,
    approach: float,
    start: Array | None,
    rtol: float,
    total: float = -1.0,
    edges: Edges | None = None,
) -> Contact:
    """Solve at an approach, unchecked and silent; a sum of the pressure, Pa, is negative if not given.

    On a period the approach is the lifted one of `asperity.contact.periodic`, there and in `at_load`.
    """
    soft = None if edges is None else grid.softness(edges)
    rows = np.zeros(grid.shape)
    at = np.array([approach])
    block = block_of(grid, rows, gap, np.zeros(1), at, 0, rtol, load=total, soft=soft)
    if start is not None:
        block.pressures[1, 0] = start
        block.solved[0] = 1
    solve_block(grid, block)
    pressure = block.pressures[0, 0]
    (solved, iterations, unconverged, _) = block.counts.tolist()
    outcome = Outcome.CONVERGED if solved else Outcome.NO_CONTACT
    if unconverged:
        outcome = Outcome.ITERATION_LIMIT if iterations >= MAX_ITERATIONS else Outcome.STALLED
    return Contact(
        pressure, float(block.totals[0, 0]) * grid.cell_area, approach + float(block.levels[0, 0]),
        grid.covered_cells(pressure, edges) * grid.cell_area, iterations, float(block.residuals[0, 0]),
        outcome, grid, gap, edges,
    )  # fmt: skip


def block_of(
    grid: ElasticGrid,
    rows: Array,
    body: Array,
    planes: Array,
    approaches: Array,
    stride: int,
    rtol: float,
    single: bool = False,
    load: float = -1.0,
    soft: Softness | None = None,
    *,
    forces_alone: bool = False,
) -> scanning.Block:
    """Lay out contacts to be solved, with nothing known of them; arguments as in `scanning.Block`.

    Where forces alone are asked for they are as exact as else, and pressures less so.
    In single precision the iteration is half again as fast, down to a tolerance of about 1e-6.
    """
    rows, body, planes, approaches = map(contiguous, (rows, body, planes, approaches))
    if soft is not None:
        soft = Softness(*map(contiguous, soft))
    k = len(approaches)
    shape = body.shape
    nx, ny = shape
    size = (len(approaches), len(planes))
    loose = scanning.LOOSE * rtol if forces_alone else 0.0
    known = grid.known[np.float32 if single else np.float64]
    return scanning.Block(
        rows, body, planes, approaches, stride, load, 0.0, grid.pressure_cap, rtol, loose, MAX_ITERATIONS,
        scanning.room(known, nx, ny, grid.sides, soft), np.empty(shape), np.empty(shape),
        np.zeros((2, *shape)),
        np.zeros((2, k, *shape)), np.empty(shape), np.zeros((k, *shape)),
        np.zeros(k, dtype=np.int64), np.zeros(size), np.zeros(size),
        np.zeros(size), np.zeros(4, dtype=np.int64),
    )  # fmt: skip


def solve_block(grid: ElasticGrid, block: scanning.Block) -> scanning.Block:
    """Solve the contacts of a block, each from what is known of those before; unchecked and silent.

    Threads share the convolutions that are prepared: at worst one overwrites what another has prepared,
    which then comes again.
    """
    position = 0
    level = 0
    count = len(block.planes)
    precision = block.room.outer.dtype.type
    while position < count:
        refuse_to_go_on()
        end = min(position + AT_ONCE, count)
        known = grid.known[precision]
        position, level, nx, ny = scanning.solve_positions(known, block, position, level, end)
        if position < end:
            grid.known[precision] = prepared(grid.known[precision], nx, ny)
    return block


def at_load(
    grid: ElasticGrid, gap: Array, load: float, start: Array | None, rtol: float, edges: Edges | None = None
) -> Contact:
    """Solve at a given load as `solve` does, unchecked and silent: look at `converged`.

    The overlap at an estimated approach is all that needs a grid.
    """
    lowest = float(gap.min())
    if load == 0.0:
        return at_approach(grid, gap, lowest, None, rtol, edges=edges)
    estimate = foundation_approach(gap, load, grid.modulus, grid.cell_area, grid.pressure_cap)
    iterations = 0
    while True:
        reach = lowest + scanning.REACH * (estimate - lowest)
        contact = at_approach(grid, gap, reach, start, rtol, load / grid.cell_area, edges)
        iterations += contact.iterations
        if contact.approach <= reach:
            return replace(contact, iterations=iterations)
        estimate = contact.approach
        start = contact.pressure
