"""A ball bearing is run by each of its laws: what of it was recorded."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from functools import cache, partial
from typing import Any, Self

import numpy as np

from asperity.arguments import Array
from asperity.case.ball_bearing import BearingUnderLoad
from asperity.errors import PhysicsWarning
from asperity.laws import Need, spec_of
from asperity.laws.film import WithFilm
from asperity.laws.tilted import Tilted
from asperity.progress import Progress, counted
from asperity.rolling.bearing import (
    BearingRings,
    RolledBearing,
    Sensor,
    roll_bearing,
)
from asperity.scenarios.prepared_bearing import (
    ON,
    RINGS,
    PreparedBearing,
    named_on,
    prepare_bearing,
    raceways_of,
)
from asperity.scenarios.raceway_laws import OnRaceway, laws_on
from asperity.scenarios.roller_raceways import felt_by
from asperity.scenarios.scanned_states import within_scan
from asperity.scenes.compute import checkpoint_of
from asperity.scenes.records import RecordedRuns
from asperity.speeds import SpeedCourse
from asperity.store import Store
from asperity.structures.ball_bearing import BallBearing
from asperity.structures.ring import Ring
from asperity.threads import begun_in_order

DAMPED = 0.05
"""Share by which the force of a contact that is looked up may lie beside what its damping leaves of it."""
TRIED = 0.1
"""Share of run-in and record after which it is asked first whether forces leave what was scanned."""
BY_PARTS = "areal"
"""The law by which parts are run alone: it sees whole contacts, and asks for no scan."""
ALIKE = 1e-6
"""Share of their loads by which balls may differ that are carried alike."""
FORCES = ("inner_force", "outer_force")
"""They begin and end at once, where the filter rings: none is written that is below all that were found."""
SIGNALS = (*FORCES, "flank_force", "rib_force", "ball_motion", "inner_motion", "outer_motion", "acceleration")
"""What a run holds over time, beside what grows evenly."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ComputedBearing(PreparedBearing, RecordedRuns):
    """A bearing that was run by its laws, before it is laid out as a result."""

    runs: dict[str, RolledBearing]  # records, by law, at the sampling rate of the case
    rolled: dict[str, RolledBearing]  # the same with what rounding leaves of motion where nothing vibrates
    # accelerations (sensors, n), m/s², by `BY_PARTS`, with nothing on the parts, or what is on one of them
    alone: dict[str, Array] = field(default_factory=dict)

    @property
    def bearing(self) -> BallBearing:
        """Geometry of the bearing, and its speeds."""
        return self.case.bearing.bearing

    @property
    def quantities(self) -> frozenset[str]:
        """Which of `asperity.scenes.observer.QUANTITIES` it has."""
        sensed = {"acceleration"} if self.case.sensors else set()
        return frozenset({"contact_force", "bearing"} | sensed)


def compute_bearing(
    prepared: PreparedBearing, progress: Progress, begin_beside: Callable[[], object] = lambda: None
) -> ComputedBearing:
    """Run the bearing by each law, at the sampling rate of the case.

    `begin_beside` is called as a run begins that takes one thread, after scans, which take all; maybe again.
    """
    every = prepared.case.steps_per_sample
    found = {}
    for name, run in _rolled(prepared, progress, begin_beside=begin_beside):
        signals: dict[str, Any] = {each: thinned(getattr(run, each), every) for each in SIGNALS}
        signals |= {each: np.maximum(signals[each], getattr(run, each).min()) for each in FORCES}
        found[name] = replace(run, time=run.time[::every], cage=run.cage[::every], **signals)
    runs = {name: run.steadied() for name, run in found.items()}
    return ComputedBearing(**vars(prepared), runs=runs, rolled=found)


def _rolled(
    prepared: PreparedBearing,
    progress: Progress | None = None,
    share: float = 1.0,
    begin_beside: Callable[[], object] = lambda: None,
) -> Iterator[tuple[str, RolledBearing]]:
    """The bearing as each law rolls it, at all time steps.

    For a share of run-in and record; by laws that are looked up for all of it.
    """
    case = prepared.case
    of = prepared.case.bearing.bearing
    ons = raceways_of(prepared, progress)
    looked_up = {name for name in case.laws if Need.SCAN in spec_of(name).needs}
    others = [name for name in case.laws if name not in looked_up]
    laws_of = [  # balls run forwards on the ring that stands still
        laws_on(on, others, balls=prepared.balls, forwards=ring != of.turning)
        for ring, on in zip(RINGS, ons, strict=True)
    ]
    smooth, load = case.contacts[1]
    averaged = [felt_by(smooth, surface, load) for surface in prepared.balls]
    time = case.settling + case.duration
    sensors: list[Sensor] = [("outer", angle, "radial") for angle in case.sensors]

    def surfaces() -> list[Array]:
        every = (*prepared.raceways, *prepared.balls)
        return [heights for each in every for heights in (each.heights, each.line, each.faults)]

    def once(law: str, inner: Any, outer: Any, share: float) -> RolledBearing:
        if share == 1.0:
            begin_beside()
        return roll_bearing(
            of, bearing_rings(case), inner, outer,
            speed=case.speed, radial=case.radial, axial=case.axial, rotating=case.rotating,
            duration=max(share * time - case.settling, case.step), time_step=case.step,
            settling=case.settling, slip=cage_slip(case),
            ball_heights=[] if isinstance(inner, list) else averaged,
            centrifugal=case.centrifugal, sensors=sensors, **case.tilts,
            highest_frequency=case.highest_frequency, progress=progress,
            checkpoint=checkpoint_of(law, case, surfaces, Store()),
        )  # fmt: skip

    def looking_up(law: str, scanned: Sequence[ScannedRaceway], share: float) -> RolledBearing:
        inner, outer = laid(case, [each.raceway.build(law, each.states) for each in scanned])
        return once(law, inner, outer, share)

    loads = case.static.inner_load, case.static.outer_load
    scanned: Sequence[ScannedRaceway] = []
    if looked_up:
        scanned = [
            ScannedRaceway(on, on.states_under(each.min(), each.max()))
            for on, each in zip(ons, loads, strict=True)
        ]
    del ons  # what they derived of heights is not needed beside what is rolled
    for name in case.laws:
        if name in looked_up:
            run, scanned = within_scan(partial(looking_up, name), scanned, _visited, TRIED)
        else:
            inner, outer = laid(case, [of[name] for of in laws_of])
            run = once(name, inner, outer, share)
        yield name, run


def compute_with_parts(prepared: PreparedBearing, progress: Progress) -> ComputedBearing:
    """Run the bearing by each law, and by `BY_PARTS` with what is on each part alone, and on none.

    None of the latter if nothing is on any. These runs are independent, and made on threads, beside the runs
    of the bearing, which take one thread each.
    """
    case = prepared.case
    textured = _textured(case)
    if not textured:
        return compute_bearing(prepared, progress)
    names = ["perfect surfaces", *(named_on(case, key) for key in textured)]
    if len(case.faults) > 1:
        names[-1] = "the faults"
    others = (dict.fromkeys(key for key in textured if key != kept) for kept in (None, *textured))
    parts = (_without(prepared, left_out) for left_out in others)
    with ExitStack() as beside:
        begin = cache(lambda: beside.enter_context(begun_in_order(_acceleration, parts)))
        computed = compute_bearing(prepared, progress, begin)
        runs = counted(begin(), len(names), "rolling with parts alone", progress)
        alone = dict(zip(names, runs, strict=True))
    still = np.zeros_like(computed.first.acceleration)
    return replace(computed, alone={name: still if run is None else run for name, run in alone.items()})


def _textured(case: BearingUnderLoad) -> list[str]:
    """Sections of a case that put anything on a part."""
    return [key for key in map(case.called, ON) if getattr(case, key).given()]


def _without(prepared: PreparedBearing, left_out: dict[str, None]) -> PreparedBearing:
    """A case by `BY_PARTS`, some sections left out, laid ready."""
    return prepare_bearing(prepared.case.with_(laws=[BY_PARTS], **left_out), beside=prepared)


def _acceleration(prepared: PreparedBearing) -> Array | None:
    """Accelerations (sensors, n), m/s², by `BY_PARTS`; None where nothing vibrates."""
    with PhysicsWarning.unsaid_here():
        if not _textured(prepared.case) and _stands_still(prepared):
            return None
        ((_, run),) = _rolled(prepared)
        return thinned(run.steadied().acceleration, prepared.case.steps_per_sample)


def _stands_still(prepared: PreparedBearing) -> bool:
    """Whether nothing vibrates in a bearing of perfect surfaces, as one turn of the cage shows.

    All that happens there happens again in each turn at a steady speed. It is asked where all balls are
    carried alike.
    """
    case = prepared.case
    turn = 1.0 / abs(case.kinematics.cage)
    loads = case.static.inner_load, case.static.outer_load
    unlike = any(np.ptp(each) > ALIKE * each.max() for each in loads)
    if unlike or isinstance(case.speed, SpeedCourse) or turn >= case.duration:
        return False
    share = (case.settling + turn) / (case.settling + case.duration)
    ((_, run),) = _rolled(prepared, share=share)
    return not run.vibrates


@dataclass(frozen=True, eq=False)
class ScannedRaceway:
    """A raceway in which a law looks its forces up, with the states in which it is scanned."""

    raceway: OnRaceway
    states: slice

    def wider(self, visited: tuple[float, float] | None) -> Self | None:
        """One that is scanned for forces between two, N, too; None if this one is."""
        if visited is None:
            states = slice(0, len(self.raceway.approaches))
        else:
            states = self.raceway.wider(self.states, *visited)
        return None if states == self.states else replace(self, states=states)


def _visited(run: RolledBearing) -> list[tuple[float, float]]:
    """Least and largest force of the springs of contacts, N, on the inner and on the outer raceway."""
    return [((1.0 - DAMPED) * least, (1.0 + DAMPED) * most) for least, most in run.reached]


def laid(case: BearingUnderLoad, level: Sequence[Any]) -> Sequence[Any]:
    """Laws of the contacts with the inner and the outer ring: tilted with the ring, with films of oil."""
    laws = list(level)
    contacts: Any = case.contacts
    if case.tilts:
        laws = [Tilted(law, smooth) for law, (smooth, _) in zip(laws, contacts, strict=True)]
    if case.films is None:
        return laws
    each = zip(laws, case.films, contacts, strict=True)
    return [WithFilm(law, film, load) for law, film, (_, load) in each]


def bearing_rings(case: BearingUnderLoad) -> BearingRings:
    """Both rings with what they carry, on what holds them; they bend if the case says so."""
    angle = case.static.contact_angle
    inner, held = (
        Ring.rigid(
            keys.mass, angle, radial_stiffness=keys.radial_stiffness, axial_stiffness=keys.axial_stiffness,
            damping_ratio=keys.damping_ratio
        )
        for keys in (case.shaft, case.housing)
    )  # fmt: skip
    return BearingRings(inner, held, *case.bending_rings())


def cage_slip(case: BearingUnderLoad) -> Callable[[Array], Array]:
    """Slip of the cage at times (n,), s, drawn anew for each of its turns, and straight between these."""
    least, most = case.cage_slip
    rate = case.kinematics.cage
    turns = int(rate * (case.settling + case.duration)) + 3
    drawn = np.random.default_rng([case.seed, 7]).uniform(least, most, turns)
    if isinstance(speed := case.speed, SpeedCourse):
        before = speed.covered(-case.settling)
        per_turn = rate / float(speed)
        return lambda at: np.interp((speed.covered(at) - before) * per_turn + 1.0, np.arange(turns), drawn)
    return lambda at: np.interp((at + case.settling) * rate + 1.0, np.arange(turns), drawn)


def thinned(signal: Array, every: int) -> Array:
    """A signal (…, n) at one of so many samples, without what the fewer samples do not hold."""
    if every == 1:
        return signal
    if not signal.size:
        return signal[..., ::every]
    from scipy.signal import resample_poly

    return resample_poly(signal, 1, every, axis=-1, padtype="line")
