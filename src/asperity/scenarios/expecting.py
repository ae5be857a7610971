"""What a run will take: contact solutions, disk, and time, expected from small pieces of it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from asperity.config.case import Case
from asperity.laws import Need, needs_of, spec_of
from asperity.progress import Progress
from asperity.scenarios.compiling import compile_kernels
from asperity.scenarios.preparing import PreparedCase
from asperity.scenarios.reducing import STATES
from asperity.scenarios.running_in import running_in_passes, running_in_positions
from asperity.scenarios.scan_sizes import Expected, scan_sizes
from asperity.scenarios.trial import ContactTrial, timed, try_contacts
from asperity.threads import one_thread_in_linear_algebra, thread_count

SINGLE_TIME = 0.65
"""Time of a contact solution in single precision to that in double."""
STATE_TIME = 1.5e-7
"""Time of laying a state function out for a time step, s."""
NUMBER_TIME = 5e-7
"""Time of making a spectrum of a number of a record and of writing it, s."""
POINT_TIME = 3e-7
"""Time of a point of the path in its statistics, s."""
LAID_OUT = 0.5
"""Time of laying out the rest of a result, s."""
SINGLE_COMPILED = 10.0
"""Time of compiling the contact in single precision, where that is not kept yet, s."""
COUNTING_TIME = 12e-3
"""Time of adding up the first 200 000 squares on the processor on which those were measured, s."""


@dataclass(frozen=True)
class Work:
    """What a run will take."""

    # ``"filters"`` where samples are scanned, ``"path"`` where a law looks its scan up
    scans: dict[str, Expected]
    seconds: dict[str, float]  # by part of the work
    tried: ContactTrial | None = None  # contacts of a sample; None without samples

    @property
    def total(self) -> float:
        """Time of all parts, s."""
        return sum(self.seconds.values())


def expect(prepared: PreparedCase, progress: Progress) -> Work:
    """Expect the work of a case, from small pieces of it that are computed here.

    Parameters
    ----------
    prepared : PreparedCase
        The case.
    progress : Progress
        Called between the pieces.

    Returns
    -------
    Work
        On all threads of this machine, while nothing else is done on it and nothing is found in the cache;
        most often within a third.
    """
    case, trial = prepared.case, None
    with one_thread_in_linear_algebra():
        compile_kernels(progress)
        pace = _pace()
        scans = scan_sizes(case, prepared.shape, prepared.textures)
        seconds = {"textures": prepared.processor}
        if prepared.textures.maps:
            trial = try_contacts(prepared, progress)
            scans = {name: _timed_scan(name, scan, trial) for name, scan in scans.items()}
            seconds |= _contact_seconds(prepared, trial, scans, pace)
        seconds |= prepared.kind.plan("seconds")(prepared, progress, pace)
        seconds |= _rolling_seconds(prepared, pace)
    return Work(scans, seconds, trial)


def expected_path_scan(prepared: PreparedCase, progress: Progress) -> Expected:
    """Expect the size and time of the scan of a path alone, of a case that has one."""
    case = prepared.case
    with one_thread_in_linear_algebra():
        compile_kernels(progress)
        size = scan_sizes(case, prepared.shape, prepared.textures)["path"]
        return _timed_scan("path", size, try_contacts(prepared, progress))


def _timed_scan(name: str, scan: Expected, trial: ContactTrial) -> Expected:
    """Time of a scan: that of its positions, on as many threads as it has blocks."""
    position = trial.filters if name == "filters" else trial.path
    seconds = scan.positions * position * (SINGLE_TIME if scan.single else 1.0)
    return replace(scan, seconds=seconds / min(thread_count(), scan.blocks))


def _contact_seconds(
    prepared: PreparedCase, trial: ContactTrial, scans: dict[str, Expected], pace: float
) -> dict[str, float]:
    """Time of pressing the samples, of the scans, and of textures averaged under the patch."""
    case, textures = prepared.case, prepared.textures
    samples, needs = case.contact.samples, needs_of(case.laws)
    rows = 0 if textures.path is None else textures.path.shape[0]
    touched = rows * (1 + (Need.SCAN in needs and textures.defects is not None)) + sum(
        strip.shape[0] for strip in textures.strips
    )
    averaged = rows * (1 + (Need.AREAL in needs) * len(trial.approaches))
    found = {
        "pressing the samples": samples * trial.load + samples * trial.curve / min(thread_count(), samples),
        "averaging under the patch": touched * trial.touch + averaged * trial.average,
    }
    found |= {f"scanning for the {name}": scan.seconds for name, scan in scans.items()}
    if case.contact.running_in is not None:
        rolled = running_in_passes(case) * running_in_positions(prepared.shape, textures)
        found["running in"] = rolled * trial.rolled / thread_count()
    if any(scan.single for scan in scans.values()):
        found["compiling"] = SINGLE_COMPILED * pace
    solved = [law for law in case.laws if spec_of(law).solved_every_step]
    found |= dict.fromkeys(solved, steps_of(case) * trial.direct)
    return found


def _rolling_seconds(prepared: PreparedCase, pace: float) -> dict[str, float]:
    """Time of rolling all laws, of their spectra and statistics, and of writing the report."""
    case = prepared.case
    steps, laws, states = steps_of(case), len(case.laws), STATES
    plan = prepared.kind.plan
    path = prepared.textures.path
    points = len(prepared.textures.line) if path is None else math.prod(path.shape)
    written = steps * laws * plan("records")(case) * NUMBER_TIME + points * POINT_TIME
    return {
        "rolling": steps * laws * (plan("step_seconds")(prepared) + states * STATE_TIME * pace),
        "spectra and statistics": (written + LAID_OUT) * pace,
        "report": plan("REPORT") * pace,
    }


def steps_of(case: Case) -> int:
    """Time steps of a law, with its run-in."""
    return round((case.settled_time + case.rolled_time) / case.time_step)


def _pace() -> float:
    """How much slower this processor is than the one on which constants of this module were measured."""
    return min(timed(lambda: sum(i * i for i in range(200_000)))[1] for _ in range(3)) / COUNTING_TIME
