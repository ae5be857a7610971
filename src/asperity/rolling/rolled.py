"""Rolling any bodies under a law: from rest to the end of the path, and what is recorded of it."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from asperity.errors import CoarseSamplingWarning, Outcome
from asperity.kernels.pointforce import Prepared
from asperity.laws.base import Law
from asperity.progress import Progress
from asperity.rolling.equilibrium import static_approach
from asperity.rolling.outcome import (
    STEPPED_EQUILIBRIUM,
    ContactLoss,
    contact_losses,
    displaced_in_contact,
    evaluation,
    flying,
    refuse_missed_load,
    warn_after,
)
from asperity.rolling.path import Path
from asperity.rolling.stability import (
    largest_force,
    largest_stiffness,
    softening,
    stiffness_in_impacts,
)
from asperity.rolling.stepping import Stepper, restore, step_through
from asperity.store import Checkpoint

S = TypeVar("S", bound=Stepper)
Limit = tuple[str, float, float]
"""What must be resolved: its name, its frequency, Hz, and the time steps in a period that it takes."""


@dataclass(frozen=True, eq=False)
class Rolled:
    """One body has rolled over another."""

    time: NDArray[np.float64]  # (n,), s, uniform from zero, after the run-in
    position: NDArray[np.float64]  # (n,), of the contact, m
    contact_force: NDArray[np.float64]  # (n,), N, compression positive
    relative_displacement: NDArray[np.float64]  # (n,), approach of the mean surfaces, m, positive closing
    in_contact: NDArray[np.bool_]  # (n,), whether the bodies touch
    contact_loss: list[ContactLoss]  # flights
    evaluations: int  # of the law, in run-in and run
    unconverged_steps: int  # time steps whose contact force missed the tolerance, of run-in and run
    outcome: Outcome  # whether all steps converged

    @property
    def contact_loss_share(self) -> float:
        """Share of the time out of contact."""
        return 1.0 - float(np.mean(self.in_contact))

    @property
    def longest_loss(self) -> float:
        """Duration of the longest flight, s."""
        return max((event.duration for event in self.contact_loss), default=0.0)


def roll_along(
    path: Path,
    law: Law,
    load: float,
    stand: Callable[[float, float], S],
    *,
    alternating: tuple[float, float],
    limits: Callable[[float], Iterable[Limit]],
    judge: Callable[[S], None] = lambda stepper: None,
    free: tuple[float, float] | None = None,
    progress: Progress | None,
    checkpoint: Checkpoint | None,
) -> tuple[Rolled, S]:
    """Roll bodies along a path under a law and a static load, N, from equilibrium; return record and bodies.

    `stand` makes the bodies at rest from the approach as the law sees it under the load, m, and a compliance
    in series with the contact, m/N; `limits` says, of the contact stiffness at rest, N/m, what the time step
    must resolve; `alternating` holds the least alternating compliance of both bodies, and of what throws them
    apart, m/N (`asperity.rolling.stability`). `judge` looks at the bodies at the end, also at that of a
    motion that runs away, and may warn. `free` holds the mass, kg, of a body that nothing but its contact
    holds, and the largest static compliance, m/N, of what deflects on the path: a run that misses the load in
    the mean is then refused (`asperity.rolling.outcome`). A checkpoint keeps the state about every 10 s, at
    the end and when interrupted, to go on from there.

    Warned of are a coarse time step, a law that was continued beyond its data, and forces that missed the
    tolerance.
    """
    prepared = law.prepare(path.positions)
    relative = 1e-9 if isinstance(prepared, Prepared) else STEPPED_EQUILIBRIUM
    approach, stiffness = static_approach(evaluation(prepared, 0), load, relative)
    warn_if_coarse(path.time_step, limits(stiffness))
    stiffest, strongest = largest_stiffness(prepared, (approach, stiffness))
    stiff = stiffest, stiffness_in_impacts(prepared, stiffest, stiffness)
    softer = softening(alternating, stiff, law.damping, stiffness, path.time_step)
    stepper = stand(approach, softer)
    restore(checkpoint, stepper, prepared)
    try:
        step_through(stepper, prepared, law.damping, largest_force(load, strongest), progress, checkpoint)
    finally:  # why a motion may have run away
        judge(stepper)
    record, counts, kept = stepper.record, stepper.motion.counts, slice(path.settled, None)
    seen = record.approach - softer * record.force
    flown = flying(prepared, record.force, seen)
    apart = flown[kept]
    warn_after(law.name, counts, prepared, seen)
    if free is not None:
        reach = free[1] * load + displaced_in_contact(record.approach, flown)
        refuse_missed_load(law.name, record.force, load, free[0], reach, path.time_step, path.settled)
    rolled = Rolled(
        time=path.time,
        position=path.positions[kept],
        contact_force=record.force[kept],
        relative_displacement=record.approach[kept],
        in_contact=~apart,
        contact_loss=contact_losses(apart, path.time_step),
        evaluations=int(counts[2]),
        unconverged_steps=int(counts[1]),
        outcome=Outcome.STEPS_UNCONVERGED if counts[1] else Outcome.CONVERGED,
    )
    return rolled, stepper


def warn_if_coarse(time_step: float, limits: Iterable[Limit]) -> None:
    """Compare the time step with the periods that it must resolve."""
    for what, frequency, least in limits:
        if frequency * time_step * least > 1.0:
            warnings.warn(
                f"{what}, {frequency:.4g} Hz, has {1.0 / (frequency * time_step):.3g} time steps in a "
                f"period, fewer than {least:.0f}: its response is distorted; "
                f"take a time step of at most {1.0 / (least * frequency):.2g} s",
                CoarseSamplingWarning,
                stacklevel=4,
            )
