"""Bodies roll over a structure: the whole chain from texture to spectra."""

from __future__ import annotations

from dataclasses import dataclass

from asperity.kinds.bodies.bodies import RolledCase, loads_of
from asperity.kinds.bodies.case import Bodies
from asperity.kinds.bodies.textures import contacts_of
from asperity.laws import Law
from asperity.progress import Progress
from asperity.rolling.roll import FirstContact, first_contact, roll_bodies
from asperity.scenarios.chain import Chain, Stopwatch, reduce_and_roll
from asperity.scenarios.compiling import compile_kernels
from asperity.scenarios.preparing import PreparedCase
from asperity.scenarios.usual.compute import checkpoint_of
from asperity.scenarios.usual.textures import recorded_time
from asperity.store import Store
from asperity.structures.modal import Modal
from asperity.structures.moving_kernel import moving_kernel
from asperity.structures.rail_poles import RailBetween, poles_or_kernel, rail_between
from asperity.structures.track import Track

Over = Modal | RailBetween | None


@dataclass(frozen=True, eq=False)
class Computed:
    """Everything that was computed for a case, before it is laid out as a result."""

    case: Bodies
    bodies: RolledCase
    over: Over  # what was rolled over, as it was carried on in time
    chain: Chain[FirstContact]  # textures, state functions, laws and runs


def compute(prepared: PreparedCase, progress: Progress) -> Computed:
    """Reduce and roll a case from `asperity.running.prepare_case`."""
    case, bodies, textures = prepared.case, prepared.bodies, prepared.textures
    assert isinstance(case, Bodies)
    assert isinstance(bodies, RolledCase)
    store, watch = Store(), Stopwatch(textures=prepared.seconds)
    compile_kernels(progress)  # not before the files are known to be right
    watch.lap("compiled functions")
    over = _carried(case, bodies.over, store, progress)
    watch.lap("structure")
    which, others = contacts_of(case, loads_of(bodies.rolling))
    duration = recorded_time(case, textures)

    def roll_laws(first: Law, *further: Law) -> FirstContact:
        laws = (first, *further)
        every = roll_bodies(
            over,
            bodies.rolling,
            [laws[k] for k in which],
            positions=case.body.positions,
            speed=case.speed,
            start=case.record_start,
            duration=duration,
            settling=case.settled_time,
            time_step=case.time_step,
            sensors=bodies.sensors,
            highest_frequency=case.numerics.highest_frequency,
            progress=progress,
            checkpoint=checkpoint_of(first, prepared, store),
        )
        return first_contact(every)

    chain = reduce_and_roll(prepared, roll_laws, store, progress, watch, others)
    return Computed(case, bodies, over, chain)


def _carried(case: Bodies, over: Modal | Track | None, store: Store, progress: Progress) -> Over:
    """What is rolled over, as it is carried on in time: a track by its kernels."""
    if not isinstance(over, Track):
        return over
    kernel = moving_kernel(over, case.speed, case.time_step, cache=store, progress=progress)
    direct = poles_or_kernel(kernel, cache=store)
    return rail_between(direct, case.body.offsets, cache=store, progress=progress)
