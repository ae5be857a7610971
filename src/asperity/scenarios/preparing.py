"""What comes before the work: all that a case needs, what is wrong with it, and what the run will take."""

import math
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from asperity.arguments import Array
from asperity.case.chosen_lengths import with_chosen
from asperity.case.scene import Case
from asperity.contact.batched import find_device
from asperity.contact.scan import BLOCK_BYTES, FILTER_SHARE, ScanJob, rtol_for, scan_forces
from asperity.errors import Finding, InputError, PhysicsWarning
from asperity.files import amount, free_space
from asperity.laws import Need, needs_of, spec_of
from asperity.progress import Progress, duration
from asperity.rolling.ground import warn_if_bent
from asperity.rolling.resolution import (
    PER_HIGHEST,
    PER_HIGHEST_ON_RAIL,
    PER_MODE,
    PER_RESONANCE,
    PER_RESONANCE_ON_RAIL,
    PER_SLEEPER,
)
from asperity.rolling.steps import warn_if_coarse
from asperity.scenarios import compiling, reducing, run_time, running_in
from asperity.scenarios.coverage import doubt_levels, problems_of_coverage
from asperity.scenarios.doubts import doubt_sizes
from asperity.scenarios.geometry import CLEAR, Geometry, geometry_of, window_cells
from asperity.scenarios.problems import by_key, problems, refuse
from asperity.scenarios.rim_cells import with_rims
from asperity.scenarios.scanned_positions import table_stride
from asperity.scenarios.scanned_states import states_apart, states_expected
from asperity.scenarios.scene import PreparedCase, scene_of
from asperity.scenarios.textures import Textures, textures_of, warn_of_textures
from asperity.store import MOST_HELD, Store
from asperity.structures.modal import HIGHEST
from asperity.structures.track import Track
from asperity.surfaces.strip import Rows, Strip
from asperity.threads import one_thread_in_linear_algebra, thread_count
from asperity.written_numbers import in_newtons, rounded

LONG = 2.0
"""Processor time, s, after which no further sample is pressed."""


def prepare(case: Case, source: str = "case") -> PreparedCase:
    """Build and read all that a case needs, and refuse what cannot be computed, with all errors at once."""
    begin = time.perf_counter()
    spent = time.process_time()
    made = list[Any]()
    errors = list[InputError]()
    with PhysicsWarning.caught() as caught, one_thread_in_linear_algebra():
        whole = (partial(make, case) for make in (scene_of, geometry_of, textures_of))
        for make in (*whole, thread_count, find_device):
            try:
                made.append(make())
            except InputError as error:
                errors.append(by_key(case, error))
        refuse(list({str(error): error for error in errors}.values()), source)  # threads are asked twice
        prepared = PreparedCase(case, *made[:3])
        if (smaller := _within_the_map(case, prepared.textures)) is not None:
            refuse(_problems_of_narrow_maps(smaller, prepared.shape), source)
            return prepare(smaller, source)
        refuse([*problems(prepared), *_problem_of_disk(prepared)], source)
        prepared = with_rims(prepared)
        warn_of_textures(case, prepared.shape, prepared.textures)
        doubt_sizes(case, prepared.scene.over)
        doubt_levels(case)
        refuse(list(problems_of_coverage(case, prepared.textures)), source)
    seconds = {"textures": time.perf_counter() - begin}
    processor = time.process_time() - spent
    return replace(prepared, caught=tuple(caught), seconds=seconds, processor=processor)


def _within_the_map(case: Case, textures: Textures) -> Case | None:
    """The case with a window no wider than its measured maps, where it was chosen wider; else None."""
    smallest = min((min(sample.shape) for sample in textures.maps), default=math.inf)
    if "window" in case.contact.given_names or window_cells(case.contact) <= smallest:
        return None
    cells = int(smallest) - 1 + int(smallest) % 2  # odd, as those of every window
    return with_chosen(case, {"contact": {"window": cells * case.contact.spacing}})


def _problems_of_narrow_maps(case: Case, shape: Geometry) -> list[InputError]:
    """Errors about measured maps that do not hold the smooth contact, with a window as wide as they are."""
    least = CLEAR * 2.0 * max(shape.semi_axes)
    held = window_cells(case.contact) * case.contact.spacing
    if held >= least or case.surface.file is None:
        return []
    allowed = (
        f"at least {rounded(least * 1e6, 4)} um, {CLEAR:g} times the width of the smooth contact under "
        f"{in_newtons(shape.load)}"
    )
    remedy = "Measure wider maps, press less, or roll a smaller body over them."
    return [InputError("surface.file", f"maps of {rounded(held * 1e6, 4)} um across", allowed, remedy)]


def _problem_of_disk(prepared: PreparedCase) -> Iterator[InputError]:
    """A disk that does not hold the scan of the path."""
    path = scan_sizes(prepared).get("path")
    root = Store().root
    if path is not None and (free := free_space(root)) < path.bytes > MOST_HELD:
        remedy = "Set $ASPERITY_CACHE to a folder on another disk, or free some space."
        allowed = f"{amount(path.bytes)} for the scan of the path"
        yield InputError("disk of the cache", f"{amount(free)} free in {root}", allowed, remedy)


# --- what a run will take


@dataclass(frozen=True)
class ScanSize:
    """What a scan will take."""

    positions: int
    states: int
    bytes: int  # on disk
    farther: int = 0  # states beside these, which a motion may visit

    @property
    def solutions(self) -> int:
        """Contact solutions: fewer where states do not touch, more where a motion goes beyond them."""
        return self.positions * self.states

    @property
    def most(self) -> int:
        """Contact solutions where a motion visits all states."""
        return self.positions * (self.states + self.farther)


def scan_sizes(prepared: PreparedCase) -> dict[str, ScanSize]:
    """Find the sizes of the scans of a case, of as many states as it names or the run chooses.

    ``"filters"`` where rough samples are scanned, ``"path"`` where a law looks its scan up: at the states
    that its motion is expected to visit.
    """
    states = np.arange(float(len(prepared.case.contact.approaches or range(reducing.STATES))))
    sizes = {}
    for name, jobs in scans_of(prepared, states).items():
        positions, size = (sum(getattr(job, what) for job in jobs) for what in ("positions", "bytes"))
        count = len(jobs[0].approaches)
        if name == "path":  # each state has blocks of its own
            size += BLOCK_BYTES * len(jobs[0].starts) * (count - 1)
        sizes[name] = ScanSize(positions, count, size, len(states) - count if name == "path" else 0)
    return sizes


def scans_of(prepared: PreparedCase, states: Array) -> dict[str, list[ScanJob]]:
    """The scans of a case, whose states, m, are these."""
    case = prepared.case
    shape = prepared.shape
    textures = prepared.textures

    def scans(
        strips: Sequence[Strip], on: Geometry, at: Array, stride: int, accuracy: float, anchor: int = 0
    ) -> list[ScanJob]:
        half_space = on.half_space(None)
        rtol = rtol_for(accuracy * case.numerics.force_accuracy)
        return [ScanJob(half_space, strip, on.body, at, stride, rtol, anchor=anchor) for strip in strips]

    found = {}
    if strips := [strip for strip in textures.strips if strip.heights.any()]:
        every = 1 if Need.FILTER in needs_of(case.laws) else reducing.SHOWN
        shown = states[(len(states) - 1) % every :: every]
        found["filters"] = scans(strips, shape, shown, reducing.filter_stride(shape), FILTER_SHARE)
    if Need.SCAN in needs_of(case.laws) and textures.path is not None:
        scanning = prepared.scanning
        over = scanning.textures
        assert over.path is not None
        visited = list(range(len(states)))
        if case.contact.approaches is None:
            forces = reducing.nominal_forces(shape)
            if prepared.leaves_states_out:
                visited = states_apart(forces ** (2.0 / 3.0), forces[None])
            visited = visited[states_expected(states[visited], forces[visited], prepared.scene.loads)]
        stride = table_stride(scanning)
        found["path"] = scans([over.path], scanning.shape, states[visited], stride, 1.0, over.before)
    return found


@dataclass(frozen=True, eq=False)
class ContactTrial:
    """What samples of a case say of its contact."""

    approaches: Array  # (k,), states much as the run will choose them, m
    pressed: reducing.PressedSamples  # under that load; a few where that takes long
    cut_off: float  # share of the contacts of a loading curve that the window cuts off
    solution: float  # processor time of a contact of that curve, s
    scanned: Mapping[str, float]  # of a contact of each scan, s


def try_contacts(prepared: PreparedCase, progress: Progress) -> ContactTrial:
    """Press some samples of a case, and compute the loading curve of the first."""
    case = prepared.case
    shape = prepared.shape
    textures = prepared.textures
    with PhysicsWarning.ignored():
        progress(0, 2, "trying contacts")
        samples = reducing.samples_of(case, shape, textures.maps, shape.class_axes)
        half_space = shape.half_space(case.contact.hardness)
        solve = partial(half_space.solve, load=shape.load, rtol=case.numerics.rtol)
        contacts = [solve(shape.body - samples[0])]
        begin = time.process_time()
        for sample in samples[1:]:
            if time.process_time() - begin > LONG:
                break
            contacts.append(solve(shape.body - sample))
        pressed = reducing.PressedSamples(half_space, contacts, solve(shape.body))
        progress(1, 2, "trying contacts")
        working = contacts[0].approach
        if (given := case.contact.approaches) is None:
            places = reducing.touched_places(textures, shape)
            approaches = reducing.chosen_states([samples[0], *places], shape, half_space)
            reducing.refuse_uneven_states(approaches, textures)
        else:
            approaches = np.array(given)
            highest = [[half_space.solve(shape.body - s, r).force for r in given[-2:]] for s in samples]
            reducing.refuse_low_states(approaches, np.mean(highest, axis=0), shape, working)
        rtol = rtol_for(case.numerics.force_accuracy)
        begin = time.process_time()
        job = ScanJob(half_space, Rows(samples[0]), shape.body, approaches, rtol=rtol, device=None)
        counts = scan_forces(job, workers=1).counts
        solution = (time.process_time() - begin) / len(approaches)
        scanned = {
            name: run_time.time_of_contacts(jobs[0], solution, shape if name == "path" else None)
            for name, jobs in scans_of(prepared, approaches).items()
        }
        progress(2, 2, "trying contacts")
    return ContactTrial(approaches, pressed, counts.truncated / max(counts.solved, 1), solution, scanned)


def doubt_time_step(prepared: PreparedCase) -> None:
    """Warn of a time step that is too long for the contact, or for modes and sleepers, as the run will.

    The contact is the smooth one: on a track on a bay of rail; elsewhere on what rolls, which is less than
    together with what yields under it.
    """
    case = prepared.case
    over = prepared.scene.over
    shape = prepared.shape
    highest = case.numerics.highest_frequency
    own = np.concatenate([body.natural_frequencies for body in prepared.scene.rolling])
    limits = [("the highest mode of a body", float(own[own <= highest].max(initial=0.0)), PER_MODE)]
    if isinstance(over, Track):
        stiffness = shape.hertz.stiffness_under(shape.load)
        on_bay = math.sqrt(stiffness / (over.mass_per_length * over.sleeper_spacing)) / (2.0 * math.pi)
        limits += [
            ("the contact resonance on a bay of rail", on_bay, PER_RESONANCE_ON_RAIL),
            ("the passing of sleepers v/L", case.speed / over.sleeper_spacing, PER_SLEEPER),
            ("the highest frequency asked for", highest, PER_HIGHEST_ON_RAIL),
        ]
    else:
        modes = np.zeros(0) if over is None else over.natural_frequencies
        highest_mode = float(modes[modes <= HIGHEST].max(initial=0.0))
        limits += [
            ("the contact resonance", case.contact_resonance, PER_RESONANCE),
            ("the highest mode of the structure", highest_mode, PER_MODE),
            ("the highest frequency asked for", highest, PER_HIGHEST),
        ]
    warn_if_coarse(case.time_step, limits)


def doubt_deflection(prepared: PreparedCase) -> None:
    """Warn of what is rolled over where the loads at rest displace it by too much, as the run will.

    Where the record begins, in its middle, and where it ends; supports are left out, on which nothing moves,
    and what nothing holds. A rail is looked at under one load.
    """
    scene = prepared.scene
    first, last = prepared.case.rolled_range
    over = scene.over
    static = list[Array]()
    if isinstance(over, Track):
        static.append(np.array(over.static_deflection(float(scene.loads.max()))))
    elif over is not None:
        stiffness = (2.0 * math.pi * over.natural_frequencies) ** 2
        for start in np.linspace(first, last, 3):
            shapes, _ = over.shapes(start + np.asarray(scene.offsets))
            held = stiffness > 0.0
            static.append(shapes[:, held] @ (shapes[:, held].T @ scene.loads / stiffness[held]))
    warn_if_bent(over, np.array(static))


@dataclass(frozen=True)
class Work:
    """What a run will take."""

    # ``"filters"`` where samples are scanned, ``"path"`` where a law looks its scan up
    scans: dict[str, ScanSize]
    solutions: dict[str, int]  # contacts to solve, at most, by what for
    steps: int  # time steps of a law, with its run-in
    tried: ContactTrial | None  # contacts of a sample; None without samples
    time: run_time.RunTime = field(default_factory=run_time.RunTime)  # nothing of it found in the cache
    compiling: float = 0.0  # processor time beside it, s: of functions that are not kept from an earlier run
    farther: float = 0.0  # more processor time, s, where a motion visits all states of the path

    @property
    def seconds(self) -> float:
        """Time on the clock of an idle machine, s."""
        return self.time.clock

    @property
    def told(self) -> str:
        """The time in words: of the processor, on the clock, what most of it is for, and what is compiled."""
        processor = self.time.processor
        clock = self.time.clock
        said = f"about {_coarsely(processor)} of processor time"
        if _coarsely(clock) != _coarsely(processor):
            said += f", {_coarsely(clock)} on the clock of an idle machine"
        if self.farther > 0.5 * processor:
            said += f", up to {_coarsely(processor + self.farther)} where contact is lost or forces vary much"
        said += ", less what the cache holds"
        most = max(self.time.parts, key=self.time.parts.__getitem__, default="")
        if most and self.time.parts[most] > 0.5 * processor:
            said += f"; most of it {most}"
        if self.compiling:
            said += f"; before that functions are compiled, about {_coarsely(self.compiling)}, the first time"
        return said


class Plan(NamedTuple):
    """What will be computed of a case of any kind."""

    rows: list[tuple[str, str]]  # names and values, in words
    work: Work
    findings: Sequence[Finding] = ()  # what is doubtful of it


def _coarsely(seconds: float) -> str:
    """A time in words, to two digits."""
    return duration(float(f"{seconds:.2g}"))


def expect(prepared: PreparedCase, progress: Progress) -> Work:
    """Count the work of a case; a few contacts of its samples are solved for that.

    Parameters
    ----------
    prepared : PreparedCase
        The case.
    progress : Progress
        Called meanwhile.

    Returns
    -------
    Work
        Its time within a factor of two (`benchmarks/told_times.py`), if a motion stays where it is expected.
    """
    case = prepared.case
    trial = None
    doubt_time_step(prepared)
    doubt_deflection(prepared)
    with one_thread_in_linear_algebra():
        if prepared.textures.maps:
            compiling.compile_kernels(progress, *prepared.kinds_of_cells)
            trial = try_contacts(prepared, progress)
    scans = scan_sizes(prepared)
    steps = case.steps_taken
    solutions = {f"scan for the {name}": scan.most for name, scan in scans.items()}
    if case.contact.running_in is not None:
        solutions["running in"] = running_in.running_in_solutions(prepared)
    contacts = len(prepared.scene.offsets)
    solved = [law for law in case.laws if spec_of(law).solved_every_step]
    pace = run_time.pace()
    fixed = {"start and report": run_time.START} | run_time.of_track(prepared)
    parts = {part: pace * seconds for part, seconds in fixed.items()} | {"textures": prepared.processor}
    solution = farther = 0.0
    if trial is not None:
        solution = trial.solution
        parts["contacts of samples"] = case.contact.samples * len(trial.approaches) * solution
        for name, size in scans.items():
            parts[f"the scan for the {name}"] = trial.scanned[name] * size.solutions
            farther += trial.scanned[name] * (size.most - size.solutions)
        if case.contact.running_in is not None:
            parts["the running in"] = solution * solutions["running in"]
        if prepared.textures.path is not None:
            parts["planes of the path"] = pace * run_time.CELL * math.prod(prepared.textures.path.shape)
    for part, seconds in run_time.of_laws(prepared, steps, solution / pace).items():
        parts[part] = pace * seconds
    beside = frozenset(part for part in parts if part.startswith("the scan ")) | {"the moving kernel"}
    counts = solutions | dict.fromkeys(solved, steps * contacts)
    taken = run_time.RunTime(parts, beside)
    compiled = pace * compiling.time_to_compile(*prepared.kinds_of_cells)
    return Work(scans, counts, steps, trial, taken, compiled, farther)
