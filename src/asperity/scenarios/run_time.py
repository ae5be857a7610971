"""How long a run takes: counts of what is done, times rates of the machine that it is done on.

Contacts are timed on the case itself, a few of each of its scans. For all else there are processor times of
one machine, and how much longer this one takes for a little piece of such work.
"""

import math
import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache

import numpy as np

from asperity.contact.scan import ScanJob, scan_forces
from asperity.laws import Need, spec_of
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.reducing import patch_planes
from asperity.scenarios.scene import PreparedCase
from asperity.structures.moving_kernel import SHORTEST, STARTS
from asperity.structures.track import Track
from asperity.surfaces.strip import Rows
from asperity.threads import thread_count

# Processor times, s, on a machine of pace one
START = 3.9
"""Of starting the program, laying out a result and writing its report."""
TRACK_START = 1.6
"""Of the same for what only tracks have: sound, decay, what passes by."""
LAW = 0.1
"""Of a law in results and figures."""
STEP = 1.7e-6
"""Of a step of one contact by a law that looks its force up, and of its record."""
SPECTRUM = 2.2e-5
"""Of a step of one law in the spectra, sound and record beside a track."""
SOLVED_STEP = 1.5e-4
"""Of a step of a law that is solved in Python, beside its contact."""
SOLVED_START = 1.5
"""Of such a law before its first step."""
SOLVED = 1.2
"""Contacts of a loading curve that a step of such a law takes."""
CELL = 3.4e-7
"""Of a cell of the path, whose planes are found."""
AREAL = 1.7e-7
"""Of a cell of the path that a law averages in all states."""
RESPONSE = 2.0e-8
"""Of one lag of the response of a track at one place to a force at another."""
POLES, POLES_OF_BAY = 0.6, 0.15
"""Of fitting a moving kernel by poles, and more for each bay that differs."""
SOUND_OF_BAY = 0.35
"""Of sound, receptances and points that are passed, of each bay that differs."""
PIECE = 0.7e-3
"""Of the piece of work by which the pace is found."""
REACH = 40.0
"""Distance up to which contacts feel each other on a rail, m, as `asperity.structures.rail_poles` has it."""
FEW = 8
"""Positions of a scan that are solved to time it."""
FIRST = 2
"""Of these, positions whose starts are worse than those of others."""
PATIENCE = 1.0
"""Time, s, that timing a scan may take; else a single contact stands for those of the scan."""
SMOOTH = 0.1
"""Time of a contact on a path without heights, in those of a contact of a loading curve."""
FOLLOWING = 0.6
"""Time of a contact of a scan, in those of a contact of a loading curve, where it is not timed."""


@cache
def pace() -> float:
    """How much longer this machine takes than the one of the times above, by its processor's clock.

    As long, where the clock ticks too seldom to tell.
    """
    rows = np.random.default_rng(1).standard_normal((24, 2400))

    def piece() -> float:
        begin = time.process_time()
        np.fft.irfft(np.fft.rfft(rows, axis=1) * 0.5, axis=1)
        sum(k * k for k in range(6000))
        return time.process_time() - begin

    return (min(piece() for _ in range(5)) or PIECE) / PIECE


@dataclass(frozen=True)
class RunTime:
    """Processor time of a run, and time on the clock of a machine that does nothing else, s."""

    parts: Mapping[str, float] = field(default_factory=dict)  # processor time by what takes it
    beside: frozenset[str] = frozenset()  # those that all threads share

    @property
    def processor(self) -> float:
        """Of all parts, s."""
        return sum(self.parts.values())

    @property
    def clock(self) -> float:
        """On the clock, s."""
        threads = thread_count()
        return sum(
            seconds / threads if part in self.beside else seconds for part, seconds in self.parts.items()
        )


def time_of_contacts(job: ScanJob, solution: float, shape: Geometry | None = None) -> float:
    """Processor time of a contact of a scan, s: of a few in its middle, one after the other.

    `solution` is that of a contact of a loading curve, s. With a geometry approaches count from the planes
    that its nominal patch feels.
    """
    states = len(job.approaches)
    rows = job.body.shape[0]
    positions = min(FEW, job.positions)
    if positions <= FIRST + 1 or positions * states * solution > PATIENCE:
        return FOLLOWING * solution
    middle = (job.positions - positions) // 2 * job.stride
    heights = job.surface.rows(middle, middle + rows + (positions - 1) * job.stride)
    if not heights.any():
        return SMOOTH * solution
    planes = np.zeros(positions)
    if shape is not None:
        planes = patch_planes(Rows(heights, shape.spacing), shape)[rows // 2 :: job.stride][:positions]

    def timed(count: int) -> float:
        part = Rows(heights[: rows + (count - 1) * job.stride])
        few = replace(job, surface=part, planes=planes[:count], anchor=0, device=None)
        begin = time.process_time()
        scan_forces(few, workers=1)
        return time.process_time() - begin

    return max(timed(positions) - timed(FIRST), 0.0) / ((positions - FIRST) * states)


def of_track(prepared: PreparedCase) -> dict[str, float]:
    """Parts of a track; nothing of other structures."""
    case = prepared.case
    over = prepared.scene.over
    if not isinstance(over, Track):
        return {}
    offsets = prepared.scene.offsets
    apart = np.unique(np.abs(np.round(np.subtract.outer(offsets, offsets), 6)))
    kernels = 1.0 + 2.0 * float(np.count_nonzero((apart > 0.0) & (apart < REACH)))
    bays = over.cell_bays
    taps = SHORTEST / case.time_step
    passed = SHORTEST * case.speed / over.sleeper_spacing + 2.0
    of_kernel = RESPONSE * bays * STARTS**2 * passed * taps
    poles = 0.0 if case.numerics.kernel == "scatter" else POLES + POLES_OF_BAY * (bays if over.bays else 0)
    steps = case.rolled_time / case.time_step
    points = len(case.point_positions)
    return {
        "the track": TRACK_START + (SOUND_OF_BAY * bays if over.bays else 0.0) + kernels * poles,
        "the moving kernel": kernels * of_kernel,
        "spectra and sound": SPECTRUM * steps * len(case.laws),
        "points that are passed": 0.1 + 4e-6 * steps * len(case.laws) * points,
    }


def of_laws(prepared: PreparedCase, steps: int, solution: float) -> dict[str, float]:
    """Parts of the laws, with the processor time of a contact of a loading curve, s."""
    contacts = len(prepared.scene.offsets)
    cells = 0.0
    if prepared.textures.path is not None:
        cells = float(math.prod(prepared.textures.path.shape))
    found = {}
    for law in prepared.case.laws:
        seconds = LAW + STEP * steps * contacts
        if spec_of(law).solved_every_step:
            seconds += SOLVED_START + (SOLVED_STEP + SOLVED * solution) * steps * contacts
        if Need.AREAL in spec_of(law).needs:
            seconds += AREAL * cells
        found[f"the law {law}"] = seconds
    return found
