"""A case of any kind is computed: from textures to the motion of what rolls and of what is rolled over."""

import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any, TypeVar

import numpy as np

from asperity import __version__
from asperity.arguments import Array
from asperity.case.any_case import AnyCase
from asperity.case.form import content, file_digest
from asperity.case.scene import Case
from asperity.contact.scan import ScannedForces
from asperity.laws import Need, Role, in_role, names, needs_of, spec_of
from asperity.progress import Progress
from asperity.radiation.passing import passed_points
from asperity.rolling.roll import RolledBodies, roll_bodies
from asperity.rolling.trajectory import Path
from asperity.scenarios import compiling
from asperity.scenarios.laws import ReducedCase, reduced_case, working_point
from asperity.scenarios.running_in import run_in_case
from asperity.scenarios.scanned_states import within_scan
from asperity.scenarios.scene import PreparedCase, Scene
from asperity.scenarios.textures import other_contacts, recorded_time
from asperity.scenes.records import RecordedRuns
from asperity.schema import Values
from asperity.speeds import SpeedCourse
from asperity.store import Checkpoint, Store, content_key
from asperity.structures.modal import Modal
from asperity.structures.rail_poles import RailBetween, rail_at
from asperity.structures.track import Track
from asperity.surfaces.bands import band_levels_of
from asperity.surfaces.heightmap import Profile
from asperity.surfaces.strip import drawn_meanwhile

T = TypeVar("T")
FORMAT = 3
"""Of a state of motion that is kept: raise it where one is laid out anew."""
LOWEST_SWEPT = 20.0
"""Frequency from which on receptances of a track are laid out, Hz."""
SWEPT = 600
"""Frequencies of receptances of a track."""
TOLD_OF = ("laws", "noise")
"""Keys of a case by which only that is computed which is told of a motion, and the laws."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Computed(ReducedCase, RecordedRuns):
    """Everything that was computed for a case, before it is laid out as a result: its textures as run in."""

    over: Modal | RailBetween | None  # what was rolled over, as it was carried on in time
    runs: dict[str, RolledBodies]  # time histories, by law
    scan: ScannedForces | None  # of the path
    running_in: Values  # what passes before did to the textures
    # (c, n), N, over a track by the bare linear law, of whose force CNOSSOS-EU's sound power is
    bare_force: Array | None
    # (laws, points, n), displacement, m, and velocity, m/s, of the rail at the points that are passed
    points: tuple[Array, ...] = ()
    _derived: dict[Callable[..., Any], Any] = field(default_factory=dict, init=False, repr=False)

    @property
    def quantities(self) -> frozenset[str]:
        """Which of `asperity.scenes.observer.QUANTITIES` it has."""
        sensed = {"acceleration"} if self.case.rolled_over.sensor_positions else set()
        over = {"track"} if isinstance(self.scene.over, Track) else set()
        return frozenset({"contact_force", "scene"} | sensed | over)

    def derived(self, function: Callable[["Computed"], T]) -> T:
        """What a function derives from this run: derived once, whoever asks for it."""
        if function not in self._derived:
            self._derived[function] = function(self)
        found: T = self._derived[function]
        return found

    @property
    def stiffness(self) -> float:
        """Stiffness of a linear contact under the working load, N/m."""
        return working_point(self.case.contact, self.shape, self.reduction)[1]

    @property
    def track(self) -> Track:
        """What is rolled over, of cases that roll over a track."""
        assert isinstance(self.scene.over, Track)
        return self.scene.over

    @property
    def swept(self) -> Array:
        """Frequencies (k,), Hz, at which receptances and decay rates of a track are laid out."""
        return np.geomspace(LOWEST_SWEPT, self.case.numerics.highest_frequency, SWEPT)

    @property
    def rail(self) -> RailBetween:
        """How the rail of a track was carried on in time."""
        assert isinstance(self.over, RailBetween)
        return self.over

    @cached_property
    def bare_levels(self) -> Array | None:
        """Levels of the forces by the bare linear law (c, b), dB re 1 N; None where it was not rolled."""
        return None if self.bare_force is None else self.levels(self.psd(self.bare_force))

    @cached_property
    def line_levels(self) -> dict[str, tuple[Array, Array]]:
        """Wavelengths, m, and band levels, dB re 1 µm, of the parts of the line texture and all combined.

        Without flat and joint.
        """
        textures = self.textures
        spacing = self.case.contact.spacing
        lines = {**textures.parts, "combined": textures.line}
        return {name: band_levels_of(Profile(line, spacing)) for name, line in lines.items()}


class _Clock:
    """Wall time of each part of the work, s: what has passed since the last part is that of this one."""

    def __init__(self, seconds: Mapping[str, float]) -> None:
        self.seconds = dict(seconds)
        self.last = time.perf_counter()

    def book(self, part: str) -> None:
        """Book the time since the last part on this one."""
        now = time.perf_counter()
        self.seconds[part] = now - self.last
        self.last = now


def compute(prepared: PreparedCase, progress: Progress) -> Computed:
    """Run the textures of a case in, if it asks for it, reduce its samples, build its laws and roll each."""
    case = prepared.case
    clock = _Clock(prepared.seconds)
    with drawn_meanwhile(prepared.textures.path):
        # not before files are known to be right
        compiling.compile_kernels(progress, *prepared.kinds_of_cells)
        clock.book("compiled functions")
        over = _in_time(prepared.scene, case, Store(), progress)
    clock.book("what is rolled over")
    which, others = other_contacts(case, prepared.scene.loads)
    run_in, ran = _run_in(prepared, progress)
    if run_in is not prepared:
        clock.book("running in")
    first = reduced_case(run_in, progress)
    clock.book("reduction")
    every = [first, *(first.of_contact(*own) for own in others)]
    scanned: Sequence[ReducedCase] = [each.scanning for each in every]
    once = partial(_rolled, prepared, over, which, progress)
    visited = partial(_visited, len(every))
    runs: dict[str, RolledBodies] = {}
    for name in case.laws:
        if Need.SCAN in spec_of(name).needs:
            runs[name], scanned = within_scan(partial(once, name), scanned, visited)
        else:
            runs[name] = once(name, every)
        clock.book(f"law {name}")
    bare_force = None
    bare = in_role(Role.BARE, names())
    steady = not isinstance(case.speed, SpeedCourse)  # CNOSSOS-EU knows no other speed
    if bare is not None and steady and isinstance(prepared.scene.over, Track) and np.ptp(first.textures.line):
        bare_force = (runs[bare] if bare in runs else once(bare, every)).contact_force
        clock.book("what CNOSSOS-EU's sound power is of")
    scan = scanned[0].path_scan if Need.SCAN in needs_of(case.laws) else None
    unused = replace(first, seconds=clock.seconds, states=scanned[0].states)
    computed = Computed(
        **vars(unused), over=over, runs=runs, scan=scan, running_in=ran, bare_force=bare_force
    )
    if case.point_positions:
        computed = replace(computed, points=_passed(computed, progress))
        clock.book("passed points")
    return computed


def _rolled(
    prepared: PreparedCase,
    over: Modal | RailBetween | None,
    which: Sequence[int],
    progress: Progress,
    law: str,
    every: Sequence[ReducedCase],
    share: float = 1.0,
) -> RolledBodies:
    """Roll a share of the record by a law, built for each contact that differs; which is whose is told."""
    case = prepared.case
    laws = [materials.build(law) for materials in every]
    run = roll_bodies(
        over,
        prepared.scene.rolling,
        [laws[k] for k in which],
        positions=prepared.scene.positions,
        speed=case.speed,
        start=case.record_start,
        duration=share * recorded_time(case, prepared.textures),
        settling=case.settled_time,
        time_step=case.time_step,
        sensors=case.rolled_over.sensor_positions,
        highest_frequency=case.numerics.highest_frequency,
        progress=progress,
        checkpoint=checkpoint_of(law, case, lambda: _heights_of(prepared), Store()),
    )
    return run.steadied()


def _run_in(prepared: PreparedCase, progress: Progress) -> tuple[PreparedCase, Values]:
    """The case with its textures run in, where it asks for that, and what running in says."""
    if prepared.case.contact.running_in is None:
        return prepared, Values()
    textures, ran = run_in_case(prepared, progress)
    return replace(prepared, textures=textures), ran


def _visited(paths: int, run: RolledBodies) -> list[tuple[float, float]]:
    """Least and largest approach of all contacts of a run, m, for each of so many paths that they roll on."""
    return [(float(run.visited[:, 0].min()), float(run.visited[:, 1].max()))] * paths


def _in_time(scene: Scene, case: Case, store: Store, progress: Progress) -> Modal | RailBetween | None:
    """What is rolled over, as it is carried on in time: a track by its moving kernels."""
    if not isinstance(scene.over, Track):
        return scene.over
    scattered = case.numerics.kernel == "scatter"
    given = scene.over, case.speed, case.time_step, scene.offsets
    return rail_at(*given, poles=case.numerics.poles, scattered=scattered, cache=store, progress=progress)


def _passed(computed: Computed, progress: Progress) -> tuple[Array, ...]:
    """Displacement, m, and velocity, m/s, of the rail at its points (laws, p, n), under all contacts."""
    forces = computed.stacked("history")
    origins = computed.first.history_start
    settled = forces.shape[-1] - len(computed.first.time)
    step = computed.case.time_step
    record = step * (len(computed.first.time) - 1)
    rolled = Path.laid(0.0, computed.case.speed, step, record, step * settled).positions[0]
    kernel = computed.rail.kernel
    points = computed.case.point_positions
    parts = [
        passed_points(kernel, forces[:, k], origin + rolled - rolled[0], points, settled, progress)
        for k, origin in enumerate(origins)
    ]
    return tuple(np.sum(each, axis=0) for each in zip(*parts, strict=True))


def _heights_of(prepared: PreparedCase) -> list[Array]:
    """Heights of all of the path, before it is run in."""
    if prepared.textures.path is None:
        return [prepared.textures.line]
    surface = prepared.textures.surface
    return [surface.rows(0, surface.shape[0])]


def checkpoint_of(
    law: str, case: AnyCase, surfaces: Callable[[], Sequence[Array]], store: Store
) -> Checkpoint | None:
    """Where a law that is solved in every step is kept, by the whole case and the heights it rolls over.

    Left out of the case are `TOLD_OF` and the names of its laws, each of which rolls alone.
    """
    if not spec_of(law).solved_every_step:
        return None
    keys = {name: held for name, held in content(case, file_digest).items() if name not in TOLD_OF}
    told = json.dumps(keys, sort_keys=True)
    return Checkpoint(store, content_key(law, FORMAT, __version__, *surfaces(), told))
