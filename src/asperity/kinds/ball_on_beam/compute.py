"""A ball rolls over a rough beam: the whole chain from texture to spectra."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from asperity.kinds.ball_on_beam.bodies import Bodies
from asperity.kinds.ball_on_beam.case import BallOnBeam
from asperity.kinds.ball_on_beam.roll import roll_ball
from asperity.laws import Law
from asperity.progress import Progress
from asperity.rolling.roll import FirstContact
from asperity.scenarios.chain import Chain, Stopwatch, reduce_and_roll
from asperity.scenarios.compiling import compile_kernels
from asperity.scenarios.usual.compute import checkpoint_of
from asperity.scenarios.usual.textures import recorded_time
from asperity.store import Store
from asperity.structures.beam import Beam
from asperity.structures.body import Ball

if TYPE_CHECKING:
    from asperity.scenarios.preparing import PreparedCase


@dataclass(frozen=True, eq=False)
class Computed:
    """Everything that was computed for a case, before it is laid out as a result."""

    case: BallOnBeam
    chain: Chain[FirstContact]  # textures, state functions, laws and runs
    ball: Ball
    beam: Beam


def compute(prepared: PreparedCase, progress: Progress) -> Computed:
    """Reduce and roll.

    Parameters
    ----------
    prepared : PreparedCase
        A case from `asperity.running.prepare_case`.
    progress : Progress
        Called during long work.

    Returns
    -------
    Computed
        All that was computed.
    """
    case, bodies, textures = prepared.case, prepared.bodies, prepared.textures
    assert isinstance(case, BallOnBeam)
    assert isinstance(bodies, Bodies)
    ball, beam, store, watch = bodies.ball, bodies.beam, Store(), Stopwatch(textures=prepared.seconds)
    compile_kernels(progress)  # not before the files are known to be right
    watch.lap("compiled functions")
    duration = recorded_time(case, textures)

    def roll_law(law: Law) -> FirstContact:
        return roll_ball(
            beam,
            ball,
            law,
            speed=case.speed,
            start=case.record_start,
            duration=duration,
            settling=case.settled_time,
            time_step=case.time_step,
            sensors=case.beam.sensor_positions,
            highest_frequency=case.numerics.highest_frequency,
            progress=progress,
            checkpoint=checkpoint_of(law, prepared, store),
        )

    chain = reduce_and_roll(prepared, roll_law, store, progress, watch)
    return Computed(case, chain, ball, beam)
