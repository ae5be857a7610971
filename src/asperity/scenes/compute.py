"""A case of any kind is computed: from textures to the motion of what rolls and of what is rolled over."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity import __version__
from asperity.config.case import Case
from asperity.config.content import content, file_digest
from asperity.laws import Law, spec_of
from asperity.progress import Progress
from asperity.radiation.passing import passed_points
from asperity.rolling.roll import RolledBodies, roll_bodies
from asperity.scenarios.chain import Chain, Stopwatch, reduce_and_roll
from asperity.scenarios.compiling import compile_kernels
from asperity.scenarios.kind import Kind
from asperity.scenarios.preparing import PreparedCase
from asperity.scenarios.scene import Scene
from asperity.scenes.textures import recorded_time
from asperity.store import Checkpoint, Store, content_key
from asperity.structures.modal import Modal
from asperity.structures.moving_kernel import MovingKernel, moving_kernel
from asperity.structures.rail_poles import RailBetween, RailPoles, poles_or_kernel, rail_between
from asperity.structures.track import Track

FORMAT = 2
"""Of a state of motion that is kept: raise it where one is laid out anew."""
TOLD_OF = ("laws", "noise")
"""Keys of a case by which only that is computed which is told of a motion, and the laws."""


@dataclass(frozen=True, eq=False)
class Computed:
    """Everything that was computed for a case, before it is laid out as a result."""

    kind: Kind
    case: Any
    scene: Scene
    over: Modal | RailBetween | None  # what was rolled over, as it was carried on in time
    chain: Chain  # textures, state functions, laws and runs
    # (laws, points, n), displacement, m, and velocity, m/s, of the rail at the points that are passed
    points: tuple[NDArray[np.float64], ...] = ()

    @property
    def track(self) -> Track:
        """What is rolled over, of cases that roll over a track."""
        assert isinstance(self.scene.over, Track)
        return self.scene.over

    @property
    def rail(self) -> RailPoles | MovingKernel:
        """How the rail under one contact was carried on in time."""
        assert isinstance(self.over, RailBetween)
        return self.over.direct

    @property
    def kernel(self) -> MovingKernel:
        """Response of the rail under a moving contact."""
        assert isinstance(self.over, RailBetween)
        return self.over.kernel


def compute(prepared: PreparedCase, progress: Progress) -> Computed:
    """Reduce and roll a case from `asperity.running.prepare_case`."""
    case, scene, textures = prepared.case, prepared.bodies, prepared.textures
    assert isinstance(scene, Scene)
    store, watch = Store(), Stopwatch(textures=prepared.seconds)
    compile_kernels(progress)  # not before the files are known to be right
    watch.lap("compiled functions")
    over = in_time(scene, case, store, progress)
    watch.lap("what is rolled over")
    which, others = prepared.kind.contacts_of(case, scene.loads)
    duration = recorded_time(case, textures)

    def roll_laws(first: Law, *further: Law) -> RolledBodies:
        laws = (first, *further)
        return roll_bodies(
            over,
            scene.rolling,
            [laws[k] for k in which],
            positions=scene.positions,
            speed=case.speed,
            start=case.record_start,
            duration=duration,
            settling=case.settled_time,
            time_step=case.time_step,
            sensors=scene.sensors,
            highest_frequency=case.numerics.highest_frequency,
            progress=progress,
            checkpoint=checkpoint_of(first, prepared, store),
        )

    chain = reduce_and_roll(prepared, roll_laws, store, progress, watch, others)
    computed = Computed(prepared.kind, case, scene, over, chain)
    if scene.points:
        computed = replace(computed, points=_passed(computed, progress))
        watch.lap("passed points")
    return computed


def in_time(
    scene: Scene, case: Case, store: Store, progress: Progress | None = None
) -> Modal | RailBetween | None:
    """What is rolled over, as it is carried on in time: a track by its moving kernels."""
    if not isinstance(scene.over, Track):
        return scene.over
    kernel = moving_kernel(scene.over, case.speed, case.time_step, cache=store, progress=progress)
    rail = kernel if scene.scattered else poles_or_kernel(kernel, scene.most_poles, cache=store)
    return rail_between(rail, scene.offsets, cache=store, progress=progress)


def _passed(computed: Computed, progress: Progress) -> tuple[NDArray[np.float64], ...]:
    """Displacement, m, and velocity, m/s, of the rail at its points (laws, p, n), under all contacts."""
    runs = list(computed.chain.runs.values())
    forces, settled = np.stack([run.history for run in runs]), runs[0].history.shape[1] - len(runs[0].time)
    parts = [
        passed_points(computed.kernel, forces[:, k], float(origin), computed.scene.points, settled, progress)
        for k, origin in enumerate(runs[0].history_start)
    ]
    return tuple(np.sum(each, axis=0) for each in zip(*parts, strict=True))


def checkpoint_of(law: Law, prepared: PreparedCase, store: Store) -> Checkpoint | None:
    """Where a law that is solved in every step is kept, by the whole case and its path.

    Left out of the case are `TOLD_OF` and the names of its laws, each of which rolls alone.
    """
    if prepared.textures.path is None or not spec_of(law.name).solved_every_step:
        return None
    case = content(prepared.case, file_digest)
    case = {name: held for name, held in case.items() if name not in TOLD_OF}
    surface = prepared.textures.surface
    rows = surface.rows(0, surface.shape[0])
    return Checkpoint(
        store, content_key(law.name, FORMAT, __version__, rows, json.dumps(case, sort_keys=True))
    )
