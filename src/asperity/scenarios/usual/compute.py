"""One body rolls over another: the whole chain from texture to spectra."""

from __future__ import annotations

import json
from dataclasses import dataclass

from asperity import __version__
from asperity.config.content import content, file_digest
from asperity.laws import Law, spec_of
from asperity.progress import Progress
from asperity.rolling.pair import RolledPair, roll_pair
from asperity.scenarios.chain import Chain, Stopwatch, reduce_and_roll
from asperity.scenarios.compiling import compile_kernels
from asperity.scenarios.preparing import PreparedCase
from asperity.scenarios.usual.textures import recorded_time
from asperity.store import Checkpoint, Store, content_key

FORMAT = 2
"""Raise it when a state of motion is laid out anew."""


@dataclass(frozen=True, eq=False)
class Computed:
    """Everything that was computed for a case, before it is laid out as a result."""

    prepared: PreparedCase
    chain: Chain[RolledPair]


def compute(prepared: PreparedCase, progress: Progress) -> Computed:
    """Reduce and roll a case from `asperity.running.prepare_case`."""
    case, bodies, textures = prepared.case, prepared.bodies, prepared.textures
    store, watch = Store(), Stopwatch(textures=prepared.seconds)
    compile_kernels(progress)  # not before the files are known to be right
    watch.lap("compiled functions")
    duration = recorded_time(case, textures)

    def roll_law(law: Law) -> RolledPair:
        return roll_pair(
            bodies.over,
            bodies.rolls,
            law,
            speed=case.speed,
            start=case.record_start,
            duration=duration,
            settling=case.settled_time,
            time_step=case.time_step,
            highest_frequency=case.numerics.highest_frequency,
            progress=progress,
            checkpoint=checkpoint_of(law, prepared, store),
        )

    return Computed(prepared, reduce_and_roll(prepared, roll_law, store, progress, watch))


def checkpoint_of(
    law: Law, prepared: PreparedCase, store: Store, told_after: tuple[str, ...] = ()
) -> Checkpoint | None:
    """Where a law that is solved in every step is kept, by the whole case and its path.

    Left out of the case are the names of its laws, each of which rolls alone, and `told_after`: keys by which
    only that is computed which is told of a motion. What is no such key is never forgotten.
    """
    if prepared.textures.path is None or not spec_of(law.name).solved_every_step:
        return None
    case = content(prepared.case, file_digest)
    for name in ("laws", *told_after):
        del case[name]
    surface = prepared.textures.surface
    rows = surface.rows(0, surface.shape[0])
    return Checkpoint(
        store, content_key(law.name, FORMAT, __version__, rows, json.dumps(case, sort_keys=True))
    )
