"""The chain that all kinds of case share: textures are reduced, laws are built and rolled one by one."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.config.case import SETTLED, Case
from asperity.contact.scan import ScannedForces
from asperity.errors import PhysicsWarning, ShortRecordWarning
from asperity.laws import Law, Need, needs_of
from asperity.progress import Progress
from asperity.rolling.roll import RolledBodies
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.laws import Workshop
from asperity.scenarios.line_filters import normalisations
from asperity.scenarios.reducing import Reduction, patch_planes, reduce
from asperity.scenarios.running_in import RunInCase, run_in_case
from asperity.scenarios.textures import Textures
from asperity.store import Store

if TYPE_CHECKING:
    from asperity.scenarios.preparing import PreparedCase


@dataclass(frozen=True, eq=False)
class Chain:
    """What was computed for a case of any kind, before it is laid out as a result."""

    case: Case
    textures: Textures
    shape: Geometry
    reduction: Reduction | None  # state functions; None without samples
    runs: dict[str, RolledBodies]  # time histories, by law
    scan: ScannedForces[Any] | None  # of the path
    running_in: RunInCase | None  # what passes before did to the textures; None where there were none
    seconds: dict[str, float]  # wall time of each part, s
    workshop: Workshop  # to build its laws in

    @property
    def laws(self) -> dict[str, Law]:
        """Its laws by name, in the order of the case, built again: each holds all the path in every state."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", PhysicsWarning)  # of that was warned when they were rolled
            return {name: self.workshop.build(name) for name in self.case.laws}

    def stacked(self, name: str) -> NDArray[np.float64]:
        """Stack one record of all runs, (laws, contacts or sensors, ...), by the name of its attribute."""
        return np.stack([getattr(run, name) for run in self.runs.values()])


class Further(NamedTuple):
    """A contact beside the first of a case."""

    textures: Callable[[Textures], Textures]  # its own, from those of the first
    load: float  # N


class Stopwatch:
    """Wall time of consecutive parts of the work."""

    def __init__(self, **before: float) -> None:
        self.seconds: dict[str, float] = before
        self._last = time.perf_counter()

    def lap(self, part: str) -> None:
        """Book the time since the last lap on a part."""
        now = time.perf_counter()
        self.seconds[part] = now - self._last
        self._last = now


def warn_of_start(case: Case, remedy: str) -> None:
    """Warn of a record that holds the start from rest; `remedy` is how to make room for a run-in."""
    settling = case.settled_time
    if settling < SETTLED * (1 - 1e-9):
        warnings.warn(
            f"the record starts {settling * 1e3:.3g} ms after rest, less than {SETTLED * 1e3:.3g} ms: its "
            f"levels hold the start. So that there is time for settling, {remedy}.",
            ShortRecordWarning,
            stacklevel=3,
        )


def reduce_and_roll(
    prepared: PreparedCase,
    roll: Callable[..., RolledBodies],
    store: Store,
    progress: Progress,
    watch: Stopwatch,
    further: Sequence[Further] = (),
) -> Chain:
    """Run the textures in where a case asks for it, reduce the samples, build its laws and roll each.

    `roll` rolls a law, and beside it the same law of each `further` contact. The store keeps finished scans;
    the stopwatch books the wall time.
    """
    case, textures, shape, ran = prepared.case, prepared.textures, prepared.shape, None
    if case.contact.running_in is not None:
        ran = run_in_case(case, textures, shape, store, progress)
        textures = ran.textures
        watch.lap("running in")
    planes = None if textures.path is None else patch_planes(textures.path, shape)
    reduction = None
    if textures.maps:
        needed = normalisations(case.contact, case.laws)
        reduction = reduce(case.contact, case.numerics, textures, shape, planes, needed, store, progress)
    watch.lap("reduction")
    workshop = Workshop(case.contact, case.numerics, textures, shape, reduction, planes, store, progress)
    others = [_of_contact(workshop, contact) for contact in further]
    runs: dict[str, RolledBodies] = {}
    anew = replace(workshop)  # without the textures that it will make
    for name in case.laws:
        runs[name] = roll(workshop.build(name), *(other.build(name) for other in others))
        watch.lap(f"law {name}")
    scan = workshop.scan if Need.SCAN in needs_of(case.laws) else None
    return Chain(case, textures, shape, reduction, runs, scan, ran, watch.seconds, anew)


def _of_contact(workshop: Workshop, contact: Further) -> Workshop:
    """The workshop of another contact of the same bodies."""
    textures = contact.textures(workshop.textures)
    planes = None if textures.path is None else patch_planes(textures.path, workshop.shape)
    shape = replace(workshop.shape, load=contact.load)
    return replace(workshop, textures=textures, shape=shape, planes=planes)
