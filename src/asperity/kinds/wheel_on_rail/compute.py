"""A wheel rolls on an infinite track: the whole chain from texture to sound power."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from asperity.kinds.wheel_on_rail.bodies import Bodies
from asperity.kinds.wheel_on_rail.case import WheelOnRail
from asperity.kinds.wheel_on_rail.passing import passed_points
from asperity.kinds.wheel_on_rail.roll import roll_wheel
from asperity.laws import Law
from asperity.progress import Progress
from asperity.rolling.roll import FirstContact
from asperity.scenarios.chain import Chain, Stopwatch, reduce_and_roll
from asperity.scenarios.compiling import compile_kernels
from asperity.scenarios.usual.compute import checkpoint_of
from asperity.store import Store
from asperity.structures.moving_kernel import MovingKernel, moving_kernel
from asperity.structures.rail_poles import RailPoles, poles_or_kernel
from asperity.structures.track import Track
from asperity.structures.wheel import Wheel

if TYPE_CHECKING:
    from asperity.scenarios.preparing import PreparedCase


@dataclass(frozen=True, eq=False)
class Computed:
    """Everything that was computed for a case, before it is laid out as a result."""

    case: WheelOnRail
    chain: Chain[FirstContact]  # textures, state functions, laws and runs
    wheel: Wheel
    track: Track
    kernel: MovingKernel  # response of the rail under the moving contact
    rail: RailPoles | MovingKernel  # how it was carried on in time
    # (laws, points, n), displacement, m, and velocity, m/s, of the passed points
    points: tuple[NDArray[np.float64], ...] = ()


def compute(prepared: PreparedCase, progress: Progress) -> Computed:
    """Reduce and roll a case from `asperity.running.prepare_case`."""
    case, bodies = prepared.case, prepared.bodies
    assert isinstance(case, WheelOnRail)
    assert isinstance(bodies, Bodies)
    track, wheel, store = bodies.track, bodies.wheel, Store()
    watch = Stopwatch(textures=prepared.seconds)
    compile_kernels(progress)  # not before the files are known to be right
    watch.lap("compiled functions")
    kernel = moving_kernel(track, case.speed, case.time_step, cache=store, progress=progress)
    rail: RailPoles | MovingKernel = kernel
    if case.numerics.kernel == "poles":
        rail = poles_or_kernel(kernel, case.numerics.poles, cache=store)
    watch.lap("track")

    def roll_law(law: Law) -> FirstContact:
        return roll_wheel(
            rail,
            wheel,
            law,
            start=case.start,
            duration=case.duration,
            settling=case.settling,
            highest_frequency=case.numerics.highest_frequency,
            progress=progress,
            checkpoint=checkpoint_of(law, prepared, store, told_after=("noise",)),
        )

    chain = reduce_and_roll(prepared, roll_law, store, progress, watch)
    runs = [run.every for run in chain.runs.values()]
    forces, settled = np.stack([run.history[0] for run in runs]), runs[0].history.shape[1] - len(runs[0].time)
    origin = float(runs[0].history_start[0])
    points = passed_points(kernel, forces, origin, case.point_positions, settled, progress)
    watch.lap("passed points")
    return Computed(case, chain, wheel, track, kernel, rail, points)
