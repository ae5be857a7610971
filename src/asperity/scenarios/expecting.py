"""What a run will take: contacts to solve, time steps, disk; and a coarse time."""

from __future__ import annotations

from dataclasses import dataclass

from asperity.config.case import Case
from asperity.laws import spec_of
from asperity.progress import Progress
from asperity.scenarios.compiling import compile_kernels
from asperity.scenarios.preparing import PreparedCase
from asperity.scenarios.running_in import running_in_passes, running_in_positions
from asperity.scenarios.scan_sizes import Expected, scan_sizes
from asperity.scenarios.trial import ContactTrial, try_contacts
from asperity.threads import one_thread_in_linear_algebra, thread_count

NEIGHBOUR = 0.4
"""Time of a contact that starts from its neighbour's pressure to that of one that does not."""
STEP_TIME = 1e-6
"""Time of a step of one contact by a law that looks its force up, and of its spectra and record, s."""
TRACK_TIME = 2.0
"""Time of the moving kernels of a track, for each of its distances, s."""
START_TIME = 2.0
"""Time of starting the program, of laying out a result and of writing its report, s."""


@dataclass(frozen=True)
class Work:
    """What a run will take."""

    # ``"filters"`` where samples are scanned, ``"path"`` where a law looks its scan up
    scans: dict[str, Expected]
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
    case, trial = prepared.case, None
    with one_thread_in_linear_algebra():
        if prepared.textures.maps:
            compile_kernels(progress)
            trial = try_contacts(prepared, progress)
    scans, steps = scan_sizes(case, prepared.shape, prepared.textures), steps_of(case)
    solutions = {f"scan for the {name}": scan.solutions for name, scan in scans.items()}
    if case.contact.running_in is not None:
        rolled = running_in_positions(prepared.shape, prepared.textures)
        solutions["running in"] = running_in_passes(case) * rolled
    contacts = len(prepared.bodies.offsets)
    solved = [law for law in case.laws if spec_of(law).solved_every_step]
    seconds = START_TIME + prepared.processor + TRACK_TIME * len(prepared.bodies.points)
    seconds += STEP_TIME * steps * contacts * len(case.laws)
    if trial is not None:
        one = NEIGHBOUR * trial.solution
        seconds += case.contact.samples * len(trial.approaches) * trial.solution
        seconds += one * sum(solutions.values()) / thread_count() + one * len(solved) * steps * contacts
    return Work(scans, solutions | dict.fromkeys(solved, steps * contacts), steps, trial, seconds)


def steps_of(case: Case) -> int:
    """Time steps of a law, with its run-in."""
    return round((case.settled_time + case.rolled_time) / case.time_step)
