"""Contacts of half-spaces whose grid is one period of an infinite surface, at an approach or under a load.

The mean planes stay where they are: the displacement has no mean. Such an influence is negative far away,
and pressure may act outside of the overlap. Lifted until it is nowhere negative, it displaces by
lift × (sum of the pressure) more, everywhere alike: pressures are the same, and only what an approach counts
from is another. No pressure then acts outside of the overlap, and what solves contacts with a free boundary
solves these: the influence repeats itself with the period, so that between two cells of the grid it holds all
their images.
"""

from dataclasses import replace

import numpy as np

from asperity.arguments import Array, require
from asperity.contact.elastic_grid import ElasticGrid
from asperity.contact.pressed import at_approach, at_load
from asperity.contact.solved import Contact
from asperity.errors import Outcome
from asperity.written_numbers import rounded

ROUGHLY = 1e-3
"""Accuracy of the stiffness that a Newton step goes by."""
HALF = 0.5
"""Share of the tolerance that is left to the pressure, and of it to the approach."""


def refuse_period(half_space: ElasticGrid, what: str) -> None:
    """Refuse a periodic half-space for what needs a window that moves, or tractions along the surface."""
    require(
        half_space.boundary == "free", f"boundary of the half-space of {what}",
        f'"{half_space.boundary}"', '"free"', "On a period, solve contacts one by one, with solve.",
    )  # fmt: skip


def period_at_load(
    half_space: ElasticGrid, gap: Array, load: float, start: Array | None, rtol: float
) -> Contact:
    """Solve a periodic contact under a load, N; arguments checked, silent.

    The tolerance is relative to the overlap, which the lifted one exceeds: where that matters, a second
    solution goes on from the first.
    """
    if load > 0.0 and np.ptp(gap) == 0.0:
        return _flat(half_space, gap, load)
    contact = at_load(half_space, gap, load, start, rtol)
    lowered = _lowered(contact)
    if lowered.residual > rtol:
        tolerance = HALF * rtol * contact.residual / lowered.residual
        again = at_load(half_space, gap, load, contact.pressure, tolerance)
        lowered = replace(_lowered(again), iterations=contact.iterations + again.iterations)
    return lowered


def period_at_approach(
    half_space: ElasticGrid, gap: Array, approach: float, start: Array | None, rtol: float
) -> Contact:
    """Solve a periodic contact at an approach of the mean planes, m; arguments checked but for its limit.

    Looks for the lifted approach at which the mean planes have come so near. Without hardness that is a
    concave function of the lifted one, and Newton's method comes nearer from below; what overshoots
    elsewhere is halved.
    """
    lowest = float(gap.min())
    mean = float(gap.mean())
    require(
        half_space.hardness is not None or approach < mean,
        "approach of a periodic contact", f"{rounded(approach, 4)} m",
        f"less than the mean gap, {rounded(mean, 4)} m, at which elastic bodies touch everywhere",
        "Give the load, which goes on from there.",
    )  # fmt: skip
    overlap = approach - lowest
    lifted = approach
    low = approach
    high = np.inf
    iterations = 0
    if overlap <= 0.0:
        return at_approach(half_space, gap, approach, None, rtol)
    while True:
        contact = at_approach(half_space, gap, lifted, start, HALF * rtol * overlap / (lifted - lowest))
        lowered = _lowered(contact)
        start = contact.pressure
        iterations += contact.iterations
        missing = approach - lowered.approach
        low, high = (lifted, high) if missing > 0.0 else (low, lifted)
        if abs(missing) <= HALF * rtol * overlap or high - low <= np.spacing(lifted):
            break
        stiffness = half_space.tangent_stiffness(start, ROUGHLY)
        lifted += missing * (1.0 + stiffness * half_space.lift / half_space.cell_area)
        if not low < lifted < high:
            lifted = 0.5 * (low + high) if high < np.inf else lowest + 2.0 * (low - lowest)
    residual = lowered.residual + abs(missing) / overlap
    return replace(lowered, approach=approach, residual=residual, iterations=iterations)


def _flat(half_space: ElasticGrid, gap: Array, load: float) -> Contact:
    """Contact of parallel planes: the pressure is the same everywhere."""
    untouched = at_approach(half_space, gap, float(gap.min()), None, HALF)
    area = gap.size * half_space.cell_area
    pressure = np.full_like(gap, load / area)
    return replace(untouched, pressure=pressure, force=load, area=area, outcome=Outcome.CONVERGED)


def _lowered(contact: Contact) -> Contact:
    """Contact whose approach and residual are those of the mean planes."""
    approach = contact.approach - contact.half_space.lift * float(contact.pressure.sum())
    lowest = float(contact.undeformed_gap.min())
    share = (approach - lowest) / (contact.approach - lowest) if approach > lowest else 1.0
    return replace(contact, approach=approach, residual=contact.residual / share)
