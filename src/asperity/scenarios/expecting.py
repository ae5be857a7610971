"""What a run will take: contacts to solve, time steps, disk, a coarse time; a few contacts are tried."""

from __future__ import annotations

import time
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from asperity.case.scene import Case
from asperity.contact.scan import FILTER_SHARE, ScanJob, rtol_for, scan_forces
from asperity.errors import InputError, PhysicsWarning
from asperity.files import amount, free_space
from asperity.laws import Need, needs_of, spec_of
from asperity.progress import Progress
from asperity.scenarios import reducing
from asperity.scenarios.compiling import compile_kernels
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.laws import table_stride
from asperity.scenarios.running_in import running_in_passes, running_in_positions
from asperity.scenarios.textures import Textures
from asperity.store import MOST_HELD
from asperity.surfaces.strip import Rows, Strip
from asperity.threads import one_thread_in_linear_algebra, thread_count

if TYPE_CHECKING:
    from asperity.scenarios.preparing import PreparedCase

NEIGHBOUR = 0.4
"""Time of a contact that starts from its neighbour's pressure to that of one that does not."""
STEP_TIME = 1e-6
"""Time of a step of one contact by a law that looks its force up, and of its spectra and record, s."""
TRACK_TIME = 2.0
"""Time of the moving kernels of a track, for each of its distances, s."""
START_TIME = 2.0
"""Time of starting the program, of laying out a result and of writing its report, s."""
LONG = 2.0
"""Processor time, s, after which no further sample is pressed."""


@dataclass(frozen=True)
class ScanSize:
    """What a scan will take."""

    positions: int
    states: int
    step: float  # distance of the positions, m
    bytes: int  # on disk
    single: bool  # whether the iteration will be in single precision

    @property
    def solutions(self) -> int:
        """Contact solutions, at most: states that do not touch need none."""
        return self.positions * self.states


def scan_sizes(case: Case, shape: Geometry, textures: Textures) -> dict[str, ScanSize]:
    """Find the sizes of the scans of a case, of as many states as it names or the run chooses.

    ``"filters"`` where rough samples are scanned, ``"path"`` where a law looks its scan up.
    """
    half_space = shape.half_space(None)
    states = np.arange(float(len(case.contact.approaches or range(reducing.STATES))))

    def sized(strips: Sequence[Strip], stride: int, accuracy: float, anchor: int = 0) -> ScanSize:
        rtol = rtol_for(accuracy * case.numerics.force_accuracy)
        jobs = [
            ScanJob(half_space, strip, shape.body, states, stride, rtol, anchor=anchor) for strip in strips
        ]
        positions, size = sum(job.positions for job in jobs), sum(job.bytes for job in jobs)
        single = any(job.single for job in jobs)
        return ScanSize(positions, len(states), stride * shape.spacing[0], size, single)

    sizes = {}
    if strips := [strip for strip in textures.strips if strip.heights.any()]:
        sizes["filters"] = sized(strips, reducing.filter_stride(shape), FILTER_SHARE)
    if Need.SCAN in needs_of(case.laws) and textures.path is not None:
        sizes["path"] = sized([textures.path], table_stride(shape), 1.0, textures.before)
    return sizes


def problem_of_disk(size: ScanSize, root: Path) -> Iterator[InputError]:
    """Find out whether the disk of the cache has room for a scan, or memory is to hold it."""
    free = free_space(root)
    if free < size.bytes > MOST_HELD:
        remedy = "Set $ASPERITY_CACHE to a folder on another disk, or free some space."
        allowed = f"{amount(size.bytes)} for the scan of the path"
        yield InputError("disk of the cache", f"{amount(free)} free in {root}", allowed, remedy)


@dataclass(frozen=True, eq=False)
class ContactTrial:
    """What samples of a case say of its contact."""

    approaches: NDArray[np.float64]  # (k,), states much as the run will choose them, m
    working: float  # approach of a sample under the working load, m
    pressed: reducing.PressedSamples  # under that load; a few where that takes long
    cut_off: float  # share of the contacts of a loading curve that the window cuts off
    solution: float  # processor time of a contact of that curve, s


def try_contacts(case: Case, shape: Geometry, textures: Textures, progress: Progress) -> ContactTrial:
    """Press some samples of a case, and compute the loading curve of the first."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PhysicsWarning)
        progress(0, 2, "trying contacts")
        samples = reducing.samples_of(case, shape, textures.maps, shape.class_axes)
        half_space = shape.half_space(case.contact.hardness)
        solve = partial(half_space.solve, load=shape.load, rtol=case.numerics.rtol)
        contacts, begin = [solve(shape.body - samples[0])], time.process_time()
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
        else:
            approaches = np.array(given)
            highest = [[half_space.solve(shape.body - s, r).force for r in given[-2:]] for s in samples]
            reducing.refuse_low_states(approaches, np.mean(highest, axis=0), shape, working)
        rtol, begin = rtol_for(case.numerics.force_accuracy), time.process_time()
        job = ScanJob(half_space, Rows(samples[0]), shape.body, approaches, rtol=rtol, device=None)
        counts = scan_forces(job, workers=1).counts
        solution = (time.process_time() - begin) / len(approaches)
        progress(2, 2, "trying contacts")
    return ContactTrial(approaches, working, pressed, counts.truncated / max(counts.solved, 1), solution)


@dataclass(frozen=True)
class Work:
    """What a run will take."""

    # ``"filters"`` where samples are scanned, ``"path"`` where a law looks its scan up
    scans: dict[str, ScanSize]
    solutions: dict[str, int]  # contacts to solve, at most, by what for
    steps: int  # time steps of a law, with its run-in
    tried: ContactTrial | None  # contacts of a sample; None without samples
    seconds: float  # a coarse time on all threads, nothing of it found in the cache, s


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
        Its time within a factor of three or so: that of one contact, times their number.
    """
    case, shape, textures, trial = prepared.case, prepared.shape, prepared.textures, None
    with one_thread_in_linear_algebra():
        if textures.maps:
            compile_kernels(progress)
            trial = try_contacts(case, shape, textures, progress)
    scans = scan_sizes(case, shape, textures)
    steps = round((case.settled_time + case.rolled_time) / case.time_step)
    solutions = {f"scan for the {name}": scan.solutions for name, scan in scans.items()}
    if case.contact.running_in is not None:
        solutions["running in"] = running_in_passes(case) * running_in_positions(shape, textures)
    contacts = len(prepared.scene.offsets)
    solved = [law for law in case.laws if spec_of(law).solved_every_step]
    seconds = START_TIME + prepared.processor + TRACK_TIME * len(prepared.scene.points)
    seconds += STEP_TIME * steps * contacts * len(case.laws)
    if trial is not None:
        one = NEIGHBOUR * trial.solution
        seconds += case.contact.samples * len(trial.approaches) * trial.solution
        seconds += one * sum(solutions.values()) / thread_count() + one * len(solved) * steps * contacts
    return Work(scans, solutions | dict.fromkeys(solved, steps * contacts), steps, trial, seconds)
