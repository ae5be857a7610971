"""What a contact solution does to keep a load: the sum of the pressure, whose multiplier is the approach."""

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.box import FAR, REACH, Box
from asperity.kernels.options import CALLED, INNER, REASSOCIATE, compiled

EXACT, SHIFTS = 1e-13, 100
"""Accuracy of the sum, some hundred roundings of it, and how often it is tried to reach it."""


@compiled(**INNER)
def rounding(hardness: float, total: float) -> float:
    """Pressure, Pa, within which a cell is at a bound: where all are, rounding leaves none between.

    Zero without an upper bound, and for a negative `total` (Pa, over the cells): the approach is given then,
    and nothing kept but the bounds.
    """
    return EXACT * min(hardness, total) if total >= 0.0 and hardness < np.inf else 0.0


@compiled(**INNER, **REASSOCIATE)
def find_level(b: Box, hardness: float) -> float:
    """Find the approach beyond that of the overlap, m: the mean residual of the cells between the bounds."""
    added, count = 0.0, 0.0
    for q in range(len(b.pressure)):
        p = b.pressure[q]
        between = p > 0.0 and p < hardness
        added += b.residual[q] if between else 0.0
        count += 1.0 if between else 0.0
    return added / count if count > 0.0 else _between_bounds(b)


@compiled(**CALLED)
def _between_bounds(b: Box) -> float:
    """Level between the residuals of those cells that are at the one and the other bound."""
    capped = -FAR
    empty = FAR
    for i in range(b.nx):
        for q in range(i * b.pitch, i * b.pitch + b.ny):
            if b.pressure[q] > 0.0:
                capped = max(capped, b.residual[q])
            else:
                empty = min(empty, b.residual[q])
    return 0.5 * (capped + empty) if empty < FAR else capped


@compiled(**INNER)
def mark_free(b: Box, hardness: float, level: float) -> None:
    """Mask ones with the free set: cells that no bound holds at a level, m, beyond the overlap's approach."""
    target = b.masked[REACH * b.pitch :]
    for q in range(len(b.pressure)):
        p = b.pressure[q]
        r = b.residual[q] - level
        target[q] = 1.0 if (p > 0.0 or r < 0.0) and (p < hardness or r > 0.0) else 0.0


@compiled(**INNER, **REASSOCIATE)
def balance_load(b: Box, share: float, level: float) -> tuple[float, float]:
    """Take a share of `unit`, m, off z; return product and change as `projected_cg.precondition` does."""
    rho = 0.0
    change = 0.0
    free = b.masked[REACH * b.pitch :]
    for q in range(len(b.z)):
        z = b.z[q] - share * b.unit[q]
        g = (b.residual[q] - level) * free[q]
        b.z[q] = z
        rho += g * z
        change += (g - b.previous[q]) * z
    return rho, change


@compiled(**INNER, **REASSOCIATE)
def _shift(
    b: Box, length: float, shift: float, level: float, hardness: float
) -> tuple[float, float, float, float]:
    """Set the step to a length along the direction and one along `unit`, projected on the bounds.

    Returns the sum of the pressure after it, how that grows with the shift, its work against the residual,
    and how many cells the bounds held back.
    """
    total = 0.0
    growth = 0.0
    work = 0.0
    clipped = 0.0
    for q in range(len(b.z)):
        p, unit = b.pressure[q], b.unit[q]
        wanted = p + length * b.direction[q] + shift * unit
        kept = min(max(wanted, 0.0), hardness)
        growth += unit if kept == wanted else 0.0
        clipped += 1.0 if kept != wanted else 0.0
        step = kept - p
        b.step[q] = step
        total += kept
        work += (b.residual[q] - level) * step
    return total, growth, work, clipped


@compiled(**INNER)
def _sum(values: NDArray[np.float64]) -> float:
    """Add them up in order: `sum` of an array needs a part of numba that takes 0.2 s to import."""
    total = 0.0
    for q in range(len(values)):
        total += values[q]
    return total


@compiled(**CALLED)
def project_at_load(
    b: Box, length: float, level: float, hardness: float, total: float
) -> tuple[float, float, bool]:
    """Set the step to a length along the direction, projected on the bounds and on the load.

    The load is the sum of the pressure, Pa. What the projection takes is shifted along `unit`: the sum grows
    along straight lines with the shift, so that a Newton iteration within a bracket finds it. Returns the
    work of the step against the residual (zero if there is no such shift), the cells that the bounds held
    back, and whether there is such a shift.
    """
    low = -np.inf
    high = np.inf
    shift = 0.0
    reach = 0.0
    for _ in range(SHIFTS):
        reached, growth, work, clipped = _shift(b, length, shift, level, hardness)
        missing = total - reached
        if abs(missing) <= EXACT * total:
            return work, clipped, True
        low, high = (shift, high) if missing > 0.0 else (low, shift)
        following = shift + missing / growth if growth > 0.0 else np.nan
        if not low < following < high:
            if low > -np.inf and high < np.inf:
                following = 0.5 * (low + high)
            else:  # the bounds hold all cells back
                reach = 4.0 * reach if reach > 0.0 else total / _sum(b.unit)
                following = shift + (reach if missing > 0.0 else -reach)
        shift = following
    return 0.0, 0.0, False


@compiled(**CALLED)
def carry(b: Box, hardness: float, total: float, stiffness: float) -> None:
    """Scale about the pressure of a box to the sum that it has to carry, Pa, within the bounds.

    The overlapping cells can carry that. Where the pressure acts on too few cells, the overlap times a
    stiffness (Pa/m) is scaled instead.
    """
    for q in range(len(b.pressure)):
        b.direction[q] = b.unit[q] = b.pressure[q]
        b.pressure[q] = 0.0
    if not project_at_load(b, 1.0, 0.0, hardness, total)[2]:
        for q in range(len(b.pressure)):
            b.direction[q] = stiffness * b.overlap[q]
            b.unit[q] = stiffness
        project_at_load(b, 1.0, 0.0, hardness, total)
    margin = rounding(hardness, total)
    for q in range(len(b.pressure)):
        kept = 0.0 if b.step[q] <= margin else b.step[q]
        b.pressure[q] = hardness if kept >= hardness - margin else kept
